/* Signs of the eigenvalues of a small symmetric matrix: see inertia.h. */
#include "inertia.h"

#include <float.h>
#include <math.h>

/* Jacobi rotation of rows and columns p and q that makes entry (p, q) zero. */
static void turn_pair(int n, double S[SPARI_INERTIA][SPARI_INERTIA], int p, int q) {
    double half = 0.5 * (S[q][q] - S[p][p]) / S[p][q];
    double t = (half < 0 ? -1 : 1) / (fabs(half) + sqrt(1 + half * half)), c = 1 / sqrt(1 + t * t), s = t * c;
    for (int k = 0; k < n; k++) {
        double x = S[k][p], y = S[k][q];
        S[k][p] = c * x - s * y;
        S[k][q] = s * x + c * y;
    }
    for (int k = 0; k < n; k++) {
        double x = S[p][k], y = S[q][k];
        S[p][k] = c * x - s * y;
        S[q][k] = s * x + c * y;
    }
}

/* Scales rows and columns equally, to largest entries of about 1: the signs are unchanged (Sylvester). */
static void equilibrate(int n, double S[SPARI_INERTIA][SPARI_INERTIA]) {
    for (int pass = 0; pass < 3; pass++) {
        double f[SPARI_INERTIA];
        for (int i = 0; i < n; i++) {
            double most = 0;
            for (int k = 0; k < n; k++) {
                most = fmax(most, fabs(S[i][k]));
            }
            f[i] = most > 0 && isfinite(most) ? 1 / sqrt(most) : 1;
        }
        for (int i = 0; i < n * n; i++) {
            S[i / n][i % n] *= f[i / n] * f[i % n];
        }
    }
}

int spari_inertia_negative(int n, const double *A, int stride) {
    enum { SWEEPS = 30 };
    double S[SPARI_INERTIA][SPARI_INERTIA];
    int negative = 0;
    for (int i = 0; i < n * n; i++) {
        double a = A[stride * (i / n) + i % n], b = A[stride * (i % n) + i / n];
        S[i / n][i % n] = 0.5 * (a + b);
    }
    equilibrate(n, S);
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        int turned = 0;
        for (int p = 0; p < n; p++) {
            for (int q = p + 1; q < n; q++) {
                if (fabs(S[p][q]) > DBL_EPSILON * sqrt(fabs(S[p][p] * S[q][q])) && fabs(S[p][q]) > DBL_MIN) {
                    turn_pair(n, S, p, q);
                    turned = 1;
                }
            }
        }
        if (!turned) {
            break;
        }
    }
    for (int i = 0; i < n; i++) {
        negative += S[i][i] < 0;
    }
    return negative;
}
