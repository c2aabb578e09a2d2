/* The matrices of a frame, from the tangents of the exact member at the reference. */
#include "../algebra/cblas.h"
#include "../math/rotation.h"
#include "../member/body.h"
#include "frame.h"

#include <stdlib.h>
#include <string.h>

const int spari_frame_pair[SPARI_SPIN_PRODUCTS][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};

void spari_frame_add_times(const spari_frame *f, const double *X, const double *x, double factor, double *y) {
    int m = f->block, step = f->block - f->overlap;
    for (int e = 0; e < f->elements; e++) {
        spari_linear_add_rows(m, m, X + (int64_t)m * m * e, factor, x + (int64_t)e * step, y + (int64_t)e * step);
    }
}

/* ---- matrices from the exact member's tangents at the reference ---- */

static void product3(const double a[9], const double b[9], double c[9]) {
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            c[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
        }
    }
}

/* out += B diag(U, T, U, T, ...) for an element matrix B [m][m]; T NULL: 0 */
static void times_nodes(int m, const double *B, const double U[9], const double *T, double *out) {
    for (int i = 0; i < m; i++) {
        for (int at = 0; at < m; at += 3) {
            const double *S = at % 6 == 0 ? U : T;
            const double *b = B + (int64_t)m * i + at;
            for (int j = 0; j < 3 && S; j++) {
                out[(int64_t)m * i + at + j] += b[0] * S[j] + b[1] * S[3 + j] + b[2] * S[6 + j];
            }
        }
    }
}

/* The rigid motion omega of the reference about the root: velocities and centripetal accelerations. */
static void rigid_motion(const spari_frame *f, const double *arm, const double omega[3], double *v, double *a) {
    for (int i = 0; i < f->nodes; i++) {
        spari_cross(omega, arm + 3 * i, v + 6 * i);
        spari_cross(omega, v + 6 * i, a + 6 * i);
        memcpy(v + 6 * i + 3, omega, 3 * sizeof *v);
        memset(a + 6 * i + 3, 0, 3 * sizeof *a);
    }
}

/* Workspace of the set-up: the reference as a state, its lever arms from the root, velocities and accelerations of a
   rigid rotation, four element matrices, a field of the nodes. */
typedef struct setup {
    const spari_body *body;
    int m; /* 6 P */
    const double *arm;
    double *q, *v, *a, *S[4], *field;
} setup;

/* Adds the matrices of a rotation with omega: those of the position into N, element after element, and those of the
   rate into G. A rotating frame gives du-dot = omega x u, d(u-ddot) = 2 omega x u-dot + omega x (omega x u), d(alpha) =
   omega x theta-dot. */
static void rotation_matrices(const spari_frame *f, const setup *w, const double omega[3], double *N, double *G) {
    int m = w->m;
    int64_t mm = (int64_t)m * m;
    double W[9], WW[9], W2[9];
    spari_skew(omega, W);
    product3(W, W, WW);
    for (int i = 0; i < 9; i++) {
        W2[i] = 2 * W[i];
    }
    rigid_motion(f, w->arm, omega, w->v, w->a);
    for (int e = 0; e < w->body->elements; e++) {
        const double *K = f->K + mm * e, *M = f->M + mm * e;
        double *S = w->S[0], *B = w->S[1];
        spari_body_tangent(w->body, e, w->q, w->v, w->a, 0, 0, 0, NULL, S);
        spari_body_rates(w->body, e, w->q, w->v, w->a, 0, S, B, NULL);
        for (int64_t i = 0; i < mm; i++) {
            N[mm * e + i] = S[i] - K[i];
        }
        times_nodes(m, B, W, NULL, N + mm * e);
        times_nodes(m, M, WW, NULL, N + mm * e);
        if (G) {
            for (int64_t i = 0; i < mm; i++) {
                G[mm * e + i] = B[i] - (f->D ? f->D[mm * e + i] : 0);
            }
            times_nodes(m, M, W2, W, G + mm * e);
        }
    }
}

