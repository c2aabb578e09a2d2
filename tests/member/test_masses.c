/* Bodies that sit on a beam: frequencies, weight, pull of a turn and energy in closed form, the same body welded on by
   a joint, what switches them, save and load, bad input. */
#include "scene.h"
#include "trials.h"

#include <stdio.h>

static const double two_pi = 6.283185307179586, L = 2, EI = 5, m = 3;

/* Slender: shear and stretch 1e8 EI / L^2, rotary inertia 1e-8 m L^2. */
static spar_member *slender(spar_session *s, int elements, int nodes, double density) {
    double K[36], M[36], stiff = 1e8 * EI / L / L, j = 1e-8 * density * L * L;
    scene_diagonal(K, stiff, stiff, stiff, 1e6 * EI, EI, EI);
    scene_diagonal(M, density, density, density, 2 * j, j, j);
    return scene_beam(s, "beam", elements, nodes, L, K, M);
}

/* ---- frequencies ---- */

/* Cantilever with a body of mass r m L and rotary inertia j m L^3 at its tip, omega = lambda^2 sqrt(EI / m) / L^2
   (Laura, Pombo, Susemihl, J. Sound Vib. 37 (1974) 161; the inertia as of Bhat, Wagner, ibid. 45 (1976) 304). */
static double tip_equation(double x, double r, double j) {
    double c = cos(x), s = sin(x), C = cosh(x), S = sinh(x);
    return 1 + c * C + r * x * (c * S - s * C) - j * x * x * x * (C * s + S * c) + r * j * x * x * x * x * (1 - c * C);
}

/* The roots of it in order, by steps that are shorter than they are apart, and bisection to rounding. */
static void tip_roots(double r, double j, int n, double *root) {
    double a = 1e-3;
    for (int k = 0; k < n; a += 1e-3) {
        double lo = a, hi = a + 1e-3, low = tip_equation(lo, r, j);
        if (low * tip_equation(hi, r, j) > 0) {
            continue;
        }
        for (int i = 0; i < 60; i++) {
            double mid = 0.5 * (lo + hi), now = tip_equation(mid, r, j);
            *(now * low > 0 ? &lo : &hi) = mid;
        }
        root[k++] = lo;
    }
}

/* Three pairs of bending modes with light and heavy bodies, exact, linear and modal; shear and stretch soften by some
   1e-7 and the nodes' polynomials leave 1e-7 of the third: 1e-5 is asked for. The eigenvalues of the same are i omega.
 */
static void test_tip_body(void **state) {
    (void)state;
    static const double ratio[3][2] = {{1, 0}, {0.3, 0.05}, {5, 0.5}};
    static const int fidelity[3] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL};
    const double tip[1] = {1}, none[3] = {0};
    for (int k = 0; k < 9; k++) {
        double r = ratio[k / 3][0], j = ratio[k / 3][1], root[3], f[6], value[2], mass[36];
        const double inertia = j * m * L * L * L, J[3] = {1.5 * inertia, inertia, inertia};
        spar_session *s = scene_session();
        spar_member *b = slender(s, 1, 14, m);
        scene_mass(mass, r * m * L, none, J);
        OK(s, spar_beam_set_masses(b, 1, tip, mass));
        OK(s, spar_member_set_fidelity(b, fidelity[k % 3], 12));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_solve_modes(b, 6, f, NULL));
        tip_roots(r, j, 3, root);
        for (int i = 0; i < 6; i++) {
            double omega = root[i / 2] * root[i / 2] * sqrt(EI / m) / (L * L);
            NEAR(two_pi * f[i] / omega, 1, 1e-5);
        }
        OK(s, spar_member_solve_eigenvalues(b, 1, NULL, value, NULL, NULL));
        NEAR(value[1], two_pi * f[0], 1e-5 * value[1]);
        spar_session_destroy(&s);
    }
}

/* ---- the same body on a joint ---- */

static void full_mass(double mass[36]) {
    const double c[3] = {0.2, 0.1, -0.15}, J[3] = {0.3, 0.2, 0.25};
    scene_mass(mass, 4, c, J);
}

