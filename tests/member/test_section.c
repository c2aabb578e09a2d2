/* Strains and section forces along a beam. */
#include "scene.h"

#include <gsl/gsl_integration.h>

static const double pi = 3.14159265358979323846;

/* A pure moment bends to an arc: curvature M/EI everywhere, section moment M everywhere, no other strain, place and
   orientation those of the arc of radius EI/M. 15 nodes, 0.8 pi of turn: the interpolation error, 1e-9. */
static void test_arc(void **state) {
    (void)state;
    const double L = 10, EI = 86.9e3, M = 0.8 * pi * EI / L, load[6] = {0, 0, 0, 0, -M, 0}, r = EI / M;
    const double eta[5] = {0, 0.2, 0.5, 0.77, 1};
    double K[36], strain[30], force[30], x[15], q[20];
    scene_diagonal(K, 1.77e6, 1.77e6, 1.77e6, 8.16e3, EI, 215e3);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, 15, L, K, NULL);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 14, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_beam_evaluate(b, 5, eta, strain, force, x, q));
    for (int i = 0; i < 5; i++) {
        for (int k = 0; k < 6; k++) {
            NEAR(strain[6 * i + k], k == 4 ? -1 / r : 0, 1e-8);
            NEAR(force[6 * i + k], k == 4 ? -M : 0, 1e-7 * M);
        }
        double angle = eta[i] * L / r;
        NEAR(x[3 * i], r * sin(angle), 1e-9 * L);
        NEAR(x[3 * i + 2], r * (1 - cos(angle)), 1e-9 * L);
        NEAR(q[4 * i], cos(0.5 * angle), 1e-9);
        NEAR(q[4 * i + 2], -sin(0.5 * angle), 1e-9);
    }
    spar_session_destroy(&s);
}

/* What the part beyond gives a section: force F everywhere, moment (tip - x) x F, in the axes of the section. Bathe's
   45-degree bend with coupled, twisted sections, one element of 14 nodes: constitutive forces converge, here to 1e-8 of
   F and F L; the reaction is the load's to rounding of the stiffness, 1e-10 of it. A section's axes: orientation times
   (x, y, z). */
static void test_balance(void **state) {
    (void)state;
    double K[36], M[36], xyz[3 * 40], eta[40], twist[40], F[6] = {20, 30, 60, 5, 3, 2};
    spar_session *s = scene_session();
    spar_member *b = NULL;
    scene_box(K, M);
    for (int i = 0; i < 40; i++) {
        double a = pi / 4 * i / 39;
        eta[i] = i / 39.0;
        twist[i] = 0.6 * eta[i];
        xyz[3 * i] = 10 * sin(a), xyz[3 * i + 1] = -10 * (1 - cos(a)), xyz[3 * i + 2] = 0;
    }
    OK(s, spar_beam_create(s, "b", 1, 14, &b));
    OK(s, spar_beam_set_axis(b, 40, eta, xyz, twist));
    OK(s, spar_beam_set_sections(b, 1, eta, K, M));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 13, SPAR_LOAD_DEAD, F));
    OK(s, spar_member_solve_static(b, 1));
    double force[6 * 40], x[3 * 40], q[4 * 40], r[6];
    OK(s, spar_beam_evaluate(b, 40, eta, NULL, force, x, q));
    OK(s, spar_member_get_reaction(b, r));
    for (int i = 0; i < 40; i++) {
        double arm[3], m[3];
        for (int k = 0; k < 3; k++) {
            arm[k] = x[3 * 39 + k] - x[3 * i + k];
        }
        spari_cross(arm, F, m);
        spari_rotate(q + 4 * i, force + 6 * i, force + 6 * i);
        spari_rotate(q + 4 * i, force + 6 * i + 3, force + 6 * i + 3);
        for (int k = 0; k < 3; k++) {
            NEAR(force[6 * i + k], F[k], 1e-8 * 70);
            NEAR(force[6 * i + 3 + k], m[k] + F[3 + k], 1e-8 * 700);
        }
    }
    for (int k = 0; k < 6; k++) {
        NEAR(r[k], -force[k], 1e-8 * 700);
        NEAR(r[k], k < 3 ? -F[k] : r[k], 1e-10 * 1.4e6);
    }
    spar_session_destroy(&s);
}

/* With P - 1 Gauss points in a straight element the section forces there are the loads beyond to rounding, however
   coarse the element: P - 1 equations sum w phi_l' n = 0 for P - 1 values. */
