/* Static equilibrium against closed forms and converged solutions of the exact beam equations. */
#include "scene.h"

#include <stdio.h>

static const double pi = 3.14159265358979323846;

/* A cantilever under a tip moment rolls up to an arc of radius EI/M: u1 = r sin(L/r) - L, u3 = r (1 - cos(L/r)) for any
   lambda = M L / (pi EI). 15 nodes, one load step. Tolerance: the interpolation error of 15 nodes, 1e-11 up to 216
   degrees, 1e-9 at a full circle. */
static void test_roll_up(void **state) {
    (void)state;
    const double lambda[] = {0.4, 0.8, 1.2, 1.6, 2.0}, tolerance[] = {1e-12, 1e-12, 1e-11, 1e-11, 1e-9};
    double K[36], L = 10, EI = 86.9e3;
    scene_diagonal(K, 1.77e6, 1.77e6, 1.77e6, 8.16e3, EI, 215e3);
    for (int k = 0; k < 5; k++) {
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "roll", 1, 15, L, K, NULL);
        double M = lambda[k] * pi * EI / L, load[6] = {0, 0, 0, 0, -M, 0}, q[7], r = EI / M, reaction[6];
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, 14, SPAR_LOAD_DEAD, load));
        OK(s, spar_member_solve_static(b, 1));
        scene_tip(b, q);
        NEAR(q[0], r * sin(L / r) - L, L * tolerance[k]);
        NEAR(q[2], r * (1 - cos(L / r)), L * tolerance[k]);
        OK(s, spar_member_get_reaction(b, reaction));
        NEAR(reaction[4], M, 1e-10 * M);
        spar_session_destroy(&s);
    }
}

/* The same full circle by 1 and by 10 load steps, and with two elements of 12 nodes: the answer does not depend on the
 * way there. */
static void test_roll_up_does_not_depend_on_the_way(void **state) {
    (void)state;
    double K[36], L = 10, EI = 86.9e3, M = 2 * pi * EI / L, load[6] = {0, 0, 0, 0, -M, 0}, q[2][7];
    scene_diagonal(K, 1.77e6, 1.77e6, 1.77e6, 8.16e3, EI, 215e3);
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "roll", 2, 12, L, K, NULL);
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, 23, SPAR_LOAD_DEAD, load));
        OK(s, spar_member_solve_static(b, k ? 10 : 1));
        scene_tip(b, q[k]);
        NEAR(q[k][0], -L, 1e-11 * L);
        spar_session_destroy(&s);
    }
    for (int i = 0; i < 3; i++) {
        NEAR(q[0][i], q[1][i], 1e-10);
    }
}

/* Wang et al. 2017, composite box, tip force 150: converged solution of the exact equations to 13 digits (BeamDyn and
   Kynema-FMB have the same); 15 nodes, 1e-11. The quaternion to its 12 digits; the root moment balances the force at
   the displaced tip. */
static void test_composite_box(void **state) {
    (void)state;
    double K[36], M[36], q[7], r[6], load[6] = {0, 0, 150, 0, 0, 0};
    const double u[3] = {-0.0902726627566, -0.0647488486259, 1.2297364829237};
    const double turn[4] = {0.9917434399258, 0.091773329785, -0.0895360363322, 0.0024297123826};
    spar_session *s = scene_session();
    scene_box(K, M);
    spar_member *b = scene_beam(s, "box", 1, 15, 10, K, M);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 14, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(b, 1));
    scene_tip(b, q);
    for (int i = 0; i < 3; i++) {
        NEAR(q[i], u[i], 1e-11);
    }
    for (int i = 0; i < 4; i++) {
        NEAR(q[3 + i], turn[i], 1e-12);
    }
    OK(s, spar_member_get_reaction(b, r));
    NEAR(r[2], -150, 1e-9);
    NEAR(r[3], -150 * q[1], 1e-8);       /* -(x cross f)_x = -y f_z */
    NEAR(r[4], 150 * (10 + q[0]), 1e-8); /* -(x cross f)_y = x f_z */
    spar_session_destroy(&s);
}

