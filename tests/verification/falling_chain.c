/* A chain of ten rods on ball joints, 0.1 m and 0.5 kg each, falls from the horizontal: a whip, whose accelerations
   reach 1000 g. Against Runge and Kutta's method of order 4 on its minimal coordinates, the rods' angles theta_k below
   the horizontal, in steps of 0.1 ms (1e-9 rad off at most, by halving them):
   sum_j A_kj cos(theta_k - theta_j) theta_j'' = G_k cos theta_k - sum_j A_kj sin(theta_k - theta_j) theta_j'^2,
   A_kj = m L^2 (n - 1 - max(k, j) + 1/2), its diagonal m L^2 (n - 1 - k + 1/3), G_k = m g L (n - 1/2 - k).
   - Angles and the uppermost joint's load at 0.4 s, extrapolated from steps of 1, 1/2 and 1/4 ms, and their order.
   - The energy of 16000 steps with rho_inf = 1, hanging and let go at 0.05 rad: along the constraints alone the scheme
     takes something out, or the chain flies apart after 8000 (assembly_calm.c).
   - The energy of 4 s in steps of 2 ms, rho_inf = 0.9 and 1, whips of a motion that has become chaotic, in which the
   fastest rod turns by a quarter of a radian a step: the scheme takes some out, and must bring none in. With
   constraints of places alone its accelerations, and the joints' loads, rang from step to step until the chain flew
   apart at 1.5 s, with 38 kJ. */
#include "verification.h"

enum { LINKS = 10 };

static const double length = 0.1, link_mass = 0.5, g = 9.81, upright[4] = {1, 0, 0, 0};

/* ---- minimal coordinates ---- */

/* x := A^-1 x, A symmetric and positive definite; spent */
static void solve(double A[LINKS][LINKS], double x[LINKS]) {
    for (int k = 0; k < LINKS; k++) {
        for (int i = k + 1; i < LINKS; i++) {
            double f = A[i][k] / A[k][k];
            for (int j = k; j < LINKS; j++) {
                A[i][j] -= f * A[k][j];
            }
            x[i] -= f * x[k];
        }
    }
    for (int k = LINKS - 1; k >= 0; k--) {
        for (int j = k + 1; j < LINKS; j++) {
            x[k] -= A[k][j] * x[j];
        }
        x[k] /= A[k][k];
    }
}

/* y: angles, their rates; dy: rates, accelerations */
static void rates_of(const double *y, double *dy) {
    double A[LINKS][LINKS], x[LINKS];
    for (int k = 0; k < LINKS; k++) {
        x[k] = link_mass * g * length * (LINKS - 0.5 - k) * cos(y[k]);
        for (int j = 0; j < LINKS; j++) {
            double m = link_mass * length * length * (LINKS - 1 - (k > j ? k : j) + (k == j ? 1. / 3 : 0.5));
            A[k][j] = m * cos(y[k] - y[j]);
            x[k] -= m * sin(y[k] - y[j]) * y[LINKS + j] * y[LINKS + j];
        }
    }
    solve(A, x);
    memcpy(dy, y + LINKS, LINKS * sizeof *dy);
    memcpy(dy + LINKS, x, sizeof x);
}

/* From rest along x. */
static void fall(double t, double h, double y[2 * LINKS]) {
    const double at[4] = {0, 0.5, 0.5, 1}, weight[4] = {1. / 6, 1. / 3, 1. / 3, 1. / 6};
    memset(y, 0, 2 * LINKS * sizeof *y);
    for (int n = 0; n < (int)(t / h + 0.5); n++) {
        double k[2 * LINKS] = {0}, z[2 * LINKS], sum[2 * LINKS] = {0};
        for (int stage = 0; stage < 4; stage++) {
            for (int i = 0; i < 2 * LINKS; i++) {
                z[i] = y[i] + at[stage] * h * k[i];
            }
            rates_of(z, k);
            for (int i = 0; i < 2 * LINKS; i++) {
                sum[i] += weight[stage] * h * k[i];
            }
        }
        for (int i = 0; i < 2 * LINKS; i++) {
            y[i] += sum[i];
        }
    }
}

/* What holds the chain up: the momentum of all rods changes by it and their weight. Along x and z. */
static void load_of(const double *y, double load[2]) {
    double dy[2 * LINKS], a[2] = {0};
    rates_of(y, dy);
    load[0] = 0, load[1] = LINKS * link_mass * g;
    for (int k = 0; k < LINKS; k++) {
        double w2 = y[LINKS + k] * y[LINKS + k], aw = dy[LINKS + k],
               along[2] = {-length * (cos(y[k]) * w2 + sin(y[k]) * aw), length * (sin(y[k]) * w2 - cos(y[k]) * aw)};
        for (int i = 0; i < 2; i++) {
            load[i] += link_mass * (a[i] + 0.5 * along[i]);
            a[i] += along[i];
        }
    }
}

/* ---- bodies on joints ---- */

typedef struct chain {
    spar_session *s;
    spar_member *link[LINKS];
    spar_joint *ball[LINKS];
} chain;

static chain hang(double rho) {
    const double J = link_mass * length * length / 12, inertia[3] = {0.1 * J, J, J}, centre[3] = {0.5 * length, 0, 0};
    double mass[36];
    chain c = {.s = scene_session()};
    scene_mass(mass, link_mass, centre, inertia);
    OK(c.s, spar_session_set_gravity(c.s, (double[]){0, 0, -g}));
    OK(c.s, spar_session_set_integrator(c.s, rho, 1));
    for (int i = 0; i < LINKS; i++) {
        const double x[3] = {i * length, 0, 0};
        char name[16];
        snprintf(name, sizeof name, "link %d", i);
        OK(c.s, spar_rigid_create(c.s, name, x, upright, mass, &c.link[i]));
        OK(c.s, spar_member_commit(c.link[i]));
        OK(c.s, spar_joint_create(c.s, name, c.link[i], 0, i ? c.link[i - 1] : NULL, 0,
                                  SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ, &c.ball[i]));
        OK(c.s, spar_joint_set_frame(c.ball[i], x, upright));
    }
    return c;
}

