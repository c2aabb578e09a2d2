/* Steps of a session: the clock, messages, what a failed or refused call leaves, and who may end a step. */
#include "pistons.h"
#include "trials.h"

#include <stdio.h>

/* A push refused before the first step: what then cannot go on says so in its own name, with the reason; the same after
   messages of others; and all is well once the fluid is gone. */
static void test_refused_before_the_first_step(void **state) {
    (void)state;
    const double r = 0, nan3[3] = {0, NAN, 0};
    pistons p;
    pistons_create(&p, 1, &r);
    spar_session *s = p.session;
    spar_fluid *other = NULL;
    OK(s, spar_fluid_create(p.body[0], "other", &other));
    const double x[3] = {0, 0, 0};
    OK(s, spar_fluid_set_force_nodes(other, 1, x));
    OK(s, spar_fluid_map(other));
    assert_int_equal(spar_fluid_push_forces(other, nan3, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_session_set_predictor(s, 7), SPAR_ERR_ARGUMENT); /* another message stands now */
    static const char *const call[] = {"spar_step_begin", "spar_session_save"};
    for (int k = 0; k < 2; k++) {
        int status = k == 0 ? spar_step_begin(s, 0.1) : spar_session_save(s, "never_written.run");
        const char *text = spar_session_message(s);
        assert_int_equal(status, SPAR_ERR_ARGUMENT);
        assert_true(strncmp(text, call[k], strlen(call[k])) == 0);
        assert_non_null(strstr(text, "'other'"));
        assert_non_null(strstr(text, "component 1"));
    }
    spar_fluid_destroy(&other);
    scene_run(s, 0.1, 2);
    pistons_destroy(&p);
}

/* Messages stand until the next failure: a step that succeeds is none. */
static void test_messages_stand(void **state) {
    (void)state;
    const double r = 0;
    char before[1024];
    pistons p;
    pistons_create(&p, 1, &r);
    assert_int_equal(spar_session_set_predictor(p.session, 7), SPAR_ERR_ARGUMENT);
    snprintf(before, sizeof before, "%s", spar_session_message(p.session));
    OK(p.session, spar_step(p.session, 0.1, pistons_fluid, &p, NULL));
    assert_string_equal(spar_session_message(p.session), before);
    pistons_destroy(&p);
}

/* What was pushed for a static solution, or a first step, that then fails or is given up is in use no longer. The
   pinned body has no static solution: nothing holds its rotation. */
static void test_loads_as_they_were(void **state) {
    (void)state;
    const double f[3] = {0, 0, 1e-3}, wild[3] = {0, 0, 1e4}, tip[3] = {10, 0, 0};
    double K[36], M[36], loads[6 * 4], then[6 * 4];
    scene_box(K, M);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "beam", 1, 4, 10, K, M);
    spar_fluid *fluid = NULL;
    OK(s, spar_member_commit(b));
    OK(s, spar_fluid_create(b, "tip", &fluid));
    OK(s, spar_fluid_set_force_nodes(fluid, 1, tip));
    OK(s, spar_fluid_map(fluid));
    OK(s, spar_fluid_push_forces(fluid, f, NULL));
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_member_get_loads(b, loads));
    NEAR(loads[20], 1e-3, 1e-15);
    OK(s, spar_session_set_newton(s, 0, 1e-12, 1)); /* one iteration finds nothing */
    OK(s, spar_fluid_push_forces(fluid, wild, NULL));
    assert_int_equal(spar_step(s, 1, NULL, NULL, NULL), SPAR_ERR_NUMERIC);
    OK(s, spar_member_get_loads(b, then));
    assert_memory_equal(loads, then, sizeof loads);
    OK(s, spar_session_set_newton(s, 0, 1e-12, 50));
    OK(s, spar_step_begin(s, 0.01));
    OK(s, spar_step_reject(s));
    OK(s, spar_member_get_loads(b, then));
    assert_memory_equal(loads, then, sizeof loads);
    const double squeeze[3] = {-1e9, 0, 0}; /* past the column's limit: no equilibrium */
    OK(s, spar_fluid_push_forces(fluid, squeeze, NULL));
    assert_int_equal(spar_member_solve_static(b, 1), SPAR_ERR_NUMERIC);
    OK(s, spar_member_get_loads(b, then));
    assert_memory_equal(loads, then, sizeof loads);
    spar_session_destroy(&s);
}

/* A check that failed is no ground to accept on, whatever made it fail. */
static void test_no_accept_after_a_failed_check(void **state) {
    (void)state;
    const double r = 3, nan3[3] = {NAN, 0, 0}, f[3] = {1, 0, 0};
    int done;
    pistons p;
    pistons_create(&p, 1, &r);
    spar_session *s = p.session;
    OK(s, spar_step_begin(s, 0.1));
    OK(s, spar_step_solve(s));
    assert_int_equal(spar_fluid_push_forces(p.fluid[0], nan3, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_step_accept(s), SPAR_ERR_ARGUMENT); /* not checked, but refused */
    assert_int_equal(spar_step_check(s, &done), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_step_accept(s), SPAR_ERR_STATE);
    assert_non_null(strstr(spar_session_message(s), "spar_step_accept"));
    OK(s, spar_fluid_push_forces(p.fluid[0], f, NULL));
    assert_int_equal(spar_step_accept(s), SPAR_ERR_STATE); /* the good push is not checked yet */
    OK(s, spar_step_check(s, &done));
    OK(s, spar_step_accept(s));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_FIXED_POINT, 0, 1e-12, 1)); /* diverges, and ends at once */
    OK(s, spar_step_begin(s, 0.1));
    OK(s, spar_step_solve(s));
    OK(s, pistons_fluid(s, 0.1, 0.1, 0, &p));
    assert_int_equal(spar_step_check(s, &done), SPAR_ERR_NUMERIC);
    assert_int_equal(spar_step_accept(s), SPAR_ERR_STATE);
    OK(s, spar_step_reject(s));
    pistons_destroy(&p);
}

