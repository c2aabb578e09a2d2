/* Closed mechanisms of rigid bodies on hinges, with more holds than a plane mechanism needs.
   - Andrews' squeezing mechanism: seven bodies, ten hinges, a spring, a motor at the crank (Giles 1978, Manning 1981;
     Hairer & Wanner, Solving ODEs II, VII.7; the angles at 0.03 s from the test set for IVP solvers, Mazzia & Magherini
     2008, 14 digits). Step 20 us and halves, extrapolated: the crank turns 15.8 rad.
   - Bricard's mechanism: six edges of a cube, each turning about the next by a hinge square to both; one is the ground.
     It moves though counted it cannot (30 unknowns, 30 holds). Under gravity: energy, to second order. */
#include "verification.h"

static const double straight[4] = {1, 0, 0, 0}, nothing[3] = {0};

/* ---- Andrews' squeezer ---- */

enum { K1, K2, K3, K4, K5, K6, K7, BODIES };
enum { BETA, THETA, GAMMA, PHI, DELTA, OMEGA, EPSILON };

static const double angle_0[7] = {
    -0.0617138900142764496, 0, 0.455279819163070380, 0.222668390165885885, 0.487364979543842550, -0.222668390165885885,
    1.23054744454982120};
static const double angle_end[7] = {15.81077119629904,  -15.75637105984298, 0.04082224013073101, -0.5347301163226948,
                                    0.5244099658805304, 0.5347301163226948, 1.048080741042263};
static const double rr = 7e-3, ra = 92e-5, d = 28e-3, da = 115e-4, e = 2e-2, ea = 1421e-5, zf = 2e-2, fa = 1421e-5,
                    ss = 35e-3, sa = 1874e-5, sb = 1043e-5, sc = 18e-3, sd = 2e-2, zt = 4e-2, ta = 2308e-5, tb = 916e-5,
                    u = 4e-2, ua = 1228e-5, ub = 449e-5;
static const double A[3] = {-0.06934, -0.00227, 0}, B[3] = {-0.03635, 0.03273, 0}, C[3] = {0.014, 0.072, 0};

/* to = from + x along `angle` + y square to it */
static void go(const double from[3], double angle, double x, double y, double to[3]) {
    to[0] = from[0] + x * cos(angle) - y * sin(angle);
    to[1] = from[1] + x * sin(angle) + y * cos(angle);
    to[2] = 0;
}

typedef struct squeezer {
    spar_session *s;
    spar_member *body[BODIES];
    spar_joint *hinge[10];
    int hinges;
} squeezer;

/* its angle grows with that of a; b: -1 is the ground */
static void squeezer_hinge(squeezer *k, int a, int b, const double at[3]) {
    char name[24];
    spar_joint **j = &k->hinge[k->hinges];
    snprintf(name, sizeof name, "hinge %d", k->hinges++);
    OK(k->s, spar_joint_create(k->s, name, k->body[a], 0, b < 0 ? NULL : k->body[b], 0, SPAR_FREE_RZ, j));
    OK(k->s, spar_joint_set_frame(*j, at, straight));
}

static void squeezer_bodies(squeezer *k, const double centre[BODIES][3]) {
    static const double m[BODIES] = {.04325, .00365, .02373, .00706, .07050, .00706, .05498};
    static const double I[BODIES] = {2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5};
    for (int i = 0; i < BODIES; i++) {
        char name[24];
        double mass[36];
        scene_mass(mass, m[i], nothing, (double[]){I[i], I[i], I[i]});
        snprintf(name, sizeof name, "K%d", i + 1);
        OK(k->s, spar_rigid_create(k->s, name, centre[i], straight, mass, &k->body[i]));
        OK(k->s, spar_member_commit(k->body[i]));
    }
}

