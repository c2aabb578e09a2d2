/* Whether advice is kept: on each scene spar_trial_advise is asked for some tolerances, the scene is built to what it
   says, run over its whole time and compared with a converged run; its cost with the cheapest of 120 settings such as
   one would choose by hand, both timed in turn. advice [--scene name] [--tolerance x] [--part x] [--out file.csv]
   [--elements n] [--nodes n] [--scan] [--verbose]. part: of the scene's time that trials see, default 1/2; elements,
   nodes: that the scene has before it is asked, else its own; scan: all numbers of elements and nodes beside what is
   advised, with the rest of the advice. A table on stdout; --out for advice.gp. */
#include "scenes.h"

#include <math.h>
#include <spar/spar.h>
#include <spar/spar_analysis.h>
#include <spar/spar_structure.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { SAMPLES_OF_TRIALS = 8 };

typedef struct choice {
    knobs k;
    double error, seconds;
} choice;

static int verbose, scans;
static FILE *csv; /* NULL: not wanted */

static void show(const spar_session *s, int level, const char *text, void *context) {
    (void)s, (void)context;
    if (verbose || level < SPAR_LOG_INFO) {
        fprintf(stderr, "\n%s", text);
    }
}

static double now(void) {
    return (double)clock() / CLOCKS_PER_SEC;
}

/* Error and least time of some runs; a setting that fails has an infinite error. */
static void play(const scene *s, const scene_reference *reference, int repeats, choice *c) {
    c->error = c->seconds = INFINITY;
    for (int i = 0; i < repeats; i++) {
        scene_run *run;
        scene_result result;
        if (scene_build(s, &c->k, &run) == SPAR_OK && scene_march(run, &result) == SPAR_OK) {
            c->error = scene_error(reference, &result);
            c->seconds = fmin(c->seconds, result.seconds);
        }
        scene_destroy(&run);
    }
}

/* ---- by hand ---- */

static const double factors[] = {4, 2, 1, 0.5, 0.25, 0.125};
static const struct {
    int scheme, predictor;
} couplings[] = {{SPAR_COUPLING_EXPLICIT, 1},
                 {SPAR_COUPLING_EXPLICIT, 2},
                 {SPAR_COUPLING_FIXED_POINT, 1},
                 {SPAR_COUPLING_IQN_ILS, 1}};
static const struct {
    int fidelity, modes, nodes;
} shapes[] = {{SPAR_FIDELITY_EXACT, 0, 8},
              {SPAR_FIDELITY_EXACT, 0, 6},
              {SPAR_FIDELITY_EXACT, 0, 5},
              {SPAR_FIDELITY_MODAL, 8, 6},
              {SPAR_FIDELITY_RIGID, 0, 6}};
#define LENGTH(x) (sizeof(x) / sizeof *(x))
enum { CHOICES = LENGTH(factors) * LENGTH(couplings) * LENGTH(shapes) };

static void choose_by_hand(const scene *s, const scene_reference *reference, choice hand[CHOICES]) {
    for (size_t i = 0; i < CHOICES; i++) {
        size_t f = i / (LENGTH(couplings) * LENGTH(shapes)), c = i / LENGTH(shapes) % LENGTH(couplings),
               b = i % LENGTH(shapes);
        choice *t = &hand[i];
        t->k = s->standard;
        t->k.dt = scene_dt(s, s->standard.dt * factors[f]);
        t->k.newton = 1e-6;
        t->k.scheme = couplings[c].scheme, t->k.predictor = couplings[c].predictor;
        t->k.tolerance = t->k.scheme ? 1e-2 : t->k.tolerance;
        t->k.fidelity = shapes[b].fidelity, t->k.modes = shapes[b].modes, t->k.nodes = shapes[b].nodes;
        play(s, reference, 3, t);
    }
}

/* The cheapest that keeps the tolerance; NULL: none does. */
static const choice *best_by_hand(const choice hand[CHOICES], double tolerance) {
    const choice *best = NULL;
    for (int i = 0; i < CHOICES; i++) {
        if (hand[i].error <= tolerance && (!best || hand[i].seconds < best->seconds)) {
            best = &hand[i];
        }
    }
    return best;
}

/* ---- by advice ---- */

static knobs advised(const scene *s, const scene_run *run, const spar_trial *trial) {
    knobs k = s->standard;
    double dt = 0;
    (void)spar_trial_get_settings(trial, &dt, &k.substeps, &k.scheme, &k.tolerance, &k.predictor, &k.newton);
    (void)spar_trial_get_beam(trial, run->member, &k.fidelity, &k.modes, &k.elements, &k.nodes, &k.points);
    k.dt = scene_dt(s, dt * (1 + 1e-9));
    k.rule = k.points > 0 ? SPAR_QUADRATURE_SECTIONS : k.rule;
    return k;
}

