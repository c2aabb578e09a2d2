/* Fidelities below the exact beam: each is the exact one's limit for small deformation, and skips its work. */
#include "scene.h"

#include <stdio.h>

#include "floating/frame.h"
#include "solve/rigid_beam.h"
#include "time/body_solver.h"

static double K[36], M[36];
static const double SPIN = 2, DT = 2e-3;

typedef struct answer {
    double q[7], reaction[6];
    spar_member *beam;
} answer;

/* A beam of the box section on a root that is fixed, or turns about z with SPIN; a load of `size` at its tip. */
static spar_session *turning(int fidelity, int64_t modes, int root, double size, const double g[3], spar_member **out) {
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 2, 6, 10, K, M);
    double load[6] = {0, 0.3 * size, size, 0.1 * size, 0, 0};
    const double x0[3] = {0}, omega[3] = {0, 0, root == SPAR_ROOT_DRIVEN ? SPIN : 0};
    if (g) {
        OK(s, spar_session_set_gravity(s, g));
    }
    OK(s, spar_member_set_root(b, root));
    OK(s, spar_member_set_fidelity(b, fidelity, modes));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_initial_velocity(b, x0, x0, omega));
    OK(s, spar_member_set_load(b, 11, SPAR_LOAD_DEAD, load));
    *out = b;
    return s;
}

static void drive(spar_session *s, spar_member *b, double t) {
    const double q[7] = {0, 0, 0, cos(0.5 * SPIN * t), 0, 0, sin(0.5 * SPIN * t)}, v[6] = {0, 0, 0, 0, 0, SPIN};
    OK(s, spar_member_drive(b, q, v, NULL));
}

static void run(spar_session *s, spar_member *b, int root, int n) {
    for (int k = 1; k <= n; k++) {
        if (root == SPAR_ROOT_DRIVEN) {
            drive(s, b, k * DT);
        }
        scene_run(s, DT, 1);
    }
}

/* The tip's deformation beyond `other`, after n steps */
static double distance(const double *a, const double *b) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static void tip_of(int fidelity, int64_t modes, int root, double size, int n, double q[7], double reaction[6]) {
    spar_member *b;
    spar_session *s = turning(fidelity, modes, root, size, NULL, &b);
    run(s, b, root, n);
    scene_tip(b, q);
    OK(s, spar_member_get_reaction(b, reaction));
    spar_session_destroy(&s);
}

/* Linear against exact, root fixed: their difference falls with the square of the load: relative to the load,
   in proportion to it (measured order 1.07). */
static void test_linear_at_rest(void **state) {
    (void)state;
    double q[2][7], r[6], d[2];
    for (int k = 0; k < 2; k++) {
        double size = k ? 5 : 50;
        for (int e = 0; e < 2; e++) {
            tip_of(e ? SPAR_FIDELITY_EXACT : SPAR_FIDELITY_LINEAR, 0, SPAR_ROOT_FIXED, size, 100, q[e], r);
        }
        d[k] = distance(q[0], q[1]) / size;
    }
    assert_true(log10(d[0] / d[1]) > 0.9);
}

/* On a root that turns, the answer to a load (the difference of runs with and without it, so that the centrifugal
   stretch drops out) is that of the exact beam to the order of the load, and what is left at small loads is the
   stiffening's own second order: 4e-4 here, where leaving the stiffening out makes 7e-2. */
