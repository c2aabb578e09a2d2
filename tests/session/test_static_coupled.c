/* Static equilibrium with the fluid's answer, against closed forms: torsional divergence of a wing, a spring-like
   fluid, members that meet in the fluid only; and what a run makes of it. */
#include "scene.h"

#include "math/basis.h"
#include "math/rotation.h"

#include <stdio.h>

static const double pi = 3.14159265358979323846;

enum { MOST_STRIPS = 256 };

static char warned[1024];

static void listen(const spar_session *s, int level, const char *text, void *context) {
    (void)s, (void)context;
    if (level == SPAR_LOG_WARNING) {
        (void)snprintf(warned, sizeof warned, "%s", text);
    }
}

/* ---- a wing that twists ---- */

/* Straight wing along x on its torsional stiffness GJ; the fluid gives a moment m = lambda^2 GJ (theta + alpha0) per
   length, at Gauss points of the elements. A pure twist: turns about one axis add, whatever their size. */
typedef struct wing {
    spar_session *session;
    spar_member *beam;
    spar_fluid *strips;
    int n, calls;
    double eta[MOST_STRIPS], weight[MOST_STRIPS]; /* weight: length of the strip */
    double lambda, alpha0, theta;                 /* theta: where in the step the fluid looks */
} wing;

static const double wing_span = 3, wing_gj = 2;
static int wing_effects_off; /* of the next wing */

static void wing_create(wing *w, int elements, int nodes, double lambda_l, int scheme) {
    enum { POINTS = 8 };
    double K[36], M[36], xi[POINTS], weight[POINTS];
    memset(w, 0, sizeof *w);
    scene_diagonal(K, 100, 100, 100, wing_gj, 10, 10);
    scene_diagonal(M, 1, 1, 1, 0.2, 0.1, 0.1);
    w->session = scene_session();
    w->beam = scene_beam(w->session, "wing", elements, nodes, wing_span, K, M);
    w->lambda = lambda_l / wing_span, w->alpha0 = 0.05, w->theta = 1;
    OK(w->session, spar_member_set_effects(w->beam, 0, wing_effects_off));
    OK(w->session, spar_member_commit(w->beam));
    spari_gauss(POINTS, xi, weight);
    for (int e = 0; e < elements; e++) {
        for (int k = 0; k < POINTS; k++, w->n++) {
            w->eta[w->n] = (e + 0.5 * (1 + xi[k])) / elements;
            w->weight[w->n] = weight[k] * wing_span / (2 * elements);
        }
    }
    OK(w->session, spar_fluid_create(w->beam, "strips", &w->strips));
    OK(w->session, spar_fluid_set_stations(w->strips, w->n, w->eta, NULL));
    OK(w->session, spar_fluid_map(w->strips));
    OK(w->session, spar_session_set_coupling(w->session, scheme, 0, 1e-12, 500));
    OK(w->session, spar_session_set_log(w->session, listen, NULL));
    warned[0] = '\0';
}

static int wing_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    wing *w = context;
    static double q[MOST_STRIPS][4], force[MOST_STRIPS][3], moment[MOST_STRIPS][3];
    (void)t, (void)dt, (void)iteration;
    w->calls++;
    OK(s, spar_fluid_pull_poses(w->strips, SPAR_NODES_MOTION, w->theta, NULL, q[0], NULL, NULL, NULL, NULL));
    for (int i = 0; i < w->n; i++) {
        double twist = 2 * atan2(q[i][1], q[i][0]);
        moment[i][0] = w->lambda * w->lambda * wing_gj * (twist + w->alpha0) * w->weight[i];
    }
    return spar_fluid_push_forces(w->strips, force[0], moment[0]);
}

/* theta'' + lambda^2 (theta + alpha0) = 0, theta(0) = 0, theta'(L) = 0 */
static double wing_twist(const wing *w, double y) {
    return w->alpha0 * (tan(w->lambda * wing_span) * sin(w->lambda * y) + cos(w->lambda * y) - 1);
}

static double wing_tip(const wing *w) {
    double q[7];
    scene_tip(w->beam, q);
    return 2 * atan2(q[4], q[3]);
}

/* Twist at all strips against the slender wing's closed form at lambda L = 1.2: one element of 12 nodes has it to 1e-11
   of the tip's twist. Elements of 2 and 3 nodes: the tip's error falls with h^2 and h^4, as nodal values of degree p
   with h^2p; measured from 4 to 8 and 16 elements, within 0.1 of the order. */
static void test_twist_of_a_wing(void **state) {
    (void)state;
    wing w;
    static double q[MOST_STRIPS][4];
    wing_create(&w, 1, 12, 1.2, SPAR_COUPLING_IQN_ILS);
    OK(w.session, spar_session_solve_static(w.session, 1, wing_fluid, &w, NULL));
    OK(w.session, spar_fluid_pull_poses(w.strips, SPAR_NODES_MOTION, 1, NULL, q[0], NULL, NULL, NULL, NULL));
    for (int i = 0; i < w.n; i++) {
        NEAR(2 * atan2(q[i][1], q[i][0]), wing_twist(&w, wing_span * w.eta[i]), 1e-7 * wing_twist(&w, 3));
    }
    NEAR(wing_tip(&w), wing_twist(&w, wing_span), 1e-11 * wing_twist(&w, wing_span));
    assert_string_equal(warned, "");
    spar_session_destroy(&w.session);
    for (int nodes = 2; nodes <= 3; nodes++) {
        double error[3];
        for (int k = 0; k < 3; k++) {
            wing_create(&w, 4 << k, nodes, 1.2, SPAR_COUPLING_IQN_ILS);
            OK(w.session, spar_session_solve_static(w.session, 1, wing_fluid, &w, NULL));
            error[k] = fabs(wing_tip(&w) - wing_twist(&w, wing_span));
            spar_session_destroy(&w.session);
        }
        NEAR(log2(error[0] / error[1]), 2 * (nodes - 1), 0.1);
        NEAR(log2(error[1] / error[2]), 2 * (nodes - 1), 0.1);
    }
}

