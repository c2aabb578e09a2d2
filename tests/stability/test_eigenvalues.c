/* Eigenvalues of small motions about a state: flutter under loads that follow, damping, rotors. */
#include "scene.h"

#include "member/structure.h"

/* The largest growth rate of n eigenvalues. */
static double growth(int n, double (*value)[2]) {
    double most = -INFINITY;
    for (int i = 0; i < n; i++) {
        most = value[i][0] > most ? value[i][0] : most;
    }
    return most;
}

/* A cantilever of unit length, EI = m = 1, slender, under a follower force along its axis: at the tip (Beck), or spread
   evenly (Leipholz). */
static spar_member *column(spar_session *s, int elements, double tip, double spread) {
    double K[36], M[36], load[6] = {-tip, 0, 0, 0, 0, 0}, line[6] = {-spread, 0, 0, 0, 0, 0};
    scene_diagonal(K, 1e6, 1e6, 1e6, 1e2, 1, 1);
    scene_diagonal(M, 1, 1, 1, 1e-4, 1e-8, 1e-8);
    spar_member *b = scene_beam(s, "column", elements, elements > 1 ? 8 : 12, 1, K, M);
    OK(s, spar_member_commit(b));
    int64_t n;
    const double eta[1] = {0};
    OK(s, spar_member_get_count(b, &n));
    if (tip != 0) {
        OK(s, spar_member_set_load(b, n - 1, SPAR_LOAD_FOLLOWER, load));
    }
    if (spread != 0) {
        OK(s, spar_beam_set_line_load(b, SPAR_LOAD_FOLLOWER, 1, eta, line));
    }
    OK(s, spar_member_solve_static(b, 1));
    return b;
}

static double growth_of_column(double tip, double spread) {
    spar_session *s = scene_session();
    double value[4][2];
    OK(s, spar_member_solve_eigenvalues(column(s, 1, tip, spread), 4, NULL, &value[0][0], NULL, NULL));
    spar_session_destroy(&s);
    return growth(4, value);
}

/* The load between two at which the growth rate leaves 0. */
static double limit_between(int spread, double low, double high) {
    while (high - low > 1e-4 * low) {
        double middle = 0.5 * (low + high), g = spread ? growth_of_column(0, middle) : growth_of_column(middle, 0);
        if (g > 1e-2) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return 0.5 * (low + high);
}

/* Beck's column loses its stability at P = 20.05095 EI/L^2 (Beck, ZAMP 3, 1952), Leipholz's at q L = 40.05 (Leipholz,
   Stability Theory, 1970), both by flutter; their slender limit, and shear, stretch of 1e-6: asked to 2e-4. Below it no
   motion grows: the modes of the symmetric part decide nothing, which turn negative at P = 9.87 and q L = 20 about. */
static void test_followers(void **state) {
    (void)state;
    double f[1];
    assert_true(fabs(growth_of_column(15, 0)) < 1e-4);
    assert_true(fabs(growth_of_column(0, 35)) < 1e-4);
    NEAR(limit_between(0, 15, 25), 20.05095, 2e-4 * 20.05);
    NEAR(limit_between(1, 35, 45), 40.05, 2e-4 * 40.05);
    spar_session *s = scene_session();
    OK(s, spar_member_solve_modes(column(s, 1, 15, 0), 1, f, NULL));
    assert_true(f[0] < 0);
    spar_session_destroy(&s);
}

/* Past the limit Beck's column flutters: both signs of growth, one frequency; the same from 174 unknowns, by Arnoldi,
   as from 66, dense. And shapes: (lambda^2 M + lambda C + K) x = 0 makes them the motion that steps of time go through.
 */
static void test_flutter(void **state) {
    (void)state;
    double value[2][4][2];
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        OK(s, spar_member_solve_eigenvalues(column(s, k ? 4 : 1, 25, 0), 4, NULL, &value[k][0][0], NULL, NULL));
        spar_session_destroy(&s);
    }
    assert_true(growth(4, value[0]) > 1);
    for (int i = 0; i < 4; i++) {
        NEAR(hypot(value[0][i][0], value[0][i][1]), hypot(value[1][i][0], value[1][i][1]), 1e-5);
    }
    NEAR(growth(4, value[1]), growth(4, value[0]), 1e-5);
}

static const double rotor_table[][5] = {{0, 3.5160152685, 22.034491565, 61.697214414, 3.5160153},
                                        {1, 3.681646814, 22.181011151, 61.841762587, 3.5432363},
                                        {4, 5.5850014209, 24.273349394, 63.966760493, 3.8977225},
                                        {12, 13.170150488, 37.603112331, 79.614478489, 5.4270493}};

