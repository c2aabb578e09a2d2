/* Consistent initial conditions: accelerations and fluid loads at t^0 that satisfy M a + ... = F(q, v, a). Iterated
   like a step, with the members' equations at t^0 instead of their integration to t^{n+1}; time does not advance. */
#include "initial_accelerations.h"

#include "../assembly/assembly.h"
#include "../comm/enter.h"
#include "../coupling/coupling.h"
#include "../exchange/rank_loads_and_motion.h"
#include "../fluid/fluid.h"
#include "../member/check_arguments.h"
#include "../member/joint.h"
#include "../solve/life.h"
#include "../time/fidelity.h"

#include <string.h>

static int check_start(spar_session *s, const char *call, double dt) {
    SPARI_TRY(spari_need_idle(s, call));
    SPARI_REQUIRE(s, s->clock.step == 0, SPAR_ERR_STATE,
                  "%s: the clock is at t = %g; compute initial accelerations before the first step", call,
                  s->clock.time);
    SPARI_TRY(spari_need_dt(s, call, dt));
    SPARI_TRY(spari_need_all_committed(s, call));
    SPARI_TRY(spari_session_mapped(s, call));
    return spari_session_pushes(s, call);
}

static void copy_start_loads(const spar_member *m, const double *from, double *to) {
    memcpy(to, from, (size_t)(6 * m->nodes) * sizeof *to);
}

int spari_start_begin(spar_session *s, const char *call, double dt) {
    static const double last[2] = {1, 1};
    const spari_agreed must_agree[] = {spari_real("dt", dt),
                                       spari_hash("springs, loads or drives of joints", spari_joints_setting(s))};
    SPARI_TRY(spari_enter_agreed(s, call, must_agree, 2, check_start(s, call, dt)));
    SPARI_TRY(spari_named(s, call, spari_solvers_place(s, call)));
    int status = SPAR_OK;
    for (spar_member *m = s->members; m && status == SPAR_OK; m = m->next) {
        status = spari_member_begin_start(m);
    }
    SPARI_TRY(spari_named(s, call, spari_session_seal(s, status)));
    SPARI_TRY(spari_session_exchange_loads(s, NULL));
    int scheme = spari_coupling_scheme_of(s->coupling.scheme)->iterates ? s->coupling.scheme : SPAR_COUPLING_IQN_ILS;
    SPARI_TRY(spari_named(s, call, spari_coupling_suspend(s, scheme)));
    for (spar_member *m = s->members; m; m = m->next) {
        copy_start_loads(m, m->load.pushed, m->load.before);
        spari_session_take_loads(s, m, m->load.used);
    }
    for (spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        spari_fluid_begin(f, 0, 1, last);
    }
    s->clock.dt = dt;
    s->state.iteration = s->state.iterating = s->state.failed = 0;
    spari_coupling_begin(s);
    s->clock.started = s->state.static_solution = 1;
    s->state.phase = SPARI_BEGUN;
    return SPAR_OK;
}

/* From the same state every time. */
static int balance_members(spar_session *s) {
    int status = SPAR_OK;
    spari_joints_each(s, spari_joint_reject);
    for (spar_member *m = s->members; m; m = m->next) {
        copy_start_loads(m, m->load.used, m->load.history[0]);
        spari_member_again(m);
    }
    for (spar_member *m = s->members; m && status == SPAR_OK; m = m->next) {
        int own = !m->assembly && m->row->component && spari_fidelity_is_here(m);
        status = own ? spari_lone_balance(m, s->clock.dt) : SPAR_OK;
    }
    for (spari_assembly *a = s->assemblies; a && status == SPAR_OK; a = spari_assembly_next(a)) {
        status = spari_assembly_balance(a, s->clock.dt);
    }
    return status;
}

int spari_start_solve(spar_session *s, const char *call) {
    int status = balance_members(s);
    for (const spar_member *m = s->members; m && status == SPAR_OK; m = m->next) {
        int finite = spari_first_nonfinite(m->after.a, 6 * m->nodes) < 0;
        status =
            finite
                ? SPAR_OK
                : spari_fail(s, SPAR_ERR_NUMERIC,
                             "member '%s': its initial accelerations are not finite; check its loads and their units",
                             m->name);
    }
    status = spari_session_share_motion(s, status);
    for (spar_member *m = s->members; m; m = m->next) {
        if (status == SPAR_OK) {
            spari_member_solved(m, m->load.used);
        } else { /* discards the failed iterate */
            spari_member_again(m);
        }
    }
    s->state.failed = 0;
    s->state.phase = status == SPAR_OK ? SPARI_SOLVED : SPARI_BEGUN;
    return spari_coupling_solve_failed(s, call, spari_named(s, call, status));
}

static void end_start(spar_session *s) {
    s->state.phase = SPARI_IDLE;
    s->clock.started = s->state.static_solution = 0;
}

void spari_start_accept(spar_session *s) {
    int checked = s->state.phase == SPARI_CHECKED;
    for (spar_member *m = s->members; m; m = m->next) {
        if (!checked) {
            copy_start_loads(m, m->load.used, m->load.pushed);
        }
        copy_start_loads(m, m->load.pushed, m->load.history[0]);
        copy_start_loads(m, m->load.pushed, m->load.before);
        spari_member_end_start(m, 1);
    }
    spari_joints_each(s, spari_joint_end_start);
    spari_fluids_each(s, spari_fluid_commit_state);
    spari_coupling_keep(s);
    s->state.past = 0;
    end_start(s);
}

void spari_start_reject(spar_session *s) {
    for (spar_member *m = s->members; m; m = m->next) {
        copy_start_loads(m, m->load.before, m->load.pushed);
        copy_start_loads(m, m->load.before, m->load.history[0]);
        spari_member_end_start(m, 0);
    }
    spari_joints_each(s, spari_joint_reject);
    spari_fluids_each(s, spari_fluid_reject);
    spari_coupling_resume(s);
    end_start(s);
}

int spari_start_stands(const spar_session *s) {
    return s->state.phase == SPARI_IDLE && s->members && s->members->initial.acceleration;
}
