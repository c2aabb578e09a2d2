/* A file as 64-bit words: little-endian on disc, with a heading, a version and a checksum (CRC-64 of ECMA-182,
   reflected, as in xz). It is written beside its place under a temporary name, flushed to the disc and renamed, so that
   whatever happens there is a whole file, the old or the new one. */
#ifndef SPARI_IMAGE_H
#define SPARI_IMAGE_H

#include "file.h"

#include <stdint.h>

typedef struct spari_image {
    uint64_t *word;
    int64_t count, room;
    int64_t at;    /* reading: next word */
    int failed;    /* no memory to write, or nothing left to read */
    int no_memory; /* for what was read: failed, but by no fault of the file */
} spari_image;

void spari_image_free(spari_image *image);
/* Room for n words more, to be written at once; NULL: no memory. */
uint64_t *spari_image_add(spari_image *image, int64_t n);
void spari_image_put(spari_image *image, const void *words, int64_t n); /* words: doubles or 64-bit integers */
void spari_image_put_int(spari_image *image, int64_t value);
void spari_image_put_text(spari_image *image, const char *text);
/* The next n words where they are, or NULL (and failed). */
const uint64_t *spari_image_get(spari_image *image, int64_t n);
int64_t spari_image_get_int(spari_image *image);
/* Whether the next text is this one. */
int spari_image_is_text(spari_image *image, const char *text);

/* Words into the order of bytes that they have on disc, where they lie. */
void spari_words_to_disc(uint64_t *words, int64_t n);

/* Bytes into a check sum, which begins with 0; and the sum of two pieces, the second of n bytes behind the first. */
uint64_t spari_check_bytes(uint64_t sum, const void *data, size_t n);
uint64_t spari_check_join(uint64_t first, uint64_t second, uint64_t n);

/* What fails below answers SPAR_ERR_IO or SPAR_ERR_MEMORY with the reason in why[size]. */

/* A file of `count` words that is being written, by one process, in order; or parts of it by others, who write to its
   temporary file, file.temporary. */
typedef struct spari_saving {
    spari_file file;
    uint64_t sum; /* of what is there so far */
    int skipped;  /* some of it was written by others */
    int reason;   /* errno of the first write that failed */
} spari_saving;
int spari_saving_begin(spari_saving *saving, const char *path, int64_t count, char *why, size_t size);
/* words: in the order of bytes of the disc. What fails is told at the end. */
void spari_saving_put(spari_saving *saving, const uint64_t *words, int64_t n);
/* By a mark in the place of the check sum others know that the file they see is this one; 0: it could not be made. */
int spari_saving_mark(spari_saving *saving, int64_t count, uint64_t mark);
int spari_saving_is_marked(const char *temporary, int64_t count, uint64_t mark);
/* Of that file n words, which another process writes, in the order of bytes of the disc; and whether it has them, by
   their check sum. */
int spari_saving_put_part(const char *temporary, int64_t at, int64_t n, const uint64_t *words, char *why, size_t size);
int spari_saving_has_part(const char *temporary, int64_t at, int64_t n, uint64_t sum);
/* The next n words, of this check sum, others have written. */
void spari_saving_skip(spari_saving *saving, int64_t n, uint64_t sum);
/* The check sum, and the file is in its place; or nothing has changed. To give up: spari_file_drop. */
int spari_saving_end(spari_saving *saving, int64_t count, char *why, size_t size);

/* A file that is being read. */
typedef struct spari_loading {
    FILE *stream;
    char *path;
    int64_t count; /* words */
    uint64_t sum;  /* that it should have */
} spari_loading;
/* Its heading and length are right. */
int spari_loading_open(spari_loading *source, const char *path, char *why, size_t size);
void spari_loading_close(spari_loading *source);
int spari_loading_read(spari_loading *source, int64_t at, int64_t n, uint64_t *words, char *why, size_t size);
/* The check sum of one of so many parts of all n bytes before it. */
int spari_loading_sum(spari_loading *source, int part, int parts, uint64_t *sum, uint64_t *n, char *why, size_t size);
int spari_loading_refuse(const char *path, char *why, size_t size); /* its check sum is wrong */

#endif
