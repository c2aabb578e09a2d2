#include "member.h"

#include "../math/basis.h"
#include "../math/rotation.h"
#include "../session/session.h"
#include "../solve/solver.h"
#include "applied.h"
#include "beam.h"
#include "rung.h"
#include "work.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <stdlib.h>
#include <string.h>

/* ---- checks at the edge ---- */

static int need_member(const spar_member *member, const char *call) {
    SPARI_REQUIRE(NULL, member, SPAR_ERR_ARGUMENT, "%s: the member is NULL; create it first", call);
    return SPAR_OK;
}

static int need_open(spar_member *member, const char *call) {
    SPARI_TRY(need_member(member, call));
    SPARI_REQUIRE(member->session, !member->committed, SPAR_ERR_STATE,
                  "%s: member '%s' is committed; describe it before spar_member_commit", call, member->name);
    return SPAR_OK;
}

static int need_committed(const spar_member *member, const char *call) {
    SPARI_TRY(need_member(member, call));
    SPARI_REQUIRE(member->session, member->committed, SPAR_ERR_STATE,
                  "%s: member '%s' is not committed; call spar_member_commit first", call, member->name);
    return SPAR_OK;
}

static int need_beam(spar_member *member, const char *call) {
    SPARI_TRY(need_open(member, call));
    SPARI_REQUIRE(member->session, member->kind == SPARI_BEAM, SPAR_ERR_ARGUMENT, "%s: member '%s' is not a beam", call,
                  member->name);
    return SPAR_OK;
}

/* x[n] must be there and finite; `what` names it. */
static int need_finite(spar_session *session, const char *call, const char *name, const char *what, int64_t n,
                       const double *x) {
    SPARI_REQUIRE(session, x || n == 0, SPAR_ERR_ARGUMENT, "%s: '%s': %s is NULL", call, name, what);
    int64_t at = spari_first_nonfinite(x, n);
    SPARI_REQUIRE(session, at < 0, SPAR_ERR_ARGUMENT, "%s: '%s': entry %lld of %s is not a finite number", call, name,
                  (long long)at, what);
    return SPAR_OK;
}

static int need_unit(spar_session *session, const char *call, const char *name, const char *what, int64_t n,
                     const double *q, int stride) {
    for (int64_t i = 0; i < n; i++) {
        double size = spari_quat_dot(q + stride * i, q + stride * i);
        SPARI_REQUIRE(session, fabs(size - 1) < 1e-6, SPAR_ERR_ARGUMENT,
                      "%s: '%s': quaternion %lld of %s has length %g; give unit quaternions, scalar first", call, name,
                      (long long)i, what, sqrt(size));
    }
    return SPAR_OK;
}

/* eta[n] strictly increasing in [0,1] */
static int need_increasing(spar_session *session, const char *call, const char *name, int64_t n, const double *eta) {
    SPARI_TRY(need_finite(session, call, name, "eta", n, eta));
    for (int64_t i = 0; i < n; i++) {
        SPARI_REQUIRE(session, eta[i] >= -1e-9 && eta[i] <= 1 + 1e-9, SPAR_ERR_ARGUMENT,
                      "%s: '%s': eta %lld is %g; eta runs from 0 to 1", call, name, (long long)i, eta[i]);
        SPARI_REQUIRE(session, i == 0 || eta[i] > eta[i - 1], SPAR_ERR_ARGUMENT,
                      "%s: '%s': eta %lld (%.17g) does not increase on the one before", call, name, (long long)i,
                      eta[i]);
    }
    return SPAR_OK;
}

static double *copy_of(const double *x, int64_t n) {
    double *c = spari_zalloc(n, sizeof *c);
    if (c && n > 0) {
        memcpy(c, x, (size_t)n * sizeof *c);
    }
    return c;
}

/* ---- create ---- */

static int member_create(spar_session *session, const char *call, const char *name, int kind, spar_member **out) {
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", call);
    SPARI_REQUIRE(session, out, SPAR_ERR_ARGUMENT, "%s: no place for the new member (NULL)", call);
    SPARI_REQUIRE(session, name && name[0], SPAR_ERR_ARGUMENT, "%s: a member needs a name", call);
    SPARI_REQUIRE(session, !session->started, SPAR_ERR_STATE,
                  "%s: '%s': the clock has started; create members before the first step", call, name);
    spar_member **end = &session->members;
    for (; *end; end = &(*end)->next) {
        SPARI_REQUIRE(session, strcmp((*end)->name, name) != 0, SPAR_ERR_ARGUMENT,
                      "%s: there is a member '%s' already; names are unique in a session", call, name);
    }
    spar_member *m = spari_zalloc(1, sizeof *m);
    size_t size = strlen(name) + 1;
    if (!m || !(m->name = spari_zalloc((int64_t)size, 1))) {
        free(m);
        return spari_fail(session, SPAR_ERR_MEMORY, "%s: '%s': no memory for the member", call, name);
    }
    memcpy(m->name, name, size);
    m->session = session;
    m->kind = kind;
    m->elements = m->per_element = 1;
    m->nodes = 1;
    m->owner = session->member_count % spari_comm_size(session->comm);
    m->root = kind == SPARI_BEAM ? SPAR_ROOT_FIXED : SPAR_ROOT_FREE;
    m->fidelity = SPAR_FIDELITY_EXACT;
    m->place_q[0] = 1;
    session->member_count++;
    *end = m;
    *out = m;
    return SPAR_OK;
}

static int check_place(spar_session *session, const char *call, const char *name, const double x[3],
                       const double q[4]) {
    if (x) {
        SPARI_TRY(need_finite(session, call, name, "x", 3, x));
    }
    if (q) {
        SPARI_TRY(need_finite(session, call, name, "q", 4, q));
        SPARI_TRY(need_unit(session, call, name, "q", 1, q, 4));
    }
    return SPAR_OK;
}

