#include "lines.h"

#include <gsl/gsl_sf_legendre.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

double line_random(unsigned long long *state) {
    unsigned long long x = *state;
    x ^= x << 13, x ^= x >> 7, x ^= x << 17; /* Marsaglia's xorshift64 */
    *state = x;
    return (double)(x >> 11) / 4503599627370496.0 - 1.0;
}

/* GLL points by bisection on P'_m between the extrema of cosines: slow, and not the library's way. */
static double legendre_slope(int m, double x) {
    double p[LINE_NODES + 1], d[LINE_NODES + 1];
    gsl_sf_legendre_Pl_deriv_array(m, x, p, d);
    return d[m];
}

static void gll_points(int n, double *x) {
    int m = n - 1, found = 1, steps = 4000;
    x[0] = -1, x[m] = 1;
    for (int k = 1; k < steps && found < m; k++) {
        double a = -cos(M_PI * (k - 0.5) / steps), b = -cos(M_PI * (k + 0.5) / steps);
        double fa = legendre_slope(m, a), fb = legendre_slope(m, b);
        if ((fa < 0) == (fb < 0)) {
            continue;
        }
        for (int i = 0; i < 80; i++) {
            double c = 0.5 * (a + b), fc = legendre_slope(m, c);
            if ((fc < 0) == (fa < 0)) {
                a = c;
            } else {
                b = c;
            }
        }
        x[found++] = 0.5 * (a + b);
    }
}

static void prepare(polyline *l) {
    for (int j = 0; j < l->nodes; j++) {
        l->weight[j] = 1;
        for (int k = 0; k < l->nodes; k++) {
            if (k != j) {
                l->weight[j] /= 2 * (l->gll[j] - l->gll[k]);
            }
        }
    }
    l->scale = 0;
    for (int i = 0; i < 3; i++) {
        double low = l->x[0][i], high = low;
        for (int j = 1; j < l->elements * l->nodes; j++) {
            low = fmin(low, l->x[j][i]), high = fmax(high, l->x[j][i]);
        }
        l->scale = fmax(l->scale, high - low);
    }
    l->samples = 100 * l->nodes;
    l->sample = malloc(sizeof *l->sample * (size_t)(l->elements * (l->samples + 1)));
    for (int e = 0; e < l->elements; e++) {
        for (int k = 0; k <= l->samples; k++) {
            line_at(l, e, -1 + 2.0 * k / l->samples, l->sample[e * (l->samples + 1) + k]);
        }
    }
}

static void start(polyline *l, int elements, int nodes) {
    memset(l, 0, sizeof *l);
    l->elements = elements, l->nodes = nodes;
    gll_points(nodes, l->gll);
}

void line_of_shape(polyline *l, int elements, int nodes, line_shape shape) {
    start(l, elements, nodes);
    for (int j = 0; j < elements * nodes; j++) {
        shape((j / nodes + 0.5 * (1 + l->gll[j % nodes])) / elements, l->x[j]);
    }
    prepare(l);
}

void line_of_nodes(polyline *l, int elements, int nodes, const double *x) {
    start(l, elements, nodes);
    memcpy(l->x, x, sizeof l->x[0] * (size_t)(elements * nodes));
    prepare(l);
}

void line_at_random(polyline *l, int nodes, double decay, unsigned long long *state) {
    start(l, 1, nodes);
    double size = 1;
    for (int k = 0; k<nodes; k++, size *= k> 1 ? decay : 1) {
        double c[3] = {size * line_random(state), size * line_random(state), size * line_random(state)};
        for (int j = 0; j < nodes; j++) {
            for (int i = 0; i < 3; i++) {
                l->x[j][i] += c[i] * cos(k * acos(l->gll[j]));
            }
        }
    }
    prepare(l);
}

void line_free(polyline *l) {
    free(l->sample);
}

/* Second (true) form of the barycentric formula. */
void line_at(const polyline *l, int element, double xi, double x[3]) {
    double sum = 0;
    x[0] = x[1] = x[2] = 0;
    for (int j = 0; j < l->nodes; j++) {
        const double *node = l->x[element * l->nodes + j];
        if (xi == l->gll[j]) {
            memcpy(x, node, 3 * sizeof *x);
            return;
        }
        double w = l->weight[j] / (xi - l->gll[j]);
        sum += w;
        for (int i = 0; i < 3; i++) {
            x[i] += w * node[i];
        }
    }
    for (int i = 0; i < 3; i++) {
        x[i] /= sum;
    }
}

void line_slope(const polyline *l, int element, double xi, double dx[3]) {
    const double h = 1e-4;
    double a[3], b[3], c[3], d[3];
    line_at(l, element, xi - h, a), line_at(l, element, xi + h, b);
    line_at(l, element, xi - 2 * h, c), line_at(l, element, xi + 2 * h, d);
    for (int i = 0; i < 3; i++) {
        dx[i] = (8 * (b[i] - a[i]) - (d[i] - c[i])) / (12 * h);
    }
}

void line_curve(const polyline *l, int element, double xi, double ddx[3]) {
    const double h = 1e-3;
    double a[3], b[3], m[3], c[3], d[3];
    line_at(l, element, xi - h, a), line_at(l, element, xi + h, b), line_at(l, element, xi, m);
    line_at(l, element, xi - 2 * h, c), line_at(l, element, xi + 2 * h, d);
    for (int i = 0; i < 3; i++) {
        ddx[i] = (16 * (a[i] + b[i]) - (c[i] + d[i]) - 30 * m[i]) / (12 * h * h);
    }
}

static double square(const double a[3], const double b[3]) {
    double s = 0;
    for (int i = 0; i < 3; i++) {
        s += (a[i] - b[i]) * (a[i] - b[i]);
    }
    return s;
}

/* Golden section between two samples. */
static double sharpen(const polyline *l, int element, double a, double b, const double p[3]) {
    const double g = 0.6180339887498949;
    double x[3], c = b - g * (b - a), d = a + g * (b - a), fc, fd;
    line_at(l, element, c, x), fc = square(x, p);
    line_at(l, element, d, x), fd = square(x, p);
    while (b - a > 1e-15) {
        if (fc < fd) {
            b = d, d = c, fd = fc, c = b - g * (b - a);
            line_at(l, element, c, x), fc = square(x, p);
        } else {
            a = c, c = d, fc = fd, d = a + g * (b - a);
            line_at(l, element, d, x), fd = square(x, p);
        }
        if (d <= c) {
            break;
        }
    }
    return fmin(fc, fd);
}

double line_distance(const polyline *l, const double p[3]) {
    double best = HUGE_VAL;
    for (int e = 0; e < l->elements; e++) {
        const double(*s)[3] = (const double(*)[3])l->sample + e * (l->samples + 1);
        for (int k = 0; k <= l->samples; k++) {
            best = fmin(best, square(s[k], p));
        }
    }
    double reach = sqrt(best) + 2e-3 * l->scale; /* a minimum between samples is not farther below them than this */
    for (int e = 0; e < l->elements; e++) {
        const double(*s)[3] = (const double(*)[3])l->sample + e * (l->samples + 1);
        for (int k = 0; k <= l->samples; k++) {
            double here = square(s[k], p);
            if (here <= reach * reach && (k == 0 || here <= square(s[k - 1], p)) &&
                (k == l->samples || here <= square(s[k + 1], p))) {
                double h = 2.0 / l->samples, xi = -1 + k * h;
                best = fmin(best, sharpen(l, e, fmax(-1, xi - h), fmin(1, xi + h), p));
            }
        }
    }
    return sqrt(best);
}
