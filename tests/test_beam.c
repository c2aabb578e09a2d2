/* A beam's line, frames, sections and elements: what the description becomes. */
#include "scene.h"

#include <float.h>

static const double pi = 3.14159265358979323846;
static double K[36], M[36];

/* x axis of the section at node i of qr */
static void axis_of(const double *q, int which, double a[3]) {
    double e[3] = {which == 0, which == 1, which == 2};
    spari_rotate(q, e, a);
}

/* A straight beam along x: nodes at Gauss-Lobatto points, sections level, y in the x-y plane: quaternion 1. */
static void test_straight_line(void **state) {
    (void)state;
    double x[9], q[12];
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, 3, 10, K, M);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_get_reference(b, x, q));
    for (int i = 0; i < 3; i++) {
        NEAR(x[3 * i], 5.0 * i, 1e-14);
        NEAR(x[3 * i + 1], 0, 1e-15);
        NEAR(q[4 * i], 1, 1e-15);
    }
    spar_session_destroy(&s);
}

/* Few points: the polynomial through them. A parabola from three points is met by every node of three elements. */
static void test_polynomial_axis_is_exact(void **state) {
    (void)state;
    const double eta[3] = {0, 0.5, 1}, xyz[9] = {0, 0, 0, 5, 1, -0.5, 10, 4, -2};
    double x[36], q[48];
    spar_session *s = scene_session();
    spar_member *b;
    OK(s, spar_beam_create(s, "b", 3, 4, &b));
    OK(s, spar_beam_set_axis(b, 3, eta, xyz, NULL));
    OK(s, spar_beam_set_sections(b, 1, eta, K, M));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_get_reference(b, x, q));
    for (int i = 0; i < 12; i++) {
        double u = x[3 * i] / 10, t[3] = {10, 8 * u, -4 * u}, n = spari_norm(t), a[3];
        NEAR(x[3 * i + 1], 4 * u * u, 1e-13);
        NEAR(x[3 * i + 2], -2 * u * u, 1e-13);
        axis_of(q + 4 * i, 0, a); /* the tangent */
        for (int c = 0; c < 3; c++) {
            NEAR(a[c], t[c] / n, 1e-13);
        }
        axis_of(q + 4 * i, 1, a); /* y level: unit(z x tangent) */
        NEAR(a[2], 0, 1e-14);
        assert_true(a[1] > 0);
    }
    spar_session_destroy(&s);
}

/* Many points of an arc: least squares with exact ends converges with the nodes; joints are where the arc is. */
static void test_least_squares_axis(void **state) {
    (void)state;
    enum { N = 81 };
    double eta[N], xyz[3 * N], twist[N];
    for (int i = 0; i < N; i++) {
        double a = 1.2 * i / (N - 1);
        eta[i] = (double)i / (N - 1);
        twist[i] = 0.3 * eta[i];
        xyz[3 * i] = 10 * sin(a), xyz[3 * i + 1] = 10 * (1 - cos(a)), xyz[3 * i + 2] = 0.5 * a;
    }
    for (int elements = 1; elements <= 4; elements += 3) {
        spar_session *s = scene_session();
        spar_member *b;
        OK(s, spar_beam_create(s, "b", elements, 8, &b));
        OK(s, spar_beam_set_axis(b, N, eta, xyz, twist));
        OK(s, spar_beam_set_sections(b, 1, eta, K, M));
        OK(s, spar_member_commit(b));
        double x[96], q[128], worst = 0;
        OK(s, spar_member_get_reference(b, x, q));
        for (int i = 0; i < 8 * elements; i++) {
            double a = x[3 * i + 2] / 0.5;
            worst = fmax(worst, fabs(x[3 * i] - 10 * sin(a)));
            worst = fmax(worst, fabs(x[3 * i + 1] - 10 * (1 - cos(a))));
        }
        assert_true(worst < 1e-6);
        for (int c = 0; c < 3; c++) {
            NEAR(x[c], xyz[c], 0); /* the ends exactly */
            NEAR(x[3 * (8 * elements - 1) + c], xyz[3 * (N - 1) + c], 0);
        }
        spar_session_destroy(&s);
    }
}

