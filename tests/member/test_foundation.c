/* Springs to the ground along a beam: Winkler's beam at rest and swinging, section axes and stations, energies, linear
   and modal beams, what switches them, bad input. */
#include "scene.h"
#include "trials.h"

#include <stdio.h>

static const double pi = 3.14159265358979323846, EI = 2e4, m = 5, L = 10;

/* A slender beam along x that hardly shears or stretches; no inertia of turning to speak of. */
static spar_member *pile(spar_session *s, int elements, int nodes, int root) {
    double K[36], M[36];
    scene_diagonal(K, 1e9, 1e9, 1e9, 1e4, EI, EI);
    scene_diagonal(M, m, m, m, 2e-6, 1e-6, 1e-6);
    spar_member *b = scene_beam(s, "pile", elements, nodes, L, K, M);
    OK(s, spar_member_set_root(b, root));
    return b;
}

/* Exact, linear, modal with `modes`. */
enum { KINDS = 3 };
static void of_kind(spar_session *s, spar_member *b, int kind, int64_t modes) {
    static const int fidelity[KINDS] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL};
    OK(s, spar_member_set_fidelity(b, fidelity[kind], kind == 2 ? modes : 0));
}

static void bed(spar_session *s, spar_member *b, double x, double y, double z) {
    const double eta = 0.5, k[3] = {x, y, z};
    OK(s, spar_beam_set_foundation(b, 1, &eta, k));
}

/* Hetenyi's pile with a force P across its head, far from where it is held: y(0) = 2 P beta / k at the head, slope
   -2 P beta^2 / k, beta^4 = k / (4 EI); beta L = 10, exp(-20) is left of the other end. Shear adds EI beta^2 / GA =
   2e-5 of it; large deflections square of 2e-5. Head y turns about z. All kinds of beams alike, a modal one with all
   its modes; what the root gives is what is left of the force. */
static void test_hetenyi(void **state) {
    (void)state;
    const double k = 4 * EI, P = 0.5; /* beta = 1 */
    for (int kind = 0; kind < KINDS; kind++) {
        spar_session *s = scene_session();
        spar_member *b = pile(s, 6, 8, SPAR_ROOT_FIXED);
        double q[7];
        int64_t n;
        bed(s, b, 0, k, 0);
        of_kind(s, b, kind, 252);
        OK(s, spar_member_commit(b));
        OK(s, spar_member_get_count(b, &n));
        OK(s, spar_member_set_load(b, n - 1, SPAR_LOAD_DEAD, (double[6]){0, P, 0, 0, 0, 0}));
        OK(s, spar_member_solve_static(b, 1));
        scene_tip(b, q);
        NEAR(q[1] / (2 * P / k), 1, 4e-5);
        NEAR(2 * q[6] / (2 * P / k), 1, 1e-4);
        double reaction[6];
        OK(s, spar_member_get_reaction(b, reaction)); /* exp(-beta L) of it comes to the root */
        NEAR(reaction[1], 0, 4 * exp(-L) * P);
        spar_session_destroy(&s);
    }
}

static void shifted_as_they_should_be(double f[2][6], double k) {
    static const double root[3] = {1.8751040687119611, 4.6940911329741746, 7.8547574382376126};
    for (int i = 0; i < 3; i++) { /* modes come in pairs without springs */
        double w2 = EI * pow(root[i] / L, 4) / m, hard = sqrt(w2 + k / m) / (2 * pi), soft = sqrt(w2) / (2 * pi);
        double shifted = sqrt(pow(2 * pi * f[0][2 * i], 2) + k / m) / (2 * pi), nearest[2] = {1e9, 1e9}, got = 0;
        for (int j = 0; j < 6; j++) {
            nearest[0] = fmin(nearest[0], fabs(f[1][j] / soft - 1));
            if (fabs(f[1][j] / hard - 1) < nearest[1]) {
                nearest[1] = fabs(f[1][j] / hard - 1);
                got = f[1][j];
            }
        }
        NEAR(nearest[0], 0, 2e-4);
        NEAR(nearest[1], 0, 2e-4);
        NEAR(got / shifted, 1, 1e-7);
    }
}

/* omega^2 = (EI (x / L)^4 + k) / m, x the roots of cos x cosh x = -1 of a cantilever: all modes across are as much
   stiffer. Exact shift against the same beam without springs: 1e-7 (inertia of turning has none of it); against Euler
   and Bernoulli's roots 1e-4 (shear). Springs along z alone leave those along y as they are. */