static void test_linear_turning(void **state) {
    (void)state;
    double q[4][7], r[6];
    tip_of(SPAR_FIDELITY_EXACT, 0, SPAR_ROOT_DRIVEN, 0, 400, q[0], r);
    tip_of(SPAR_FIDELITY_EXACT, 0, SPAR_ROOT_DRIVEN, 0.01, 400, q[1], r);
    tip_of(SPAR_FIDELITY_LINEAR, 0, SPAR_ROOT_DRIVEN, 0, 400, q[2], r);
    tip_of(SPAR_FIDELITY_LINEAR, 0, SPAR_ROOT_DRIVEN, 0.01, 400, q[3], r);
    double exact = distance(q[1], q[0]), error = 0;
    for (int k = 0; k < 3; k++) {
        double e = (q[3][k] - q[2][k]) - (q[1][k] - q[0][k]);
        error += e * e;
    }
    assert_true(exact > 1e-6);
    assert_true(sqrt(error) < 1e-3 * exact);
    assert_true(distance(q[0], q[2]) < 1e-5); /* the stretch itself, to its square */
}

/* Modal with all its modes is the linear beam (other coordinates, the same equations); fewer modes come from above. */
static void test_all_modes_are_linear(void **state) {
    (void)state;
    double q[3][7], r[2][6];
    tip_of(SPAR_FIDELITY_LINEAR, 0, SPAR_ROOT_DRIVEN, 20, 200, q[0], r[0]);
    tip_of(SPAR_FIDELITY_MODAL, 60, SPAR_ROOT_DRIVEN, 20, 200, q[1], r[1]);
    tip_of(SPAR_FIDELITY_MODAL, 8, SPAR_ROOT_DRIVEN, 20, 200, q[2], r[1]);
    double still[7];
    spar_member *b;
    spar_session *s = turning(SPAR_FIDELITY_RIGID, 0, SPAR_ROOT_DRIVEN, 20, NULL, &b);
    run(s, b, SPAR_ROOT_DRIVEN, 200);
    scene_tip(b, still);
    spar_session_destroy(&s);
    double size = distance(q[0], still);
    assert_true(size > 1e-3);
    assert_true(distance(q[0], q[1]) < 1e-7 * size);
    assert_true(distance(q[0], q[2]) < 0.02 * size);
}

/* The same where nothing holds the root, or only its place; and the rigid-body motions alone are the rigid body, to the
   square of the turn (measured 0.99 for the order relative to the load). */
static void test_modal_free(void **state) {
    (void)state;
    for (int root = SPAR_ROOT_FREE; root <= SPAR_ROOT_PINNED; root += SPAR_ROOT_PINNED - SPAR_ROOT_FREE) {
        int held = root == SPAR_ROOT_FREE ? 0 : 3;
        double q[2][7], r[2][6], d[2];
        tip_of(SPAR_FIDELITY_LINEAR, 0, root, 2, 200, q[0], r[0]);
        tip_of(SPAR_FIDELITY_MODAL, 66 - held, root, 2, 200, q[1], r[1]);
        assert_true(fabs(q[0][2]) > 0.1);
        for (int i = 0; i < 7; i++) {
            NEAR(q[1][i], q[0][i], 1e-8);
        }
        for (int i = 0; i < 6; i++) {
            NEAR(r[1][i], r[0][i], 1e-6);
            assert_true(i < held ? r[0][i] != 0 || i == 0 : r[0][i] == 0);
        }
        for (int k = 0; k < 2; k++) {
            double size = k ? 0.005 : 0.05;
            tip_of(SPAR_FIDELITY_RIGID, 0, root, size, 100, q[0], r[0]);
            tip_of(SPAR_FIDELITY_MODAL, 6 - held, root, size, 100, q[1], r[1]);
            d[k] = distance(q[0], q[1]) / size;
            assert_true(fabs(q[0][2]) > 1e-2 * size);
        }
        assert_true(log10(d[0] / d[1]) > 0.9);
    }
}

/* A slender beam that nothing holds, and one that hangs in a ball joint, whose modes have a closed form: (beta L)^2
   sqrt(EI / rho A) / (2 pi L^2). Shear and rotary inertia, left out there, change them by 1e-5 at
   most. */
