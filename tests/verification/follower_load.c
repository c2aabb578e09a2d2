/* Cantilever under a follower force across its tip: Argyris & Symeonidis, CMAME 26 (1981): L 100, EI 3.5e7, force to
   130e3, the tip turns by more than 180 degrees. Exact elastica from the tip: with the tip's frame fixed, force and
   moment there are known, so the shape is an initial value problem theta' = kappa, EI kappa' = -Q, integrated by the
   classical Runge-Kutta method (4000 steps, error 1e-12). EA = GA = 1e6 EI/L^2 times 100 stand for inextensible: Q
   L^2/EI = 37 leaves 4e-7 of L. And the line loads: a partial uniform load on a cantilever, small, by integration. */
#include "verification.h"

enum { NODES = 20 };

/* Tip of the elastica relative to its clamped root: x along the root's tangent, z across, turn */
static void elastica(double load, double out[3]) {
    enum { STEPS = 4000 };
    /* s runs from the tip (0) to the root (1), unit length and EI: turn t and curvature k relative to the tip's tangent
     */
    double h = 1.0 / STEPS, y[4] = {0, 0, 0, 0}; /* t, k, x, z */
    for (int i = 0; i < STEPS; i++) {
        double k[4][4], at[4];
        for (int r = 0; r < 4; r++) {
            for (int j = 0; j < 4; j++) {
                at[j] = r == 0 ? y[j] : y[j] + (r == 3 ? h : 0.5 * h) * k[r - 1][j];
            }
            /* moment about a section: the force, fixed across the tip, at the arm along the tip's tangent */
            k[r][0] = at[1], k[r][1] = load * cos(at[0]), k[r][2] = cos(at[0]), k[r][3] = sin(at[0]);
        }
        for (int j = 0; j < 4; j++) {
            y[j] += h / 6 * (k[0][j] + 2 * k[1][j] + 2 * k[2][j] + k[3][j]);
        }
    }
    /* from the root, whose tangent stands at y[0] against the tip's: the tip lies at (x, z) turned back */
    out[0] = cos(y[0]) * y[2] + sin(y[0]) * y[3];
    out[1] = sin(y[0]) * y[2] - cos(y[0]) * y[3];
    out[2] = y[0];
}

static void test_follower(void **state) {
    (void)state;
    const double force[] = {10e3, 30e3, 60e3, 100e3, 130e3};
    double L = 100, EI = 3.5e7, K[36];
    scene_diagonal(K, 1e8 * EI / L / L, 1e8 * EI / L / L, 1e8 * EI / L / L, EI, EI, EI);
    for (int k = 0; k < 5; k++) {
        double load[6] = {0, 0, force[k], 0, 0, 0}, q[7], exact[3], lambda = force[k] * L * L / EI;
        char what[64];
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "cantilever", 2, NODES, L, K, NULL);
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, 2 * NODES - 1, SPAR_LOAD_FOLLOWER, load));
        OK(s, spar_member_solve_static(b, 10));
        scene_tip(b, q);
        elastica(lambda, exact);
        snprintf(what, sizeof what, "F = %g: x / L", force[k]);
        verify(what, 1 + q[0] / L, exact[0], 1e-8 * (1 + lambda), "elastica from the tip");
        snprintf(what, sizeof what, "F = %g: z / L", force[k]);
        verify(what, q[2] / L, exact[1], 1e-8 * (1 + lambda), "elastica from the tip");
        snprintf(what, sizeof what, "F = %g: turn of the tip", force[k]);
        double turn = -2 * atan2(q[5], q[3]);
        verify(what, turn < 0 ? turn + 2 * 3.14159265358979323846 : turn, exact[2], 1e-8 * (1 + lambda),
               "elastica from the tip");
        spar_session_destroy(&s);
    }
    verified();
}

/* w = 1e-3 from 0.25 L to 0.6 L: root force and moment by statics, and the linear deflection int m M / EI + q Q / GA,
   in closed form by pieces: EI w'''' = load. Deflections of 1e-9 L: nonlinear terms are beyond the tolerance. */
static void test_partial_load(void **state) {
    (void)state;
    const double line[4] = {0.25, 0.6, 0.25, 0.6};
    double K[36], q[7], r[6], load[12] = {0}, p = 1e-3, L = 4, a = line[0] * L, b = line[1] * L, EI = 2e6, GA = 7e5;
    load[2] = load[8] = p;
    scene_diagonal(K, 1e6, GA, GA, 1e6, EI, EI);
    spar_session *s = scene_session();
    spar_member *m = scene_beam(s, "cantilever", 1, 12, L, K, NULL);
    OK(s, spar_member_commit(m));
    OK(s, spar_beam_set_line_load(m, SPAR_LOAD_DEAD, 2, line, load));
    OK(s, spar_member_solve_static(m, 1));
    scene_tip(m, q);
    OK(s, spar_member_get_reaction(m, r));
    /* a load P at x deflects the tip by P x^2 (3 L - x) / (6 EI) + P x / GA */
    double tip = p * (3 * L * (b * b * b - a * a * a) / 3 - (pow(b, 4) - pow(a, 4)) / 4) / (6 * EI) +
                 p * (b * b - a * a) / 2 / GA;
    verify("partial uniform load: root force, relative", r[2] / (-p * (b - a)), 1, 1e-10, "statics");
    verify("partial uniform load: root moment, relative", r[4] / (p * (b * b - a * a) / 2), 1, 1e-8, "statics");
    /* the third derivative jumps inside the element: interpolation of a kink in the moment's slope by 12 nodes */
    verify("partial uniform load: tip, relative", q[2] / tip, 1, 1e-6, "closed form");
    spar_session_destroy(&s);
    verified();
}

VERIFICATION_MAIN("Follower force and line load", cmocka_unit_test(test_follower), cmocka_unit_test(test_partial_load))