static void place(spar_member *m, const double x[3], const double q[4]) {
    if (x) {
        memcpy(m->place_x, x, sizeof m->place_x);
    }
    if (q) {
        memcpy(m->place_q, q, sizeof m->place_q);
        spari_quat_normalise(m->place_q);
    }
}

int spar_point_create(spar_session *session, const char *name, const double x[3], const double q[4],
                      spar_member **member) {
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "spar_point_create: the session is NULL; create it first");
    SPARI_TRY(check_place(session, "spar_point_create", name ? name : "", x, q));
    spar_member *m;
    SPARI_TRY(member_create(session, "spar_point_create", name, SPARI_POINT, member ? &m : NULL));
    place(m, x, q);
    *member = m;
    return SPAR_OK;
}

int spar_rigid_create(spar_session *session, const char *name, const double x[3], const double q[4],
                      const double mass[36], spar_member **member) {
    const char *call = "spar_rigid_create", *label = name ? name : "";
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", call);
    SPARI_TRY(check_place(session, call, label, x, q));
    SPARI_TRY(need_finite(session, call, label, "mass", 36, mass));
    double m0, c[3], J[6];
    const char *wrong = spari_mass_split(mass, &m0, c, J);
    SPARI_REQUIRE(session, !wrong, SPAR_ERR_ARGUMENT, "%s: '%s': the mass matrix is not that of a rigid body: %s", call,
                  label, wrong);
    spar_member *m;
    SPARI_TRY(member_create(session, call, name, SPARI_RIGID, member ? &m : NULL));
    place(m, x, q);
    memcpy(m->mass, mass, sizeof m->mass);
    *member = m;
    return SPAR_OK;
}

int spar_beam_create(spar_session *session, const char *name, int elements, int nodes_per_element,
                     spar_member **member) {
    const char *call = "spar_beam_create", *label = name ? name : "";
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", call);
    SPARI_REQUIRE(session, elements >= 1 && elements <= 1000000, SPAR_ERR_ARGUMENT,
                  "%s: '%s': %d elements; give 1 to 1000000", call, label, elements);
    SPARI_REQUIRE(session, nodes_per_element >= 2 && nodes_per_element <= SPARI_MAX_NODES, SPAR_ERR_ARGUMENT,
                  "%s: '%s': %d nodes per element; give 2 to %d", call, label, nodes_per_element, SPARI_MAX_NODES);
    spari_beam *beam = spari_zalloc(1, sizeof *beam);
    SPARI_REQUIRE(session, beam, SPAR_ERR_MEMORY, "%s: '%s': no memory for the beam", call, label);
    beam->rule = -1;
    spar_member *m;
    int status = member_create(session, call, name, SPARI_BEAM, member ? &m : NULL);
    if (status != SPAR_OK) {
        spari_beam_free(beam);
        return status;
    }
    m->beam = beam; /* NOLINT(clang-analyzer-core.NullDereference): create has set it */
    m->elements = elements;
    m->per_element = nodes_per_element;
    m->nodes = (int64_t)elements * nodes_per_element;
    *member = m;
    return SPAR_OK;
}

/* ---- describe ---- */

int spar_beam_set_axis(spar_member *beam, int64_t n, const double *eta, const double *xyz, const double *twist) {
    const char *call = "spar_beam_set_axis";
    SPARI_TRY(need_beam(beam, call));
    spar_session *session = beam->session;
    SPARI_REQUIRE(session, n >= 2, SPAR_ERR_ARGUMENT, "%s: '%s': %lld axis points; give at least 2", call, beam->name,
                  (long long)n);
    SPARI_TRY(need_increasing(session, call, beam->name, n, eta));
    SPARI_REQUIRE(session, fabs(eta[0]) < 1e-9 && fabs(eta[n - 1] - 1) < 1e-9, SPAR_ERR_ARGUMENT,
                  "%s: '%s': eta runs from %g to %g; the first point is eta 0 and the last eta 1", call, beam->name,
                  eta[0], eta[n - 1]);
    SPARI_TRY(need_finite(session, call, beam->name, "xyz", 3 * n, xyz));
    if (twist) {
        SPARI_TRY(need_finite(session, call, beam->name, "twist", n, twist));
    }
    double *copies[3] = {copy_of(eta, n), copy_of(xyz, 3 * n), twist ? copy_of(twist, n) : NULL};
    if (!copies[0] || !copies[1] || (twist && !copies[2])) {
        free(copies[0]), free(copies[1]), free(copies[2]);
        return spari_fail(session, SPAR_ERR_MEMORY, "%s: '%s': no memory for the axis", call, beam->name);
    }
    spari_beam *b = beam->beam;
    free(b->eta), free(b->xyz), free(b->twist), free(b->node_x), free(b->node_q);
    b->eta = copies[0], b->xyz = copies[1], b->twist = copies[2];
    b->node_x = b->node_q = NULL;
    b->axis_count = n;
    return SPAR_OK;
}

