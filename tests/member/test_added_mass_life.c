/* The guess of the fluid's added mass (spar_member_set_added_mass) through all that a member lives through: joints,
   statics, longer steps, giving a step up, files, trials, changes of fidelity; what is refused and what is read. What
   it computes is in test_added_mass.c. The oracle is the converged run without it, or the run that was not disturbed.
 */
#include "pistons.h"
#include "trials.h"

#include <stdio.h>

/* Two arms of a mechanism in a heavy fluid: a rigid body on a hinge at the ground, and a beam on a hinge at its tip;
   the fluid is added mass at three places and a stream that changes. */
enum { ARM_NODES = 3 };
typedef struct arms {
    spar_session *session;
    spar_member *body, *beam;
    spar_fluid *fluid[2];
    double mass;
    int fails;
} arms;

static int arms_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    arms *m = context;
    (void)iteration;
    for (int k = 0; k < 2; k++) {
        double q[4 * ARM_NODES], a[3 * ARM_NODES], f[3 * ARM_NODES];
        int n = k ? ARM_NODES : 1;
        if (k) {
            OK(s, spar_fluid_pull_poses(m->fluid[1], SPAR_NODES_MOTION, 1, NULL, q, NULL, NULL, a, NULL));
        } else {
            double pose[7], rate[6];
            OK(s, spar_member_get_motion(m->body, pose, NULL, rate));
            for (int c = 0; c < 3; c++) {
                a[c] = rate[c];
            }
        }
        for (int i = 0; i < 3 * n; i++) {
            f[i] = -m->mass / n * a[i] + (i % 3 == 1 ? 0.3 * sin(4 * (t + dt)) : 0);
        }
        OK(s, spar_fluid_push_forces(m->fluid[k], f, NULL));
    }
    return m->fails ? SPAR_ERR_USER : SPAR_OK;
}

static int is_frame(int fidelity) {
    return fidelity == SPAR_FIDELITY_LINEAR || fidelity == SPAR_FIDELITY_MODAL;
}

/* guess: times the fluid's mass; by_tip: the beam hangs on the body by its last node, not by its root */
static void arms_create_by(arms *m, double mass, double guess, int fidelity, int by_tip) {
    static const double x[3] = {1, 0, 0}, q[4] = {1, 0, 0, 0}, c[3] = {0, 0, 0}, J[3] = {0.1, 0.2, 0.2},
                        along[ARM_NODES] = {0.1, 0.5, 0.9}, about[4] = {0, 0, 0, 1}, outer[3] = {3, 0, 0},
                        ground[3] = {0, 0, 0}, eta[2] = {0, 1};
    double M[36], K[36], A[36];
    spar_joint *joint;
    memset(m, 0, sizeof *m);
    spar_session *s = m->session = scene_session();
    m->mass = mass;
    scene_mass(M, 1, c, J);
    OK(s, spar_rigid_create(s, "body", x, q, M, &m->body));
    scene_diagonal(A, guess * mass, guess * mass, guess * mass, 0, 0, 0);
    OK(s, spar_member_set_added_mass(m->body, 1, NULL, A));
    OK(s, spar_member_set_effects(m->body, SPAR_EFFECT_WORK, 0));
    OK(s, spar_member_commit(m->body));
    scene_diagonal(K, 1e4, 1e4, 1e4, 100, 80, 80);
    scene_diagonal(M, 0.5, 0.5, 0.5, 0.01, 0.01, 0.01);
    m->beam = scene_beam(s, "beam", 2, 3, 2, K, M);
    OK(s, spar_member_set_placement(m->beam, by_tip ? outer : x, by_tip ? about : q));
    OK(s, spar_member_set_root(m->beam, SPAR_ROOT_FREE));
    OK(s, spar_member_set_fidelity(m->beam, fidelity, 0));
    for (int i = 0; i < 36; i++) {
        A[i] /= 2; /* its length */
    }
    OK(s, spar_member_set_added_mass(m->beam, 1, eta, A));
    OK(s, spar_member_set_effects(m->beam, SPAR_EFFECT_WORK, 0));
    OK(s, spar_member_commit(m->beam));
    OK(s, spar_joint_create(s, "ground", m->body, 0, NULL, 0, SPAR_FREE_RZ, &joint));
    OK(s, spar_joint_set_frame(joint, ground, q));
    OK(s, spar_joint_create(s, "elbow", m->beam, by_tip ? 5 : 0, m->body, 0, SPAR_FREE_RZ, &joint));
    OK(s, spar_fluid_create(m->body, "on body", &m->fluid[0]));
    OK(s, spar_fluid_set_force_nodes(m->fluid[0], 1, x));
    OK(s, spar_fluid_map(m->fluid[0]));
    OK(s, spar_fluid_create(m->beam, "on beam", &m->fluid[1]));
    OK(s, spar_fluid_set_stations(m->fluid[1], ARM_NODES, along, NULL));
    OK(s, spar_fluid_map(m->fluid[1]));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 1e-12, 1e-11, 300));
}

