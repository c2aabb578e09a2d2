/* Free rigid bodies: Jacobi's elliptic functions for J = diag(1, 2, 3), the axisymmetric body of Kynema-FMB's
   precession test, and the flip time of a body that spins near its middle axis (Dzhanibekov). Order 2; extrapolated
   from dt 4e-3, 2e-3, 1e-3. */
#include "verification.h"

#include <gsl/gsl_sf_ellint.h>

static void turn(const double J[3], const double w[3], double dt, double rho, double end, double q[4], double body[3],
                 double *momentum) {
    const double c[3] = {0, 0, 0};
    double M[36], motion[7], v[6], h[3], L[3], lost[3];
    spar_session *s = scene_session();
    spar_member *r;
    scene_mass(M, 2, c, J);
    OK(s, spar_rigid_create(s, "body", c, NULL, M, &r));
    OK(s, spar_member_commit(r));
    OK(s, spar_member_set_initial_velocity(r, c, c, w));
    OK(s, spar_session_set_integrator(s, rho, 1));
    OK(s, spar_session_set_newton(s, 1e-14, 1e-14, 30));
    scene_run(s, dt, (int64_t)(end / dt + 0.5));
    OK(s, spar_member_get_motion(r, motion, v, NULL));
    memcpy(q, motion + 3, 4 * sizeof *q);
    spari_rotate_back(q, v + 3, body);
    for (int i = 0; i < 3; i++) {
        h[i] = J[i] * body[i];
    }
    spari_rotate(q, h, L);
    for (int i = 0; i < 3; i++) {
        lost[i] = L[i] - J[i] * w[i];
    }
    *momentum = spari_norm(lost);
    spar_session_destroy(&s);
}

static void compare(const char *name, const double J[3], const double w[3], double end, const double q[4],
                    const double *body) {
    double got[3][4], rate[3][3], lost[3], e[2] = {0, 0};
    char what[64];
    for (int k = 0; k < 3; k++) {
        turn(J, w, 1e-3 / (1 << k), 0.8, end, got[k], rate[k], &lost[k]);
        for (int i = 0; i < 4; i++) {
            got[k][i] *= k > 0 && got[k][0] * got[0][0] < 0 ? -1 : 1;
        }
    }
    double sign = spari_quat_dot(got[2], q) < 0 ? -1 : 1;
    for (int i = 0; i < 4; i++) {
        snprintf(what, sizeof what, "%s, t = %g: quaternion %c", name, end, "wxyz"[i]);
        verify(what, sign * richardson_3(got[0][i], got[1][i], got[2][i], 3), q[i], 1e-9, "elliptic functions");
        e[0] = fmax(e[0], fabs(sign * got[1][i] - q[i])), e[1] = fmax(e[1], fabs(sign * got[2][i] - q[i]));
    }
    for (int i = 0; body && i < 3; i++) {
        snprintf(what, sizeof what, "%s, t = %g: body rate %d", name, end, i + 1);
        verify(what, richardson_3(rate[0][i], rate[1][i], rate[2][i], 3), body[i], 1e-8, "elliptic functions");
    }
    snprintf(what, sizeof what, "%s, t = %g: order of the turn", name, end);
    verify(what, log2(e[0] / e[1]), 2, 0.1, "generalised-alpha");
    snprintf(what, sizeof what, "%s, t = %g: |q|", name, end);
    verify(what, sqrt(spari_quat_dot(got[2], got[2])), 1, 1e-14, "unit quaternion");
    snprintf(what, sizeof what, "%s, t = %g: angular momentum lost", name, end);
    verify(what, lost[2], 0, 1e-6, "conserved, second order");
}

static void test_jacobi(void **state) {
    (void)state;
    const double J[3] = {1, 2, 3}, w[3] = {1, 1, 1};
    const double q[4][4] = {{0.6874647329811, 0.1752015919558, 0.54071725242305, 0.45201935358504},
                            {-0.782606016022353, 0.345983656169568, -0.000346353972507, -0.517516195803108},
                            {0.46254544055464, -0.31433514514461, 0.0494296312793, 0.82752754848441},
                            {-0.37618492158354, 0.1001924456978, 0.5755227789511, 0.71918002579791}};
    const double rate[4][3] = {{-0.12664292289242, 1.40853170716221, 0.81976387452297},
                               {1.00798033098342, -0.99195546893525, 1.00266716771643},
                               {-0.60347042309252, -1.27899313854788, 0.88772678821573},
                               {0.18293703838386, 1.40233164407972, 0.82329945139717}};
    const double end[4] = {1, 5, 10, 20};
    for (int k = 0; k < 4; k++) {
        compare("J = 1, 2, 3", J, w, end[k], q[k], rate[k]);
    }
    verified();
}

