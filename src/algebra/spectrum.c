/* Eigenvalues of the small-motion equations nearest to a shift sigma, by shift-and-invert. With y = lambda x the
   quadratic problem is lambda (x, y) = (y, -M^-1 (K x + C y)). Its inverse about the shift, mu = 1 / (lambda -
   sigma),
     T (p, q) = (x, p + sigma x),  x = -P(sigma)^-1 (M (q + sigma p) + C p),  P = K + sigma C + sigma^2 M

   asks for no inverse of M: what has no mass has eigenvalues beyond all numbers, mu = 0. Where motions are held,
   P(sigma) is bordered by G and its transpose, and T takes of its argument only what G allows: what it does not comes
   out as mu = 0 too. Small problems: Schur's form of T as a matrix; large ones: Arnoldi's subspaces, restarted with
   Schur vectors (Stewart 2001). */
#include "../base/status.h"
#include "arnoldi.h"
#include "band.h"
#include "dense.h"
#include "pencil.h"
#include "schur.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A row of G is dependent if its remainder is smaller than this, as in redundant.c. */
static const double dependent_hold = 1e-9;
/* Tolerance of T z = mu z. A larger residual means that rounding dominates the eigenvalue. */
static const double spectrum_residual = 1e-6;
/* |mu| of massless unknowns, relative to the largest. */
static const double massless = 1e-9;
/* only_rounding: if P x is smaller than this relative to its terms, x is a motion without stiffness. The shift is
   then moved by `beside` times the root of the rounding error. Eigenvalues within without_stiffness times that root
   are such motions. */
static const double only_rounding = 4e-15, beside = 1e4, without_stiffness = 30;
/* Up to this many unknowns are solved as a dense matrix. */
enum { MOST_DENSE = 90 };

typedef struct spectrum {
    spari_pencil *p;
    int n, all;                  /* unknowns; unknowns with multipliers */
    double *d;                   /* [n] scale factors of the unknowns */
    double highest;              /* largest K_ii / M_ii, its root, rad/s */
    int rank;                    /* independent constraints: */
    int *multiplier;             /* [constraints] their number, or -1 if dependent */
    double *Q;                   /* [rank][n] orthonormal rows: the constrained motions */
    spari_pencil_constraint *at; /* [entries + 2 constraint entries]: positions of the entries of the bordered matrix */
    spari_band *band;
    double complex sigma;
    double s;                  /* scale of x relative to y = lambda x */
    double complex *workspace; /* [all + 2 n] */
    double rounding;           /* rounding error of lambda if the matrix is singular at the requested shift; else 0 */
} spectrum;

/* ---- scaling ---- */

/* Scales the unknowns by the roots of their masses, so that sums of squares are energies in any units. Massless
   unknowns get the mass that corresponds to the highest frequency. */
static void scale_pencil(spectrum *a) {
    spari_pencil *p = a->p;
    double *k = a->d, *m = (double *)a->workspace;
    memset(m, 0, (size_t)a->n * sizeof *m);
    for (int64_t i = 0; i < p->entries; i++) {
        const spari_pencil_entry *e = p->entry + i;
        k[e->row] += e->row == e->column ? e->k : 0;
        m[e->row] += e->row == e->column ? e->m : 0;
    }
    double most = 0;
    for (int i = 0; i < a->n; i++) {
        most = m[i] > 0 ? fmax(most, fabs(k[i]) / m[i]) : most;
    }
    a->highest = most > 0 ? sqrt(most) : 1;
    for (int i = 0; i < a->n; i++) {
        double other = fabs(k[i]) / (a->highest * a->highest);
        a->d[i] = m[i] > 0 ? sqrt(m[i]) : other > 0 ? sqrt(other) : 1;
    }
    for (int64_t i = 0; i < p->entries; i++) {
        spari_pencil_entry *e = p->entry + i;
        double f = 1 / (a->d[e->row] * a->d[e->column]);
        e->k *= f, e->c *= f, e->m *= f;
    }
    for (int64_t i = 0; i < p->constraint_entries; i++) {
        p->constraint[i].g /= a->d[p->constraint[i].column];
    }
}

/* ---- constraints ---- */

