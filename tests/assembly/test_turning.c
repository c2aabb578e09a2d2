/* Static equilibrium of members that joints tie together and that turn as one, and eigenvalues about it. */
#include "scene.h"

static const double at_origin[3] = {0}, upright[4] = {1, 0, 0, 0};

/* A round body, driven by its root, that turns with W about z through the origin. */
static spar_member *driven_hub(spar_session *s, const double W[3]) {
    const double c[3] = {0}, J[3] = {1, 1, 1};
    double M[36];
    spar_member *hub = NULL;
    scene_mass(M, 1, c, J);
    OK(s, spar_rigid_create(s, "hub", at_origin, upright, M, &hub));
    OK(s, spar_member_set_root(hub, SPAR_ROOT_DRIVEN));
    OK(s, spar_member_set_initial_velocity(hub, NULL, NULL, W));
    OK(s, spar_member_commit(hub));
    return hub;
}

/* A blade from x on, at an angle about z, welded to the hub by its root, which is free. */
static spar_member *welded(spar_session *s, spar_member *b, const char *name, spar_member *hub, double radius,
                           double angle, spar_joint **weld) {
    const double q[4] = {cos(0.5 * angle), 0, 0, sin(0.5 * angle)};
    const double x[3] = {radius * cos(angle), radius * sin(angle), 0};
    spar_joint *j = NULL;
    OK(s, spar_member_set_placement(b, x, q));
    OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
    OK(s, spar_joint_create(s, name, b, 0, hub, 0, 0, &j));
    OK(s, spar_joint_set_frame(j, x, NULL));
    if (weld) {
        *weld = j;
    }
    return b;
}

/* A bent, coupled blade of which nothing is symmetric; names must differ. */
static spar_member *crooked(spar_session *s, const char *name, int nodes) {
    const double eta[3] = {0, 0.5, 1}, xyz[9] = {0, 0, 0, 5, 0.2, 0.1, 10, 0.7, -0.3}, one[2] = {0, 1};
    const double c[3] = {0, 0.02, -0.03}, J[3] = {0.02, 0.005, 0.015};
    double K[36], M[36];
    spar_member *b = NULL;
    scene_box(K, M);
    scene_mass(M, 0.2, c, J);
    OK(s, spar_beam_create(s, name, 1, nodes, &b));
    OK(s, spar_beam_set_axis(b, 3, eta, xyz, NULL));
    OK(s, spar_beam_set_sections(b, 1, one, K, M));
    return b;
}

/* ---- against closed forms and single members ---- */

/* Rods on a hub, stretched by their own centrifugal force: a material place s goes to x(s) with EA (x' - 1)' + rho A
   W^2 x = 0, x(0) = 0, x'(L) = 1, so that x = sin(k s) / (k cos(k L)), k^2 = rho A W^2 / EA, and the root is pulled
   with EA (1 / cos(k L) - 1). One rod of 9 nodes, two elements; two opposite rods leave nothing to the hub. */
static void test_rod(void **state) {
    (void)state;
    enum { N = 18 };
    const double EA = 50, m = 2, L = 1.5, W[3] = {0, 0, 2.4}, k = W[2] * sqrt(m / EA);
    for (int rods = 1; rods <= 2; rods++) {
        double K[36], M[36], q[2][7], load[6], reaction[6], v[6 * N], x[7 * N];
        spar_joint *weld[2];
        spar_member *rod[2];
        spar_session *s = scene_session();
        spar_member *hub = driven_hub(s, W);
        scene_diagonal(K, EA, 1e3, 1e3, 1e3, 1e3, 1e3);
        scene_diagonal(M, m, m, m, 2e-6, 1e-6, 1e-6);
        for (int i = 0; i < rods; i++) {
            rod[i] = scene_beam(s, i ? "second" : "first", 2, N / 2, L, K, M);
            welded(s, rod[i], i ? "weld 2" : "weld 1", hub, 0, i * acos(-1), &weld[i]);
            OK(s, spar_member_commit(rod[i]));
        }
        OK(s, spar_session_solve_static(s, 1, NULL, NULL, NULL));
        for (int i = 0; i < rods; i++) {
            scene_tip(rod[i], q[i]);
            NEAR(q[i][0], (i ? -1 : 1) * (tan(k * L) / k - L), 1e-9);
            NEAR(q[i][1], 0, 1e-12);
            OK(s, spar_joint_get_load(weld[i], load));
            NEAR(load[0], -EA * (1 / cos(k * L) - 1), 1e-7);
        }
        OK(s, spar_member_get_reaction(hub, reaction));
        NEAR(reaction[0], rods == 2 ? 0 : -EA * (1 / cos(k * L) - 1), 1e-7);
        OK(s, spar_member_get_motion(rod[0], x, v, NULL));
        NEAR(v[6 * N - 5], W[2] * (L + x[7 * N - 7]), 1e-12); /* it turns as it is */
        NEAR(v[6 * N - 1], W[2], 1e-15);
        spar_session_destroy(&s);
    }
}