/* The eigenvalue nearest to i f. */
static void nearest(spar_member *b, double f, double value[2], double *shape) {
    const double shift[2] = {0, f};
    OK(b->session, spar_member_solve_eigenvalues(b, 1, shift, value, shape, NULL));
}

/* Rotating uniform cantilever, hub radius 0: flap (out of the plane of rotation) by Frobenius' series, Wright et al.,
   J. Appl. Mech. 49 (1982) 197; in the plane omega^2 is less by eta^2. EA = 1e8 EI/L^2 leaves 1e-5 by stretch, and
   Coriolis' forces, which couple stretch and bending in the plane, 1e-7: asked to 2e-5. Dense and by Arnoldi. */
static void test_rotating_blade(void **state) {
    (void)state;
    const double L = 2, EI = 5, m = 3, unit = sqrt(EI / m) / (L * L), stiff = 1e8 * EI / L / L, j = 1e-8 * m * L * L;
    double K[36], M[36];
    scene_diagonal(K, stiff, stiff, stiff, 1e6 * EI, EI, EI);
    scene_diagonal(M, m, m, m, 2 * j, j, j);
    for (size_t k = 0; k < sizeof rotor_table / sizeof *rotor_table; k++) {
        for (int elements = 1; elements <= 2; elements++) {
            const double *row = rotor_table[k], w[3] = {0, 0, row[0] * unit};
            double value[2], frame[3];
            spar_session *s = scene_session();
            spar_member *b = scene_beam(s, "b", elements, 14, L, K, M);
            OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
            OK(s, spar_member_set_initial_velocity(b, NULL, NULL, w));
            OK(s, spar_member_commit(b));
            OK(s, spar_member_solve_static(b, 1));
            for (int i = 1; i < 5; i++) {
                nearest(b, row[i] * unit, value, NULL);
                NEAR(value[1] / unit, row[i], 2e-5 * row[i]);
                NEAR(value[0] / unit, 0, 1e-5);
            }
            OK(s, spar_member_solve_eigenvalues(b, 1, NULL, value, NULL, frame));
            NEAR(frame[2], w[2], 0);
            spar_session_destroy(&s);
        }
    }
}

/* A round shaft, its root driven about its own axis: seen from the frame that turns with it the whirls of both planes
   are omega +- W, omega = 3.51602 without rotary inertia. From the frame's imaginary parts alone: |omega - W| and
   omega + W; without damping neither grows, at any speed. */
static void test_whirl(void **state) {
    (void)state;
    double K[36], M[36];
    scene_diagonal(K, 1e6, 1e6, 1e6, 1e3, 1, 1);
    scene_diagonal(M, 1, 1, 1, 2e-6, 1e-6, 1e-6);
    for (double W = 1; W < 6; W += 2) {
        const double w[3] = {W, 0, 0};
        double value[2][2];
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "shaft", 1, 10, 1, K, M);
        OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
        OK(s, spar_member_set_initial_velocity(b, NULL, NULL, w));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_solve_eigenvalues(b, 2, NULL, &value[0][0], NULL, NULL));
        NEAR(value[0][1], fabs(3.5160153 - W), 1e-4);
        NEAR(value[1][1], 3.5160153 + W, 1e-4);
        NEAR(growth(2, value), 0, 1e-7);
        spar_session_destroy(&s);
    }
}

/* A rigid body on a spring and damper in one direction: lambda = -z w0 +- i w0 sqrt(1 - z^2), and beyond z = 1 two that
   are real; the other directions are welded. */
static void test_damped(void **state) {
    (void)state;
    for (int k = 0; k < 2; k++) {
        const double m = 2, stiff = 50, w0 = 5, ratio = k ? 1.25 : 0.3, x[3] = {0}, q[4] = {1, 0, 0, 0};
        const double c[3] = {0}, J[3] = {1, 1, 1};
        double M[36], spring[36] = {stiff}, damper[36] = {2 * ratio * w0 * m}, value[2][2];
        spar_session *s = scene_session();
        spar_member *b = NULL;
        spar_joint *j = NULL;
        scene_mass(M, m, c, J);
        OK(s, spar_rigid_create(s, "mass", x, q, M, &b));
        OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
        OK(s, spar_joint_create(s, "spring", b, 0, NULL, 0, SPAR_FREE_X, &j));
        OK(s, spar_joint_set_spring(j, spring, damper, NULL));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_solve_eigenvalues(b, 1 + k, NULL, &value[0][0], NULL, NULL));
        if (k) {
            NEAR(value[0][0], -w0 * (ratio - sqrt(ratio * ratio - 1)), 1e-10);
            NEAR(value[1][0], -w0 * (ratio + sqrt(ratio * ratio - 1)), 1e-10);
        } else {
            NEAR(value[0][0], -w0 * ratio, 1e-10);
            NEAR(value[0][1], w0 * sqrt(1 - ratio * ratio), 1e-10);
        }
        spar_session_destroy(&s);
    }
}