/* A body with its centre of mass beside the line, on the tip of a beam that bends far under its weight: place, reaction
   and modes about that state are those of a rigid body of its own that a joint welds to the tip. Two ways to the same
   equations: 1e-8. */
static void test_welded(void **state) {
    (void)state;
    const double g[3] = {0, 0, -0.4}, tip[1] = {1}, at[3] = {L, 0, 0};
    double mass[36], q[2][7], f[2][8], load[2][6];
    full_mass(mass);
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_member *b = slender(s, 2, 6, m), *body = NULL;
        spar_joint *weld = NULL;
        OK(s, spar_session_set_gravity(s, g));
        if (k == 0) {
            OK(s, spar_beam_set_masses(b, 1, tip, mass));
        }
        OK(s, spar_member_commit(b));
        if (k == 1) {
            OK(s, spar_rigid_create(s, "body", at, NULL, mass, &body));
            OK(s, spar_member_commit(body));
            OK(s, spar_joint_create(s, "weld", b, 11, body, 0, 0, &weld));
        }
        OK(s, spar_member_solve_static(b, 4));
        OK(s, spar_member_solve_modes(b, 8, f[k], NULL));
        OK(s, spar_member_get_reaction(b, load[k]));
        scene_tip(b, q[k]);
        spar_session_destroy(&s);
    }
    assert_true(q[0][2] < -0.3);
    for (int i = 0; i < 7; i++) {
        NEAR(q[0][i], q[1][i], 1e-8);
    }
    for (int i = 0; i < 6; i++) {
        NEAR(load[0][i], load[1][i], 1e-7);
    }
    for (int i = 0; i < 8; i++) {
        NEAR(f[0][i] / f[1][i], 1, 1e-6);
    }
}

/* ---- loads ---- */

enum { KINDS = 3 };
static const int kinds[KINDS] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_RIGID};

/* A stiff beam with two bodies between its nodes, centres of mass beside the line. */
static spar_member *laden(spar_session *s, int fidelity, int root, double *first, double *second) {
    const double eta[2] = {0.65, 0.3}, c[2][3] = {{0.1, 0.2, 0.3}, {-0.2, 0, 0.1}}, J[3] = {0.1, 0.1, 0.1};
    double K[36], M[36], mass[72];
    scene_diagonal(K, 1e11, 1e11, 1e11, 1e11, 1e11, 1e11);
    scene_diagonal(M, m, m, m, 2e-3, 1e-3, 1e-3);
    spar_member *b = scene_beam(s, "beam", 2, 5, L, K, M);
    scene_mass(mass, 4, c[0], J);
    scene_mass(mass + 36, 7, c[1], J);
    OK(s, spar_beam_set_masses(b, 2, eta, mass));
    OK(s, spar_member_set_fidelity(b, fidelity, 0));
    OK(s, spar_member_set_root(b, root));
    *first = m * L * L / 2 + 4 * (0.65 * L + 0.1) + 7 * (0.3 * L - 0.2); /* moments of mass along x, */
    *second = 4 * 0.2;                                                   /* and along y */
    return b;
}

/* Weight: the support holds (m L + 11) g and its moment about the root, from the centres of mass of the reference; in a
   turn at w about z it pulls w^2 times the first moments of mass. The beam gives way by 1e-8 of its length at most:
   1e-6 of the loads. */
static void test_weight_and_turn(void **state) {
    (void)state;
    const double g[3] = {0, 0, -9.81}, w[3] = {0, 0, 5}, none[3] = {0};
    for (int k = 0; k < KINDS; k++) {
        double load[6], x, y;
        spar_session *s = scene_session();
        spar_member *b = laden(s, kinds[k], SPAR_ROOT_FIXED, &x, &y);
        OK(s, spar_session_set_gravity(s, g));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_solve_static(b, 1));
        OK(s, spar_member_get_reaction(b, load));
        NEAR(load[2], (m * L + 11) * 9.81, 1e-4);
        NEAR(load[3], y * 9.81, 1e-4);
        NEAR(load[4], -x * 9.81, 1e-4);
        spar_session_destroy(&s);
        s = scene_session();
        b = laden(s, kinds[k], SPAR_ROOT_DRIVEN, &x, &y);
        OK(s, spar_member_set_initial_velocity(b, none, none, w));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_solve_static(b, 1));
        OK(s, spar_member_get_reaction(b, load));
        NEAR(load[0], -25 * x, 3e-4);
        NEAR(load[1], -25 * y, 3e-4);
        spar_session_destroy(&s);
    }
}

