/* Members tied by joints, in time: closed forms, invariants, and two ways to say one thing. */
#include "scene.h"

#include <stdio.h>

static const double rest[4] = {1, 0, 0, 0}, origin[3] = {0}, two_pi = 6.283185307179586;

static spar_member *add_body(spar_session *s, const char *name, const double x[3], double m, const double c[3],
                             const double J[3]) {
    double mass[36];
    spar_member *b = NULL;
    scene_mass(mass, m, c, J);
    OK(s, spar_rigid_create(s, name, x, rest, mass, &b));
    OK(s, spar_member_commit(b));
    return b;
}

static spar_joint *add_joint(spar_session *s, const char *name, spar_member *a, int64_t node_a, spar_member *b,
                             int64_t node_b, int free_motions, const double x[3]) {
    spar_joint *j = NULL;
    OK(s, spar_joint_create(s, name, a, node_a, b, node_b, free_motions, &j));
    if (x) {
        OK(s, spar_joint_set_frame(j, x, rest));
    }
    return j;
}

static double order_of(double coarse, double fine) {
    return log(fabs(coarse / fine)) / log(2);
}

/* What is held stays, and its rate: the worst of all. */
static double gap_of(const spar_joint *j, int free_motions) {
    double z[6], rate[6], worst = 0;
    assert_int_equal(spar_joint_get_motion(j, z, rate, NULL), SPAR_OK);
    for (int k = 0; k < 6; k++) {
        worst = free_motions >> k & 1 ? worst : fmax(worst, fmax(fabs(z[k]), fabs(rate[k])));
    }
    return worst;
}

/* ---- a pendulum ---- */

typedef struct swing {
    double angle, energy, load, gap;
} swing;

/* A body of m = 2 kg, J = 0.3 kg m^2 about its centre, L = 1.5 m below a hinge along y, from 1 rad at rest:
   (J + m L^2) w^2 / 2 = m g L (cos theta - cos 1), and along the pendulum the hinge pulls with m g cos theta + m L w^2.
   The body's node is at the hinge, or at its centre, from which a rigid arm leads there. */
static swing pendulum(int at_centre, double rho, double dt, double T) {
    const double g = 9.81, m = 2, J = 0.3, L = 1.5, theta0 = 1, I = J + m * L * L;
    const double centre[3] = {-L * sin(theta0), 0, -L * cos(theta0)}, inertia[3] = {J, J, J};
    spar_session *s = scene_session();
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -g}));
    OK(s, spar_session_set_integrator(s, rho, 1));
    spar_member *b = add_body(s, "bob", at_centre ? centre : origin, m, at_centre ? origin : centre, inertia);
    spar_joint *j = add_joint(s, "hinge", b, 0, NULL, 0, SPAR_FREE_RY, origin);
    swing w = {0};
    double z[6], rate[6], load[6];
    for (int i = 0, n = (int)lround(T / dt); i < n; i++) {
        OK(s, spar_step(s, dt, NULL, NULL, NULL));
        OK(s, spar_joint_get_motion(j, z, rate, NULL));
        OK(s, spar_joint_get_load(j, load));
        double theta = theta0 + z[4], along = load[0] * sin(theta) + load[2] * cos(theta);
        double e = 0.5 * I * rate[4] * rate[4] - m * g * L * (cos(theta) - cos(theta0));
        w.energy = fmax(w.energy, fabs(e) / (m * g * L));
        w.load = fmax(w.load, fabs(along - m * g * cos(theta) - m * L * rate[4] * rate[4]) / (m * g));
        w.gap = fmax(w.gap, gap_of(j, SPAR_FREE_RY));
        w.angle = theta;
    }
    spar_session_destroy(&s);
    return w;
}

/* Order 2 in motion and energy; the load is that of the motion to what its acceleration is off, dt^2 too. The reference
   is the same pendulum in steps of 1e-4 s of Runge and Kutta's method of order 4. */
static void test_pendulum(void **state) {
    (void)state;
    const double T = 3, k = 9.81 * 2 * 1.5 / (0.3 + 2 * 1.5 * 1.5), h = 1e-4;
    double theta = 1, w = 0;
    for (int i = 0; i < (int)lround(T / h); i++) {
        double k1 = w, l1 = -k * sin(theta), k2 = w + h / 2 * l1, l2 = -k * sin(theta + h / 2 * k1),
               k3 = w + h / 2 * l2, l3 = -k * sin(theta + h / 2 * k2), k4 = w + h * l3, l4 = -k * sin(theta + h * k3);
        theta += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
        w += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
    }
    for (int at_centre = 0; at_centre <= 1; at_centre++) {
        for (int damped = 0; damped <= 1; damped++) {
            swing a = pendulum(at_centre, damped ? 0.8 : 1, 0.01, T),
                  b = pendulum(at_centre, damped ? 0.8 : 1, 0.005, T);
            NEAR(order_of(a.angle - theta, b.angle - theta), 2, 0.05);
            NEAR(order_of(a.energy, b.energy), 2, 0.1);
            assert_true(at_centre ? fabs(order_of(a.load, b.load) - 2) < 0.1 : b.load < 1e-7);
            assert_true(fabs(b.angle - theta) < 1e-3);
            assert_true(b.gap < 1e-12);
        }
    }
}

/* ---- a double pendulum ---- */

/* Two rods of 1 m and 1 kg, hinged along y at their ends, from the horizontal: energy is kept to dt^2, constraints to
   rounding; the elbow's acceleration is the central difference of its rate to dt^2. */
static void double_pendulum(double dt, double *energy, double *gap, double *jerk) {
    const double g = 9.81, half[3] = {0.5, 0, 0}, J[3] = {0, 1. / 12, 1. / 12}, elbow[3] = {1, 0, 0};
    spar_session *s = scene_session();
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -g}));
    OK(s, spar_session_set_integrator(s, 1, 1));
    spar_member *upper = add_body(s, "upper", origin, 1, half, J), *lower = add_body(s, "lower", elbow, 1, half, J);
    spar_joint *shoulder = add_joint(s, "shoulder", upper, 0, NULL, 0, SPAR_FREE_RY, origin);
    spar_joint *joint = add_joint(s, "elbow", lower, 0, upper, 0, SPAR_FREE_RY, elbow);
    double rate[3] = {0, 0, 0}, acceleration[2] = {0, 0};
    *energy = *gap = *jerk = 0;
    for (int i = 0; i < (int)lround(2 / dt); i++) {
        double e[2][4], v[6], a[6];
        OK(s, spar_step(s, dt, NULL, NULL, NULL));
        OK(s, spar_member_get_energy(upper, 4, e[0]));
        OK(s, spar_member_get_energy(lower, 4, e[1]));
        *energy = fmax(*energy, fabs(e[0][0] + e[0][2] + e[1][0] + e[1][2]) / (2 * g));
        *gap = fmax(*gap, fmax(gap_of(shoulder, SPAR_FREE_RY), gap_of(joint, SPAR_FREE_RY)));
        OK(s, spar_joint_get_motion(joint, NULL, v, a));
        rate[0] = rate[1], rate[1] = rate[2], rate[2] = v[4];
        acceleration[0] = acceleration[1], acceleration[1] = a[4];
        if (i > 2) {
            *jerk = fmax(*jerk, fabs((rate[2] - rate[0]) / (2 * dt) - acceleration[0]) / g);
        }
    }
    spar_session_destroy(&s);
}

static void test_double_pendulum(void **state) {
    (void)state;
    double coarse, fine, gap, jerk[2];
    double_pendulum(0.002, &coarse, &gap, &jerk[0]);
    double_pendulum(0.001, &fine, &gap, &jerk[1]);
    NEAR(order_of(coarse, fine), 2, 0.2);
    NEAR(order_of(jerk[0], jerk[1]), 2, 0.2);
    assert_true(gap < 1e-12);
}

/* ---- a weld ---- */

/* A cantilever of two elements against two beams of one, welded: the same motion to rounding. Parts that a step does
   not resolve ring as their start rounds, so the tip's load grows from nothing. */
static void test_weld(void **state) {
    (void)state;
    double K[36], M[36], tip[2][7], place[3] = {1, 0, 0};
    scene_diagonal(K, 1e6, 1e6, 1e6, 200, 300, 400);
    scene_diagonal(M, 2, 2, 2, 0.02, 0.01, 0.01);
    for (int welded = 0; welded <= 1; welded++) {
        spar_session *s = scene_session();
        OK(s, spar_session_set_integrator(s, 0.8, 1));
        spar_member *first = scene_beam(s, "first", welded ? 1 : 2, 5, welded ? 1 : 2, K, M), *last = first;
        OK(s, spar_member_commit(first));
        if (welded) {
            last = scene_beam(s, "second", 1, 5, 1, K, M);
            OK(s, spar_member_set_placement(last, place, NULL));
            OK(s, spar_member_set_root(last, SPAR_ROOT_FREE));
            OK(s, spar_member_commit(last));
            (void)add_joint(s, "weld", last, 0, first, 4, 0, NULL);
        }
        int64_t n;
        OK(s, spar_member_get_count(last, &n));
        for (int i = 0; i < 200; i++) {
            double load[6] = {0, 0.3 * i, 0.5 * i, 0.02 * i, 0, 0}, q[7 * 20];
            OK(s, spar_member_set_load(last, n - 1, SPAR_LOAD_DEAD, load));
            OK(s, spar_step(s, 0.002, NULL, NULL, NULL));
            OK(s, spar_member_get_motion(last, q, NULL, NULL));
            memcpy(tip[welded], q + 7 * (n - 1), sizeof tip[0]);
        }
        spar_session_destroy(&s);
    }
    for (int k = 0; k < 7; k++) {
        NEAR(tip[1][k], tip[0][k], 1e-10);
    }
}

/* ---- springs ---- */

/* A body on a spring and damper in each of six directions in turn: z = exp(-d t) (cos w t + d / w sin w t) z0, with d =
   c / 2m and w^2 = k/m - d^2, m the mass or the inertia; order 2. */
