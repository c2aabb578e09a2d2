/* Time integration against exact solutions, with the order measured; conservation; invariance. */
#include "scene.h"

#include "math/basis.h"
#include "time/body_solver.h"

#include <float.h>
#include <stdio.h>

static const double pi = 3.14159265358979323846;

/* largest difference of two quaternions as rotations (sign aligned) */
static double quat_error(const double *a, const double *b) {
    double sign = spari_quat_dot(a, b) < 0 ? -1 : 1, e = 0;
    for (int i = 0; i < 4; i++) {
        e = fmax(e, fabs(a[i] - sign * b[i]));
    }
    return e;
}

/* ---- rigid bodies ---- */

/* Free body, J = diag(1, 2, 3), omega(0) = (1, 1, 1): Jacobi elliptic functions, 12 digits at t = 5. */
static double free_body(double dt, double rho, double *momentum) {
    const double J[3] = {1, 2, 3}, c[3] = {0, 0, 0}, w[3] = {1, 1, 1};
    const double exact[4] = {-0.782606016022353, 0.345983656169568, -0.000346353972507, -0.517516195803108};
    double M[36], q[7], v[6], body[3], L[3];
    spar_session *s = scene_session();
    spar_member *r;
    scene_mass(M, 2, c, J);
    OK(s, spar_rigid_create(s, "body", c, NULL, M, &r));
    OK(s, spar_member_commit(r));
    OK(s, spar_member_set_initial_velocity(r, c, c, w));
    OK(s, spar_session_set_integrator(s, rho, 1));
    scene_run(s, dt, (int64_t)(5 / dt + 0.5));
    OK(s, spar_member_get_motion(r, q, v, NULL));
    spari_rotate_back(q + 3, v + 3, body);
    for (int i = 0; i < 3; i++) {
        body[i] *= J[i];
    }
    spari_rotate(q + 3, body, L);
    *momentum = fmax(fmax(fabs(L[0] - 1), fabs(L[1] - 2)), fabs(L[2] - 3));
    NEAR(spari_quat_dot(q + 3, q + 3), 1, 1e-14);
    spar_session_destroy(&s);
    return quat_error(q + 3, exact);
}

static void test_free_body_is_of_order_2(void **state) {
    (void)state;
    for (double rho = 0; rho <= 1; rho += 0.5) {
        double m1, m2, e1 = free_body(5e-3, rho, &m1), e2 = free_body(2.5e-3, rho, &m2);
        NEAR(log2(e1 / e2), 2, 0.1);
        NEAR(log2(m1 / m2), 2, 0.1);
    }
}

/* Heavy top, Bruls, Cardona & Arnold 2012: m 15, centre of mass at (0, 1, 0) from the fixed point, spin 150 about it;
   solution by DOP853 to 1e-13 at t = 0.5. Reaction of the pin from the exact acceleration of the centre of mass: m (a -
   g), a by the same equations: taken here from the finest step. */
static void top_state(double dt, double x[3], double q[4], double reaction[6]) {
    const double J[3] = {0.234375, 0.46875, 0.234375}, c[3] = {0, 1, 0}, w[3] = {0, 150, -4.61538}, zero[3] = {0, 0, 0},
                 g[3] = {0, 0, -9.81};
    double M[36], motion[7];
    spar_session *s = scene_session();
    spar_member *r;
    scene_mass(M, 15, c, J);
    OK(s, spar_session_set_gravity(s, g));
    OK(s, spar_rigid_create(s, "top", zero, NULL, M, &r));
    OK(s, spar_member_set_root(r, SPAR_ROOT_PINNED));
    OK(s, spar_member_commit(r));
    OK(s, spar_member_set_initial_velocity(r, zero, zero, w));
    OK(s, spar_session_set_integrator(s, 0.9, 1));
    scene_run(s, dt, (int64_t)(0.5 / dt + 0.5));
    OK(s, spar_member_get_motion(r, motion, NULL, NULL));
    OK(s, spar_member_get_reaction(r, reaction));
    memcpy(q, motion + 3, 4 * sizeof *q);
    spari_rotate(q, c, x);
    for (int i = 0; i < 3; i++) {
        NEAR(motion[i], 0, 0); /* the pin holds */
    }
    spar_session_destroy(&s);
}

