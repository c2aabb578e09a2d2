/* Largest eigenvalues of an operator, by Arnoldi's method. */
#ifndef SPARI_ARNOLDI_H
#define SPARI_ARNOLDI_H

#include <complex.h>

typedef struct spari_arnoldi_problem {
    void (*apply)(void *self, const double complex *in, double complex *out);
    void *self;
    int size; /* of a vector */
    int rank; /* upper bound of the operator's rank */
} spari_arnoldi_problem;

/* Computes the `wanted` eigenvalues of largest modulus, with multiplicity, and their vectors z [wanted][size];
 *count: how many have converged. Returns 0, SPAR_ERR_MEMORY or SPAR_ERR_NUMERIC. */
int spari_arnoldi(const spari_arnoldi_problem *of, int wanted, int *count, double complex *mu, double complex *z);

#endif
