/* Eigenvalues of structure and fluid in a few shapes: see reduced_model.h. For a fluid with memory, A(s) is the
   transform of the loads divided by that of the pulse, z = e^(s dt). It is a sum over the pulse plus the closed form
   of the decay after it, so it exists also where the infinite sum diverges. All eigenvalues of a rational
   approximation are computed, and each is then refined with A(s) itself. */
#include "reduced_model.h"

#include "../algebra/schur.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* shown: maximum phase change per step, in radians, of a motion that samples resolve; modelled: of the fluid's own
   rates. */
static const double shown = 1, modelled = 1.5;
/* Rates below this fraction of the fastest shape count as zero. */
static const double still = 1e-6;
enum { NEAREST = 9, POLISH = 30, MORE = 6 };

int spari_reduced_create(spari_reduced *r) {
    int64_t size = (int64_t)r->n * r->n;
    r->M = spari_zalloc(6 * size, sizeof *r->M);
    if (!r->M) {
        return SPAR_ERR_MEMORY;
    }
    r->C = r->M + size, r->K = r->C + size;
    for (int k = 0; k < 3; k++) {
        r->A[k] = r->K + (k + 1) * size;
    }
    return SPAR_OK;
}

void spari_reduced_free(spari_reduced *r) {
    free(r->M);
    r->M = NULL;
    spari_fluid_response_free(&r->response);
    spari_decay_free(&r->tail);
}

/* ---- response of the fluid ---- */

/* Transform of the pulse. */
static double complex transform(const spari_reduced *r, double complex s) {
    double complex sum = 0, back = cexp(-s * r->dt), factor = cexp(s * r->dt * SPARI_PULSE_MIDDLE);
    for (int k = 0; k < SPARI_PULSE; k++, factor *= back) {
        sum += r->response.x[k] * factor;
    }
    return sum;
}

/* A(s) [n][n] of a fluid with memory */
static void find_response(const spari_reduced *r, double complex s, double complex *A) {
    int size = r->n * r->n;
    double complex back = cexp(-s * r->dt), factor = cexp(s * r->dt * SPARI_PULSE_MIDDLE), pulse = transform(r, s);
    memset(A, 0, (size_t)size * sizeof *A);
    for (int k = 0; k < SPARI_PULSE; k++, factor *= back) {
        const double *load = r->response.load + (int64_t)size * k;
        for (int i = 0; i < size; i++) {
            A[i] += load[i] * factor / pulse;
        }
    }
    for (int k = 0; k < r->tail.order; k++) {
        double complex f = factor / (pulse * (1 - r->tail.z[k] * back));
        const double complex *left = r->tail.left + r->n * k, *right = r->tail.right + r->n * k;
        for (int i = 0; i < size; i++) {
            A[i] += f * left[i / r->n] * right[i % r->n];
        }
    }
}

/* The fluid's own resolved rates, and the coefficients of 1 / (s - rate) in A(s). */
typedef struct reduced_pole {
    int of;
    double complex rate, factor;
} reduced_pole;

static int find_poles(const spari_reduced *r, reduced_pole *pole) {
    int count = 0;
    for (int k = 0; k < r->tail.order; k++) {
        double complex z = r->tail.z[k], rate = cabs(z) > 0 ? clog(z) / r->dt : INFINITY;
        if (cabs(rate) * r->dt < modelled) {
            double complex factor =
                cexp(-rate * r->dt * (SPARI_PULSE - SPARI_PULSE_MIDDLE)) / (r->dt * transform(r, rate));
            pole[count++] = (reduced_pole){k, rate, factor};
        }
    }
    return count;
}

/* Approximates A(i w) beside the poles by a0 - w^2 a2 + i w a1, by least squares. */
static void fit_response(spari_reduced *r, int poles, const reduced_pole *pole, double complex *A) {
    double top = fmin(fmax(1.5 * r->fastest, 0.1 / r->dt), shown / r->dt), s0 = 0, s2 = 0, s4 = 0;
    int n = r->n, size = n * n;
    double *const *a = r->A;
    for (int j = 0; j < NEAREST; j++) {
        double w = top * j / (NEAREST - 1), u = w / top;
        find_response(r, CMPLX(0, w), A);
        s0 += 1, s2 += u * u, s4 += u * u * u * u;
        for (int i = 0; i < size; i++) {
            double complex left = A[i];
            for (int k = 0; k < poles; k++) {
                int at = n * pole[k].of;
                left -= pole[k].factor * r->tail.left[at + i / n] * r->tail.right[at + i % n] /
                        (CMPLX(0, w) - pole[k].rate);
            }
            a[0][i] += creal(left);
            a[1][i] += u * cimag(left);
            a[2][i] -= u * u * creal(left);
        }
    }
    for (int i = 0; i < size; i++) {
        double b0 = a[0][i], b2 = a[2][i], det = s0 * s4 - s2 * s2;
        a[0][i] = (s4 * b0 + s2 * b2) / det;
        a[1][i] /= s2 * top;
        a[2][i] = (s2 * b0 + s0 * b2) / (det * top * top);
    }
}

