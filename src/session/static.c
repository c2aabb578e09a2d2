/* Static equilibrium of one member, and of all members with the fluid. */
#include "../assembly/assembly.h"
#include "../base/environment.h"
#include "../comm/enter.h"
#include "../coupling/coupling.h"
#include "../coupling/schemes.h"
#include "../exchange/rank_loads_and_motion.h"
#include "../exchange/session_private.h"
#include "../fluid/fluid.h"
#include "../member/body.h"
#include "../member/check_arguments.h"
#include "../member/joint.h"
#include "../solve/life.h"
#include "../time/fidelity.h"
#include "callbacks.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- one member ---- */

/* Whether the member has a unique equilibrium that spar can solve. */
static int check_held(const spar_member *m, const char *call) {
    spar_session *s = m->session;
    SPARI_TRY(spari_need_committed(m, call));
    int loose =
        m->joint_count == 0 && (m->root == SPAR_ROOT_FREE || (m->root == SPAR_ROOT_PINNED && m->body && !m->body->C));
    SPARI_REQUIRE(
        s, !loose || !spari_fidelity_has_equilibrium(m), SPAR_ERR_STATE,
        "%s: '%s' is free to move as a rigid body; fix, pin or drive its root. The stiffness of a sea that it floats "
        "on is the fluid's, which spar does not know: let a floating body settle in steps, with dampers "
        "(spar_spring_create)",
        call, m->name);
    return SPAR_OK;
}

/* Whether m is solved together with a member (by joints, or the member itself); NULL: all are. */
static int is_with(const spar_member *member, const spar_member *m) {
    return !member || m == member || (m->assembly && m->assembly == member->assembly);
}

/* Whether two motions of a root differ in position or rate. */
static int differs(const spari_pose *a, const spari_pose *b) {
    return memcmp(a->q, b->q, sizeof a->q) != 0 || memcmp(a->v, b->v, sizeof a->v) != 0;
}

/* Roots at rest that have been driven already: the call was for the next step, and the host may take it for the state
   in which the equilibrium is. Told once for each such call of spar_member_drive. */
static void tell_drives(spar_session *s, const spar_member *only, const char *call) {
    static const double rest[6] = {0};
    for (spar_member *m = s->members; m; m = m->next) {
        if (is_with(only, m) && m->root == SPAR_ROOT_DRIVEN && m->state.drive_given == 1 &&
            memcmp(m->drive[0].v, rest, sizeof rest) == 0 && differs(&m->drive[0], &m->drive[1])) {
            m->state.drive_given = SPARI_DRIVE_TOLD;
            spari_warn(
                s,
                "%s: '%s' was driven before, which counts from the next step on; this equilibrium is that of its "
                "root at rest where it is; for steady rotation call spar_member_set_initial_velocity before",
                call, m->name);
        }
    }
}

static int check_member_static(const spar_member *m, const char *call, int load_steps) {
    spar_session *s = m->session;
    SPARI_TRY(spari_need_committed(m, call));
    SPARI_REQUIRE(s, s->state.phase == SPARI_IDLE, SPAR_ERR_STATE,
                  "%s: '%s': a step is in progress; accept or reject it first", call, m->name);
    SPARI_REQUIRE(s, load_steps >= 1 && load_steps <= SPARI_STATIC_MOST, SPAR_ERR_ARGUMENT,
                  "%s: '%s': %d load steps; give 1 to %d", call, m->name, load_steps, SPARI_STATIC_MOST);
    SPARI_REQUIRE(s, spari_fidelity_has_equilibrium(m), SPAR_ERR_UNSUPPORTED,
                  "%s: spar does not solve '%s', which is a point or an external member; solve a beam or a rigid body",
                  call, m->name);
    SPARI_TRY(check_held(m, call));
    return s->clock.started ? SPAR_OK : spari_session_pushes(s, call);
}

static const double *pushed(const spar_member *m) {
    return m->load.pushed;
}