static void arms_create(arms *m, double mass, double guess, int fidelity) {
    arms_create_by(m, mass, guess, fidelity, 0);
}

/* The whole converged motion of the two, and their work. */
typedef struct shape {
    double q[7 * 7], v[6 * 7], work[2][SPAR_WORK_COUNT];
} shape;

static void look(const arms *m, shape *to) {
    OK(m->session, spar_member_get_motion(m->body, to->q, to->v, NULL));
    OK(m->session, spar_member_get_motion(m->beam, to->q + 7, to->v + 6, NULL));
    OK(m->session, spar_member_get_work(m->body, SPAR_WORK_COUNT, to->work[0]));
    OK(m->session, spar_member_get_work(m->beam, SPAR_WORK_COUNT, to->work[1]));
}

static double distance(const double *a, const double *b, int n) {
    double most = 0;
    for (int i = 0; i < n; i++) {
        most = fmax(most, fabs(a[i] - b[i]));
    }
    return most;
}

static int arms_steps(arms *m, double dt, int steps) {
    int sum = 0, n;
    for (int i = 0; i < steps; i++) {
        OK(m->session, spar_step(m->session, dt, arms_fluid, m, &n));
        sum += n;
    }
    return sum;
}

static const int arm_fidelity[2] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_RIGID};

/* Evaluations to a tolerance that is used. */
static int tied_count(int fidelity, int by_tip, double guess) {
    arms m;
    arms_create_by(&m, 10, guess, fidelity, by_tip);
    OK(m.session, spar_session_set_coupling(m.session, SPAR_COUPLING_IQN_ILS, 1e-7, 1e-6, 300));
    int count = arms_steps(&m, 0.02, 20);
    spar_session_destroy(&m.session);
    return count;
}

static void tied_as(int fidelity, int by_tip) {
    static const double guess[4] = {0, 1, 0.5, 2};
    shape seen[4];
    double f[4][3];
    int count[4];
    for (int k = 0; k < 4; k++) {
        arms m;
        memset(&seen[k], 0, sizeof seen[k]);
        arms_create_by(&m, 10, guess[k], fidelity, by_tip);
        count[k] = arms_steps(&m, 0.02, 20);
        look(&m, &seen[k]);
        memset(f[k], 0, sizeof f[k]);
        if (fidelity != SPAR_FIDELITY_RIGID) { /* the first two are turns in the hinges */
            OK(m.session, spar_member_solve_modes(m.beam, 3, f[k], NULL));
        }
        spar_session_destroy(&m.session);
        print_message("tied, guess %g: %d evaluations, off by %.1e, work by %.1e of %.1e\n", guess[k], count[k],
                      distance(seen[k].q, seen[0].q, 49), distance(seen[k].work[0], seen[0].work[0], 8),
                      fabs(seen[0].work[0][SPAR_WORK_FLUID]));
        NEAR(distance(seen[k].q, seen[0].q, 49), 0, 1e-10);
        NEAR(distance(seen[k].v, seen[0].v, 42), 0, 1e-7);
        NEAR(distance(seen[k].work[0], seen[0].work[0], 2 * SPAR_WORK_COUNT), 0, 1e-10);
        NEAR(f[k][2], f[0][2], 1e-7 * f[0][2]);
    }
    count[0] = tied_count(fidelity, by_tip, 0);
    count[1] = tied_count(fidelity, by_tip, 1);
    print_message("tied, to 1e-6: %d evaluations, with a guess %d\n", count[0], count[1]);
    assert_true(count[1] < count[0] + (fidelity == SPAR_FIDELITY_RIGID ? 3 : 0));
}

