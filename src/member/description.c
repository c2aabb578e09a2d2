/* The description of a member before commit: creation, setters and what they refuse. */
#include "../algebra/dense.h"
#include "../base/environment.h"
#include "../comm/comm.h"
#include "../math/rotation.h"
#include "added_mass_fit.h"
#include "beam.h"
#include "check_arguments.h"

#include <stdlib.h>
#include <string.h>

/* ---- create ---- */

static int member_create(spar_session *session, const char *call, const char *name, int kind, spar_member **out) {
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", call);
    SPARI_REQUIRE(session, out, SPAR_ERR_ARGUMENT, "%s: the pointer to the new member is NULL", call);
    SPARI_REQUIRE(session, name && name[0], SPAR_ERR_ARGUMENT,
                  "%s: a member needs a name; give one that is unique in the session", call);
    SPARI_REQUIRE(session, !session->clock.started && !session->state.trial, SPAR_ERR_STATE,
                  "%s: '%s': the clock has started; create members before the first step", call, name);
    spar_member *m = spari_zalloc(1, sizeof *m);
    char *own = strdup(name);
    int failed = m && own ? spari_names_add(&session->member_names, own) : -1;
    if (failed) {
        free(m);
        free(own);
        SPARI_REQUIRE(session, failed < 0, SPAR_ERR_ARGUMENT,
                      "%s: member '%s' already exists; use a unique name in the session", call, name);
        return spari_fail(session, SPAR_ERR_MEMORY, "%s: '%s': no memory for the member", call, name);
    }
    m->name = own;
    m->session = session;
    m->number = session->member_count;
    m->kind = kind;
    m->mesh.elements = m->mesh.per_element = 1;
    m->nodes = 1;
    m->owner = session->member_count % spari_comm_size(session->ranks.comm);
    m->root = kind == SPARI_BEAM ? SPAR_ROOT_FIXED : SPAR_ROOT_FREE;
    m->fidelity = SPAR_FIDELITY_EXACT;
    m->placement.q[0] = 1;
    session->member_count++;
    *(session->last_member ? &session->last_member->next : &session->members) = m;
    session->last_member = m;
    *out = m;
    return SPAR_OK;
}

static int check_place(spar_session *session, const char *call, const char *name, const double x[3],
                       const double q[4]) {
    if (x) {
        SPARI_TRY(spari_need_finite(session, call, name, "x", 3, x));
    }
    if (q) {
        SPARI_TRY(spari_need_finite(session, call, name, "q", 4, q));
        SPARI_TRY(spari_need_unit(session, call, name, "q", 1, q, 4));
    }
    return SPAR_OK;
}

static void set_place(spar_member *m, const double x[3], const double q[4]) {
    if (x) {
        memcpy(m->placement.x, x, sizeof m->placement.x);
    }
    if (q) {
        memcpy(m->placement.q, q, sizeof m->placement.q);
        spari_quat_normalise(m->placement.q);
    }
}

int spar_point_create(spar_session *session, const char *name, const double x[3], const double q[4],
                      spar_member **member) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    SPARI_TRY(check_place(session, __func__, name ? name : "", x, q));
    spar_member *m;
    SPARI_TRY(member_create(session, __func__, name, SPARI_POINT, member ? &m : NULL));
    set_place(m, x, q);
    *member = m;
    return SPAR_OK;
}

int spar_rigid_create(spar_session *session, const char *name, const double x[3], const double q[4],
                      const double mass[36], spar_member **member) {
    SPARI_GUARD_ENVIRONMENT;
    const char *label = name ? name : "";
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    SPARI_TRY(check_place(session, __func__, label, x, q));
    SPARI_TRY(spari_need_finite(session, __func__, label, "mass", 36, mass));
    double m0, c[3], J[6];
    const char *wrong = spari_mass_split(mass, &m0, c, J);
    SPARI_REQUIRE(session, !wrong, SPAR_ERR_ARGUMENT, "%s: '%s': the mass matrix is not that of a rigid body: %s",
                  __func__, label, wrong);
    double moment[3];
    SPARI_REQUIRE(session, !spari_inertia_is_impossible(mass, moment), SPAR_ERR_ARGUMENT,
                  "%s: '%s': no body has the moments of inertia %.4g, %.4g, %.4g about its centre of mass: the largest "
                  "is at most the sum of the others; check the axes and the point they refer to",
                  __func__, label, moment[0], moment[1], moment[2]);
    spar_member *m;
    SPARI_TRY(member_create(session, __func__, name, SPARI_RIGID, member ? &m : NULL));
    set_place(m, x, q);
    memcpy(m->mass, mass, sizeof m->mass);
    *member = m;
    return SPAR_OK;
}

