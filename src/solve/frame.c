/* Members that are linear, or modal, in the frame of their root: matrices, modes, time (frame.h). */
#include "frame.h"
#include "../base/blas.h"

#include "../base/scene.h"
#include "../math/rotation.h"
#include "../member/applied.h"
#include "../member/body.h"
#include "../member/pose.h"
#include "eigen.h"
#include "leap.h"
#include "scheme.h"
#include "solver.h"
#include "turn.h"

#include <float.h>
#include <gsl/gsl_blas.h> /* the declarations; the linked CBLAS is the fast one */
#include <stdlib.h>
#include <string.h>

static const int pair[SPARI_TURNS][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};

/* Where two products of turns stand among their SPARI_TURN_PAIRS. */
static int pair_of(int k, int l) {
    return k >= l ? k * (k + 1) / 2 + l : pair_of(l, k);
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
    double *q, *arm, *v, *a, *S[4], *field;
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

/* y [n] += factor * X x for a matrix of the frame */
static void add_times(const spari_frame *f, const double *X, const double *x, double factor, double *y) {
    int m = f->block, step = f->block - f->overlap;
    for (int e = 0; e < f->elements; e++) {
        SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasNoTrans, m, m, factor, X + (int64_t)m * m * e, m,
                               x + (int64_t)e * step, 1, 1, y + (int64_t)e * step, 1));
    }
}

static void factor_into(spari_frame *f, const double *K, double ck, const double *C, double cv, double cm, double *S,
                        int *singular) {
    int64_t mm = (int64_t)f->block * f->block;
    spari_linear_zero(f->linear);
    for (int e = 0; e < f->elements; e++) {
        for (int64_t i = 0; i < mm; i++) {
            int64_t at = mm * e + i;
            S[i] = ck * K[at] + (C ? cv * C[at] : 0) + (f->M ? cm * f->M[at] : 0);
        }
        spari_linear_add(f->linear, e, S);
    }
    for (int i = 0; i < f->held; i++) {
        spari_linear_fix(f->linear, i);
    }
    f->factors++;
    *singular = spari_linear_factor(f->linear);
}

/* What of N and f belongs to omega_i omega_j alone. */
static void polarise(spari_frame *f) {
    for (int k = 3; k < SPARI_TURNS; k++) {
        for (int side = 0; side < 2; side++) {
            int d = pair[k][side];
            cblas_daxpy((int)f->size, -1, f->N[d], 1, f->N[k], 1);
            cblas_daxpy(6 * f->nodes, -1, f->f[d], 1, f->f[k], 1);
        }
    }
}

/* The stretch s_k = -K^-1 f_k of every product of turns, its stiffness S_k into N, and S_k s_l / 2 into what is counted
   twice. */
static int stretch_terms(spari_frame *f, const setup *w) {
    int singular = 0, n6 = 6 * f->nodes;
    double *S = spari_zalloc(f->size + SPARI_TURNS * (int64_t)n6, sizeof *S), *s = S + f->size;
    if (!S) {
        return SPAR_ERR_MEMORY;
    }
    factor_into(f, f->K, 1, NULL, 0, 0, w->S[0], &singular);
    for (int k = 0; k < SPARI_TURNS && !singular; k++) {
        double *x = s + (int64_t)k * n6;
        cblas_daxpy(n6, -1, f->f[k], 1, x, 1);
        memset(x, 0, 6 * sizeof *x);
        singular = spari_linear_solve(f->linear, x);
    }
    for (int k = 0; k < SPARI_TURNS && !singular; k++) {
        stretch_matrices(f, w, s + (int64_t)k * n6, S);
        cblas_daxpy((int)f->size, 1, S, 1, f->N[k], 1);
        for (int l = 0; l < SPARI_TURNS; l++) { /* those of two kinds come from both */
            add_times(f, S, s + (int64_t)l * n6, 0.5, f->twice[pair_of(k, l)]);
        }
    }
    free(S);
    return singular ? SPAR_ERR_NUMERIC : SPAR_OK;
}

static int turn_terms(spari_frame *f, const setup *w) {
    double *none = NULL;
    for (int k = 0; k < SPARI_TURNS; k++) {
        int i = pair[k][0], j = pair[k][1];
        double omega[3] = {0};
        omega[i] = omega[j] = 1;
        turn_matrices(f, w, omega, f->N[k], i == j ? f->G[i] : none);
        rigid_motion(f, w->arm, omega, w->v, w->a);
        spari_body_residual(w->body, w->q, w->v, w->a, 0, f->f[k], NULL);
    }
    polarise(f);
    return stretch_terms(f, w);
}

/* ---- modes ---- */

/* A [n - from][n - from] += scale times the symmetric part of X, over the unknowns from `from` on. */
static void assemble_dense(const spari_frame *f, const double *X, double scale, int from, double *A) {
    int m = f->block, step = f->block - f->overlap;
    int64_t n = f->n - from;
    for (int e = 0; e < f->elements; e++) {
        const double *x = X + (int64_t)m * m * e;
        for (int i = 0; i < m; i++) {
            for (int j = 0; j < m; j++) {
                int row = e * step + i - from, col = e * step + j - from;
                if (row >= 0 && col >= 0) {
                    A[n * row + col] += 0.5 * scale * (x[(int64_t)m * i + j] + x[(int64_t)m * j + i]);
                }
            }
        }
    }
}

/* The six rigid motions about the root, as columns of the basis. */
static void rigid_columns(spari_frame *f, const double *arm, int cols) {
    for (int i = 0; i < f->nodes; i++) {
        double W[9], *at = f->basis + (int64_t)6 * i * cols;
        spari_skew(arm + 3 * i, W);
        for (int r = 0; r < 3; r++) {
            at[r * cols + r] = at[(3 + r) * cols + 3 + r] = 1;
            for (int c = 0; c < 3; c++) {
                at[r * cols + 3 + c] = -W[3 * r + c];
            }
        }
    }
}

