/* Modes about the present state, seen from the frame that turns with the root: K x = omega^2 M x over the unknowns that
   the root leaves free. K is the tangent in that frame (turn.h); Coriolis' forces are left out, so that the problem
   stays symmetric. Solved as M x = mu (K + sigma M) x, mu = 1 / (omega^2 + sigma): the low modes are the large mu and
   keep their digits beside stiffnesses and rotary inertias that differ by many powers of ten; M may be singular. sigma
   is 0 where K is positive definite, else the smallest tried that makes it so. */
#include "../base/blas.h"
#include "../base/quiet.h"
#include "../base/scene.h"
#include "../member/body.h"
#include "../member/edge.h"
#include "../member/joint.h"
#include "eigen.h"
#include "fidelity.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The problem over the free unknowns. */
typedef struct modal {
    size_t size;
    gsl_matrix *K, *M, *A, *B, *x;
    gsl_vector *lambda, *work;
    double *room; /* 6 of each unique node */
} modal;

static void modal_free(modal *p) {
    gsl_matrix_free(p->K);
    gsl_matrix_free(p->M);
    gsl_matrix_free(p->A);
    gsl_matrix_free(p->B);
    gsl_matrix_free(p->x);
    gsl_vector_free(p->lambda);
    gsl_vector_free(p->work);
    free(p->room);
}

static int modal_alloc(const spar_member *m, modal *p) {
    size_t n = p->size;
    p->K = gsl_matrix_calloc(n, n);
    p->M = gsl_matrix_calloc(n, n);
    p->A = gsl_matrix_alloc(n, n);
    p->B = gsl_matrix_alloc(n, n);
    p->x = gsl_matrix_alloc(n, n);
    p->lambda = gsl_vector_alloc(n);
    p->work = gsl_vector_alloc(n);
    p->room = spari_zalloc(6 * (int64_t)m->body->unique, sizeof *p->room);
    return p->K && p->M && p->A && p->B && p->x && p->lambda && p->work && p->room;
}

/* K + sigma M into B, with its Cholesky factor tried in A. */
static int shifted(const modal *p, double sigma) {
    for (size_t i = 0; i < p->size; i++) {
        for (size_t j = 0; j < p->size; j++) {
            gsl_matrix_set(p->B, i, j, gsl_matrix_get(p->K, i, j) + sigma * gsl_matrix_get(p->M, i, j));
        }
    }
    gsl_matrix_memcpy(p->A, p->B);
    int status;
    SPARI_BLAS(status = gsl_linalg_cholesky_decomp1(p->A));
    return status == GSL_SUCCESS;
}

/* Smallest shift that makes K + sigma M positive definite, in steps of 10 from 1e-6 of the largest K_ii / M_ii; -1 when
   none does. A smaller one would make 1 / (omega^2 + sigma) of a rigid motion so large that rounding in it drowns the
   others, a larger one drowns the low modes: an omega^2 keeps what is between sigma and rounding on either side. */
static double find_shift(const modal *p) {
    double largest = 0;
    if (shifted(p, 0)) {
        return 0;
    }
    for (size_t i = 0; i < p->size; i++) {
        double k = fabs(gsl_matrix_get(p->K, i, i)), m = gsl_matrix_get(p->M, i, i);
        largest = m > 0 && k / m > largest ? k / m : largest;
    }
    for (double f = 1e-6; f < 1e4; f *= 10) {
        if (shifted(p, f * largest)) {
            return f * largest;
        }
    }
    return largest == 0 && shifted(p, 1) ? 1 : -1; /* a rigid body that nothing holds */
}

static void give_mode(const spar_member *m, modal *p, size_t k, double *shape) {
    gsl_vector_view x = gsl_matrix_column(p->x, k);
    double norm;
    SPARI_BLAS(gsl_blas_dsymv(CblasLower, 1, p->M, &x.vector, 0, p->work));
    gsl_blas_ddot(&x.vector, p->work, &norm);
    gsl_vector_memcpy(p->work, &x.vector);
    gsl_vector_scale(p->work, 1 / (norm > 0 ? sqrt(norm) : 1));
    m->row->shape(m, p->work->data, p->room, shape);
}

static int is_finite(const gsl_matrix *A) { /* fresh matrices have no gaps */
    return spari_first_nonfinite(A->data, (int64_t)(A->size1 * A->size2)) < 0;
}

static int find_modes(const spar_member *m, int64_t n, modal *p, double *frequency, double *shapes) {
    int status = modal_alloc(m, p) ? m->row->problem(m, p->K->data, p->M->data) : SPAR_ERR_MEMORY; /* without gaps */
    SPARI_REQUIRE(m->session, status == SPAR_OK, status, "no memory for the modes of '%s'", m->name);
    SPARI_REQUIRE(m->session, is_finite(p->K) && is_finite(p->M), SPAR_ERR_NUMERIC,
                  "member '%s': its stiffness in the present state is beyond the range of numbers; look at its loads "
                  "and sections, or at their units",
                  m->name);
    double sigma = find_shift(p);
    SPARI_REQUIRE(m->session, sigma >= 0, SPAR_ERR_NUMERIC,
                  "member '%s': no shift makes its stiffness positive definite in the present state: it can move where "
                  "it has neither mass nor stiffness",
                  m->name);
    gsl_matrix_memcpy(p->A, p->M);
    status = spari_eigen(p->A, p->B, p->lambda, p->x);
    SPARI_REQUIRE(m->session, status != SPAR_ERR_MEMORY, status, "no memory for the modes of '%s'", m->name);
    SPARI_REQUIRE(m->session, status == SPAR_OK, status,
                  "member '%s': stiffness and mass lie too far apart for the range of numbers; look at its sections",
                  m->name);
    for (int64_t k = 0; k < n; k++) {
        double mu = gsl_vector_get(p->lambda, (size_t)k), square = mu > 0 ? 1 / mu - sigma : INFINITY;
        frequency[k] = copysign(sqrt(fabs(square)), square) / 6.283185307179586;
        if (shapes) {
            give_mode(m, p, (size_t)k, shapes + 6 * m->nodes * k);
        }
    }
    return SPAR_OK;
}

int spar_member_solve_modes(spar_member *member, int64_t n, double *frequency_hz, double *shapes) {
    SPARI_QUIET;
    SPARI_TRY(spari_need_committed(member, __func__));
    spar_session *s = member->session;
    SPARI_REQUIRE(s, member->body && member->body->mass && (member->effects & SPAR_EFFECT_INERTIA),
                  SPAR_ERR_UNSUPPORTED, "%s: '%s' has no mass that spar knows of", __func__, member->name);
    SPARI_REQUIRE(s, !spari_member_is_tied(member), SPAR_ERR_UNSUPPORTED,
                  "%s: joints tie '%s'; the modes of members tied together are not there in this release", __func__,
                  member->name);
    int64_t free_unknowns = member->row->unknowns(member);
    SPARI_REQUIRE(s, n >= 0 && n <= free_unknowns, SPAR_ERR_ARGUMENT, "%s: '%s': %lld modes; it has %lld", __func__,
                  member->name, (long long)n, (long long)free_unknowns);
    SPARI_REQUIRE(s, frequency_hz || n == 0, SPAR_ERR_ARGUMENT, "%s: '%s': frequency_hz is NULL", __func__,
                  member->name);
    if (n == 0) {
        return SPAR_OK;
    }
    modal p = {.size = (size_t)free_unknowns};
    int status = find_modes(member, n, &p, frequency_hz, shapes);
    modal_free(&p);
    return spari_named(s, __func__, status);
}