static void test_balance_at_gauss_points(void **state) {
    (void)state;
    enum { P = 4 };
    double K[36], M[36], eta[P - 1], q[4 * (P - 1)], force[6 * (P - 1)], F[6] = {20, 30, 60, 0, 0, 0};
    scene_box(K, M);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, P, 10, K, M);
    gsl_integration_glfixed_table *gauss = gsl_integration_glfixed_table_alloc(P - 1);
    for (int i = 0; i < P - 1; i++) {
        double w;
        gsl_integration_glfixed_point(0, 1, (size_t)i, &eta[i], &w, gauss);
    }
    gsl_integration_glfixed_table_free(gauss);
    OK(s, spar_beam_set_quadrature(b, SPAR_QUADRATURE_GAUSS, P - 1));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, P - 1, SPAR_LOAD_DEAD, F));
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_beam_evaluate(b, P - 1, eta, NULL, force, NULL, q));
    for (int i = 0; i < P - 1; i++) {
        spari_rotate(q + 4 * i, force + 6 * i, force + 6 * i);
        for (int k = 0; k < 3; k++) {
            NEAR(force[6 * i + k], F[k], 1e-9);
        }
    }
    spar_session_destroy(&s);
}

/* A linear member: the section moment of a cantilever under a tip force is F (L - s), its curvature that over EI;
   4 nodes hold the cubic exactly. 1e-9 of F L. */
static void test_linear(void **state) {
    (void)state;
    const double L = 3, EI = 50, eta[3] = {0, 0.4, 1}, F[6] = {0, 0, 7, 0, 0, 0};
    double K[36], strain[18], force[18];
    scene_diagonal(K, 1e4, 1e4, 1e4, EI, EI, EI);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, 4, L, K, NULL);
    OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_LINEAR, 0));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 3, SPAR_LOAD_DEAD, F));
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_beam_evaluate(b, 3, eta, strain, force, NULL, NULL));
    for (int i = 0; i < 3; i++) {
        NEAR(force[6 * i + 4], -F[2] * L * (1 - eta[i]), 1e-9 * F[2] * L);
        NEAR(strain[6 * i + 4], -F[2] * L * (1 - eta[i]) / EI, 1e-9);
        NEAR(strain[6 * i + 2], F[2] / 1e4, 1e-9);
    }
    spar_session_destroy(&s);
}

/* Damping's part: a stretching beam carries EA (e + mu e-dot). An element of 8 nodes pulled at its tip: the
   force at the section, less the stiffness times the strain, is mu EA times the rate of strain seen between two steps;
   order dt^2, 1e-3 of it. */
static void test_damping(void **state) {
    (void)state;
    const double L = 1, EA = 100, mu[6] = {0.05, 0, 0, 0, 0, 0}, eta[1] = {0.5}, F[6] = {10, 0, 0, 0, 0, 0}, h = 1e-3;
    double K[36], M[36], strain[3][6], force[3][6];
    scene_diagonal(K, EA, 1e3, 1e3, 10, 10, 10);
    scene_diagonal(M, 1, 1, 1, 1, 1, 1);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, 8, L, K, M);
    OK(s, spar_beam_set_damping(b, mu));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 7, SPAR_LOAD_DEAD, F));
    scene_run(s, h, 60);
    for (int i = 0; i < 3; i++) {
        scene_run(s, h, 1);
        OK(s, spar_beam_evaluate(b, 1, eta, strain[i], force[i], NULL, NULL));
    }
    double rate = (strain[2][0] - strain[0][0]) / (2 * h);
    assert_true(fabs(mu[0] * EA * rate) > 1e-2);
    NEAR(force[1][0] - EA * strain[1][0], mu[0] * EA * rate, 1e-3 * fabs(mu[0] * EA * rate));
    spar_session_destroy(&s);
}

