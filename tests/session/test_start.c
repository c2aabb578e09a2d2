/* The balanced start (spar_session_solve_initial): accelerations and loads at t = 0 that belong together, against
   closed forms, twins whose own mass has the fluid's in it, and the order of the runs that begin with it. */
#include "scene.h"
#include "trials.h"

#include "math/basis.h"

#include <stdio.h>

static int64_t steps_of(double span, double dt) {
    return (int64_t)(span / dt + 0.5);
}

/* ---- one degree of freedom ---- */

/* A mass 1 on a spring 1 in a fluid of added mass 10 under a constant force 11: x = 11 (1 - cos(t / sqrt(11))). */
typedef struct piston {
    spar_session *session;
    spar_member *body;
    spar_fluid *fluid;
    int calls, fails_at;
    double dt_seen;
} piston;

static const double ratio = 10, pull = 11;

static void piston_create(piston *p, int scheme, double rtol) {
    static const double zero[3] = {0, 0, 0}, J[3] = {1, 1, 1}, load[6] = {11, 0, 0, 0, 0, 0};
    double M[36];
    *p = (piston){.session = scene_session()};
    spar_session *s = p->session;
    scene_mass(M, 1, zero, J);
    OK(s, spar_rigid_create(s, "piston", NULL, NULL, M, &p->body));
    OK(s, spar_member_commit(p->body));
    OK(s, spar_member_set_load(p->body, 0, SPAR_LOAD_DEAD, load));
    OK(s, spar_fluid_create(p->body, "water", &p->fluid));
    OK(s, spar_fluid_set_motion_nodes(p->fluid, 1, zero));
    OK(s, spar_fluid_set_force_nodes(p->fluid, 1, zero));
    OK(s, spar_fluid_map(p->fluid));
    OK(s, spar_session_set_coupling(s, scheme, 0, rtol, 50));
}

static int piston_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    piston *p = context;
    double x[3], a[3], f[3];
    (void)t, (void)iteration;
    p->calls++;
    p->dt_seen = dt;
    OK(s, spar_fluid_pull_motion(p->fluid, 1, x, NULL));
    OK(s, spar_fluid_pull_poses(p->fluid, SPAR_NODES_MOTION, 1, NULL, NULL, NULL, NULL, a, NULL));
    for (int k = 0; k < 3; k++) {
        f[k] = -ratio * a[k] - x[k];
    }
    OK(s, spar_fluid_push_forces(p->fluid, f, NULL));
    return p->calls == p->fails_at ? 5 : 0;
}

enum begin { AS_PULLED, NOT_PUSHED, BALANCED };

/* Largest error of the displacement over t = 0 to 8, relative to its amplitude. */
static double piston_error(enum begin how, double dt) {
    piston p;
    double worst = 0;
    int64_t steps = steps_of(8, dt);
    piston_create(&p, SPAR_COUPLING_IQN_ILS, 1e-10);
    if (how == AS_PULLED) {
        assert_int_equal(piston_fluid(p.session, 0, dt, 0, &p), 0);
    } else if (how == BALANCED) {
        OK(p.session, spar_session_solve_initial(p.session, dt, piston_fluid, &p, NULL));
        assert_true(p.dt_seen == 0);
    }
    for (int64_t i = 1; i <= steps; i++) {
        double q[7];
        OK(p.session, spar_step(p.session, dt, piston_fluid, &p, NULL));
        scene_tip(p.body, q);
        worst = fmax(worst, fabs(q[0] / pull - (1 - cos((double)i * dt / sqrt(1 + ratio)))));
    }
    spar_session_destroy(&p.session);
    return worst;
}

/* The start's acceleration is F / (m + m_a) = 1, its load -m_a = -10, to the coupling's tolerance of 1e-10; x and v
   stay 0, and so does the clock. The explicit scheme starts alike. */
