/* Couplings with flows as solvers have them (tests/support/flows.h): partly converged, noisy, heavy. The default
   quasi-Newton must end every step; figures beside bounds are what it took when this was written. */
#include "scene.h"

#include "support/flows.h"

#include <stdio.h>

static flow_result result, exact;

static flow_case flow_of(int scene, double added, int inner) {
    return (flow_case){.scene = scene,
                       .added = added,
                       .inner = inner,
                       .drag = 1.2,
                       .dt = 0.025,
                       .steps = 40,
                       .scheme = SPAR_COUPLING_IQN_ILS,
                       .predictor = -1,
                       .most = 150,
                       .rtol = 1e-5,
                       .seed = 3};
}

static void run(const flow_case *c) {
    assert_int_equal(flow_run(c, &result), SPAR_OK);
    if (result.status != SPAR_OK) {
        fail_msg("scene %d, added mass %g, %d corrections, noise %g: step %d: %s", c->scene, c->added, c->inner,
                 c->noise, result.steps + 1, result.message);
    }
}

/* Added mass 0.1 to 100, exact and with 1 to 4 corrections of the pressure in each push: every step ends, and where the
   solution with the exact fluid and a tolerance of 1e-10 is, within 1e-3 of the largest way (the tolerance of loads,
   1e-5, of 40 steps, and what the inner corrections leave). Exact fluids take no more than 3 evaluations a step. */
static void test_partly_converged(void **state) {
    (void)state;
    static const double added[] = {0.1, 1, 4, 30, 100};
    static const int inner[] = {0, 1, 2, 4};
    for (int scene = FLOW_CYLINDER; scene <= FLOW_CHANNEL; scene++) {
        for (size_t a = 0; a < sizeof added / sizeof *added; a++) {
            flow_case c = flow_of(scene, added[a], 0);
            c.rtol = 1e-10;
            run(&c);
            exact = result;
            for (size_t k = 0; k < sizeof inner / sizeof *inner; k++) {
                c = flow_of(scene, added[a], inner[k]);
                run(&c);
                assert_true(flow_distance(&result, &exact) < 1e-3);
                assert_true(inner[k] > 0 || result.iterations < 3);
            }
        }
    }
}

/* Noise up to a hundredth of the loads, with tolerances five times as large: no more iterations than without. */
static void test_noise(void **state) {
    (void)state;
    static const double added[] = {0.1, 1, 4, 30, 100}, noise[] = {1e-8, 1e-5, 1e-3, 1e-2};
    for (int scene = FLOW_CYLINDER; scene <= FLOW_CHANNEL; scene++) {
        for (size_t a = 0; a < sizeof added / sizeof *added; a++) {
            for (size_t k = 0; k < sizeof noise / sizeof *noise; k++) {
                flow_case c = flow_of(scene, added[a], 0);
                c.noise = noise[k];
                c.rtol = fmax(1e-5, 5 * noise[k]);
                run(&c);
                assert_true(result.iterations < 4);
            }
        }
    }
}

/* A flag that swings by 13 degrees to either side: its flexibility, nothing along it and all across it, turns within a
   step and from step to step, under loads that are hundreds of times the differences that the scheme learns from.
   Columns of 15 steps, and noise of a fifth and of half the tolerance: every step ends (2.3 and 3.1 evaluations, 7 at
   most). With images that are differences of those of whole loads the second diverged in step 278. */
static void test_far_swing(void **state) {
    (void)state;
    static const double noise[] = {2e-5, 5e-5};
    for (size_t k = 0; k < sizeof noise / sizeof *noise; k++) {
        flow_case c = flow_of(FLOW_FLAG, 4, 0);
        c.noise = noise[k];
        c.swing = 30, c.drag = 0.1;
        c.dt = 0.01, c.steps = 400, c.rtol = 1e-4, c.seed = 0;
        c.option[0][0] = "coupling.reuse", c.option[0][1] = "15";
        run(&c);
        print_message("noise %.0e: %.2f evaluations, %d at most\n", noise[k], result.iterations, result.most);
        assert_true(result.iterations < 3.5 && result.most <= 12);
    }
}

/* Drag, which the structure hardly answers, says nothing of the motion: with a tolerance of 1e-3 of all loads the lift
   is left where it is by steps that end at once; of the motion it is right. The same where a joint holds against it. */
