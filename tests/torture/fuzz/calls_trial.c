/* The calls on trials. */
#include "fuzz.h"

#include <limits.h>
#include <string.h>

static live_trial *free_slot(world *w) {
    for (int i = 0; i < TRIALS; i++) {
        if (!w->trial[i].t && w->trial[i].busy == 0) {
            return w->trial + i;
        }
    }
    return NULL;
}

void do_spar_trial_create(call *c) {
    live_session *l = arg_session(c);
    spar_trial *t = NULL;
    int nowhere = odd(c);
    RUN(c, spar_trial_create(l->s, nowhere ? NULL : &t));
    live_trial *at = free_slot(c->w);
    if (c->status == SPAR_OK && at) {
        *at = (live_trial){.t = t, .session = c->session, .made = ++c->w->clock};
    }
}

/* One that runs is destroyed when it ends. */
void do_spar_trial_destroy(call *c) {
    live_trial *t = arg_trial(c);
    c->asked = 0;
    c->session = -1;
    if (!t->t) {
        spar_trial *none = NULL;
        int nowhere = chance(c, 50);
        RUN_VOID(c, spar_trial_destroy(nowhere ? NULL : &none));
        return;
    }
    RUN_VOID(c, spar_trial_destroy(&t->t));
    if (t->t) {
        fuzz_finding("handle", "a destroyed trial's handle is not NULL");
    }
}

void do_spar_trial_get_session(call *c) {
    live_trial *t = arg_trial(c);
    spar_session *s = NULL;
    RUN(c, spar_trial_get_session(t->t, &s));
    if (c->status == SPAR_OK && s != c->w->session[t->session].s) {
        fuzz_finding("handle", "a trial is of another session");
    }
}

void do_spar_trial_set_steps(call *c) {
    static const int64_t list[] = {0, -8, 7, 12, -1, INT64_MIN, 1};
    live_trial *t = arg_trial(c);
    double dt = arg_dt(c);
    int64_t steps = odd(c) ? list[below(c, 7)] : chance(c, 90) ? 8 : 16;
    text(c, ", %lld", (long long)steps);
    RUN(c, spar_trial_set_steps(t->t, dt, steps));
}

void do_spar_trial_get_steps(call *c) {
    live_trial *t = arg_trial(c);
    double *dt = OUT_OR_NULL(c, 1);
    int64_t *steps = arg_out(c, sizeof *steps, 1);
    RUN(c, spar_trial_get_steps(t->t, dt, steps));
}

void do_spar_trial_set_callbacks(call *c) {
    live_trial *t = arg_trial(c);
    spar_fluid_solver solve;
    spar_before_step before;
    host *h = arg_host(c, &solve, &before);
    RUN(c, spar_trial_set_callbacks(t->t, before, &t->host, solve, &t->host));
    if (c->status == SPAR_OK) {
        t->host = *h;
        t->host.session = t->session;
    }
}

void do_spar_trial_set_progress(call *c) {
    live_trial *t = arg_trial(c);
    int on = chance(c, 70);
    text(c, on ? ", progress" : ", NULL");
    RUN(c, spar_trial_set_progress(t->t, on ? fuzz_progress : NULL, c->w->session + t->session));
}

void do_spar_trial_set_goals(call *c) {
    live_trial *t = arg_trial(c);
    int goals = arg_int(c, 1, 31);
    RUN(c, spar_trial_set_goals(t->t, goals));
}

void do_spar_trial_get_goals(call *c) {
    live_trial *t = arg_trial(c);
    int *goals = arg_out(c, (int64_t)sizeof *goals, 1);
    RUN(c, spar_trial_get_goals(t->t, goals));
}

void do_spar_trial_push_numbers(call *c) {
    live_trial *t = arg_trial(c);
    int64_t n = arg_count(c, 0, 32);
    double *numbers = arg_reals(c, length(n), -10, 10);
    RUN(c, spar_trial_push_numbers(t->t, n, numbers));
}

