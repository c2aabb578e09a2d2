/* Modes about the present state, seen from the frame that turns with the root: K x = omega^2 M x over the unknowns that
   the root leaves free. K is the tangent in that frame (turn.h); Coriolis' forces are left out, so that the problem
   stays symmetric. Solved as M x = mu (K + sigma M) x, mu = 1 / (omega^2 + sigma): the low modes are the large mu and
   keep their digits beside stiffnesses and rotary inertias that differ by many powers of ten; M may be singular. sigma
   is 0 where K is positive definite, else the smallest tried that makes it so. */
#include "../base/blas.h"
#include "../base/quiet.h"
#include "../base/scene.h"
#include "../math/rotation.h"
#include "../member/applied.h"
#include "../member/edge.h"
#include "eigen.h"
#include "frame.h"
#include "rigid_beam.h"
#include "solver.h"
#include "turn.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The problem over the free unknowns. */
typedef struct modal {
    size_t size;
    int end; /* unknowns before the first free one */
    gsl_matrix *K, *M, *A, *B, *x;
    gsl_vector *lambda, *work;
    double *q, *v, *a, *S, *Me, *shape;
} modal;

static void modal_free(modal *p) {
    gsl_matrix_free(p->K);
    gsl_matrix_free(p->M);
    gsl_matrix_free(p->A);
    gsl_matrix_free(p->B);
    gsl_matrix_free(p->x);
    gsl_vector_free(p->lambda);
    gsl_vector_free(p->work);
    free(p->q);
}

static int modal_alloc(const spar_member *m, modal *p) {
    int64_t u = m->body->unique, e = 36 * (int64_t)m->per_element * m->per_element;
    size_t n = p->size;
    p->K = gsl_matrix_calloc(n, n);
    p->M = gsl_matrix_calloc(n, n);
    p->A = gsl_matrix_alloc(n, n);
    p->B = gsl_matrix_alloc(n, n);
    p->x = gsl_matrix_alloc(n, n);
    p->lambda = gsl_vector_alloc(n);
    p->work = gsl_vector_alloc(n);
    p->q = spari_zalloc(25 * u + 2 * e, sizeof *p->q);
    if (!p->K || !p->M || !p->A || !p->B || !p->x || !p->lambda || !p->work || !p->q) {
        return 0;
    }
    p->v = p->q + 7 * u, p->a = p->v + 6 * u, p->shape = p->a + 6 * u;
    p->S = p->shape + 6 * u, p->Me = p->S + e;
    return 1;
}

/* The symmetric part of an element matrix into A: at equilibrium the rest is of loads that have no potential. */
static void add_element(int at, int n, const double *S, gsl_matrix *A) {
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            if (at + i >= 0 && at + j >= 0) {
                *gsl_matrix_ptr(A, (size_t)(at + i), (size_t)(at + j)) += 0.5 * (S[n * i + j] + S[n * j + i]);
            }
        }
    }
}

/* From the tangents of m, which may be the body that carries a rigid member. */
static void assemble_problem(const spar_member *m, modal *p) {
    int P = m->per_element;
    spari_turn turn;
    int turning = spari_turn_of(m, m->after.v, m->after.a, &turn);
    spari_member_to_unique(m, 7, m->after.q, p->q);
    if (turning) {
        spari_turn_rates(m, &turn, p->q, p->v, p->a);
    }
    for (int e = 0; e < m->elements; e++) {
        int at = 6 * e * (P - 1) - p->end;
        spari_turn_tangent(m, turning ? &turn : NULL, e, p->q, p->v, p->a, 1, p->S, p->Me);
        if (m->applied) {
            spari_applied_tangent(m, e, p->q, 1, p->S);
        }
        if (m->arms) {
            spari_arms_tangent(m->arms, p->q + 3, p->S);
        }
        add_element(at, 6 * P, p->S, p->K);
        add_element(at, 6 * P, p->Me, p->M);
    }
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
    if (m->rung && m->rung->frame) {
        spari_frame_shape(m->rung->frame, m, p->work->data, p->shape);
    } else {
        memset(p->shape, 0, (size_t)(6 * m->body->unique) * sizeof *p->shape);
        memcpy(p->shape + p->end, p->work->data, p->size * sizeof *p->shape);
    }
    if (m->rung && m->rung->core) {
        spari_rung_carry(m, p->shape, shape);
    } else {
        spari_member_from_unique(m, 6, p->shape, shape);
    }
}

