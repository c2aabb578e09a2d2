/* Stability of periodic states: Mathieu's equation x'' + (a - 2 q cos 2 t) x = 0 by a pendulum of length 1 whose pivot
   goes up and down with an amplitude of q / 2, at 2 rad/s, under the gravity a (upside down where a < 0). Between its
   characteristic numbers a_k and b_k (Abramowitz & Stegun, table 20.1, q = 1) it grows or does not; found by bisection
   of spar_trial_solve_floquet's growth rate, at two dt, right to dt^2. */
#include "trials.h"
#include "verification.h"

static const double pi = 3.14159265358979323846;
enum { COARSE = 100 };

typedef struct pivot {
    spar_member *member;
    double height;
} pivot;

static int shake(spar_session *s, double t, double dt, void *context) {
    const pivot *p = context;
    double wave = 2 * (t + dt), h = p->height;
    const double q[7] = {0, 0, h * (cos(wave) - 1), 1, 0, 0, 0}, v[6] = {0, 0, -2 * h * sin(wave), 0, 0, 0},
                 a[6] = {0, 0, -4 * h * cos(wave), 0, 0, 0};
    (void)s;
    return spar_member_drive(p->member, q, v, a);
}

/* Growth rate and frequency of the pendulum, by so many steps a period. */
static void swing(double a, double q, int steps, double value[2]) {
    const double x[3] = {0}, unit[4] = {1, 0, 0, 0}, zero[3] = {0}, J[3] = {1e-9, 1e-9, 1e-9};
    const double arm[3] = {0, 0, a > 0 ? -1 : 1}, g[3] = {0, 0, -fabs(a)}, dt = pi / steps;
    double M[36];
    pivot p = {.height = 0.5 * q};
    spar_member *bob = NULL;
    spar_joint *j = NULL;
    spar_session *s = scene_session();
    scene_mass(M, 1, zero, J);
    OK(s, spar_rigid_create(s, "pivot", x, unit, M, &p.member));
    OK(s, spar_member_set_root(p.member, SPAR_ROOT_DRIVEN));
    scene_mass(M, 1, arm, J);
    OK(s, spar_rigid_create(s, "bob", x, unit, M, &bob));
    OK(s, spar_joint_create(s, "hinge", bob, 0, p.member, 0, SPAR_FREE_RX, &j));
    OK(s, spar_member_set_root(bob, SPAR_ROOT_FREE));
    OK(s, spar_member_commit(p.member));
    OK(s, spar_member_commit(bob));
    OK(s, spar_session_set_gravity(s, g));
    OK(s, spar_session_set_integrator(s, 1, 1));
    for (int i = 0; i < steps; i++) {
        OK(s, shake(s, i * dt, dt, &p));
        scene_run(s, dt, 1);
    }
    OK(s, trial_floquet(s, dt, steps, 0, shake, NULL, &p, 1, 1, value));
    spar_session_destroy(&s);
}

/* Between `still`, where it does not grow, and `grows`. */
static double limit_of_growth(double q, double still, double grows, int steps) {
    for (int i = 0; i < 30; i++) {
        double a = 0.5 * (still + grows), value[2];
        swing(a, q, steps, value);
        *(value[0] > 1e-5 ? &grows : &still) = a;
    }
    return 0.5 * (still + grows);
}

static void test_limits(void **state) {
    (void)state;
    const struct {
        const char *name;
        double number, still, grows;
    } limit[4] = {{"a0", -0.45513860, -0.3, -0.6},
                  {"b1", -0.11024882, -0.3, 0.3},
                  {"a1", 1.85910807, 2.2, 1.5},
                  {"b2", 3.91702477, 3.6, 4.1}};
    for (int i = 0; i < 4; i++) {
        double coarse = limit_of_growth(1, limit[i].still, limit[i].grows, COARSE);
        double fine = limit_of_growth(1, limit[i].still, limit[i].grows, 2 * COARSE);
        char what[64];
        (void)snprintf(what, sizeof what, "Mathieu, q = 1: %s", limit[i].name);
        verify(what, richardson(coarse, fine), limit[i].number, 2e-6, "Abramowitz & Stegun, table 20.1");
        (void)snprintf(what, sizeof what, "the same: order in dt");
        verify(what, log2((coarse - limit[i].number) / (fine - limit[i].number)), 2, 0.1, "2");
    }
    verified();
}

/* The multiplier that is larger, of x over a period, by 20000 steps of fourth order. */
static double growth_of_hill(double a, double q) {
    const int steps = 20000;
    double h = pi / steps, x[2][2] = {{1, 0}, {0, 1}};
    for (int i = 0; i < steps; i++) {
        for (int k = 0; k < 2; k++) {
            double k1[2], k2[2], k3[2], k4[2], *y = x[k], t = i * h;
            double f0 = a - 2 * q * cos(2 * t), f1 = a - 2 * q * cos(2 * t + h), f2 = a - 2 * q * cos(2 * t + 2 * h);
            k1[0] = y[1], k1[1] = -f0 * y[0];
            k2[0] = y[1] + 0.5 * h * k1[1], k2[1] = -f1 * (y[0] + 0.5 * h * k1[0]);
            k3[0] = y[1] + 0.5 * h * k2[1], k3[1] = -f1 * (y[0] + 0.5 * h * k2[0]);
            k4[0] = y[1] + h * k3[1], k4[1] = -f2 * (y[0] + h * k3[0]);
            for (int n = 0; n < 2; n++) {
                y[n] += h / 6 * (k1[n] + 2 * k2[n] + 2 * k3[n] + k4[n]);
            }
        }
    }
    double half = 0.5 * fabs(x[0][0] + x[1][1]);
    return log(half + sqrt(half * half - 1)) / pi;
}

static void test_growth(void **state) {
    (void)state;
    const double cases[3][2] = {{1, 1}, {1, 0.2}, {-0.8, 0.5}};
    for (int i = 0; i < 3; i++) {
        double value[2][2];
        char what[64];
        swing(cases[i][0], cases[i][1], COARSE, value[0]);
        swing(cases[i][0], cases[i][1], 2 * COARSE, value[1]);
        (void)snprintf(what, sizeof what, "growth rate, a = %g, q = %g", cases[i][0], cases[i][1]);
        verify(what, richardson(value[0][0], value[1][0]), growth_of_hill(cases[i][0], cases[i][1]), 1e-6,
               "Runge and Kutta");
        (void)snprintf(what, sizeof what, "frequency, a = %g, q = %g", cases[i][0], cases[i][1]);
        verify(what, value[1][1], cases[i][0] > 0 ? 1 : 0, 1e-9, "half the pivot's, or none");
    }
    verified();
}

VERIFICATION_MAIN("Periodic states by multipliers", cmocka_unit_test(test_limits), cmocka_unit_test(test_growth))
