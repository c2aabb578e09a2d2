/* The handle spar_trial: create, destroy, settings. See handle.h. */
#include "handle.h"

#include "../base/environment.h"
#include "../base/setting.h"
#include "../comm/enter.h"
#include "../member/check_arguments.h"

#include <assert.h>
#include <string.h>

enum { MOST_TRIALS = 15 }; /* of advice, unless the host allows more */

/* ---- life ---- */

static void free_trial(spar_trial *t) {
    spari_record_free(&t->kept);
    SPARI_FREE(t->advised.beam, t);
}

static void free_trials(spar_trial *first) {
    for (spar_trial *t = first, *next; t; t = next) {
        next = t->next;
        free_trial(t);
    }
}

int spar_trial_create(spar_session *session, spar_trial **trial) {
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    SPARI_REQUIRE(session, trial, SPAR_ERR_ARGUMENT, "%s: trial is NULL; give the address of a handle", __func__);
    spar_trial *t = spari_zalloc(1, sizeof *t), **end = &session->own->trials;
    SPARI_REQUIRE(session, t, SPAR_ERR_MEMORY, "%s: no memory", __func__);
    t->session = session;
    t->number = session->own->trials_created++;
    t->search.goals = SPAR_GOAL_MOTION;
    t->search.limit = MOST_TRIALS;
    while (*end) {
        end = &(*end)->next;
    }
    *end = t;
    session->own->free_trials = free_trials;
    *trial = t;
    return SPAR_OK;
}

void spar_trial_destroy(spar_trial **trial) {
    if (!trial || !*trial) {
        return;
    }
    spar_trial *t = *trial, **at = &t->session->own->trials;
    *trial = NULL;
    t->gone = t->running;
    if (t->running) {
        return;
    }
    while (*at != t) {
        at = &(*at)->next;
    }
    *at = t->next;
    free_trial(t);
}

/* A call of several runs, in a library on top of this one, may still have the handle. */
static int check_lives(const spar_trial *trial, const char *call) {
    SPARI_REQUIRE(NULL, trial, SPAR_ERR_ARGUMENT, "%s: the trial is NULL; create it first", call);
    SPARI_REQUIRE(trial->session, !trial->gone, SPAR_ERR_STATE,
                  "%s: a callback has destroyed the trial in its run; destroy it after the call", call);
    return SPAR_OK;
}

int spar_trial_get_session(const spar_trial *trial, spar_session **session) {
    SPARI_TRY(check_lives(trial, __func__));
    SPARI_REQUIRE(trial->session, session, SPAR_ERR_ARGUMENT, "%s: session is NULL; give the address of a handle",
                  __func__);
    *session = trial->session;
    return SPAR_OK;
}

/* ---- settings ---- */

static int trial_settable(spar_trial *trial, const char *call) {
    SPARI_TRY(check_lives(trial, call));
    SPARI_REQUIRE(trial->session, !trial->running, SPAR_ERR_STATE,
                  "%s: the trial is running; change its settings before or after", call);
    return SPAR_OK;
}

int spar_trial_set_steps(spar_trial *trial, double dt, int64_t steps) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(trial_settable(trial, __func__));
    int none = dt == 0 && steps == 0; /* as read from a new trial */
    SPARI_TRY(none ? SPAR_OK : spari_need_dt(trial->session, __func__, dt));
    SPARI_REQUIRE(trial->session, steps >= 1 || none, SPAR_ERR_ARGUMENT, "%s: %lld steps; give at least 1", __func__,
                  (long long)steps);
    trial->dt = dt;
    trial->steps = steps;
    return SPAR_OK;
}

int spar_trial_get_steps(const spar_trial *trial, double *dt, int64_t *steps) {
    SPARI_REQUIRE(NULL, trial, SPAR_ERR_ARGUMENT, "%s: the trial is NULL; create it first", __func__);
    SPARI_GIVE(dt, trial->dt);
    SPARI_GIVE(steps, trial->steps);
    return SPAR_OK;
}

int spar_trial_set_callbacks(spar_trial *trial, spar_before_step before, void *before_context, spar_fluid_solver solve,
                             void *solve_context) {
    SPARI_TRY(trial_settable(trial, __func__));
    trial->before = before;
    trial->before_context = before_context;
    trial->solve = solve;
    trial->solve_context = solve_context;
    return SPAR_OK;
}

int spar_trial_set_progress(spar_trial *trial, spar_progress progress, void *context) {
    SPARI_TRY(trial_settable(trial, __func__));
    trial->progress = progress;
    trial->progress_context = context;
    return SPAR_OK;
}

