/* One coupling step: begin (predict), solve, check, accept or reject. */
#include "step.h"
#include "../assembly/assembly.h"
#include "../base/environment.h"
#include "../coupling/coupling.h"
#include "../exchange/rank_loads_and_motion.h"
#include "../fluid/fluid.h"
#include "../member/added_mass.h"
#include "../member/added_mass_fit.h"
#include "../member/check_arguments.h"
#include "../member/joint.h"
#include "../member/mean_acceleration.h"
#include "../solve/life.h"
#include "../solve/work.h"
#include "../time/fidelity.h"
#include "../time/substeps.h"
#include "callbacks.h"
#include "initial_accelerations.h"
#include "step_control.h"
#include "work_shares.h"

#include "../comm/enter.h"

#include "../math/predictor.h"

#include <math.h>
#include <string.h>

static const char *const phase_name[] = {"no step is in progress", "the step has begun but is not solved",
                                         "the step is solved but not checked", "the step is checked"};

static int wrong_phase(spar_session *s, const char *call, const char *cure) {
    return spari_fail(s, SPAR_ERR_STATE, "%s: %s; %s", call, phase_name[s->state.phase], cure);
}

/* ---- begin ---- */

/* Whether fluids are to see mean accelerations from the step dt on (member/mean_acceleration.h). */
static int is_uneven(const spar_session *s, double dt) {
    return s->clock.uneven[0] || !spari_steps_even(&s->clock, dt) || spari_substeps_rotate_fast(s, dt);
}

/* A step that the clock does not resolve, or beside which the last one is so long that accelerations by differences are
   rounding: what a host is left with at the end of a window. */
static int check_least(spar_session *s, const char *call, double dt) {
    static const double part = 1e-12;
    const double t = s->clock.time, last = s->clock.step > 0 ? s->clock.dt_last[0] : 0;
    SPARI_REQUIRE(s, dt >= part * last && (t == 0 || t + dt != t), SPAR_ERR_ARGUMENT,
                  "%s: dt is %g s at t = %.9g s, after a step of %g s: the clock and accelerations do not resolve it; "
                  "add what is left of a window to the step before, or leave it out",
                  call, dt, t, last);
    return SPAR_OK;
}

/* uneven: result of is_uneven. */
static int check_begin(spar_session *s, const char *call, double dt, int uneven) {
    if (s->state.phase != SPARI_IDLE) {
        return wrong_phase(s, call, "accept or reject it first");
    }
    SPARI_TRY(spari_need_dt(s, call, dt));
    SPARI_REQUIRE(s, isfinite(s->clock.time + dt), SPAR_ERR_ARGUMENT,
                  "%s: the clock is at %g s and cannot advance by %g s; give a smaller dt", call, s->clock.time, dt);
    SPARI_TRY(check_least(s, call, dt));
    SPARI_TRY(spari_need_all_committed(s, call));
    SPARI_TRY(spari_session_mapped(s, call));
    const int mean = s->integrator.substeps > 1 || uneven;
    for (spar_member *m = s->members; m && mean; m = m->next) {
        SPARI_TRY(spari_named(s, call, spari_means_make(m)));
    }
    SPARI_TRY(spari_named(s, call, spari_threads_prepare(s)));
    return s->clock.started ? SPAR_OK : spari_session_pushes(s, call);
}

typedef struct load_extrapolation {
    const spar_member *m;
    int order;
    double w[3];
} load_extrapolation;

static void predict_nodes_loads(void *context, int64_t from, int64_t to) {
    const load_extrapolation *t = context;
    const spar_member *m = t->m;
    for (int64_t i = 6 * from; i < 6 * to; i++) {
        double f = t->w[0] * m->load.history[0][i];
        for (int k = 1; k <= t->order; k++) {
            f += t->w[k] * m->load.history[k][i];
        }
        m->load.used[i] = f;
    }
}

/* A step as it begins for a member. */
typedef struct step_begun {
    const spar_session *s;
    int order;
    double dt;
} step_begun;

