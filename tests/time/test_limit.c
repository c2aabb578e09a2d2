/* Static equilibrium up to limit and branching points: spar says where the path of stable equilibria ends and leaves
   the state as it was. A member is held at its root alone, so that frames held at two ends (Lee's) cannot be expressed;
   columns and a bar torn apart by its own rotation can. */
#include "scene.h"

static const double pi = 3.14159265358979323846;

/* The part of the loads that the message says has been reached */
static double reached(const spar_session *s) {
    const char *at = strstr(spar_session_message(s), "beyond ");
    assert_non_null(at);
    return atof(at + 7);
}

static spar_member *column(spar_session *s, int elements, double L, double EI, double ratio) {
    double K[36], M[36];
    scene_diagonal(K, 1e7, 1e7, 1e7, EI, EI, ratio * EI);
    scene_diagonal(M, 1, 1, 1, 1e-3, 1e-3, 1e-3);
    spar_member *b = scene_beam(s, "mast", elements, 8, L, K, M);
    OK(s, spar_member_commit(b));
    return b;
}

static void expect_end(spar_session *s, spar_member *b, int steps, double part, double tolerance) {
    double before[7], after[7], r[2][6];
    scene_tip(b, before);
    OK(s, spar_member_get_reaction(b, r[0]));
    assert_int_equal(spar_member_solve_static(b, steps), SPAR_ERR_NUMERIC);
    assert_non_null(strstr(spar_session_message(s), "'mast'"));
    NEAR(reached(s), part, tolerance);
    scene_tip(b, after);
    OK(s, spar_member_get_reaction(b, r[1]));
    assert_memory_equal(before, after, sizeof before);
    assert_memory_equal(r[0], r[1], sizeof r[0]);
}

/* Euler: P_cr = pi^2 EI / (4 L^2), less by P/GA (1e-6 here). Straight stays an equilibrium beyond; with equal bending
   stiffnesses two eigenvalues pass zero at once and the determinant keeps its sign. The last load step is 2^-14 of the
   first. One and two elements: dense and banded matrices. */
static void test_euler_column(void **state) {
    (void)state;
    const double L = 2, EI = 5, critical = pi * pi * EI / (4 * L * L);
    for (int elements = 1; elements <= 2; elements++) {
        for (int k = 0; k < 2; k++) {
            spar_session *s = scene_session();
            spar_member *b = column(s, elements, L, EI, k ? 3 : 1);
            double load[6] = {-2 * critical, 0, 0, 0, 0, 0};
            OK(s, spar_member_set_load(b, 8 * elements - 1, SPAR_LOAD_DEAD, load));
            expect_end(s, b, 1, 0.5, 2e-4);
            expect_end(s, b, 7, 0.5, 1e-4);
            load[0] = -0.999 * critical;
            OK(s, spar_member_set_load(b, 8 * elements - 1, SPAR_LOAD_DEAD, load));
            OK(s, spar_member_solve_static(b, 1));
            spar_session_destroy(&s);
        }
    }
}

/* Greenhill: a column of its own weight w per length stands to w L^3/EI = 7.83735, 9/4 j^2 with j the first zero of
   J_{-1/3}; the weight as gravity and as a dead line load. */
static void test_heavy_column(void **state) {
    (void)state;
    const double L = 2, EI = 5, critical = 7.83734744 * EI / (L * L * L), eta[1] = {0};
    double load[6] = {-3 * critical, 0, 0, 0, 0, 0}, g[3] = {-3 * critical, 0, 0};
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_member *b = column(s, 1, L, EI, 2);
        if (k == 0) {
            OK(s, spar_beam_set_line_load(b, SPAR_LOAD_DEAD, 1, eta, load));
        } else {
            OK(s, spar_session_set_gravity(s, g));
        }
        expect_end(s, b, 1, 1.0 / 3, 2e-4);
        spar_session_destroy(&s);
    }
}

/* A bar that turns about its end stretches as tan k, k^2 = m W^2 L^2 / EA, without bound towards k = pi/2; beyond, the
   equations have a solution again, of the other sign, which Newton finds at once: it is not one that spinning up leads
   to. Loads of rotation grow with W^2. Asked for k = 2: (pi/2)^2 / 4. */
static void test_spinning_bar(void **state) {
    (void)state;
    const double L = 2, EA = 50, m = 3, k = 2, W = k / L * sqrt(EA / m), w[3] = {0, 0, W};
    double K[36], M[36];
    scene_diagonal(K, EA, 1e4, 1e4, 1e4, 1e4, 1e4);
    scene_diagonal(M, m, m, m, 1e-3, 1e-3, 1e-3);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "mast", 1, 12, L, K, M);
    OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
    OK(s, spar_member_set_initial_velocity(b, NULL, NULL, w));
    OK(s, spar_member_commit(b));
    expect_end(s, b, 1, 0.25 * pi * pi / 4, 1e-3);
    spar_session_destroy(&s);
}

/* With a side load of a thousandth the path has no end: the column bends over and stays stable, past the Euler load to
   three times it, where the tip of Euler's elastica has come below the root; one and twenty load steps agree. */
static void test_imperfect_column(void **state) {
    (void)state;
    const double L = 2, EI = 5, critical = pi * pi * EI / (4 * L * L);
    double q[2][7];
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_member *b = column(s, 2, L, EI, 2);
        double load[6] = {-3 * critical, 0, 3e-3 * critical, 0, 0, 0};
        OK(s, spar_member_set_load(b, 15, SPAR_LOAD_DEAD, load));
        OK(s, spar_member_solve_static(b, k ? 20 : 1));
        scene_tip(b, q[k]);
        spar_session_destroy(&s);
    }
    assert_true(q[0][2] > 0.5 * L && q[0][0] < -L);
    for (int i = 0; i < 7; i++) {
        NEAR(q[0][i], q[1][i], 1e-8);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_euler_column),
        cmocka_unit_test(test_heavy_column),
        cmocka_unit_test(test_spinning_bar),
        cmocka_unit_test(test_imperfect_column),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