/* Adds the matrix of an angular acceleration: d(u-ddot) = alpha x u, and the rotated inertia of the sections. */
static void euler_matrices(const spari_frame *f, const setup *w, const double alpha[3], double *E) {
    int m = w->m;
    int64_t mm = (int64_t)m * m;
    double A[9];
    spari_skew(alpha, A);
    memset(w->v, 0, (size_t)(6 * f->nodes) * sizeof *w->v);
    for (int i = 0; i < f->nodes; i++) {
        spari_cross(alpha, w->arm + 3 * i, w->a + 6 * i);
        memcpy(w->a + 6 * i + 3, alpha, 3 * sizeof *alpha);
    }
    for (int e = 0; e < w->body->elements; e++) {
        double *S = w->S[0];
        spari_body_tangent(w->body, e, w->q, w->v, w->a, 0, 0, 0, NULL, S);
        for (int64_t i = 0; i < mm; i++) {
            E[mm * e + i] = S[i] - f->K[mm * e + i];
        }
        times_nodes(m, f->M + mm * e, A, NULL, E + mm * e);
    }
}

/* Reduces N and f to the part of omega_i omega_j alone. */
static void polarise(spari_frame *f) {
    for (int k = 3; k < SPARI_SPIN_PRODUCTS; k++) {
        for (int side = 0; side < 2; side++) {
            int d = spari_frame_pair[k][side];
            cblas_daxpy((int)f->size, -1, f->N[d], 1, f->N[k], 1);
            cblas_daxpy(6 * f->nodes, -1, f->f[d], 1, f->f[k], 1);
        }
    }
}

/* X += m x theta / 2 on the rotation theta of each node, for the moments m there. The tangents are those of moments
   under small rotations, the equations those of rotation vectors, on which a moment m acts as m + m x theta / 2. This
   makes N symmetric. */
static void add_half_moments(const setup *w, const double *moments, double *X) {
    const int P = w->m / 6;
    for (int e = 0; e < w->body->elements; e++) {
        for (int l = e > 0; l < P; l++) { /* a node of two elements counts once */
            double W[9];
            spari_skew(moments + 6 * (e * (P - 1) + l) + 3, W);
            for (int k = 0; k < 9; k++) {
                X[((int64_t)w->m * e + 6 * l + 3 + k / 3) * w->m + 6 * l + 3 + k % 3] += 0.5 * W[k];
            }
        }
    }
}

static int rotation_terms(spari_frame *f, const setup *w) {
    double *none = NULL;
    for (int k = 0; k < SPARI_SPIN_PRODUCTS; k++) {
        int i = spari_frame_pair[k][0], j = spari_frame_pair[k][1];
        double omega[3] = {0};
        omega[i] = omega[j] = 1;
        rotation_matrices(f, w, omega, f->N[k], i == j ? f->G[i] : none);
        rigid_motion(f, w->arm, omega, w->v, w->a);
        spari_body_residual(w->body, w->q, w->v, w->a, 0, f->f[k], NULL);
        cblas_daxpy(f->pull ? 6 * f->nodes : 0, -1, f->pull, 1, f->f[k], 1);
        if (k < 3) {
            euler_matrices(f, w, omega, f->E[k]);
            add_half_moments(w, f->rigid[3 + k], f->E[k]);
        }
    }
    polarise(f);
    for (int k = 0; k < SPARI_SPIN_PRODUCTS; k++) {
        add_half_moments(w, f->f[k], f->N[k]);
    }
    double *X[SPARI_TRANSLATIONS];
    memcpy(X, f->N, sizeof f->N);
    memcpy(X + SPARI_SPIN_PRODUCTS, f->E, sizeof f->E);
    return spari_frame_add_stretch(w->body, w->arm, w->q, 0, SPARI_TRANSLATIONS, X);
}

/* M times the rigid accelerations of the frame. */
static void rigid_forces(spari_frame *f, const setup *w) {
    for (int k = 0; k < 6 && f->M; k++) {
        double unit[3] = {0};
        unit[k % 3] = 1;
        for (int64_t i = 0; i < f->nodes; i++) {
            memset(w->field + 6 * i, 0, 6 * sizeof *w->field);
            if (k < 3) {
                memcpy(w->field + 6 * i, unit, sizeof unit);
            } else {
                spari_cross(unit, w->arm + 3 * i, w->field + 6 * i);
                memcpy(w->field + 6 * i + 3, unit, sizeof unit);
            }
        }
        spari_frame_add_times(f, f->M, w->field, 1, f->rigid[k]);
    }
}

