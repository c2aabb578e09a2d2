/* Trials: runs steps with other settings or without an effect, and restores the session. See trial.h. */
#include "trial.h"

#include "move_joints.h"
#include "move_loads.h"

#include "../coupling/coupling.h"
#include "../exchange/rank_loads_and_motion.h"
#include "../exchange/session_private.h"
#include "../fluid/fluid.h"
#include "../member/check_arguments.h"
#include "../session/callbacks.h"
#include "../session/initial_accelerations.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- trial settings ---- */

int spari_trial_settings_create(spar_session *s, spari_trial_settings *trial_settings) {
    *trial_settings = (spari_trial_settings){.member = spari_zalloc(s->member_count, sizeof *trial_settings->member)};
    (void)spari_settings_varied(s, trial_settings->setting);
    spari_rebuild *r = trial_settings->member;
    for (const spar_member *m = s->members; m && r; m = m->next, r++) {
        *r = spari_rebuild_of(m);
    }
    int status = r ? SPAR_OK : spari_fail(s, SPAR_ERR_MEMORY, "no memory for a trial run");
    status = spari_agree(s, status);
    if (status != SPAR_OK) {
        spari_trial_settings_free(trial_settings);
    }
    return status;
}

void spari_trial_settings_free(spari_trial_settings *trial_settings) {
    free(trial_settings->member);
    trial_settings->member = NULL;
}

/* ---- save and restore ---- */

/* What a run changes in a session itself, or a callback of the host. */
static void copy_saved(spar_session *to, const spar_session *from) {
    to->failures = from->failures;
    to->ranks.calls_differ = from->ranks.calls_differ;
    to->ranks.reproducible = from->ranks.reproducible;
    to->callbacks.in_progress = from->callbacks.in_progress;
    to->callbacks.muted = from->callbacks.muted;
    to->integrator = from->integrator;
    to->newton = from->newton;
    to->coupling = from->coupling;
    to->tolerance = from->tolerance;
    to->clock = from->clock;
    to->state = from->state;
    memcpy(to->gravity, from->gravity, sizeof to->gravity);
    memcpy(to->gravity_before, from->gravity_before, sizeof to->gravity_before);
}

typedef struct snapshot {
    spar_session session;    /* copy_saved of it */
    spari_exchange exchange; /* private data of the session that are saved meanwhile */
    spari_coupling *coupling;
    spar_member *members;                /* [member_count] old members; */
    int made;                            /* number of those rebuilt */
    spari_joint_snapshot joint_snapshot; /* of the members */
    spar_fluid **fluids;                 /* old fluids, in their order */
    int fluid_count, fluids_made;
    spari_moved_loads *carried; /* [fluid_count] room for those with other nodes */
} snapshot;

/* After a failure the session is unchanged, with nothing to restore. */
static int snapshot_create(spar_session *s, snapshot *t) {
    spari_own *own = s->own;
    *t = (snapshot){.exchange = own->exchange, .coupling = own->coupling};
    copy_saved(&t->session, s);
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        t->fluid_count++;
    }
    t->members = spari_zalloc(s->member_count, sizeof *t->members);
    t->fluids = spari_zalloc(t->fluid_count, sizeof(spar_fluid *));
    t->carried = spari_zalloc(t->fluid_count, sizeof *t->carried);
    int status = t->members && t->fluids && t->carried ? spari_joints_save_snapshot(s, &t->joint_snapshot)
                                                       : spari_fail(s, SPAR_ERR_MEMORY, "no memory for a trial run");
    if (status != SPAR_OK) {
        SPARI_FREE(t->members, t->fluids, t->carried);
        return status;
    }
    own->coupling = NULL;
    s->coupling.stale = 1;
    own->exchange = (spari_exchange){0};
    s->callbacks.muted = 1;
    return SPAR_OK;
}

static int make_anew(spar_session *s, snapshot *t, const spari_trial_settings *trial_settings) {
    spari_settings_vary(s, trial_settings->setting);
    s->state.past = s->state.past < s->coupling.predictor ? s->state.past : s->coupling.predictor;
    for (spar_member *m = s->members; m; m = m->next, t->made++) {
        int status = spari_member_rebuild(m, trial_settings->member + t->made, t->members + t->made);
        status = status == SPAR_OK ? spari_joints_follow_rebuild(m, t->members + t->made) : status;
        if (status != SPAR_OK) {
            t->made++;
            return status;
        }
    }
    for (spar_fluid *f = s->fluids; f; f = spari_fluid_next(f), t->fluids_made++) {
        int status = spari_fluid_rebuild(f, t->members + spari_fluid_member(f)->number, t->fluids + t->fluids_made);
        if (status != SPAR_OK) {
            t->fluids_made += t->fluids[t->fluids_made] != NULL;
            return status;
        }
        spari_fluid_mute(f, trial_settings->mute);
    }
    s->state.trial = 1;
    return SPAR_OK;
}

