/* Between two sets of nodes: see resample.h. */
#include "resample.h"

#include "basis.h"
#include "rotation.h"

#include <string.h>

void spari_resample_basis(int P, double xi, double *phi) {
    double x[SPARI_MAX_NODES], bary[SPARI_MAX_NODES];
    phi[0] = 1;
    if (P > 1) {
        spari_gll(P, x, NULL, bary);
        spari_lagrange(P, x, bary, xi, phi, NULL);
    }
}

/* Where the n nodes of an element are. */
static void places_of(int n, double *x) {
    x[0] = 0;
    if (n > 1) {
        spari_gll(n, x, NULL, NULL);
    }
}

void spari_resample_values(int elements, int P, int n, int width, int turn, const double *from, double *to) {
    double x[SPARI_MAX_NODES], phi[SPARI_MAX_NODES];
    places_of(n, x);
    for (int k = 0; k < n; k++) {
        spari_resample_basis(P, x[k], phi);
        for (int e = 0; e < elements; e++) {
            const double *f = from + (int64_t)width * e * P;
            double *t = to + (int64_t)width * ((int64_t)e * n + k);
            memset(t, 0, (size_t)width * sizeof *t);
            for (int l = 0; l < P; l++) {
                const double *fl = f + width * l;
                double sign = turn >= 0 && spari_quat_dot(f + turn, fl + turn) < 0 ? -1 : 1;
                for (int c = 0; c < width; c++) {
                    t[c] += phi[l] * (turn >= 0 && c >= turn && c < turn + 4 ? sign : 1) * fl[c];
                }
            }
            if (turn >= 0) {
                spari_quat_normalise(t + turn);
            }
        }
    }
}

void spari_resample_loads(int elements, int P, int n, const double *loads, double *out) {
    if (P == n) {
        memcpy(out, loads, (size_t)(6 * (int64_t)elements * P) * sizeof *out);
        return;
    }
    double x[SPARI_MAX_NODES], phi[SPARI_MAX_NODES];
    places_of(P, x);
    memset(out, 0, (size_t)(6 * (int64_t)elements * n) * sizeof *out);
    for (int l = 0; l < P; l++) {
        spari_resample_basis(n, x[l], phi);
        for (int e = 0; e < elements; e++) {
            for (int k = 0; k < n; k++) {
                for (int c = 0; c < 6; c++) {
                    out[6 * ((int64_t)e * n + k) + c] += phi[k] * loads[6 * ((int64_t)e * P + l) + c];
                }
            }
        }
    }
}
