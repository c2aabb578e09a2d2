/* Text files of other codes: lines of numbers and words, keys behind their values, and messages that name file, line
   and field. */
#ifndef SPARI_READER_H
#define SPARI_READER_H

#include "message.h"

#include <stdio.h>

enum { SPARI_READ_LINE = 4096, SPARI_READ_MOST = 1000000 };

typedef struct spari_reader {
    const spar_session *session; /* for messages; NULL: none */
    const char *call, *subject;  /* the public call, and what it reads for */
    const char *path;
    FILE *file;
    int number;                                        /* of the line read last */
    char line[SPARI_READ_LINE], word[SPARI_READ_LINE]; /* room for a word of it: much for a small stack */
} spari_reader;

/* A failure in the line read last. */
#define SPARI_READ_FAIL(r, status, format, ...)                                                                        \
    spari_fail((r)->session, status, "%s: '%s': %s, line %d: " format, (r)->call, (r)->subject, (r)->path,             \
               (r)->number, __VA_ARGS__)
int spari_read_no_memory(const spari_reader *r);

/* To be closed with fclose(r->file) where it was opened. */
int spari_read_open(spari_reader *r, const char *path);
/* The next line; `what` is missed if there is none. */
int spari_read_line(spari_reader *r, const char *what);
/* The next one that has a word. */
int spari_read_filled(spari_reader *r, const char *what);
/* On to the line whose second word is the key, in letters of either case. */
int spari_read_key(spari_reader *r, const char *key);

/* The next word from *at on (quotes hold it together), into word; 0 at the end of the line. */
int spari_read_word(const char **at, char word[SPARI_READ_LINE]);
/* The first n numbers of the line; Fortran's d exponents too. `what` names the fields, the column says which. */
int spari_read_numbers(spari_reader *r, const char *what, int n, double *x);
/* The number in a column, from 0, of the line: whole, from low to SPARI_READ_MOST. */
int spari_read_whole(spari_reader *r, const char *what, int low, int column, int *out);

/* A path that the file names: beside it, unless it is a whole one. malloc'd; NULL: no memory. */
char *spari_read_beside(const spari_reader *r, const char *path);

#endif
