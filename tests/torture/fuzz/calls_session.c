/* The calls on sessions and steps. */
#include "fuzz.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

static int odd_word(call *c) {
    static const int list[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, -1, 99, INT_MIN, INT_MAX};
    int x = list[below(c, (int)(sizeof list / sizeof *list))];
    text(c, "%d", x);
    return x;
}

/* What the fuzzer has named itself may be long. */
void is_name(const char *answer) {
    enum { LONGEST = 100000 };
    if (!answer || strlen(answer) > LONGEST) {
        fuzz_finding("text", "no name");
    }
}

void is_text(const char *answer) {
    if (!answer || strlen(answer) > 2000) {
        fuzz_finding("text", "no text");
    }
}

void do_spar_status_text(call *c) {
    int status = odd_word(c);
    RUN_VOID(c, is_text(spar_status_text(status)));
}

void do_spar_version(call *c) {
    RUN_VOID(c, is_text(spar_version()));
}

void do_spar_has(call *c) {
    static const char *const list[] = {NULL, "", "mpi", "gsl", "lapack", "MPI", "%n%s"};
    const char *what = list[below(c, 7)];
    text(c, "%s", what ? what : "NULL");
    RUN_VOID(c, (void)spar_has(what));
}

void do_spar_effect_name(call *c) {
    int row = odd_word(c);
    RUN_VOID(c, is_text(spar_effect_name(row)));
}

void do_spar_aero_effect_name(call *c) {
    int row = odd_word(c);
    RUN_VOID(c, is_text(spar_aero_effect_name(row)));
}

/* ---- session ---- */

static void begin_session(live_session *l, spar_session *s) {
    *l = (live_session){.s = s};
}

void do_spar_session_create(call *c) {
    int k = 0;
    while (k < SESSIONS - 1 && c->w->session[k].s) {
        k++;
    }
    spar_session *s = NULL;
    int nowhere = odd(c) || c->w->session[k].s;
    text(c, nowhere ? "NULL" : "&s%d", k);
    RUN(c, spar_session_create(nowhere ? NULL : &s));
    if (c->status == SPAR_OK) {
        begin_session(c->w->session + k, s);
    }
}

void do_spar_session_create_fcomm(call *c) {
    spar_session *s = NULL;
    int comm = odd_word(c), nowhere = odd(c);
    RUN(c, spar_session_create_fcomm(comm, nowhere ? NULL : &s));
    if (s || c->status == SPAR_OK) {
        fuzz_finding("handle", "a session over what is no communicator");
    }
}

/* What was made from it is dead. */
static void forget_session(world *w, int session) {
    for (int i = 0; i < JOINTS; i++) {
        if (w->joint[i].session == session) {
            w->joint[i].j = NULL;
        }
    }
    for (int i = 0; i < MEMBERS; i++) {
        if (w->member[i].session == session) {
            w->member[i].m = NULL;
        }
    }
    for (int i = 0; i < FLUIDS; i++) {
        if (w->fluid[i].session == session) {
            w->fluid[i].f = NULL;
        }
    }
    for (int i = 0; i < TRIALS; i++) {
        if (w->trial[i].session == session) {
            w->trial[i].t = NULL;
        }
    }
    for (int i = 0; i < AEROS; i++) {
        if (w->aero[i].a && w->aero[i].session == session) {
            spar_aero_destroy(&w->aero[i].a);
        }
    }
    w->session[session] = (live_session){0};
}

void do_spar_session_destroy(call *c) {
    live_session *l = arg_session(c);
    c->asked = 0;
    c->session = -1;
    if (!l->s) {
        spar_session *none = NULL;
        int nowhere = chance(c, 50);
        RUN_VOID(c, spar_session_destroy(nowhere ? NULL : &none));
        return;
    }
    if (l->busy) {
        return;
    }
    spar_session *s = l->s;
    forget_session(c->w, (int)(l - c->w->session));
    RUN_VOID(c, spar_session_destroy(&s));
    if (s) {
        fuzz_finding("handle", "a destroyed session's handle is not NULL");
    }
}

void do_spar_session_message(call *c) {
    live_session *l = arg_session(c);
    RUN_VOID(c, is_text(spar_session_message(l->s)));
}

void do_spar_session_get_warning(call *c) {
    live_session *l = arg_session(c);
    int64_t i = arg_count(c, 0, 40);
    RUN_VOID(c, is_text(spar_session_get_warning(l->s, i)));
}