/* K and M of the member, of any fidelity. */
static int form_problem(const spar_member *m, modal *p) {
    if (m->rung && m->rung->frame) {
        spari_frame_modal(m->rung->frame, m, p->K->data, p->M->data); /* fresh matrices have no gaps */
    } else if (m->rung && m->rung->core) {
        spar_member *core;
        SPARI_TRY(spari_rung_core(m, &core));
        assemble_problem(core, p);
    } else {
        assemble_problem(m, p);
    }
    return SPAR_OK;
}

/* Unknowns that the root leaves free, `end` of the node of the root are not. */
static int64_t unknowns(const spar_member *m, int *end) {
    int first;
    spari_solver_fixed(m, &first, end);
    if (m->rung && m->rung->frame) {
        return spari_frame_unknowns(m->rung->frame);
    }
    return 6 * (m->rung && m->rung->core ? 1 : (int64_t)m->body->unique) - *end;
}

static int is_finite(const gsl_matrix *A) { /* fresh matrices have no gaps */
    return spari_first_nonfinite(A->data, (int64_t)(A->size1 * A->size2)) < 0;
}

static int find_modes(const spar_member *m, int64_t n, modal *p, double *frequency, double *shapes) {
    const char *call = "spar_member_solve_modes";
    SPARI_REQUIRE(m->session, modal_alloc(m, p), SPAR_ERR_MEMORY, "%s: no memory for '%s'", call, m->name);
    SPARI_REQUIRE(m->session, form_problem(m, p) == SPAR_OK, SPAR_ERR_MEMORY, "%s: no memory for '%s'", call, m->name);
    SPARI_REQUIRE(m->session, is_finite(p->K) && is_finite(p->M), SPAR_ERR_NUMERIC,
                  "%s: '%s': its stiffness in the present state is beyond the range of numbers; look at its loads and "
                  "sections, or at their units",
                  call, m->name);
    double sigma = find_shift(p);
    SPARI_REQUIRE(m->session, sigma >= 0, SPAR_ERR_NUMERIC,
                  "%s: '%s': no shift makes its stiffness positive definite in the present state: it can move where it "
                  "has neither mass nor stiffness",
                  call, m->name);
    gsl_matrix_memcpy(p->A, p->M);
    int status = spari_eigen(p->A, p->B, p->lambda, p->x);
    SPARI_REQUIRE(m->session, status != SPAR_ERR_MEMORY, status, "%s: no memory for '%s'", call, m->name);
    SPARI_REQUIRE(m->session, status == SPAR_OK, status,
                  "%s: '%s': stiffness and mass lie too far apart for the range of numbers; look at its sections", call,
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
    int end;
    int64_t free_unknowns = unknowns(member, &end);
    SPARI_REQUIRE(s, n >= 0 && n <= free_unknowns, SPAR_ERR_ARGUMENT, "%s: '%s': %lld modes; it has %lld", __func__,
                  member->name, (long long)n, (long long)free_unknowns);
    SPARI_REQUIRE(s, frequency_hz || n == 0, SPAR_ERR_ARGUMENT, "%s: '%s': frequency_hz is NULL", __func__,
                  member->name);
    if (n == 0) {
        return SPAR_OK;
    }
    modal p = {.size = (size_t)free_unknowns, .end = end};
    int status = find_modes(member, n, &p, frequency_hz, shapes);
    modal_free(&p);
    return status;
}