/* At q / q_D = (2 lambda L / pi)^2 = 0.9 the fixed point's residual shrinks by 0.9 an iteration (the largest eigenvalue
   of its map): 1e-12 takes 0.9^n, n = 262, less what the first loads have already; counted 240 to 270, the last factor
   0.9 within 1e-6. Quasi-Newton: at most 10. Both have the twist to 1e-9 of the tip's. */
static void test_near_divergence(void **state) {
    (void)state;
    static double residual[500];
    wing w;
    int n = 0;
    wing_create(&w, 1, 12, pi / 2 * sqrt(0.9), SPAR_COUPLING_FIXED_POINT);
    OK(w.session, spar_session_solve_static(w.session, 1, wing_fluid, &w, &n));
    assert_in_range(n, 240, 270);
    assert_int_equal(w.calls, n);
    int told;
    OK(w.session, spar_session_get_iterations(w.session, &told, 500, residual, NULL));
    assert_int_equal(told, n);
    NEAR(residual[100] / residual[99], 0.9, 1e-6);
    NEAR(wing_tip(&w), wing_twist(&w, wing_span), 1e-9 * wing_twist(&w, wing_span));
    spar_session_destroy(&w.session);
    wing_create(&w, 1, 12, pi / 2 * sqrt(0.9), SPAR_COUPLING_IQN_ILS);
    OK(w.session, spar_session_solve_static(w.session, 1, wing_fluid, &w, &n));
    assert_in_range(n, 3, 10);
    NEAR(wing_tip(&w), wing_twist(&w, wing_span), 1e-9 * wing_twist(&w, wing_span));
    spar_session_destroy(&w.session);
}

/* Beyond, at q / q_D = 1.21, the fixed point's loads grow by 1.21 an iteration: refused, with member and factor named,
   and all as it was. Quasi-Newton finds the equilibrium there is, which is unstable: the log says so. */
static void test_beyond_divergence(void **state) {
    (void)state;
    wing w;
    int n = 0;
    wing_create(&w, 1, 12, pi / 2 * 1.1, SPAR_COUPLING_FIXED_POINT);
    OK(w.session, spar_session_set_coupling(w.session, SPAR_COUPLING_FIXED_POINT, 0, 1e-12, 30));
    w.alpha0 = 1e-4; /* 1.21^30 of it are no large turns */
    assert_int_equal(spar_session_solve_static(w.session, 1, wing_fluid, &w, &n), SPAR_ERR_NUMERIC);
    assert_int_equal(n, 30);
    const char *message = spar_session_message(w.session);
    assert_non_null(strstr(message, "spar_session_solve_static: the loads grow"));
    assert_non_null(strstr(message, "by a factor of 1.21:"));
    assert_non_null(strstr(message, "member 'wing'"));
    assert_non_null(strstr(message, "static divergence"));
    NEAR(wing_tip(&w), 0, 0);
    double report[SPAR_REPORT_COUNT];
    OK(w.session, spar_session_get_iterations(w.session, &n, 0, NULL, NULL));
    OK(w.session, spar_session_get_report(w.session, SPAR_REPORT_COUNT, report));
    assert_int_equal(n, 30);
    NEAR(report[SPAR_REPORT_CONTRACTION], 1.21, 0.01);
    OK(w.session, spar_session_set_coupling(w.session, SPAR_COUPLING_IQN_ILS, 0, 1e-12, 40));
    assert_string_equal(warned, "");
    OK(w.session, spar_session_solve_static(w.session, 1, wing_fluid, &w, NULL));
    NEAR(wing_tip(&w), wing_twist(&w, wing_span), 1e-9 * fabs(wing_twist(&w, wing_span)));
    assert_non_null(strstr(warned, "unstable (static divergence)"));
    spar_session_destroy(&w.session);
}

/* Steps without inertia are equilibria one after the other: beyond divergence they say so as the static solution does,
   once in a run. Below it, and with inertia (where such a ratio is that of an added mass), nothing is told. */
static void test_steps_beyond_divergence(void **state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        wing w;
        int times = 0;
        wing_effects_off = k < 2 ? SPAR_EFFECT_INERTIA : 0;
        wing_create(&w, 1, 12, pi / 2 * (k == 0 ? 1.1 : 0.8), SPAR_COUPLING_IQN_ILS);
        wing_effects_off = 0;
        for (int step = 0; step < 4; step++) {
            warned[0] = '\0';
            OK(w.session, spar_step(w.session, 0.1, wing_fluid, &w, NULL));
            times += strstr(warned, "unstable (static divergence)") != NULL;
        }
        assert_int_equal(times, k == 0);
        if (k < 2) {
            NEAR(wing_tip(&w), wing_twist(&w, wing_span), 1e-9 * fabs(wing_twist(&w, wing_span)));
        }
        spar_session_destroy(&w.session);
    }
}

