/* Elastica: cantilever under a transverse dead tip load. Bisshopp & Drucker, Quart. Appl. Math. 3 (1945); Mattiasson,
   IJNME 17 (1981), table 1: elliptic integrals, 13 digits. EA = GA = 1e10 EI/L^2 stands for inextensible and
   shear-rigid, which leaves the shear of the tip, w/L = 1e-10 lambda. 18 nodes: the layer at the root has the width L /
   sqrt(lambda), so the interpolation error grows with lambda; two elements beyond 10 with a joint where the layer ends.
   Rounding in a stiffness of 1e10 leaves up to 2e-10 in the rotations, with another BLAS other digits. */
#include "verification.h"

static void solve(double lambda, int elements, double q[7]) {
    double K[36], load[6] = {0, 0, lambda, 0, 0, 0};
    scene_diagonal(K, 1e10, 1e10, 1e10, 1, 1, 1);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "elastica", elements, 18, 1, K, NULL);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 18 * elements - 1, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(b, 10));
    scene_tip(b, q);
    spar_session_destroy(&s);
}

static void test_elastica(void **state) {
    (void)state;
    const double table[][4] = {{0.2, 0.06636448214483, 0.002646548340523, 0.0996361630374},
                               {1, 0.3017207737998, 0.05643323628338, 0.4613519497119},
                               {4, 0.6699641812777, 0.3289412422468, 1.121239347488},
                               {10, 0.8106090248803, 0.5549955977538, 1.430285538804},
                               {25, 0.8827305261799, 0.7171925461889, 1.548466471441},
                               {100, 0.941421350862, 0.8585786445629, 1.57064588466}};
    for (size_t k = 0; k < sizeof table / sizeof *table; k++) {
        double lambda = table[k][0], q[7], tolerance = 1e-10 * (3 + lambda) + (lambda > 10 ? 1e-8 : 0);
        char what[64];
        solve(lambda, lambda > 10 ? 2 : 1, q);
        snprintf(what, sizeof what, "P L^2/EI = %g: w/L", lambda);
        verify(what, q[2], table[k][1], tolerance, "elliptic integrals");
        snprintf(what, sizeof what, "P L^2/EI = %g: -u/L", lambda);
        verify(what, -q[0], table[k][2], tolerance, "elliptic integrals");
        snprintf(what, sizeof what, "P L^2/EI = %g: tip angle", lambda);
        verify(what, -2 * atan2(q[5], q[3]), table[k][3], tolerance, "elliptic integrals");
    }
    verified();
}

/* Geradin & Cardona's cantilever with finite EA and GA, as Simpson & Palacios (2013) print it: two and three decimals
 */
static void test_geradin(void **state) {
    (void)state;
    double K[36], load[6] = {0, 0, -600e3, 0, 0, 0}, q[7];
    scene_diagonal(K, 4.8e8, 3.231e8, 3.231e8, 1e6, 9.346e6, 9.346e6);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "cantilever", 1, 12, 5, K, NULL);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 11, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(b, 1));
    scene_tip(b, q);
    verify("Geradin, P = 600e3: uz", q[2], -2.159, 5e-3, "Simpson & Palacios 2013, 2 decimals");
    verify("Geradin, P = 600e3: -ux", -q[0], 0.596, 1e-3, "Simpson & Palacios 2013, 3 decimals");
    verify("Geradin, P = 600e3: rotation", 2 * atan2(q[5], q[3]), 0.6720, 1e-3, "Simpson & Palacios 2013, 3 decimals");
    spar_session_destroy(&s);
    verified();
}

/* Nachbagauer, Pechstein, Irschik & Gerstmayr, Multibody Syst. Dyn. 26 (2011): L 2, w 0.1, h 0.5, E 2.07e11, nu 0.3,
   tip force 5e8 h^3; their 1024 elements of second order leave some 1e-6 of what they print. The small load, 5e5 h^3,
   to the digits printed. */
static void test_nachbagauer(void **state) {
    (void)state;
    double E = 2.07e11, nu = 0.3, w = 0.1, h = 0.5, ks = 10 * (1 + nu) / (12 + 11 * nu), A = w * h,
           G = E / 2 / (1 + nu);
    double K[36], q[7];
    scene_diagonal(K, E * A, ks * G * A, ks * G * A, G * 2e-3, E * h * w * w * w / 12, E * w * h * h * h / 12);
    for (int k = 0; k < 2; k++) {
        double load[6] = {0, (k ? 5e8 : 5e5) * h * h * h, 0, 0, 0, 0};
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "cantilever", 1, 12, 2, K, NULL);
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, 11, SPAR_LOAD_DEAD, load));
        OK(s, spar_member_solve_static(b, 1));
        scene_tip(b, q);
        verify(k ? "Nachbagauer, 5e8 h^3: ux" : "Nachbagauer, 5e5 h^3: -ux", k ? q[0] : -q[0],
               k ? -0.15097103 : 1.888e-7, k ? 1e-6 * 0.71 : 5e-11, "Nachbagauer et al. 2011");
        verify(k ? "Nachbagauer, 5e8 h^3: uy" : "Nachbagauer, 5e5 h^3: uy", q[1], k ? 0.71056837 : 8.0990e-4,
               k ? 1e-6 * 0.71 : 5e-9, "Nachbagauer et al. 2011");
        spar_session_destroy(&s);
    }
    verified();
}

VERIFICATION_MAIN("Elastica and other cantilevers under a dead tip force", cmocka_unit_test(test_elastica),
                  cmocka_unit_test(test_geradin), cmocka_unit_test(test_nachbagauer))
