#include "projection.h"

#include "../math/rotation.h"
#include "../session/status.h"
#include "transfer.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct spari_line {
    int elements, per_element;
    double scale; /* size of the line's box */
    double *c;    /* Chebyshev coefficients [element][mode][3] */
};

spari_line *spari_line_create(int elements, int per_element, const double *x) {
    double m[SPARI_MAX_NODES * SPARI_MAX_NODES];
    spari_line *line = spari_zalloc(1, sizeof *line);
    if (!line) {
        return NULL;
    }
    line->elements = elements, line->per_element = per_element;
    line->c = spari_zalloc((int64_t)elements * per_element * 3, sizeof *line->c);
    if (!line->c) {
        spari_line_free(line);
        return NULL;
    }
    spari_modal_matrix(per_element, m);
    for (int e = 0; e < elements; e++) {
        ptrdiff_t node = (ptrdiff_t)e * per_element;
        for (int k = 0; k < per_element; k++) {
            for (int l = 0; l < per_element; l++) {
                for (int i = 0; i < 3; i++) {
                    line->c[3 * (node + k) + i] += m[k * per_element + l] * x[3 * (node + l) + i];
                }
            }
        }
    }
    for (int i = 0; i < 3; i++) {
        double low = x[i], high = x[i];
        for (ptrdiff_t l = 1; l < (ptrdiff_t)elements * per_element; l++) {
            low = fmin(low, x[3 * l + i]), high = fmax(high, x[3 * l + i]);
        }
        line->scale = fmax(line->scale, high - low);
    }
    return line;
}

void spari_line_free(spari_line *line) {
    if (line) {
        free(line->c);
        free(line);
    }
}

/* Place, first and second derivative by the recurrences of T_k, T_k' and T_k''. */
static void evaluate(const spari_line *line, int element, double xi, double x[3], double dx[3], double ddx[3]) {
    const double *c = line->c + (ptrdiff_t)element * line->per_element * 3;
    double t0 = 1, t1 = xi, d0 = 0, d1 = 1, s0 = 0, s1 = 0;
    for (int i = 0; i < 3; i++) {
        x[i] = c[i], dx[i] = 0, ddx[i] = 0;
    }
    for (int k = 1; k < line->per_element; k++) {
        for (int i = 0; i < 3; i++) {
            double a = c[3 * k + i];
            x[i] += a * t1, dx[i] += a * d1, ddx[i] += a * s1;
        }
        double t2 = 2 * xi * t1 - t0, d2 = 2 * t1 + 2 * xi * d1 - d0, s2 = 4 * d1 + 2 * xi * s1 - s0;
        t0 = t1, t1 = t2, d0 = d1, d1 = d2, s0 = s1, s1 = s2;
    }
}

void spari_line_point(const spari_line *line, int element, double xi, double x[3], double dx[3]) {
    double d[3], s[3];
    evaluate(line, element, xi, x, dx ? dx : d, s);
}

/* A candidate foot. */
typedef struct foot {
    int element;
    double xi, square, x[3];
} foot;

static double slope(const spari_line *line, const double p[3], foot *f, double *curve) {
    double d[3], s[3], r[3];
    evaluate(line, f->element, f->xi, f->x, d, s);
    for (int i = 0; i < 3; i++) {
        r[i] = f->x[i] - p[i];
    }
    f->square = spari_dot(r, r);
    *curve = spari_dot(d, d) + spari_dot(r, s);
    return spari_dot(r, d);
}

/* Newton on half the slope of the squared distance, kept in [low, high] by bisection. */
static void refine(const spari_line *line, const double p[3], double low, double high, foot *f) {
    for (int k = 0; k < 80; k++) {
        double curve, g = slope(line, p, f, &curve);
        if (g > 0) {
            high = f->xi;
        } else {
            low = f->xi;
        }
        double next = curve > 0 ? f->xi - g / curve : 0.5 * (low + high);
        if (!(next >= low && next <= high)) {
            next = 0.5 * (low + high);
        }
        if (fabs(next - f->xi) <= 4e-16) {
            break;
        }
        f->xi = next;
    }
    double curve;
    slope(line, p, f, &curve);
}

/* Takes the better of two feet; of equal ones the earlier, flagged unless they are one place. */
static void compare(const spari_line *line, const foot *f, foot *best, uint8_t *flags) {
    double tie = 1e-12 * (best->square + line->scale * line->scale);
    if (best->square == HUGE_VAL || f->square < best->square - tie) {
        *best = *f, *flags = 0;
    } else if (f->square <= best->square + tie) {
        double apart[3] = {f->x[0] - best->x[0], f->x[1] - best->x[1], f->x[2] - best->x[2]};
        if (spari_norm(apart) > 1e-5 * line->scale) {
            *flags |= SPAR_MAP_AMBIGUOUS;
        }
    }
}

static void project_one(const spari_line *line, const double p[3], foot *best, uint8_t *flags) {
    int samples = 8 * line->per_element;
    best->square = HUGE_VAL;
    *flags = 0;
    for (int e = 0; e < line->elements; e++) {
        for (int k = 0; k <= samples; k++) {
            double h = 2.0 / samples, curve;
            foot f = {.element = e, .xi = k == samples ? 1 : -1 + k * h};
            foot ahead = {.element = e, .xi = fmin(1, f.xi + h)};
            double g = slope(line, p, &f, &curve), g1 = slope(line, p, &ahead, &curve);
            if (k < samples && g < 0 && g1 > 0) {
                double low = f.xi;
                f.xi += 0.5 * h;
                refine(line, p, low, ahead.xi, &f);
            } else if (!((k == 0 && g >= 0) || (k == samples && g <= 0) || (k < samples && g1 == 0))) {
                continue;
            }
            compare(line, &f, best, flags);
        }
    }
    double curve, g = slope(line, p, best, &curve);
    if ((best->element == 0 && best->xi == -1 && g > 0) ||
        (best->element == line->elements - 1 && best->xi == 1 && g < 0)) {
        *flags |= SPAR_MAP_END;
    }
}

void spari_line_project(const spari_line *line, int method, int64_t n, const double *x, int *element, double *xi,
                        double *feet, uint8_t *flags) {
    (void)method;
    for (int64_t j = 0; j < n; j++) {
        foot best = {0};
        flags[j] = 0;
        if (line->per_element > 1) {
            project_one(line, x + 3 * j, &best, &flags[j]);
        } else {
            spari_line_point(line, 0, 0, best.x, NULL);
        }
        element[j] = best.element, xi[j] = best.xi;
        memcpy(feet + 3 * j, best.x, sizeof best.x);
    }
}
