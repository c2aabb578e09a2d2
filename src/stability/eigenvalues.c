/* Small-motion equations about the present state, and the public call for their eigenvalues. A state at rest, or in
   steady rotation as one body, is described in a frame that rotates with it, where the coefficients are constant.
   Parts that rotate otherwise than the rest (a rotor on its tower) are allowed if they are isotropic about their
   axis: then nothing depends on their angle. */
#include "small_motions.h"

#include "../assembly/assembly.h"
#include "../base/environment.h"
#include "../base/session.h"
#include "../math/rotation.h"
#include "../member/body.h"
#include "../member/check_arguments.h"
#include "../time/fidelity.h"
#include "modes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Angular velocities with a smaller relative difference are equal. */
static const double one_turn = 1e-4;
/* equilibrium: maximum force residual of an equilibrium state, relative to the largest forces. equilibrium_noise:
   the same relative to the largest stiffness, above the rounding of positions. */
static const double equilibrium = 1e-3, equilibrium_noise = 1e-9;

void spari_small_motions_free(spari_small_motions *w) {
    free(w->part);
    free(w->workspace);
    spari_pencil_free(&w->pencil);
}

/* ---- connected members ---- */

/* Whether joints connect a part with m. */
static int is_reached(const spari_small_motions *w, const spar_member *m) {
    for (const spar_joint *j = w->session->joints; j && m->row && m->row->component; j = j->next) {
        for (int side = 0; side < 2; side++) {
            if (j->member[side] == m && spari_small_motions_part(w, j->member[1 - side])) {
                return 1;
            }
        }
    }
    return 0;
}

static int add_motion_part(spari_small_motions *w, const spar_member *m) {
    SPARI_TRY(spari_modes_need_mass(m));
    spari_motion_part *p = w->part + w->parts++;
    *p = (spari_motion_part){.member = m, .size = (int)m->row->unknowns(m)};
    memcpy(p->own, m->after.v + 3, sizeof p->own);
    return SPAR_OK;
}

static int by_creation(const void *a, const void *b) {
    const spar_member *x = ((const spari_motion_part *)a)->member, *y = ((const spari_motion_part *)b)->member;
    for (const spar_member *m = x->next; m; m = m->next) {
        if (m == y) {
            return -1;
        }
    }
    return x != y;
}

static int gather_motions(spari_small_motions *w, const spar_member *first) {
    spar_session *s = w->session;
    w->part = spari_zalloc(s->member_count, sizeof *w->part);
    SPARI_REQUIRE(s, w->part, SPAR_ERR_MEMORY, "no memory for eigenvalues");
    if (first) {
        SPARI_TRY(add_motion_part(w, first));
    }
    for (int more = 1; more;) {
        more = 0;
        for (const spar_member *m = s->members; m; m = m->next) {
            int wanted = first ? is_reached(w, m) : m->committed && m->row->solved && m->row->linearise;
            if (wanted && !spari_small_motions_part(w, m)) {
                SPARI_TRY(add_motion_part(w, m));
                more = 1;
            }
        }
    }
    qsort(w->part, (size_t)w->parts, sizeof *w->part, by_creation);
    int64_t most = 0;
    for (int i = 0; i < w->parts; i++) {
        const spar_member *m = w->part[i].member;
        int64_t workspace = 2 * (int64_t)w->part[i].size + 6 * m->body->unique + 12 * m->nodes;
        w->part[i].at = w->size;
        w->size += w->part[i].size;
        most = workspace > most ? workspace : most;
    }
    w->workspace = spari_zalloc(most, sizeof *w->workspace);
    SPARI_REQUIRE(s, w->workspace, SPAR_ERR_MEMORY, "no memory for eigenvalues");
    return SPAR_OK;
}

/* ---- frame of reference ---- */

static double apart_by(const double a[3], const double b[3]) {
    double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return spari_norm(d);
}

/* x := derivative of vectors that rotate with s */
static void rotate_vectors(int n, const double s[3], const double *x, double *y) {
    for (int i = 0; i < n; i += 3) {
        spari_cross(s, x + i, y + i);
    }
}

/* A part that rotates with s relative to the frame must be isotropic about this axis: its matrices X satisfy X T = T
   X, T the rotation of all vectors with s. Tested with one vector without symmetry. */