int spar_trial_set_goals(spar_trial *trial, int goals) {
    const int all = SPAR_GOAL_MOTION | SPAR_GOAL_REACTION | SPAR_GOAL_SECTION | SPAR_GOAL_LOAD | SPAR_GOAL_NUMBERS;
    SPARI_TRY(trial_settable(trial, __func__));
    SPARI_REQUIRE(trial->session, goals >= 1 && goals <= all, SPAR_ERR_ARGUMENT,
                  "%s: goals is %d; give at least one SPAR_GOAL_*, combined with or", __func__, goals);
    trial->search.goals = goals;
    return SPAR_OK;
}

int spar_trial_get_goals(const spar_trial *trial, int *goals) {
    SPARI_REQUIRE(NULL, trial, SPAR_ERR_ARGUMENT, "%s: the trial is NULL; create it first", __func__);
    SPARI_GIVE(goals, trial->search.goals);
    return SPAR_OK;
}

int spar_trial_push_numbers(spar_trial *trial, int64_t n, const double *numbers) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, trial, SPAR_ERR_ARGUMENT, "%s: the trial is NULL; create it first", __func__);
    SPARI_REQUIRE(trial->session, n >= 0 && n <= SPARI_MOST_NUMBERS && (numbers || n == 0), SPAR_ERR_ARGUMENT,
                  "%s: %lld numbers%s; give 0 to %d", __func__, (long long)n, numbers ? "" : " without an array",
                  SPARI_MOST_NUMBERS);
    int64_t bad = numbers ? spari_first_nonfinite(numbers, n) : -1;
    SPARI_REQUIRE(trial->session, bad < 0, SPAR_ERR_ARGUMENT, "%s: number %lld is %g; give finite numbers", __func__,
                  (long long)bad, numbers[bad]);
    memset(trial->numbers, 0, sizeof trial->numbers);
    for (int64_t i = 0; i < n; i++) {
        trial->numbers[i] = numbers[i];
    }
    return SPAR_OK;
}

int spar_trial_set_motion(spar_trial *trial, int64_t modes, double amplitude, int64_t memory) {
    const double most_amplitude = 0.1;
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(trial_settable(trial, __func__));
    SPARI_REQUIRE(trial->session, modes >= 0 && modes <= SPARI_MOST_MODES, SPAR_ERR_ARGUMENT,
                  "%s: %lld modes; give 1 to %d", __func__, (long long)modes, SPARI_MOST_MODES);
    SPARI_REQUIRE(trial->session, amplitude >= 0 && amplitude <= most_amplitude, SPAR_ERR_ARGUMENT,
                  "%s: an amplitude of %g; give up to %g, or 0 for the default", __func__, amplitude, most_amplitude);
    SPARI_REQUIRE(trial->session, memory >= 0 && memory <= SPARI_MOST_MEMORY, SPAR_ERR_ARGUMENT,
                  "%s: a memory of %lld steps; give 0 to %d", __func__, (long long)memory, SPARI_MOST_MEMORY);
    trial->modes = modes;
    trial->amplitude = amplitude;
    trial->memory = memory;
    return SPAR_OK;
}

int spar_trial_get_motion(const spar_trial *trial, int64_t *modes, double *amplitude, int64_t *memory) {
    SPARI_REQUIRE(NULL, trial, SPAR_ERR_ARGUMENT, "%s: the trial is NULL; create it first", __func__);
    SPARI_GIVE(modes, trial->modes);
    SPARI_GIVE(amplitude, trial->amplitude);
    SPARI_GIVE(memory, trial->memory);
    return SPAR_OK;
}

/* ---- options: rows as in session/settings.c, whose fields are in the trial ---- */

#define KEEP(key, field)                                                                                               \
    {                                                                                                                  \
        "option " key " (1: keep)", key, offsetof(spar_trial, search.field), SPARI_IS_WORD, 0, 0, 1, "vary or keep",   \
            {"vary", "keep"}, 0, SPARI_AGREED                                                                          \
    }
#define LIMIT(least, most, range)                                                                                      \
    {                                                                                                                  \
        "option limit", "limit", offsetof(spar_trial, search.limit), SPARI_IS_WHOLE, 0, least, most, range,            \
            {NULL, NULL}, MOST_TRIALS, SPARI_AGREED                                                                    \
    }
static const spari_setting options[] = {KEEP("dt", keep_dt), KEEP("nodes", keep_nodes), KEEP("coupling", keep_coupling),
                                        LIMIT(4, 1000, "4 to 1000 trials")};
enum { OPTIONS = sizeof options / sizeof *options };