static const double *used(const spar_member *m) {
    return m->load.used;
}

/* Solves the motion `after`, on the owners. only: one member with all that joints connect to it; NULL: all members. */
static int solve_all(spar_session *s, const spar_member *only, const double *(*fluid)(const spar_member *),
                     int load_steps, int onward) {
    int status = SPAR_OK;
    for (spar_member *m = s->members; m && status == SPAR_OK; m = m->next) {
        if (!is_with(only, m) || m->assembly || !spari_fidelity_has_equilibrium(m) || !spari_fidelity_is_here(m)) {
            continue;
        }
        if (m->row->equilibrium) {
            m->row->equilibrium(m);
        } else {
            status = spari_lone_static(m, fluid, load_steps, onward);
        }
        status = status == SPAR_OK ? spari_member_check_rotations(m) : status;
    }
    for (spari_assembly *a = s->assemblies; a && status == SPAR_OK; a = spari_assembly_next(a)) {
        if (only && only->assembly != a) {
            continue;
        }
        status = spari_assembly_static(a, fluid, load_steps, onward);
        for (const spar_member *m = s->members; m && status == SPAR_OK; m = m->next) {
            status = m->assembly == a ? spari_member_check_rotations(m) : SPAR_OK;
        }
    }
    SPARI_TRY(spari_session_share_motion(s, status));
    for (spar_member *m = s->members; m && !only; m = m->next) {
        spari_member_solved(m, m->load.used);
    }
    return SPAR_OK;
}

static void copy_loads(const spar_member *m, const double *from, double *to) {
    memcpy(to, from, (size_t)(6 * m->nodes) * sizeof *to);
}

/* Saves or loads the solver data of the owner's members, each with its length in front, to be restored if there is no
   equilibrium. Returns the length of all. only: as in solve_all. */
enum { COUNT, SAVE, LOAD };
static int64_t pass_state(spar_session *s, const spar_member *only, int mode, double *at) {
    int64_t n = 0;
    for (spar_member *m = s->members; m; m = m->next) {
        int64_t size = !is_with(only, m) ? -1 : mode == LOAD ? (int64_t)at[n] : spari_fidelity_state_size(m);
        if (size > 0 && mode == SAVE) {
            m->row->save(m, at + n + 1);
        } else if (size > 0 && mode == LOAD) {
            m->row->load(m, at + n + 1);
        }
        if (size >= 0 && mode == SAVE) {
            at[n] = (double)size;
        }
        n += 1 + size;
    }
    for (spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        int with = !only || only->assembly == a;
        int64_t size = !with ? -1 : mode == LOAD ? (int64_t)at[n] : spari_assembly_state_size(a);
        if (size > 0 && mode == SAVE) {
            spari_assembly_save(a, at + n + 1);
        } else if (size > 0 && mode == LOAD) {
            spari_assembly_load(a, at + n + 1);
        }
        if (size >= 0 && mode == SAVE) {
            at[n] = (double)size;
        }
        n += 1 + size;
    }
    return n;
}

static int save_state(spar_session *s, const spar_member *only, double **saved_state) {
    *saved_state = spari_zalloc(pass_state(s, only, COUNT, NULL), sizeof **saved_state);
    SPARI_REQUIRE(s, *saved_state, SPAR_ERR_MEMORY, "no memory to save the state of the members");
    (void)pass_state(s, only, SAVE, *saved_state);
    return SPAR_OK;
}

/* Makes the motion `after`, under the pushed loads, the state at t^n. */
static void commit(spar_session *s, const spar_member *only) {
    for (spar_member *m = s->members; m; m = m->next) {
        if (is_with(only, m)) {
            m->state.dissipated_step = 0;
            spari_member_solved(m, m->load.pushed);
            spari_member_commit_state(m);
            memcpy(s->gravity_before, s->gravity, sizeof s->gravity_before);
        }
    }
    for (spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        if (!only || only->assembly == a) {
            spari_assembly_commit_state(a);
        }
    }
}

