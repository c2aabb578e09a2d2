/* One width of vectors for the code included next: in place of the width before, which ends here, defines for
   SPARI_WIDTH 1 (plain C), 2 (portable: two lanes are in every processor that has lanes at all), 4 (AVX2), 8 (AVX-512)
     W           lanes of a vector
     NAME(x)     the name of x at this width
     TARGET      function attributes of the instruction set
     MADD(a,b,c) a b + c, rounded once where the processor can; MSUB a b - c and NMADD c - a b likewise
     SPLAT(p)    *p in every lane
     ROOT(x)     square root, where there is an instruction for it
     MOST(a,b)   the larger, b where one is no number, likewise; LEAST the smaller
     ABOVE(a,b)  some bits where a lane of a is larger, likewise
     LOW(a,b)    the first of each two lanes of a and b in turns, and HIGH the second, likewise
     STREAM(p,v) v to p, a multiple of its size, past the caches, likewise
     L           the vector; get and put take it from memory and bring it there
     HERE        how a function begins that is inlined
   and for SPARI_WIDTH 0 nothing. SPARI_WIDTH itself is gone afterwards. 4 and 8 are for SPARI_AVX_KERNELS alone. No
   include guard: this is a body, not an interface. */
#include "lanes.h"

#undef W
#undef NAME
#undef TARGET
#undef MADD
#undef MSUB
#undef NMADD
#undef SPLAT
#undef ROOT
#undef MOST
#undef LEAST
#undef ABOVE
#undef LOW
#undef HIGH
#undef STREAM
#undef L
#undef HERE

#if SPARI_WIDTH == 1
#define W 1
#define NAME(x) x##_one
#elif SPARI_WIDTH == 2
#if defined(SPARI_PLAIN_LANES)
#define W SPARI_PLAIN_LANES
#elif defined(__GNUC__)
#define W 2
#else
#define W 1
#endif
#define NAME(x) x##_plain
#elif SPARI_WIDTH == 4
#define W 4
#define NAME(x) x##_avx2
#define TARGET __attribute__((target("avx2,fma")))
#define MADD(a, b, c) _mm256_fmadd_pd(a, b, c)
#define MSUB(a, b, c) _mm256_fmsub_pd(a, b, c)
#define NMADD(a, b, c) _mm256_fnmadd_pd(a, b, c)
#define SPLAT(p) _mm256_broadcast_sd(p)
#define ROOT(x) _mm256_sqrt_pd(x)
#define MOST(a, b) _mm256_max_pd(a, b)
#define LEAST(a, b) _mm256_min_pd(a, b)
#define ABOVE(a, b) _mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_GT_OQ))
#define LOW(a, b) _mm256_unpacklo_pd(a, b)
#define HIGH(a, b) _mm256_unpackhi_pd(a, b)
#define STREAM(p, v) _mm256_stream_pd(p, v)
#elif SPARI_WIDTH == 8
#define W 8
#define NAME(x) x##_avx512
#define TARGET __attribute__((target("avx512f,avx512dq")))
#define MADD(a, b, c) _mm512_fmadd_pd(a, b, c)
#define MSUB(a, b, c) _mm512_fmsub_pd(a, b, c)
#define NMADD(a, b, c) _mm512_fnmadd_pd(a, b, c)
#define SPLAT(p) _mm512_set1_pd(*(p))
#define ROOT(x) _mm512_sqrt_pd(x)
#define MOST(a, b) _mm512_max_pd(a, b)
#define LEAST(a, b) _mm512_min_pd(a, b)
#define ABOVE(a, b) _mm512_cmp_pd_mask(a, b, _CMP_GT_OQ)
#define LOW(a, b) _mm512_unpacklo_pd(a, b)
#define HIGH(a, b) _mm512_unpackhi_pd(a, b)
#define STREAM(p, v) _mm512_stream_pd(p, v)
#endif

#if SPARI_WIDTH == 1 || SPARI_WIDTH == 2
#define TARGET
#define MADD(a, b, c) ((a) * (b) + (c))
#define MSUB(a, b, c) ((a) * (b) - (c))
#define NMADD(a, b, c) ((c) - (a) * (b))
#if W == 1
#define SPLAT(p) (*(p))
#else
#define SPLAT(p) (*(p) - (L){0}) /* less nothing, for that keeps the sign of a zero */
#endif
#if W == 2 && defined(__SSE2__)
#define ROOT(x) _mm_sqrt_pd(x)
#define MOST(a, b) _mm_max_pd(a, b)
#define LEAST(a, b) _mm_min_pd(a, b)
#define ABOVE(a, b) _mm_movemask_pd(_mm_cmpgt_pd(a, b))
#define LOW(a, b) _mm_unpacklo_pd(a, b)
#define HIGH(a, b) _mm_unpackhi_pd(a, b)
#define STREAM(p, v) _mm_stream_pd(p, v)
#endif
#endif

#if SPARI_WIDTH > 0
#if W > 1
typedef double NAME(lanes) __attribute__((vector_size(8 * W)));
#else
typedef double NAME(lanes);
#endif
#define L NAME(lanes)
#define HERE TARGET static inline SPARI_ALWAYS_INLINE

HERE L NAME(get)(const double *p) {
    L v;
    memcpy(&v, p, sizeof v);
    return v;
}

HERE void NAME(put)(double *p, L v) {
    memcpy(p, &v, sizeof v);
}
#endif

#undef SPARI_WIDTH