static void accelerations_and_loads_belong_together(void **state) {
    (void)state;
    for (int scheme = SPAR_COUPLING_EXPLICIT; scheme <= SPAR_COUPLING_IQN_ILS; scheme++) {
        piston p;
        double q[7], v[6], a[6], load[6], t;
        int64_t step;
        int iterations = 0;
        if (scheme == SPAR_COUPLING_FIXED_POINT) { /* diverges: its factor is m_a / m */
            continue;
        }
        piston_create(&p, scheme, 1e-10);
        OK(p.session, spar_session_solve_initial(p.session, 0.1, piston_fluid, &p, &iterations));
        assert_true(iterations == p.calls && iterations <= 4);
        OK(p.session, spar_member_get_motion(p.body, q, v, a));
        OK(p.session, spar_member_get_loads(p.body, load));
        OK(p.session, spar_session_get_time(p.session, &t, &step, NULL));
        assert_true(t == 0 && step == 0 && q[0] == 0 && v[0] == 0);
        NEAR(a[0], 1, 1e-8);
        NEAR(load[0], pull - ratio, 1e-7);
        OK(p.session, spar_fluid_pull_poses(p.fluid, SPAR_NODES_MOTION, 0, NULL, NULL, NULL, NULL, a,
                                            NULL)); /* and fluids see it before a step */
        NEAR(a[0], 1, 1e-8);
        spar_session_destroy(&p.session);
    }
}

/* Orders between dt and dt / 2 from the errors' own ratio: pulled 1, balanced 2 and the least error of the three. */
static void a_balanced_start_makes_it_second_order(void **state) {
    (void)state;
    const double dt = 0.05;
    double pulled = piston_error(AS_PULLED, dt), none = piston_error(NOT_PUSHED, dt), own = piston_error(BALANCED, dt),
           half = piston_error(BALANCED, 0.5 * dt), pulled_half = piston_error(AS_PULLED, 0.5 * dt);
    print_message("as pulled %.2e (order %.2f), nothing pushed %.2e, balanced %.2e (order %.2f)\n", pulled,
                  log2(pulled / pulled_half), none, own, log2(own / half));
    NEAR(log2(own / half), 2, 0.05);
    NEAR(log2(pulled / pulled_half), 1, 0.1);
    assert_true(own < 0.1 * none && own < 0.01 * pulled);
}

/* A host's own loop takes the same way to the last bit; a start made again begins where the first did. */
static void a_loop_of_the_host_starts_alike(void **state) {
    (void)state;
    piston one, own;
    double a[2][6];
    int done = 0;
    piston_create(&one, SPAR_COUPLING_AITKEN, 1e-9);
    piston_create(&own, SPAR_COUPLING_AITKEN, 1e-9);
    OK(one.session, spar_session_solve_initial(one.session, 0.1, piston_fluid, &one, NULL));
    for (int again = 0; again < 2; again++) {
        OK(own.session, spar_step_begin_initial(own.session, 0.1));
        for (int k = 0; !done; k++) {
            OK(own.session, spar_step_solve(own.session));
            assert_int_equal(piston_fluid(own.session, 0, 0, k, &own), 0);
            OK(own.session, spar_step_check(own.session, &done));
        }
        OK(own.session, again ? spar_step_accept(own.session) : spar_step_reject(own.session));
        done = 0;
        OK(own.session, spar_member_get_motion(own.body, NULL, NULL, a[0]));
        assert_true(again || a[0][0] == 0);
        if (!again) {
            const double zero[3] = {0, 0, 0}; /* what was pushed in the start that was rejected is gone with it */
            double force[3], moment[3];
            OK(own.session, spar_fluid_sum_loads(own.fluid, zero, force, moment));
            assert_true(force[0] == 0);
        }
    }
    for (int i = 0; i < 10; i++) {
        OK(one.session, spar_step(one.session, 0.1, piston_fluid, &one, NULL));
        OK(own.session, spar_step(own.session, 0.1, piston_fluid, &own, NULL));
        OK(one.session, spar_member_get_motion(one.body, NULL, NULL, a[0]));
        OK(own.session, spar_member_get_motion(own.body, NULL, NULL, a[1]));
        assert_memory_equal(a[0], a[1], sizeof a[0]);
    }
    spar_session_destroy(&one.session);
    spar_session_destroy(&own.session);
}

