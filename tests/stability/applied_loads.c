/* Loads that the host gives are of order 2 in dt with any number of substeps, and in steps of any length: what is given
   before a step is the value at its end, and between the value of the step before and this one the load is linear (as a
   fluid's). Each kind of load follows a sine; the motion at 1 s is compared with that of one substep and 1/32 of dt. */
#include "scene.h"

#include <math.h>
#include <stdio.h>

enum { NODES = 5, END = NODES - 1 };

/* What bears the load, and how the load is given. */
typedef enum what { BODY, EXACT, LINEAR, MODAL, RIGID } what;
typedef enum load { DEAD, FOLLOWER, LINE_DEAD, LINE_FOLLOWER, MOTOR, GRAVITY } load;

typedef struct scene {
    spar_session *session;
    spar_member *member;
    spar_joint *hinge;
} scene;

static void body_create(scene *p) {
    static const double x[3] = {0}, J[3] = {0.5, 0.7, 0.9};
    p->member = scene_body(p->session, "body", x, 2, J);
    p->hinge = scene_joint_at(p->session, "hinge", p->member, 0, NULL, 0, SPAR_FREE_RZ | SPAR_FREE_X | SPAR_FREE_Y, x);
    double K[36];
    scene_diagonal(K, 30, 40, 0, 0, 0, 5);
    OK(p->session, spar_joint_set_spring(p->hinge, K, NULL, NULL));
}

static void beam_create(scene *p, what of) {
    static const int fidelity[] = {[EXACT] = SPAR_FIDELITY_EXACT,
                                   [LINEAR] = SPAR_FIDELITY_LINEAR,
                                   [MODAL] = SPAR_FIDELITY_MODAL,
                                   [RIGID] = SPAR_FIDELITY_RIGID};
    static const double mu[6] = {0.01, 0.01, 0.01, 0.01, 0.01, 0.01};
    double K[36], M[36];
    spar_session *s = p->session;
    scene_diagonal(K, 1e3, 1e3, 1e3, 60, 20, 20);
    scene_diagonal(M, 1, 1, 1, 0.1, 0.05, 0.05);
    p->member = scene_beam(s, "beam", 1, NODES, 1, K, M);
    OK(s, spar_beam_set_damping(p->member, mu)); /* of what the steps do not resolve */
    OK(s, spar_member_set_fidelity(p->member, fidelity[of], of == MODAL ? 3 : 0));
    if (of == RIGID) {
        OK(s, spar_member_set_root(p->member, SPAR_ROOT_FREE));
    }
    OK(s, spar_member_commit(p->member));
    if (of == RIGID) {
        static const double x[3] = {0};
        p->hinge = scene_joint_at(s, "hinge", p->member, 0, NULL, 0, SPAR_FREE_RZ, x);
        scene_diagonal(K, 0, 0, 0, 0, 0, 8);
        OK(s, spar_joint_set_spring(p->hinge, K, NULL, NULL));
    }
}

static scene create(what of, int substeps) {
    scene p = {.session = scene_session()};
    OK(p.session, spar_session_set_integrator(p.session, 0.9, substeps));
    if (of == BODY) {
        body_create(&p);
    } else {
        beam_create(&p, of);
    }
    return p;
}

/* The value at the time t. */
static void give(const scene *p, load kind, double t) {
    static const double eta[2] = {0, 1};
    spar_session *s = p->session;
    double f = pow(sin(2.5 * t), 4), node[6] = {0.5 * f, 3 * f, 0, 0, 0, 0.7 * f}, g[3] = {0.5 * f, 4 * f, 0},
           line[12] = {0, 4 * f, 0, 0, 0, 0, f, 2 * f, 0, 0, 0, 0.5 * f}, motor[6] = {0, 0, 0, 0, 0, 2 * f};
    int64_t n;
    OK(s, spar_member_get_count(p->member, &n));
    if (kind == DEAD || kind == FOLLOWER) {
        OK(s, spar_member_set_load(p->member, n - 1, kind == DEAD ? SPAR_LOAD_DEAD : SPAR_LOAD_FOLLOWER, node));
    } else if (kind == LINE_DEAD || kind == LINE_FOLLOWER) {
        OK(s,
           spar_beam_set_line_load(p->member, kind == LINE_DEAD ? SPAR_LOAD_DEAD : SPAR_LOAD_FOLLOWER, 2, eta, line));
    } else if (kind == MOTOR) {
        OK(s, spar_joint_set_load(p->hinge, motor));
    } else {
        OK(s, spar_session_set_gravity(s, g));
    }
}

