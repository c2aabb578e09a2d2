/* Mass-proportional damping: growth rates, the step response of one mode and the energy in closed form, fidelities
   against each other, roots that turn, beams that fly, what switches it, save and load, bad input. */
#include "scene.h"
#include "trials.h"

#include <stdio.h>

enum { P = 7, KINDS = 3 };
static const double two_pi = 6.283185307179586, L = 2, alpha = 0.8;
static const int kinds[KINDS] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL};

static spar_member *beam(spar_session *s, int kind, int64_t modes, double drag, const double *mu) {
    double K[36], M[36];
    scene_diagonal(K, 1e5, 1e5, 1e5, 300, 200, 350);
    scene_diagonal(M, 3, 3, 3, 0.02, 0.01, 0.012);
    spar_member *b = scene_beam(s, "beam", 1, P, L, K, M);
    OK(s, spar_beam_set_mass_damping(b, drag));
    OK(s, mu ? spar_beam_set_damping(b, mu) : SPAR_OK);
    OK(s, spar_member_set_fidelity(b, kinds[kind], modes));
    return b;
}

/* Every mode decays by alpha / 2, its frequency is sqrt(omega^2 - alpha^2 / 4); with mu for all strains alike by (alpha
   + mu omega^2) / 2: the closed form of Rayleigh's damping. Eigenvalues and modes are known to 1e-9. */
static void test_growth_rates(void **state) {
    (void)state;
    static const double mu[6] = {2e-3, 2e-3, 2e-3, 2e-3, 2e-3, 2e-3};
    for (int k = 0; k < 2 * KINDS; k++) {
        double f[5], value[5][2], stiff = k < KINDS ? 0 : 2e-3;
        spar_session *s = scene_session();
        spar_member *b = beam(s, k % KINDS, 8, alpha, k < KINDS ? NULL : mu);
        OK(s, spar_member_commit(b));
        OK(s, spar_member_solve_modes(b, 5, f, NULL));
        OK(s, spar_member_solve_eigenvalues(b, 5, NULL, value[0], NULL, NULL));
        for (int i = 0; i < 5; i++) {
            double w = two_pi * f[i], decay = 0.5 * (alpha + stiff * w * w);
            NEAR(value[i][0], -decay, 1e-7 * w);
            NEAR(value[i][1], sqrt(w * w - decay * decay), 1e-7 * w);
        }
        spar_session_destroy(&s);
    }
}

/* A modal member of one mode of each bending under a load at its tip that comes on at once: u = u_s (1 - e^(-d t) (cos
   w t + d / w sin w t)), d = alpha / 2, w the damped frequency. rho_inf 1 and 400 steps in a period: the integrator is
   off by (w dt)^2 / 12 a radian, 2e-5 w t; 1e-3 of u_s in five periods. */
static void test_one_mode(void **state) {
    (void)state;
    const double dead[6] = {0, 0, 1e-3, 0, 0, 0};
    double f[2], tip[7], settled = 0;
    spar_session *s = scene_session();
    spar_member *b = beam(s, 2, 2, alpha, NULL);
    OK(s, spar_session_set_integrator(s, 1, 1));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_solve_modes(b, 2, f, NULL));
    double w0 = two_pi * f[0], d = alpha / 2, w = sqrt(w0 * w0 - d * d), dt = two_pi / w0 / 400;
    OK(s, spar_member_set_load(b, P - 1, SPAR_LOAD_DEAD, dead));
    OK(s, spar_member_solve_static(b, 1));
    scene_tip(b, tip);
    settled = tip[2];
    OK(s, spar_member_set_load(b, P - 1, SPAR_LOAD_DEAD, (double[6]){0}));
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_member_set_load(b, P - 1, SPAR_LOAD_DEAD, dead));
    for (int i = 1; i <= 2000; i++) {
        double t = i * dt;
        scene_run(s, dt, 1);
        scene_tip(b, tip);
        NEAR(tip[2], settled * (1 - exp(-d * t) * (cos(w * t) + d / w * sin(w * t))), 1e-3 * settled);
    }
    spar_session_destroy(&s);
}

/* The same motion of all fidelities under a load so small that nothing bends far: the exact member's tip and that of
   the others after 200 steps of a decaying swing, to 1e-6 of its way, and the root's reaction, which
   has the damping's forces in it, to 1e-5 of the load. Without the damping it is elsewhere. */