/* Where a blade's nodes are in the axes of the hub, turned back by its own angle. */
static void places(spar_member *b, int n, double angle, double *x) {
    double xr[3 * 32], q[7 * 32];
    const double turn[4] = {cos(0.5 * angle), 0, 0, sin(0.5 * angle)};
    assert_true(n <= 32);
    assert_int_equal(spar_member_get_reference(b, xr, NULL), SPAR_OK);
    assert_int_equal(spar_member_get_motion(b, q, NULL, NULL), SPAR_OK);
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++) {
            x[3 * i + k] = xr[3 * i + k] + q[7 * i + k];
        }
        spari_rotate_back(turn, x + 3 * i, x + 3 * i);
    }
}

/* A bent, coupled blade off the axis: alone with a root that rotates, and three of them welded to a hub, have the same
   shape and the same forces at the root. Exact and rigid. */
static void test_ring(void **state) {
    (void)state;
    enum { N = 11 };
    const double radius = 0.8, third = 2 * acos(-1) / 3;
    const int kinds[2] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_RIGID};
    for (int kind = 0; kind < 2; kind++) {
        const double x[3] = {radius, 0, 0}, W[3] = {0, 0, 6};
        double alone[3 * N], ring[3 * N], reaction[6], load[6], size = 0;
        spar_session *s = scene_session();
        spar_member *b = crooked(s, "alone", N);
        OK(s, spar_member_set_placement(b, x, upright));
        OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
        OK(s, spar_member_set_fidelity(b, kinds[kind], 0));
        OK(s, spar_member_set_initial_velocity(b, NULL, NULL, W));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_solve_static(b, 2));
        places(b, N, 0, alone);
        OK(s, spar_member_get_reaction(b, reaction));
        spar_session_destroy(&s);

        spar_joint *weld[3];
        spar_member *blade[3];
        s = scene_session();
        spar_member *hub = driven_hub(s, W);
        for (int i = 0; i < 3; i++) {
            static const char *const name[3] = {"a", "b", "c"}, *const tie[3] = {"weld a", "weld b", "weld c"};
            blade[i] = crooked(s, name[i], N);
            OK(s, spar_member_set_fidelity(blade[i], kinds[kind], 0));
            welded(s, blade[i], tie[i], hub, radius, i * third, &weld[i]);
            OK(s, spar_member_commit(blade[i]));
        }
        OK(s, spar_member_solve_static(blade[1], 2));
        for (int k = 0; k < 6; k++) {
            size = fmax(size, fabs(reaction[k]));
        }
        for (int i = 0; i < 3; i++) {
            places(blade[i], N, i * third, ring);
            for (int k = 0; k < 3 * N; k++) {
                NEAR(ring[k], alone[k], 1e-10);
            }
        }
        OK(s, spar_joint_get_load(weld[0], load)); /* in the section axes of the root, x along the tangent there */
        NEAR(spari_norm(load), spari_norm(reaction), 1e-8 * size);
        NEAR(spari_norm(load + 3), spari_norm(reaction + 3), 1e-8 * size);
        spar_session_destroy(&s);
    }
}

/* A body whose mass is off its axis by e, on a bearing alike all around, spring k and damper c, driven about it with W:
   (k - m W^2 + i c W) r = m W^2 e, below the critical speed and beyond. In the axes of the body. */
