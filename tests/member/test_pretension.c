/* Pretension of beams: strings, columns, beams under tension, springs back to where nothing pulls, section axes and
   stations, linear members and turning roots, energies, what switches it, bad input. */
#include "scene.h"
#include "trials.h"

#include <stdio.h>

static const double pi = 3.14159265358979323846, EI = 200, EA = 1e8, GA = 1e7, m = 2, L = 10;

static spar_member *cable(spar_session *s, int elements, int nodes) {
    double K[36], M[36];
    scene_diagonal(K, EA, GA, GA, 100, EI, EI);
    scene_diagonal(M, m, m, m, 2e-7, 1e-7, 1e-7);
    return scene_beam(s, "cable", elements, nodes, L, K, M);
}

static void pull(spar_session *s, spar_member *b, double N) {
    const double eta = 0.5, force[6] = {N, 0, 0, 0, 0, 0};
    OK(s, spar_beam_set_pretension(b, 1, &eta, force));
}

/* (omega / k)^2 = (N + EI k^2 / (1 + EI k^2 / (GA - N))) / m of a beam on hinges, k = n pi / L: with the section force
   R (N, GA gamma) the balance of forces is m w'' = (N w' + (GA - N) gamma)', that of moments EI theta'' + (GA - N)
   gamma = 0, gamma = w' - theta. A string for EI -> 0. Rotary inertia is 1e-8 of it. */
static double squared(double n, double N) {
    double k = n * pi / L;
    return k * k * (N + EI * k * k / (1 + EI * k * k / (GA - N))) / m;
}

/* Both ends on hinges that hold the line. The tension is the joints', statically found. */
static void test_hinged(void **state) {
    (void)state;
    static const double tension[4] = {0, 5000, 40, -4};
    for (int i = 0; i < 4; i++) {
        double N = tension[i], f[6];
        spar_session *s = scene_session();
        spar_member *b = cable(s, 3, 8);
        spar_joint *j = NULL;
        int64_t n;
        OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
        pull(s, b, N);
        OK(s, spar_member_commit(b));
        OK(s, spar_member_get_count(b, &n));
        OK(s, spar_joint_create(s, "left", b, 0, NULL, 0, SPAR_FREE_RY | SPAR_FREE_RZ, &j));
        OK(s, spar_joint_create(s, "right", b, n - 1, NULL, 0, SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ, &j));
        OK(s, spar_member_solve_modes(b, 6, f, NULL));
        for (int k = 0; k < 6; k++) { /* across in pairs */
            NEAR(pow(2 * pi * f[k], 2) / squared(1 + k / 2, N), 1, 1e-6);
        }
        spar_session_destroy(&s);
    }
}

/* A column buckles at N = -P, P / (1 + P / GA) = EI (pi / L)^2 / (1 + ...): of the root of squared. A millionth below
   it the lowest frequency is positive, as much above it negative. */
static void test_buckling(void **state) {
    (void)state;
    double low = -1.1 * EI * pi * pi / L / L, high = 0;
    for (int i = 0; i < 100; i++) {
        double middle = 0.5 * (low + high);
        *(squared(1, middle) > 0 ? &high : &low) = middle;
    }
    NEAR(high / (-EI * pi * pi / L / L), 1, 1e-5);
    for (int over = 0; over < 2; over++) {
        double f[2];
        spar_session *s = scene_session();
        spar_member *b = cable(s, 2, 8);
        spar_joint *j = NULL;
        OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
        pull(s, b, high * (over ? 1.000001 : 0.999999));
        OK(s, spar_member_commit(b));
        OK(s, spar_joint_create(s, "left", b, 0, NULL, 0, SPAR_FREE_RY | SPAR_FREE_RZ, &j));
        OK(s, spar_joint_create(s, "right", b, 15, NULL, 0, SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ, &j));
        OK(s, spar_member_solve_modes(b, 2, f, NULL));
        assert_true(over ? f[0] < 0 && f[1] < 0 : f[0] > 0 && f[1] > 0);
        spar_session_destroy(&s);
    }
}

