/* Extrapolation in time, and the past values that it needs. */
#ifndef SPARI_PREDICTOR_H
#define SPARI_PREDICTOR_H

#include "../base/status.h"

#include <stdlib.h>
#include <string.h>

/* An extrapolation over dt through values at a distance a amplifies their error by dt/a or more (a first step of
   1e-30 s followed by one of 1 ms: 1e27). So dt may be at most this multiple of the last step, and a quadratic is
   used only if its three values are no closer together than that. */
enum { SPARI_REACH = 10 };

/* Weights at t^{n+1} of the values at t^n, t^{n-1}, t^{n-2}, for a polynomial of `order` 0, 1 or 2.
   last[0]: the step to t^n; last[1]: the step before it
   Order 1 is (T11), f^n + dt^{n+1}/dt^n (f^n - f^{n-1}). */
static inline void spari_predictor(int order, double dt, const double last[2], double w[3]) {
    w[0] = 1, w[1] = w[2] = 0;
    dt = dt > SPARI_REACH * last[0] ? SPARI_REACH * last[0] : dt;
    if (order == 1 || (order == 2 && last[0] > SPARI_REACH * last[1])) {
        w[1] = -dt / last[0];
        w[0] = 1 - w[1];
    } else if (order == 2) {
        double a = last[0], b = last[0] + last[1]; /* the earlier values are at 0, -a, -b */
        w[0] = (dt + a) * (dt + b) / (a * b);
        w[1] = -dt * (dt + b) / (a * (b - a));
        w[2] = dt * (dt + a) / (b * (b - a));
    }
}

/* Allocates past values [n] at t^n, t^{n-1}, ... for an order; new arrays are zero, arrays beyond the order are
   freed. SPAR_ERR_MEMORY: existing arrays are unchanged. */
static inline int spari_history_keep(double *past[3], int64_t n, int order) {
    for (int k = 0; k <= order; k++) {
        past[k] = past[k] ? past[k] : spari_zalloc(n, sizeof **past);
        if (!past[k]) {
            return SPAR_ERR_MEMORY;
        }
    }
    for (int k = order + 1; k < 3; k++) {
        free(past[k]);
        past[k] = NULL;
    }
    return SPAR_OK;
}

/* Shifts the values one step back: `now` [n] becomes the value at t^n. */
static inline void spari_history_shift(double *past[3], int64_t n, int order, const double *now) {
    double *oldest = past[order];
    for (int k = order; k > 0; k--) {
        past[k] = past[k - 1];
    }
    past[0] = oldest;
    if (n > 0) {
        memcpy(oldest, now, sizeof *now * (size_t)n);
    }
}

#endif
