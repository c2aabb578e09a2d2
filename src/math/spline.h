/* Interpolation of tabulated values: straight lines, cubic splines, Akima's curves. */
#ifndef SPARI_SPLINE_H
#define SPARI_SPLINE_H

#include <stdint.h>

typedef enum spari_spline_kind {
    SPARI_SPLINE_LINEAR,
    SPARI_SPLINE_PARABOLA,       /* through three points */
    SPARI_SPLINE_CUBIC,          /* natural: no curvature at the ends */
    SPARI_SPLINE_CUBIC_PERIODIC, /* the first and the last value are equal */
    SPARI_SPLINE_AKIMA,          /* Akima, J. ACM 17, 1970; a corner between two straight pieces stays a corner */
    SPARI_SPLINE_AKIMA_PERIODIC
} spari_spline_kind;

/* The fewest points of a kind. */
int64_t spari_spline_least(spari_spline_kind kind);

/* On interval i, with t = at - x[i]: y[i] + c[i][0] t + c[i][1] t^2 + c[i][2] t^3. The table x, y stays the caller's.
 */
typedef struct spari_spline {
    int64_t n;
    const double *x, *y;
    double (*c)[3]; /* [n] */
} spari_spline;

/* x [n] ascending. 0, or 1: no memory. */
int spari_spline_create(spari_spline *spline, spari_spline_kind kind, int64_t n, const double *x, const double *y);
void spari_spline_free(spari_spline *spline);

/* The value at x[0] <= at <= x[n - 1].
     interval: in, where the search begins, any number >= 0; out, the interval of `at`
     slope: out, the derivative; NULL: not wanted */
double spari_spline_at(const spari_spline *spline, double at, int64_t *interval, double *slope);

#endif
