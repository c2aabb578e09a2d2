/* What Newton leaves, in random scenes of members and mechanisms (random_scenes.h): each is run with the defaults, with
   the strictest tolerances, and with these in half the steps. The last two differ by what dt leaves: the scheme's own
   error. It is the measure of everything else:
   - Energy. E - E(0) - work, with the work of the loads summed here, is 0 without damping and falls with it. With the
     defaults it rises above 0 by no more than with the strictest tolerances and a tenth of the scheme's error.
   - With the strictest tolerances it rises by no more than three times the scheme's error, which is less than half of
     the energy in motion. (Not for pairs of moments, whose work in the first step the trapezoidal rule does not find.)
   - The motion of the tip differs from that with the strictest tolerances by a tenth of the scheme's error at most.
   - The defaults refuse no step that the strictest tolerances take.
   A run that takes more than 40 iterations a step on average is stopped and counted. A scene of which the library tells
   that its elements lock is counted, and nothing is compared.
   A floor of 1e-9 stands for rounding: of positions times EA, and of differences of energies.

   random_motions [seed, default 1 [scenes, default 3 of each class]]: the long form is 500 scenes of several seeds.
   random_motions seed 0 runs one scene, by the seed that the table names. */
#include "random_scenes.h"

enum { MOST_STEPS = 640 };

static const double part = 0.1, floor_of = 1e-9;

/* ---- one scene ---- */

typedef struct outcome {
    int status, steps, stopped, locks;
    int64_t iterations;
    double scale;                                             /* largest energy in motion and strain */
    double balance[MOST_STEPS], tip[3 * MOST_STEPS], largest; /* after each whole step; displacement of the tip */
    char message[160];
} outcome;

static void run(const motion_scene *c, int strictest, int halves, outcome *o) {
    motion_world w = scene_build(c, strictest);
    double size, first = scene_energy(&w, &size);
    *o = (outcome){.status = w.status, .scale = size};
    sequence_seed = c->seed;
    for (int k = 0; k < c->steps && o->status == SPAR_OK; k++) {
        const double dt = sequence_step(c->pattern, k, c->dt, c->factor) / halves;
        for (int i = 0; i < halves && o->status == SPAR_OK; i++) {
            o->status = scene_step(&w, dt);
        }
        if (o->status == SPAR_OK) {
            const double balance = scene_energy(&w, &size) - first - w.work;
            o->scale = fmax(o->scale, size);
            o->balance[k] = balance;
            memcpy(o->tip + 3 * k, w.tip, 3 * sizeof *w.tip);
            o->largest = fmax(o->largest, sqrt(spari_dot(w.tip, w.tip)));
            o->steps++;
        }
        if (scene_is_slow(&w, halves * c->steps)) {
            o->stopped = 1;
            break;
        }
    }
    o->iterations = scene_iterations(&w);
    o->locks = scene_is_told_to_lock(&w);
    snprintf(o->message, sizeof o->message, "%.150s", spar_session_message(w.s));
    spar_session_destroy(&w.s);
}

/* Largest difference of two histories of so many numbers for each step, over the steps that both have. */
static double apart(const outcome *a, const outcome *b, int tip) {
    const int steps = a->steps < b->steps ? a->steps : b->steps;
    double most = 0;
    for (int k = 0; k < steps; k++) {
        double square = 0;
        for (int i = 0; i < (tip ? 3 : 1); i++) {
            const double d = tip ? a->tip[3 * k + i] - b->tip[3 * k + i] : a->balance[k] - b->balance[k];
            square += d * d;
        }
        most = fmax(most, square);
    }
    return sqrt(most);
}

/* Largest rise above 0 in the first steps. */
static double gain_of(const outcome *o, int steps) {
    double most = 0;
    for (int k = 0; k < steps && k < o->steps; k++) {
        most = fmax(most, o->balance[k]);
    }
    return most;
}

/* ---- classes ---- */

typedef struct scene_class {
    const char *name;
    int structure[2], loading, uneven; /* the first and last structure; -1: any loading */
} scene_class;

