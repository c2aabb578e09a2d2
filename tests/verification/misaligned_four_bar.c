/* Bauchau's four-bar with a misaligned hinge (Bauchau 1998; Bauchau, Betsch, Cardona et al., Multibody System Dynamics
   37 (2016)): steel bars AB 0.12 m, BC 0.24 m (16 x 16 mm), CD 0.12 m (8 x 8 mm) on hinges across their plane, of
   which that at C leans by 5 degrees; the crank AB turns at -0.6 rad/s. Were the bars rigid it would lock: they bend
   out of their plane, go through both dead points and come back crossed. Inertia is next to nothing.
   - The hinge leaning along CD, 12 s: place of C as V. Sonneville's code for elements on SE(3) has it (mb_sef_py,
   github.com/vspsonn/mb_sef_py, examples/beam_fourbar: 8 elements a bar, 4 ms, rho_inf 0; its stored result). In the
   plane 2e-5 m; across 1.5e-5 m of 4.1e-3, what two nodes an element leave.
   - Leaning by half a degree, along BC or CD, before the first dead point: linear theory. Across the plane the rigid
   pose is a frame clamped at A and D with a dislocation at C, CD turned against BC by delta = e (n - R n), n the axis
   that the hinge leans about and R the turn of CD: (F_L + F_R) (F, M_x, M_y) = -(0, delta), F_L and F_R what the bars
   from A and from D give way at C by; the torque at the crank is what the energy rises by with its angle. 3e-4.
   - Not leaning: the rigid parallelogram, C = D + R CD; 1e-8 m. */
#include "verification.h"

enum { P = 8 };

static const double crank = 0.12, coupler = 0.24, speed = -0.6, straight[4] = {1, 0, 0, 0};
static const double thick[6] = {52.99e6, 16.88e6, 16.88e6, 733.5, 1131, 1131}, thick_m = 1.997, thick_j = 42.6e-6,
                    thin[6] = {13.25e6, 4.22e6, 4.22e6, 45.84, 70.66, 70.66}, thin_m = 0.4992, thin_j = 2.662e-6;

typedef struct four_bar {
    spar_session *s;
    spar_member *bar[3];
    spar_joint *hinge[4];
    double t;
} four_bar;

static spar_member *make_bar(spar_session *s, const char *name, const double *from, const double *to, const double *k,
                             double m, double j) {
    const double eta[2] = {0, 1}, line[6] = {from[0], from[1], from[2], to[0], to[1], to[2]};
    double K[36], M[36];
    spar_member *b = NULL;
    scene_diagonal(K, k[0], k[1], k[2], k[3], k[4], k[5]);
    scene_diagonal(M, m, m, m, 2 * j, j, j);
    OK(s, spar_beam_create(s, name, 1, P, &b));
    OK(s, spar_beam_set_axis(b, 2, eta, line, NULL));
    OK(s, spar_beam_set_sections(b, 1, eta, K, M));
    OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
    OK(s, spar_member_commit(b));
    return b;
}

/* The hinge at C leans by so much (rad) about n, an axis of the plane; all turn along as rigid ones would. */
static four_bar four_bar_create(double lean, const double n[2]) {
    const double x[4][3] = {{0, 0, 0}, {0, crank, 0}, {coupler, crank, 0}, {coupler, 0, 0}},
                 tilt[4] = {cos(lean / 2), n[0] * sin(lean / 2), n[1] * sin(lean / 2), 0}, turn[3] = {0, 0, speed},
                 way[3] = {-speed * crank, 0, 0};
    four_bar f = {.s = scene_session()};
    OK(f.s, spar_session_set_integrator(f.s, 0, 1));
    f.bar[0] = make_bar(f.s, "AB", x[0], x[1], thick, thick_m, thick_j);
    f.bar[1] = make_bar(f.s, "BC", x[1], x[2], thick, thick_m, thick_j);
    f.bar[2] = make_bar(f.s, "CD", x[2], x[3], thin, thin_m, thin_j);
    OK(f.s, spar_joint_create(f.s, "A", f.bar[0], 0, NULL, 0, SPAR_FREE_RZ, &f.hinge[0]));
    OK(f.s, spar_joint_create(f.s, "B", f.bar[1], 0, f.bar[0], P - 1, SPAR_FREE_RZ, &f.hinge[1]));
    OK(f.s, spar_joint_create(f.s, "C", f.bar[2], 0, f.bar[1], P - 1, SPAR_FREE_RZ, &f.hinge[2]));
    OK(f.s, spar_joint_create(f.s, "D", f.bar[2], P - 1, NULL, 0, SPAR_FREE_RZ, &f.hinge[3]));
    for (int k = 0; k < 4; k++) {
        OK(f.s, spar_joint_set_frame(f.hinge[k], x[k], k == 2 ? tilt : straight));
    }
    OK(f.s, spar_joint_set_driven(f.hinge[0], SPAR_FREE_RZ));
    OK(f.s, spar_member_set_initial_velocity(f.bar[0], x[0], NULL, turn));
    OK(f.s, spar_member_set_initial_velocity(f.bar[1], x[1], way, NULL));
    OK(f.s, spar_member_set_initial_velocity(f.bar[2], x[3], NULL, turn));
    return f;
}