/* error: that the advice expects; runs: that it took */
static int ask(const scene *s, double tolerance, double part, double *error, int64_t *runs, knobs *k) {
    scene_run *run;
    spar_trial *trial = NULL;
    double dt = s->standard.dt;
    int64_t steps = SAMPLES_OF_TRIALS * llround(part * s->T / dt / SAMPLES_OF_TRIALS);
    int status = scene_build(s, &s->standard, &run);
    if (status == SPAR_OK) {
        (void)spar_session_set_log(run->session, show, NULL);
        status = spar_trial_create(run->session, &trial);
    }
    if (status == SPAR_OK) {
        (void)spar_trial_set_callbacks(trial, run->before, run->context, run->solve, run->context);
        status = spar_trial_set_steps(trial, dt, steps);
    }
    status = status == SPAR_OK ? spar_trial_advise(trial, tolerance, s->T) : status;
    if (status == SPAR_OK) {
        *k = advised(s, run, trial);
        (void)spar_trial_get_outcome(trial, error, NULL, NULL, NULL);
        (void)spar_trial_get_search(trial, runs, NULL);
    } else {
        printf("%-6s %-9.3g %s\n", s->name, tolerance, spar_session_message(run->session));
    }
    scene_destroy(&run);
    return status;
}

static const char *words(const knobs *k, char *text, size_t size) {
    static const char *const scheme[] = {"explicit", "fixed", "aitken", "iqn"}, *const fidelity[] = {"prescribed",
                                                                                                     "rigid", "linear",
                                                                                                     "modal", "exact"};
    char modes[16] = "", tolerance[16] = "", points[16] = "", substeps[24] = "";
    if (k->fidelity == SPAR_FIDELITY_MODAL) {
        snprintf(modes, sizeof modes, " %d", (int)k->modes);
    }
    if (k->scheme) {
        snprintf(tolerance, sizeof tolerance, " %.0e", k->tolerance);
    }
    if (k->points > 0) {
        snprintf(points, sizeof points, "/%d", k->points);
    }
    if (k->substeps > 1) {
        snprintf(substeps, sizeof substeps, " in %d", k->substeps);
    }
    snprintf(text, size, "dt %.4g%s, %s%s, predictor %d, Newton %.0e, %s%s, %d x %d%s nodes", k->dt, substeps,
             scheme[k->scheme], tolerance, k->predictor, k->newton, fidelity[k->fidelity], modes, k->elements, k->nodes,
             points);
    return text;
}

/* Elements and nodes by brute force: the cheapest that keep the tolerance. */
static void scan(const scene *s, const scene_reference *reference, const choice *mine, double tolerance) {
    enum { MOST_ELEMENTS = 6, LEAST_NODES = 3, MOST_NODES = 12, BEST = 4 };
    choice best[BEST + 1];
    int count = 0;
    for (int elements = 1; elements <= MOST_ELEMENTS; elements++) {
        for (int nodes = LEAST_NODES; nodes <= MOST_NODES; nodes++) {
            choice c = *mine;
            c.k.elements = elements, c.k.nodes = nodes;
            play(s, reference, 3, &c);
            int at = count;
            for (; at > 0 && best[at - 1].seconds > c.seconds && c.error <= tolerance; at--) {
                best[at] = best[at - 1];
            }
            best[at] = c;
            count += c.error <= tolerance && count < BEST;
        }
    }
    for (int i = 0; i < count; i++) {
        printf("       scan:   %d x %d, error %.2e, cost %.2f\n", best[i].k.elements, best[i].k.nodes, best[i].error,
               best[i].seconds / mine->seconds);
    }
}

/* For the picture: what it was, the tolerance, error and cost over the default's. */
static void keep(const scene *s, const char *what, double tolerance, const choice *c, const choice *standard) {
    if (csv && isfinite(c->error)) {
        fprintf(csv, "%s,%s,%g,%.4e,%.4f\n", s->name, what, tolerance, c->error, c->seconds / standard->seconds);
    }
}