/* Twist is right-handed about the tangent, in radians. */
static void test_twist(void **state) {
    (void)state;
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 10, 0, 0}, twist[2] = {0.2, 0.8};
    double x[18], q[24], y[3];
    spar_session *s = scene_session();
    spar_member *b;
    OK(s, spar_beam_create(s, "b", 1, 6, &b));
    OK(s, spar_beam_set_axis(b, 2, eta, xyz, twist));
    OK(s, spar_beam_set_sections(b, 1, eta, K, M));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_get_reference(b, x, q));
    for (int i = 0; i < 6; i++) {
        double t = 0.2 + 0.06 * x[3 * i];
        axis_of(q + 4 * i, 1, y);
        NEAR(y[1], cos(t), 1e-14);
        NEAR(y[2], sin(t), 1e-14);
    }
    spar_session_destroy(&s);
}

/* A line along global z, and a quarter arc from x to z: sections are carried along without a jump. */
static void test_frames_near_the_vertical(void **state) {
    (void)state;
    enum { N = 40 };
    double eta[N], up[3 * N], arc[3 * N], q[40], y[3], before[3] = {0};
    for (int i = 0; i < N; i++) {
        double a = 0.5 * pi * i / (N - 1);
        eta[i] = (double)i / (N - 1);
        up[3 * i] = up[3 * i + 1] = 0, up[3 * i + 2] = 7 * eta[i];
        arc[3 * i] = sin(a), arc[3 * i + 1] = 0, arc[3 * i + 2] = 1 - cos(a);
    }
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_member *b;
        OK(s, spar_beam_create(s, "b", 1, 10, &b));
        OK(s, spar_beam_set_axis(b, N, eta, k ? arc : up, NULL));
        OK(s, spar_beam_set_sections(b, 1, eta, K, M));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_get_reference(b, NULL, q));
        for (int i = 0; i < 10; i++) {
            axis_of(q + 4 * i, 1, y);
            NEAR(y[1], 1, 1e-12); /* y stays global y in both */
            if (i > 0) {
                assert_true(spari_dot(y, before) > 0.99);
            }
            memcpy(before, y, sizeof y);
        }
        spar_session_destroy(&s);
    }
}

/* E elements of P nodes with the composite box's tip force: all converge to the same; a curved, twisted placement of
   two elements by set_nodes gives what the axis gives. */
static void test_elements_agree(void **state) {
    (void)state;
    const int E[4] = {1, 2, 4, 9}, P[4] = {15, 10, 8, 6};
    for (int k = 0; k < 4; k++) {
        double load[6] = {0, 0, 150, 0, 0, 0}, q[7];
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "b", E[k], P[k], 10, K, M);
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, E[k] * P[k] - 1, SPAR_LOAD_DEAD, load));
        OK(s, spar_member_solve_static(b, 1));
        scene_tip(b, q);
        NEAR(q[0], -0.0902726627566, 1e-10);
        NEAR(q[1], -0.0647488486259, 1e-10);
        NEAR(q[2], 1.2297364829237, 1e-10);
        spar_session_destroy(&s);
    }
}

static void test_nodes_given_agree_with_the_axis(void **state) {
    (void)state;
    const double eta[3] = {0, 0.5, 1}, xyz[9] = {0, 0, 0, 5, 1, -0.5, 10, 4, -2}, twist[3] = {0.1, 0.2, 0.3};
    double x[60], q[80], tip[2][7], load[6] = {10, -20, 50, 5, 0, 3};
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_member *b;
        OK(s, spar_beam_create(s, "b", 2, 10, &b));
        if (k) {
            OK(s, spar_beam_set_nodes(b, 20, x, q));
        } else {
            OK(s, spar_beam_set_axis(b, 3, eta, xyz, twist));
        }
        OK(s, spar_beam_set_sections(b, 1, eta, K, M));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_get_reference(b, x, q));
        OK(s, spar_member_set_load(b, 19, SPAR_LOAD_DEAD, load));
        OK(s, spar_member_solve_static(b, 1));
        scene_tip(b, tip[k]);
        spar_session_destroy(&s);
    }
    for (int i = 0; i < 7; i++) {
        NEAR(tip[1][i], tip[0][i], 1e-9);
    }
}