static void test_tolerance_is_of_the_motion(void **state) {
    (void)state;
    for (int tied = 0; tied < 2; tied++) {
        double error[2];
        flow_case c = flow_of(FLOW_CYLINDER, 4, 0);
        c.tied = tied;
        c.rtol = 1e-10;
        run(&c);
        exact = result;
        for (int k = 0; k < 2; k++) {
            c.scheme = SPAR_COUPLING_FIXED_POINT;
            c.omega = 0.2;
            c.rtol = 1e-3;
            c.option[0][0] = "coupling.norm", c.option[0][1] = k ? "loads" : "motion";
            run(&c);
            error[k] = flow_distance(&result, &exact);
        }
        print_message("%s, rtol 1e-3: error %.1e by motion, %.1e by loads\n", tied ? "on a joint" : "a rod", error[0],
                      error[1]);
        assert_true(error[0] < 1e-3 && error[0] < 0.5 * error[1]);
    }
}

/* A structure that joints hold is weighed as one that needs none: the cylinder a body on a joint's spring or the end of
   a rod; the wall welded to the ground or clamped; the same with a body at its tip, welded, or the stiff and heavy end
   of one beam. */
static void test_tied(void **state) {
    (void)state;
    static const struct {
        const char *name;
        int scene;
        double tip;
    } scenes[] = {{"cylinder", FLOW_CYLINDER, 0}, {"wall", FLOW_CHANNEL, 0}, {"wall with a tip", FLOW_CHANNEL, 0.2}};
    static const int schemes[] = {SPAR_COUPLING_IQN_ILS, SPAR_COUPLING_AITKEN};
    static const double added[] = {1, 30};
    for (int i = 0; i < 3 * 2 * 2 * 2; i++) {
        const int k = i / 8;
        flow_case c = flow_of(scenes[k].scene, added[i / 2 % 2], i % 2 ? 4 : 0);
        c.tip = scenes[k].tip;
        c.scheme = schemes[i / 4 % 2];
        c.newton = 1e-12; /* what differs is to be the joints alone */
        run(&c);
        exact = result;
        c.tied = 1;
        run(&c);
        int differ = 0;
        for (int n = 0; n < result.steps; n++) {
            differ += result.count[n] != exact.count[n];
        }
        print_message("%s, added mass %g, %s, %s: %.3f evaluations a step, tied %.3f, %d steps differ, off by %.1e\n",
                      scenes[k].name, added[i / 2 % 2], i / 4 % 2 ? "Aitken" : "IQN-ILS",
                      i % 2 ? "4 corrections" : "exact", exact.iterations, result.iterations, differ,
                      flow_distance(&result, &exact));
        assert_true(result.iterations <= 1.05 * exact.iterations);
        assert_true(flow_distance(&result, &exact) < 1e-5);
        assert_true(k != 1 || c.inner > 0 || differ <= 2);
    }
}

/* Nobody pushes at t = 0: the second step begins with the first one's loads, not with twice as much. */
static void test_start(void **state) {
    (void)state;
    flow_case c = flow_of(FLOW_CYLINDER, 1, 0);
    run(&c);
    NEAR(result.predicted[0], result.force[0][0], 1e-12);
    c.pushed = c.ramp = 1; /* nothing before the stream, and that is a load to extrapolate from */
    run(&c);
    NEAR(result.predicted[0], 2 * result.force[0][0], 1e-2);
}

/* An explicit scheme that dies is told of within the first third of the steps that it lasts; one that lives is not. */
static void test_warning_in_time(void **state) {
    (void)state;
    static const struct {
        int scene, order;
        double added;
    } cases[] = {{FLOW_CYLINDER, 1, 1}, {FLOW_CYLINDER, 0, 4}, {FLOW_CYLINDER, 1, 4}, {FLOW_CHANNEL, 1, 4}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        flow_case c = flow_of(cases[k].scene, cases[k].added, 0);
        c.scheme = SPAR_COUPLING_EXPLICIT;
        c.predictor = cases[k].order;
        c.steps = 400;
        c.option[0][0] = "coupling.unstable", c.option[0][1] = "accept"; /* till it dies */
        assert_int_equal(flow_run(&c, &result), SPAR_OK);
        assert_int_equal(result.status, SPAR_ERR_NUMERIC);
        assert_true(result.warned > 0 && 3 * result.warned <= result.steps);
    }
    flow_case c = flow_of(FLOW_CYLINDER, 0.2, 0);
    c.scheme = SPAR_COUPLING_EXPLICIT;
    c.steps = 400;
    run(&c);
    assert_int_equal(result.complaints, 0);
}

/* Loads that grow from iteration to iteration are told as that. */
static void test_divergence_is_named(void **state) {
    (void)state;
    flow_case c = flow_of(FLOW_CYLINDER, 4, 1);
    c.scheme = SPAR_COUPLING_FIXED_POINT;
    assert_int_equal(flow_run(&c, &result), SPAR_OK);
    assert_int_equal(result.status, SPAR_ERR_NUMERIC);
    assert_non_null(strstr(result.message, "the coupling diverges"));
    assert_non_null(strstr(result.message, "grown by a factor"));
}

