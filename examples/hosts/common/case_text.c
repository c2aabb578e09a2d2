/* Reads the text of a case into headings, lines and words, and says what is wrong with them, where, and the cure. */
#if !defined(_XOPEN_SOURCE) && !defined(_POSIX_C_SOURCE)
#define _POSIX_C_SOURCE 200809L
#endif
#include "case_parts.h"

#include <ctype.h>
#include <errno.h>
#include <locale.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_BYTES = 1 << 28, MATRIX = 36, TRIANGLE = 21, DIAGONAL = 6 };

static _Thread_local char last_message[1024];

const char *case_message(void) {
    return last_message;
}

int(case_fail)(const case_text *text, int line, int status, const char *format, ...) {
    char what[sizeof last_message];
    va_list list;
    va_start(list, format);
    (void)vsnprintf(what, sizeof what, format, list);
    va_end(list);
    if (text && line > 0) {
        (void)snprintf(last_message, sizeof last_message, "%.300s, line %d: %.680s", text->path, line, what);
    } else if (text && text->path) {
        (void)snprintf(last_message, sizeof last_message, "%.300s: %.680s", text->path, what);
    } else {
        (void)snprintf(last_message, sizeof last_message, "%.1000s", what);
    }
    return status;
}

int case_quiet_begin(case_quiet *quiet) {
    locale_t point = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!point) {
        return case_fail(NULL, 0, SPAR_ERR_MEMORY, "no memory for a locale");
    }
    quiet->point = point;
    quiet->host = uselocale(point);
    (void)feholdexcept(&quiet->environment);
    (void)fesetround(FE_TONEAREST);
    return SPAR_OK;
}

void case_quiet_end(case_quiet *quiet) {
    (void)fesetenv(&quiet->environment);
    (void)uselocale((locale_t)quiet->host);
    freelocale((locale_t)quiet->point);
}

/* ---- the file ---- */

static int unreadable(const case_text *text, int reason) {
    return case_fail(text, 0, SPAR_ERR_IO, "cannot be read: %s; check the path and its permissions on every rank",
                     strerror(reason ? reason : EIO));
}

static int read_stream(case_text *text, FILE *file) {
    size_t room = 1 << 14, size = 0;
    text->bytes = malloc(room);
    while (text->bytes) {
        size += fread(text->bytes + size, 1, room - size - 1, file);
        if (ferror(file)) {
            return unreadable(text, errno);
        }
        if (size + 1 < room) {
            break;
        }
        if (room >= MOST_BYTES) {
            return case_fail(text, 0, SPAR_ERR_IO, "has more than %d MB; give a text file", MOST_BYTES >> 20);
        }
        char *more = realloc(text->bytes, room *= 2);
        if (!more) {
            free(text->bytes);
        }
        text->bytes = more;
    }
    if (!text->bytes) {
        return case_fail(text, 0, SPAR_ERR_MEMORY, "no memory to read it");
    }
    text->bytes[size] = '\0';
    return memchr(text->bytes, '\0', size) ? case_fail(text, 0, SPAR_ERR_IO, "has a byte that is 0; it is not a text")
                                           : SPAR_OK;
}

static int read_bytes(case_text *text, const char *path) {
    size_t size = strlen(path) + 1;
    text->path = malloc(size);
    if (!text->path) {
        return case_fail(NULL, 0, SPAR_ERR_MEMORY, "no memory to read %.300s", path);
    }
    memcpy(text->path, path, size);
    errno = 0;
    FILE *file = fopen(path, "r");
    if (!file) {
        return unreadable(text, errno);
    }
    int status = read_stream(text, file);
    (void)fclose(file);
    return status;
}

/* ---- words ---- */

static int is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/* Cuts the next word off, in place; NULL: no more on this line. Quotes that do not end set *open. */
static char *cut_word(char **at, int *open) {
    char *c = *at;
    while (is_blank(*c)) {
        c++;
    }
    if (*c == '\0' || *c == '#') {
        return NULL;
    }
    char *word = c;
    if (*c == '"') {
        word = ++c;
        c += strcspn(c, "\"");
        *open = *c == '\0';
    } else {
        while (*c && *c != '#' && !is_blank(*c)) {
            c++;
        }
    }
    if (*c == '#') { /* a comment right behind the word */
        *c = '\0';
        *at = c;
    } else {
        *at = c + (*c != '\0');
        *c = '\0';
    }
    return word;
}