/* The same pushed across by P at its middle: w = P (L / 2 - tanh(l L / 2) / l) / (2 N), l^2 = N / EI; shear adds 1.5e-5
   of it. */
static void test_plucked(void **state) {
    (void)state;
    const double N = 300, P = 1e-3, l = sqrt(N / EI), w = P * (L / 2 - tanh(l * L / 2) / l) / (2 * N);
    spar_session *s = scene_session();
    spar_member *b = cable(s, 2, 9);
    spar_joint *j = NULL;
    double q[18][7];
    OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
    pull(s, b, N);
    OK(s, spar_member_commit(b));
    OK(s, spar_joint_create(s, "left", b, 0, NULL, 0, SPAR_FREE_RY | SPAR_FREE_RZ, &j));
    OK(s, spar_joint_create(s, "right", b, 17, NULL, 0, SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ, &j));
    OK(s, spar_member_set_load(b, 8, SPAR_LOAD_DEAD, (double[6]){0, 0, P, 0, 0, 0}));
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_member_get_motion(b, q[0], NULL, NULL));
    NEAR(q[8][2] / w, 1, 5e-5);
    spar_session_destroy(&s);
}

/* A cantilever under a tension N that a force at its tip balances, pushed across by P there: w' = 0 at the root and
   EI w''' - N w' = -P give w(L) = P (L - tanh(l L) / l) / N, M(0) = P tanh(l L) / l, l^2 = N / EI. All that is linear
   alike; the exact one by P^2 besides. Shear adds N / GA = 3e-5 of it. */
static void test_cantilever(void **state) {
    (void)state;
    const double N = 300, P = 1e-3, l = sqrt(N / EI), w = P * (L - tanh(l * L) / l) / N;
    for (int i = 0; i < 3; i++) {
        spar_session *s = scene_session();
        spar_member *b = cable(s, 2, 10);
        double q[7], force[6], reaction[6];
        const double root = 0, load[6] = {N, 0, P, 0, 0, 0};
        pull(s, b, N);
        if (i > 0) {
            OK(s, spar_member_set_fidelity(b, i == 1 ? SPAR_FIDELITY_LINEAR : SPAR_FIDELITY_MODAL, i == 1 ? 0 : 108));
        }
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, 19, SPAR_LOAD_DEAD, load));
        OK(s, spar_member_solve_static(b, 1));
        scene_tip(b, q);
        NEAR(q[2] / w, 1, 5e-5);
        NEAR(q[0], 0, 1e-9);
        OK(s, spar_beam_evaluate(b, 1, &root, NULL, force, NULL, NULL));
        NEAR(force[0] / N, 1, 1e-6);
        NEAR(force[4] / (-P * tanh(l * L) / l), 1, 1e-3); /* at an end of an element, where strains are least exact */
        OK(s, spar_member_get_reaction(b, reaction));
        NEAR(reaction[0], -N, 1e-6);
        NEAR(reaction[2], -P, 1e-9);
        NEAR(reaction[4] / (P * tanh(l * L) / l), 1, 5e-5);
        spar_session_destroy(&s);
    }
}

/* Nothing holds the end: strain -C^-1 pretension everywhere, section forces 0. A full matrix, a skew placement, a
   twisted line; small enough that strains are one field. Then a large one, a bending moment alone: a quarter of a
   circle of radius EI / M. */
