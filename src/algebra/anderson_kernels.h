/* The kernels of Anderson's mixing (anderson_lanes.c): one table for each width of vectors. */
#ifndef SPARI_ANDERSON_KERNELS_H
#define SPARI_ANDERSON_KERNELS_H

#include "../math/lanes.h"
#include "anderson.h"

typedef struct spari_mixing_kernels {
    void (*look)(const spari_anderson *m, const double *x, int64_t from, int64_t to, double *sums);
    void (*mix)(const spari_anderson *m, const double *by, double *x, int64_t from, int64_t to);
} spari_mixing_kernels;

SPARI_KERNEL_TABLES(spari_mixing_kernels)

#endif