static squeezer squeezer_create(void) {
    const double *a = angle_0, quarter = -1.57079632679489661923; /* (sin x, -cos x) is the direction x - pi/2 */
    double F[3], E[3], G[3], H[3], D[3], centre[BODIES][3];
    squeezer k = {.s = scene_session()};
    go(nothing, a[BETA], rr, 0, F);
    go(F, a[BETA] + a[THETA], -d, 0, E);
    go(A, a[DELTA], zt, 0, G);
    go(A, a[EPSILON] + quarter, u, 0, H);
    go(B, a[GAMMA] + quarter, sc, sd, D);
    go(nothing, a[BETA], ra, 0, centre[K1]);
    go(F, a[BETA] + a[THETA], -da, 0, centre[K2]);
    go(B, a[GAMMA] + quarter, sa, sb, centre[K3]);
    go(G, a[PHI] + a[DELTA] + quarter, e - ea, 0, centre[K4]);
    go(A, a[DELTA], ta, tb, centre[K5]);
    go(H, a[OMEGA] + a[EPSILON], zf - fa, 0, centre[K6]);
    go(A, a[EPSILON] + quarter, ua, -ub, centre[K7]);
    double closed[3];
    go(B, a[GAMMA] + quarter, ss, 0, closed);
    NEAR(hypot(closed[0] - E[0], closed[1] - E[1]), 0, 1e-16);
    squeezer_bodies(&k, (const double(*)[3])centre);
    squeezer_hinge(&k, K1, -1, nothing);
    squeezer_hinge(&k, K2, K1, F);
    squeezer_hinge(&k, K3, -1, B);
    squeezer_hinge(&k, K4, K5, G);
    squeezer_hinge(&k, K5, -1, A);
    squeezer_hinge(&k, K6, K7, H);
    squeezer_hinge(&k, K7, -1, A);
    squeezer_hinge(&k, K3, K2, E);
    squeezer_hinge(&k, K4, K2, E);
    squeezer_hinge(&k, K6, K2, E);
    spar_joint *spring = NULL;
    OK(k.s, spar_link_create(k.s, "spring", k.body[K3], 0, D, NULL, 0, C, &spring));
    OK(k.s, spar_link_set_spring(spring, 4530, 0, 0.07785, 0));
    OK(k.s, spar_joint_set_load(k.hinge[0], (double[]){0, 0, 0, 0, 0, 0.033}));
    return k;
}

static void squeeze(int steps, double angle[7], double *gap) {
    squeezer k = squeezer_create();
    double z[6], rate[6];
    *gap = 0;
    OK(k.s, spar_session_set_integrator(k.s, 1, 1));
    for (int n = 0; n < steps; n++) {
        OK(k.s, spar_step(k.s, 0.03 / steps, NULL, NULL, NULL));
        for (int i = 0; i < 10; i++) {
            OK(k.s, spar_joint_get_motion(k.hinge[i], z, rate, NULL));
            *gap = fmax(*gap, fmax(fabs(z[0]), fabs(z[1])));
        }
    }
    for (int i = 0; i < 7; i++) {
        OK(k.s, spar_joint_get_motion(k.hinge[i], z, rate, NULL));
        angle[i] = angle_0[i] + z[5];
    }
    spar_session_destroy(&k.s);
}

static void test_squeezer(void **state) {
    (void)state;
    static const char *const name[7] = {"beta", "theta", "gamma", "phi", "delta", "omega", "epsilon"};
    double a[3][7], gap[3];
    for (int k = 0; k < 3; k++) {
        squeeze(1500 << k, a[k], &gap[k]);
    }
    for (int i = 0; i < 7; i++) {
        char what[64];
        snprintf(what, sizeof what, "squeezer at 0.03 s: %s, rad", name[i]);
        verify(what, richardson_3(a[0][i], a[1][i], a[2][i], 4), angle_end[i], 1e-7, "IVP test set");
        snprintf(what, sizeof what, "squeezer: order, %s", name[i]);
        verify(what, log2((a[0][i] - angle_end[i]) / (a[1][i] - angle_end[i])), 2, 0.02, "generalised-alpha");
    }
    verify("squeezer: worst gap of a hinge, m", gap[0], 0, 1e-15, "holds at positions");
    verified();
}

/* ---- Bricard's mechanism ---- */

static const double corner[6][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}, {0, 0, 1}};
/* the hinge at each corner turns about the axis of the cube that both edges there are square to */
static const int about[6] = {SPAR_FREE_RY, SPAR_FREE_RZ, SPAR_FREE_RX, SPAR_FREE_RY, SPAR_FREE_RZ, SPAR_FREE_RX};

static char warning[512];

static void listen(const spar_session *s, int level, const char *text, void *context) {
    (void)s, (void)context;
    if (level == SPAR_LOG_WARNING) {
        snprintf(warning, sizeof warning, "%s", text);
    }
}