static void test_unbalance(void **state) {
    (void)state;
    const double m = 2, k = 50, c = 3, e = 0.01;
    for (int i = 0; i < 2; i++) {
        const double W = i ? 8 : 3, centre[3] = {0, e, 0}, J[3] = {1.5, 0.8, 0.8}, rate[6] = {0, 0, 0, W, 0, 0};
        const double angle[6] = {0}, re = k - m * W * W, im = c * W, f = m * W * W * e / (re * re + im * im);
        double M[36], spring[36], damper[36], q[7], v[6], load[6], w[3] = {W, 0, 0};
        spar_member *b = NULL;
        spar_joint *j = NULL;
        spar_session *s = scene_session();
        scene_mass(M, m, centre, J);
        OK(s, spar_rigid_create(s, "disc", at_origin, upright, M, &b));
        OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
        OK(s, spar_member_set_initial_velocity(b, NULL, NULL, w));
        OK(s, spar_member_commit(b));
        OK(s, spar_joint_create(s, "bearing", b, 0, NULL, 0, SPAR_FREE_Y | SPAR_FREE_Z | SPAR_FREE_RX, &j));
        OK(s, spar_joint_set_driven(j, SPAR_FREE_RX));
        scene_diagonal(spring, 0, k, k, 0, 0, 0);
        scene_diagonal(damper, 0, c, c, 0, 0, 0);
        OK(s, spar_joint_set_spring(j, spring, damper, NULL));
        OK(s, spar_joint_drive(j, angle, rate, NULL));
        OK(s, spar_session_solve_static(s, 1, NULL, NULL, NULL));
        scene_tip(b, q);
        NEAR(q[1], re * f, 1e-10);
        NEAR(q[2], -im * f, 1e-10);
        OK(s, spar_member_get_motion(b, NULL, v, NULL));
        NEAR(v[1], -W * q[2], 1e-13);
        NEAR(v[2], W * q[1], 1e-13);
        OK(s, spar_joint_get_load(j, load)); /* what the drive gives: the damper's moment */
        NEAR(load[3], c * W * (q[1] * q[1] + q[2] * q[2]), 1e-10);
        for (int unlike = 0; unlike < 2; unlike++) {
            double after[7];
            (unlike ? damper : spring)[14] *= 1.01;
            OK(s, spar_joint_set_spring(j, spring, damper, NULL));
            REFUSED(s, SPAR_ERR_UNSUPPORTED, "joint 'bearing' connects 'disc', which rotates, to a part at rest",
                    spar_session_solve_static(s, 1, NULL, NULL, NULL));
            scene_tip(b, after);
            assert_memory_equal(after, q, sizeof q);
            (unlike ? damper : spring)[14] /= 1.01;
        }
        spar_session_destroy(&s);
    }
}

/* Air that brakes both tips of a rotor of two blades by c v and pulls them along the axis, as places and velocities
 * are. */
typedef struct air {
    spar_fluid *fluid[2];
    double c, thrust;
    double moment; /* about the axis, of the last call */
} air;

static int blow(spar_session *s, double t, double dt, int iteration, void *context) {
    air *a = context;
    (void)t, (void)dt, (void)iteration;
    a->moment = 0;
    for (int i = 0; i < 2; i++) {
        double x[3], v[3];
        const double m[3] = {0};
        OK(s, spar_fluid_pull_motion(a->fluid[i], 1, x, v));
        const double f[3] = {-a->c * v[0], -a->c * v[1], a->thrust - a->c * v[2]};
        a->moment += x[0] * f[1] - x[1] * f[0];
        OK(s, spar_fluid_push_forces(a->fluid[i], f, m));
    }
    return SPAR_OK;
}

/* With a fluid that is steady as seen from the rotor: velocities that it pulls are those of the turn, so that the hub
   is given the moment that the air takes and carries the thrust; and steps with the same fluid stay there to dt^2. */
