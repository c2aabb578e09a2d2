/* Loads of a fluid that begin or end gradually: options ramp and ramp.start. */
#include "scene.h"

#include <stdio.h>

static const double pi = 3.14159265358979323846;
static const double mass = 2, force = 6, k_spring = 8; /* angular frequency 2 */

typedef struct sprung {
    spar_session *s;
    spar_member *body;
    spar_fluid *fluid[2];
    int fluids;
} sprung;

/* A body on a spring along z, with fluids of one node in its middle. */
static void sprung_create(sprung *w, int fluids) {
    const double o[3] = {0}, unit[4] = {1, 0, 0, 0};
    double M[36], K[36] = {0};
    scene_diagonal(M, mass, mass, mass, 1, 1, 1);
    K[14] = k_spring;
    w->s = scene_session();
    w->fluids = fluids;
    OK(w->s, spar_rigid_create(w->s, "body", o, unit, M, &w->body));
    OK(w->s, spar_member_set_effects(w->body, SPAR_EFFECT_WORK, 0));
    OK(w->s, spar_member_commit(w->body));
    OK(w->s, spar_spring_create(w->s, "spring", w->body, 0, SPAR_FREE_Z, K, NULL, NULL, NULL));
    for (int i = 0; i < fluids; i++) {
        OK(w->s, spar_fluid_create(w->body, i ? "second" : "first", w->fluid + i));
        OK(w->s, spar_fluid_set_motion_nodes(w->fluid[i], 1, o));
        OK(w->s, spar_fluid_set_force_nodes(w->fluid[i], 1, o));
        OK(w->s, spar_fluid_map(w->fluid[i]));
    }
}

/* Every fluid pushes the whole force in every iteration. */
static int push_all(spar_session *s, double t, double dt, int iteration, void *context) {
    const sprung *w = context;
    const double f[3] = {0, 0, force};
    (void)s, (void)t, (void)dt, (void)iteration;
    int status = SPAR_OK;
    for (int i = 0; i < w->fluids && status == SPAR_OK; i++) {
        status = spar_fluid_push_forces(w->fluid[i], f, NULL);
    }
    return status;
}

static double load_z(const sprung *w) {
    double load[6];
    OK(w->s, spar_member_get_loads(w->body, load));
    return load[2];
}

/* m x'' + k x = F min(t/T, 1) from rest: F/k (t/T - sin(wt)/(wT)), then F/k (1 - (sin(wt) - sin(w(t - T)))/(wT)). T is
   a third more than a period, so that the body goes on swinging. 400 steps a period: error 3e-4 F/k by the period's.
   The fluid's work is the energy of body and spring, to the order of the integrator. */
static void test_oscillator(void **state) {
    (void)state;
    const double w = sqrt(k_spring / mass), period = 2 * pi / w, T = period * 4 / 3, dt = period / 400;
    sprung a;
    char text[40];
    sprung_create(&a, 1);
    (void)snprintf(text, sizeof text, "%.17g", T);
    OK(a.s, spar_fluid_set_option(a.fluid[0], "ramp", text));
    for (int i = 1; i <= 1000; i++) {
        double q[7], v[6], t = i * dt, rest = t > T ? t - T : 0;
        OK(a.s, spar_step(a.s, dt, push_all, &a, NULL));
        OK(a.s, spar_member_get_motion(a.body, q, v, NULL));
        double x = force / k_spring * (fmin(t / T, 1) - (sin(w * t) - sin(w * rest)) / (w * T));
        NEAR(q[2], x, 3e-4 * force / k_spring);
        NEAR(load_z(&a), force * fmin(t / T, 1), 1e-12 * force);
        if (i % 100 == 0) {
            double work[SPAR_WORK_COUNT], energy = 0.5 * mass * v[2] * v[2] + 0.5 * k_spring * q[2] * q[2];
            OK(a.s, spar_member_get_work(a.body, SPAR_WORK_COUNT, work));
            NEAR(work[SPAR_WORK_FLUID], energy, 1e-3 * force * force / k_spring);
        }
    }
    spar_session_destroy(&a.s);
}