/* The message of an earlier failure is put back, so that the checks of messages hold. */
static int fail_and_restore(spar_session *s, int status, const char *message) {
    char before[1024];
    (void)snprintf(before, sizeof before, "%s", spar_session_message(s));
    int answer = spar_session_fail(s, status, message);
    if (answer == SPAR_OK) {
        size_t n = strlen(message); /* the middle of a long one goes; a failure that was not read may follow */
        if (strncmp(spar_session_message(s), message, n < 400 ? n : 400) != 0) {
            fuzz_finding("message", "the message is '%.80s', not '%.80s'", spar_session_message(s), message);
        }
        (void)spar_session_fail(s, SPAR_OK, before);
    }
    return answer;
}

void do_spar_session_fail(call *c) {
    live_session *l = arg_session(c);
    int status = odd(c) ? 99 : below(c, SPAR_ERR_LIMIT + 1);
    const char *message = arg_name(c, "why");
    RUN(c, fail_and_restore(l->s, status, message));
}

void do_spar_session_set_gravity(call *c) {
    live_session *l = arg_session(c);
    double *g = arg_reals(c, 3, -10, 10);
    RUN(c, spar_session_set_gravity(l->s, g));
}

void do_spar_session_set_integrator(call *c) {
    live_session *l = arg_session(c);
    double rho = arg_real(c, 0, 1);
    int substeps = arg_limit(c, 1, 3);
    RUN(c, spar_session_set_integrator(l->s, rho, substeps));
}

void do_spar_session_set_newton(call *c) {
    live_session *l = arg_session(c);
    double atol = arg_real(c, 1e-13, 1e-10), rtol = arg_real(c, 1e-12, 1e-8);
    int most = chance(c, 20) ? 1 : arg_limit(c, 15, 60);
    c->wild |= most == 1;
    RUN(c, spar_session_set_newton(l->s, atol, rtol, most));
}

void do_spar_session_set_tolerance(call *c) {
    live_session *l = arg_session(c);
    double drift = arg_real(c, 0, 0.1), rtol = arg_real(c, 0, 0.1);
    RUN(c, spar_session_set_tolerance(l->s, drift, rtol));
}

void do_spar_session_get_step_control(call *c) {
    live_session *l = arg_session(c);
    double *ratio = OUT_OR_NULL(c, 1), *dt = OUT_OR_NULL(c, 1);
    int *reject = arg_out(c, (int64_t)sizeof *reject, 1);
    int64_t *rejected = arg_out(c, (int64_t)sizeof *rejected, 1);
    RUN(c, spar_session_get_step_control(l->s, ratio, dt, reject, rejected));
}

void do_spar_session_set_predictor(call *c) {
    live_session *l = arg_session(c);
    int order = arg_int(c, 0, 2);
    RUN(c, spar_session_set_predictor(l->s, order));
}

void do_spar_session_set_coupling(call *c) {
    live_session *l = arg_session(c);
    int scheme = arg_int(c, SPAR_COUPLING_EXPLICIT, SPAR_COUPLING_IQN_ILS);
    double atol = arg_real(c, 1e-9, 1e-5), rtol = arg_real(c, 1e-8, 1e-3);
    int most = arg_limit(c, 1, 12);
    RUN(c, spar_session_set_coupling(l->s, scheme, atol, rtol, most));
}

void do_spar_session_set_relaxation(call *c) {
    live_session *l = arg_session(c);
    double omega = arg_real(c, 0.1, 1.5);
    RUN(c, spar_session_set_relaxation(l->s, omega));
}

void do_spar_session_set_reproducible(call *c) {
    live_session *l = arg_session(c);
    int on = arg_int(c, 0, 1);
    RUN(c, spar_session_set_reproducible(l->s, on));
}

void do_spar_session_set_threads(call *c) {
    live_session *l = arg_session(c);
    int threads = arg_int(c, 1, 3);
    RUN(c, spar_session_set_threads(l->s, threads));
}