/* Restores everything. only: as in solve_all. */
static void discard_static(spar_session *s, const spar_member *only, double *saved_state) {
    for (spar_member *m = s->members; m; m = m->next) {
        if (is_with(only, m)) {
            spari_member_reject(m);
            copy_loads(m, m->load.before, m->load.pushed);
        }
    }
    (void)pass_state(s, only, LOAD, saved_state);
    for (spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        spari_assembly_discard(a);
    }
}

static int find_member_equilibrium(spar_member *member, int load_steps) {
    spar_session *s = member->session;
    s->clock.begun++;
    spari_budget_begin(s);
    SPARI_TRY(s->clock.started ? SPAR_OK : spari_session_exchange_loads(s, NULL));
    for (spar_member *m = s->members; m && !s->clock.started; m = m->next) {
        if (is_with(member, m)) {
            spari_session_take_loads(s, m, m->load.pushed);
        }
    }
    return solve_all(s, member, pushed, load_steps, 0);
}

int spar_member_solve_static(spar_member *member, int load_steps) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, member, SPAR_ERR_ARGUMENT, "%s: the member is NULL; create it first", __func__);
    spar_session *s = member->session;
    const spari_agreed must_agree[] = {spari_whole("load_steps", load_steps),
                                       spari_hash("springs, loads or drives of joints", spari_joints_setting(s))};
    SPARI_TRY(spari_member_enter(member, __func__, must_agree, 2, check_member_static(member, __func__, load_steps)));
    double *saved_state = NULL;
    int status = spari_solvers_place(s, __func__);
    status = status == SPAR_OK ? spari_session_seal(s, save_state(s, member, &saved_state)) : status;
    if (status == SPAR_OK) {
        tell_drives(s, member, __func__);
        for (spar_member *m = s->members; m; m = m->next) {
            if (is_with(member, m)) {
                copy_loads(m, m->load.pushed, m->load.before);
            }
        }
        status = find_member_equilibrium(member, load_steps);
        if (status == SPAR_OK) {
            commit(s, member);
        } else {
            discard_static(s, member, saved_state);
        }
    }
    free(saved_state);
    return spari_named(s, __func__, status);
}

/* ---- all members, with the fluid ---- */

static int check_session_static(spar_session *s, const char *call, int load_steps) {
    SPARI_TRY(spari_need_idle(s, call));
    SPARI_REQUIRE(s, load_steps >= 1 && load_steps <= SPARI_STATIC_MOST, SPAR_ERR_ARGUMENT,
                  "%s: %d load steps; give 1 to %d", call, load_steps, SPARI_STATIC_MOST);
    for (const spar_member *m = s->members; m; m = m->next) {
        SPARI_TRY(check_held(m, call));
    }
    return s->clock.started ? SPAR_OK : spari_session_pushes(s, call);
}

/* Allows fluids to push and pull as in a step. */
static int begin_static(spar_session *s) {
    static const double last[2] = {1, 1};
    s->clock.begun++;
    spari_budget_begin(s);
    for (spar_member *m = s->members; m; m = m->next) {
        copy_loads(m, m->load.pushed, m->load.before);
        copy_loads(m, m->load.pushed, m->load.used);
    }
    if (!s->clock.started) { /* loads pushed before the first step are those at t^0 */
        SPARI_TRY(spari_session_exchange_loads(s, NULL));
        for (spar_member *m = s->members; m; m = m->next) {
            spari_session_take_loads(s, m, m->load.used);
        }
    }
    for (spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        spari_fluid_begin(f, 0, 1, last);
    }
    s->state.iteration = s->state.iterating = s->state.failed = 0;
    s->clock.started = s->state.static_solution = 1;
    s->state.phase = SPARI_SOLVED;
    spari_coupling_begin(s);
    return SPAR_OK;
}

