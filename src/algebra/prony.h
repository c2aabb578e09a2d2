/* Sequences of matrices that decay as those of a linear system do: Y_k = sum of left_i z_i^k right_i^T. */
#ifndef SPARI_DECAY_H
#define SPARI_DECAY_H

#include <complex.h>
#include <stdint.h>

typedef struct spari_decay {
    int size, order;              /* of Y; how many z_i */
    double complex *z;            /* [order] */
    double complex *left, *right; /* [order][size] */
    double largest, misfit;       /* entry of all Y; difference from it, over the largest entry */
} spari_decay;

/* Finds it for y [count][size][size] (Ho and Kalman; Juang and Pappa 1985) with as few z as fit it, none where y is no
   larger than `noise`. 0, SPAR_ERR_MEMORY, SPAR_ERR_NUMERIC: y has no numbers. Free it whatever that is. */
int spari_decay_fit(int size, int64_t count, const double *y, double noise, spari_decay *decay);
void spari_decay_free(spari_decay *decay);

/* A x = b in place of b, complex, A [n][n] is lost, b [n][columns]; 0, or 1: A is singular. */
int spari_decay_solve(int n, double complex *A, int columns, double complex *b);

#endif
