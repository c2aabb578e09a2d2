/* Symmetric generalised eigenvalue problems. */
#ifndef SPARI_EIGEN_H
#define SPARI_EIGEN_H

#include <gsl/gsl_matrix.h>
#include <gsl/gsl_vector.h>
#include <stdint.h>

/* Solves A x = mu B x with A symmetric and B symmetric positive definite. Destroys A and B.
   mu: eigenvalues, descending
   x: eigenvectors in columns, of unit length
   Returns 0, SPAR_ERR_MEMORY, or SPAR_ERR_NUMERIC if an entry of A, B or B^-1 A is not finite or B is not positive
     definite. */
int spari_eigen(gsl_matrix *A, gsl_matrix *B, gsl_vector *mu, gsl_matrix *x);

/* A [size][size] += scale times the symmetric part of X [n][n], whose first unknown is unknown `at` of A. Unknowns
   before the first one of A are skipped. */
void spari_eigen_add(int at, int n, const double *X, double scale, int64_t size, double *A);

#endif
