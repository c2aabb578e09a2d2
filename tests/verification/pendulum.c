/* Pendulum: period T / T0 = (2 / pi) K(sin^2(theta / 2)) for a swing from rest at theta; T0 = 2 pi sqrt(I / (m g c)).
   Four times the time to the lowest place, by the cubic through angles and rates of a step's two ends; dt = T0 / 500
   and halves, extrapolated. Near the top small errors grow: 179 degrees to 1e-6, else 1e-8. */
#include "verification.h"

#include <gsl/gsl_sf_ellint.h>

static const double pi = 3.14159265358979323846;

static double period(double degrees, int per_period) {
    const double J[3] = {0.02, 0.01, 0.02}, c[3] = {0, -0.7, 0}, zero[3] = {0, 0, 0}, g[3] = {0, -9.81, 0};
    double a = degrees * pi / 180, start[4] = {cos(a / 2), 0, 0, sin(a / 2)}, M[36], q[7], v[6];
    double I = J[2] + 1.3 * 0.49, T0 = 2 * pi * sqrt(I / (1.3 * 9.81 * 0.7)), dt = T0 / per_period, last[2] = {a, 0};
    spar_session *s = scene_session();
    spar_member *r;
    scene_mass(M, 1.3, c, J);
    OK(s, spar_session_set_gravity(s, g));
    OK(s, spar_rigid_create(s, "pendulum", zero, start, M, &r));
    OK(s, spar_member_set_root(r, SPAR_ROOT_PINNED));
    OK(s, spar_member_commit(r));
    OK(s, spar_session_set_integrator(s, 1, 1));
    OK(s, spar_session_set_newton(s, 1e-14, 1e-14, 30));
    for (int n = 1;; n++) {
        scene_run(s, dt, 1);
        OK(s, spar_member_get_motion(r, q, v, NULL));
        double now[2] = {a + 2 * atan2(q[6], q[3]), v[5]};
        if (now[0] <= 0) {
            double x = last[0] / (last[0] - now[0]);
            for (int k = 0; k < 30; k++) {
                double y = x - 1, h = (1 + 2 * x) * y * y * last[0] + x * y * y * dt * last[1] +
                                      x * x * (1 - 2 * y) * now[0] + x * x * y * dt * now[1];
                x -= h / (now[0] - last[0]);
            }
            spar_session_destroy(&s);
            return 4 * (n - 1 + x) * dt / T0;
        }
        memcpy(last, now, sizeof last);
    }
}

static void test_periods(void **state) {
    (void)state;
    const double table[5][2] = {{10, 1.0019071881432},
                                {45, 1.0399733431968},
                                {90, 1.1803405990161},
                                {150, 1.7622037295038},
                                {179, 3.9010651603891}};
    for (int k = 0; k < 5; k++) {
        double a = period(table[k][0], 500), b = period(table[k][0], 1000), c = period(table[k][0], 2000);
        char what[64];
        snprintf(what, sizeof what, "swing of %g deg: T / T0", table[k][0]);
        verify(what, richardson_3(a, b, c, 4), table[k][1], k < 4 ? 1e-8 : 1e-6, "elliptic integral");
        snprintf(what, sizeof what, "swing of %g deg: order", table[k][0]);
        verify(what, log2((a - table[k][1]) / (b - table[k][1])), 2, 0.1, "generalised-alpha");
    }
    verified();
}

VERIFICATION_MAIN("Pendulum", cmocka_unit_test(test_periods))