/* How many words and lines there can be at most. */
static void count_most(const char *bytes, size_t *words, size_t *lines) {
    *words = *lines = 2;
    for (const char *c = bytes; *c; c++) {
        *lines += *c == '\n';
        *words += is_blank(*c) || *c == '\n' || *c == '"';
    }
}

static int begin_block(case_text *text, char *heading, int number, case_line *lines) {
    char *end = strchr(heading, ']');
    const char *rest = end ? end + 1 : "";
    while (is_blank(*rest)) {
        rest++;
    }
    if (!end || (*rest && *rest != '#')) {
        return case_fail(text, number, SPAR_ERR_ARGUMENT,
                         "the heading is not complete; write [kind] or [kind name], alone on its line");
    }
    *end = '\0';
    char *kind = heading + 1, *name;
    while (is_blank(*kind)) {
        kind++;
    }
    name = kind + strcspn(kind, " \t");
    if (*name) {
        *name++ = '\0';
    }
    while (is_blank(*name)) {
        name++;
    }
    for (char *c = name + strlen(name); c > name && is_blank(c[-1]);) {
        *--c = '\0';
    }
    text->block[text->n++] = (case_block){.number = number, .kind = kind, .name = name, .line = lines};
    return SPAR_OK;
}

static int split_line(case_text *text, char *at, int number, case_line *line, char **word, const char *label) {
    int open = 0;
    *line = (case_line){.number = number, .word = word};
    for (char *next = cut_word(&at, &open); next; next = cut_word(&at, &open)) {
        *word++ = next;
    }
    line->n = (int)(word - line->word) - 1;
    line->label = label ? label : line->word[0];
    return open ? case_fail(text, number, SPAR_ERR_ARGUMENT, "a quote is not closed on its line; close it") : SPAR_OK;
}

static int split_bytes(case_text *text, int headings) {
    char *at = text->bytes, **word = text->word, *next;
    case_line *line = text->line;
    if (!headings) {
        text->block[text->n++] = (case_block){.number = 1, .kind = "", .name = "", .line = line};
    }
    at += strncmp(at, "\xef\xbb\xbf", 3) == 0 ? 3 : 0; /* the mark that some editors begin a file with */
    for (int number = 1; at; at = next, number++) {
        next = strchr(at, '\n');
        if (next) {
            *next++ = '\0';
        }
        while (is_blank(*at)) {
            at++;
        }
        int status = SPAR_OK;
        if (headings && *at == '[') {
            status = begin_block(text, at, number, line);
        } else if (*at && *at != '#') {
            status = text->n > 0 ? split_line(text, at, number, line, word, headings ? NULL : "a row")
                                 : case_fail(text, number, SPAR_ERR_ARGUMENT,
                                             "is before the first heading; begin with a heading, such as [beam wing]");
            word += line->n + 1;
            line++;
            text->block[text->n > 0 ? text->n - 1 : 0].n++;
        }
        if (status != SPAR_OK) {
            return status;
        }
    }
    return SPAR_OK;
}

int case_text_read(case_text *text, const char *path, int headings) {
    size_t words, lines;
    *text = (case_text){0};
    int status = read_bytes(text, path);
    if (status != SPAR_OK) {
        return status;
    }
    count_most(text->bytes, &words, &lines);
    text->word = calloc(words, sizeof *text->word);
    text->line = calloc(lines, sizeof *text->line);
    text->block = calloc(lines, sizeof *text->block);
    if (!text->word || !text->line || !text->block) {
        return case_fail(text, 0, SPAR_ERR_MEMORY, "no memory to read it");
    }
    return split_bytes(text, headings);
}

void case_text_free(case_text *text) {
    free(text->path);
    free(text->bytes);
    free(text->word);
    free(text->line);
    free(text->block);
    *text = (case_text){0};
}

char *case_beside(const case_text *text, const char *path) {
    const char *slash = path[0] == '/' ? NULL : strrchr(text->path, '/');
    size_t folder = slash ? (size_t)(slash - text->path) + 1 : 0, size = strlen(path) + 1;
    char *whole = malloc(folder + size);
    if (whole) {
        memcpy(whole, text->path, folder);
        memcpy(whole + folder, path, size);
    }
    return whole;
}

/* ---- lines and their values ---- */