void do_spar_session_set_option(call *c) {
    static const char *const keys[] = {"newton.budget",        "coupling.unconverged", "coupling.columns",
                                       "coupling.reuse",       "coupling.filter",      "coupling.motion_atol",
                                       "coupling.motion_rtol", "coupling.norm",        "coupling.patience",
                                       "coupling.estimate",    "coupling.unstable"};
    static const char *const values[][3] = {{"1", "40", "10000"}, {"error", "accept", "accept"}, {"1", "3", "30"},
                                            {"0", "1", "5"},      {"0", "1e-4", "0.5"},          {"0", "1e-12", "1e-3"},
                                            {"0", "1e-6", "0.1"}, {"motion", "loads", "loads"},  {"1", "3", "1000000"},
                                            {"off", "on", "on"},  {"error", "accept", "accept"}};
    static const char *const strange[] = {"",   "nan",   "inf",    "-1", "1e999",  "1,5",  "0x10",  " 1",   "1 ",
                                          "%s", "10001", "1e-400", "-0", "accept", "keep", "1e300", "10000"};
    live_session *l = arg_session(c);
    enum { KEYS = sizeof keys / sizeof *keys };
    int k = below(c, KEYS);
    const char *key = keys[k], *value = values[k][below(c, 3)];
    if (odd(c)) {
        key = chance(c, 30) ? NULL : chance(c, 50) ? "coupling.none%n" : keys[below(c, KEYS)];
    }
    if (odd(c)) {
        value = chance(c, 20) ? NULL : strange[below(c, 17)];
        c->wild = 1;
    }
    text(c, ", \"%s\", \"%s\"", key ? key : "NULL", value ? value : "NULL");
    RUN(c, spar_session_set_option(l->s, key, value));
}

void do_spar_session_get_phase(call *c) {
    live_session *l = arg_session(c);
    int *phase = arg_out(c, (int64_t)sizeof *phase, 1);
    RUN(c, spar_session_get_phase(l->s, phase));
    if (c->status == SPAR_OK && phase && (*phase < SPAR_PHASE_START || *phase > SPAR_PHASE_CHECKED)) {
        fuzz_finding("phase", "phase %d", *phase);
    }
}

void do_spar_session_sum(call *c) {
    live_session *l = arg_session(c);
    int status = odd(c) ? -1 : SPAR_OK;
    int64_t n = arg_count(c, 0, 6);
    double *x = arg_reals(c, length(n), -1, 1);
    RUN(c, spar_session_sum(l->s, status, n, x));
}

void do_spar_session_sum_balance(call *c) {
    live_session *l = arg_session(c);
    int64_t n = arg_count(c, 0, 6);
    int64_t *members = arg_out(c, length(n) * (int64_t)sizeof *members, 1);
    double *expected = arg_out(c, length(n) * (int64_t)sizeof *expected, 1);
    double *counted = arg_out(c, length(n) * (int64_t)sizeof *counted, 1);
    RUN(c, spar_session_sum_balance(l->s, n, members, expected, counted));
}

void do_spar_session_get_option(call *c) {
    static const char *const keys[] = {
        "coupling.unconverged", "coupling.estimate", "coupling.columns", "coupling.filter",
        "coupling.norm",        "coupling.patience", "no.option",        "spar%n"};
    live_session *l = arg_session(c);
    const char *key = odd(c) ? NULL : keys[below(c, 8)];
    int64_t n = arg_count(c, 0, 30);
    char *into = arg_out(c, length(n), 1);
    text(c, ", \"%s\"", key ? key : "NULL");
    RUN(c, spar_session_get_option(l->s, key, n, into));
}

void do_spar_session_get_iterations(call *c) {
    live_session *l = arg_session(c);
    int *iterations = arg_out(c, sizeof(int), 1);
    int64_t n = arg_count(c, 0, 60);
    double *residual = OUT_OR_NULL(c, length(n)), *size = OUT_OR_NULL(c, length(n));
    RUN(c, spar_session_get_iterations(l->s, iterations, n, residual, size));
}

void do_spar_session_get_report(call *c) {
    live_session *l = arg_session(c);
    int64_t n = arg_count(c, 0, SPAR_REPORT_COUNT + 2);
    double *report = OUT_OR_NULL(c, length(n));
    RUN(c, spar_session_get_report(l->s, n, report));
}

void do_spar_session_set_log(call *c) {
    live_session *l = arg_session(c);
    int on = chance(c, 70);
    text(c, on ? ", log" : ", NULL");
    RUN(c, spar_session_set_log(l->s, on ? fuzz_log : NULL, l));
    if (c->status == SPAR_OK) {
        l->logs = on;
    }
}

/* Nothing that would be written: standard error is watched. */
void do_spar_log_stderr(call *c) {
    live_session *l = arg_session(c);
    const int written = chance(c, 50);
    const char *message = written ? NULL : arg_name(c, "x");
    const int level = written ? SPAR_LOG_ERROR : SPAR_LOG_INFO;
    text(c, ", %d", level);
    RUN_VOID(c, spar_log_stderr(l->s, level, message, NULL));
}

void do_spar_session_set_progress(call *c) {
    live_session *l = arg_session(c);
    int on = chance(c, 70);
    text(c, on ? ", progress" : ", NULL");
    RUN(c, spar_session_set_progress(l->s, on ? fuzz_iterations : NULL, l));
}