/* Members that joints tie: the converged motion and work are those without a guess (1e-10 of metres and 1e-7 of motions
   of 0.1 to 1, 1e-10 of joules of 1e-4: the coupling's tolerance, 1e-11, over 20 steps and an added mass of 10 times
   the mass), with the guess right, half and twice; in fewer iterations where it is right (of a rigid one the
   columns know as much after two); the same frequencies. The beam exact and rigid, on the joint by its root and by its
   other end. */
static void tied_members(void **state) {
    (void)state;
    for (int i = 0; i < 4; i++) {
        tied_as(arm_fidelity[i / 2], i % 2);
    }
}

/* Tied members in substeps: between the ends of a step the guess stands against a corrected load, so that the answer
   differs from that without one by (omega dt)^2 of the motion of 1e-3 m, 6e-6 m; corrected at one end only it would be
   off by 8e-4 m. */
static void tied_in_substeps(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        shape seen[2];
        for (int guessed = 0; guessed < 2; guessed++) {
            arms m;
            arms_create(&m, 0.1, guessed, arm_fidelity[i]);
            OK(m.session, spar_session_set_integrator(m.session, 0.9, 2));
            OK(m.session, spar_session_set_coupling(m.session, SPAR_COUPLING_IQN_ILS, 1e-10, 1e-9, 300));
            (void)arms_steps(&m, 0.02, 20);
            look(&m, &seen[guessed]);
            spar_session_destroy(&m.session);
        }
        print_message("tied, in substeps: off by %.1e\n", distance(seen[0].q, seen[1].q, 49));
        NEAR(distance(seen[0].q, seen[1].q, 49), 0, 6e-6);
    }
}

/* Loads that are read during a step and after it are the fluids', without what the guess adds to them: after a step
   what was pushed, to rounding of the 100 N that are added; of a step that was not checked, what it was solved with. */
static void loads_are_the_fluids(void **state) {
    (void)state;
    const double r = 10, guess = 20;
    double load[6], a[6], pushed[3] = {1, 0, 0};
    int done;
    pistons p;
    pistons_create_with(&p, 1, &r, &guess);
    p.b[0] = 5;
    OK(p.session, spar_fluid_push_forces(p.fluid[0], pushed, NULL));
    OK(p.session, spar_session_set_coupling(p.session, SPAR_COUPLING_IQN_ILS, 1e-12, 1e-12, 50));
    for (int step = 0; step < 3; step++) {
        OK(p.session, spar_step_begin(p.session, 0.1));
        for (done = 0; !done;) {
            OK(p.session, spar_step_solve(p.session));
            OK(p.session, spar_member_get_loads(p.body[0], load));
            OK(p.session, spar_member_get_motion(p.body[0], NULL, NULL, a));
            NEAR(load[0], 2 * a[0], 1e-13 * 100); /* what moves it: its own mass times its acceleration */
            OK(p.session, pistons_fluid(p.session, 0, 0.1, 0, &p));
            OK(p.session, spar_step_check(p.session, &done));
        }
        OK(p.session, spar_member_get_loads(p.body[0], load));
        NEAR(load[0], p.force[0][0], 1e-13 * 100);
        OK(p.session, spar_step_accept(p.session));
        OK(p.session, spar_member_get_loads(p.body[0], load));
        NEAR(load[0], p.force[0][0], 1e-13 * 100);
    }
    OK(p.session, spar_step_begin(p.session, 0.1));
    OK(p.session, spar_step_solve(p.session));
    OK(p.session, spar_step_accept(p.session)); /* not checked */
    OK(p.session, spar_member_get_loads(p.body[0], load));
    OK(p.session, spar_member_get_motion(p.body[0], NULL, NULL, a));
    NEAR(load[0], 2 * a[0], 1e-13 * 100);
    pistons_destroy(&p);
}

