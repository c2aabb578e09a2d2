/* Whether advice is kept over ten times the trials, on eleven scenes that it was not made with: each asks for two
   tolerances, puts the advice in force, runs ten times as long as the trials did and is compared with where
   steps of a sixteenth and of half that point to, on more nodes, with the coupling converged. kept [--scene name]
   [--scale factor ...] [--verbose]: asks at so many times the tolerances, for each factor; 1 where there is none. A
   table on stdout; 1: one tolerance or more is not kept. */
#include "try.h"
#include "worlds.h"

#include <math.h>
#include <spar/spar.h>
#include <spar/spar_analysis.h>
#include <spar/spar_coupling.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FINER = 16 };

/* Ends of the members. */
static int look(const world *w, double *out) {
    double q[7 * 64];
    for (int k = 0; k < w->members; k++) {
        int64_t n;
        TRY(spar_member_get_count(w->m[k], &n));
        TRY(spar_member_get_motion(w->m[k], q, NULL, NULL));
        memcpy(out + 3 * k, q + 7 * (n - 1), 3 * sizeof *out);
    }
    return SPAR_OK;
}

/* A run of `finer` steps to each of the host's, what it comes to at every FINER-th part of those; from the second on it
   goes to where that and the one before of half the steps point, of order 2. truth [steps + 1][3 WORLD_MEMBERS] */
static int converge(int k, int finer, double *truth) {
    world w;
    double dt = worlds[k].dt / finer, now[3 * WORLD_MEMBERS];
    const int each = finer / FINER;
    int status = world_create(k, 10, 0, &w);
    w.air.noise = 0; /* of the solver: the answer that it is meant to give */
    status = status ? status : spar_session_set_coupling(w.s, SPAR_COUPLING_IQN_ILS, 1e-12, 1e-7, 50);
    status = status ? status : spar_session_set_newton(w.s, 1e-14, 1e-9, 50);
    status = status ? status : look(&w, truth);
    for (int64_t i = 1; i <= worlds[k].times * finer * worlds[k].steps && !status; i++) {
        double *x = truth + 3 * WORLD_MEMBERS * (i / each);
        status = world_step(&w, (double)(i - 1) * dt, dt);
        status = status ? status : look(&w, now);
        for (int c = 0; c < 3 * w.members && i % each == 0; c++) {
            x[c] = each == 1 ? now[c] : now[c] + (now[c] - x[c]) / 3;
        }
    }
    spar_session_destroy(&w.s);
    return status;
}

/* Root of the mean square of the error over that of the motion from where it began, at the ends of steps. */
static int march(world *w, int k, double dt, const double *truth, double *error) {
    double d = 0, size = 0, end = worlds[k].times * worlds[k].dt * (double)worlds[k].steps, now[3 * WORLD_MEMBERS];
    for (int64_t i = 1; (double)i * dt <= end * (1 + 1e-9); i++) {
        TRY(world_step(w, (double)(i - 1) * dt, dt));
        TRY(look(w, now));
        double at = (double)i * dt / worlds[k].dt * FINER, most = (double)(worlds[k].times * FINER * worlds[k].steps);
        int64_t low = (int64_t)fmin(at, most - 1);
        for (int c = 0; c < 3 * w->members; c++) {
            const double *x = truth + 3 * WORLD_MEMBERS * low + c;
            double exact = x[0] + (at - (double)low) * (x[3 * WORLD_MEMBERS] - x[0]);
            d += (now[c] - exact) * (now[c] - exact), size += (exact - truth[c]) * (exact - truth[c]);
        }
    }
    *error = sqrt(d / size);
    return SPAR_OK;
}

static int verbose;

static void show(const spar_session *s, int level, const char *text, void *context) {
    (void)s, (void)context;
    if (verbose || level < SPAR_LOG_INFO) {
        fprintf(stderr, "%s\n", text);
    }
}

static int advise(world *w, int k, double tolerance, spar_trial **trial) {
    int status = spar_trial_create(w->s, trial);
    status = status ? status : spar_trial_set_steps(*trial, worlds[k].dt, worlds[k].steps);
    status = status ? status : spar_trial_set_callbacks(*trial, world_before, w, world_solve, w);
    return status ? status
                  : spar_trial_advise(*trial, tolerance, worlds[k].times * worlds[k].dt * (double)worlds[k].steps);
}

static int check(int k, double tolerance, const double *truth) {
    world w;
    spar_trial *trial = NULL;
    double dt, error = INFINITY, expected, cost, present, asking;
    int fails;
    int64_t runs;
    int status = world_create(k, 8, 0, &w);
    status = status ? status : spar_session_set_log(w.s, show, NULL);
    status = status ? status : advise(&w, k, tolerance, &trial);
    if (status) {
        printf("%-9s %-7.3g refused: %s\n", worlds[k].name, tolerance, spar_session_message(w.s));
        spar_session_destroy(&w.s);
        return 0;
    }
    (void)spar_trial_get_outcome(trial, &expected, &cost, &fails, &present);
    (void)spar_trial_get_search(trial, &runs, &asking);
    status = spar_trial_apply(trial, &dt);
    status = status ? status : march(&w, k, dt, truth, &error);
    printf("%-9s %-7.3g %9.2e %9.2e %9.2e %8.4g %5d %7.3f %7.1f %s\n", worlds[k].name, tolerance, fails ? NAN : present,
           expected, error, dt, (int)runs, cost, asking,
           status               ? spar_session_message(w.s)
           : error <= tolerance ? ""
                                : "NOT KEPT");
    fflush(stdout);
    spar_session_destroy(&w.s);
    return !(error <= tolerance);
}

/* What the command line says; `scales` of the tolerances. */
typedef struct request {
    const char *only;
    double scale[8];
    int scales;
} request;

static int read_arguments(int argc, char **argv, request *r) {
    enum { MOST = sizeof r->scale / sizeof *r->scale };
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--verbose") == 0) {
            verbose = 1;
        } else if (strcmp(argv[i], "--scene") == 0 && i + 1 < argc) {
            r->only = argv[++i];
        } else if (strcmp(argv[i], "--scale") == 0 && i + 1 < argc && r->scales < MOST) {
            r->scale[r->scales++] = strtod(argv[++i], NULL);
        } else {
            (void)fprintf(stderr, "kept [--scene name] [--scale factor ...] [--verbose]\n");
            return 0;
        }
    }
    if (r->scales == 0) {
        r->scale[r->scales++] = 1;
    }
    return 1;
}

int main(int argc, char **argv) {
    request r = {0};
    int failed = 0;
    if (!read_arguments(argc, argv, &r)) {
        return 2;
    }
    printf("scene     tolerance  as is      said      real       dt trials   cost  asking  (in trials as it is)\n");
    for (int k = 0; k < WORLD_COUNT; k++) {
        if (r.only && strcmp(r.only, worlds[k].name) != 0) {
            continue;
        }
        double *truth =
            malloc((size_t)(3 * WORLD_MEMBERS * (worlds[k].times * FINER * worlds[k].steps + 1)) * sizeof *truth);
        if (!truth || converge(k, FINER, truth) != SPAR_OK || converge(k, 2 * FINER, truth) != SPAR_OK) {
            printf("%s: no reference\n", worlds[k].name);
            failed++;
        }
        for (int t = 0; t < 2 * r.scales && truth; t++) {
            failed += check(k, r.scale[t / 2] * worlds[k].tolerance[t % 2], truth);
        }
        free(truth);
    }
    return failed > 0;
}
