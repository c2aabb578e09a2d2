/* Hard cases of the coupling: each must end with a bounded, right answer or a clear refusal that leaves the state.
   Closed forms are those of a mass on a spring with added mass: w^2 = k / (m + m_a), x = F/k (1 - cos w t) under a step
   load. */
#include "pistons.h"

static const double pi = 3.14159265358979323846;

/* mass 1 at the tip of a rod with spring 4, added mass `added` at the tip, pulled by a step load of 1 */
typedef struct oscillator {
    spar_session *session;
    spar_member *rod;
    spar_fluid *fluid;
    double added;
    int silent; /* pushes nothing */
    int warnings;
} oscillator;

static int answer(spar_session *s, double t, double dt, int iteration, void *context) {
    oscillator *o = context;
    double a[12], f[3] = {0};
    (void)t;
    (void)dt;
    (void)iteration;
    if (o->silent) {
        return 0;
    }
    OK(s, spar_member_get_motion(o->rod, NULL, NULL, a));
    f[0] = -o->added * a[6];
    return spar_fluid_push_forces(o->fluid, f, NULL);
}

static void listen(const spar_session *s, int level, const char *text, void *context) {
    oscillator *o = context;
    (void)s;
    o->warnings += level == SPAR_LOG_WARNING && strstr(text, "unstable");
}

static void create(oscillator *o, int scheme, double added, double force) {
    const double place[3] = {1, 0, 0}, tip[6] = {force, 0, 0, 0, 0, 0}, f0[3] = {-added * force / (1 + added), 0, 0};
    double K[36], M[36];
    *o = (oscillator){.added = added};
    spar_session *s = o->session = scene_session();
    OK(s, spar_session_set_integrator(s, 1, 1));
    OK(s, spar_session_set_coupling(s, scheme, 0, 1e-10, 100));
    scene_diagonal(K, 4, 1, 1, 1, 1, 1);
    scene_diagonal(M, 2, 2, 2, 1, 1, 1);
    o->rod = scene_beam(s, "rod", 1, 2, 1, K, M);
    OK(s, spar_beam_set_quadrature(o->rod, SPAR_QUADRATURE_LOBATTO, 2));
    OK(s, spar_member_set_root(o->rod, SPAR_ROOT_FIXED));
    OK(s, spar_member_commit(o->rod));
    OK(s, spar_member_set_load(o->rod, 1, SPAR_LOAD_DEAD, tip));
    OK(s, spar_fluid_create(o->rod, "medium", &o->fluid));
    OK(s, spar_fluid_set_force_nodes(o->fluid, 1, place));
    OK(s, spar_fluid_map(o->fluid));
    OK(s, spar_fluid_push_forces(o->fluid, f0, NULL));
}

static double tip(const oscillator *o) {
    double q[14];
    OK(o->session, spar_member_get_motion(o->rod, q, NULL, NULL));
    return q[7];
}

/* A hundred times the mass, ten periods of 200 steps: the integrator (the trapezoidal rule) turns tan(w dt / 2) = W dt
   / 2, and the run follows that to 1e-7 of its amplitude, what the tolerance 1e-10 of loads 100 times the answer
   leaves. */
static void test_added_mass_100(void **state) {
    (void)state;
    for (int scheme = SPAR_COUPLING_AITKEN; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
        oscillator o;
        double W = sqrt(4 / 101.0), dt = 2 * pi / W / 200, w = 2 / dt * atan(W * dt / 2), worst = 0;
        int most = 0, iterations;
        create(&o, scheme, 100, 1);
        for (int n = 1; n <= 2000; n++) {
            OK(o.session, spar_step(o.session, dt, answer, &o, &iterations));
            worst = fmax(worst, fabs(tip(&o) - 0.25 * (1 - cos(w * n * dt))));
            most = iterations > most ? iterations : most;
        }
        assert_true(worst < 1e-7);
        assert_true(most <= 4);
        spar_session_destroy(&o.session);
    }
}