int spar_beam_set_nodes(spar_member *beam, int64_t n, const double *x, const double *q) {
    const char *call = "spar_beam_set_nodes";
    SPARI_TRY(need_beam(beam, call));
    spar_session *session = beam->session;
    SPARI_REQUIRE(session, n == beam->nodes, SPAR_ERR_ARGUMENT,
                  "%s: '%s': %lld nodes; it has %d elements of %d nodes, give %lld", call, beam->name, (long long)n,
                  beam->elements, beam->per_element, (long long)beam->nodes);
    SPARI_TRY(need_finite(session, call, beam->name, "x", 3 * n, x));
    if (q) {
        SPARI_TRY(need_finite(session, call, beam->name, "q", 4 * n, q));
        SPARI_TRY(need_unit(session, call, beam->name, "q", n, q, 4));
    }
    double size = 0;
    for (int64_t i = 3; i < 3 * n; i++) {
        size = fmax(size, fabs(x[i] - x[i % 3]));
    }
    for (int64_t i = beam->per_element; i < n; i += beam->per_element) {
        for (int c = 0; c < 3; c++) {
            SPARI_REQUIRE(session, fabs(x[3 * i + c] - x[3 * i - 3 + c]) <= 1e-9 * size, SPAR_ERR_ARGUMENT,
                          "%s: '%s': the joint of elements %lld and %lld stands at two places (nodes %lld and %lld)",
                          call, beam->name, (long long)(i / beam->per_element - 1), (long long)(i / beam->per_element),
                          (long long)i - 1, (long long)i);
        }
    }
    double *copies[2] = {copy_of(x, 3 * n), q ? copy_of(q, 4 * n) : NULL};
    if (!copies[0] || (q && !copies[1])) {
        free(copies[0]), free(copies[1]);
        return spari_fail(session, SPAR_ERR_MEMORY, "%s: '%s': no memory for the nodes", call, beam->name);
    }
    for (int64_t i = 0; q && i < n; i++) {
        spari_quat_normalise(copies[1] + 4 * i);
    }
    spari_beam *b = beam->beam;
    free(b->eta), free(b->xyz), free(b->twist), free(b->node_x), free(b->node_q);
    b->eta = b->xyz = b->twist = NULL;
    b->axis_count = 0;
    b->node_x = copies[0], b->node_q = copies[1];
    return SPAR_OK;
}

/* Symmetric to 1e-6 of the diagonal entries, and positive definite after scaling to a unit diagonal (so that units do
 * not matter). */
const char *spari_stiffness_fault(const double C[36]) {
    double d[6], scaled[36];
    for (int i = 0; i < 6; i++) {
        if (!(C[7 * i] > 0)) {
            return "not positive definite";
        }
        d[i] = sqrt(C[7 * i]);
    }
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 6; j++) {
            if (fabs(C[6 * i + j] - C[6 * j + i]) > 1e-6 * d[i] * d[j]) {
                return "not symmetric";
            }
            scaled[6 * i + j] = 0.5 * (C[6 * i + j] + C[6 * j + i]) / (d[i] * d[j]);
        }
    }
    gsl_matrix_view view = gsl_matrix_view_array(scaled, 6, 6);
    return gsl_linalg_cholesky_decomp1(&view.matrix) == GSL_SUCCESS ? NULL : "not positive definite";
}

int spar_beam_set_sections(spar_member *beam, int64_t n, const double *eta, const double *stiffness,
                           const double *mass) {
    const char *call = "spar_beam_set_sections";
    SPARI_TRY(need_beam(beam, call));
    spar_session *session = beam->session;
    SPARI_REQUIRE(session, n >= 1, SPAR_ERR_ARGUMENT, "%s: '%s': %lld sections; give at least 1", call, beam->name,
                  (long long)n);
    SPARI_TRY(need_increasing(session, call, beam->name, n, eta));
    SPARI_TRY(need_finite(session, call, beam->name, "stiffness", 36 * n, stiffness));
    if (mass) {
        SPARI_TRY(need_finite(session, call, beam->name, "mass", 36 * n, mass));
    }
    for (int64_t i = 0; i < n; i++) {
        const char *wrong = spari_stiffness_fault(stiffness + 36 * i);
        SPARI_REQUIRE(session, !wrong, SPAR_ERR_ARGUMENT, "%s: '%s': the stiffness of section %lld is %s", call,
                      beam->name, (long long)i, wrong);
        double m, c[3], J[6];
        wrong = mass ? spari_mass_split(mass + 36 * i, &m, c, J) : NULL;
        SPARI_REQUIRE(session, !wrong, SPAR_ERR_ARGUMENT,
                      "%s: '%s': the mass of section %lld is not that of a rigid section: %s", call, beam->name,
                      (long long)i, wrong);
    }
    double *copies[3] = {copy_of(eta, n), copy_of(stiffness, 36 * n), mass ? copy_of(mass, 36 * n) : NULL};
    if (!copies[0] || !copies[1] || (mass && !copies[2])) {
        free(copies[0]), free(copies[1]), free(copies[2]);
        return spari_fail(session, SPAR_ERR_MEMORY, "%s: '%s': no memory for the sections", call, beam->name);
    }
    spari_beam *b = beam->beam;
    free(b->section_eta), free(b->stiffness), free(b->mass);
    b->section_eta = copies[0], b->stiffness = copies[1], b->mass = copies[2];
    b->section_count = n;
    return SPAR_OK;
}

int spar_beam_set_quadrature(spar_member *beam, int rule, int points) {
    const char *call = "spar_beam_set_quadrature";
    SPARI_TRY(need_beam(beam, call));
    SPARI_REQUIRE(beam->session, rule >= SPAR_QUADRATURE_GAUSS && rule <= SPAR_QUADRATURE_SECTIONS, SPAR_ERR_ARGUMENT,
                  "%s: '%s': there is no quadrature rule %d; see SPAR_QUADRATURE_*", call, beam->name, rule);
    SPARI_REQUIRE(beam->session, points >= (rule == SPAR_QUADRATURE_LOBATTO ? 2 : 1) && points <= 512,
                  SPAR_ERR_ARGUMENT, "%s: '%s': %d quadrature points; give 1 (Lobatto 2) to 512", call, beam->name,
                  points);
    beam->beam->rule = rule;
    beam->beam->points = points;
    return SPAR_OK;
}