/* The motion of the last node, and its velocity, at 1 s. Steps are dt (1 +- uneven) in turns. */
static void motion_at_end(what of, load kind, int substeps, int steps, double uneven, double x[13]) {
    scene p = create(of, substeps);
    double t = 0, v[6 * NODES], q[7 * NODES];
    int64_t n;
    give(&p, kind, 0);
    for (int i = 0; i < steps; i++) {
        double dt = (i % 2 ? 1 - uneven : 1 + uneven) / steps;
        t += dt;
        give(&p, kind, t);
        scene_run(p.session, dt, 1);
    }
    OK(p.session, spar_member_get_count(p.member, &n));
    OK(p.session, spar_member_get_motion(p.member, q, v, NULL));
    memcpy(x, q + 7 * (n - 1), 7 * sizeof *x);
    memcpy(x + 7, v + 6 * (n - 1), 6 * sizeof *x);
    spar_session_destroy(&p.session);
}

static double error_of(what of, load kind, int substeps, int steps, double uneven, const double exact[13]) {
    double x[13], sum = 0;
    motion_at_end(of, kind, substeps, steps, uneven, x);
    for (int k = 0; k < 13; k++) {
        sum = hypot(sum, x[k] - exact[k]);
    }
    return sum;
}

static const struct {
    what of;
    load kind;
    const char *name;
} cases[] = {{BODY, DEAD, "body, dead"},
             {BODY, FOLLOWER, "body, follower"},
             {BODY, MOTOR, "body, motor"},
             {BODY, GRAVITY, "body, gravity"},
             {EXACT, DEAD, "beam, dead"},
             {EXACT, FOLLOWER, "beam, follower"},
             {EXACT, LINE_DEAD, "beam, line"},
             {EXACT, LINE_FOLLOWER, "beam, line that follows"},
             {EXACT, GRAVITY, "beam, gravity"},
             {LINEAR, DEAD, "linear beam, dead"},
             {LINEAR, LINE_FOLLOWER, "linear beam, line that follows"},
             {LINEAR, GRAVITY, "linear beam, gravity"},
             {MODAL, LINE_DEAD, "modal beam, line"},
             {MODAL, GRAVITY, "modal beam, gravity"},
             {RIGID, DEAD, "rigid beam on a hinge, dead"},
             {RIGID, MOTOR, "rigid beam on a hinge, motor"},
             {RIGID, GRAVITY, "rigid beam on a hinge, gravity"}};
enum { CASES = sizeof cases / sizeof *cases };

static void order_two_with_substeps(void **state) {
    (void)state;
    enum { STEPS = 100 };
    int bad = 0;
    for (int c = 0; c < CASES; c++) {
        double exact[13], one = 0;
        motion_at_end(cases[c].of, cases[c].kind, 1, 32 * STEPS, 0, exact);
        for (int k = 0; k < 6; k++) {
            int substeps = 1 << k % 3;
            double uneven = k < 3 ? 0 : 0.3;
            double whole = error_of(cases[c].of, cases[c].kind, substeps, STEPS, uneven, exact),
                   half = error_of(cases[c].of, cases[c].kind, substeps, 2 * STEPS, uneven, exact),
                   order = log2(whole / half);
            one = k % 3 == 0 ? whole : one;
            int wrong = fabs(order - 2) > 0.25 || whole > 2 * one;
            print_message("%s%-40s%s %d substeps: %.2e, order %.2f\n", wrong ? "BAD " : "", cases[c].name,
                          k < 3 ? "" : ", uneven", substeps, whole, order);
            bad += wrong;
        }
    }
    assert_int_equal(bad, 0);
}

/* Two runs have come to the same state. */
static void assert_same(const scene *a, const scene *b, double tolerance) {
    double q[2][7 * NODES], v[2][6 * NODES], f[2][6 * NODES];
    int64_t n;
    OK(a->session, spar_member_get_count(a->member, &n));
    OK(a->session, spar_member_get_motion(a->member, q[0], v[0], NULL));
    OK(b->session, spar_member_get_motion(b->member, q[1], v[1], NULL));
    OK(a->session, spar_member_get_loads(a->member, f[0]));
    OK(b->session, spar_member_get_loads(b->member, f[1]));
    for (int64_t i = 0; i < 6 * n; i++) {
        NEAR(q[0][7 * (i / 6) + i % 6], q[1][7 * (i / 6) + i % 6], tolerance);
        NEAR(v[0][i], v[1][i], 10 * tolerance);
        NEAR(f[0][i], f[1][i], 100 * tolerance);
    }
}

/* A step that is tried with another load and another dt and rejected leaves no trace, and a file that is written
   between a load and its step has both ends of the ramp: the same bits. */