static void begin_member(spar_member *m, const void *context) {
    const step_begun *t = context;
    if ((m->root == SPAR_ROOT_DRIVEN || m->kind == SPARI_POINT) &&
        !m->state.drive_given) { /* the root stays in place */
        const double rest[6] = {0};
        m->drive[1] = spari_pose_of(m->drive[0].q, rest, rest);
    }
    /* the loads by the polynomial of `order` through t^n, t^{n-1}, t^{n-2}; order 1 is (T11) of
       docs/explanation/theory.md */
    load_extrapolation loads = {.m = m, .order = t->order};
    spari_predictor(t->order, t->dt, t->s->clock.dt_last, loads.w);
    spari_member_spread(m, m->nodes, predict_nodes_loads, &loads);
    if (m->added) {
        spari_added_predict(m, loads.w, t->dt);
    }
    spari_learned_begin(m);
    spari_member_begin(m);
}

/* Loads pushed before the clock runs are those at t^0. */
static int begin_loads(spar_session *s) {
    int pushed = 0;
    SPARI_TRY(spari_session_exchange_loads(s, &pushed));
    s->state.past = pushed ? s->state.past : -1; /* zeros that nobody has pushed are nothing to extrapolate from */
    for (spar_member *m = s->members; m; m = m->next) {
        spari_session_take_loads(s, m, m->load.history[0]);
        memcpy(m->load.before, m->load.pushed, (size_t)(6 * m->nodes) * sizeof(double));
        if (m->work) {
            spari_work_begin(m);
        }
    }
    return SPAR_OK;
}

int spar_step_begin(spar_session *session, double dt) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_callback_refuse(session, __func__));
    spar_session *s = session;
    int anew = !spari_coupling_fits(s), uneven = is_uneven(s, dt);
    const spari_agreed must_agree[] = {spari_real("dt", dt), spari_whole("calls that set the coupling", anew),
                                       spari_hash("springs, loads or drives of joints", spari_joints_setting(s))};
    SPARI_TRY(spari_enter_agreed(s, __func__, must_agree, 3, check_begin(s, __func__, dt, uneven)));
    if (!s->clock.started) {
        SPARI_TRY(spari_named(s, __func__, spari_solvers_place(s, __func__)));
    }
    if (anew) { /* discards the report of the coupling: done after all checks that may refuse */
        SPARI_TRY(spari_named(s, __func__, spari_enter(s, "coupling", spari_coupling_prepare(s))));
        s->coupling.stale = 0;
    }
    if (!s->clock.started || !spari_session_is_sealed(s)) {
        SPARI_TRY(spari_named(s, __func__, spari_session_seal(s, SPAR_OK)));
    }
    if (!s->clock.started) {
        SPARI_TRY(begin_loads(s));
    }
    int order = s->state.past > 0 ? s->state.past : 0;
    spari_threads_each(s, begin_member, &(step_begun){s, order, dt});
    for (spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        spari_assembly_begin(a);
    }
    spari_joints_each(s, spari_joint_hold);
    for (spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        spari_fluid_begin(f, order, dt, s->clock.dt_last);
    }
    s->clock.dt = dt;
    s->clock.uneven[1] = uneven;
    s->state.order = order;
    s->state.iteration = 0;
    s->state.iterating = 0;
    s->state.failed = 0;
    spari_coupling_begin(s);
    s->state.phase = SPARI_BEGUN;
    s->clock.begun++;
    s->clock.started = 1;
    return SPAR_OK;
}

int spar_step_begin_initial(spar_session *session, double dt) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_callback_refuse(session, __func__));
    return spari_start_begin(session, __func__, dt);
}

/* ---- solve ---- */

static void solved_member(spar_member *m, const void *unused) {
    (void)unused;
    spari_member_solved(m, m->load.used);
    if (m->means) {
        spari_means_find(m);
    }
    if (m->added) {
        spari_added_see(m);
        spari_added_correct(m, -1, m->load.solved[1]);
    }
}

