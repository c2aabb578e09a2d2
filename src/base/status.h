/* Status handling, checks of numbers, memory and hashes, used by every file. Depends on no other file. */
#ifndef SPARI_STATUS_H
#define SPARI_STATUS_H

#include <spar/spar_analysis.h>
#include <stddef.h>

#if defined(__GNUC__)
#define SPARI_PRINTF(fmt, args) __attribute__((format(printf, fmt, args)))
#else
#define SPARI_PRINTF(fmt, args)
#endif

enum { SPARI_MESSAGE_SIZE = 1024, SPARI_CAUSE_SIZE = 400 };

/* Prevents inlining: inlined, the arrays of both functions would share one stack frame, which is too large for small
   stacks. */
#ifdef __GNUC__
#define SPARI_APART __attribute__((noinline))
#else
#define SPARI_APART
#endif

/* Upper bound of a count. A larger count is an error of the host; a smaller one times the size of an entry fits 64
   bits. */
#define SPARI_MOST (INT64_C(1) << 40)

/* Check and return, at the public interface and below it. */
#define SPARI_TRY(call)                                                                                                \
    do {                                                                                                               \
        int spari_status_ = (call);                                                                                    \
        if (spari_status_ != SPAR_OK) {                                                                                \
            return spari_status_;                                                                                      \
        }                                                                                                              \
    } while (0)

/* Whether it is SPAR_OK or a SPAR_ERR_*. */
int spari_is_status(int status);

/* Index of the first entry of x[n] that is not finite, or -1. */
int64_t spari_first_nonfinite(const double *x, int64_t n);

/* Whether x is a count that was saved as a double. */
int spari_is_count(double x);

/* Zeroed memory for n items, to be freed with free(). Not NULL for n = 0. NULL: no memory. */
void *spari_zalloc(int64_t n, size_t size);

/* Frees all pointers given, of any type. */
#define SPARI_FREE(...) spari_free_all(sizeof((void *[]){__VA_ARGS__}) / sizeof(void *), (void *[]){__VA_ARGS__})
void spari_free_all(size_t n, void *const *pointers);

/* Copy of x[n], or zeros if x is NULL. Free it with free(). NULL: no memory. */
double *spari_copy(const double *x, int64_t n);

/* Copies values[n] to a host's array, which may be NULL. */
void spari_give(double *array, const double *values, int64_t n);
/* Copies values[known] to a host's array[capacity] (may be NULL). Excess entries of array are set to 0. */
void spari_fill(int64_t capacity, double *array, int64_t known, const double *values);

/* Adds bytes to a hash (FNV-1a), which begins with SPARI_HASH_BEGIN. */
#define SPARI_HASH_BEGIN UINT64_C(14695981039346656037)
uint64_t spari_hash_bytes(uint64_t hash, const void *data, size_t size);

#endif
