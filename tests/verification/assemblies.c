/* Members tied by joints, their frequencies and equilibrium against closed forms; tolerances beside each.
   - Portal frame with clamped feet: dynamic stiffness of slender members (Clough & Penzien, Dynamics of Structures, ch.
     18). Two equal spans: n pi, tan x = tanh x.
   - Beam on N discrete springs at equal distances: see test_foundation.
   - Hanging parallelogram, bead on taut lines: one degree of freedom each.
   - Body on preloaded springs in six directions: k z = weight + preload about its node. */
#include "verification.h"

static const double upright[4] = {1, 0, 0, 0}, zero[3] = {0, 0, 0}, two_pi = 6.283185307179586;

/* ---- frames ---- */

/* Roots of a function between `from` and `to`, by steps and bisection; how many. */
static int roots_of(double (*f)(double), double from, double to, int most, double *root) {
    int n = 0;
    const double step = 1e-3;
    for (double x = from; x < to && n < most; x += step) {
        double a = x, b = x + step;
        if (!(f(a) * f(b) < 0) || fabs(f(a) - f(b)) > 1e4) { /* or a pole */
            continue;
        }
        for (int i = 0; i < 60; i++) {
            double c = 0.5 * (a + b);
            (f(a) * f(c) <= 0 ? &b : &a)[0] = c;
        }
        root[n++] = 0.5 * (a + b);
    }
    return n;
}

/* End stiffnesses of a slender beam that vibrates, by EI / L, EI / L^2, EI / L^3; x = L (m omega^2 / EI)^(1/4). */
static double below(double x) {
    return 1 - cos(x) * cosh(x);
}
static double near_turn(double x) { /* moment at the turned end */
    return x * (cosh(x) * sin(x) - sinh(x) * cos(x)) / below(x);
}
static double far_turn(double x) { /* at the other */
    return x * (sinh(x) - sin(x)) / below(x);
}
static double shear_turn(double x) {
    return x * x * sin(x) * sinh(x) / below(x);
}
static double shear_way(double x) {
    return x * x * x * (sin(x) * cosh(x) + cos(x) * sinh(x)) / below(x);
}
/* A portal of three equal members with clamped feet, its corners turned against each other; or alike, and swaying with
   half of the beam's mass on each column. */
static double portal_symmetric(double x) {
    return 2 * near_turn(x) - far_turn(x);
}
static double portal_sway(double x) {
    return (2 * near_turn(x) + far_turn(x)) * (shear_way(x) - 0.5 * x * x * x * x) - shear_turn(x) * shear_turn(x);
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Stiff but for bending in the plane of x and z: shear and stretch by 1e8 EI / L^2, rotary inertia 1e-9 m L^2. */
static void slender(double EI, double m, double L, double *K, double *M) {
    double stiff = 1e8 * EI / (L * L), j = 1e-9 * m * L * L;
    scene_diagonal(K, stiff, stiff, stiff, 1e5 * EI, EI, 1e5 * EI);
    scene_diagonal(M, m, m, m, 2 * j, j, j);
}

/* Portal frame of slender members against its frequency equations (Bernoulli-Euler, dynamic stiffness; e.g. Clough &
   Penzien, Dynamics of Structures, ch. 18): the first five to 2e-6. One of them leaves the corners where they are, each
   member vibrating as if clamped, cos x cosh x = 1, with its moments in balance: there the equations have a pole. */
static void test_portal(void **state) {
    (void)state;
    enum { P = 10 };
    const double L = 1.5, EI = 20, m = 3, eta[2] = {0, 1},
                 line[3][6] = {{0, 0, 0, 0, 0, L}, {0, 0, L, L, 0, L}, {L, 0, 0, L, 0, L}};
    double K[36], M[36], f[5], root[20];
    char what[64];
    slender(EI, m, L, K, M);
    spar_session *s = scene_session();
    spar_member *b[3];
    static const char *const name[3] = {"left", "beam", "right"};
    for (int k = 0; k < 3; k++) {
        OK(s, spar_beam_create(s, name[k], 1, P, &b[k]));
        OK(s, spar_beam_set_axis(b[k], 2, eta, line[k], NULL));
        OK(s, spar_beam_set_sections(b[k], 1, eta, K, M));
        OK(s, spar_member_set_root(b[k], k == 1 ? SPAR_ROOT_FREE : SPAR_ROOT_FIXED));
        OK(s, spar_member_commit(b[k]));
    }
    (void)scene_joint(s, "left corner", b[1], 0, b[0], P - 1, 0);
    (void)scene_joint(s, "right corner", b[1], P - 1, b[2], P - 1, 0);
    OK(s, spar_member_solve_modes(b[1], 5, f, NULL));
    int n = roots_of(portal_symmetric, 0.5, 9, 10, root);
    n += roots_of(portal_sway, 0.5, 9, 10, root + n);
    n += roots_of(below, 1, 6, 1, root + n);
    assert_true(n >= 5);
    qsort(root, (size_t)n, sizeof *root, ascending);
    for (int k = 0; k < 5; k++) {
        double expected = root[k] * root[k] * sqrt(EI / m) / (L * L) / two_pi;
        snprintf(what, sizeof what, "portal frame: frequency %d, Hz", k + 1);
        verify(what, f[k], expected, 2e-6 * expected, "dynamic stiffness");
    }
    spar_session_destroy(&s);
    verified();
}

/* A beam over two equal spans, its ends and its middle node on joints to the ground: each span simply supported, x = n
   pi, or clamped at the middle, tan x = tanh x. Slender; 2e-6. */
static double clamped_pinned(double x) {
    return sin(x) - cos(x) * tanh(x);
}

static void test_two_spans(void **state) {
    (void)state;
    enum { P = 10 };
    const double L = 2, EI = 8, m = 0.5, half = acos(-1);
    double K[36], M[36], f[4], root[2];
    char what[64];
    slender(EI, m, L, K, M);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "beam", 2, P, 2 * L, K, M);
    OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
    OK(s, spar_member_commit(b));
    for (int k = 0; k < 3; k++) {
        spar_joint *j = scene_joint(s, (const char *[]){"left", "middle", "right"}[k], b,
                                    (int64_t[]){0, P, 2 * P - 1}[k], NULL, 0, SPAR_FREE_RY | (k ? SPAR_FREE_X : 0));
        OK(s, spar_joint_set_frame(j, (double[]){k * L, 0, 0}, NULL));
    }
    OK(s, spar_member_solve_modes(b, 4, f, NULL));
    assert_int_equal(roots_of(clamped_pinned, 1, 8, 2, root), 2);
    const double x[4] = {half, root[0], 2 * half, root[1]};
    for (int k = 0; k < 4; k++) {
        double expected = x[k] * x[k] * sqrt(EI / m) / (L * L) / two_pi;
        snprintf(what, sizeof what, "two spans: frequency %d, Hz", k + 1);
        verify(what, f[k], expected, 2e-6 * expected, "closed form");
    }
    spar_session_destroy(&s);
    verified();
}

