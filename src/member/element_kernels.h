/* The kernels of an element (element_lanes.c): one table for each width of vectors. */
#ifndef SPARI_ELEMENT_KERNELS_H
#define SPARI_ELEMENT_KERNELS_H

#include "../math/lanes.h"
#include "tangent.h"

/* Forces by what of its mass a section shows. */
typedef struct spari_element_kernels {
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
} spari_element_kernels;

SPARI_KERNEL_TABLES(spari_element_kernels)

#endif