/* To time t, and what C has moved by then. */
static void go_on(four_bar *f, double dt, double t, double moved[3]) {
    double q[7 * P];
    while (f->t < t - dt / 2) {
        f->t += dt;
        OK(f->s, spar_joint_drive(f->hinge[0], (double[]){0, 0, 0, 0, 0, speed * f->t},
                                  (double[]){0, 0, 0, 0, 0, speed}, NULL));
        OK(f->s, spar_step(f->s, dt, NULL, NULL, NULL));
    }
    OK(f->s, spar_member_get_motion(f->bar[1], q, NULL, NULL));
    memcpy(moved, q + 7 * (P - 1), 3 * sizeof *moved);
}

/* ---- another code ---- */

static void test_published(void **state) {
    (void)state;
    static const double table[][4] = {
        {0.6, 0.04226808, -0.00769067, -0.00014469},  {1.2, 0.07911529, -0.02978052, -0.00087408},
        {1.8, 0.10581647, -0.06347232, -0.00215367},  {2.4, 0.11894704, -0.10485851, -0.00374325},
        {3.0, 0.09446813, -0.04612209, -0.00333500},  {4.2, -0.04891159, -0.01042245, -0.00050216},
        {6.0, -0.11011721, -0.07231440, -0.00051685}, {7.2, -0.11893570, -0.10427645, -0.00231889},
        {8.4, -0.11362959, -0.08153544, -0.00258701}, {9.6, -0.05995293, -0.01605234, -0.00068852},
        {12, 0.09522535, -0.04700387, -0.00151420}};
    static const double tolerance[3] = {2e-5, 2e-5, 1.5e-5}, along_rocker[2] = {1, 0};
    four_bar f = four_bar_create(5 * acos(-1) / 180, along_rocker);
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        double moved[3];
        go_on(&f, 4e-3, table[i][0], moved);
        for (int k = 0; k < 3; k++) {
            char what[64];
            snprintf(what, sizeof what, "four-bar at %.1f s: C moved along %c, m", table[i][0], "xyz"[k]);
            verify(what, moved[k], table[i][1 + k], tolerance[k], "mb_sef_py, 8 elements");
        }
    }
    spar_session_destroy(&f.s);
    verified();
}

/* ---- linear theory ---- */

/* Adds what the end `at` of a clamped row of bars gives way by under (F_z, M_x, M_y) there, of the bar from x to y. */
static void add_bar(const double *k, const double x[2], const double y[2], const double at[2], double F[3][3]) {
    const double weight[3] = {1. / 6, 4. / 6, 1. / 6}, L = hypot(y[0] - x[0], y[1] - x[1]),
                 t[2] = {(y[0] - x[0]) / L, (y[1] - x[1]) / L};
    for (int p = 0; p < 3; p++) { /* Simpson's rule: moments are linear along the bar */
        double arm[2] = {at[0] - x[0] - 0.5 * p * (y[0] - x[0]), at[1] - x[1] - 0.5 * p * (y[1] - x[1])};
        double moment[3][2] = {{arm[1], -arm[0]}, {1, 0}, {0, 1}};
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) {
                double twist =
                           (moment[i][0] * t[0] + moment[i][1] * t[1]) * (moment[j][0] * t[0] + moment[j][1] * t[1]),
                       bend = (moment[i][1] * t[0] - moment[i][0] * t[1]) * (moment[j][1] * t[0] - moment[j][0] * t[1]);
                F[i][j] += weight[p] * L * (twist / k[3] + bend / k[4] + (i == 0 && j == 0 ? 1 / k[2] : 0));
            }
        }
    }
}