/* ---- a body that floats ---- */

typedef struct buoy {
    spar_member *body;
    spar_fluid *sea;
} buoy;

/* Buoyancy of 40 kN/m about its weight at a draught of 0.1 m, and a righting moment of 20 kN m. */
static int sea(spar_session *s, double t, double dt, int iteration, void *context) {
    buoy *b = context;
    double x[3], q[4], n[3], moment[3], up[3] = {0, 0, 1};
    (void)t, (void)dt, (void)iteration;
    OK(s, spar_fluid_pull_poses(b->sea, SPAR_NODES_MOTION, 1, x, q, NULL, NULL, NULL, NULL));
    spari_rotate(q, up, n);
    spari_cross(n, up, moment);
    for (int i = 0; i < 3; i++) {
        moment[i] *= 2e4;
    }
    return spar_fluid_push_forces(b->sea, (double[]){0, 0, 9810 - 4e4 * (x[2] - 0.1)}, moment);
}

/* The static solution does not know the sea's stiffness and refuses. Steps with dampers settle, as its message says:
   4e4 N/m, 1000 kg and 1e4 N s/m decay by exp(-5 t), to 1e-6 m within 3 s. */
static void test_floating_body(void **state) {
    (void)state;
    const double centre[3] = {0}, J[3] = {500, 500, 700};
    double mass[36], damping[36], q[7];
    buoy b;
    spar_session *s = scene_session();
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -9.81}));
    scene_mass(mass, 1000, centre, J);
    OK(s, spar_rigid_create(s, "buoy", NULL, NULL, mass, &b.body));
    OK(s, spar_member_set_root(b.body, SPAR_ROOT_FREE));
    OK(s, spar_member_commit(b.body));
    OK(s, spar_fluid_create(b.body, "sea", &b.sea));
    OK(s, spar_fluid_set_motion_nodes(b.sea, 1, centre));
    OK(s, spar_fluid_set_force_nodes(b.sea, 1, centre));
    OK(s, spar_fluid_map(b.sea));
    REFUSED(s, SPAR_ERR_STATE, "let a floating body settle in steps, with dampers",
            spar_session_solve_static(s, 20, sea, &b, NULL));
    scene_diagonal(damping, 1e4, 1e4, 1e4, 1e4, 1e4, 1e4);
    OK(s, spar_spring_create(s, "dampers", b.body, 0, 63, NULL, damping, NULL, NULL));
    REFUSED(s, SPAR_ERR_NUMERIC, "the stiffness of a fluid does not count",
            spar_session_solve_static(s, 20, sea, &b, NULL));
    for (int i = 0; i < 100; i++) {
        OK(s, spar_step(s, 0.05, sea, &b, NULL));
    }
    OK(s, spar_member_get_motion(b.body, q, NULL, NULL));
    NEAR(q[2], 0.1, 1e-5);
    spar_session_destroy(&s);
}

/* ---- fluids like springs ---- */

/* Cantilevers of linear theory along x, a metre apart in y; the fluid answers force b_i - sum k_ij u_j, along z, on the
   tip of the i-th. Tip stiffness K_i = 1 / (L^3 / 3 EI + L / GA). */
typedef struct springs {
    spar_session *session;
    spar_member *beam[2];
    spar_fluid *tip[2];
    int n, calls, bad_call, answer; /* bad_call: pushes NaN; answer: of the next call, unless 0 */
    double K[2], b[2], k[2][2], theta;
} springs;

static void springs_create(springs *p, int n, int scheme) {
    static const double eta[2] = {0, 1}, EI[2] = {6, 9}, GA = 50, length = 2;
    memset(p, 0, sizeof *p);
    p->session = scene_session();
    p->n = n, p->theta = 1;
    for (int i = 0; i < n; i++) {
        char name[8] = {'b', (char)('0' + i), 0};
        double K[36], M[36], xyz[6] = {0, i, 0, length, i, 0};
        scene_diagonal(K, 100, GA, GA, 5, EI[i], EI[i]);
        scene_diagonal(M, 1, 1, 1, 0.2, 0.1, 0.1);
        p->K[i] = 1 / (length * length * length / (3 * EI[i]) + length / GA);
        OK(p->session, spar_beam_create(p->session, name, 1, 5, &p->beam[i]));
        OK(p->session, spar_beam_set_axis(p->beam[i], 2, eta, xyz, NULL));
        OK(p->session, spar_beam_set_sections(p->beam[i], 1, eta, K, M));
        OK(p->session, spar_member_set_fidelity(p->beam[i], SPAR_FIDELITY_LINEAR, 0));
        OK(p->session,
           spar_member_set_effects(p->beam[i], EFFECTS_ONLY(SPAR_EFFECT_INERTIA | SPAR_EFFECT_FLUID_HISTORY)));
        OK(p->session, spar_member_commit(p->beam[i]));
        OK(p->session, spar_fluid_create(p->beam[i], name, &p->tip[i]));
        OK(p->session, spar_fluid_set_motion_nodes(p->tip[i], 1, xyz + 3));
        OK(p->session, spar_fluid_set_force_nodes(p->tip[i], 1, xyz + 3));
        OK(p->session, spar_fluid_map(p->tip[i]));
    }
    OK(p->session, spar_session_set_coupling(p->session, scheme, 0, 1e-14, 200));
}

