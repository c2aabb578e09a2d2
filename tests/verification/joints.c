/* Bodies on joints against closed forms and independent solutions of their equations. Where no dt is named a figure is
   extrapolated from steps dt, dt/2 and dt/4 of order 2, and the order itself is a figure.
   - Pendulum on a hinge, its node at its centre: theta by the elliptic function, sin(theta/2) = k sn(K - w t); the
   hinge's load along it m g cos theta + m L theta'^2, and across it m g sin theta - m L |theta''|.
   - Double pendulum of two rods, from the horizontal: Runge and Kutta's method of order 4 in steps of 1e-4 s on
     Hamilton's equations; the elbow's load is the lower rod's mass times the acceleration of its centre less gravity.
   - Spherical pendulum on a ball: the same method on d'' = -|d'|^2 d + (m g L / I)(e - (e.d) d), and its two
   invariants.
   - Gyroscope on a ball: regular precession, A W^2 cos a - C s W + m g l = 0 for precession W and spin s about its
   axis.
   - Four-bar with a driven crank: the rocker's angle from the circle equations; spatial slider-crank on ball and
     universal joint: the slider from the rod's length. Whatever dt is.
   - Body on springs and dampers in six directions: exp(-d t)(cos w t + d/w sin w t).
   - The same in a fluid of ten times its mass: no more coupling iterations than where the spring is the fluid's load,
   or the body is an external member that the host integrates, with a spring of its own or on the joint.
 */
#include "verification.h"

#include "pistons.h"

#include <gsl/gsl_sf_ellint.h>
#include <gsl/gsl_sf_elljac.h>

static const double pi = 3.14159265358979323846, g = 9.81, straight[4] = {1, 0, 0, 0}, nothing[3] = {0};

static spar_member *add_body(spar_session *s, const char *name, const double x[3], const double q[4], double m,
                             const double c[3], const double J[3]) {
    double mass[36];
    spar_member *b = NULL;
    scene_mass(mass, m, c, J);
    OK(s, spar_rigid_create(s, name, x, q, mass, &b));
    OK(s, spar_member_commit(b));
    return b;
}

static spar_joint *add_joint(spar_session *s, const char *name, spar_member *a, spar_member *b, int free_motions,
                             const double x[3]) {
    spar_joint *j = NULL;
    OK(s, spar_joint_create(s, name, a, 0, b, 0, free_motions, &j));
    OK(s, spar_joint_set_frame(j, x, straight));
    return j;
}

static spar_session *scene(int weight) {
    spar_session *s = scene_session();
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, weight ? -g : 0}));
    OK(s, spar_session_set_integrator(s, 1, 1));
    OK(s, spar_session_set_newton(s, 1e-14, 1e-14, 30));
    return s;
}

/* Figures x[3][n] at dt, dt/2, dt/4 against exact ones: extrapolated, with a next order of error, and their order. */
static void verify_order(const char *of, const char *const *name, int n, const double *x, const double *exact, int next,
                         double tolerance, const char *source) {
    for (int i = 0; i < n; i++) {
        char what[96];
        snprintf(what, sizeof what, "%s: %s", of, name[i]);
        verify(what, richardson_3(x[i], x[n + i], x[2 * n + i], next), exact[i], tolerance * fmax(1, fabs(exact[i])),
               source);
        snprintf(what, sizeof what, "%s: order, %s", of, name[i]);
        verify(what, log2((x[i] - exact[i]) / (x[n + i] - exact[i])), 2, 0.1, "generalised-alpha");
    }
}

/* ---- pendulum ---- */

static void pendulum(double dt, double T, double out[4]) {
    const double m = 2, J = 0.3, L = 1.5, a = 1, place[3] = {-L * sin(a), 0, -L * cos(a)};
    spar_session *s = scene(1);
    spar_member *b = add_body(s, "bob", place, straight, m, nothing, (double[]){J, J, J});
    OK(s, spar_session_set_integrator(s, 0.8, 1)); /* undamped, what the start is off stays in the loads */
    spar_joint *j = add_joint(s, "hinge", b, NULL, SPAR_FREE_RY, nothing);
    double z[6], rate[6], load[6];
    scene_run(s, dt, lround(T / dt));
    OK(s, spar_joint_get_motion(j, z, rate, NULL));
    OK(s, spar_joint_get_load(j, load)); /* in the ground's axes: b's */
    double theta = a + z[4];
    out[0] = theta, out[1] = rate[4];
    out[2] = load[0] * sin(theta) + load[2] * cos(theta);
    out[3] = load[0] * cos(theta) - load[2] * sin(theta);
    spar_session_destroy(&s);
}

