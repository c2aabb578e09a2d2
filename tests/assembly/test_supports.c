/* A second support, and springs on any node of a beam, are joints with the ground: frequencies and deflections in
   closed form. */
#include "scene.h"

enum { P = 14, ALL = 63 };
static const double two_pi = 6.283185307179586, L = 2, EI = 5, m = 3;

/* Slender, clamped at its root, along x. */
static spar_member *slender(spar_session *s, int elements) {
    double K[36], M[36], stiff = 1e8 * EI / L / L, j = 1e-8 * m * L * L;
    scene_diagonal(K, stiff, stiff, stiff, 1e6 * EI, EI, EI);
    scene_diagonal(M, m, m, m, 2 * j, j, j);
    spar_member *b = scene_beam(s, "beam", elements, P, L, K, M);
    OK(s, spar_member_commit(b));
    return b;
}

/* Cantilever with a spring kappa EI / L^3 across its tip: 1 + cos x cosh x + kappa / x^3 (sin x cosh x - cos x sinh x)
   = 0, omega = x^2 sqrt(EI / m) / L^2 (of the beam's equation with V(L) = k u(L)); kappa infinite, a support: the last
   bracket. The lowest root from x0 by bisection. */
static double sprung(double x, double kappa) {
    double bracket = sin(x) * cosh(x) - cos(x) * sinh(x);
    return isinf(kappa) ? bracket : 1 + cos(x) * cosh(x) + kappa / (x * x * x) * bracket;
}

static double lowest_root(double kappa) {
    double lo = 1, hi = 1;
    while (sprung(lo, kappa) * sprung(hi, kappa) > 0) {
        hi += 1e-2;
    }
    for (int i = 0; i < 60; i++) {
        double mid = 0.5 * (lo + hi);
        *(sprung(mid, kappa) * sprung(lo, kappa) > 0 ? &lo : &hi) = mid;
    }
    return lo;
}

/* Lowest frequency in the direction of the spring or support at the tip; what is across it stays that of a cantilever
   (3.516). 1e-5. */
static void test_tip(void **state) {
    (void)state;
    static const double kappas[3] = {4, 50, INFINITY};
    const double unit = sqrt(EI / m) / (L * L);
    for (int k = 0; k < 3; k++) {
        double kappa = kappas[k], f[2], K[36] = {0}, root = lowest_root(kappa);
        spar_session *s = scene_session();
        spar_member *b = slender(s, 1);
        K[14] = isinf(kappa) ? 0 : kappa * EI / (L * L * L);
        OK(s, spar_spring_create(s, "spring", b, P - 1, isinf(kappa) ? ALL & ~SPAR_FREE_Z : ALL, K, NULL, NULL, NULL));
        OK(s, spar_member_solve_modes(b, 2, f, NULL));
        NEAR(two_pi * f[0] / unit, 3.5160152685, 1e-4);
        NEAR(two_pi * f[1] / (unit * root * root), 1, 1e-5);
        spar_session_destroy(&s);
    }
}

/* A spring k on a node along the beam, at a from the root, under a load F at the tip that hardly bends it: the spring
   holds k u, u = F a^2 (3 L - a) / (6 EI) / (1 + k a^3 / (3 EI)), and the root the rest. Where two elements join the
   beam's shape has the step of the shear there, 1e-5 is asked for; on a node within an element its polynomials
   have not: 3e-4. */
static void test_along(void **state) {
    (void)state;
    const double F = 1e-4, k = 20, load[6] = {0, 0, F, 0, 0, 0};
    for (int elements = 1; elements <= 2; elements++) {
        int64_t node = elements == 2 ? P : 6, tip = elements * P - 1;
        double K[36] = {0}, x[3 * 2 * P], held[6], reaction[6], within = elements == 2 ? 1e-5 * F : 3e-4 * F;
        spar_joint *spring = NULL;
        spar_session *s = scene_session();
        spar_member *b = slender(s, elements);
        K[14] = k;
        OK(s, spar_spring_create(s, "spring", b, node, ALL, K, NULL, NULL, &spring));
        OK(s, spar_member_set_load(b, tip, SPAR_LOAD_DEAD, load));
        OK(s, spar_member_solve_static(b, 1));
        OK(s, spar_member_get_reference(b, x, NULL));
        OK(s, spar_joint_get_load(spring, held));
        OK(s, spar_member_get_reaction(b, reaction));
        double a = x[3 * node], u = F * a * a * (3 * L - a) / (6 * EI) / (1 + k * a * a * a / (3 * EI));
        NEAR(held[2], -k * u, within);
        NEAR(reaction[2], k * u - F, within);
        spar_session_destroy(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tip),
        cmocka_unit_test(test_along),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