static void test_fidelities(void **state) {
    (void)state;
    const double dead[6] = {0, 1e-5, 2e-5, 1e-6, 0, 0};
    double tip[KINDS + 1][7], root[KINDS + 1][6], way = 0;
    for (int k = 0; k <= KINDS; k++) {
        spar_session *s = scene_session();
        spar_member *b = beam(s, k % KINDS, 6 * (P - 1), k < KINDS ? alpha : 0, NULL);
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, P - 1, SPAR_LOAD_DEAD, dead));
        scene_run(s, 0.02, 200);
        scene_tip(b, tip[k]);
        OK(s, spar_member_get_reaction(b, root[k]));
        spar_session_destroy(&s);
    }
    way = fabs(tip[0][2]);
    for (int k = 1; k < KINDS; k++) {
        for (int i = 0; i < 7; i++) {
            NEAR(tip[k][i], tip[0][i], 1e-6 * way);
        }
        for (int i = 0; i < 6; i++) {
            NEAR(root[k][i], root[0][i], 1e-5 * dead[2]);
        }
    }
    assert_true(fabs(tip[KINDS][2] - tip[0][2]) > 0.01 * way);
}

/* Energy that comes and goes: what the load has done is kinetic, strain and dissipated energy, in a large swing to the
   order of the integrator: the defect falls by up to four with half the step (2.5 is asked for: the load comes on at
   once, and what of it is fast is not resolved); and much is dissipated. */
static void test_energy_account(void **state) {
    (void)state;
    const double dead[6] = {0, 0, 60, 0, 0, 0};
    double defect[2];
    for (int k = 0; k < 2; k++) {
        double energy[4], work[4], dt = k ? 5e-4 : 1e-3;
        spar_session *s = scene_session();
        spar_member *b = beam(s, 0, 0, alpha, NULL);
        OK(s, spar_session_set_integrator(s, 1, 1));
        OK(s, spar_member_set_effects(b, SPAR_EFFECT_WORK, 0));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, P - 1, SPAR_LOAD_DEAD, dead));
        scene_run(s, dt, (int64_t)lround(2 / dt));
        OK(s, spar_member_get_energy(b, 4, energy));
        OK(s, spar_member_get_work(b, 4, work));
        assert_true(energy[SPAR_ENERGY_DISSIPATED] > 0.05 * work[SPAR_WORK_LOADS]);
        defect[k] = fabs(energy[0] + energy[1] + energy[3] - work[SPAR_WORK_LOADS]) / work[SPAR_WORK_LOADS];
        spar_session_destroy(&s);
    }
    print_message("defects %g %g\n", defect[0], defect[1]);
    assert_true(defect[0] < 1e-4 && defect[1] < defect[0] / 2.5);
}

/* ---- roots that turn ---- */

/* A blade that turns steadily is not braked: started in its balance the root has no torque about the axis (9 N m would
   be drag's, alpha w m L^3 / 3), nothing is dissipated and the shape stays, to 1e-6. */
static void test_steady_turn(void **state) {
    (void)state;
    const double w[3] = {0, 0, 3};
    for (int k = 0; k < 3; k++) {
        double first[7], tip[7], load[6], energy[4], q[7] = {0}, v[6] = {0, 0, 0, 0, 0, 3};
        spar_session *s = scene_session();
        spar_member *b = beam(s, k, 20, alpha, NULL);
        OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
        OK(s, spar_member_set_initial_velocity(b, NULL, NULL, w));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_solve_static(b, 1));
        scene_tip(b, first);
        for (int i = 1; i <= 20; i++) {
            q[3] = cos(1.5 * 0.01 * i), q[6] = sin(1.5 * 0.01 * i);
            OK(s, spar_member_drive(b, q, v, NULL));
            scene_run(s, 0.01, 1);
        }
        scene_tip(b, tip);
        double way = 2 + first[0], x = 2 + tip[0], y = tip[1];
        NEAR(hypot(x, y), way, 1e-6);
        OK(s, spar_member_get_reaction(b, load));
        NEAR(load[5], 0, 2e-4);
        OK(s, spar_member_get_energy(b, 4, energy));
        NEAR(energy[SPAR_ENERGY_DISSIPATED], 0, 1e-7);
        spar_session_destroy(&s);
    }
}

/* The trace of M^-1 C of a blade that turns is that of alpha alone, gyroscopic terms have none: the decay rates of all
   modes of a member of few unknowns add up to alpha / 2 each; exact and linear. */
static void test_turning_decay(void **state) {
    (void)state;
    enum { FEW = 3, MODES = 6 * (FEW - 1) };
    const double w[3] = {0.3, 1, 3};
    for (int k = 0; k < 2; k++) {
        double K[36], M[36], value[MODES][2], sum = 0;
        spar_session *s = scene_session();
        scene_diagonal(K, 1e3, 1e3, 1e3, 300, 200, 350);
        scene_diagonal(M, 3, 3, 3, 0.2, 0.1, 0.12);
        spar_member *b = scene_beam(s, "beam", 1, FEW, L, K, M);
        OK(s, spar_beam_set_mass_damping(b, alpha));
        OK(s, spar_member_set_fidelity(b, kinds[k], 0));
        OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
        OK(s, spar_member_set_initial_velocity(b, NULL, NULL, w));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_solve_static(b, 1));
        OK(s, spar_member_solve_eigenvalues(b, MODES, NULL, value[0], NULL, NULL));
        for (int i = 0; i < MODES; i++) {
            assert_true(value[i][0] < 0 && value[i][1] > 0);
            sum += value[i][0];
        }
        NEAR(sum, -0.5 * alpha * MODES, 1e-5 * alpha * MODES);
        spar_session_destroy(&s);
    }
}

