/* Contribution of effects: their size in a run, and trials with and without them. */
#include "../base/environment.h"
#include "handle.h"

#include "../math/rotation.h"
#include "../member/applied_loads.h"
#include "../member/beam.h"
#include "../member/body.h"
#include "../member/joint.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- sizes ---- */

/* Terms of the equations of motion */
enum { INTERNAL, INERTIA, GYROSCOPIC, GRAVITY, DAMPING, MASSES, FOUNDATION, PRETENSION, LOADS, TERMS };

/* Sum of the squares of nodal forces r [n][6]; moments are divided by the length. */
static double squares(const double *r, int64_t n, double length) {
    double sum = 0;
    for (int64_t i = 0; i < 6 * n; i++) {
        double x = i % 6 < 3 ? r[i] : r[i] / length;
        sum += x * x;
    }
    return sum;
}

static void minus(double *r, const double *from, int64_t n) {
    for (int64_t i = 0; i < 6 * n; i++) {
        r[i] -= from[i];
    }
}

/* Forces of attached masses: difference with and without them. r, less: workspace of [6 n] each. */
static double point_mass_squares(const spar_member *m, const double *q, const double *v, const double *a, double *r,
                                 double *less, double length) {
    int inertia = (m->effects & SPAR_EFFECT_INERTIA) != 0;
    const double *rate = inertia ? v : NULL, *acceleration = inertia ? a : NULL;
    spari_body_residual(m->body, q, rate, acceleration, 1, r, NULL);
    spari_point_masses_weight(m, 0);
    spari_body_residual(m->body, q, rate, acceleration, 1, less, NULL);
    spari_point_masses_weight(m, 1);
    minus(r, less, m->body->unique);
    return squares(r, m->body->unique, length);
}

/* Forces of pretension: difference with and without it, at rest. r, less: workspace of [6 n] each. */
static double pretension_squares(const spar_member *m, const double *q, double *r, double *less, double length) {
    spari_body loose = *m->body;
    loose.pre = NULL;
    spari_body_residual(m->body, q, NULL, NULL, 0, r, NULL);
    spari_body_residual(&loose, q, NULL, NULL, 0, less, NULL);
    minus(r, less, m->body->unique);
    return squares(r, m->body->unique, length);
}

/* Adds the squares of the loads, and of the foundation's forces, as separate terms. loads: workspace of [6 nodes],
   with a foundation twice that. */
static void load_squares(const spar_member *m, double *loads, double length, double sum[TERMS]) {
    for (int64_t i = 0; i < 6 * m->nodes; i++) {
        loads[i] = m->load.dead[i] + m->load.pushed[i];
    }
    if (spari_carries_loads(m)) {
        spari_applied_nodal(m, m->now.q, loads);
    }
    for (int64_t i = 0; i < m->nodes && m->session->joints && !m->external; i++) {
        spari_joints_on(m, i, loads + 6 * i);
    }
    if (m->load.foundation) {
        double *springs = loads + 6 * m->nodes;
        spari_foundation_nodal(m, m->now.q, 1, springs);
        sum[FOUNDATION] += squares(springs, m->nodes, length);
        minus(loads, springs, m->nodes);
    }
    sum[LOADS] += squares(loads, m->nodes, length);
}

/* Adds the squares of a member's terms at t^n, as differences of residuals. spari_body_residual takes velocities NULL
   as no damping, accelerations NULL as no inertia, zero accelerations as gyroscopic forces alone, and a factor of
   gravity. rest: the residual that is subtracted. */
