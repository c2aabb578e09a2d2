/* Gates of the time integrator on one degree of freedom: a rod of one two-node element with Lobatto's points, whose
   tip has the mass m L / 2 and the spring EA / L exactly. */
#include "verification.h"

static const double pi = 3.14159265358979323846;

/* mass 1 at the tip, spring k */
static spar_member *spring(spar_session *s, double k) {
    double K[36], M[36];
    scene_diagonal(K, k, 1, 1, 1, 1, 1);
    scene_diagonal(M, 2, 2, 2, 2, 2, 2);
    spar_member *b = scene_beam(s, "spring", 1, 2, 1, K, M);
    OK(s, spar_beam_set_quadrature(b, SPAR_QUADRATURE_LOBATTO, 2));
    OK(s, spar_member_commit(b));
    return b;
}

/* The scheme itself, for one mass of 1, a spring k and a constant force, from rest: eight lines that share nothing with
   the library (Chung & Hulbert, J. Appl. Mech. 60 (1993)). a: true acceleration, b: algorithmic, from a0. */
static double oscillator(double k, double force, double a0, double rho, double h, int n) {
    double am = (2 * rho - 1) / (rho + 1), af = rho / (rho + 1), gamma = 0.5 + af - am,
           beta = 0.25 * (0.5 + gamma) * (0.5 + gamma);
    double x = 0, v = 0, a = a0, b = a0;
    for (int i = 0; i < n; i++) {
        double c = h * h * beta / (1 - am), x0 = x + h * v + h * h * (0.5 - beta) * b + c * (af * a - am * b);
        double next = (force - k * x0) / (1 + k * c * (1 - af)), b1 = ((1 - af) * next + af * a - am * b) / (1 - am);
        x = x0 + c * (1 - af) * next;
        v += h * ((1 - gamma) * b + gamma * b1);
        a = next, b = b1;
    }
    return x;
}

/* Kynema-FMB's test_spring_mass_system: m 1, k 10, released from 2, dt = T / 1000, rho_inf 0: the same motion as under
   a force of -20 from rest. Exact -4 at T/2 and 0 at T. Kynema starts with no acceleration, which costs it a factor of
   100: what it prints comes out of the eight lines above with a0 = 0, and what spar gives with the a0 of the balance.
 */
static void test_spring_mass(void **state) {
    (void)state;
    double T = 2 * pi / sqrt(10), q[7], load[6] = {-20, 0, 0, 0, 0, 0};
    spar_session *s = scene_session();
    spar_member *b = spring(s, 10);
    OK(s, spar_session_set_integrator(s, 0, 1));
    OK(s, spar_session_set_newton(s, 1e-14, 1e-14, 20));
    OK(s, spar_member_set_load(b, 1, SPAR_LOAD_DEAD, load));
    for (int k = 1; k <= 2; k++) {
        char what[64];
        scene_run(s, T / 1000, 500);
        scene_tip(b, q);
        snprintf(what, sizeof what, "spring and mass, t = %s", k == 1 ? "T/2" : "T");
        verify(what, q[0], k == 1 ? -4 : 0, 2 * pow(2 * pi / 1000, 2), "cosine, second order");
        snprintf(what, sizeof what, "spring and mass, t = %s, the scheme", k == 1 ? "T/2" : "T");
        verify(what, q[0], oscillator(10, -20, -20, 0, T / 1000, 500 * k), 1e-11, "scalar recurrence");
        snprintf(what, sizeof what, "the recurrence from a0 = 0, t = %s", k == 1 ? "T/2" : "T");
        verify(what, oscillator(10, -20, 0, 0, T / 1000, 500 * k),
               k == 1 ? -3.9999199193098396 : -8.1226588438437419e-05, 1e-10, "Kynema-FMB, 16 digits");
    }
    spar_session_destroy(&s);
    verified();
}

/* Order 2 for all rho_inf: displacement (v0 / w) sin(w t) of the free spring at t = 1 */
static void test_order(void **state) {
    (void)state;
    const double zero[3] = {0, 0, 0}, v0[3] = {1, 0, 0};
    for (int r = 0; r <= 4; r++) {
        double e[2], rho = 0.25 * r;
        char what[64];
        for (int k = 0; k < 2; k++) {
            double q[7];
            spar_session *s = scene_session();
            spar_member *b = spring(s, 10);
            OK(s, spar_session_set_integrator(s, rho, 1));
            OK(s, spar_session_set_newton(s, 1e-14, 1e-14, 20));
            OK(s, spar_member_set_initial_velocity(b, zero, v0, zero));
            scene_run(s, 1e-3 / (1 + k), 1000 * (1 + k));
            scene_tip(b, q);
            e[k] = fabs(q[0] - sin(sqrt(10)) / sqrt(10));
            spar_session_destroy(&s);
        }
        snprintf(what, sizeof what, "rho_inf = %.2f: order", rho);
        verify(what, log2(e[0] / e[1]), 2, 0.05, "generalised-alpha");
    }
    verified();
}

/* Spectral radius at k dt^2 / m = 1e8: all three roots are -rho_inf there (Chung & Hulbert 1993), so the displacements
   obey x3 + 3 rho x2 + 3 rho^2 x1 + rho^3 x0 = 0. What is left of it, relative to its largest term: m / (k dt^2) and
   the rounding that Newton stops at. */
static void test_spectral_radius(void **state) {
    (void)state;
    const double zero[3] = {0, 0, 0}, v0[3] = {1, 0, 0};
    for (int r = 0; r <= 4; r++) {
        double x[8], rho = 0.25 * r, worst = 0;
        char what[64];
        spar_session *s = scene_session();
        spar_member *b = spring(s, 1e8);
        OK(s, spar_session_set_integrator(s, rho, 1));
        OK(s, spar_session_set_newton(s, 1e-16, 1e-14, 20));
        OK(s, spar_member_set_initial_velocity(b, zero, v0, zero));
        for (int k = 0; k < 8; k++) {
            double q[7];
            scene_run(s, 1, 1);
            scene_tip(b, q);
            x[k] = q[0];
        }
        double size = fmax(fabs(x[0]), fabs(x[1]));
        for (int k = 1; k + 3 < 8; k++) {
            worst = fmax(
                worst, fabs(x[k + 3] + 3 * rho * x[k + 2] + 3 * rho * rho * x[k + 1] + rho * rho * rho * x[k]) / size);
        }
        snprintf(what, sizeof what, "rho_inf = %.2f: triple root at infinity", rho);
        verify(what, worst, 0, 1e-6, "Chung & Hulbert 1993");
        spar_session_destroy(&s);
    }
    verified();
}

VERIFICATION_MAIN("Time integrator", cmocka_unit_test(test_spring_mass), cmocka_unit_test(test_order),
                  cmocka_unit_test(test_spectral_radius))