int spar_beam_create(spar_session *session, const char *name, int elements, int nodes_per_element,
                     spar_member **member) {
    const char *label = name ? name : "";
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    SPARI_REQUIRE(session, elements >= 1 && elements <= 1000000, SPAR_ERR_ARGUMENT,
                  "%s: '%s': %d elements; give 1 to 1000000", __func__, label, elements);
    SPARI_REQUIRE(session, nodes_per_element >= 2 && nodes_per_element <= SPARI_MAX_NODES, SPAR_ERR_ARGUMENT,
                  "%s: '%s': %d nodes per element; give 2 to %d", __func__, label, nodes_per_element, SPARI_MAX_NODES);
    spari_beam *beam = spari_zalloc(1, sizeof *beam);
    SPARI_REQUIRE(session, beam, SPAR_ERR_MEMORY, "%s: '%s': no memory for the beam", __func__, label);
    beam->rule = -1;
    spar_member *m;
    int status = member_create(session, __func__, name, SPARI_BEAM, member ? &m : NULL);
    if (status != SPAR_OK) {
        spari_beam_free(beam);
        return status;
    }
    m->beam = beam; /* NOLINT(clang-analyzer-core.NullDereference): create has set it */
    m->mesh.elements = elements;
    m->mesh.per_element = nodes_per_element;
    m->nodes = (int64_t)elements * nodes_per_element;
    *member = m;
    return SPAR_OK;
}

/* ---- description ---- */

int spar_beam_set_axis(spar_member *beam, int64_t n, const double *eta, const double *xyz, const double *twist) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_beam(beam, __func__));
    spar_session *session = beam->session;
    SPARI_REQUIRE(session, n >= 2 && n <= SPARI_MOST, SPAR_ERR_ARGUMENT,
                  "%s: '%s': %lld axis points; give at least 2, at most 2^40", __func__, beam->name, (long long)n);
    SPARI_TRY(spari_need_eta(session, __func__, beam->name, n, eta, SPARI_INCREASING));
    SPARI_REQUIRE(session, fabs(eta[0]) < 1e-9 && fabs(eta[n - 1] - 1) < 1e-9, SPAR_ERR_ARGUMENT,
                  "%s: '%s': eta runs from %g to %g; the first point is eta 0 and the last eta 1", __func__, beam->name,
                  eta[0], eta[n - 1]);
    SPARI_TRY(spari_need_finite(session, __func__, beam->name, "xyz", 3 * n, xyz));
    if (twist) {
        SPARI_TRY(spari_need_finite(session, __func__, beam->name, "twist", n, twist));
    }
    double *copies[3] = {spari_copy(eta, n), spari_copy(xyz, 3 * n), twist ? spari_copy(twist, n) : NULL};
    if (!copies[0] || !copies[1] || (twist && !copies[2])) {
        free(copies[0]), free(copies[1]), free(copies[2]);
        return spari_fail(session, SPAR_ERR_MEMORY, "%s: '%s': no memory for the axis", __func__, beam->name);
    }
    spari_beam *b = beam->beam;
    free(b->eta), free(b->xyz), free(b->twist), free(b->node_x), free(b->node_q);
    b->eta = copies[0], b->xyz = copies[1], b->twist = copies[2];
    b->node_x = b->node_q = NULL;
    b->axis_count = n;
    return SPAR_OK;
}