static void test_free_frequencies(void **state) {
    (void)state;
    static const struct {
        int root, rigid;
        double beta[3];
    } cases[2] = {{SPAR_ROOT_FREE, 6, {4.730040744862704, 7.853204624095838, 10.995607838001671}},
                  {SPAR_ROOT_PINNED, 3, {3.926602312047919, 7.068582745628732, 10.210176122813031}}};
    double C[36], mass[36], f[12];
    scene_diagonal(C, 1e8, 1e8, 1e8, 1e7, 1e3, 1e3);
    scene_diagonal(mass, 1, 1, 1, 2e-6, 1e-6, 1e-6);
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "b", 1, 18, 10, C, mass);
        OK(s, spar_member_set_root(b, cases[k].root));
        OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_MODAL, cases[k].rigid + 6));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_solve_modes(b, cases[k].rigid + 6, f, NULL));
        assert_int_equal(spar_member_solve_modes(b, cases[k].rigid + 7, f, NULL), SPAR_ERR_ARGUMENT);
        for (int i = 0; i < cases[k].rigid; i++) {
            NEAR(f[i], 0, 1e-6);
        }
        for (int i = 0; i < 6; i++) { /* two planes */
            double beta = cases[k].beta[i / 2], exact = beta * beta * sqrt(1e3) / (6.283185307179586 * 100);
            NEAR(f[cases[k].rigid + i], exact, 1e-5 * exact);
        }
        spar_session_destroy(&s);
    }
}

/* Falls and flies as a free body: v t + g t^2 / 2, exact for this integrator, without strain and with its energy. */
static void test_modal_falls(void **state) {
    (void)state;
    const double g[3] = {0, 1, -9.81}, v[3] = {0.5, 0, 1}, x0[3] = {5, 0, 0}, spin[3] = {0, 0.2, 0};
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 2, 5, 10, K, M);
    double q[10][7], e[2][4], work[3], t = 0.5;
    OK(s, spar_session_set_gravity(s, g));
    OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
    OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_MODAL, 12));
    OK(s, spar_member_set_effects(b, SPAR_EFFECT_WORK, 0));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_initial_velocity(b, x0, v, spin));
    OK(s, spar_member_get_work(b, 3, work));
    OK(s, spar_member_get_energy(b, 4, e[0]));
    assert_int_equal(spar_member_solve_static(b, 1), SPAR_ERR_STATE);
    scene_run(s, 1e-2, 50);
    OK(s, spar_member_get_motion(b, q[0], NULL, NULL));
    for (int i = 0; i < 10; i++) {
        double place[30];
        OK(s, spar_member_get_reference(b, place, NULL));
        NEAR(q[i][0], v[0] * t, 1e-11);
        NEAR(q[i][1], g[1] * t * t / 2, 1e-11);
        NEAR(q[i][2], v[2] * t + g[2] * t * t / 2 - spin[1] * t * (place[3 * i] - 5), 1e-11);
        NEAR(q[i][5], sin(0.5 * spin[1] * t), 1e-11);
    }
    OK(s, spar_member_get_energy(b, 4, e[1]));
    NEAR(e[1][1], 0, 1e-15);
    NEAR(e[1][0] + e[1][2], e[0][0], 1e-12 * e[0][0]);
    spar_session_destroy(&s);
}

/* A rigid beam that hangs in a ball joint is a pendulum: omega^2 = m g c / I; with a dead load down at its tip instead
   of a weight F L / I. Nothing in it can swing otherwise. */
