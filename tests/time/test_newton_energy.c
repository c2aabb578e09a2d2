/* Newton ends on what it has measured in the solution under way, in corrections and in forces, so that no beam makes
   energy. A strip is much stiffer along its line than across it: a small correction across leaves a large force along
   the line, and the contraction of another solution says nothing of it. The oracle is the work of the loads. */
#include "scene.h"

#include "check.h"

/* A cantilever of length 1 and EI 1, EA L^2 / EI = ratio, with the force EI / L^2 at its tip, which comes at once.
   mu: of stiffness-proportional damping. Returns the most by which kinetic and strain energy ever exceed the work of
   the load, relative to the largest work. *each: iterations a step. */
static double gain_of(double ratio, int steps, double mu, double *each) {
    enum { NODES = 10 };
    const double load[6] = {0, 1, 0}, period = 2 * M_PI / 3.516;
    double K[36], M[36], q[7], energy[2], most = 0, gain = 0;
    int64_t iterations;
    spar_session *s = NULL;
    OK(NULL, spar_session_create(&s));
    scene_diagonal(K, ratio, ratio, ratio, 1, 1, 1);
    scene_diagonal(M, 1, 1, 1, 2e-4, 1e-4, 1e-4);
    spar_member *b = scene_beam(s, "strip", 1, NODES, 1, K, M);
    OK(s, spar_beam_set_damping(b, (double[]){mu, mu, mu, mu, mu, mu}));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, NODES - 1, SPAR_LOAD_DEAD, load));
    for (int i = 0; i < steps; i++) {
        scene_run(s, period / steps, 1);
        scene_tip(b, q);
        OK(s, spar_member_get_energy(b, 2, energy));
        most = fmax(most, load[1] * q[1]);
        gain = fmax(gain, energy[0] + energy[1] - load[1] * q[1]);
    }
    OK(s, spar_member_get_iterations(b, &iterations, NULL));
    *each = (double)iterations / steps;
    spar_session_destroy(&s);
    return gain / most;
}

/* Generalised-alpha itself takes energy out of the motion along the line, and adds none. */
static void test_strip_makes_no_energy(void **state) {
    (void)state;
    for (double ratio = 1e3; ratio < 2e12; ratio *= 1e3) {
        for (int steps = 40; steps <= 640; steps *= 4) {
            double each, gain = gain_of(ratio, steps, 0, &each);
            print_message("EA L2 / EI %.0e, %d steps a period: %.1e of the work\n", ratio, steps, gain);
            assert_true(gain <= 1e-3);
        }
    }
}

/* The number of iterations does not depend on the stiffness along the line (Magisano, Leonetti and Garcea 2017). With
   the section forces of the strains it grows from 10 to 23. Damped, the largest ratio takes 37 for 75. */
static void test_stiffness_costs_no_iterations(void **state) {
    (void)state;
    for (double mu = 0; mu < 0.03; mu += 0.02) {
        for (double ratio = 1e6; ratio < (mu > 0 ? 2e9 : 2e12); ratio *= 1e3) {
            double each;
            gain_of(ratio, 160, mu, &each);
            print_message("EA L2 / EI %.0e, damping %.2f: %.1f iterations a step\n", ratio, mu, each);
            assert_true(each <= 8);
        }
    }
}

/* A cantilever released under its weight, without damping of material or scheme (rho_inf 1), 16 steps a period. At most
   0.32 J swing; the scheme itself changes the energy by 4e-4 of that, to and fro. */
static void test_swing_keeps_its_energy(void **state) {
    (void)state;
    const double gravity[3] = {0, 0, -9.81}, whole = 0.32;
    double K[36], M[36], e[3], most = 0, least = 0;
    spar_session *s = NULL;
    OK(NULL, spar_session_create(&s));
    OK(s, spar_session_set_gravity(s, gravity));
    OK(s, spar_session_set_integrator(s, 1, 1));
    scene_diagonal(K, 1e5, 4e4, 4e4, 20, 30, 50);
    scene_diagonal(M, 1, 1, 1, 1e-3, 5e-4, 5e-4);
    spar_member *b = scene_beam(s, "swing", 1, 5, 1, K, M);
    OK(s, spar_member_commit(b));
    for (int i = 0; i < 10000; i++) {
        scene_run(s, 0.02, 1);
        OK(s, spar_member_get_energy(b, 3, e));
        most = fmax(most, e[0] + e[1] + e[2]);
        least = fmin(least, e[0] + e[1] + e[2]);
    }
    print_message("swing: energy from %.1e to %.1e of the largest\n", least / whole, most / whole);
    assert_true(most <= 1e-3 * whole && least >= -2e-3 * whole);
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_strip_makes_no_energy),
                                       cmocka_unit_test(test_stiffness_costs_no_iterations),
                                       cmocka_unit_test(test_swing_keeps_its_energy)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