int spar_beam_set_nodes(spar_member *beam, int64_t n, const double *x, const double *q) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_beam(beam, __func__));
    spar_session *session = beam->session;
    SPARI_REQUIRE(session, n == beam->nodes, SPAR_ERR_ARGUMENT,
                  "%s: '%s': %lld nodes; for %d elements of %d nodes give %lld", __func__, beam->name, (long long)n,
                  beam->mesh.elements, beam->mesh.per_element, (long long)beam->nodes);
    SPARI_TRY(spari_need_finite(session, __func__, beam->name, "x", 3 * n, x));
    if (q) {
        SPARI_TRY(spari_need_finite(session, __func__, beam->name, "q", 4 * n, q));
        SPARI_TRY(spari_need_unit(session, __func__, beam->name, "q", n, q, 4));
    }
    double size = 0;
    for (int64_t i = 3; i < 3 * n; i++) {
        size = fmax(size, fabs(x[i] - x[i % 3]));
    }
    for (int64_t i = beam->mesh.per_element; i < n; i += beam->mesh.per_element) {
        for (int c = 0; c < 3; c++) {
            SPARI_REQUIRE(session, fabs(x[3 * i + c] - x[3 * i - 3 + c]) <= 1e-9 * size, SPAR_ERR_ARGUMENT,
                          "%s: '%s': elements %lld and %lld share a node, but its two positions differ (nodes %lld and "
                          "%lld); give the same position twice",
                          __func__, beam->name, (long long)(i / beam->mesh.per_element - 1),
                          (long long)(i / beam->mesh.per_element), (long long)i - 1, (long long)i);
        }
    }
    double *copies[2] = {spari_copy(x, 3 * n), q ? spari_copy(q, 4 * n) : NULL};
    if (!copies[0] || (q && !copies[1])) {
        free(copies[0]), free(copies[1]);
        return spari_fail(session, SPAR_ERR_MEMORY, "%s: '%s': no memory for the nodes", __func__, beam->name);
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

/* Symmetric to 1e-6 of the diagonal entries, and positive definite after scaling to a unit diagonal, so that units
   do not matter. */
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
    return spari_cholesky(6, scaled) ? "not positive definite" : NULL;
}

int spar_beam_set_sections(spar_member *beam, int64_t n, const double *eta, const double *stiffness,
                           const double *mass) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_beam(beam, __func__));
    spar_session *session = beam->session;
    SPARI_REQUIRE(session, n >= 1 && n <= SPARI_MOST, SPAR_ERR_ARGUMENT,
                  "%s: '%s': %lld sections; give at least 1, at most 2^40", __func__, beam->name, (long long)n);
    SPARI_TRY(spari_need_eta(session, __func__, beam->name, n, eta, SPARI_INCREASING));
    SPARI_TRY(spari_need_finite(session, __func__, beam->name, "stiffness", 36 * n, stiffness));
    if (mass) {
        SPARI_TRY(spari_need_finite(session, __func__, beam->name, "mass", 36 * n, mass));
    }
    for (int64_t i = 0; i < n; i++) {
        const char *wrong = spari_stiffness_fault(stiffness + 36 * i);
        SPARI_REQUIRE(session, !wrong, SPAR_ERR_ARGUMENT, "%s: '%s': the stiffness of section %lld is %s", __func__,
                      beam->name, (long long)i, wrong);
        double m, c[3], J[6];
        wrong = mass ? spari_mass_split(mass + 36 * i, &m, c, J) : NULL;
        SPARI_REQUIRE(session, !wrong, SPAR_ERR_ARGUMENT,
                      "%s: '%s': the mass of section %lld is not that of a rigid section: %s", __func__, beam->name,
                      (long long)i, wrong);
    }
    double *copies[3] = {spari_copy(eta, n), spari_copy(stiffness, 36 * n), mass ? spari_copy(mass, 36 * n) : NULL};
    if (!copies[0] || !copies[1] || (mass && !copies[2])) {
        free(copies[0]), free(copies[1]), free(copies[2]);
        return spari_fail(session, SPAR_ERR_MEMORY, "%s: '%s': no memory for the sections", __func__, beam->name);
    }
    spari_beam *b = beam->beam;
    free(b->section_eta), free(b->stiffness), free(b->mass);
    b->section_eta = copies[0], b->stiffness = copies[1], b->mass = copies[2];
    b->section_count = n;
    return SPAR_OK;
}

int spar_beam_set_quadrature(spar_member *beam, int rule, int points) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_beam(beam, __func__));
    SPARI_REQUIRE(beam->session, rule >= SPAR_QUADRATURE_GAUSS && rule <= SPAR_QUADRATURE_SECTIONS, SPAR_ERR_ARGUMENT,
                  "%s: '%s': quadrature rule %d is not known; see SPAR_QUADRATURE_*", __func__, beam->name, rule);
    SPARI_REQUIRE(beam->session, points == 0 || (points >= (rule == SPAR_QUADRATURE_LOBATTO ? 2 : 1) && points <= 512),
                  SPAR_ERR_ARGUMENT,
                  "%s: '%s': %d quadrature points; give 1 (Lobatto 2) to 512, or 0 for as many as the element needs",
                  __func__, beam->name, points);
    beam->beam->rule = rule;
    beam->beam->points = points;
    return SPAR_OK;
}