static void test_fluid(void **state) {
    (void)state;
    enum { N = 9 };
    const double W[3] = {0, 0, 4}, tip[2][3] = {{10.5, 0, 0}, {-10.5, 0, 0}};
    double wander[2] = {0};
    for (int fine = 0; fine < 2; fine++) {
        double load[6], x[2][3 * N], dt = fine ? 2e-3 : 4e-3, far = 0;
        air a = {.c = 0.05, .thrust = 3};
        spar_member *b[2];
        spar_session *s = scene_session();
        spar_member *hub = driven_hub(s, W);
        double K[36], M[36];
        scene_diagonal(K, 1e6, 1e6, 1e6, 1e4, 4e3, 8e3);
        scene_diagonal(M, 0.2, 0.2, 0.2, 2e-3, 1e-3, 1e-3);
        for (int i = 0; i < 2; i++) {
            b[i] = scene_beam(s, i ? "b" : "a", 1, N, 10, K, M);
            welded(s, b[i], i ? "weld b" : "weld a", hub, 0.5, i * acos(-1), NULL);
            OK(s, spar_beam_set_damping(b[i], (const double[6]){0.02, 0.02, 0.02, 0.02, 0.02, 0.02}));
            OK(s, spar_member_set_initial_velocity(b[i], NULL, NULL, W));
            OK(s, spar_member_commit(b[i]));
            OK(s, spar_fluid_create(b[i], "air", &a.fluid[i]));
            OK(s, spar_fluid_set_motion_nodes(a.fluid[i], 1, tip[i]));
            OK(s, spar_fluid_set_force_nodes(a.fluid[i], 1, tip[i]));
            OK(s, spar_fluid_map(a.fluid[i]));
        }
        OK(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 1e-13, 1e-11, 50));
        OK(s, spar_session_set_integrator(s, 0.8, 1));
        OK(s, spar_session_solve_static(s, 2, blow, &a, NULL));
        places(b[0], N, 0, x[0]);
        for (int k = 0; k < 3; k++) {
            far += x[0][3 * N - 3 + k] * x[0][3 * N - 3 + k] * (k < 2);
        }
        assert_true(x[0][3 * N - 1] > 0.1);          /* it is bent */
        NEAR(a.moment, -2 * a.c * W[2] * far, 1e-8); /* c v r, v = W r */
        OK(s, spar_member_get_reaction(hub, load));
        NEAR(load[5], -a.moment, 1e-7);
        NEAR(load[2], -2 * a.thrust, 1e-7);
        for (int i = 1; i <= (fine ? 200 : 100); i++) {
            const double angle = W[2] * dt * i, rate[6] = {0, 0, 0, 0, 0, W[2]};
            const double q[7] = {0, 0, 0, cos(0.5 * angle), 0, 0, sin(0.5 * angle)};
            OK(s, spar_member_drive(hub, q, rate, NULL));
            OK(s, spar_step(s, dt, blow, &a, NULL));
            places(b[0], N, angle, x[1]);
            for (int k = 3 * N - 3; k < 3 * N; k++) {
                wander[fine] = fmax(wander[fine], fabs(x[1][k] - x[0][k]));
            }
        }
        spar_session_destroy(&s);
    }
    assert_true(wander[0] < 1e-3);
    NEAR(wander[0] / wander[1], 4, 0.6);
}

/* ---- in time ---- */

static void step_hub(spar_session *s, spar_member *hub, double W, double dt, int from, int n) {
    for (int i = from + 1; i <= from + n; i++) {
        const double angle = W * dt * i, rate[6] = {0, 0, 0, 0, 0, W};
        const double q[7] = {0, 0, 0, cos(0.5 * angle), 0, 0, sin(0.5 * angle)};
        OK(s, spar_member_drive(hub, q, rate, NULL));
        scene_run(s, dt, 1);
    }
}

/* Steps from there stay there: with half the dt the wander of the tips, seen from the hub, is a quarter. And steps that
   damp, from straight blades, come to the same shape. */
static void steps_stay(int fidelity) {
    enum { N = 9 };
    const double W[3] = {0, 0, 4};
    double wander[2] = {0}, x[2][3 * N];
    for (int how = 0; how < 3; how++) {
        double dt = how == 0 ? 4e-3 : 2e-3;
        int steps = how == 0 ? 150 : how == 1 ? 300 : 3000;
        spar_session *s = scene_session();
        spar_member *hub = driven_hub(s, W), *b = crooked(s, "blade", N);
        welded(s, b, "weld", hub, 0.5, 0, NULL);
        OK(s, spar_member_set_fidelity(b, fidelity, 0));
        OK(s, spar_beam_set_damping(b, (const double[6]){0.02, 0.02, 0.02, 0.02, 0.02, 0.02}));
        OK(s, spar_member_set_initial_velocity(b, NULL, NULL, W));
        OK(s, spar_member_commit(b));
        OK(s, spar_session_set_integrator(s, how < 2 ? 0.8 : 0, 1));
        if (how < 2) {
            OK(s, spar_session_solve_static(s, 2, NULL, NULL, NULL));
            places(b, N, 0, x[0]);
        }
        for (int i = 0; i < steps; i += 10) {
            step_hub(s, hub, W[2], dt, i, 10);
            places(b, N, W[2] * dt * (i + 10), x[1]);
            for (int k = 3 * N - 3; k < 3 * N && how < 2; k++) {
                wander[how] = fmax(wander[how], fabs(x[1][k] - x[0][k]));
            }
        }
        for (int k = 0; k < 3 * N && how == 2; k++) {
            NEAR(x[1][k], x[0][k], 2e-5);
        }
        spar_session_destroy(&s);
    }
    assert_true(wander[0] < 1e-3);
    if (fidelity == SPAR_FIDELITY_RIGID) {
        NEAR(wander[0], 0, 1e-10);
    } else {
        NEAR(wander[0] / wander[1], 4, 0.4);
    }
}