/* Refused, or failed in its first or third iteration, a start leaves a session that runs with the bits of its twin. */
static void a_start_that_fails_leaves_no_trace(void **state) {
    (void)state;
    for (int fails_at = 1; fails_at <= 3; fails_at += 2) {
        piston hit, calm;
        double a[2][6];
        piston_create(&hit, SPAR_COUPLING_IQN_ILS, 1e-9);
        piston_create(&calm, SPAR_COUPLING_IQN_ILS, 1e-9);
        hit.fails_at = fails_at;
        assert_int_equal(spar_session_solve_initial(hit.session, 0.1, piston_fluid, &hit, NULL), SPAR_ERR_USER);
        hit.fails_at = 0;
        OK(hit.session, spar_session_set_coupling(hit.session, SPAR_COUPLING_IQN_ILS, 0, 1e-300, 2));
        assert_int_equal(spar_session_solve_initial(hit.session, 0.1, piston_fluid, &hit, NULL), SPAR_ERR_NUMERIC);
        assert_non_null(strstr(spar_session_message(hit.session), "spar_session_solve_initial"));
        OK(hit.session, spar_session_set_coupling(hit.session, SPAR_COUPLING_IQN_ILS, 0, 1e-9, 50));
        assert_int_equal(spar_session_solve_initial(hit.session, 0, piston_fluid, &hit, NULL), SPAR_ERR_ARGUMENT);
        assert_int_equal(spar_session_solve_initial(hit.session, NAN, piston_fluid, &hit, NULL), SPAR_ERR_ARGUMENT);
        OK(hit.session, spar_member_get_motion(hit.body, NULL, NULL, a[0]));
        assert_true(a[0][0] == 0);
        for (int i = 0; i < 5; i++) {
            OK(hit.session, spar_step(hit.session, 0.1, piston_fluid, &hit, NULL));
            OK(calm.session, spar_step(calm.session, 0.1, piston_fluid, &calm, NULL));
            OK(hit.session, spar_member_get_motion(hit.body, NULL, NULL, a[0]));
            OK(calm.session, spar_member_get_motion(calm.body, NULL, NULL, a[1]));
            assert_memory_equal(a[0], a[1], sizeof a[0]);
        }
        assert_int_equal(spar_session_solve_initial(hit.session, 0.1, piston_fluid, &hit, NULL), SPAR_ERR_STATE);
        OK(hit.session, spar_step_begin(hit.session, 0.1));
        assert_int_equal(spar_step_begin_initial(hit.session, 0.1), SPAR_ERR_STATE);
        spar_session_destroy(&hit.session);
        spar_session_destroy(&calm.session);
    }
}

/* A trial of a session that has been started starts too: from loads that agree already it
   asks the fluid once more than the run of as many steps. One of a session that has not does not. */
static void a_trial_starts_as_the_run(void **state) {
    (void)state;
    int calls[2];
    for (int started = 0; started < 2; started++) {
        piston p;
        double report[TRY_COUNT];
        int in_step;
        piston_create(&p, SPAR_COUPLING_IQN_ILS, 1e-9);
        if (started) {
            OK(p.session, spar_session_solve_initial(p.session, 0.1, piston_fluid, &p, NULL));
        }
        p.calls = 0;
        OK(p.session, trial_run(p.session, 0.1, 8, NULL, piston_fluid, &p, 0, report));
        calls[started] = p.calls;
        p.calls = 0;
        for (int i = 0; i < 8; i++) {
            OK(p.session, spar_step(p.session, 0.1, piston_fluid, &p, NULL));
        }
        in_step = p.calls;
        assert_true(calls[started] == in_step + started);
        spar_session_destroy(&p.session);
    }
}

/* ---- beams ---- */

enum { NODES = 6, POINTS = 8 };

/* A cantilever under a load at its tip; a fluid that has three times its mass at Gauss points of the line, as a mass of
   its own would be integrated. */
typedef struct cantilever {
    spar_session *session;
    spar_member *beam;
    spar_fluid *strips;
    double eta[POINTS], weight[POINTS], added;
} cantilever;