static double tip_of(const springs *p, int i) {
    double q[7];
    scene_tip(p->beam[i], q);
    return q[2];
}

static int springs_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    springs *p = context;
    double u[2] = {0, 0};
    (void)t, (void)dt, (void)iteration;
    p->calls++;
    for (int i = 0; i < p->n; i++) {
        double x[3];
        OK(s, spar_fluid_pull_motion(p->tip[i], p->theta, x, NULL));
        u[i] = x[2];
    }
    for (int i = 0; i < p->n; i++) {
        double force[3] = {0, 0, p->b[i] - p->k[i][0] * u[0] - p->k[i][1] * u[1]};
        force[2] = p->calls == p->bad_call ? NAN : force[2];
        int status = spar_fluid_push_forces(p->tip[i], force, NULL);
        if (status != SPAR_OK && p->calls != p->bad_call) {
            return status;
        }
    }
    return p->answer;
}

/* u = b / (K + k) to 1e-12, by fixed point and quasi-Newton, at any theta the fluid looks; every residual of the fixed
   point is k/K times the one before (1e-8, or rounding of 1e-13 in the first, some hundred roundings of a factored
   solution, of which the tenth is 5e-7 where it falls fastest), with relaxation |1 - omega (1 + k/K)| times. At k = 1.5
   K the fixed point diverges by 1.5, relaxed by 0.6 it halves; quasi-Newton has it in 4. */
static void test_spring(void **state) {
    (void)state;
    static const struct {
        int scheme;
        double part, omega, theta;
        int fails;
    } cases[] = {{SPAR_COUPLING_FIXED_POINT, 0.5, 1, 1, 0}, {SPAR_COUPLING_FIXED_POINT, 0.5, 0.8, 1, 0},
                 {SPAR_COUPLING_FIXED_POINT, 1.5, 1, 1, 1}, {SPAR_COUPLING_FIXED_POINT, 1.5, 0.6, 0.5, 0},
                 {SPAR_COUPLING_AITKEN, 1.5, 1, 1, 0},      {SPAR_COUPLING_IQN_ILS, 1.5, 1, 0.5, 0},
                 {SPAR_COUPLING_IQN_ILS, 30, 1, 0, 0}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        springs p;
        double residual[200];
        int n;
        springs_create(&p, 1, cases[c].scheme);
        OK(p.session, spar_session_set_relaxation(p.session, cases[c].omega));
        p.b[0] = 3e-3, p.theta = cases[c].theta;
        OK(p.session, spar_session_set_coupling(p.session, cases[c].scheme, 0, 1e-12, cases[c].fails ? 15 : 200));
        p.k[0][0] = cases[c].part * p.K[0];
        int status = spar_session_solve_static(p.session, 1, springs_fluid, &p, &n);
        OK(p.session, spar_session_get_iterations(p.session, NULL, 200, residual, NULL));
        if (cases[c].scheme == SPAR_COUPLING_FIXED_POINT) {
            double factor = fabs(1 - cases[c].omega * (1 + cases[c].part));
            for (int i = 1; i < 10; i++) {
                double rounding = 1e-13 * residual[0] / residual[i];
                NEAR(residual[i] / residual[i - 1], factor, fmax(1e-8, rounding) * factor);
            }
        }
        if (cases[c].fails) {
            assert_int_equal(status, SPAR_ERR_NUMERIC);
            assert_non_null(strstr(spar_session_message(p.session), "by a factor of 1.5:"));
            assert_non_null(strstr(spar_session_message(p.session), "'b0'"));
            NEAR(tip_of(&p, 0), 0, 0);
        } else {
            OK(p.session, status);
            NEAR(tip_of(&p, 0), 3e-3 / (p.K[0] + p.k[0][0]), 1e-12 * 3e-3 / p.K[0]);
            for (int end = 0; end < 2; end++) { /* the node forces at t^n are those, and nothing is predicted beyond */
                double force[3];
                OK(p.session, spar_fluid_pull_forces(p.tip[0], end, force));
                NEAR(force[2], 3e-3 / (1 + cases[c].part), 1e-11 * 3e-3);
            }
        }
        assert_true(cases[c].scheme == SPAR_COUPLING_FIXED_POINT || n <= 4);
        assert_int_equal(p.calls, n);
        spar_session_destroy(&p.session);
    }
}

/* Two members, each with a fluid of its own, that meet in the fluid alone: (K + k) u = b, k neither symmetric nor
   diagonal; 1e-12 of the largest. */
static void test_two_members(void **state) {
    (void)state;
    for (int scheme = SPAR_COUPLING_FIXED_POINT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
        springs p;
        springs_create(&p, 2, scheme);
        p.b[0] = 3, p.b[1] = -1;
        p.k[0][0] = 0.3 * p.K[0], p.k[0][1] = 0.4 * p.K[0], p.k[1][0] = -0.2 * p.K[1], p.k[1][1] = 0.5 * p.K[1];
        OK(p.session, spar_session_solve_static(p.session, 1, springs_fluid, &p, NULL));
        double a = p.K[0] + p.k[0][0], b = p.k[0][1], c = p.k[1][0], d = p.K[1] + p.k[1][1], det = a * d - b * c;
        NEAR(tip_of(&p, 0), (d * p.b[0] - b * p.b[1]) / det, 1e-12);
        NEAR(tip_of(&p, 1), (a * p.b[1] - c * p.b[0]) / det, 1e-12);
        spar_session_destroy(&p.session);
    }
}