static double sprung(int direction, double dt) {
    const double inertia[3] = {0.4, 0.7, 1.1}, m = direction < 3 ? 3 : inertia[direction - 3], k = 50, c = 0.8;
    double K[36] = {0}, C[36] = {0}, z[6], d = c / (2 * m), w = sqrt(k / m - d * d), v0[3] = {0}, o0[3] = {0};
    spar_session *s = scene_session();
    OK(s, spar_session_set_integrator(s, 1, 1));
    double mass[36];
    spar_member *b = NULL;
    scene_mass(mass, 3, origin, inertia);
    OK(s, spar_rigid_create(s, "body", origin, rest, mass, &b));
    (direction < 3 ? v0 : o0)[direction % 3] = 0.2;
    OK(s, spar_member_set_initial_velocity(b, origin, v0, o0));
    OK(s, spar_member_commit(b));
    spar_joint *j = add_joint(s, "spring", b, 0, NULL, 0, 1 << direction, origin);
    K[7 * direction] = k, C[7 * direction] = c;
    OK(s, spar_joint_set_spring(j, K, C, NULL));
    int n = (int)lround(2 / dt);
    for (int i = 0; i < n; i++) {
        OK(s, spar_step(s, dt, NULL, NULL, NULL));
    }
    OK(s, spar_joint_get_motion(j, z, NULL, NULL));
    spar_session_destroy(&s);
    return z[direction] - 0.2 / w * exp(-d * 2) * sin(w * 2);
}

static void test_springs(void **state) {
    (void)state;
    for (int k = 0; k < 6; k++) {
        double a = sprung(k, 0.01), b = sprung(k, 0.005);
        NEAR(order_of(a, b), 2, 0.05);
        assert_true(fabs(b) < 1e-4);
    }
}

/* ---- a top ---- */

/* A top on a ball joint, nutation and precession: energy, the moment about the vertical and (symmetric) the spin about
   its axis are kept. */
static void top(double dt, double *energy, double *moment, double *spin) {
    const double g = 9.81, m = 1, L = 0.4, centre[3] = {L * sin(0.5), 0, L * cos(0.5)}, J1 = 0.02, J3 = 0.01;
    const double axis[3] = {sin(0.5), 0, cos(0.5)}, w0 = 60;
    double M[36] = {0}, J[9], v[36];
    (void)v;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            J[3 * i + k] = (i == k ? J1 : 0) + (J3 - J1) * axis[i] * axis[k];
        }
    }
    scene_mass(M, m, centre, (double[]){0, 0, 0});
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            M[6 * (3 + i) + 3 + k] += J[3 * i + k];
        }
    }
    spar_session *s = scene_session();
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -g}));
    OK(s, spar_session_set_integrator(s, 1, 1));
    spar_member *b = NULL;
    OK(s, spar_rigid_create(s, "top", origin, rest, M, &b));
    OK(s, spar_member_set_initial_velocity(b, origin, origin, (double[]){w0 * axis[0], 0, w0 * axis[2]}));
    OK(s, spar_member_commit(b));
    spar_joint *j = add_joint(s, "ball", b, 0, NULL, 0, SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ, origin);
    double e0 = 0.5 * J3 * w0 * w0, h0 = J3 * w0 * axis[2];
    *energy = *moment = *spin = 0;
    for (int i = 0; i < (int)lround(1 / dt); i++) {
        double e[4], q[7], u[6], a[3], c[3];
        OK(s, spar_step(s, dt, NULL, NULL, NULL));
        OK(s, spar_member_get_energy(b, 4, e));
        OK(s, spar_member_get_motion(b, q, u, NULL));
        spari_rotate(q + 3, axis, a);
        spari_rotate(q + 3, centre, c);
        double n = spari_dot(a, u + 3), across = J1 + m * L * L, h[3];
        for (int k = 0; k < 3; k++) {
            h[k] = across * u[3 + k] + (J3 - across) * n * a[k];
        }
        *energy = fmax(*energy, fabs(e[0] + e[2] - e0) / e0);
        *moment = fmax(*moment, fabs(h[2] - h0) / h0);
        *spin = fmax(*spin, fabs(n - w0) / w0);
    }
    assert_true(gap_of(j, 56) < 1e-12);
    spar_session_destroy(&s);
}

static void test_top(void **state) {
    (void)state;
    double e[2], h[2], n[2];
    top(2e-3, &e[0], &h[0], &n[0]);
    top(1e-3, &e[1], &h[1], &n[1]);
    NEAR(order_of(e[0], e[1]), 2, 0.1);
    NEAR(order_of(h[0], h[1]), 2, 0.1);
    NEAR(order_of(n[0], n[1]), 2, 0.1);
    assert_true(e[1] < 1e-4 && h[1] < 1e-3 && n[1] < 2e-5);
}

/* ---- a chain ---- */

static void test_chain(void **state) {
    (void)state;
    for (int links = 10; links <= 100; links *= 10) {
        const double half[3] = {0.05, 0, 0}, J[3] = {1e-5, 1. / 1200, 1. / 1200};
        spar_session *s = scene_session();
        OK(s, spar_session_set_gravity(s, (double[]){0, 0, -9.81}));
        OK(s, spar_session_set_integrator(s, 0.9, 1));
        spar_member *last = NULL;
        for (int i = 0; i < links; i++) {
            char name[16];
            double x[3] = {0.1 * i, 0, 0};
            snprintf(name, sizeof name, "link%d", i);
            spar_member *b = add_body(s, name, x, 1, half, J);
            (void)add_joint(s, name, b, 0, last, 0, 56, x);
            last = b;
        }
        for (int i = 0; i < 100; i++) {
            OK(s, spar_step(s, 0.002, NULL, NULL, NULL));
        }
        spar_session_destroy(&s);
    }
}

/* ---- loops ---- */

static int warnings;

static void hear(const spar_session *s, int level, const char *text, void *context) {
    (void)s, (void)context;
    if (level == SPAR_LOG_WARNING) {
        warnings++;
        assert_non_null(strstr(text, "follows from the other joints"));
    }
}

/* Reference: theta'' = f(theta) by Runge and Kutta, order 4, in steps of 1e-4 s. */
static double oscillate(double theta, double k, double T) {
    const double h = 1e-4;
    double w = 0;
    for (int i = 0; i < (int)lround(T / h); i++) {
        double k1 = w, l1 = -k * cos(theta), k2 = w + h / 2 * l1, l2 = -k * cos(theta + h / 2 * k1),
               k3 = w + h / 2 * l2, l3 = -k * cos(theta + h / 2 * k2), k4 = w + h * l3, l4 = -k * cos(theta + h * k3);
        theta += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
        w += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
    }
    return theta;
}

/* A parallelogram of rods of 1 kg a metre: cranks of L = 1 m, 2 m apart, a coupler of 2 m. Four parallel hinges say 20
   things about 3 bodies that have one motion: 3 of them twice, all of which are named. With the crank's angle theta
   from the horizontal (2 m L^2 / 3 + 2 L^2) theta'' = -(2 L / 2 + 2 L) g cos theta. */
static double parallelogram(double dt, double T, double *gap) {
    const double g = 9.81, theta = -1, c = cos(theta), d = sin(theta);
    const double foot[3] = {0}, foot2[3] = {2, 0, 0}, top[3] = {c, 0, d}, top2[3] = {2 + c, 0, d};
    const double half[3] = {c / 2, 0, d / 2}, bar[3] = {1, 0, 0}, thin[3] = {1. / 12, 1. / 12, 1. / 12},
                 thick[3] = {8. / 12, 8. / 12, 8. / 12};
    spar_session *s = scene_session();
    OK(s, spar_session_set_log(s, hear, NULL));
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -g}));
    OK(s, spar_session_set_integrator(s, 0.95, 1));
    spar_member *a = add_body(s, "crank", foot, 1, half, thin), *b = add_body(s, "rocker", foot2, 1, half, thin),
                *k = add_body(s, "coupler", top, 2, bar, thick);
    spar_joint *j[4] = {add_joint(s, "foot", a, 0, NULL, 0, SPAR_FREE_RY, foot),
                        add_joint(s, "foot2", b, 0, NULL, 0, SPAR_FREE_RY, foot2),
                        add_joint(s, "top", k, 0, a, 0, SPAR_FREE_RY, top),
                        add_joint(s, "top2", k, 0, b, 0, SPAR_FREE_RY, top2)};
    double z[6];
    warnings = 0;
    *gap = 0;
    for (int i = 0; i < (int)lround(T / dt); i++) {
        OK(s, spar_step(s, dt, NULL, NULL, NULL));
        for (int n = 0; n < 4; n++) {
            *gap = fmax(*gap, gap_of(j[n], SPAR_FREE_RY));
        }
    }
    assert_int_equal(warnings, 3);
    OK(s, spar_joint_get_motion(j[0], z, NULL, NULL));
    spar_session_destroy(&s);
    return theta - z[4]; /* a turn about y takes x to -z */
}

static void test_parallelogram(void **state) {
    (void)state;
    double T = 1.5, exact = oscillate(-1, 3 * 9.81 / (2. / 3 + 2), T), gap[2];
    double a = parallelogram(0.005, T, &gap[0]) - exact, b = parallelogram(0.0025, T, &gap[1]) - exact;
    NEAR(order_of(a, b), 2, 0.05);
    assert_true(fabs(b) < 1e-3 && gap[1] < 1e-11);
}

/* A slider-crank whose crank of r = 0.3 m is driven at 7 rad/s over several turns: the slider on the x axis is at r cos
   + sqrt(l^2 - r^2 sin^2) with l = 1 m, its velocity the derivative, to rounding whatever dt is. */
static void test_slider_crank(void **state) {
    (void)state;
    const double r = 0.3, l = 1, w = 7, at = 1, c = r * cos(at), h = r * sin(at), far = sqrt(l * l - h * h);
    const double wrist[3] = {c, 0, -h}, pin[3] = {c + far, 0, 0}, half[3] = {c / 2, 0, -h / 2},
                 rod[3] = {far / 2, 0, h / 2}, J[3] = {0.1, 0.1, 0.1};
    spar_session *s = scene_session();
    double mass[36];
    spar_member *crank = NULL, *con = add_body(s, "rod", wrist, 1, rod, J),
                *slider = add_body(s, "slider", pin, 2, origin, J);
    scene_mass(mass, 1, half, J);
    OK(s, spar_rigid_create(s, "crank", origin, rest, mass, &crank));
    OK(s, spar_member_set_initial_velocity(crank, origin, origin, (double[]){0, w, 0}));
    OK(s, spar_member_commit(crank));
    spar_joint *shaft = add_joint(s, "shaft", crank, 0, NULL, 0, SPAR_FREE_RY, origin);
    (void)add_joint(s, "wrist", con, 0, crank, 0, SPAR_FREE_RY, wrist);
    (void)add_joint(s, "pin", con, 0, slider, 0, SPAR_FREE_RY, pin);
    spar_joint *way = add_joint(s, "way", slider, 0, NULL, 0, SPAR_FREE_X, pin);
    OK(s, spar_joint_set_driven(shaft, SPAR_FREE_RY));
    for (int i = 1; i <= 150; i++) {
        double t = 0.03 * i, a = at + w * t, motion[6] = {0, 0, 0, 0, w * t, 0}, rate[6] = {0, 0, 0, 0, w, 0}, z[6],
               v[6], root = sqrt(l * l - r * r * sin(a) * sin(a));
        OK(s, spar_joint_drive(shaft, motion, rate, NULL));
        OK(s, spar_step(s, 0.03, NULL, NULL, NULL));
        OK(s, spar_joint_get_motion(way, z, v, NULL));
        NEAR(z[0], r * cos(a) + root - pin[0], 1e-12);
        NEAR(v[0], -r * w * sin(a) - r * r * w * sin(a) * cos(a) / root, 1e-11);
        OK(s, spar_joint_get_motion(shaft, z, v, NULL));
        NEAR(z[4], w * t, 1e-12); /* it counts its turns: 31.5 rad at the end */
    }
    spar_session_destroy(&s);
}

