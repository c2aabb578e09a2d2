/* The advised dt (SPAR_REPORT_ADVISED_DT) as a bound: a run that follows it from step to step keeps the error of the
   prediction below the target in 95 % of its steps, whatever the loads are like. */
#include "scene.h"

#include <math.h>
#include <stdio.h>

enum { HARMONIC, SEVERAL, OFFSET, GUSTS, SWEEP, KINDS };

/* A body on springs in six directions; forces at two places that come and go in time, and a drag. */
typedef struct scene {
    spar_session *session;
    spar_member *body;
    spar_fluid *air;
    int kind;
} scene;

static double course(int kind, int i, double t) {
    const double w = 6.2831853;
    switch (kind) {
    case HARMONIC:
        return sin(w * t + i);
    case SEVERAL:
        return sin(w * t + i) + 0.3 * sin(2.7 * w * t) + 0.1 * sin(7 * w * t);
    case OFFSET:
        return 1 + 0.5 * sin(w * t) * (i + 1);
    case GUSTS:
        return 0.2 + exp(-2 * pow(fmod(t, 20) - 5, 2)) * sin(w * t);
    default:
        return sin(w * t * (1 + 0.02 * t));
    }
}

static int blow(spar_session *s, double t, double dt, int iteration, void *context) {
    scene *c = context;
    double v[2][3], f[2][3];
    (void)iteration;
    OK(s, spar_fluid_pull_motion(c->air, 1, NULL, v[0]));
    for (int i = 0; i < 2; i++) {
        const double wind[3] = {course(c->kind, i, t + dt), c->kind == HARMONIC ? 0 : 0.3 * cos(4.4 * (t + dt)), 0};
        for (int k = 0; k < 3; k++) {
            f[i][k] = wind[k] - 0.3 * v[i][k];
        }
    }
    return spar_fluid_push_forces(c->air, f[0], NULL);
}

static void create(scene *c, int kind, int order, const char *target) {
    static const double zero[3] = {0, 0, 0}, J[3] = {1, 1, 1}, x[2][3] = {{0, 1, 0}, {0, -1, 0}};
    double M[36], K[36];
    spar_joint *spring;
    *c = (scene){.session = scene_session(), .kind = kind};
    spar_session *s = c->session;
    scene_mass(M, 1, zero, J);
    scene_diagonal(K, 30, 20, 20, 5, 5, 5);
    OK(s, spar_rigid_create(s, "body", NULL, NULL, M, &c->body));
    OK(s, spar_member_commit(c->body));
    OK(s, spar_member_set_spring(c->body, 0, 63, K, NULL, NULL, &spring));
    OK(s, spar_fluid_create(c->body, "air", &c->air));
    OK(s, spar_fluid_set_motion_nodes(c->air, 2, x[0]));
    OK(s, spar_fluid_set_force_nodes(c->air, 2, x[0]));
    OK(s, spar_fluid_map(c->air));
    OK(s, spar_session_set_predictor(s, order));
    OK(s, spar_session_set_option(s, "coupling.target", target));
}

/* Of 2000 steps after the first 20, the part whose error is at most `times` the target. */
static double kept(int kind, int order, const char *target, double dt, double times) {
    enum { STEPS = 2020, FIRST = 20 };
    scene c;
    int good = 0;
    double aim = strtod(target, NULL), report[SPAR_REPORT_COUNT];
    create(&c, kind, order, target);
    for (int i = 0; i < STEPS; i++) {
        OK(c.session, spar_step(c.session, dt, blow, &c, NULL));
        OK(c.session, spar_session_get_report(c.session, SPAR_REPORT_COUNT, report));
        good += i >= FIRST && report[SPAR_REPORT_ERROR] <= times * aim;
        dt = report[SPAR_REPORT_ADVISED_DT];
    }
    spar_session_destroy(&c.session);
    return (double)good / (STEPS - FIRST);
}

/* 95 % of the steps within the target (as it was, 62 to 99.9 % of order 1 and 2); and not 100: it is no smaller than it
   need be. The few beyond stay within twice of it in 97 %. */
static void it_is_kept_in_95_of_100_steps(void **state) {
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        for (int order = 0; order <= 2; order++) {
            double part = kept(kind, order, order == 0 ? "0.01" : order == 1 ? "0.001" : "0.01", 0.01, 1);
            print_message("loads %d, order %d: %.3f\n", kind, order, part);
            assert_true(part >= 0.95 && part <= 0.98);
        }
        assert_true(kept(kind, 2, "0.01", 0.01, 2) >= 0.97);
    }
}

/* The first dt does not matter: a hundredth, or twenty times of what it becomes. */
static void from_any_first_step(void **state) {
    (void)state;
    assert_true(kept(SEVERAL, 2, "0.01", 1e-4, 1) >= 0.95);
    assert_true(kept(SEVERAL, 2, "0.01", 0.2, 1) >= 0.94);
}

/* At a fixed dt it says the dt that keeps the target: the error at the one advised, run on at that, is within it in 95
   % of the steps too. */
static void what_it_says_at_a_fixed_dt(void **state) {
    (void)state;
    scene c;
    int good = 0;
    double report[SPAR_REPORT_COUNT], least = 1;
    create(&c, SEVERAL, 1, "0.001");
    for (int i = 0; i < 1500; i++) {
        OK(c.session, spar_step(c.session, 0.002, blow, &c, NULL));
        OK(c.session, spar_session_get_report(c.session, SPAR_REPORT_COUNT, report));
        least = i >= 1000 ? fmin(least, report[SPAR_REPORT_ADVISED_DT]) : least;
    }
    for (int i = 0; i < 1500; i++) {
        OK(c.session, spar_step(c.session, least, blow, &c, NULL));
        OK(c.session, spar_session_get_report(c.session, SPAR_REPORT_COUNT, report));
        good += report[SPAR_REPORT_ERROR] <= 0.001;
    }
    assert_true(good >= 1425);
    spar_session_destroy(&c.session);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(it_is_kept_in_95_of_100_steps),
                                       cmocka_unit_test(from_any_first_step),
                                       cmocka_unit_test(what_it_says_at_a_fixed_dt)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
