/* Trials of sessions with joints: they go back to the bit, say what theory says, and their advice comes into force for
   members that are tied. */
#include "scene.h"
#include "trials.h"

#include "member/joint.h"

enum { MEMBERS = 3, JOINTS = 3, MOST = 40 };

static const double rest[4] = {1, 0, 0, 0}, step = 0.02;

typedef struct scene {
    spar_session *session;
    spar_member *member[MEMBERS];
    spar_joint *joint[JOINTS];
    spar_fluid *fluid;
    double load, drag;
    int fails;
} scene;

/* A wing with a body on a sprung hinge at its tip (node: of the wing), which a rope holds, and a rotor on a driven
   shaft. The wing has a fluid node at its tip. */
static void create(scene *c, int nodes, int64_t node, double damping) {
    static const double tip[3] = {4, 0, 0}, hub[3] = {0, 6, 0}, centre[3] = {0.3, 0, 0}, J[3] = {0.1, 0.2, 0.3};
    double K[36], M[36], spring[36] = {0}, damper[36] = {0}, mass[36], place[3 * MOST];
    *c = (scene){.session = scene_session(), .load = 2, .drag = 0.5};
    scene_explicit(c->session);
    spar_session *s = c->session;
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -9.81}));
    scene_diagonal(K, 4e4, 4e4, 4e4, 800, 600, 600);
    scene_diagonal(M, 1, 1, 1, 0.02, 0.01, 0.01);
    c->member[0] = scene_beam(s, "wing", 2, nodes, 4, K, M);
    OK(s, spar_member_set_root(c->member[0], SPAR_ROOT_FIXED));
    OK(s, spar_member_commit(c->member[0]));
    OK(s, spar_member_get_reference(c->member[0], place, NULL));
    scene_mass(mass, 2, centre, J);
    OK(s, spar_rigid_create(s, "flap", place + 3 * node, rest, mass, &c->member[1]));
    OK(s, spar_member_commit(c->member[1]));
    OK(s, spar_rigid_create(s, "rotor", hub, rest, mass, &c->member[2]));
    OK(s, spar_member_commit(c->member[2]));
    spring[28] = 60, damper[28] = damping;
    OK(s, spar_joint_create(s, "hinge", c->member[1], 0, c->member[0], node, SPAR_FREE_RY, &c->joint[0]));
    OK(s, spar_joint_set_frame(c->joint[0], place + 3 * node, rest));
    OK(s, spar_joint_set_spring(c->joint[0], spring, damper, NULL));
    OK(s, spar_link_create(s, "rope", c->member[1], 0, tip, NULL, 0, (double[]){4, 0, 3}, &c->joint[1]));
    OK(s, spar_link_set_spring(c->joint[1], 30, 0.1, 2.5, 1));
    OK(s, spar_joint_create(s, "shaft", c->member[2], 0, NULL, 0, SPAR_FREE_RZ, &c->joint[2]));
    OK(s, spar_joint_set_frame(c->joint[2], hub, rest));
    OK(s, spar_joint_set_driven(c->joint[2], SPAR_FREE_RZ));
    OK(s, spar_fluid_create(c->member[0], "air", &c->fluid));
    OK(s, spar_fluid_set_motion_nodes(c->fluid, 1, tip));
    OK(s, spar_fluid_set_force_nodes(c->fluid, 1, tip));
    OK(s, spar_fluid_map(c->fluid));
}

static int before(spar_session *s, double t, double dt, void *context) {
    scene *c = context;
    double z[6] = {0, 0, 0, 0, 0, 9 * (t + dt)}, rate[6] = {0, 0, 0, 0, 0, 9};
    (void)s;
    return spar_joint_drive(c->joint[2], z, rate, NULL);
}

static int press(spar_session *s, double t, double dt, int iteration, void *context) {
    scene *c = context;
    double v[3], f[3];
    (void)s, (void)iteration;
    int status = c->fails ? c->fails : spar_fluid_pull_motion(c->fluid, 1, NULL, v);
    for (int k = 0; k < 3 && !status; k++) {
        f[k] = -c->drag * v[k] + (k == 2 ? c->load * sin(5 * (t + dt)) : 0);
    }
    return status ? status : spar_fluid_push_forces(c->fluid, f, NULL);
}