static int check_same(const spari_small_motions *w, const spari_motion_part *p, int64_t first) {
    double s[3] = {p->own[0] - w->w[0], p->own[1] - w->w[1], p->own[2] - w->w[2]};
    if (spari_norm(s) <= one_turn * fmax(spari_norm(p->own), spari_norm(w->w))) {
        return SPAR_OK;
    }
    double *x = spari_zalloc(5 * (int64_t)w->size, sizeof *x), *rotated = x + w->size, *y = rotated + w->size,
           *z = y + w->size, *last = z + w->size;
    SPARI_REQUIRE(w->session, x, SPAR_ERR_MEMORY, "no memory for eigenvalues");
    int same = p->size % 3 == 0, kinds = p->member->body->C ? 3 : 2; /* weight alone may have a direction */
    for (int i = 0; i < p->size; i++) {
        x[p->at + i] = sin(1 + 12.9898 * i);
    }
    for (int kind = 0; kind < kinds && same; kind++) {
        double change = 0, size = 0;
        memset(y, 0, 3 * (size_t)w->size * sizeof *y);
        rotate_vectors(p->size, s, x + p->at, rotated + p->at);
        spari_pencil_times(&w->pencil, first, kind == 2, kind == 1, kind == 0, rotated, y);
        spari_pencil_times(&w->pencil, first, kind == 2, kind == 1, kind == 0, x, z);
        rotate_vectors(p->size, s, z + p->at, last + p->at);
        for (int i = p->at; i < p->at + p->size; i++) {
            change = fmax(change, fabs(y[i] - last[i]));
            size = fmax(size, fabs(z[i]));
        }
        same = change <= 1e-6 * spari_norm(s) * size;
    }
    free(x);
    SPARI_REQUIRE(
        w->session, same, SPAR_ERR_UNSUPPORTED,
        "'%s' rotates relative to the parts it is connected to, and is not isotropic about its axis: the small-motion "
        "equations depend on time and have no eigenvalues; for a periodic state use spar_trial_solve_floquet",
        p->member->name);
    return SPAR_OK;
}

static int fill_motions(spari_small_motions *w) {
    spar_session *s = w->session;
    int constraints = 0;
    spari_pencil_free(&w->pencil);
    SPARI_REQUIRE(s, spari_pencil_create(&w->pencil, w->size) == SPAR_OK, SPAR_ERR_MEMORY, "no memory for eigenvalues");
    for (int i = 0; i < w->parts; i++) {
        const spari_motion_part *p = w->part + i;
        int64_t first = w->pencil.entries;
        w->pencil.base = p->at;
        int status = p->member->row->linearise(p->member, w->loose ? p->own : w->w, &w->pencil);
        SPARI_REQUIRE(s, status != SPAR_ERR_UNSUPPORTED, status,
                      "'%s' is linear in the frame of its root, which rotates relative to the parts it is connected "
                      "to; use SPAR_FIDELITY_EXACT",
                      p->member->name);
        SPARI_REQUIRE(s, status == SPAR_OK, status, "'%s': no memory for eigenvalues", p->member->name);
        SPARI_TRY(w->loose ? SPAR_OK : check_same(w, p, first));
    }
    for (const spar_joint *j = s->joints; j; j = j->next) {
        SPARI_TRY(spari_small_motions_add_joint(w, j, &constraints));
    }
    w->pencil.constraints = constraints;
    SPARI_REQUIRE(s, !w->pencil.full, SPAR_ERR_MEMORY, "no memory for eigenvalues");
    return SPAR_OK;
}

/* The rotating frame if all rotate as one; otherwise, or if the ground is not isotropic about this axis, the
   inertial frame. */
static int find_frame(spari_small_motions *w) {
    int same = 1;
    for (int i = 1; i < w->parts; i++) {
        const double *a = w->part[0].own, *b = w->part[i].own;
        same = same && apart_by(a, b) <= one_turn * fmax(spari_norm(a), spari_norm(b));
    }
    if (same && w->parts > 0 && spari_norm(w->part[0].own) > 0) {
        char message[SPARI_MESSAGE_SIZE];
        memcpy(w->w, w->part[0].own, sizeof w->w);
        (void)spari_messages_redirect(message); /* a frame that does not fit is no failure */
        int status = fill_motions(w);
        (void)spari_messages_redirect(NULL);
        if (status != SPAR_ERR_UNSUPPORTED) {
            SPARI_REQUIRE(w->session, status == SPAR_OK, status, "%s", message);
            return SPAR_OK;
        }
    }
    memset(w->w, 0, sizeof w->w);
    return fill_motions(w);
}

