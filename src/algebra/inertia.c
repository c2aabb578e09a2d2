/* Signs of the eigenvalues of a small symmetric matrix: see inertia.h. */
#include "inertia.h"

#include "../base/status.h"
#include "eigen.h"

#include <math.h>

/* Rows and columns by the same factors, to largest entries of about 1: the signs stay (Sylvester). */
static void equilibrate(int n, double *S) {
    for (int pass = 0; pass < 3; pass++) {
        double f[SPARI_INERTIA];
        for (int i = 0; i < n; i++) {
            double most = 0;
            for (int k = 0; k < n; k++) {
                most = fmax(most, fabs(S[n * i + k]));
            }
            f[i] = most > 0 && isfinite(most) ? 1 / sqrt(most) : 1;
        }
        for (int i = 0; i < n * n; i++) {
            S[i] *= f[i / n] * f[i % n];
        }
    }
}

int spari_inertia_negative(int n, const double *A, int stride) {
    double S[SPARI_INERTIA * SPARI_INERTIA], mu[SPARI_INERTIA], workspace[SPARI_SYMMETRIC_ROOM(SPARI_INERTIA)];
    int negative = 0;
    for (int i = 0; i < n * n; i++) {
        S[i] = 0.5 * (A[stride * (i / n) + i % n] + A[stride * (i % n) + i / n]);
    }
    equilibrate(n, S);
    int known = spari_symmetric(n, S, mu, workspace) == SPAR_OK;
    for (int i = 0; i < n && known; i++) {
        negative += mu[i] < 0;
    }
    return negative;
}