/* The added mass is told of a flow once there are differences enough, and from then on in every step. The fluid takes
   its acceleration from velocities at both ends of the step: of a load at its end these change by gamma (1 - alpha_f) /
   (1 - alpha_m) = 0.502 of dt times load over mass (rho_inf 0.9), so that of the scene's 4 the coupling sees 2.01; to a
   tenth (there is drag too) where the fluid is exact; where two corrections leave a push half way between the last one
   and where it should be, between a quarter and all of it. */
static void test_added_mass(void **state) {
    (void)state;
    for (int inner = 0; inner <= 2; inner += 2) {
        flow_case c = flow_of(FLOW_CYLINDER, 4, inner);
        double least = HUGE_VAL, most = 0;
        int first = -1;
        run(&c);
        for (int n = 0; n < result.steps; n++) {
            first = first < 0 && result.added[n] != 0 ? n : first;
            least = first < 0 ? least : fmin(least, result.added[n]);
            most = fmax(most, result.added[n]);
        }
        print_message("added mass from step %d on: %.2f to %.2f\n", first + 1, least, most);
        assert_true(first >= 0 && first < 10);
        assert_true(inner == 0 ? least > 1.9 && most < 2.2 : least > 0.5 && most < 2);
    }
}

/* Forty iterated steps, in which the added mass is learned, and then what goes without it only with light fluids, at
   added mass 1 to 1000: a fixed point, two evaluations a step (cylinder, 1e-5 of the loads from the exact run, 1e-4 of
   the way); one evaluation, with a fluid that takes accelerations from velocities: order 1 within 5e-3 of the largest
   way on the cylinder, whose mass is one number; on the channel, whose pressure is no mass per length, order 0 within a
   tenth. Without learning runs of added mass 10 and more do not end. */
static void test_learned_mass(void **state) {
    (void)state;
    static const double added[] = {1, 10, 100, 1000};
    for (size_t a = 0; a < sizeof added / sizeof *added; a++) {
        for (int scene = FLOW_CYLINDER; scene <= FLOW_CHANNEL; scene++) {
            flow_case c = flow_of(scene, added[a], 0);
            c.steps = 200;
            c.rtol = 1e-10;
            run(&c);
            exact = result;
            c.rtol = 1e-5;
            c.learn = 1;
            c.change_at = 40;
            c.then = SPAR_COUPLING_FIXED_POINT, c.then_predictor = 1;
            run(&c);
            double fixed = 0;
            for (int i = 40; i < 200; i++) {
                fixed += result.count[i] / 160.0;
            }
            assert_true(result.used && result.used_at < 10 && flow_distance(&result, &exact) < 1e-4);
            assert_true(fixed < (scene == FLOW_CYLINDER ? 2.3 : 13));
            c.then = SPAR_COUPLING_EXPLICIT, c.then_predictor = scene == FLOW_CYLINDER;
            c.response = SPAR_RESPONSE_VELOCITY;
            run(&c);
            double off = flow_distance(&result, &exact);
            print_message("scene %d, added mass %g: fixed point %.1f evaluations, explicit off by %.1e\n", scene,
                          added[a], fixed, off);
            assert_true(off < (scene == FLOW_CYLINDER ? 5e-3 : 0.1));
            c.learn = 0;
            assert_int_equal(flow_run(&c, &result), SPAR_OK);
            assert_true(added[a] < 10 || result.status == SPAR_ERR_NUMERIC || flow_distance(&result, &exact) > 1);
        }
    }
}

/* What has not converged is accepted twice on end and told each time; the third is an error, unless patience is given.
 */
static void test_patience(void **state) {
    (void)state;
    flow_case c = flow_of(FLOW_CYLINDER, 4, 1);
    c.most = 3;
    c.option[0][0] = "coupling.unconverged", c.option[0][1] = "accept";
    assert_int_equal(flow_run(&c, &result), SPAR_OK);
    assert_int_equal(result.status, SPAR_ERR_NUMERIC);
    assert_int_equal(result.steps, 2);
    assert_int_equal(result.complaints, 2);
    c.option[1][0] = "coupling.patience", c.option[1][1] = "1000";
    run(&c);
    assert_int_equal(result.steps, 40);
    assert_int_equal(result.complaints, result.unconverged);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_partly_converged),
        cmocka_unit_test(test_noise),
        cmocka_unit_test(test_far_swing),
        cmocka_unit_test(test_tolerance_is_of_the_motion),
        cmocka_unit_test(test_tied),
        cmocka_unit_test(test_start),
        cmocka_unit_test(test_warning_in_time),
        cmocka_unit_test(test_divergence_is_named),
        cmocka_unit_test(test_patience),
        cmocka_unit_test(test_added_mass),
        cmocka_unit_test(test_learned_mass),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
