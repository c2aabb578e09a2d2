/* Newton ends on what it has measured in the solution under way, so that no beam makes energy. A strip is much stiffer
   along its line than across it: a small correction across leaves a large force along the line, and the contraction of
   another solution says nothing of it. The oracle is the work of the load, which comes at once and then stays. */
#include "scene.h"

#include "check.h"

/* A cantilever of length 1 and EI 1, E A L^2 / (E I) = ratio, with the force EI / L^2 at its tip. Returns the most by
   which kinetic and strain energy ever exceed the work of the load, relative to the largest work. */
static double gain_of(double ratio, int steps) {
    enum { NODES = 10 };
    const double load[6] = {0, 1, 0}, period = 2 * M_PI / 3.516;
    double K[36], M[36], q[7], energy[2], most = 0, gain = 0;
    spar_session *s = NULL;
    OK(NULL, spar_session_create(&s));
    scene_diagonal(K, ratio, ratio, ratio, 1, 1, 1);
    scene_diagonal(M, 1, 1, 1, 2e-4, 1e-4, 1e-4);
    spar_member *b = scene_beam(s, "strip", 1, NODES, 1, K, M);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, NODES - 1, SPAR_LOAD_DEAD, load));
    for (int i = 0; i < steps; i++) {
        scene_run(s, period / steps, 1);
        scene_tip(b, q);
        OK(s, spar_member_get_energy(b, 2, energy));
        most = fmax(most, load[1] * q[1]);
        gain = fmax(gain, energy[0] + energy[1] - load[1] * q[1]);
    }
    spar_session_destroy(&s);
    return gain / most;
}

/* Generalised-alpha itself takes energy out of the motion along the line, and adds none. */
static void test_strip_makes_no_energy(void **state) {
    (void)state;
    for (double ratio = 1e3; ratio < 2e9; ratio *= 1e3) {
        for (int steps = 40; steps <= 640; steps *= 4) {
            double gain = gain_of(ratio, steps);
            print_message("EA L2 / EI %.0e, %d steps a period: %.1e of the work\n", ratio, steps, gain);
            assert_true(gain <= 1e-3);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_strip_makes_no_energy)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