void do_spar_trial_set_option(call *c) {
    static const char *const keys[] = {"dt", "nodes", "coupling", "limit"};
    static const char *const values[] = {"vary", "keep", "0", "1e-6", "1000", "0.5", "1"}, *const strange[] = {
                                                                                               "",     "nan",   "inf",
                                                                                               "-1",   "1e999", "1,5",
                                                                                               "0x10", " 1",    "%s",
                                                                                               "1e300"};
    live_trial *t = arg_trial(c);
    int k = below(c, 4);
    const char *key = keys[k], *value = values[k < 3 ? below(c, 2) : 2 + below(c, 5)];
    if (odd(c)) {
        key = chance(c, 30) ? NULL : "none%n";
    }
    if (odd(c)) {
        value = chance(c, 20) ? NULL : strange[below(c, 10)];
    }
    text(c, ", \"%s\", \"%s\"", key ? key : "NULL", value ? value : "NULL");
    RUN(c, spar_trial_set_option(t->t, key, value));
}

void do_spar_trial_get_option(call *c) {
    static const char *const keys[] = {"dt", "nodes", "coupling", "limit", "none%n"};
    live_trial *t = arg_trial(c);
    const char *key = odd(c) ? NULL : keys[below(c, 5)];
    int64_t n = arg_count(c, 0, 30);
    char *into = arg_out(c, length(n), 1);
    text(c, ", \"%s\"", key ? key : "NULL");
    RUN(c, spar_trial_get_option(t->t, key, n, into));
}

void do_spar_trial_set_motion(call *c) {
    live_trial *t = arg_trial(c);
    int64_t modes = arg_count(c, 1, 4);
    double amplitude = arg_real(c, 0, 0.05);
    int64_t memory = arg_count(c, 0, 12);
    RUN(c, spar_trial_set_motion(t->t, modes, amplitude, memory));
}

void do_spar_trial_get_motion(call *c) {
    live_trial *t = arg_trial(c);
    int64_t *modes = arg_out(c, sizeof *modes, 1);
    double *amplitude = OUT_OR_NULL(c, 1);
    int64_t *memory = arg_out(c, sizeof *memory, 1);
    RUN(c, spar_trial_get_motion(t->t, modes, amplitude, memory));
}

/* ---- runs ---- */

/* The same call again is the same: a host counts from 0. */
#define RUN_TRIAL(c, trial, expression)                                                                                \
    do {                                                                                                               \
        (trial)->host.count = (trial)->busy == 0 ? 0 : (trial)->host.count;                                            \
        (trial)->busy++;                                                                                               \
        RUN(c, expression);                                                                                            \
        (trial)->busy--;                                                                                               \
    } while (0)

void do_spar_trial_run(call *c) {
    live_trial *t = arg_trial(c);
    int compare = arg_int(c, 0, 1);
    RUN_TRIAL(c, t, spar_trial_run(t->t, compare));
}

void do_spar_trial_get_errors(call *c) {
    live_trial *t = arg_trial(c);
    double *motion = OUT_OR_NULL(c, 1), *reaction = OUT_OR_NULL(c, 1), *load = OUT_OR_NULL(c, 1);
    RUN(c, spar_trial_get_errors(t->t, motion, reaction, load));
}

void do_spar_trial_get_cost(call *c) {
    live_trial *t = arg_trial(c);
    double *seconds = OUT_OR_NULL(c, 1);
    int64_t *evaluations = arg_out(c, sizeof *evaluations, 1);
    RUN(c, spar_trial_get_cost(t->t, seconds, evaluations));
}

void do_spar_trial_report_effects(call *c) {
    live_trial *t = arg_trial(c);
    RUN_TRIAL(c, t, spar_trial_report_effects(t->t));
}

void do_spar_trial_get_effect(call *c) {
    live_trial *t = arg_trial(c);
    int row = arg_int(c, 0, SPAR_ROW_COUNT - 1);
    int *in_force = arg_out(c, sizeof *in_force, 1), *fails = arg_out(c, sizeof *fails, 1);
    double *size = OUT_OR_NULL(c, 1), *motion = OUT_OR_NULL(c, 1), *reaction = OUT_OR_NULL(c, 1),
           *share = OUT_OR_NULL(c, 1);
    RUN(c, spar_trial_get_effect(t->t, row, in_force, fails, size, motion, reaction, share));
}

