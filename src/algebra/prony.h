/* Fits decaying sequences of matrices by those of a linear system: Y_k = sum of left_i z_i^k right_i^T. */
#ifndef SPARI_PRONY_H
#define SPARI_PRONY_H

#include <complex.h>
#include <stdint.h>

typedef struct spari_decay {
    int size, order;              /* size of Y; number of z_i */
    double complex *z;            /* [order] */
    double complex *left, *right; /* [order][size] */
    double largest, misfit;       /* largest entry of all Y; error relative to it */
} spari_decay;

/* Fits y [count][size][size] (Ho and Kalman; Juang and Pappa 1985) with as few z as possible, none if y does not
   exceed `noise`. Returns 0, SPAR_ERR_MEMORY, or SPAR_ERR_NUMERIC: y is not finite. Free the result in any case. */
int spari_decay_fit(int size, int64_t count, const double *y, double noise, spari_decay *decay);
void spari_decay_free(spari_decay *decay);

/* Solves complex A x = b in place; A [n][n] is lost, b [n][columns]. Returns 0, or 1 if A is singular. */
int spari_decay_solve(int n, double complex *A, int columns, double complex *b);

#endif