static void test_rigid_modes(void **state) {
    (void)state;
    const double g[3] = {9.81, 0, 0}, none[3] = {0}, load[6] = {3, 0, 0, 0, 0, 0};
    double m = 10 * M[0], f[3], shape[3][12][6];
    for (int k = 0; k < 2; k++) {
        spar_member *b;
        spar_session *s = turning(SPAR_FIDELITY_RIGID, 0, SPAR_ROOT_PINNED, 0, k ? none : g, &b);
        if (k) {
            OK(s, spar_member_set_load(b, 11, SPAR_LOAD_DEAD, load));
        }
        OK(s, spar_member_solve_modes(b, 3, f, &shape[0][0][0]));
        NEAR(f[0], 0, 1e-7);                                                    /* about its own axis */
        double swing[2] = {m * 100 / 3 + 10 * M[35], m * 100 / 3 + 10 * M[28]}; /* about z, about y */
        for (int i = 0; i < 2; i++) {
            double expected = sqrt((k ? 3 * 10 : m * 9.81 * 5) / swing[i]) / 6.283185307179586;
            NEAR(f[1 + i], expected, 1e-9 * expected);
            NEAR(fabs(shape[1 + i][11][1 + i]), 10 / sqrt(swing[i]), 1e-9); /* y, then z, of unit modal mass */
            NEAR(shape[1 + i][0][1 + i], 0, 1e-14);
        }
        assert_int_equal(spar_member_solve_modes(b, 4, f, NULL), SPAR_ERR_ARGUMENT);
        spar_session_destroy(&s);
    }
}

/* Rigid against exact with the stiffness scaled up: the pendulum of a pinned beam under gravity and a tip load. The
   difference is the elastic deformation, which falls as 1 / stiffness, in the motion as in reaction, energy and work.
 */
static void test_rigid_is_the_stiff_limit(void **state) {
    (void)state;
    const double g[3] = {0, 0, -9.81};
    double q[2][7], d[2], r[2][6], e[2][4], work[2][3], other[2];
    for (int k = 0; k < 2; k++) {
        double stiff[36];
        for (int c = 0; c < 36; c++) {
            stiff[c] = (k ? 1e2 : 1e1) * K[c];
        }
        for (int i = 0; i < 2; i++) {
            spar_session *s = scene_session();
            spar_member *b = scene_beam(s, "b", 1, 6, 10, stiff, M);
            double load[6] = {0, 0.5, 0.2, 0, 0, 0};
            OK(s, spar_session_set_gravity(s, g));
            OK(s, spar_session_set_integrator(s, 0.0, 1));
            OK(s, spar_member_set_root(b, SPAR_ROOT_PINNED));
            OK(s, spar_member_set_fidelity(b, i ? SPAR_FIDELITY_EXACT : SPAR_FIDELITY_RIGID, 0));
            OK(s, spar_member_set_effects(b, SPAR_EFFECT_WORK, 0));
            OK(s, spar_member_commit(b));
            OK(s, spar_member_set_load(b, 5, SPAR_LOAD_DEAD, load));
            OK(s, spar_member_get_work(b, 3, work[i]));
            scene_run(s, 1e-3, 500);
            scene_tip(b, q[i]);
            OK(s, spar_member_get_reaction(b, r[i]));
            OK(s, spar_member_get_energy(b, 4, e[i]));
            OK(s, spar_member_get_work(b, 3, work[i]));
            spar_session_destroy(&s);
        }
        assert_true(fabs(q[0][2]) > 0.5); /* it has swung */
        d[k] = distance(q[0], q[1]);
        assert_true(e[0][1] == 0 && r[0][3] == 0);
        other[k] = fmax(distance(r[0], r[1]) / fabs(r[1][2]), fabs(work[0][0] - work[1][0]) / fabs(work[1][0]));
        other[k] = fmax(other[k], fmax(fabs(e[0][0] / e[1][0] - 1), fabs(e[0][2] / e[1][2] - 1)));
    }
    assert_true(other[0] < 0.1); /* the reaction rings */
    assert_true(other[1] < 0.2 * other[0]);
    assert_true(d[0] < 1e-2);
    assert_true(d[1] < 0.2 * d[0]);
}

/* A free rigid beam of mass m under a tip force F: its centre moves as F t^2 / 2 m whatever it turns; and the mass is
   the section's times the length. */