static int trial_option(const spar_trial *trial, const char *call, const char *key, const spari_setting **of) {
    char keys[SPARI_MESSAGE_SIZE / 2];
    *of = spari_setting_find(options, OPTIONS, 0, key);
    SPARI_REQUIRE(trial->session, *of, SPAR_ERR_ARGUMENT, "%s: there is no option '%s'; give one of %s", call, key,
                  spari_setting_keys(options, OPTIONS, 0, keys, sizeof keys));
    return SPAR_OK;
}

int spar_trial_set_option(spar_trial *trial, const char *key, const char *value) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(trial_settable(trial, __func__));
    SPARI_REQUIRE(trial->session, key && value, SPAR_ERR_ARGUMENT, "%s: key or value is NULL", __func__);
    const spari_setting *of;
    SPARI_TRY(trial_option(trial, __func__, key, &of));
    double x;
    SPARI_REQUIRE(trial->session, spari_setting_read(of, value, &x), SPAR_ERR_ARGUMENT,
                  "%s: option '%s' does not accept '%s'; give %s", __func__, key, value, of->range);
    spari_setting_store(trial, of, x);
    return SPAR_OK;
}

int spar_trial_get_option(const spar_trial *trial, const char *key, int64_t capacity, char *text) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, trial, SPAR_ERR_ARGUMENT, "%s: the trial is NULL; create it first", __func__);
    SPARI_REQUIRE(trial->session, key && text, SPAR_ERR_ARGUMENT, "%s: key or text is NULL", __func__);
    const spari_setting *of;
    SPARI_TRY(trial_option(trial, __func__, key, &of));
    return spari_setting_write(trial->session, __func__, of, spari_setting_value(trial, of), capacity, text);
}

/* ---- entry of collective calls ---- */

spari_run spari_trial_run_of(const spar_trial *t, spari_progress *progress) {
    return (spari_run){.dt = t->dt,
                       .steps = t->steps,
                       .before = t->before,
                       .before_context = t->before_context,
                       .solve = t->solve,
                       .solve_context = t->solve_context,
                       .numbers = t->numbers,
                       .progress = progress};
}

spari_progress spari_trial_progress(const spar_trial *t, const char *call) {
    return (spari_progress){.call = call, .tell = t->progress, .context = t->progress_context};
}

int spari_trial_ready(spar_trial *t, const char *call) {
    SPARI_TRY(spari_trial_check(t->session, call));
    SPARI_REQUIRE(t->session, t->steps > 0, SPAR_ERR_STATE,
                  "%s: the trial has no steps; call spar_trial_set_steps first", call);
    return SPAR_OK;
}

int spari_trial_ready_for_runs(spar_trial *t, const char *call) {
    SPARI_TRY(spari_trial_ready(t, call));
    return spari_trial_check_steps(t->session, call, t->dt, t->steps);
}

int spari_trial_enter(spar_trial *t, const char *call, const spari_agreed *arguments, int count, int status) {
    enum { OWN = 14 };
    spari_agreed all[OWN + SPARI_MOST_ARGUMENTS] = {spari_whole("number of the trial", t->number),
                                                    spari_real("dt", t->dt),
                                                    spari_whole("steps", t->steps),
                                                    spari_given("before", t->before != NULL),
                                                    spari_given("solve", t->solve != NULL),
                                                    spari_given("progress callback", t->progress != NULL),
                                                    spari_whole("goals", t->search.goals),
                                                    spari_whole("modes", t->modes),
                                                    spari_real("amplitude", t->amplitude),
                                                    spari_whole("memory", t->memory),
                                                    spari_whole("option dt", t->search.keep_dt),
                                                    spari_whole("option nodes", t->search.keep_nodes),
                                                    spari_whole("option coupling", t->search.keep_coupling),
                                                    spari_whole("option limit", t->search.limit)};
    assert(count <= SPARI_MOST_ARGUMENTS);
    status = status == SPAR_OK && !t->running ? check_lives(t, call) : status;
    for (int k = 0; k < count; k++) {
        all[OWN + k] = arguments[k];
    }
    SPARI_TRY(spari_enter_agreed(t->session, call, all, OWN + count, status));
    t->running = 1;
    memcpy(t->message, t->session->message, sizeof t->message);
    return SPAR_OK;
}

int spari_trial_leave(spar_trial *t, const char *call, int status) {
    if (status == SPAR_OK) {
        spari_put_message_back(t->session, t->message);
    }
    status = spari_named(t->session, call, status);
    t->running = 0; /* one that is gone is freed with its session */
    return status;
}