/* image := M times column k of the basis, which goes into x */
static void image_of(const spari_frame *f, int cols, int k, double *x, double *image) {
    cblas_dcopy(6 * f->nodes, f->basis + k, cols, x, 1);
    memset(image, 0, (size_t)(6 * f->nodes) * sizeof *image);
    add_times(f, f->M, x, 1, image);
}

/* The columns [from, end) orthonormal in the norm of the mass, to each other and to those from `held` on before them; a
   second pass takes out what rounding leaves. work: [12 nodes]. 1: a column without mass. */
static int orthonormalise(spari_frame *f, int cols, int from, int end, double *work) {
    int n = 6 * f->nodes;
    double *x = work, *image = work + n;
    for (int k = from; k < end; k++) {
        for (int pass = 0; pass < 2; pass++) {
            image_of(f, cols, k, x, image);
            for (int j = f->held; j < k; j++) {
                cblas_daxpy(n, -cblas_ddot(n, f->basis + j, cols, image, 1), f->basis + j, cols, f->basis + k, cols);
            }
        }
        image_of(f, cols, k, x, image);
        double square = cblas_ddot(n, x, 1, image, 1);
        if (!(square > 0)) {
            return 1;
        }
        cblas_dscal(n, 1 / sqrt(square), f->basis + k, cols);
    }
    return 0;
}

/* The lowest modes seen from the root, as columns from 6 on: K z = lambda (M - M R R^T M) z over the nodes beside it,
   where R are the rigid motions that the root leaves free, orthonormal: what those take on is no inertia of the
   deformation. Beams that nothing holds have a singular K, but not here: rigid motions are columns of their own.
   Solved for 1 / lambda, in which the low modes keep their digits. */
static int elastic_columns(spari_frame *f, int cols, double *work) {
    size_t n = (size_t)(6 * f->nodes - 6);
    gsl_matrix *K = gsl_matrix_calloc(n, n), *M = gsl_matrix_calloc(n, n), *z = gsl_matrix_alloc(n, n);
    gsl_vector *mu = gsl_vector_alloc(n);
    int status = K && M && z && mu ? SPAR_OK : SPAR_ERR_MEMORY;
    if (status == SPAR_OK) {
        double *x = work, *image = work + 6 * f->nodes;
        assemble_dense(f, f->K, 1, 6, K->data); /* fresh matrices have no gaps */
        assemble_dense(f, f->M, 1, 6, M->data);
        for (int k = f->held; k < 6; k++) {
            image_of(f, cols, k, x, image);
            gsl_vector_view beside = gsl_vector_view_array(image + 6, n);
            gsl_blas_dger(-1, &beside.vector, &beside.vector, M);
        }
        status = spari_eigen(M, K, mu, z);
    }
    if (status == SPAR_OK) {
        for (int k = 6; k < cols; k++) {
            int massive = gsl_vector_get(mu, (size_t)(k - 6)) > DBL_EPSILON * gsl_vector_get(mu, 0);
            status = massive ? status : SPAR_ERR_NUMERIC;
            for (size_t i = 0; i < n; i++) {
                f->basis[(6 + i) * (size_t)cols + (size_t)k] = gsl_matrix_get(z, i, (size_t)(k - 6));
            }
        }
    }
    gsl_matrix_free(K);
    gsl_matrix_free(M);
    gsl_matrix_free(z);
    gsl_vector_free(mu);
    return status;
}

/* Columns of the basis: the six rigid motions about the root, of which the first `held` stay zero, then the lowest
   modes; those that are free are orthonormal in the norm of the mass. */
static int fill_basis(spari_frame *f, const double *arm, int cols) {
    double *work = spari_zalloc(12 * (int64_t)f->nodes, sizeof *work);
    f->basis = spari_zalloc((int64_t)6 * f->nodes * cols, sizeof *f->basis);
    int status = work && f->basis ? SPAR_OK : SPAR_ERR_MEMORY;
    if (status == SPAR_OK) {
        rigid_columns(f, arm, cols);
        status = orthonormalise(f, cols, f->held, 6, work) ? SPAR_ERR_NUMERIC : elastic_columns(f, cols, work);
    }
    if (status == SPAR_OK && orthonormalise(f, cols, 6, cols, work)) {
        status = SPAR_ERR_NUMERIC;
    }
    free(work);
    return status;
}

/* *X := basis^T X basis */
static int project_matrix(const spari_frame *f, int cols, double **X) {
    int m = f->block, step = f->block - f->overlap;
    double *to = spari_zalloc((int64_t)cols * cols, sizeof *to), *half = spari_zalloc((int64_t)m * cols, sizeof *half);
    if (!to || !half) {
        free(to);
        free(half);
        return 1;
    }
    for (int e = 0; e < f->elements; e++) {
        const double *b = f->basis + (int64_t)e * step * cols;
        SPARI_BLAS(cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, m, cols, m, 1, *X + (int64_t)m * m * e, m, b,
                               cols, 0, half, cols));
        SPARI_BLAS(
            cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, cols, cols, m, 1, b, cols, half, cols, 1, to, cols));
    }
    free(half);
    free(*X);
    *X = to;
    return 0;
}

/* Rigid motions strain nothing: not by rounding either. */
static void no_strain(const spari_frame *f, double *X) {
    for (int i = 0; i < f->n && X; i++) {
        for (int j = 0; j < f->n; j++) {
            X[(int64_t)f->n * i + j] = i < 6 || j < 6 ? 0 : X[(int64_t)f->n * i + j];
        }
    }
}

