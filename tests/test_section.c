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
    OK(s, spar_beam_get_section(b, 5, eta, strain, force, x, q));
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
    OK(s, spar_beam_get_section(b, 40, eta, NULL, force, x, q));
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
    OK(s, spar_beam_get_section(b, P - 1, eta, NULL, force, NULL, q));
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
    OK(s, spar_member_set_effects(b, 0));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 3, SPAR_LOAD_DEAD, F));
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_beam_get_section(b, 3, eta, strain, force, NULL, NULL));
    for (int i = 0; i < 3; i++) {
        NEAR(force[6 * i + 4], -F[2] * L * (1 - eta[i]), 1e-9 * F[2] * L);
        NEAR(strain[6 * i + 4], -F[2] * L * (1 - eta[i]) / EI, 1e-9);
        NEAR(strain[6 * i + 2], F[2] / 1e4, 1e-9);
    }
    spar_session_destroy(&s);
}

/* Damping's part: a stretching beam carries EA (e + mu e-dot). One element pulled at its tip: the
   force at the section, less the stiffness times the strain, is mu EA times the rate of strain seen between two steps;
   order dt^2, 1e-3 of it. */
static void test_damping(void **state) {
    (void)state;
    const double L = 1, EA = 100, mu[6] = {0.05, 0, 0, 0, 0, 0}, eta[1] = {0.5}, F[6] = {10, 0, 0, 0, 0, 0}, h = 1e-3;
    double K[36], M[36], strain[3][6], force[3][6];
    scene_diagonal(K, EA, 1e3, 1e3, 10, 10, 10);
    scene_diagonal(M, 1, 1, 1, 1, 1, 1);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, 2, L, K, M);
    OK(s, spar_beam_set_damping(b, mu));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 1, SPAR_LOAD_DEAD, F));
    scene_run(s, h, 60);
    for (int i = 0; i < 3; i++) {
        scene_run(s, h, 1);
        OK(s, spar_beam_get_section(b, 1, eta, strain[i], force[i], NULL, NULL));
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
    assert_int_equal(spar_beam_get_section(NULL, 1, eta, out, NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_get_section(b, 1, eta, out, NULL, NULL, NULL), SPAR_ERR_STATE);
    OK(s, spar_member_commit(b));
    assert_int_equal(spar_beam_get_section(b, 1, eta, out, NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_beam_get_section(b, 1, NULL, out, NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
    OK(s, spar_beam_get_section(b, 0, NULL, NULL, NULL, NULL, NULL));
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_arc),    cmocka_unit_test(test_balance), cmocka_unit_test(test_balance_at_gauss_points),
        cmocka_unit_test(test_linear), cmocka_unit_test(test_damping), cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