/* Transfers the fluids' loads to other nodes; collective. */
static int carry_loads(spar_session *s, const snapshot *t) {
    int64_t count = 0;
    int any = 0, k = 0;
    for (const spar_member *m = s->members; m; m = m->next) {
        any = any || !spari_mesh_is_equal(m->mesh, t->members[m->number].mesh);
    }
    for (spar_fluid *f = s->fluids; f; f = spari_fluid_next(f), k++) {
        const spar_member *before = t->members + spari_fluid_member(f)->number;
        if (!spari_mesh_is_equal(before->mesh, spari_fluid_member(f)->mesh)) {
            t->carried[count++] = (spari_moved_loads){f, t->fluids[k], before};
        }
    }
    return spari_move_loads(s, "a trial run", any, t->carried, count);
}

/* The message of a failure is kept. */
static void restore_session(spar_session *s, snapshot *t) {
    spar_fluid *f = s->fluids;
    for (int k = 0; k < t->fluids_made; k++, f = spari_fluid_next(f)) {
        spari_fluid_restore(f, t->fluids[k]);
    }
    spar_member *m = s->members;
    for (int k = 0; k < t->made; k++, m = m->next) {
        spari_member_restore(m, t->members + k);
    }
    spari_joints_restore_snapshot(s, &t->joint_snapshot);
    spari_coupling_free(&s->own->coupling);
    SPARI_FREE(s->own->exchange.pack, s->own->exchange.first, s->own->exchange.motion);
    copy_saved(s, &t->session);
    s->own->exchange = t->exchange, s->own->coupling = t->coupling;
    SPARI_FREE(t->members, t->fluids, t->carried);
    spari_fluid_release_gone(s);
}

/* ---- the run ---- */

/* Alternation of the loads at step i. Unstable explicit coupling begins as an alternation, whose second differences
   change sign with every step; those of a resolved motion keep their sign. size: squares of the loads in each
   quarter. */
static void watch_loads(const spar_session *s, int64_t i, int64_t steps, spari_record *r, double size[4]) {
    int n = 6 * r->members, quarter = (int)((i - 1) * 4 / steps);
    double *now = r->trail + i % 3 * n, *last = r->trail + (i + 2) % 3 * n, *before = r->trail + (i + 1) % 3 * n,
           *turn = r->trail + 3 * n, product = 0;
    spari_record_loads(s, now);
    for (int k = 0; k < n; k++) {
        double second = now[k] - 2 * last[k] + before[k];
        product += second * turn[k];
        turn[k] = second;
        size[quarter] += now[k] * now[k];
    }
    if (i == 1) {
        memcpy(r->load, now, (size_t)n * sizeof *now);
    }
    if (i * SPARI_MULTIPLE % steps == 0) {
        memcpy(r->load + i * SPARI_MULTIPLE / steps * n, now, (size_t)n * sizeof *now);
    }
    if (quarter % 2 == 1) {
        r->alternating[quarter / 2] += fmax(-product, 0);
    }
}

static int march(spar_session *s, const spari_run *run, spari_record *r) {
    double size[4] = {0};
    const char *call = run->progress ? run->progress->call : "spar_trial_run";
    for (int64_t i = 1; i <= run->steps; i++) {
        SPARI_TRY(spari_callback_before_step(s, call, run->before, run->dt, run->before_context));
        int iterations = 0;
        const clock_t since = clock();
        int status = spar_step(s, run->dt, run->solve, run->solve_context, &iterations);
        r->seconds += (double)(clock() - since) / CLOCKS_PER_SEC;
        r->solutions += iterations;
        SPARI_TRY(status);
        if (run->watch) { /* it may lack memory on one rank alone */
            status = run->watch(s, run->watcher);
            SPARI_TRY(spari_agree(s, status));
        }
        watch_loads(s, i, run->steps, r, size);
        SPARI_TRY(spari_record_look(r, s, i));
    }
    for (int k = 0; k < 2; k++) {
        r->alternating[k] = size[1] + size[3] > 0 ? r->alternating[k] / (size[1] + size[3]) : 0;
    }
    return SPAR_OK;
}

