/* Helpers for kernels that are compiled once per vector width: see width.h and widths.h. */
#ifndef SPARI_LANES_H
#define SPARI_LANES_H

#include <stdint.h>
#include <string.h>

#if defined(__GNUC__)
#define SPARI_ALWAYS_INLINE __attribute__((always_inline))
#define SPARI_UNROLL _Pragma("GCC unroll 9")
#define SPARI_UNROLL_ALL _Pragma("GCC unroll 32")
#define SPARI_AHEAD(p) __builtin_prefetch(p)
#else
#define SPARI_ALWAYS_INLINE
#define SPARI_UNROLL
#define SPARI_UNROLL_ALL
#define SPARI_AHEAD(p) ((void)(p))
#endif

/* SPARI_PLAIN_LANES (1, 2, 4, 8) builds only the portable kernels at the given width, to test every width on any
   processor. */
#if defined(__GNUC__) && defined(__x86_64__)
#include <immintrin.h>
#if !defined(SPARI_PLAIN_LANES)
#define SPARI_X86 1
#endif
#endif

/* Number of doubles from x to the next cache line of eight. Vectors that cross a cache line take twice as long. */
static inline int64_t spari_to_line(const double *x) {
    uintptr_t off = (uintptr_t)x % 64;
    return off == 0 ? 0 : (int64_t)((64 - off) / sizeof *x);
}

/* Vector width of the kernels for this processor, at most `most`: 8, 4, or 0 for the portable kernels. */
static inline int spari_lanes_here(int most) {
#ifdef SPARI_X86
    if (most >= 8 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
        return 8;
    }
    if (most >= 4 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
        return 4;
    }
#endif
    (void)most;
    return 0;
}

#endif
