/* Words of a saved session: in memory, and in a file with a check sum. See saved_file.h. */
#include "saved_file.h"

#include "status.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A file is the heading, the words, and their check sum, which is of all before it. */
enum { VERSION = 33, HEAD_WORDS = 3, HEAD_BYTES = 8 * HEAD_WORDS, CHECK_BYTES = 8 };

static const char magic[8] = {'s', 'p', 'a', 'r', '-', 'r', 'u', 'n'};

/* ---- words ---- */

void spari_image_free(spari_image *image) {
    free(image->word);
    *image = (spari_image){0};
}

uint64_t *spari_image_add(spari_image *image, int64_t n) {
    if (image->count + n > image->capacity) {
        int64_t capacity = image->count + n, more_capacity = capacity + capacity / 4;
        uint64_t *more = realloc(image->word, (size_t)more_capacity * sizeof *more);
        if (!more) {
            image->failed = 1;
            return NULL;
        }
        image->word = more;
        image->capacity = more_capacity;
    }
    image->count += n;
    return image->word + image->count - n;
}

void spari_image_put(spari_image *image, const void *words, int64_t n) {
    uint64_t *to = n > 0 ? spari_image_add(image, n) : NULL;
    if (to) {
        memcpy(to, words, (size_t)n * sizeof *to);
    }
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

/* ---- the check sum ---- */

static const uint64_t crc_polynomial = UINT64_C(0xC96C5795D7870F42); /* reflected: the highest bit is x^0 */

/* Check sum of further bytes; it begins with 0. */
static uint64_t check_bytes(uint64_t sum, const void *data, size_t n) {
    const unsigned char *byte = data;
    uint64_t table[256], crc = ~sum;
    for (uint64_t i = 0; i < 256; i++) {
        uint64_t c = i;
        for (int k = 0; k < 8; k++) {
            c = (c >> 1) ^ (c & 1 ? crc_polynomial : 0);
        }
        table[i] = c;
    }
    for (size_t i = 0; i < n; i++) {
        crc = (crc >> 8) ^ table[(crc ^ byte[i]) & 0xff];
    }
    return ~crc;
}

/* ---- files ---- */

static int io_failure(char *why, size_t size, const char *what, const char *path) {
    int reason = errno;
    (void)snprintf(why, size, "%s '%s': %s", what, path, reason == ENOMEM ? "no memory" : strerror(reason));
    return reason == ENOMEM ? SPAR_ERR_MEMORY : SPAR_ERR_IO;
}

/* ---- writing ---- */

static void put_summed(spari_saving *saving, const void *bytes, size_t n) {
    if (fwrite(bytes, 1, n, saving->file.stream) != n && saving->reason == 0) { /* reported at the end */
        saving->reason = errno ? errno : EIO;
    }
    saving->sum = check_bytes(saving->sum, bytes, n);
}

int spari_saving_begin(spari_saving *saving, const char *path, int64_t count, char *why, size_t size) {
    unsigned char head[HEAD_BYTES];
    *saving = (spari_saving){.sum = 0};
    SPARI_TRY(spari_file_begin(&saving->file, path, ".new", why, size));
    memcpy(head, magic, sizeof magic);
    put_word(head + 8, VERSION);
    put_word(head + 16, (uint64_t)count);
    put_summed(saving, head, sizeof head);
    return SPAR_OK;
}

void spari_saving_put(spari_saving *saving, uint64_t *words, int64_t n) {
    for (int64_t i = 0; i < n; i++) {
        put_word((unsigned char *)(words + i), words[i]);
    }
    if (n > 0) { /* a session without members has no states: NULL */
        put_summed(saving, words, 8 * (size_t)n);
    }
}

static int64_t offset_of_word(int64_t word) {
    return HEAD_BYTES + 8 * word;
}

int spari_saving_end(spari_saving *saving, char *why, size_t size) {
    unsigned char bytes[CHECK_BYTES];
    put_word(bytes, saving->sum);
    put_summed(saving, bytes, sizeof bytes);
    errno = saving->reason;
    return spari_file_end(&saving->file, 1, why, size);
}

/* ---- reading ---- */

/* got: bytes of the heading that were read; n: bytes of the file. */
static int check_head(const char *path, const unsigned char *head, size_t got, uint64_t n, char *why, size_t size) {
    uint64_t words = got == HEAD_BYTES ? get_word(head + 16) : 0;
    if (got < sizeof magic || memcmp(head, magic, sizeof magic) != 0) {
        (void)snprintf(why, size, "'%s' is not a saved session", path);
    } else if (got < HEAD_BYTES || n < HEAD_BYTES + CHECK_BYTES) {
        (void)snprintf(why, size, "'%s' is truncated after %llu bytes; use an older file", path, (unsigned long long)n);
    } else if (get_word(head + 8) != VERSION) {
        (void)snprintf(why, size,
                       "'%s' has format version %llu, but this library reads version %d; load it with the version of "
                       "spar that wrote it",
                       path, (unsigned long long)get_word(head + 8), VERSION);
    } else if (words != (n - HEAD_BYTES - CHECK_BYTES) / 8 || n % 8 != 0) {
        (void)snprintf(why, size, "'%s' has %llu bytes but should have %llu; use an older file", path,
                       (unsigned long long)n, (unsigned long long)(HEAD_BYTES + CHECK_BYTES + 8 * words));
    } else {
        return SPAR_OK;
    }
    return SPAR_ERR_IO;
}

/* Size of a regular file in bytes. Other kinds are refused: they could be endless or block. */
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

/* Checks the heading and the size of the file. */
static int read_heading(spari_loading *source, char *why, size_t size) {
    unsigned char head[HEAD_BYTES];
    uint64_t there = 0;
    SPARI_TRY(measure_file(source->stream, source->path, &there, why, size));
    size_t got = fread(head, 1, sizeof head, source->stream);
    if (ferror(source->stream)) {
        return io_failure(why, size, "cannot read", source->path);
    }
    SPARI_TRY(check_head(source->path, head, got, there, why, size));
    source->count = (int64_t)get_word(head + 16);
    return spari_loading_read(source, source->count, 1, &source->sum, why, size);
}

int spari_loading_open(spari_loading *source, const char *path, char *why, size_t size) {
    *source = (spari_loading){.path = strdup(path)};
    if (!source->path) {
        (void)snprintf(why, size, "no memory to read '%s'", path);
        return SPAR_ERR_MEMORY;
    }
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC); /* a pipe would block until somebody writes */
    source->stream = fd >= 0 ? fdopen(fd, "rb") : NULL;
    int status = SPAR_OK;
    if (!source->stream) {
        status = io_failure(why, size, "cannot read", path);
        (void)(fd >= 0 && close(fd));
    } else {
        status = read_heading(source, why, size);
    }
    if (status != SPAR_OK) {
        spari_loading_close(source);
    }
    return status;
}