static int check(const scene *s, const scene_reference *reference, const choice by_hand[CHOICES],
                 const choice *standard, double tolerance, double part) {
    double expected = 0, since = now(), took, least[2] = {INFINITY, INFINITY};
    int64_t runs = 0;
    char text[160];
    const choice *best = best_by_hand(by_hand, tolerance);
    choice mine, hand;
    if (ask(s, tolerance, part, &expected, &runs, &mine.k) != SPAR_OK) {
        return 1;
    }
    took = now() - since;
    hand = best ? *best : (choice){s->standard, INFINITY, INFINITY};
    for (int i = 0; i < 3; i++) { /* in turn, as the machine's speed changes */
        play(s, reference, 1, &mine);
        if (best) {
            play(s, reference, 1, &hand);
        }
        least[0] = fmin(least[0], mine.seconds), least[1] = fmin(least[1], hand.seconds);
    }
    mine.seconds = least[0], hand.seconds = least[1];
    int kept = mine.error <= tolerance, cheap = !best || mine.seconds <= 2 * hand.seconds;
    printf("%-6s %-9.3g %9.2e %9.2e %6.2f %8.3f %8.3f %5d %7.1f  %s%s\n", s->name, tolerance, expected, mine.error,
           mine.seconds / hand.seconds, mine.seconds / standard->seconds, hand.seconds / standard->seconds, (int)runs,
           took, kept ? "" : "NOT KEPT ", cheap ? "" : "DEAR");
    printf("       advice: %s\n", words(&mine.k, text, sizeof text));
    if (best) {
        printf("       hand:   %s, error %.2e\n", words(&hand.k, text, sizeof text), hand.error);
    } else {
        printf("       hand:   none of the %d keeps it\n", CHOICES);
    }
    if (scans) {
        scan(s, reference, &mine, tolerance);
    }
    fflush(stdout);
    keep(s, "advice", tolerance, &mine, standard);
    keep(s, "best", tolerance, &hand, standard);
    return !kept || !cheap;
}

static int check_scene(const scene *s, const double *tolerance, int count, double part) {
    scene_reference reference;
    choice hand[CHOICES], standard = {s->standard, 0, 0};
    int failed = 0;
    if (scene_converge(s, 16, s->spins ? 8 : 1, s->spins ? 8 : 18, &reference) != SPAR_OK) {
        printf("%s: no reference\n", s->name);
        return 1;
    }
    choose_by_hand(s, &reference, hand);
    play(s, &reference, 3, &standard);
    keep(s, "default", 0, &standard, &standard);
    for (int i = 0; i < CHOICES; i++) {
        keep(s, "hand", 0, &hand[i], &standard);
    }
    for (int t = 0; t < count; t++) {
        failed += check(s, &reference, hand, &standard, tolerance[t], part);
    }
    return failed;
}

int main(int argc, char **argv) {
    static const double tolerances[SCENE_COUNT][2] = {
        {3e-2, 1e-2}, {3e-2, 1e-2}, {3e-2, 1e-2}, {3e-2, 1e-2}, {1e-2, 1e-3}};
    const char *only = NULL;
    double tolerance = 0, part = 0.5;
    int elements = 0, nodes = 0;
    for (int i = 1; i < argc; i++) {
        verbose |= strcmp(argv[i], "--verbose") == 0;
        scans |= strcmp(argv[i], "--scan") == 0;
        only = strcmp(argv[i], "--scene") == 0 && i + 1 < argc ? argv[++i] : only;
        tolerance = strcmp(argv[i], "--tolerance") == 0 && i + 1 < argc ? strtod(argv[++i], NULL) : tolerance;
        elements = strcmp(argv[i], "--elements") == 0 && i + 1 < argc ? atoi(argv[++i]) : elements;
        nodes = strcmp(argv[i], "--nodes") == 0 && i + 1 < argc ? atoi(argv[++i]) : nodes;
        if (strcmp(argv[i], "--out") == 0 && i + 1 < argc && !csv) {
            csv = fopen(argv[++i], "w");
        }
        part = strcmp(argv[i], "--part") == 0 && i + 1 < argc ? strtod(argv[++i], NULL) : part;
    }
    int failed = 0;
    printf("scene  tolerance estimate      real   cost  /default  hand/d. runs       s  (cost: of the cheapest by "
           "hand)\n");
    for (int i = 0; i < SCENE_COUNT; i++) {
        if (!only || strcmp(only, scenes[i].name) == 0) {
            fprintf(stderr, "%s ...\r", scenes[i].name);
            scene s = scenes[i];
            s.standard.elements = elements > 0 ? elements : s.standard.elements;
            s.standard.nodes = nodes > 0 ? nodes : s.standard.nodes;
            failed += check_scene(&s, tolerance > 0 ? &tolerance : tolerances[i], tolerance > 0 ? 1 : 2, part);
        }
    }
    if (csv) {
        fclose(csv);
    }
    scenes_free();
    return failed > 0;
}