static int check_motions(const spari_small_motions *w) {
    const spari_pencil *p = &w->pencil;
    double most = 0, size = 0;
    for (int i = 0; i < w->size; i++) {
        most = fmax(most, fabs(p->left[i]));
    }
    for (int64_t i = 0; i < p->entries; i++) {
        size += fabs(p->entry[i].k) + fabs(p->entry[i].c) + fabs(p->entry[i].m);
    }
    SPARI_REQUIRE(w->session, isfinite(size) && isfinite(most), SPAR_ERR_NUMERIC,
                  "'%s': stiffness in the present state is not finite; check loads, sections and their units",
                  w->part[0].member->name);
    SPARI_REQUIRE(w->session, most <= equilibrium * p->scale + equilibrium_noise * p->noise, SPAR_ERR_STATE,
                  "'%s' is not in equilibrium, at rest or in steady rotation: forces of %.3g are unbalanced, compared "
                  "with forces of %.3g; compute the static solution first",
                  w->part[0].member->name, most, p->scale);
    return SPAR_OK;
}

int spari_small_motions_create(spari_small_motions *w, spar_session *s, const spar_member *first) {
    *w = (spari_small_motions){.session = s};
    SPARI_TRY(gather_motions(w, first));
    if (w->parts == 0) {
        return SPAR_OK;
    }
    SPARI_TRY(find_frame(w));
    return check_motions(w);
}

int spari_small_motions_create_loose(spari_small_motions *w, spar_session *s) {
    *w = (spari_small_motions){.session = s, .loose = 1};
    SPARI_TRY(gather_motions(w, NULL));
    return w->parts > 0 ? fill_motions(w) : SPAR_OK;
}

/* ---- results ---- */

int spari_small_motions_solve(spari_small_motions *w, int n, double complex shift, double complex *value,
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

void spari_small_motions_shape(const spari_small_motions *w, const spari_motion_part *p, const double complex *x,
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
        status = value && x ? spari_small_motions_solve(&w, (int)n, shift, value, x)
                            : spari_fail(s, SPAR_ERR_MEMORY, "'%s': no memory for eigenvalues", m->name);
        for (int64_t k = 0; k < n && status == SPAR_OK; k++) {
            eigenvalue[2 * k] = creal(value[k]);
            eigenvalue[2 * k + 1] = cimag(value[k]);
            if (shapes) {
                spari_small_motions_shape(&w, spari_small_motions_part(&w, m), x + w.size * k,
                                          shapes + 12 * m->nodes * k);
            }
        }
        free(value);
        free(x);
    }
    if (status == SPAR_OK && frame) {
        memcpy(frame, w.w, sizeof w.w);
    }
    spari_small_motions_free(&w);
    return status;
}

int spar_member_solve_eigenvalues(spar_member *member, int64_t n, const double shift[2], double *eigenvalue,
                                  double *shapes, double frame[3]) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_committed(member, __func__));
    spar_session *s = member->session;
    SPARI_TRY(spari_named(s, __func__, spari_modes_need_mass(member)));
    SPARI_REQUIRE(s, n >= 0, SPAR_ERR_ARGUMENT, "%s: '%s': %lld eigenvalues", __func__, member->name, (long long)n);
    SPARI_REQUIRE(s, eigenvalue || n == 0, SPAR_ERR_ARGUMENT, "%s: '%s': eigenvalue is NULL", __func__, member->name);
    if (shift) {
        SPARI_TRY(spari_need_finite(s, __func__, member->name, "shift", 2, shift));
    }
    double complex at = shift ? CMPLX(shift[0], fabs(shift[1])) : 0;
    SPARI_TRY(spari_named(s, __func__, spari_joints_place(s)));
    return spari_named(s, __func__, eigenvalues_of(member, n, at, eigenvalue, shapes, frame));
}
