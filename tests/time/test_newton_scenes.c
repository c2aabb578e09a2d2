/* Newton with its default tolerance in coupled scenes: the same as strict (1e-12) to a part of what dt leaves, with
   fewer iterations. See test_newton.c. */
#include "check.h"
#include "scenes.h"

typedef struct played {
    scene_result result;
    double newton; /* iterations a step */
} played;

static played play(const scene *of, double dt, int strict) {
    knobs k = of->standard;
    scene_run *run;
    played p;
    int64_t taken;
    double left;
    k.dt = dt;
    OK(NULL, scene_build(of, &k, &run));
    if (strict) {
        OK(run->session, spar_session_set_newton(run->session, 1e-15, 1e-12, 50));
    }
    OK(run->session, scene_march(run, &p.result));
    OK(run->session, spar_member_get_iterations(run->member, &taken, &left));
    p.newton = (double)taken / (double)p.result.steps;
    assert_true(left >= 0 && left < 1e-7);
    scene_destroy(&run);
    return p;
}

/* The benchmarks' five scenes with their standard settings, four of them explicit, the plate by IQN-ILS to 1e-6,
   default and strict. Their distance may be a hundredth of the error of dt, in positions and in loads at the root. The
   fluid is evaluated no more often than by a hundredth. */
static void test_scenes_are_the_same(void **state) {
    (void)state;
    for (int k = 0; k < SCENE_COUNT; k++) {
        const scene *of = scenes + k;
        played strict = play(of, of->standard.dt, 1), plain = play(of, of->standard.dt, 0),
               fine = play(of, of->standard.dt / 2, 1);
        const scene_result *a = &strict.result, *b = &plain.result, *c = &fine.result;
        double error = scene_distance(a->history, c->history), load = scene_distance(a->load, c->load);
        print_message("%s: places %.1e, loads %.1e of the error; iterations %.2f of %.2f, of the coupling %.3f\n",
                      of->name, scene_distance(a->history, b->history) / error, scene_distance(a->load, b->load) / load,
                      plain.newton, strict.newton, (double)b->iterations / (double)a->iterations);
        assert_true(scene_distance(a->history, b->history) <= 0.01 * error);
        assert_true(scene_distance(a->load, b->load) <= 0.01 * load);
        assert_true(plain.newton <= strict.newton);
        assert_true((double)b->iterations <= 1.01 * (double)a->iterations);
    }
    scenes_free();
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_scenes_are_the_same)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
