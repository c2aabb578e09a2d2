/* Schur form of small complex matrices: A = Q S Q^H, S upper triangular with the eigenvalues on its diagonal, Q
   unitary. Row-major. GSL has it for real matrices only. */
#ifndef SPARI_SCHUR_H
#define SPARI_SCHUR_H

#include <complex.h>

/* S [n][n]: in A, out S; Q [n][n]: out; sorted: largest eigenvalues first; room [4 n]: workspace. 0, or 1: no
   convergence, or an entry is not finite. */
int spari_schur(int n, double complex *S, double complex *Q, int sorted, double complex *workspace);
/* x [n]: the eigenvector of A to the eigenvalue S [k][k], room [n]. */
void spari_schur_vector(int n, const double complex *S, const double complex *Q, int k, double complex *x,
                        double complex *workspace);

#endif
