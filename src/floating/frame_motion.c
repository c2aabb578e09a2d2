/* The matrices of a frame for the motion of its root: P formed when there is an acceleration or weight, the sums K + N
   + E + P and D + G. See frame.h. */
#include "../algebra/cblas.h"
#include "../math/rotation.h"
#include "../member/body.h"
#include "frame.h"

#include <stdlib.h>
#include <string.h>

double *spari_frame_arms(const spar_member *m) {
    double *arm = spari_zalloc(3 * (int64_t)m->body->unique, sizeof *arm);
    if (arm) {
        spari_member_to_unique(m, 3, m->xr, arm);
        for (int64_t i = m->body->unique - 1; i >= 0; i--) {
            for (int k = 0; k < 3; k++) {
                arm[3 * i + k] -= arm[k];
            }
        }
    }
    return arm;
}

int spari_frame_project_matrix(const spari_frame *f, const spari_body *body, int cols, double **X) {
    int m = 6 * body->per_element, step = m - 6;
    double *to = spari_zalloc((int64_t)cols * cols, sizeof *to), *half = spari_zalloc((int64_t)m * cols, sizeof *half);
    if (!to || !half) {
        SPARI_FREE(to, half);
        return 1;
    }
    for (int e = 0; e < body->elements; e++) {
        const double *b = f->basis + (int64_t)e * step * cols;
        SPARI_BLAS(cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, m, cols, m, 1, *X + (int64_t)m * m * e, m, b,
                               cols, 0, half, cols));
        SPARI_BLAS(
            cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, cols, cols, m, 1, b, cols, half, cols, 1, to, cols));
    }
    SPARI_FREE(half, *X);
    *X = to;
    return 0;
}

int spari_frame_weigh(spari_frame *f, const spar_member *m, const double field[3]) {
    if (f->P[0] || !f->M || m->root == SPAR_ROOT_FREE || !(spari_norm(field) > 0)) {
        return SPAR_OK;
    }
    const int64_t size = 36 * (int64_t)m->mesh.elements * m->mesh.per_element * m->mesh.per_element;
    double *arm = spari_frame_arms(m), *P[3] = {0};
    int ok = arm && (f->sumK || (f->sumK = spari_zalloc(f->size, sizeof *f->sumK)));
    for (int k = 0; k < 3; k++) {
        ok = ok && (P[k] = spari_zalloc(size, sizeof *P[k]));
    }
    ok = ok && spari_frame_form_translations(m->body, arm, P) == SPAR_OK;
    for (int k = 0; k < 3 && f->basis; k++) {
        ok = ok && spari_frame_project_matrix(f, m->body, f->n, &P[k]) == 0;
    }
    free(arm);
    f->combined = 0; /* there is a sum now */
    if (!ok) {
        SPARI_FREE(P[0], P[1], P[2]);
        return SPAR_ERR_MEMORY;
    }
    memcpy(f->P, P, sizeof f->P);
    return SPAR_OK;
}

/* Whether two sets of rates are the same except for rounding; that of angular accelerations is relative to omega
   squared. */
static int is_same_motion(const double before[SPARI_FRAME_RATES], const double rates[SPARI_FRAME_RATES]) {
    const double speed = spari_norm(rates), rate = spari_norm(rates + 3) + speed * speed;
    double change[SPARI_FRAME_RATES];
    for (int k = 0; k < SPARI_FRAME_RATES; k++) {
        change[k] = rates[k] - before[k];
    }
    return spari_norm(change) <= 1e-13 * speed && spari_norm(change + 3) <= 1e-13 * rate &&
           spari_norm(change + 6) <= 1e-13 * spari_norm(rates + 6);
}

void spari_frame_rates(const spar_member *m, const spari_pose *root, int still, double factor,
                       double rates[SPARI_FRAME_RATES]) {
    double field[3];
    for (int k = 0; k < 3; k++) {
        field[k] = (still ? 0 : root->a[k]) - factor * m->body->gravity[k];
    }
    memset(rates, 0, SPARI_FRAME_RATES * sizeof *rates);
    spari_rotate_back(root->q + 3, root->v + 3, rates);
    if (!still) {
        spari_rotate_back(root->q + 3, root->a + 3, rates + 3);
    }
    spari_rotate_back(root->q + 3, field, rates + 6);
}

int spari_frame_terms(const spari_frame *f, const double rates[SPARI_FRAME_RATES],
                      spari_frame_term term[SPARI_FIELDS]) {
    int n = 0;
    for (int k = 0; k < SPARI_SPIN_PRODUCTS && f->N[0]; k++) {
        const double c = rates[spari_frame_pair[k][0]] * rates[spari_frame_pair[k][1]];
        if (c != 0) {
            term[n++] = (spari_frame_term){c, f->N[k]};
        }
    }
    for (int k = 0; k < 6; k++) {
        const double *X = k < 3 ? f->E[k] : f->P[k - 3];
        if (X && rates[3 + k] != 0) {
            term[n++] = (spari_frame_term){rates[3 + k], X};
        }
    }
    return n;
}

/* D + G(omega) */
static void combine_rates(spari_frame *f, const double omega[3]) {
    memset(f->sumC, 0, (size_t)f->size * sizeof *f->sumC);
    if (f->D) {
        memcpy(f->sumC, f->D, (size_t)f->size * sizeof *f->sumC);
    }
    for (int k = 0; k < 3; k++) {
        if (f->G[k] && omega[k] != 0) {
            cblas_daxpy((int)f->size, omega[k], f->G[k], 1, f->sumC, 1);
        }
    }
}

int spari_frame_combine(spari_frame *f, const spar_member *m, const double rates[SPARI_FRAME_RATES]) {
    if (f->combined && is_same_motion(f->rates, rates)) {
        return SPAR_OK;
    }
    SPARI_TRY(spari_frame_weigh(f, m, rates + 6));
    memcpy(f->rates, rates, sizeof f->rates);
    f->combined = 1;
    if (f->sumC) {
        combine_rates(f, rates);
    }
    if (f->sumf) {
        memset(f->sumf, 0, (size_t)f->n * sizeof *f->sumf);
        for (int k = 0; k < SPARI_SPIN_PRODUCTS; k++) {
            const double c = rates[spari_frame_pair[k][0]] * rates[spari_frame_pair[k][1]];
            cblas_daxpy(c != 0 ? f->n : 0, c, f->f[k], 1, f->sumf, 1);
        }
    }
    if (f->sumK) {
        spari_frame_term term[SPARI_FIELDS];
        const int terms = spari_frame_terms(f, rates, term);
        memcpy(f->sumK, f->K, (size_t)f->size * sizeof *f->sumK);
        for (int k = 0; k < terms; k++) {
            cblas_daxpy((int)f->size, term[k].factor, term[k].X, 1, f->sumK, 1);
        }
    }
    return SPAR_OK;
}
