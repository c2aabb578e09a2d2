/* The words of a saved session in memory, written to a file and read from it with a check sum. */
#include "image.h"

#include "../base/file.h"
#include "status.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { VERSION = 6, HEAD_BYTES = 24, CHECK_BYTES = 8 };

static const char magic[8] = {'s', 'p', 'a', 'r', '-', 'r', 'u', 'n'};

/* ---- words ---- */

void spari_image_free(spari_image *image) {
    free(image->word);
    *image = (spari_image){0};
}

void spari_image_put(spari_image *image, const void *words, int64_t n) {
    if (image->count + n > image->room) {
        int64_t room = 2 * (image->count + n);
        uint64_t *more = realloc(image->word, (size_t)room * sizeof *more);
        if (!more) {
            image->failed = 1;
            return;
        }
        image->word = more;
        image->room = room;
    }
    if (n > 0) {
        memcpy(image->word + image->count, words, (size_t)n * sizeof *image->word);
    }
    image->count += n;
}

void spari_image_put_int(spari_image *image, int64_t value) {
    spari_image_put(image, &value, 1);
}

void spari_image_put_text(spari_image *image, const char *text) {
    int64_t length = (int64_t)strlen(text);
    spari_image_put_int(image, length);
    for (int64_t i = 0; i < length; i += 8) {
        uint64_t word = 0;
        memcpy(&word, text + i, (size_t)(length - i < 8 ? length - i : 8));
        spari_image_put(image, &word, 1);
    }
}

const uint64_t *spari_image_get(spari_image *image, int64_t n) {
    if (n < 0 || n > image->count - image->at) {
        image->failed = 1;
        return NULL;
    }
    image->at += n;
    return image->word + image->at - n;
}

int64_t spari_image_get_int(spari_image *image) {
    const uint64_t *word = spari_image_get(image, 1);
    int64_t value = 0;
    if (word) {
        memcpy(&value, word, sizeof value);
    }
    return value;
}

int spari_image_is_text(spari_image *image, const char *text) {
    int64_t length = spari_image_get_int(image);
    const uint64_t *word = spari_image_get(image, length < 0 || length > INT64_MAX - 7 ? -1 : (length + 7) / 8);
    return word && length == (int64_t)strlen(text) && memcmp(word, text, (size_t)length) == 0;
}

/* ---- bytes ---- */

static void put_word(unsigned char *to, uint64_t word) {
    for (int i = 0; i < 8; i++) {
        to[i] = (unsigned char)(word >> (8 * i));
    }
}

static uint64_t get_word(const unsigned char *from) {
    uint64_t word = 0;
    for (int i = 0; i < 8; i++) {
        word |= (uint64_t)from[i] << (8 * i);
    }
    return word;
}

static uint64_t crc64(const unsigned char *data, size_t n) {
    uint64_t table[256], crc = ~UINT64_C(0);
    for (uint64_t i = 0; i < 256; i++) {
        uint64_t c = i;
        for (int k = 0; k < 8; k++) {
            c = (c >> 1) ^ (c & 1 ? UINT64_C(0xC96C5795D7870F42) : 0);
        }
        table[i] = c;
    }
    for (size_t i = 0; i < n; i++) {
        crc = (crc >> 8) ^ table[(crc ^ data[i]) & 0xff];
    }
    return ~crc;
}

/* ---- files ---- */

static int io_failure(char *why, size_t size, const char *what, const char *path) {
    int reason = errno;
    (void)snprintf(why, size, "%s '%s': %s", what, path, reason == ENOMEM ? "no memory" : strerror(reason));
    return reason == ENOMEM ? SPAR_ERR_MEMORY : SPAR_ERR_IO;
}

int spari_image_write(const spari_image *image, const char *path, char *why, size_t size) {
    size_t n = HEAD_BYTES + 8 * (size_t)image->count;
    unsigned char *bytes = malloc(n + CHECK_BYTES);
    spari_file file;
    if (!bytes) {
        (void)snprintf(why, size, "no memory for what goes into '%s'", path);
        return SPAR_ERR_MEMORY;
    }
    memcpy(bytes, magic, sizeof magic);
    put_word(bytes + 8, VERSION);
    put_word(bytes + 16, (uint64_t)image->count);
    for (int64_t i = 0; i < image->count; i++) {
        put_word(bytes + HEAD_BYTES + 8 * i, image->word[i]);
    }
    put_word(bytes + n, crc64(bytes, n));
    int status = spari_file_begin(&file, path, ".new", why, size);
    if (status == SPAR_OK) {
        (void)fwrite(bytes, 1, n + CHECK_BYTES, file.stream); /* how that went is asked at the end */
        status = spari_file_end(&file, 1, why, size);
    }
    free(bytes);
    return status;
}