const case_line *case_next(const case_block *block, const char *key, int64_t *from) {
    for (int64_t i = *from; i < block->n; i++) {
        if (strcmp(block->line[i].word[0], key) == 0) {
            *from = i + 1;
            return block->line + i;
        }
    }
    *from = block->n;
    return NULL;
}

const case_line *case_find(const case_block *block, const char *key) {
    int64_t from = 0;
    return case_next(block, key, &from);
}

int case_numbers(const case_text *text, const case_line *line, int first, int n, double *x) {
    for (int i = 0; i < n; i++) {
        if (first + i > line->n) {
            return case_fail(text, line->number, SPAR_ERR_ARGUMENT, "%s: %d numbers expected, %d found", line->label, n,
                             line->n + 1 - first);
        }
        char *word = line->word[first + i], *end;
        x[i] = strtod(word, &end);
        if (end == word || *end || !isfinite(x[i])) {
            return case_fail(text, line->number, SPAR_ERR_ARGUMENT,
                             "%s: '%.60s' is not a number; write it as 1, -0.5 or 2e-3", line->label, word);
        }
    }
    return SPAR_OK;
}

int case_whole(const case_text *text, const case_line *line, int i, int64_t low, int64_t high, int64_t *x) {
    double value = 0;
    int status = case_numbers(text, line, i, 1, &value);
    if (status == SPAR_OK && (value != floor(value) || value < (double)low || value > (double)high)) {
        return case_fail(text, line->number, SPAR_ERR_ARGUMENT, "%s: %s; give a whole number from %lld to %lld",
                         line->label, line->word[i], (long long)low, (long long)high);
    }
    *x = (int64_t)value;
    return status;
}

static int smaller(int a, int b) {
    return a < b ? a : b;
}

/* Levenshtein's */
int case_distance(const char *a, const char *b) {
    enum { LONGEST = 64 };
    int row[LONGEST + 1], m = smaller((int)strlen(b), LONGEST);
    for (int j = 0; j <= m; j++) {
        row[j] = j;
    }
    for (int i = 0; a[i] && i < LONGEST; i++) {
        int corner = row[0]++;
        for (int j = 0; j < m; j++) {
            int change = corner + (a[i] != b[j]);
            corner = row[j + 1];
            row[j + 1] = smaller(change, 1 + smaller(corner, row[j]));
        }
    }
    return row[m];
}

const char *case_nearest(const char *word, int64_t n, const char *const *names) {
    const char *best = "";
    for (int64_t i = 0, least = INT64_MAX; i < n; i++) {
        int64_t d = case_distance(word, names[i]);
        if (d < least) {
            least = d;
            best = names[i];
        }
    }
    return best;
}

int case_choice(const case_text *text, const case_line *line, int i, const char *const *choices, int *choice) {
    int n = 0;
    for (; choices[n]; n++) {
        if (strcmp(choices[n], line->word[i]) == 0) {
            *choice = n;
            return SPAR_OK;
        }
    }
    char all[400] = "";
    for (int k = 0; k < n; k++) {
        size_t used = strlen(all);
        (void)snprintf(all + used, sizeof all - used, "%s%s", k ? ", " : "", choices[k]);
    }
    return case_fail(text, line->number, SPAR_ERR_ARGUMENT, "%s: '%.60s' is not known; did you mean %s? (%s)",
                     line->label, line->word[i], case_nearest(line->word[i], n, choices), all);
}

void case_unfold(int form, const double *from, double matrix[36]) {
    for (int i = 0, k = 0; i < 6; i++) {
        for (int j = form == MATRIX ? 0 : i; j < 6; j++) {
            if (form == MATRIX) {
                matrix[6 * i + j] = from[k++];
            } else {
                matrix[6 * i + j] = matrix[6 * j + i] = form == TRIANGLE ? from[k++] : i == j ? from[i] : 0;
            }
        }
    }
}

int case_matrix(const case_text *text, const case_line *line, double matrix[36]) {
    double x[MATRIX];
    if (line->n != DIAGONAL && line->n != TRIANGLE && line->n != MATRIX) {
        return case_fail(text, line->number, SPAR_ERR_ARGUMENT,
                         "%s: a 6x6 matrix of %d numbers; give 6 (the diagonal), 21 (the upper triangle, row by row) "
                         "or 36",
                         line->label, line->n);
    }
    CASE_TRY(case_numbers(text, line, 1, line->n, x));
    case_unfold(line->n, x, matrix);
    return SPAR_OK;
}