static void cantilever_create(cantilever *c, int fidelity, int substeps, double own, double added) {
    const double load[6] = {0, 0, 2, 0, 0, 0};
    double K[36], M[36];
    *c = (cantilever){.session = scene_session(), .added = added};
    spar_session *s = c->session;
    scene_diagonal(K, 4e3, 4e3, 4e3, 80, 60, 60);
    scene_diagonal(M, own, own, own, 0.02, 0.01, 0.01);
    c->beam = scene_beam(s, "cantilever", 1, NODES, 2, K, M);
    OK(s, spar_member_set_root(c->beam, fidelity == SPAR_FIDELITY_RIGID ? SPAR_ROOT_PINNED : SPAR_ROOT_FIXED));
    OK(s, spar_beam_set_quadrature(c->beam, SPAR_QUADRATURE_GAUSS, POINTS));
    OK(s, spar_member_set_fidelity(c->beam, fidelity, fidelity == SPAR_FIDELITY_MODAL ? 4 : 0));
    OK(s, spar_member_commit(c->beam));
    OK(s, spar_member_set_load(c->beam, NODES - 1, SPAR_LOAD_DEAD, load));
    spari_gauss(POINTS, c->eta, c->weight);
    for (int i = 0; i < POINTS; i++) {
        c->eta[i] = 0.5 * (1 + c->eta[i]);
    }
    OK(s, spar_fluid_create(c->beam, "strips", &c->strips));
    OK(s, spar_fluid_set_stations(c->strips, POINTS, c->eta, NULL));
    OK(s, spar_fluid_map(c->strips));
    OK(s, spar_session_set_integrator(s, 0.9, substeps));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 0, 1e-9, 100));
}

static int cantilever_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    cantilever *c = context;
    double a[POINTS][3], f[POINTS][3];
    (void)t, (void)dt, (void)iteration;
    OK(s, spar_fluid_pull_poses(c->strips, SPAR_NODES_MOTION, 1, NULL, NULL, NULL, NULL, a[0], NULL));
    for (int i = 0; i < 3 * POINTS; i++) {
        f[i / 3][i % 3] = -c->added * c->weight[i / 3] * a[i / 3][i % 3];
    }
    return spar_fluid_push_forces(c->strips, f[0], NULL);
}

/* In a fluid of three times its mass a beam starts as one of four times the mass, but for what its step does not
   resolve: with omega dt < 0.02 of its highest mode that is 2e-8 of its z^4 = (omega^2 / cm)^4 and less; the rest is
   the coupling's 1e-9, times the ratio and the spread of the accelerations. Substeps look at a shorter step. */
static void a_beam_starts_as_one_with_the_fluids_mass(void **state) {
    (void)state;
    static const int kind[] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL, SPAR_FIDELITY_RIGID};
    for (int k = 0; k < 4; k++) {
        for (int substeps = 1; substeps <= 2; substeps++) {
            cantilever wet, heavy;
            double a[2][NODES][6], largest = 0;
            cantilever_create(&wet, kind[k], substeps, 1, 3);
            cantilever_create(&heavy, kind[k], substeps, 4, 0);
            OK(wet.session, spar_session_solve_initial(wet.session, 1e-5, cantilever_fluid, &wet, NULL));
            OK(heavy.session, spar_session_solve_initial(heavy.session, 1e-5, cantilever_fluid, &heavy, NULL));
            OK(wet.session, spar_member_get_motion(wet.beam, NULL, NULL, a[0][0]));
            OK(heavy.session, spar_member_get_motion(heavy.beam, NULL, NULL, a[1][0]));
            for (int i = 0; i < 6 * NODES; i++) {
                largest = fmax(largest, fabs(a[1][i / 6][i % 6]));
            }
            assert_true(largest > 0.1);
            for (int i = 0; i < 6 * NODES && kind[k] != SPAR_FIDELITY_MODAL; i++) {
                NEAR(a[0][i / 6][i % 6], a[1][i / 6][i % 6], 1e-7 * largest);
            }
            for (int i = 0; i < NODES && kind[k] == SPAR_FIDELITY_MODAL; i++) { /* other modes: the same to these */
                NEAR(a[0][i][2], a[1][i][2], 0.03 * largest);
            }
            spar_session_destroy(&wet.session);
            spar_session_destroy(&heavy.session);
        }
    }
}

static void cantilever_tip(int fidelity, double dt, int balanced, double tip[7]) {
    cantilever c;
    cantilever_create(&c, fidelity, 1, 1, 3);
    OK(c.session, spar_session_set_option(c.session, "coupling.norm", "loads"));
    if (balanced) {
        OK(c.session, spar_session_solve_initial(c.session, dt, cantilever_fluid, &c, NULL));
    } else {
        (void)cantilever_fluid(c.session, 0, dt, 0, &c);
    }
    for (int64_t i = 0; i < steps_of(0.32, dt); i++) {
        OK(c.session, spar_step(c.session, dt, cantilever_fluid, &c, NULL));
    }
    scene_tip(c.beam, tip);
    spar_session_destroy(&c.session);
}

/* Of a rigid beam on a pin, which has nothing that a step does not resolve, order 2 by three steps' differences;
   without the start 1. */
