/* What asking for advice costs, beside what it saves: counted in trials, the same on every machine. */
#include "scene.h"
#include "trials.h"

#include "trial/run_record.h"

#include <stdio.h>

enum { BEAMS = 3, NODES = 8, TIMES = 10 };

/* Slender beams of 1 kg/m in a gust that comes and goes and in still air: loads at nodes along each, across it. */
typedef struct air {
    spar_session *s;
    spar_member *b[BEAMS];
    spar_fluid *f[BEAMS];
    double x[BEAMS][3 * NODES], v[3 * NODES], force[3 * NODES];
    double load, rate, drag;
    int beams, far_off; /* trials that ended for their error */
} air;

static int blow(spar_session *s, double t, double dt, int iteration, void *context) {
    air *w = context;
    (void)s, (void)iteration;
    for (int k = 0; k < w->beams; k++) {
        OK(s, spar_fluid_pull_motion(w->f[k], 1, NULL, w->v));
        for (int i = 0; i < NODES; i++) {
            w->force[3 * i + 2] = w->load * sin(w->rate * (t + dt)) - w->drag * w->v[3 * i + 2];
        }
        OK(s, spar_fluid_push_forces(w->f[k], w->force, NULL));
    }
    return SPAR_OK;
}

static void count_far_off(const spar_session *s, int level, const char *text, void *context) {
    air *w = context;
    (void)s, (void)level;
    w->far_off += strstr(text, "the error exceeds") != NULL;
}

/* Between two points; of stiffness EI in bending, damped as mu. */
static void add_beam(air *w, int root, const double from[3], const double to[3], double EI, double mu) {
    const double eta[2] = {0, 1}, xyz[6] = {from[0], from[1], from[2], to[0], to[1], to[2]};
    const double damping[6] = {mu, mu, mu, mu, mu, mu};
    int k = w->beams++;
    char name[16];
    double K[36], M[36];
    (void)snprintf(name, sizeof name, "beam%d", k);
    scene_diagonal(K, 1e4 * EI, 1e4 * EI, 1e4 * EI, EI, EI, 2 * EI);
    scene_diagonal(M, 1, 1, 1, 2e-3, 1e-3, 1e-3);
    OK(w->s, spar_beam_create(w->s, name, 1, 8, &w->b[k]));
    OK(w->s, spar_beam_set_axis(w->b[k], 2, eta, xyz, NULL));
    OK(w->s, spar_beam_set_sections(w->b[k], 1, eta, K, M));
    OK(w->s, spar_member_set_root(w->b[k], root));
    if (mu > 0) {
        OK(w->s, spar_beam_set_damping(w->b[k], damping));
    }
    OK(w->s, spar_member_commit(w->b[k]));
    for (int i = 0; i < NODES; i++) {
        for (int c = 0; c < 3; c++) {
            w->x[k][3 * i + c] = from[c] + (to[c] - from[c]) * (i + 0.5) / NODES;
        }
    }
    OK(w->s, spar_fluid_create(w->b[k], name, &w->f[k]));
    OK(w->s, spar_fluid_set_motion_nodes(w->f[k], NODES, w->x[k]));
    OK(w->s, spar_fluid_set_force_nodes(w->f[k], NODES, w->x[k]));
    OK(w->s, spar_fluid_map(w->f[k]));
}

/* Begun as the host of a light fluid begins it: explicit, Newton as it is by default. */
static air begin(double load, double rate, double drag) {
    air w = {.load = load, .rate = rate, .drag = drag};
    OK(NULL, spar_session_create(&w.s));
    OK(w.s, spar_session_set_coupling(w.s, SPAR_COUPLING_EXPLICIT, 1e-9, 1e-6, 50));
    return w;
}

static air wing(void) {
    static const double root[3] = {0, 0, 0}, tip[3] = {4, 0, 0};
    air w = begin(0.3, 1.5, 0.6);
    add_beam(&w, SPAR_ROOT_FIXED, root, tip, 60, 0);
    return w;
}

