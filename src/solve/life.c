/* The life of a member: see life.h. */
#include "life.h"

#include "../base/environment.h"
#include "../base/thread_pool.h"

#include "../comm/comm.h"
#include "../math/rotation.h"
#include "../member/added_mass.h"
#include "../member/added_mass_fit.h"
#include "../member/applied_loads.h"
#include "../member/beam.h"
#include "../member/check_arguments.h"
#include "../member/mean_acceleration.h"
#include "../member/plane.h"
#include "../time/fidelity.h"
#include "work.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the motion at t^0 and the steps ---- */

static int rigid_field(spar_member *m) {
    const double *normal = spari_member_plane(m);
    double motion[6];
    memcpy(motion, m->initial.velocity[1], sizeof m->initial.velocity[1]);
    memcpy(motion + 3, m->initial.velocity[2], sizeof m->initial.velocity[2]);
    SPARI_TRY(spari_plane_take(m, "initial velocity", NULL, motion, NULL));
    const double *x0 = m->initial.velocity[0], *v0 = m->initial.velocity[1], *w = m->initial.velocity[2];
    for (int64_t i = 0; i < m->nodes; i++) {
        double r[3], *v = m->now.v + 6 * i, *a = m->now.a + 6 * i;
        for (int c = 0; c < 3; c++) {
            r[c] = m->xr[3 * i + c] + m->now.q[7 * i + c] - x0[c];
        }
        spari_cross(w, r, v);
        spari_cross(
            w, v,
            a); /* centripetal: that of a body in steady rotation; the solver replaces it by the balance of forces */
        for (int c = 0; c < 3; c++) {
            v[c] += v0[c];
            v[3 + c] = w[c];
            a[3 + c] = 0;
        }
    }
    if (normal) {
        spari_plane_project(normal, m->nodes, m->now.v);
        spari_plane_project(normal, m->nodes, m->now.a);
    }
    if (m->row->moves && m->root != SPAR_ROOT_DRIVEN) { /* what stands has no velocity */
        memset(m->now.v, 0, (size_t)spari_member_constrained(m) * sizeof(double));
        memset(m->now.a, 0, (size_t)spari_member_constrained(m) * sizeof(double));
    }
    int finite = spari_first_nonfinite(m->now.v, 6 * m->nodes) < 0 && spari_first_nonfinite(m->now.a, 6 * m->nodes) < 0;
    SPARI_REQUIRE(
        m->session, finite, SPAR_ERR_ARGUMENT,
        "member '%s': its initial velocities are not finite; check spar_member_set_initial_velocity and the units",
        m->name);
    return SPAR_OK;
}

static void copy_nodes(void *context, int64_t first, int64_t end) {
    const spari_motion *const *motion = context, *from = motion[0], *to = motion[1];
    size_t n = (size_t)(end - first);
    memcpy(to->q + 7 * first, from->q + 7 * first, n * 7 * sizeof *to->q);
    memcpy(to->v + 6 * first, from->v + 6 * first, n * 6 * sizeof *to->v);
    memcpy(to->a + 6 * first, from->a + 6 * first, n * 6 * sizeof *to->a);
}

static void copy_motion(const spar_member *m, const spari_motion *from, spari_motion *to) {
    const spari_motion *motion[2] = {from, to};
    spari_member_spread(m, m->nodes, copy_nodes, motion);
}

/* Before the first step, the accelerations count with which the search for consistent initial accelerations began,
   not those that it found. */
static void restart_solution(spar_member *m) {
    double *found = m->now.a;
    if (m->row->restart && spari_fidelity_is_here(m)) {
        m->now.a = m->initial.acceleration ? m->initial.acceleration : found;
        m->row->restart(m);
        m->now.a = found;
    }
}

static void forget_begun(spar_member *m) {
    free(m->initial.acceleration);
    m->initial.acceleration = NULL;
}

/* The motion at t^0 has changed: the latest iterate, the root and the solver start from it. */
void spari_member_restart(spar_member *m) {
    forget_begun(m);
    m->state.balanced[0] = m->state.balanced[1] = 0;
    spari_means_forget(m);
    copy_motion(m, &m->now, &m->after);
    for (int k = 0; k < (m->state.drive_given ? 1 : 2); k++) { /* where it is to be driven to stays */
        m->drive[k] = spari_pose_of(m->now.q, m->now.v, m->now.a);
    }
    restart_solution(m);
    if (m->added) {
        spari_added_restart(m);
    }
    if (m->work) {
        spari_work_restart(m);
    }
}