/* Kinetic energy of a free beam that moves and turns about its root with a body at its tip, centre there: 1/2 (m L + M)
   v^2 along z, 1/2 w^2 (m L^3 / 3 + j L + M L^2 + J) about z; the weight's potential after a fall of g t^2 / 2 is as
   much as kinetic energy has come. To 1e-12 of it. */
static void test_energy(void **state) {
    (void)state;
    const double tip[1] = {1}, none[3] = {0}, J[3] = {0.3, 0.3, 0.2}, v[3] = {0, 0, 2}, w[3] = {0, 0, 3},
                 g[3] = {0, 0, -1};
    for (int k = 0; k < KINDS; k++) {
        double K[36], M[36], mass[36], energy[4], first;
        spar_session *s = scene_session();
        scene_diagonal(K, 1e6, 1e6, 1e6, 1e6, 1e6, 1e6);
        scene_diagonal(M, m, m, m, 2e-3, 1e-3, 1e-3);
        scene_mass(mass, 4, none, J);
        spar_member *b = scene_beam(s, "beam", 1, 5, L, K, M);
        OK(s, spar_session_set_gravity(s, g));
        OK(s, spar_beam_set_masses(b, 1, tip, mass));
        OK(s, spar_member_set_fidelity(b, kinds[k], 0));
        OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
        OK(s, spar_member_set_initial_velocity(b, none, v, kinds[k] == SPAR_FIDELITY_LINEAR ? none : w));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_get_energy(b, 4, energy));
        double turning = kinds[k] == SPAR_FIDELITY_LINEAR ? 0 : 4.5 * (m * L * L * L / 3 + 1e-3 * L + 4 * L * L + 0.2);
        first = 2 * (m * L + 4) + turning;
        NEAR(energy[SPAR_ENERGY_KINETIC], first, 1e-12 * first);
        if (kinds[k] == SPAR_FIDELITY_LINEAR) {
            scene_run(s, 0.1, 1);
            OK(s, spar_member_get_energy(b, 4, energy));
            NEAR(energy[SPAR_ENERGY_GRAVITY], (m * L + 4) * (0.2 - 0.005), 1e-10);
        }
        spar_session_destroy(&s);
    }
}

/* ---- switches ---- */

static void steps(spar_session *s, spar_member *b, double q[7]) {
    scene_run(s, 0.01, 8);
    scene_tip(b, q);
}

/* Described and left out gives the bits of never described, and of what was described and taken away again; with them
   the beam moves otherwise. What is in force says so. */
static void test_off(void **state) {
    (void)state;
    const double g[3] = {0, 0, -9.81}, tip[1] = {1};
    double mass[36], q[4][7];
    full_mass(mass);
    for (int k = 0; k < 4; k++) {
        int effects;
        spar_session *s = scene_session();
        spar_member *b = slender(s, 1, 6, m);
        OK(s, spar_session_set_gravity(s, g));
        if (k > 0) {
            OK(s, spar_beam_set_masses(b, 1, tip, mass));
        }
        if (k == 1) {
            OK(s, spar_member_set_effects(
                      b, EFFECTS_ONLY(SPAR_EFFECT_INERTIA | SPAR_EFFECT_GYROSCOPIC | SPAR_EFFECT_GRAVITY)));
        } else if (k == 2) {
            OK(s, spar_beam_set_masses(b, 0, NULL, NULL));
        }
        OK(s, spar_member_commit(b));
        OK(s, spar_member_get_effects(b, &effects));
        assert_int_equal((effects & SPAR_EFFECT_MASSES) != 0, k == 3);
        steps(s, b, q[k]);
        spar_session_destroy(&s);
    }
    assert_memory_equal(q[0], q[1], sizeof q[0]);
    assert_memory_equal(q[0], q[2], sizeof q[0]);
    assert_true(fabs(q[3][2] - q[0][2]) > 0.01 * fabs(q[0][2]));
}

