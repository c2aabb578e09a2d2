/* Interpolation of tabulated values: see spline.h. Every kind becomes one cubic polynomial on each interval. */
#include "spline.h"

#include "../base/status.h"

#include <math.h>
#include <stdlib.h>

int64_t spari_spline_least(spari_spline_kind kind) {
    static const int64_t least[] = {2, 3, 3, 2, 5, 5};
    return least[kind];
}

static double length_of(const spari_spline *s, int64_t i) {
    return s->x[i + 1] - s->x[i];
}

static double chord(const spari_spline *s, int64_t i) {
    return (s->y[i + 1] - s->y[i]) / length_of(s, i);
}

/* The polynomials from the half curvatures c[i][1] at all points. */
static void finish_curvatures(spari_spline *s) {
    for (int64_t i = 0; i + 1 < s->n; i++) {
        double h = length_of(s, i), here = s->c[i][1], next = s->c[i + 1][1];
        s->c[i][0] = chord(s, i) - h * (next + 2 * here) / 3;
        s->c[i][2] = (next - here) / (3 * h);
    }
}

/* The slope has no step at points first .. last: h[i-1] m[i-1] + 2 (h[i-1] + h[i]) m[i] + h[i] m[i+1] =
   3 (chord[i] - chord[i-1]) for the half curvatures m = c[.][1], which hold the right side at first. Gauss's
   elimination; c[i][0] keeps the ratio of the upper entry to the pivot. */
static void solve_curvatures(const spari_spline *s, int64_t first, int64_t last) {
    double before = 0;
    for (int64_t i = first; i <= last; i++) {
        double left = i > first ? length_of(s, i - 1) : 0;
        double pivot = 2 * (length_of(s, i - 1) + length_of(s, i)) - left * before;
        before = s->c[i][0] = length_of(s, i) / pivot;
        s->c[i][1] = (s->c[i][1] - left * (i > first ? s->c[i - 1][1] : 0)) / pivot;
    }
    for (int64_t i = last - 1; i >= first; i--) {
        s->c[i][1] -= s->c[i][0] * s->c[i + 1][1];
    }
}

static void fit_natural(spari_spline *s) {
    int64_t n = s->n;
    for (int64_t i = 1; i + 1 < n; i++) {
        s->c[i][1] = 3 * (chord(s, i) - chord(s, i - 1));
    }
    if (n > 2) {
        solve_curvatures(s, 1, n - 2);
    }
    s->c[0][1] = s->c[n - 1][1] = 0;
    finish_curvatures(s);
}

/* The half curvature z at both ends is one more unknown. The inner ones are p + z q: p as if z were 0, q what z = 1
   adds; the equation of the end gives z. c[.][2] keeps q. */
static void fit_periodic(spari_spline *s) {
    int64_t n = s->n;
    double h = length_of(s, 0), g = length_of(s, n - 2), z = 0;
    for (int64_t i = 1; i + 1 < n; i++) {
        s->c[i][1] = (i == 1 ? -h : 0) - (i == n - 2 ? g : 0);
    }
    if (n > 2) {
        solve_curvatures(s, 1, n - 2);
        for (int64_t i = 1; i + 1 < n; i++) {
            s->c[i][2] = s->c[i][1];
            s->c[i][1] = 3 * (chord(s, i) - chord(s, i - 1));
        }
        solve_curvatures(s, 1, n - 2);
        double right = 3 * (chord(s, 0) - chord(s, n - 2)) - h * s->c[1][1] - g * s->c[n - 2][1];
        z = right / (2 * (h + g) + h * s->c[1][2] + g * s->c[n - 2][2]);
    }
    for (int64_t i = 1; i + 1 < n; i++) {
        s->c[i][1] += z * s->c[i][2];
    }
    s->c[0][1] = s->c[n - 1][1] = z;
    finish_curvatures(s);
}

/* The chord of interval i, also of two beyond either end: continued, or those of the other end. */
static double chord_beyond(const spari_spline *s, int64_t i, int periodic) {
    int64_t all = s->n - 1;
    if (i >= 0 && i < all) {
        return chord(s, i);
    }
    if (periodic) {
        return chord(s, i < 0 ? i + all : i - all);
    }
    int64_t end = i < 0 ? 0 : all - 1, inner = i < 0 ? 1 : all - 2;
    double away = (double)(i < 0 ? -i : i - end);
    return chord(s, end) + away * (chord(s, end) - chord(s, inner));
}

/* The slope at point i, seen from the interval whose chord is `own`. */
static double akima_slope(const spari_spline *s, int64_t i, int periodic, double own) {
    double m[4];
    for (int k = 0; k < 4; k++) {
        m[k] = chord_beyond(s, i - 2 + k, periodic);
    }
    double before = fabs(m[1] - m[0]), after = fabs(m[3] - m[2]);
    return before + after > 0 ? (after * m[1] + before * m[2]) / (before + after) : own;
}

static void fit_akima(spari_spline *s, int periodic) {
    for (int64_t i = 0; i + 1 < s->n; i++) {
        double h = length_of(s, i), m = chord(s, i);
        double from = akima_slope(s, i, periodic, m), to = akima_slope(s, i + 1, periodic, m);
        s->c[i][0] = from;
        s->c[i][1] = (3 * m - 2 * from - to) / h;
        s->c[i][2] = (from + to - 2 * m) / (h * h);
    }
}

int spari_spline_create(spari_spline *s, spari_spline_kind kind, int64_t n, const double *x, const double *y) {
    *s = (spari_spline){n, x, y, spari_zalloc(n, sizeof *s->c)};
    if (!s->c) {
        return 1;
    }
    if (kind == SPARI_SPLINE_CUBIC) {
        fit_natural(s);
    } else if (kind == SPARI_SPLINE_CUBIC_PERIODIC) {
        fit_periodic(s);
    } else if (kind == SPARI_SPLINE_AKIMA || kind == SPARI_SPLINE_AKIMA_PERIODIC) {
        fit_akima(s, kind == SPARI_SPLINE_AKIMA_PERIODIC);
    } else {
        double bend = kind == SPARI_SPLINE_PARABOLA ? (chord(s, 1) - chord(s, 0)) / (x[2] - x[0]) : 0;
        for (int64_t i = 0; i + 1 < n; i++) {
            s->c[i][0] = chord(s, i) - bend * length_of(s, i);
            s->c[i][1] = bend;
        }
    }
    return 0;
}

void spari_spline_free(spari_spline *s) {
    free(s->c);
    s->c = NULL;
}

double spari_spline_at(const spari_spline *s, double at, int64_t *interval, double *slope) {
    int64_t i = *interval < s->n - 1 ? *interval : 0;
    if (!(s->x[i] <= at && at < s->x[i + 1])) {
        int64_t end = s->n - 1;
        for (i = 0; end - i > 1;) {
            int64_t middle = i + (end - i) / 2;
            i = s->x[middle] <= at ? middle : i;
            end = s->x[middle] <= at ? end : middle;
        }
        *interval = i;
    }
    const double *c = s->c[i], t = at - s->x[i];
    if (slope) {
        *slope = c[0] + t * (2 * c[1] + 3 * t * c[2]);
    }
    return at == s->x[i + 1] ? s->y[i + 1] : s->y[i] + t * (c[0] + t * (c[1] + t * c[2]));
}