/* Loads of one kind and of another. */
typedef struct two_loads {
    const double *a, *b;
    double *to;
} two_loads;

static void copy_load_span(void *context, int64_t from, int64_t to) {
    const two_loads *t = context;
    memcpy(t->to + 6 * from, t->a + 6 * from, (size_t)(6 * (to - from)) * sizeof *t->to);
}

/* a's loads become b's */
static void copy_solved(spar_member *m, int a, int b) {
    spari_member_spread(m, m->nodes, copy_load_span, &(two_loads){.a = m->load.solved[a], .to = m->load.solved[b]});
}

static void add_load_span(void *context, int64_t from, int64_t to) {
    const two_loads *t = context;
    for (int64_t i = 6 * from; i < 6 * to; i++) {
        t->to[i] = t->a[i] + t->b[i];
    }
}

void spari_member_solved(spar_member *m, const double *fluid) {
    m->state.balanced[1] = 1;
    spari_member_spread(m, m->nodes, add_load_span, &(two_loads){m->load.dead, fluid, m->load.solved[1]});
}

int spari_member_check_rotations(const spar_member *m) {
    SPARI_REQUIRE(m->session, m->frame != SPARI_FRAME_LINEAR || !m->state.overturned, SPAR_ERR_NUMERIC,
                  "member '%s' is linear and rotates by pi relative to %s, the limit of rotation vectors; use "
                  "SPAR_FIDELITY_EXACT, or drive its root",
                  m->name, spari_member_root_is_prescribed(m) ? "its root" : "its reference");
    return SPAR_OK;
}

void spari_member_commit_state(spar_member *m) {
    copy_motion(m, &m->after, &m->now);
    copy_solved(m, 1, 0);
    spari_applied_accept(m);
    spari_member_restart(m);
    m->state.balanced[0] = m->state.balanced[1] = 1;
}

void spari_member_begin(spar_member *m) {
    if (m->row->begin && spari_fidelity_is_here(m)) {
        m->row->begin(m);
    }
}

void spari_member_accept(spar_member *m) {
    if (m->work) {
        spari_work_step(m);
    }
    if (m->means) {
        spari_means_accept(m);
    }
    copy_motion(m, &m->after, &m->now);
    copy_solved(m, 1, 0);
    m->state.balanced[0] = m->state.balanced[1];
    m->drive[0] = m->drive[1];
    m->state.drive_given = m->state.motion_given = 0;
    spari_applied_accept(m);
    m->state.dissipated += m->state.dissipated_step;
    m->state.dissipated_step = 0;
    forget_begun(m);
    if (m->row->accept && spari_fidelity_is_here(m)) {
        m->row->accept(m);
    }
}

/* So many halvings of a step are more than a jump of loads takes: dt does not resolve the motion. */
enum { MANY_HALVINGS = 32 };

static void tell_halvings(spar_member *m) {
    const spari_cuts *cuts = &m->state.cuts;
    if (cuts->halved < MANY_HALVINGS || cuts->begun != m->session->clock.begun || m->state.halvings_told ||
        m->session->state.trial) {
        return;
    }
    m->state.halvings_told = 1;
    spari_warn(m->session,
               "member '%s'%s: the step to t = %g was halved %d times, because Newton found no solution in longer "
               "parts, or one that gains energy: dt does not resolve the motion; use a smaller dt, and look for loads "
               "or prescribed motions that jump, a bent free member that rolls about its axis, and elements with too "
               "few nodes",
               m->name, m->assembly ? " and those connected to it" : "", m->session->clock.time, cuts->halved);
}

void spari_member_tell(spar_member *m) {
    if (m->row->accept && spari_fidelity_is_here(m)) {
        spari_beam_check_locking(m);
        tell_halvings(m);
    }
}

int spari_member_learn(spar_member *m) {
    if (!spari_learned_accept(m)) {
        return 0;
    }
    spari_member_put_learned(m);
    return 1;
}