int spar_beam_set_damping(spar_member *beam, const double mu[6]) {
    const char *call = "spar_beam_set_damping";
    SPARI_TRY(need_beam(beam, call));
    SPARI_TRY(need_finite(beam->session, call, beam->name, "mu", 6, mu));
    int any = 0;
    for (int i = 0; i < 6; i++) {
        SPARI_REQUIRE(beam->session, mu[i] >= 0, SPAR_ERR_ARGUMENT,
                      "%s: '%s': mu[%d] is negative; damping takes energy out", call, beam->name, i);
        any |= mu[i] > 0;
    }
    memcpy(beam->beam->mu, mu, sizeof beam->beam->mu);
    beam->beam->damped = any;
    return SPAR_OK;
}

int spar_member_set_placement(spar_member *member, const double x[3], const double q[4]) {
    const char *call = "spar_member_set_placement";
    SPARI_TRY(need_open(member, call));
    SPARI_TRY(check_place(member->session, call, member->name, x, q));
    place(member, x, q);
    return SPAR_OK;
}

int spar_member_set_root(spar_member *member, int kind) {
    const char *call = "spar_member_set_root";
    SPARI_TRY(need_open(member, call));
    SPARI_REQUIRE(member->session, kind >= SPAR_ROOT_FREE && kind <= SPAR_ROOT_DRIVEN, SPAR_ERR_ARGUMENT,
                  "%s: '%s': there is no root condition %d; see SPAR_ROOT_*", call, member->name, kind);
    member->root = kind;
    return SPAR_OK;
}

int spar_member_set_external(spar_member *member, int on) {
    SPARI_TRY(need_open(member, "spar_member_set_external"));
    member->external = on != 0;
    return SPAR_OK;
}

int spar_member_set_effects(spar_member *member, int effects) {
    const char *call = "spar_member_set_effects";
    const int all = SPAR_EFFECT_INERTIA | SPAR_EFFECT_GYROSCOPIC | SPAR_EFFECT_GRAVITY | SPAR_EFFECT_DAMPING |
                    SPAR_EFFECT_LARGE_ROTATION | SPAR_EFFECT_FLUID_MOMENT | SPAR_EFFECT_FLUID_HISTORY;
    SPARI_TRY(need_open(member, call));
    SPARI_REQUIRE(member->session, (effects & ~all) == 0, SPAR_ERR_ARGUMENT,
                  "%s: '%s': unknown effect bits 0x%x; see SPAR_EFFECT_*", call, member->name,
                  (unsigned)(effects & ~all));
    member->effects = effects;
    member->effects_given = 1;
    return SPAR_OK;
}

int spar_member_set_fidelity(spar_member *member, int kind, int64_t modes) {
    const char *call = "spar_member_set_fidelity";
    SPARI_TRY(need_open(member, call));
    spar_session *s = member->session;
    SPARI_REQUIRE(s, kind >= SPAR_FIDELITY_PRESCRIBED && kind <= SPAR_FIDELITY_EXACT, SPAR_ERR_ARGUMENT,
                  "%s: '%s': there is no fidelity %d; see SPAR_FIDELITY_*", call, member->name, kind);
    SPARI_REQUIRE(s, kind == SPAR_FIDELITY_EXACT || member->kind == SPARI_BEAM, SPAR_ERR_ARGUMENT,
                  "%s: '%s' is not a beam; a point and a rigid body have one fidelity", call, member->name);
    SPARI_REQUIRE(s, kind != SPAR_FIDELITY_MODAL || (modes >= 1 && modes <= INT32_MAX), SPAR_ERR_ARGUMENT,
                  "%s: '%s': %lld modes; give at least 1", call, member->name, (long long)modes);
    member->fidelity = kind;
    member->modes = kind == SPAR_FIDELITY_MODAL ? modes : 0;
    return SPAR_OK;
}

static void rigid_field(spar_member *m) {
    const double *x0 = m->velocity[0], *v0 = m->velocity[1], *w = m->velocity[2];
    for (int64_t i = 0; i < m->nodes; i++) {
        double r[3], *v = m->now.v + 6 * i, *a = m->now.a + 6 * i;
        for (int c = 0; c < 3; c++) {
            r[c] = m->xr[3 * i + c] + m->now.q[7 * i + c] - x0[c];
        }
        spari_cross(w, r, v);
        spari_cross(
            w, v,
            a); /* centripetal: what a body turning steadily has; the solver replaces it by the balance of forces */
        for (int c = 0; c < 3; c++) {
            v[c] += v0[c];
            v[3 + c] = w[c];
            a[3 + c] = 0;
        }
    }
}

static void copy_motion(const spar_member *m, const spari_motion *from, spari_motion *to) {
    memcpy(to->q, from->q, (size_t)m->nodes * 7 * sizeof *to->q);
    memcpy(to->v, from->v, (size_t)m->nodes * 6 * sizeof *to->v);
    memcpy(to->a, from->a, (size_t)m->nodes * 6 * sizeof *to->a);
}

/* The motion at t^0 has changed: the latest iterate, the root and the solver start from it. */
static void restart(spar_member *m) {
    copy_motion(m, &m->now, &m->after);
    for (int k = 0; k < 2; k++) {
        memcpy(m->drive[k], m->now.q, 7 * sizeof(double));
        memcpy(m->drive[k] + 7, m->now.v, 6 * sizeof(double));
        memcpy(m->drive[k] + 13, m->now.a, 6 * sizeof(double));
    }
    if (m->solver) {
        spari_solver_restart(m->solver, m);
    } else if (m->rung) {
        spari_rung_restart(m);
    }
    if (m->work) {
        spari_work_restart(m);
    }
}

