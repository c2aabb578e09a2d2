/* All defaults with a heavy fluid. Set-up: a body of 2 kg on a spring that holds it to the ground, in a fluid that
   pushes a load b(t) and the load of its added mass. The oracles know nothing of the coupling: a body with both masses
   under b(t) alone, by the same time integration, and the closed form of the same equation. Expected: within 1e-6 of
   the first for any added mass. */
#include "support/sprung.h"

#include <stdio.h>

enum { STEPS = 200 };

static void test_heavy_body(void **state) {
    (void)state;
    static const double ratios[] = {0.2, 0.5, 1, 4, 100};
    const double dt = 0.02, omega = 2 * pi / period;
    for (size_t r = 0; r < sizeof ratios / sizeof *ratios; r++) {
        sprung w, whole;
        double off = 0, form = 0, most = 0;
        create(&w, body_mass, ratios[r] * body_mass);
        create(&whole, (1 + ratios[r]) * body_mass, 0);
        OK(whole.s, spar_session_set_newton(whole.s, 1e-15, 1e-12, 50));
        /* its loads do not depend on the motion: the second evaluation confirms the first */
        OK(whole.s, spar_session_set_coupling(whole.s, SPAR_COUPLING_FIXED_POINT, 0, 1e-14, 2));
        w.load = whole.load = slow;
        for (int i = 0; i < STEPS; i++) {
            double x[3], y[3], t = (i + 1) * dt;
            OK(w.s, spar_step(w.s, dt, solve, &w, NULL));
            OK(whole.s, spar_step(whole.s, dt, solve, &whole, NULL));
            place(&w, x), place(&whole, y);
            /* M x'' + k x = sin(4 t) from rest */
            double exact = (sin(4 * t) - 4 / omega * sin(omega * t)) / (whole.mass * (omega * omega - 16));
            for (int k = 0; k < 3; k++) {
                off = fmax(off, fabs(x[k] - y[k]));
                most = fmax(most, fabs(y[k]));
            }
            form = fmax(form, fabs(x[0] - exact));
        }
        print_message("added mass %g: off by %.1e of the oracle, %.1e of the closed form; %.2f evaluations a step\n",
                      ratios[r], off / most, form / most, (double)w.calls / STEPS);
        assert_true(off <= 1e-6 * most);
        assert_true(form <= 2e-2 * most); /* dt */
        spar_session_destroy(&w.s), spar_session_destroy(&whole.s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_heavy_body)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