static void a_beam_is_of_second_order(void **state) {
    (void)state;
    double order[2];
    for (int balanced = 0; balanced < 2; balanced++) {
        double q[3][7];
        for (int k = 0; k < 3; k++) {
            cantilever_tip(SPAR_FIDELITY_RIGID, 0.02 / (1 << k), balanced, q[k]);
        }
        order[balanced] = log2((q[0][2] - q[1][2]) / (q[1][2] - q[2][2]));
    }
    print_message("order %.3f as pulled, %.3f balanced\n", order[0], order[1]);
    NEAR(order[1], 2, 0.1);
    assert_true(order[0] < 1.3);
}

/* ---- an assembly ---- */

/* A body of mass 2 on a hinge at the origin, its centre a metre along x, let go there under gravity in a fluid of added
   mass 20 at its centre: (m + m_a) l^2 + J) theta'' = -m g l cos(theta). The pin bears (m + m_a) l theta'' + m g. */
typedef struct pendulum {
    spar_session *session;
    spar_member *body;
    spar_joint *hinge;
    spar_fluid *fluid;
} pendulum;

static const double bob = 2, drag_mass = 20, bob_inertia = 0.1, g = 9.81;

static void pendulum_create(pendulum *p) {
    static const double zero[3] = {0, 0, 0}, centre[3] = {1, 0, 0}, gravity[3] = {0, 0, -9.81};
    static const double J[3] = {0.1, 0.1, 0.1}, along_y[4] = {1, 0, 0, 0};
    double M[36];
    *p = (pendulum){.session = scene_session()};
    spar_session *s = p->session;
    scene_mass(M, bob, zero, J);
    OK(s, spar_session_set_gravity(s, gravity));
    OK(s, spar_rigid_create(s, "bob", centre, NULL, M, &p->body));
    OK(s, spar_member_commit(p->body));
    OK(s, spar_joint_create(s, "hinge", p->body, 0, NULL, 0, SPAR_FREE_RY, &p->hinge));
    OK(s, spar_joint_set_frame(p->hinge, zero, along_y));
    OK(s, spar_fluid_create(p->body, "water", &p->fluid));
    OK(s, spar_fluid_set_motion_nodes(p->fluid, 1, centre));
    OK(s, spar_fluid_set_force_nodes(p->fluid, 1, centre));
    OK(s, spar_fluid_map(p->fluid));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 0, 1e-11, 50));
}

static int pendulum_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    pendulum *p = context;
    double f[3];
    (void)t, (void)dt, (void)iteration;
    OK(s, spar_fluid_pull_poses(p->fluid, SPAR_NODES_MOTION, 1, NULL, NULL, NULL, NULL, f, NULL));
    for (int k = 0; k < 3; k++) {
        f[k] *= -drag_mass;
    }
    return spar_fluid_push_forces(p->fluid, f, NULL);
}

