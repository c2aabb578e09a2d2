/* Contribution of each effect of a blade-element fluid: trials of the host's own steps with and without it. Uses
   public calls alone. */
#include "aero.h"
#include "message.h"

#include <math.h>
#include <spar/spar_aero.h>
#include <stdio.h>
#include <string.h>

typedef struct aero_row {
    const char *name;
    int effect;
    int needs; /* effect that it depends on */
} aero_row;

static const aero_row rows[SPAR_AERO_ROW_COUNT] = {
    {"induction", SPAR_AERO_INDUCTION, 0},
    {"tip loss", SPAR_AERO_TIP_LOSS, SPAR_AERO_INDUCTION},
    {"hub loss", SPAR_AERO_HUB_LOSS, SPAR_AERO_INDUCTION},
    {"swirl", SPAR_AERO_SWIRL, SPAR_AERO_INDUCTION},
    {"drag", SPAR_AERO_DRAG, 0},
    {"pitching moments", SPAR_AERO_MOMENT, 0},
    {"wind shear", SPAR_AERO_SHEAR, 0},
    {"tower shadow", SPAR_AERO_TOWER, 0},
    {"dynamic inflow", SPAR_AERO_INFLOW, SPAR_AERO_INDUCTION},
    {"dynamic stall", SPAR_AERO_STALL, 0},
    {"unsteady airfoil", SPAR_AERO_UNSTEADY, 0},
};

const char *spar_aero_effect_name(int r) {
    return r >= 0 && r < SPAR_AERO_ROW_COUNT ? rows[r].name : "";
}

static int polars_have_moments(const spar_aero *aero) {
    int any = 0;
    for (int64_t i = 0; i < aero->n; i++) {
        any |= aero->section[i].table && spari_table_has_moment(aero->section[i].table);
    }
    return any;
}

/* Whether an effect is in force on this rank, with something to act on. */
static int is_in_force(const spar_aero *aero, int r) {
    int wanted = rows[r].effect | rows[r].needs;
    if (aero->blades == 0 || (aero->rotor.effects & wanted) != wanted) {
        return 0;
    }
    return rows[r].effect == SPAR_AERO_HUB_LOSS ? aero->rotor.hub_radius > 0
                                                : rows[r].effect != SPAR_AERO_MOMENT || polars_have_moments(aero);
}

/* Whether effects are in force on any rank, because all ranks run the same trials. status: of the arguments on this
   rank. */
static int find_rows(spar_session *s, const spar_aero *aero, int status, double in_force[SPAR_AERO_ROW_COUNT]) {
    for (int r = 0; r < SPAR_AERO_ROW_COUNT; r++) {
        in_force[r] = status == SPAR_OK ? is_in_force(aero, r) : 0;
    }
    return spar_session_sum(s, status, SPAR_AERO_ROW_COUNT, in_force);
}

/* A run of the trial: its errors, and the time of one solution, because a run that starts out of equilibrium iterates
   more, which is not the cost of the effect. */
typedef struct aero_run {
    double motion, reaction, load, time;
} aero_run;

static int try_once(spar_trial *trial, int compare, aero_run *out) {
    double seconds;
    int64_t evaluations;
    SPARI_TRY(spar_trial_run(trial, compare));
    SPARI_TRY(spar_trial_get_errors(trial, &out->motion, &out->reaction, &out->load));
    SPARI_TRY(spar_trial_get_cost(trial, &seconds, &evaluations));
    out->time = seconds / fmax((double)evaluations, 1);
    return SPAR_OK;
}

/* A callback of the last run may have destroyed the trial. */
static int check_trial_lives(const spar_trial *trial) {
    spar_session *session;
    return spar_trial_get_session(trial, &session);
}

/* Restores the effects, whatever fails. Times are the smallest of three runs, with and without in turn. */
static int try_without(spar_trial *trial, spar_aero *aero, int r, const aero_run *base, spari_aero_effect *out) {
    enum { REPEATS = 3 };
    double with = base->time, without = INFINITY;
    const int effects = aero->rotor.effects;
    for (int k = 0; k < REPEATS; k++) {
        aero_run run;
        aero->rotor.effects = effects & ~rows[r].effect;
        int status = try_once(trial, 1, &run);
        aero->rotor.effects = effects;
        if (status != SPAR_OK) {
            SPARI_TRY(check_trial_lives(trial));
            *out = (spari_aero_effect){.in_force = 1, .fails = 1};
            return SPAR_OK;
        }
        *out = (spari_aero_effect){.in_force = 1, .size = run.load, .motion = run.motion, .reaction = run.reaction};
        without = fmin(without, run.time);
        SPARI_TRY(try_once(trial, 1, &run));
        with = fmin(with, run.time);
    }
    out->share = with > 0 ? 1 - without / with : 0;
    return SPAR_OK;
}