static void test_refusals(void **state) {
    (void)state;
    double K[36], out[6];
    const double eta[1] = {1.5};
    scene_diagonal(K, 1, 1, 1, 1, 1, 1);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, 2, 1, K, NULL);
    assert_int_equal(spar_beam_evaluate(NULL, 1, eta, out, NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_evaluate(b, 1, eta, out, NULL, NULL, NULL), SPAR_ERR_STATE);
    OK(s, spar_member_commit(b));
    assert_int_equal(spar_beam_evaluate(b, 1, eta, out, NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_evaluate(b, 1, NULL, out, NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
    OK(s, spar_beam_evaluate(b, 0, NULL, NULL, NULL, NULL, NULL));
    spar_session_destroy(&s);
}

/* A cantilever of 2 m that a force at its tip bends far: the force at the root is that force, whatever the nodes. By
   the strains it was off by 82 N along and 14 N across with 6 nodes, 0.9 and 0.4 N with 8. */
static void test_root_of_cantilever(void **state) {
    (void)state;
    const double load[6] = {1, 3, 7, 0, 0, 0}, root = 0;
    double K[36];
    scene_diagonal(K, 1e6, 4e5, 4e5, 40, 20, 30);
    for (int nodes = 4; nodes <= 12; nodes += 2) {
        double force[6], reaction[6], tip[7];
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "b", 1, nodes, 2, K, NULL);
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, nodes - 1, SPAR_LOAD_DEAD, load));
        OK(s, spar_member_solve_static(b, 4));
        OK(s, spar_beam_evaluate(b, 1, &root, NULL, force, NULL, NULL));
        OK(s, spar_member_get_reaction(b, reaction));
        scene_tip(b, tip);
        const double arm[3] = {2 + tip[0], tip[1], tip[2]};
        double moment[3];
        spari_cross(arm, load, moment);
        assert_true(tip[2] > 0.4);
        for (int k = 0; k < 3; k++) {
            NEAR(force[k], load[k], 1e-12);
            NEAR(force[3 + k], moment[k], 1e-12);
            NEAR(force[k], -reaction[k], 1e-8);
            NEAR(force[3 + k], -reaction[3 + k], 1e-8);
        }
        spar_session_destroy(&s);
    }
}

enum { PLACES = 5 };

/* What the support gives the root, in the axes of the section there. */
static void reaction_in_section(spar_session *s, spar_member *b, double reaction[6]) {
    double q[7 * 64], q0[4 * 64], now[4];
    OK(s, spar_member_get_reaction(b, reaction));
    OK(s, spar_member_get_reference(b, NULL, q0));
    OK(s, spar_member_get_motion(b, q, NULL, NULL));
    spari_quat_mul(q + 3, q0, now);
    for (int k = 0; k < 6; k += 3) {
        spari_rotate_back(now, reaction + k, reaction + k);
    }
}

/* A curved, twisted beam that swings under all there is: weight, dead and follower loads along it and at a node, point
   masses, springs to the ground, damping of both kinds. Section forces at PLACES, by balance and by strains; the
   reaction. */
static void swing_beam(int fidelity, int root, int nodes, double by_balance[6 * PLACES], double by_strains[6 * PLACES],
                       double reaction[6]) {
    static const double eta[PLACES] = {0, 0.13, 0.31, 0.5, 0.83}, ends[2] = {0, 1}, at[2] = {0.25, 0.75};
    const double line[12] = {0, 3, 8, 0.2, 0.1, 0, 1, 5, -3, 0, 0.3, 0.1},
                 follow[12] = {0, 2, 1, 0, 0, 0, 0, 1, 2, 0, 0, 0}, bed[6] = {20, 30, 40, 20, 30, 40},
                 g[3] = {0.5, 0, -9.81}, tip[6] = {2, 1, 4, 0.1, 0.2, 0.3}, mid[6] = {0, 1, 2, 0, 0, 0},
                 mu[6] = {1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3};
    const double axis[3] = {0, 0.5, 1}, xyz[9] = {0, 0, 0, 1.5, 0.1, 0.2, 3, 0.5, 0.3}, twist[3] = {0, 0.1, 0.2};
    const double centre[3] = {0, 0.02, -0.01}, J[3] = {0.02, 0.01, 0.01};
    double K[36], M[36], lump[72], strain[6 * PLACES];
    spar_session *s = scene_session();
    spar_member *b = NULL;
    scene_diagonal(K, 3e4, 2e4, 2e4, 300, 400, 500);
    K[6 * 3 + 4] = K[6 * 4 + 3] = 60;
    scene_mass(M, 0.8, centre, J);
    scene_mass(lump, 0.4, centre, J);
    scene_mass(lump + 36, 0.3, centre, J);
    OK(s, spar_session_set_gravity(s, g));
    OK(s, spar_beam_create(s, "b", 2, nodes, &b));
    OK(s, spar_beam_set_axis(b, 3, axis, xyz, twist));
    OK(s, spar_beam_set_sections(b, 1, ends, K, M));
    OK(s, spar_beam_set_damping(b, mu));
    OK(s, spar_beam_set_mass_damping(b, 0.3));
    OK(s, spar_beam_set_masses(b, 2, at, lump));
    if (root == SPAR_ROOT_FIXED) {
        OK(s, spar_beam_set_foundation(b, 2, ends, bed));
    }
    OK(s, spar_member_set_root(b, root));
    OK(s, spar_member_set_fidelity(b, fidelity, fidelity == SPAR_FIDELITY_MODAL ? 12 : 0));
    OK(s, spar_member_commit(b));
    OK(s, spar_beam_set_line_load(b, SPAR_LOAD_DEAD, 2, ends, line));
    OK(s, spar_beam_set_line_load(b, SPAR_LOAD_FOLLOWER, 2, ends, follow));
    OK(s, spar_member_set_load(b, 2 * nodes - 1, SPAR_LOAD_DEAD, tip));
    OK(s, spar_member_set_load(b, nodes, SPAR_LOAD_FOLLOWER, mid));
    for (int k = 1; k <= 40; k++) {
        const double w = 0.01 * k, q[7] = {0, 0, 0.05 * w, cos(w / 4), 0, sin(w / 4), 0},
                     v[6] = {0, 0, 0.05, 0, 0.5, 0}, a[6] = {0};
        if (root == SPAR_ROOT_DRIVEN) {
            OK(s, spar_member_drive(b, q, v, a));
        }
        scene_run(s, 0.01, 1);
    }
    OK(s, spar_beam_evaluate(b, PLACES, eta, strain, by_balance, NULL, NULL));
    for (int i = 0; i < 6 * PLACES; i++) {
        by_strains[i] = 0;
        for (int j = 0; j < 6; j++) {
            by_strains[i] += K[6 * (i % 6) + j] * strain[6 * (i / 6) + j];
        }
    }
    reaction_in_section(s, b, reaction);
    spar_session_destroy(&s);
}