/* Over a whole period nothing is left to swing: the body stands at F/k, to the same error. */
static void test_period(void **state) {
    (void)state;
    const double period = 2 * pi / sqrt(k_spring / mass);
    sprung a;
    char text[40];
    sprung_create(&a, 1);
    (void)snprintf(text, sizeof text, "%.17g", period);
    OK(a.s, spar_fluid_set_option(a.fluid[0], "ramp", text));
    for (int i = 1; i <= 800; i++) {
        double q[7];
        OK(a.s, spar_step(a.s, period / 400, push_all, &a, NULL));
        OK(a.s, spar_member_get_motion(a.body, q, NULL, NULL));
        if (i > 400) {
            NEAR(q[2], force / k_spring, 3e-4 * force / k_spring);
        }
    }
    spar_session_destroy(&a.s);
}

/* One source fades out from t = 0.5 to 1.5 while the other fades in: of equal forces the sum stays, and the body, which
   starts in equilibrium, stays with it (1e-12). Before and after, one source alone counts. */
static void test_blend(void **state) {
    (void)state;
    sprung a;
    double f[3];
    sprung_create(&a, 2);
    OK(a.s, spar_fluid_set_option(a.fluid[0], "ramp", "-1"));
    OK(a.s, spar_fluid_set_option(a.fluid[0], "ramp.start", "0.5"));
    OK(a.s, spar_fluid_set_option(a.fluid[1], "ramp", "1"));
    OK(a.s, spar_fluid_set_option(a.fluid[1], "ramp.start", "0.5"));
    OK(a.s, spar_session_solve_static(a.s, 1, push_all, &a, NULL));
    for (int i = 1; i <= 20; i++) {
        double q[7], t = 0.1 * i, part = fmin(1, fmax(0, t - 0.5)), first, second;
        OK(a.s, spar_step(a.s, 0.1, push_all, &a, NULL));
        OK(a.s, spar_member_get_motion(a.body, q, NULL, NULL));
        NEAR(q[2], force / k_spring, 1e-10);
        NEAR(load_z(&a), force, 1e-12);
        OK(a.s, spar_fluid_sum_loads(a.fluid[0], NULL, f, NULL));
        first = f[2];
        OK(a.s, spar_fluid_sum_loads(a.fluid[1], NULL, f, NULL));
        second = f[2];
        NEAR(first, force * (1 - part), 1e-12);
        NEAR(second, force * part, 1e-12);
    }
    spar_session_destroy(&a.s);
}

/* Other ways to push, in a step of 0.5 s from 0 of a ramp of 1 s: moments, single precision, strides, reproducible
   sums. Parts of a step have the factor of their middle, two halves 1/8 and 3/8. By (T13) their mean is m = F/4, the
   least-squares line through the two constants ends at e = (1/4 + 3/16) F, and the load at the end is m + e/2. */
static void test_pushes(void **state) {
    (void)state;
    const double strided[6] = {0, 7, 0, 7, force, 7}, f[3] = {0, 0, force}, moment[3] = {0, 4, 0};
    const float single[3] = {0, 0, (float)force};
    for (int reproducible = 0; reproducible < 2; reproducible++) {
        sprung a;
        double load[6], kept[3];
        sprung_create(&a, 1);
        OK(a.s, spar_session_set_reproducible(a.s, reproducible));
        OK(a.s, spar_fluid_set_option(a.fluid[0], "ramp", "1"));
        OK(a.s, spar_step_begin(a.s, 0.5));
        OK(a.s, spar_step_solve(a.s));
        OK(a.s, spar_fluid_push_forces(a.fluid[0], f, moment));
        OK(a.s, spar_fluid_sum_loads(a.fluid[0], NULL, load, load + 3));
        assert_true(load[2] == 0.5 * force && load[4] == 2);
        OK(a.s, spar_fluid_push_forces_f32(a.fluid[0], single, NULL));
        OK(a.s, spar_fluid_sum_loads(a.fluid[0], NULL, load, load + 3));
        assert_true(load[2] == 0.5 * force && load[4] == 0);
        OK(a.s, spar_fluid_push_forces_at(a.fluid[0], 0.5, f, NULL));
        OK(a.s, spar_fluid_push_forces_at(a.fluid[0], 1, f, NULL));
        OK(a.s, spar_fluid_sum_loads(a.fluid[0], NULL, load, load + 3));
        NEAR(load[2], (0.25 + 0.5 * 0.4375) * force, 1e-12);
        OK(a.s, spar_step_accept(a.s));
        OK(a.s, spar_fluid_set_layout(a.fluid[0], SPAR_NODES_FORCE, 6, 2));
        OK(a.s, spar_step_begin(a.s, 0.25));
        OK(a.s, spar_step_solve(a.s));
        OK(a.s, spar_fluid_push_forces(a.fluid[0], strided, NULL));
        OK(a.s, spar_fluid_sum_loads(a.fluid[0], NULL, load, kept));
        assert_true(load[2] == 0.75 * force);
        spar_session_destroy(&a.s);
    }
}