/* Member whose loads changed most in the last iteration. */
static const spar_member *most_changed(const spar_session *s) {
    const spar_member *found = s->members;
    double most = -1;
    int k = 0;
    for (const spar_member *m = s->members; m; m = m->next, k++) {
        double sum = 0;
        for (int64_t i = 0; i < 6 * m->nodes; i++) {
            double r = (m->load.pushed[i] - m->load.used[i]) / (i % 6 < 3 ? 1 : s->own->coupling->length[k]);
            sum += r * r;
        }
        if (!(sum <= most)) { /* or NaN */
            most = sum;
            found = m;
        }
    }
    return found;
}

static const char *cure_for(const spar_session *s) {
    return spari_coupling_scheme_of(s->coupling.scheme)->columns
               ? "if the fluid stiffness exceeds the structural stiffness (static divergence), there is no stable "
                 "equilibrium: reduce the loads or stiffen the member"
               : "use another scheme (spar_session_set_coupling, IQN-ILS) or a smaller relaxation; if the fluid "
                 "stiffness exceeds the structural stiffness (static divergence), there is no stable equilibrium";
}

/* why: message of the cause, of this rank or a peer; NULL: the iteration limit. */
static int not_committed(spar_session *s, const char *call, int status, const char *why) {
    const spari_coupling *c = s->own->coupling;
    int n = c->iterations, last = n - 1, half = last / 2;
    /* mean factor from iteration to iteration in the later half of them; 0: too few to tell */
    double factor =
        last > 0 && c->residual[half] > 0 ? pow(c->residual[last] / c->residual[half], 1.0 / (last - half)) : 0;
    if (n == 0 || !s->members || (factor <= 1 && why)) {
        return spari_fail(s, status, "%s: %s", call, why ? why : "no iterations");
    }
    const char *member = most_changed(s)->name;
    if (factor > 1) {
        return spari_fail(s, status,
                          "%s: the loads grow from iteration to iteration by a factor of %.4g: they changed by %.3g N "
                          "of %.3g N in the last of %d iterations, most on member '%s' (%.400s); %s",
                          call, factor, c->residual[n - 1], c->size[n - 1], n, member,
                          why ? why : "iteration limit reached", cure_for(s));
    }
    return spari_fail(s, status,
                      "%s: no equilibrium with the fluid in %d iterations: the loads still change by %.3g N of %.3g N, "
                      "most on member '%s'; allow more iterations, or %s",
                      call, n, c->residual[n - 1], c->size[n - 1], member, cure_for(s));
}

static int not_solved(spar_session *s, const char *call, int status) {
    char why[SPARI_MESSAGE_SIZE];
    memcpy(why, s->message, sizeof why);
    return status == SPAR_ERR_COMM ? status : not_committed(s, call, status, why);
}

/* Fluid loads on these shapes, from all ranks. */
static int ask_fluid(spar_session *s, const char *call, spar_fluid_solver solve, void *context) {
    int status = spari_callback_run(s, call, solve, 0, context);
    if (status == SPAR_ERR_COMM) {
        return status;
    }
    status = status == SPAR_OK ? spari_session_pushes(s, call) : status;
    SPARI_TRY(spari_enter(s, call, status));
    int moved = 0;
    SPARI_TRY(spari_session_moved(s, &moved));
    if (moved) {
        status = solve_all(s, NULL, used, 1, 1);
        SPARI_TRY(status == SPAR_OK ? status : not_solved(s, call, status));
    }
    SPARI_TRY(spari_session_exchange_loads(s, NULL));
    for (spar_member *m = s->members; m; m = m->next) {
        spari_session_take_loads(s, m, m->load.pushed);
    }
    s->state.iteration++;
    return SPAR_OK;
}

/* Whether the shapes were solved with exactly the returned loads; otherwise puts these in use. */
static int stands_under_response(spar_session *s) {
    int same = 1;
    for (spar_member *m = s->members; m; m = m->next) {
        same &= memcmp(m->load.used, m->load.pushed, (size_t)(6 * m->nodes) * sizeof(double)) == 0;
        copy_loads(m, m->load.pushed, m->load.used);
    }
    return same;
}

