/* Eigenvalues of the small-motion equations, and the public call. */
#include "small_motions.h"

#include "../assembly/assembly.h"
#include "../base/environment.h"
#include "../base/session.h"
#include "../member/body.h"
#include "../member/check_arguments.h"
#include "../time/fidelity.h"

#include <math.h>
#include <string.h>

/* The n eigenvalues nearest to the shift (see pencil.h), and x [n][size], with unit x^H M x. */
static int solve_small_motions(spari_small_motions *w, int n, double complex shift, double complex *value,
                               double complex *x) {
    int found = 0, status = spari_spectrum(&w->pencil, n, shift, SPARI_SPECTRUM_CHOICE, &found, value, x);
    const char *name = w->part[0].member->name;
    SPARI_REQUIRE(w->session, status != SPAR_ERR_MEMORY, status, "'%s': no memory for %d eigenvalues", name, n);
    SPARI_REQUIRE(w->session, status == SPAR_OK, status,
                  "'%s': stiffness, damping and mass are singular together: a free motion has none of the three; "
                  "constrain it or give it mass",
                  name);
    SPARI_REQUIRE(w->session, found >= n, SPAR_ERR_NUMERIC,
                  "'%s': only %d of %d eigenvalues found; the others have no mass, or have not converged: request "
                  "fewer, or give a shift closer to them",
                  name, found, n);
    return SPAR_OK;
}

/* Converts a vector x of all unknowns to the motion of a member's nodes [nodes][6][2]. */
static void shape_of_vector(const spari_small_motions *w, const spari_motion_part *p, const double complex *x,
                            double *nodes) {
    const spar_member *m = p->member;
    double *part = w->workspace, *workspace = part + p->size, *motion = workspace + 6 * m->body->unique;
    for (int side = 0; side < 2; side++) {
        for (int i = 0; i < p->size; i++) {
            part[i] = side ? cimag(x[p->at + i]) : creal(x[p->at + i]);
        }
        m->row->shape(m, part, workspace, motion);
        for (int64_t i = 0; i < 6 * m->nodes; i++) {
            nodes[2 * i + side] = motion[i];
        }
    }
}

static int eigenvalues_of(spar_member *m, int64_t n, double complex shift, double *eigenvalue, double *shapes,
                          double frame[3]) {
    spar_session *s = m->session;
    spari_small_motions w;
    int status = spari_small_motions_create(&w, s, m);
    if (status == SPAR_OK && n > w.size) {
        status = spari_fail(s, SPAR_ERR_ARGUMENT, "'%s': %lld eigenvalues; there are %d unknowns", m->name,
                            (long long)n, w.size);
    }
    if (status == SPAR_OK && n > 0) {
        double complex *value = spari_zalloc(n, sizeof *value), *x = spari_zalloc(n * w.size, sizeof *x);
        status = value && x ? solve_small_motions(&w, (int)n, shift, value, x)
                            : spari_fail(s, SPAR_ERR_MEMORY, "'%s': no memory for eigenvalues", m->name);
        for (int64_t k = 0; k < n && status == SPAR_OK; k++) {
            eigenvalue[2 * k] = creal(value[k]);
            eigenvalue[2 * k + 1] = cimag(value[k]);
            if (shapes) {
                shape_of_vector(&w, spari_small_motions_part(&w, m), x + w.size * k, shapes + 12 * m->nodes * k);
            }
        }
        SPARI_FREE(value, x);
    }
    if (status == SPAR_OK) {
        spari_give(frame, w.w, 3);
    }
    spari_small_motions_free(&w);
    return status;
}

int spar_member_solve_eigenvalues(spar_member *member, int64_t n, const double shift[2], double *eigenvalue,
                                  double *shapes, double frame[3]) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_committed(member, __func__));
    spar_session *s = member->session;
    SPARI_TRY(spari_named(s, __func__, spari_need_mass(member)));
    SPARI_REQUIRE(s, n >= 0, SPAR_ERR_ARGUMENT, "%s: '%s': %lld eigenvalues", __func__, member->name, (long long)n);
    SPARI_REQUIRE(s, eigenvalue || n == 0, SPAR_ERR_ARGUMENT, "%s: '%s': eigenvalue is NULL", __func__, member->name);
    if (shift) {
        SPARI_TRY(spari_need_finite(s, __func__, member->name, "shift", 2, shift));
    }
    double complex at = shift ? CMPLX(shift[0], fabs(shift[1])) : 0;
    SPARI_TRY(spari_named(s, __func__, spari_joints_place(s)));
    return spari_named(s, __func__, eigenvalues_of(member, n, at, eigenvalue, shapes, frame));
}
