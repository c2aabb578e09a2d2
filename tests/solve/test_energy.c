/* The balance of energy: kinetic, strain, potential, dissipated, and the work of loads, fluids and root. */
#include "scene.h"

#include <gsl/gsl_integration.h>

/* Static: strain energy is the work of loads that grow slowly, int lambda' f . u dlambda = f . u(1) - int f . u
   dlambda. The discrete forces are the gradient of the discrete energy: with 24 Gauss points in lambda 1e-10 of it. The
   composite box under a tip force and a dead line load, bent by a tenth of its length. */
static void test_static(void **state) {
    (void)state;
    enum { P = 8, N = 24 };
    double K[36], M[36], work = 0, e[4];
    const double eta[1] = {0};
    scene_box(K, M);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, P, 10, K, NULL);
    OK(s, spar_member_set_effects(b, SPAR_EFFECT_WORK, 0));
    OK(s, spar_member_commit(b));
    gsl_integration_glfixed_table *gauss = gsl_integration_glfixed_table_alloc(N);
    for (int k = 0; k <= N; k++) {
        double l = 1, w = 0, q[7 * P], load[6 * P], line[6] = {0}, force[6] = {0}, along = 0;
        if (k < N) {
            gsl_integration_glfixed_point(0, 1, (size_t)k, &l, &w, gauss);
        }
        force[1] = 40 * l, force[2] = 100 * l, line[2] = 5 * l;
        OK(s, spar_member_set_load(b, P - 1, SPAR_LOAD_DEAD, force));
        OK(s, spar_beam_set_line_load(b, SPAR_LOAD_DEAD, 1, eta, line));
        OK(s, spar_member_solve_static(b, 1));
        OK(s, spar_member_get_motion(b, q, NULL, NULL));
        OK(s, spar_member_get_loads(b, load));
        for (int i = 0; i < P; i++) {
            along += spari_dot(load + (ptrdiff_t)6 * i, q + (ptrdiff_t)7 * i) / l;
        }
        work += k < N ? -w * along : along;
    }
    gsl_integration_glfixed_table_free(gauss);
    OK(s, spar_member_get_energy(b, 4, e));
    assert_true(e[1] > 10);
    NEAR(work, e[1], 1e-10 * e[1]);
    spar_session_destroy(&s);
}

/* Everything at once: a damped, twisted beam of coupled sections turned and moved by its root, under gravity, dead,
   follower and line loads. The defect of the balance over the motion is of order 2 in dt: a quarter at half the step.
 */
static double defect(int n, double T) {
    enum { P = 6 };
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 10, 0, 1}, twist[2] = {0.3, 0}, g[3] = {0, 0, -9.81},
                 mu[6] = {0.01, 0.01, 0.01, 0.01, 0.01, 0.01}, dead[6] = {0, 3, 10, 1, 2, 3},
                 follower[6] = {1, 0, -8, 2, 0, 0}, line[12] = {0, 0, 4, 1, 0, 0, 0, 2, 0, 0, 0, 1};
    double K[36], M[36], e[2][4], work[3];
    spar_session *s = scene_session();
    spar_member *b = NULL;
    scene_box(K, M);
    OK(s, spar_session_set_gravity(s, g));
    OK(s, spar_session_set_integrator(s, 1, 1));
    OK(s, spar_session_set_newton(s, 1e-11, 1e-11, 30));
    OK(s, spar_beam_create(s, "b", 1, P, &b));
    OK(s, spar_beam_set_axis(b, 2, eta, xyz, twist));
    OK(s, spar_beam_set_sections(b, 1, eta, K, M));
    OK(s, spar_beam_set_damping(b, mu));
    OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
    OK(s, spar_member_set_effects(b, SPAR_EFFECT_WORK, 0));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, P - 1, SPAR_LOAD_DEAD, dead));
    OK(s, spar_member_set_load(b, P / 2, SPAR_LOAD_FOLLOWER, follower));
    OK(s, spar_beam_set_line_load(b, SPAR_LOAD_FOLLOWER, 2, eta, line));
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_member_get_work(b, 3, work));
    assert_true(work[0] == 0 && work[1] == 0 && work[2] == 0);
    OK(s, spar_member_get_energy(b, 4, e[0]));
    double dt = T / n;
    for (int i = 1; i <= n; i++) {
        double t = dt * i, c = t * t * t, c1 = 3 * t * t, c2 = 6 * t, psi[3] = {0, 0.2 * c, 0.4 * c},
               q[7] = {0.3 * c, 0, 0.2 * c}, v[6] = {0.3 * c1, 0, 0.2 * c1, 0, 0.2 * c1, 0.4 * c1},
               a[6] = {0.3 * c2, 0, 0.2 * c2, 0, 0.2 * c2, 0.4 * c2};
        spari_quat_exp(psi, q + 3);
        OK(s, spar_member_drive(b, q, v, a));
        scene_run(s, dt, 1);
    }
    OK(s, spar_member_get_energy(b, 4, e[1]));
    OK(s, spar_member_get_work(b, 3, work));
    double sum = -work[0] - work[1] - work[2];
    for (int i = 0; i < 4; i++) {
        sum += e[1][i] - e[0][i];
    }
    assert_true(fabs(work[0]) > 5 && fabs(work[2]) > 1 && e[1][3] > 1e-3 && e[1][0] > 1);
    spar_session_destroy(&s);
    return fabs(sum);
}