int spar_beam_set_damping(spar_member *beam, const double mu[6]) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_beam(beam, __func__));
    SPARI_TRY(spari_need_finite(beam->session, __func__, beam->name, "mu", 6, mu));
    int any = 0;
    for (int i = 0; i < 6; i++) {
        SPARI_REQUIRE(beam->session, mu[i] >= 0, SPAR_ERR_ARGUMENT, "%s: '%s': mu[%d] is negative; give a number >= 0",
                      __func__, beam->name, i);
        any |= mu[i] > 0;
    }
    memcpy(beam->beam->mu, mu, sizeof beam->beam->mu);
    beam->beam->damped = any;
    return SPAR_OK;
}

int spar_beam_set_mass_damping(spar_member *beam, double alpha) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_beam(beam, __func__));
    SPARI_REQUIRE(beam->session, isfinite(alpha) && alpha >= 0, SPAR_ERR_ARGUMENT,
                  "%s: '%s': alpha is %g; give a number >= 0, 1/s", __func__, beam->name, alpha);
    beam->beam->mass_damping = alpha;
    return SPAR_OK;
}

int spar_member_set_placement(spar_member *member, const double x[3], const double q[4]) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_open(member, __func__));
    SPARI_TRY(check_place(member->session, __func__, member->name, x, q));
    set_place(member, x, q);
    return SPAR_OK;
}

int spar_member_set_root(spar_member *member, int kind) {
    SPARI_TRY(spari_need_open(member, __func__));
    SPARI_REQUIRE(member->session, kind >= SPAR_ROOT_FREE && kind <= SPAR_ROOT_DRIVEN, SPAR_ERR_ARGUMENT,
                  "%s: '%s': root condition %d is not known; see SPAR_ROOT_*", __func__, member->name, kind);
    member->root = kind;
    return SPAR_OK;
}

int spar_member_set_external(spar_member *member, int on) {
    SPARI_TRY(spari_need_open(member, __func__));
    member->external = on != 0;
    return SPAR_OK;
}

int spar_member_set_effects(spar_member *member, int switch_on, int switch_off) {
    SPARI_GUARD_ENVIRONMENT;
    const int all = SPAR_EFFECT_INERTIA | SPAR_EFFECT_GYROSCOPIC | SPAR_EFFECT_GRAVITY | SPAR_EFFECT_DAMPING |
                    SPAR_EFFECT_FLUID_MOMENT | SPAR_EFFECT_FLUID_HISTORY | SPAR_EFFECT_WORK | SPAR_EFFECT_MASSES |
                    SPAR_EFFECT_FOUNDATION | SPAR_EFFECT_PRETENSION,
              large_rotation = 16, given = switch_on | switch_off; /* the bit 16 stays free */
    SPARI_TRY(spari_need_open(member, __func__));
    SPARI_REQUIRE(member->session, !(given & large_rotation), SPAR_ERR_ARGUMENT,
                  "%s: '%s': large rotation (16) is not an effect: SPAR_FIDELITY_EXACT always includes large "
                  "rotations; remove this bit; for a linear beam use SPAR_FIDELITY_LINEAR (spar_member_set_fidelity)",
                  __func__, member->name);
    SPARI_REQUIRE(member->session, (given & ~all) == 0, SPAR_ERR_ARGUMENT,
                  "%s: '%s': unknown effect bits 0x%x; see SPAR_EFFECT_*", __func__, member->name,
                  (unsigned)(given & ~all));
    SPARI_REQUIRE(member->session, (switch_on & switch_off) == 0, SPAR_ERR_ARGUMENT,
                  "%s: '%s': effect bits 0x%x are to be on and off; give each bit once", __func__, member->name,
                  (unsigned)(switch_on & switch_off));
    member->effects_on = switch_on;
    member->effects_off = switch_off;
    return SPAR_OK;
}

int spar_member_set_owner(spar_member *member, int rank) {
    SPARI_TRY(spari_need_open(member, __func__));
    int size = spari_comm_size(member->session->ranks.comm);
    SPARI_REQUIRE(member->session, rank >= 0 && rank < size, SPAR_ERR_ARGUMENT,
                  "%s: '%s': there is no rank %d; the session has %d", __func__, member->name, rank, size);
    member->owner = rank;
    member->owner_given = 1;
    return SPAR_OK;
}