void spari_member_put_learned(spar_member *m) {
    spari_learned_put(m);
    if (m->row->remass) {
        m->row->remass(m);
    }
}

void spari_member_reject(spar_member *m) {
    copy_motion(m, &m->now, &m->after);
    copy_solved(m, 0, 1);
    m->state.balanced[1] = m->state.balanced[0];
    m->state.motion_given = 0;
    m->state.dissipated_step = 0;
    spari_applied_at(m, 0);
    if (spari_gravity_changes(m->session)) { /* that of its end, whatever stage has failed */
        spari_member_gravity(m);
    }
    if (m->means) {
        spari_means_reject(m);
    }
    if (m->row->reject && spari_fidelity_is_here(m)) {
        m->row->reject(m);
    }
    if (m->session->clock.step == 0) { /* the first step's accelerations at t^0 depend on its dt */
        restart_solution(m);
    }
}

int spari_member_begin_start(spar_member *m) {
    if (!m->initial.acceleration) {
        m->initial.acceleration = spari_copy(m->now.a, 6 * m->nodes);
        SPARI_REQUIRE(m->session, m->initial.acceleration, SPAR_ERR_MEMORY,
                      "no memory for the initial accelerations of '%s'", m->name);
    }
    return SPAR_OK;
}

void spari_member_again(spar_member *m) {
    if (m->row->moves) {
        spari_member_reject(m);
    } else if (m->state.motion_given) {
        memcpy(m->now.a, m->after.a, (size_t)(6 * m->nodes) * sizeof(double));
    }
}

void spari_member_end_start(spar_member *m, int found) {
    const double *a = found ? m->after.a : m->row->moves ? m->now.a : m->initial.acceleration;
    memmove(m->now.a, a, (size_t)(6 * m->nodes) * sizeof(double));
    if (found) {
        copy_solved(m, 1, 0);
        m->state.balanced[0] = 1;
    }
    spari_member_reject(m);
    if (found && m->added) {
        spari_added_restart(m);
    }
    if (found && m->work) {
        spari_work_restart(m);
    }
}

int spar_member_set_initial_velocity(spar_member *member, const double x0[3], const double v0[3],
                                     const double omega[3]) {
    SPARI_GUARD_ENVIRONMENT;
    static const double zero[3] = {0, 0, 0};
    SPARI_TRY(spari_need_member(member, __func__));
    SPARI_REQUIRE(member->session, !member->session->clock.started, SPAR_ERR_STATE,
                  "%s: '%s': the clock has started; give initial velocities before the first step", __func__,
                  member->name);
    const double *in[3] = {x0 ? x0 : zero, v0 ? v0 : zero, omega ? omega : zero};
    const char *what[3] = {"x0", "v0", "omega"};
    for (int k = 0; k < 3; k++) {
        SPARI_TRY(spari_need_finite(member->session, __func__, member->name, what[k], 3, in[k]));
    }
    double old[3][3];
    memcpy(old, member->initial.velocity, sizeof old);
    for (int k = 0; k < 3; k++) {
        memcpy(member->initial.velocity[k], in[k], 3 * sizeof(double));
    }
    if (member->committed) {
        int status = rigid_field(member);
        if (status != SPAR_OK) {
            memcpy(member->initial.velocity, old, sizeof old);
            copy_motion(member, &member->after, &member->now);
            return status;
        }
        spari_member_restart(member);
    }
    member->initial.velocity_given = 1;
    return SPAR_OK;
}

/* ---- commit ---- */

static int check_complete(spar_member *m) {
    if (m->kind == SPARI_BEAM) {
        SPARI_REQUIRE(m->session, m->beam->eta || m->beam->node_x, SPAR_ERR_STATE,
                      "member '%s' has no axis; call spar_beam_set_axis or spar_beam_set_nodes", m->name);
        SPARI_REQUIRE(m->session, m->external || m->beam->stiffness, SPAR_ERR_STATE,
                      "member '%s' has no sections; call spar_beam_set_sections", m->name);
        SPARI_TRY(spari_point_masses_check(m));
        SPARI_REQUIRE(m->session,
                      m->beam->mass_damping == 0 || m->fidelity != SPAR_FIDELITY_RIGID ||
                          spari_member_root_is_prescribed(m),
                      SPAR_ERR_UNSUPPORTED,
                      "member '%s' is rigid with a free or pinned root, and mass-proportional damping would slow its "
                      "rigid motion; remove this damping, choose another fidelity, or fix or drive the root",
                      m->name);
    }
    SPARI_REQUIRE(m->session, !m->session->clock.started, SPAR_ERR_STATE,
                  "member '%s': the clock has started; commit members before the first step", m->name);
    return spari_fidelity_check(m);
}

