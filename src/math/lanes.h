/* Helpers for kernels that are compiled once per vector width: see width.h. */
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
#define SPARI_AVX_KERNELS 1
#endif
#endif

/* The width of this object. SPARI_HAS_OBJECT: the compiler can make kernels of this width. */
#if !defined(SPARI_OBJECT_WIDTH)
#define SPARI_OBJECT_WIDTH 2
#endif
#if SPARI_OBJECT_WIDTH == 2 || defined(SPARI_AVX_KERNELS)
#define SPARI_HAS_OBJECT 1
#endif

/* Doubles from x on to where a cache line of eight begins: vectors that lie across two take twice as long. */
static inline int64_t spari_to_line(const double *x) {
    uintptr_t off = (uintptr_t)x % 64;
    return off == 0 ? 0 : (int64_t)((64 - off) / sizeof *x);
}

/* Vector width of the kernels for this processor, at most `most`: 8, 4, or 0 for the portable kernels. */
static inline int spari_lanes_here(int most) {
#ifdef SPARI_AVX_KERNELS
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

/* SPARI_KERNEL_TABLES(set) declares a set of kernels, whose type is `set`: the table of each width, and the function
   set_for(most), which gives the widest table that this processor can use, of `most` lanes at most. */
#ifdef SPARI_AVX_KERNELS
#define SPARI_KERNEL_TABLES(set)                                                                                       \
    extern const set set##_plain, set##_avx2, set##_avx512;                                                            \
    static inline const set *set##_for(int most) {                                                                     \
        switch (spari_lanes_here(most)) {                                                                              \
        case 8:                                                                                                        \
            return &set##_avx512;                                                                                      \
        case 4:                                                                                                        \
            return &set##_avx2;                                                                                        \
        default:                                                                                                       \
            return &set##_plain;                                                                                       \
        }                                                                                                              \
    }
#else
#define SPARI_KERNEL_TABLES(set)                                                                                       \
    extern const set set##_plain;                                                                                      \
    static inline const set *set##_for(int most) {                                                                     \
        (void)most;                                                                                                    \
        return &set##_plain;                                                                                           \
    }
#endif

#endif