/* a's loads become b's */
static void copy_solved(spar_member *m, int a, int b) {
    memcpy(m->load_solved[b], m->load_solved[a], (size_t)(6 * m->nodes) * sizeof(double));
}

void spari_member_solved(spar_member *m, const double *fluid) {
    for (int64_t i = 0; i < 6 * m->nodes; i++) {
        m->load_solved[1][i] = m->dead[i] + fluid[i];
    }
}

void spari_member_settle(spar_member *m) {
    copy_motion(m, &m->after, &m->now);
    copy_solved(m, 1, 0);
    restart(m);
}

void spari_member_accept(spar_member *m) {
    if (m->work) {
        spari_work_step(m);
    }
    copy_motion(m, &m->after, &m->now);
    copy_solved(m, 1, 0);
    memcpy(m->drive[0], m->drive[1], sizeof m->drive[0]);
    m->drive_given = m->motion_given = 0;
    m->dissipated += m->dissipated_step;
    m->dissipated_step = 0;
    if (m->solver) {
        spari_solver_accept(m->solver);
    } else if (m->rung) {
        spari_rung_accept(m);
    }
}

void spari_member_reject(spar_member *m) {
    copy_motion(m, &m->now, &m->after);
    copy_solved(m, 0, 1);
    m->motion_given = 0;
    m->dissipated_step = 0;
    if (m->solver && m->session->step == 0) { /* the first step's accelerations at t^0 depend on its dt */
        spari_solver_restart(m->solver, m);
    } else if (m->rung && m->session->step == 0) {
        spari_rung_restart(m);
    }
}

int spar_member_set_velocity(spar_member *member, const double x0[3], const double v0[3], const double omega[3]) {
    const char *call = "spar_member_set_velocity";
    static const double zero[3] = {0, 0, 0};
    SPARI_TRY(need_member(member, call));
    SPARI_REQUIRE(member->session, !member->session->started, SPAR_ERR_STATE,
                  "%s: '%s': the clock has started; give initial velocities before the first step", call, member->name);
    const double *in[3] = {x0 ? x0 : zero, v0 ? v0 : zero, omega ? omega : zero};
    const char *what[3] = {"x0", "v0", "omega"};
    for (int k = 0; k < 3; k++) {
        SPARI_TRY(need_finite(member->session, call, member->name, what[k], 3, in[k]));
    }
    for (int k = 0; k < 3; k++) {
        memcpy(member->velocity[k], in[k], 3 * sizeof(double));
    }
    member->velocity_given = 1;
    if (member->committed) {
        rigid_field(member);
        restart(member);
    }
    return SPAR_OK;
}

int spar_member_set_owner(spar_member *member, int rank) {
    const char *call = "spar_member_set_owner";
    SPARI_TRY(need_open(member, call));
    int size = spari_comm_size(member->session->comm);
    SPARI_REQUIRE(member->session, rank >= 0 && rank < size, SPAR_ERR_ARGUMENT,
                  "%s: '%s': there is no rank %d; the session has %d", call, member->name, rank, size);
    member->owner = rank;
    return SPAR_OK;
}

/* ---- commit ---- */

int spari_member_is_solved(const spar_member *member) {
    return !member->external && member->kind != SPARI_POINT && !spari_rung_prescribed(member);
}

/* FNV-1a over what the ranks must agree on. */
static uint64_t hash_bytes(uint64_t h, const void *data, size_t size) {
    const unsigned char *p = data;
    for (size_t i = 0; i < size; i++) {
        h = (h ^ p[i]) * UINT64_C(1099511628211);
    }
    return h;
}

uint64_t spari_member_hash(const spar_member *m) {
    uint64_t h = UINT64_C(14695981039346656037);
    int numbers[] = {m->kind,     m->external,    m->root,           m->effects,  m->effects_given,
                     m->elements, m->per_element, m->velocity_given, m->fidelity, (int)m->modes};
    h = hash_bytes(h, m->name, strlen(m->name));
    h = hash_bytes(h, numbers, sizeof numbers);
    h = hash_bytes(h, m->place_x, sizeof m->place_x);
    h = hash_bytes(h, m->place_q, sizeof m->place_q);
    h = hash_bytes(h, m->mass, sizeof m->mass);
    h = hash_bytes(h, m->velocity, sizeof m->velocity);
    const spari_beam *b = m->beam;
    if (b) {
        size_t n = (size_t)b->axis_count, s = (size_t)b->section_count, d = sizeof(double);
        int more[] = {b->rule,           b->points,         b->eta != NULL, b->twist != NULL,
                      b->node_x != NULL, b->node_q != NULL, b->mass != NULL};
        h = hash_bytes(h, more, sizeof more);
        h = hash_bytes(h, b->mu, sizeof b->mu);
        h = b->eta ? hash_bytes(hash_bytes(h, b->eta, n * d), b->xyz, 3 * n * d) : h;
        h = b->twist ? hash_bytes(h, b->twist, n * d) : h;
        h = b->node_x ? hash_bytes(h, b->node_x, 3 * (size_t)m->nodes * d) : h;
        h = b->node_q ? hash_bytes(h, b->node_q, 4 * (size_t)m->nodes * d) : h;
        h = b->section_eta ? hash_bytes(hash_bytes(h, b->section_eta, s * d), b->stiffness, 36 * s * d) : h;
        h = b->mass ? hash_bytes(h, b->mass, 36 * s * d) : h;
    }
    return h;
}