/* Explicit: the fluid is called once, on the shape under the loads there are (none), and the shape is that of its
   answer: u = b / K, and k u the next time: u = (b - k b / K) / K. Rounding. */
static void test_explicit_asks_once(void **state) {
    (void)state;
    springs p;
    int n;
    springs_create(&p, 1, SPAR_COUPLING_EXPLICIT);
    p.b[0] = 3, p.k[0][0] = 0.5 * p.K[0];
    for (int k = 0; k < 2; k++) {
        OK(p.session, spar_session_solve_static(p.session, 1, springs_fluid, &p, &n));
        assert_int_equal(n, 1);
        assert_int_equal(p.calls, k + 1);
        NEAR(tip_of(&p, 0), 3 / p.K[0] * (k ? 0.5 : 1), 1e-13);
    }
    spar_session_destroy(&p.session);
}

/* ---- what a run makes of it ---- */

/* A beam bent by gravity and by a wind whose loads turn with it: 30 N on 11 points. */
typedef struct flag {
    spar_session *session;
    spar_member *beam;
    spar_fluid *wind;
    double x[11][3];
} flag;

static void flag_create(flag *f, int scheme) {
    static const double gravity[3] = {0, 0, -4}, mu[6] = {0.05, 0.05, 0.05, 0.05, 0.05, 0.05};
    double K[36], M[36];
    memset(f, 0, sizeof *f);
    f->session = scene_session();
    scene_diagonal(K, 4e3, 4e3, 4e3, 60, 60, 60);
    scene_diagonal(M, 1, 1, 1, 0.02, 0.01, 0.01);
    OK(f->session, spar_session_set_gravity(f->session, gravity));
    f->beam = scene_beam(f->session, "flag", 2, 6, 4, K, M);
    OK(f->session, spar_beam_set_damping(f->beam, mu));
    OK(f->session, spar_member_set_effects(f->beam, SPAR_EFFECT_WORK, 0));
    OK(f->session, spar_member_commit(f->beam));
    for (int i = 0; i < 11; i++) {
        f->x[i][0] = 0.4 * i;
    }
    OK(f->session, spar_fluid_create(f->beam, "wind", &f->wind));
    OK(f->session, spar_fluid_set_motion_nodes(f->wind, 11, f->x[0]));
    OK(f->session, spar_fluid_set_force_nodes(f->wind, 11, f->x[0]));
    OK(f->session, spar_fluid_map(f->wind));
    OK(f->session, spar_session_set_coupling(f->session, scheme, 0, 1e-11, 200));
}

/* Along y, less where the beam has moved; and drag on what moves */
static int wind_on(spar_session *s, double t, double dt, int iteration, void *context) {
    flag *f = context;
    double x[11][3], v[11][3], force[11][3];
    (void)t, (void)dt, (void)iteration;
    OK(s, spar_fluid_pull_motion(f->wind, 1, x[0], v[0]));
    for (int i = 0; i < 11; i++) {
        for (int k = 0; k < 3; k++) {
            force[i][k] = (k == 1 ? 3 : 0) - 1.5 * (x[i][k] - f->x[i][k]) - 2 * v[i][k];
        }
    }
    return spar_fluid_push_forces(f->wind, force[0], NULL);
}

static double apart(const spar_member *a, const spar_member *b) {
    double x[12][7], y[12][7], most = 0;
    assert_int_equal(spar_member_get_motion(a, x[0], NULL, NULL), SPAR_OK);
    assert_int_equal(spar_member_get_motion(b, y[0], NULL, NULL), SPAR_OK);
    for (int i = 0; i < 12; i++) {
        for (int k = 0; k < 7; k++) {
            most = fmax(most, fabs(x[i][k] - y[i][k]));
        }
    }
    return most;
}

/* The static answer is where a damped run ends (tip moved by more than a metre): 400 steps of 0.1 s, rho_inf 0, to
   1e-9. All schemes find the same, in one load step or five: 1e-10. */
static void test_end_of_a_run(void **state) {
    (void)state;
    flag run, still;
    double q[7];
    flag_create(&run, SPAR_COUPLING_IQN_ILS);
    OK(run.session, spar_session_set_integrator(run.session, 0, 1));
    for (int i = 0; i < 400; i++) {
        OK(run.session, spar_step(run.session, 0.1, wind_on, &run, NULL));
    }
    scene_tip(run.beam, q);
    assert_true(fabs(q[1]) > 0.5 && fabs(q[2]) > 0.5);
    for (int scheme = SPAR_COUPLING_FIXED_POINT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
        flag_create(&still, scheme);
        OK(still.session, spar_session_set_relaxation(still.session, 0.5));
        OK(still.session,
           spar_session_solve_static(still.session, scheme == SPAR_COUPLING_AITKEN ? 5 : 1, wind_on, &still, NULL));
        assert_true(apart(run.beam, still.beam) < 1e-9);
        spar_session_destroy(&still.session);
    }
    spar_session_destroy(&run.session);
}