/* ---- universal joints ---- */

/* Two shafts that meet at the origin, bent by 30 degrees: b along x, driven; a along n. An arm of the cross stands on b
   along z, one on a along n x z. They stay perpendicular: tan(out) = cos(bend) tan(in), its rate the derivative, to
   rounding, over two and a half turns. (A held component of the rotation vector gave 93.7 degrees for 86.1.) */
static void test_hooke(void **state) {
    (void)state;
    const double bend = 3.14159265358979323846 / 6, c = cos(bend), sb = sin(bend), w = 2, dt = 0.01;
    const double J[3] = {0.1, 0.2, 0.3}, far[2][3] = {{-1, 0, 0}, {c, sb, 0}};
    /* axes of the joint, as columns: z, n x z turned to (-sb, c, 0), -n; of the hinge of a: n, (-sb, c, 0), z */
    const double half = 0.5 * bend, along[4] = {cos(half), 0, 0, sin(half)};
    const double frame[3][3] = {{0, -sb, -c}, {0, c, -sb}, {1, 0, 0}};
    double cross[4];
    cross[0] = 0.5 * sqrt(1 + frame[0][0] + frame[1][1] + frame[2][2]);
    cross[1] = (frame[2][1] - frame[1][2]) / (4 * cross[0]);
    cross[2] = (frame[0][2] - frame[2][0]) / (4 * cross[0]);
    cross[3] = (frame[1][0] - frame[0][1]) / (4 * cross[0]);
    spar_session *s = scene_session();
    spar_member *b = scene_body(s, "b", far[0], 1, J), *a = scene_body(s, "a", far[1], 1, J);
    spar_joint *in = scene_joint_at(s, "in", b, 0, NULL, 0, SPAR_FREE_RX, far[0]),
               *out = scene_joint(s, "out", a, 0, NULL, 0, SPAR_FREE_RX),
               *joint = scene_joint(s, "cross", a, 0, b, 0, SPAR_FREE_RX | SPAR_FREE_RY);
    OK(s, spar_joint_set_frame(out, far[1], along));
    OK(s, spar_joint_set_frame(joint, origin, cross));
    OK(s, spar_joint_set_driven(in, SPAR_FREE_RX));
    OK(s, spar_member_set_initial_velocity(b, far[0], origin, (double[]){w, 0, 0}));
    OK(s, spar_member_set_initial_velocity(a, far[1], origin, (double[]){w * c * c, w * c * sb, 0}));
    for (int i = 1; i <= 785; i++) {
        double at = w * dt * i, z[6], rate[6], S = sin(at), C = cos(at);
        OK(s, spar_joint_drive(in, (double[]){0, 0, 0, at, 0, 0}, (double[]){0, 0, 0, w, 0, 0}, NULL));
        OK(s, spar_step(s, dt, NULL, NULL, NULL));
        OK(s, spar_joint_get_motion(out, z, rate, NULL));
        NEAR(z[3], at + remainder(atan2(c * S, C) - at, 2 * 3.14159265358979323846), 1e-11);
        NEAR(rate[3], w * c / (C * C + c * c * S * S), 1e-10);
        OK(s, spar_joint_get_motion(joint, z, NULL, NULL));
        NEAR(z[5], 0, 1e-12);
    }
    spar_session_destroy(&s);
}

/* A gimbal: both angles of a universal joint are driven, over 9 and 14 rad; the body is where the two turns, one after
   the other, put it, and the angles are counted. */
static void test_gimbal(void **state) {
    (void)state;
    const double J[3] = {0.1, 0.2, 0.3}, dt = 0.02;
    spar_session *s = scene_session();
    spar_member *b = scene_body(s, "b", origin, 1, J);
    spar_joint *j = scene_joint_at(s, "gimbal", b, 0, NULL, 0, SPAR_FREE_RX | SPAR_FREE_RZ, origin);
    OK(s, spar_joint_set_driven(j, SPAR_FREE_RX | SPAR_FREE_RZ));
    for (int i = 1; i <= 150; i++) {
        double first = 3 * dt * i, second = -14.0 / 3 * dt * i, q[7], z[6], turn[2][4], both[4];
        OK(s, spar_joint_drive(j, (double[]){0, 0, 0, first, 0, second}, (double[]){0, 0, 0, 3, 0, -14.0 / 3}, NULL));
        OK(s, spar_step(s, dt, NULL, NULL, NULL));
        OK(s, spar_member_get_motion(b, q, NULL, NULL));
        OK(s, spar_joint_get_motion(j, z, NULL, NULL));
        NEAR(z[3], first, 1e-12);
        NEAR(z[5], second, 1e-12);
        spari_quat_exp((double[]){first, 0, 0}, turn[0]);
        spari_quat_exp((double[]){0, 0, second}, turn[1]);
        spari_quat_mul(turn[0], turn[1], both);
        NEAR(fabs(spari_quat_dot(both, q + 3)), 1, 1e-13);
    }
    spar_session_destroy(&s);
}

/* ---- lines ---- */

/* A ball of 1 kg on a rope of 1 m that only pulls (no mass, 1e4 N/m), thrown up from its hang at 3 m/s: it flies as if
   there were no rope, z = 3 t - g t^2 / 2, up to the scheme's dt^2; then the rope holds it. */
static void test_rope(void **state) {
    (void)state;
    const double g = 9.81, hang[3] = {0, 0, -1}, J[3] = {0.01, 0.01, 0.01}, dt = 1e-3;
    double mass[36], q[7], lowest = 0;
    spar_session *s = scene_session();
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -g}));
    spar_member *ball = NULL;
    scene_mass(mass, 1, origin, J);
    OK(s, spar_rigid_create(s, "ball", hang, rest, mass, &ball));
    OK(s, spar_member_set_initial_velocity(ball, hang, (double[]){0, 0, 3}, origin));
    OK(s, spar_member_commit(ball));
    spar_joint *rope = NULL;
    OK(s, spar_link_create(s, "rope", ball, 0, hang, NULL, 0, origin, &rope));
    OK(s, spar_link_set_spring(rope, 1e4, 10, 1, 1));
    for (int i = 1; i <= 900; i++) {
        double t = dt * i;
        OK(s, spar_step(s, dt, NULL, NULL, NULL));
        OK(s, spar_member_get_motion(ball, q, NULL, NULL));
        if (t < 0.6) {
            NEAR(q[2], 3 * t - 0.5 * g * t * t, 1e-9);
        }
        lowest = fmin(lowest, q[2]);
    }
    assert_true(lowest < 0 && lowest > -0.05); /* sqrt(m / k) v = 0.03 m */
    spar_session_destroy(&s);
}

/* A ball of 1e9 kg, which no rope slows down, moves out at 1 m/s and is 1 mm beyond the rope's length when the step of
   0.01 s ends. The rope has been taut for a tenth of the step. The scheme's rate of a stretch that grew from 0 in it is
   gamma / (beta dt) = 199.5 / s (rho_inf 0.9: gamma 21/38, beta (gamma + 1/2)^2 / 4). So the damper of 100 N s/m gives
   19.95 N, not 100 N; in the next step, taut from its begin, it gives 100 N. */
static void test_coming_taut(void **state) {
    (void)state;
    const double J[3] = {1e9, 1e9, 1e9}, gamma = 21.0 / 38, dt = 0.01, x[3] = {1 - 0.9 * dt, 0, 0};
    double mass[36], load[6];
    spar_session *s = scene_session();
    spar_member *ball = NULL;
    spar_joint *rope = NULL;
    scene_mass(mass, 1e9, origin, J);
    OK(s, spar_rigid_create(s, "ball", x, rest, mass, &ball));
    OK(s, spar_member_set_initial_velocity(ball, x, (double[]){1, 0, 0}, origin));
    OK(s, spar_member_commit(ball));
    OK(s, spar_link_create(s, "rope", ball, 0, x, NULL, 0, origin, &rope));
    OK(s, spar_link_set_spring(rope, 0, 100, 1, 1));
    OK(s, spar_step(s, dt, NULL, NULL, NULL));
    OK(s, spar_joint_get_load(rope, load));
    NEAR(load[0], -100 * gamma / (0.25 * (gamma + 0.5) * (gamma + 0.5) * dt) * 1e-3, 1e-5);
    OK(s, spar_step(s, dt, NULL, NULL, NULL));
    OK(s, spar_joint_get_load(rope, load));
    NEAR(load[0], -100, 1e-4);
    spar_session_destroy(&s);
}

/* A ball of 2 kg dropped 0.4 m on a rope of 1 m, 2e4 N/m and 20 N s/m: free fall, then y'' = -k/m y - c/m y' about the
   hang until the pull is 0, then free flight. *pull: the largest; height and speed below the hook at `after` seconds
   behind the moment at which the rope goes slack again, which is the answer. */
typedef struct snap {
    double m, k, c, length, from, g;
} snap;

static double rope_motion(const snap *r, double speed, double t, double *v) {
    double d = 0.5 * r->c / r->m, w = sqrt(r->k / r->m - d * d), at = r->m * r->g / r->k, A = -at,
           B = (speed + d * A) / w, C = cos(w * t), S = sin(w * t);
    *v = exp(-d * t) * ((B * w - d * A) * C - (A * w + d * B) * S);
    return at + exp(-d * t) * (A * C + B * S);
}

