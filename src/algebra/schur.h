/* Schur's form of small complex matrices, which GSL has for real ones only: A = Q S Q^H, S upper triangular with the
   eigenvalues on its diagonal, Q unitary. Row-major. */
#ifndef SPARI_SCHUR_H
#define SPARI_SCHUR_H

#include <complex.h>

/* S [n][n]: in A, out S; Q [n][n]: out; room [n]. 0, or 1 where it does not converge or meets what is no number. */
int spari_schur(int n, double complex *S, double complex *Q, double complex *room);
/* The eigenvalues k and k + 1 exchange their places. */
void spari_schur_swap(int n, double complex *S, double complex *Q, int k);
/* x [n]: the eigenvector of S to the eigenvalue k, its entry k is 1 and those behind it 0. */
void spari_schur_vector(int n, const double complex *S, int k, double complex *x);

#endif
