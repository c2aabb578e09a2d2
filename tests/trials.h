/* Trials of a session in one call each, with the results in arrays: for tests that compare many of them. They use the
   first trial of the session. Both callbacks have one context. */
#ifndef TRIALS_H
#define TRIALS_H

#include "exchange/session_private.h"
#include "trial/handle.h"
#include "tune/apply.h"

#include <spar/spar_aero.h>
#include <stdlib.h>

enum { TRY_MOTION, TRY_REACTION, TRY_LOAD, TRY_SECONDS, TRY_EVALUATIONS, TRY_COUNT };
/* motion and reaction: -1 if the run fails without the effect */
enum { COLUMN_IN_FORCE, COLUMN_SIZE, COLUMN_MOTION, COLUMN_REACTION, COLUMN_SHARE, COLUMN_COUNT };
enum {
    ADVICE_DT,
    ADVICE_SUBSTEPS,
    ADVICE_SCHEME,
    ADVICE_COUPLING_RTOL,
    ADVICE_PREDICTOR,
    ADVICE_NEWTON_RTOL,
    ADVICE_ERROR,
    ADVICE_COST,
    ADVICE_PRESENT_ERROR, /* -1 if the session as it is fails */
    ADVICE_RUNS,
    ADVICE_WORK,
    ADVICE_COUNT
};

static inline spar_trial *trial_of(spar_session *s) {
    spar_trial *trial = s ? s->own->trials : NULL;
    if (s && !trial) {
        (void)spar_trial_create(s, &trial);
    }
    return trial;
}

static inline int trial_set(spar_session *s, double dt, int64_t steps, spar_before_step before, spar_fluid_solver solve,
                            void *context) {
    int status = spar_trial_set_steps(trial_of(s), dt, steps);
    return status == SPAR_OK ? spar_trial_set_callbacks(trial_of(s), before, context, solve, context) : status;
}

static inline int trial_run(spar_session *s, double dt, int64_t steps, spar_before_step before, spar_fluid_solver solve,
                            void *context, int compare, double report[TRY_COUNT]) {
    spar_trial *t = trial_of(s);
    int64_t evaluations = 0;
    int status = trial_set(s, dt, steps, before, solve, context);
    status = status == SPAR_OK ? spar_trial_run(t, compare) : status;
    if (status == SPAR_OK) {
        (void)spar_trial_get_errors(t, report + TRY_MOTION, report + TRY_REACTION, report + TRY_LOAD);
        (void)spar_trial_get_cost(t, report + TRY_SECONDS, &evaluations);
        report[TRY_EVALUATIONS] = (double)evaluations;
    }
    return status;
}

/* table[SPAR_ROW_COUNT][COLUMN_COUNT] */
static inline int trial_report_effects(spar_session *s, double dt, int64_t steps, spar_before_step before,
                                       spar_fluid_solver solve, void *context, double *table) {
    spar_trial *t = trial_of(s);
    int status = trial_set(s, dt, steps, before, solve, context);
    status = status == SPAR_OK ? spar_trial_report_effects(t) : status;
    for (int r = 0; r < SPAR_ROW_COUNT && status == SPAR_OK; r++) {
        int in_force, fails;
        double *x = table + r * COLUMN_COUNT;
        (void)spar_trial_get_effect(t, r, &in_force, &fails, x + COLUMN_SIZE, x + COLUMN_MOTION, x + COLUMN_REACTION,
                                    x + COLUMN_SHARE);
        x[COLUMN_IN_FORCE] = in_force;
        if (fails) {
            x[COLUMN_MOTION] = x[COLUMN_REACTION] = -1;
        }
    }
    return status;
}

/* table[SPAR_AERO_ROW_COUNT][COLUMN_COUNT] */
static inline int trial_report_aero(spar_aero *aero, spar_session *s, double dt, int64_t steps, spar_before_step before,
                                    spar_fluid_solver solve, void *context, double *table) {
    spar_trial *t = trial_of(s);
    int status = trial_set(s, dt, steps, before, solve, context);
    status = status == SPAR_OK ? spar_aero_report_effects(aero, t) : status;
    for (int r = 0; r < SPAR_AERO_ROW_COUNT && status == SPAR_OK; r++) {
        int in_force, fails;
        double *x = table + r * COLUMN_COUNT;
        (void)spar_aero_get_effect(aero, r, &in_force, &fails, x + COLUMN_SIZE, x + COLUMN_MOTION, x + COLUMN_REACTION,
                                   x + COLUMN_SHARE);
        x[COLUMN_IN_FORCE] = in_force;
        if (fails) {
            x[COLUMN_MOTION] = x[COLUMN_REACTION] = -1;
        }
    }
    return status;
}

