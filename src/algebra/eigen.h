/* Symmetric generalised eigenvalue problems. */
#ifndef SPARI_EIGEN_H
#define SPARI_EIGEN_H

#include <gsl/gsl_matrix.h>
#include <gsl/gsl_vector.h>
#include <stdint.h>

/* A x = mu B x with A symmetric and B symmetric positive definite: mu descending, eigenvectors the columns of x, of
   unit length. Destroys A and B. 0; SPAR_ERR_MEMORY; SPAR_ERR_NUMERIC: an entry, or one of B^-1 A, is not a finite
   number, or B is not positive definite. */
int spari_eigen(gsl_matrix *A, gsl_matrix *B, gsl_vector *mu, gsl_matrix *x);

/* A [size][size] += scale times the symmetric part of X [n][n], whose first unknown is unknown `at` of A; those before
   A's first are left out. */
void spari_eigen_add(int at, int n, const double *X, double scale, int64_t size, double *A);

#endif
