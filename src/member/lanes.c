/* Forces and tangents of quadrature points side by side: which kernels serve. */
#include "element_kernels.h"

/* For so many points, or nodes, side by side: no wider than they are many. */
static const spari_element_kernels *kernels_for(const spari_body *body, int count) {
    int most = body->lanes ? body->lanes : SPARI_LANES, fit = count > 4 ? 8 : count > 2 ? 4 : 2;
    return spari_element_kernels_for(most < fit ? most : fit);
}

int spari_lanes_gather(const spari_body *body, const double *q, const double *v, const double *a, double *z) {
    int opposed = 0;
    const spari_element_kernels *kernel;
    for (int l = 0, P = body->per_element; l < P; l += kernel->width) {
        kernel = kernels_for(body, P - l);
        opposed |= kernel->gather(l, P - l, q, v, a, z);
    }
    return opposed;
}

void spari_lanes_add(const spari_body *body, const double *g, const double *z, double *r) {
    const spari_element_kernels *kernel;
    for (int l = 0, P = body->per_element; l < P; l += kernel->width) {
        kernel = kernels_for(body, P - l);
        kernel->add(l, P - l, g, z, r);
    }
}

void spari_lanes_interpolate(const spari_body *body, int e, int wanted, const double *z, double *f) {
    int P = body->per_element, n = body->first[e + 1] - body->first[e];
    const spari_element_kernels *kernel = kernels_for(body, n);
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
