/* The sixteen-metre wing of Patil, Hodges & Cesnik (J. Aircraft 38, 2001) in static equilibrium with strip theory: L
   16, chord 1, EI 2e4, GJ 1e4, chordwise 4e6, elastic axis at mid-chord, density 0.0889; lift 2 pi a_eff q c per
   undeformed length by the wind in the section's plane, at a quarter of the chord, following the section. Solution of
   the exact beam equations (unshearable, 1e10) with these loads, 25 m/s, 2 degrees at the root, without gravity, 10
   digits. Here one element of 16 nodes, 24 strips at Gauss points; the fixed point of beam and strips. Tolerance 1e-9
   of the span; the angle to its last printed digit. Divergence: q_D = (pi / 2 L)^2 GJ / (c/4 c 2 pi); the increments of
   the fixed point at small angles shrink by q / q_D. */
#include "verification.h"

#include "math/basis.h"

enum { NODES = 16, STRIPS = 24 };

static const double pi = 3.14159265358979323846, span = 16, chord = 1, density = 0.0889;

typedef struct wing {
    spar_session *session;
    spar_member *beam;
    spar_fluid *strips;
    double eta[STRIPS], weight[STRIPS];
} wing;

static void create(wing *w, double root) {
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, span, 0, 0}, twist[2] = {-root, -root}; /* nose up: about -x */
    double K[36], M[36];
    w->session = scene_session();
    spar_session *s = w->session;
    scene_diagonal(K, 1e10, 1e10, 1e10, 1e4, 2e4, 4e6);
    scene_diagonal(M, 0.75, 0.75, 0.75, 0.1, 0.05, 0.05);
    OK(s, spar_beam_create(s, "wing", 1, NODES, &w->beam));
    OK(s, spar_beam_set_axis(w->beam, 2, eta, xyz, twist));
    OK(s, spar_beam_set_sections(w->beam, 1, eta, K, M));
    OK(s, spar_member_set_root(w->beam, SPAR_ROOT_FIXED));
    OK(s, spar_member_commit(w->beam));
    spari_gauss(STRIPS, w->eta, w->weight);
    for (int i = 0; i < STRIPS; i++) {
        w->eta[i] = 0.5 * (1 + w->eta[i]);
    }
    OK(s, spar_fluid_create(w->beam, "strips", &w->strips));
    OK(s, spar_fluid_set_stations(w->strips, STRIPS, w->eta, NULL));
    OK(s, spar_fluid_map(w->strips));
}

/* Effective angle of a section of orientation q, its axes as columns */
static double angle(const double q[4], double speed, double axes[9], double plane[2]) {
    spari_quat_matrix(q, axes);
    plane[0] = speed * axes[4], plane[1] = speed * axes[5]; /* wind (0, U, 0) along the section's y and z */
    return atan2(plane[1], plane[0]);
}

static void push(const wing *w, double speed) {
    double q[STRIPS][4], f[STRIPS][3], m[STRIPS][3];
    OK(w->session, spar_fluid_pull_poses(w->strips, SPAR_NODES_MOTION, 1, NULL, q[0], NULL, NULL, NULL, NULL));
    for (int i = 0; i < STRIPS; i++) {
        double R[9], p[2], a = angle(q[i], speed, R, p), v2 = p[0] * p[0] + p[1] * p[1], v = sqrt(v2);
        double lift = 0.5 * density * v2 * chord * 2 * pi * a * w->weight[i] * span / 2;
        for (int k = 0; k < 3; k++) {
            f[i][k] = lift * (-p[1] * R[3 * k + 1] + p[0] * R[3 * k + 2]) / v;
            m[i][k] = -0.25 * chord * lift * cos(a) * R[3 * k];
        }
    }
    OK(w->session, spar_fluid_push_forces(w->strips, f[0], m[0]));
}

/* Solves beam and strips in turn; returns the factor by which the last increment of the tip's twist had shrunk. */
static double iterate(const wing *w, double speed, int iterations, double tip[7]) {
    double twist = 0, change = 0, factor = 0;
    for (int i = 0; i < iterations; i++) {
        push(w, speed);
        OK(w->session, spar_member_solve_static(w->beam, 1));
        scene_tip(w->beam, tip);
        double now = 2 * atan2(tip[4], tip[3]);
        factor = change != 0 ? (now - twist) / change : 0;
        change = now - twist;
        twist = now;
    }
    return factor;
}

static void test_static_equilibrium(void **state) {
    (void)state;
    static const double expected[3] = {15.4208087454, 0.1700811501, 3.9734246354};
    const char *source = "exact beam equations with strip theory";
    wing w;
    double tip[7], place[3], R[9], plane[2], q[4], load[6];
    create(&w, 2 * pi / 180);
    iterate(&w, 25, 60, tip);
    for (int k = 0; k < 3; k++) {
        place[k] = tip[k] + (k == 0 ? span : 0);
    }
    verify_3("wing at 25 m/s, 2 degrees: tip", place, expected, 1e-9 * span, source);
    const double at_root[4] = {cos(pi / 180), -sin(pi / 180), 0, 0};
    spari_quat_mul(tip + 3, at_root, q);
    verify("effective angle at the tip, degrees", angle(q, 25, R, plane) * 180 / pi, 3.4399633, 1e-6 * 180 / pi,
           source);
    OK(w.session, spar_member_get_reaction(w.beam, load));
    verify("force at the root, x", -load[0], -37.2220, 1e-4, source);
    verify("force at the root, z", -load[2], 136.3263, 1e-4, source);
    verify("moment at the root, y", -load[4], -1221.5982, 1e-4, source);
    spar_session_destroy(&w.session);
    verified();
}

static void test_divergence(void **state) {
    (void)state;
    wing w;
    double tip[7], q_D = pow(pi / (2 * span), 2) * 1e4 / (0.25 * chord * chord * 2 * pi);
    create(&w, 1e-5);
    double factor = iterate(&w, 25, 15, tip);
    double speed = sqrt(2 * q_D / density);
    verify("divergence speed of a straight wing", 25 / sqrt(factor), speed, 1e-3 * speed, "closed form");
    spar_session_destroy(&w.session);
    verified();
}

VERIFICATION_MAIN("Sixteen-metre wing in equilibrium with the air", cmocka_unit_test(test_static_equilibrium),
                  cmocka_unit_test(test_divergence))
