/* Extrapolation in time. */
#ifndef SPARI_PREDICTOR_H
#define SPARI_PREDICTOR_H

/* Weights at t^{n+1} of the values at t^n, t^{n-1}, t^{n-2}: the polynomial of `order` 0, 1 or 2 through them, steps of
   any length, last[0] the step to t^n and last[1] the one before. Order 1 is the spec's f + dt^{n+1}/dt^n (f^n -
   f^{n-1}). */
static inline void spari_predictor(int order, double dt, const double last[2], double w[3]) {
    w[0] = 1, w[1] = w[2] = 0;
    if (order == 1) {
        w[1] = -dt / last[0];
        w[0] = 1 - w[1];
    } else if (order == 2) {
        double a = last[0], b = last[0] + last[1]; /* the earlier values stand at 0, -a, -b */
        w[0] = (dt + a) * (dt + b) / (a * b);
        w[1] = -dt * (dt + b) / (a * (b - a));
        w[2] = dt * (dt + a) / (b * (b - a));
    }
}

#endif
