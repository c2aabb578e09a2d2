/* Least-squares fit of a derivative to noisy secants: see secants.h. */
#include "secants.h"

#include "../base/status.h"
#include "eigen.h"

#include <math.h>
#include <string.h>

enum { MOST = SPARI_SECANTS_MOST };

typedef struct secant {
    spari_secant of;
    double size; /* of x */
} secant;

struct spari_secants {
    int64_t n;
    int most, count, rank;
    double filter, gain; /* linear independence threshold; largest |w| / |x| */
    double rho;          /* fraction of a change that recurs in the next response */
    secant column[MOST];
    double at[MOST][MOST]; /* of column j, of unit size, in the basis: at[j][i] */
    double *q, *p, *u;     /* [most][n]: the basis, orthonormal; its images; J of it */
    double a[MOST][MOST], workspace[SPARI_SYMMETRIC_ROOM(MOST)];
};

spari_secants *spari_secants_create(int64_t n, int most) {
    spari_secants *s = spari_zalloc(1, sizeof *s);
    if (!s) {
        return NULL;
    }
    s->n = n;
    s->most = most < MOST ? most : MOST;
    if (!(s->q = spari_zalloc(s->most * n, sizeof *s->q)) || !(s->p = spari_zalloc(s->most * n, sizeof *s->p)) ||
        !(s->u = spari_zalloc(s->most * n, sizeof *s->u))) {
        spari_secants_free(s);
        return NULL;
    }
    return s;
}

void spari_secants_free(spari_secants *s) {
    if (s) {
        SPARI_FREE(s->q, s->p, s->u, s);
    }
}

void spari_secants_begin(spari_secants *s, double filter) {
    s->count = s->rank = 0;
    s->filter = filter;
    s->gain = s->rho = 0;
}