static void test_pendulum(void **state) {
    (void)state;
    static const char *const name[4] = {"angle", "rate", "load along it", "load across it"};
    const double m = 2, J = 0.3, L = 1.5, a = 1, T = 2.3, I = J + m * L * L, w = sqrt(m * g * L / I), k = sin(a / 2);
    double x[3][4], exact[4], sn, cn, dn;
    for (int i = 0; i < 3; i++) {
        pendulum(0.01 / (1 << i), T, x[i]);
    }
    assert_int_equal(gsl_sf_elljac_e(gsl_sf_ellint_Kcomp(k, GSL_PREC_DOUBLE) - w * T, k * k, &sn, &cn, &dn), 0);
    exact[0] = 2 * asin(k * sn);
    exact[1] = -2 * k * w * cn * dn / cos(exact[0] / 2);
    exact[2] = m * g * cos(exact[0]) + m * L * exact[1] * exact[1];
    exact[3] = m * L * (-m * g * L * sin(exact[0]) / I) + m * g * sin(exact[0]);
    exact[3] = -exact[3]; /* m a = load + weight, across: along (cos, 0, -sin) against growing theta */
    verify_order("pendulum", name, 4, x[0], exact, 3, 1e-6, "elliptic function");
    verified();
}

/* ---- double pendulum ---- */

typedef void (*slope)(const double *y, double *dy);

/* n steps of h, m unknowns */
static void runge_kutta(slope f, int m, double h, int n, double *y) {
    double k[4][8], x[8];
    for (int i = 0; i < n; i++) {
        for (int p = 0; p < 4; p++) {
            for (int j = 0; j < m; j++) {
                x[j] = y[j] + (p == 0 ? 0 : (p == 3 ? 1 : 0.5) * h * k[p - 1][j]);
            }
            f(x, k[p]);
        }
        for (int j = 0; j < m; j++) {
            y[j] += h / 6 * (k[0][j] + 2 * k[1][j] + 2 * k[2][j] + k[3][j]);
        }
    }
}

/* Angles from the vertical and their momenta, rods of 1 m and 1 kg. */
static void rods(const double *y, double *dy) {
    double c = cos(y[0] - y[1]), e = sin(y[0] - y[1]), over = 16 - 9 * c * c;
    dy[0] = 6 * (2 * y[2] - 3 * c * y[3]) / over;
    dy[1] = 6 * (8 * y[3] - 3 * c * y[2]) / over;
    dy[2] = -0.5 * (dy[0] * dy[1] * e + 3 * g * sin(y[0]));
    dy[3] = -0.5 * (-dy[0] * dy[1] * e + g * sin(y[1]));
}

static void double_pendulum(double dt, double T, double out[4]) {
    const double half[3] = {0.5, 0, 0}, J[3] = {0, 1. / 12, 1. / 12}, elbow[3] = {1, 0, 0};
    spar_session *s = scene(1);
    spar_member *upper = add_body(s, "upper", nothing, straight, 1, half, J),
                *lower = add_body(s, "lower", elbow, straight, 1, half, J);
    OK(s, spar_session_set_integrator(s, 0.8, 1));
    spar_joint *a = add_joint(s, "shoulder", upper, NULL, SPAR_FREE_RY, nothing),
               *b = add_joint(s, "elbow", lower, upper, SPAR_FREE_RY, elbow);
    double z[6], y[6], load[6];
    scene_run(s, dt, lround(T / dt));
    OK(s, spar_joint_get_motion(a, z, NULL, NULL));
    OK(s, spar_joint_get_motion(b, y, NULL, NULL));
    OK(s, spar_joint_get_load(b, load)); /* in the upper rod's axes, x along it */
    out[0] = pi / 2 - z[4], out[1] = pi / 2 - z[4] - y[4], out[2] = load[0], out[3] = load[2];
    spar_session_destroy(&s);
}