static void test_steps_stay(void **state) {
    (void)state;
    steps_stay(SPAR_FIDELITY_EXACT);
    steps_stay(SPAR_FIDELITY_RIGID);
}

/* ---- eigenvalues about it ---- */

/* Three uniform blades on a hub that a hinge against the ground drives: flap out of the plane (Wright et al. 1982, as
   in test_eigenvalues.c), three times each, at a speed that no step has run up to. */
static void test_rotor(void **state) {
    (void)state;
    enum { N = 9 };
    const double flap[2] = {7.3603730193, 26.809081678}, third = 2 * acos(-1) / 3, c[3] = {0}, J[3] = {1, 1, 1};
    const double rate[6] = {0, 0, 0, 0, 0, 6}, angle[6] = {0};
    double K[36], M[36], body[36], value[3][2], frame[3];
    spar_session *s = scene_session();
    spar_member *hub = NULL, *b[3];
    spar_joint *shaft = NULL;
    scene_diagonal(K, 1e8, 1e8, 1e8, 1e3, 1, 1);
    scene_diagonal(M, 1, 1, 1, 2e-8, 1e-8, 1e-8);
    scene_mass(body, 1, c, J);
    OK(s, spar_rigid_create(s, "hub", at_origin, upright, body, &hub));
    OK(s, spar_member_set_root(hub, SPAR_ROOT_FREE));
    OK(s, spar_member_commit(hub));
    OK(s, spar_joint_create(s, "shaft", hub, 0, NULL, 0, SPAR_FREE_RZ, &shaft));
    OK(s, spar_joint_set_driven(shaft, SPAR_FREE_RZ));
    OK(s, spar_joint_drive(shaft, angle, rate, NULL));
    for (int i = 0; i < 3; i++) {
        static const char *const name[3] = {"a", "b", "c"}, *const tie[3] = {"weld a", "weld b", "weld c"};
        b[i] = scene_beam(s, name[i], 1, N, 1, K, M);
        welded(s, b[i], tie[i], hub, 0, i * third, NULL);
        OK(s, spar_member_commit(b[i]));
    }
    OK(s, spar_session_solve_static(s, 1, NULL, NULL, NULL));
    for (int k = 0; k < 2; k++) {
        const double shift[2] = {0, flap[k]};
        OK(s, spar_member_solve_eigenvalues(b[1], 3, shift, &value[0][0], NULL, frame));
        for (int i = 0; i < 3; i++) {
            NEAR(value[i][1], flap[k], 2e-5 * flap[k]);
            NEAR(value[i][0], 0, 1e-6);
        }
        NEAR(frame[2], 6, 1e-9);
    }
    spar_session_destroy(&s);
}

/* ---- what is not steady ---- */

/* A blade on a hub, and a call that must change nothing. */
static void refuse(spar_session *s, spar_member *b, const char *text) {
    double before[7 * 9], after[7 * 9] = {0};
    OK(s, spar_member_get_motion(b, before, NULL, NULL));
    REFUSED(s, SPAR_ERR_UNSUPPORTED, text, spar_session_solve_static(s, 1, NULL, NULL, NULL));
    OK(s, spar_member_get_motion(b, after, NULL, NULL));
    for (int i = 0; i < 63; i++) {
        NEAR(after[i], before[i], 0);
    }
}