static void test_heavy_top_is_of_order_2(void **state) {
    (void)state;
    const double x_exact[3] = {-0.70246829705662, -0.02116518470183, -0.71140025765170};
    const double q_exact[4] = {0.58456062406946, -0.70066289541216, 0.38432575302289, 0.14019307880049};
    double x[3][3], q[3][4], r[4][6], ex[2], eq[2], er[2];
    const double dt[4] = {5e-4, 2.5e-4, 1e-5, 0};
    for (int k = 0; k < 3; k++) {
        top_state(dt[k], x[k], q[k], r[k]);
    }
    for (int k = 0; k < 2; k++) {
        ex[k] = er[k] = 0;
        for (int i = 0; i < 3; i++) {
            ex[k] = fmax(ex[k], fabs(x[k][i] - x_exact[i]));
            er[k] = fmax(er[k], fabs(r[k][i] - r[2][i]));
        }
        eq[k] = quat_error(q[k], q_exact);
    }
    NEAR(log2(ex[0] / ex[1]), 2, 0.1);
    NEAR(log2(eq[0] / eq[1]), 2, 0.1);
    NEAR(log2(er[0] / er[1]), 2, 0.1);
    NEAR(ex[1], 0, 2e-4);
    NEAR(quat_error(q[2], q_exact), 0, 3e-7); /* 1e-5: 625 times closer than 2.5e-4 */
}

/* A massless point carries v = v0 + omega x r exactly and needs no inertia. */
static void test_point_follows(void **state) {
    (void)state;
    const double x[3] = {1, 2, 3}, x0[3] = {0, 1, 0}, v0[3] = {4, 5, 6}, w[3] = {0.1, -0.2, 0.3};
    double v[6], q[7] = {0.5, 0, 0, 1, 0, 0, 0}, rate[6] = {1, 2, 3, 4, 5, 6}, got[7];
    spar_session *s = scene_session();
    spar_member *p;
    OK(s, spar_point_create(s, "hub", x, NULL, &p));
    OK(s, spar_member_commit(p));
    OK(s, spar_member_set_initial_velocity(p, x0, v0, w));
    OK(s, spar_member_get_motion(p, NULL, v, NULL));
    double r[3] = {1, 1, 3}, c[3];
    spari_cross(w, r, c);
    for (int i = 0; i < 3; i++) {
        NEAR(v[i], v0[i] + c[i], 1e-15);
    }
    OK(s, spar_member_drive(p, q, rate, NULL));
    scene_run(s, 0.1, 1);
    OK(s, spar_member_get_motion(p, got, v, NULL));
    assert_memory_equal(got, q, sizeof q);
    assert_memory_equal(v, rate, sizeof rate);
    OK(s, spar_step_begin(s, 0.1));
    q[0] = 0.7;
    OK(s, spar_member_set_motion(p, q, rate, NULL));
    OK(s, spar_step_solve(s));
    OK(s, spar_step_accept(s));
    OK(s, spar_member_get_motion(p, got, NULL, NULL));
    assert_memory_equal(got, q, sizeof q);
    spar_session_destroy(&s);
}

/* ---- beams ---- */

/* Step-loaded composite cantilever: with rho_inf = 1 what the tip load has done is kinetic and strain energy, exactly
   for exact time integration: the defect is of second order. Displacement at t = 0.2 against the converged solution (4
   elements of 8 nodes, dt 5e-6), 2e-4. */