/* ---- switches, files, input ---- */

/* Off gives the bits of never described; the report has it at rest. A rigid beam does not know of it. */
static void test_off(void **state) {
    (void)state;
    const double dead[6] = {0, 0, 20, 0, 0, 0};
    double tip[4][7], table[SPAR_ROW_COUNT][COLUMN_COUNT];
    for (int k = 0; k < 4; k++) {
        int effects;
        spar_session *s = scene_session();
        spar_member *b = beam(s, 0, 0, k == 0 ? 0 : alpha, NULL);
        if (k == 1) {
            OK(s, spar_member_set_effects(b, EFFECTS_ONLY(SPAR_EFFECT_INERTIA | SPAR_EFFECT_GYROSCOPIC)));
        }
        OK(s, spar_member_set_fidelity(b, k == 3 ? SPAR_FIDELITY_RIGID : SPAR_FIDELITY_EXACT, 0));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_get_effects(b, &effects));
        assert_int_equal((effects & SPAR_EFFECT_DAMPING) != 0, k == 2);
        OK(s, spar_member_set_load(b, P - 1, SPAR_LOAD_DEAD, dead));
        if (k == 2) {
            OK(s, trial_report_effects(s, 0.02, 16, NULL, NULL, NULL, table[0]));
            assert_true(table[SPAR_ROW_DAMPING][COLUMN_SIZE] > 1e-3);
            assert_true(table[SPAR_ROW_DAMPING][COLUMN_MOTION] > 1e-3);
        }
        scene_run(s, 0.02, 20);
        scene_tip(b, tip[k]);
        spar_session_destroy(&s);
    }
    assert_memory_equal(tip[0], tip[1], sizeof tip[0]);
    assert_true(fabs(tip[2][2] - tip[0][2]) > 1e-3 * fabs(tip[0][2]));
    assert_true(tip[3][2] == 0);
}

/* Saved half way, loaded, and on: the same bits; a session with another alpha is told. */
static void test_saved(void **state) {
    (void)state;
    const char *const path = "test_mass_damping.save";
    const double dead[6] = {0, 0, 20, 0, 0, 0};
    double tip[2][7], energy[2][4];
    for (int k = 0; k < 3; k++) {
        spar_session *s = scene_session();
        spar_member *b = beam(s, 0, 0, k == 2 ? 2 * alpha : alpha, NULL);
        OK(s, spar_member_commit(b));
        if (k == 0) {
            OK(s, spar_member_set_load(b, P - 1, SPAR_LOAD_DEAD, dead));
            scene_run(s, 0.02, 10);
            OK(s, spar_session_save(s, path));
        } else if (k == 1) {
            OK(s, spar_session_load(s, path));
        } else {
            assert_int_equal(spar_session_load(s, path), SPAR_ERR_ARGUMENT);
        }
        if (k < 2) {
            scene_run(s, 0.02, 10);
            scene_tip(b, tip[k]);
            OK(s, spar_member_get_energy(b, 4, energy[k]));
        }
        spar_session_destroy(&s);
    }
    (void)remove(path);
    assert_memory_equal(tip[0], tip[1], sizeof tip[0]);
    assert_memory_equal(energy[0], energy[1], sizeof energy[0]);
}

/* Nothing given at the root: a beam that flies keeps its way and loses momentum as exp(-alpha t), and its kinetic
   energy, as exp(-2 alpha t), to damping; under a weight g it settles at g / alpha. The trapezium's error of an
   exponential is (alpha dt)^2 alpha t / 12: 1e-5. All kinds. */