static void test_rigid_free_centre(void **state) {
    (void)state;
    double m = 10 * M[0], F = 0.5, load[6] = {0, 0, F, 0, 0, 0}, q[7], t = 0.5;
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, 6, 10, K, M);
    OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
    OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_RIGID, 0));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_set_load(b, 5, SPAR_LOAD_DEAD, load));
    scene_run(s, 1e-3, 500);
    scene_tip(b, q);
    double c[3] = {-5, 0, 0}, r[3]; /* from the tip to the centre */
    spari_rotate(q + 3, c, r);
    NEAR(q[2] + r[2], F * t * t / (2 * m), 1e-6 * F * t * t / m);
    NEAR(10 + q[0] + r[0], 5, 1e-6);
    const spari_rigid_beam *kept = b->solution;
    assert_int_equal(kept->solver->n, 1);
    spar_session_destroy(&s);
}

/* The support bears what is left: with all loads and the inertia of the turning mass. At rest the reaction of every
   fidelity is minus the loads and the weight; on a turning root the rigid one needs m omega^2 r_c towards the axis. */
static void test_reactions(void **state) {
    (void)state;
    const double g[3] = {0, 0, -9.81};
    const int fidelities[] = {SPAR_FIDELITY_RIGID, SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL};
    double m = 10 * M[0], r[6], q[7];
    for (int k = 0; k < 3; k++) {
        spar_member *b;
        spar_session *s = turning(fidelities[k], 6, SPAR_ROOT_FIXED, 2, g, &b);
        OK(s, spar_member_solve_static(b, 1));
        OK(s, spar_member_get_reaction(b, r));
        NEAR(r[1], -0.6, 1e-9);
        NEAR(r[2], -2 + m * 9.81, 1e-9);
        NEAR(r[0], 0, 1e-6);
        spar_session_destroy(&s);
    }
    spar_session *s;
    spar_member *b;
    s = turning(SPAR_FIDELITY_RIGID, 0, SPAR_ROOT_DRIVEN, 0, NULL, &b);
    run(s, b, SPAR_ROOT_DRIVEN, 100);
    OK(s, spar_member_get_reaction(b, r));
    NEAR(r[0] * cos(SPIN * 0.2) + r[1] * sin(SPIN * 0.2), -m * SPIN * SPIN * 5, 1e-9);
    spar_session_destroy(&s);
    s = turning(SPAR_FIDELITY_PRESCRIBED, 0, SPAR_ROOT_DRIVEN, 2, g, &b);
    run(s, b, SPAR_ROOT_DRIVEN, 100);
    OK(s, spar_member_get_reaction(b, r));
    scene_tip(b, q);
    NEAR(r[2], -2, 1e-14); /* no mass */
    NEAR(q[0], 10 * cos(SPIN * 0.2) - 10, 1e-13);
    NEAR(r[5], -(10 * cos(SPIN * 0.2) * 0.6), 1e-12);
    spar_session_destroy(&s);
}

/* Linear statics of a cantilever: w = F L^3 / 3 EI + F L / GA with one load, exactly, and gravity as w = q L^4 / 8 EI +
 * q L^2 / 2 GA. */
static void test_linear_static(void **state) {
    (void)state;
    double C[36], D[36], L = 10, EI = 5e4, GA = 4e4, m = 0.1, g[3] = {0, 0, -9.81}, load[6] = {0, 0, 10, 0, 0, 0}, q[7];
    scene_diagonal(C, 1e6, GA, GA, 2e4, EI, EI);
    scene_diagonal(D, m, m, m, 0.1, 0.05, 0.05);
    for (int gravity = 0; gravity < 2; gravity++) {
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "b", 2, 6, L, C, D);
        OK(s, spar_session_set_gravity(s, g));
        OK(s, spar_member_set_effects(b, EFFECTS_ONLY(gravity ? SPAR_EFFECT_GRAVITY : 0)));
        OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_LINEAR, 0));
        OK(s, spar_member_commit(b));
        load[2] = gravity ? 0 : 10;
        OK(s, spar_member_set_load(b, 11, SPAR_LOAD_DEAD, load));
        OK(s, spar_member_solve_static(b, 1));
        scene_tip(b, q);
        double w =
            gravity ? -m * 9.81 * (L * L * L * L / (8 * EI) + L * L / (2 * GA)) : 10 * (L * L * L / (3 * EI) + L / GA);
        NEAR(q[2], w, 1e-11 * fabs(w));
        spar_session_destroy(&s);
    }
}