/* G^T = Q R with column pivoting: independent rows of G, and their span. */
static int find_holds(spectrum *a) {
    spari_pencil *p = a->p;
    int n = a->n, h = p->constraints, most = n < h ? n : h;
    if (h == 0) {
        return SPAR_OK;
    }
    double *G = spari_zalloc((int64_t)n * h, sizeof *G);
    int *order = spari_zalloc(h, sizeof *order);
    a->Q = spari_zalloc((int64_t)most * n, sizeof *a->Q);
    int status = G && order && a->Q ? SPAR_OK : SPAR_ERR_MEMORY;
    if (status == SPAR_OK) {
        for (int64_t i = 0; i < p->constraint_entries; i++) {
            G[(int64_t)n * p->constraint[i].row + p->constraint[i].column] += p->constraint[i].g;
        }
        int rank = spari_independent_rows(h, n, G, dependent_hold, order, most, a->Q);
        status = rank >= 0 ? SPAR_OK : SPAR_ERR_MEMORY;
        for (a->rank = 0; a->rank < rank; a->rank++) {
            a->multiplier[order[a->rank]] = a->rank;
        }
    }
    SPARI_FREE(G, order);
    return status;
}

/* Projects x onto the admissible motions, twice because of rounding. */
static void allow(const spectrum *a, double complex *x) {
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < a->rank; k++) {
            const double *q = a->Q + (int64_t)k * a->n;
            double re = 0, im = 0;
            for (int i = 0; i < a->n; i++) {
                re += q[i] * creal(x[i]);
                im += q[i] * cimag(x[i]);
            }
            for (int i = 0; i < a->n; i++) {
                x[i] -= q[i] * CMPLX(re, im);
            }
        }
    }
}

/* ---- the operator ---- */

static int make_band(spectrum *a) {
    spari_pencil *p = a->p;
    int64_t count = 0;
    a->all = a->n + a->rank;
    for (int64_t i = 0; i < p->entries; i++) {
        a->at[count++] = (spari_pencil_constraint){p->entry[i].row, p->entry[i].column, 0};
    }
    for (int64_t i = 0; i < p->constraint_entries; i++) {
        int k = a->multiplier[p->constraint[i].row];
        if (k >= 0) {
            a->at[count++] = (spari_pencil_constraint){a->n + k, p->constraint[i].column, 0};
        }
    }
    for (int i = 0; i < a->all; i++) {
        a->at[count++] = (spari_pencil_constraint){i, i, 0};
    }
    a->band = spari_band_create(a->all, count, &a->at[0].row, &a->at[0].column, sizeof *a->at);
    return a->band ? SPAR_OK : SPAR_ERR_MEMORY;
}

/* Factors the bordered P(sigma); 0 or 1. */
static int factor_at(spectrum *a, double complex sigma) {
    const spari_pencil *p = a->p;
    double size = 0;
    a->sigma = sigma;
    spari_band_zero(a->band);
    for (int64_t i = 0; i < p->entries; i++) {
        const spari_pencil_entry *e = p->entry + i;
        double complex x = e->k + sigma * (e->c + sigma * e->m);
        size = fmax(size, cabs(x));
        spari_band_add(a->band, e->row, e->column, x);
    }
    for (int64_t i = 0; i < p->constraint_entries; i++) {
        int k = a->multiplier[p->constraint[i].row];
        if (k >= 0) {
            spari_band_add(a->band, a->n + k, p->constraint[i].column, size * p->constraint[i].g);
            spari_band_add(a->band, p->constraint[i].column, a->n + k, size * p->constraint[i].g);
        }
    }
    return spari_band_factor(a->band);
}

/* x [all] := P^-1 x, with the right-hand side in the first n */
static void solve_at(const spectrum *a, double complex *x) {
    memset(x + a->n, 0, (size_t)a->rank * sizeof *x);
    spari_band_solve(a->band, x);
}

/* out [2 n] := T in; x is scaled by s. */
static void apply_inverse(void *self, const double complex *in, double complex *out) {
    const spectrum *a = self;
    const spari_pencil *p = a->p;
    double complex *x = a->workspace, *first = x + a->all, *second = first + a->n;
    for (int i = 0; i < a->n; i++) {
        first[i] = in[i] / a->s;
        second[i] = in[a->n + i];
        x[i] = 0;
    }
    allow(a, first);
    allow(a, second);
    for (int64_t i = 0; i < p->entries; i++) {
        const spari_pencil_entry *e = p->entry + i;
        double complex f = first[e->column];
        x[e->row] -= e->m * (second[e->column] + a->sigma * f) + e->c * f;
    }
    solve_at(a, x);
    for (int i = 0; i < a->n; i++) {
        out[i] = a->s * x[i];
        out[a->n + i] = first[i] + a->sigma * x[i];
    }
}