/* Whatever acts on it and however it is solved, the section at the root carries the reaction; and within, with few
   nodes the forces are 20 times nearer to those of many nodes than the stiffness times the strains. */
static void test_balance_of_all_loads(void **state) {
    (void)state;
    const int fidelity[] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL};
    for (int k = 0; k < 6; k++) {
        const int root = k < 3 ? SPAR_ROOT_FIXED : SPAR_ROOT_DRIVEN;
        double fine[6 * PLACES], few[6 * PLACES], strains[6 * PLACES], of_few[6 * PLACES], reaction[6], off[2] = {0};
        swing_beam(fidelity[k % 3], root, 5, few, of_few, reaction);
        for (int i = 0; i < 6; i++) {
            NEAR(few[i], -reaction[i], 1e-9);
        }
        swing_beam(fidelity[k % 3], root, 10, fine, strains, reaction);
        for (int i = 0; i < 6 * PLACES; i++) {
            off[0] = fmax(off[0], fabs(few[i] - fine[i]));
            off[1] = fmax(off[1], fabs(of_few[i] - fine[i]));
        }
        assert_true(off[0] < 0.1 && off[0] < 0.05 * off[1]); /* N, N m, of up to 30 */
    }
}

/* The same with 4, 5 and 6 nodes an element, of forces up to 30 N: two nodes more bring all of them ten times nearer to
   those of many, as the motion. */
static void test_order_of_forces(void **state) {
    (void)state;
    double fine[6 * PLACES], few[6 * PLACES], strains[6 * PLACES], reaction[6], off[3] = {0};
    swing_beam(SPAR_FIDELITY_EXACT, SPAR_ROOT_FIXED, 12, fine, strains, reaction);
    for (int k = 0; k < 3; k++) {
        swing_beam(SPAR_FIDELITY_EXACT, SPAR_ROOT_FIXED, 4 + k, few, strains, reaction);
        for (int i = 0; i < 6 * PLACES; i++) {
            off[k] = fmax(off[k], fabs(few[i] - fine[i]));
        }
    }
    assert_true(off[1] < 0.2 * off[0] && off[2] < 0.1 * off[0] && off[2] < 0.03);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_arc),
        cmocka_unit_test(test_balance),
        cmocka_unit_test(test_balance_at_gauss_points),
        cmocka_unit_test(test_linear),
        cmocka_unit_test(test_damping),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_root_of_cantilever),
        cmocka_unit_test(test_balance_of_all_loads),
        cmocka_unit_test(test_order_of_forces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
