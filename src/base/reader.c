/* Reads input files of other codes line by line: see reader.h. Also compiled into libspar_aero. */
#include "reader.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

int spari_read_no_memory(const spari_reader *r) {
    return r->fail(r->session, SPAR_ERR_MEMORY, "%s: '%s': no memory for %s", r->call, r->subject, r->path);
}

int spari_read_open(spari_reader *r, const char *path) {
    r->path = path;
    r->number = r->again = 0;
    r->file = fopen(path, "r");
    if (!r->file) {
        int reason = errno;
        return r->fail(r->session, reason == ENOMEM ? SPAR_ERR_MEMORY : SPAR_ERR_IO, "%s: '%s': cannot open %s: %s",
                       r->call, r->subject, path, reason == ENOMEM ? "no memory" : strerror(reason));
    }
    return SPAR_OK;
}

/* Reads a line without its end, which is LF, CR LF or CR. *end: nothing was left to read. */
static int next_line(spari_reader *r, int *end) {
    size_t n = 0;
    *end = 0;
    if (r->again) {
        r->again = 0;
        return SPAR_OK;
    }
    int c = getc(r->file);
    *end = c == EOF;
    r->number += !*end;
    while (c != EOF && c != '\n' && c != '\r' && c != '\0' && n < sizeof r->line - 1) {
        r->line[n++] = (char)c;
        c = getc(r->file);
    }
    r->line[n] = '\0';
    if (ferror(r->file)) {
        return r->fail(r->session, SPAR_ERR_IO, "%s: '%s': reading %s failed after line %d: %s", r->call, r->subject,
                       r->path, r->number, strerror(errno));
    }
    if (c == '\0' ||
        (r->number == 1 && (strncmp(r->line, "\xff\xfe", 2) == 0 || strncmp(r->line, "\xfe\xff", 2) == 0))) {
        return SPARI_READ_FAIL(
            r, SPAR_ERR_IO, "%s",
            "the file is UTF-16 or no text (it has a byte 0 or begins with a mark of UTF-16); save it "
            "as UTF-8");
    }
    if (c != EOF && c != '\n' && c != '\r') {
        return SPARI_READ_FAIL(r, SPAR_ERR_IO, "has more than %d characters", SPARI_READ_LINE - 1);
    }
    if (c == '\r' && (c = getc(r->file)) != '\n') {
        (void)ungetc(c, r->file);
    }
    return SPAR_OK;
}

/* The first line: skips the mark of UTF-8, and knows a file that Git has not fetched. */
static int check_first_line(spari_reader *r) {
    static const char mark[] = "\xef\xbb\xbf", pointer[] = "version https://git-lfs.github.com/spec/";
    if (strncmp(r->line, mark, sizeof mark - 1) == 0) {
        memmove(r->line, r->line + sizeof mark - 1, strlen(r->line + sizeof mark - 1) + 1);
    }
    return strncmp(r->line, pointer, sizeof pointer - 1) == 0
               ? SPARI_READ_FAIL(r, SPAR_ERR_IO, "%s",
                                 "this is a Git LFS pointer in place of the file; fetch the file with git lfs pull")
               : SPAR_OK;
}

int spari_read_line(spari_reader *r, const char *what) {
    int end;
    SPARI_TRY(next_line(r, &end));
    if (end) {
        return r->fail(r->session, SPAR_ERR_IO, "%s: '%s': %s ends at line %d; %s is missing", r->call, r->subject,
                       r->path, r->number, what);
    }
    return r->number == 1 ? check_first_line(r) : SPAR_OK;
}

static int is_gap(char c) {
    return isspace((unsigned char)c) || c == ',';
}

int spari_read_word(const char **at, char word[SPARI_READ_LINE]) {
    const char *c = *at;
    size_t n = 0;
    while (is_gap(*c)) {
        c++;
    }
    if (*c == '"' || *c == '\'') {
        char quote = *c++;
        while (*c && *c != quote && *c != '\n') {
            word[n++] = *c++;
        }
        c += *c == quote;
    } else {
        while (*c && !is_gap(*c)) {
            word[n++] = *c++;
        }
    }
    word[n] = 0;
    int any = c != *at && (n > 0 || c[-1] == '"' || c[-1] == '\'');
    *at = c;
    return any;
}

/* Whether a word is a finite number; Fortran's d exponents become e. */
static int is_number(char *word, double *x) {
    for (char *c = word; *c; c++) {
        *c = *c == 'd' || *c == 'D' ? 'e' : *c;
    }
    char *end;
    *x = strtod(word, &end);
    return end != word && !*end && isfinite(*x);
}

int spari_read_numbers(spari_reader *r, const char *what, int n, double *x) {
    const char *at = r->line;
    for (int i = 0; i < n; i++) {
        if (!spari_read_word(&at, r->word)) {
            return SPARI_READ_FAIL(r, SPAR_ERR_IO, "%s: number %d of %d is missing", what, i + 1, n);
        }
        if (!is_number(r->word, x + i)) {
            return SPARI_READ_FAIL(r, SPAR_ERR_IO, "%s: '%s' (number %d of %d) is not a number", what, r->word, i + 1,
                                   n);
        }
    }
    return SPAR_OK;
}

int spari_read_last(spari_reader *r, const char *count, int rows, int n) {
    const char *at;
    int end = 0, found = 0;
    double x;
    do {
        SPARI_TRY(next_line(r, &end));
        at = r->line;
    } while (!end && !spari_read_word(&at, r->word));
    r->again = !end;
    at = r->line;
    while (found < n && spari_read_word(&at, r->word) && is_number(r->word, &x)) {
        found++;
    }
    return found < n
               ? SPAR_OK
               : SPARI_READ_FAIL(r, SPAR_ERR_IO, "a row follows the last one; %s is %d: correct it, or remove the rows",
                                 count, rows);
}

int spari_read_whole(spari_reader *r, const char *what, int low, int column, int *out) {
    enum { MOST_COLUMNS = 8 };
    double x[MOST_COLUMNS] = {0};
    SPARI_TRY(spari_read_numbers(r, what, column + 1, x));
    if (!(x[column] >= low && x[column] <= SPARI_READ_MOST) || x[column] != floor(x[column])) {
        return SPARI_READ_FAIL(r, SPAR_ERR_IO, "%s is %g; give a whole number of at least %d", what, x[column], low);
    }
    *out = (int)x[column];
    return SPAR_OK;
}

int spari_read_key(spari_reader *r, const char *key) {
    for (;;) {
        SPARI_TRY(spari_read_line(r, key));
        const char *at = r->line;
        if (spari_read_word(&at, r->word) && spari_read_word(&at, r->word) && strcasecmp(r->word, key) == 0) {
            return SPAR_OK;
        }
    }
}

int spari_read_filled(spari_reader *r, const char *what) {
    const char *at;
    do {
        SPARI_TRY(spari_read_line(r, what));
        at = r->line;
    } while (!spari_read_word(&at, r->word));
    return SPAR_OK;
}

char *spari_read_beside(const spari_reader *r, const char *path) {
    const char *slash = path[0] == '/' ? NULL : strrchr(r->path, '/');
    size_t folder = slash ? (size_t)(slash - r->path) + 1 : 0, size = strlen(path) + 1;
    char *whole = spari_zalloc((int64_t)(folder + size), 1);
    if (whole) {
        memcpy(whole, r->path, folder);
        memcpy(whole + folder, path, size);
    }
    return whole;
}