/* Whether the trial's fluid solver has solved for this object on any rank. */
static int check_solves(spar_session *s, const spar_aero *aero, int64_t before, const char *call) {
    double sum[] = {aero->solves > before, aero->blades};
    SPARI_TRY(spar_session_sum(s, SPAR_OK, 2, sum));
    SPARI_AERO_REQUIRE(s, sum[0] > 0 || sum[1] == 0, SPAR_ERR_STATE,
                       "%s: the trial's fluid solver does not call spar_aero_solve on this object; give "
                       "spar_trial_set_callbacks one that does",
                       call);
    return SPAR_OK;
}

static int try_all(spar_session *s, spar_trial *trial, spar_aero *aero, int status, const char *call,
                   spari_aero_effect *table) {
    double in_force[SPAR_AERO_ROW_COUNT];
    aero_run base;
    SPARI_TRY(find_rows(s, aero, status, in_force));
    const int64_t solves = aero->solves;
    SPARI_TRY(try_once(trial, 0, &base));
    SPARI_TRY(check_solves(s, aero, solves, call));
    for (int r = 0; r < SPAR_AERO_ROW_COUNT; r++) {
        if (in_force[r] > 0) {
            SPARI_TRY(try_without(trial, aero, r, &base, table + r));
        }
    }
    return SPAR_OK;
}

static int check_arguments(spar_session *s, const spar_aero *aero, const char *call) {
    SPARI_AERO_REQUIRE(s, aero, SPAR_ERR_ARGUMENT, "%s: the aero object is NULL; create it with spar_aero_create",
                       call);
    SPARI_AERO_REQUIRE(s, !aero->session || aero->session == s, SPAR_ERR_ARGUMENT,
                       "%s: the blades belong to another session; give a trial of the session of the blades", call);
    return SPAR_OK;
}

/* Without a guard: libspar calls the host in the environment that its own calls are made in. */
int spar_aero_report_effects(spar_aero *aero, spar_trial *trial) {
    SPARI_AERO_REQUIRE(NULL, trial, SPAR_ERR_ARGUMENT, "%s: the trial is NULL; create it with spar_trial_create",
                       __func__);
    spar_session *session = NULL;
    SPARI_TRY(spar_trial_get_session(trial, &session));
    spari_aero_effect made[SPAR_AERO_ROW_COUNT] = {{0}};
    char message[SPARI_MESSAGE_SIZE] = "";
    (void)snprintf(message, sizeof message, "%s", spar_session_message(session));
    int status = check_arguments(session, aero, __func__);
    int alone = aero && !aero->reporting; /* not within a callback of another report */
    if (alone) {
        aero->reporting = 1;
    }
    status = spari_aero_named(session, __func__, try_all(session, trial, aero, status, __func__, made));
    if (alone) {
        aero->reporting = 0;
    }
    if (alone && aero->gone) {
        spar_aero_destroy(&aero);
        return status != SPAR_OK
                   ? status
                   : spari_aero_fail(session, SPAR_ERR_STATE,
                                     "%s: a callback has destroyed the aero object; destroy it after the call",
                                     __func__);
    }
    SPARI_TRY(status);
    spari_aero_put_message_back(session, message);
    memcpy(aero->effect, made, sizeof made); /* NOLINT(clang-analyzer-core.NonNullParamChecker): checked above */
    aero->reported = 1;
    return SPAR_OK;
}

int spar_aero_get_effect(const spar_aero *aero, int row, int *in_force, int *fails, double *size, double *motion,
                         double *reaction, double *share) {
    SPARI_AERO_REQUIRE(NULL, aero, SPAR_ERR_ARGUMENT, "%s: the aero object is NULL; create it with spar_aero_create",
                       __func__);
    SPARI_AERO_REQUIRE(aero->session, row >= 0 && row < SPAR_AERO_ROW_COUNT, SPAR_ERR_ARGUMENT,
                       "%s: there is no row %d; give a SPAR_AERO_ROW_*", __func__, row);
    SPARI_AERO_REQUIRE(aero->session, aero->reported, SPAR_ERR_STATE,
                       "%s: there is no report; call spar_aero_report_effects first", __func__);
    const spari_aero_effect *e = aero->effect + row;
    int *const flags[] = {in_force, fails};
    const int flag[] = {e->in_force, e->fails};
    double *const figures[] = {size, motion, reaction, share};
    const double figure[] = {e->size, e->motion, e->reaction, e->share};
    for (int k = 0; k < 2; k++) {
        if (flags[k]) {
            *flags[k] = flag[k];
        }
    }
    for (int k = 0; k < 4; k++) {
        if (figures[k]) {
            *figures[k] = figure[k];
        }
    }
    return SPAR_OK;
}