static void test_precession(void **state) {
    (void)state;
    const double J[3] = {1, 1, 0.5}, w[3] = {0.5, 0.5, 1};
    const double five[4] = {-0.63051414583894, 0.60480498494019, -0.30312423905729, -0.38049775003859};
    const double one[4] = {0.81955116035667, 0.29466531251745, 0.17479294030796, 0.45929911514777};
    compare("J = 1, 1, 1/2", J, w, 1, one, NULL);
    compare("J = 1, 1, 1/2", J, w, 5, five, NULL);
    verified();
}

/* J = (3, 2, 1), omega(0) = (.01, 5, .01): omega_2 = const sn(n t + c, k), zero every 2 K(k) / n, with n^2 = (I1 -
   I2)(L^2
   - 2 T I3) / (I1 I2 I3), k^2 = (I2 - I3)(2 T I1 - L^2) / ((I1 - I2)(L^2 - 2 T I3)) where L^2 > 2 T I2 (Landau &
   Lifshitz, Mechanics, par. 37). Times of the passages by the cubic through values and slopes of a step's two ends. */
static double flip_time(double dt) {
    const double J[3] = {3, 2, 1}, w[3] = {0.01, 5, 0.01}, c[3] = {0, 0, 0};
    double M[36], q[7], v[6], body[3], last[3], first = 0, time = 0;
    spar_session *s = scene_session();
    spar_member *r;
    scene_mass(M, 1, c, J);
    OK(s, spar_rigid_create(s, "body", c, NULL, M, &r));
    OK(s, spar_member_commit(r));
    OK(s, spar_member_set_initial_velocity(r, c, c, w));
    OK(s, spar_session_set_integrator(s, 1, 1));
    OK(s, spar_session_set_newton(s, 1e-18, 1e-14, 30)); /* a step rotates by 5e-4, and errors grow exponentially */
    memcpy(last, w, sizeof last);
    for (int n = 1; time <= 0; n++) {
        scene_run(s, dt, 1);
        OK(s, spar_member_get_motion(r, q, v, NULL));
        spari_rotate_back(q + 3, v + 3, body);
        if (last[1] * body[1] < 0) {
            double slope0 = dt * last[0] * last[2] * (J[2] - J[0]) / J[1], x = last[1] / (last[1] - body[1]),
                   slope1 = dt * body[0] * body[2] * (J[2] - J[0]) / J[1];
            for (int k = 0; k < 20; k++) {
                double y = x - 1, h = (1 + 2 * x) * y * y * last[1] + x * y * y * slope0 +
                                      x * x * (1 - 2 * y) * body[1] + x * x * y * slope1;
                x -= h / (body[1] - last[1]);
            }
            double t = (n - 1 + x) * dt;
            time = first > 0 ? t - first : 0;
            first = t;
        }
        memcpy(last, body, sizeof last);
    }
    spar_session_destroy(&s);
    return time;
}

static void test_dzhanibekov(void **state) {
    (void)state;
    const double J[3] = {3, 2, 1}, w[3] = {0.01, 5, 0.01};
    double T2 = 0, L2 = 0;
    for (int i = 0; i < 3; i++) {
        T2 += J[i] * w[i] * w[i];
        L2 += J[i] * J[i] * w[i] * w[i];
    }
    double n = sqrt((J[0] - J[1]) * (L2 - T2 * J[2]) / (J[0] * J[1] * J[2]));
    double k = sqrt((J[1] - J[2]) * (T2 * J[0] - L2) / ((J[0] - J[1]) * (L2 - T2 * J[2])));
    double flip = 2 * gsl_sf_ellint_Kcomp(k, GSL_PREC_DOUBLE) / n;
    double a = flip_time(4e-4), b = flip_time(2e-4), c = flip_time(1e-4);
    verify("Dzhanibekov: time between flips", richardson_3(a, b, c, 3), flip, 1e-6, "elliptic integral");
    verified();
}

/* Euler's period for J = (1, 2, 3), omega(0) = (1, 1, 1): 6.422703084225694; after it the rates are back */
static void test_period(void **state) {
    (void)state;
    const double J[3] = {1, 2, 3}, w[3] = {1, 1, 1}, period = 6.422703084225694;
    double q[4], rate[3][3], lost;
    for (int k = 0; k < 3; k++) {
        turn(J, w, period / (8000 << k), 0.8, period, q, rate[k], &lost);
    }
    for (int i = 0; i < 3; i++) {
        char what[64];
        snprintf(what, sizeof what, "after one period: body rate %d", i + 1);
        verify(what, richardson_3(rate[0][i], rate[1][i], rate[2][i], 3), 1, 1e-9, "elliptic integral");
    }
    verified();
}

VERIFICATION_MAIN("Free rigid bodies", cmocka_unit_test(test_jacobi), cmocka_unit_test(test_precession),
                  cmocka_unit_test(test_dzhanibekov), cmocka_unit_test(test_period))