/* The same explicitly: the log warns while the answer is still of the size of the right one, the run ends with a
   refusal, and the last accepted state is there. */
static void test_explicit_ends_with_a_refusal(void **state) {
    (void)state;
    oscillator o;
    create(&o, SPAR_COUPLING_EXPLICIT, 100, 1);
    OK(o.session, spar_session_set_log(o.session, listen, &o));
    int status = SPAR_OK, steps = 0;
    double at_warning = 0, before = 0;
    while (status == SPAR_OK && steps++ < 2000) {
        before = tip(&o);
        status = spar_step(o.session, 0.01, answer, &o, NULL);
        at_warning = o.warnings == 0 ? tip(&o) : at_warning;
    }
    assert_int_equal(status, SPAR_ERR_NUMERIC);
    assert_true(o.warnings >= 1);
    assert_true(fabs(at_warning) < 1e3);
    assert_true(isfinite(before) && tip(&o) == before);
    /* and goes on with an iterated scheme where the host wants to */
    OK(o.session, spar_session_set_coupling(o.session, SPAR_COUPLING_IQN_ILS, 0, 1e-8, 100));
    status = spar_step(o.session, 1e-6, answer, &o, NULL);
    assert_true(status == SPAR_OK || status == SPAR_ERR_NUMERIC);
    assert_true(isfinite(tip(&o)));
    spar_session_destroy(&o.session);
}

/* dt a thousand times up and down: columns of other steps rest, and the free amplitude of 0.25 does not grow. A step of
   1 s turns its phase by omega dt = 0.36; the stage of a step of another length takes the loads as linear, which is off
   by (omega dt)^2 / 8 = 0.016 of the fluid's, in each of the two steps after a change. */
static void test_jumps_of_dt(void **state) {
    (void)state;
    oscillator o;
    double largest = 0;
    create(&o, SPAR_COUPLING_IQN_ILS, 30, 1);
    for (int n = 0; n < 600; n++) {
        OK(o.session, spar_step(o.session, n / 50 % 2 ? 1 : 1e-3, answer, &o, NULL));
        largest = fmax(largest, fabs(tip(&o) - 0.25));
    }
    assert_true(largest > 0.2 && largest < 0.27);
    spar_session_destroy(&o.session);
}

/* A thousand substeps under loads that are linear in each step: right to second order in dt. */
static void test_thousand_substeps(void **state) {
    (void)state;
    double error[2] = {0, 0};
    for (int k = 0; k < 2; k++) {
        oscillator o;
        int steps = 50 << k;
        double W = sqrt(4 / 11.0), dt = 2 * pi / W / steps;
        create(&o, SPAR_COUPLING_IQN_ILS, 10, 1);
        OK(o.session, spar_session_set_integrator(o.session, 1, 1000));
        for (int n = 1; n <= steps; n++) {
            OK(o.session, spar_step(o.session, dt, answer, &o, NULL));
            error[k] = fmax(error[k], fabs(tip(&o) - 0.25 * (1 - cos(W * n * dt))));
        }
        spar_session_destroy(&o.session);
    }
    assert_true(error[1] < 0.25 * 0.02);
    NEAR(log2(error[0] / error[1]), 2, 0.1);
}

/* A fluid that pushes nothing: the bits of a run without one. */
static void test_fluid_that_pushes_nothing(void **state) {
    (void)state;
    for (int scheme = SPAR_COUPLING_EXPLICIT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
        oscillator with, without;
        int iterations;
        create(&with, scheme, 0, 1);
        create(&without, scheme, 0, 1);
        with.silent = 1;
        for (int n = 0; n < 50; n++) {
            OK(with.session, spar_step(with.session, 0.05, answer, &with, &iterations));
            OK(without.session, spar_step(without.session, 0.05, NULL, NULL, NULL));
            assert_int_equal(iterations, 1);
            assert_true(tip(&with) == tip(&without));
        }
        spar_session_destroy(&with.session);
        spar_session_destroy(&without.session);
    }
}