static int project_all(spari_frame *f, int cols) {
    int bad = 0;
    double **all[3 + SPARI_TURNS + 3] = {&f->K, &f->M, &f->D};
    for (int k = 0; k < SPARI_TURNS; k++) {
        all[3 + k] = &f->N[k];
    }
    for (int k = 0; k < 3; k++) {
        all[3 + SPARI_TURNS + k] = &f->G[k];
    }
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        bad = bad || (*all[k] && project_matrix(f, cols, all[k]));
    }
    double *part = spari_zalloc(cols, sizeof *part);
    double *const *const vectors[] = {f->f, f->rigid, f->twice};
    const int counts[] = {SPARI_TURNS, 6, SPARI_TURN_PAIRS};
    for (int v = 0; v < 3 && part; v++) {
        for (int k = 0; k < counts[v] && vectors[v][k]; k++) {
            double *x = vectors[v][k];
            SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasTrans, 6 * f->nodes, cols, 1, f->basis, cols, x, 1, 0, part, 1));
            memcpy(x, part, (size_t)cols * sizeof *part);
        }
    }
    bad = bad || !part;
    free(part);
    f->elements = 1, f->block = cols, f->overlap = 6, f->n = cols;
    f->size = (int64_t)cols * cols;
    no_strain(f, f->K);
    no_strain(f, f->D);
    spari_linear_free(f->linear);
    f->linear = spari_linear_create(1, cols, 6);
    return bad || !f->linear;
}

/* ---- life ---- */

static int carve_states(spari_frame *f) {
    spari_frame_state *states[3] = {&f->begin, &f->from, &f->to};
    for (int k = 0; k < 3; k++) {
        double *block = spari_zalloc(4 * (int64_t)f->n, sizeof *block);
        if (!block) {
            return 1;
        }
        states[k]->y = block, states[k]->v = block + f->n;
        states[k]->a = block + 2 * f->n, states[k]->b = block + 3 * f->n;
        states[k]->root[3] = 1;
    }
    return 0;
}

static int allocate_matrices(spari_frame *f, const spar_member *m) {
    int turns = m->root == SPAR_ROOT_DRIVEN && (m->effects & SPAR_EFFECT_INERTIA), ok = 1;
    double **matrices[] = {&f->K, &f->M, &f->D};
    const int wanted[] = {1, m->body->mass != NULL, m->body->D != NULL};
    for (int k = 0; k < 3; k++) {
        ok = ok && (!wanted[k] || (*matrices[k] = spari_zalloc(f->size, sizeof(double))));
    }
    for (int k = 0; k < SPARI_TURNS; k++) {
        ok = ok && (!turns || ((f->N[k] = spari_zalloc(f->size, sizeof(double))) &&
                               (f->f[k] = spari_zalloc(6 * (int64_t)f->nodes, sizeof(double)))));
        ok = ok && (!f->M || (f->rigid[k] = spari_zalloc(6 * (int64_t)f->nodes, sizeof(double))));
    }
    for (int k = 0; k < 3; k++) {
        ok = ok && (!turns || (f->G[k] = spari_zalloc(f->size, sizeof(double))));
    }
    for (int k = 0; k < SPARI_TURN_PAIRS; k++) {
        ok = ok && (!turns || (f->twice[k] = spari_zalloc(6 * (int64_t)f->nodes, sizeof(double))));
    }
    return ok && (f->linear = spari_linear_create(f->elements, f->block, f->overlap)) ? 0 : 1;
}

static int allocate_work(spari_frame *f) {
    int64_t wide = f->n > 6 * f->nodes ? f->n : 6 * (int64_t)f->nodes;
    double **vectors[] = {&f->load, &f->load0, &f->load1, &f->r, &f->dx, &f->increment};
    int ok = carve_states(f) == 0;
    for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++) {
        ok = ok && (*vectors[k] = spari_zalloc(wide, sizeof(double)));
    }
    ok = ok && (f->nodal = spari_zalloc(18 * (int64_t)f->nodes, sizeof(double)));
    ok = ok && (f->turned = spari_zalloc(19 * (int64_t)f->nodes, sizeof(double)));
    ok = ok && (f->element = spari_zalloc((int64_t)f->block * f->block, sizeof(double)));
    if (f->N[0] || f->D) { /* else the sums are K and nothing */
        ok = ok && (f->sumC = spari_zalloc(f->size, sizeof(double)));
    }
    if (f->N[0]) {
        ok = ok && (f->sumK = spari_zalloc(f->size, sizeof(double))) && (f->sumf = spari_zalloc(f->n, sizeof(double)));
    }
    return !ok;
}

/* The reference as a state, and arms from the root; then the matrices. */
static int build_matrices(spari_frame *f, const spar_member *m, setup *w) {
    int64_t mm = (int64_t)w->m * w->m, n = f->nodes;
    double *block = spari_zalloc(7 * n + 3 * n + 13 * n + 4 * mm + 6 * n, sizeof *block);
    if (!block) {
        return SPAR_ERR_MEMORY;
    }
    w->q = block, w->arm = w->q + 7 * n, w->v = w->arm + 3 * n, w->a = w->v + 6 * n, w->field = w->a + 7 * n;
    for (int k = 0; k < 4; k++) {
        w->S[k] = w->field + 6 * n + mm * k;
    }
    spari_member_to_unique(m, 3, m->xr, w->arm);
    for (int64_t i = n - 1; i >= 0; i--) {
        for (int k = 0; k < 3; k++) {
            w->arm[3 * i + k] -= w->arm[k];
        }
        w->q[7 * i + 3] = 1;
    }
    rest_matrices(f, w);
    for (int k = 0; k < 6 && f->M; k++) {
        double unit[3] = {0};
        unit[k % 3] = 1;
        for (int64_t i = 0; i < n; i++) {
            memset(w->field + 6 * i, 0, 6 * sizeof *w->field);
            if (k < 3) {
                memcpy(w->field + 6 * i, unit, sizeof unit);
            } else {
                spari_cross(unit, w->arm + 3 * i, w->field + 6 * i);
                memcpy(w->field + 6 * i + 3, unit, sizeof unit);
            }
        }
        add_times(f, f->M, w->field, 1, f->rigid[k]);
    }
    return f->N[0] ? turn_terms(f, w) : SPAR_OK;
}