/* x := A^-1 x by Cramer's rule */
static void solve(double A[3][3], double x[3]) {
    double c[3][3], y[3] = {x[0], x[1], x[2]}, det = 0;
    for (int i = 0; i < 3; i++) { /* columns of the inverse, but for the determinant */
        const double *u = A[(i + 1) % 3], *v = A[(i + 2) % 3];
        c[i][0] = u[1] * v[2] - u[2] * v[1];
        c[i][1] = u[2] * v[0] - u[0] * v[2];
        c[i][2] = u[0] * v[1] - u[1] * v[0];
    }
    for (int k = 0; k < 3; k++) {
        det += A[0][k] * c[0][k];
    }
    for (int k = 0; k < 3; k++) {
        x[k] = (c[0][k] * y[0] + c[1][k] * y[1] + c[2][k] * y[2]) / det;
    }
}

/* At the crank's angle: way of C across the plane; force and moments of the ground at A; the energy. */
static double dislocated(double angle, double lean, const double n[2], double figure[4]) {
    const double co = cos(angle), si = sin(angle), A[2] = {0, 0}, D[2] = {coupler, 0}, B[2] = {-crank * si, crank * co},
                 C[2] = {B[0] + coupler, B[1]};
    double left[3][3] = {{0}}, both[3][3],
           gap[3] = {0, -lean * (n[0] - co * n[0] + si * n[1]), -lean * (n[1] - si * n[0] - co * n[1])}, load[3];
    add_bar(thick, A, B, C, left);
    add_bar(thick, B, C, C, left);
    memcpy(both, left, sizeof both);
    add_bar(thin, D, C, C, both);
    memcpy(load, gap, sizeof load);
    solve(both, load);
    figure[0] = left[0][0] * load[0] + left[0][1] * load[1] + left[0][2] * load[2];
    figure[1] = -load[0];
    figure[2] = -(load[1] + C[1] * load[0]);
    figure[3] = -(load[2] - C[0] * load[0]);
    return 0.5 * (gap[0] * load[0] + gap[1] * load[1] + gap[2] * load[2]);
}

static void test_linear(void **state) {
    (void)state;
    static const double axis[2][2] = {{0, 1}, {1, 0}};
    static const char *const leaning[2] = {"BC", "CD"}, *const name[5] = {"C across, m", "force at A, N",
                                                                          "moment x at A, N m", "moment y at A, N m",
                                                                          "torque, N m"};
    const double lean = 0.5 * acos(-1) / 180, h = 1e-4;
    for (int way = 0; way < 2; way++) {
        four_bar f = four_bar_create(lean, axis[way]);
        for (int i = 1; i <= 3; i++) {
            double angle = speed * 0.7 * i, moved[3], load[6], expected[5], room[4];
            go_on(&f, 4e-3, 0.7 * i, moved);
            OK(f.s, spar_joint_get_load(f.hinge[0], load));
            (void)dislocated(angle, lean, axis[way], expected);
            expected[4] =
                (dislocated(angle + h, lean, axis[way], room) - dislocated(angle - h, lean, axis[way], room)) / (2 * h);
            const double got[5] = {moved[2], load[2], load[3], load[4], load[5]};
            for (int k = 0; k < 5; k++) {
                char what[96];
                snprintf(what, sizeof what, "leaning along %s, crank at %.2f: %s", leaning[way], angle, name[k]);
                verify(what, got[k], expected[k], 3e-4 * fabs(expected[k]), "linear theory");
            }
        }
        spar_session_destroy(&f.s);
    }
    verified();
}

static void test_aligned(void **state) {
    (void)state;
    static const double axis[2] = {1, 0};
    four_bar f = four_bar_create(0, axis);
    for (int i = 1; i <= 3; i++) {
        double t = 0.7 * i, moved[3], angle = speed * t,
               expected[3] = {-crank * sin(angle), crank * (cos(angle) - 1), 0};
        char what[64];
        go_on(&f, 4e-3, t, moved);
        snprintf(what, sizeof what, "aligned, crank at %.2f: C", angle);
        verify_3(what, moved, expected, 1e-8, "rigid");
    }
    spar_session_destroy(&f.s);
    verified();
}

VERIFICATION_MAIN("Four-bar with a misaligned hinge", cmocka_unit_test(test_published), cmocka_unit_test(test_linear),
                  cmocka_unit_test(test_aligned))