/* The effects in force: those requested or implied, as far as the description has data for them. */
int spari_member_effects(const spar_member *m) {
    const int implied = SPAR_EFFECT_INERTIA | SPAR_EFFECT_GYROSCOPIC | SPAR_EFFECT_GRAVITY | SPAR_EFFECT_DAMPING |
                        SPAR_EFFECT_FLUID_MOMENT | SPAR_EFFECT_MASSES | SPAR_EFFECT_FOUNDATION | SPAR_EFFECT_PRETENSION;
    const int e = (implied | m->effects_on) & ~m->effects_off;
    const spari_fidelity *row = spari_fidelity_of(m);
    int massive = m->kind == SPARI_RIGID || (m->beam && m->beam->mass), solved = row->solved;
    int possible = SPAR_EFFECT_FLUID_MOMENT;
    possible |= solved && massive ? SPAR_EFFECT_INERTIA | SPAR_EFFECT_GRAVITY : 0;
    possible |= solved && massive && (e & SPAR_EFFECT_INERTIA) ? SPAR_EFFECT_GYROSCOPIC : 0;
    possible |= solved && m->beam && (m->beam->damped || m->beam->mass_damping > 0) ? SPAR_EFFECT_DAMPING : 0;
    possible |= solved && massive && m->beam && m->beam->point_masses.count > 0 ? SPAR_EFFECT_MASSES : 0;
    possible |= solved && m->beam && m->beam->springs.count > 0 ? SPAR_EFFECT_FOUNDATION : 0;
    possible |= solved && !row->whole && m->beam && m->beam->pretension.count > 0 ? SPAR_EFFECT_PRETENSION : 0;
    possible |= SPAR_EFFECT_FLUID_HISTORY | SPAR_EFFECT_WORK; /* unasked, a history comes with fluids of sections */
    return row->effects ? row->effects(m, e & possible) : e & possible;
}

static int make_node_arrays(spar_member *m) {
    for (int k = 0; k < SPARI_NODAL_COUNT; k++) {
        if (spari_nodal_table[k].order > m->session->coupling.predictor) {
            continue;
        }
        double *x = spari_zalloc(spari_nodal_table[k].width * m->nodes, sizeof *x);
        SPARI_REQUIRE(m->session, x, SPAR_ERR_MEMORY, "no memory for '%s'", m->name);
        *spari_nodal_array(m, k) = x;
    }
    return SPAR_OK;
}

void spari_member_release(spar_member *m) {
    spar_member built;
    spari_member_detach(m, &built);
    for (int k = 0; k < SPARI_NODAL_COUNT; k++) {
        free(*spari_nodal_array(&built, k));
    }
    SPARI_FREE(built.initial.acceleration, built.initial.acceleration_next);
    spari_work_free(built.work);
    spari_added_free(built.added);
    spari_means_free(built.means);
    spari_applied_free(built.load.applied);
    spari_applied_free(built.load.applied_next);
    spari_ramp_free(built.load.ramp);
    spari_ramp_free(built.load.ramp_next);
    spari_foundation_free(built.load.foundation);
    if (built.solution) {
        built.row->free(built.solution);
    }
    spari_body_free(built.body);
}

int spari_member_move(spar_member *m, int owner, void **before) {
    *before = m->solution;
    m->solution = NULL;
    m->owner = owner;
    SPARI_TRY(m->row->create(m));
    restart_solution(m);
    return SPAR_OK;
}

void spari_member_end_move(spar_member *m, int owner, void *before, int back) {
    void *not_wanted = back ? m->solution : before;
    if (not_wanted) {
        m->row->free(not_wanted);
    }
    if (back) {
        m->solution = before;
        m->owner = owner;
    }
}