/* A slender beam of length L, pinned at its ends, on SPRINGS springs k at equal distances L / s, s = SPRINGS + 1.
   Springs see a shape sin(n pi x / L) as they see those of n' = 2 s j +- n, with the sign: the beam's motion is of
   these alone, each pushed by the springs' s k / L of the common height, so that with x^4 = m omega^2 L^4 / EI 1 + k s
   L^3 / EI sum 1 / ((n' pi)^4 - x^4) = 0, one root between n pi and the next pole. */
enum { SPRINGS = 4 };
static const double foundation_K = 3000;

static double on_springs(double x, int n) {
    const int s = SPRINGS + 1;
    double sum = 0;
    for (int j = 0; j < 400; j++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            int at = 2 * s * j + sign * n;
            sum += at > 0 ? 1 / (pow(at * two_pi / 2, 4) - pow(x, 4)) : 0;
        }
    }
    return 1 + foundation_K * s * sum;
}

static void test_foundation(void **state) {
    (void)state;
    enum { P = 10 };
    const double L = 5, EI = 8, m = 0.5, k = foundation_K * EI / (L * L * L);
    double K[36], M[36], spring[36], f[SPRINGS];
    char what[64];
    slender(EI, m, L, K, M);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "beam", SPRINGS + 1, P, L, K, M);
    OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
    OK(s, spar_member_commit(b));
    scene_diagonal(spring, 0, 0, k, 0, 0, 0);
    for (int i = 0; i <= SPRINGS + 1; i++) {
        int end = i == 0 || i == SPRINGS + 1;
        snprintf(what, sizeof what, "support %d", i);
        spar_joint *j = scene_joint(s, what, b, i == SPRINGS + 1 ? (SPRINGS + 1) * P - 1 : i * P, NULL, 0,
                                    end ? SPAR_FREE_RY | (i ? SPAR_FREE_X : 0) : 63);
        OK(s, spar_joint_set_frame(j, (double[]){i * L / (SPRINGS + 1), 0, 0}, NULL));
        OK(s, spar_joint_set_spring(j, end ? NULL : spring, NULL, NULL));
    }
    OK(s, spar_member_solve_modes(b, SPRINGS, f, NULL));
    double expected[SPRINGS];
    for (int n = 1; n <= SPRINGS; n++) {
        double low = n * two_pi / 2, high = (2 * (SPRINGS + 1) - n) * two_pi / 2;
        for (int i = 0; i < 60; i++) {
            double x = 0.5 * (low + high);
            *(on_springs(x, n) < 0 ? &low : &high) = x;
        }
        expected[n - 1] = low * low * sqrt(EI / m) / (L * L) / two_pi;
    }
    qsort(expected, SPRINGS, sizeof *expected, ascending);
    for (int n = 0; n < SPRINGS; n++) {
        snprintf(what, sizeof what, "beam on springs: frequency %d, Hz", n + 1);
        verify(what, f[n], expected[n], 2e-6 * expected[n], "closed form");
    }
    spar_session_destroy(&s);
    verified();
}

/* ---- bodies ---- */

