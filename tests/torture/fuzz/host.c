/* What a host's callbacks do: their work, fail, or call back in ways they may and may not. */
#include "fuzz.h"

#include <math.h>
#include <string.h>

static void note_push(world *w, int status) {
    w->failures += status != SPAR_OK;
}

/* Loads that depend on the motion alone, so that runs can be repeated. */
static int exchange(world *w, int session) {
    for (int i = 0; i < FLUIDS; i++) {
        live_fluid *f = w->fluid + i;
        if (!f->f || f->session != session) {
            continue;
        }
        int64_t n = fluid_count(f, SPAR_NODES_MOTION), m = fluid_count(f, SPAR_NODES_FORCE), at[2], to[2];
        if (fluid_room(f, SPAR_NODES_MOTION) > 3 * 64 || fluid_room(f, SPAR_NODES_FORCE) > 3 * 64) {
            continue;
        }
        (void)spar_fluid_get_layout(f->f, SPAR_NODES_MOTION, &at[0], &at[1]);
        (void)spar_fluid_get_layout(f->f, SPAR_NODES_FORCE, &to[0], &to[1]);
        double x[3 * 64] = {0}, v[3 * 64] = {0}, force[3 * 64] = {0};
        int status = spar_fluid_pull_motion(f->f, 1, x, v);
        for (int64_t k = 0; k < 3 * m; k++) {
            double u = n > 0 ? v[k / 3 % n * at[0] + k % 3 * at[1]] : 0;
            force[k / 3 * to[0] + k % 3 * to[1]] = 0.1 + (fabs(u) < 10 ? -0.05 * u : 0);
        }
        w->failures += status != SPAR_OK;
        if (status == SPAR_OK) {
            note_push(w, spar_fluid_push_forces(f->f, force, m > 0 && i % 2 ? force : NULL));
        }
    }
    for (int i = 0; i < AEROS; i++) {
        live_aero *a = w->aero + i;
        double wind[3 * 64];
        if (a->a && !a->orphan && a->session == session && a->blades * a->n <= 64) {
            for (int64_t k = 0; k < a->blades * a->n; k++) {
                wind[3 * k] = 5;
                wind[3 * k + 1] = 2;
                wind[3 * k + 2] = 8;
            }
            note_push(w, spar_aero_solve(a->a, 1.2, wind, 1));
        }
    }
    return 0;
}

static int work(host *h, int64_t turn) {
    world *w = h->w;
    h->count++;
    uint64_t random = fuzz_mix(h->seed, (uint64_t)turn);
    if (h->mode == HOST_FAILS && h->count > h->fail_at) {
        return random % 3 == 0 ? -1 : (int)(1 + random % 1000);
    }
    if (h->mode == HOST_CHAOS && w->depth < 2) {
        w->depth++;
        for (int n = (int)(random % 4); n > 0 && w->budget > 0; n--) {
            w->budget--;
            uint64_t pick = fuzz_next(&random);
            record r = {(int)(pick % CALL_COUNT), 0, fuzz_next(&random)};
            fuzz_run(w, &r);
        }
        w->depth--;
    }
    return h->mode == HOST_NOTHING ? 0 : exchange(w, h->session);
}

static int solve_fluid(spar_session *session, double t, double dt, int iteration, void *context) {
    host *h = context;
    if (session != h->w->session[h->session].s || !isfinite(t) || !(dt >= 0) || iteration < 0) {
        fuzz_finding("callback", "a solver was given t = %g, dt = %g, iteration %d", t, dt, iteration);
    }
    return work(h, h->mode == HOST_CHAOS ? h->count : iteration);
}

static int before_step(spar_session *session, double t, double dt, void *context) {
    host *h = context;
    if (session != h->w->session[h->session].s || !isfinite(t) || !(dt > 0)) {
        fuzz_finding("callback", "what comes before a step was given t = %g, dt = %g", t, dt);
    }
    return h->mode == HOST_CHAOS || h->mode == HOST_FAILS ? work(h, h->count) : 0;
}

/* Lives as long as the call. */
host *arg_host(call *c, spar_fluid_solver *solve, spar_before_step *before) {
    static const int modes[] = {HOST_PLAIN, HOST_PLAIN, HOST_PLAIN, HOST_FAILS, HOST_CHAOS, HOST_NOTHING};
    static const char *const name[HOST_MODES] = {"plain", "failing", "chaotic", "idle"};
    host *h = malloc(sizeof *h);
    if (!h || c->held >= CALL_HOLDS) {
        fuzz_finding("fuzzer", "no memory");
    }
    c->hold[c->held++] = h;
    *h = (host){c->w, c->session, modes[below(c, 6)], below(c, 12), 0, word(c)};
    *solve = chance(c, 85) ? solve_fluid : NULL;
    if (before) {
        *before = chance(c, 50) ? before_step : NULL;
        text(c, ", %s", *before ? "before" : "NULL");
    }
    text(c, ", %s, %s host", *solve ? "solve" : "NULL", name[h->mode]);
    return h;
}

/* Stops about one call in five, always at the same progress. */
int fuzz_progress(spar_session *session, double done, double expected, void *context) {
    live_session *l = context;
    if (session != l->s || !(done >= 0) || !(expected >= done) || !isfinite(expected)) {
        fuzz_finding("callback", "progress was given %g of %g", done, expected);
    }
    return done > 0 && (int64_t)(8 * done) % 40 == 7 ? 3 : 0;
}

/* Cancels what needs more than a dozen iterations. */
int fuzz_iterations(spar_session *session, double done, double expected, void *context) {
    const live_session *l = context;
    if (session != l->s || !(done >= 0) || !(expected >= done) || !isfinite(expected)) {
        fuzz_finding("callback", "progress was given %g of %g", done, expected);
    }
    return done > 12 ? -3 : 0;
}

void fuzz_log(const spar_session *session, int level, const char *message, void *context) {
    world *w = &fuzz_world;
    live_session *l = context;
    if (session != l->s || level < SPAR_LOG_ERROR || level > SPAR_LOG_INFO || !message || strlen(message) == 0) {
        fuzz_finding("log", "a log was given level %d and '%s'", level, message ? message : "NULL");
    }
    l->logged += !w->quiet;
}