static inline void trial_advice(const spar_trial *t, double advice[ADVICE_COUNT]) {
    int substeps, scheme, predictor, fails;
    int64_t runs;
    (void)spar_trial_get_settings(t, advice + ADVICE_DT, &substeps, &scheme, advice + ADVICE_COUPLING_RTOL, &predictor,
                                  advice + ADVICE_NEWTON_RTOL);
    (void)spar_trial_get_outcome(t, advice + ADVICE_ERROR, advice + ADVICE_COST, &fails, advice + ADVICE_PRESENT_ERROR);
    (void)spar_trial_get_search(t, &runs, advice + ADVICE_WORK);
    advice[ADVICE_SUBSTEPS] = substeps, advice[ADVICE_SCHEME] = scheme, advice[ADVICE_PREDICTOR] = predictor;
    advice[ADVICE_RUNS] = (double)runs;
    if (fails) {
        advice[ADVICE_PRESENT_ERROR] = -1;
    }
}

static inline int trial_advise(spar_session *s, double tolerance, double dt, int64_t steps, double length,
                               spar_before_step before, spar_fluid_solver solve, void *context,
                               double advice[ADVICE_COUNT]) {
    int status = trial_set(s, dt, steps, before, solve, context);
    status = status == SPAR_OK ? spar_trial_advise(trial_of(s), tolerance, length) : status;
    if (status == SPAR_OK) {
        trial_advice(trial_of(s), advice);
    }
    return status;
}

static inline int trial_get_beam(spar_member *m, int *fidelity, int64_t *modes, int *nodes, int *points) {
    spar_session *s = NULL;
    (void)spar_member_get_session(m, &s);
    return spar_trial_get_beam(trial_of(s), m, fidelity, modes, NULL, nodes, points);
}

/* Puts other elements of a beam in force, as if they had been advised. */
static inline int trial_give_elements(spar_session *s, const spar_member *beam, int elements, int per_element) {
    spar_trial *t = trial_of(s);
    spari_advised *a = &t->advised;
    free(a->beam);
    *a = (spari_advised){.given = 1, .of = spari_advised_of(s), .members = s->member_count};
    (void)spari_settings_varied(s, a->setting);
    a->beam = calloc((size_t)s->member_count, sizeof *a->beam);
    int64_t k = 0;
    for (const spar_member *m = s->members; m && a->beam; m = m->next, k++) {
        a->beam[k] = spari_rebuild_of(m);
        if (m == beam) {
            a->beam[k].elements = elements;
            a->beam[k].per_element = per_element;
        }
    }
    return spar_trial_apply(t, NULL);
}

static inline int trial_set_motion(spar_session *s, double dt, int64_t steps, int64_t modes, double amplitude,
                                   int64_t memory, spar_before_step before, spar_fluid_solver solve, void *context) {
    int status = trial_set(s, dt, steps, before, solve, context);
    return status == SPAR_OK ? spar_trial_set_motion(trial_of(s), modes, amplitude, memory) : status;
}

static inline int trial_eigenvalues(spar_session *s, double dt, int64_t memory, double amplitude,
                                    spar_before_step before, spar_fluid_solver solve, void *context, int64_t modes,
                                    int64_t n, const double shift[2], double *eigenvalue, int64_t nodes, double *shapes,
                                    double frame[3]) {
    int status = trial_set_motion(s, dt, 1, modes, amplitude, memory, before, solve, context);
    return status == SPAR_OK ? spar_trial_solve_eigenvalues(trial_of(s), n, shift, eigenvalue, nodes, shapes, frame)
                             : status;
}

static inline int trial_floquet(spar_session *s, double dt, int64_t steps, double amplitude, spar_before_step before,
                                spar_fluid_solver solve, void *context, int64_t modes, int64_t n, double *eigenvalue) {
    int status = trial_set_motion(s, dt, steps, modes, amplitude, 0, before, solve, context);
    return status == SPAR_OK ? spar_trial_solve_floquet(trial_of(s), n, eigenvalue) : status;
}

#endif