static void run(scene *c, int steps) {
    for (int i = 0; i < steps; i++) {
        double t = 0;
        OK(c->session, spar_session_get_time(c->session, &t, NULL, NULL));
        OK(c->session, before(c->session, t, step, c));
        OK(c->session, spar_step(c->session, step, press, c, NULL));
    }
}

enum { STATE = 25 * MOST * MEMBERS + 18 * JOINTS };

static void same(const scene *a, const scene *b) {
    static double x[2][STATE];
    for (int i = 0; i < 2; i++) {
        const scene *c = i ? b : a;
        double *to = memset(x[i], 0, sizeof x[i]);
        for (int k = 0; k < MEMBERS; k++, to += 25 * MOST) {
            OK(c->session, spar_member_get_motion(c->member[k], to, to + 7 * MOST, to + 13 * MOST));
            OK(c->session, spar_member_get_reaction(c->member[k], to + 19 * MOST));
        }
        for (int k = 0; k < JOINTS; k++, to += 18) {
            OK(c->session, spar_joint_get_motion(c->joint[k], to, to + 6, NULL));
            OK(c->session, spar_joint_get_load(c->joint[k], to + 12));
        }
    }
    assert_memory_equal(x[0], x[1], sizeof x[0]);
}

/* Trials of all kinds before the first step and between steps leave no bit; the same run again is the same; a callback
   that fails, or one that changes joints, leaves nothing either. */
static void test_to_the_bit(void **state) {
    (void)state;
    for (int first = 0; first <= 12; first += 12) {
        scene a, b;
        double seen[TRY_COUNT], table[SPAR_ROW_COUNT][COLUMN_COUNT];
        create(&a, 4, 7, 0.5);
        create(&b, 4, 7, 0.5);
        run(&a, first);
        run(&b, first);
        OK(b.session, trial_run(b.session, step, 16, before, press, &b, 0, seen));
        same(&a, &b);
        OK(b.session, trial_run(b.session, step, 16, before, press, &b, 1, seen));
        assert_true(seen[TRY_MOTION] == 0 && seen[TRY_REACTION] == 0);
        b.fails = 7;
        assert_int_equal(trial_run(b.session, step, 16, before, press, &b, 0, seen), SPAR_ERR_USER);
        b.fails = 0;
        OK(b.session, trial_report_effects(b.session, step, 8, before, press, &b, table[0]));
        same(&a, &b);
        run(&a, 12);
        run(&b, 12);
        same(&a, &b);
        spar_session_destroy(&a.session);
        spar_session_destroy(&b.session);
    }
}

/* What a trial runs is what the session then does: the trial's motion against the run itself, by a second trial from
   there. Without gravity the run is another one; inertia counts; there is no damping to leave out. */
static void test_effects(void **state) {
    (void)state;
    scene c;
    double table[SPAR_ROW_COUNT][COLUMN_COUNT];
    create(&c, 4, 7, 0.5);
    run(&c, 10);
    OK(c.session, trial_report_effects(c.session, step, 16, before, press, &c, table[0]));
    assert_true(table[SPAR_ROW_GRAVITY][COLUMN_IN_FORCE] == 1);
    assert_true(table[SPAR_ROW_GRAVITY][COLUMN_MOTION] > 0.05);
    assert_true(table[SPAR_ROW_GRAVITY][COLUMN_REACTION] > 0.05);
    assert_true(table[SPAR_ROW_INERTIA][COLUMN_MOTION] != 0);
    assert_true(table[SPAR_ROW_DAMPING][COLUMN_IN_FORCE] == 0);
    spar_session_destroy(&c.session);
}

static double turn_of_hinge(const scene *c) {
    double z[6];
    OK(c->session, spar_joint_get_motion(c->joint[0], z, NULL, NULL));
    for (int k = 0; k < 6; k++) {
        assert_true(k == 4 || fabs(z[k]) < 1e-11);
    }
    return z[4];
}