/* Work that is skipped: no solver and no body where nothing is solved; one factorisation while the speed and dt stay,
   and one solution per step. */
static void test_skipped_work(void **state) {
    (void)state;
    spar_member *b;
    spar_session *s = turning(SPAR_FIDELITY_PRESCRIBED, 0, SPAR_ROOT_DRIVEN, 2, NULL, &b);
    assert_null(b->solution);
    assert_null(b->body);
    spar_session_destroy(&s);
    for (int modal = 0; modal < 2; modal++) {
        s = turning(modal ? SPAR_FIDELITY_MODAL : SPAR_FIDELITY_LINEAR, 4, SPAR_ROOT_DRIVEN, 2, NULL, &b);
        run(s, b, SPAR_ROOT_DRIVEN, 1);
        const spari_frame *f = b->solution;
        int64_t factors = f->factors, solves = f->solves;
        assert_int_equal(f->n, modal ? 10 : 66);
        run(s, b, SPAR_ROOT_DRIVEN, 50);
        assert_int_equal(f->factors, factors);
        assert_in_range(f->solves - solves, 50, 100); /* where the speed's last bits change, a second */
        spar_session_destroy(&s);
    }
}

/* Rollback and substeps: a rejected step leaves no trace; two substeps of dt are two steps of dt / 2 under a load that
   stands. */
static void test_reject_and_substeps(void **state) {
    (void)state;
    const int fidelities[] = {SPAR_FIDELITY_RIGID, SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL};
    for (int k = 0; k < 3; k++) {
        double q[2][7];
        for (int way = 0; way < 2; way++) {
            spar_member *b;
            int root = fidelities[k] == SPAR_FIDELITY_RIGID ? SPAR_ROOT_PINNED : SPAR_ROOT_FIXED;
            spar_session *s = turning(fidelities[k], 6, root, 2, NULL, &b);
            if (way) {
                OK(s, spar_session_set_integrator(s, 0.9, 2));
            }
            for (int n = 0; n < (way ? 20 : 40); n++) {
                OK(s, spar_step_begin(s, way ? 2 * DT : DT));
                OK(s, spar_step_solve(s));
                if (n == 7) {
                    OK(s, spar_step_reject(s));
                    OK(s, spar_step_begin(s, way ? 2 * DT : DT));
                    OK(s, spar_step_solve(s));
                    OK(s, spar_step_solve(s));
                }
                OK(s, spar_step_accept(s));
            }
            scene_tip(b, q[way]);
            spar_session_destroy(&s);
        }
        for (int i = 0; i < 7; i++) {
            NEAR(q[0][i], q[1][i], 1e-11);
        }
    }
}

/* Damping acts on the deformation only, energy tells where it went. */
static void test_energy(void **state) {
    (void)state;
    double e[2][4], mu[6] = {1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3}, load[6] = {0, 0, 5, 0, 0, 0}, none[6] = {0};
    for (int modal = 0; modal < 2; modal++) {
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "b", 1, 8, 10, K, M);
        OK(s, spar_beam_set_damping(b, mu));
        OK(s, spar_member_set_fidelity(b, modal ? SPAR_FIDELITY_MODAL : SPAR_FIDELITY_LINEAR, 5));
        OK(s, spar_member_commit(b));
        OK(s, spar_session_set_integrator(s, 1, 1));
        OK(s, spar_member_set_load(b, 7, SPAR_LOAD_DEAD, load));
        OK(s, spar_member_solve_static(b, 1));
        OK(s, spar_member_set_load(b, 7, SPAR_LOAD_DEAD, none));
        OK(s, spar_member_get_energy(b, 4, e[0]));
        scene_run(s, 1e-3, 400);
        OK(s, spar_member_get_energy(b, 4, e[1]));
        assert_true(e[1][3] > 0.01 * e[0][1]);
        NEAR(e[1][0] + e[1][1] + e[1][3], e[0][1], 2e-3 * e[0][1]);
        spar_session_destroy(&s);
    }
}

