/* Eigenvalue problems of real matrices. */
#ifndef SPARI_EIGEN_H
#define SPARI_EIGEN_H

#include <complex.h>
#include <stdint.h>

/* The size of the workspace of spari_symmetric. */
#define SPARI_SYMMETRIC_ROOM(n) ((n) * ((n) + 4))

/* A x = mu x with a symmetric A [n][n]: mu [n] ascending, orthonormal eigenvectors as rows in place of A. 0, or
   SPAR_ERR_NUMERIC: an entry is not a finite number. */
int spari_symmetric(int n, double *A, double *mu, double *workspace);

/* The eigenvalues z [n] of a real matrix A [n][n], in no order. Conjugate pairs are exactly conjugate, real ones
   exactly real. Destroys A. 0, SPAR_ERR_MEMORY, SPAR_ERR_NUMERIC. */
int spari_eigenvalues(int n, double *A, double complex *z);

#endif