static int member_terms(const spar_member *m, double sum[TERMS]) {
    spari_body plain = *m->body, *b = &plain;
    int64_t n = b->unique;
    double *q = spari_zalloc(37 * n + (m->load.foundation ? 12 : 6) * m->nodes, sizeof *q), *v = q + 7 * n,
           *a = v + 6 * n, *zero = a + 6 * n, *rest = zero + 6 * n, *r = rest + 6 * n, *loads = r + 6 * n,
           length = spari_member_length(m);
    SPARI_REQUIRE(m->session, q, SPAR_ERR_MEMORY, "no memory for the effects of '%s'", m->name);
    spari_member_to_unique(m, 7, m->now.q, q);
    spari_member_to_unique(m, 6, m->now.v, v);
    spari_member_to_unique(m, 6, m->now.a, a);
    plain.mass_damping = 0; /* mass-proportional damping has the form of inertia but counts as damping */
    spari_body_residual(b, q, NULL, NULL, 0, rest, NULL);
    sum[INTERNAL] += squares(rest, n, length);
    spari_body_residual(b, q, NULL, NULL, 1, r, NULL);
    minus(r, rest, n);
    sum[GRAVITY] += squares(r, n, length);
    if (b->D) {
        spari_body_residual(m->body, q, v, m->body->mass_damping > 0 ? zero : NULL, 0, r, NULL);
        if (m->body->mass_damping > 0) { /* less what is gyroscopic */
            spari_body_residual(b, q, v, zero, 0, loads, NULL);
            minus(r, loads, n);
            spari_body_residual(b, q, v, NULL, 0, loads, NULL);
            minus(loads, rest, n);
            for (int64_t i = 0; i < 6 * n; i++) {
                r[i] += loads[i];
            }
        } else {
            minus(r, rest, n);
        }
        sum[DAMPING] += squares(r, n, length);
    }
    if (m->effects & SPAR_EFFECT_INERTIA) {
        /* inertia is linear in the accelerations: the part at zero acceleration is gyroscopic */
        const double *rate = b->D ? v : NULL;
        spari_body_residual(b, q, v, zero, 0, r, NULL);
        spari_body_residual(b, q, rate, NULL, 0, rest, NULL);
        minus(r, rest, n);
        sum[GYROSCOPIC] += b->gyroscopic ? squares(r, n, length) : 0;
        spari_body_residual(b, q, v, a, 0, rest, NULL);
        spari_body_residual(b, q, v, zero, 0, r, NULL);
        minus(rest, r, n);
        sum[INERTIA] += squares(rest, n, length);
    }
    if (m->effects & SPAR_EFFECT_MASSES) {
        sum[MASSES] += point_mass_squares(m, q, v, a, r, rest, length);
    }
    if (m->effects & SPAR_EFFECT_PRETENSION) {
        sum[PRETENSION] += pretension_squares(m, q, r, rest, length);
    }
    load_squares(m, loads, length, sum);
    free(q);
    return SPAR_OK;
}

/* What a run has shown so far: sums of the terms' squares, the largest angular velocity. */
typedef struct sizes {
    double sum[TERMS], rate;
} sizes;

static int add_state(spar_session *s, void *to) {
    sizes *so_far = to;
    int status = SPAR_OK;
    for (spar_member *m = s->members; m && status == SPAR_OK; m = m->next) {
        if (m->body) {
            status = member_terms(m, so_far->sum);
        }
        for (int64_t i = 0; i < m->nodes; i++) {
            so_far->rate = fmax(so_far->rate, spari_norm(m->now.v + 6 * i + 3));
        }
    }
    return status;
}

/* Terms of the whole run, relative to the largest. */
static void find_sizes(const sizes *of, double dt, double size[SPAR_ROW_COUNT]) {
    double leading = 0;
    for (int k = 0; k < TERMS; k++) {
        leading = fmax(leading, of->sum[k]);
    }
    static const int row[] = {
        [INERTIA] = SPAR_ROW_INERTIA,      [GYROSCOPIC] = SPAR_ROW_GYROSCOPIC, [GRAVITY] = SPAR_ROW_GRAVITY,
        [DAMPING] = SPAR_ROW_DAMPING,      [MASSES] = SPAR_ROW_MASSES,         [FOUNDATION] = SPAR_ROW_FOUNDATION,
        [PRETENSION] = SPAR_ROW_PRETENSION};
    for (int k = INERTIA; k <= PRETENSION; k++) {
        size[row[k]] = leading > 0 ? sqrt(of->sum[k] / leading) : 0;
    }
    size[SPAR_ROW_HALF_STEP] = of->rate * dt * of->rate * dt / 8;
}

/* ---- rows ---- */

typedef struct effect_row {
    const char *name;
    int effect; /* SPAR_EFFECT_* of members */
    int part;   /* SPARI_MUTE_* of fluids */
} effect_row;

static const effect_row rows[SPAR_ROW_COUNT] = {
    {"inertia", SPAR_EFFECT_INERTIA, 0},
    {"gyroscopic terms", SPAR_EFFECT_GYROSCOPIC, 0},
    {"gravity", SPAR_EFFECT_GRAVITY, 0},
    {"damping", SPAR_EFFECT_DAMPING, 0},
    {"fluid moments", SPAR_EFFECT_FLUID_MOMENT, SPARI_ASKED_MOMENT},
    {"fluid velocities", 0, SPARI_MUTE_VELOCITY},
    {"section poses", 0, SPARI_MUTE_POSES},
    {"node force history", 0, SPARI_MUTE_HISTORY},
    {"predictor", 0, 0},
    {"iteration", 0, 0},
    {"half step", 0, SPARI_MUTE_HALF_STEP},
    {"bodies on beams", SPAR_EFFECT_MASSES, 0},
    {"foundation", SPAR_EFFECT_FOUNDATION, 0},
    {"pretension", SPAR_EFFECT_PRETENSION, 0},
};