static void test_double_pendulum(void **state) {
    (void)state;
    static const char *const name[4] = {"upper angle", "lower angle", "elbow, along", "elbow, across"};
    const double T = 0.9, h = 1e-4;
    double x[3][4], y[3][4], exact[4], spin[3][4];
    for (int i = 0; i < 3; i++) {
        double_pendulum(0.004 / (1 << i), T, x[i]);
        double from[4] = {pi / 2, pi / 2, 0, 0};
        runge_kutta(rods, 4, h, (int)lround(T / h) + i - 1, from);
        memcpy(y[i], from, sizeof from);
        rods(y[i], spin[i]);
    }
    double a1 = (spin[2][0] - spin[0][0]) / (2 * h), a2 = (spin[2][1] - spin[0][1]) / (2 * h), t1 = y[1][0],
           t2 = y[1][1], w1 = spin[1][0], w2 = spin[1][1];
    double ax = a1 * cos(t1) - w1 * w1 * sin(t1) + 0.5 * (a2 * cos(t2) - w2 * w2 * sin(t2)),
           az = a1 * sin(t1) + w1 * w1 * cos(t1) + 0.5 * (a2 * sin(t2) + w2 * w2 * cos(t2)) + g;
    exact[0] = t1, exact[1] = t2;
    exact[2] =
        ax * sin(t1) - az * cos(t1); /* the upper rod's axes are (sin, 0, -cos) and, upwards at first, (cos, 0, sin) */
    exact[3] = ax * cos(t1) + az * sin(t1);
    verify_order("double pendulum", name, 4, x[0], exact, 3, 1e-6, "Runge-Kutta");
    verified();
}

/* ---- spherical pendulum ---- */

enum { SPHERE_M = 2 };
static const double sphere_L = 1.2, sphere_J = 0.2;

static void sphere(const double *y, double *dy) {
    const double *d = y, *v = y + 3, pull = SPHERE_M * g * sphere_L / (sphere_J + SPHERE_M * sphere_L * sphere_L);
    double vv = spari_dot(v, v);
    for (int i = 0; i < 3; i++) {
        dy[i] = v[i];
        dy[3 + i] = -vv * d[i] + pull * ((i == 2 ? -1 : 0) + d[2] * d[i]);
    }
}

static void spherical_pendulum(double dt, double T, double out[3], double invariant[2]) {
    const double a = 0.9, c[3] = {sphere_L * sin(a), 0, -sphere_L * cos(a)}, J[3] = {sphere_J, sphere_J, sphere_J};
    const double side = 1.5, omega[3] = {side * cos(a), 0, side * sin(a)}; /* d' = omega x d = (0, side, 0) */
    spar_session *s = scene(1);
    spar_member *b = add_body(s, "bob", nothing, straight, SPHERE_M, c, J);
    double q[7], v[6], turn[4], d[3], I = sphere_J + SPHERE_M * sphere_L * sphere_L;
    (void)add_joint(s, "ball", b, NULL, SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ, nothing);
    OK(s, spar_member_set_initial_velocity(b, nothing, nothing, omega));
    scene_run(s, dt, lround(T / dt));
    OK(s, spar_member_get_motion(b, q, v, NULL));
    memcpy(turn, q + 3, sizeof turn);
    spari_rotate(turn, c, d);
    for (int i = 0; i < 3; i++) {
        out[i] = d[i] / sphere_L;
    }
    double w[3] = {v[3], v[4], v[5]}, dd[3] = {out[0], out[1], out[2]}, along = spari_dot(w, dd);
    invariant[0] =
        0.5 * (I * (spari_dot(w, w) - along * along) + sphere_J * along * along) + SPHERE_M * g * sphere_L * out[2];
    invariant[1] = I * (w[2] - along * out[2]) + sphere_J * along * out[2];
    spar_session_destroy(&s);
}

static void test_spherical_pendulum(void **state) {
    (void)state;
    static const char *const name[3] = {"x", "y", "z"}, *const held[2] = {"energy", "moment about the vertical"};
    const double a = 0.9, T = 2, I = sphere_J + SPHERE_M * sphere_L * sphere_L;
    double x[3][3], y[6] = {sin(a), 0, -cos(a), 0, 1.5, 0}, e[3][2],
                    exact[2] = {0.5 * I * 2.25 - SPHERE_M * g * sphere_L * cos(a), I * 1.5 * sin(a)};
    for (int i = 0; i < 3; i++) {
        spherical_pendulum(0.01 / (1 << i), T, x[i], e[i]);
    }
    runge_kutta(sphere, 6, 1e-4, 20000, y);
    verify_order("spherical pendulum", name, 3, x[0], y, 4, 1e-7, "Runge-Kutta");
    for (int i = 0; i < 2; i++) {
        char what[64];
        snprintf(what, sizeof what, "spherical pendulum: %s", held[i]);
        verify(what, richardson_3(e[0][i], e[1][i], e[2][i], 4), exact[i], 1e-7 * fabs(exact[i]), "invariant");
    }
    verified();
}

