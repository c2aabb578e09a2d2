/* Roll-up: a cantilever under a tip moment M = lambda pi EI / L becomes an arc of radius r = EI/M, exactly: u1 = r
   sin(L/r)
   - L, u3 = r (1 - cos(L/r)). One load step. Tolerance: the interpolation error, which falls spectrally: with 15 nodes
   1e-12 L below half a turn, 1e-11 L at 1.6, 1e-9 L at 2 (a full circle); with 22 nodes 1e-11 L at 4
   (two circles). */
#include "verification.h"

static const double pi = 3.14159265358979323846;

static void roll(double lambda, int nodes, double q[7]) {
    double K[36], L = 10, EI = 86.9e3, load[6] = {0, 0, 0, 0, -lambda * pi * EI / L, 0};
    scene_diagonal(K, 1.77e6, 1.77e6, 1.77e6, 8.16e3, EI, 215e3);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "roll", 1, nodes, L, K, NULL);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, nodes - 1, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(b, 1));
    scene_tip(b, q);
    spar_session_destroy(&s);
}

static void test_roll_up(void **state) {
    (void)state;
    const double lambda[] = {0.4, 0.8, 1.2, 1.6, 2.0, 4.0}, tolerance[] = {1e-12, 1e-12, 1e-11, 1e-11, 1e-9, 1e-11};
    const int nodes[] = {15, 15, 15, 15, 15, 22};
    for (int k = 0; k < 6; k++) {
        char what[64];
        double q[7], L = 10, r = L / (lambda[k] * pi);
        roll(lambda[k], nodes[k], q);
        snprintf(what, sizeof what, "lambda = %g, %d nodes: u1", lambda[k], nodes[k]);
        verify(what, q[0], r * sin(L / r) - L, L * tolerance[k], "circle");
        snprintf(what, sizeof what, "lambda = %g, %d nodes: u3", lambda[k], nodes[k]);
        verify(what, q[2], r * (1 - cos(L / r)), L * tolerance[k], "circle");
    }
    verified();
}

/* Spectral convergence at the full circle: each added node takes a fixed factor off; from 9 to 15 nodes at least 1e6.
 */
static void test_convergence(void **state) {
    (void)state;
    double coarse[7], fine[7];
    roll(2, 9, coarse);
    roll(2, 15, fine);
    verify("lambda = 2: error 15 nodes / 9 nodes", fabs(fine[0] + 10) / fabs(coarse[0] + 10), 0, 1e-6,
           "spectral decay");
    verified();
}

VERIFICATION_MAIN("Roll-up of a cantilever under a tip moment", cmocka_unit_test(test_roll_up),
                  cmocka_unit_test(test_convergence))