static double size_of(int n, const double complex *x) {
    double sum = 0;
    for (int i = 0; i < n; i++) {
        sum = hypot(sum, cabs(x[i]));
    }
    return sum;
}

/* Estimated distance of the nearest eigenvalue from the shift, by a few steps of x := P^-1 M x. */
static double near_shift(spectrum *a) {
    enum { STEPS = 4 };
    const spari_pencil *p = a->p;
    double complex *x = a->workspace, *y = x + a->all;
    double square = 0;
    for (int i = 0; i < a->n; i++) {
        y[i] = 1 + 0.3 * sin(12.9898 * (i + 1));
    }
    allow(a, y);
    for (int step = 0; step < STEPS; step++) {
        double before = size_of(a->n, y);
        memset(x, 0, (size_t)a->n * sizeof *x);
        for (int64_t i = 0; i < p->entries; i++) {
            x[p->entry[i].row] += p->entry[i].m * y[p->entry[i].column];
        }
        solve_at(a, x);
        double after = size_of(a->n, x);
        square = after > 0 ? before / after : 0;
        for (int i = 0; i < a->n && after > 0; i++) {
            y[i] = x[i] / after;
        }
        if (!(after > 0) || !isfinite(after)) {
            return 0;
        }
    }
    return sqrt(square);
}

/* For the vector from near_shift: rounding error of lambda due to P(shift); *only: whether P x is rounding error
   alone. */
static double rounding_at(spectrum *a, double complex shift, int *only) {
    const spari_pencil *p = a->p;
    double complex *x = a->workspace, *y = x + a->all;
    double *sum = (double *)(y + a->n), most = 0;
    memset(x, 0, (size_t)a->n * sizeof *x);
    memset(sum, 0, (size_t)a->n * sizeof *sum);
    for (int64_t i = 0; i < p->entries; i++) {
        const spari_pencil_entry *e = p->entry + i;
        double complex f = e->k + shift * (e->c + shift * e->m);
        x[e->row] += f * y[e->column];
        sum[e->row] += cabs(f * y[e->column]);
    }
    allow(a, x);
    for (int i = 0; i < a->n; i++) {
        most = hypot(most, sum[i]);
    }
    double size = size_of(a->n, y);
    *only = size_of(a->n, x) <= only_rounding * most;
    return size > 0 ? sqrt(DBL_EPSILON * most / size) : 0;
}

/* Factors at sigma; 0 or 1. */
static int stand_at(spectrum *a, double complex sigma) {
    double near = factor_at(a, sigma) ? 0 : near_shift(a);
    a->s = fmax(near, cabs(sigma));
    return !(near > 0) || !isfinite(a->s);
}

/* Factors at the shift, or beside it if the matrix is singular there: at an eigenvalue, or at zero with motions
   without stiffness. */
static int begin_at(spectrum *a, double complex shift) {
    const double least = sqrt(DBL_EPSILON) * a->highest; /* its square is the rounding error of the stiffness */
    double some = least;
    int only = 0, bad = stand_at(a, shift);
    if (!bad) {
        (void)rounding_at(a, shift, &only);
    }
    a->rounding = 0;
    if (!bad && !only) {
        return 0;
    }
    if (cabs(shift) > 0) {
        return stand_at(a, shift * (1 + 1e-3)) && stand_at(a, shift * (1 - 1e-3) + 1e-3 * cabs(shift));
    }
    while (bad && some < 1e5 * least) {
        some *= 10;
        bad = stand_at(a, some);
    }
    if (bad) {
        return 1;
    }
    a->rounding = fmax(rounding_at(a, 0, &only), DBL_EPSILON * a->highest);
    return stand_at(a, beside * a->rounding);
}

/* ---- dense solution ---- */