/* Steps given up, at every stage, and fluids that fail, change no bit of what comes after; nor do a file written and
   read between steps and in the middle of one, by a session made anew. */
static void bits(void **state) {
    (void)state;
    static const char path[] = "added_mass.spar";
    shape seen[3];
    memset(seen, 0, sizeof seen);
    for (int way = 0; way < 3; way++) { /* undisturbed, with steps given up, from files */
        arms m;
        int done;
        arms_create(&m, 10, 0.7, SPAR_FIDELITY_EXACT);
        OK(m.session, spar_session_set_predictor(m.session, 2));
        OK(m.session, spar_session_set_option(m.session, "coupling.reuse", "0"));
        for (int step = 0; step < 6; step++) {
            for (int stage = 0; stage < 4 && way == 1; stage++) {
                OK(m.session, spar_step_begin(m.session, 0.02));
                for (int i = 0; i < stage; i++) {
                    OK(m.session, spar_step_solve(m.session));
                    OK(m.session, arms_fluid(m.session, 0.02 * step, 0.02, i, &m));
                    if (i < 2) {
                        OK(m.session, spar_step_check(m.session, &done));
                    }
                }
                OK(m.session, spar_step_reject(m.session));
            }
            if (way == 1) {
                m.fails = 1;
                assert_int_equal(spar_step(m.session, 0.02, arms_fluid, &m, NULL), SPAR_ERR_USER);
                m.fails = 0;
            }
            OK(m.session, spar_step_begin(m.session, 0.02));
            for (int i = 0; !done || i == 0; i++) {
                OK(m.session, spar_step_solve(m.session));
                if (way == 2 && i == 1) {
                    OK(m.session, spar_session_save(m.session, path));
                    spar_session_destroy(&m.session);
                    arms_create(&m, 10, 0.7, SPAR_FIDELITY_EXACT);
                    OK(m.session, spar_session_set_predictor(m.session, 2));
                    OK(m.session, spar_session_set_option(m.session, "coupling.reuse", "0"));
                    OK(m.session, spar_session_load(m.session, path));
                }
                OK(m.session, arms_fluid(m.session, 0.02 * step, 0.02, i, &m));
                OK(m.session, spar_step_check(m.session, &done));
            }
            OK(m.session, spar_step_accept(m.session));
        }
        look(&m, &seen[way]);
        memset(seen[way].work, 0, sizeof seen[way].work); /* an account begins where the file is loaded */
        if (way == 2) {                                   /* a session with another guess has another description */
            OK(m.session, spar_session_save(m.session, path));
            spar_session_destroy(&m.session);
            arms_create(&m, 10, 0.8, SPAR_FIDELITY_EXACT);
            OK(m.session, spar_session_set_predictor(m.session, 2));
            assert_int_not_equal(spar_session_load(m.session, path), SPAR_OK);
        }
        spar_session_destroy(&m.session);
    }
    assert_memory_equal(&seen[1], &seen[0], sizeof seen[0]);
    assert_memory_equal(&seen[2], &seen[0], sizeof seen[0]);
    (void)remove(path);
}

/* A static solution, steps, and a jump to steps ten times as long (which filters the acceleration carried along): as
   without the guess. The beam alone, on a fixed root, under a weight. */
typedef struct mast {
    spar_session *session;
    spar_member *beam;
    spar_fluid *fluid;
    double mass;
} mast;

