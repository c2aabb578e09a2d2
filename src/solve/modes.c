/* Modes about the present state: K x = omega^2 M x over the unknowns that the root leaves free. */
#include "../session/session.h"
#include "solver.h"

#include <gsl/gsl_eigen.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_sort_vector.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Element tangents at cm summed into A (free unknowns only). */
static void assemble(const spar_member *m, const double *q, double cm, double *S, gsl_matrix *A) {
    int P = m->per_element, first, end;
    spari_solver_fixed(m, &first, &end);
    for (int e = 0; e < m->elements; e++) {
        int at = 6 * e * (P - 1) - end;
        spari_body_tangent(m->body, e, q, NULL, NULL, 1, cm, 0, NULL, S);
        for (int i = 0; i < 6 * P; i++) {
            for (int j = 0; j < 6 * P; j++) {
                if (at + i >= 0 && at + j >= 0) {
                    /* at equilibrium the tangent is symmetric but for moments that are not gradients: the symmetric
                     * part */
                    double value = 0.5 * (S[6 * P * i + j] + S[6 * P * j + i]);
                    *gsl_matrix_ptr(A, (size_t)(at + i), (size_t)(at + j)) += value;
                }
            }
        }
    }
}

/* Solves A x = lambda B x for symmetric A and positive definite B, ascending; 0 when it worked. Destroys A and B. */
static int solve(gsl_matrix *A, gsl_matrix *B, gsl_vector *lambda, gsl_matrix *x) {
    gsl_eigen_gensymmv_workspace *w = gsl_eigen_gensymmv_alloc(A->size1);
    int status = w ? gsl_eigen_gensymmv(A, B, lambda, x, w) : GSL_ENOMEM;
    if (w) {
        gsl_eigen_gensymmv_free(w);
    }
    return status == GSL_SUCCESS ? gsl_eigen_gensymmv_sort(lambda, x, GSL_EIGEN_SORT_VAL_ASC) : status;
}

static int find_modes(const spar_member *m, int64_t n, double *frequency, double *shapes, gsl_matrix *K, gsl_matrix *M,
                      gsl_matrix *M2, gsl_vector *lambda, gsl_matrix *x) {
    int first, end;
    spari_solver_fixed(m, &first, &end);
    size_t size = K->size1;
    gsl_matrix *K2 = gsl_matrix_alloc(size, size);
    SPARI_REQUIRE(m->session, K2, SPAR_ERR_MEMORY, "spar_member_get_modes: no memory for '%s'", m->name);
    gsl_matrix_memcpy(K2, K);
    gsl_matrix_memcpy(M2, M);
    int inverse = 0, status = solve(K2, M2, lambda, x);
    if (status != GSL_SUCCESS) { /* parts without mass: M x = mu K x, mu = 1 / omega^2, largest first */
        inverse = 1;
        gsl_matrix_memcpy(K2, K);
        gsl_matrix_memcpy(M2, M);
        status = solve(M2, K2, lambda, x);
    }
    gsl_matrix_free(K2);
    SPARI_REQUIRE(
        m->session, status == GSL_SUCCESS, SPAR_ERR_NUMERIC,
        "spar_member_get_modes: '%s': neither its mass nor its stiffness is positive definite in the present state",
        m->name);
    double *mode = spari_zalloc(6 * (int64_t)m->body->unique, sizeof *mode);
    SPARI_REQUIRE(m->session, mode, SPAR_ERR_MEMORY, "spar_member_get_modes: no memory for '%s'", m->name);
    for (int64_t k = 0; k < n; k++) {
        size_t col = inverse ? size - 1 - (size_t)k : (size_t)k;
        double value = gsl_vector_get(lambda, col);
        value = inverse ? (value > 0 ? 1 / value : INFINITY) : value;
        frequency[k] = copysign(sqrt(fabs(value)), value) / 6.283185307179586;
        if (!shapes) {
            continue;
        }
        double norm = 0;
        for (size_t i = 0; i < size; i++) {
            for (size_t j = 0; j < size; j++) {
                norm += gsl_matrix_get(x, i, col) * gsl_matrix_get(M, i, j) * gsl_matrix_get(x, j, col);
            }
        }
        memset(mode, 0, (size_t)(6 * m->body->unique) * sizeof *mode);
        for (size_t i = 0; i < size; i++) {
            mode[(size_t)end + i] = gsl_matrix_get(x, i, col) / (norm > 0 ? sqrt(norm) : 1);
        }
        spari_member_from_unique(m, 6, mode, shapes + 6 * m->nodes * k);
    }
    free(mode);
    return SPAR_OK;
}

int spar_member_get_modes(spar_member *member, int64_t n, double *frequency_hz, double *shapes) {
    const char *call = "spar_member_get_modes";
    SPARI_REQUIRE(NULL, member, SPAR_ERR_ARGUMENT, "%s: the member is NULL; create it first", call);
    spar_session *s = member->session;
    SPARI_REQUIRE(s, member->committed, SPAR_ERR_STATE,
                  "%s: member '%s' is not committed; call spar_member_commit first", call, member->name);
    SPARI_REQUIRE(s, member->body && member->body->mass && (member->effects & SPAR_EFFECT_INERTIA),
                  SPAR_ERR_UNSUPPORTED, "%s: '%s' has no mass that spar knows of", call, member->name);
    int first, end;
    spari_solver_fixed(member, &first, &end);
    int64_t free_unknowns = 6 * (int64_t)member->body->unique - end, u = member->body->unique;
    SPARI_REQUIRE(s, n >= 0 && n <= free_unknowns, SPAR_ERR_ARGUMENT, "%s: '%s': %lld modes; it has %lld", call,
                  member->name, (long long)n, (long long)free_unknowns);
    SPARI_REQUIRE(s, frequency_hz || n == 0, SPAR_ERR_ARGUMENT, "%s: '%s': frequency_hz is NULL", call, member->name);
    if (n == 0) {
        return SPAR_OK;
    }
    size_t size = (size_t)free_unknowns;
    int64_t element = 36 * (int64_t)member->per_element * member->per_element;
    gsl_matrix *K = gsl_matrix_calloc(size, size), *M = gsl_matrix_calloc(size, size),
               *M2 = gsl_matrix_alloc(size, size);
    gsl_matrix *x = gsl_matrix_alloc(size, size);
    gsl_vector *lambda = gsl_vector_alloc(size);
    double *q = spari_zalloc(7 * u + element, sizeof *q);
    int status = SPAR_ERR_MEMORY;
    if (K && M && M2 && x && lambda && q) {
        double *S = q + 7 * u;
        spari_member_to_unique(member, 7, member->after.q, q);
        assemble(member, q, 0, S, K);
        assemble(member, q, 1, S, M);
        gsl_matrix_sub(M, K);
        status = find_modes(member, n, frequency_hz, shapes, K, M, M2, lambda, x);
    } else {
        spari_fail(s, status, "%s: no memory for '%s'", call, member->name);
    }
    gsl_matrix_free(K);
    gsl_matrix_free(M);
    gsl_matrix_free(M2);
    gsl_matrix_free(x);
    gsl_vector_free(lambda);
    free(q);
    return status;
}