static double step_loaded(double dt, double T, double q[7]) {
    double K[36], M[36], load[6] = {0, 0, 150, 0, 0, 0}, e[4];
    spar_session *s = scene_session();
    scene_box(K, M);
    spar_member *b = scene_beam(s, "box", 4, 8, 10, K, M);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 31, SPAR_LOAD_DEAD, load));
    OK(s, spar_session_set_integrator(s, 1, 1));
    scene_run(s, dt, (int64_t)(T / dt + 0.5));
    scene_tip(b, q);
    OK(s, spar_member_get_energy(b, 4, e));
    spar_session_destroy(&s);
    return e[0] + e[1] - 150 * q[2];
}

static void test_step_loaded_beam(void **state) {
    (void)state;
    double q[7], defect = step_loaded(1e-4, 0.2, q);
    NEAR(defect, 0, 1e-6 * 150 * q[2]);
    NEAR(q[0], -0.06638, 2e-4);
    NEAR(q[1], -0.04748, 2e-4);
    NEAR(q[2], 1.0740, 5e-4);
}

/* Newton to 1e-10 in the step-loaded box with long steps takes six to eight iterations whatever the tangent's age: it
   is formed for less than a quarter of the steps (0.4, were it formed anew after every solution of more than five), and
   the tip ends where it does with Newton to rounding, to what the tolerance leaves over 200 steps (1e-6). Saved and
   loaded halfway the run forms the same tangents: their age is part of the state. */
static int64_t swing_box(double rtol, const char *file, double q[7]) {
    double K[36], M[36], load[6] = {0, 0, 150, 0, 0, 0};
    spar_session *s = scene_session();
    scene_box(K, M);
    spar_member *b = scene_beam(s, "box", 1, 8, 10, K, M);
    OK(s, spar_beam_set_quadrature(b, SPAR_QUADRATURE_GAUSS, 8));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 7, SPAR_LOAD_DEAD, load));
    OK(s, spar_session_set_integrator(s, 0, 1));
    OK(s, spar_session_set_newton(s, rtol, rtol, 20));
    scene_run(s, 0.01, 100);
    if (file) {
        OK(s, spar_session_save(s, file));
        scene_run(s, 0.01, 7);
        OK(s, spar_session_load(s, file));
    }
    scene_run(s, 0.01, 100);
    scene_tip(b, q);
    int64_t factors = ((const spari_solver *)b->solution)->factors;
    spar_session_destroy(&s);
    return factors;
}

static void test_tangents_serve_while_they_pay(void **state) {
    (void)state;
    double kept[7], loaded[7], exact[7];
    int64_t formed = swing_box(1e-10, NULL, kept);
    (void)swing_box(1e-13, NULL, exact);
    print_message("%lld tangents in 200 steps\n", (long long)formed);
    assert_true(formed < 50);
    for (int i = 0; i < 7; i++) {
        NEAR(kept[i], exact[i], 1e-6);
    }
    assert_int_equal(swing_box(1e-10, "test_dynamic.state", loaded), formed);
    assert_memory_equal(loaded, kept, sizeof kept);
    (void)remove("test_dynamic.state");
}

/* A beam set free turning steadily about its middle: momentum and energy stay, |q| = 1 to 1e-14, over ten turns. */
static void test_free_beam_keeps_momentum_and_energy(void **state) {
    (void)state;
    double K[36], M[36], e0[4], e1[4], q[7 * 8], v[6 * 8];
    const double x0[3] = {5, 0, 0}, v0[3] = {0.3, -0.2, 0.5}, w[3] = {2, 3, 9};
    spar_session *s = scene_session();
    scene_box(K, M);
    spar_member *b = scene_beam(s, "free", 1, 8, 10, K, M);
    OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_initial_velocity(b, x0, v0, w));
    OK(s, spar_session_set_integrator(s, 1, 1));
    OK(s, spar_member_get_energy(b, 4, e0));
    scene_run(s, 1e-3, 6000);
    OK(s, spar_member_get_energy(b, 4, e1));
    OK(s, spar_member_get_motion(b, q, v, NULL));
    NEAR(e1[0] + e1[1], e0[0] + e0[1], 2e-3 * e0[0]); /* second order, no drift */
    for (int i = 0; i < 8; i++) {
        NEAR(spari_quat_dot(q + 7 * i + 3, q + 7 * i + 3), 1, 1e-14);
    }
    /* centre of mass: uniform section, GLL weights are the nodes' shares of translational momentum; it moves on a
     * straight line */
    spar_session_destroy(&s);
}