static int mast_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    mast *m = context;
    double q[4 * ARM_NODES], a[3 * ARM_NODES], f[3 * ARM_NODES];
    (void)iteration;
    OK(s, spar_fluid_pull_poses(m->fluid, SPAR_NODES_MOTION, 1, NULL, q, NULL, NULL, a, NULL));
    for (int i = 0; i < 3 * ARM_NODES; i++) {
        f[i] = -m->mass * a[i] + (i % 3 == 2 ? 3 + sin(3 * (t + dt)) : 0);
    }
    return spar_fluid_push_forces(m->fluid, f, NULL);
}

static void mast_create(mast *m, double mass, double guess, int fidelity) {
    static const double along[ARM_NODES] = {0.1, 0.5, 0.9}, eta[1] = {0};
    double K[36], M[36], A[36];
    spar_session *s = m->session = scene_session();
    m->mass = mass;
    scene_diagonal(K, 1e4, 1e4, 1e4, 100, 80, 80);
    scene_diagonal(M, 0.5, 0.5, 0.5, 0.01, 0.01, 0.01);
    m->beam = scene_beam(s, "mast", 1, 6, 2, K, M);
    OK(s, spar_member_set_fidelity(m->beam, fidelity, 6));
    scene_diagonal(A, guess, guess, guess, 0, 0, 0);
    OK(s, spar_member_set_added_mass(m->beam, 1, eta, A));
    OK(s, spar_member_commit(m->beam));
    OK(s, spar_fluid_create(m->beam, "strips", &m->fluid));
    OK(s, spar_fluid_set_stations(m->fluid, ARM_NODES, along, NULL));
    OK(s, spar_fluid_map(m->fluid));
    double rough = is_frame(fidelity) ? 100 : 1;
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 1e-12 * rough, 1e-11 * rough, 300));
}

/* With any guess the same, to what the coupling leaves; but for the steps of another length, which have a stage whose
   loads are linear in time: the part that the guess accounts for follows the acceleration of the stage, so that the
   answer differs by (omega dt)^2 / 8 = 1.1e-2 of the way that the load of 3 rad/s makes in steps of 0.1 s, 0.03 m. */
static void statics_and_longer_steps(void **state) {
    (void)state;
    static const int fidelity[3] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL};
    for (int f = 0; f < 3; f++) {
        double q[2][4][7];
        for (int k = 0; k < 2; k++) {
            mast m;
            mast_create(&m, 2, k ? 3 : 0, fidelity[f]);
            OK(m.session, spar_session_solve_static(m.session, 2, mast_fluid, &m, NULL));
            scene_tip(m.beam, q[k][0]);
            for (int i = 0; i < 30; i++) {
                OK(m.session, spar_step(m.session, i < 20 ? 0.01 : 0.1, mast_fluid, &m, NULL));
                if (i == 10) {
                    scene_tip(m.beam, q[k][1]);
                }
            }
            scene_tip(m.beam, q[k][2]);
            OK(m.session, spar_session_solve_static(m.session, 2, mast_fluid, &m, NULL));
            OK(m.session, spar_step(m.session, 0.01, mast_fluid, &m, NULL));
            OK(m.session, spar_member_solve_static(m.beam, 2));
            scene_tip(m.beam, q[k][3]);
            spar_session_destroy(&m.session);
        }
        for (int i = 0; i < 4; i++) {
            print_message("fidelity %d, %d: tip %g, off by %.1e\n", fidelity[f], i, q[0][i][2],
                          distance(q[0][i], q[1][i], 7));
            assert_true(fabs(q[0][i][2]) > 1e-3);
            NEAR(distance(q[0][i], q[1][i], 7), 0, i == 2 ? 1.1e-2 * 0.03 : 1e-8);
        }
    }
}

/* A beam that falls from a hinge at the ground, by its root or its other end, with loads at t^0, in a fluid whose added
   mass goes with the beam: m along it, 5 m across. */