int spari_frame_create(spar_member *member, int64_t modes, spari_frame **frame) {
    spari_frame *f = spari_zalloc(1, sizeof *f);
    setup w = {.body = member->body, .m = 6 * member->per_element};
    int status = f ? SPAR_OK : SPAR_ERR_MEMORY;
    if (f) {
        int first;
        spari_solver_fixed(member, &first, &f->held);
        f->nodes = member->body->unique;
        f->elements = member->elements, f->block = w.m, f->overlap = 6, f->n = 6 * f->nodes;
        f->size = (int64_t)f->elements * f->block * f->block;
        status = allocate_matrices(f, member) ? SPAR_ERR_MEMORY : SPAR_OK;
    }
    if (status == SPAR_OK) {
        status = build_matrices(f, member, &w);
    }
    if (status == SPAR_OK && modes > 0) {
        int cols = (int)modes + f->held;
        status = fill_basis(f, w.arm, cols);
        if (status == SPAR_OK && project_all(f, cols)) {
            status = SPAR_ERR_MEMORY;
        }
    }
    free(w.q);
    if (status == SPAR_OK && allocate_work(f)) {
        status = SPAR_ERR_MEMORY;
    }
    if (status != SPAR_OK) {
        spari_frame_free(f);
        return spari_fail(
            member->session, status, "spar_member_commit: '%s': %s", member->name,
            status == SPAR_ERR_MEMORY
                ? "no memory for the linear member"
                : "its stiffness is not positive definite, or it has fewer modes with mass than asked for; "
                  "give every section mass and rotary inertia, or ask for fewer modes");
    }
    f->factors = 0; /* those of the set-up do not count */
    *frame = f;
    return SPAR_OK;
}

void spari_frame_free(spari_frame *f) {
    if (!f) {
        return;
    }
    double *all[] = {f->basis,   f->K,         f->M,     f->D,      f->sumK,   f->sumC,  f->sumf,
                     f->begin.y, f->from.y,    f->to.y,  f->load,   f->load0,  f->load1, f->r,
                     f->dx,      f->increment, f->nodal, f->turned, f->element};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        free(all[k]);
    }
    for (int k = 0; k < SPARI_TURNS; k++) {
        free(f->N[k]);
        free(f->f[k]);
        free(f->rigid[k]);
    }
    for (int k = 0; k < 3; k++) {
        free(f->G[k]);
    }
    for (int k = 0; k < SPARI_TURN_PAIRS; k++) {
        free(f->twice[k]);
    }
    spari_linear_free(f->linear);
    free(f);
}

/* ---- between the nodes' motion and the frame ---- */

static void matvec3(const double T[9], const double x[3], double y[3]) {
    for (int k = 0; k < 3; k++) {
        y[k] = T[3 * k] * x[0] + T[3 * k + 1] * x[1] + T[3 * k + 2] * x[2];
    }
}

/* Deformation and rates of the nodes' motion, seen from the frame, as unknowns. */
static void from_nodes(spari_frame *f, const spar_member *m, const spari_motion *nodes, double *y, double *rate) {
    double *x = f->nodal, *xd = x + 6 * (int64_t)f->nodes, pose[13];
    spari_member_pose(m, nodes, pose);
    for (int64_t i = 0; i < m->nodes; i++) {
        int64_t u = m->elements == 1 ? i : i - i / m->per_element;
        spari_member_deformation(m, pose, nodes, i, x + 6 * u, xd + 6 * u);
    }
    if (!f->basis) {
        memcpy(y, x, (size_t)f->n * sizeof *y);
        memcpy(rate, xd, (size_t)f->n * sizeof *y);
        return;
    }
    /* modal: the nearest in the norm of the mass, Phi^T M x; M of the nodes is gone, but the body has it as forces of
     * accelerations at the reference */
    const double *in[2] = {x, xd};
    double *out[2] = {y, rate}, *still = f->turned, *zero = still + 7 * (int64_t)f->nodes,
           *force = zero + 6 * (int64_t)f->nodes;
    memset(still, 0, (size_t)(13 * f->nodes) * sizeof *still);
    for (int i = 0; i < f->nodes; i++) {
        still[7 * i + 3] = 1;
    }
    for (int k = 0; k < 2; k++) {
        spari_body_residual(m->body, still, zero, in[k], 0, force, NULL);
        SPARI_BLAS(
            cblas_dgemv(CblasRowMajor, CblasTrans, 6 * f->nodes, f->n, 1, f->basis, f->n, force, 1, 0, out[k], 1));
        memset(out[k], 0, (size_t)f->held * sizeof *y);
    }
}

/* The nodes' motion q, v, a [unique] of a state; rotations of the nodes follow their rotation vectors exactly, second
 * derivatives to first order. */