void spari_member_detach(spar_member *m, spar_member *detached) {
    *detached = *m;
    for (int k = 0; k < SPARI_NODAL_COUNT; k++) {
        *spari_nodal_array(m, k) = NULL;
    }
    m->initial.acceleration = m->initial.acceleration_next = NULL;
    m->work = NULL;
    m->added = NULL;
    m->means = NULL;
    m->load.applied = m->load.applied_next = NULL;
    m->load.ramp = m->load.ramp_next = NULL;
    m->load.foundation = NULL;
    m->solution = NULL;
    m->body = NULL;
    m->assembly = NULL;
}

void spari_member_take_back(spar_member *m, const spar_member *detached) {
    spari_member_release(m);
    *m = *detached;
    spari_learned_take_back(m);
}

static int build_body(spar_member *m) {
    int damped = m->beam && (m->beam->damped || m->beam->mass_damping > 0) && (m->effects & SPAR_EFFECT_DAMPING);
    SPARI_TRY(m->kind == SPARI_BEAM ? spari_beam_build(m, m->row->massive, damped ? m->beam->mu : NULL, &m->body)
                                    : spari_rigid_build(m, &m->body));
    SPARI_TRY(damped ? spari_beam_mass_damping(m, m->body) : SPAR_OK);
    SPARI_REQUIRE(m->session, !spari_thread_pool_reserve(m->session->pool, spari_body_workspace_size(m->body)),
                  SPAR_ERR_MEMORY, "no memory for the worker threads of '%s'", m->name);
    m->body->gyroscopic = (m->effects & SPAR_EFFECT_GYROSCOPIC) != 0;
    spari_member_gravity(m);
    return SPAR_OK;
}

int spari_member_build(spar_member *m) {
    m->row = spari_fidelity_of(m);
    m->frame = m->row->frame;
    m->locks_from = INFINITY;
    SPARI_TRY(make_node_arrays(m));
    if (m->kind == SPARI_BEAM) {
        SPARI_TRY(spari_beam_place_nodes(m));
        if (m->row->solved && !m->row->whole) {
            spari_beam_find_locking(m);
        }
    } else {
        memcpy(m->xr, m->placement.x, sizeof m->placement.x);
        memcpy(m->qr, m->placement.q, sizeof m->placement.q);
    }
    for (int64_t i = 0; i < m->nodes; i++) {
        m->now.q[7 * i + 3] = 1;
    }
    if (m->initial.velocity_given) {
        SPARI_TRY(rigid_field(m));
    }
    if (m->row->solved) {
        SPARI_TRY(build_body(m));
        SPARI_TRY(spari_foundation_build(m));
        SPARI_TRY(spari_added_create(m, m->row->whole));
        SPARI_REQUIRE(m->session, spari_learned_create(m) == SPAR_OK, SPAR_ERR_MEMORY,
                      "no memory for the added mass of '%s'", m->name);
        SPARI_TRY(spari_means_keep(m));
    }
    if (m->row->create) {
        int status = m->row->create(m);
        SPARI_REQUIRE(m->session, status != SPAR_ERR_MEMORY, status, "no memory to solve for '%s'", m->name);
        SPARI_TRY(status);
    }
    if (m->effects & SPAR_EFFECT_WORK) {
        SPARI_TRY(spari_work_create(m));
    }
    spari_member_restart(m);
    return SPAR_OK;
}

void spari_member_gravity(spar_member *m) {
    if (m->body) {
        for (int i = 0; i < 3; i++) {
            m->body->gravity[i] = m->effects & SPAR_EFFECT_GRAVITY ? m->session->gravity[i] : 0;
        }
    }
}

