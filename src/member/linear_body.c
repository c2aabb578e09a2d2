/* A body that is linear about its reference: see linear_body.h. */
#include "linear_body.h"

#include "../algebra/cblas.h"
#include "../math/rotation.h"

#include <math.h>
#include <string.h>

/* v . B v of one element */
static double quadratic_form(int n, const double *B, const double *v, double *work) {
    SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasNoTrans, n, n, 1, B, n, v, 1, 0, work, 1));
    return cblas_ddot(n, v, 1, work, 1);
}

/* Displacements and rotation vectors of n nodes */
static void displacements(int n, const double *q, double *x) {
    for (int l = 0; l < n; l++) {
        memcpy(x + 6 * l, q + 7 * l, 3 * sizeof *x);
        spari_quat_log(q + 7 * l + 3, x + 6 * l + 3);
    }
}

void spari_linear_energy(const spari_body *body, const double *q, const double *v, double energy[4]) {
    int P = body->per_element, n = 6 * P;
    double *x = body->scratch;
    for (int e = 0; e < body->elements; e++) {
        int64_t first = (int64_t)e * (P - 1), at = (int64_t)n * n * e;
        displacements(P, q + 7 * first, x);
        energy[1] += 0.5 * quadratic_form(n, body->linear[0] + at, x, x + n);
        energy[0] += body->linear[2] && v ? 0.5 * quadratic_form(n, body->linear[2] + at, v + 6 * first, x + n) : 0;
        energy[3] += body->linear[1] && v ? quadratic_form(n, body->linear[1] + at, v + 6 * first, x + n) : 0;
        for (int i = e > 0 ? 6 : 0; i < n && body->weights; i++) { /* a joint counts once */
            energy[2] += body->weights[6 * first + i] * x[i];
        }
        for (int i = e > 0 ? 6 : 0; i < n && body->pull; i++) {
            energy[1] += body->pull[6 * first + i] * x[i];
        }
    }
}

double spari_linear_residual(const spari_body *body, const double *q, const double *v, const double *a, double factor,
                             double *r, double *power) {
    int P = body->per_element, n = 6 * P;
    double *x = body->scratch, scale = 0, damped = 0;
    if (v && body->drag > 0) { /* strains' rates are those of what the root sees as well */
        spari_body_see(body, NULL, v, body->seen);
    }
    const double *rate = v && body->drag > 0 ? body->seen : v;
    for (int64_t i = 0; i < (int64_t)body->unique * 6; i++) {
        r[i] = body->weights ? factor * body->weights[i] : 0;
    }
    for (int64_t i = 0; i < (int64_t)body->unique * 6 && body->pull; i++) {
        r[i] += body->pre_part * body->pull[i];
    }
    for (int e = 0; e < body->elements; e++) {
        int64_t first = (int64_t)e * (P - 1), at = (int64_t)n * n * e;
        displacements(P, q + 7 * first, x);
        const double *in[3] = {x, rate ? rate + 6 * first : NULL, a ? a + 6 * first : NULL};
        for (int k = 0; k < 3; k++) {
            if (in[k] && body->linear[k] && (k != 1 || body->D)) {
                if (k == 1) {
                    damped += quadratic_form(n, body->linear[1] + at, in[1], x + n);
                }
                SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasNoTrans, n, n, 1, body->linear[k] + at, n, in[k], 1, 1,
                                       r + 6 * first, 1));
            }
        }
    }
    for (int64_t i = 0; i < (int64_t)body->unique * 6; i++) {
        scale = fabs(r[i]) > scale ? fabs(r[i]) : scale;
    }
    if (power) {
        *power = damped;
    }
    return scale;
}

void spari_linear_tangent(const spari_body *body, int e, double cm, double cv, double *S) {
    int64_t size = (int64_t)36 * body->per_element * body->per_element;
    const double c[3] = {1, cv, cm};
    memcpy(S, body->linear[0] + size * e, (size_t)size * sizeof *S);
    for (int k = 1; k < 3; k++) {
        for (int64_t i = 0; i < size && body->linear[k]; i++) {
            S[i] += c[k] * body->linear[k][size * e + i];
        }
    }
}