static void to_nodes(spari_frame *f, const spar_member *m, const spari_frame_state *s, double *q, double *v,
                     double *a) {
    int64_t n6 = 6 * (int64_t)f->nodes;
    const double *x[3] = {s->y, s->v, s->a};
    for (int k = 0; k < 3 && f->basis; k++) {
        SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasNoTrans, (int)n6, f->n, 1, f->basis, f->n, x[k], 1, 0,
                               f->nodal + k * n6, 1));
        x[k] = f->nodal + k * n6;
    }
    const double *root = s->root;
    double omega[3], alpha[3];
    spari_rotate_back(root + 3, root + 10, omega);
    spari_rotate_back(root + 3, root + 16, alpha);
    for (int i = 0; i < f->nodes; i++) {
        const double *w = x[0] + 6 * i, *wd = x[1] + 6 * i, *wdd = x[2] + 6 * i;
        double arm[3], d[3], T[9], spin[3], twice[3], c1[3], c2[3], c3[3], p[4];
        double *qn = q + 7 * i, *vn = v + 6 * i, *an = a + 6 * i;
        spari_member_arm(m, i, arm);
        for (int k = 0; k < 3; k++) {
            d[k] = arm[k] + w[k];
        }
        spari_quat_exp(w + 3, p);
        spari_quat_mul(root + 3, p, qn + 3);
        spari_quat_normalise(qn + 3);
        spari_tangent(w + 3, T);
        matvec3(T, wd + 3, spin);
        matvec3(T, wdd + 3, twice);
        spari_cross(omega, d, c1);
        for (int k = 0; k < 3; k++) {
            vn[k] = c1[k] + wd[k];
            vn[3 + k] = omega[k] + spin[k];
            c1[k] += 2 * wd[k]; /* omega x (omega x d + 2 w') */
        }
        spari_cross(omega, c1, c2);
        spari_cross(alpha, d, c3);
        for (int k = 0; k < 3; k++) {
            an[k] = c2[k] + c3[k] + wdd[k];
        }
        spari_cross(omega, spin, c1);
        for (int k = 0; k < 3; k++) {
            an[3 + k] = alpha[k] + twice[k] + c1[k];
        }
        spari_rotate(root + 3, d, d);
        for (int k = 0; k < 6; k += 3) {
            spari_rotate(root + 3, vn + k, vn + k);
            spari_rotate(root + 3, an + k, an + k);
        }
        for (int k = 0; k < 3; k++) {
            qn[k] = d[k] - arm[k] + root[k];
            vn[k] += root[7 + k];
            an[k] += root[13 + k];
        }
    }
}

static void publish(spari_frame *f, spar_member *m, const spari_frame_state *s, spari_motion *to) {
    int64_t n = f->nodes;
    double *q = f->turned, *v = q + 7 * n, *a = v + 6 * n;
    to_nodes(f, m, s, q, v, a);
    spari_member_from_unique(m, 7, q, to->q);
    spari_member_from_unique(m, 6, v, to->v);
    spari_member_from_unique(m, 6, a, to->a);
}

int64_t spari_frame_unknowns(const spari_frame *f) {
    return f->n - f->held;
}

void spari_frame_modal(const spari_frame *f, const spar_member *m, double *K, double *M) {
    double pose[13], omega[3];
    spari_member_pose(m, &m->after, pose);
    spari_rotate_back(pose + 3, pose + 10, omega);
    assemble_dense(f, f->K, 1, f->held, K);
    assemble_dense(f, f->M, 1, f->held, M);
    for (int k = 0; k < SPARI_TURNS && f->N[0]; k++) {
        assemble_dense(f, f->N[k], omega[pair[k][0]] * omega[pair[k][1]], f->held, K);
    }
}

void spari_frame_shape(const spari_frame *f, const spar_member *m, const double *x, double *nodes) {
    double pose[13];
    spari_member_pose(m, &m->after, pose);
    memset(nodes, 0, (size_t)(6 * f->nodes) * sizeof *nodes);
    if (f->basis) {
        SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasNoTrans, 6 * f->nodes, f->n - f->held, 1, f->basis + f->held, f->n,
                               x, 1, 0, nodes, 1));
    } else {
        memcpy(nodes + f->held, x, (size_t)(f->n - f->held) * sizeof *nodes);
    }
    for (int i = 0; i < 6 * f->nodes; i += 3) {
        spari_rotate(pose + 3, nodes + i, nodes + i);
    }
}

/* ---- time ---- */

/* K + N, D + G and f of a turn; formed anew only when the turn has changed, in the frame's axes. */
static void combine(spari_frame *f, const double omega[3]) {
    double change[3] = {omega[0] - f->omega[0], omega[1] - f->omega[1], omega[2] - f->omega[2]};
    if (f->combined && spari_norm(change) <= 1e-13 * spari_norm(omega)) {
        return;
    }
    memcpy(f->omega, omega, sizeof f->omega);
    f->combined = 1;
    if (f->sumC) {
        for (int64_t i = 0; i < f->size; i++) {
            f->sumC[i] = f->D ? f->D[i] : 0;
        }
    }
    if (!f->N[0]) {
        return;
    }
    memcpy(f->sumK, f->K, (size_t)f->size * sizeof *f->sumK);
    memset(f->sumf, 0, (size_t)f->n * sizeof *f->sumf);
    double c[SPARI_TURNS];
    for (int k = 0; k < SPARI_TURNS; k++) {
        c[k] = omega[pair[k][0]] * omega[pair[k][1]];
        if (c[k] != 0) {
            cblas_daxpy((int)f->size, c[k], f->N[k], 1, f->sumK, 1);
            cblas_daxpy(f->n, c[k], f->f[k], 1, f->sumf, 1);
        }
        for (int l = 0; l <= k; l++) {
            if (c[k] * c[l] != 0) {
                cblas_daxpy(f->n, -c[k] * c[l], f->twice[pair_of(k, l)], 1, f->sumf, 1);
            }
        }
    }
    for (int k = 0; k < 3; k++) {
        if (omega[k] != 0) {
            cblas_daxpy((int)f->size, omega[k], f->G[k], 1, f->sumC, 1);
        }
    }
}

/* Nodal loads [unique][6] in global axes, as loads on the unknowns. Destroys x. */
static void turn_loads(const spari_frame *f, const double q[4], double *x, double *out) {
    for (int i = 0; i < 6 * f->nodes; i += 3) {
        spari_rotate_back(q, x + i, x + i);
    }
    if (f->basis) {
        SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasTrans, 6 * f->nodes, f->n, 1, f->basis, f->n, x, 1, 0, out, 1));
    } else {
        memcpy(out, x, (size_t)f->n * sizeof *out);
    }
}

/* What does not depend on the deformation: r = f + M (rigid acceleration - weight) - loads. Loads that follow depend on
 * it and are taken at the latest state. */
