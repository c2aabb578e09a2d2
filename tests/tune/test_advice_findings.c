/* Questions that are hard to answer from trials, on scenes of benchmarks/worlds.h: an impulse, a slow spin-up, a
   parametric excitation, light arms in a heavy fluid, a noisy fluid. What is advised keeps the tolerance in a run of
   several trials' time against the same scene in a sixteenth of its dt with a tight coupling; or it is refused. */
#include "check.h"
#include "trials.h"
#include "worlds.h"

#include <math.h>
#include <spar/spar_coupling.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FINER = 16, MOST_TRIALS = 15 };

static int number_of(const char *name) {
    int k = 0;
    while (strcmp(worlds[k].name, name) != 0) {
        k++;
    }
    return k;
}

/* End of the last member. */
static void look(const world *w, double out[3]) {
    double q[7 * 64];
    int64_t n;
    OK(w->s, spar_member_get_count(w->m[w->members - 1], &n));
    OK(w->s, spar_member_get_motion(w->m[w->members - 1], q, NULL, NULL));
    memcpy(out, q + 7 * (n - 1), 3 * sizeof *out);
}

/* Positions at every dt/FINER of the scene. */
static double *reference(int k, int64_t count) {
    world w;
    double *x = malloc((size_t)(3 * (count + 1)) * sizeof *x);
    assert_non_null(x);
    assert_int_equal(world_create(k, 10, 0, &w), SPAR_OK);
    w.air.noise = 0; /* of the solver: the answer that it is meant to give */
    OK(w.s, spar_session_set_coupling(w.s, SPAR_COUPLING_IQN_ILS, 1e-12, 1e-7, 50));
    look(&w, x);
    for (int64_t i = 1; i <= count; i++) {
        OK(w.s, world_step(&w, (double)(i - 1) * worlds[k].dt / FINER, worlds[k].dt / FINER));
        look(&w, x + 3 * i);
    }
    spar_session_destroy(&w.s);
    return x;
}

/* Root mean square of the error over that of the motion, as the world goes with dt. */
static double error_of(world *w, int k, double dt, int times, const double *x) {
    double difference = 0, size = 0, end = times * worlds[k].dt * (double)worlds[k].steps;
    for (int64_t i = 1; (double)i * dt <= end * (1 + 1e-9); i++) {
        double now[3], at = (double)i * dt / worlds[k].dt * FINER;
        int64_t low = (int64_t)fmin(at, (double)(times * FINER * worlds[k].steps - 1));
        OK(w->s, world_step(w, (double)(i - 1) * dt, dt));
        look(w, now);
        for (int c = 0; c < 3; c++) {
            double exact = x[3 * low + c] + (at - (double)low) * (x[3 * low + 3 + c] - x[3 * low + c]);
            difference += (now[c] - exact) * (now[c] - exact);
            size += (exact - x[c]) * (exact - x[c]);
        }
    }
    return sqrt(difference / size);
}

/* Asks, and returns the status; an answer is kept, is no error of 0, and took few trials. */
static int ask(const char *name, double tolerance, int times) {
    const int k = number_of(name);
    world w;
    double advice[ADVICE_COUNT], dt = 0;
    assert_int_equal(world_create(k, 8, 0, &w), SPAR_OK);
    int status = trial_advise(w.s, tolerance, worlds[k].dt, worlds[k].steps,
                              times * worlds[k].dt * (double)worlds[k].steps, world_before, world_solve, &w, advice);
    if (status != SPAR_OK) {
        print_message("%s to %g: %s\n", name, tolerance, spar_session_message(w.s));
    } else {
        double *x = reference(k, times * FINER * worlds[k].steps);
        OK(w.s, spar_trial_apply(trial_of(w.s), &dt));
        double error = error_of(&w, k, dt, times, x);
        print_message("%s to %g: dt %.4g, said %.3g, is %.3g, %g trials\n", name, tolerance, dt, advice[ADVICE_ERROR],
                      error, advice[ADVICE_RUNS]);
        assert_true(advice[ADVICE_ERROR] > 0 && advice[ADVICE_RUNS] <= MOST_TRIALS);
        assert_true(error <= tolerance);
        free(x);
    }
    spar_session_destroy(&w.s);
    return status;
}

/* A mass on a spring gets a kick of 0.03 s, which steps of 0.02 s see and those of 0.04 s and 0.08 s do not. The
   coarser ones agree with one another, and are all wrong. */
static void test_kick(void **state) {
    (void)state;
    assert_int_equal(ask("kick", 3e-2, 3), SPAR_OK);
    assert_int_equal(ask("kick", 1e-2, 3), SPAR_OK);
}

/* A shaft that spins up in 40 s, of which the trials show 3.2 s. */
static void test_spin_up(void **state) {
    (void)state;
    assert_int_equal(ask("spinup", 3e-2, 3), SPAR_OK);
}

/* A beam whose foundation is modulated: errors cross zero at some dt. */
static void test_parametric_excitation(void **state) {
    (void)state;
    assert_int_equal(ask("swing", 3e-2, 2), SPAR_OK);
}

/* Two stiff arms on hinges, with an added mass of three times their own. */
static void test_light_arms(void **state) {
    (void)state;
    assert_int_equal(ask("arms", 3e-2, 3), SPAR_OK);
}

/* A fluid that is solved to a few digits allows no tight coupling: the session's own is kept. White noise in time is
   resolved by no dt: refused, after few trials. */
static void test_noise(void **state) {
    (void)state;
    assert_int_equal(ask("grid", 3e-2, 3), SPAR_OK);
    assert_int_equal(ask("storm", 3e-2, 3), SPAR_ERR_NUMERIC);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kick),       cmocka_unit_test(test_spin_up), cmocka_unit_test(test_parametric_excitation),
        cmocka_unit_test(test_light_arms), cmocka_unit_test(test_noise),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
