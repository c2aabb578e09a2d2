/* A file as 64-bit words: little-endian on disc, with a heading, a version and a checksum (CRC-64 of ECMA-182,
   reflected, as in xz). It is written beside its place under a temporary name, flushed to the disc and renamed, so that
   whatever happens there is a whole file, the old or the new one. */
#ifndef SPARI_IMAGE_H
#define SPARI_IMAGE_H

#include <stddef.h>
#include <stdint.h>

typedef struct spari_image {
    uint64_t *word;
    int64_t count, room;
    int64_t at;    /* reading: next word */
    int failed;    /* no memory to write, or nothing left to read */
    int no_memory; /* for what was read: failed, but by no fault of the file */
} spari_image;

void spari_image_free(spari_image *image);
void spari_image_put(spari_image *image, const void *words, int64_t n); /* words: doubles or 64-bit integers */
void spari_image_put_int(spari_image *image, int64_t value);
void spari_image_put_text(spari_image *image, const char *text);
/* The next n words where they are, or NULL (and failed). */
const uint64_t *spari_image_get(spari_image *image, int64_t n);
int64_t spari_image_get_int(spari_image *image);
/* Whether the next text is this one. */
int spari_image_is_text(spari_image *image, const char *text);

/* Return SPAR_OK, or SPAR_ERR_IO, SPAR_ERR_MEMORY with the reason in why[size]. */
int spari_image_write(const spari_image *image, const char *path, char *why, size_t size);
int spari_image_read(spari_image *image, const char *path, char *why, size_t size);

#endif