static void reject_joints(spar_session *s) {
    spari_joints_each(s, spari_joint_reject);
    for (spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        spari_assembly_reject(a);
    }
}

int spar_step_solve(spar_session *session) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_callback_refuse(session, __func__));
    spar_session *s = session;
    int status = s->state.phase == SPARI_IDLE ? wrong_phase(s, __func__, "call spar_step_begin first") : SPAR_OK;
    SPARI_TRY(spari_enter(s, __func__, status));
    if (s->state.static_solution) {
        return spari_start_solve(s, __func__);
    }
    s->state.rough = spari_coupling_is_rough(s);
    s->state.renew = spari_coupling_renews_tangents(s);
    spari_budget_begin(s);
    status = spari_threads_solve(s);
    status = spari_session_share_motion(s, status);
    if (status != SPAR_OK) { /* t^n is unchanged; discards the failed iterate */
        for (spar_member *m = s->members; m; m = m->next) {
            if (m->row->moves) {
                spari_member_reject(m);
            }
        }
        reject_joints(s);
        s->state.phase = SPARI_BEGUN;
        return spari_coupling_solve_failed(s, __func__, spari_named(s, __func__, status));
    }
    spari_threads_each(s, solved_member, NULL);
    s->state.failed = 0;
    s->state.phase = SPARI_SOLVED;
    return SPAR_OK;
}

/* ---- check ---- */

/* status: of what this rank's host has done since the solution */
static int check_iteration(spar_session *s, const char *call, int status, int *done) {
    int ended = 0, solved = s->state.phase == SPARI_SOLVED;
    if (s->state.phase != SPARI_SOLVED) {
        status = wrong_phase(s, call, "call spar_step_solve, then push, then check");
    } else if (!done) {
        status = spari_fail(s, SPAR_ERR_ARGUMENT, "%s: done is NULL", call);
    } else if (status == SPAR_OK) {
        status = spari_session_pushes(s, call);
    }
    status = spari_enter(s, call, status);
    if (status != SPAR_OK) {
        /* the same on all ranks, because they were in this call */
        s->state.failed = s->state.failed || (solved && status != SPAR_ERR_COMM);
        return status;
    }
    s->state.failed = 1; /* until everything below has succeeded */
    SPARI_TRY(spari_session_exchange_loads(s, NULL));
    for (spar_member *m = s->members; m; m = m->next) {
        spari_session_take_loads(s, m, m->load.pushed);
        if (!s->state.static_solution) {
            spari_learned_note(m, s->state.iteration + 1);
        }
        if (m->added && !s->state.static_solution) {
            spari_added_correct(m, 1, m->load.pushed);
        }
    }
    s->state.iteration++;
    s->state.phase = SPARI_CHECKED;
    SPARI_TRY(spari_coupling_check(s, call, &ended));
    s->state.failed = 0;
    s->state.iterating = !ended;
    *done = ended;
    return SPAR_OK;
}

int spar_step_check(spar_session *session, int *done) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_callback_refuse(session, __func__));
    return check_iteration(session, __func__, SPAR_OK, done);
}

/* ---- accept and reject ---- */

/* Whether it is an external member with loads from joints and none from fluids. */
static int has_joints_alone(const spar_member *m) {
    int alone = m->external && m->session->joints;
    for (const spar_fluid *f = m->session->fluids; f && alone; f = spari_fluid_next(f)) {
        alone = spari_fluid_member(f) != m;
    }
    return alone;
}