/* The clock stays a number, and so does every dt that a trial is made with. */
static int nothing(spar_session *s, double t, double dt, int iteration, void *context) {
    (void)s, (void)iteration, (void)context;
    assert_true(isfinite(t) && isfinite(dt) && dt > 0);
    return 0;
}

/* A million steps of 0.01 s end at 1e4 s to the last digit of the sum, 2e-13 s off as the double nearest to 0.01 is;
   added one by one they were 1.7e-7 s off. A file in the middle changes nothing. */
static void test_clock_of_many_steps(void **state) {
    (void)state;
    enum { STEPS = 1000000, HALF = STEPS / 2 };
    static const char file[] = "step_clock.spar";
    const double x[3] = {0}, J[3] = {1, 1, 1}, dt = 0.01;
    double t;
    spar_session *s = scene_session();
    (void)scene_body(s, "b", x, 1, J);
    for (int half = 0; half < 2; half++) {
        scene_run(s, dt, HALF);
        if (half == 0) {
            OK(s, spar_session_save(s, file));
            spar_session_destroy(&s);
            s = scene_session();
            (void)scene_body(s, "b", x, 1, J);
            OK(s, spar_session_load(s, file));
        }
    }
    (void)remove(file);
    OK(s, spar_session_get_time(s, &t, NULL, NULL));
    NEAR(t, 1e4, 2e-12); /* one digit of 1e4 */
    spar_session_destroy(&s);
}

static void test_clock_beyond_numbers(void **state) {
    (void)state;
    double report[TRY_COUNT], advice[ADVICE_COUNT], t;
    spar_session *s = scene_session();
    OK(s, spar_step(s, 1e308, nothing, NULL, NULL));
    assert_int_equal(spar_step(s, 1e308, nothing, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_session_message(s), "clock"));
    OK(s, spar_session_get_time(s, &t, NULL, NULL));
    assert_true(t == 1e308);
    OK(s, spar_step(s, 1e300, nothing, NULL, NULL));
    static const double dt[] = {1e308, 1e302, 5e-324};
    for (size_t k = 0; k < sizeof dt / sizeof *dt; k++) {
        assert_int_equal(trial_run(s, dt[k], 8, NULL, nothing, NULL, 0, report), SPAR_ERR_ARGUMENT);
        assert_int_equal(trial_advise(s, 0.1, dt[k], 8, 1, NULL, nothing, NULL, advice), SPAR_ERR_ARGUMENT);
    }
    spar_session_destroy(&s);
}

static int meddle(spar_session *s, double t, double dt, int iteration, void *context) {
    pistons *p = context;
    assert_int_equal(spar_step_solve(s), SPAR_ERR_STATE);
    assert_int_equal(spar_step_accept(s), SPAR_ERR_STATE);
    assert_non_null(strstr(spar_session_message(s), "spar_step_accept"));
    assert_int_equal(spar_step_reject(s), SPAR_ERR_STATE);
    int done = 0;
    assert_int_equal(spar_step_check(s, &done), SPAR_ERR_STATE);
    return pistons_fluid(s, t, dt, iteration, p);
}

/* The step that spar_step makes is not ended by the fluid solver it calls: such calls are refused, and the step comes
   out as without them: a = b / (1 + r) / m. */
static void test_a_fluid_solver_ends_no_step(void **state) {
    (void)state;
    const double ratio = 0.5;
    pistons p;
    pistons_create(&p, 1, &ratio);
    p.b[0] = 3;
    double a[6];
    OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_IQN_ILS, 0, 1e-12, 50));
    OK(p.session, spar_step(p.session, 0.1, meddle, &p, NULL));
    OK(p.session, spar_member_get_motion(p.body[0], NULL, NULL, a));
    NEAR(a[0], 3 / 1.5 / 2, 1e-12);
    OK(p.session, spar_step_begin(p.session, 0.1)); /* outside they are the host's again */
    OK(p.session, spar_step_solve(p.session));
    OK(p.session, spar_step_reject(p.session));
    pistons_destroy(&p);
}

/* What rounding leaves of a window: a step of less than 1e-12 of the last one, or one that the clock does not resolve,
   is refused by name, and the run goes on. 1e-11 of the last one is a step. */
static void test_least_step(void **state) {
    (void)state;
    const double r = 0;
    pistons p;
    pistons_create(&p, 1, &r);
    spar_session *s = p.session;
    OK(s, spar_step(s, 0.01, NULL, NULL, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "do not resolve it", spar_step_begin(s, 1e-18));
    REFUSED(s, SPAR_ERR_ARGUMENT, "after a step of 0.01 s", spar_step_begin(s, 0.9e-14));
    OK(s, spar_step(s, 1e-13, NULL, NULL, NULL));
    OK(s, spar_step(s, 1000, NULL, NULL, NULL));
    OK(s, spar_step(s, 1e-8, NULL, NULL, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "spar_step_begin: dt is 1e-14 s", spar_step_begin(s, 1e-14)); /* 1000 s + 1e-14 s */
    OK(s, spar_step(s, 0.01, NULL, NULL, NULL));
    pistons_destroy(&p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_refused_before_the_first_step),
        cmocka_unit_test(test_messages_stand),
        cmocka_unit_test(test_loads_as_they_were),
        cmocka_unit_test(test_no_accept_after_a_failed_check),
        cmocka_unit_test(test_clock_beyond_numbers),
        cmocka_unit_test(test_clock_of_many_steps),
        cmocka_unit_test(test_least_step),
        cmocka_unit_test(test_a_fluid_solver_ends_no_step),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