static void test_dynamic(void **state) {
    (void)state;
    double d[2] = {defect(200, 1), defect(400, 1)};
    NEAR(d[0] / d[1], 4, 0.3);
    assert_true(d[1] < 1e-2);
}

/* Step-loaded box at rest: K + U = 150 u3 at every time, and the work of a dead force is exactly that product. */
static void test_dead_force(void **state) {
    (void)state;
    enum { P = 6 };
    double K[36], M[36], q[7], work[3], load[6] = {0, 0, 150, 0, 0, 0};
    scene_box(K, M);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, P, 10, K, M);
    OK(s, spar_session_set_integrator(s, 1, 3));
    OK(s, spar_member_set_effects(b, SPAR_EFFECT_WORK, 0));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, P - 1, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_get_work(b, 3, work));
    for (int i = 0; i < 5; i++) {
        scene_run(s, 0.01, 10);
        OK(s, spar_member_get_work(b, 3, work));
        scene_tip(b, q);
        NEAR(work[0], 150 * q[2], 1e-10 * 300);
        assert_true(work[1] == 0 && work[2] == 0);
    }
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_member_get_work(b, 3, work));
    assert_true(work[0] == 0);
    spar_session_destroy(&s);
}

/* A force of the fluid that is there at t = 0 works from there on. A unit mass under 1 N from 1 m/s: its energy grows
   by the fluid's work to rounding, by the trapezium rule exact for a constant force. A rigid beam that its root carries
   along at 1 m/s keeps its energy: what the fluid gives at the tip the root takes. */
static void test_force_from_the_start(void **state) {
    (void)state;
    const double dt = 0.1, zero[3] = {0}, tip[3] = {10, 0, 0}, v0[3] = {0, 1, 0}, push[3] = {0, 1, 0};
    double K[36], M[36] = {0}, e[4], w[3];
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_member *m = NULL;
        spar_fluid *f = NULL;
        scene_box(K, M);
        for (int i = 0; i < 6; i++) {
            M[7 * i] = 1;
        }
        if (k == 0) {
            OK(s, spar_rigid_create(s, "body", zero, NULL, M, &m));
        } else {
            m = scene_beam(s, "beam", 1, 4, 10, K, M);
            OK(s, spar_member_set_root(m, SPAR_ROOT_DRIVEN));
            OK(s, spar_member_set_fidelity(m, SPAR_FIDELITY_RIGID, 0));
        }
        OK(s, spar_member_set_effects(m, SPAR_EFFECT_WORK, 0));
        OK(s, spar_member_commit(m));
        OK(s, spar_member_set_initial_velocity(m, NULL, v0, NULL));
        OK(s, spar_fluid_create(m, "air", &f));
        OK(s, spar_fluid_set_force_nodes(f, 1, k == 0 ? zero : tip));
        OK(s, spar_fluid_map(f));
        OK(s, spar_fluid_push_forces(f, push, NULL));
        OK(s, spar_member_get_energy(m, 4, e));
        const double before = e[SPAR_ENERGY_KINETIC];
        for (int i = 0; i < 3; i++) {
            const double q[7] = {0, (i + 1) * dt, 0, 1, 0, 0, 0}, v[6] = {0, 1, 0, 0, 0, 0};
            int done;
            OK(s, k == 0 ? SPAR_OK : spar_member_drive(m, q, v, NULL));
            OK(s, spar_step_begin(s, dt));
            OK(s, spar_step_solve(s));
            if (i == 0) { /* given up and begun again: nothing counts twice */
                OK(s, spar_step_reject(s));
                OK(s, spar_step_begin(s, dt));
                OK(s, spar_step_solve(s));
            }
            OK(s, spar_fluid_push_forces(f, push, NULL));
            OK(s, spar_step_check(s, &done));
            OK(s, spar_step_accept(s));
            OK(s, spar_member_get_energy(m, 4, e));
            OK(s, spar_member_get_work(m, 3, w));
            NEAR(e[SPAR_ENERGY_KINETIC] - before, w[SPAR_WORK_FLUID] + w[SPAR_WORK_ROOT], 1e-12);
            assert_true(w[SPAR_WORK_FLUID] > 0.9 * (i + 1) * dt);
        }
        spar_session_destroy(&s);
    }
}

static void test_refusals(void **state) {
    (void)state;
    double K[36], work[3];
    scene_diagonal(K, 1, 1, 1, 1, 1, 1);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, 3, 1, K, NULL), *bare = scene_beam(s, "bare", 1, 3, 1, K, NULL);
    assert_int_equal(spar_member_get_work(NULL, 3, work), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_member_get_work(b, 3, work), SPAR_ERR_STATE);
    OK(s, spar_member_set_effects(b, SPAR_EFFECT_WORK, 0));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_commit(bare));
    assert_int_equal(spar_member_get_work(b, -1, work), SPAR_ERR_ARGUMENT);
    OK(s, spar_step_begin(s, 0.1));
    OK(s, spar_member_get_work(b, 3, work));
    assert_int_equal(spar_member_get_work(bare, 3, work), SPAR_ERR_STATE);
    assert_non_null(strstr(spar_session_message(s), "request SPAR_EFFECT_WORK"));
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_static),     cmocka_unit_test(test_dynamic),
        cmocka_unit_test(test_dead_force), cmocka_unit_test(test_force_from_the_start),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