/* Advice for a wing of many nodes: fewer will do; put in force within a run, the hinge holds on the other nodes, and
   the run goes on as the one that was not advised, to the tolerance (5 % of the motion) and what 0.3 s more add to it.
   The shaft keeps its turns. */
static void test_advice(void **state) {
    (void)state;
    scene a, b;
    double advice[ADVICE_COUNT], dt = 0, load[6], other[6], z[6];
    int64_t nodes = 0;
    create(&a, 7, 13, 0.5);
    create(&b, 7, 13, 0.5);
    OK(b.session, spar_trial_set_option(trial_of(b.session), "dt", "keep"));
    OK(b.session, spar_trial_set_option(trial_of(b.session), "coupling", "keep"));
    run(&a, 30);
    run(&b, 30);
    OK(b.session, trial_advise(b.session, 0.05, step, 16, 16 * step, before, press, &b, advice));
    same(&a, &b);
    OK(b.session, spar_trial_apply(trial_of(b.session), &dt));
    NEAR(dt, step, 1e-12);
    OK(b.session, spar_member_get_count(b.member[0], &nodes));
    assert_true(nodes < 14);
    run(&a, 15);
    run(&b, 15);
    double turn = turn_of_hinge(&a);
    NEAR(turn_of_hinge(&b), turn, 0.1 * fabs(turn));
    OK(a.session, spar_joint_get_load(a.joint[1], load));
    OK(b.session, spar_joint_get_load(b.joint[1], other));
    NEAR(load[0], other[0], 0.1 * fabs(load[0]));
    OK(b.session, spar_joint_get_motion(b.joint[2], z, NULL, NULL));
    NEAR(z[5], 9 * 45 * step, 1e-10);
    spar_session_destroy(&a.session);
    spar_session_destroy(&b.session);
}

/* A beam that is held within an element stays as it is; advice is given nevertheless. */
static void test_held_within(void **state) {
    (void)state;
    scene c;
    double advice[ADVICE_COUNT];
    int64_t nodes = 0;
    create(&c, 6, 8, 0.5);
    run(&c, 5);
    OK(c.session, trial_advise(c.session, 0.05, step, 8, 8 * step, before, press, &c, advice));
    OK(c.session, spar_trial_apply(trial_of(c.session), NULL));
    OK(c.session, spar_member_get_count(c.member[0], &nodes));
    assert_int_equal(nodes, 12);
    run(&c, 5);
    (void)turn_of_hinge(&c);
    spar_session_destroy(&c.session);
}

static int give_elements(scene *c, int elements, int nodes) {
    return trial_give_elements(c->session, c->member[0], elements, nodes);
}

/* The hinge is in the middle, where two elements meet: with four of them it holds the node that is there then, the body
   stays where it is, and the run goes on as the other, to what other elements make of it. With three there is no such
   node: refused, to the bit. */
static void test_other_elements(void **state) {
    (void)state;
    for (int64_t node = 5; node <= 6; node++) { /* both nodes of the place */
        scene a, b;
        double x[2][7];
        create(&a, 6, node, 0.5);
        create(&b, 6, node, 0.5);
        run(&a, 5);
        run(&b, 5);
        REFUSED(b.session, SPAR_ERR_STATE, "lies within an element", give_elements(&b, 3, 6));
        same(&a, &b);
        OK(b.session, give_elements(&b, 4, 6));
        assert_int_equal(b.joint[0]->node[1], node == 5 ? 11 : 12);
        OK(a.session, spar_member_get_motion(a.member[1], x[0], NULL, NULL));
        OK(b.session, spar_member_get_motion(b.member[1], x[1], NULL, NULL));
        for (int k = 0; k < 7; k++) { /* quaternions are brought to length 1 again */
            NEAR(x[1][k], x[0][k], 1e-15);
        }
        run(&a, 10);
        run(&b, 10);
        double turn = turn_of_hinge(&a);
        NEAR(turn_of_hinge(&b), turn, 1e-3 * fabs(turn));
        spar_session_destroy(&a.session);
        spar_session_destroy(&b.session);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_to_the_bit), cmocka_unit_test(test_effects),
                                       cmocka_unit_test(test_advice), cmocka_unit_test(test_held_within),
                                       cmocka_unit_test(test_other_elements)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