/* A parallelogram of rods of 1 kg a metre (cranks of 1 m, a coupler of 2 m) hangs on four parallel hinges, three of
   whose holds follow from others: (2 m L^2 / 3 + 2 L^2) omega^2 = (2 L / 2 + 2 L) g; the weight is in the joints'
   loads, which turn with them. */
static void test_hanging_parallelogram(void **state) {
    (void)state;
    const double g = 9.81, x[4][3] = {{0, 0, 0}, {2, 0, 0}, {0, 0, -1}, {2, 0, -1}}, omega = sqrt(9 * g / 8);
    const double down[3] = {0, 0, -0.5}, bar[3] = {1, 0, 0}, thin[3] = {1. / 12, 1. / 12, 1. / 12};
    double mass[36], f[1];
    spar_session *s = scene_session();
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -g}));
    spar_member *b[3];
    for (int k = 0; k < 3; k++) {
        scene_mass(mass, k < 2 ? 1 : 2, k < 2 ? down : bar, thin);
        OK(s, spar_rigid_create(s, (const char *[]){"crank", "rocker", "coupler"}[k], x[k], upright, mass, &b[k]));
        OK(s, spar_member_commit(b[k]));
    }
    for (int k = 0; k < 4; k++) {
        spar_joint *j = scene_joint(s, (const char *[]){"foot", "foot2", "top", "top2"}[k], b[k < 2 ? k : 2], 0,
                                    k < 2 ? NULL : b[k - 2], 0, SPAR_FREE_RY);
        OK(s, spar_joint_set_frame(j, x[k], upright));
    }
    OK(s, spar_member_solve_static(b[2], 1));
    OK(s, spar_member_solve_modes(b[2], 1, f, NULL));
    verify("parallelogram: frequency, rad/s", two_pi * f[0], omega, 1e-7 * omega, "closed form");
    assert_int_equal(spar_member_solve_modes(b[0], 2, f, NULL), SPAR_ERR_ARGUMENT);
    spar_session_destroy(&s);
    verified();
}

/* A body of 2 kg between two taut lines along x, of 1 m, 400 N/m and 0.8 m unstretched: across them omega^2 = 2 T / (m
   l), along them 2 k / m; its three turns are free. */
static void test_taut_lines(void **state) {
    (void)state;
    const double m = 2, k = 400, T = k * 0.2, J[3] = {1, 2, 3}, end[2][3] = {{1, 0, 0}, {-1, 0, 0}};
    double f[6];
    spar_session *s = scene_session();
    spar_member *b = scene_body(s, "bead", zero, m, J);
    for (int i = 0; i < 2; i++) {
        spar_joint *j = NULL;
        OK(s, spar_link_create(s, i ? "left" : "right", b, 0, zero, NULL, 0, end[i], &j));
        OK(s, spar_link_set_spring(j, k, 0, 0.8, 1));
    }
    OK(s, spar_member_solve_modes(b, 6, f, NULL));
    const double expected[6] = {0, 0, 0, sqrt(2 * T / m), sqrt(2 * T / m), sqrt(2 * k / m)};
    for (int i = 0; i < 6; i++) {
        char what[64];
        snprintf(what, sizeof what, "bead on taut lines: frequency %d, rad/s", i + 1);
        verify(what, two_pi * f[i], expected[i], i < 3 ? 1e-2 : 1e-7 * expected[i], "closed form");
    }
    spar_session_destroy(&s);
    verified();
}

/* A body of 5 kg, its centre 0.2 m beside its node; small enough to be linear. */
static void test_preloaded(void **state) {
    (void)state;
    static const char *const name[6] = {"x", "y", "z", "turn about x", "turn about y", "turn about z"};
    const double centre[3] = {0.2, 0, 0}, J[3] = {1, 1, 1}, g = 9.81, weight[6] = {0, 0, -5 * g, 0, 5 * g * 0.2, 0},
                 preload[6] = {3, -2, 4, 0.5, 0, -0.2};
    double K[36], mass[36], z[6];
    spar_session *s = scene_session();
    spar_member *b = NULL;
    scene_mass(mass, 5, centre, J);
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -g}));
    OK(s, spar_rigid_create(s, "body", zero, upright, mass, &b));
    OK(s, spar_member_commit(b));
    spar_joint *j = scene_joint(s, "spring", b, 0, NULL, 0, 63);
    scene_diagonal(K, 1e5, 2e5, 3e5, 4e7, 5e7, 6e7);
    OK(s, spar_joint_set_spring(j, K, NULL, preload));
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_joint_get_motion(j, z, NULL, NULL));
    for (int k = 0; k < 6; k++) {
        char what[64];
        double expected = (preload[k] + weight[k]) / K[7 * k];
        snprintf(what, sizeof what, "preloaded springs at rest: %s, m, rad", name[k]);
        verify(what, z[k], expected, 1e-6 * fabs(expected), "closed form");
    }
    spar_session_destroy(&s);
    verified();
}

VERIFICATION_MAIN("Assemblies", cmocka_unit_test(test_portal), cmocka_unit_test(test_two_spans),
                  cmocka_unit_test(test_foundation), cmocka_unit_test(test_hanging_parallelogram),
                  cmocka_unit_test(test_taut_lines), cmocka_unit_test(test_preloaded))