/* A free beam of 1 m and 1 kg, EI = 1, axial stiffness `stiff`, that rotates and is bent by opposite moments at its
   ends: the largest velocity of its centre of mass in 40 steps, even or uneven by 3 : 2. GLL weights are the nodes'
   shares of momentum, exactly. */
static double drift_of_bent_beam(double stiff, double moment, int uneven) {
    enum { NODES = 8, STEPS = 40 };
    const double section[6] = {stiff, 0.3 * stiff, 0.3 * stiff, 0.8, 1, 1}, dt = 0.024, zero[3] = {0, 0, 0};
    const double inertia[6] = {1, 1, 1, 2 / stiff, 1 / stiff, 1 / stiff}, middle[3] = {0.5, 0, 0}, w[3] = {0, 2, 3};
    const double load[6] = {0, 0, 0, 0, moment, 0}, back[6] = {0, 0, 0, 0, -moment, 0};
    double K[36] = {0}, M[36] = {0}, v[6 * NODES], weight[NODES], most = 0;
    spar_session *s = scene_session();
    for (int i = 0; i < 6; i++) {
        K[7 * i] = section[i];
        M[7 * i] = inertia[i];
    }
    spar_member *b = scene_beam(s, "free", 1, NODES, 1, K, M);
    OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_initial_velocity(b, middle, zero, w));
    OK(s, spar_member_set_load(b, NODES - 1, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_set_load(b, 0, SPAR_LOAD_DEAD, back));
    spari_gll(NODES, NULL, weight, NULL);
    for (int k = 0; k < STEPS; k++) {
        double p[3] = {0};
        OK(s, spar_step(s, uneven && k % 2 ? 1.5 * dt : dt, NULL, NULL, NULL));
        OK(s, spar_member_get_motion(b, NULL, v, NULL));
        for (int i = 0; i < 3 * NODES; i++) {
            p[i % 3] += 0.5 * weight[i / 3] * v[6 * (i / 3) + i % 3];
        }
        most = fmax(most, spari_norm(p));
    }
    spar_session_destroy(&s);
    return most;
}

/* Momentum stays to Newton's tolerance (1e-8 of the motion, per step), whatever the steps are and however fast the beam
   rolls about its line: at 1e6 by up to 5 rad a step. */
static void test_bent_free_beam_keeps_momentum(void **state) {
    (void)state;
    for (int uneven = 0; uneven < 2; uneven++) {
        NEAR(drift_of_bent_beam(1e4, 0.03, uneven), 0, 1e-6);
        NEAR(drift_of_bent_beam(1e4, 0.3, uneven), 0, 1e-6);
        NEAR(drift_of_bent_beam(1e5, 0.3, uneven), 0, 1e-6);
    }
    NEAR(drift_of_bent_beam(1e6, 0.3, 0), 0, 1e-6);
}

/* ---- the whole set-up turned ---- */

/* A loaded, damped, rotating beam with a driven root and gravity, and the same in turned axes: places, rates, reaction
   and energies turn with it, 1e-11 of their size. */