static void forcing(spari_frame *f, const spar_member *m, const spari_frame_state *s, int still, double *out) {
    double weight[3], *x = f->nodal;
    memcpy(x, f->load, (size_t)(6 * f->nodes) * sizeof *x);
    if (m->applied) {
        double *q = f->turned, *v = q + 7 * (int64_t)f->nodes, *a = v + 6 * (int64_t)f->nodes;
        to_nodes(f, m, s, q, v, a);
        for (int i = 0; i < 6 * f->nodes; i++) {
            x[i] = -f->load[i];
        }
        spari_applied_residual(m, q, 1, x);
        for (int i = 0; i < 6 * f->nodes; i++) {
            x[i] = -x[i];
        }
    }
    turn_loads(f, s->root + 3, x, out);
    for (int i = 0; i < f->n; i++) {
        out[i] = (still || !f->sumf ? 0 : f->sumf[i]) - out[i];
    }
    if (f->rigid[0]) {
        double rate[6] = {0};
        spari_rotate_back(s->root + 3, m->body->gravity, weight);
        if (!still) {
            spari_rotate_back(s->root + 3, s->root + 13, rate);
            spari_rotate_back(s->root + 3, s->root + 16, rate + 3);
        }
        for (int k = 0; k < 3; k++) {
            rate[k] -= weight[k];
        }
        for (int k = 0; k < 6; k++) {
            if (rate[k] != 0) {
                cblas_daxpy(f->n, rate[k], f->rigid[k], 1, out, 1);
            }
        }
    }
}

/* r = forcing + M a + C v + K y, the held rows out */
static void unbalance(const spari_frame *f, const spari_frame_state *s, int still, const double *fixed, double *r) {
    memcpy(r, fixed, (size_t)f->n * sizeof *r);
    add_times(f, f->sumK ? f->sumK : f->K, s->y, 1, r);
    if (f->sumC) {
        add_times(f, f->sumC, s->v, 1, r);
    }
    if (f->M && !still) {
        add_times(f, f->M, s->a, 1, r);
    }
    memset(r, 0, (size_t)f->held * sizeof *r);
}

static int factor_step(spari_frame *f, const spari_scheme *c) {
    int singular;
    factor_into(f, f->sumK ? f->sumK : f->K, 1, f->sumC, c->cv, c->cm, f->element, &singular);
    f->factored = !singular;
    f->kept_cm = c->cm, f->kept_cv = c->cv;
    memcpy(f->kept_omega, f->omega, sizeof f->omega);
    return singular;
}

static double largest(const spari_frame *f, const double *x) {
    double big = 0;
    for (int i = 0; i < f->n; i++) {
        big = fmax(big, fabs(x[i]));
    }
    return big;
}

/* Starting values: the accelerations stay. */
static void predict_unknowns(const spari_frame *f, const spari_scheme *c, const spari_frame_state *from,
                             spari_frame_state *to) {
    double h = c->h;
    for (int k = f->held; k < f->n; k++) {
        double b = from->b[k], a = from->a[k];
        if (c->still) {
            to->y[k] = from->y[k];
            to->v[k] = to->a[k] = to->b[k] = 0;
            continue;
        }
        to->a[k] = a;
        to->b[k] = (a - c->alpha_m * b) / (1 - c->alpha_m);
        to->y[k] = from->y[k] + h * from->v[k] + h * h * ((0.5 - c->beta) * b + c->beta * to->b[k]);
        to->v[k] = from->v[k] + h * ((1 - c->gamma) * b + c->gamma * to->b[k]);
    }
}

/* Where the root jumps (hosts that give no accelerations, a sudden start) the nodes keep place and velocity: seen from
   it they lose the jump; modal ones to the nearest, in the norm of the mass. */
static void take_jump(const spari_frame *f, const spar_member *m, double h, spari_frame_state *from,
                      const spari_frame_state *to) {
    double jump[2][6], *rows[2] = {from->v, from->y};
    spari_solver_jump(from->root, to->root, h, jump[0], jump[1]);
    for (int s = 0; s < 2; s++) {
        const double *J = jump[s];
        double *x = rows[s];
        for (int k = 6; k < f->n && f->basis; k++) {
            x[k] -= cblas_ddot(6, f->M + (int64_t)f->n * k, 1, J, 1);
        }
        for (int i = 1; i < f->nodes && !f->basis; i++) {
            double arm[3], turn[3];
            spari_member_arm(m, i, arm);
            spari_cross(J + 3, arm, turn);
            for (int k = 0; k < 3; k++) {
                x[6 * i + k] -= J[k] + turn[k];
                x[6 * i + 3 + k] -= J[3 + k];
            }
        }
    }
}

/* As spari_leap, with the matrix of the step itself, which is kept for it. */
static int leap(spari_frame *f, const spari_scheme *c, spari_frame_state *from) {
    double *y = f->increment;
    if (!f->factored && factor_step(f, c)) {
        return 1;
    }
    memcpy(y, from->b, (size_t)f->n * sizeof *y);
    memset(y, 0, (size_t)f->held * sizeof *y);
    for (int pass = 0; pass < SPARI_LEAP_PASSES; pass++) {
        memset(f->r, 0, (size_t)f->n * sizeof *f->r);
        add_times(f, f->M, y, 1, f->r);
        memset(f->r, 0, (size_t)f->held * sizeof *f->r);
        if (spari_linear_solve(f->linear, f->r)) {
            return 1;
        }
        cblas_daxpy(f->n, -c->cm, f->r, 1, y, 1);
    }
    cblas_daxpy(f->n, -1, y, 1, from->b, 1);
    return 0;
}

enum { MOST_ITERATIONS = 30 };

/* One substep. The equations are linear: one solution with their own matrix ends it; with the matrix of a slightly
   other turn, or with loads that follow, the corrections shrink until they are rounding. */
