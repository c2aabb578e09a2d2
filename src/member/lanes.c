/* Selects the kernels of quadrature points for the vector width of this processor. */
#include "../base/status.h"
#include "../math/basis.h"
#include "tangent.h"

#define SPARI_KERNELS "../member/element_lanes.h"
#include "../math/widths.h"

/* Kernels of one instruction set; forces by the mass variant of the sections. */
typedef struct lane_kernels {
    int width;
    void (*interpolate)(int wanted, int P, const double *shape, const double *z, double *f);
    void (*forces[3])(const spari_body *body, int64_t slot, int n, const spari_regime *how, const double *z, double *f,
                      double *back, spari_tally *tally);
    int (*gather)(int first, int left, const double *q, const double *v, const double *a, double *z);
    void (*add)(int first, int left, const double *g, const double *z, double *r);
    void (*collect)(int sloped, int P, int n, const double *phi, const double *dphi, const double *back, double *g);
    void (*matrices)(const spari_body *body, int e, const spari_regime *how, const spari_tangent_work *t);
    void (*products)(const spari_tangent_work *t, const double *phi, const double *dphi);
    void (*sum)(const spari_tangent_work *t, int rows, const double *points, const double *product, double *pairs);
    void (*project)(const spari_tangent_work *t, double *S);
} lane_kernels;

#define KERNELS(set)                                                                                                   \
    {                                                                                                                  \
        (int)(sizeof(lanes_##set) / sizeof(double)), interpolate_block_##set,                                          \
            {massless_forces_##set, weighed_forces_##set, accelerated_forces_##set}, gather_nodes_##set,               \
            add_nodes_##set, collect_##set, element_matrices_##set, pair_products_##set, sum_pairs_##set,              \
            project_##set                                                                                              \
    }
static const lane_kernels plain = KERNELS(plain);
#ifdef SPARI_X86
static const lane_kernels avx2 = KERNELS(avx2), avx512 = KERNELS(avx512);
#endif

/* Kernels for this many points or nodes: not wider than their number. */
static const lane_kernels *kernels_for(const spari_body *body, int count) {
#ifdef SPARI_X86
    int most = body->lanes ? body->lanes : SPARI_LANES, fit = count > 4 ? 8 : count > 2 ? 4 : 2;
    switch (spari_lanes_here(most < fit ? most : fit)) {
    case 8:
        return &avx512;
    case 4:
        return &avx2;
    default:
        break;
    }
#endif
    (void)body, (void)count;
    return &plain;
}

int spari_lanes_gather(const spari_body *body, const double *q, const double *v, const double *a, double *z) {
    int opposed = 0;
    const lane_kernels *kernel;
    for (int l = 0, P = body->per_element; l < P; l += kernel->width) {
        kernel = kernels_for(body, P - l);
        opposed |= kernel->gather(l, P - l, q, v, a, z);
    }
    return opposed;
}

void spari_lanes_add(const spari_body *body, const double *g, const double *z, double *r) {
    const lane_kernels *kernel;
    for (int l = 0, P = body->per_element; l < P; l += kernel->width) {
        kernel = kernels_for(body, P - l);
        kernel->add(l, P - l, g, z, r);
    }
}

void spari_lanes_interpolate(const spari_body *body, int e, int wanted, const double *z, double *f) {
    int P = body->per_element, n = body->first[e + 1] - body->first[e];
    const lane_kernels *kernel = kernels_for(body, n);
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

void spari_lanes_matrices(const spari_body *body, int e, const spari_regime *how, const spari_tangent_work *t) {
    kernels_for(body, t->points)->matrices(body, e, how, t);
}

void spari_lanes_products(const spari_body *body, int e, const spari_tangent_work *t) {
    int64_t first = (int64_t)body->first[e] * t->P;
    kernels_for(body, t->P)->products(t, body->phi + first, body->dphi + first);
}

void spari_lanes_sum(const spari_body *body, const spari_tangent_work *t, int rows, const double *points, int product,
                     double *pairs) {
    kernels_for(body, (int)t->pairs)->sum(t, rows, points, t->products + product * t->stride, pairs);
}

void spari_lanes_project(const spari_body *body, const spari_tangent_work *t, double *S) {
    kernels_for(body, t->P)->project(t, S);
}