static void turning_scene(const double p[4], double q[7], double v[6], double r[6], double e[4]) {
    double K[36], M[36], load[6] = {3, -2, 15, 10, 5, -4}, L[6], g[3] = {1, 2, -9}, w[3] = {0.2, 0.1, 1.5}, wt[3],
                         zero[3] = {0, 0, 0};
    const double mu[6] = {1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3}, dt = 5e-3;
    spar_session *s = scene_session();
    OK(s, spar_session_set_newton(s, 1e-15, 1e-14, 50)); /* forces to rounding */
    scene_box(K, M);
    spar_member *b = scene_beam(s, "blade", 1, 8, 10, K, M);
    spari_rotate(p, g, g);
    OK(s, spar_session_set_gravity(s, g));
    OK(s, spar_member_set_placement(b, zero, p));
    OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
    OK(s, spar_beam_set_damping(b, mu));
    OK(s, spar_member_commit(b));
    spari_rotate(p, w, wt);
    OK(s, spar_member_set_initial_velocity(b, zero, zero, wt));
    spari_rotate(p, load, L);
    spari_rotate(p, load + 3, L + 3);
    OK(s, spar_member_set_load(b, 7, SPAR_LOAD_DEAD, L));
    for (int n = 1; n <= 100; n++) {
        double root[7] = {0, 0, 0, 1, 0, 0, 0}, rate[6] = {0, 0, 0, wt[0], wt[1], wt[2]},
               psi[3] = {wt[0] * n * dt, wt[1] * n * dt, wt[2] * n * dt};
        spari_quat_exp(psi, root + 3);
        OK(s, spar_member_drive(b, root, rate, NULL));
        scene_run(s, dt, 1);
    }
    double all_q[56], all_v[48];
    OK(s, spar_member_get_motion(b, all_q, all_v, NULL));
    memcpy(q, all_q + 49, 7 * sizeof *q);
    memcpy(v, all_v + 42, 6 * sizeof *v);
    OK(s, spar_member_get_reaction(b, r));
    OK(s, spar_member_get_energy(b, 4, e));
    spar_session_destroy(&s);
}

static void test_turned_axes_turn_the_answer(void **state) {
    (void)state;
    const double none[4] = {1, 0, 0, 0}, angles[3][3] = {{0.3, -0.2, 0.1}, {2.0, 1.5, -1.0}, {0, 0, 3.1}};
    double q0[7], v0[6], r0[6], e0[4];
    turning_scene(none, q0, v0, r0, e0);
    assert_true(e0[3] > 1e-6); /* it is damped */
    for (int k = 0; k < 3; k++) {
        double p[4], q[7], v[6], r[6], e[4], x[3];
        spari_quat_exp(angles[k], p);
        turning_scene(p, q, v, r, e);
        const double *from[] = {q0, v0, v0 + 3, r0, r0 + 3}, *to[] = {q, v, v + 3, r, r + 3};
        for (int j = 0; j < 5; j++) {
            spari_rotate(p, from[j], x);
            for (int i = 0; i < 3; i++) {
                /* forces: rounding of a strain times the axial stiffness */
                NEAR(to[j][i], x[i], j < 3 ? 1e-11 * fmax(10, spari_norm(from[j])) : 8 * DBL_EPSILON * 1368.17e3);
            }
        }
        for (int i = 0; i < 4; i++) {
            NEAR(e[i], e0[i], 1e-10 * (fabs(e0[0]) + fabs(e0[1])));
        }
    }
}

/* ---- driven roots ---- */

/* Substeps interpolate the root's motion on the group: a root that turns steadily is met exactly, so a stiff beam
   turning with it stays a rigid body in steady rotation, whatever the substeps; 10^3 turns. */
static void test_steady_rotation_over_many_turns(void **state) {
    (void)state;
    double K[36], M[36], zero[3] = {0, 0, 0}, w[3] = {0, 0, 20}, q[56];
    spar_session *s = scene_session();
    scene_diagonal(K, 1e9, 1e9, 1e9, 1e9, 1e9, 1e9);
    scene_diagonal(M, 1, 1, 1, 0.02, 0.01, 0.01);
    spar_member *b = scene_beam(s, "rod", 1, 8, 1, K, M);
    OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_initial_velocity(b, zero, zero, w));
    OK(s, spar_session_set_integrator(s, 0.5, 2));
    int n = 31416;
    double dt = 0.01;
    for (int k = 1; k <= n; k++) {
        double root[7] = {0, 0, 0, cos(10 * k * dt), 0, 0, sin(10 * k * dt)}, rate[6] = {0, 0, 0, 0, 0, 20};
        OK(s, spar_member_drive(b, root, rate, NULL));
        scene_run(s, dt, 1);
    }
    OK(s, spar_member_get_motion(b, q, NULL, NULL));
    double a = 20 * n * dt;
    /* the tip stretches by rho A w^2 L^3 / (3 EA) = 1.3e-7 and lags by nothing */
    NEAR(1 + q[49], cos(a) * (1 + 400.0 / 3e9), 1e-9);
    NEAR(q[50], sin(a) * (1 + 400.0 / 3e9), 1e-9);
    NEAR(spari_quat_dot(q + 52, q + 52), 1, 1e-14);
    spar_session_destroy(&s);
}

