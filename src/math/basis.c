/* Quadrature points and weights, and Lagrange polynomials: see basis.h. */
#include "basis.h"

#include <math.h>

/* Legendre P_n(x) and P_{n-1}(x) by the three-term recurrence, n >= 1. */
static double legendre(int n, double x, double *before) {
    double p0 = 1, p1 = x;
    for (int k = 1; k < n; k++) {
        double p2 = ((2 * k + 1) * x * p1 - k * p0) / (k + 1);
        p0 = p1, p1 = p2;
    }
    *before = p0;
    return p1;
}

/* The inner nodes are the zeros of P'_m, m = n - 1: Newton on (1 - x^2) P'_m = m (P_{m-1} - x P_m), whose derivative is
   -m (m + 1) P_m. Barycentric weights 1 / P_m(x_j), weights 2 / (m (m + 1) P_m^2). */
void spari_gll(int n, double *x, double *w, double *bary) {
    if (n == 1) {
        if (x) {
            x[0] = 0;
        }
        if (w) {
            w[0] = 2;
        }
        if (bary) {
            bary[0] = 1;
        }
        return;
    }
    int m = n - 1;
    for (int i = 0; i < n; i++) {
        int mirror = i > m - i; /* keeps the nodes exactly symmetric */
        int j = mirror ? m - i : i;
        double t = -cos(3.14159265358979323846 * j / m), before;
        if (2 * j == m) {
            t = 0;
        } else if (j > 0) {
            for (int k = 0; k < 50; k++) {
                double p = legendre(m, t, &before), step = (before - t * p) / ((m + 1) * p);
                t += step;
                if (fabs(step) < 1e-16) {
                    break;
                }
            }
        } else {
            t = -1;
        }
        t = mirror ? -t : t;
        double p = legendre(m, t, &before);
        if (x) {
            x[i] = t;
        }
        if (w) {
            w[i] = 2.0 / ((double)m * (m + 1) * p * p);
        }
        if (bary) {
            bary[i] = 1.0 / p;
        }
    }
}

/* Newton's method on P_n, with P'_n (1 - x^2) = n (P_{n-1} - x P_n). Long double, where it has more digits, leaves
   nothing but the last rounding. */
void spari_gauss(int n, double *x, double *w) {
    for (int i = 0; i <= n / 2; i++) {
        int j = n - 1 - i; /* points in exactly symmetric pairs */
        long double t = 2 * i + 1 == n ? 0 : -cosl(3.14159265358979323846L * (4 * i + 3) / (4 * n + 2)), weight = 0;
        for (int pass = 0, near = 0; pass < 8 && near < 2 && i <= j; pass++) {
            long double before = 1, at = t;
            for (int k = 1; k < n; k++) {
                long double next = ((2 * k + 1) * t * at - k * before) / (k + 1);
                before = at, at = next;
            }
            long double slope = n * (before - t * at) / (1 - t * t);
            weight = 2 / ((1 - t * t) * slope * slope);
            t -= 2 * i + 1 == n ? 0 : at / slope;
            near += fabsl(at / slope) < 1e-10L; /* once: the next step is the last, and the weight that of the root */
        }
        if (i <= j) {
            x[i] = (double)t, x[j] = (double)-t;
            w[i] = w[j] = (double)weight;
        }
    }
}

void spari_lagrange(int n, const double *x, const double *bary, double xi, double *phi, double *dphi) {
    int at = -1;
    double sum = 0;
    for (int j = 0; j < n; j++) {
        if (xi == x[j]) {
            at = j;
            break;
        }
        phi[j] = bary[j] / (xi - x[j]);
        sum += phi[j];
    }
    for (int j = 0; j < n; j++) {
        phi[j] = at >= 0 ? (j == at) : phi[j] / sum;
    }
    if (!dphi) {
        return;
    }
    /* phi_j' is a polynomial: interpolating its nodal values D_mj by phi_m is exact */
    for (int j = 0; j < n; j++) {
        double d = 0, diagonal = 0;
        for (int m = 0; m < n; m++) {
            if (m != j) {
                d += phi[m] * (bary[j] / bary[m]) / (x[m] - x[j]);
                diagonal -= (bary[m] / bary[j]) / (x[j] - x[m]);
            }
        }
        dphi[j] = d + phi[j] * diagonal;
    }
}

/* A distributed load p has the moments sum of P_k(x_j) f_j with Legendre polynomials P_k, which are combinations of
   the basis. The integral of P_k beyond xi is (P_{k-1} - P_{k+1})(xi) / (2 k + 1). */
void spari_share_beyond(int n, const double *x, double xi, double *share) {
    double beyond[SPARI_MAX_NODES], older = 1, old = xi;
    for (int k = 1; k < n; k++) {
        const double next = ((2 * k + 1) * xi * old - k * older) / (k + 1);
        beyond[k] = older - next;
        older = old, old = next;
    }
    for (int j = 0; j < n; j++) {
        double sum = 1 - xi, before = 1, at = x[j];
        for (int k = 1; k < n; k++) {
            sum += beyond[k] * at;
            const double next = ((2 * k + 1) * x[j] * at - k * before) / (k + 1);
            before = at, at = next;
        }
        share[j] = 0.5 * sum;
    }
}