/* A root that starts suddenly, its accelerations not given: the nodes keep the velocity they have, in every fidelity
   that bends. Without that the frame would take the whole beam along at once, and its tip be off by a third. */
static void test_sudden_start(void **state) {
    (void)state;
    const int fidelities[] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL};
    double tip[3][7];
    for (int k = 0; k < 3; k++) {
        spar_member *b;
        spar_session *s = turning(fidelities[k], 12, SPAR_ROOT_DRIVEN, 0.1, NULL, &b);
        const double none[3] = {0};
        OK(s, spar_member_set_initial_velocity(b, none, none, none));
        for (int i = 1; i <= 50; i++) {
            const double q[7] = {0, 0, 2e-4 * i, 1, 0, 0, 0}, v[6] = {0, 0, 0.1, 0, 0, 0};
            OK(s, spar_member_drive(b, q, v, NULL));
            scene_run(s, DT, 1);
        }
        scene_tip(b, tip[k]);
        spar_session_destroy(&s);
    }
    double off = fabs(tip[0][2] - 0.01); /* what it has beyond the root */
    assert_true(off > 1e-3);
    NEAR(tip[1][2], tip[0][2], 0.01 * off);
    NEAR(tip[2][2], tip[0][2], 0.1 * off);
}

/* Saved and loaded in the middle of a run, each fidelity goes on with the same bits. */
static void test_saved(void **state) {
    (void)state;
    const char *path = "test_fidelity.state";
    for (int root = SPAR_ROOT_FREE; root <= SPAR_ROOT_DRIVEN; root++) {
        int given = root == SPAR_ROOT_DRIVEN || root == SPAR_ROOT_FIXED;
        for (int fidelity = given ? SPAR_FIDELITY_PRESCRIBED : SPAR_FIDELITY_RIGID; fidelity <= SPAR_FIDELITY_EXACT;
             fidelity++) {
            double q[2][7];
            for (int way = 0; way < 2; way++) {
                spar_member *b;
                spar_session *s = turning(fidelity, 9, root, 2, NULL, &b);
                if (way == 0) {
                    run(s, b, root, 20);
                    OK(s, spar_session_save(s, path));
                } else {
                    OK(s, spar_session_load(s, path));
                }
                for (int k = 21; k <= 40; k++) {
                    if (root == SPAR_ROOT_DRIVEN) {
                        drive(s, b, k * DT);
                    }
                    scene_run(s, DT, 1);
                }
                scene_tip(b, q[way]);
                spar_session_destroy(&s);
            }
            assert_memory_equal(q[0], q[1], sizeof q[0]);
        }
    }
    remove(path);
}