static int swing_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    mast *m = context;
    double q[4 * ARM_NODES], a[3 * ARM_NODES], f[3 * ARM_NODES], root[7 * 6];
    (void)iteration, (void)t, (void)dt;
    OK(s, spar_member_get_motion(m->beam, root, NULL, NULL));
    double turn = 2 * atan2(root[6], root[3]), c = cos(turn), d = sin(turn), share = -m->mass / ARM_NODES;
    OK(s, spar_fluid_pull_poses(m->fluid, SPAR_NODES_MOTION, 1, NULL, q, NULL, NULL, a, NULL));
    for (int i = 0; i < ARM_NODES; i++) {
        double along = a[3 * i] * c + a[3 * i + 1] * d, across = a[3 * i + 1] * c - a[3 * i] * d;
        f[3 * i] = share * (along * c - 5 * across * d);
        f[3 * i + 1] = share * (along * d + 5 * across * c);
        f[3 * i + 2] = 5 * share * a[3 * i + 2];
    }
    return spar_fluid_push_forces(m->fluid, f, NULL);
}

static void swing_create(mast *m, double mass, double guess, int fidelity, int by_tip) {
    static const double along[ARM_NODES] = {0.1, 0.5, 0.9}, eta[1] = {0}, start[2][3] = {{0, 0, 0}, {2, 0, 0}},
                        ahead[2][4] = {{1, 0, 0, 0}, {0, 0, 0, 1}}, down[3] = {0, -30, 0}, x[3] = {0, 0, 0};
    double K[36], M[36], A[36];
    const double first[3 * ARM_NODES] = {0, 1, 0, 0, 2, 0, 0, 3, 0};
    spar_joint *hinge;
    memset(m, 0, sizeof *m);
    spar_session *s = m->session = scene_session();
    m->mass = mass;
    OK(s, spar_session_set_gravity(s, down));
    scene_diagonal(K, 1e4, 1e4, 1e4, 100, 80, 80);
    scene_diagonal(M, 0.5, 0.5, 0.5, 0.01, 0.01, 0.01);
    m->beam = scene_beam(s, "swing", 2, 3, 2, K, M);
    OK(s, spar_member_set_placement(m->beam, start[by_tip], ahead[by_tip]));
    OK(s, spar_member_set_root(m->beam, SPAR_ROOT_FREE));
    OK(s, spar_member_set_fidelity(m->beam, fidelity, 0));
    scene_diagonal(A, guess / 2, 5 * guess / 2, 5 * guess / 2, 0, 0, 0);
    OK(s, spar_member_set_added_mass(m->beam, 1, eta, A));
    OK(s, spar_member_commit(m->beam));
    OK(s, spar_joint_create(s, "hinge", m->beam, by_tip ? 5 : 0, NULL, 0, SPAR_FREE_RZ, &hinge));
    OK(s, spar_joint_set_frame(hinge, x, ahead[0]));
    OK(s, spar_fluid_create(m->beam, "strips", &m->fluid));
    OK(s, spar_fluid_set_stations(m->fluid, ARM_NODES, along, NULL));
    OK(s, spar_fluid_map(m->fluid));
    OK(s, spar_fluid_push_forces(m->fluid, first, NULL));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 1e-10, 1e-10, 300));
}

/* The same far along: hinged members that swing by more than a radian, accelerated from t^0 on, in a fluid that is
   heavier across than along: as without the guess, position and acceleration to the coupling's tolerance (1e-10 of
   loads of 10 N on 1 kg over 0.8 s). The joint's constraint projects velocities with the tangent, which contains the
   guess: the rigid beam that hangs by its other end, whose root the constraint moves, differs by up to dt^2, 4e-4 s^2,
   of rates that change by 10 1/s^2. */