static const scene_class classes[] = {
    {"clamped, load at once", {CLAMPED, CLAMPED}, AT_ONCE, 0},
    {"clamped, ramp", {CLAMPED, CLAMPED}, RAMPED, 0},
    {"clamped, periodic load", {CLAMPED, CLAMPED}, PERIODIC, 0},
    {"clamped, let go", {CLAMPED, CLAMPED}, LET_GO, 0},
    {"pinned", {PINNED, PINNED}, -1, 0},
    {"free", {FREE, FREE}, -1, 0},
    {"on a hinge", {HINGED, HINGED}, -1, 0},
    {"two beams, weld or ball", {WELDED, BALL}, -1, 0},
    {"rods on joints", {CHAIN, CHAIN}, -1, 0},
    {"mechanisms in flight", {FLIGHT, FLIGHT}, -1, 0},
    {"members, uneven steps", {CLAMPED, FREE}, -1, 1},
    {"mechanisms, uneven steps", {HINGED, FLIGHT}, -1, 1},
};
enum { CLASSES = sizeof classes / sizeof *classes };

typedef struct tally {
    int scenes, refused, stopped, locked, failed;
    int64_t iterations[2], steps;    /* with the defaults, the strictest */
    double gain, difference, scheme; /* the worst: over the energy in motion; over the scheme's error; its own error */
    uint64_t at_gain, at_difference, at_scheme;
} tally;

static void worst(double value, uint64_t seed, double *most, uint64_t *at) {
    if (value > *most) {
        *most = value, *at = seed;
    }
}

static void complain(const motion_scene *c, const char *what, double found, double allowed, tally *t) {
    print_message("  %s: %.3g, allowed %.3g\n", what, found, allowed);
    scene_print(c);
    t->failed++;
}

static void check(const motion_scene *c, tally *t) {
    static outcome usual, strict, half;
    run(c, 0, 1, &usual);
    const int failed = t->failed;
    t->scenes++;
    if (usual.stopped || usual.locks) {
        t->locked += usual.locks;
        t->stopped += usual.stopped && !usual.locks;
        return;
    }
    run(c, 1, 1, &strict), run(c, 1, 2, &half);
    if (strict.status != SPAR_OK || half.status != SPAR_OK) {
        t->refused++;
    } else if (usual.status != SPAR_OK) {
        print_message("  refused with the defaults alone: %s\n", usual.message);
        complain(c, "refused in step", usual.steps, 0, t);
    }
    t->stopped += strict.stopped || half.stopped;
    const double scale = fmax(strict.scale, DBL_MIN), error = 4.0 / 3 * apart(&strict, &half, 0),
                 off = 4.0 / 3 * apart(&strict, &half, 1), size = strict.largest;
    const double energy = part * error + floor_of * scale, motion = part * off + floor_of * size,
                 strict_gain = gain_of(&strict, usual.steps), gain = gain_of(&usual, strict.steps) - strict_gain,
                 difference = apart(&usual, &strict, 1);
    worst(gain / scale, c->seed, &t->gain, &t->at_gain);
    worst(difference / (motion / part), c->seed, &t->difference, &t->at_difference);
    worst(fmax(strict_gain, error) / scale, c->seed, &t->scheme, &t->at_scheme);
    t->iterations[0] += usual.iterations, t->iterations[1] += strict.iterations, t->steps += usual.steps;
    if (!(gain <= energy)) {
        complain(c, "energy above that of the strictest run, by the energy in motion", gain / scale, energy / scale, t);
    }
    if (!(difference <= motion)) {
        complain(c, "tip off that of the strictest run, by its way", difference / size, motion / size, t);
    }
    if (!(strict_gain <= 3 * error + 1e-6 * scale)) {
        complain(c, "energy of the strictest run, by the energy in motion", strict_gain / scale, 3 * error / scale, t);
    }
    if (!(error <= 0.5 * scale) && (!scene_is_free(c) || c->loading == LET_GO)) {
        complain(c, "error of the scheme itself, by the energy in motion", error / scale, 0.5, t);
    }
    t->failed = failed + (t->failed > failed); /* once a scene */
}

