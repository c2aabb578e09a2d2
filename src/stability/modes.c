/* Modes about the present state, in the frame that rotates with the root: K x = omega^2 M x over the unknowns that
   the root leaves free. K is the tangent in this frame (time/steady_rotation.h). Coriolis forces are left out, so
   the problem is symmetric. It is solved as M x = mu (K + sigma M) x, mu = 1 / (omega^2 + sigma). Low modes are
   large mu and keep their digits although stiffnesses and rotary inertias differ by many powers of ten; M may be
   singular. sigma is 0 if K is positive definite beyond rounding, otherwise the smallest tried that makes it so. */
#include "modes.h"

#include "../algebra/cblas.h"
#include "../algebra/dense.h"
#include "../algebra/eigen.h"
#include "../base/session.h"
#include "../member/body.h"
#include "../time/fidelity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void spari_modal_free(spari_modal *p) {
    free(p->K);
}

int spari_modal_alloc(spari_modal *p, int n) {
    int64_t size = (int64_t)n * n;
    p->size = n;
    p->K = spari_zalloc(5 * size + 2 * (int64_t)n, sizeof *p->K);
    p->M = p->K + size, p->A = p->M + size, p->B = p->A + size, p->x = p->B + size;
    p->lambda = p->x + size, p->work = p->lambda + n;
    return p->K != NULL;
}

/* K + sigma M into B; tries its Cholesky factor in A. */
static int shifted(const spari_modal *p, double sigma) {
    int64_t size = (int64_t)p->size * p->size;
    for (int64_t i = 0; i < size; i++) {
        p->B[i] = p->K[i] + sigma * p->M[i];
    }
    memcpy(p->A, p->B, (size_t)size * sizeof *p->A);
    return !spari_cholesky(p->size, p->A);
}

/* Whether K x is rounding error alone for the motion of least stiffness, by steps of x := K^-1 M x with the factor
   in A. (The factorisation of a singular matrix may succeed by rounding.) Rows are scaled by the roots of their
   stiffness. */
static int has_loose_motion(const spari_modal *p) {
    enum { STEPS = 4 };
    const double only_rounding = 1e-12;
    double left = 0, size = 0, *x = p->lambda;
    int n = p->size;
    for (int i = 0; i < n; i++) {
        x[i] = 1 + 0.3 * sin(12.9898 * (double)(i + 1));
    }
    for (int step = 0; step < STEPS; step++) {
        double norm = cblas_dnrm2(n, x, 1);
        cblas_dscal(n, norm > 0 ? 1 / norm : 0, x, 1);
        SPARI_BLAS(cblas_dsymv(CblasRowMajor, CblasLower, n, 1, p->M, n, x, 1, 0, p->work, 1));
        memcpy(x, p->work, (size_t)n * sizeof *x);
        spari_cholesky_solve(n, p->A, x);
    }
    for (int i = 0; i < n; i++) {
        const double *row = p->K + (int64_t)n * i;
        double sum = 0, of_sizes = 0, own = sqrt(fabs(row[i]));
        for (int j = 0; j < n; j++) {
            sum += row[j] * x[j];
            of_sizes += fabs(row[j] * x[j]);
        }
        left = hypot(left, own > 0 ? sum / own : 0);
        size = hypot(size, own > 0 ? of_sizes / own : 0);
    }
    return !(left > only_rounding * size);
}

/* Smallest shift that makes K + sigma M positive definite, in steps of 10 from 1e-6 of the largest K_ii / M_ii; -1
   if none does. A smaller shift makes 1 / (omega^2 + sigma) of rigid motions so large that its rounding hides the
   other modes. A larger shift hides the low modes: omega^2 keeps the digits between sigma and rounding. */
static double find_shift(const spari_modal *p) {
    double largest = 0;
    if (shifted(p, 0) && !has_loose_motion(p)) {
        return 0;
    }
    for (int64_t i = 0; i < p->size; i++) {
        double k = fabs(p->K[(p->size + 1) * i]), m = p->M[(p->size + 1) * i];
        largest = m > 0 && k / m > largest ? k / m : largest;
    }
    for (double f = 1e-6; f < 1e4; f *= 10) {
        if (shifted(p, f * largest)) {
            return f * largest;
        }
    }
    return largest == 0 && shifted(p, 1) ? 1 : -1; /* an unconstrained rigid body */
}