static void tied_and_swinging(void **state) {
    (void)state;
    for (int i = 0; i < 4; i++) {
        double q[2][7 * 6], v[2][6 * 6], a[2][6 * 6];
        int count[2] = {0, 0}, n;
        for (int k = 0; k < 2; k++) {
            mast m;
            swing_create(&m, 1, k ? 0.7 : 0, arm_fidelity[i / 2], i % 2);
            for (int step = 0; step < 40; step++) {
                OK(m.session, spar_step(m.session, 0.02, swing_fluid, &m, &n));
                count[k] += n;
            }
            OK(m.session, spar_member_get_motion(m.beam, q[k], v[k], a[k]));
            spar_session_destroy(&m.session);
        }
        print_message("swinging %d: %d and %d evaluations, turn %g, off by %.1e, %.1e of %.1e, %.1e of %.1e\n", i,
                      count[0], count[1], 2 * atan2(q[0][6], q[0][3]), distance(q[0], q[1], 42),
                      distance(v[0], v[1], 36), fabs(v[0][5]), distance(a[0], a[1], 36), fabs(a[0][5]));
        assert_true(fabs(2 * atan2(q[0][6], q[0][3])) > 1);
        NEAR(distance(q[0], q[1], 42), 0, 1e-9);
        NEAR(distance(v[0], v[1], 36), 0, i == 3 ? 5e-3 : 1e-8);
        NEAR(distance(a[0], a[1], 36), 0, 1e-6);
    }
}

/* Trials go back to the last bit, and make members anew, of other fidelities and nodes, with the guess: the advice of a
   session with a guess comes to pass and its answers are those of a session without (10 per cent of the motion, which
   is the tolerance that was asked for). */
static void trials(void **state) {
    (void)state;
    double report[TRY_COUNT], advice[ADVICE_COUNT], tip[2][7];
    for (int k = 0; k < 2; k++) {
        mast m;
        double dt = 0.01, table[SPAR_ROW_COUNT][COLUMN_COUNT];
        mast_create(&m, 2, k ? 2 : 0, SPAR_FIDELITY_EXACT);
        OK(m.session, spar_session_set_coupling(m.session, SPAR_COUPLING_IQN_ILS, 1e-9, 1e-7, 100));
        for (int i = 0; i < 5; i++) {
            OK(m.session, spar_step(m.session, dt, mast_fluid, &m, NULL));
        }
        double before[2][7 * 6];
        OK(m.session, spar_member_get_motion(m.beam, before[0], NULL, NULL));
        OK(m.session, trial_run(m.session, dt, 16, NULL, mast_fluid, &m, 0, report));
        OK(m.session, trial_report_effects(m.session, dt, 16, NULL, mast_fluid, &m, table[0]));
        OK(m.session, trial_advise(m.session, 0.1, dt, 32, 0.5, NULL, mast_fluid, &m, advice));
        OK(m.session, spar_member_get_motion(m.beam, before[1], NULL, NULL));
        assert_memory_equal(before[0], before[1], sizeof before[0]);
        OK(m.session, spar_trial_apply(trial_of(m.session), &dt));
        double t = 0;
        for (int i = 0; i < 400 && t < 0.5; i++) {
            OK(m.session, spar_step(m.session, fmin(dt, 0.01), mast_fluid, &m, NULL));
            OK(m.session, spar_session_get_time(m.session, &t, NULL, NULL));
        }
        scene_tip(m.beam, tip[k]);
        print_message("advised, tip %g at %g\n", tip[k][2], t);
        spar_session_destroy(&m.session);
    }
    NEAR(tip[1][2], tip[0][2], 0.1 * fabs(tip[0][2]));
}