static double product(const double *a, const double *b, int64_t n) {
    double sum = 0;
    for (int64_t i = 0; i < n; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

static void add_times(double f, const double *a, double *b, int64_t n) {
    for (int64_t i = 0; i < n; i++) {
        b[i] += f * a[i];
    }
}

/* q, p: x and its image divided by the size of x, minus their projection onto the basis; parts[rank]: its
   coefficients. Returns the norm of the remainder. */
static double split(const spari_secants *s, const secant *c, double *q, double *p, double *parts) {
    int64_t n = s->n;
    for (int64_t i = 0; i < n; i++) {
        q[i] = (c->of.w[i] - c->of.v[i]) / c->size;
        p[i] = (c->of.iw[i] - c->of.iv[i]) / c->size;
    }
    for (int pass = 0; pass < 2; pass++) {
        for (int j = 0; j < s->rank; j++) {
            double part = product(s->p + j * n, q, n);
            parts[j] += part;
            add_times(-part, s->q + j * n, q, n);
            add_times(-part, s->p + j * n, p, n);
        }
    }
    return sqrt(fmax(product(q, p, n), 0));
}

/* size of x = w - v */
static double secant_size(const spari_secant *c, int64_t n) {
    double sum = 0;
    for (int64_t i = 0; i < n; i++) {
        sum += (c->w[i] - c->v[i]) * (c->iw[i] - c->iv[i]);
    }
    return sqrt(fmax(sum, 0));
}

int spari_secants_add(spari_secants *s, const spari_secant *column) {
    if (s->count == s->most) {
        return 0;
    }
    int64_t n = s->n;
    secant *c = s->column + s->count;
    double *q = s->q + s->rank * n, *p = s->p + s->rank * n, *at = s->at[s->count];
    *c = (secant){*column, secant_size(column, n)};
    if (!(c->size > 0) || !isfinite(c->size)) {
        return 1;
    }
    memset(at, 0, sizeof s->at[0]);
    double left = split(s, c, q, p, at);
    s->gain = fmax(s->gain, sqrt(fmax(product(column->w, column->iw, n), 0)) / c->size);
    if (left > s->filter) {
        for (int64_t i = 0; i < n; i++) {
            q[i] /= left;
            p[i] /= left;
        }
        at[s->rank++] = left;
    }
    s->count++;
    return 1;
}

/* a := a^-1 for symmetric positive definite a, by Gauss-Jordan elimination */
static void invert(double a[MOST][MOST], int n) {
    for (int i = 0; i < n; i++) {
        double pivot = 1 / a[i][i];
        a[i][i] = 1;
        for (int j = 0; j < n; j++) {
            a[i][j] *= pivot;
        }
        for (int k = 0; k < n; k++) {
            double f = a[k][i];
            for (int j = 0; j < n && k != i; j++) {
                a[k][j] = (j == i ? 0 : a[k][j]) - f * a[i][j];
            }
        }
    }
}

/* x of c . S what, where `what` belongs to a column of this size, divided by both sizes */
static double answered(const secant *c, const double *what, double size, int64_t n) {
    double sum = 0;
    for (int64_t i = 0; i < n; i++) {
        sum += (c->of.iw[i] - c->of.iv[i]) * what[i];
    }
    return sum / (c->size * size);
}

void spari_secants_tell(const spari_secants *s, int newest, spari_asymmetry *sum) {
    for (int k = 0; k < s->count && k < newest; k++) {
        const secant *c = s->column + k;
        double itself = answered(c, c->of.w, c->size, s->n);
        sum->symmetric += 2 * itself * itself;
        for (int l = k + 1; l < s->count; l++) {
            const secant *d = s->column + l;
            if (c->of.b && d->of.b) {
                double one = answered(c, d->of.w, d->size, s->n), other = answered(d, c->of.w, c->size, s->n);
                double w = one - other, b = answered(c, d->of.b, d->size, s->n) - answered(d, c->of.b, c->size, s->n);
                sum->both += w * b, sum->ww += w * w, sum->bb += b * b;
                sum->symmetric += (one + other) * (one + other);
                sum->pairs++;
            }
        }
    }
}

void spari_secants_remember(spari_secants *s, double rho) {
    s->rho = rho;
}

/* Weights of the columns in the fit: a longer column has relatively less noise of constant size. The weight is the
   fourth root of the length; no weight, the square root and the length itself were worse on the flows of the
   coupling benchmark. If the fluid has memory, columns without b get little weight. */
static void weigh_columns(const spari_secants *s, double weight[MOST]) {
    static const double UNKNOWN = 1e-2;
    double longest = 0;
    for (int k = 0; k < s->count; k++) {
        longest = fmax(longest, s->column[k].size);
    }
    for (int k = 0; k < s->count; k++) {
        weight[k] = sqrt(sqrt(s->column[k].size / longest)) * (s->rho > 0 && !s->column[k].of.b ? UNKNOWN : 1);
    }
}

int spari_secants_fit(spari_secants *s, double doubt) {
    int m = s->rank;
    double weight[MOST];
    weigh_columns(s, weight);
    for (int i = 0; i < m; i++) {
        for (int j = 0; j < m; j++) {
            s->a[i][j] = i == j ? doubt : 0;
            for (int k = 0; k < s->count; k++) {
                s->a[i][j] += weight[k] * s->at[k][i] * s->at[k][j];
            }
        }
    }
    invert(s->a, m);
    memset(s->u, 0, (size_t)(m * s->n) * sizeof *s->u);
    for (int k = 0; k < s->count; k++) {
        for (int j = 0; j < m; j++) {
            double f = 0;
            for (int i = 0; i < m; i++) {
                f += weight[k] * s->at[k][i] * s->a[i][j];
            }
            const spari_secant *c = &s->column[k].of;
            add_times(f / s->column[k].size, c->w, s->u + j * s->n, s->n);
            if (s->rho > 0 && c->b) {
                add_times(-s->rho * f / s->column[k].size, c->b, s->u + j * s->n, s->n);
            }
        }
    }
    return m;
}

double spari_secants_defect(spari_secants *s, const spari_secant *column) {
    static const double FAR = 0.3, CARE = 2;
    int64_t n = s->n;
    double parts[MOST] = {0}, off = 0, seen = 0;
    secant c = {*column, secant_size(column, n)};
    if (s->rank == 0 || s->rank == s->most || !(c.size > 0) || !isfinite(c.size)) {
        return -1;
    }
    double left = split(s, &c, s->q + s->rank * n, s->p + s->rank * n, parts);
    if (!(left <= FAR)) {
        return -1;
    }
    for (int i = 0; i < s->rank; i++) {
        const double *p = s->p + i * n;
        double was = product(p, column->w, n), says = s->rho > 0 && column->b ? s->rho * product(p, column->b, n) : 0;
        for (int j = 0; j < s->rank; j++) {
            says += c.size * parts[j] * product(p, s->u + j * n, n);
        }
        off += (was - says) * (was - says);
        seen += was * was;
    }
    return seen > 0 ? fmax(sqrt(off) - CARE * s->gain * left * c.size, 0) / sqrt(seen) : -1;
}

int spari_secants_step(spari_secants *s, const double *x, const double *r, double length, double longest,
                       double *next) {
    int m = s->rank;
    int64_t n = s->n;
    double b[MOST] = {0}, y[MOST] = {0}, value[MOST], *e = s->a[0]; /* [m][m]: I - J, then its eigenvectors */
    for (int i = 0; i < m; i++) {
        const double *p = s->p + i * n;
        for (int64_t k = 0; k < n; k++) {
            b[i] += p[k] * r[k];
        }
        for (int j = 0; j <= i; j++) {
            double both = product(p, s->u + j * n, n) + product(s->p + j * n, s->u + i * n, n);
            e[m * i + j] = e[m * j + i] = (i == j) - 0.5 * both;
        }
    }
    if (m > 0 && spari_symmetric(m, e, value, s->workspace) != SPAR_OK) {
        return 0;
    }
    for (int k = 0; k < m; k++) { /* an added mass makes I - J at least I */
        double along = product(e + m * k, b, m) / fmax(fabs(value[k]), 1);
        add_times(along, e + m * k, y, m);
    }
    double square = length * length;
    for (int64_t i = 0; i < n; i++) {
        next[i] = r[i];
    }
    for (int j = 0; j < m; j++) {
        add_times(y[j] - b[j], s->q + j * n, next, n);
        square += y[j] * y[j] - b[j] * b[j];
    }
    double cut = square > longest * longest ? longest / sqrt(square) : 1;
    for (int64_t i = 0; i < n; i++) {
        next[i] = x[i] + cut * next[i];
    }
    return spari_first_nonfinite(next, n) < 0;
}