static double snap_oracle(const snap *r, double after, double *x, double *v, double *pull) {
    double t0 = sqrt(2 * (r->length - r->from) / r->g), speed = r->g * t0, step = 1e-6, t = step, rate,
           stretch = rope_motion(r, speed, t, &rate);
    for (*pull = 0; r->k * stretch + r->c * rate > 0; t += step) {
        *pull = fmax(*pull, r->k * stretch + r->c * rate);
        stretch = rope_motion(r, speed, t, &rate);
    }
    *x = r->length + stretch + rate * after + 0.5 * r->g * after * after;
    *v = rate + r->g * after;
    return t0 + t;
}

/* The pull of every step in which the rope is slack is 0; motion and largest pull converge to the oracle's. Errors at
   dt = 1 ms are those of when the rope goes taut in a step, v dt at most; they fall with dt. With a damper that also
   acted while the rope was slack they stayed at 3.4 mm and 2.6 N, and it pulled by up to 55 N. */
static void test_snap(void **state) {
    (void)state;
    const snap r = {2, 2e4, 20, 1, 0.6, 9.81};
    const double J[3] = {1, 1, 1}, at[3] = {0, 0, -r.from};
    for (double dt = 1e-3; dt > 1e-5; dt /= 8) {
        double x, v, most, pull = 0, energy[SPAR_JOINT_ENERGY_COUNT], mass[36], q[7], rate[6], z[6], load[6];
        double end = snap_oracle(&r, 0.03, &x, &v, &most) + 0.03;
        int steps = (int)ceil(end / dt);
        spar_session *s = scene_session();
        spar_member *ball = NULL;
        spar_joint *rope = NULL;
        OK(s, spar_session_set_gravity(s, (double[]){0, 0, -r.g}));
        scene_mass(mass, r.m, origin, J);
        OK(s, spar_rigid_create(s, "ball", at, rest, mass, &ball));
        OK(s, spar_member_set_effects(ball, SPAR_EFFECT_WORK, 0));
        OK(s, spar_member_commit(ball));
        OK(s, spar_link_create(s, "rope", ball, 0, at, NULL, 0, origin, &rope));
        OK(s, spar_link_set_spring(rope, r.k, r.c, r.length, 1));
        for (int i = 0; i < steps; i++) {
            OK(s, spar_step(s, end / steps, NULL, NULL, NULL));
            OK(s, spar_joint_get_motion(rope, z, NULL, NULL));
            OK(s, spar_joint_get_load(rope, load));
            assert_true(load[0] <= 0 && (z[0] > r.length || load[0] == 0));
            pull = fmax(pull, -load[0]);
        }
        OK(s, spar_member_get_motion(ball, q, rate, NULL));
        NEAR(r.from - q[2], x, 3 * dt);
        NEAR(-rate[2], v, 12 * dt);
        NEAR(pull, most, 3000 * dt);
        OK(s, spar_joint_get_energy(rope, SPAR_JOINT_ENERGY_COUNT, energy));
        double lost = -r.m * r.g * q[2] - 0.5 * r.m * rate[2] * rate[2];
        NEAR(energy[SPAR_JOINT_ENERGY_SPRING], 0, 0);
        NEAR(energy[SPAR_JOINT_ENERGY_DAMPER], lost, 400 * dt * lost);
        spar_session_destroy(&s);
    }
}

/* Two balls on a rod of 2 m, free in space, spinning about their middle: the rod's load is m w^2 L / 2, the distance
   stays, and so does the middle. */
static void test_rod(void **state) {
    (void)state;
    const double left[3] = {-1, 0, 0}, right[3] = {1, 0, 0}, J[3] = {0.01, 0.01, 0.01}, w = 2;
    double mass[36], z[6], load[6], q[2][7];
    spar_session *s = scene_session();
    spar_member *b[2] = {NULL, NULL};
    scene_mass(mass, 3, origin, J);
    for (int k = 0; k < 2; k++) {
        OK(s, spar_rigid_create(s, k ? "right" : "left", k ? right : left, rest, mass, &b[k]));
        OK(s, spar_member_set_initial_velocity(b[k], origin, origin, (double[]){0, w, 0}));
        OK(s, spar_member_commit(b[k]));
    }
    spar_joint *rod = NULL;
    OK(s, spar_link_create(s, "rod", b[1], 0, right, b[0], 0, left, &rod));
    for (int i = 0; i < 500; i++) {
        OK(s, spar_step(s, 2e-3, NULL, NULL, NULL));
        OK(s, spar_joint_get_motion(rod, z, NULL, NULL));
        OK(s, spar_joint_get_load(rod, load));
        NEAR(z[0], 2, 1e-12);
        NEAR(load[0], -3 * w * w, 1e-4); /* it pulls the right one to the left */
    }
    for (int k = 0; k < 2; k++) {
        OK(s, spar_member_get_motion(b[k], q[k], NULL, NULL));
    }
    for (int k = 0; k < 3; k++) {
        NEAR(q[0][k] + q[1][k], 0, 1e-12);
    }
    NEAR(1 + q[1][0], cos(2 * w * 0.5), 1e-4);
    spar_session_destroy(&s);
}

/* ---- nodes that move as they are told ---- */

/* A pendulum on a cart that accelerates at 3 m/s^2, hanging at the angle at which it stands still beside it. */
static void test_cart(void **state) {
    (void)state;
    const double g = 9.81, accel = 3, lean = atan(accel / g), L = 0.7, J[3] = {0.01, 0.01, 0.01},
                 centre[3] = {-L * sin(lean), 0, -L * cos(lean)};
    double load[6], z[6], on_cart[6];
    for (int substeps = 1; substeps <= 3; substeps += 2) {
        spar_session *s = scene_session();
        OK(s, spar_session_set_gravity(s, (double[]){0, 0, -g}));
        OK(s, spar_session_set_integrator(s, 0.9, substeps));
        spar_member *cart = NULL, *bob = NULL;
        OK(s, spar_point_create(s, "cart", origin, rest, &cart));
        OK(s, spar_member_commit(cart));
        bob = add_body(s, "bob", origin, 2, centre, J);
        spar_joint *j = add_joint(s, "hinge", bob, 0, cart, 0, SPAR_FREE_RY, origin);
        double at0[7] = {0, 0, 0, 1, 0, 0, 0}, v0[6] = {0}, a0[6] = {accel, 0, 0, 0, 0, 0};
        OK(s, spar_member_set_motion(cart, at0, v0, a0));
        for (int i = 1; i <= 100; i++) {
            double t = 0.01 * i, q[7] = {0.5 * accel * t * t, 0, 0, 1, 0, 0, 0}, v[6] = {accel * t, 0, 0, 0, 0, 0};
            OK(s, spar_step_begin(s, 0.01));
            OK(s, spar_member_set_motion(cart, q, v, a0));
            OK(s, spar_step_solve(s));
            OK(s, spar_step_accept(s));
            OK(s, spar_joint_get_motion(j, z, NULL, NULL));
            OK(s, spar_joint_get_load(j, load));
            NEAR(z[4], 0, 1e-10);
            NEAR(load[0], 2 * accel, 1e-8);
            NEAR(load[2], 2 * g, 1e-8);
            OK(s, spar_member_get_loads(cart, on_cart)); /* the bob hangs on it */
            for (int k = 0; k < 6; k++) {
                NEAR(on_cart[k], -load[k], 1e-12);
            }
        }
        spar_session_destroy(&s);
    }
}

/* A body on springs and dampers to a point that the host moves steadily along and the body sets out with: seen from it
   nothing happens, from the first acceleration on. */
static void test_sprung_to_a_cart(void **state) {
    (void)state;
    const double speed[3] = {3, -1, 2}, J[3] = {1, 1, 1}, v[6] = {3, -1, 2};
    double K[36], D[36], z[6], rate[6], load[6];
    scene_diagonal(K, 300, 400, 500, 60, 70, 80);
    scene_diagonal(D, 3, 4, 5, 6, 7, 8);
    spar_session *s = scene_session();
    spar_member *cart = NULL, *body = add_body(s, "body", origin, 2, origin, J);
    OK(s, spar_member_set_initial_velocity(body, origin, speed, origin));
    OK(s, spar_point_create(s, "cart", origin, rest, &cart));
    OK(s, spar_member_commit(cart));
    spar_joint *j = add_joint(s, "springs", body, 0, cart, 0, 63, origin);
    OK(s, spar_joint_set_spring(j, K, D, NULL));
    OK(s, spar_member_set_motion(cart, (double[]){0, 0, 0, 1, 0, 0, 0}, v, NULL));
    for (int i = 1; i <= 50; i++) {
        double t = 0.02 * i, q[7] = {3 * t, -t, 2 * t, 1, 0, 0, 0};
        OK(s, spar_step_begin(s, 0.02));
        OK(s, spar_member_set_motion(cart, q, v, NULL));
        OK(s, spar_step_solve(s));
        OK(s, spar_step_accept(s));
        OK(s, spar_joint_get_motion(j, z, rate, NULL));
        OK(s, spar_joint_get_load(j, load));
        for (int k = 0; k < 6; k++) {
            NEAR(z[k], 0, 1e-12);
            NEAR(rate[k], 0, 1e-11);
            NEAR(load[k], 0, 1e-9);
        }
    }
    spar_session_destroy(&s);
}

/* ---- external members ---- */

/* A body of 2 kg on a joint to one of 3 kg, which hangs on a spring of 50 N/m; the first sets out at 1 m/s, on a spring
   of 30 N/m, or held, both at once. `external`: the host integrates it, by the trapezoidal rule, as spar does. */
typedef struct pair {
    spar_session *s;
    spar_member *heavy, *light;
    spar_joint *between;
    double x, v, a, next[3]; /* of the light one at t^n; and at t^{n+1} */
    int checked, iterations;
} pair;

static spar_member *make_light(spar_session *s, int external) {
    const double J[3] = {1, 1, 1}, speed[3] = {1, 0, 0};
    double mass[36];
    spar_member *b = NULL;
    scene_mass(mass, 2, origin, J);
    OK(s, spar_rigid_create(s, "light", origin, rest, mass, &b));
    OK(s, spar_member_set_external(b, external));
    OK(s, spar_member_set_effects(b, SPAR_EFFECT_WORK, 0));
    OK(s, spar_member_commit(b));
    if (external) {
        OK(s, spar_member_set_motion(b, NULL, (double[]){1, 0, 0, 0, 0, 0}, NULL));
    } else {
        OK(s, spar_member_set_initial_velocity(b, origin, speed, origin));
    }
    return b;
}