const double *spari_modal_mode(spari_modal *p, int64_t k) {
    int n = p->size;
    const double *x = p->x + n * k;
    SPARI_BLAS(cblas_dsymv(CblasRowMajor, CblasLower, n, 1, p->M, n, x, 1, 0, p->work, 1));
    double norm = cblas_ddot(n, x, 1, p->work, 1);
    memcpy(p->work, x, (size_t)n * sizeof *x);
    cblas_dscal(n, 1 / (norm > 0 ? sqrt(norm) : 1), p->work, 1);
    return p->work;
}

int spari_modal_solve(spari_modal *p, const spar_member *m, const char *who, int64_t n, double *frequency) {
    spar_session *s = m->session;
    int64_t size = (int64_t)p->size * p->size; /* M follows K */
    SPARI_REQUIRE(s, spari_first_nonfinite(p->K, 2 * size) < 0, SPAR_ERR_NUMERIC,
                  "%s '%s': stiffness in the present state is not finite; check loads, sections and their units", who,
                  m->name);
    double sigma = find_shift(p);
    SPARI_REQUIRE(s, sigma >= 0, SPAR_ERR_NUMERIC,
                  "%s '%s': no shift makes the stiffness positive definite in the present state: a free motion has "
                  "neither mass nor stiffness; constrain it or give it mass",
                  who, m->name);
    memcpy(p->A, p->M, (size_t)size * sizeof *p->A);
    int status = spari_eigen(p->size, p->A, p->B, p->lambda, p->x);
    SPARI_REQUIRE(s, status != SPAR_ERR_MEMORY, status, "no memory for the modes of '%s'", m->name);
    SPARI_REQUIRE(s, status == SPAR_OK, status,
                  "%s '%s': the ratio of stiffness to mass is outside the range of a double; check the sections", who,
                  m->name);
    for (int64_t k = 0; k < n; k++) {
        double mu = p->lambda[k], square = mu > 0 ? 1 / mu - sigma : INFINITY;
        frequency[k] = copysign(sqrt(fabs(square)), square) / 6.283185307179586;
    }
    return SPAR_OK;
}

/* ---- one member ---- */

int spari_modes_need_mass(const spar_member *m) {
    SPARI_REQUIRE(m->session, m->body && m->body->mass && (m->effects & SPAR_EFFECT_INERTIA), SPAR_ERR_UNSUPPORTED,
                  "'%s' has no mass in spar", m->name);
    return SPAR_OK;
}

static int check_count(const spar_member *m, int64_t n, int64_t free_unknowns) {
    SPARI_REQUIRE(m->session, n <= free_unknowns, SPAR_ERR_ARGUMENT, "'%s': %lld modes; it has %lld", m->name,
                  (long long)n, (long long)free_unknowns);
    return SPAR_OK;
}

static int find_modes(const spar_member *m, int64_t n, spari_modal *p, double *frequency, double *shapes) {
    double *workspace = spari_zalloc(6 * (int64_t)m->body->unique, sizeof *workspace);
    int status =
        workspace && spari_modal_alloc(p, (int)m->row->unknowns(m)) ? m->row->problem(m, p->K, p->M) : SPAR_ERR_MEMORY;
    if (status != SPAR_OK) {
        free(workspace);
        return spari_fail(m->session, status, "no memory for the modes of '%s'", m->name);
    }
    status = spari_modal_solve(p, m, "member", n, frequency);
    for (int64_t k = 0; k < n && shapes && status == SPAR_OK; k++) {
        m->row->shape(m, spari_modal_mode(p, k), workspace, shapes + 6 * m->nodes * k);
    }
    free(workspace);
    return status;
}

int spari_modes_of_member(const spar_member *m, int64_t n, double *frequency, double *shapes) {
    spari_modal p = {0};
    SPARI_TRY(spari_modes_need_mass(m));
    SPARI_TRY(check_count(m, n, m->row->unknowns(m)));
    int status = find_modes(m, n, &p, frequency, shapes);
    spari_modal_free(&p);
    return status;
}