/* ---- gyroscope ---- */

static const double top_A = 0.02, top_C = 0.01, top_m = 1.5, top_l = 0.08, top_tilt = 0.6, top_spin = 60;

static double precession(void) {
    double Cs = top_C * top_spin, c = cos(top_tilt);
    return (Cs - sqrt(Cs * Cs - 4 * top_A * top_m * g * top_l * c)) / (2 * top_A * c);
}

/* Body axes: z along the axle; A is about the ball. */
static void gyroscope(double dt, double T, double out[3]) {
    const double lean[4] = {cos(top_tilt / 2), 0, sin(top_tilt / 2), 0}, c[3] = {0, 0, top_l};
    const double across = top_A - top_m * top_l * top_l, J[3] = {across, across, top_C}, W = precession();
    double axle[3] = {0, 0, 1}, omega[3], q[7], d[3] = {0, 0, 1};
    spari_rotate(lean, axle, axle);
    for (int i = 0; i < 3; i++) {
        omega[i] = (top_spin - W * cos(top_tilt)) * axle[i] + (i == 2 ? W : 0);
    }
    spar_session *s = scene(1);
    spar_member *b = add_body(s, "gyroscope", nothing, lean, top_m, c, J);
    (void)add_joint(s, "ball", b, NULL, SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ, nothing);
    OK(s, spar_member_set_initial_velocity(b, nothing, nothing, omega));
    scene_run(s, dt, lround(T / dt));
    OK(s, spar_member_get_motion(b, q, NULL, NULL));
    spari_rotate(lean, d, d);
    spari_rotate(q + 3, d, d);
    out[0] = atan2(d[1], d[0]);
    out[1] = acos(d[2]);
    spar_session_destroy(&s);
}

static void test_gyroscope(void **state) {
    (void)state;
    const double T = 0.8;
    double x[3][3];
    for (int i = 0; i < 3; i++) {
        gyroscope(1e-3 / (1 << i), T, x[i]);
    }
    verify("gyroscope: precession in 0.8 s, rad", richardson_3(x[0][0], x[1][0], x[2][0], 4), precession() * T, 1e-6,
           "regular precession");
    verify("gyroscope: tilt, rad", richardson_3(x[0][1], x[1][1], x[2][1], 4), top_tilt, 1e-6, "regular precession");
    verify("gyroscope: order, precession", log2((x[0][0] - precession() * T) / (x[1][0] - precession() * T)), 2, 0.1,
           "generalised-alpha");
    verified();
}

/* ---- four-bar ---- */

/* Angles of coupler and rocker (of 1 and 0.8 m, the ground's hinges 1 m apart) when the crank of 0.4 m is at phi. */
static void four_bar(double phi, double *coupler, double *rocker) {
    const double b[2] = {0.4 * cos(phi), 0.4 * sin(phi)}, way[2] = {1 - b[0], -b[1]}, D = hypot(way[0], way[1]);
    double at = acos((1 + D * D - 0.64) / (2 * D)); /* between coupler and the line from its hinge to the far one */
    *coupler = atan2(way[1], way[0]) + at;
    *rocker = atan2(b[1] + sin(*coupler), b[0] + cos(*coupler) - 1);
}