/* Eigenpairs of T: mu, and z [2 n] in rows. */
typedef struct inverse_pairs {
    int count;
    double complex *mu, *z;
} inverse_pairs;

/* GSL's unsymmetric solver does not converge if T has many zero eigenvalues, as with constraints. */
static int solve_dense(spectrum *a, inverse_pairs *found) {
    const int n = 2 * a->n;
    const int64_t size = (int64_t)n * n;
    double complex *S = spari_zalloc(2 * size + 4 * (int64_t)n, sizeof *S), *Q = S + size, *x = Q + size;
    int status = S ? SPAR_OK : SPAR_ERR_MEMORY;
    for (int j = 0; j < n && status == SPAR_OK; j++) {
        x[j] = 1;
        apply_inverse(a, x, x + n);
        x[j] = 0;
        for (int i = 0; i < n; i++) {
            S[(int64_t)n * i + j] = x[n + i];
        }
    }
    status = status == SPAR_OK && spari_schur(n, S, Q, 0, x) ? SPAR_ERR_NUMERIC : status;
    for (int j = 0; j < n && status == SPAR_OK; j++) {
        found->mu[j] = S[(int64_t)(n + 1) * j];
        spari_schur_vector(n, S, Q, j, found->z + (int64_t)n * j, x);
    }
    found->count = status == SPAR_OK ? n : 0;
    free(S);
    return status;
}

/* ---- results ---- */

typedef struct spectrum_choice {
    double complex lambda;
    double apart; /* distance from the shift */
    int from;
} spectrum_choice;

static int by_distance(const void *a, const void *b) {
    const spectrum_choice *x = a, *y = b;
    if (x->apart != y->apart) {
        return x->apart < y->apart ? -1 : 1;
    }
    return (cimag(x->lambda) < cimag(y->lambda)) - (cimag(x->lambda) > cimag(y->lambda));
}

/* Verifies T z = mu z with a new product; eigenvalues made by rounding fail. */
static int is_pair(spectrum *a, double complex mu, const double complex *z, double complex *image) {
    double left = 0, size = 0;
    apply_inverse(a, z, image);
    for (int i = 0; i < 2 * a->n; i++) {
        left = hypot(left, cabs(image[i] - mu * z[i]));
        size = hypot(size, cabs(z[i]));
    }
    return left <= spectrum_residual * cabs(mu) * size && size > 0;
}

/* Selects half of the eigenvalues: the upper one of each conjugate pair. Motions without stiffness have a double
   zero, which rounding splits: they count once. */
static int choose_pairs(spectrum *a, const inverse_pairs *found, double complex shift, spectrum_choice *choice,
                        double complex *image) {
    double most = 0;
    int count = 0, still = 0;
    for (int i = 0; i < found->count; i++) {
        most = fmax(most, cabs(found->mu[i]));
    }
    for (int i = 0; i < found->count; i++) {
        double complex mu = found->mu[i];
        if (!(cabs(mu) > massless * most) || !is_pair(a, mu, found->z + 2 * (int64_t)a->n * i, image)) {
            continue;
        }
        double complex lambda = a->sigma + 1 / mu;
        if (fabs(cimag(lambda)) <= 1e-9 * cabs(lambda)) {
            lambda = creal(lambda);
        }
        int stands = a->rounding > 0 && cabs(lambda) <= without_stiffness * a->rounding;
        lambda = stands ? 0 : lambda;
        if (cimag(lambda) >= 0 && (!stands || still++ % 2 == 0)) {
            choice[count++] = (spectrum_choice){lambda, cabs(lambda - shift), i};
        }
    }
    qsort(choice, (size_t)count, sizeof *choice, by_distance);
    return count;
}

/* Eigenvector x in the units of the unknowns, normalised to x^H M x = 1, its largest scaled entry real. */
static void give_vector(const spectrum *a, const double complex *z, double complex *x) {
    const spari_pencil *p = a->p;
    double complex square = 0, phase = 1;
    double most = 0;
    for (int64_t i = 0; i < p->entries; i++) {
        square += conj(z[p->entry[i].row]) * p->entry[i].m * z[p->entry[i].column];
    }
    for (int i = 0; i < a->n; i++) {
        if (cabs(z[i]) > most * (1 + 1e-6)) {
            most = cabs(z[i]);
            phase = conj(z[i]) / most;
        }
    }
    double f = creal(square) > 0 ? 1 / sqrt(creal(square)) : most > 0 ? 1 / most : 1;
    for (int i = 0; i < a->n; i++) {
        x[i] = f * phase * z[i] / a->d[i];
    }
}