const char *spar_effect_name(int r) {
    return r >= 0 && r < SPAR_ROW_COUNT ? rows[r].name : "";
}

/* asked: what the fluids of all ranks have pulled and pushed */
static int row_in_force(const spar_session *s, int r, int asked) {
    if (r == SPAR_ROW_PREDICTOR) {
        return s->coupling.predictor > 0;
    }
    if (r == SPAR_ROW_ITERATION) {
        return s->coupling.scheme != SPAR_COUPLING_EXPLICIT;
    }
    int any = rows[r].effect == 0;
    for (const spar_member *m = s->members; m; m = m->next) {
        int here = (m->effects & rows[r].effect) != 0;
        if (r == SPAR_ROW_GRAVITY) {
            here = here && spari_norm(s->gravity) > 0;
        }
        any |= here;
    }
    return any && (asked & rows[r].part) == rows[r].part;
}

static void leave_row_out(const spar_session *s, int r, spari_trial_settings *trial_settings) {
    if (r == SPAR_ROW_PREDICTOR) {
        SPARI_VARY(trial_settings->setting, coupling.predictor, 0);
    } else if (r == SPAR_ROW_ITERATION) {
        SPARI_VARY(trial_settings->setting, coupling.scheme, SPAR_COUPLING_EXPLICIT);
    } else if (rows[r].effect == 0) {
        trial_settings->mute = rows[r].part;
    }
    for (int k = 0; k < s->member_count; k++) {
        trial_settings->member[k].left_out = rows[r].effect;
    }
}

/* Compares the time of one solution, because a run that starts out of equilibrium iterates more, which is not the
   cost of the effect. Exception: rows that change the number of solutions. */
static double cost_of_row(const spari_record *record, int r) {
    int of_coupling = r == SPAR_ROW_PREDICTOR || r == SPAR_ROW_ITERATION;
    return of_coupling || record->solutions == 0 ? record->seconds : record->seconds / (double)record->solutions;
}

enum { REPEATS = 3 }; /* times are the smallest of this many runs, with and without in turn */

/* Number of runs for rows from r on. asked: as in row_in_force. */
static int count_runs(const spar_session *s, int r, int asked) {
    int runs = 0;
    for (; r < SPAR_ROW_COUNT; r++) {
        runs += row_in_force(s, r, asked) ? 2 * REPEATS : 0;
    }
    return runs;
}

/* Number of runs made, and in total. */
typedef struct run_tally {
    int done, left;
} run_tally;

/* A run with a call of the progress callback before it. */
static int run_told(spar_session *s, const spari_run *run, const spari_trial_settings *trial_settings, run_tally *runs,
                    spari_record *record) {
    *record = (spari_record){0};
    record->own = spari_progress_tell(s, run->progress, runs->done, runs->done + runs->left);
    SPARI_TRY(record->own);
    runs->done++;
    runs->left--;
    return spari_trial_run(s, run, trial_settings, record);
}

static int try_row_out(spar_session *s, const char *call, const spari_run *run, int r, const spari_record *base,
                       run_tally *runs, spari_effect *out) {
    double with = cost_of_row(base, r), without = INFINITY;
    spari_trial_settings plain, left_out = {.member = NULL};
    SPARI_TRY(spari_trial_settings_create(s, &plain));
    int status = spari_trial_settings_create(s, &left_out);
    if (status == SPAR_OK) {
        leave_row_out(s, r, &left_out);
    }
    for (int k = 0; k < 2 * REPEATS && status == SPAR_OK; k++) {
        spari_record record;
        const int without_it = k % 2 == 0;
        status = run_told(s, run, without_it ? &left_out : &plain, runs, &record);
        if (status == SPAR_OK && k == 0) {
            out->motion = spari_record_distance(&record, base, SPARI_OF_MOTION);
            out->reaction = spari_record_distance(&record, base, SPARI_OF_REACTION);
            if (r >= SPAR_ROW_FLUID_MOMENT && r <= SPAR_ROW_FLUID_HISTORY) {
                out->size = spari_record_load(&record, base);
            }
        }
        double *least = without_it ? &without : &with;
        *least = status == SPAR_OK ? fmin(*least, cost_of_row(&record, r)) : *least;
        spari_record_free(&record);
    }
    spari_trial_settings_free(&plain);
    spari_trial_settings_free(&left_out);
    int over_budget = status == SPAR_ERR_LIMIT && run->progress->stopped == SPAR_OK;
    if (over_budget || status == SPAR_ERR_NUMERIC || status == SPAR_ERR_USER || status == SPAR_ERR_STATE ||
        status == SPAR_ERR_UNSUPPORTED) { /* the other rows can still be tried */
        char text[SPARI_MESSAGE_SIZE + 100];
        (void)snprintf(text, sizeof text, "%s: without %s the run fails: %s", call, rows[r].name, s->message);
        spari_log(s, SPAR_LOG_INFO, text);
        out->fails = 1;
        out->motion = out->reaction = 0;
        return SPAR_OK;
    }
    out->share = with > 0 ? 1 - without / with : 0;
    return status;
}