static void test_frequencies(void **state) {
    (void)state;
    const double k = 300;
    for (int kind = 0; kind < KINDS; kind++) {
        double f[2][6];
        for (int on = 0; on < 2; on++) {
            spar_session *s = scene_session();
            spar_member *b = pile(s, 3, 8, SPAR_ROOT_FIXED);
            bed(s, b, 0, 0, on ? k : 0);
            of_kind(s, b, kind, 12);
            OK(s, spar_member_commit(b));
            OK(s, spar_member_solve_modes(b, 6, f[on], NULL));
            spar_session_destroy(&s);
        }
        shifted_as_they_should_be(f, k);
    }
}

/* A free beam let go with a velocity along its section's y on springs there, skew in space: u = v sin(w t) / w along
   that axis, w^2 = k / m, of second order in dt; energies as they should be at every step (rho_inf 1), the springs'
   force as the member's loads. Springs along the other axes are not felt. */
static void test_swing(void **state) {
    (void)state;
    const double k = 45, w = sqrt(k / m), v0 = 0.3, q[4] = {0.5, 0.5, 0.5, 0.5}, none[3] = {0};
    double error[2];
    for (int run = 0; run < 2 * KINDS; run++) {
        int fine = run % 2;
        spar_session *s = scene_session();
        spar_member *b = pile(s, 1, 5, SPAR_ROOT_FREE);
        double dt = fine ? 0.02 : 0.04, e[SPAR_ENERGY_COUNT], load[5][6], tip[7], sum = 0, work[SPAR_WORK_COUNT];
        OK(s, spar_session_set_integrator(s, 1, 1));
        OK(s, spar_member_set_placement(b, none, q)); /* x, y, z go to y, z, x */
        OK(s, spar_member_set_effects(b, SPAR_EFFECT_WORK, 0));
        of_kind(s, b, run / 2, 8);
        OK(s, spar_member_set_initial_velocity(b, none, (double[3]){0, 0, v0}, none));
        bed(s, b, 7, k, 11);
        OK(s, spar_member_commit(b));
        for (int i = 0; i < (fine ? 50 : 25); i++) {
            scene_run(s, dt, 1);
            OK(s, spar_member_get_energy(b, SPAR_ENERGY_COUNT, e));
            NEAR(e[SPAR_ENERGY_KINETIC] + e[SPAR_ENERGY_FOUNDATION], 0.5 * m * L * v0 * v0, 2e-3 * m * L * v0 * v0);
        }
        scene_tip(b, tip);
        NEAR(e[SPAR_ENERGY_FOUNDATION], 0.5 * k * L * tip[2] * tip[2], run < 2 ? 1e-12 : 1e-8); /* EA is 1e9 */
        OK(s, spar_member_get_loads(b, load[0]));
        for (int i = 0; i < 5; i++) {
            sum += load[i][2];
        }
        NEAR(sum, -k * L * tip[2], run < 2 ? 1e-10 : 1e-6);
        NEAR(tip[0], 0, 1e-12);
        NEAR(tip[1], 0, 1e-12);
        OK(s, spar_member_get_work(b, SPAR_WORK_COUNT, work));
        assert_true(work[SPAR_WORK_LOADS] == 0);
        error[fine] = fabs(tip[2] - v0 * sin(w) / w);
        spar_session_destroy(&s);
        NEAR(fine ? log2(error[0] / error[1]) : 2, 2, 0.05);
    }
}

/* A force comes upon a beam at rest, which swings free on its bed: all energies less all work stay 0, as
   spar_member_get_work says, to (w dt)^2 / 4 of the work: 1e-3 with w = sqrt(60 / 5) of the stiffest springs and the
   modes that the force meets. A third of the work at least is in the springs at some time. */