/* got: of the head, so many bytes; n: of the file. */
static int check_head(const char *path, const unsigned char *head, size_t got, uint64_t n, char *why, size_t size) {
    uint64_t words = got == HEAD_BYTES ? get_word(head + 16) : 0;
    if (got < sizeof magic || memcmp(head, magic, sizeof magic) != 0) {
        (void)snprintf(why, size, "'%s' is no saved session", path);
    } else if (got < HEAD_BYTES || n < HEAD_BYTES + CHECK_BYTES) {
        (void)snprintf(why, size, "'%s' is cut off after %llu bytes; take an older file", path, (unsigned long long)n);
    } else if (get_word(head + 8) != VERSION) {
        (void)snprintf(
            why, size,
            "'%s' has version %llu of the format, this library reads %d; load it with the spar that wrote it", path,
            (unsigned long long)get_word(head + 8), VERSION);
    } else if (words != (n - HEAD_BYTES - CHECK_BYTES) / 8 || n % 8 != 0) {
        (void)snprintf(why, size,
                       "'%s' is cut off or has grown: it has %llu bytes and should have %llu; take an older file", path,
                       (unsigned long long)n, (unsigned long long)(HEAD_BYTES + CHECK_BYTES + 8 * words));
    } else {
        return SPAR_OK;
    }
    return SPAR_ERR_IO;
}

/* How many bytes the file has. What is none could go on for ever, or wait. */
static int measure_file(FILE *f, const char *path, uint64_t *n, char *why, size_t size) {
    struct stat there;
    if (fstat(fileno(f), &there) != 0) {
        return io_failure(why, size, "cannot read", path);
    }
    const char *kind = spari_file_kind(there.st_mode);
    if (kind) {
        (void)snprintf(why, size, "cannot read '%s': it is %s; name a file", path, kind);
        return SPAR_ERR_IO;
    }
    *n = (uint64_t)there.st_size;
    return SPAR_OK;
}

/* All of a file in memory, whose heading must be right and fit its size; n: its size. */
static int slurp(FILE *f, const char *path, unsigned char **bytes, size_t *n, char *why, size_t size) {
    unsigned char head[HEAD_BYTES];
    uint64_t there = 0;
    SPARI_TRY(measure_file(f, path, &there, why, size));
    size_t got = fread(head, 1, sizeof head, f);
    if (ferror(f)) {
        return io_failure(why, size, "cannot read", path);
    }
    SPARI_TRY(check_head(path, head, got, there, why, size));
    *n = (size_t)there;
    *bytes = malloc(*n);
    if (!*bytes) {
        (void)snprintf(why, size, "no memory to read '%s'", path);
        return SPAR_ERR_MEMORY;
    }
    memcpy(*bytes, head, sizeof head);
    got = fread(*bytes + sizeof head, 1, *n - sizeof head, f);
    if (got != *n - sizeof head) {
        errno = ferror(f) ? errno : EIO; /* it has become shorter meanwhile */
        return io_failure(why, size, "cannot read", path);
    }
    if (get_word(*bytes + *n - CHECK_BYTES) != crc64(*bytes, *n - CHECK_BYTES)) {
        (void)snprintf(why, size, "'%s' is damaged (its checksum is wrong); take an older file", path);
        return SPAR_ERR_IO;
    }
    return SPAR_OK;
}

int spari_image_read(spari_image *image, const char *path, char *why, size_t size) {
    unsigned char *bytes = NULL;
    size_t n = 0;
    *image = (spari_image){0};
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC); /* a pipe would wait for somebody to write */
    FILE *f = fd >= 0 ? fdopen(fd, "rb") : NULL;
    if (!f) {
        int status = io_failure(why, size, "cannot read", path);
        (void)(fd >= 0 && close(fd));
        return status;
    }
    int status = slurp(f, path, &bytes, &n, why, size);
    if (status == SPAR_OK) {
        image->room = image->count = (int64_t)get_word(bytes + 16);
        image->word = spari_zalloc(image->count, sizeof *image->word);
        for (int64_t i = 0; image->word && i < image->count; i++) {
            image->word[i] = get_word(bytes + HEAD_BYTES + 8 * i);
        }
        if (!image->word) {
            (void)snprintf(why, size, "no memory to read '%s'", path);
            status = SPAR_ERR_MEMORY;
        }
    }
    (void)fclose(f);
    free(bytes);
    return status;
}
