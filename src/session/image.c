#include "image.h"

#include "status.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { VERSION = 1, HEAD_BYTES = 24, CHECK_BYTES = 8 };

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

static void put_bytes(unsigned char *to, uint64_t word) {
    for (int i = 0; i < 8; i++) {
        to[i] = (unsigned char)(word >> (8 * i));
    }
}

static uint64_t get_bytes(const unsigned char *from) {
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
    (void)snprintf(why, size, "%s '%s': %s", what, path, strerror(errno));
    return SPAR_ERR_IO;
}

/* The name of a file is safe when its folder is on the disc. Where folders cannot be opened that is left to the system.
 */
static void sync_folder(const char *path) {
    char folder[4096] = ".";
    const char *slash = strrchr(path, '/');
    if (slash && (size_t)(slash - path) + 1 < sizeof folder) {
        memcpy(folder, path, (size_t)(slash - path) + 1);
        folder[slash - path + 1] = '\0';
    }
    int fd = open(folder, O_RDONLY);
    if (fd >= 0) {
        (void)fsync(fd);
        (void)close(fd);
    }
}

static int write_bytes(const char *temporary, const char *path, const unsigned char *bytes, size_t n, char *why,
                       size_t size) {
    FILE *f = fopen(temporary, "wb");
    if (!f) {
        return io_failure(why, size, "cannot write", temporary);
    }
    int ok = fwrite(bytes, 1, n, f) == n && fflush(f) == 0 && fsync(fileno(f)) == 0;
    int reason = errno;
    if (fclose(f) != 0 && ok) {
        ok = 0;
        reason = errno;
    }
    if (ok && rename(temporary, path) == 0) {
        sync_folder(path);
        return SPAR_OK;
    }
    errno = ok ? errno : reason;
    int status = io_failure(why, size, ok ? "cannot rename to" : "cannot write", ok ? path : temporary);
    (void)remove(temporary);
    return status;
}

int spari_image_write(const spari_image *image, const char *path, char *why, size_t size) {
    size_t n = HEAD_BYTES + 8 * (size_t)image->count, length = strlen(path);
    unsigned char *bytes = malloc(n + CHECK_BYTES);
    char *temporary = malloc(length + 5);
    int status = SPAR_ERR_MEMORY;
    if (bytes && temporary) {
        memcpy(bytes, magic, sizeof magic);
        put_bytes(bytes + 8, VERSION);
        put_bytes(bytes + 16, (uint64_t)image->count);
        for (int64_t i = 0; i < image->count; i++) {
            put_bytes(bytes + HEAD_BYTES + 8 * i, image->word[i]);
        }
        put_bytes(bytes + n, crc64(bytes, n));
        memcpy(temporary, path, length);
        memcpy(temporary + length, ".new", 5);
        status = write_bytes(temporary, path, bytes, n + CHECK_BYTES, why, size);
    } else {
        (void)snprintf(why, size, "no memory for what goes into '%s'", path);
    }
    free(bytes);
    free(temporary);
    return status;
}

/* All of a file in memory; n: its size. */
static int slurp(const char *path, unsigned char **bytes, size_t *n, char *why, size_t size) {
    FILE *f = fopen(path, "rb");
    if (!f) {
        return io_failure(why, size, "cannot read", path);
    }
    size_t room = 1 << 16;
    int status = SPAR_OK;
    *n = 0;
    *bytes = malloc(room);
    while (*bytes) {
        size_t got = fread(*bytes + *n, 1, room - *n, f);
        *n += got;
        if (*n < room) {
            status = ferror(f) ? io_failure(why, size, "cannot read", path) : SPAR_OK;
            break;
        }
        unsigned char *more = realloc(*bytes, 2 * room);
        if (!more) {
            free(*bytes);
        }
        *bytes = more;
        room *= 2;
    }
    if (!*bytes) {
        (void)snprintf(why, size, "no memory to read '%s'", path);
        status = SPAR_ERR_MEMORY;
    }
    (void)fclose(f);
    return status;
}

/* What is wrong with the bytes of a file, or NULL. */
static int check_bytes(const char *path, const unsigned char *bytes, size_t n, char *why, size_t size) {
    uint64_t words = n >= HEAD_BYTES ? get_bytes(bytes + 16) : 0;
    if (n < sizeof magic || memcmp(bytes, magic, sizeof magic) != 0) {
        (void)snprintf(why, size, "'%s' is no saved session", path);
    } else if (n < HEAD_BYTES + CHECK_BYTES) {
        (void)snprintf(why, size, "'%s' is cut off after %zu bytes; take an older file", path, n);
    } else if (get_bytes(bytes + 8) != VERSION) {
        (void)snprintf(
            why, size,
            "'%s' has version %llu of the format, this library reads %d; load it with the spar that wrote it", path,
            (unsigned long long)get_bytes(bytes + 8), VERSION);
    } else if (words != (n - HEAD_BYTES - CHECK_BYTES) / 8 || (n - HEAD_BYTES) % 8 != 0) {
        (void)snprintf(why, size,
                       "'%s' is cut off or has grown: it has %zu bytes and should have %llu; take an older file", path,
                       n, (unsigned long long)(HEAD_BYTES + CHECK_BYTES + 8 * words));
    } else if (get_bytes(bytes + n - CHECK_BYTES) != crc64(bytes, n - CHECK_BYTES)) {
        (void)snprintf(why, size, "'%s' is damaged (its checksum is wrong); take an older file", path);
    } else {
        return SPAR_OK;
    }
    return SPAR_ERR_IO;
}

int spari_image_read(spari_image *image, const char *path, char *why, size_t size) {
    unsigned char *bytes = NULL;
    size_t n = 0;
    *image = (spari_image){0};
    int status = slurp(path, &bytes, &n, why, size);
    if (status == SPAR_OK) {
        status = check_bytes(path, bytes, n, why, size);
    }
    if (status == SPAR_OK) {
        image->room = image->count = (int64_t)get_bytes(bytes + 16);
        image->word = spari_zalloc(image->count, sizeof *image->word);
        for (int64_t i = 0; image->word && i < image->count; i++) {
            image->word[i] = get_bytes(bytes + HEAD_BYTES + 8 * i);
        }
        if (!image->word) {
            (void)snprintf(why, size, "no memory to read '%s'", path);
            status = SPAR_ERR_MEMORY;
        }
    }
    free(bytes);
    return status;
}