/* Angle below the horizontal at t, by Runge and Kutta's fourth order in 1e4 steps. */
static double pendulum_angle(double t) {
    const int n = 10000;
    double h = t / n, c = bob * g / (bob + drag_mass + bob_inertia), x = 0, v = 0;
    for (int i = 0; i < n; i++) {
        double k1 = c * cos(x), k2 = c * cos(x + 0.5 * h * v), k3 = c * cos(x + 0.5 * h * v + 0.25 * h * h * k1),
               k4 = c * cos(x + h * v + 0.5 * h * h * k2);
        x += h * v + h * h / 6 * (k1 + k2 + k3);
        v += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    return x;
}

static double pendulum_error(double dt) {
    pendulum p;
    double q[7], t = 1.6;
    pendulum_create(&p);
    OK(p.session, spar_session_solve_initial(p.session, dt, pendulum_fluid, &p, NULL));
    for (int64_t i = 0; i < steps_of(t, dt); i++) {
        OK(p.session, spar_step(p.session, dt, pendulum_fluid, &p, NULL));
    }
    scene_tip(p.body, q);
    spar_session_destroy(&p.session);
    return fabs(2 * atan2(q[5], q[3]) - pendulum_angle(t));
}

/* Accelerations are on the constraint, and the joint's load is the one that goes with them, to the coupling's 1e-11
   times the ratio of the masses; the run is of second order from there on. */
static void joints_carry_their_loads(void **state) {
    (void)state;
    pendulum p;
    double a[6], load[6], alpha = bob * g / (bob + drag_mass + bob_inertia);
    pendulum_create(&p);
    OK(p.session, spar_session_solve_initial(p.session, 0.02, pendulum_fluid, &p, NULL));
    OK(p.session, spar_member_get_motion(p.body, NULL, NULL, a));
    OK(p.session, spar_joint_get_load(p.hinge, load));
    NEAR(a[2], -alpha, 1e-8);
    NEAR(a[4], alpha, 1e-8);
    NEAR(a[0], 0, 1e-12);
    NEAR(load[2], bob * g - (bob + drag_mass) * alpha, 1e-7);
    spar_session_destroy(&p.session);
    double whole = pendulum_error(0.04), half = pendulum_error(0.02);
    print_message("pendulum: error %.2e, %.2e (order %.2f)\n", whole, half, log2(whole / half));
    NEAR(log2(whole / half), 2, 0.15);
}

/* ---- members that the host moves ---- */

/* An external body of mass 3 welded to one of mass 2 under a force 10 on the latter: the host gives a = F / m of what
   reaches it, in each iteration. Both have 2 m/s^2; the weld carries 6 N. */
typedef struct welded {
    spar_member *body;
} welded;

static int external_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    welded *w = context;
    double load[6], a[6] = {0};
    (void)t, (void)dt, (void)iteration;
    OK(s, spar_member_get_loads(w->body, load));
    a[0] = load[0] / 3;
    return spar_member_set_motion(w->body, NULL, NULL, a);
}

static void an_external_member_answers(void **state) {
    (void)state;
    static const double zero[3] = {0, 0, 0}, J[3] = {1, 1, 1}, load[6] = {10, 0, 0, 0, 0, 0};
    spar_session *s = scene_session();
    spar_member *own, *theirs;
    spar_joint *weld;
    double M[36], a[2][6], carried[6];
    scene_mass(M, 2, zero, J);
    OK(s, spar_rigid_create(s, "own", NULL, NULL, M, &own));
    OK(s, spar_rigid_create(s, "theirs", NULL, NULL, M, &theirs));
    OK(s, spar_member_set_external(theirs, 1));
    OK(s, spar_member_commit(own));
    OK(s, spar_member_commit(theirs));
    OK(s, spar_member_set_load(own, 0, SPAR_LOAD_DEAD, load));
    OK(s, spar_joint_create(s, "weld", own, 0, theirs, 0, 0, &weld));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 0, 1e-10, 50));
    welded w = {theirs};
    OK(s, spar_session_solve_initial(s, 0.01, external_fluid, &w, NULL));
    OK(s, spar_member_get_motion(own, NULL, NULL, a[0]));
    OK(s, spar_member_get_motion(theirs, NULL, NULL, a[1]));
    OK(s, spar_member_get_loads(theirs, carried));
    NEAR(a[0][0], 2, 1e-8);
    NEAR(a[1][0], 2, 1e-8);
    NEAR(carried[0], 6, 1e-7);
    spar_session_destroy(&s);
}

/* ---- saved before the first step ---- */

/* A soft arm that swings on a pinned root, with a fluid at three places on it. */
typedef struct wet_arm {
    spar_session *session;
    spar_member *arm;
    spar_fluid *fluid;
} wet_arm;

static int arm_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    const wet_arm *w = context;
    double a[9], f[9];
    int status = spar_fluid_pull_poses(w->fluid, SPAR_NODES_MOTION, 1, NULL, NULL, NULL, NULL, a, NULL);
    for (int k = 0; k < 9; k++) {
        f[k] = -3 * a[k] + cos(t + dt + k);
    }
    (void)s, (void)iteration;
    return status == SPAR_OK ? spar_fluid_push_forces(w->fluid, f, NULL) : status;
}