enum { FIGURES = LINKS + 2 };

/* The rods' angles, and what holds the first. */
static void figures(double dt, double t, double x[FIGURES]) {
    chain c = hang(0.9);
    double q[7], load[6];
    scene_run(c.s, dt, (int64_t)(t / dt + 0.5));
    for (int i = 0; i < LINKS; i++) {
        OK(c.s, spar_member_get_motion(c.link[i], q, NULL, NULL));
        x[i] = 2 * atan2(q[5], q[3]);
    }
    OK(c.s, spar_joint_get_load(c.ball[0], load));
    x[LINKS] = load[0], x[LINKS + 1] = load[2];
    spar_session_destroy(&c.s);
}

/* Of the largest errors of figures `from` on, before `end`. */
static double order_of(double x[3][FIGURES], const double *exact, int from, int end) {
    double error[3] = {0};
    for (int i = from; i < end; i++) {
        for (int k = 1; k < 3; k++) {
            error[k] = fmax(error[k], fabs(x[k][i] - exact[i]));
        }
    }
    return log2(error[1] / error[2]);
}

static void test_fall(void **state) {
    (void)state;
    const double t = 0.4;
    double y[2 * LINKS], finer[2 * LINKS], exact[FIGURES], x[3][FIGURES];
    fall(t, 1e-4, y);
    fall(t, 5e-5, finer);
    for (int i = 0; i < LINKS; i++) {
        exact[i] = y[i];
        NEAR(finer[i], y[i], 1e-9);
    }
    load_of(y, exact + LINKS);
    for (int k = 0; k < 3; k++) {
        figures(1e-3 / (1 << k), t, x[k]);
    }
    for (int i = 0; i < FIGURES; i++) {
        char name[32], what[64];
        if (i < LINKS) {
            snprintf(name, sizeof name, "angle of rod %d", i + 1);
        } else {
            snprintf(name, sizeof name, "upper load, %s", i == LINKS ? "x" : "z");
        }
        snprintf(what, sizeof what, "chain at 0.4 s: %s", name);
        verify(what, richardson_3(x[0][i], x[1][i], x[2][i], 4), exact[i], 1e-6 * fmax(1, fabs(exact[i])),
               "Runge-Kutta");
    }
    verify("chain: order, angles", order_of(x, exact, 0, LINKS), 2, 0.05, "generalised-alpha");
    verify("chain: order, upper load", order_of(x, exact, LINKS, FIGURES), 2, 0.05, "generalised-alpha");
    verified();
}

static double energy_of(const chain *c) {
    double sum = 0, e[SPAR_ENERGY_COUNT];
    for (int i = 0; i < LINKS; i++) {
        OK(c->s, spar_member_get_energy(c->link[i], SPAR_ENERGY_COUNT, e));
        sum += e[SPAR_ENERGY_KINETIC] + e[SPAR_ENERGY_GRAVITY];
    }
    return sum;
}

/* How far the energy goes below and above that of the start. */
static void run_chain(const chain *c, double dt, int steps, double *least, double *most, double *fastest) {
    double begin = energy_of(c), v[6];
    *least = *most = *fastest = 0;
    for (int n = 0; n < steps; n++) {
        OK(c->s, spar_step(c->s, dt, NULL, NULL, NULL));
        double change = energy_of(c) - begin;
        *least = fmin(*least, change), *most = fmax(*most, change);
        for (int i = 0; i < LINKS; i++) {
            OK(c->s, spar_member_get_motion(c->link[i], NULL, v, NULL));
            *fastest = fmax(*fastest, fabs(v[4]));
        }
    }
}

static void test_whips(void **state) {
    (void)state;
    for (int keeps = 0; keeps <= 1; keeps++) {
        chain c = hang(keeps ? 1 : 0.9);
        double least, most, fastest;
        run_chain(&c, 2e-3, 2000, &least, &most, &fastest);
        verify(keeps ? "chain, rho_inf 1, 4 s of whips: energy brought in, J of 24"
                     : "chain, 4 s of whips: energy brought in, J of 24",
               most, 0, 1, "invariant");
        verify(keeps ? "chain, rho_inf 1, 4 s of whips: energy taken out, J of 24"
                     : "chain, 4 s of whips: energy taken out, J of 24",
               -least, 0, 8, "invariant");
        assert_true(fastest > 60);
        spar_session_destroy(&c.s);
    }
    verified();
}

/* 0.03 J of the swing, of which 1e-5 may go in or out in 64 s. */
static void test_long_swing(void **state) {
    (void)state;
    const double tilt = 0.05;
    chain c = hang(1);
    double least, most, fastest;
    OK(c.s, spar_session_set_gravity(c.s, (double[]){g * cos(tilt), 0, -g * sin(tilt)}));
    run_chain(&c, 4e-3, 16000, &least, &most, &fastest);
    verify("chain, rho_inf 1, 16000 steps: energy in, J of 0.03", most, 0, 3e-7, "invariant");
    verify("chain, rho_inf 1, 16000 steps: energy out, J of 0.03", -least, 0, 3e-7, "invariant");
    spar_session_destroy(&c.s);
    verified();
}

VERIFICATION_MAIN("Falling chain", cmocka_unit_test(test_fall), cmocka_unit_test(test_whips),
                  cmocka_unit_test(test_long_swing))
