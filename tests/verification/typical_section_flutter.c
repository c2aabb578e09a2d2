/* Flutter of the typical section HP-1 (Hodges & Pierce): a = -1/5, e = -1/10, mu = 20, r^2 = 6/25, sigma = 2/5, b = 1,
   omega_alpha = 1, with Theodorsen's loads at C(k) = 1 (quasi-steady, with added mass): V_F = 0.93764931, eigenvalues
   of a 4 x 4 matrix. A rigid body of mass 1; springs and air are the fluid. 100 steps a period, integrator without
   damping. The growth rate of pitch from t = 150, when plunge (which decays with -0.06) has gone, to 600, at 0.99
   and 1.01 V_F: below it shrinks, above it grows; V_F by interpolation. Small angles: 1e-4. */
#include "verification.h"

static const double pi = 3.14159265358979323846;
static const double a = -0.2, e = -0.1, mu = 20, r2 = 0.24, sigma = 0.4, flutter = 0.93764931;

typedef struct host {
    spar_member *section;
    spar_fluid *air;
    double V;
} host;

/* Plunge h is down, pitch nose up; the body's x runs along the span, y aft, z up: u_z = -h, turn about x = -pitch. */
static int air(spar_session *s, double t, double dt, int iteration, void *context) {
    host *wing = context;
    double q[7], v[6], acc[6], V = wing->V;
    (void)t;
    (void)dt;
    (void)iteration;
    OK(s, spar_member_get_motion(wing->section, q, v, acc));
    double h = -q[2], h1 = -v[2], h2 = -acc[2], p = -2 * atan2(q[4], q[3]), p1 = -v[3], p2 = -acc[3];
    double wash = h1 + V * p + (0.5 - a) * p1;
    double lift = pi * (h2 + V * p1 - a * p2) + 2 * pi * V * wash;
    double moment = pi * (a * h2 - V * (0.5 - a) * p1 - (0.125 + a * a) * p2) + 2 * pi * V * (a + 0.5) * wash;
    double f[3] = {0, 0, lift / (pi * mu) + sigma * sigma * h}, m[3] = {-(moment / (pi * mu) - r2 * p), 0, 0};
    return spar_fluid_push_forces(wing->air, f, m);
}

/* Mean rate at which the peaks of pitch grow between 150 and 600 */
static double growth(double V, int scheme) {
    static const double unit[4] = {1, 0, 0, 0}, place[3] = {0, 0, 0}, rest[3] = {0, 0, 0}, omega[3] = {1e-4, 0, 0};
    const double c[3] = {0, e - a, 0}, J[3] = {r2 - (e - a) * (e - a), 1, 1}, dt = 2 * pi / 0.94 / 100;
    double M[36], q[7], peak[2] = {0, 0};
    host wing = {.V = V};
    spar_session *s = scene_session();
    OK(s, spar_session_set_integrator(s, 1, 1));
    OK(s, spar_session_set_coupling(s, scheme, 0, 1e-9, 50));
    scene_mass(M, 1, c, J);
    OK(s, spar_rigid_create(s, "section", place, unit, M, &wing.section));
    OK(s, spar_member_set_initial_velocity(wing.section, place, rest, omega));
    OK(s, spar_member_commit(wing.section));
    OK(s, spar_fluid_create(wing.section, "air", &wing.air));
    OK(s, spar_fluid_set_force_nodes(wing.air, 1, place));
    OK(s, spar_fluid_map(wing.air));
    for (double t = 0; t < 600; t += dt) {
        OK(s, spar_step(s, dt, air, &wing, NULL));
        OK(s, spar_member_get_motion(wing.section, q, NULL, NULL));
        double pitch = fabs(2 * atan2(q[4], q[3]));
        int window = t > 150 && t < 170 ? 0 : t > 580 ? 1 : -1;
        if (window >= 0) {
            peak[window] = fmax(peak[window], pitch);
        }
    }
    spar_session_destroy(&s);
    return log(peak[1] / peak[0]) / 430;
}

static void test_flutter_speed(void **state) {
    (void)state;
    static const char *const name[] = {"explicit, linear predictor", "fixed point", "Aitken", "IQN-ILS"};
    for (int scheme = SPAR_COUPLING_EXPLICIT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
        char what[80];
        double below = growth(0.99 * flutter, scheme), above = growth(1.01 * flutter, scheme);
        (void)snprintf(what, sizeof what, "flutter speed, %s", name[scheme]);
        verify(what, flutter * (0.99 - 0.02 * below / (above - below)), flutter, 0.01 * flutter,
               "Hodges & Pierce; eigenvalues");
        (void)snprintf(what, sizeof what, "sign of growth 1 %% below and above, %s", name[scheme]);
        verify(what, (above > 0) - (below > 0), 1, 0, "Hodges & Pierce; eigenvalues");
    }
    verified();
}

VERIFICATION_MAIN("Flutter of a typical section", cmocka_unit_test(test_flutter_speed))