static void test_four_bar(void **state) {
    (void)state;
    const double w = 3, at = 0.7, dt = 0.05, D[3] = {1, 0, 0}, J[3] = {0.1, 0.1, 0.1};
    double b0, r0, mass[36], worst[2] = {0, 0};
    four_bar(at, &b0, &r0);
    const double B[3] = {0.4 * cos(at), 0.4 * sin(at), 0}, C[3] = {1 + 0.8 * cos(r0), 0.8 * sin(r0), 0};
    spar_session *s = scene(0);
    spar_member *crank = NULL, *coupler = add_body(s, "coupler", B, straight, 1, nothing, J),
                *rocker = add_body(s, "rocker", D, straight, 1, nothing, J);
    scene_mass(mass, 1, nothing, J);
    OK(s, spar_rigid_create(s, "crank", nothing, straight, mass, &crank));
    OK(s, spar_member_set_initial_velocity(crank, nothing, nothing, (double[]){0, 0, w}));
    OK(s, spar_member_commit(crank));
    spar_joint *shaft = add_joint(s, "A", crank, NULL, SPAR_FREE_RZ, nothing);
    (void)add_joint(s, "B", coupler, crank, SPAR_FREE_RZ, B);
    (void)add_joint(s, "C", coupler, rocker, SPAR_FREE_RZ, C);
    spar_joint *far = add_joint(s, "D", rocker, NULL, SPAR_FREE_RZ, D);
    OK(s, spar_joint_set_driven(shaft, SPAR_FREE_RZ));
    for (int i = 1; i <= 200; i++) {
        double phi = at + w * dt * i, beta, psi, z[6], v[6];
        OK(s, spar_joint_drive(shaft, (double[]){0, 0, 0, 0, 0, w * dt * i}, (double[]){0, 0, 0, 0, 0, w}, NULL));
        OK(s, spar_step(s, dt, NULL, NULL, NULL));
        OK(s, spar_joint_get_motion(far, z, v, NULL));
        four_bar(phi, &beta, &psi);
        worst[0] = fmax(worst[0], fabs(remainder(z[5] + r0 - psi, 2 * pi)));
        worst[1] = fmax(worst[1], fabs(v[5] - w * 0.4 * sin(beta - phi) / (0.8 * sin(beta - psi))));
    }
    verify("four-bar: rocker's angle, worst of 200 steps", worst[0], 0, 1e-11, "circle equations");
    verify("four-bar: rocker's rate, rad/s", worst[1], 0, 1e-10, "circle equations");
    spar_session_destroy(&s);
    verified();
}

/* ---- spatial slider-crank ---- */

/* Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989): a crank of 0.08 m that turns about a line
   along x through (0, 0.1, 0.12), a rod of 0.3 m, a slider on the x axis, at 0.2 m first. */
static void test_spatial_slider_crank(void **state) {
    (void)state;
    const double w = 6, dt = 0.02, shaft_at[3] = {0, 0.1, 0.12}, B[3] = {0, 0.1, 0.2}, P[3] = {0.2, 0, 0};
    const double J[3] = {0.01, 0.01, 0.01}, half[3] = {0.1, -0.05, -0.1};
    double mass[36], worst[2] = {0, 0};
    spar_session *s = scene(0);
    spar_member *crank = NULL, *rod = add_body(s, "rod", B, straight, 0.5, half, J),
                *slider = add_body(s, "slider", P, straight, 2, nothing, J);
    scene_mass(mass, 0.12, nothing, J);
    OK(s, spar_rigid_create(s, "crank", shaft_at, straight, mass, &crank));
    OK(s, spar_member_set_initial_velocity(crank, shaft_at, nothing, (double[]){w, 0, 0}));
    OK(s, spar_member_commit(crank));
    spar_joint *shaft = add_joint(s, "shaft", crank, NULL, SPAR_FREE_RX, shaft_at);
    (void)add_joint(s, "ball", rod, crank, SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ, B);
    (void)add_joint(s, "universal", rod, slider, SPAR_FREE_RY | SPAR_FREE_RZ, P);
    spar_joint *way = add_joint(s, "way", slider, NULL, SPAR_FREE_X, P);
    OK(s, spar_joint_set_driven(shaft, SPAR_FREE_RX));
    for (int i = 1; i <= 200; i++) {
        double a = w * dt * i, z[6], v[6], y = 0.1 - 0.08 * sin(a), h = 0.12 + 0.08 * cos(a);
        OK(s, spar_joint_drive(shaft, (double[]){0, 0, 0, a, 0, 0}, (double[]){0, 0, 0, w, 0, 0}, NULL));
        OK(s, spar_step(s, dt, NULL, NULL, NULL));
        OK(s, spar_joint_get_motion(way, z, v, NULL));
        double x = sqrt(0.09 - y * y - h * h), rate = -(y * -0.08 * w * cos(a) - h * 0.08 * w * sin(a)) / x;
        worst[0] = fmax(worst[0], fabs(z[0] + 0.2 - x));
        worst[1] = fmax(worst[1], fabs(v[0] - rate));
    }
    verify("spatial slider-crank: slider, m, worst of 200 steps", worst[0], 0, 1e-12, "length of the rod");
    verify("spatial slider-crank: its speed, m/s", worst[1], 0, 1e-11, "length of the rod");
    spar_session_destroy(&s);
    verified();
}