static void test_flies(void **state) {
    (void)state;
    const double v0[3] = {0.3, -0.2, 0.5}, none[3] = {0}, g = 2, dt = 0.01, t = 1.5, left = exp(-alpha * t);
    for (int k = 0; k < 2 * KINDS; k++) {
        int kind = k / 2, heavy = k % 2;
        double v[P][6], e[SPAR_ENERGY_COUNT], begin = 0.5 * 3 * L * 0.38;
        spar_session *s = scene_session();
        spar_member *b = beam(s, kind, 10, alpha, NULL);
        OK(s, spar_session_set_integrator(s, 1, 1));
        OK(s, spar_session_set_gravity(s, (double[3]){0, 0, heavy ? -g : 0}));
        OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
        OK(s,
           spar_member_set_effects(b, EFFECTS_ONLY(SPAR_EFFECT_INERTIA | SPAR_EFFECT_DAMPING | SPAR_EFFECT_GRAVITY)));
        OK(s, spar_member_set_initial_velocity(b, none, v0, none));
        OK(s, spar_member_commit(b));
        scene_run(s, dt, 150);
        OK(s, spar_member_get_motion(b, NULL, v[0], NULL));
        for (int i = 0; i < P; i++) {
            NEAR(v[i][0], v0[0] * left, 2e-5);
            NEAR(v[i][1], v0[1] * left, 2e-5);
            NEAR(v[i][2], v0[2] * left - (heavy ? g / alpha * (1 - left) : 0), 2e-5);
        }
        OK(s, spar_member_get_energy(b, SPAR_ENERGY_COUNT, e));
        if (!heavy) {
            NEAR(e[SPAR_ENERGY_KINETIC] / begin, left * left, 2e-5);
            NEAR(e[SPAR_ENERGY_DISSIPATED] / begin, 1 - left * left, 5e-5);
        }
        spar_session_destroy(&s);
    }
}

/* It spins about its middle, or about the end that a pin or a ball joint holds: angular momentum goes as exp(-alpha t).
   It is stiff: what its stretch takes of w is (w L)^2 m / EA = 1e-4 of it at the most. */
static void test_spins(void **state) {
    (void)state;
    const double none[3] = {0}, middle[3] = {L / 2, 0, 0}, spin[3] = {0, 0, 1}, dt = 0.01;
    for (int k = 0; k < 3; k++) {
        double v[P][6];
        spar_session *s = scene_session();
        spar_member *b = beam(s, 0, 0, alpha, NULL);
        spar_joint *j = NULL;
        OK(s, spar_session_set_integrator(s, 1, 1));
        OK(s, spar_member_set_root(b, k == 1 ? SPAR_ROOT_PINNED : SPAR_ROOT_FREE));
        OK(s, spar_member_set_initial_velocity(b, k ? none : middle, none, spin));
        OK(s, spar_member_commit(b));
        if (k == 2) {
            OK(s, spar_joint_create(s, "ball", b, 0, NULL, 0, SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ, &j));
        }
        scene_run(s, dt, 150);
        OK(s, spar_member_get_motion(b, NULL, v[0], NULL));
        for (int i = 0; i < P; i++) {
            NEAR(v[i][5], exp(-alpha * 1.5), 5e-4);
        }
        spar_session_destroy(&s);
    }
}

static void test_bad_input(void **state) {
    (void)state;
    double got = -1;
    spar_session *s = scene_session();
    spar_member *b = beam(s, 0, 0, alpha, NULL), *point = NULL;
    OK(s, spar_beam_get_mass_damping(b, &got));
    assert_true(got == alpha);
    REFUSED(s, SPAR_ERR_ARGUMENT, "alpha is -1", spar_beam_set_mass_damping(b, -1));
    REFUSED(s, SPAR_ERR_ARGUMENT, "alpha", spar_beam_set_mass_damping(b, NAN));
    OK(s, spar_beam_get_mass_damping(b, &got));
    assert_true(got == alpha);
    OK(s, spar_beam_get_mass_damping(b, NULL));
    OK(s, spar_point_create(s, "point", NULL, NULL, &point));
    REFUSED(s, SPAR_ERR_ARGUMENT, "'point' is not a beam", spar_beam_set_mass_damping(point, 1));
    REFUSED(s, SPAR_ERR_ARGUMENT, "'point' is not a beam", spar_beam_get_mass_damping(point, &got));
    assert_int_equal(spar_beam_set_mass_damping(NULL, 1), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_get_mass_damping(NULL, &got), SPAR_ERR_ARGUMENT);
    static const int roots[2] = {SPAR_ROOT_FREE, SPAR_ROOT_PINNED};
    for (int k = 0; k < 2; k++) {
        OK(s, spar_member_set_root(b, roots[k]));
        OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_RIGID, 0));
        REFUSED(s, SPAR_ERR_UNSUPPORTED, "would slow its rigid motion", spar_member_commit(b));
    }
    OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_EXACT, 0));
    OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
    OK(s, spar_member_commit(b));
    REFUSED(s, SPAR_ERR_STATE, "committed", spar_beam_set_mass_damping(b, 1));
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_growth_rates), cmocka_unit_test(test_one_mode),
        cmocka_unit_test(test_fidelities),   cmocka_unit_test(test_energy_account),
        cmocka_unit_test(test_steady_turn),  cmocka_unit_test(test_turning_decay),
        cmocka_unit_test(test_off),          cmocka_unit_test(test_saved),
        cmocka_unit_test(test_bad_input),    cmocka_unit_test(test_flies),
        cmocka_unit_test(test_spins),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