static void test_lets_go(void **state) {
    (void)state;
    double K[36], M[36], strain[3][6], force[3][6], back[6], q[7];
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 2, 0, 0}, twist[2] = {0, 0.7}, at[3] = {0, 0.37, 1},
                 place[4] = {0.5, -0.5, 0.5, 0.5}, none[3] = {0}, small[6] = {30, -2, 1, 0.5, 0.2, -0.3};
    spar_session *s = scene_session();
    spar_member *b = NULL;
    scene_box(K, M);
    OK(s, spar_beam_create(s, "box", 3, 6, &b));
    OK(s, spar_beam_set_axis(b, 2, eta, xyz, twist));
    OK(s, spar_beam_set_sections(b, 1, eta, K, M));
    OK(s, spar_member_set_placement(b, none, place));
    OK(s, spar_beam_set_pretension(b, 1, eta, small));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_beam_evaluate(b, 3, at, strain[0], force[0], NULL, NULL));
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 6; k++) {
            back[k] = 0;
            for (int c = 0; c < 6; c++) {
                back[k] += K[6 * k + c] * strain[i][c];
            }
            NEAR(back[k], -small[k], 1e-6);
            NEAR(force[i][k], 0, 1e-6);
        }
    }
    spar_session_destroy(&s);
    s = scene_session();
    b = cable(s, 2, 8);
    const double bend[6] = {0, 0, 0, 0, 0, -EI * 0.5 * pi / L}, R = L / (0.5 * pi);
    OK(s, spar_beam_set_pretension(b, 1, eta, bend));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_solve_static(b, 1));
    scene_tip(b, q);
    NEAR(L + q[0], R, 1e-6);
    NEAR(q[1], R, 1e-6);
    spar_session_destroy(&s);
}

/* Stations: constant to a quarter, linear to three quarters, constant beyond; the ends of elements are there. */
static void test_stations(void **state) {
    (void)state;
    const double eta[2] = {0.25, 0.75}, force[2][6] = {{1e4, 0, 0, 2, 0, 0}, {3e4, 0, 0, -1, 0, 0}},
                 at[5] = {0.1, 0.3, 0.5, 0.7, 0.9}, N[5] = {1e4, 1.2e4, 2e4, 2.8e4, 3e4},
                 T[5] = {2, 1.7, 0.5, -0.7, -1};
    double strain[5][6], x[2], back[2][6], q[7];
    int64_t n;
    spar_session *s = scene_session();
    spar_member *b = cable(s, 4, 5);
    OK(s, spar_beam_set_pretension(b, 2, eta, force[0]));
    OK(s, spar_beam_get_pretension(b, &n, 2, x, back[0]));
    assert_int_equal(n, 2);
    assert_memory_equal(x, eta, sizeof x);
    assert_memory_equal(back, force, sizeof back);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_beam_evaluate(b, 5, at, strain[0], NULL, NULL, NULL));
    for (int i = 0; i < 5; i++) {
        NEAR(strain[i][0], -N[i] / EA, 1e-12);
        NEAR(strain[i][3], -T[i] / 100, 1e-7); /* turns are a field of quaternions */
    }
    scene_tip(b, q);
    NEAR(q[0], -2e4 * L / EA, 1e-10);
    spar_session_destroy(&s);
}

/* A blade that turns, tight by a force at its tip: what a linear member takes from its root's frame is the
   exact one's limit. Tension by the turn alone is m w^2 L^2 / 2 = 2500, as large. */
static void test_turning(void **state) {
    (void)state;
    const double N = 2000, w = 5, none[3] = {0}, omega[3] = {0, 0, w}, load[6] = {N, 0, 1e-3, 0, 0, 0};
    double tip[2][7], f[2][3];
    for (int linear = 0; linear < 2; linear++) {
        spar_session *s = scene_session();
        spar_member *b = cable(s, 2, 8);
        pull(s, b, N);
        OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
        OK(s, spar_member_set_fidelity(b, linear ? SPAR_FIDELITY_LINEAR : SPAR_FIDELITY_EXACT, 0));
        OK(s, spar_member_set_initial_velocity(b, none, none, omega));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, 15, SPAR_LOAD_DEAD, load));
        OK(s, spar_member_solve_static(b, 1));
        scene_tip(b, tip[linear]);
        OK(s, spar_member_solve_modes(b, 3, f[linear], NULL));
        spar_session_destroy(&s);
    }
    NEAR(tip[1][2] / tip[0][2], 1, 1e-4);
    NEAR(tip[1][0] / tip[0][0], 1, 1e-3);
    for (int k = 0; k < 3; k++) {
        NEAR(f[1][k] / f[0][k], 1, 1e-4);
    }
}