/* Requests of the fluids on all ranks. */
static int asked_anywhere(spar_session *s, int *asked) {
    enum { BITS = 5 };
    double bit[BITS + 1];
    for (int k = 0; k < BITS; k++) {
        bit[k] = *asked >> k & 1;
    }
    SPARI_TRY(spari_sum(s, bit, BITS));
    *asked = 0;
    for (int k = 0; k < BITS; k++) {
        *asked |= bit[k] > 0 ? 1 << k : 0;
    }
    return SPAR_OK;
}

static int fill_rows(spar_session *s, const char *call, const spari_run *run, spari_effect *table) {
    double size[SPAR_ROW_COUNT] = {0};
    sizes seen = {{0}, 0};
    spari_run watched = *run;
    spari_trial_settings trial_settings;
    spari_record base;
    run_tally runs = {0, 1 + count_runs(s, 0, run->solve ? ~0 : 0)}; /* the first run shows the fluid's requests */
    watched.watch = add_state, watched.watcher = &seen;
    SPARI_TRY(spari_agree(s, add_state(s, &seen)));
    SPARI_TRY(spari_trial_settings_create(s, &trial_settings));
    (void)run_told(s, &watched, &trial_settings, &runs, &base);
    find_sizes(&seen, run->dt, size);
    int status = base.own, asked = base.asked;
    spari_trial_settings_free(&trial_settings);
    size[SPAR_ROW_PREDICTOR] = base.report[SPAR_REPORT_ERROR];
    size[SPAR_ROW_ITERATION] = base.report[SPAR_REPORT_ADDED_MASS];
    status = status == SPAR_OK ? asked_anywhere(s, &asked) : status;
    for (int r = 0; r < SPAR_ROW_COUNT && status == SPAR_OK; r++) {
        runs.left = count_runs(s, r, asked);
        if (row_in_force(s, r, asked)) {
            table[r] = (spari_effect){.in_force = 1, .size = size[r]};
            status = try_row_out(s, call, run, r, &base, &runs, table + r);
        }
    }
    spari_record_free(&base);
    return status;
}

int spar_trial_report_effects(spar_trial *trial) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, trial, SPAR_ERR_ARGUMENT, "%s: the trial is NULL; create it first", __func__);
    spar_session *s = trial->session;
    spari_effect made[SPAR_ROW_COUNT] = {{0}};
    SPARI_TRY(spari_trial_enter(trial, __func__, NULL, 0, spari_trial_ready_for_runs(trial, __func__)));
    spari_progress progress = spari_trial_progress(trial, __func__);
    spari_run run = spari_trial_run_of(trial, &progress);
    run.goals = SPARI_GOAL(SPARI_OF_REACTION);
    int status = spari_progress_ends(&progress, fill_rows(s, __func__, &run, made));
    if (status == SPAR_OK) {
        memcpy(trial->effect, made, sizeof made);
        trial->reported = 1;
    }
    return spari_trial_leave(trial, __func__, status);
}

int spar_trial_get_effect(const spar_trial *trial, int row, int *in_force, int *fails, double *size, double *motion,
                          double *reaction, double *share) {
    SPARI_REQUIRE(NULL, trial, SPAR_ERR_ARGUMENT, "%s: the trial is NULL; create it first", __func__);
    SPARI_REQUIRE(trial->session, row >= 0 && row < SPAR_ROW_COUNT, SPAR_ERR_ARGUMENT,
                  "%s: there is no row %d; give a SPAR_ROW_*", __func__, row);
    SPARI_REQUIRE(trial->session, trial->reported, SPAR_ERR_STATE,
                  "%s: there is no report; call spar_trial_report_effects first", __func__);
    const spari_effect *e = trial->effect + row;
    SPARI_GIVE(in_force, e->in_force);
    SPARI_GIVE(fails, e->fails);
    SPARI_GIVE(size, e->size);
    SPARI_GIVE(motion, e->motion);
    SPARI_GIVE(reaction, e->reaction);
    SPARI_GIVE(share, e->share);
    return SPAR_OK;
}