/* What is given is read; what cannot be is refused with its reason, and changes nothing. */
static void refusals(void **state) {
    (void)state;
    static const double x[3] = {0, 0, 0}, q[4] = {1, 0, 0, 0}, J[3] = {1, 1, 1}, eta[3] = {0, 0.5, 1};
    double mass[36], K[36], A[3 * 36], got[4 * 36], where[4];
    int64_t n;
    spar_session *s = scene_session();
    spar_member *body, *beam, *point;
    scene_mass(mass, 1, x, J);
    scene_diagonal(K, 1, 1, 1, 1, 1, 1);
    for (int i = 0; i < 3; i++) {
        scene_diagonal(A + 36 * i, 1 + i, 2, 0, 0, 0, 0.5);
    }
    OK(s, spar_rigid_create(s, "body", x, q, mass, &body));
    OK(s, spar_point_create(s, "point", x, q, &point));
    beam = scene_beam(s, "beam", 1, 3, 1, K, K);
    OK(s, spar_member_get_added_mass(beam, &n, 0, NULL, NULL));
    assert_int_equal(n, 0);
    OK(s, spar_member_set_added_mass(beam, 3, eta, A));
    OK(s, spar_member_get_added_mass(beam, &n, 4, where, got));
    assert_int_equal(n, 3);
    assert_memory_equal(where, eta, sizeof eta);
    assert_memory_equal(got, A, sizeof A);
    assert_true(where[3] == 0 && got[3 * 36] == 0);
    OK(s, spar_member_set_added_mass(body, 1, NULL, A));
    const struct {
        spar_member *m;
        int64_t n;
        const double *eta;
        int at; /* this entry of the matrix is set to */
        double to;
        int status;
        const char *why;
    } bad[] = {{beam, -1, eta, 0, 1, SPAR_ERR_ARGUMENT, "stations"},
               {body, 2, eta, 0, 1, SPAR_ERR_ARGUMENT, "stations"},
               {beam, 1, NULL, 0, 1, SPAR_ERR_ARGUMENT, "eta is NULL"},
               {beam, 1, eta, 0, NAN, SPAR_ERR_ARGUMENT, "finite"},
               {beam, 1, eta, 0, -1, SPAR_ERR_ARGUMENT, "semidefinite"},
               {beam, 1, eta, 1, 0.3, SPAR_ERR_ARGUMENT, "symmetric"},
               {beam, 1, eta, 14, -1e-300, SPAR_ERR_ARGUMENT, "semidefinite"},
               {point, 1, eta, 0, 1, SPAR_ERR_UNSUPPORTED, "point"}};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        scene_diagonal(mass, 1, 2, 0, 0, 0, 0.5);
        mass[bad[k].at] = bad[k].to;
        assert_int_equal(spar_member_set_added_mass(bad[k].m, bad[k].n, bad[k].eta, mass), bad[k].status);
        assert_non_null(strstr(spar_session_message(s), bad[k].why));
    }
    scene_diagonal(mass, 1, 1, 1, 1, 1, 1);
    mass[1] = mass[6] = 1.5; /* symmetric, and not positive */
    assert_int_equal(spar_member_set_added_mass(body, 1, NULL, mass), SPAR_ERR_ARGUMENT);
    mass[1] = mass[6] = 1; /* on the edge */
    OK(s, spar_member_set_added_mass(body, 1, NULL, mass));
    assert_int_equal(spar_member_set_added_mass(body, 1, NULL, NULL), SPAR_ERR_ARGUMENT);
    OK(s, spar_member_get_added_mass(beam, &n, 3, where, got));
    assert_true(n == 3 && memcmp(got, A, sizeof A) == 0);
    OK(s, spar_member_set_external(beam, 1));
    assert_int_equal(spar_member_commit(beam), SPAR_ERR_UNSUPPORTED);
    assert_non_null(strstr(spar_session_message(s), "does not apply to prescribed members"));
    OK(s, spar_member_set_external(beam, 0));
    OK(s, spar_member_set_fidelity(beam, SPAR_FIDELITY_PRESCRIBED, 0));
    assert_int_equal(spar_member_commit(beam), SPAR_ERR_UNSUPPORTED);
    OK(s, spar_member_set_added_mass(beam, 0, NULL, NULL));
    OK(s, spar_member_commit(beam));
    OK(s, spar_member_commit(body));
    assert_int_equal(spar_member_set_added_mass(body, 0, NULL, NULL), SPAR_ERR_STATE);
    assert_int_equal(spar_member_get_added_mass(NULL, &n, 0, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_member_get_added_mass(body, &n, -1, NULL, NULL), SPAR_ERR_ARGUMENT);
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tied_members),
        cmocka_unit_test(tied_in_substeps),
        cmocka_unit_test(loads_are_the_fluids),
        cmocka_unit_test(bits),
        cmocka_unit_test(statics_and_longer_steps),
        cmocka_unit_test(tied_and_swinging),
        cmocka_unit_test(trials),
        cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