int spari_reduced_prepare(spari_reduced *r) {
    int64_t size = (int64_t)r->n * r->n, count = r->response.count;
    double most = 0;
    for (int64_t i = 0; i < count * size; i++) {
        most = fmax(most, fabs(r->response.load[i]));
    }
    if (r->memory == 0) {
        for (int k = 0; k < 3; k++) {
            memcpy(r->A[k], r->response.load + size * k, (size_t)size * sizeof(double));
        }
        return isfinite(most) ? SPAR_OK : SPAR_ERR_NUMERIC;
    }
    const double *tail = r->response.load + size * SPARI_PULSE;
    SPARI_TRY(spari_decay_fit(r->n, r->memory, tail, 1e-8 * most, &r->tail));
    r->misfit = most > 0 ? r->tail.misfit * r->tail.largest / most : 0;
    double complex *A = spari_zalloc(size, sizeof *A);
    reduced_pole *pole = spari_zalloc(r->tail.order, sizeof *pole);
    int status = A && pole ? SPAR_OK : SPAR_ERR_MEMORY;
    if (status == SPAR_OK) {
        fit_response(r, find_poles(r, pole), pole, A);
    }
    SPARI_FREE(A, pole);
    return status;
}

/* ---- eigenvalues ---- */

typedef struct reduced_root {
    double complex s, begun;
    double complex *x; /* [n] */
    double distance;
    int wanted;
} reduced_root;

/* Workspace of a solution: of the rational approximation, of size N = 2 n + poles, and of each root. */
typedef struct reduced_work {
    int n, N, roots;
    reduced_pole *pole;
    double complex *S, *Q, *workspace; /* [N][N] twice, [4 N] */
    double complex *T, *D, *X, *Y, *w; /* [n][n] four times, [4 n] */
    double complex *x;                 /* [N][n] */
    reduced_root *root;                /* [N] */
} reduced_work;

static int work_create(reduced_work *w, const spari_reduced *r) {
    int64_t n = r->n;
    *w = (reduced_work){.n = r->n, .pole = spari_zalloc(r->tail.order, sizeof *w->pole)};
    int poles = w->pole ? find_poles(r, w->pole) : 0;
    w->N = 2 * r->n + poles;
    int64_t N = w->N;
    w->S = spari_zalloc(2 * N * N + 4 * N + N * n, sizeof *w->S);
    w->T = spari_zalloc(4 * n * n + 4 * n, sizeof *w->T);
    w->root = spari_zalloc(N, sizeof *w->root);
    if (!w->pole || !w->S || !w->T || !w->root) {
        return SPAR_ERR_MEMORY;
    }
    w->Q = w->S + N * N, w->workspace = w->Q + N * N, w->x = w->workspace + 4 * N;
    w->D = w->T + n * n, w->X = w->D + n * n, w->Y = w->X + n * n, w->w = w->Y + n * n;
    return SPAR_OK;
}

/* The rational approximation as one matrix of (x, s x, w), in the unit of time given by `fastest`. 1: the mass of
   the accelerated unknowns is singular. */
static int form_matrix(const spari_reduced *r, reduced_work *w, double unit) {
    int n = r->n, N = w->N, columns = N;
    double complex *rows = w->S + (int64_t)n * N;
    for (int i = 0; i < n; i++) {
        w->S[N * i + n + i] = 1;
        for (int j = 0; j < n; j++) {
            int at = n * i + j;
            w->T[at] = r->M[at] - r->A[2][at];
            rows[N * i + j] = -(r->K[at] - r->A[0][at]) / (unit * unit);
            rows[N * i + n + j] = -(r->C[at] - r->A[1][at]) / unit;
        }
    }
    for (int k = 0; k < N - 2 * n; k++) {
        const reduced_pole *p = w->pole + k;
        const double complex *left = r->tail.left + n * p->of, *right = r->tail.right + n * p->of;
        double a = 0, b = 0;
        for (int i = 0; i < n; i++) {
            a += cabs(left[i]), b += cabs(right[i]);
        }
        double even = a > 0 && b > 0 ? sqrt(b / a) : 1;
        for (int i = 0; i < n; i++) {
            rows[N * i + 2 * n + k] = left[i] * even * p->factor / unit;
            w->S[N * (2 * n + k) + i] = right[i] / (even * unit * unit);
        }
        w->S[(N + 1) * (2 * n + k)] = p->rate / unit;
    }
    return spari_decay_solve(n, w->T, columns, rows);
}