static double energy_of(spar_session *s, spar_member *rod, const double J[3], double g) {
    double q[7], v[6], x[3], energy;
    OK(s, spar_member_get_motion(rod, q, v, NULL));
    OK(s, spar_member_get_reference(rod, x, NULL));
    energy = g * (x[1] + q[1]);
    for (int i = 0; i < 3; i++) { /* an axis of the rod, as it has turned */
        const double *p = q + 4, w = q[3];
        double axis[3], turn = 0, pp = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
        for (int k = 0; k < 3; k++) {
            axis[k] = (k == i ? w * w - pp : 0) + 2 * p[i] * p[k];
        }
        axis[(i + 1) % 3] += 2 * w * p[(i + 2) % 3];
        axis[(i + 2) % 3] -= 2 * w * p[(i + 1) % 3];
        for (int k = 0; k < 3; k++) {
            turn += axis[k] * v[3 + k];
        }
        energy += 0.5 * (v[i] * v[i] + J[i] * turn * turn);
    }
    return energy;
}

/* Rods of 1 m and 1 kg, 2 s under gravity along -y: the largest error of the energy, and what the hinges open. */
static double bricard(double dt, double *gap, double *way) {
    const double g = 9.81;
    spar_session *s = scene_session();
    spar_member *rod[5];
    spar_joint *hinge[6];
    double J[5][3], error = 0, start = 0;
    *gap = *way = 0;
    warning[0] = '\0';
    OK(s, spar_session_set_log(s, listen, NULL));
    OK(s, spar_session_set_gravity(s, (double[]){0, -g, 0}));
    OK(s, spar_session_set_integrator(s, 1, 1));
    for (int k = 0; k < 5; k++) {
        char name[24];
        double mass[36], middle[3];
        for (int i = 0; i < 3; i++) {
            middle[i] = 0.5 * (corner[k][i] + corner[k + 1][i]);
            J[k][i] = corner[k][i] == corner[k + 1][i] ? 1.0 / 12 : 1e-4; /* a thin rod's, about itself nearly none */
        }
        scene_mass(mass, 1, nothing, J[k]);
        snprintf(name, sizeof name, "rod %d", k);
        OK(s, spar_rigid_create(s, name, middle, straight, mass, &rod[k]));
        OK(s, spar_member_commit(rod[k]));
        start += g * middle[1];
    }
    for (int k = 0; k < 6; k++) {
        char name[24];
        snprintf(name, sizeof name, "hinge %d", k);
        spar_member *a = k < 5 ? rod[k] : rod[4], *b = k > 0 && k < 5 ? rod[k - 1] : NULL;
        OK(s, spar_joint_create(s, name, a, 0, b, 0, about[k], &hinge[k]));
        OK(s, spar_joint_set_frame(hinge[k], corner[k], straight));
    }
    for (int n = 0; n < (int)(2 / dt + 0.5); n++) {
        double now = 0, z[6], rate[6];
        OK(s, spar_step(s, dt, NULL, NULL, NULL));
        for (int k = 0; k < 5; k++) {
            now += energy_of(s, rod[k], J[k], g);
        }
        error = fmax(error, fabs(now - start));
        for (int k = 0; k < 6; k++) {
            OK(s, spar_joint_get_motion(hinge[k], z, rate, NULL));
            for (int i = 0; i < 6; i++) {
                *gap = fmax(*gap, about[k] >> i & 1 ? 0 : fmax(fabs(z[i]), fabs(rate[i])));
                *way = fmax(*way, about[k] >> i & 1 ? fabs(z[i]) : 0);
            }
        }
    }
    spar_session_destroy(&s);
    return error;
}

static void test_bricard(void **state) {
    (void)state;
    double gap, way, coarse = bricard(2e-3, &gap, &way), fine = bricard(1e-3, &gap, &way);
    verify("Bricard: energy lost or won, J, of 29", fine, 0, 2e-3, "invariant");
    verify("Bricard: order of the energy", log2(coarse / fine), 2, 0.02, "generalised-alpha");
    verify("Bricard: worst gap of a hinge, m, rad, 1/s", gap, 0, 1e-12, "holds at positions, velocities");
    assert_true(way > 0.5);                    /* it does move */
    assert_non_null(strstr(warning, "hinge")); /* and one hold too many is named */
    verified();
}

VERIFICATION_MAIN("Mechanisms", cmocka_unit_test(test_squeezer), cmocka_unit_test(test_bricard))