static void weld(air *w, const char *name, int a, int b) {
    spar_joint *joint;
    int64_t n;
    OK(w->s, spar_member_get_count(w->b[b], &n));
    OK(w->s, spar_joint_create(w->s, name, w->b[a], 0, w->b[b], n - 1, 0, &joint));
}

static air portal(void) {
    static const double foot[3] = {0, 0, 0}, up[3] = {0, 1.5, 0}, over[3] = {1.5, 1.5, 0}, down[3] = {1.5, 0, 0};
    air w = begin(0.2, 3, 0.1);
    add_beam(&w, SPAR_ROOT_FIXED, foot, up, 60, 1e-3);
    add_beam(&w, SPAR_ROOT_FREE, up, over, 60, 1e-3);
    add_beam(&w, SPAR_ROOT_FREE, over, down, 60, 1e-3);
    weld(&w, "corner", 1, 0);
    weld(&w, "other corner", 2, 1);
    return w;
}

/* ---- what it costs ---- */

/* Where the session as it is keeps the tolerance all of asking costs no more than what is advised saves in ten times
   the trials, with a wing whose nodes and frame whose joints leave little to save. Trials that are far off end. */
static void test_asking_pays(void **state) {
    (void)state;
    static const struct {
        air (*build)(void);
        int64_t steps;
        double tolerance;
        int far_off; /* at least */
    } asks[] = {{wing, 432, 3e-2, 2}, {wing, 432, 1e-2, 2}, {portal, 216, 3e-2, 3}};
    for (size_t k = 0; k < sizeof asks / sizeof *asks; k++) {
        double advice[ADVICE_COUNT];
        const double dt = 0.02, tolerance = asks[k].tolerance;
        air w = asks[k].build();
        OK(w.s, spar_session_set_log(w.s, count_far_off, &w));
        OK(w.s,
           trial_advise(w.s, tolerance, dt, asks[k].steps, TIMES * dt * (double)asks[k].steps, NULL, blow, &w, advice));
        double saves = TIMES * (1 - advice[ADVICE_COST]);
        print_message("asked for %g: cost %.3g, asking %.3g, saves %.3g, %d of %g trials were far off\n", tolerance,
                      advice[ADVICE_COST], advice[ADVICE_WORK], saves, w.far_off, advice[ADVICE_RUNS]);
        assert_true(advice[ADVICE_PRESENT_ERROR] <= 0.9 * tolerance);
        assert_true(advice[ADVICE_WORK] <= saves);
        assert_true(w.far_off >= asks[k].far_off);
        spar_session_destroy(&w.s);
    }
}

/* ---- when a run is far off ---- */

/* A run that is off by a tenth of the motion in its samples 32 to 63 of 128, and by nothing else: the root of the mean
   square is 0.1 / 2. By the step that ends sample k all up to k - 1 are there at least: what is known grows from
   nothing to all of it, never beyond. */
static void test_least_error(void **state) {
    (void)state;
    enum { STEPS = 64, FROM = 32, TO = 64, GOALS = 1 << SPARI_OF_MOTION };
    air w = wing();
    spari_record a, b;
    OK(w.s, spari_record_create(w.s, STEPS, GOALS, &a));
    OK(w.s, spari_record_create(w.s, STEPS, GOALS, &b));
    int64_t all = spari_record_size(&b), each = all / SPARI_SAMPLES;
    for (int64_t i = 0; i < all; i++) {
        b.value[i] = 1;
        a.value[i] = i / each >= FROM && i / each < TO ? 1.1 : 1;
    }
    NEAR(spari_record_error(&a, &b, GOALS, 1), 0.05, 1e-12);
    double before = 0;
    for (int64_t i = 1; i < STEPS; i++) {
        double least = spari_record_least_error(&a, &b, GOALS, i);
        double seen = fmin(fmax(2 * (double)(i - 1), FROM), TO) - FROM; /* of the samples that are off; two in a step */
        NEAR(least, 0.1 * sqrt(seen / SPARI_SAMPLES), 1e-12);
        assert_true(least >= before);
        before = least;
    }
    NEAR(before, 0.05, 1e-12);
    spari_record_free(&a);
    spari_record_free(&b);
    spar_session_destroy(&w.s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_asking_pays),
        cmocka_unit_test(test_least_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
