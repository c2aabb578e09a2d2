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

/* A x = mu B x with A [n][n] symmetric and B symmetric positive definite: mu [n] descending, eigenvectors the rows of x
   [n][n], of unit length. Destroys A and B. 0; SPAR_ERR_MEMORY; SPAR_ERR_NUMERIC: an entry, or one of B^-1 A, is not a
   finite number, or B is not positive definite. */
int spari_eigen(int n, double *A, double *B, double *mu, double *x);

/* The eigenvalues z [n] of a real matrix A [n][n], in no order. Conjugate pairs are exactly conjugate, real ones
   exactly real. Destroys A. 0, SPAR_ERR_MEMORY, SPAR_ERR_NUMERIC. */
int spari_eigenvalues(int n, double *A, double complex *z);

/* A [size][size] += scale times the symmetric part of X [n][n], whose first unknown is unknown `at` of A. Unknowns
   before the first one of A are skipped. */
void spari_eigen_add(int at, int n, const double *X, double scale, int64_t size, double *A);

#endif