/* The members and fluids there now are the trial's. balanced: the run begins with a start with initial accelerations.
 */
static int run_there(spar_session *s, const spari_run *run, int balanced, spari_record *r) {
    int status = spari_record_create(s, run->steps, run->goals, r);
    r->numbers = run->numbers;
    status = spari_session_seal(s, status);
    if (status == SPAR_OK && balanced) { /* as the host has begun its own run */
        int iterations = 0;
        status = spar_session_solve_initial(s, run->dt, run->solve, run->solve_context, &iterations);
        r->solutions += iterations;
    }
    if (status == SPAR_OK) {
        spari_record_begin(r, s);
        status = march(s, run, r);
    }
    if (status == SPAR_OK) {
        double seconds[2] = {r->seconds, 0};
        memcpy(r->report, s->own->coupling->report, sizeof r->report);
        status = spari_sum(s, seconds, 1);
        r->seconds = seconds[0];
    }
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        r->asked |= spari_fluid_asked(f);
    }
    return status;
}

/* The failing rank's status on all ranks, for failures of the run, so that they continue equally. After a failure of
   the machine no rank continues; each keeps its own status, or learns that a peer failed. */
static int share_failure(spar_session *s, int own) {
    enum { CODES = SPAR_ERR_LIMIT + 1 };
    double there[CODES + 1] = {0};
    if (own == SPAR_OK || own == SPAR_ERR_COMM) {
        return own; /* known to all; a broken communicator cannot be used */
    }
    there[own] = 1;
    SPARI_TRY(spari_sum(s, there, CODES));
    if (there[SPAR_ERR_MEMORY] > 0 || there[SPAR_ERR_IO] > 0) {
        return own == SPAR_ERR_MEMORY || own == SPAR_ERR_IO || own == SPAR_ERR_PEER
                   ? own
                   : spari_fail(s, SPAR_ERR_PEER, "another rank has no memory or no file for a trial run");
    }
    int shared = SPAR_OK + 1;
    while (shared < CODES && (there[shared] == 0 || shared == SPAR_ERR_PEER)) {
        shared++;
    }
    return shared < CODES ? shared : SPAR_ERR_PEER; /* a host may report on all ranks that a peer of its fluid failed */
}

int spari_trial_run(spar_session *s, const spari_run *run, const spari_trial_settings *trial_settings,
                    spari_record *record) {
    snapshot t;
    int balanced = spari_start_stands(s);
    *record = (spari_record){0};
    int status = snapshot_create(s, &t), away = status == SPAR_OK;
    status = away ? make_anew(s, &t, trial_settings) : status;
    status = spari_agree(s, status);
    status = status == SPAR_OK ? carry_loads(s, &t) : status;
    status = status == SPAR_OK && s->joints ? spari_assemblies_make(s, "a trial run") : status;
    if (status == SPAR_OK && run->instead) {
        status = spari_session_seal(s, SPAR_OK);
        status = status == SPAR_OK ? run->instead(s, run->of) : status;
    } else if (status == SPAR_OK) {
        status = run_there(s, run, balanced, record);
    }
    if (away) {
        restore_session(s, &t);
    }
    record->own = status;
    return share_failure(s, status);
}

int spari_trial_check(spar_session *s, const char *call) {
    SPARI_TRY(spari_need_no_trial(s, call));
    SPARI_TRY(spari_need_idle(s, call));
    return spari_need_all_committed(s, call);
}

int spari_trial_check_steps(spar_session *s, const char *call, double dt, int64_t steps) {
    const double longer = 1e6; /* advice varies dt, and runs longer than requested */
    SPARI_REQUIRE(s, steps % SPARI_MULTIPLE == 0, SPAR_ERR_ARGUMENT,
                  "%s: the trial has %lld steps; give spar_trial_set_steps a multiple of %d", call, (long long)steps,
                  SPARI_MULTIPLE);
    SPARI_REQUIRE(s, isfinite(s->clock.time + longer * (double)steps * dt), SPAR_ERR_ARGUMENT,
                  "%s: the end of %lld steps of %g s from t = %g is not finite; give fewer or shorter steps", call,
                  (long long)steps, dt, s->clock.time);
    return SPAR_OK;
}