static void shift_history(spar_member *m, const void *session) {
    const spar_session *s = session;
    /* a step that was never checked has the loads of its solution, and those of joints */
    if (s->state.phase != SPARI_CHECKED && has_joints_alone(m)) {
        memset(m->load.pushed, 0, (size_t)(6 * m->nodes) * sizeof(double));
        spari_joints_on_external(m, m->load.pushed);
    } else if (s->state.phase != SPARI_CHECKED) {
        memcpy(m->load.pushed, m->load.used, (size_t)(6 * m->nodes) * sizeof(double));
    }
    if (m->added) {
        spari_added_correct(m, -1, m->load.pushed);
        spari_added_accept(m);
    }
    spari_history_shift(m->load.history, 6 * m->nodes, s->coupling.predictor, m->load.pushed);
}

/* Loads that move nothing have no weight in the stop test of the coupling, and may be those predicted. In reactions and
   work the loads pushed last replace them: at the constrained root, and at all nodes of a member without unknowns. */
static void take_idle_loads(spar_member *m) {
    const int moves = m->row->unknowns && m->row->unknowns(m) > 0;
    const int64_t idle = !m->row->reaction ? 0 : moves ? spari_member_constrained(m) : 6 * m->nodes;
    for (int64_t i = 0; i < idle; i++) {
        m->load.solved[1][i] = m->load.dead[i] + m->load.pushed[i];
    }
}

static void accept_member(spar_member *m, const void *session) {
    if (((const spar_session *)session)->state.phase == SPARI_CHECKED) {
        take_idle_loads(m);
    }
    spari_member_accept(m);
}

/* Puts a sufficiently known added mass into the equations of the next step. */
static void learn_added(spar_session *s) {
    int fresh = 0;
    for (spar_member *m = s->members; m; m = m->next) {
        int other = spari_member_learn(m);
        if (other && m->assembly) {
            spari_assembly_forget(m->assembly);
        }
        fresh |= other;
    }
    if (fresh) {
        spari_coupling_forget(s);
    }
}

/* Steps of members without inertia are equilibria one after the other. */
static void warn_divergence(spar_session *s, const char *call) {
    int moves = 0;
    for (const spar_member *m = s->members; m; m = m->next) {
        moves |= m->external || (m->effects & SPAR_EFFECT_INERTIA) != 0;
    }
    if (!moves && !s->state.trial && !s->state.divergence_told) {
        s->state.divergence_told = spari_session_warn_divergence(s, call);
    }
}

int spar_step_accept(spar_session *session) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_callback_refuse(session, __func__));
    spar_session *s = session;
    int status = SPAR_OK;
    if (s->state.phase != SPARI_CHECKED && s->state.phase != SPARI_SOLVED) {
        status = wrong_phase(s, __func__, "begin and solve a step first");
    } else if (s->state.failed) {
        status = spari_fail(s, SPAR_ERR_STATE,
                            "%s: the last spar_step_check failed, so loads and motion do not match; if a push was "
                            "refused, push and check again, otherwise solve again or reject the step",
                            __func__);
    } else if (s->state.phase == SPARI_SOLVED) {
        status = spari_session_pushes(s, __func__);
    }
    SPARI_TRY(spari_enter(s, __func__, status));
    if (s->state.static_solution) {
        spari_start_accept(s);
        return SPAR_OK;
    }
    warn_divergence(s, __func__);
    spari_coupling_accept(s);
    spari_joints_each(s, spari_work_of_joint);
    spari_threads_each(s, shift_history, s);
    spari_step_control_accept(s);
    spari_threads_each(s, accept_member, s);
    for (spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        spari_assembly_accept(a);
    }
    spari_joints_each(s, spari_joint_accept);
    spari_fluids_each(s, spari_fluid_accept);
    learn_added(s);
    s->state.past = s->state.past < s->coupling.predictor ? s->state.past + 1 : s->coupling.predictor;
    spari_clock_tick(&s->clock, s->clock.dt);
    s->clock.step++;
    s->clock.uneven[0] = s->clock.uneven[1];
    memcpy(s->gravity_before, s->gravity, sizeof s->gravity_before);
    s->clock.dt_last[1] = s->clock.dt_last[0];
    s->clock.dt_last[0] = s->clock.dt;
    for (spar_member *m = s->members; m; m = m->next) {
        spari_member_tell(m);
    }
    s->state.phase = SPARI_IDLE;
    return SPAR_OK;
}