/* Its eigenvalues and vectors: start values of the roots. */
static int find_starts(const spari_reduced *r, reduced_work *w) {
    double unit = r->fastest;
    int n = r->n, N = w->N;
    if (form_matrix(r, w, unit) || spari_schur(N, w->S, w->Q, 0, w->workspace)) {
        return SPAR_ERR_NUMERIC;
    }
    for (int k = 0; k < N; k++) {
        double complex s = w->S[(N + 1) * k] * unit;
        if (cimag(s) < -1e-6 * cabs(s)) {
            continue;
        }
        reduced_root *root = w->root + w->roots;
        *root = (reduced_root){.s = s, .begun = s, .x = w->x + n * w->roots++};
        spari_schur_vector(N, w->S, w->Q, k, w->workspace, w->workspace + N);
        memcpy(root->x, w->workspace, (size_t)n * sizeof *root->x);
    }
    return SPAR_OK;
}

/* T(s) and its derivative. */
static void find_matrix(const spari_reduced *r, const reduced_work *w, double complex s) {
    int size = r->n * r->n;
    double step = 1e-5 * (cabs(s) + 1e-3 * r->fastest);
    find_response(r, s + step, w->X);
    find_response(r, s - step, w->Y);
    for (int i = 0; i < size; i++) {
        w->D[i] = 2 * s * r->M[i] + r->C[i] - (w->X[i] - w->Y[i]) / (2 * step);
    }
    find_response(r, s, w->X);
    for (int i = 0; i < size; i++) {
        w->T[i] = s * (s * r->M[i] + r->C[i]) + r->K[i] - w->X[i];
    }
}

/* Refines a root by successive linear problems: nearest eigenvalue of T x = m T' x (Ruhe, SIAM J. Numer. Anal. 10,
   1973); for copies the next one. 1: no convergence, or to another root. */
static int bring_nearer(const spari_reduced *r, const reduced_work *w, reduced_root *root, int copy, double slack) {
    int n = r->n;
    double last = INFINITY;
    for (int pass = 0; pass < POLISH; pass++) {
        find_matrix(r, w, root->s);
        if (spari_decay_solve(n, w->D, n, w->T) || spari_schur(n, w->T, w->Y, 0, w->w)) {
            return 1;
        }
        int best = 0;
        for (int rank = 0, reached = -1; rank <= copy; rank++, reached = best) {
            double least = INFINITY, beyond = reached >= 0 ? cabs(w->T[(n + 1) * reached]) : -1;
            for (int k = 0; k < n; k++) {
                double size = cabs(w->T[(n + 1) * k]);
                if (size < least && size > beyond) {
                    least = size, best = k;
                }
            }
        }
        double complex step = w->T[(n + 1) * best];
        spari_schur_vector(n, w->T, w->Y, best, root->x, w->w);
        root->s -= step;
        if (!(cabs(root->s - root->begun) <= 0.2 * cabs(root->begun) + slack)) {
            return 1;
        }
        if (cabs(step) <= 1e-11 * cabs(root->s) || (cabs(step) <= 1e-6 * cabs(root->s) && cabs(step) > 0.1 * last)) {
            return 0; /* or no closer, because of noise */
        }
        last = cabs(step);
    }
    return 1;
}

/* Whether the root belongs to the structure. Close to a rate of the fluid itself, a relative change of s changes the
   loads by more than the sum of all forces. Growing roots always count. */
