/* Long runs of random scenes (random_scenes.h) with the defaults: what falls under its weight or bears a load that
   stays has the energy that it had, less what the scheme and damping take. Over all steps E - E(0) - work rises above 0
   by no more than in the first periods with the strictest tolerances, half of that again, and a tenth of the scheme's
   own error there (the difference from half the steps). If it does, the strictest tolerances show over the whole run
   whether Newton or the scheme makes the energy: the scheme may make three times its error, as in random_motions. The
   first scenes are cantilevers that grew: released under their
   weight, 0.9.

   long_runs [seed, default 1 [scenes, default 8 [steps, default 20000]]]: the long form is 100 scenes of 1000000.
   long_runs seed 0 [steps] runs one scene, by the seed that the table names. */
#include "random_scenes.h"

static const double part = 0.1, floor_of = 1e-9, periods = 10;
enum { FIXED = 3, FIRST_STEPS = 12000, WINDOWS = 40 };

static scene_plan plan = {1, 8, 20000};

/* EA 1e5 N, EI 50 N m2, 1 kg/m, 1 m, 9.81 m/s2: 57 and 115 steps a period of 3.516 sqrt(50), in steps of 0.005 s. */
static motion_scene draw_fixed(int k) {
    motion_scene c = {.structure = CLAMPED,
                      .loading = LET_GO,
                      .parts = 1,
                      .elements = 1,
                      .nodes = k == 1 ? 8 : 6,
                      .fidelity = SPAR_FIDELITY_EXACT,
                      .strip = 0.6,
                      .slenderness = 2e3,
                      .rho = 0.9,
                      .length = 1,
                      .mass = 1,
                      .EI = 50,
                      .direction = {0, 0, -1},
                      .pattern = EVEN};
    c.amplitude = 9.81 / 8 / c.EI;
    c.period = 2 * scene_pi / 3.516 / sqrt(c.EI);
    c.dt = k == 2 ? 0.005 : 0.01;
    c.per_period = c.period / c.dt;
    return c;
}

/* Few nodes, so that many steps are affordable; loads that stay. */
static motion_scene draw(uint64_t at) {
    if (at < FIXED) {
        return draw_fixed((int)at);
    }
    static const int structures[] = {CLAMPED, CLAMPED, CLAMPED, PINNED, HINGED, WELDED, BALL, CHAIN, FREE, FLIGHT};
    scene_seed_by(at);
    const int structure = structures[scene_whole(0, 9)],
              loading = scene_is_free(&(motion_scene){.structure = structure}) || scene_whole(0, 1) ? LET_GO : AT_ONCE;
    motion_scene c = scene_draw(at, structure, loading, 0);
    c.elements = c.nodes > 6 ? 1 : scene_whole(1, 2), c.nodes = 4 + c.nodes % 4;
    c.modes = (c.structure == FREE ? 6 : c.structure == PINNED ? 3 : 0) + scene_whole(1, 3);
    c.mu = scene_whole(0, 3) ? 0 : c.mu;
    c.per_period = scene_decades(log10(20), 2.3);
    c.dt = c.period / c.per_period;
    scene_draw_motion(&c);
    return c;
}

typedef struct history {
    int status, steps, slow, at; /* at: the step of the largest rise */
    int64_t iterations;
    double gain, scale, last; /* the largest value; the energy in motion; the value at the end */
    double mean, least, rise; /* of the present window; the least mean so far; the largest rise of a mean above it */
    char message[160];
} history;

/* Mean over windows of so many steps. */
static void add_to_means(history *h, int window) {
    h->mean += h->last / window;
    if (h->steps % window == 0) {
        h->rise = fmax(h->rise, h->mean - h->least);
        h->least = fmin(h->least, h->mean);
        h->mean = 0;
    }
}

/* balance: of so many steps, NULL: not kept */
static history run(const motion_scene *c, int strictest, int halves, int most, double *balance) {
    motion_world w = scene_build(c, strictest);
    double size, first = scene_energy(&w, &size);
    history h = {.status = w.status, .scale = size, .least = INFINITY};
    for (int k = 0; k < most && h.status == SPAR_OK; k++) {
        for (int i = 0; i < halves && h.status == SPAR_OK; i++) {
            h.status = scene_step(&w, c->dt / halves);
        }
        if (h.status == SPAR_OK) {
            h.last = scene_energy(&w, &size) - first - w.work;
            if (h.last > h.gain) {
                h.gain = h.last, h.at = k;
            }
            h.scale = fmax(h.scale, size);
            h.steps++;
            add_to_means(&h, most / WINDOWS);
            if (balance) {
                balance[k] = h.last;
            }
        }
        h.slow = scene_is_slow(&w, most * halves);
        if (h.slow) {
            break;
        }
    }
    h.iterations = scene_iterations(&w);
    snprintf(h.message, sizeof h.message, "%.150s", spar_session_message(w.s));
    spar_session_destroy(&w.s);
    return h;
}

/* Returns 1 if it fails. */
static int check(const motion_scene *c, int k) {
    static double coarse[FIRST_STEPS], fine[FIRST_STEPS];
    const int few = (int)fmin(fmin(periods * c->per_period, plan.steps), FIRST_STEPS);
    const history strict = run(c, 1, 1, few, coarse), half = run(c, 1, 2, few, fine),
                  usual = run(c, 0, 1, plan.steps, NULL);
    double error = 0;
    for (int i = 0; i < strict.steps && i < half.steps; i++) {
        error = fmax(error, 4.0 / 3 * fabs(coarse[i] - fine[i]));
    }
    const double scale = fmax(strict.scale, DBL_MIN), rise = part * error + floor_of * scale,
                 gain = 1.5 * strict.gain + rise;
    print_message(
        "%3d: gain %8.1e at step %d (allowed %.1e), rise %8.1e (allowed %.1e), at the end %9.1e; scheme %.1e; "
        "iterations a step %.2f\n",
        k, usual.gain / scale, usual.at, gain / scale, usual.rise / scale, rise / scale, usual.last / scale,
        error / scale, (double)usual.iterations / fmax(usual.steps, 1));
    if (usual.status != SPAR_OK) {
        print_message("  refused in step %d: %s\n", usual.steps, usual.message);
    }
    if (usual.slow) {
        print_message("  FAILED. Stopped for its iterations in step %d\n", usual.steps);
        scene_print(c);
        return 1;
    }
    if (usual.status == SPAR_OK && usual.gain <= gain && usual.rise <= rise) {
        return 0;
    }
    const history whole = run(c, 1, 1, plan.steps, NULL);
    if (usual.status == SPAR_OK && usual.gain <= whole.gain + rise && usual.rise <= rise && whole.gain <= 3 * error) {
        return 0;
    }
    print_message(
        "  FAILED. Strictest over the whole run: status %d, gain %.1e at step %d, rise %.1e, at the end %.1e: "
        "%s\n",
        whole.status, whole.gain / scale, whole.at, whole.rise / scale, whole.last / scale,
        whole.status != SPAR_OK || whole.gain > gain || whole.rise > rise ? "the scheme" : "Newton");
    scene_print(c);
    return 1;
}

static void test_long_runs(void **state) {
    (void)state;
    scene_check_all(&plan, FIXED, draw, check);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_long_runs)};
    scene_take_arguments(argc, argv, &plan);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