/* Bathe & Bolourchi's 45-degree bend, an arc of radius 100 in the x-y plane curving to -y, tip force 600 along z.
   Converged solution of the exact equations on the true arc (stiffness of the published decks); 15 nodes from 60 axis
   points, 1e-9 of the radius. */
static void test_bend_45(void **state) {
    (void)state;
    enum { N = 60 };
    double eta[N], xyz[3 * N], K[36], q[7], load[6] = {0, 0, 600, 0, 0, 0};
    const double u[3] = {-23.5612967857147, 13.6050230096446, 53.4761081402819};
    for (int i = 0; i < N; i++) {
        double a = pi / 4 * i / (N - 1);
        eta[i] = (double)i / (N - 1);
        xyz[3 * i] = 100 * sin(a), xyz[3 * i + 1] = -100 * (1 - cos(a)), xyz[3 * i + 2] = 0;
    }
    scene_diagonal(K, 1e7, 4.16667e6, 4.16667e6, 8.333e5, 8.333e5, 8.333e5);
    spar_session *s = scene_session();
    spar_member *b;
    OK(s, spar_beam_create(s, "bend", 1, 15, &b));
    OK(s, spar_beam_set_axis(b, N, eta, xyz, NULL));
    OK(s, spar_beam_set_sections(b, 1, eta, K, NULL));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 14, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(b, 1));
    scene_tip(b, q);
    for (int i = 0; i < 3; i++) {
        NEAR(q[i], u[i], 1e-7);
    }
    spar_session_destroy(&s);
}

/* Elastica: transverse dead tip load, lambda = P L^2 / EI; elliptic integrals (Bisshopp & Drucker 1945), 13 digits. EA
   = GA = 1e10 EI/L^2 stands for inextensible and shear-rigid (error 1e-10); 16 nodes, 1e-8. */
static void test_elastica(void **state) {
    (void)state;
    const double table[][4] = {{0.2, 0.06636448214483, 0.002646548340523, 0.0996361630374},
                               {1, 0.3017207737998, 0.05643323628338, 0.4613519497119},
                               {2, 0.4934574803967, 0.1606417208252, 0.7817498315565},
                               {4, 0.6699641812777, 0.3289412422468, 1.121239347488},
                               {6, 0.7445711488895, 0.4345888286819, 1.283697285801},
                               {10, 0.8106090248803, 0.5549955977538, 1.430285538804}};
    double K[36];
    scene_diagonal(K, 1e10, 1e10, 1e10, 1, 1, 1);
    for (size_t k = 0; k < sizeof table / sizeof *table; k++) {
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "elastica", 1, 18, 1, K, NULL);
        double load[6] = {0, 0, table[k][0], 0, 0, 0}, q[7];
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, 17, SPAR_LOAD_DEAD, load));
        OK(s, spar_member_solve_static(b, 4));
        scene_tip(b, q);
        NEAR(q[2], table[k][1], 1e-8);
        NEAR(-q[0], table[k][2], 1e-8);
        NEAR(-2 * atan2(q[5], q[3]), table[k][3], 1e-8);
        spar_session_destroy(&s);
    }
}

/* A member that nothing holds, no load steps, loads that no state can carry: each is refused with its reason and leaves
   the state; the member goes on working. */
static void test_refusals(void **state) {
    (void)state;
    double K[36], M[36], before[7], after[7], huge[6] = {0, 0, 1e30, 0, 0, 0};
    scene_box(K, M);
    spar_session *s = scene_session();
    spar_member *held = scene_beam(s, "held", 1, 6, 10, K, M), *loose = scene_beam(s, "loose", 1, 6, 10, K, M);
    OK(s, spar_member_set_root(loose, SPAR_ROOT_FREE));
    OK(s, spar_member_commit(held));
    OK(s, spar_member_commit(loose));
    assert_int_equal(spar_member_solve_static(loose, 1), SPAR_ERR_STATE);
    assert_int_equal(spar_member_solve_static(held, 0), SPAR_ERR_ARGUMENT);
    scene_tip(held, before);
    OK(s, spar_member_set_load(held, 5, SPAR_LOAD_DEAD, huge));
    assert_int_equal(spar_member_solve_static(held, 1), SPAR_ERR_NUMERIC);
    assert_non_null(strstr(spar_session_message(s), "held"));
    scene_tip(held, after);
    assert_memory_equal(before, after, sizeof before);
    double small[6] = {0, 0, 1, 0, 0, 0};
    OK(s, spar_member_set_load(held, 5, SPAR_LOAD_DEAD, small));
    OK(s, spar_member_solve_static(held, 1));
    spar_session_destroy(&s);
}