/* The report by trials. In statics the support without the body lacks its weight and its moment: of (m L + M) g and (m
   L / 2 + M) g L, by the length, M g twice. Of a beam of hardly any mass the size is that of the weight 4 g at one
   node, in the state before the trial and eight in balance, by the forces within the beam in these eight: at the root
   as much force and, by the length, moment, at the tip the force; 9 of 8 times 3. */
static void test_report(void **state) {
    (void)state;
    const double tip[1] = {1}, none[3] = {0}, J[3] = {0, 0, 0}, g[3] = {0, 0, -9.81};
    static const double density[2] = {m, 1e-9};
    for (int k = 0; k < 2; k++) {
        double mass[36], K[36], M[36], table[SPAR_ROW_COUNT][COLUMN_COUNT], d = density[k];
        spar_session *s = scene_session();
        scene_mass(mass, 4, none, J);
        scene_diagonal(K, 1e9, 1e9, 1e9, 1e9, 1e9, 1e9); /* stiff: moments by the reference's arms */
        scene_diagonal(M, d, d, d, 2e-3 * d, 1e-3 * d, 1e-3 * d);
        spar_member *b = scene_beam(s, "beam", 1, 6, L, K, M);
        OK(s, spar_session_set_gravity(s, g));
        OK(s, spar_beam_set_masses(b, 1, tip, mass));
        OK(s, spar_member_set_effects(b, EFFECTS_ONLY(SPAR_EFFECT_GRAVITY | SPAR_EFFECT_MASSES)));
        OK(s, spar_member_commit(b));
        OK(s, trial_report_effects(s, 0.1, 8, NULL, NULL, NULL, table[0]));
        const double *row = table[SPAR_ROW_MASSES];
        assert_true(row[COLUMN_IN_FORCE] == 1);
        NEAR(row[COLUMN_REACTION], hypot(4, 4) / hypot(d * L + 4, d * L / 2 + 4), 1e-6);
        if (k == 1) {
            NEAR(row[COLUMN_SIZE], sqrt(9.0 / 24), 1e-6);
        }
        spar_session_destroy(&s);
    }
    assert_string_equal(spar_effect_name(SPAR_ROW_MASSES), "bodies on beams");
}

/* ---- files ---- */

static spar_member *saved_scene(spar_session *s, double of_body) {
    const double g[3] = {0, 0, -9.81}, eta[2] = {1, 0.4}, none[3] = {0}, J[3] = {0.1, 0.1, 0.1};
    double mass[72];
    full_mass(mass);
    scene_mass(mass + 36, of_body, none, J);
    spar_member *b = slender(s, 1, 6, m);
    OK(s, spar_session_set_gravity(s, g));
    OK(s, spar_beam_set_masses(b, 2, eta, mass));
    OK(s, spar_member_commit(b));
    return b;
}

/* Saved after the fourth step of eight, loaded, four more: the same bits; a session whose bodies are others is told. */
static void test_saved(void **state) {
    (void)state;
    const char *const path = "test_masses.save";
    double q[2][7];
    spar_session *s = scene_session();
    spar_member *b = saved_scene(s, 2);
    scene_run(s, 0.01, 4);
    OK(s, spar_session_save(s, path));
    scene_run(s, 0.01, 4);
    scene_tip(b, q[0]);
    spar_session_destroy(&s);
    s = scene_session();
    b = saved_scene(s, 2);
    OK(s, spar_session_load(s, path));
    scene_run(s, 0.01, 4);
    scene_tip(b, q[1]);
    assert_memory_equal(q[0], q[1], sizeof q[0]);
    spar_session_destroy(&s);
    s = scene_session();
    (void)saved_scene(s, 2.5);
    assert_int_equal(spar_session_load(s, path), SPAR_ERR_ARGUMENT);
    spar_session_destroy(&s);
    (void)remove(path);
}