static int is_of_structure(const spari_reduced *r, const reduced_work *w, const reduced_root *root) {
    int n = r->n;
    double fluid = 0, structure = 0;
    if (creal(root->s) > 1e-9 * cabs(root->s)) {
        return 1;
    }
    find_matrix(r, w, root->s);
    for (int i = 0; i < n; i++) {
        double complex change = 0, stiff = 0, loads = 0, inertia = 0;
        for (int j = 0; j < n; j++) {
            int at = n * i + j;
            double complex smooth = 2 * root->s * (r->M[at] - r->A[2][at]) + r->C[at] - r->A[1][at];
            change += (w->D[at] - smooth) * root->x[j];
            stiff += r->K[at] * root->x[j];
            loads += r->A[0][at] * root->x[j];
            inertia += root->s * root->s * r->M[at] * root->x[j];
        }
        fluid = hypot(fluid, cabs(change));
        structure = hypot(structure, cabs(stiff) + cabs(loads) + cabs(inertia));
    }
    return cabs(root->s) * fluid <= structure;
}

/* Refines in the order of distance from the shift, until no other can be among the n nearest. */
static void bring_all_nearer(const spari_reduced *r, reduced_work *w, int n) {
    double slack = 1 / (r->dt * (double)(r->response.count + 1));
    for (int k = 0, enough = 0; k < w->roots; k++) {
        reduced_root *root = w->root + k;
        int copy = 0, known = 0;
        if (enough > 2 * n + MORE) {
            root->wanted = 0;
            continue;
        }
        for (int j = 0; j < k; j++) {
            copy += cabs(w->root[j].begun - root->begun) <= 1e-6 * cabs(root->begun);
        }
        if (cabs(root->begun) <= still * r->fastest) {
            continue;
        }
        root->wanted = cabs(root->begun) * r->dt <= shown && !bring_nearer(r, w, root, copy, slack) &&
                       cabs(root->s) * r->dt <= shown && is_of_structure(r, w, root);
        for (int j = 0; j < k; j++) {
            known += w->root[j].wanted && cabs(w->root[j].s - root->s) <= 1e-8 * cabs(root->s);
        }
        root->wanted = root->wanted && known <= copy;
        enough += root->wanted;
    }
}

static int by_nearness(const void *a, const void *b) {
    const reduced_root *x = a, *y = b;
    if (x->wanted != y->wanted) {
        return x->wanted ? -1 : 1;
    }
    return (x->distance > y->distance) - (x->distance < y->distance);
}

/* Makes real roots real; motions without stiffness have a double zero and count once. */
static void sort_roots(const spari_reduced *r, reduced_work *w, double complex shift) {
    int stand = 0;
    for (int k = 0; k < w->roots; k++) {
        reduced_root *root = w->root + k;
        if (fabs(cimag(root->s)) <= 1e-7 * cabs(root->s)) {
            root->s = creal(root->s);
        }
        if (cabs(root->s) <= still * r->fastest) {
            root->s = 0;
            root->wanted = root->wanted && stand++ % 2 == 0;
        }
        root->wanted = root->wanted && cimag(root->s) >= 0;
        root->distance = cabs(root->s - shift);
    }
    qsort(w->root, (size_t)w->roots, sizeof *w->root, by_nearness);
}

static void give_root(const spari_reduced *r, const reduced_root *root, double complex *x) {
    int n = r->n;
    double complex square = 0, phase = 1;
    double most = 0;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            square += conj(root->x[i]) * r->M[n * i + j] * root->x[j];
        }
        if (cabs(root->x[i]) > most * (1 + 1e-6)) {
            most = cabs(root->x[i]);
            phase = conj(root->x[i]) / most;
        }
    }
    for (int i = 0; i < n; i++) {
        x[i] = creal(square) > 0 ? phase * root->x[i] / sqrt(creal(square)) : root->x[i];
    }
}

int spari_reduced_solve(const spari_reduced *r, int n, double complex shift, int *found, double complex *value,
                        double complex *x) {
    reduced_work w;
    *found = 0;
    int status = work_create(&w, r);
    status = status == SPAR_OK ? find_starts(r, &w) : status;
    if (status == SPAR_OK) {
        for (int k = 0; k < w.roots; k++) {
            w.root[k].wanted = 1;
            w.root[k].distance = cabs(w.root[k].s - shift);
        }
        qsort(w.root, (size_t)w.roots, sizeof *w.root, by_nearness);
        if (r->memory > 0) {
            bring_all_nearer(r, &w, n);
        }
        sort_roots(r, &w, shift);
    }
    for (int k = 0; k < w.roots && *found < n && status == SPAR_OK && w.root[k].wanted; k++, ++*found) {
        value[k] = w.root[k].s;
        give_root(r, w.root + k, x + (int64_t)r->n * k);
    }
    SPARI_FREE(w.pole, w.S, w.T, w.root);
    return status;
}