/* Steps from it stay at rest to rounding: displacements within 1e-12 of 4 m, velocities 1e-10 m/s; before the first
   step, and within a run that was moving. The loads at t^n are the fluid's there: predicted loads are these, whatever
   the order, and the first iteration agrees. The account of work begins anew and stays at 0. */
static void test_run_begins_at_rest(void **state) {
    (void)state;
    flag f, start;
    double v[12][6], load[12][6], then[12][6], work[3];
    flag_create(&f, SPAR_COUPLING_IQN_ILS);
    flag_create(&start, SPAR_COUPLING_IQN_ILS);
    OK(f.session, spar_session_set_predictor(f.session, 2));
    for (int when = 0; when < 2; when++) {
        int n;
        if (when) { /* let go, and moving */
            for (int i = 0; i < 5; i++) {
                OK(f.session, spar_step(f.session, 0.1, wind_on, &f, NULL));
                double down[6] = {0, 0, -3, 0, 0, 0};
                OK(f.session, spar_member_set_load(f.beam, 11, SPAR_LOAD_DEAD, down));
            }
            double none[6] = {0};
            OK(f.session, spar_member_set_load(f.beam, 11, SPAR_LOAD_DEAD, none));
        }
        OK(f.session, spar_member_get_work(f.beam, 3, work));
        OK(f.session, spar_session_solve_static(f.session, 1, wind_on, &f, NULL));
        OK(f.session, spar_member_get_loads(f.beam, load[0]));
        if (!when) {
            OK(start.session, spar_session_solve_static(start.session, 1, wind_on, &start, NULL));
        }
        for (int i = 0; i < 4; i++) {
            OK(f.session, spar_step_begin(f.session, i % 2 ? 0.01 : 0.1));
            OK(f.session, spar_member_get_loads(f.beam, then[0]));
            for (int k = 0; k < 72; k++) {
                NEAR(then[k / 6][k % 6], load[k / 6][k % 6], 1e-9);
            }
            OK(f.session, spar_step_reject(f.session));
            OK(f.session, spar_step(f.session, i % 2 ? 0.01 : 0.1, wind_on, &f, &n));
            assert_int_equal(n, 1);
            assert_true(apart(f.beam, start.beam) < 1e-10);
            OK(f.session, spar_member_get_motion(f.beam, NULL, v[0], NULL));
            for (int k = 0; k < 72; k++) {
                NEAR(v[k / 6][k % 6], 0, 1e-9);
            }
        }
        OK(f.session, spar_member_get_work(f.beam, 3, work));
        NEAR(fabs(work[0]) + fabs(work[1]) + fabs(work[2]), 0, 1e-9);
    }
    spar_session_destroy(&f.session);
    spar_session_destroy(&start.session);
}

/* Without a fluid: the kept loads and what was pushed, as of the members one by one, to the bit; and once is enough. */
static void test_without_a_fluid(void **state) {
    (void)state;
    flag both[2];
    double force[11][3] = {{0}};
    int n;
    for (int k = 0; k < 2; k++) {
        flag *f = both + k;
        flag_create(f, SPAR_COUPLING_IQN_ILS);
        for (int i = 0; i < 11; i++) {
            force[i][1] = 0.2 * i;
        }
        OK(f->session, spar_fluid_push_forces(f->wind, force[0], NULL));
        if (k) {
            OK(f->session, spar_member_solve_static(f->beam, 3));
        } else {
            OK(f->session, spar_session_solve_static(f->session, 3, NULL, NULL, &n));
            assert_int_equal(n, 1);
        }
        OK(f->session, spar_step(f->session, 0.1, NULL, NULL, NULL));
    }
    NEAR(apart(both[0].beam, both[1].beam), 0, 0);
    spar_session_destroy(&both[0].session);
    spar_session_destroy(&both[1].session);
}

/* ---- what takes part ---- */

/* An external member and a point go where the solver puts them: here a spring of the host's under its own load, 3 N /
   (2 N/m + 1 N/m of the fluid's) = 1 m; rounding. They keep that place. A driven root goes on to where it was driven.
 */
typedef struct company {
    spar_member *mine, *point, *driven;
    spar_fluid *around;
} company;

static int company_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    company *c = context;
    double load[6], q[7] = {0, 0, 0, 1}, x[3], force[3] = {3, 0, 0};
    (void)iteration;
    NEAR(t, 0, 0);
    NEAR(dt, 0, 0);
    OK(s, spar_member_get_loads(c->mine, load));
    q[0] = load[0] / 2;
    OK(s, spar_member_set_motion(c->mine, q, NULL, NULL));
    q[0] = 0.25;
    OK(s, spar_member_set_motion(c->point, q, NULL, NULL));
    OK(s, spar_fluid_pull_motion(c->around, 1, x, NULL));
    force[0] -= x[0];
    return spar_fluid_push_forces(c->around, force, NULL);
}

