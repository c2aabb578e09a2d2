/* Schur form of small complex matrices: A = Q S Q^H, S upper triangular with the eigenvalues on its diagonal, Q
   unitary. Row-major. GSL has it for real matrices only. */
#ifndef SPARI_SCHUR_H
#define SPARI_SCHUR_H

#include <complex.h>

/* S [n][n]: A on input, S on output; Q [n][n]: output; room [n]. Returns 0, or 1 if it does not converge or a number
   is not finite. */
int spari_schur(int n, double complex *S, double complex *Q, double complex *room);
/* Exchanges the eigenvalues k and k + 1. */
void spari_schur_swap(int n, double complex *S, double complex *Q, int k);
/* x [n]: eigenvector of S for eigenvalue k; its entry k is 1 and later ones are 0. */
void spari_schur_vector(int n, const double complex *S, int k, double complex *x);

#endif
