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
    r->number = 0;
    r->file = fopen(path, "r");
    if (!r->file) {
        int reason = errno;
        return r->fail(r->session, reason == ENOMEM ? SPAR_ERR_MEMORY : SPAR_ERR_IO, "%s: '%s': cannot open %s: %s",
                       r->call, r->subject, path, reason == ENOMEM ? "no memory" : strerror(reason));
    }
    return SPAR_OK;
}

int spari_read_line(spari_reader *r, const char *what) {
    if (!fgets(r->line, sizeof r->line, r->file)) {
        if (ferror(r->file)) {
            return r->fail(r->session, SPAR_ERR_IO, "%s: '%s': reading %s failed after line %d: %s", r->call,
                           r->subject, r->path, r->number, strerror(errno));
        }
        return r->fail(r->session, SPAR_ERR_IO, "%s: '%s': %s ends at line %d; %s is missing", r->call, r->subject,
                       r->path, r->number, what);
    }
    r->number++;
    if (!strchr(r->line, '\n') && !feof(r->file)) {
        return r->fail(r->session, SPAR_ERR_IO, "%s: '%s': %s, line %d has more than %d characters", r->call,
                       r->subject, r->path, r->number, SPARI_READ_LINE - 2);
    }
    return SPAR_OK;
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

int spari_read_numbers(spari_reader *r, const char *what, int n, double *x) {
    const char *at = r->line;
    char *word = r->word;
    for (int i = 0; i < n; i++) {
        if (!spari_read_word(&at, word)) {
            return SPARI_READ_FAIL(r, SPAR_ERR_IO, "%s: number %d of %d is missing", what, i + 1, n);
        }
        for (char *c = word; *c; c++) {
            *c = *c == 'd' || *c == 'D' ? 'e' : *c;
        }
        char *end;
        x[i] = strtod(word, &end);
        if (end == word || *end || !isfinite(x[i])) {
            return SPARI_READ_FAIL(r, SPAR_ERR_IO, "%s: '%s' (number %d of %d) is not a number", what, word, i + 1, n);
        }
    }
    return SPAR_OK;
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