static int substep(spari_frame *f, spar_member *m, const spari_scheme *c, int leaps, spari_frame_state *from,
                   spari_frame_state *to) {
    double omega[3], last = 0;
    spari_rotate_back(to->root + 3, to->root + 10, omega);
    combine(f, omega);
    int same = f->factored && c->cm == f->kept_cm && c->cv == f->kept_cv;
    f->factored = same;
    if (!c->still && m->root == SPAR_ROOT_DRIVEN) {
        take_jump(f, m, c->h, from, to);
    }
    if (leaps && leap(f, c, from)) {
        return 1;
    }
    predict_unknowns(f, c, from, to);
    double *fixed = f->increment;
    for (int it = 0; it < MOST_ITERATIONS; it++) {
        if (it == 0 || m->applied) {
            forcing(f, m, to, c->still, fixed);
        }
        unbalance(f, to, c->still, fixed, f->r);
        if (!f->factored && factor_step(f, c)) {
            return 1;
        }
        int exact = !m->applied && memcmp(f->kept_omega, f->omega, sizeof f->omega) == 0;
        memcpy(f->dx, f->r, (size_t)f->n * sizeof *f->dx);
        if (spari_linear_solve(f->linear, f->dx)) {
            return 1;
        }
        f->solves++;
        for (int k = f->held; k < f->n; k++) {
            to->y[k] -= f->dx[k];
            to->v[k] -= c->still ? f->dx[k] / c->h : c->cv * f->dx[k];
            to->a[k] -= c->cm * f->dx[k];
            to->b[k] -= c->cb * f->dx[k];
        }
        double step = largest(f, f->dx), theta = last > 0 ? step / last : 0;
        if (exact || step <= m->session->newton_atol + m->session->newton_rtol * largest(f, to->y) ||
            (it > 2 && theta > 0.5 && step <= 1e-10 * largest(f, to->y))) {
            return 0;
        }
        if (theta > 0.2) {
            f->factored = 0;
        }
        last = step;
    }
    return 1;
}

/* As start_accelerations() of alpha.c: accelerations at t^0 through M + K / cm. */
static int start_accelerations(spari_frame *f, spar_member *m, const spari_scheme *c) {
    spari_frame_state *b = &f->begin;
    double omega[3];
    int singular;
    spari_rotate_back(b->root + 3, b->root + 10, omega);
    combine(f, omega);
    factor_into(f, f->sumK ? f->sumK : f->K, 1, NULL, 0, c->cm, f->element, &singular);
    f->factored = 0;
    memcpy(f->load, f->load0, (size_t)(6 * f->nodes) * sizeof *f->load);
    forcing(f, m, b, c->still, f->increment);
    for (int k = 0; k < 4 && !singular; k++) {
        unbalance(f, b, c->still, f->increment, f->r);
        singular = spari_linear_solve(f->linear, f->r);
        for (int i = f->held; i < f->n; i++) {
            b->a[i] -= c->cm * f->r[i];
        }
    }
    memcpy(b->b, b->a, (size_t)f->n * sizeof *b->b);
    f->started = 1;
    return singular;
}

static void copy_state(const spari_frame *f, const spari_frame_state *from, spari_frame_state *to) {
    memcpy(to->y, from->y, (size_t)(4 * f->n) * sizeof *to->y);
    memcpy(to->root, from->root, sizeof to->root);
}

static void swap_states(spari_frame_state *a, spari_frame_state *b) {
    spari_frame_state t = *a;
    *a = *b;
    *b = t;
}

static double damped_power(spari_frame *f, const spari_frame_state *s) {
    double power = 0;
    if (f->D) {
        memset(f->r, 0, (size_t)f->n * sizeof *f->r);
        add_times(f, f->D, s->v, 1, f->r);
        power = cblas_ddot(f->n, f->r, 1, s->v, 1);
    }
    return power;
}

/* A root that is not driven stays where it is. */
static void root_at(spari_frame *f, const spar_member *m, double s, double dt) {
    memcpy(f->to.root, f->begin.root, sizeof f->to.root);
    if (m->root == SPAR_ROOT_DRIVEN) {
        spari_solver_root_at(m, s, dt, f->to.root);
    }
}

int spari_frame_advance(spari_frame *f, spar_member *m, double dt) {
    int A = m->session->substeps;
    spari_scheme_loads(m, f->load0, f->load1, f->load);
    spari_scheme c = spari_scheme_of(m, dt / A);
    int failed = !f->started && !c.still && start_accelerations(f, m, &c);
    copy_state(f, &f->begin, &f->to);
    spari_scheme_stretch_by(spari_scheme_stretch(f->h_begin, c.h), f->n, f->to.a, f->to.b);
    int leaps = !c.still && spari_is_leap(f->h_begin, c.h);
    f->h_solved = c.h;
    m->dissipated_step = 0;
    double power = damped_power(f, &f->begin);
    for (int k = 1; k <= A && !failed; k++) {
        double s = (double)k / A;
        swap_states(&f->from, &f->to);
        spari_scheme_load_at(s, 6 * f->nodes, f->load0, f->load1, f->load);
        root_at(f, m, s, dt);
        failed = substep(f, m, &c, k == 1 && leaps, &f->from, &f->to);
        double before = power;
        power = damped_power(f, &f->to);
        m->dissipated_step += 0.5 * c.h * (before + power);
    }
    if (failed) {
        f->factored = 0;
        return spari_fail(m->session, SPAR_ERR_NUMERIC,
                          "member '%s': the linear equations have no solution in the step from t = %g; look at the "
                          "turning speed of its root, or at loads that follow it",
                          m->name, m->session->time);
    }
    publish(f, m, &f->to, &m->after);
    return SPAR_OK;
}

void spari_frame_accept(spari_frame *f) {
    swap_states(&f->begin, &f->to);
    f->h_begin = f->h_solved;
}