/* ---- getters ---- */

int spar_beam_get_elements(const spar_member *beam, int *elements, int *nodes_per_element) {
    SPARI_TRY(spari_need_any_beam(beam, __func__));
    SPARI_GIVE(elements, beam->mesh.elements);
    SPARI_GIVE(nodes_per_element, beam->mesh.per_element);
    return SPAR_OK;
}

int spar_beam_get_quadrature(const spar_member *beam, int *rule, int *points) {
    SPARI_TRY(spari_need_any_beam(beam, __func__));
    SPARI_GIVE(rule, spari_beam_rule(beam->beam));
    SPARI_GIVE(points, beam->beam->points);
    return SPAR_OK;
}

int spar_beam_get_axis(const spar_member *beam, int64_t *n, int64_t capacity, double *eta, double *xyz, double *twist) {
    SPARI_TRY(spari_need_any_beam(beam, __func__));
    SPARI_TRY(spari_need_capacity(beam->session, __func__, capacity));
    const spari_beam *b = beam->beam;
    SPARI_GIVE(n, b->axis_count);
    spari_fill(capacity, eta, b->axis_count, b->eta);
    spari_fill(3 * capacity, xyz, 3 * b->axis_count, b->xyz);
    spari_fill(capacity, twist, b->twist ? b->axis_count : 0, b->twist);
    return SPAR_OK;
}

int spar_beam_get_sections(const spar_member *beam, int64_t *n, int64_t capacity, double *eta, double *stiffness,
                           double *mass) {
    SPARI_TRY(spari_need_any_beam(beam, __func__));
    SPARI_TRY(spari_need_capacity(beam->session, __func__, capacity));
    const spari_beam *b = beam->beam;
    SPARI_GIVE(n, b->section_count);
    spari_fill(capacity, eta, b->section_count, b->section_eta);
    spari_fill(36 * capacity, stiffness, 36 * b->section_count, b->stiffness);
    spari_fill(36 * capacity, mass, b->mass ? 36 * b->section_count : 0, b->mass);
    return SPAR_OK;
}

int spar_beam_get_damping(const spar_member *beam, double mu[6]) {
    SPARI_TRY(spari_need_any_beam(beam, __func__));
    spari_give(mu, beam->beam->mu, 6);
    return SPAR_OK;
}

int spar_beam_get_mass_damping(const spar_member *beam, double *alpha) {
    SPARI_TRY(spari_need_any_beam(beam, __func__));
    SPARI_GIVE(alpha, beam->beam->mass_damping);
    return SPAR_OK;
}

int spar_member_get_placement(const spar_member *member, double x[3], double q[4]) {
    SPARI_TRY(spari_need_member(member, __func__));
    spari_give(x, member->placement.x, 3);
    spari_give(q, member->placement.q, 4);
    return SPAR_OK;
}

int spar_member_get_session(const spar_member *member, spar_session **session) {
    SPARI_TRY(spari_need_member(member, __func__));
    SPARI_REQUIRE(member->session, session, SPAR_ERR_ARGUMENT, "%s: '%s': the pointer to the session is NULL", __func__,
                  member->name);
    *session = member->session;
    return SPAR_OK;
}

const char *spar_member_get_name(const spar_member *member) {
    return member ? member->name : "";
}

int spar_member_get_root(const spar_member *member, int *kind) {
    SPARI_TRY(spari_need_member(member, __func__));
    SPARI_GIVE(kind, member->root);
    return SPAR_OK;
}

int spar_member_get_external(const spar_member *member, int *on) {
    SPARI_TRY(spari_need_member(member, __func__));
    SPARI_GIVE(on, member->external);
    return SPAR_OK;
}

int spar_member_get_effects(const spar_member *member, int *effects) {
    SPARI_TRY(spari_need_committed(member, __func__));
    SPARI_GIVE(effects, member->effects);
    return SPAR_OK;
}

int spar_member_get_fidelity(const spar_member *member, int *kind, int64_t *modes) {
    SPARI_TRY(spari_need_member(member, __func__));
    SPARI_GIVE(kind, member->fidelity);
    SPARI_GIVE(modes, member->modes);
    return SPAR_OK;
}

int spar_member_get_owner(const spar_member *member, int *rank) {
    SPARI_TRY(spari_need_member(member, __func__));
    SPARI_GIVE(rank, member->owner);
    return SPAR_OK;
}