static int check_description(spar_member *m) {
    if (m->kind == SPARI_BEAM) {
        SPARI_REQUIRE(m->session, m->beam->eta || m->beam->node_x, SPAR_ERR_STATE,
                      "spar_member_commit: '%s' has no line; call spar_beam_set_axis or spar_beam_set_nodes", m->name);
        SPARI_REQUIRE(m->session, m->external || m->beam->stiffness, SPAR_ERR_STATE,
                      "spar_member_commit: '%s' has no sections; call spar_beam_set_sections", m->name);
    }
    SPARI_REQUIRE(m->session, !m->session->started, SPAR_ERR_STATE,
                  "spar_member_commit: '%s': the clock has started; commit members before the first step", m->name);
    SPARI_TRY(spari_rung_check(m));
    return SPAR_OK;
}

/* What is in force: what was asked for (or everything), as far as the description gives it something to do. */
static int effects_in_force(const spar_member *m) {
    int e = m->effects_given ? m->effects : ~0;
    int massive = m->kind == SPARI_RIGID || (m->beam && m->beam->mass), solved = spari_member_is_solved(m);
    int possible = SPAR_EFFECT_FLUID_MOMENT | SPAR_EFFECT_LARGE_ROTATION;
    possible |= solved && massive ? SPAR_EFFECT_INERTIA | SPAR_EFFECT_GRAVITY : 0;
    possible |= solved && massive && (e & SPAR_EFFECT_INERTIA) ? SPAR_EFFECT_GYROSCOPIC : 0;
    possible |= solved && m->beam && m->beam->damped ? SPAR_EFFECT_DAMPING : 0;
    possible |= m->effects_given ? SPAR_EFFECT_FLUID_HISTORY : 0; /* unasked it comes with the fluids that need it */
    return spari_rung_effects(m, e & possible);
}

/* The arrays over the nodes, and how many numbers a node has in each. */
static const struct {
    size_t field;
    int width;
} node_arrays[] = {
    {offsetof(spar_member, xr), 3},
    {offsetof(spar_member, qr), 4},
    {offsetof(spar_member, now.q), 7},
    {offsetof(spar_member, now.v), 6},
    {offsetof(spar_member, now.a), 6},
    {offsetof(spar_member, after.q), 7},
    {offsetof(spar_member, after.v), 6},
    {offsetof(spar_member, after.a), 6},
    {offsetof(spar_member, dead), 6},
    {offsetof(spar_member, load_used), 6},
    {offsetof(spar_member, load_pushed), 6},
    {offsetof(spar_member, load_history[0]), 6},
    {offsetof(spar_member, load_history[1]), 6},
    {offsetof(spar_member, load_history[2]), 6},
    {offsetof(spar_member, load_solved[0]), 6},
    {offsetof(spar_member, load_solved[1]), 6},
};
enum { NODE_ARRAYS = sizeof node_arrays / sizeof *node_arrays };

static double **node_array(spar_member *m, int k) {
    return (double **)(void *)((char *)m + node_arrays[k].field);
}

static int allocate(spar_member *m) {
    for (int k = 0; k < NODE_ARRAYS; k++) {
        double *x = spari_zalloc(node_arrays[k].width * m->nodes, sizeof *x);
        SPARI_REQUIRE(m->session, x, SPAR_ERR_MEMORY, "spar_member_commit: no memory for '%s'", m->name);
        *node_array(m, k) = x;
    }
    return SPAR_OK;
}

static void release(spar_member *m) {
    for (int k = 0; k < NODE_ARRAYS; k++) {
        free(*node_array(m, k));
        *node_array(m, k) = NULL;
    }
    spari_work_free(m->work);
    m->work = NULL;
    spari_applied_free(m->applied);
    spari_applied_free(m->applied_next);
    m->applied = m->applied_next = NULL;
    spari_rung_free(m->rung);
    m->rung = NULL;
    spari_solver_free(m->solver);
    spari_body_free(m->body);
    m->solver = NULL;
    m->body = NULL;
}

static int build(spar_member *m) {
    spar_session *session = m->session;
    SPARI_TRY(allocate(m));
    if (m->kind == SPARI_BEAM) {
        SPARI_TRY(spari_beam_place_nodes(m));
    } else {
        memcpy(m->xr, m->place_x, sizeof m->place_x);
        memcpy(m->qr, m->place_q, sizeof m->place_q);
    }
    for (int64_t i = 0; i < m->nodes; i++) {
        m->now.q[7 * i + 3] = 1;
    }
    if (m->velocity_given) {
        rigid_field(m);
    }
    if (spari_member_is_solved(m)) {
        SPARI_TRY(m->kind == SPARI_BEAM ? spari_beam_build(m, &m->body) : spari_rigid_build(m, &m->body));
        m->body->gyroscopic = (m->effects & SPAR_EFFECT_GYROSCOPIC) != 0;
        spari_member_gravity(m);
        SPARI_TRY(spari_rung_create(m));
        if (!m->rung && !(m->effects & SPAR_EFFECT_LARGE_ROTATION)) {
            SPARI_REQUIRE(session, spari_body_linearise(m->body) == 0, SPAR_ERR_MEMORY,
                          "spar_member_commit: no memory for '%s'", m->name);
        }
        if (!m->rung && m->owner == spari_comm_rank(session->comm)) {
            m->solver = spari_solver_create(m);
            SPARI_REQUIRE(session, m->solver, SPAR_ERR_MEMORY, "spar_member_commit: no memory for the solver of '%s'",
                          m->name);
        }
    } else if (spari_rung_prescribed(m)) {
        SPARI_TRY(spari_rung_create(m));
    }
    restart(m);
    return SPAR_OK;
}

void spari_member_gravity(spar_member *m) {
    if (m->body) {
        for (int i = 0; i < 3; i++) {
            m->body->gravity[i] = m->effects & SPAR_EFFECT_GRAVITY ? m->session->gravity[i] : 0;
        }
        spari_body_gravity_changed(m->body);
    }
}