static pair couple_pair(int external, int held, int scheme, int checked) {
    const double J[3] = {1, 1, 1}, ground[36] = {50}, spring[36] = {30};
    pair p = {.s = scene_session(), .v = 1, .checked = checked};
    spar_joint *slide = NULL;
    OK(p.s, spar_session_set_integrator(p.s, 1, 1));
    OK(p.s, spar_session_set_coupling(p.s, scheme, 1e-11, 1e-11, 60));
    p.heavy = add_body(p.s, "heavy", origin, 3, origin, J);
    p.light = make_light(p.s, external);
    if (held) {
        OK(p.s, spar_member_set_initial_velocity(p.heavy, origin, (double[]){1, 0, 0}, origin));
    }
    slide = add_joint(p.s, "slide", p.heavy, 0, NULL, 0, SPAR_FREE_X, origin);
    OK(p.s, spar_joint_set_spring(slide, ground, NULL, NULL));
    p.between = add_joint(p.s, "between", p.light, 0, p.heavy, 0, held ? 62 : external ? 63 : SPAR_FREE_X, origin);
    OK(p.s, spar_joint_set_spring(p.between, held ? NULL : spring, NULL, NULL));
    return p;
}

/* The host's step; without a check it is left with the loads predicted. */
static void step_pair(pair *p, double dt) {
    double x = 0, v = 0, a = 0;
    OK(p->s, spar_step_begin(p->s, dt));
    for (int done = 0; !done; p->iterations++) {
        double load[6];
        OK(p->s, spar_member_get_loads(p->light, load));
        a = load[0] / 2, v = p->v + 0.5 * dt * (p->a + a), x = p->x + dt * p->v + 0.25 * dt * dt * (p->a + a);
        const double q[7] = {x, 0, 0, 1}, rate[6] = {v}, second[6] = {a};
        OK(p->s, spar_member_set_motion(p->light, q, rate, second));
        OK(p->s, spar_step_solve(p->s));
        done = !p->checked;
        OK(p->s, p->checked ? spar_step_check(p->s, &done) : SPAR_OK);
    }
    OK(p->s, spar_step_accept(p->s));
    p->x = x, p->v = v, p->a = a;
}

/* The joint's load is among those that the host's structure answers: they are iterated until they belong to its motion,
   to what spar finds for the two as one, in few iterations; held, too, where a plain fixed point would blow up. */
static void test_external(void **state) {
    (void)state;
    for (int run = 0; run < 4; run++) {
        int held = run % 2, scheme = run / 2 ? SPAR_COUPLING_IQN_ILS : SPAR_COUPLING_AITKEN;
        pair mine = couple_pair(1, held, scheme, 1), theirs = couple_pair(0, held, scheme, 1);
        for (int i = 0; i < 100; i++) {
            double q[2][7], load[6], on[6];
            step_pair(&mine, 0.02);
            scene_run(theirs.s, 0.02, 1);
            OK(theirs.s, spar_member_get_motion(theirs.light, q[0], NULL, NULL));
            OK(mine.s, spar_member_get_motion(mine.light, q[1], NULL, NULL));
            NEAR(q[1][0], q[0][0], 1e-8);
            OK(mine.s, spar_joint_get_load(mine.between, load));
            OK(mine.s, spar_member_get_loads(mine.light, on));
            NEAR(on[0], load[0], 1e-12);
            NEAR(2 * mine.a, load[0], 1e-8);
        }
        assert_in_range(mine.iterations, 100, 400);
        double work[5];
        OK(mine.s, spar_member_get_work(mine.light, 5, work));
        NEAR(work[SPAR_WORK_JOINTS], 0.5 * 2 * (mine.v * mine.v - 1), 1e-7);
        NEAR(work[SPAR_WORK_FLUID], 0, 1e-7);
        spar_session_destroy(&mine.s);
        spar_session_destroy(&theirs.s);
    }
}

/* The host's part of a step that is one call. */
static int move_light(spar_session *s, double t, double dt, int iteration, void *context) {
    pair *p = context;
    double load[6];
    (void)s, (void)t, (void)iteration;
    OK(p->s, spar_member_get_loads(p->light, load));
    double a = load[0] / 2, v = p->v + 0.5 * dt * (p->a + a), x = p->x + dt * p->v + 0.25 * dt * dt * (p->a + a);
    p->next[0] = x, p->next[1] = v, p->next[2] = a;
    return spar_member_set_motion(p->light, (double[7]){x, 0, 0, 1}, (double[6]){v}, (double[6]){a});
}

/* The same where the whole step is one call: the host moves its member in the callback, after the others have been
   solved for, and the joint's load in the residual is that of this motion: as many iterations as the host's own loop
   takes, the same answer, and the others where the host's member leaves them. */
static void test_external_in_one_call(void **state) {
    (void)state;
    for (int run = 0; run < 4; run++) {
        int held = run % 2, scheme = run / 2 ? SPAR_COUPLING_IQN_ILS : SPAR_COUPLING_AITKEN, total = 0;
        pair loop = couple_pair(1, held, scheme, 1), call = couple_pair(1, held, scheme, 1);
        for (int i = 0; i < 100; i++) {
            double q[2][7], z[6], load[6];
            int iterations;
            step_pair(&loop, 0.02);
            OK(call.s, spar_step(call.s, 0.02, move_light, &call, &iterations));
            call.x = call.next[0], call.v = call.next[1], call.a = call.next[2];
            total += iterations;
            NEAR(call.x, loop.x, 1e-15);
            OK(call.s, spar_member_get_motion(call.light, q[0], NULL, NULL));
            OK(call.s, spar_member_get_motion(call.heavy, q[1], NULL, NULL));
            OK(call.s, spar_joint_get_motion(call.between, z, NULL, NULL));
            OK(call.s, spar_joint_get_load(call.between, load));
            NEAR(z[0], held ? 0 : q[0][0] - q[1][0], 1e-14);
            NEAR(load[0], 2 * call.a, 1e-8);
        }
        assert_int_equal(total, loop.iterations);
        spar_session_destroy(&loop.s);
        spar_session_destroy(&call.s);
    }
}

/* A point that the host moves in the callback, and a body of 3 kg on a spring of 30 N/m to it: explicit, the step's one
   solution is under the place that the callback has given. By the trapezoidal rule from rest, the point at x = 1:
   a = K (1 - dt^2 a / 4) / m. In equilibrium the body is at the point. */
static int move_point(spar_session *s, double t, double dt, int iteration, void *context) {
    (void)s, (void)t, (void)dt, (void)iteration;
    return spar_member_set_motion(context, (double[7]){1, 0, 0, 1}, (double[6]){0}, (double[6]){0});
}

static void test_point_in_callback(void **state) {
    (void)state;
    const double K = 30, m = 3, dt = 0.1, J[3] = {1, 1, 1}, spring[36] = {30};
    for (int run = 0; run < 2; run++) {
        double q[7], a[6];
        spar_session *s = scene_session();
        spar_member *point = NULL;
        OK(s, spar_session_set_integrator(s, 1, 1));
        OK(s, spar_session_set_coupling(s, SPAR_COUPLING_EXPLICIT, 0, 0, 1));
        spar_member *body = add_body(s, "body", origin, m, origin, J);
        OK(s, spar_point_create(s, "point", origin, rest, &point));
        OK(s, spar_member_commit(point));
        spar_joint *j = add_joint(s, "between", body, 0, point, 0, SPAR_FREE_X, origin);
        OK(s, spar_joint_set_spring(j, spring, NULL, NULL));
        if (run == 0) {
            OK(s, spar_step(s, dt, move_point, point, NULL));
        } else {
            OK(s, spar_session_solve_static(s, 1, move_point, point, NULL));
        }
        OK(s, spar_member_get_motion(body, q, NULL, a));
        NEAR(a[0], run ? 0 : K / (m + 0.25 * K * dt * dt), 1e-9);
        NEAR(q[0], run ? 1 : 0.25 * dt * dt * a[0], 1e-9);
        spar_session_destroy(&s);
    }
}

/* A host that never checks has the joint's load of a step's end in the next prediction: explicit, to second order. */
static void test_external_unchecked(void **state) {
    (void)state;
    double x[2], exact;
    pair both = couple_pair(0, 0, SPAR_COUPLING_EXPLICIT, 0);
    scene_run(both.s, 0.0005, 2000);
    double q[7];
    OK(both.s, spar_member_get_motion(both.light, q, NULL, NULL));
    exact = q[0];
    spar_session_destroy(&both.s);
    for (int fine = 0; fine <= 1; fine++) {
        pair p = couple_pair(1, 0, SPAR_COUPLING_EXPLICIT, 0);
        for (int i = 0; i < (fine ? 100 : 50); i++) {
            step_pair(&p, fine ? 0.01 : 0.02);
        }
        x[fine] = p.x - exact;
        spar_session_destroy(&p.s);
    }
    NEAR(order_of(x[0], x[1]), 2, 0.2);
    NEAR(x[1], 0, 1e-4);
}

/* At rest: 6 N on the heavy one, which the ground's spring of 50 N/m holds; the light one by the joint's of 30 N/m and
   the host's of 20 N/m: 6 N over 50 + 30 20 / (30 + 20) N/m. A step from there stays. */
static int rest_pair(spar_session *s, double t, double dt, int iteration, void *context) {
    const pair *p = context;
    double load[6];
    (void)t, (void)dt, (void)iteration;
    OK(s, spar_member_get_loads(p->light, load));
    const double q[7] = {load[0] / 20, 0, 0, 1};
    return spar_member_set_motion(p->light, q, NULL, NULL);
}

