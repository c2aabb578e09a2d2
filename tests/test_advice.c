/* Advice on the scenes of the benchmarks: the same every time, whatever else the machine does. */
#define _DEFAULT_SOURCE
#include "check.h"

#include "scenes.h"
#include "trial/cost.h"
#include "trial/plan.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { ROTOR, GUST, WING, PLATE, BODY };

/* All that is advised. */
typedef struct answer {
    double advice[SPAR_ADVICE_COUNT];
    int64_t modes;
    int fidelity, nodes, points, unused;
} answer;

static void ask(scene_run *r, double tolerance, int64_t steps, answer *a) {
    spar_session *s = r->session;
    memset(a, 0, sizeof *a);
    OK(s, spar_session_advise(s, tolerance, r->knobs.dt, steps, r->before, r->solve, r->context, SPAR_ADVICE_COUNT,
                              a->advice));
    OK(s, spar_member_get_advice(r->member, &a->fidelity, &a->modes, &a->nodes, &a->points));
}

/* ---- the same every time ---- */

enum { BURNERS = 2 };

/* Others that want the machine, until quench. */
static void burn(pid_t burner[BURNERS]) {
    for (int k = 0; k < BURNERS; k++) {
        burner[k] = fork();
        if (burner[k] == 0) {
            for (volatile unsigned i = 0; getppid() != 1; i++) {
            }
            _exit(0);
        }
    }
}

static void quench(const pid_t burner[BURNERS]) {
    for (int k = 0; k < BURNERS; k++) {
        if (burner[k] > 0) {
            kill(burner[k], SIGKILL);
            waitpid(burner[k], NULL, 0);
        }
    }
}

/* Ten times the same question on the rotor: to one session again and again, and to new ones; half of them while two
   other processes want the same processors. To the bit. */
static void test_the_same_every_time(void **state) {
    (void)state;
    enum { RUNS = 10, STEPS = 16 };
    const scene *rotor = &scenes[ROTOR];
    answer first, a;
    scene_run *r = NULL;
    pid_t burner[BURNERS];
    for (int k = 0; k < RUNS; k++) {
        if (k == RUNS / 2) {
            burn(burner);
        }
        if (k % 2 == 0) {
            scene_destroy(&r);
            assert_int_equal(scene_build(rotor, &rotor->standard, &r), SPAR_OK);
        }
        ask(r, 3e-2, STEPS, k == 0 ? &first : &a);
        if (k > 0 && memcmp(&first, &a, sizeof a) != 0) {
            quench(burner);
            fail_msg("run %d advises dt %.17g, cost %.17g, %d nodes; the first dt %.17g, cost %.17g, %d nodes", k,
                     a.advice[SPAR_ADVICE_DT], a.advice[SPAR_ADVICE_COST], a.nodes, first.advice[SPAR_ADVICE_DT],
                     first.advice[SPAR_ADVICE_COST], first.nodes);
        }
    }
    quench(burner);
    scene_destroy(&r);
}

/* ---- what a fluid counts for ---- */

/* Its nodes say it, up to ten times of that either way; from there on its time, in powers of a hundred of what they
   say; what the host says goes before both. A clock off by 60 % near the middle of a class changes nothing. */
static void test_weight_of_a_fluid(void **state) {
    (void)state;
    spar_session *s = NULL;
    OK(NULL, spar_session_create(&s));
    const double second = spari_rule.price.second, nodes = 5000, each = nodes / second;
    static const struct {
        double times, counts;
    } rows[] = {{0, 1},    {1e-9, 1},  {0.4, 1},   {1.6, 1},    {9.9, 1},     {10.1, 100},
                {60, 100}, {160, 100}, {990, 100}, {1010, 1e4}, {1.6e4, 1e4}, {1.6e6, 1e6}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        NEAR(spari_cost_solution(s, nodes, 7 * rows[k].times * each, 7), rows[k].counts * nodes, 0.5);
    }
    NEAR(spari_cost_solution(s, nodes, 0, 0), nodes, 0);
    NEAR(spari_cost_solution(s, 0, 0, 0), spari_rule.price.fluid, 0); /* no nodes: not for nothing */
    OK(s, spar_session_set_option(s, "advise.fluid_cost", "2.5e-6"));
    NEAR(spari_cost_solution(s, nodes, 1e9, 7), 2.5e-6 * second, 0.5);
    assert_int_equal(spar_session_set_option(s, "advise.fluid_cost", "-1"), SPAR_ERR_ARGUMENT);
    spar_session_destroy(&s);
}

/* Solutions of the fluid in a second of the run, as they are counted for the advice: dt, and what the scheme takes. */
static double solutions(const scene *of, const answer *a, double over) {
    scene_run *r;
    knobs k = of->standard;
    double seconds = 0, t = 0;
    int64_t iterations = 0;
    k.dt = a->advice[SPAR_ADVICE_DT], k.substeps = (int)a->advice[SPAR_ADVICE_SUBSTEPS];
    k.scheme = (int)a->advice[SPAR_ADVICE_SCHEME], k.tolerance = a->advice[SPAR_ADVICE_COUPLING_RTOL];
    k.predictor = (int)a->advice[SPAR_ADVICE_PREDICTOR], k.newton = a->advice[SPAR_ADVICE_NEWTON_RTOL];
    k.fidelity = a->fidelity, k.modes = a->modes, k.nodes = a->nodes;
    k.points = a->points, k.rule = a->points > 0 ? SPAR_QUADRATURE_SECTIONS : k.rule;
    assert_int_equal(scene_build(of, &k, &r), SPAR_OK);
    for (; t < over; t += k.dt) {
        OK(r->session, scene_step(r, &seconds, &iterations));
    }
    scene_destroy(&r);
    return (double)iterations / t;
}

/* With a fluid that costs an hour a solution, no advice takes more solutions than with one that costs nothing to speak
   of; and what the structure costs no longer matters. On the wing these are different answers. */
static void test_dear_and_cheap_fluids(void **state) {
    (void)state;
    const scene *wing = &scenes[WING];
    const int64_t steps = 80;
    answer a[2];
    double taken[2];
    for (int dear = 0; dear < 2; dear++) {
        scene_run *r;
        assert_int_equal(scene_build(wing, &wing->standard, &r), SPAR_OK);
        OK(r->session, spar_session_set_option(r->session, "advise.fluid_cost", dear ? "3600" : "1e-9"));
        ask(r, 3e-2, steps, &a[dear]);
        scene_destroy(&r);
        taken[dear] = solutions(wing, &a[dear], (double)steps * wing->standard.dt);
    }
    print_message("solutions in a second: cheap %.4g, dear %.4g\n", taken[0], taken[1]);
    assert_true(taken[1] <= taken[0]);
    assert_true(memcmp(&a[0], &a[1], sizeof a[0]) != 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_same_every_time),
        cmocka_unit_test(test_weight_of_a_fluid),
        cmocka_unit_test(test_dear_and_cheap_fluids),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    scenes_free();
    return failed;
}