static void wet_arm_create(wet_arm *w, int substeps, double rtol) {
    const double places[9] = {0.4, 0, 0, 0.8, 0, 0, 1.2, 0, 0}, down[3] = {0, 0, -9.81};
    double K[36], M[36];
    w->session = scene_session();
    scene_diagonal(K, 1e5, 1e4, 1e4, 30, 40, 50);
    scene_diagonal(M, 2, 2, 2, 0.02, 0.01, 0.01);
    OK(w->session, spar_session_set_newton(w->session, 1e-15, rtol, 50));
    OK(w->session, spar_session_set_integrator(w->session, 0.9, substeps));
    OK(w->session, spar_session_set_gravity(w->session, down));
    w->arm = scene_beam(w->session, "arm", 2, 4, 1.2, K, M);
    OK(w->session, spar_member_set_root(w->arm, SPAR_ROOT_PINNED));
    OK(w->session, spar_member_commit(w->arm));
    OK(w->session, spar_fluid_create(w->arm, "water", &w->fluid));
    OK(w->session, spar_fluid_set_motion_nodes(w->fluid, 3, places));
    OK(w->session, spar_fluid_set_force_nodes(w->fluid, 3, places));
    OK(w->session, spar_fluid_map(w->fluid));
    OK(w->session, spar_session_set_coupling(w->session, SPAR_COUPLING_IQN_ILS, 1e-10, 1e-7, 60));
}

/* The first step, saved before its solution number `at` / 2, or (odd) after. */
static void first_step(wet_arm *w, int at, const char *path) {
    int done = 0, calls = 0;
    OK(w->session, spar_step_begin(w->session, 0.01));
    for (int k = 0; !done; k++) {
        OK(w->session, calls++ == at ? spar_session_save(w->session, path) : SPAR_OK);
        OK(w->session, spar_step_solve(w->session));
        OK(w->session, calls++ == at ? spar_session_save(w->session, path) : SPAR_OK);
        OK(w->session, arm_fluid(w->session, 0, 0.01, k, w));
        OK(w->session, spar_step_check(w->session, &done));
    }
    OK(w->session, spar_step_accept(w->session));
}

/* What is saved between the start and the first step, given to a session that has not started, or has otherwise, is the
   run's state: motion of four steps to the last bit, with one substep and two, Newton's stopping rule tied and strict;
   one step is rejected on the way. (Without the accelerations that the first step begins with it was 1.3 m/s^2 off.) */
static void saved_before_the_first_step(void **state) {
    (void)state;
    enum { ARM_NODES = 8, ALL = 19 * ARM_NODES };
    static const char path[] = "balanced_start.spar";
    for (int k = 0; k < 8; k++) {
        int substeps = 1 + k % 2, again = k / 4;
        static double seen[2][ALL];
        for (int loaded = 0; loaded < 2; loaded++) {
            wet_arm w;
            wet_arm_create(&w, substeps, k / 2 % 2 ? 1e-8 : 1e-12);
            if (!loaded || again) { /* another start is forgotten */
                OK(w.session, spar_session_solve_initial(w.session, loaded ? 0.02 : 0.01, arm_fluid, &w, NULL));
            }
            OK(w.session, loaded ? spar_session_load(w.session, path) : spar_session_save(w.session, path));
            if (again) {
                OK(w.session, spar_step_begin(w.session, 0.02));
                OK(w.session, spar_step_solve(w.session));
                OK(w.session, spar_step_reject(w.session));
            }
            for (int step = 0; step < 4; step++) {
                OK(w.session, spar_step(w.session, 0.01, arm_fluid, &w, NULL));
            }
            double *to = seen[loaded];
            OK(w.session, spar_member_get_motion(w.arm, to, to + 7 * ARM_NODES, to + 13 * ARM_NODES));
            spar_session_destroy(&w.session);
        }
        for (int i = 0; i < ALL; i++) {
            NEAR(seen[1][i], seen[0][i], 0);
        }
    }
    (void)remove(path);
}

/* The same of what is saved within the first step. */
static void saved_within_the_first_step(void **state) {
    (void)state;
    enum { ARM_NODES = 8, ALL = 19 * ARM_NODES };
    static const char path[] = "balanced_step.spar";
    for (int k = 0; k < 6; k++) {
        static double seen[2][ALL];
        wet_arm w, other;
        int done = 0;
        wet_arm_create(&w, 1 + k % 2, 1e-8);
        OK(w.session, spar_session_solve_initial(w.session, 0.01, arm_fluid, &w, NULL));
        first_step(&w, k / 2, path);
        OK(w.session, spar_member_get_motion(w.arm, seen[0], seen[0] + 7 * ARM_NODES, seen[0] + 13 * ARM_NODES));
        wet_arm_create(&other, 1 + k % 2, 1e-8);
        OK(other.session, spar_session_load(other.session, path));
        if (k / 2 == 1) {
            OK(other.session, arm_fluid(other.session, 0, 0.01, 0, &other));
            OK(other.session, spar_step_check(other.session, &done));
        }
        while (!done) {
            OK(other.session, spar_step_solve(other.session));
            OK(other.session, arm_fluid(other.session, 0, 0.01, 0, &other));
            OK(other.session, spar_step_check(other.session, &done));
        }
        OK(other.session, spar_step_accept(other.session));
        OK(other.session,
           spar_member_get_motion(other.arm, seen[1], seen[1] + 7 * ARM_NODES, seen[1] + 13 * ARM_NODES));
        for (int i = 0; i < ALL; i++) {
            NEAR(seen[1][i], seen[0][i], 0);
        }
        spar_session_destroy(&w.session);
        spar_session_destroy(&other.session);
    }
    (void)remove(path);
}