/* The whole set-up turned: displacements turn with it, to 1e-12 of the length; loads with couplings, placement by x and
 * q. */
static void test_placement_turns_the_answer(void **state) {
    (void)state;
    double K[36], M[36], q0[7], q1[7], load[6] = {30, -20, 150, 10, 5, -40}, turned[6];
    const double psi[3] = {0.9, -2.1, 1.4}, x[3] = {3, -7, 11}, g[3] = {1, 2, -9};
    double p[4], gt[3];
    spari_quat_exp(psi, p);
    scene_box(K, M);
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "box", 2, 8, 10, K, M);
        spari_rotate(p, g, gt);
        OK(s, spar_session_set_gravity(s, k ? gt : g));
        if (k) {
            OK(s, spar_member_set_placement(b, x, p));
        }
        spari_rotate(p, load, turned);
        spari_rotate(p, load + 3, turned + 3);
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, 15, SPAR_LOAD_DEAD, k ? turned : load));
        OK(s, spar_member_solve_static(b, 1));
        scene_tip(b, k ? q1 : q0);
        spar_session_destroy(&s);
    }
    double u[3], c[4], back[4];
    spari_rotate(p, q0, u);
    for (int i = 0; i < 3; i++) {
        NEAR(q1[i], u[i], 1e-11);
    }
    /* relative rotation in global axes: p r p* */
    spari_quat_conj(p, c);
    spari_quat_mul(p, q0 + 3, back);
    spari_quat_mul(back, c, back);
    for (int i = 0; i < 4; i++) {
        NEAR(q1[3 + i], back[i], 1e-12);
    }
}

/* A wheel on a torsion spring that its moment turns by 4e5 rad, of which a load step can find some 40: one load step is
   halved until that is so, and refused when it has taken 5000 more than were asked for; 10000 find it. */
static void work_is_bounded(void **state) {
    (void)state;
    const double J[3] = {1, 1, 1}, at[3] = {0, 0, 0}, turn = 4e5;
    double K[36], z[6];
    spar_session *s = scene_session();
    spar_member *wheel = scene_body(s, "wheel", at, 1, J);
    spar_joint *shaft = scene_joint(s, "shaft", wheel, 0, NULL, 0, SPAR_FREE_RY);
    scene_diagonal(K, 0, 0, 0, 0, 1, 0);
    OK(s, spar_joint_set_spring(shaft, K, NULL, NULL));
    OK(s, spar_joint_set_load(shaft, (double[]){0, 0, 0, 0, turn, 0}));
    REFUSED(s, SPAR_ERR_LIMIT, "budget of 100000 Newton iterations", spar_member_solve_static(wheel, 1));
    OK(s, spar_session_set_option(s, "newton.budget", "1000000"));
    REFUSED(s, SPAR_ERR_NUMERIC, "of the loads; use more load_steps", spar_member_solve_static(wheel, 1));
    REFUSED(s, SPAR_ERR_ARGUMENT, "100001 load steps; give 1 to 100000", spar_member_solve_static(wheel, 100001));
    REFUSED(s, SPAR_ERR_ARGUMENT, "0 load steps", spar_session_solve_static(s, 0, NULL, NULL, NULL));
    OK(s, spar_member_solve_static(wheel, 10000));
    OK(s, spar_joint_get_motion(shaft, z, NULL, NULL));
    NEAR(z[4], turn, 1e-6 * turn);
    spar_session_destroy(&s);
}

