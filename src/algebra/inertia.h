/* Signs of the eigenvalues of a small symmetric matrix. */
#ifndef SPARI_INERTIA_H
#define SPARI_INERTIA_H

enum { SPARI_INERTIA = 12 };

/* Number of negative eigenvalues of the symmetric part of A [n][n], n <= SPARI_INERTIA. */
int spari_inertia_negative(int n, const double *A, int stride);

#endif
