/* What must hold without any literature: the whole set-up turned and moved, the load brought on in one step or ten, the
   beam described from its other end, cut into elements; reactions balance loads; and a moment with a force at the tip
   (Mx, My) against ANSYS. Tolerances: rounding, and for the other mesh the spectral error. */
#include "verification.h"

static const double placed_x[3] = {3, -7, 11}, place_turn[3] = {0.9, -2.1, 1.4};

typedef struct bent {
    double q[7], reaction[6];
} bent;

/* The curved, twisted composite beam under a tip load, weight and a moment */
static bent bend(const double *p, int load_steps, int elements, int nodes) {
    enum { N = 40 };
    double K[36], M[36], load[6] = {30, -20, 90, 40, 25, -40}, eta[N], xyz[3 * N], twist[N];
    double g[3] = {100, 200, -900}, turned[6];
    bent out;
    const double none[4] = {1, 0, 0, 0};
    p = p ? p : none;
    for (int i = 0; i < N; i++) {
        double s = (double)i / (N - 1);
        eta[i] = s;
        xyz[3 * i] = 10 * s, xyz[3 * i + 1] = 2 * s * s, xyz[3 * i + 2] = -1.5 * s * s * s;
        twist[i] = 0.8 * s;
    }
    scene_box(K, M);
    spar_session *s = scene_session();
    spar_member *b;
    spari_rotate(p, g, g);
    OK(s, spar_session_set_gravity(s, g));
    OK(s, spar_beam_create(s, "bent", elements, nodes, &b));
    OK(s, spar_beam_set_axis(b, N, eta, xyz, twist));
    OK(s, spar_beam_set_sections(b, 1, eta, K, M));
    if (p != none) {
        OK(s, spar_member_set_placement(b, placed_x, p));
    }
    OK(s, spar_member_commit(b));
    spari_rotate(p, load, turned);
    spari_rotate(p, load + 3, turned + 3);
    OK(s, spar_member_set_load(b, elements * nodes - 1, SPAR_LOAD_DEAD, turned));
    OK(s, spar_member_solve_static(b, load_steps));
    scene_tip(b, out.q);
    OK(s, spar_member_get_reaction(b, out.reaction));
    spar_session_destroy(&s);
    return out;
}

static void test_invariance(void **state) {
    (void)state;
    double p[4], u[3], f[3], m[3];
    spari_quat_exp(place_turn, p);
    bent plain = bend(NULL, 1, 1, 16), moved = bend(p, 1, 1, 16), slow = bend(NULL, 10, 1, 16),
         cut = bend(NULL, 1, 3, 10);
    spari_rotate(p, plain.q, u);
    spari_rotate(p, plain.reaction, f);
    spari_rotate(p, plain.reaction + 3, m);
    verify_3("turned and moved: u", moved.q, u, 1e-11, "frame indifference");
    verify_3("turned and moved: root force", moved.reaction, f, 1e-8, "frame indifference, rounding of EA");
    verify_3("turned and moved: root moment", moved.reaction + 3, m, 1e-8, "frame indifference, rounding of EA");
    verify_3("ten load steps: u", slow.q, plain.q, 1e-10, "path independence");
    verify_3("three elements of 10 nodes: u", cut.q, plain.q, 1e-9, "spectral rate");
    verified();
}

/* The same beam described from its tip. Held there, with what the support gave now as the load at the other end, it has
   the same shape as seen from the tip: end at x_tip + R_tip^T (0 - x_tip), turned back by R_tip. Its section axes are
   turned by 180 degrees about y and its tangent against the other's, so that of the strains shear y and bending y
   change sign. */
static void test_other_end(void **state) {
    (void)state;
    double K[36], M[36], q[2][7], reaction[6], back[6], expected[3];
    const double load[6] = {5, 40, 90, 10, 20, -15}, sign[6] = {1, -1, 1, 1, -1, 1};
    const double half_turn[4] = {0, 0, 1, 0}, end[3] = {10, 0, 0};
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        scene_box(K, M);
        for (int i = 0; k == 1 && i < 36; i++) {
            K[i] *= sign[i / 6] * sign[i % 6];
        }
        spar_member *b = scene_beam(s, "box", 1, 14, 10, K, M);
        if (k == 1) {
            OK(s, spar_member_set_placement(b, end, half_turn));
        }
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, 13, SPAR_LOAD_DEAD, k == 0 ? load : back));
        OK(s, spar_member_solve_static(b, 1));
        scene_tip(b, q[k]);
        OK(s, spar_member_get_reaction(b, reaction));
        for (int i = 0; i < 6; i += 3) {
            spari_rotate_back(q[0] + 3, reaction + i, back + i);
        }
        spar_session_destroy(&s);
    }
    const double tip[3] = {10 + q[0][0], q[0][1], q[0][2]};
    spari_rotate_back(q[0] + 3, tip, expected);
    for (int i = 0; i < 3; i++) {
        expected[i] = end[i] - expected[i];
    }
    verify_3("from the other end: u", q[1], expected, 1e-10, "the same beam");
    for (int i = 0; i < 4; i++) {
        char what[64];
        snprintf(what, sizeof what, "from the other end: quaternion %c", "wxyz"[i]);
        verify(what, q[1][3 + i], i == 0 ? q[0][3] : -q[0][3 + i], 1e-10, "the same beam");
    }
    verified();
}

/* Nachbagauer et al.'s combined torque and moment: L 2, h 0.2, w 0.4, ANSYS to 5 digits */
static void test_torque_and_moment(void **state) {
    (void)state;
    double E = 2.07e11, nu = 0.3, h = 0.2, w = 0.4, A = h * w, G = E / 2 / (1 + nu), Iy = h * w * w * w / 12,
           Iz = w * h * h * h / 12, K[36], q[7];
    const double load[6] = {0, 0, 0, 0.5e6, 2e6, 0}, exudyn[3] = {-1.0943e-4, -1.8645e-4, -1.81174e-2},
                 ansys[3] = {-1.0939e-4, -1.8646e-4, -1.8117e-2};
    scene_diagonal(K, E * A, 0.8331 * G * A, 0.7961 * G * A, 0.5768 * G * (Iy + Iz), E * Iy, E * Iz);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "cantilever", 1, 10, 2, K, NULL);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 9, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(b, 1));
    scene_tip(b, q);
    verify_3("torque and moment: u", q, exudyn, 5e-8, "Exudyn, 5 digits");
    verify_3("torque and moment: u, ANSYS", q, ansys, 1e-3 * 1.9e-4 + 4e-7, "ANSYS");
    spar_session_destroy(&s);
    verified();
}

VERIFICATION_MAIN("Invariance", cmocka_unit_test(test_invariance), cmocka_unit_test(test_other_end),
                  cmocka_unit_test(test_torque_and_moment))