int spari_session_warn_divergence(spar_session *s, const char *call) {
    int learns = spari_coupling_scheme_of(s->coupling.scheme)->learn != NULL;
    double ratio = learns ? spari_accelerator_ratio(s->own->coupling->accelerator) : 0;
    if (ratio < -1) { /* such a change grows in time, even if an accelerated iteration converges */
        spari_warn(s,
                   "%s: the fluid amplifies a change of its loads by a factor of %.3g: the equilibrium is unstable "
                   "(static divergence), and a run departs from it",
                   call, -ratio);
    }
    return ratio < -1;
}

static int find_equilibrium(spar_session *s, const char *call, int load_steps, spar_fluid_solver solve, void *context) {
    int agreed = 0;
    while (!agreed) {
        int status = solve_all(s, NULL, used, load_steps, s->state.iteration > 0);
        if (status != SPAR_OK) {
            return not_solved(s, call, status);
        }
        SPARI_TRY(ask_fluid(s, call, solve, context));
        status = spari_coupling_compare(s, &agreed);
        if (status != SPAR_OK) {
            return not_committed(s, call, status, "the accelerations are not finite");
        }
        if (!spari_coupling_scheme_of(s->coupling.scheme)->iterates) {
            break;
        }
        if (!agreed && s->state.iteration >= s->coupling.max) {
            return not_committed(s, call, SPAR_ERR_NUMERIC, NULL);
        }
        if (!agreed) {
            SPARI_TRY(spari_coupling_next(s));
        }
    }
    (void)spari_session_warn_divergence(s, call);
    int status = stands_under_response(s) ? SPAR_OK : solve_all(s, NULL, used, load_steps, 1);
    return status == SPAR_OK ? SPAR_OK : not_solved(s, call, status);
}

int spar_session_solve_static(spar_session *session, int load_steps, spar_fluid_solver solve, void *context,
                              int *iterations) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_callback_refuse(session, __func__));
    spar_session *s = session;
    const spari_agreed must_agree[] = {spari_whole("load_steps", load_steps),
                                       spari_hash("springs, loads or drives of joints", spari_joints_setting(s))};
    SPARI_TRY(spari_enter_agreed(s, __func__, must_agree, 2, check_session_static(s, __func__, load_steps)));
    double *saved_state = NULL;
    int status = spari_solvers_place(s, __func__);
    status = status == SPAR_OK ? spari_session_seal(s, save_state(s, NULL, &saved_state)) : status;
    status = status == SPAR_OK ? spari_coupling_suspend(s, s->coupling.scheme) : status;
    if (status != SPAR_OK) {
        free(saved_state);
        return spari_named(s, __func__, status);
    }
    tell_drives(s, NULL, __func__);
    status = begin_static(s);
    status = status == SPAR_OK ? find_equilibrium(s, __func__, load_steps, solve, context) : status;
    SPARI_GIVE(iterations, s->state.iteration);
    if (status == SPAR_OK) {
        for (spar_member *m = s->members; m; m = m->next) {
            copy_loads(m, m->load.pushed, m->load.history[0]);
            copy_loads(m, m->load.pushed, m->load.before);
            m->state.motion_given = 0;
        }
        commit(s, NULL);
        spari_fluids_each(s, spari_fluid_commit_state);
        s->state.past = 0; /* the past is no basis for extrapolation */
        spari_coupling_keep(s);
    } else {
        discard_static(s, NULL, saved_state);
        spari_fluids_each(s, spari_fluid_reject);
        spari_coupling_resume(s);
    }
    s->state.phase = SPARI_IDLE;
    s->clock.started = s->clock.step > 0;
    s->state.static_solution = 0;
    free(saved_state);
    return spari_named(s, __func__, status);
}