/* Energy: a beam under tension pushed across swings; kinetic and strain energy are the work of its loads, to dt^2
   (rho_inf 1). Linear ones too, whose constant forces are among them. */
static void test_energy(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        double worst[2] = {0, 0};
        for (int fine = 0; fine < 2; fine++) {
            spar_session *s = scene_session();
            spar_member *b = cable(s, 1, 8);
            double e[SPAR_ENERGY_COUNT], work[SPAR_WORK_COUNT];
            const double load[6] = {50, 0, 0.5, 0, 0, 0}; /* not balanced: 100 of pretension */
            OK(s, spar_session_set_integrator(s, 1, 1));
            pull(s, b, 100);
            OK(s, spar_member_set_fidelity(b, i ? SPAR_FIDELITY_LINEAR : SPAR_FIDELITY_EXACT, 0));
            OK(s, spar_member_set_effects(b, SPAR_EFFECT_WORK, 0));
            OK(s, spar_member_commit(b));
            OK(s, spar_member_set_load(b, 7, SPAR_LOAD_DEAD, load));
            for (int k = 0; k < (fine ? 80 : 40); k++) {
                scene_run(s, fine ? 1e-5 : 2e-5, 1);
                OK(s, spar_member_get_energy(b, SPAR_ENERGY_COUNT, e));
                OK(s, spar_member_get_work(b, SPAR_WORK_COUNT, work));
                worst[fine] = fmax(worst[fine], fabs(e[0] + e[1] - work[SPAR_WORK_LOADS]));
            }
            assert_true(work[SPAR_WORK_LOADS] < 0 && e[SPAR_ENERGY_STRAIN] < 0);
            assert_true(worst[fine] < 0.05 * fabs(work[SPAR_WORK_LOADS]));
            spar_session_destroy(&s);
        }
        assert_true(worst[1] < 0.35 * worst[0]);
    }
}

/* Off: the bits of a beam that never had any; and of a rigid one, which does not deform. */
static void test_off(void **state) {
    (void)state;
    for (int rigid = 0; rigid < 2; rigid++) {
        double tip[2][7];
        for (int off = 0; off < 2; off++) {
            spar_session *s = scene_session();
            spar_member *b = cable(s, 1, 6);
            int effects;
            OK(s, spar_session_set_gravity(s, (double[3]){0, 0, -9.81}));
            OK(s, spar_member_set_root(b, rigid ? SPAR_ROOT_PINNED : SPAR_ROOT_FIXED));
            OK(s, spar_member_set_fidelity(b, rigid ? SPAR_FIDELITY_RIGID : SPAR_FIDELITY_EXACT, 0));
            if (off) {
                pull(s, b, 1000);
                OK(s, spar_member_set_effects(b, 0, rigid ? 0 : SPAR_EFFECT_PRETENSION));
            }
            OK(s, spar_member_commit(b));
            OK(s, spar_member_get_effects(b, &effects));
            assert_int_equal(effects & SPAR_EFFECT_PRETENSION, 0);
            scene_run(s, 0.01, 20);
            scene_tip(b, tip[off]);
            spar_session_destroy(&s);
        }
        assert_memory_equal(tip[0], tip[1], sizeof tip[0]);
    }
}

/* Row of the report: the tension's forces lead at the ends, 1 of the largest, and without them the cable sags further;
   a trial leaves the state. A file goes on with the bits. */