static void rejected_and_loaded(void **state) {
    (void)state;
    enum { STEPS = 8 };
    const double dt = 0.03;
    char path[64];
    (void)snprintf(path, sizeof path, "applied_loads_%d.spar", 1);
    for (int c = 0; c < CASES; c++) {
        load kind = cases[c].kind;
        scene p = create(cases[c].of, 3), rejected = create(cases[c].of, 3), loaded = create(cases[c].of, 3);
        for (int i = 1; i <= STEPS; i++) {
            give(&p, kind, 0.2 + i * dt);
            if (i == STEPS) {
                OK(p.session, spar_session_save(p.session, path));
            }
            scene_run(p.session, dt, 1);
            give(&rejected, kind, 3 + i * dt);
            OK(rejected.session, spar_step_begin(rejected.session, 0.6 * dt));
            OK(rejected.session, spar_step_solve(rejected.session));
            OK(rejected.session, spar_step_reject(rejected.session));
            give(&rejected, kind, 0.2 + i * dt);
            scene_run(rejected.session, dt, 1);
        }
        assert_same(&p, &rejected, 1e-10);
        if (kind == GRAVITY) { /* a setting, which files do not have; what it was is in the file */
            give(&loaded, kind, 0.2 + STEPS * dt);
        }
        OK(loaded.session, spar_session_load(loaded.session, path));
        scene_run(loaded.session, dt, 1);
        assert_same(&p, &loaded, 0);
        spar_session_destroy(&p.session);
        spar_session_destroy(&rejected.session);
        spar_session_destroy(&loaded.session);
    }
    (void)remove(path);
}

/* A load that is taken away, after a step that had it, is there at the beginning of the next one: a mass 2 at rest on
   nothing gets (1 + 1/2) dt F / 2 of velocity from two steps, the second without it. Before the first step it is gone
   at once. One substep and 4. */
static void taken_away(void **state) {
    (void)state;
    static const double x[3] = {0}, J[3] = {1, 1, 1}, F[6] = {3}, none[6] = {0};
    for (int substeps = 1; substeps <= 4; substeps += 3) {
        for (int after = 0; after < 2; after++) {
            scene p = {.session = scene_session()};
            double v[6], dt = 0.1;
            OK(p.session, spar_session_set_integrator(p.session, 1, substeps));
            p.member = scene_body(p.session, "body", x, 2, J);
            OK(p.session, spar_member_set_load(p.member, 0, SPAR_LOAD_DEAD, F));
            scene_run(p.session, dt, after);
            OK(p.session, spar_member_set_load(p.member, 0, SPAR_LOAD_DEAD, none));
            scene_run(p.session, dt, 1);
            OK(p.session, spar_member_get_motion(p.member, NULL, v, NULL));
            NEAR(v[0], after ? 1.5 * dt * F[0] / 2 : 0, 1e-14);
            spar_session_destroy(&p.session);
        }
    }
}

/* The work that accounts have of the load less the energy gained, after 1 s. */
static double defect(load kind, int steps) {
    static const double x[3] = {0}, J[3] = {0.5, 0.7, 0.9};
    scene p = {.session = scene_session()};
    spar_session *s = p.session;
    double K[36], M[36], work[SPAR_WORK_COUNT], energy[SPAR_ENERGY_COUNT], of_joint[SPAR_JOINT_ENERGY_COUNT];
    OK(s, spar_session_set_integrator(s, 1, 2));
    scene_mass(M, 2, x, J);
    OK(s, spar_rigid_create(s, "body", NULL, NULL, M, &p.member));
    OK(s, spar_member_set_effects(p.member, SPAR_EFFECT_WORK, 0));
    OK(s, spar_member_commit(p.member));
    p.hinge = scene_joint_at(s, "hinge", p.member, 0, NULL, 0, SPAR_FREE_RZ | SPAR_FREE_X | SPAR_FREE_Y, x);
    scene_diagonal(K, 30, 40, 0, 0, 0, 5);
    OK(s, spar_joint_set_spring(p.hinge, K, NULL, NULL));
    for (int i = 1; i <= steps; i++) {
        give(&p, kind, 0.9 * i / steps);
        scene_run(s, 0.9 / steps, 1);
    }
    OK(s, spar_member_get_work(p.member, SPAR_WORK_COUNT, work));
    OK(s, spar_member_get_energy(p.member, SPAR_ENERGY_COUNT, energy));
    OK(s, spar_joint_get_energy(p.hinge, SPAR_JOINT_ENERGY_COUNT, of_joint));
    double given = kind == MOTOR ? of_joint[SPAR_JOINT_ENERGY_LOAD] : work[SPAR_WORK_LOADS];
    spar_session_destroy(&p.session);
    return given - energy[SPAR_ENERGY_KINETIC] - of_joint[SPAR_JOINT_ENERGY_SPRING];
}

static void accounts_are_of_order_two(void **state) {
    (void)state;
    static const load kinds[] = {DEAD, FOLLOWER, MOTOR};
    for (int k = 0; k < 3; k++) {
        double whole = defect(kinds[k], 40), half = defect(kinds[k], 80);
        print_message("account of load %d: off by %.2e, order %.2f\n", (int)kinds[k], whole, log2(whole / half));
        NEAR(log2(whole / half), 2, 0.25);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(order_two_with_substeps), cmocka_unit_test(rejected_and_loaded),
                                       cmocka_unit_test(taken_away), cmocka_unit_test(accounts_are_of_order_two)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