static char warned[1024];

static void hear(const spar_session *s, int level, const char *text, void *context) {
    (void)s, (void)context;
    if (level == SPAR_LOG_WARNING) {
        snprintf(warned, sizeof warned, "%s", text);
    }
}

static int roll(int nodes, double turns) {
    double K[36], load[6] = {0, 0, 0, 0, 0, 2 * 3.14159265358979323846 * turns * 100};
    scene_diagonal(K, 1e7, 1e7, 1e7, 100, 100, 100);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "roll", 1, nodes, 1, K, NULL);
    OK(s, spar_session_set_log(s, hear, NULL));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, nodes - 1, SPAR_LOAD_DEAD, load));
    warned[0] = '\0';
    int status = spar_member_solve_static(b, 20), blames = strstr(spar_session_message(s), "more nodes") != NULL;
    spar_session_destroy(&s);
    return status == SPAR_OK ? SPAR_OK : blames ? status : -1;
}

/* Rolled up tighter than its nodes can follow: where Newton fails it is the nodes that are blamed, and where it finds
   an equilibrium that is none of the beam (10 turns on 24 nodes) a log is warned; not for a circle. */
static void test_too_few_nodes_are_blamed(void **state) {
    (void)state;
    assert_int_equal(roll(10, 10), SPAR_ERR_NUMERIC);
    assert_int_equal(roll(24, 10), SPAR_OK);
    assert_non_null(strstr(warned, "'roll'"));
    assert_int_equal(roll(10, 1), SPAR_OK);
    assert_string_equal(warned, "");
}

/* A strip under an axial force of 1.25 times its buckling load, in its buckled, stable state. The same force again
   leaves this state, and a sideways force of 4 % moves the tip to the same place, in any number of load steps: the
   parts of the loads begin with those of the state (2e-9: Newton ends at 1e-9 rad). */
static void test_again_from_a_buckled_state(void **state) {
    (void)state;
    static const int steps[4] = {1, 2, 4, 12};
    const double length = 1.15, P = 1.25 * 4.0126 * sqrt(2.1 * 2.9) / (length * length);
    const double loads[3][6] = {{0, 0, -P}, {0, 0.04 * P, -P}, {0, -0.04 * P, -P}};
    double K[36], M[36], want[3] = {0}, q[7];
    scene_diagonal(K, 1e6, 1e6, 1e6, 2.9, 500, 2.1);
    scene_diagonal(M, 1.7, 1.7, 1.7, 3e-5, 3e-5, 3e-5);
    for (int k = 0; k < 12; k++) {
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "strip", 2, 8, length, K, M);
        double frequency;
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, 15, SPAR_LOAD_DEAD, loads[1]));
        OK(s, spar_member_solve_static(b, 12));
        OK(s, spar_member_set_load(b, 15, SPAR_LOAD_DEAD, loads[0]));
        OK(s, spar_member_solve_static(b, 1));
        OK(s, spar_member_solve_modes(b, 1, &frequency, NULL));
        assert_true(frequency > 0.4);
        scene_tip(b, q);
        want[0] = q[1];
        OK(s, spar_member_set_load(b, 15, SPAR_LOAD_DEAD, loads[k % 3]));
        OK(s, spar_member_solve_static(b, steps[k / 3]));
        scene_tip(b, q);
        want[k % 3] = k < 3 ? q[1] : want[k % 3];
        NEAR(q[1], want[k % 3], 2e-9);
        spar_session_destroy(&s);
    }
    assert_true(want[0] > 0.4 && want[1] > want[0] + 0.03 && want[2] < want[0] - 0.03);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_roll_up),
        cmocka_unit_test(test_roll_up_does_not_depend_on_the_way),
        cmocka_unit_test(test_composite_box),
        cmocka_unit_test(test_bend_45),
        cmocka_unit_test(test_elastica),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_placement_turns_the_answer),
        cmocka_unit_test(work_is_bounded),
        cmocka_unit_test(test_too_few_nodes_are_blamed),
        cmocka_unit_test(test_again_from_a_buckled_state),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