static void test_company(void **state) {
    (void)state;
    static const double none[3] = {0, 0, 0}, J[3] = {1, 1, 1};
    double mass[36], q[7], K[36], M[36], to[7] = {0, 0.5, 0, 1, 0, 0, 0};
    company c;
    spar_session *s = scene_session();
    scene_mass(mass, 1, none, J);
    scene_box(K, M);
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 0, 1e-13, 20));
    OK(s, spar_rigid_create(s, "mine", NULL, NULL, mass, &c.mine));
    OK(s, spar_member_set_external(c.mine, 1));
    OK(s, spar_point_create(s, "point", NULL, NULL, &c.point));
    c.driven = scene_beam(s, "driven", 1, 4, 1, K, M);
    OK(s, spar_member_set_root(c.driven, SPAR_ROOT_DRIVEN));
    OK(s, spar_member_commit(c.mine));
    OK(s, spar_member_commit(c.point));
    OK(s, spar_member_commit(c.driven));
    OK(s, spar_fluid_create(c.mine, "around", &c.around));
    OK(s, spar_fluid_set_motion_nodes(c.around, 1, none));
    OK(s, spar_fluid_set_force_nodes(c.around, 1, none));
    OK(s, spar_fluid_map(c.around));
    OK(s, spar_member_drive(c.driven, to, NULL, NULL));
    OK(s, spar_session_solve_static(s, 1, company_fluid, &c, NULL));
    scene_tip(c.mine, q);
    NEAR(q[0], 1, 1e-12);
    scene_tip(c.point, q);
    NEAR(q[0], 0.25, 0);
    scene_tip(c.driven, q);
    NEAR(q[1], 0, 0);
    OK(s, spar_step_begin(s, 0.1));
    OK(s, spar_step_solve(s));
    OK(s, spar_step_accept(s));
    scene_tip(c.mine, q);
    NEAR(q[0], 1, 1e-12);
    double all[4][7];
    OK(s, spar_member_get_motion(c.driven, all[0], NULL, NULL));
    NEAR(all[0][1], 0.5, 1e-15);
    spar_session_destroy(&s);
}

/* A blade on a root that turns, prescribed beside exact: the fluid sees both turn, v = omega x r at the tip; rounding
   for the one, the stretched blade's own place for the other. */
static void test_turning_members(void **state) {
    (void)state;
    static const double omega[3] = {0, 0, 2};
    double K[36], M[36], q[4][7], v[4][6], a[4][6];
    for (int exact = 0; exact < 2; exact++) {
        spar_session *s = scene_session();
        scene_box(K, M);
        spar_member *b = scene_beam(s, "blade", 1, 4, 5, K, M);
        OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
        OK(s, spar_member_set_fidelity(b, exact ? SPAR_FIDELITY_EXACT : SPAR_FIDELITY_PRESCRIBED, 0));
        OK(s, spar_member_set_initial_velocity(b, NULL, NULL, omega));
        OK(s, spar_member_commit(b));
        OK(s, spar_session_solve_static(s, 1, NULL, NULL, NULL));
        OK(s, spar_member_get_motion(b, q[0], v[0], a[0]));
        NEAR(v[3][1], 2 * (5 + q[3][0]), 1e-12);
        NEAR(a[3][0], -4 * (5 + q[3][0]), 1e-12);
        NEAR(v[3][5], 2, 1e-14);
        spar_session_destroy(&s);
    }
}

/* ---- what is refused ---- */

static int calls_back(spar_session *s, double t, double dt, int iteration, void *context) {
    (void)t, (void)dt;
    int done = 0;
    assert_int_equal(spar_step_begin(s, 0.1), SPAR_ERR_STATE);
    assert_non_null(strstr(spar_session_message(s), "spar_session_solve_static is in progress"));
    assert_int_equal(spar_step_solve(s), SPAR_ERR_STATE);
    assert_int_equal(spar_step_check(s, &done), SPAR_ERR_STATE);
    assert_int_equal(spar_step_accept(s), SPAR_ERR_STATE);
    assert_int_equal(spar_step_reject(s), SPAR_ERR_STATE);
    assert_int_equal(spar_step(s, 0.1, NULL, NULL, NULL), SPAR_ERR_STATE);
    assert_int_equal(spar_session_solve_static(s, 1, NULL, NULL, NULL), SPAR_ERR_STATE);
    assert_int_equal(spar_session_save(s, "/tmp/none.spar"), SPAR_ERR_STATE);
    assert_int_equal(spar_session_set_predictor(s, 0), SPAR_ERR_STATE);
    return springs_fluid(s, t, dt, iteration, context);
}

/* Every way to fail leaves loads, shape, clock and what quasi-Newton has learned as they were: a run that fails in it,
   before the first step and between later ones, ends like one that does not try, to the bit. */