/* ---- input ---- */

/* What is given can be read; what is refused names the body, and leaves those of before. */
static void test_bad_input(void **state) {
    (void)state;
    double mass[72], got[108], where[3], K[36];
    const double eta[2] = {0.2, 0.1}, beyond[2] = {0.5, 1.5}, bad[2] = {0.5, NAN}, none[3] = {0}, one[2] = {0, 1};
    int64_t n = -1;
    spar_session *s = scene_session();
    spar_member *b = slender(s, 1, 4, m), *body = NULL, *light = NULL;
    full_mass(mass), full_mass(mass + 36);
    mass[0] = mass[7] = mass[14] = 4;
    OK(s, spar_beam_get_masses(b, &n, 0, NULL, NULL));
    assert_int_equal(n, 0);
    OK(s, spar_beam_set_masses(b, 2, eta, mass));
    REFUSED(s, SPAR_ERR_ARGUMENT, "eta 1 is 1.5", spar_beam_set_masses(b, 2, beyond, mass));
    REFUSED(s, SPAR_ERR_ARGUMENT, "eta", spar_beam_set_masses(b, 2, bad, mass));
    REFUSED(s, SPAR_ERR_ARGUMENT, "-1 stations", spar_beam_set_masses(b, -1, eta, mass));
    REFUSED(s, SPAR_ERR_ARGUMENT, "10001 stations", spar_beam_set_masses(b, 10001, eta, mass));
    assert_int_equal(spar_beam_set_masses(b, 1, NULL, mass), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_set_masses(b, 1, eta, NULL), SPAR_ERR_ARGUMENT);
    mass[36] = 9;
    REFUSED(s, SPAR_ERR_ARGUMENT, "body 1 is not that of a rigid body", spar_beam_set_masses(b, 2, eta, mass));
    mass[36] = 4;
    OK(s, spar_beam_get_masses(b, &n, 3, where, got));
    assert_true(n == 2 && where[0] == 0.2 && where[1] == 0.1 && where[2] == 0);
    assert_memory_equal(got, mass, sizeof mass);
    assert_true(got[72] == 0);
    assert_int_equal(spar_beam_get_masses(b, NULL, -1, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_set_masses(NULL, 0, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_get_masses(NULL, NULL, 0, NULL, NULL), SPAR_ERR_ARGUMENT);
    OK(s, spar_rigid_create(s, "body", none, NULL, mass, &body));
    REFUSED(s, SPAR_ERR_ARGUMENT, "'body' is not a beam", spar_beam_set_masses(body, 1, eta, mass));
    REFUSED(s, SPAR_ERR_ARGUMENT, "'body' is not a beam", spar_beam_get_masses(body, &n, 0, NULL, NULL));
    OK(s, spar_member_commit(b));
    REFUSED(s, SPAR_ERR_STATE, "committed", spar_beam_set_masses(b, 0, NULL, NULL));
    scene_diagonal(K, 1, 1, 1, 1, 1, 1);
    OK(s, spar_beam_create(s, "light", 1, 3, &light));
    OK(s, spar_beam_set_axis(light, 2, one, (double[6]){0, 0, 0, 1, 0, 0}, NULL));
    OK(s, spar_beam_set_sections(light, 1, one, K, NULL));
    OK(s, spar_beam_set_masses(light, 2, eta, mass));
    REFUSED(s, SPAR_ERR_STATE, "sections without mass", spar_member_commit(light));
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tip_body), cmocka_unit_test(test_welded),    cmocka_unit_test(test_weight_and_turn),
        cmocka_unit_test(test_energy),   cmocka_unit_test(test_off),       cmocka_unit_test(test_report),
        cmocka_unit_test(test_saved),    cmocka_unit_test(test_bad_input),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
