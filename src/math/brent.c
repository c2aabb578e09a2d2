/* Brent's method (Algorithms for Minimization without Derivatives, 1973, chapter 4): secants and inverse parabolas
   where they shrink the bracket fast enough, halves else. */
#include "brent.h"

#include <float.h>
#include <math.h>

/* The step from b by the parabola x(f) through three points, or by the secant where two of them are one. */
static double interpolated_step(double a, double fa, double b, double fb, double c, double fc) {
    double s = fb / fa;
    if (a == c) {
        return (c - b) * s / (s - 1);
    }
    double q = fa / fc, r = fb / fc;
    return s * ((b - a) * (r - 1) - (c - b) * q * (q - r)) / ((q - 1) * (r - 1) * (s - 1));
}

double spari_brent(double (*f)(double x, void *self), void *self, double a, double b, double width, int most) {
    double fa = f(a, self), fb = f(b, self);
    if (!isfinite(fa) || !isfinite(fb) || (fa < 0 && fb < 0) || (fa > 0 && fb > 0)) {
        return NAN;
    }
    /* b is the best so far, a the one before, c has the other sign than b */
    double c = a, fc = fa, step = b - a, before = step;
    for (int i = 0; i < most; i++) {
        if ((fb < 0) == (fc < 0) && fb != 0) {
            c = a, fc = fa, step = before = b - a;
        }
        if (fabs(fc) < fabs(fb)) {
            a = b, fa = fb, b = c, fb = fc, c = a, fc = fa;
        }
        double least = 2 * DBL_EPSILON * fabs(b) + 0.5 * width, half = 0.5 * (c - b);
        if (fabs(half) <= least || fb == 0) {
            return b;
        }
        double try = fabs(before) >= least && fabs(fa) > fabs(fb) ? interpolated_step(a, fa, b, fb, c, fc) : NAN;
        /* on the side of c, within three quarters of the way, and less than half of the step before the last */
        int well = try * half > 0 && fabs(try) < 1.5 * fabs(half) - 0.5 * least && fabs(try) < 0.5 * fabs(before);
        before = well ? step : half;
        step = well ? try : half
            ;
        a = b, fa = fb;
        b += fabs(step) > least ? step : copysign(least, half);
        fb = f(b, self);
        if (isnan(fb)) {
            return NAN;
        }
    }
    return b;
}