/* ---- springs ---- */

static double sprung(int k, double dt, double T) {
    const double J[3] = {0.4, 0.4, 0.4}, stiff = 80, damp = 0.6;
    double K[36] = {0}, D[36] = {0}, v[2][3] = {{0}}, z[6];
    spar_session *s = scene(0);
    spar_member *b = add_body(s, "body", nothing, straight, 2, nothing, J);
    spar_joint *j = add_joint(s, "spring", b, NULL, 63, nothing);
    for (int i = 0; i < 6; i++) {
        K[7 * i] = stiff * (i + 1), D[7 * i] = damp;
    }
    v[k / 3][k % 3] = 0.5;
    OK(s, spar_joint_set_spring(j, K, D, NULL));
    OK(s, spar_member_set_initial_velocity(b, nothing, v[0], v[1]));
    scene_run(s, dt, lround(T / dt));
    OK(s, spar_joint_get_motion(j, z, NULL, NULL));
    spar_session_destroy(&s);
    return z[k];
}

static void test_springs(void **state) {
    (void)state;
    static const char *const name[6] = {"x", "y", "z", "turn about x", "turn about y", "turn about z"};
    for (int k = 0; k < 6; k++) {
        double m = k < 3 ? 2 : 0.4, d = 0.3 / m, w = sqrt(80 * (k + 1) / m - d * d), T = 1.3, x[3], exact;
        for (int i = 0; i < 3; i++) {
            x[i] = sprung(k, 0.0025 / (1 << i), T);
        }
        exact = 0.5 / w * exp(-d * T) * sin(w * T);
        verify_order("spring and damper", &name[k], 1, x, &exact, 4, 1e-7, "closed form");
    }
    verified();
}

/* ---- a heavy fluid ---- */

/* A body of 2 kg in a fluid of ten times its mass swings by a spring of 800 N/m: a joint's, one that the fluid's load
   has or one that the host has; the body is spar's, or external. */
typedef enum spring_of { OF_JOINT, OF_FLUID, OF_HOST } spring_of;
static const double heavy_k = 800, heavy_step = 0.02, heavy_rho = 0.9;

/* The host's generalised-alpha, as spar's: m a + k x = load at t^{n+1}. */
typedef struct hosts {
    double x, v, a, b;
} hosts;

static hosts advance(const hosts *n, double k, double m, double load) {
    const double h = heavy_step, am = (2 * heavy_rho - 1) / (heavy_rho + 1), af = heavy_rho / (heavy_rho + 1),
                 gamma = 0.5 + af - am, beta = 0.25 * (0.5 + gamma) * (0.5 + gamma), part = (1 - af) / (1 - am);
    double old = (af * n->a - am * n->b) / (1 - am); /* b^{n+1} = old + part a^{n+1} */
    double x = n->x + h * n->v + h * h * ((0.5 - beta) * n->b + beta * old);
    hosts to;
    to.a = (load - k * x) / (m + k * h * h * beta * part);
    to.b = old + part * to.a;
    to.x = x + h * h * beta * part * to.a;
    to.v = n->v + h * ((1 - gamma) * n->b + gamma * to.b);
    return to;
}

static void create_heavy(pistons *p, int external) {
    const double ratio = 10, x[3] = {0};
    double mass[36];
    pistons_create(p, external ? 0 : 1, &ratio);
    if (external) {
        p->n = 1, p->mass[0] = 2, p->ratio[0] = ratio;
        scene_mass(mass, 2, nothing, (double[]){1, 1, 1});
        OK(p->session, spar_rigid_create(p->session, "hosts", x, straight, mass, &p->body[0]));
        OK(p->session, spar_member_set_external(p->body[0], 1));
        OK(p->session, spar_member_commit(p->body[0]));
        OK(p->session, spar_fluid_create(p->body[0], "water", &p->fluid[0]));
        OK(p->session, spar_fluid_set_motion_nodes(p->fluid[0], 1, x));
        OK(p->session, spar_fluid_set_force_nodes(p->fluid[0], 1, x));
        OK(p->session, spar_fluid_map(p->fluid[0]));
    }
    p->b[0] = 30;
}