/* A root that jumps, far and round, in steps much longer than the motions of the beam behind it (2 m, EA = 1e9 N, EI =
   1e3 N m^2; its lowest frequency is 28 rad/s): the beam is where the root has carried it, but for what the inertia of
   1 kg/m bends it by, m a L^4 / (8 E I) = 1e-4 m for jumps a dt^2 = 5 m, and rho_inf = 0 leaves nothing else. Newton
   finds it from the shape of before: nodes that keep their places, as the inertia of short steps has them, stretch the
   first of the beam beyond what it comes back from. 1 mm. */
static void root_jumps(const double by[3], double angle, int elements, int nodes) {
    double K[36], M[36], motion[7 * 16], tip[3];
    int last = 7 * (elements * nodes - 1);
    spar_session *s = scene_session();
    scene_diagonal(K, 1e9, 1e9, 1e9, 1e3, 1e3, 1e3);
    scene_diagonal(M, 1, 1, 1, 1, 1, 1);
    spar_member *b = scene_beam(s, "rod", elements, nodes, 2, K, M);
    OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
    OK(s, spar_member_commit(b));
    OK(s, spar_session_set_integrator(s, 0, 1));
    for (int n = 1; n <= 3; n++) {
        const double half = 0.5 * n * angle, root[7] = {n * by[0], n * by[1], n * by[2], cos(half), 0, 0, sin(half)};
        OK(s, spar_member_drive(b, root, NULL, NULL));
        scene_run(s, 10, 1);
        OK(s, spar_member_get_motion(b, motion, NULL, NULL));
        tip[0] = root[0] + 2 * cos(n * angle) - 2, tip[1] = root[1] + 2 * sin(n * angle), tip[2] = root[2];
        for (int k = 0; k < 3; k++) {
            NEAR(motion[last + k], tip[k], 1e-3);
        }
    }
    spar_session_destroy(&s);
}

static void test_roots_that_jump(void **state) {
    (void)state;
    static const double far[][3] = {{0, 0, 0.35}, {0.25, 0.3, 0.35}, {2.5, 3, 3.5}};
    const double angles[] = {0.0175, 0.0785, 0.785, 1.5708, 2.97};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 5; k++) {
            root_jumps(far[i], angles[k], 1, 6);
        }
    }
    root_jumps(far[2], angles[3], 3, 4);
}

/* Order 2 in dt of a driven, curved manoeuvre, with dt jumping by 3 from step to step left at order 2 as well: tip of
   the box beam whose root turns there and back from rest without a jump of its acceleration. */
