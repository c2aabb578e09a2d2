/* A file of 64-bit words, little-endian on disc, with heading, version and check sum (CRC-64 of ECMA-182, reflected,
   as in xz). It is written under a temporary name, synchronised and renamed, so that the old or the new file is
   always whole. */
#ifndef SPARI_SAVED_FILE_H
#define SPARI_SAVED_FILE_H

#include "file.h"

#include <stdint.h>

typedef struct spari_image {
    uint64_t *word;
    int64_t count, capacity;
    int64_t at;    /* next word to read */
    int failed;    /* no memory to write, or no words left to read */
    int no_memory; /* reading failed for lack of memory; the file is not at fault */
} spari_image;

void spari_image_free(spari_image *image);
/* Makes room for n words, to be written at once. NULL: no memory. */
uint64_t *spari_image_add(spari_image *image, int64_t n);
void spari_image_put(spari_image *image, const void *words, int64_t n); /* words: doubles or 64-bit integers */
void spari_image_put_int(spari_image *image, int64_t value);
void spari_image_put_text(spari_image *image, const char *text);
/* The next n words in place, or NULL (sets failed). */
const uint64_t *spari_image_get(spari_image *image, int64_t n);
int64_t spari_image_get_int(spari_image *image);
/* Whether the next text equals `text`. */
int spari_image_is_text(spari_image *image, const char *text);

/* The calls below return SPAR_ERR_IO or SPAR_ERR_MEMORY with the reason in why[size]. */

/* A file of `count` words that is being written. */
typedef struct spari_saving {
    spari_file file;
    uint64_t sum; /* of the bytes so far */
    int reason;   /* errno of the first write that failed */
} spari_saving;
int spari_saving_begin(spari_saving *saving, const char *path, int64_t count, char *why, size_t size);
/* Words are converted in place to the byte order of the file. Write errors are reported at the end. */
void spari_saving_put(spari_saving *saving, uint64_t *words, int64_t n);
/* Writes the check sum and moves the file to its final path. After a failure nothing has changed. To give up, call
   spari_file_drop. */
int spari_saving_end(spari_saving *saving, char *why, size_t size);

/* A file that is being read. */
typedef struct spari_loading {
    FILE *stream;
    char *path;
    int64_t count; /* words */
    uint64_t sum;  /* expected check sum */
} spari_loading;
/* Opens the file and checks its heading and length. */
int spari_loading_open(spari_loading *source, const char *path, char *why, size_t size);
void spari_loading_close(spari_loading *source);
int spari_loading_read(spari_loading *source, int64_t at, int64_t n, uint64_t *words, char *why, size_t size);
/* Whether the check sum is right. */
int spari_loading_check(spari_loading *source, char *why, size_t size);

#endif