static void print_tally(const char *name, const tally *t) {
    print_message("%-26s %4d (%d refused, %d stopped, %d lock): worst gain %8.1e [%llu], difference %8.1e of the "
                  "scheme's error [%llu], "
                  "scheme %.1e [%llu]; iterations a step %.2f, strictest %.2f; failed %d\n",
                  name, t->scenes, t->refused, t->stopped, t->locked, t->gain, (unsigned long long)t->at_gain,
                  t->difference, (unsigned long long)t->at_difference, t->scheme, (unsigned long long)t->at_scheme,
                  (double)t->iterations[0] / fmax((double)t->steps, 1),
                  (double)t->iterations[1] / fmax((double)t->steps, 1), t->failed);
}

/* Seeds below 4: thin strips of 1 m under a force at the tip that comes at once, for a period. Steel of 20 mm x 3 mm
   and 20 mm x 0.3 mm, and two that are square in bending and stiffer along their line. */
enum { STRIPS = 4 };

static motion_scene strip(uint64_t k) {
    static const double slenderness[STRIPS] = {12 / 9e-6, 12 / 9e-8, 1e9, 1e12}, ratio[STRIPS] = {44.4, 4444, 1, 1},
                        force[STRIPS] = {1, 0.05, 1, 1}, steps[STRIPS] = {40, 640, 160, 160};
    motion_scene c = {.seed = k,
                      .structure = CLAMPED,
                      .loading = AT_ONCE,
                      .parts = 1,
                      .elements = 1,
                      .nodes = 10,
                      .fidelity = SPAR_FIDELITY_EXACT,
                      .slenderness = slenderness[k],
                      .strip = ratio[k],
                      .rho = 0.9,
                      .length = 1,
                      .mass = 1,
                      .EI = 1,
                      .amplitude = force[k] / 3,
                      .direction = {0, 0, 1},
                      .pattern = EVEN,
                      .per_period = steps[k],
                      .ramp = 1,
                      .factor = 1,
                      .steps = (int)steps[k]};
    c.period = 2 * scene_pi / 3.516;
    c.dt = c.period / c.per_period;
    return c;
}

/* The seed says which class a scene is of. */
static motion_scene draw(uint64_t seed) {
    if (seed < STRIPS) {
        return strip(seed);
    }
    const scene_class *of = classes + seed % CLASSES;
    const int two = of->structure[1] - of->structure[0] + 1;
    return scene_draw(seed, of->structure[0] + (int)(seed / CLASSES % (uint64_t)two), of->loading, of->uneven);
}

static uint64_t seed = 1;
static int scenes = 3;

static void test_random_motions(void **state) {
    (void)state;
    int failed = 0;
    tally strips = {0};
    for (uint64_t k = 0; k < STRIPS && scenes > 0; k++) {
        const motion_scene c = strip(k);
        check(&c, &strips);
    }
    if (scenes > 0) {
        print_tally("thin strips", &strips);
    }
    failed += strips.failed;
    for (uint64_t k = 0; k < CLASSES && scenes > 0; k++) {
        tally t = {0};
        for (int i = 0; i < scenes; i++) {
            const motion_scene c = draw((seed * 100000 + (uint64_t)i) * CLASSES + k);
            check(&c, &t);
        }
        print_tally(classes[k].name, &t);
        failed += t.failed;
    }
    if (scenes == 0) {
        const motion_scene c = draw(seed);
        tally t = {0};
        scene_print(&c);
        check(&c, &t);
        print_tally(classes[seed % CLASSES].name, &t);
        failed = t.failed;
    }
    assert_int_equal(failed, 0);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_random_motions)};
    seed = argc > 1 ? strtoull(argv[1], NULL, 10) : seed;
    scenes = argc > 2 ? atoi(argv[2]) : scenes;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