/* A load on a free mass that reverses every step, each predictor: what is predicted is up to seven times too large,
   what is iterated is right: a = +-F/m at the steps' ends, so that the speed swings between 0 and -F dt / 2m. */
static int reversing(spar_session *s, double t, double dt, int iteration, void *context) {
    pistons *p = context;
    double f[3] = {fmod(floor(t / dt + 0.5), 2) == 0 ? -3 : 3, 0, 0};
    (void)s;
    (void)iteration;
    return spar_fluid_push_forces(p->fluid[0], f, NULL);
}

static void test_load_that_reverses(void **state) {
    (void)state;
    static const double r = 0, plus[3] = {3, 0, 0};
    for (int order = 0; order <= 2; order++) {
        for (int scheme = SPAR_COUPLING_EXPLICIT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
            pistons p;
            double v[6], bound = scheme == SPAR_COUPLING_EXPLICIT ? 7 * 1.5 * 0.1 : 1e-12;
            pistons_create(&p, 1, &r);
            OK(p.session, spar_session_set_predictor(p.session, order));
            OK(p.session, spar_session_set_coupling(p.session, scheme, 0, 1e-10, 20));
            OK(p.session, spar_fluid_push_forces(p.fluid[0], plus, NULL));
            for (int n = 0; n < 1000; n++) {
                OK(p.session, spar_step(p.session, 0.1, reversing, &p, NULL));
                OK(p.session, spar_member_get_motion(p.body[0], NULL, v, NULL));
                assert_true(fabs(v[0]) <= bound);
            }
            pistons_destroy(&p);
        }
    }
}

/* Loads 1e12 times too large on a blade: refused by Newton, the state is kept to the bit, and the run goes on. */
static int too_large(spar_session *s, double t, double dt, int iteration, void *context) {
    oscillator *o = context;
    double f[3] = {0, o->added * (t < 0.045 ? 1 : 1e12), 0};
    (void)s;
    (void)dt;
    (void)iteration;
    return spar_fluid_push_forces(o->fluid, f, NULL);
}

static void test_loads_too_large(void **state) {
    (void)state;
    double K[36], M[36], place[3] = {10, 0, 0}, before[7], after[7];
    oscillator o = {.added = 10};
    o.session = scene_session();
    scene_box(K, M);
    OK(o.session, spar_session_set_coupling(o.session, SPAR_COUPLING_IQN_ILS, 0, 1e-8, 20));
    o.rod = scene_beam(o.session, "blade", 1, 6, 10, K, M);
    OK(o.session, spar_member_set_root(o.rod, SPAR_ROOT_FIXED));
    OK(o.session, spar_member_commit(o.rod));
    OK(o.session, spar_fluid_create(o.rod, "gale", &o.fluid));
    OK(o.session, spar_fluid_set_force_nodes(o.fluid, 1, place));
    OK(o.session, spar_fluid_map(o.fluid));
    for (int n = 0; n < 5; n++) {
        OK(o.session, spar_step(o.session, 0.01, too_large, &o, NULL));
    }
    scene_tip(o.rod, before);
    assert_int_equal(spar_step(o.session, 0.01, too_large, &o, NULL), SPAR_ERR_NUMERIC);
    assert_non_null(strstr(spar_session_message(o.session), "blade"));
    scene_tip(o.rod, after);
    assert_memory_equal(before, after, sizeof before);
    o.added = 1e-11; /* the host has found its mistake */
    OK(o.session, spar_step(o.session, 0.01, too_large, &o, NULL));
    spar_session_destroy(&o.session);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_added_mass_100),
        cmocka_unit_test(test_explicit_ends_with_a_refusal),
        cmocka_unit_test(test_jumps_of_dt),
        cmocka_unit_test(test_thousand_substeps),
        cmocka_unit_test(test_fluid_that_pushes_nothing),
        cmocka_unit_test(test_load_that_reverses),
        cmocka_unit_test(test_loads_too_large),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