int spar_member_commit(spar_member *member) {
    SPARI_TRY(need_member(member, "spar_member_commit"));
    spar_session *s = member->session;
    int asked = member->effects, status;
    if (member->committed) {
        status = spari_fail(s, SPAR_ERR_STATE, "spar_member_commit: '%s' is committed already", member->name);
    } else {
        status = check_description(member);
        if (status == SPAR_OK) {
            member->effects = effects_in_force(member);
            status = build(member);
            if (status != SPAR_OK) {
                release(member);
            }
        }
    }
    int agreed = spari_session_enter(member, "spar_member_commit", status), same = 1;
    if (agreed == SPAR_OK) {
        agreed = spari_comm_same(s->comm, spari_member_hash(member) ^ (uint64_t)(member->owner + 1), &same);
        if (agreed == SPAR_OK && !same) {
            agreed = spari_fail(s, SPAR_ERR_COMM,
                                "spar_member_commit: the ranks describe '%s' differently; make the calls that describe "
                                "a member with the same "
                                "arguments on every rank",
                                member->name);
        }
    }
    if (agreed != SPAR_OK) {
        if (status == SPAR_OK) {
            release(member);
        }
        if (!member->committed) {
            member->effects = asked;
        }
        return agreed;
    }
    member->committed = 1;
    return SPAR_OK;
}

void spari_member_free(spar_member *member) {
    if (!member) {
        return;
    }
    release(member);
    spari_beam_free(member->beam);
    free(member->name);
    free(member);
}

/* ---- state ---- */

int spar_member_get_count(const spar_member *member, int64_t *nodes) {
    SPARI_TRY(need_member(member, "spar_member_get_count"));
    SPARI_REQUIRE(member->session, nodes, SPAR_ERR_ARGUMENT, "spar_member_get_count: '%s': nodes is NULL",
                  member->name);
    *nodes = member->nodes;
    return SPAR_OK;
}

/* copies n doubles where they are wanted */
static void give(double *to, const double *from, int64_t n) {
    if (to) {
        memcpy(to, from, (size_t)n * sizeof *to);
    }
}

int spar_member_get_reference(const spar_member *member, double *x, double *q) {
    SPARI_TRY(need_committed(member, "spar_member_get_reference"));
    give(x, member->xr, 3 * member->nodes);
    give(q, member->qr, 4 * member->nodes);
    return SPAR_OK;
}

int spar_member_get_motion(const spar_member *member, double *q, double *v, double *a) {
    SPARI_TRY(need_committed(member, "spar_member_get_motion"));
    give(q, member->after.q, 7 * member->nodes);
    give(v, member->after.v, 6 * member->nodes);
    give(a, member->after.a, 6 * member->nodes);
    return SPAR_OK;
}

int spar_member_set_motion(spar_member *member, const double *q, const double *v, const double *a) {
    const char *call = "spar_member_set_motion";
    SPARI_TRY(need_committed(member, call));
    spar_session *s = member->session;
    int64_t n = member->nodes;
    SPARI_REQUIRE(
        s, member->external || member->kind == SPARI_POINT, SPAR_ERR_STATE,
        "%s: spar solves for '%s' itself; set_motion is for points and external members (spar_member_set_external)",
        call, member->name);
    SPARI_REQUIRE(s, s->phase != SPARI_IDLE || !s->started, SPAR_ERR_STATE,
                  "%s: '%s': no step is under way; give the motion at t^{n+1} after spar_step_begin", call,
                  member->name);
    if (q) {
        SPARI_TRY(need_finite(s, call, member->name, "q", 7 * n, q));
        SPARI_TRY(need_unit(s, call, member->name, "q", n, q + 3, 7));
    }
    if (v) {
        SPARI_TRY(need_finite(s, call, member->name, "v", 6 * n, v));
    }
    if (a) {
        SPARI_TRY(need_finite(s, call, member->name, "a", 6 * n, a));
    }
    spari_motion *to = s->phase == SPARI_IDLE ? &member->now : &member->after;
    for (int64_t i = 0; q && i < n; i++) {
        memcpy(to->q + 7 * i, q + 7 * i, 7 * sizeof *q);
        spari_quat_normalise(to->q + 7 * i + 3);
    }
    if (v) {
        memcpy(to->v, v, (size_t)n * 6 * sizeof *v);
    }
    if (a) {
        memcpy(to->a, a, (size_t)n * 6 * sizeof *a);
    }
    if (s->phase == SPARI_IDLE) {
        restart(member);
    } else {
        member->motion_given = 1;
    }
    return SPAR_OK;
}

int spar_member_drive_root(spar_member *member, const double q[7], const double v[6], const double a[6]) {
    static const double rest[6] = {0};
    const char *call = "spar_member_drive_root";
    SPARI_TRY(need_committed(member, call));
    spar_session *s = member->session;
    SPARI_REQUIRE(s, member->kind == SPARI_POINT || (member->root == SPAR_ROOT_DRIVEN && !member->external),
                  SPAR_ERR_STATE,
                  "%s: the root of '%s' is not driven; call spar_member_set_root with SPAR_ROOT_DRIVEN before commit",
                  call, member->name);
    SPARI_REQUIRE(s, s->phase == SPARI_IDLE, SPAR_ERR_STATE,
                  "%s: '%s': a step is under way; the root's motion at its end is given before spar_step_begin", call,
                  member->name);
    SPARI_TRY(need_finite(s, call, member->name, "q", 7, q));
    SPARI_TRY(need_unit(s, call, member->name, "q", 1, q + 3, 7));
    const double *in[2] = {v ? v : rest, a ? a : rest};
    SPARI_TRY(need_finite(s, call, member->name, "v", 6, in[0]));
    SPARI_TRY(need_finite(s, call, member->name, "a", 6, in[1]));
    double *to = member->drive[1];
    memcpy(to, q, 7 * sizeof *q);
    memcpy(to + 7, in[0], 6 * sizeof *to);
    memcpy(to + 13, in[1], 6 * sizeof *to);
    spari_quat_normalise(to + 3);
    member->drive_given = 1;
    return SPAR_OK;
}

