/* The modes of a frame: the basis of a modal member, and modes about a state of steady rotation. */
#include "frame.h"

#include "../algebra/cblas.h"
#include "../algebra/lowest_modes.h"
#include "../algebra/pencil.h"
#include "../base/status.h"
#include "../math/rotation.h"
#include "../member/added_mass.h"
#include "../member/pose.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

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
    spari_frame_add_times(f, f->M, x, 1, image);
}

/* Makes the columns [from, end) orthonormal in the norm of the mass, to each other and to the free columns before
   them. A second pass removes rounding errors. work: [12 nodes]. 1: a column without mass. */
static int orthonormalise(spari_frame *f, int cols, int from, int end, double *work) {
    int n = 6 * f->nodes;
    double *x = work, *image = work + n;
    for (int k = from; k < end; k++) {
        for (int pass = 0; pass < 2; pass++) {
            image_of(f, cols, k, x, image);
            for (int j = f->constrained; j < k; j++) {
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

/* The lowest modes relative to the root, as the columns after the rigid ones: K z = lambda (M - M R R^T M) z over the
   nodes beside the root. R are the orthonormal rigid motions that the root leaves free; their inertia is not that of
   the deformation. K is not singular here even for a free beam, because rigid motions are separate columns. */
static int elastic_columns(spari_frame *f, int cols, double *work) {
    int n = 6 * f->nodes - 6, wanted = cols - 6, step = f->block - f->overlap, available;
    spari_pencil pencil;
    int status = spari_pencil_create(&pencil, n);
    double *square = spari_zalloc(wanted + (int64_t)n * (wanted + 6), sizeof *square), *z = square + wanted;
    int *block = spari_zalloc(n, sizeof *block);
    if (status != SPAR_OK || !square || !block) {
        status = SPAR_ERR_MEMORY;
    } else {
        /* images of the rigid motions that the root leaves free [6 - constrained][n] */
        double *W = z + (int64_t)n * wanted;
        for (int k = f->constrained; k < 6; k++) {
            image_of(f, cols, k, work, work + 6 * f->nodes);
            memcpy(W + (int64_t)n * (k - f->constrained), work + 6 * f->nodes + 6, (size_t)n * sizeof *W);
        }
        for (int e = 0; e < f->elements; e++) {
            int64_t at = (int64_t)f->block * f->block * e;
            spari_pencil_add_symmetric(&pencil, e * step - 6, f->block, f->K + at, f->M + at);
        }
        for (int i = 0; i < n; i++) {
            block[i] = i / 6;
        }
        const spari_modes_problem problem = {&pencil, block, 6 - f->constrained, W};
        status = pencil.full ? SPAR_ERR_MEMORY : spari_lowest_modes(&problem, wanted, square, z, &available);
    }
    status = status == SPAR_OK || status == SPAR_ERR_MEMORY ? status : SPAR_ERR_NUMERIC;
    for (int k = 0; k < wanted && status == SPAR_OK; k++) {
        status = DBL_EPSILON * square[k] < square[0] ? status : SPAR_ERR_NUMERIC;
        cblas_dcopy(n, z + (int64_t)n * k, 1, f->basis + (int64_t)6 * cols + 6 + k, cols);
    }
    spari_pencil_free(&pencil);
    SPARI_FREE(square, block);
    return status;
}

int spari_frame_fill_basis(spari_frame *f, const double *arm, int cols) {
    double *work = spari_zalloc(12 * (int64_t)f->nodes, sizeof *work);
    f->basis = spari_zalloc((int64_t)6 * f->nodes * cols, sizeof *f->basis);
    int status = work && f->basis ? SPAR_OK : SPAR_ERR_MEMORY;
    if (status == SPAR_OK) {
        rigid_columns(f, arm, cols);
        status = orthonormalise(f, cols, f->constrained, 6, work) ? SPAR_ERR_NUMERIC : SPAR_OK;
    }
    if (status == SPAR_OK && cols > 6) {
        status = elastic_columns(f, cols, work);
    }
    if (status == SPAR_OK && orthonormalise(f, cols, 6, cols, work)) {
        status = SPAR_ERR_NUMERIC;
    }
    free(work);
    return status;
}

/* Makes the strain of rigid motions exactly 0. */
static void no_strain(const spari_frame *f, double *X) {
    for (int i = 0; i < f->n && X; i++) {
        for (int j = 0; j < f->n; j++) {
            X[(int64_t)f->n * i + j] = i < 6 || j < 6 ? 0 : X[(int64_t)f->n * i + j];
        }
    }
}

int spari_frame_project(spari_frame *f, const spar_member *m, int cols) {
    int bad = 0;
    double **all[4 + SPARI_SPIN_PRODUCTS + 6] = {&f->K, &f->M, &f->D, &f->A};
    for (int k = 0; k < SPARI_SPIN_PRODUCTS; k++) {
        all[4 + k] = &f->N[k];
    }
    for (int k = 0; k < 3; k++) {
        all[4 + SPARI_SPIN_PRODUCTS + k] = &f->G[k];
        all[7 + SPARI_SPIN_PRODUCTS + k] = &f->E[k];
    }
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        bad = bad || (*all[k] && spari_frame_project_matrix(f, m->body, cols, all[k]));
    }
    double *part = spari_zalloc(cols, sizeof *part);
    double *const *const vectors[] = {f->f, f->rigid, &f->pull};
    const int counts[] = {SPARI_SPIN_PRODUCTS, 6, 1};
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
    no_strain(f, m->load.foundation || f->pull ? NULL : f->K); /* else they strain foundation or pretension */
    no_strain(f, f->D);
    for (int i = 0; i < cols && m->body->mass_damping > 0 && !bad; i++) { /* mass-proportional damping acts on them */
        for (int j = 0; j < cols; j++) {
            f->D[(int64_t)cols * i + j] += i < 6 || j < 6 ? m->body->mass_damping * f->M[(int64_t)cols * i + j] : 0;
        }
    }
    spari_linear_free(f->linear);
    f->linear = spari_linear_create(1, cols, 6);
    return bad || !f->linear;
}

void spari_frame_remass(spar_member *m) {
    spari_frame *f = m->solution;
    int block = 6 * m->mesh.per_element, cols = f->n;
    double *X = f->dense_A, *half = X + (int64_t)block * block;
    memset(f->A, 0, (size_t)f->size * sizeof *f->A);
    for (int e = 0; e < m->mesh.elements; e++) {
        const double *b = f->basis ? f->basis + (int64_t)e * (block - 6) * cols : NULL;
        double *to = b ? X : f->A + (int64_t)block * block * e;
        memset(to, 0, (size_t)(block * block) * sizeof *to);
        spari_added_tangent(m, e, 1, NULL, to);
        if (b) {
            SPARI_BLAS(cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, block, cols, block, 1, X, block, b, cols,
                                   0, half, cols));
            SPARI_BLAS(cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, cols, cols, block, 1, b, cols, half, cols,
                                   1, f->A, cols));
        }
    }
    f->tangent.factored = 0;
}

/* ---- about a state ---- */

/* The terms of the stiffness about member->after, in steady motion: without angular acceleration. */
static int terms_about(const spar_member *m, double rates[SPARI_FRAME_RATES], spari_frame_term term[SPARI_FIELDS],
                       int *terms) {
    spari_pose root = spari_member_pose(m, &m->after);
    memcpy(root.a, m->root == SPAR_ROOT_DRIVEN ? m->after.a : root.a, 3 * sizeof *root.a);
    spari_frame_rates(m, &root, !(m->effects & SPAR_EFFECT_INERTIA), 1, rates);
    SPARI_TRY(spari_frame_weigh(m->solution, m, rates + 6));
    *terms = spari_frame_terms(m->solution, rates, term);
    return SPAR_OK;
}

int spari_frame_problem(const spar_member *m, spari_pencil *to) {
    const spari_frame *f = m->solution;
    int constrained = spari_member_constrained(m), step = f->block - f->overlap, terms = 0;
    int64_t size = (int64_t)f->block * f->block;
    double rates[SPARI_FRAME_RATES];
    spari_frame_term term[SPARI_FIELDS];
    SPARI_TRY(terms_about(m, rates, term, &terms));
    double *K = spari_zalloc(size, sizeof *K);
    if (!K) {
        return SPAR_ERR_MEMORY;
    }
    for (int e = 0; e < f->elements; e++) {
        memcpy(K, f->K + size * e, (size_t)size * sizeof *K);
        for (int k = 0; k < terms; k++) {
            cblas_daxpy((int)size, term[k].factor, term[k].X + size * e, 1, K, 1);
        }
        spari_pencil_add_symmetric(to, e * step - constrained, f->block, K, f->M + size * e);
    }
    free(K);
    return SPAR_OK;
}

/* Small deformation is relative to the root, so the root must rotate as the frame does. */
int spari_frame_linearise(const spar_member *m, const double w[3], spari_pencil *to) {
    const spari_frame *f = m->solution;
    double difference[3], own = spari_norm(m->after.v + 3);
    for (int k = 0; k < 3; k++) {
        difference[k] = m->after.v[3 + k] - w[k];
    }
    if (spari_norm(difference) > 1e-4 * fmax(own, spari_norm(w))) {
        return SPAR_ERR_UNSUPPORTED;
    }
    int constrained = spari_member_constrained(m), step = f->block - f->overlap, terms = 0;
    int64_t mm = (int64_t)f->block * f->block;
    double omega[SPARI_FRAME_RATES];
    spari_frame_term term[SPARI_FIELDS];
    SPARI_TRY(terms_about(m, omega, term, &terms));
    for (int e = 0; e < f->elements; e++) {
        int64_t at = mm * e;
        spari_pencil_add(to, e * step - constrained, f->block, f->block, f->K + at, f->D ? f->D + at : NULL,
                         f->M ? f->M + at : NULL);
        for (int i = 0; i < f->block * f->block && (f->N[0] || terms > 0); i++) {
            int row = e * step - constrained + i / f->block, column = e * step - constrained + i % f->block;
            spari_pencil_entry x = {to->base + row, to->base + column, 0, 0, 0};
            for (int k = 0; k < terms; k++) {
                x.k += term[k].factor * term[k].X[at + i];
            }
            for (int k = 0; k < 3 && f->N[0]; k++) {
                x.c += omega[k] * f->G[k][at + i];
            }
            if (row >= 0 && column >= 0) {
                spari_pencil_put(to, x);
            }
        }
    }
    return SPAR_OK;
}

void spari_frame_shape(const spar_member *m, const double *x, double *workspace, double *nodes) {
    const spari_frame *f = m->solution;
    const spari_pose pose = spari_member_pose(m, &m->after);
    int constrained = spari_member_constrained(m);
    memset(workspace, 0, (size_t)(6 * f->nodes) * sizeof *workspace);
    if (f->basis) {
        SPARI_BLAS(cblas_dgemv(CblasRowMajor, CblasNoTrans, 6 * f->nodes, f->n - constrained, 1, f->basis + constrained,
                               f->n, x, 1, 0, workspace, 1));
    } else {
        memcpy(workspace + constrained, x, (size_t)(f->n - constrained) * sizeof *workspace);
    }
    for (int i = 0; i < 6 * f->nodes; i += 3) {
        spari_rotate(pose.q + 3, workspace + i, workspace + i);
    }
    spari_member_from_unique(m, 6, workspace, nodes);
}
