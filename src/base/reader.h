/* Reads input files of other codes: lines of numbers and words, and keys after their values. Messages name file,
   line and field. */
#ifndef SPARI_READER_H
#define SPARI_READER_H

#include "status.h"

#include <stdio.h>

enum { SPARI_READ_LINE = 4096, SPARI_READ_MOST = 1000000 };

/* Reports a failure: spari_fail in libspar, spari_aero_fail in libspar_aero. */
typedef int (*spari_read_report)(const spar_session *session, int status, const char *format, ...) SPARI_PRINTF(3, 4);

typedef struct spari_reader {
    spari_read_report fail;
    const spar_session *session; /* for messages; may be NULL */
    const char *call, *subject;  /* public call, and the object it reads for */
    const char *path;
    FILE *file;
    int number; /* number of the line read last */
    int again;  /* it is to be read again */
    char line[SPARI_READ_LINE],
        word[SPARI_READ_LINE]; /* a word of the line; here because it is large for a small stack */
} spari_reader;

/* Reports an error in the line read last. */
#define SPARI_READ_FAIL(r, status, format, ...)                                                                        \
    (r)->fail((r)->session, status, "%s: '%s': %s, line %d: " format, (r)->call, (r)->subject, (r)->path, (r)->number, \
              __VA_ARGS__)
int spari_read_no_memory(const spari_reader *r);

/* Opens the file. The caller closes it with fclose(r->file). */
int spari_read_open(spari_reader *r, const char *path);
/* Reads the next line; LF, CR LF and CR end one. If there is none, the message says that `what` is missing. */
int spari_read_line(spari_reader *r, const char *what);
/* Reads the next line that is not blank. */
int spari_read_filled(spari_reader *r, const char *what);
/* Reads on to the line whose second word is `key`, ignoring case. */
int spari_read_key(spari_reader *r, const char *key);

/* Copies the next word from *at on; quotes enclose one word. Returns 0 at the end of the line. */
int spari_read_word(const char **at, char word[SPARI_READ_LINE]);
/* Reads the first n numbers of the line; Fortran's d exponents are allowed. `what` names the fields in messages. */
int spari_read_numbers(spari_reader *r, const char *what, int n, double *x);
/* Checks that the next line that is not blank is no further row of n numbers: `count`, which says `rows`, is too small
   if it is. The line is read again; the file may end before it. */
int spari_read_last(spari_reader *r, const char *count, int rows, int n);
/* Reads the integer in a column (from 0) of the line; it must lie between low and SPARI_READ_MOST. */
int spari_read_whole(spari_reader *r, const char *what, int low, int column, int *out);

/* A path named in the file, relative to that file unless absolute. Free it with free(). NULL: no memory. */
char *spari_read_beside(const spari_reader *r, const char *path);

#endif