int spar_member_add_load(spar_member *member, int64_t node, const double load[6]) {
    const char *call = "spar_member_add_load";
    SPARI_TRY(need_committed(member, call));
    SPARI_REQUIRE(member->session, node >= 0 && node < member->nodes, SPAR_ERR_ARGUMENT,
                  "%s: '%s' has nodes 0 to %lld; there is no node %lld", call, member->name,
                  (long long)member->nodes - 1, (long long)node);
    SPARI_TRY(need_finite(member->session, call, member->name, "load", 6, load));
    memcpy(member->dead + 6 * node, load, 6 * sizeof *load);
    return SPAR_OK;
}

int spar_member_get_loads(const spar_member *member, double *load) {
    SPARI_TRY(need_committed(member, "spar_member_get_loads"));
    SPARI_REQUIRE(member->session, load, SPAR_ERR_ARGUMENT, "spar_member_get_loads: '%s': load is NULL", member->name);
    const spar_session *s = member->session;
    int used = s->phase == SPARI_BEGUN || s->phase == SPARI_SOLVED || (s->phase == SPARI_CHECKED && s->iterating);
    const double *fluid = used ? member->load_used : member->load_pushed;
    for (int64_t i = 0; i < 6 * member->nodes; i++) {
        load[i] = member->dead[i] + fluid[i];
    }
    if (member->applied) {
        spari_applied_nodal(member, member->after.q, load);
    }
    return SPAR_OK;
}

int spar_member_get_reaction(const spar_member *member, double load[6]) {
    SPARI_TRY(need_committed(member, "spar_member_get_reaction"));
    SPARI_REQUIRE(member->session, load, SPAR_ERR_ARGUMENT, "spar_member_get_reaction: '%s': load is NULL",
                  member->name);
    return spari_member_reaction(member, load);
}

/* The unknowns' view of the nodes: joints once. Node i of the public numbering is unique node i - i / P (e P + k -> e
 * (P-1) + k). */
void spari_member_to_unique(const spar_member *m, int width, const double *nodes, double *unique) {
    int P = m->per_element;
    if (m->elements == 1) {
        memcpy(unique, nodes, (size_t)(width * m->nodes) * sizeof *nodes);
        return;
    }
    for (int64_t i = 0; i < m->nodes; i++) {
        memcpy(unique + width * (i - i / P), nodes + width * i, (size_t)width * sizeof *nodes);
    }
}

void spari_member_from_unique(const spar_member *m, int width, const double *unique, double *nodes) {
    int P = m->per_element;
    if (m->elements == 1) {
        memcpy(nodes, unique, (size_t)(width * m->nodes) * sizeof *nodes);
        return;
    }
    for (int64_t i = 0; i < m->nodes; i++) {
        memcpy(nodes + width * i, unique + width * (i - i / P), (size_t)width * sizeof *nodes);
    }
}

int spari_member_reaction(const spar_member *m, double load[6]) {
    if (m->rung) {
        return spari_rung_reaction(m, load);
    }
    memset(load, 0, 6 * sizeof *load);
    const spari_body *b = m->body;
    int held = m->root == SPAR_ROOT_FREE ? 0 : m->root == SPAR_ROOT_PINNED ? 3 : 6;
    if (!b || held == 0) {
        return SPAR_OK;
    }
    int64_t n = b->unique;
    int still = !(m->effects & SPAR_EFFECT_INERTIA);
    double *q = spari_zalloc(25 * n, sizeof *q), *v = q + 7 * n, *a = v + 6 * n, *r = a + 6 * n;
    SPARI_REQUIRE(m->session, q, SPAR_ERR_MEMORY, "member '%s': no memory for its reaction", m->name);
    spari_member_to_unique(m, 7, m->after.q, q);
    spari_member_to_unique(m, 6, m->after.v, v);
    spari_member_to_unique(m, 6, m->after.a, a);
    spari_body_residual(b, q, still && !b->D ? NULL : v, still ? NULL : a, 1, r, NULL);
    if (m->applied) {
        spari_applied_residual(m, q, 1, r);
    }
    for (int i = 0; i < held; i++) { /* the root is node 0, which no joint repeats */
        load[i] = r[i] - m->load_solved[1][i];
    }
    free(q);
    return SPAR_OK;
}

int spar_member_get_energy(const spar_member *member, double energy[4]) {
    SPARI_TRY(need_committed(member, "spar_member_get_energy"));
    SPARI_REQUIRE(member->session, energy, SPAR_ERR_ARGUMENT, "spar_member_get_energy: '%s': energy is NULL",
                  member->name);
    memset(energy, 0, 4 * sizeof *energy);
    const spari_body *b = member->body;
    if (!b) {
        return SPAR_OK;
    }
    double *q = spari_zalloc(13 * (int64_t)b->unique, sizeof *q), *v = q + 7 * (int64_t)b->unique;
    SPARI_REQUIRE(member->session, q, SPAR_ERR_MEMORY, "spar_member_get_energy: no memory for '%s'", member->name);
    spari_member_to_unique(member, 7, member->after.q, q);
    spari_member_to_unique(member, 6, member->after.v, v);
    spari_body_energy(b, q, v, energy);
    energy[0] = member->effects & SPAR_EFFECT_INERTIA ? energy[0] : 0;
    energy[3] = member->dissipated;
    if (member->rung) {
        spari_rung_energy(member, energy);
    }
    free(q);
    return SPAR_OK;
}
