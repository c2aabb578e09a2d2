/* Advice over ten times the trials: what was asked for is kept, and what trials cannot tell is refused. The oracle is
   the same scene in its first modes, in steps of a millisecond. */
#include "scene.h"

#include <stdio.h>

enum { NODES = 12 };

/* A cantilever of 2 m (its first period 0.65 s) that waves come upon, in still water: load and drag on nodes along it.
 */
typedef struct pile {
    spar_session *s;
    spar_member *b;
    spar_fluid *f;
    double x[3 * NODES], v[3 * NODES], force[3 * NODES];
    double load, rate, drag;
} pile;

static int waves(spar_session *s, double t, double dt, int iteration, void *context) {
    pile *p = context;
    (void)s, (void)iteration;
    int status = spar_fluid_pull_motion(p->f, 1, NULL, p->v);
    for (int i = 0; i < NODES; i++) {
        double u = p->load * sin(p->rate * (t + dt) - 0.3 * p->x[3 * i]);
        p->force[3 * i + 2] = u - p->drag * p->v[3 * i + 2];
    }
    return status ? status : spar_fluid_push_forces(p->f, p->force, NULL);
}

static void build(pile *p, int fidelity, int64_t modes) {
    double K[36], M[36];
    p->s = scene_session();
    scene_diagonal(K, 1e6, 1e5, 1e5, 100, 120, 400);
    scene_diagonal(M, 1, 1, 1, 2e-3, 1e-3, 1e-3);
    p->b = scene_beam(p->s, "pile", 1, 7, 2, K, M);
    OK(p->s, spar_member_set_fidelity(p->b, fidelity, modes));
    OK(p->s, spar_member_commit(p->b));
    for (int i = 0; i < NODES; i++) {
        p->x[3 * i] = 2 * (i + 0.5) / NODES;
    }
    OK(p->s, spar_fluid_create(p->b, "water", &p->f));
    OK(p->s, spar_fluid_set_motion_nodes(p->f, NODES, p->x));
    OK(p->s, spar_fluid_set_force_nodes(p->f, NODES, p->x));
    OK(p->s, spar_fluid_map(p->f));
}

static double tip(const pile *p) {
    int64_t n;
    double q[7 * 32];
    OK(p->s, spar_member_get_count(p->b, &n));
    OK(p->s, spar_member_get_motion(p->b, q, NULL, NULL));
    return q[7 * (n - 1) + 2];
}

/* Ten times the trials: root of the mean square of the tip's error over that of its motion. */
static double error_of(pile *p, double dt, double length, const pile *like) {
    const double fine = 1e-3;
    pile truth = *like;
    double difference = 0, size = 0, before = 0, now = 0, t = 0;
    build(&truth, SPAR_FIDELITY_MODAL, 4);
    for (int i = 1; i * dt <= length; i++) {
        OK(p->s, spar_step(p->s, dt, waves, p, NULL));
        for (; t < i * dt; t += fine) {
            before = now;
            OK(truth.s, spar_step(truth.s, fine, waves, &truth, NULL));
            now = tip(&truth);
        }
        double exact = now + (before - now) * (t - i * dt) / fine, got = tip(p);
        difference += (got - exact) * (got - exact);
        size += exact * exact;
    }
    spar_session_destroy(&truth.s);
    return sqrt(difference / size);
}

/* Waves of 3 s excite what stands in them at the start, and 1 % of damping lets it go slowly. To 3 % and 1 %. */
static void test_kept_over_ten_times(void **state) {
    (void)state;
    const double tolerance[] = {3e-2, 1e-2}, step = 0.02;
    enum { STEPS = 304 };
    for (int k = 0; k < 2; k++) {
        const pile scene = {.load = 0.1, .rate = 2.1, .drag = 0.03};
        pile p = scene;
        double advice[SPAR_ADVICE_COUNT], dt;
        build(&p, SPAR_FIDELITY_EXACT, 0);
        OK(p.s, spar_session_advise(p.s, tolerance[k], step, STEPS, 10 * STEPS * step, NULL, waves, &p,
                                    SPAR_ADVICE_COUNT, advice));
        OK(p.s, spar_session_apply_advice(p.s, &dt));
        double error = error_of(&p, dt, 10 * STEPS * step, &scene);
        print_message("asked for %g: dt %.4g, said %.3g, is %.3g over ten times the trials; asking cost %.3g runs\n",
                      tolerance[k], dt, advice[SPAR_ADVICE_ERROR], error, advice[SPAR_ADVICE_WORK]);
        assert_true(error <= tolerance[k]);
        assert_true(dt <= 0.65 / 10); /* ten steps in a period of its own */
        spar_session_destroy(&p.s);
    }
}

/* A quarter of a wave tells nothing of what a long run does: refused, with the cure; for a run as long as the trials it
   is enough. Nothing has changed. */
static void test_trials_too_short(void **state) {
    (void)state;
    pile p = {.load = 0.1, .rate = 0.2, .drag = 0.3};
    double advice[SPAR_ADVICE_COUNT] = {7};
    build(&p, SPAR_FIDELITY_EXACT, 0);
    REFUSED(p.s, SPAR_ERR_NUMERIC, "give more steps, or the length 7.2",
            spar_session_advise(p.s, 3e-2, 0.02, 360, 72, NULL, waves, &p, SPAR_ADVICE_COUNT, advice));
    assert_true(advice[0] == 7);
    REFUSED(p.s, SPAR_ERR_STATE, "no advice", spar_member_get_advice(p.b, NULL, NULL, NULL, NULL));
    OK(p.s, spar_session_advise(p.s, 3e-2, 0.02, 360, 7.2, NULL, waves, &p, SPAR_ADVICE_COUNT, advice));
    spar_session_destroy(&p.s);
}

static void test_bad_lengths(void **state) {
    (void)state;
    static const double bad[] = {0, -1, NAN, INFINITY};
    pile p = {.load = 0.1, .rate = 2.1};
    double advice[SPAR_ADVICE_COUNT];
    build(&p, SPAR_FIDELITY_EXACT, 0);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        REFUSED(p.s, SPAR_ERR_ARGUMENT, "the length is ",
                spar_session_advise(p.s, 3e-2, 0.02, 8, bad[k], NULL, waves, &p, SPAR_ADVICE_COUNT, advice));
    }
    spar_session_destroy(&p.s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kept_over_ten_times),
        cmocka_unit_test(test_trials_too_short),
        cmocka_unit_test(test_bad_lengths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