static void test_external_at_rest(void **state) {
    (void)state;
    const int scheme[] = {SPAR_COUPLING_FIXED_POINT, SPAR_COUPLING_AITKEN, SPAR_COUPLING_IQN_ILS};
    for (int k = 0; k < 3; k++) {
        double z[6], load[6], x = 6 / 62.0;
        int n;
        pair p = couple_pair(1, 0, scheme[k], 1);
        OK(p.s, spar_session_set_relaxation(p.s, 0.4));
        OK(p.s, spar_member_set_load(p.heavy, 0, SPAR_LOAD_DEAD, (double[]){6, 0, 0, 0, 0, 0}));
        OK(p.s, spar_session_solve_static(p.s, 1, rest_pair, &p, &n));
        assert_in_range(n, 2, 40);
        for (int step = 0; step <= 3; step++) {
            OK(p.s, spar_joint_get_motion(p.between, z, NULL, NULL));
            OK(p.s, spar_member_get_loads(p.light, load));
            NEAR(z[0], -0.4 * x, 1e-8);
            NEAR(load[0], 12 * x, 1e-6);
            int done = 0;
            OK(p.s, spar_step_begin(p.s, 0.1));
            while (!done) {
                double q[7] = {0, 0, 0, 1};
                OK(p.s, spar_member_get_loads(p.light, load));
                q[0] = load[0] / 20;
                OK(p.s, spar_member_set_motion(p.light, q, (double[6]){0}, (double[6]){0}));
                OK(p.s, spar_step_solve(p.s));
                OK(p.s, spar_step_check(p.s, &done));
            }
            OK(p.s, spar_step_accept(p.s));
        }
        spar_session_destroy(&p.s);
    }
}

/* The same under a fluid that pushes the light one at y = 0.2 m with 5 N - 4 N/m x, and a spring of 40 N m/rad about z
   in the joint beside the host's 20 N m/rad. Sprung, 20 x + 30 (x - X) = 5 - 4 x and 50 X + 30 (X - x) = 6; held, x = X
   = 11/74. The force's arm turns with the body: 60 phi = -0.2 cos(phi) (5 - 4 x). What the joint carries is K times
   that, or what the ground's spring leaves of 6 N; the external body's loads are the fluid's and the joint's. A step
   stays. */
typedef struct breeze {
    pair *pair;
    spar_fluid *air;
} breeze;

/* The host puts its body where its loads hold it; returns its place. */
static double move_in_breeze(const pair *p) {
    const double none[6] = {0};
    double load[6];
    OK(p->s, spar_member_get_loads(p->light, load));
    const double phi = load[5] / 20, q[7] = {load[0] / 20, 0, 0, cos(phi / 2), 0, 0, sin(phi / 2)};
    OK(p->s, spar_member_set_motion(p->light, q, none, none));
    return q[0];
}

static int blow_on_pair(spar_session *s, double t, double dt, int iteration, void *context) {
    const breeze *b = context;
    const double x = move_in_breeze(b->pair);
    (void)s;
    (void)t, (void)dt, (void)iteration;
    return spar_fluid_push_forces(b->air, (double[]){5 - 4 * x, 0, 0}, NULL);
}

static void step_in_breeze(const breeze *b) {
    spar_session *s = b->pair->s;
    int done = 0;
    OK(s, spar_step_begin(s, 0.1));
    while (!done) {
        const double x = move_in_breeze(b->pair);
        OK(s, spar_step_solve(s));
        OK(s, spar_fluid_push_forces(b->air, (double[]){5 - 4 * x, 0, 0}, NULL));
        OK(s, spar_step_check(s, &done));
    }
    OK(s, spar_step_accept(s));
}

static void check_breeze(const pair *p, int held) {
    double z[6], load[6], on[6], phi = 0;
    const double x = held ? 11 / 74.0 : (5 + 30 * 6 / 80.0) / (54 - 30 * 30 / 80.0), X = held ? x : (6 + 30 * x) / 80;
    for (int k = 0; k < 20; k++) {
        phi = -0.2 * cos(phi) * (5 - 4 * x) / 60;
    }
    OK(p->s, spar_joint_get_motion(p->between, z, NULL, NULL));
    OK(p->s, spar_joint_get_load(p->between, load));
    OK(p->s, spar_member_get_loads(p->light, on));
    NEAR(z[0], x - X, 1e-8);
    NEAR(z[5], phi, 1e-8);
    NEAR(load[0], held ? 6 - 50 * x : 30 * (X - x), 1e-6);
    NEAR(load[5], -40 * phi, 1e-6);
    NEAR(on[0], 20 * x, 1e-6);
    NEAR(on[5], 20 * phi, 1e-6);
}

static void test_external_at_rest_in_flow(void **state) {
    (void)state;
    const int scheme[] = {SPAR_COUPLING_FIXED_POINT, SPAR_COUPLING_AITKEN, SPAR_COUPLING_IQN_ILS};
    const double at[3] = {0, 0.2, 0}, free_turn[36] = {[35] = 40}, sprung[36] = {30, [35] = 40};
    for (int run = 0; run < 6; run++) {
        int held = run % 2, n;
        pair p = couple_pair(1, held, scheme[run / 2], 1);
        breeze b = {&p, NULL};
        OK(p.s, spar_joint_set_spring(p.between, held ? free_turn : sprung, NULL, NULL));
        OK(p.s, spar_session_set_coupling(p.s, scheme[run / 2], 1e-9, 1e-10, 60));
        OK(p.s, spar_session_set_relaxation(p.s, 0.25));
        OK(p.s, spar_fluid_create(p.light, "air", &b.air));
        OK(p.s, spar_fluid_set_motion_nodes(b.air, 1, at));
        OK(p.s, spar_fluid_set_force_nodes(b.air, 1, at));
        OK(p.s, spar_fluid_map(b.air));
        OK(p.s, spar_member_set_load(p.heavy, 0, SPAR_LOAD_DEAD, (double[]){6, 0, 0, 0, 0, 0}));
        OK(p.s, spar_session_solve_static(p.s, 1, blow_on_pair, &b, &n));
        assert_in_range(n, 2, 60);
        check_breeze(&p, held);
        /* held, 3 kg that the host's spring moves would need 1200 N/m a step: no fixed point */
        for (int step = 0; step < 3 && !(held && scheme[run / 2] != SPAR_COUPLING_IQN_ILS); step++) {
            step_in_breeze(&b);
            check_breeze(&p, held);
        }
        spar_session_destroy(&p.s);
    }
}

/* ---- a beam that one body carries ---- */

/* A rigid beam of 2 m and 3 kg, hinged at its far end: J = m L^2 / 3, so theta'' = -3 g / (2 L) cos theta from the
   horizontal; at its root nothing holds it. */
static void test_rigid_beam(void **state) {
    (void)state;
    const double g = 9.81, L = 2, far[3] = {L, 0, 0}, T = 1;
    double K[36], M[36], z[6], error[2], loads[6];
    scene_diagonal(K, 1, 1, 1, 1, 1, 1);
    scene_diagonal(M, 1.5, 1.5, 1.5, 0, 0, 0);
    for (int k = 0; k < 2; k++) {
        double dt = k ? 0.005 : 0.01;
        spar_session *s = scene_session();
        OK(s, spar_session_set_gravity(s, (double[]){0, 0, -g}));
        OK(s, spar_session_set_integrator(s, 1, 1));
        spar_member *b = scene_beam(s, "beam", 1, 4, L, K, M);
        OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
        OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_RIGID, 0));
        OK(s, spar_member_commit(b));
        spar_joint *j = add_joint(s, "hinge", b, 3, NULL, 0, SPAR_FREE_RY, far);
        for (int i = 0; i < (int)lround(T / dt); i++) {
            OK(s, spar_step(s, dt, NULL, NULL, NULL));
            assert_true(gap_of(j, SPAR_FREE_RY) < 1e-12);
        }
        OK(s, spar_joint_get_motion(j, z, NULL, NULL));
        OK(s, spar_member_get_reaction(b, loads));
        for (int i = 0; i < 6; i++) {
            NEAR(loads[i], 0, 1e-12);
        }
        error[k] = z[4] - oscillate(0, 1.5 * g / L, T); /* its free end, at -x, falls: a turn about -y */
        spar_session_destroy(&s);
    }
    NEAR(order_of(error[0], error[1]), 2, 0.05);
    assert_true(fabs(error[1]) < 1e-3);
}

/* ---- two ways to say one thing ---- */

/* A cantilever of Wang et al.'s box that its weight swings, its root driven for 1 s: by itself, or free and on a joint
   to the ground whose motions are driven. `turns`: there and back about z, from rest (test_dynamic.c's manoeuvre); else
   along x and z at constant speed. Out: the tip's place and turn, the root's load. */
static void carry_about(int by_joint, int turns, double dt, double out[13]) {
    const double speed[3] = {turns ? 0 : 2, 0, turns ? 0 : -1}, T = 1, f = two_pi;
    double K[36], M[36];
    spar_session *s = scene_session();
    spar_joint *j = NULL;
    scene_box(K, M);
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -9.81}));
    OK(s, spar_session_set_integrator(s, 0.8, 1));
    OK(s, spar_session_set_newton(s, 1e-15, 1e-15, 30));
    spar_member *b = scene_beam(s, "arm", 1, 6, 10, K, M);
    OK(s, spar_member_set_root(b, by_joint ? SPAR_ROOT_FREE : SPAR_ROOT_DRIVEN));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_initial_velocity(b, origin, speed, origin));
    if (by_joint) {
        int driven = turns ? SPAR_FREE_RZ : SPAR_FREE_X | SPAR_FREE_Z;
        j = add_joint(s, "root", b, 0, NULL, 0, driven, origin);
        OK(s, spar_joint_set_driven(j, driven));
    }
    for (int i = 1; i <= lround(T / dt); i++) {
        double t = i * dt, c = cos(f * t), d = sin(f * t), z[6] = {0}, v[6] = {0}, a[6] = {0}, q[7] = {0};
        for (int k = 0; k < 3; k++) {
            q[k] = z[k] = t * speed[k], v[k] = speed[k];
        }
        if (turns) {
            z[5] = 0.25 * (1 - c) * (1 - c), v[5] = 0.5 * f * d * (1 - c), a[5] = 0.5 * f * f * (c - c * c + d * d);
        }
        q[3] = cos(z[5] / 2), q[6] = sin(z[5] / 2);
        OK(s, by_joint ? spar_joint_drive(j, z, v, a) : spar_member_drive(b, q, v, a));
        scene_run(s, dt, 1);
    }
    scene_tip(b, out);
    OK(s, by_joint ? spar_joint_get_load(j, out + 7) : spar_member_get_reaction(b, out + 7));
    spar_session_destroy(&s);
}

/* What scene `turns` gives by both, apart: of the place and turn, and of the load beside its weight of 8.4 N and the
   moment of that, 42 N m. */
static void compare_ways(int turns, double dt, double apart[2]) {
    double out[2][13];
    apart[0] = apart[1] = 0;
    for (int k = 0; k <= 1; k++) {
        carry_about(k, turns, dt, out[k]);
    }
    for (int i = 0; i < 13; i++) {
        double size = i < 7 ? 1 : i < 10 ? 8.4 : 42;
        apart[i >= 7] = fmax(apart[i >= 7], fabs(out[1][i] - out[0][i]) / size);
    }
}