/* ---- steps ---- */

void do_spar_step_begin(call *c) {
    live_session *l = arg_session(c);
    double dt = arg_dt(c);
    RUN(c, spar_step_begin(l->s, dt));
}

void do_spar_step_solve(call *c) {
    live_session *l = arg_session(c);
    RUN(c, spar_step_solve(l->s));
}

void do_spar_step_check(call *c) {
    live_session *l = arg_session(c);
    int *done = arg_out(c, sizeof *done, 0);
    RUN(c, spar_step_check(l->s, done));
    if (c->status == SPAR_OK && *done != 0 && *done != 1) {
        fuzz_finding("done", "done is %d", *done);
    }
}

void do_spar_step_accept(call *c) {
    live_session *l = arg_session(c);
    RUN(c, spar_step_accept(l->s));
}

void do_spar_step_reject(call *c) {
    live_session *l = arg_session(c);
    RUN(c, spar_step_reject(l->s));
}

void do_spar_step(call *c) {
    live_session *l = arg_session(c);
    double dt = arg_dt(c);
    spar_fluid_solver solve;
    host *h = arg_host(c, &solve, NULL);
    int *iterations = arg_out(c, sizeof *iterations, 1);
    RUN(c, spar_step(l->s, dt, solve, h, iterations));
}

void do_spar_session_solve_initial(call *c) {
    live_session *l = arg_session(c);
    double dt = arg_dt(c);
    spar_fluid_solver solve;
    host *h = arg_host(c, &solve, NULL);
    int *iterations = arg_out(c, sizeof *iterations, 1);
    RUN(c, spar_session_solve_initial(l->s, dt, solve, h, iterations));
}

void do_spar_step_adaptive(call *c) {
    live_session *l = arg_session(c);
    spar_fluid_solver solve;
    spar_before_step before;
    host *h = arg_host(c, &solve, &before);
    double *dt = arg_out(c, sizeof *dt, 1), *taken = OUT_OR_NULL(c, 1);
    if (dt) {
        *dt = 0.01;
    }
    RUN(c, spar_step_adaptive(l->s, dt, before, solve, h, taken));
}

void do_spar_step_begin_initial(call *c) {
    live_session *l = arg_session(c);
    double dt = arg_dt(c);
    RUN(c, spar_step_begin_initial(l->s, dt));
}

void do_spar_session_solve_static(call *c) {
    live_session *l = arg_session(c);
    int load_steps = arg_limit(c, 1, 3);
    spar_fluid_solver solve;
    host *h = arg_host(c, &solve, NULL);
    int *iterations = arg_out(c, sizeof *iterations, 1);
    RUN(c, spar_session_solve_static(l->s, load_steps, solve, h, iterations));
}

/* ---- files ---- */

void do_spar_session_save(call *c) {
    live_session *l = arg_session(c);
    const char *path = arg_path(c, ".spar");
    RUN(c, spar_session_save(l->s, path));
}

void do_spar_session_load(call *c) {
    live_session *l = arg_session(c);
    const char *path = arg_path(c, ".spar");
    RUN(c, spar_session_load(l->s, path));
}

/* One byte of a saved file is another, or its end is gone. */
void do_damage_file(call *c) {
    static char bytes[1 << 16];
    char path[128];
    snprintf(path, sizeof path, "%s/f%d.spar", c->w->folder, below(c, 3));
    text(c, "%s", path);
    fuzz_before(c);
    FILE *f = fopen(path, "rb");
    size_t n = f ? fread(bytes, 1, sizeof bytes, f) : 0;
    if (f) {
        (void)fclose(f);
    }
    f = n > 0 ? fopen(path, "wb") : NULL;
    if (f) {
        bytes[word(c) % n] ^= (char)(1 << below(c, 8));
        (void)fwrite(bytes, 1, chance(c, 50) ? n : word(c) % n, f);
        (void)fclose(f);
    }
    fuzz_after(c, SPAR_OK);
}

void do_spar_section_report(call *c) {
    double *stiffness = arg_reals(c, 36, -1, 1);
    double *mass = arg_reals_or_null(c, 36, -1, 1);
    int64_t n = arg_count(c, 0, 1000);
    char *into = arg_out(c, length(n), 0);
    RUN(c, spar_section_report(stiffness, mass, n, into));
}

void do_spar_vtk_series_add(call *c) {
    const char *path = arg_path(c, ".pvd");
    double time = arg_real(c, 0, 10);
    int part = arg_int(c, 0, 3);
    const char *file = arg_name(c, "v");
    RUN(c, spar_vtk_series_add(path, time, part, file));
}
