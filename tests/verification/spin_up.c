/* Spin-up manoeuvre: Simo & Vu-Quoc, J. Appl. Mech. 53 (1986). Root driven about z by psi(t), constant rate 6 rad/s
   after 15 s; tip relative to the frame that turns with the root. Table: converged solution of the exact equations, 7
   digits, taken as five units of the seventh digit of the largest value. At dt, dt/2 and dt/4 and extrapolated: with
   meshes of 2 x 8, 3 x 8, 4 x 8 and 1 x 12 nodes, rho_inf 0.8 and 1, dt 5e-3 and 4e-3 the figures differ by 1e-8 at
   most. */
#include "verification.h"

static const double pi = 3.14159265358979323846, ramp = 15;

static void drive(spar_session *s, spar_member *b, double t, double *psi) {
    double f = 2 * pi / ramp, rate, acceleration;
    if (t <= ramp) {
        *psi = 6 / ramp * (t * t / 2 + (cos(f * t) - 1) / (f * f));
        rate = 6 / ramp * (t - sin(f * t) / f);
        acceleration = 6 / ramp * (1 - cos(f * t));
    } else {
        *psi = 6 * t - 45, rate = 6, acceleration = 0;
    }
    double q[7] = {0, 0, 0, cos(*psi / 2), 0, 0, sin(*psi / 2)}, v[6] = {0, 0, 0, 0, 0, rate},
           a[6] = {0, 0, 0, 0, 0, acceleration};
    OK(s, spar_member_drive(b, q, v, a));
}

enum { TIMES = 11 };
static const double largest[3] = {1.861826e-2, 5.738348e-1, 7.678033e-2};
static const double table[TIMES][4] = {
    {1, -2.436340e-5, -2.054353e-2, -2.792813e-3},  {2, -6.059015e-4, -1.023806e-1, -1.395858e-2},
    {4, -6.766007e-3, -3.422786e-1, -4.663605e-2},  {5, -1.265464e-2, -4.684762e-1, -6.371673e-2},
    {6, -1.697125e-2, -5.435964e-1, -7.359917e-2},  {7, -1.861826e-2, -5.713118e-1, -7.678033e-2},
    {8, -1.662992e-2, -5.428415e-1, -7.223516e-2},  {10, -7.072330e-3, -3.628143e-1, -4.723698e-2},
    {12, -8.039874e-4, -1.509007e-1, -1.935938e-2}, {13, 2.333594e-4, -6.921544e-2, -8.847991e-3},
    {15, 5.139897e-4, 1.303577e-3, 1.677405e-4}};

typedef struct spin {
    double at[TIMES][3]; /* u1, u2, phi */
    double least, when;  /* of u2 */
    double mean;         /* of u1 over whole vibrations after the ramp */
} spin;

static void run(double dt, double end, double rho, spin *out) {
    double K[36], M[36], h[3] = {0};
    scene_diagonal(K, 2.8e7, 1e7, 1e7, 1.4e4, 1.4e4, 1.4e4);
    scene_diagonal(M, 1.2, 1.2, 1.2, 12e-4, 6e-4, 6e-4);
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "arm", 2, 8, 10, K, M);
    OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
    OK(s, spar_member_commit(b));
    OK(s, spar_session_set_integrator(s, rho, 1));
    OK(s, spar_session_set_newton(s, 1e-12, 1e-12, 20));
    int next = 0, per_second = (int)(1 / dt + 0.5), count = 0;
    memset(out, 0, sizeof *out);
    for (int k = 1; k <= (int)(end * per_second + 0.5); k++) {
        double psi, q[7], turn[4], x[3], u[3], t = (double)k / per_second;
        drive(s, b, t, &psi);
        scene_run(s, 1.0 / per_second, 1);
        scene_tip(b, q);
        double frame[4] = {cos(psi / 2), 0, 0, sin(psi / 2)};
        x[0] = 10 + q[0], x[1] = q[1], x[2] = q[2];
        spari_rotate_back(frame, x, u);
        frame[3] = -frame[3];
        spari_quat_mul(frame, q + 3, turn);
        u[0] -= 10;
        if (next < TIMES && k == (int)table[next][0] * per_second) {
            out->at[next][0] = u[0], out->at[next][1] = u[1], out->at[next++][2] = 2 * atan2(turn[3], turn[0]);
        }
        if (k > 2 && h[1] < h[0] && h[1] < u[1] && h[1] < out->least) {
            double slope = 0.5 * (u[1] - h[0]), bend = h[0] - 2 * h[1] + u[1];
            out->least = h[1] - slope * slope / (2 * bend);
            out->when = t - (1 + slope / bend) / per_second;
        }
        if (t > ramp) {
            out->mean += u[0];
            count++;
        }
        h[0] = h[1], h[1] = u[1];
    }
    out->mean /= count > 0 ? count : 1;
    spar_session_destroy(&s);
}

static void test_spin_up(void **state) {
    (void)state;
    spin r[3];
    double dt = verification_long() ? 2e-3 : 5e-3, worst[2] = {0, 0};
    const char *names[] = {"u1", "u2", "phi"};
    for (int k = 0; k < 3; k++) {
        run(dt / (1 << k), ramp, 0.8, &r[k]);
    }
    for (int i = 0; i < TIMES; i++) {
        for (int k = 0; k < 3; k++) {
            char what[64];
            double got = richardson_3(r[0].at[i][k], r[1].at[i][k], r[2].at[i][k], 3), value = table[i][1 + k];

            snprintf(what, sizeof what, "t = %g: %s", table[i][0], names[k]);
            verify(what, got, value, 5e-7 * largest[k], "exact equations, 7 digits");
            if (k == 1) {
                worst[0] = fmax(worst[0], fabs(r[0].at[i][k] - got));
                worst[1] = fmax(worst[1], fabs(r[1].at[i][k] - got));
            }
        }
    }
    verify("order in dt of u2", log2(worst[0] / worst[1]), 2, 0.1, "generalised-alpha");
    verify("least u2", richardson(r[1].least, r[2].least), -5.738348e-1, 2e-7, "exact equations, 7 digits");
    verify("time of the least u2", richardson(r[1].when, r[2].when), 6.762, 1e-3, "exact equations, 4 digits");
    verified();
}

/* After the ramp the arm turns at 6 rad/s; undamped vibrations of u2 below 4.4e-3 ride on the steady extension rho A
   omega^2 L^3 / (3 EA) and shorten the tip by up to 6 u2^2 / (5 L) = 2.3e-6. */
static void test_steady_extension(void **state) {
    (void)state;
    spin r;
    run(1e-2, 30, 0.8, &r);
    verify("mean u1 after the ramp", r.mean, 1.2 * 36 * 1000 / (3 * 2.8e7), 2.3e-6, "rhoA omega^2 L^3 / 3 EA");
    verified();
}

VERIFICATION_MAIN("Spin-up manoeuvre (Simo & Vu-Quoc 1986)", cmocka_unit_test(test_spin_up),
                  cmocka_unit_test(test_steady_extension))