static void test_balance(void **state) {
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        spar_session *s = scene_session();
        spar_member *b = pile(s, 1, 5, SPAR_ROOT_FREE);
        double most = 0;
        OK(s, spar_session_set_integrator(s, 1, 1));
        OK(s, spar_member_set_effects(b, SPAR_EFFECT_WORK, 0));
        of_kind(s, b, kind, 24);
        bed(s, b, 40, 50, 60);
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, 2, SPAR_LOAD_DEAD, (double[6]){0, 2, 3, 0, 0, 0}));
        OK(s, spar_session_solve_initial(s, 0.005, NULL, NULL, NULL));
        for (int i = 0; i < 200; i++) {
            double e[SPAR_ENERGY_COUNT], work[SPAR_WORK_COUNT], sum = 0;
            scene_run(s, 0.005, 1);
            OK(s, spar_member_get_energy(b, SPAR_ENERGY_COUNT, e));
            OK(s, spar_member_get_work(b, SPAR_WORK_COUNT, work));
            for (int k = 0; k < SPAR_ENERGY_COUNT; k++) {
                sum += e[k];
            }
            assert_true(work[SPAR_WORK_FLUID] == 0 && work[SPAR_WORK_ROOT] == 0 && work[SPAR_WORK_JOINTS] == 0);
            NEAR(sum / work[SPAR_WORK_LOADS], 1, 1e-3);
            most = fmax(most, e[SPAR_ENERGY_FOUNDATION] / work[SPAR_WORK_LOADS]);
        }
        assert_true(most > 1.0 / 3);
        spar_session_destroy(&s);
    }
}

/* Stations: from 0 at the root to k at the middle, a jump to 2 k there, nothing behind 3/4: a free stiff beam that is
   pushed sideways by its own weight sinks and turns as a plank does: sums of force and moment over [0, 1/2] and
   [1/2, 3/4] by hand. The jumps lie within elements. Bending, k L^4 / EI = 0.005: 1e-4 of it. */
static void test_stations(void **state) {
    (void)state;
    const double eta[4] = {0, 0.5, 0.5, 0.75}, k = 0.01, g = 1e-6;
    const double along[4][3] = {{1, 0, 0}, {1, k, 0}, {1, 2 * k, 0}, {1, 2 * k, 0}};
    double stiffness[12], q[7], x[4], kk[4][3];
    int64_t n;
    spar_session *s = scene_session();
    spar_member *b = pile(s, 2, 6, SPAR_ROOT_FREE);
    memcpy(stiffness, along, sizeof stiffness);
    for (int i = 0; i < 4; i++) {
        stiffness[3 * i + 2] = 1; /* holds it along z */
    }
    OK(s, spar_session_set_gravity(s, (double[3]){0, -g, 0}));
    OK(s, spar_beam_set_foundation(b, 4, eta, stiffness));
    OK(s, spar_beam_get_foundation(b, &n, 4, x, kk[0]));
    assert_int_equal(n, 4);
    assert_memory_equal(x, eta, sizeof x);
    assert_memory_equal(kk, stiffness, sizeof kk);
    OK(s, spar_member_commit(b));
    spar_joint *j = NULL; /* springs across the line do not hold it about that */
    OK(s, spar_joint_create(s, "root", b, 0, NULL, 0, 63 & ~SPAR_FREE_RX, &j));
    double S0 = k * L / 4 + 2 * k * L / 4, S1 = k * L * L / 12 + 2 * k * (9.0 / 16 - 4.0 / 16) * L * L / 2,
           S2 = k * L * L * L / 32 + 2 * k * (27.0 / 64 - 8.0 / 64) * L * L * L / 3, W = -m * L * g, W1 = W * L / 2;
    double D = S0 * S2 - S1 * S1, a = (W * S2 - W1 * S1) / D, c = (S0 * W1 - S1 * W) / D;
    OK(s, spar_member_solve_static(b, 1));
    scene_tip(b, q);
    NEAR(q[1] / (a + c * L), 1, 1e-4);
    spar_session_destroy(&s);
}

/* Off: the bits of a beam that never had springs. */
static void test_off(void **state) {
    (void)state;
    double tip[2][7];
    for (int off = 0; off < 2; off++) {
        spar_session *s = scene_session();
        spar_member *b = pile(s, 1, 6, SPAR_ROOT_FIXED);
        double e[SPAR_ENERGY_COUNT];
        OK(s, spar_session_set_gravity(s, (double[3]){0, 0, -9.81}));
        if (off) {
            bed(s, b, 1, 100, 100);
            OK(s, spar_member_set_effects(
                      b, EFFECTS_ONLY(SPAR_EFFECT_INERTIA | SPAR_EFFECT_GYROSCOPIC | SPAR_EFFECT_GRAVITY)));
        }
        OK(s, spar_member_commit(b));
        scene_run(s, 0.01, 20);
        scene_tip(b, tip[off]);
        OK(s, spar_member_get_energy(b, SPAR_ENERGY_COUNT, e));
        assert_true(e[SPAR_ENERGY_FOUNDATION] == 0);
        spar_session_destroy(&s);
    }
    assert_memory_equal(tip[0], tip[1], sizeof tip[0]);
}