/* A driven joint and a driven root are one thing to rounding where the root goes steadily along; where it turns they
   are two discretisations of it, dt^2 apart (docs/explanation/theory.md): seen from the root, and in global axes. */
static void test_driven_root(void **state) {
    (void)state;
    double steady[2], coarse[2], fine[2];
    compare_ways(0, 0.005, steady);
    compare_ways(1, 0.00125, coarse);
    compare_ways(1, 0.000625, fine);
    for (int i = 0; i < 2; i++) {
        NEAR(steady[i], 0, i ? 1e-8 : 1e-10);
        NEAR(order_of(coarse[i], fine[i]), 2, 0.15);
        NEAR(fine[i], 0, 1e-3);
    }
}

/* A beam of 2 m (EA = 1e9 N, EI in N m^2, 1 kg/m) whose end a joint drives, which jumps in the second step. */
static void jump_by(const double z[6], double ei, double dt, double rho, double q[7], double *gap) {
    double K[36], M[36], motion[6 * 7], at[6];
    spar_session *s = scene_session();
    scene_diagonal(K, 1e9, 1e9, 1e9, ei, ei, ei);
    scene_diagonal(M, 1, 1, 1, 1e-3, 1e-3, 1e-3);
    OK(s, spar_session_set_integrator(s, rho, 1));
    spar_member *b = scene_beam(s, "rod", 1, 6, 2, K, M);
    OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
    OK(s, spar_member_commit(b));
    spar_joint *j = add_joint(s, "drive", b, 0, NULL, 0, 63, origin);
    OK(s, spar_joint_set_driven(j, 63));
    scene_run(s, dt, 1);
    for (int n = 0; n < 2; n++) {
        OK(s, spar_joint_drive(j, z, NULL, NULL));
        scene_run(s, dt, 1);
    }
    OK(s, spar_member_get_motion(b, motion, NULL, NULL));
    OK(s, spar_joint_get_motion(j, at, NULL, NULL));
    memcpy(q, motion + (ptrdiff_t)7 * 5, 7 * sizeof *q);
    *gap = 0;
    for (int k = 0; k < 6; k++) {
        *gap = fmax(*gap, fabs(at[k] - z[k]));
    }
    spar_session_destroy(&s);
}

/* Driven joints that jump, far and round, as driven roots do (test_dynamic): in long steps the beam is where they have
   carried it, to 1 mm. Newton does not find it in one stride from 45 degrees on; it walks there. And 0.35 m across with
   1 degree in 0.01 s, which shakes the beam violently. */
static void test_drives_that_jump(void **state) {
    (void)state;
    static const double far[][3] = {{0, 0, 0.35}, {2.5, 3, 3.5}}, angle[] = {0.0175, 0.785, 1.5708, 2.97};
    double q[7], gap;
    for (int i = 0; i < 8; i++) {
        const double *x = far[i / 4], by = angle[i % 4], z[6] = {x[0], x[1], x[2], 0, by, 0};
        jump_by(z, 1e3, 10, 0, q, &gap);
        NEAR(gap, 0, 1e-12);
        NEAR(q[0], x[0] + 2 * cos(by) - 2, 1e-3);
        NEAR(q[1], x[1], 1e-3);
        NEAR(q[2], x[2] - 2 * sin(by), 1e-3);
    }
    jump_by((const double[]){0, 0.35, 0, 0, 0.0175, 0}, 1e4, 0.01, 0.9, q, &gap);
    NEAR(gap, 0, 1e-12);
}

/* ---- at rest ---- */

/* A body of 5 kg, its centre 0.2 m beside its node, on springs in six directions with a preload: k z = weight + preload
   about the node, small enough to be linear; and a step after it stays. */
static void test_sprung_at_rest(void **state) {
    (void)state;
    const double centre[3] = {0.2, 0, 0}, J[3] = {1, 1, 1}, g = 9.81;
    double K[36], preload[6] = {3, -2, 4, 0.5, 0, -0.2}, z[6], load[6];
    spar_session *s = scene_session();
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -g}));
    spar_member *b = add_body(s, "body", origin, 5, centre, J);
    spar_joint *j = add_joint(s, "spring", b, 0, NULL, 0, 63, origin);
    scene_diagonal(K, 1e5, 2e5, 3e5, 4e7, 5e7, 6e7);
    OK(s, spar_joint_set_spring(j, K, NULL, preload));
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_joint_get_motion(j, z, NULL, NULL));
    OK(s, spar_joint_get_load(j, load));
    const double expected[6] = {0, 0, -5 * g, 0, 5 * g * 0.2, 0};
    for (int k = 0; k < 6; k++) {
        NEAR(z[k], (preload[k] + expected[k]) / K[7 * k], 1e-11);
        NEAR(load[k], -expected[k], 1e-6);
    }
    for (int i = 0; i < 5; i++) {
        double z2[6];
        OK(s, spar_step(s, 0.01, NULL, NULL, NULL));
        OK(s, spar_joint_get_motion(j, z2, NULL, NULL));
        for (int k = 0; k < 6; k++) {
            NEAR(z2[k], z[k], 1e-14);
        }
    }
    spar_session_destroy(&s);
}

/* A cantilever of two elements under a large tip load, against two beams welded: the same shape to rounding; the weld
   carries the tip's load and its moment about the weld. */
/* Two bodies of 1 kg hang from the ground, one on the other, by hinges along y with springs. At rest the lower one is
   carried with its weight: the load on it has the axes of the upper one, which is b, whatever the lower one's angle;
   and the hinge's spring has the moment of the weight about the hinge. */
static void test_load_has_axes_of_b(void **state) {
    (void)state;
    const double g = 9.81, half[3] = {0.5, 0, 0}, J[3] = {0.1, 0.1, 0.1}, elbow[3] = {1, 0, 0};
    double K[36] = {0}, z[2][6], load[6];
    spar_session *s = scene_session();
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -g}));
    spar_member *upper = add_body(s, "upper", origin, 1, half, J), *lower = add_body(s, "lower", elbow, 1, half, J);
    spar_joint *j[2] = {add_joint(s, "shoulder", upper, 0, NULL, 0, SPAR_FREE_RY, origin),
                        add_joint(s, "elbow", lower, 0, upper, 0, SPAR_FREE_RY, elbow)};
    K[28] = 30;
    OK(s, spar_joint_set_spring(j[0], K, NULL, NULL));
    K[28] = 6;
    OK(s, spar_joint_set_spring(j[1], K, NULL, NULL));
    OK(s, spar_session_solve_static(s, 4, NULL, NULL, NULL));
    for (int i = 0; i < 2; i++) {
        OK(s, spar_joint_get_motion(j[i], z[i], NULL, NULL));
    }
    OK(s, spar_joint_get_load(j[1], load));
    const double up = z[0][4], both = up + z[1][4]; /* a rotation by phi about y takes z to (sin phi, 0, cos phi) */
    assert_true(fabs(up) > 0.3 && fabs(z[1][4]) > 0.3);
    NEAR(load[0], -g * sin(up), 1e-6);
    NEAR(load[2], g * cos(up), 1e-6);
    NEAR(load[4], -6 * z[1][4], 1e-6);
    NEAR(load[4], -g * 0.5 * cos(both), 1e-6);
    spar_session_destroy(&s);
}

static void test_weld_at_rest(void **state) {
    (void)state;
    const double place[3] = {1, 0, 0};
    double K[36], tip[2][7], load[6] = {0, 0, 400, 30, 0, 0}, weld_load[6], q[7 * 20];
    scene_diagonal(K, 1e6, 1e6, 1e6, 200, 300, 400);
    for (int welded = 0; welded <= 1; welded++) {
        spar_session *s = scene_session();
        spar_member *first = scene_beam(s, "first", welded ? 1 : 2, 6, welded ? 1 : 2, K, NULL), *last = first;
        OK(s, spar_member_commit(first));
        spar_joint *weld = NULL;
        if (welded) {
            last = scene_beam(s, "second", 1, 6, 1, K, NULL);
            OK(s, spar_member_set_placement(last, place, NULL));
            OK(s, spar_member_set_root(last, SPAR_ROOT_FREE));
            OK(s, spar_member_commit(last));
            weld = add_joint(s, "weld", last, 0, first, 5, 0, NULL);
        }
        int64_t n;
        OK(s, spar_member_get_count(last, &n));
        OK(s, spar_member_set_load(last, n - 1, SPAR_LOAD_DEAD, load));
        OK(s, spar_member_solve_static(first, 10));
        OK(s, spar_member_get_motion(last, q, NULL, NULL));
        memcpy(tip[welded], q + 7 * (n - 1), sizeof tip[0]);
        if (welded) {
            double force[3], back[3], frame[4];
            OK(s, spar_joint_get_load(weld, weld_load));
            memcpy(frame, q + 3, sizeof frame);
            spari_rotate(frame, weld_load, force); /* the weld's axes are those of the first beam's tip */
            spari_rotate_back(frame, (double[]){0, 0, 0}, back);
            NEAR(force[0], 0, 1e-6);
            NEAR(force[1], 0, 1e-6);
            NEAR(force[2], -400, 1e-6);
        }
        spar_session_destroy(&s);
    }
    for (int k = 0; k < 7; k++) {
        NEAR(tip[1][k], tip[0][k], 1e-12);
    }
}

/* Nothing holds a hinge without spring in a plane without gravity: the message names it. */
static void test_nothing_holds(void **state) {
    (void)state;
    const double centre[3] = {0.2, 0, 0}, J[3] = {1, 1, 1}, load[6] = {0, 0, 1, 0, 0, 0};
    spar_session *s = scene_session();
    spar_member *b = add_body(s, "body", origin, 5, centre, J);
    (void)add_joint(s, "hinge", b, 0, NULL, 0, SPAR_FREE_RX, origin);
    OK(s, spar_member_set_load(b, 0, SPAR_LOAD_DEAD, load));
    assert_int_equal(spar_member_solve_static(b, 1), SPAR_ERR_NUMERIC);
    assert_non_null(strstr(spar_session_message(s), "the rotation about x"));
    spar_session_destroy(&s);
}

/* A static solution holds a pendulum by its driven hinge, at 1 rad from its hang; let go by spar_joint_set_driven, and
   a second body hung from it, both swing: theta'' of the first is that of a fresh scene that never was at rest. */
