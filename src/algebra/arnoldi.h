/* The largest eigenvalues of an operator, by Krylov's subspaces. */
#ifndef SPARI_ARNOLDI_H
#define SPARI_ARNOLDI_H

#include <complex.h>

typedef struct spari_arnoldi_problem {
    void (*apply)(void *self, const double complex *in, double complex *out);
    void *self;
    int size; /* of a vector */
    int rank; /* of the operator at most */
} spari_arnoldi_problem;

/* The `wanted` eigenvalues that are largest in modulus, where the operator has so many, copies of multiple ones
   included, and their vectors z [wanted][size]; *count: how many have converged. 0, SPAR_ERR_MEMORY, SPAR_ERR_NUMERIC.
 */
int spari_arnoldi(const spari_arnoldi_problem *of, int wanted, int *count, double complex *mu, double complex *z);

#endif