/* Returns 0, or 1 if there is no memory. */
static int begin_setup(setup *w, const spari_body *body, const double *arm) {
    const int64_t n = body->unique;
    *w = (setup){.body = body, .m = 6 * body->per_element, .arm = arm};
    const int64_t mm = (int64_t)w->m * w->m;
    w->q = spari_zalloc(7 * n + 13 * n + 4 * mm + 6 * n, sizeof *w->q);
    if (!w->q) {
        return 1;
    }
    w->v = w->q + 7 * n, w->a = w->v + 6 * n, w->field = w->a + 7 * n;
    for (int k = 0; k < 4; k++) {
        w->S[k] = w->field + 6 * n + mm * k;
    }
    for (int64_t i = 0; i < n; i++) {
        w->q[7 * i + 3] = 1;
    }
    return 0;
}

int spari_frame_form(spari_frame *f, const spari_body *damped, const double *arm) {
    spari_body undragged = *damped, *body = &undragged;
    body->mass_damping = 0; /* it is added to D below, for the deformation alone */
    setup w;
    if (begin_setup(&w, body, arm)) {
        return SPAR_ERR_MEMORY;
    }
    for (int e = 0; e < body->elements; e++) { /* without motion and loads the tangent is K + cv D + cm M */
        int64_t at = (int64_t)w.m * w.m * e;
        spari_body_tangent(body, e, w.q, NULL, NULL, 0, 0, 0, NULL, f->K + at);
        spari_body_rates(body, e, w.q, NULL, NULL, 0, f->K + at, f->D ? f->D + at : NULL, f->M ? f->M + at : NULL);
    }
    if (f->pull) {
        spari_body_residual(body, w.q, NULL, NULL, 0, f->pull, NULL);
    }
    rigid_forces(f, &w);
    int status = f->N[0] ? rotation_terms(f, &w) : SPAR_OK;
    if (damped->mass_damping > 0 && f->M) {
        cblas_daxpy((int)f->size, damped->mass_damping, f->M, 1, f->D, 1);
    }
    free(w.q);
    return status;
}

/* Matrices of the accelerations 1 of the root along the axes: the moments of their forces turn with the sections. */
static int translation_terms(const setup *w, double *const P[3]) {
    const double large = 0x1p60; /* the forces are linear in the acceleration: the subtraction loses no digits */
    const int64_t mm = (int64_t)w->m * w->m;
    for (int k = 0; k < 3; k++) {
        memset(w->v, 0, (size_t)(6 * w->body->unique) * sizeof *w->v);
        memset(w->a, 0, (size_t)(6 * w->body->unique) * sizeof *w->a);
        for (int64_t i = 0; i < w->body->unique; i++) {
            w->a[6 * i + k] = large;
        }
        for (int e = 0; e < w->body->elements; e++) {
            double *still = w->S[0], *S = w->S[1];
            spari_body_tangent(w->body, e, w->q, NULL, NULL, 0, 0, 0, NULL, still);
            spari_body_tangent(w->body, e, w->q, w->v, w->a, 0, 0, 0, NULL, S);
            for (int64_t i = 0; i < mm; i++) {
                P[k][mm * e + i] = (S[i] - still[i]) / large;
            }
        }
        for (int64_t i = 0; i < w->body->unique; i++) {
            w->a[6 * i + k] = 1;
        }
        spari_body_residual(w->body, w->q, w->v, w->a, 0, w->field, NULL);
        add_half_moments(w, w->field, P[k]);
    }
    return spari_frame_add_stretch(w->body, w->arm, w->q, SPARI_TRANSLATIONS, 3, P);
}

int spari_frame_form_translations(const spari_body *damped, const double *arm, double *const P[3]) {
    spari_body loose = *damped;
    loose.mass_damping = 0;
    loose.pre = NULL;
    setup w;
    if (begin_setup(&w, &loose, arm)) {
        return SPAR_ERR_MEMORY;
    }
    int status = translation_terms(&w, P);
    free(w.q);
    return status;
}