int spar_member_commit(spar_member *member) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_member(member, __func__));
    spar_session *s = member->session;
    int status;
    if (member->committed) {
        status = spari_fail(s, SPAR_ERR_STATE, "%s: '%s' is committed already; commit a member once", __func__,
                            member->name);
    } else {
        status = check_complete(member);
        if (status == SPAR_OK) {
            member->effects = spari_member_effects(member);
            status = spari_member_build(member);
            if (status != SPAR_OK) {
                spari_member_release(member);
            }
        }
    }
    const spari_agreed must_agree[] = {spari_whole("positions of it in the order of creation", member->number),
                                       spari_whole("owners of it", member->owner),
                                       spari_given("owners of it (set or not)", member->owner_given),
                                       spari_hash("descriptions of it", spari_member_hash(member))};
    int agreed = spari_member_enter(member, __func__, must_agree, 4, status);
    if (agreed != SPAR_OK) {
        if (status == SPAR_OK) {
            spari_member_release(member);
        }
        return spari_named(s, __func__, agreed);
    }
    member->committed = 1;
    if (member->kind == SPARI_BEAM && member->row->solved && spari_comm_rank(s->ranks.comm) == 0) {
        spari_beam_tell_line(member);
        spari_beam_tell_plausible(member);
        if (!member->row->whole) {
            spari_beam_tell_locking(member);
        }
    }
    return SPAR_OK;
}

void spari_member_free(spar_member *member) {
    if (!member) {
        return;
    }
    spari_member_release(member);
    spari_beam_free(member->beam);
    SPARI_FREE(member->guess.eta, member->guess.value);
    spari_learned_free(member->learned);
    SPARI_FREE(member->joints, member->name, member);
}

int spar_member_set_motion(spar_member *member, const double *q, const double *v, const double *a) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_committed(member, __func__));
    spar_session *s = member->session;
    int64_t n = member->nodes;
    SPARI_REQUIRE(
        s, member->external || member->kind == SPARI_POINT, SPAR_ERR_STATE,
        "%s: spar solves '%s' itself; set the motion only of points and external members (spar_member_set_external)",
        __func__, member->name);
    SPARI_REQUIRE(s, s->state.phase != SPARI_IDLE || !s->clock.started, SPAR_ERR_STATE,
                  "%s: '%s': no step is in progress; give the motion at t^{n+1} after spar_step_begin", __func__,
                  member->name);
    if (q) {
        SPARI_TRY(spari_need_finite(s, __func__, member->name, "q", 7 * n, q));
        SPARI_TRY(spari_need_unit(s, __func__, member->name, "q", n, q + 3, 7));
    }
    if (v) {
        SPARI_TRY(spari_need_finite(s, __func__, member->name, "v", 6 * n, v));
    }
    if (a) {
        SPARI_TRY(spari_need_finite(s, __func__, member->name, "a", 6 * n, a));
    }
    spari_motion *to = s->state.phase == SPARI_IDLE ? &member->now : &member->after;
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
    if (s->state.phase == SPARI_IDLE) {
        spari_member_restart(member);
    } else {
        member->state.motion_given = 1;
    }
    return SPAR_OK;
}

int spar_member_drive(spar_member *member, const double q[7], const double v[6], const double a[6]) {
    SPARI_GUARD_ENVIRONMENT;
    static const double rest[6] = {0};
    SPARI_TRY(spari_need_committed(member, __func__));
    spar_session *s = member->session;
    SPARI_REQUIRE(s, member->kind == SPARI_POINT || (member->root == SPAR_ROOT_DRIVEN && !member->external),
                  SPAR_ERR_STATE,
                  "%s: the root of '%s' is not driven; call spar_member_set_root with SPAR_ROOT_DRIVEN before commit",
                  __func__, member->name);
    SPARI_REQUIRE(s, s->state.phase == SPARI_IDLE, SPAR_ERR_STATE,
                  "%s: '%s': a step is in progress; give the root's motion at its end before spar_step_begin", __func__,
                  member->name);
    SPARI_TRY(spari_need_finite(s, __func__, member->name, "q", 7, q));
    SPARI_TRY(spari_need_unit(s, __func__, member->name, "q", 1, q + 3, 7));
    const double *in[2] = {v ? v : rest, a ? a : rest};
    SPARI_TRY(spari_need_finite(s, __func__, member->name, "v", 6, in[0]));
    SPARI_TRY(spari_need_finite(s, __func__, member->name, "a", 6, in[1]));
    spari_pose to = spari_pose_of(q, in[0], in[1]);
    spari_quat_normalise(to.q + 3);
    SPARI_TRY(spari_plane_take(member, __func__, to.q, to.v, to.a));
    member->drive[1] = to;
    member->state.drive_given = 1;
    return SPAR_OK;
}
