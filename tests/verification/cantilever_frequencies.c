/* Natural frequencies of cantilevers at rest: Euler-Bernoulli (roots of cosh x cos x = -1), rods, and Timoshenko with
   rotary inertia, whose table is the exact solution to 9 or 10 digits; 20 nodes: spectrally exact for the first modes.
 */
#include "verification.h"

static const double pi = 3.14159265358979323846;

static void modes(const double K[36], const double M[36], double L, int n, double *f) {
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "cantilever", 1, 20, L, K, M);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_solve_modes(b, n, f, NULL));
    spar_session_destroy(&s);
}

/* EI 1 in one plane, the other planes out of the way; m = 1, L = 1. Shear and rotary inertia of 1e-6 and 1e-7 shift
 * mode n by some 5e-7 beta_n^2 (Rayleigh). */
static void test_euler_bernoulli(void **state) {
    (void)state;
    const double exact[5] = {3.51601526850015, 22.0344915646668, 61.6972144135491, 120.901916052306, 199.859530116803};
    double K[36], M[36], f[5];
    scene_diagonal(K, 1e6, 1e6, 1e6, 1e3, 1, 1e6);
    scene_diagonal(M, 1, 1, 1, 1e-4, 1e-7, 1e-7);
    modes(K, M, 1, 5, f);
    for (int k = 0; k < 5; k++) {
        char what[64];
        snprintf(what, sizeof what, "Euler-Bernoulli, mode %d", k + 1);
        /* relative shift by shear and rotary inertia: (r^2 + s^2) / 2 times (slope / deflection)^2 <= beta^2 */
        verify(what, 2 * pi * f[k], exact[k], 2.5e-6 * exact[k] * exact[k], "cosh x cos x = -1");
    }
    verified();
}

static void test_rods(void **state) {
    (void)state;
    double K[36], M[36], f[3];
    scene_diagonal(K, 7, 1e4, 1e4, 1e4, 1e4, 1e4);
    scene_diagonal(M, 1.5, 1.5, 1.5, 1, 1, 1);
    modes(K, M, 2, 3, f);
    for (int k = 0; k < 3; k++) {
        char what[64];
        snprintf(what, sizeof what, "rod along its axis, mode %d", k + 1);
        verify(what, 2 * pi * f[k], (k + 0.5) * pi * sqrt(7 / 1.5) / 2, 1e-9, "(n - 1/2) pi sqrt(EA/m) / L");
    }
    scene_diagonal(K, 1e3, 1e3, 1e3, 3, 1e3, 1e3);
    scene_diagonal(M, 1, 1, 1, 0.2, 0.1, 0.1);
    modes(K, M, 2, 3, f);
    for (int k = 0; k < 3; k++) {
        char what[64];
        snprintf(what, sizeof what, "rod in torsion, mode %d", k + 1);
        verify(what, 2 * pi * f[k], (k + 0.5) * pi * sqrt(3 / 0.2) / 2, 1e-9, "(n - 1/2) pi sqrt(GJ/Ip) / L");
    }
    verified();
}

/* r^2 = I / (A L^2), EI / (kGA L^2) = 3.12 r^2 */
static void test_timoshenko(void **state) {
    (void)state;
    const double table[3][5] = {{0.02, 3.50264107, 21.46982418, 58.14983171, 109.0291433},
                                {0.05, 3.435274962, 19.10362328, 46.60313987, 78.90221754},
                                {0.10, 3.227127762, 14.4689281, 31.50253891, 47.90901878}};
    for (int k = 0; k < 3; k++) {
        double K[36], M[36], f[4], r = table[k][0];
        scene_diagonal(K, 1e5, 1e5, 1 / (3.12 * r * r), 1e4, 1, 1e4);
        scene_diagonal(M, 1, 1, 1, r * r * 2, r * r, r * r);
        modes(K, M, 1, 4, f);
        for (int i = 0; i < 4; i++) {
            char what[64];
            snprintf(what, sizeof what, "Timoshenko, r = %.2f, mode %d", r, i + 1);
            verify(what, 2 * pi * f[i], table[k][1 + i], 1e-7 * (i == 3 ? 1 : 0.2), "exact, 9 to 10 digits");
        }
    }
    verified();
}

VERIFICATION_MAIN("Frequencies of cantilevers", cmocka_unit_test(test_euler_bernoulli), cmocka_unit_test(test_rods),
                  cmocka_unit_test(test_timoshenko))