/* Local: executed on all ranks when the step ends on all of them. */
static void reject(spar_session *s) {
    if (s->state.static_solution) {
        spari_start_reject(s);
        return;
    }
    spari_coupling_reject(s);
    spari_step_control_reject(s);
    s->clock.uneven[1] = s->clock.uneven[0];
    for (spar_member *m = s->members; m; m = m->next) {
        spari_member_reject(m);
        spari_learned_begin(m);
        memcpy(m->load.pushed, s->clock.step > 0 ? m->load.history[0] : m->load.before,
               (size_t)(6 * m->nodes) * sizeof(double));
    }
    reject_joints(s);
    spari_fluids_each(s, spari_fluid_reject);
    s->state.phase = SPARI_IDLE;
    s->clock.started = s->clock.step > 0;
    s->state.past = s->state.past > 0 ? s->state.past : 0;
}

int spar_step_reject(spar_session *session) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_callback_refuse(session, __func__));
    spar_session *s = session;
    int status = s->state.phase == SPARI_IDLE ? wrong_phase(s, __func__, "no step is in progress to reject") : SPAR_OK;
    SPARI_TRY(spari_enter(s, __func__, status));
    reject(s);
    return SPAR_OK;
}

/* ---- the whole step ---- */

static int solve_for(spar_session *s, const char *call) {
    if (!s->state.static_solution) {
        return spar_step_solve(s);
    }
    SPARI_TRY(spari_enter(s, call, SPAR_OK));
    return spari_start_solve(s, call);
}

static int iterate(spar_session *s, const char *call, spar_fluid_solver solve, void *context) {
    int done = 0;
    while (!done) {
        SPARI_TRY(solve_for(s, call));
        int status = spari_callback_run(s, call, solve, s->state.static_solution ? 0 : s->clock.dt, context);
        if (status == SPAR_ERR_COMM) {
            return status;
        }
        if (spari_joints_hold_prescribed(
                s)) { /* the host may have moved tied members: joints' loads are of that motion */
            int moved = 0;
            SPARI_TRY(spari_enter(s, call, status));
            SPARI_TRY(spari_session_moved(s, &moved));
            SPARI_TRY(moved ? solve_for(s, call) : SPAR_OK);
        }
        SPARI_TRY(check_iteration(s, call, status, &done));
    }
    return SPAR_OK;
}

int spari_step_run(spar_session *s, const char *call, spar_fluid_solver solve, void *context) {
    int status = iterate(s, call, solve, context);
    if (status != SPAR_OK && status != SPAR_ERR_COMM && spar_step_reject(s) != SPAR_OK) {
        status = SPAR_ERR_COMM; /* a step in progress can be rejected whenever all ranks are together */
    }
    if (status == SPAR_ERR_COMM) { /* the ranks are in different calls and must not wait for each other again */
        reject(s);
    }
    return status;
}

/* Performs a begun step to its end. */
static int run_begun(spar_session *s, const char *call, spar_fluid_solver solve, void *context, int *iterations) {
    int status = spari_step_run(s, call, solve, context);
    SPARI_GIVE(iterations, s->state.iteration);
    SPARI_TRY(status);
    status = spar_step_accept(s);
    if (status == SPAR_ERR_COMM) {
        reject(s);
    }
    return status;
}

int spar_step(spar_session *session, double dt, spar_fluid_solver solve, void *context, int *iterations) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_callback_refuse(session, __func__));
    SPARI_TRY(spar_step_begin(session, dt));
    return run_begun(session, __func__, solve, context, iterations);
}

int spar_session_solve_initial(spar_session *session, double dt, spar_fluid_solver solve, void *context,
                               int *iterations) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_callback_refuse(session, __func__));
    SPARI_TRY(spari_start_begin(session, __func__, dt));
    return run_begun(session, __func__, solve, context, iterations);
}