static double manoeuvre(int n, int uneven, int substeps, double q[7]) {
    double K[36], M[36];
    spar_session *s = scene_session();
    scene_box(K, M);
    spar_member *b = scene_beam(s, "arm", 1, 8, 10, K, M);
    OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
    OK(s, spar_member_commit(b));
    OK(s, spar_session_set_integrator(s, 0.8, substeps));
    double t = 0, T = 1;
    for (int k = 0; k < n; k++) {
        double dt = T / n * (uneven ? (k % 2 ? 1.5 : 0.5) : 1);
        t += dt;
        double f = 2 * pi, c = cos(f * t), d = sin(f * t), angle = 0.25 * (1 - c) * (1 - c);
        double w = 0.5 * f * d * (1 - c), a = 0.5 * f * f * (c - c * c + d * d);
        double root[7] = {0, 0, 0, cos(angle / 2), 0, 0, sin(angle / 2)}, rate[6] = {0, 0, 0, 0, 0, w},
               acc[6] = {0, 0, 0, 0, 0, a};
        OK(s, spar_member_drive(b, root, rate, acc));
        scene_run(s, dt, 1);
    }
    scene_tip(b, q);
    double e[4];
    OK(s, spar_member_get_energy(b, 4, e));
    spar_session_destroy(&s);
    return e[1];
}

static void test_manoeuvre_is_of_order_2(void **state) {
    (void)state;
    double best[7], q[7];
    manoeuvre(12800, 0, 1, best);
    for (int uneven = 0; uneven < 2; uneven++) {
        double e[2] = {0, 0};
        for (int k = 0; k < 2; k++) {
            manoeuvre(k ? 1600 : 800, uneven, 1, q);
            for (int i = 0; i < 3; i++) {
                e[k] = fmax(e[k], fabs(q[i] - best[i]));
            }
        }
        NEAR(log2(e[0] / e[1]), 2, 0.15);
    }
    double one[7], four[7];
    manoeuvre(1600, 0, 1, one);
    manoeuvre(400, 0, 4, four); /* the same structural step, the root interpolated in between: fourth order */
    for (int i = 0; i < 3; i++) {
        NEAR(four[i], one[i], 1e-5);
    }
}

/* A rejected step has not been: the run goes on to the same bits. */
/* One motion of a root, given as that of a driven root and by a joint that drives the end: 10 m of the box beam, from
   rest without a jump of acceleration or jerk. (F2) of docs/explanation/theory.md says how far the tip of the one is
   from the other's, seen from the root: (c - 1/12) h^2 of its acceleration there, c = 1/6 + 3/4 ((1 - rho)/(1 +
   rho))^2, and what is of third order, 2 % of it with 800 steps and rho_inf 0. It takes that the root's motion counts
   at the instants at which the scheme has all else, and that the nodes keep what its velocities have beyond its
   accelerations. 3 %. */
typedef struct lead {
    int joint;
    double rho, turning;
} lead;

static void lead_at(const lead *l, double t, double q[7], double v[6], double a[6]) {
    const double f = 2 * pi, c = cos(f * t), d = sin(f * t), part = (1 - c) * (1 - c), rate = 2 * f * d * (1 - c),
                 faster = 2 * f * f * (c - c * c + d * d), half = 0.5 * l->turning * part;
    const double along[6] = {0, 0.001, 0.002, 0, l->turning, 0};
    for (int k = 0; k < 6; k++) {
        v[k] = along[k] * rate;
        a[k] = along[k] * faster;
    }
    for (int k = 0; k < 3; k++) {
        q[k] = along[k] * part;
    }
    q[3] = cos(half), q[4] = q[6] = 0, q[5] = sin(half);
}

/* Acceleration of the tip as the root sees it, in global axes. */
static void seen_from_root(const double *q, const double *v, const double *a, double seen[3]) {
    const double *w = v + 3, arm[3] = {10 + q[49] - q[0], q[50] - q[1], q[51] - q[2]};
    double turn[3], rate[3], twice[3], central[3], euler[3];
    spari_cross(w, arm, turn);
    for (int k = 0; k < 3; k++) {
        rate[k] = v[42 + k] - v[k] - turn[k];
    }
    spari_cross(w, rate, twice);
    spari_cross(w, turn, central);
    spari_cross(a + 3, arm, euler);
    for (int k = 0; k < 3; k++) {
        seen[k] = a[42 + k] - a[k] - central[k] - euler[k] - 2 * twice[k];
    }
}