/* A cantilever that is loaded at once, started for steps of three lengths: the filter leaves accelerations that balance
   the whole, not each node. At every fidelity the reaction is the rate of the momentum that they give, by quadrature at
   the nodes (exact for 12 of them), less the loads; and the section force at the root is what it balances. The exact
   beam's reaction was the balance of the root's node, 0.223 N for 8.70 N at 0.1 s, and the section force 0. */
static void the_reaction_belongs_to_the_accelerations(void **state) {
    (void)state;
    enum { N = 12 };
    static const int fidelities[] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL};
    static const double dts[] = {0.1, 0.01, 1e-5}, weight[3] = {0, 1, -9.81}, tip[6] = {3, -2, 4, 0.5, 0, 0.3}, L = 2;
    double K[36], M[36], x[N], w[N];
    scene_diagonal(K, 1e6, 4e5, 4e5, 60, 120, 200);
    scene_diagonal(M, 1.5, 1.5, 1.5, 4e-3, 2e-3, 2e-3);
    spari_gll(N, x, w, NULL);
    for (int run = 0; run < 9; run++) {
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "b", 1, N, L, K, M);
        double a[6 * N], r[6], f[6],
            sum[6] = {-tip[0], -tip[1], -tip[2], -tip[3], -tip[4] + L * tip[2], -tip[5] - L * tip[1]}, size = 0,
            root = 0;
        OK(s, spar_session_set_gravity(s, weight));
        OK(s, spar_member_set_fidelity(b, fidelities[run / 3], 8));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, N - 1, SPAR_LOAD_DEAD, tip));
        OK(s, spar_session_solve_initial(s, dts[run % 3], NULL, NULL, NULL));
        OK(s, spar_member_get_motion(b, NULL, NULL, a));
        OK(s, spar_member_get_reaction(b, r));
        OK(s, spar_beam_evaluate(b, 1, &root, NULL, f, NULL, NULL));
        for (int i = 0; i < N; i++) {
            const double part = 0.5 * L * w[i], at = 0.5 * L * (1 + x[i]);
            for (int k = 0; k < 3; k++) {
                sum[k] += part * M[0] * (a[6 * i + k] - weight[k]);
                sum[3 + k] += part * M[7 * (3 + k)] * a[6 * i + 3 + k];
            }
            sum[4] -= at * part * M[0] * (a[6 * i + 2] - weight[2]);
            sum[5] += at * part * M[0] * (a[6 * i + 1] - weight[1]);
        }
        for (int k = 0; k < 6; k++) {
            size = fmax(size, fabs(sum[k]));
        }
        for (int k = 0; k < 6; k++) {
            NEAR(r[k], sum[k], 1e-9 * size);
            NEAR(f[k], -sum[k], 1e-9 * size);
        }
        spar_session_destroy(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(accelerations_and_loads_belong_together),
        cmocka_unit_test(a_balanced_start_makes_it_second_order),
        cmocka_unit_test(a_loop_of_the_host_starts_alike),
        cmocka_unit_test(a_start_that_fails_leaves_no_trace),
        cmocka_unit_test(a_trial_starts_as_the_run),
        cmocka_unit_test(a_beam_starts_as_one_with_the_fluids_mass),
        cmocka_unit_test(a_beam_is_of_second_order),
        cmocka_unit_test(joints_carry_their_loads),
        cmocka_unit_test(the_reaction_belongs_to_the_accelerations),
        cmocka_unit_test(an_external_member_answers),
        cmocka_unit_test(saved_before_the_first_step),
        cmocka_unit_test(saved_within_the_first_step),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
