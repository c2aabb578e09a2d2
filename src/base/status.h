/* Statuses, and what every file may need: checks of numbers, memory. Knows nobody. */
#ifndef SPARI_STATUS_H
#define SPARI_STATUS_H

#include <spar/spar.h>
#include <stddef.h>

#if defined(__GNUC__)
#define SPARI_PRINTF(fmt, args) __attribute__((format(printf, fmt, args)))
#else
#define SPARI_PRINTF(fmt, args)
#endif

enum { SPARI_MESSAGE_SIZE = 1024 };

/* A function that keeps a frame of its own: put into its caller, both their arrays would lie on the stack for as long
   as either runs, which is much for a small one. */
#ifdef __GNUC__
#define SPARI_APART __attribute__((noinline))
#else
#define SPARI_APART
#endif

/* More entries than any memory holds: a host's count beyond it is a mistake, and below it a count times what an entry
   takes fits 64 bits. */
#define SPARI_MOST (INT64_C(1) << 40)

/* Checks and returns, at the public edge and below it. */
#define SPARI_TRY(call)                                                                                                \
    do {                                                                                                               \
        int spari_status_ = (call);                                                                                    \
        if (spari_status_ != SPAR_OK) {                                                                                \
            return spari_status_;                                                                                      \
        }                                                                                                              \
    } while (0)

/* Index of the first entry of x[n] that is not finite, or -1. */
int64_t spari_first_nonfinite(const double *x, int64_t n);

/* Whether x is a count that was saved as a double. */
int spari_is_count(double x);

/* Zeroed memory for n items, never NULL for n = 0; NULL when there is none left. Free with free(). */
void *spari_zalloc(int64_t n, size_t size);

/* A copy of x[n], likewise; zeros where x is NULL. */
double *spari_copy(const double *x, int64_t n);

/* What a host gets of values[known] whose entries have names: array[capacity] takes what it has room for, and 0 where
   there is more room; NULL: nothing. */
void spari_fill(int64_t capacity, double *array, int64_t known, const double *values);
/* The same of a table [known_rows][known_columns] into [rows][columns]. */
void spari_fill_table(int64_t rows, int64_t columns, double *to, int64_t known_rows, int64_t known_columns,
                      const double *values);

/* Bytes into a hash (FNV-1a), which begins with SPARI_HASH_BEGIN. */
#define SPARI_HASH_BEGIN UINT64_C(14695981039346656037)
uint64_t spari_hash_bytes(uint64_t hash, const void *data, size_t size);

#endif
