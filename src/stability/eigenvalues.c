/* Eigenvalues of the small-motion equations, and the public call. */
#include "rounding.h"

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

/* The eigenvalues sought. A pair has two vectors, the real and the imaginary part. */
typedef struct eigenvalue_search {
    spari_small_motions *motions;
    double complex shift, *value, *x; /* [n], [n][unknowns] */
} eigenvalue_search;

static int solve_eigenvalues(void *context, spari_pairs *pairs) {
    const eigenvalue_search *of = context;
    const int64_t size = of->motions->size;
    SPARI_TRY(solve_small_motions(of->motions, pairs->n, of->shift, of->value, of->x));
    for (int k = 0; k < pairs->n; k++) {
        double *x = pairs->x + 2 * size * k;
        pairs->value[2 * k] = creal(of->value[k]), pairs->value[2 * k + 1] = cimag(of->value[k]);
        pairs->square[k] = creal(of->value[k] * conj(of->value[k]));
        for (int64_t i = 0; i < size; i++) {
            x[i] = creal(of->x[size * k + i]), x[size + i] = cimag(of->x[size * k + i]);
        }
    }
    return SPAR_OK;
}

/* Converts the real and the imaginary part x [2][unknowns] of all unknowns to the motion of a member's nodes
   [nodes][6][2]. */
static void shape_of_vector(const spari_small_motions *w, const spari_motion_part *p, const double *x, double *nodes) {
    const spar_member *m = p->member;
    double *workspace = w->workspace, *motion = workspace + 6 * m->body->unique;
    for (int side = 0; side < 2; side++) {
        m->row->shape(m, x + (int64_t)w->size * side + p->at, workspace, motion);
        for (int64_t i = 0; i < 6 * m->nodes; i++) {
            nodes[2 * i + side] = motion[i];
        }
    }
}

/* With a shift, motions with stiff strains may be sought, which less stiff ones would move. */
static int best_eigenvalues(spari_small_motions *w, const spar_member *m, int64_t n, double complex shift,
                            double *eigenvalue, double *shapes) {
    eigenvalue_search of = {.motions = w, .shift = shift, .value = spari_zalloc(n, sizeof *of.value)};
    spari_pairs p = {.n = (int)n, .width = 2, .vectors = 2, .solve = solve_eigenvalues, .context = &of};
    of.x = spari_zalloc(n * w->size, sizeof *of.x);
    p.square = spari_zalloc(n * (4 + 2 * (int64_t)w->size), sizeof *p.square);
    p.error = p.square + n, p.value = p.error + n, p.x = p.value + 2 * n;
    int status = of.value && of.x && p.square
                     ? spari_pairs_solve(w, &p, !(cabs(shift) > 0))
                     : spari_fail(w->session, SPAR_ERR_MEMORY, "'%s': no memory for eigenvalues", m->name);
    if (status == SPAR_OK) {
        spari_give(eigenvalue, p.value, 2 * n);
    }
    for (int64_t k = 0; k < n && status == SPAR_OK && shapes; k++) {
        shape_of_vector(w, spari_small_motions_part(w, m), p.x + 2 * (int64_t)w->size * k, shapes + 12 * m->nodes * k);
    }
    SPARI_FREE(of.value, of.x, p.square);
    return status;
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
    status = status == SPAR_OK && n > 0 ? best_eigenvalues(&w, m, n, shift, eigenvalue, shapes) : status;
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