static void test_failures_leave_all(void **state) {
    (void)state;
    springs p, calm;
    double force[3] = {0, 0, 0.7};
    springs_create(&p, 2, SPAR_COUPLING_IQN_ILS);
    springs_create(&calm, 2, SPAR_COUPLING_IQN_ILS);
    for (int i = 0; i < 2; i++) {
        calm.b[i] = p.b[i] = 3;
        calm.k[i][i] = p.k[i][i] = 2 * p.K[i];
        OK(p.session, spar_fluid_push_forces(p.tip[i], force, NULL));
        OK(calm.session, spar_fluid_push_forces(calm.tip[i], force, NULL));
    }
    for (int step = 0; step < 6; step++) {
        spar_session *s = p.session;
        double before[5][7], after[5][7], loads[2][5][6];
        OK(s, spar_member_get_motion(p.beam[1], before[0], NULL, NULL));
        OK(s, spar_member_get_loads(p.beam[1], loads[0][0]));
        p.bad_call = p.calls + 2;
        REFUSED(s, SPAR_ERR_ARGUMENT, "push", spar_session_solve_static(s, 1, springs_fluid, &p, NULL));
        p.bad_call = 0, p.answer = 5;
        REFUSED(s, SPAR_ERR_USER, "spar_session_solve_static: the fluid solver returned 5 in iteration 0",
                spar_session_solve_static(s, 1, springs_fluid, &p, NULL));
        p.answer = 0;
        REFUSED(s, SPAR_ERR_ARGUMENT, "0 load steps", spar_session_solve_static(s, 0, springs_fluid, &p, NULL));
        p.k[0][0] *= 1e200;
        p.b[1] = 1e300;
        REFUSED(s, SPAR_ERR_NUMERIC, "spar_session_solve_static",
                spar_session_solve_static(s, 1, springs_fluid, &p, NULL));
        p.k[0][0] = 2 * p.K[0], p.b[1] = 3;
        OK(s, spar_member_get_motion(p.beam[1], after[0], NULL, NULL));
        OK(s, spar_member_get_loads(p.beam[1], loads[1][0]));
        assert_memory_equal(before, after, sizeof before);
        assert_memory_equal(loads[0], loads[1], sizeof loads[0]);
        int n[2];
        OK(s, spar_step(s, 0.05, springs_fluid, &p, &n[0]));
        OK(calm.session, spar_step(calm.session, 0.05, springs_fluid, &calm, &n[1]));
        assert_int_equal(n[0], n[1]);
        for (int i = 0; i < 2; i++) {
            NEAR(tip_of(&p, i), tip_of(&calm, i), 0);
        }
    }
    spar_session_destroy(&p.session);
    spar_session_destroy(&calm.session);
}

static int wind_that_fails(spar_session *s, double t, double dt, int iteration, void *context) {
    return wind_on(s, t, dt, iteration, context) + (iteration == 1 ? 9 : 0);
}

/* Of a beam that bends and moves the factored tangent is kept from step to step: that too is as it was, to the bit. */
static void test_failures_leave_the_tangent(void **state) {
    (void)state;
    flag f, calm;
    flag_create(&f, SPAR_COUPLING_IQN_ILS);
    flag_create(&calm, SPAR_COUPLING_IQN_ILS);
    for (int step = 0; step < 8; step++) {
        REFUSED(f.session, SPAR_ERR_USER, "returned 9 in iteration 1",
                spar_session_solve_static(f.session, 1, wind_that_fails, &f, NULL));
        OK(f.session, spar_step(f.session, 0.05, wind_on, &f, NULL));
        OK(calm.session, spar_step(calm.session, 0.05, wind_on, &calm, NULL));
        NEAR(apart(f.beam, calm.beam), 0, 0);
    }
    spar_session_destroy(&f.session);
    spar_session_destroy(&calm.session);
}

static void test_out_of_order(void **state) {
    (void)state;
    static const double none[3] = {0, 0, 0}, J[3] = {1, 1, 1};
    double mass[36];
    springs p;
    spar_member *loose, *bare;
    assert_int_equal(spar_session_solve_static(NULL, 1, NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_session_message(NULL), "spar_session_solve_static"));
    springs_create(&p, 1, SPAR_COUPLING_IQN_ILS);
    spar_session *s = p.session;
    p.b[0] = 1;
    OK(s, spar_session_solve_static(s, 1, calls_back, &p, NULL));
    NEAR(tip_of(&p, 0), 1 / p.K[0], 1e-12);
    scene_mass(mass, 1, none, J);
    OK(s, spar_rigid_create(s, "loose", NULL, NULL, mass, &loose));
    REFUSED(s, SPAR_ERR_STATE, "'loose' is not committed", spar_session_solve_static(s, 1, springs_fluid, &p, NULL));
    OK(s, spar_member_commit(loose));
    REFUSED(s, SPAR_ERR_STATE, "'loose' is free to move as a rigid body; fix",
            spar_session_solve_static(s, 1, springs_fluid, &p, NULL));
    spar_session_destroy(&p.session);
    springs_create(&p, 1, SPAR_COUPLING_IQN_ILS);
    s = p.session;
    OK(s, spar_step_begin(s, 0.1));
    REFUSED(s, SPAR_ERR_STATE, "a step is in progress", spar_session_solve_static(s, 1, springs_fluid, &p, NULL));
    spar_session_destroy(&p.session);
    s = scene_session(); /* nothing there: nothing to do */
    OK(s, spar_session_solve_static(s, 1, NULL, NULL, NULL));
    OK(s, spar_point_create(s, "bare", NULL, NULL, &bare));
    OK(s, spar_member_commit(bare));
    OK(s, spar_session_solve_static(s, 1, NULL, NULL, NULL));
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_twist_of_a_wing),
        cmocka_unit_test(test_near_divergence),
        cmocka_unit_test(test_beyond_divergence),
        cmocka_unit_test(test_steps_beyond_divergence),
        cmocka_unit_test(test_floating_body),
        cmocka_unit_test(test_spring),
        cmocka_unit_test(test_two_members),
        cmocka_unit_test(test_explicit_asks_once),
        cmocka_unit_test(test_end_of_a_run),
        cmocka_unit_test(test_run_begins_at_rest),
        cmocka_unit_test(test_without_a_fluid),
        cmocka_unit_test(test_company),
        cmocka_unit_test(test_turning_members),
        cmocka_unit_test(test_failures_leave_all),
        cmocka_unit_test(test_failures_leave_the_tangent),
        cmocka_unit_test(test_out_of_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