static void test_refusals(void **state) {
    (void)state;
    spar_session *s = scene_session();
    spar_member *b = scene_beam(s, "b", 1, 4, 10, K, M), *p;
    OK(s, spar_point_create(s, "p", NULL, NULL, &p));
    assert_int_equal(spar_member_set_fidelity(NULL, 0, 0), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_member_set_fidelity(b, 5, 0), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_member_set_fidelity(b, SPAR_FIDELITY_MODAL, 0), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_member_set_fidelity(p, SPAR_FIDELITY_RIGID, 0), SPAR_ERR_ARGUMENT);
    OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_MODAL, 19));
    assert_int_equal(spar_member_commit(b), SPAR_ERR_ARGUMENT); /* it has 18 */
    OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_MODAL, 3));
    OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
    assert_int_equal(spar_member_commit(b), SPAR_ERR_ARGUMENT); /* 6 are those of a rigid body */
    OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_MODAL, 25));
    assert_int_equal(spar_member_commit(b), SPAR_ERR_ARGUMENT); /* it has 24 */
    OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_LINEAR, 0));
    OK(s, spar_member_set_effects(b, EFFECTS_ONLY(0)));
    assert_int_equal(spar_member_commit(b), SPAR_ERR_STATE); /* neither inertia nor a support */
    OK(s, spar_member_set_fidelity(b, SPAR_FIDELITY_PRESCRIBED, 0));
    assert_int_equal(spar_member_commit(b), SPAR_ERR_STATE);
    OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
    OK(s, spar_member_commit(b)); /* a refusal leaves all as it was */
    assert_int_equal(spar_member_set_fidelity(b, SPAR_FIDELITY_EXACT, 0), SPAR_ERR_STATE);
    spar_session_destroy(&s);
}

static spar_member *light_beam(spar_session *s, int fidelity, int effects, int root) {
    spar_member *b = scene_beam(s, "beam", 2, 4, 10, K, M);
    OK(s, spar_member_set_fidelity(b, fidelity, 4));
    OK(s, spar_member_set_effects(b, EFFECTS_ONLY(effects)));
    OK(s, spar_member_set_root(b, root));
    OK(s, spar_member_commit(b));
    return b;
}

/* Rigid and modal members with no effect that asks for mass: they stand, or follow their root, and a modal one bends as
   a static one does. u = F L^3 / (3 EI) is met by the first modes to a per cent or so; here: that it is there and the
   same in every step, for no inertia keeps anything. */
static void test_no_inertia_no_weight(void **state) {
    (void)state;
    const int none = 0, roots[] = {SPAR_ROOT_FIXED, SPAR_ROOT_DRIVEN};
    const double load[6] = {0, 0, 3, 0, 0, 0};
    for (int k = 0; k < 4; k++) {
        spar_session *s = scene_session();
        double first[7], tip[7], energy[4];
        int fidelity = k / 2 ? SPAR_FIDELITY_MODAL : SPAR_FIDELITY_RIGID;
        spar_member *b = light_beam(s, fidelity, none, roots[k % 2]);
        OK(s, spar_member_set_load(b, 7, SPAR_LOAD_DEAD, load));
        scene_run(s, 0.1, 1);
        scene_tip(b, first);
        scene_run(s, 0.1, 3);
        scene_tip(b, tip);
        NEAR(tip[2], first[2], 1e-13);
        assert_true(fidelity == SPAR_FIDELITY_RIGID ? tip[2] == 0 : tip[2] > 1e-4);
        OK(s, spar_member_get_energy(b, 4, energy));
        assert_true(energy[0] == 0 && energy[2] == 0);
        spar_session_destroy(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_linear_at_rest),
        cmocka_unit_test(test_linear_static),
        cmocka_unit_test(test_linear_turning),
        cmocka_unit_test(test_all_modes_are_linear),
        cmocka_unit_test(test_modal_free),
        cmocka_unit_test(test_free_frequencies),
        cmocka_unit_test(test_modal_falls),
        cmocka_unit_test(test_rigid_modes),
        cmocka_unit_test(test_rigid_is_the_stiff_limit),
        cmocka_unit_test(test_rigid_free_centre),
        cmocka_unit_test(test_reactions),
        cmocka_unit_test(test_skipped_work),
        cmocka_unit_test(test_reject_and_substeps),
        cmocka_unit_test(test_energy),
        cmocka_unit_test(test_sudden_start),
        cmocka_unit_test(test_saved),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_no_inertia_no_weight),
    };
    scene_box(K, M);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
