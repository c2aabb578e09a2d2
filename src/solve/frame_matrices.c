/* What a frame is made of: its matrices, from the exact member's tangents at the reference. */
#include "carriage.h"

#include "../base/scene.h"
#include "../math/rotation.h"
#include "../member/body.h"

#include <gsl/gsl_cblas.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const int spari_frame_pair[SPARI_TURNS][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};

int spari_frame_pair_of(int k, int l) {
    return k >= l ? k * (k + 1) / 2 + l : spari_frame_pair_of(l, k);
}

void spari_frame_add_times(const spari_frame *f, const double *X, const double *x, double factor, double *y) {
    int m = f->block, step = f->block - f->overlap;
    for (int e = 0; e < f->elements; e++) {
        spari_linear_add_rows(m, m, X + (int64_t)m * m * e, factor, x + (int64_t)e * step, y + (int64_t)e * step);
    }
}

void spari_frame_factor(spari_frame *f, const double *K, double ck, const double *C, double cv, const double *A,
                        double cm, double *S, int *singular) {
    int64_t mm = (int64_t)f->block * f->block;
    spari_linear_zero(f->linear);
    for (int e = 0; e < f->elements; e++) {
        for (int64_t i = 0; i < mm; i++) {
            int64_t at = mm * e + i;
            S[i] = ck * K[at] + (C ? cv * C[at] : 0) + (f->M ? cm * f->M[at] : 0) + (A ? cm * A[at] : 0);
        }
        spari_linear_add(f->linear, e, S);
    }
    for (int i = 0; i < f->held; i++) {
        spari_linear_fix(f->linear, i);
    }
    f->factors++;
    *singular = spari_linear_factor(f->linear);
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

/* Work of the set-up: the reference as a state, its arms from the root, velocities and accelerations of a rigid turn,
 * four element matrices, a field of the nodes. */
typedef struct setup {
    const spari_body *body;
    int m; /* 6 P */
    const double *arm;
    double *q, *v, *a, *S[4], *field;
} setup;

/* What a turn with omega adds: matrices of the place (into N, element after element) and of the rate (into G). A frame
   that turns gives du-dot = omega x u, d(u-ddot) = 2 omega x u-dot + omega x (omega x u), d(alpha) = omega x theta-dot.
 */
static void turn_matrices(const spari_frame *f, const setup *w, const double omega[3], double *N, double *G) {
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

/* What an angular acceleration adds: d(u-ddot) = alpha x u, and the sections' inertia, turned. */
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

/* K, D, M: at rest and unloaded the tangent is K + cv D + cm M. */
static void rest_matrices(const spari_frame *f, const setup *w) {
    int64_t mm = (int64_t)w->m * w->m;
    for (int e = 0; e < w->body->elements; e++) {
        double *K = f->K + mm * e;
        spari_body_tangent(w->body, e, w->q, NULL, NULL, 0, 0, 0, NULL, K);
        spari_body_rates(w->body, e, w->q, NULL, NULL, 0, K, f->D ? f->D + mm * e : NULL, f->M ? f->M + mm * e : NULL);
    }
}

/* The geometric stiffness of a deformation u [nodes][6]: the derivative of the tangent along it, by central differences
   over a step in which the largest strain-like measure is `small` (error small^2). The tangent's virtual rotations are
   those at the deformed state: T(theta) takes the rotation vector's changes there. */
static void stretch_matrices(const spari_frame *f, const setup *w, const double *u, double *N) {
    const double small = 1e-4;
    int m = w->m, P = m / 6;
    int64_t mm = (int64_t)m * m;
    double largest = 0, *q = w->v; /* 7 per node fit into v and a together */
    memset(N, 0, (size_t)f->size * sizeof *N);
    for (int i = 0; i < f->nodes; i++) {
        largest = fmax(largest, fmax(spari_norm(u + 6 * i) / w->body->length, spari_norm(u + 6 * i + 3)));
    }
    if (largest == 0) {
        return;
    }
    for (int side = -1; side <= 1; side += 2) {
        double step = side * small / largest;
        for (int i = 0; i < f->nodes; i++) {
            double psi[3];
            for (int k = 0; k < 3; k++) {
                q[7 * i + k] = step * u[6 * i + k];
                psi[k] = step * u[6 * i + 3 + k];
            }
            spari_quat_exp(psi, q + 7 * i + 3);
        }
        for (int e = 0; e < w->body->elements; e++) {
            double *S = w->S[0], scale = side * largest / (2 * small);
            spari_body_tangent(w->body, e, q, NULL, NULL, 0, 0, 0, NULL, S);
            for (int l = 0; l < P; l++) {
                double psi[3], T[9], *N0 = N + mm * e;
                for (int k = 0; k < 3; k++) {
                    psi[k] = step * u[6 * ((int64_t)e * (P - 1) + l) + 3 + k];
                }
                spari_tangent(psi, T);
                for (int i = 0; i < m; i++) {
                    const double *s = S + (int64_t)m * i + 6 * l;
                    double *to = N0 + (int64_t)m * i + 6 * l;
                    for (int j = 0; j < 3; j++) {
                        to[j] += scale * s[j];
                        to[3 + j] += scale * (s[3] * T[j] + s[4] * T[3 + j] + s[5] * T[6 + j]);
                    }
                }
            }
        }
    }
}

/* What of N and f belongs to omega_i omega_j alone. */
static void polarise(spari_frame *f) {
    for (int k = 3; k < SPARI_TURNS; k++) {
        for (int side = 0; side < 2; side++) {
            int d = spari_frame_pair[k][side];
            cblas_daxpy((int)f->size, -1, f->N[d], 1, f->N[k], 1);
            cblas_daxpy(6 * f->nodes, -1, f->f[d], 1, f->f[k], 1);
        }
    }
}

/* Of a frame that goes with an unknown root: of nodal forces x what is along the line. */
static void keep_along_line(const spari_frame *f, double *x) {
    for (int i = 0; i < f->nodes && f->S[0]; i++) {
        const double *axis = f->carriage->axis + 3 * i;
        double along = spari_dot(axis, x + 6 * i);
        for (int k = 0; k < 3; k++) {
            x[6 * i + k] = along * axis[k];
            x[6 * i + 3 + k] = 0;
        }
    }
}

/* The stretch s_k = -K^-1 f_k of every product of turns, its stiffness S_k into N, or for itself, and S_k s_l / 2 into
   what is counted twice. */
static int stretch_terms(spari_frame *f, const setup *w) {
    int singular = 0, n6 = 6 * f->nodes;
    double *S = spari_zalloc(f->size + SPARI_TURNS * (int64_t)n6, sizeof *S), *s = S + f->size;
    if (!S) {
        return SPAR_ERR_MEMORY;
    }
    spari_frame_factor(f, f->K, 1, NULL, 0, NULL, 0, w->S[0], &singular);
    for (int k = 0; k < SPARI_TURNS && !singular; k++) {
        double *x = s + (int64_t)k * n6;
        cblas_daxpy(n6, -1, f->f[k], 1, x, 1);
        keep_along_line(f, x);
        memset(x, 0, 6 * sizeof *x);
        singular = spari_linear_solve(f->linear, x);
    }
    for (int k = 0; k < SPARI_TURNS && !singular; k++) {
        stretch_matrices(f, w, s + (int64_t)k * n6, S);
        cblas_daxpy((int)f->size, 1, S, 1, f->S[k] ? f->S[k] : f->N[k], 1);
        for (int l = 0; l < SPARI_TURNS; l++) { /* those of two kinds come from both */
            spari_frame_add_times(f, S, s + (int64_t)l * n6, 0.5, f->twice[spari_frame_pair_of(k, l)]);
        }
    }
    free(S);
    return singular ? SPAR_ERR_NUMERIC : SPAR_OK;
}

static int turn_terms(spari_frame *f, const setup *w) {
    double *none = NULL;
    for (int k = 0; k < SPARI_TURNS; k++) {
        int i = spari_frame_pair[k][0], j = spari_frame_pair[k][1];
        double omega[3] = {0};
        omega[i] = omega[j] = 1;
        turn_matrices(f, w, omega, f->N[k], i == j ? f->G[i] : none);
        rigid_motion(f, w->arm, omega, w->v, w->a);
        spari_body_residual(w->body, w->q, w->v, w->a, 0, f->f[k], NULL);
        cblas_daxpy(f->pull ? 6 * f->nodes : 0, -1, f->pull, 1, f->f[k], 1);
        if (k < 3 && f->E[k]) {
            euler_matrices(f, w, omega, f->E[k]);
        }
    }
    polarise(f);
    return stretch_terms(f, w);
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

int spari_frame_form(spari_frame *f, const spari_body *damped, const double *arm) {
    spari_body undragged = *damped, *body = &undragged;
    body->drag = 0; /* of the deformation alone, in the end */
    setup w = {.body = body, .m = 6 * body->per_element, .arm = arm};
    int64_t mm = (int64_t)w.m * w.m, n = f->nodes;
    w.q = spari_zalloc(7 * n + 13 * n + 4 * mm + 6 * n, sizeof *w.q);
    if (!w.q) {
        return SPAR_ERR_MEMORY;
    }
    w.v = w.q + 7 * n, w.a = w.v + 6 * n, w.field = w.a + 7 * n;
    for (int k = 0; k < 4; k++) {
        w.S[k] = w.field + 6 * n + mm * k;
    }
    for (int64_t i = 0; i < n; i++) {
        w.q[7 * i + 3] = 1;
    }
    rest_matrices(f, &w);
    if (f->pull) {
        spari_body_residual(body, w.q, NULL, NULL, 0, f->pull, NULL);
    }
    rigid_forces(f, &w);
    int status = f->N[0] ? turn_terms(f, &w) : SPAR_OK;
    if (damped->drag > 0 && f->M) {
        cblas_daxpy((int)f->size, damped->drag, f->M, 1, f->D, 1);
    }
    free(w.q);
    return status;
}