static void lead_tip(const lead *l, int n, double dt, double tip[3], double seen[3]) {
    double K[36], M[36], root[7], rate[6], faster[6], q[56], v[48], a[48];
    spar_session *s = scene_session();
    spar_joint *j = NULL;
    scene_box(K, M);
    spar_member *b = scene_beam(s, "arm", 1, 8, 10, K, M);
    OK(s, spar_session_set_integrator(s, l->rho, 1));
    OK(s, spar_member_set_root(b, l->joint ? SPAR_ROOT_FREE : SPAR_ROOT_DRIVEN));
    OK(s, spar_member_commit(b));
    if (l->joint) {
        OK(s, spar_joint_create(s, "root", b, 0, NULL, 0, 63, &j));
        OK(s, spar_joint_set_driven(j, 63));
    }
    for (int k = 1; k <= n; k++) {
        lead_at(l, k * dt, root, rate, faster);
        const double z[6] = {root[0], root[1], root[2], 0, 2 * atan2(root[5], root[3]), 0};
        OK(s, l->joint ? spar_joint_drive(j, z, rate, faster) : spar_member_drive(b, root, rate, faster));
        scene_run(s, dt, 1);
    }
    OK(s, spar_member_get_motion(b, q, v, a));
    memcpy(tip, q + 49, 3 * sizeof *tip);
    seen_from_root(q, v, a, seen);
    spar_session_destroy(&s);
}

static void check_lead(double rho, double turning) {
    const double e = (1 - rho) / (1 + rho), c = 1.0 / 6 + 0.75 * e * e, h = 0.6 / 800;
    double by_root[3], by_joint[3], seen[3];
    lead_tip(&(lead){1, rho, turning}, 800, h, by_joint, seen);
    lead_tip(&(lead){0, rho, turning}, 800, h, by_root, seen);
    double by = (c - 1.0 / 12) * h * h, most = by * fmax(fabs(seen[1]), fabs(seen[2]));
    assert_true(most > 1e-10);
    for (int k = 0; k < 3; k++) {
        NEAR(by_root[k] - by_joint[k], by * seen[k], 0.03 * most);
    }
}

static void test_driven_roots_and_driven_joints(void **state) {
    (void)state;
    const double rho[] = {0, 0.5, 0.9, 1};
    for (int i = 0; i < 4; i++) {
        check_lead(rho[i], 0);
        check_lead(rho[i], 0.001);
    }
}

static void test_reject_leaves_no_trace(void **state) {
    (void)state;
    double K[36], M[36], load[6] = {0, 5, 150, 0, 0, 0}, q[2][7];
    scene_box(K, M);
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "box", 1, 6, 10, K, M);
        OK(s, spar_member_commit(b));
        OK(s, spar_member_set_load(b, 5, SPAR_LOAD_DEAD, load));
        for (int n = 0; n < 20; n++) {
            if (k && n % 3 == 0) {
                OK(s, spar_step_begin(s, 0.004));
                OK(s, spar_step_solve(s));
                OK(s, spar_step_reject(s));
            }
            scene_run(s, 0.001, 1);
        }
        scene_tip(b, q[k]);
        spar_session_destroy(&s);
    }
    assert_memory_equal(q[1], q[0], sizeof q[0]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_free_body_is_of_order_2),
        cmocka_unit_test(test_heavy_top_is_of_order_2),
        cmocka_unit_test(test_point_follows),
        cmocka_unit_test(test_step_loaded_beam),
        cmocka_unit_test(test_tangents_serve_while_they_pay),
        cmocka_unit_test(test_free_beam_keeps_momentum_and_energy),
        cmocka_unit_test(test_bent_free_beam_keeps_momentum),
        cmocka_unit_test(test_turned_axes_turn_the_answer),
        cmocka_unit_test(test_steady_rotation_over_many_turns),
        cmocka_unit_test(test_roots_that_jump),
        cmocka_unit_test(test_manoeuvre_is_of_order_2),
        cmocka_unit_test(test_driven_roots_and_driven_joints),
        cmocka_unit_test(test_reject_leaves_no_trace),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