/* A body of revolution that spins with W about x, on springs alike all around. In axes that stand: m y'' + k y = 0 in
   both directions, and Jt p'' - i Jp W p' + kr p = 0 of the tilt p = py + i pz; seen from the body all whirls are less
   by W. */
static void test_spinning_body(void **state) {
    (void)state;
    const double m = 2, k = 50, kr = 30, Jp = 1.5, Jt = 0.8, W = 3, x[3] = {0}, q[4] = {1, 0, 0, 0}, c[3] = {0};
    const double J[3] = {1.5, 0.8, 0.8}, w[3] = {3, 0, 0};
    const double root = sqrt(Jp * Jp * W * W + 4 * Jt * kr),
                 tilt[2] = {(Jp * W + root) / (2 * Jt), (Jp * W - root) / (2 * Jt)};
    const double expected[5] = {fabs(5 - W), 5 + W, fabs(tilt[0] - W), fabs(tilt[1] - W), sqrt(70 / m)};
    double M[36], spring[36] = {0}, value[2];
    spar_session *s = scene_session();
    spar_member *b = NULL;
    spar_joint *j = NULL;
    scene_mass(M, m, c, J);
    scene_diagonal(spring, 70, k, k, 0, kr, kr);
    OK(s, spar_rigid_create(s, "top", x, q, M, &b));
    OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
    OK(s, spar_member_set_initial_velocity(b, NULL, NULL, w));
    OK(s, spar_joint_create(s, "springs", b, 0, NULL, 0, 63, &j));
    OK(s, spar_joint_set_spring(j, spring, NULL, NULL));
    OK(s, spar_member_commit(b));
    for (int i = 0; i < 5; i++) {
        nearest(b, expected[i], value, NULL);
        NEAR(value[1], expected[i], 1e-8);
        NEAR(value[0], 0, 1e-8);
    }
    spar_session_destroy(&s);
}

/* A free beam of a square section: six motions without stiffness, then 22.37329 twice. */
static void test_free_beam(void **state) {
    (void)state;
    double K[36], M[36], value[8][2];
    for (int elements = 1; elements <= 3; elements++) {
        scene_diagonal(K, 1e6, 1e6, 1e6, 1e2, 1, 1);
        scene_diagonal(M, 1, 1, 1, 1e-2, 1e-6, 1e-6);
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "free", elements, 12, 1, K, M);
        OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_solve_eigenvalues(b, 8, NULL, &value[0][0], NULL, NULL));
        for (int i = 0; i < 8; i++) {
            NEAR(value[i][1], i < 6 ? 0 : 22.373285, 1e-3);
            NEAR(value[i][0], 0, 1e-6);
        }
        spar_session_destroy(&s);
    }
}

/* What is refused leaves the arrays as they were. */
static void test_refusals(void **state) {
    (void)state;
    const double nan_shift[2] = {0, NAN}, load[6] = {0, 0, 1e-2, 0, 0, 0};
    double value[2] = {7, 7};
    spar_session *s = scene_session();
    spar_member *b = column(s, 1, 0, 0);
    REFUSED(s, SPAR_ERR_ARGUMENT, "shift", spar_member_solve_eigenvalues(b, 1, nan_shift, value, NULL, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "66 unknowns", spar_member_solve_eigenvalues(b, 67, NULL, value, NULL, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "-1", spar_member_solve_eigenvalues(b, -1, NULL, value, NULL, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "NULL", spar_member_solve_eigenvalues(b, 1, NULL, NULL, NULL, NULL));
    OK(s, spar_member_solve_eigenvalues(b, 0, NULL, NULL, NULL, NULL));
    OK(s, spar_member_set_load(b, 11, SPAR_LOAD_DEAD, load));
    REFUSED(s, SPAR_ERR_STATE, "equilibrium", spar_member_solve_eigenvalues(b, 1, NULL, value, NULL, NULL));
    assert_true(value[0] == 7 && value[1] == 7);
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_member_solve_eigenvalues(b, 1, NULL, value, NULL, NULL));
    NEAR(value[1], 3.516, 1e-3);
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_followers), cmocka_unit_test(test_flutter),  cmocka_unit_test(test_rotating_blade),
        cmocka_unit_test(test_whirl),     cmocka_unit_test(test_damped),   cmocka_unit_test(test_spinning_body),
        cmocka_unit_test(test_free_beam), cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
