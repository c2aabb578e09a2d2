/* A cantilever whose bending stiffness jumps at five stations, under a small tip force: statically determined, so the
   deflection is P int (L - x)^2 / EI + 1 / GA dx, in closed form. Quadrature per section interval converges to the
   answer of the mesh and the mesh to the exact one; Gauss over the whole beam does neither. With joints on the jumps
   the elements are exact: moments linear in x, deflection cubic; what is left is rounding. */
#include "verification.h"

enum { PIECES = 6 };
static const double joint[PIECES + 1] = {0, 0.137, 0.31, 0.472, 0.55, 0.83, 1};
static const double rigidity[PIECES] = {5e4, 3.5e4, 4.4e4, 2.5e4, 3.1e4, 2e4};

/* Deflection over the exact one, less 1. by_joints: six elements that end on the jumps; else one element */
static double error(int by_joints, int nodes, int rule, int points) {
    double eta[2 * PIECES], K[36 * 2 * PIECES], load[6] = {0, 0, 1e-3, 0, 0, 0}, q[7], exact = 10 / 1e7, width = 1e-6;
    const double line[2] = {0, 1}, xyz[6] = {0, 0, 0, 10, 0, 0};
    static const double gll[4] = {-1, -0.44721359549995793928, 0.44721359549995793928, 1};
    spar_session *s = scene_session();
    spar_member *b;
    for (int i = 0; i < PIECES; i++) {
        double from = 10 * (1 - joint[i]), to = 10 * (1 - joint[i + 1]);
        /* eta counts elements: a jump at a joint stands at e / PIECES, whatever the elements' lengths */
        double begin = by_joints ? (double)i / PIECES : joint[i], end = by_joints ? (i + 1.0) / PIECES : joint[i + 1];
        eta[2 * i] = i == 0 ? 0 : begin + width / 2;
        eta[2 * i + 1] = i == PIECES - 1 ? 1 : end - width / 2;
        for (int k = 0; k < 2; k++) {
            scene_diagonal(K + 36 * (2 * i + k), 1e7, 1e7, 1e7, 1e5, rigidity[i], 1e5);
        }
        exact += (from * from * from - to * to * to) / 3 / rigidity[i];
    }
    OK(s, spar_beam_create(s, "blade", by_joints ? PIECES : 1, nodes, &b));
    if (by_joints) {
        double x[3 * 4 * PIECES] = {0};
        for (int i = 0; i < 4 * PIECES; i++) {
            int e = i / 4;
            x[3 * i] = 10 * (joint[e] + 0.5 * (1 + gll[i % 4]) * (joint[e + 1] - joint[e]));
        }
        OK(s, spar_beam_set_nodes(b, 4 * PIECES, x, NULL));
    } else {
        OK(s, spar_beam_set_axis(b, 2, line, xyz, NULL));
    }
    OK(s, spar_beam_set_sections(b, 2 * PIECES, eta, K, NULL));
    OK(s, spar_beam_set_quadrature(b, rule, points));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, (by_joints ? PIECES : 1) * nodes - 1, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(b, 1));
    scene_tip(b, q);
    spar_session_destroy(&s);
    return q[2] / (exact * 1e-3) - 1;
}

static void test_jumps(void **state) {
    (void)state;
    double limit = error(0, 12, SPAR_QUADRATURE_SECTIONS, 16), last = 1, least = 1;
    for (int points = 3; points <= 9; points += 2) {
        char what[64];
        double off = fabs(error(0, 12, SPAR_QUADRATURE_SECTIONS, points) - limit);
        snprintf(what, sizeof what, "12 nodes, %d points an interval: off its limit", points);
        /* Gauss' rule on a polynomial of degree 22 in an interval of a tenth: four digits and more for two points */
        verify(what, off, 0, points == 3 ? 2e-3 : last / 30, "Gauss' rule on a polynomial");
        last = off;
    }
    for (int points = 30; points <= 150; points += 20) {
        least = fmin(least, fmax(fabs(error(0, 12, SPAR_QUADRATURE_GAUSS, points) - limit),
                                 fabs(error(0, 12, SPAR_QUADRATURE_GAUSS, points + 7) - limit)));
    }
    verify("12 nodes, Gauss over the beam, 30 to 157 points: off by", least, 1e-3, 9e-4, "a jump inside the rule");
    for (int nodes = 6; nodes <= 24; nodes += 6) {
        char what[64];
        double now = -error(0, nodes, SPAR_QUADRATURE_SECTIONS, 10);
        snprintf(what, sizeof what, "%d nodes, per section: too stiff by", nodes);
        /* a conforming mesh with exact integrals is too stiff, and less so with more nodes */
        verify(what, now, 0, nodes == 6 ? 0.05 : last, "Rayleigh-Ritz: falls with the nodes");
        assert_true(now > 0);
        last = now;
    }
    verify("joints on the jumps, 4 nodes: relative error", error(1, 4, SPAR_QUADRATURE_SECTIONS, 4), 0, 2e-6,
           "exact but for the width of the jumps");
    verified();
}

VERIFICATION_MAIN("Quadrature where the stiffness jumps", cmocka_unit_test(test_jumps))