/* The loop of an external member (examples/external.c); iterations. */
static int step_external(pistons *p, hosts *now, double k) {
    int done = 0, taken = 0;
    hosts to = *now;
    OK(p->session, spar_step_begin(p->session, heavy_step));
    for (; !done; taken++) {
        double load[6];
        OK(p->session, spar_member_get_loads(p->body[0], load));
        to = advance(now, k, p->mass[0], load[0]);
        const double q[7] = {to.x, 0, 0, 1}, v[6] = {to.v}, a[6] = {to.a};
        OK(p->session, spar_member_set_motion(p->body[0], q, v, a));
        OK(p->session, spar_step_solve(p->session));
        OK(p->session, pistons_fluid(p->session, 0, heavy_step, taken, p));
        OK(p->session, spar_step_check(p->session, &done));
    }
    OK(p->session, spar_step_accept(p->session));
    *now = to;
    return taken;
}

/* Iterations of 100 steps, and where the body is then. */
static int iterate(int scheme, int external, spring_of spring, double *x) {
    const double K[36] = {[0] = heavy_k};
    pistons p;
    hosts now = {0};
    int sum = 0;
    create_heavy(&p, external);
    p.stiffness = spring == OF_FLUID ? heavy_k : 0;
    OK(p.session, spar_session_set_integrator(p.session, heavy_rho, 1));
    OK(p.session, spar_session_set_coupling(p.session, scheme, 1e-9, 1e-8, 60));
    if (spring == OF_JOINT) {
        spar_joint *j = NULL;
        OK(p.session, spar_joint_create(p.session, "spring", p.body[0], 0, NULL, 0, external ? 63 : SPAR_FREE_X, &j));
        OK(p.session, spar_joint_set_spring(j, K, NULL, NULL));
    }
    for (int i = 0; i < 100; i++) {
        int taken = 0;
        if (external) {
            taken = step_external(&p, &now, spring == OF_HOST ? heavy_k : 0);
        } else {
            OK(p.session, spar_step(p.session, heavy_step, pistons_fluid, &p, &taken));
        }
        sum += taken;
    }
    double q[7];
    OK(p.session, spar_member_get_motion(p.body[0], q, NULL, NULL));
    *x = q[0];
    pistons_destroy(&p);
    return sum;
}

static void test_heavy_fluid(void **state) {
    (void)state;
    static const struct {
        const char *of, *than;
        int external, of_external;
        spring_of spring, other;
    } pair[] = {{"on a spring", "spring as the fluid's load", 0, 0, OF_JOINT, OF_FLUID},
                {"on a spring", "external, spring of the host's", 0, 1, OF_JOINT, OF_HOST},
                {"external, on a spring", "spring as the fluid's load", 1, 0, OF_JOINT, OF_FLUID}};
    for (int iqn = 0; iqn <= 1; iqn++) {
        int scheme = iqn ? SPAR_COUPLING_IQN_ILS : SPAR_COUPLING_AITKEN;
        for (size_t k = 0; k < sizeof pair / sizeof *pair; k++) {
            double x, y;
            char what[96];
            int n = iterate(scheme, pair[k].external, pair[k].spring, &x),
                most = iterate(scheme, pair[k].of_external, pair[k].other, &y);
            snprintf(what, sizeof what, "added mass 10, %s, %s: more iterations", pair[k].of,
                     iqn ? "IQN-ILS" : "Aitken");
            /* in the load norm IQN-ILS does not know the structure */
            verify(what, fmax(0, n - most), 0, iqn && pair[k].external ? 0.2 * most : 0, pair[k].than);
            snprintf(what, sizeof what, "added mass 10, %s, %s: place, m", pair[k].of, iqn ? "IQN-ILS" : "Aitken");
            verify(what, x, y, 1e-7, pair[k].than);
            assert_in_range(most, 100, 600);
        }
    }
    verified();
}

VERIFICATION_MAIN("Joints", cmocka_unit_test(test_pendulum), cmocka_unit_test(test_double_pendulum),
                  cmocka_unit_test(test_spherical_pendulum), cmocka_unit_test(test_gyroscope),
                  cmocka_unit_test(test_four_bar), cmocka_unit_test(test_spatial_slider_crank),
                  cmocka_unit_test(test_springs), cmocka_unit_test(test_heavy_fluid))
