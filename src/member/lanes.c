/* Forces of quadrature points side by side: the kernels for each width of vectors, and which of them serves. */
#include "../math/basis.h"
#include "point.h"

#if defined(__GNUC__) && defined(__x86_64__)
#include <immintrin.h>
#if !defined(SPARI_PLAIN_LANES)
#define SPARI_X86 1
#endif
#endif

/* Two lanes are in every processor that has lanes at all; more are asked for at run time. SPARI_PLAIN_LANES (1, 2, 4,
   8) builds the portable kernel alone at a width of choice, so that every width can be tried on any processor. */
#if defined(SPARI_PLAIN_LANES)
#define W SPARI_PLAIN_LANES
#elif defined(__GNUC__)
#define W 2
#else
#define W 1
#endif
#define NAME(x) x##_plain
#define TARGET
#define MADD(a, b, c) ((a) * (b) + (c))
#if W == 1
#define SPLAT(p) (*(p))
#else
#define SPLAT(p) ((lanes_plain){0} + *(p))
#endif
#if W == 2 && defined(__SSE2__)
#define ROOT(x) _mm_sqrt_pd(x)
#endif
#include "forces_lanes.h"
#undef W
#undef NAME
#undef TARGET
#undef MADD
#undef ROOT
#undef SPLAT

#ifdef SPARI_X86

#define W 4
#define NAME(x) x##_avx2
#define TARGET __attribute__((target("avx2,fma")))
#define MADD(a, b, c) _mm256_fmadd_pd(a, b, c)
#define ROOT(x) _mm256_sqrt_pd(x)
#define SPLAT(p) _mm256_broadcast_sd(p)
#include "forces_lanes.h"
#undef W
#undef NAME
#undef TARGET
#undef MADD
#undef ROOT
#undef SPLAT

#define W 8
#define NAME(x) x##_avx512
#define TARGET __attribute__((target("avx512f,avx512dq")))
#define MADD(a, b, c) _mm512_fmadd_pd(a, b, c)
#define ROOT(x) _mm512_sqrt_pd(x)
#define SPLAT(p) _mm512_set1_pd(*(p))
#include "forces_lanes.h"
#undef W
#undef NAME
#undef TARGET
#undef MADD
#undef ROOT
#undef SPLAT
#endif

/* The kernels of one instruction set; forces by what of its mass a section shows. */
typedef struct force_kernels {
    void (*interpolate)(int wanted, int P, const double *shape, const double *z, double *f);
    void (*forces[3])(const spari_body *body, int64_t slot, int n, const spari_regime *how, const double *z, double *f,
                      double *back, spari_tally *tally);
    void (*collect)(int sloped, int P, int n, const double *phi, const double *dphi, const double *back, double *g);
} force_kernels;

#define KERNELS(set)                                                                                                   \
    { interpolate_block_##set, {massless_forces_##set, weighed_forces_##set, accelerated_forces_##set}, collect_##set }
static const force_kernels plain = KERNELS(plain);
#ifdef SPARI_X86
static const force_kernels avx2 = KERNELS(avx2), avx512 = KERNELS(avx512);
#endif

/* For so many points, or nodes, side by side: no wider than they are many. */
static const force_kernels *kernels_for(const spari_body *body, int count) {
#ifdef SPARI_X86
    int most = body->lanes ? body->lanes : SPARI_LANES;
    if (most >= 8 && count > 4 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
        return &avx512;
    }
    if (most >= 4 && count > 2 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
        return &avx2;
    }
#endif
    (void)body, (void)count;
    return &plain;
}

void spari_lanes_interpolate(const spari_body *body, int e, int wanted, const double *z, double *f) {
    int P = body->per_element, n = body->first[e + 1] - body->first[e];
    const force_kernels *kernel = kernels_for(body, n);
    for (int k = 0; k < n; k += SPARI_LANES) {
        kernel->interpolate(wanted, P, SPARI_BLOCK(body->shape, 2 * P, body->slot[e] + k), z,
                            SPARI_BLOCK(f, POINT_ROWS, k));
    }
}

void spari_lanes_forces(const spari_body *body, int e, const spari_regime *how, const double *z, double *f,
                        double *back, spari_tally *tally) {
    int n = body->first[e + 1] - body->first[e];
    kernels_for(body, n)->forces[how->shown](body, body->slot[e], n, how, z, f, back, tally);
}

void spari_lanes_collect(const spari_body *body, int e, const double *back, double *g) {
    int P = body->per_element, first = body->first[e];
    const double *phi = body->phi + (int64_t)first * P, *dphi = body->dphi + (int64_t)first * P;
    kernels_for(body, P)->collect(body->C != NULL, P, body->first[e + 1] - first, phi, dphi, back, g);
}