void spari_frame_restart(spari_frame *f, const spar_member *m) {
    memset(f->begin.root, 0, sizeof f->begin.root);
    spari_member_pose(m, &m->now, f->begin.root);
    if (m->root == SPAR_ROOT_DRIVEN) {
        memcpy(f->begin.root + 13, m->now.a, 6 * sizeof(double));
    }
    memset(f->begin.y, 0, (size_t)(4 * f->n) * sizeof(double));
    from_nodes(f, m, &m->now, f->begin.y, f->begin.v);
    copy_state(f, &f->begin, &f->to);
    f->started = 0;
    f->h_begin = 0;
}

int spari_frame_static(spari_frame *f, spar_member *m) {
    double last = 0, omega[3];
    int failed = 1;
    spari_turn turn;
    SPARI_REQUIRE(
        m->session, f->held == 6, SPAR_ERR_STATE,
        "spar_member_solve_static: '%s': nothing holds a linear member that its root leaves free to turn; fix "
        "or drive its root",
        m->name);
    int turning = m->root == SPAR_ROOT_DRIVEN && spari_turn_of(m, f->begin.root + 7, f->begin.root + 13, &turn);
    spari_solver_gather(m, m->dead, f->load);
    spari_solver_gather(m, m->load_pushed, f->load1);
    for (int i = 0; i < 6 * f->nodes; i++) {
        f->load[i] += f->load1[i];
    }
    spari_scheme c = {.cm = 0, .cv = 0};
    copy_state(f, &f->begin, &f->to);
    memset(f->to.root + (turning ? 16 : 7), 0, (turning ? 3 : 12) * sizeof(double)); /* steady, or at rest */
    spari_rotate_back(f->to.root + 3, f->to.root + 10, omega);
    combine(f, omega);
    memset(f->to.v, 0, (size_t)(3 * f->n) * sizeof(double));
    int singular = factor_step(f, &c);
    f->factored = 0;
    for (int it = 0; it < MOST_ITERATIONS && failed && !singular; it++) {
        forcing(f, m, &f->to, !turning, f->increment);
        unbalance(f, &f->to, !turning, f->increment, f->r);
        memcpy(f->dx, f->r, (size_t)f->n * sizeof *f->dx);
        singular = spari_linear_solve(f->linear, f->dx);
        for (int k = 6; k < f->n; k++) {
            f->to.y[k] -= f->dx[k];
        }
        double step = largest(f, f->dx);
        failed = m->applied && step > 1e-11 * largest(f, f->to.y) && !(it > 2 && step > 0.5 * last && step < 1e-9);
        last = step;
    }
    if (!singular && !failed) {
        publish(f, m, &f->to, &m->after);
        failed = spari_first_nonfinite(m->after.q, 7 * m->nodes) >= 0 ||
                 spari_first_nonfinite(m->after.a, 6 * m->nodes) >= 0;
    }
    if (singular || failed) {
        return spari_fail(m->session, SPAR_ERR_NUMERIC,
                          "spar_member_solve_static: '%s': the linear member has no equilibrium under these loads; the "
                          "state is as it was",
                          m->name);
    }
    publish(f, m, &f->to, &m->now);
    return SPAR_OK;
}

enum { STATE_HEAD = 14 };

int64_t spari_frame_state_size(const spari_frame *f) {
    return STATE_HEAD + 19 + 4 * (int64_t)f->n;
}

void spari_frame_save(const spari_frame *f, double *state) {
    const double head[STATE_HEAD] = {f->n,        f->factored,      f->kept_cm,       f->kept_cv,      f->h_begin,
                                     f->h_solved, f->started,       f->combined,      f->omega[0],     f->omega[1],
                                     f->omega[2], f->kept_omega[0], f->kept_omega[1], f->kept_omega[2]};
    memcpy(state, head, sizeof head);
    memcpy(state + STATE_HEAD, f->begin.root, sizeof f->begin.root);
    memcpy(state + STATE_HEAD + 19, f->begin.y, (size_t)(4 * f->n) * sizeof *state);
}

int spari_frame_is_state(const spari_frame *f, const double *state, int64_t count) {
    return count == spari_frame_state_size(f) && state[0] == f->n;
}

/* The kept factors are those of the kept turn and coefficients, to the last bit. */
void spari_frame_load(spari_frame *f, const double *state) {
    spari_scheme c = {.cm = state[2], .cv = state[3]};
    f->factored = 0;
    f->combined = 0;
    if (state[1] != 0) {
        combine(f, state + 11);
        factor_step(f, &c);
    }
    f->combined = 0;
    if (state[7] != 0) {
        combine(f, state + 8);
    }
    f->h_begin = state[4], f->h_solved = state[5];
    f->started = state[6] != 0;
    memcpy(f->begin.root, state + STATE_HEAD, sizeof f->begin.root);
    memcpy(f->begin.y, state + STATE_HEAD + 19, (size_t)(4 * f->n) * sizeof *state);
    copy_state(f, &f->begin, &f->to);
}

/* x^T X x / 2 */
static double half_form(spari_frame *f, const double *X, const double *x) {
    memset(f->r, 0, (size_t)f->n * sizeof *f->r);
    add_times(f, X, x, 0.5, f->r);
    return cblas_ddot(f->n, x, 1, f->r, 1);
}

int spari_frame_energy(spari_frame *f, const spar_member *m, double energy[4]) {
    double *y = spari_zalloc(2 * (int64_t)f->n, sizeof *y), *rate = y + f->n;
    if (!y) {
        return SPAR_ERR_MEMORY;
    }
    from_nodes(f, m, &m->after, y, rate);
    energy[1] = half_form(f, f->K, y);
    if (m->root != SPAR_ROOT_DRIVEN) { /* the frame stands: these are what the equations keep */
        energy[0] = f->M && (m->effects & SPAR_EFFECT_INERTIA) ? half_form(f, f->M, rate) : 0;
        energy[2] = 0;
        for (int k = 0; k < 3 && f->M; k++) {
            energy[2] -= m->body->gravity[k] * cblas_ddot(f->n, f->rigid[k], 1, y, 1);
        }
    }
    free(y);
    return SPAR_OK;
}
