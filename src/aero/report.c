/* Contribution of each effect of a blade-element fluid: trials of the host's own steps with and without it. Uses
   public calls alone. */
#include "../base/environment.h"
#include "../base/message.h"
#include "aero.h"

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

/* The host's arguments of a trial. */
typedef struct aero_trial {
    double dt;
    int64_t steps;
    spar_before_step before;
    spar_fluid_solver solve;
    void *context;
} aero_trial;

static int try_once(spar_session *s, const aero_trial *t, int compare, double report[SPAR_TRY_COUNT]) {
    return spar_session_try(s, t->dt, t->steps, t->before, t->solve, t->context, compare, SPAR_TRY_COUNT, report);
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

/* Compares the time of one solution: a run that starts out of equilibrium iterates more, which is not the cost of
   the effect. */
static double cost_of_try(const double report[SPAR_TRY_COUNT]) {
    return report[SPAR_TRY_SECONDS] / fmax(report[SPAR_TRY_SOLUTIONS], 1);
}

/* Restores the effects, whatever fails. Times are the smallest of three runs, with and without in turn. */
static int try_without(spar_session *s, spar_aero *aero, const aero_trial *t, int r, const double *base, double *out) {
    enum { REPEATS = 3 };
    double with = cost_of_try(base), without = INFINITY, report[SPAR_TRY_COUNT];
    const int effects = aero->rotor.effects;
    for (int k = 0; k < REPEATS; k++) {
        aero->rotor.effects = effects & ~rows[r].effect;
        int status = try_once(s, t, 1, report);
        aero->rotor.effects = effects;
        if (status != SPAR_OK) {
            out[SPAR_COLUMN_MOTION] = out[SPAR_COLUMN_REACTION] = -1;
            return SPAR_OK;
        }
        out[SPAR_COLUMN_SIZE] = report[SPAR_TRY_LOAD];
        out[SPAR_COLUMN_MOTION] = report[SPAR_TRY_MOTION];
        out[SPAR_COLUMN_REACTION] = report[SPAR_TRY_REACTION];
        without = fmin(without, cost_of_try(report));
        SPARI_TRY(try_once(s, t, 1, report));
        with = fmin(with, cost_of_try(report));
    }
    out[SPAR_COLUMN_SHARE] = with > 0 ? 1 - without / with : 0;
    return SPAR_OK;
}

static int try_all(spar_session *s, spar_aero *aero, const aero_trial *t, int status,
                   double (*table)[SPAR_COLUMN_COUNT]) {
    double in_force[SPAR_AERO_ROW_COUNT], base[SPAR_TRY_COUNT];
    SPARI_TRY(find_rows(s, aero, status, in_force));
    SPARI_TRY(try_once(s, t, 0, base));
    for (int r = 0; r < SPAR_AERO_ROW_COUNT; r++) {
        if (in_force[r] > 0) {
            table[r][SPAR_COLUMN_IN_FORCE] = 1;
            SPARI_TRY(try_without(s, aero, t, r, base, table[r]));
        }
    }
    return SPAR_OK;
}

static int check_arguments(spar_session *s, const spar_aero *aero, const aero_trial *t, int64_t table_rows,
                           int64_t table_columns, const char *call) {
    SPARI_REQUIRE(s, aero, SPAR_ERR_ARGUMENT, "%s: the aero object is NULL; create it with spar_aero_create", call);
    SPARI_REQUIRE(s, !aero->session || aero->session == s, SPAR_ERR_ARGUMENT,
                  "%s: the blades belong to another session; give the session of the blades", call);
    SPARI_REQUIRE(s, t->solve, SPAR_ERR_ARGUMENT, "%s: solve is NULL; give the solver passed to spar_step", call);
    SPARI_TRY(spari_need_capacity(s, call, table_rows));
    return spari_need_capacity(s, call, table_columns);
}

int spar_aero_report_effects(spar_aero *aero, spar_session *session, double dt, int64_t steps, spar_before_step before,
                             spar_fluid_solver solve, void *context, int64_t table_rows, int64_t table_columns,
                             double *table) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; give that of the blades", __func__);
    const aero_trial t = {dt, steps, before, solve, context};
    double made[SPAR_AERO_ROW_COUNT][SPAR_COLUMN_COUNT] = {{0}};
    char message[SPARI_MESSAGE_SIZE] = "";
    (void)snprintf(message, sizeof message, "%s", spar_session_message(session));
    int status = check_arguments(session, aero, &t, table_rows, table_columns, __func__);
    SPARI_TRY(spari_named(session, __func__, try_all(session, aero, &t, status, made)));
    spari_put_message_back(session, message);
    spari_fill_table(table_rows, table_columns, table, SPAR_AERO_ROW_COUNT, SPAR_COLUMN_COUNT, made[0]);
    return SPAR_OK;
}
