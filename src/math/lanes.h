/* What code needs that is compiled once for each width of vectors: see point_lanes.h and transfer/kernel.h. */
#ifndef SPARI_LANES_H
#define SPARI_LANES_H

#if defined(__GNUC__)
#define SPARI_ALWAYS_INLINE __attribute__((always_inline))
#define SPARI_UNROLL _Pragma("GCC unroll 9")
#else
#define SPARI_ALWAYS_INLINE
#define SPARI_UNROLL
#endif

#endif