/* Of the trial's motion, or 1. */
static int64_t modes_of(const live_trial *t) {
    int64_t modes = 0;
    return t->t && spar_trial_get_motion(t->t, &modes, NULL, NULL) == SPAR_OK && modes > 0 && modes < 9 ? modes : 1;
}

void do_spar_trial_solve_eigenvalues(call *c) {
    live_trial *t = arg_trial(c);
    int64_t n = arg_count(c, 0, modes_of(t)), room = length(n);
    double *shift = arg_reals_or_null(c, 2, -30, 100), *eigenvalue = OUT(c, 2 * room), *frame = OUT_OR_NULL(c, 3);
    RUN_TRIAL(c, t, spar_trial_solve_eigenvalues(t->t, n, shift, eigenvalue, 0, NULL, frame));
}

void do_spar_trial_solve_floquet(call *c) {
    live_trial *t = arg_trial(c);
    int64_t n = arg_count(c, 0, modes_of(t)), room = length(n);
    double *eigenvalue = OUT(c, 2 * room);
    RUN_TRIAL(c, t, spar_trial_solve_floquet(t->t, n, eigenvalue));
}

void do_spar_trial_advise(call *c) {
    live_trial *t = arg_trial(c);
    double tolerance = arg_real(c, 0.01, 0.5), run = arg_real(c, 1e-3, 0.02);
    RUN_TRIAL(c, t, spar_trial_advise(t->t, tolerance, run));
}

void do_spar_trial_get_settings(call *c) {
    live_trial *t = arg_trial(c);
    double *dt = OUT_OR_NULL(c, 1), *coupling = OUT_OR_NULL(c, 1), *newton = OUT_OR_NULL(c, 1);
    int *substeps = arg_out(c, sizeof(int), 1), *scheme = arg_out(c, sizeof(int), 1),
        *predictor = arg_out(c, sizeof(int), 1);
    RUN(c, spar_trial_get_settings(t->t, dt, substeps, scheme, coupling, predictor, newton));
}

void do_spar_trial_get_beam(call *c) {
    live_trial *t = arg_trial(c);
    live_member *m = arg_member(c, -1);
    int *fidelity = arg_out(c, sizeof(int), 1), *elements = arg_out(c, sizeof(int), 1),
        *nodes = arg_out(c, sizeof(int), 1), *points = arg_out(c, sizeof(int), 1);
    int64_t *modes = arg_out(c, sizeof(int64_t), 1);
    RUN(c, spar_trial_get_beam(t->t, m->m, fidelity, modes, elements, nodes, points));
}

void do_spar_trial_get_outcome(call *c) {
    live_trial *t = arg_trial(c);
    double *error = OUT_OR_NULL(c, 1), *cost = OUT_OR_NULL(c, 1), *present = OUT_OR_NULL(c, 1);
    int *fails = arg_out(c, sizeof(int), 1);
    RUN(c, spar_trial_get_outcome(t->t, error, cost, fails, present));
}

void do_spar_trial_get_search(call *c) {
    live_trial *t = arg_trial(c);
    int64_t *runs = arg_out(c, sizeof *runs, 1);
    double *work = OUT_OR_NULL(c, 1);
    RUN(c, spar_trial_get_search(t->t, runs, work));
}

void do_spar_trial_apply(call *c) {
    live_trial *t = arg_trial(c);
    double *dt = OUT_OR_NULL(c, 1);
    int session = t->session;
    RUN_TRIAL(c, t, spar_trial_apply(t->t, dt));
    for (int i = 0; i < MEMBERS; i++) { /* beams may have other nodes now */
        live_member *m = c->w->member + i;
        if (m->m && m->kind == KIND_BEAM && m->session == session) {
            (void)spar_beam_get_elements(m->m, &m->elements, &m->per_element);
        }
    }
}