static void let_go(int held_first, double rate[6]) {
    const double hang[3] = {sin(1), 0, -cos(1)}, J[3] = {0.1, 0.1, 0.1};
    spar_session *s = scene_session();
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -9.81}));
    spar_member *upper = add_body(s, "upper", origin, 2, hang, J), *lower = add_body(s, "lower", hang, 1, hang, J);
    spar_joint *hinge = add_joint(s, "hinge", upper, 0, NULL, 0, SPAR_FREE_RY, origin);
    if (held_first) {
        OK(s, spar_joint_set_driven(hinge, SPAR_FREE_RY));
        OK(s, spar_member_solve_static(upper, 1));
        OK(s, spar_joint_set_driven(hinge, 0));
    }
    (void)add_joint(s, "elbow", lower, 0, upper, 0, SPAR_FREE_RY, hang);
    for (int i = 0; i < 50; i++) {
        OK(s, spar_step(s, 0.01, NULL, NULL, NULL));
    }
    OK(s, spar_joint_get_motion(hinge, NULL, rate, NULL));
    spar_session_destroy(&s);
}

static void test_described_after_rest(void **state) {
    (void)state;
    double fresh[6], again[6];
    let_go(0, fresh);
    let_go(1, again);
    assert_true(fabs(fresh[4]) > 1);
    NEAR(again[4], fresh[4], 1e-11);
}

/* All that a session of two masses and three joints shows. */
static void look_at_joints(spar_member *const m[2], spar_joint *const j[3], double seen[64]) {
    double *out = seen;
    memset(seen, 0, 64 * sizeof *seen);
    for (int i = 0; i < 2; i++, out += 6) {
        (void)spar_member_get_reaction(m[i], out);
    }
    for (int i = 0; i < 3; i++, out += 16) {
        (void)spar_joint_get_motion(j[i], out, NULL, NULL);
        (void)spar_joint_get_load(j[i], out + 6);
        (void)spar_joint_get_energy(j[i], SPAR_JOINT_ENERGY_COUNT, out + 12);
    }
}

/* A first step that is rejected leaves the joints as they were (the balance at t^0 had stayed in what a getter says); a
   joint described after it holds. A body of 2 kg under gravity at a rod of 3 m, whose pull is 2 kg * 9.81 m/s^2 once
   the clock runs and nothing before; then a second rod, level, keeps it from a push that way. */
static void test_joints_after_a_rejected_step(void **state) {
    (void)state;
    const double low[3] = {0, 0, -3}, side[3] = {4, 0, -3}, q[4] = {1, 0, 0, 0}, J[3] = {1, 1, 1};
    double mass[36], z[6], rate[6], load[6], x[7];
    spar_session *s = scene_session();
    spar_member *b = NULL;
    spar_joint *rod = NULL, *level = NULL;
    scene_mass(mass, 2, origin, J);
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -9.81}));
    OK(s, spar_rigid_create(s, "bob", low, q, mass, &b));
    OK(s, spar_member_commit(b));
    OK(s, spar_link_create(s, "rod", b, 0, low, NULL, 0, origin, &rod));
    for (int round = 0; round < 2; round++) {
        OK(s, spar_step_begin(s, 0.01));
        OK(s, spar_step_solve(s));
        OK(s, spar_joint_get_load(rod, load));
        NEAR(load[0], -2 * 9.81, 1e-9);
        OK(s, spar_step_reject(s));
        OK(s, spar_joint_get_motion(rod, z, rate, NULL));
        OK(s, spar_joint_get_load(rod, load));
        assert_true(z[0] == 3 && rate[0] == 0 && load[0] == 0);
    }
    OK(s, spar_link_create(s, "level", b, 0, low, NULL, 0, side, &level));
    OK(s, spar_member_set_load(b, 0, SPAR_LOAD_DEAD, (double[]){5, 0, 0, 0, 0, 0}));
    OK(s, spar_step(s, 0.01, NULL, NULL, NULL));
    OK(s, spar_joint_get_load(level, load));
    NEAR(load[0], 5, 1e-9);
    OK(s, spar_member_get_motion(b, x, NULL, NULL));
    NEAR(x[0], 0, 1e-12);
    spar_session_destroy(&s);
}

/* A step that is refused because a joint's nodes are apart leaves all as it was: those before it in the order of
   creation had been placed, and showed what springs hold there. A body of 2 kg on a line of 3 m, 3 N/m and 2 m
   unstretched, which holds 1.5 J; a second one at the ground, and a joint between the two from 1 m away. Once that has
   a frame the step is made; in 1 ms the line is shortened by 3 N / 2 kg * 1e-6 s^2 / 2. */
static void test_joints_apart_change_nothing(void **state) {
    (void)state;
    const double away[3] = {1, 0, 0}, up[3] = {0, 0, 3}, q[4] = {1, 0, 0, 0}, J[3] = {1, 1, 1};
    double mass[36], stiff[36] = {3}, before[64], after[64];
    spar_session *s = scene_session();
    spar_member *m[2];
    spar_joint *j[3] = {NULL};
    scene_mass(mass, 2, origin, J);
    OK(s, spar_rigid_create(s, "one", origin, q, mass, &m[0]));
    OK(s, spar_rigid_create(s, "two", away, q, mass, &m[1]));
    OK(s, spar_member_set_effects(m[0], SPAR_EFFECT_WORK, 0));
    OK(s, spar_member_commit(m[0]));
    OK(s, spar_member_commit(m[1]));
    OK(s, spar_link_create(s, "line", m[0], 0, origin, NULL, 0, up, &j[0]));
    OK(s, spar_link_set_spring(j[0], 3, 0, 2, 0));
    OK(s, spar_joint_create(s, "foot", m[1], 0, NULL, 0, 0, &j[1]));
    OK(s, spar_joint_create(s, "apart", m[1], 0, m[0], 0, 63, &j[2]));
    OK(s, spar_joint_set_spring(j[2], stiff, NULL, NULL));
    look_at_joints(m, j, before);
    assert_int_equal(spar_step_begin(s, 1e-3), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_session_message(s), "1 m apart"));
    look_at_joints(m, j, after);
    assert_memory_equal(before, after, sizeof before);
    OK(s, spar_joint_set_frame(j[2], away, q));
    OK(s, spar_step(s, 1e-3, NULL, NULL, NULL));
    OK(s, spar_joint_get_energy(j[0], SPAR_JOINT_ENERGY_COUNT, after));
    NEAR(after[0], 1.5 * (1 - 2 * 0.75e-6), 1e-7);
    spar_session_destroy(&s);
}

/* A clamped beam whose tip a spring of 2 N/m and 9 m connects to a fixed body, static: the tip is where the force of
   the spring, from the distance found, moves the beam alone (1e-9 m). A fixed member has no motion that its joints
   could leave free. */
static void test_spring_to_a_fixed_body(void **state) {
    (void)state;
    enum { P = 6 };
    static const double q[4] = {1, 0, 0, 0}, body_at[3] = {0, 5, 0}, tip[3] = {10, 0, 0}, centre[3] = {0, 0, 0},
                        J[3] = {1, 2, 3};
    double K[36], M[36], mass[36], force[6] = {0}, x[2][7 * P], d[3];
    for (int alone = 0; alone < 2; alone++) {
        spar_session *s = scene_session();
        spar_joint *link;
        spar_member *body;
        scene_diagonal(K, 1e4, 1e4, 1e4, 1e3, 1e3, 1e3);
        scene_diagonal(M, 1, 1, 1, 0.1, 0.1, 0.1);
        spar_member *beam = scene_beam(s, "beam", 1, P, 10, K, M);
        scene_mass(mass, 3, centre, J);
        OK(s, spar_rigid_create(s, "body", body_at, q, mass, &body));
        OK(s, spar_member_set_root(body, SPAR_ROOT_FIXED));
        OK(s, spar_member_commit(beam));
        OK(s, spar_member_commit(body));
        if (alone) {
            OK(s, spar_member_set_load(beam, P - 1, SPAR_LOAD_DEAD, force));
        } else {
            OK(s, spar_link_create(s, "link", beam, P - 1, tip, body, 0, body_at, &link));
            OK(s, spar_link_set_spring(link, 2, 0.1, 9, 0));
        }
        OK(s, spar_member_solve_static(beam, 1));
        OK(s, spar_member_get_motion(beam, x[alone], NULL, NULL));
        for (int k = 0; k < 3 && !alone; k++) {
            d[k] = body_at[k] - tip[k] - x[0][7 * (P - 1) + k];
        }
        for (int k = 0; k < 3 && !alone; k++) {
            force[k] = 2 * (spari_norm(d) - 9) * d[k] / spari_norm(d);
        }
        spar_session_destroy(&s);
    }
    assert_true(fabs(force[1]) > 0.1);
    for (int k = 0; k < 7 * P; k++) {
        NEAR(x[0][k], x[1][k], 1e-9);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pendulum),
        cmocka_unit_test(test_double_pendulum),
        cmocka_unit_test(test_weld),
        cmocka_unit_test(test_springs),
        cmocka_unit_test(test_top),
        cmocka_unit_test(test_chain),
        cmocka_unit_test(test_parallelogram),
        cmocka_unit_test(test_slider_crank),
        cmocka_unit_test(test_hooke),
        cmocka_unit_test(test_gimbal),
        cmocka_unit_test(test_rope),
        cmocka_unit_test(test_coming_taut),
        cmocka_unit_test(test_snap),
        cmocka_unit_test(test_rod),
        cmocka_unit_test(test_cart),
        cmocka_unit_test(test_sprung_at_rest),
        cmocka_unit_test(test_load_has_axes_of_b),
        cmocka_unit_test(test_weld_at_rest),
        cmocka_unit_test(test_spring_to_a_fixed_body),
        cmocka_unit_test(test_nothing_holds),
        cmocka_unit_test(test_driven_root),
        cmocka_unit_test(test_drives_that_jump),
        cmocka_unit_test(test_external),
        cmocka_unit_test(test_external_in_one_call),
        cmocka_unit_test(test_point_in_callback),
        cmocka_unit_test(test_external_at_rest),
        cmocka_unit_test(test_external_at_rest_in_flow),
        cmocka_unit_test(test_external_unchecked),
        cmocka_unit_test(test_sprung_to_a_cart),
        cmocka_unit_test(test_rigid_beam),
        cmocka_unit_test(test_described_after_rest),
        cmocka_unit_test(test_joints_after_a_rejected_step),
        cmocka_unit_test(test_joints_apart_change_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