/* Row of the report, from a run under weight: its force against the largest of all terms, which weight is (to 1, in a
   run of a twentieth of a period of the beam on its springs); a trial leaves the state. A file goes on with the bits.
 */
static void test_trial_and_file(void **state) {
    (void)state;
    static const char *const file = "test_foundation.spar";
    double table[SPAR_ROW_COUNT][COLUMN_COUNT], tip[3][7];
    spar_session *s[2];
    spar_member *b[2];
    for (int i = 0; i < 2; i++) {
        s[i] = scene_session();
        b[i] = pile(s[i], 1, 6, SPAR_ROOT_FIXED);
        OK(s[i], spar_session_set_gravity(s[i], (double[3]){0, 0, -9.81}));
        bed(s[i], b[i], 0, 0, 2000);
        OK(s[i], spar_member_commit(b[i]));
    }
    scene_run(s[0], 0.01, 10);
    scene_tip(b[0], tip[0]);
    OK(s[0], trial_report_effects(s[0], 0.01, 16, NULL, NULL, NULL, table[0]));
    scene_tip(b[0], tip[1]);
    assert_memory_equal(tip[0], tip[1], sizeof tip[0]);
    assert_true(table[SPAR_ROW_FOUNDATION][COLUMN_IN_FORCE] == 1);
    assert_true(table[SPAR_ROW_FOUNDATION][COLUMN_SIZE] > 0.1);
    assert_true(table[SPAR_ROW_FOUNDATION][COLUMN_MOTION] > 0.1);
    assert_string_equal(spar_effect_name(SPAR_ROW_FOUNDATION), "foundation");
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
    spar_member *b = pile(s, 1, 4, SPAR_ROOT_FIXED);
    const double eta[2] = {0.5, 0.4}, k[6] = {1, 1, 1, 1, 1, -1}, bad[3] = {1, NAN, 1}, ok[3] = {0, 2, 0};
    OK(s, spar_beam_set_foundation(b, 1, eta, ok));
    REFUSED(s, SPAR_ERR_ARGUMENT, "below the previous one", spar_beam_set_foundation(b, 2, eta, k));
    REFUSED(s, SPAR_ERR_ARGUMENT, "-1 stations", spar_beam_set_foundation(b, -1, eta, k));
    REFUSED(s, SPAR_ERR_ARGUMENT, "station 0 is below 0", spar_beam_set_foundation(b, 1, eta, k + 3));
    REFUSED(s, SPAR_ERR_ARGUMENT, "not", spar_beam_set_foundation(b, 1, eta, bad));
    REFUSED(s, SPAR_ERR_ARGUMENT, "NULL", spar_beam_set_foundation(b, 1, NULL, k));
    assert_int_equal(spar_beam_set_foundation(NULL, 0, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_get_foundation(NULL, NULL, 0, NULL, NULL), SPAR_ERR_ARGUMENT);
    OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_LINEAR, 0));
    OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
    REFUSED(s, SPAR_ERR_UNSUPPORTED, "frame of a driven root", spar_member_commit(b));
    OK(s, spar_member_set_root(b, SPAR_ROOT_FIXED));
    OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_RIGID, 0));
    REFUSED(s, SPAR_ERR_UNSUPPORTED, "has a foundation", spar_member_commit(b));
    OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_EXACT, 0));
    int64_t n;
    double got[3];
    OK(s, spar_beam_get_foundation(b, &n, 1, NULL, got));
    assert_true(n == 1 && got[1] == 2);
    OK(s, spar_member_commit(b));
    REFUSED(s, SPAR_ERR_STATE, "commit", spar_beam_set_foundation(b, 0, NULL, NULL));
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hetenyi),        cmocka_unit_test(test_frequencies), cmocka_unit_test(test_swing),
        cmocka_unit_test(test_balance),        cmocka_unit_test(test_stations),    cmocka_unit_test(test_off),
        cmocka_unit_test(test_trial_and_file), cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