/* A right-angle frame: two legs of 10 as two elements of one beam, the elbow standing twice with two orientations.
   Linear theory for a small tip force F out of plane: leg 2 bends (F L^3 / 3 EI), leg 1 bends and twists (F L^3/3 EI +
   F L * L / GJ * L). GA, EA large. Tolerance: second order in the load. */
static void test_kink(void **state) {
    (void)state;
    double x[36], q[48], C[36],
        gll[6] = {-1, -0.765055323929465, -0.285231516480645, 0.285231516480645, 0.765055323929465, 1};
    double load[6] = {0, 0, 1e-4, 0, 0, 0}, tip[7], EI = 1e3, GJ = 700, L = 10, eta[1] = {0};
    for (int i = 0; i < 12; i++) {
        double along = 5 * (1 + gll[i % 6]), turn[3] = {0, 0, i < 6 ? 0 : 0.5 * pi};
        x[3 * i] = i < 6 ? along : L, x[3 * i + 1] = i < 6 ? 0 : along, x[3 * i + 2] = 0;
        spari_quat_exp(turn, q + 4 * i);
    }
    scene_diagonal(C, 1e9, 1e9, 1e9, GJ, EI, EI);
    spar_session *s = scene_session();
    spar_member *b;
    OK(s, spar_beam_create(s, "frame", 2, 6, &b));
    OK(s, spar_beam_set_nodes(b, 12, x, q));
    OK(s, spar_beam_set_sections(b, 1, eta, C, NULL));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 11, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(b, 1));
    scene_tip(b, tip);
    double w = 1e-4 * L * L * L * (2 / (3 * EI) + 1 / GJ);
    NEAR(tip[2], w, 1e-5 * w);
    x[18] += 0.5;
    spar_member *open;
    OK(s, spar_beam_create(s, "open", 2, 6, &open));
    assert_int_equal(spar_beam_set_nodes(open, 12, x, q), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_session_message(s), "two places"));
    spar_session_destroy(&s);
}

/* Section properties linear between stations: total mass by each quadrature rule, from the potential energy of a unit
   lift in unit gravity. Piecewise linear mass is integrated exactly by section intervals, whatever the stations. */
static void test_sections_are_interpolated(void **state) {
    (void)state;
    const double eta[4] = {0, 0.13, 0.6, 1}, m[4] = {4, 2, 3, 1};
    double Ks[4 * 36], Ms[4 * 36], total = 0, g[3] = {0, 0, -1}, line[2] = {0, 1}, xyz[6] = {0, 0, 0, 10, 0, 0};
    for (int i = 0; i < 4; i++) {
        memcpy(Ks + 36 * i, K, sizeof K);
        scene_diagonal(Ms + 36 * i, m[i], m[i], m[i], 0.1, 0.05, 0.05);
        total += i ? 5 * (eta[i] - eta[i - 1]) * (m[i] + m[i - 1]) : 0;
    }
    spar_session *s = scene_session();
    spar_member *b;
    OK(s, spar_session_set_gravity(s, g));
    OK(s, spar_beam_create(s, "b", 2, 5, &b));
    OK(s, spar_beam_set_axis(b, 2, line, xyz, NULL));
    OK(s, spar_beam_set_sections(b, 4, eta, Ks, Ms));
    OK(s, spar_beam_set_quadrature(b, SPAR_QUADRATURE_SECTIONS, 3));
    OK(s, spar_member_commit(b));
    double r[6];
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_member_get_reaction(b, r));
    NEAR(r[2], total, 1e-11 * total);
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_straight_line),
        cmocka_unit_test(test_polynomial_axis_is_exact),
        cmocka_unit_test(test_least_squares_axis),
        cmocka_unit_test(test_twist),
        cmocka_unit_test(test_frames_near_the_vertical),
        cmocka_unit_test(test_elements_agree),
        cmocka_unit_test(test_nodes_given_agree_with_the_axis),
        cmocka_unit_test(test_kink),
        cmocka_unit_test(test_sections_are_interpolated),
    };
    scene_box(K, M);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