void spari_loading_close(spari_loading *source) {
    if (source->stream) {
        (void)fclose(source->stream);
    }
    free(source->path);
    *source = (spari_loading){.stream = NULL};
}

/* Reads n bytes at an offset. */
static int read_raw(spari_loading *source, int64_t offset, size_t n, void *bytes, char *why, size_t size) {
    errno = 0;
    if (fseeko(source->stream, (off_t)offset, SEEK_SET) != 0 || fread(bytes, 1, n, source->stream) != n) {
        errno = errno ? errno : EIO; /* the file has been truncated since */
        return io_failure(why, size, "cannot read", source->path);
    }
    return SPAR_OK;
}

int spari_loading_read(spari_loading *source, int64_t at, int64_t n, uint64_t *words, char *why, size_t size) {
    SPARI_TRY(read_raw(source, offset_of_word(at), 8 * (size_t)n, words, why, size));
    for (int64_t i = 0; i < n; i++) {
        words[i] = get_word((const unsigned char *)(words + i));
    }
    return SPAR_OK;
}

int spari_loading_check(spari_loading *source, char *why, size_t size) {
    unsigned char bytes[1 << 10];
    int64_t end = offset_of_word(source->count);
    uint64_t sum = 0;
    for (int64_t at = 0; at < end; at += (int64_t)sizeof bytes) {
        size_t piece = end - at < (int64_t)sizeof bytes ? (size_t)(end - at) : sizeof bytes;
        SPARI_TRY(read_raw(source, at, piece, bytes, why, size));
        sum = check_bytes(sum, bytes, piece);
    }
    if (sum != source->sum) {
        (void)snprintf(why, size, "'%s' is damaged (wrong checksum); use an older file", source->path);
        return SPAR_ERR_IO;
    }
    return SPAR_OK;
}
