/* Factorisations of dense matrices, row-major without gaps. */
#ifndef SPARI_DENSE_H
#define SPARI_DENSE_H

/* A = L L^T of the lower triangle of A [n][n], L in its place. 0, or 1: A is not positive definite. */
int spari_cholesky(int n, double *A);
/* x := (L L^T)^-1 x */
void spari_cholesky_solve(int n, const double *L, double *x);
/* The same factors of a banded matrix, A [n][band + 1]: row i holds entry (i, i) and those below it in column i. */
int spari_cholesky_band(int n, int band, double *A);

/* Least squares: minimises |A x - b| for A [m][n] of full rank, m >= n, and each row of b [columns][m]. x replaces the
   first n entries of the row. Destroys A. 0, SPAR_ERR_MEMORY, SPAR_ERR_NUMERIC: A is singular. */
int spari_least_squares(int m, int n, double *A, int columns, double *b);

/* The rank of G [h][n], and its independent rows. The rows are scaled to unit length; a row is dependent where the rows
   chosen before it leave no more than `least` of it. Returns the rank, or -1: no memory. Destroys G.
     order [h]: out, the rows; the first `rank` are the independent ones
     Q [want][n], want <= n: out, orthonormal rows; the first `rank` span the rows of G */
int spari_independent_rows(int h, int n, double *G, double least, int *order, int want, double *Q);

/* A = U S V^T: U [n][n] in place of A, V [n][n] with the vectors as columns, S [n] descending. 0, SPAR_ERR_MEMORY,
 * SPAR_ERR_NUMERIC. */
int spari_singular_values(int n, double *A, double *S, double *V);

#endif