static void test_trial_and_file(void **state) {
    (void)state;
    static const char *const file = "test_pretension.spar";
    double table[SPAR_ROW_COUNT][COLUMN_COUNT], tip[3][7];
    spar_session *s[2];
    spar_member *b[2];
    for (int i = 0; i < 2; i++) {
        s[i] = scene_session();
        b[i] = cable(s[i], 1, 6);
        OK(s[i], spar_session_set_gravity(s[i], (double[3]){0, 0, -9.81}));
        pull(s[i], b[i], 5000);
        OK(s[i], spar_member_commit(b[i]));
        OK(s[i], spar_member_set_load(b[i], 5, SPAR_LOAD_DEAD, (double[6]){5000, 0, 0, 0, 0, 0}));
    }
    scene_run(s[0], 0.01, 10);
    scene_tip(b[0], tip[0]);
    OK(s[0], trial_report_effects(s[0], 0.01, 16, NULL, NULL, NULL, table[0]));
    scene_tip(b[0], tip[1]);
    assert_memory_equal(tip[0], tip[1], sizeof tip[0]);
    assert_true(table[SPAR_ROW_PRETENSION][COLUMN_IN_FORCE] == 1);
    assert_true(table[SPAR_ROW_PRETENSION][COLUMN_SIZE] > 0.5);
    assert_true(table[SPAR_ROW_PRETENSION][COLUMN_MOTION] > 1e-3);
    assert_string_equal(spar_effect_name(SPAR_ROW_PRETENSION), "pretension");
    OK(s[0], spar_session_save(s[0], file));
    OK(s[1], spar_session_load(s[1], file));
    for (int i = 0; i < 2; i++) {
        scene_run(s[i], 0.01, 10);
        scene_tip(b[i], tip[i]);
        spar_session_destroy(&s[i]);
    }
    assert_memory_equal(tip[0], tip[1], sizeof tip[0]);
    remove(file);
}

static void test_refusals(void **state) {
    (void)state;
    spar_session *s = scene_session();
    spar_member *b = cable(s, 1, 4);
    const double eta[2] = {0.5, 0.5}, far[2] = {0.5, 1.5}, k[12] = {7, 1, 1, 1, 1, 1}, bad[6] = {1, NAN, 1, 0, 0, 0};
    OK(s, spar_beam_set_pretension(b, 1, eta, k));
    REFUSED(s, SPAR_ERR_ARGUMENT, "not above the previous one", spar_beam_set_pretension(b, 2, eta, k));
    REFUSED(s, SPAR_ERR_ARGUMENT, "eta 1 is 1.5", spar_beam_set_pretension(b, 2, far, k));
    REFUSED(s, SPAR_ERR_ARGUMENT, "-1 stations", spar_beam_set_pretension(b, -1, eta, k));
    REFUSED(s, SPAR_ERR_ARGUMENT, "entry 1 of force", spar_beam_set_pretension(b, 1, eta, bad));
    REFUSED(s, SPAR_ERR_ARGUMENT, "NULL", spar_beam_set_pretension(b, 1, NULL, k));
    assert_int_equal(spar_beam_set_pretension(NULL, 0, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_get_pretension(NULL, NULL, 0, NULL, NULL), SPAR_ERR_ARGUMENT);
    int64_t n;
    double got[6];
    OK(s, spar_beam_get_pretension(b, &n, 1, NULL, got));
    assert_true(n == 1 && got[0] == 7);
    OK(s, spar_member_commit(b));
    REFUSED(s, SPAR_ERR_STATE, "commit", spar_beam_set_pretension(b, 0, NULL, NULL));
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hinged),         cmocka_unit_test(test_plucked),  cmocka_unit_test(test_buckling),
        cmocka_unit_test(test_cantilever),     cmocka_unit_test(test_lets_go),  cmocka_unit_test(test_stations),
        cmocka_unit_test(test_turning),        cmocka_unit_test(test_energy),   cmocka_unit_test(test_off),
        cmocka_unit_test(test_trial_and_file), cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