static void test_refused(void **state) {
    (void)state;
    enum { N = 9 };
    const double W[3] = {0, 0, 4}, g[3] = {0, 3, -9.81}, along[3] = {0, 0, -9.81}, side[6] = {0, 1, 0, 0, 0, 0};
    const double none[6] = {0}, one[2] = {0, 1}, lines[12] = {1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0}, zero[12] = {0};
    spar_session *s = scene_session();
    spar_member *hub = driven_hub(s, W), *b = crooked(s, "blade", N);
    welded(s, b, "weld", hub, 0.5, 0, NULL);
    OK(s, spar_member_commit(b));
    OK(s, spar_session_set_gravity(s, g));
    refuse(s, b, "gravity (0, 3, -9.81) is not parallel");
    OK(s, spar_session_set_gravity(s, along));
    OK(s, spar_session_solve_static(s, 1, NULL, NULL, NULL));
    OK(s, spar_member_set_load(b, 3, SPAR_LOAD_DEAD, side));
    refuse(s, b, "the dead load of node 3");
    OK(s, spar_member_set_load(b, 3, SPAR_LOAD_DEAD, none));
    OK(s, spar_member_set_load(b, 3, SPAR_LOAD_FOLLOWER, side));
    OK(s, spar_session_solve_static(s, 1, NULL, NULL, NULL));
    OK(s, spar_beam_set_line_load(b, SPAR_LOAD_DEAD, 2, one, lines));
    refuse(s, b, "its dead line load");
    OK(s, spar_beam_set_line_load(b, SPAR_LOAD_DEAD, 2, one, zero));
    OK(s, spar_session_solve_static(s, 1, NULL, NULL, NULL));
    spar_session_destroy(&s);
}

/* A rotor on a mast that stands; a blade whose tip is held by the ground; one on springs that are not alike all around;
   two hubs of two speeds. */
static void test_refused_ties(void **state) {
    (void)state;
    enum { N = 9 };
    for (int kind = 0; kind < 4; kind++) {
        const double W[3] = {0, 0, 4}, tip[3] = {10.5, 0.7, -0.3}, rate[6] = {0, 0, 0, 0, 0, 2}, angle[6] = {0};
        double spring[36];
        spar_joint *j = NULL;
        spar_session *s = scene_session();
        spar_member *hub = driven_hub(s, W), *b = crooked(s, "blade", N);
        welded(s, b, "weld", hub, 0.5, 0, NULL);
        OK(s, spar_member_commit(b));
        if (kind == 0) {
            spar_member *mast = crooked(s, "mast", N);
            OK(s, spar_member_set_placement(mast, tip, upright));
            OK(s, spar_member_set_root(mast, SPAR_ROOT_FIXED));
            OK(s, spar_member_commit(mast));
            OK(s, spar_joint_create(s, "hinge", mast, 0, b, N - 1, SPAR_FREE_RZ, &j));
            refuse(s, b,
                   "the root of 'hub' rotates at (0, 0, 4) rad/s and the root of 'mast', which is connected to it");
        } else if (kind == 1) {
            OK(s, spar_joint_create(s, "stay", b, N - 1, NULL, 0, SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ, &j));
            refuse(s, b, "joint 'stay' connects 'blade', which rotates, to a part at rest");
        } else if (kind == 2) { /* alike all around, but not about the axis */
            scene_diagonal(spring, 7, 7, 0, 0, 0, 0);
            OK(s, spar_joint_create(s, "springs", b, 0, NULL, 0, 63, &j));
            OK(s, spar_joint_set_spring(j, spring, NULL, NULL));
            refuse(s, b, "joint 'springs' connects 'blade'");
        } else {
            spar_member *flap = crooked(s, "flap", N);
            OK(s, spar_member_set_placement(flap, tip, upright));
            OK(s, spar_member_set_root(flap, SPAR_ROOT_FREE));
            OK(s, spar_member_commit(flap));
            OK(s, spar_joint_create(s, "hinge", flap, 0, b, N - 1, SPAR_FREE_RZ, &j));
            OK(s, spar_joint_set_driven(j, SPAR_FREE_RZ));
            OK(s, spar_joint_set_frame(j, tip, upright));
            OK(s, spar_joint_drive(j, angle, rate, NULL));
            refuse(s, b, "joint 'hinge' is driven between moving parts");
            OK(s, spar_joint_drive(j, angle, NULL, NULL));
            OK(s, spar_session_solve_static(s, 2, NULL, NULL, NULL));
        }
        spar_session_destroy(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rod),          cmocka_unit_test(test_ring),  cmocka_unit_test(test_unbalance),
        cmocka_unit_test(test_steps_stay),   cmocka_unit_test(test_rotor), cmocka_unit_test(test_refused),
        cmocka_unit_test(test_refused_ties), cmocka_unit_test(test_fluid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