static int solve_about(spectrum *a, int n, int how, inverse_pairs *found) {
    if (how == SPARI_SPECTRUM_DENSE) {
        return solve_dense(a, found);
    }
    const spari_arnoldi_problem of = {apply_inverse, a, 2 * a->n, 2 * (a->n - a->rank)};
    return spari_arnoldi(&of, 2 * n + 2, &found->count, found->mu, found->z);
}

/* Near motions without stiffness the other eigenvalues of T lose digits. So a second pass uses a shift nearer to the
   others. */
static int solve_pairs(spectrum *a, int n, double complex shift, int how, inverse_pairs *found) {
    double nearest = INFINITY;
    if (begin_at(a, shift)) {
        return SPAR_ERR_NUMERIC;
    }
    int status = solve_about(a, n, how, found);
    for (int i = 0; i < found->count && status == SPAR_OK && a->rounding > 0; i++) {
        double size = cabs(a->sigma + 1 / found->mu[i]);
        nearest = size > 1e3 * a->rounding && size < nearest ? size : nearest;
    }
    if (status != SPAR_OK || !isfinite(nearest) || 0.3 * nearest <= cabs(a->sigma)) {
        return status;
    }
    return stand_at(a, 0.3 * nearest) ? SPAR_ERR_NUMERIC : solve_about(a, n, how, found);
}

static int solve_spectrum(spectrum *a, int n, double complex shift, int how, int *count, double complex *value,
                          double complex *x) {
    int64_t all = 2 * (int64_t)a->n, most = how == SPARI_SPECTRUM_DENSE || 2 * n + 2 > all ? all : 2 * n + 2;
    inverse_pairs found = {0, spari_zalloc(most + all, sizeof *found.mu), spari_zalloc(most * all, sizeof *found.z)};
    spectrum_choice *choice = spari_zalloc(most, sizeof *choice);
    int status = found.mu && found.z && choice ? solve_pairs(a, n, shift, how, &found) : SPAR_ERR_MEMORY;
    if (status == SPAR_OK) {
        *count = choose_pairs(a, &found, shift, choice, found.mu + most);
        *count = *count < n ? *count : n;
    }
    for (int k = 0; k < *count && status == SPAR_OK; k++) {
        value[k] = choice[k].lambda;
        give_vector(a, found.z + all * choice[k].from, x + (int64_t)a->n * k);
    }
    SPARI_FREE(found.mu, found.z, choice);
    return status;
}

int spari_spectrum(spari_pencil *p, int n, double complex shift, int how, int *found, double complex *value,
                   double complex *x) {
    spectrum a = {.p = p, .n = p->n, .d = spari_zalloc(p->n, sizeof *a.d)};
    *found = 0;
    if (how == SPARI_SPECTRUM_CHOICE) {
        int left = 2 * p->n;
        how = p->n <= MOST_DENSE || 6 * (n + 1) > left ? SPARI_SPECTRUM_DENSE : SPARI_SPECTRUM_SPARSE;
    }
    a.multiplier = spari_zalloc(p->constraints, sizeof *a.multiplier);
    a.workspace = spari_zalloc(3 * (int64_t)p->n + p->constraints, sizeof *a.workspace);
    a.at = spari_zalloc(p->entries + p->constraint_entries + p->n + p->constraints, sizeof *a.at);
    int status = a.d && a.multiplier && a.workspace && a.at && !p->full ? SPAR_OK : SPAR_ERR_MEMORY;
    for (int i = 0; i < p->constraints && status == SPAR_OK; i++) {
        a.multiplier[i] = -1;
    }
    if (status == SPAR_OK) {
        scale_pencil(&a);
        status = find_holds(&a);
    }
    status = status == SPAR_OK ? make_band(&a) : status;
    status = status == SPAR_OK ? solve_spectrum(&a, n, shift, how, found, value, x) : status;
    SPARI_FREE(a.d, a.multiplier, a.Q, a.at, a.workspace);
    spari_band_free(a.band);
    return status;
}
