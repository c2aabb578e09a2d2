/* The kernels of dense and banded systems (linear_lanes.c): one table for each width of vectors. */
#ifndef SPARI_LINEAR_KERNELS_H
#define SPARI_LINEAR_KERNELS_H

#include "../math/lanes.h"

/* Columns of a dense matrix are solved for so many at a time, with so many corners of that size (solve_dense). */
enum { SPARI_CORNER = 8, SPARI_CORNERS = 4 };

typedef struct spari_linear_kernels {
    int (*factor_dense)(int64_t n, int64_t inner, double *A, int64_t step, int *swap, double *weight, double *corners);
    int (*factor_band)(int64_t n, int64_t band, double *columns, int64_t step, int *swap, double *weight);
    void (*corner)(int64_t n, int64_t j, int loaded, const double *A, int64_t step, double *corner);
    int (*dense)(int64_t n, const double *A, int64_t step, const double *corners, double *y);
    void (*forth_dense)(int64_t n, int64_t inner, const double *A, double *x);
    void (*back_dense)(int64_t n, int64_t inner, const double *A, double *x);
    void (*forth)(int64_t n, int64_t band, const double *columns, int64_t step, const int *swap, double *x);
    void (*back)(int64_t n, int64_t band, const double *columns, int64_t step, double *x);
    void (*columns)(int64_t n, int64_t count, const double *columns, const double *by, double *x);
    void (*rows)(int64_t n, int64_t count, const double *rows, double by, const double *x, double *y);
} spari_linear_kernels;

SPARI_KERNEL_TABLES(spari_linear_kernels)

#endif