/* A run that continues from a file within the ramp has the same bits. */
static void test_restart(void **state) {
    (void)state;
    double q[2][7];
    for (int k = 0; k < 2; k++) {
        sprung a;
        sprung_create(&a, 1);
        OK(a.s, spar_fluid_set_option(a.fluid[0], "ramp", "1"));
        if (k == 1) {
            OK(a.s, spar_session_load(a.s, "ramp.spar"));
        }
        for (int i = k == 0 ? 0 : 5; i < 12; i++) {
            if (i == 5 && k == 0) {
                OK(a.s, spar_session_save(a.s, "ramp.spar"));
            }
            OK(a.s, spar_step(a.s, 0.1, push_all, &a, NULL));
        }
        OK(a.s, spar_member_get_motion(a.body, q[k], NULL, NULL));
        spar_session_destroy(&a.s);
    }
    assert_memory_equal(q[0], q[1], sizeof q[0]);
    remove("ramp.spar");
}

/* What is set can be read; what is no number is refused; off, and beyond the ramp, loads are pushed as they are. */
static void test_option(void **state) {
    (void)state;
    sprung a;
    char text[40];
    const double f[3] = {0, 0, NAN};
    double sum[3];
    sprung_create(&a, 1);
    OK(a.s, spar_fluid_get_option(a.fluid[0], "ramp", 40, text));
    assert_string_equal(text, "0");
    OK(a.s, spar_fluid_set_option(a.fluid[0], "ramp", "2.5"));
    OK(a.s, spar_fluid_get_option(a.fluid[0], "ramp", 40, text));
    assert_string_equal(text, "2.5");
    REFUSED(a.s, SPAR_ERR_ARGUMENT, "does not accept 'long'", spar_fluid_set_option(a.fluid[0], "ramp", "long"));
    REFUSED(a.s, SPAR_ERR_ARGUMENT, "does not accept 'inf'", spar_fluid_set_option(a.fluid[0], "ramp.start", "inf"));
    OK(a.s, spar_step_begin(a.s, 2.5));
    OK(a.s, spar_step_solve(a.s));
    REFUSED(a.s, SPAR_ERR_STATE, "", spar_fluid_set_option(a.fluid[0], "ramp", "1"));
    OK(a.s, push_all(a.s, 0, 0, 0, &a));
    OK(a.s, spar_fluid_sum_loads(a.fluid[0], NULL, sum, NULL));
    assert_true(sum[2] == force);
    OK(a.s, spar_step_reject(a.s));
    OK(a.s, spar_step_begin(a.s, 1));
    OK(a.s, spar_step_solve(a.s));
    REFUSED(a.s, SPAR_ERR_ARGUMENT, "force of node 0, component 2, is nan",
            spar_fluid_push_forces(a.fluid[0], f, NULL));
    spar_session_destroy(&a.s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_oscillator), cmocka_unit_test(test_period),
                                       cmocka_unit_test(test_blend),      cmocka_unit_test(test_pushes),
                                       cmocka_unit_test(test_restart),    cmocka_unit_test(test_option)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
