/* Save and load of a session with joints: a run that goes on from a file has the bits of the one that went on, whatever
   its joints carry: turns of a shaft, loads of what is held, driven motions, springs given anew meanwhile. */
#include "scene.h"

#include <stdio.h>

enum { MEMBERS = 4, JOINTS = 5, NODES = 8 };

static const double rest[4] = {1, 0, 0, 0}, step = 0.03;
static const char file[] = "test_joint_save.spar";

typedef struct scene {
    spar_session *session;
    spar_member *member[MEMBERS];
    spar_joint *joint[JOINTS];
} scene;

enum { AS_IT_IS, OTHER_NAME, OTHER_MASK, OTHER_PLACE, OTHER_NODE, OTHER_DRIVE, OTHER_ROPE, ONE_LESS, WAYS };

static spar_member *body_at(spar_session *s, const char *name, const double x[3]) {
    const double c[3] = {0.5, 0, 0}, J[3] = {0.1, 0.2, 0.3};
    double mass[36];
    spar_member *b = NULL;
    scene_mass(mass, 2, c, J);
    OK(s, spar_rigid_create(s, name, x, rest, mass, &b));
    OK(s, spar_member_commit(b));
    return b;
}

static void add_rod(scene *c) {
    static const double from[3] = {1, 6, 0}, to[3] = {0, 7, 0};
    OK(c->session, spar_link_create(c->session, "rod", c->member[3], 0, from, c->member[2], 0, to, &c->joint[4]));
    OK(c->session, spar_link_set_spring(c->joint[4], 0, 3, 1, 0));
}

/* A beam with a flap on a sprung hinge and a weight on a rope, and a rotor on a driven shaft with a sprung mass on its
   arm. way: what of its joints is otherwise. */
static void create(scene *c, int way) {
    static const double tip[3] = {4, 0, 0}, hang[3] = {5, 0, -1}, hub[3] = {0, 6, 0}, end[3] = {1, 6, 0};
    double K[36], M[36], spring[36] = {0};
    *c = (scene){.session = scene_session()};
    spar_session *s = c->session;
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -2}));
    scene_diagonal(K, 4e4, 4e4, 4e4, 800, 600, 600);
    scene_diagonal(M, 1, 1, 1, 0.02, 0.01, 0.01);
    c->member[0] = scene_beam(s, "wing", 2, NODES / 2, 4, K, M);
    OK(s, spar_member_set_root(c->member[0], SPAR_ROOT_FIXED));
    OK(s, spar_member_commit(c->member[0]));
    c->member[1] = body_at(s, "flap", tip);
    c->member[2] = body_at(s, "rotor", hub);
    c->member[3] = body_at(s, "mass", end);
    spring[28] = 40;
    OK(s, spar_joint_create(s, way == OTHER_NAME ? "flap" : "hinge", c->member[1], 0, c->member[0],
                            way == OTHER_NODE ? 5 : 7, way == OTHER_MASK ? SPAR_FREE_RY | SPAR_FREE_RX : SPAR_FREE_RY,
                            &c->joint[0]));
    OK(s, spar_joint_set_frame(c->joint[0], way == OTHER_PLACE ? (double[]){4, 0.1, 0} : tip, rest));
    OK(s, spar_joint_set_spring(c->joint[0], spring, NULL, NULL));
    OK(s, spar_link_create(s, "rope", c->member[1], 0, hang, NULL, 0, (double[]){5, 0, 3}, &c->joint[1]));
    OK(s, spar_link_set_spring(c->joint[1], 5, 0.1, way == OTHER_ROPE ? 3 : 4, 1));
    OK(s, spar_joint_create(s, "shaft", c->member[2], 0, NULL, 0, SPAR_FREE_RZ, &c->joint[2]));
    OK(s, spar_joint_set_driven(c->joint[2], way == OTHER_DRIVE ? 0 : SPAR_FREE_RZ));
    OK(s, spar_joint_set_frame(c->joint[2], hub, rest));
    OK(s, spar_joint_create(s, "arm", c->member[3], 0, c->member[2], 0, SPAR_FREE_Z, &c->joint[3]));
    OK(s, spar_joint_set_frame(c->joint[3], end, rest));
    if (way != ONE_LESS) {
        add_rod(c);
    }
}

static void springs(scene *c, double k) {
    double spring[36] = {0}, damper[36] = {0};
    spring[14] = k, damper[14] = 1;
    OK(c->session, spar_joint_set_spring(c->joint[3], spring, damper, NULL));
    OK(c->session, spar_joint_set_load(c->joint[0], (double[]){0, 0, 0, 0, 0.01 * k, 0}));
}

static void begin_step(scene *c, int i, double dt) {
    double z[6] = {0, 0, 0, 0, 0, 20 * (i + 1) * step}, rate[6] = {0, 0, 0, 0, 0, 20};
    OK(c->session, spar_joint_drive(c->joint[2], z, rate, NULL));
    OK(c->session, spar_step_begin(c->session, dt));
}

static void run(scene *c, int first, int steps) {
    for (int i = first; i < first + steps; i++) {
        begin_step(c, i, step);
        OK(c->session, spar_step_solve(c->session));
        OK(c->session, spar_step_accept(c->session));
    }
}

enum { STATE = 25 * NODES * MEMBERS + 18 * JOINTS };

static void look(const scene *c, double *out) {
    memset(out, 0, STATE * sizeof *out);
    for (int k = 0; k < MEMBERS; k++, out += 25 * NODES) {
        OK(c->session, spar_member_get_motion(c->member[k], out, out + 7 * NODES, out + 13 * NODES));
        OK(c->session, spar_member_get_reaction(c->member[k], out + 19 * NODES));
    }
    for (int k = 0; k < JOINTS; k++, out += 18) {
        OK(c->session, spar_joint_get_motion(c->joint[k], out, out + 6, NULL));
        OK(c->session, spar_joint_get_load(c->joint[k], out + 12));
    }
}

static void same(const scene *a, const scene *b) {
    static double x[STATE], y[STATE];
    look(a, x);
    look(b, y);
    assert_memory_equal(x, y, sizeof x);
}

/* Saved between steps after `steps`, loaded into a new session and into one that has gone on. */
static void resume(int steps) {
    scene c, d;
    double z[6];
    create(&c, AS_IT_IS);
    springs(&c, 30);
    run(&c, 0, steps);
    if (steps > 0) {
        springs(&c, 50);
    }
    OK(c.session, spar_session_save(c.session, file));
    create(&d, AS_IT_IS);
    OK(d.session, spar_session_load(d.session, file));
    same(&c, &d);
    run(&c, steps, 10);
    run(&d, steps, 10);
    same(&c, &d);
    OK(c.session, spar_joint_get_motion(c.joint[2], z, NULL, NULL)); /* more than a turn */
    NEAR(z[5], 20 * (steps + 10) * step, 1e-10);
    run(&d, steps + 10, 5);
    OK(d.session, spar_session_load(d.session, file));
    run(&d, steps, 10);
    same(&c, &d);
    spar_session_destroy(&c.session);
    spar_session_destroy(&d.session);
}

static void test_resume(void **state) {
    (void)state;
    resume(0);
    resume(1);
    resume(25);
    remove(file);
}

/* Within a step, the first or a later one: solved, saved, then solved again, or given up. */
static void test_within_a_step(void **state) {
    (void)state;
    for (int way = 0; way < 4; way++) {
        int first = way % 2 ? 12 : 0, give_up = way / 2;
        scene c, d;
        create(&c, AS_IT_IS);
        springs(&c, 30);
        run(&c, 0, first);
        begin_step(&c, first, 0.7 * step);
        OK(c.session, spar_step_solve(c.session));
        OK(c.session, spar_session_save(c.session, file));
        create(&d, AS_IT_IS);
        OK(d.session, spar_session_load(d.session, file));
        same(&c, &d);
        scene *both[2] = {&c, &d};
        for (int k = 0; k < 2; k++) {
            if (give_up) {
                OK(both[k]->session, spar_step_reject(both[k]->session));
            } else {
                OK(both[k]->session, spar_step_solve(both[k]->session));
                OK(both[k]->session, spar_step_accept(both[k]->session));
            }
        }
        same(&c, &d);
        run(&c, first + 1, 5);
        run(&d, first + 1, 5);
        same(&c, &d);
        spar_session_destroy(&c.session);
        spar_session_destroy(&d.session);
    }
    remove(file);
}

/* After an equilibrium, whose shape the first step begins with. */
static void test_after_rest(void **state) {
    (void)state;
    scene c, d;
    create(&c, AS_IT_IS);
    create(&d, AS_IT_IS);
    springs(&c, 30);
    OK(c.session, spar_member_solve_static(c.member[1], 2));
    OK(c.session, spar_session_save(c.session, file));
    OK(d.session, spar_session_load(d.session, file));
    same(&c, &d);
    run(&c, 0, 5);
    run(&d, 0, 5);
    same(&c, &d);
    spar_session_destroy(&c.session);
    spar_session_destroy(&d.session);
    remove(file);
}

/* A step was solved and rejected, then a joint came: the file is that of a session that had it from the beginning. */
static void test_a_joint_more(void **state) {
    (void)state;
    scene a, b, c;
    create(&a, AS_IT_IS);
    create(&b, ONE_LESS);
    create(&c, AS_IT_IS);
    begin_step(&b, 0, step);
    OK(b.session, spar_step_solve(b.session));
    OK(b.session, spar_step_reject(b.session));
    add_rod(&b);
    OK(b.session, spar_session_save(b.session, file));
    OK(c.session, spar_session_load(c.session, file));
    run(&a, 0, 3);
    run(&b, 0, 3);
    run(&c, 0, 3);
    same(&a, &b);
    same(&a, &c);
    spar_session_destroy(&a.session);
    spar_session_destroy(&b.session);
    spar_session_destroy(&c.session);
    remove(file);
}

/* Joints described otherwise: refused, with the name, and all is as it was. */
static void test_of_another_session(void **state) {
    (void)state;
    static const char *const said[WAYS] = {[OTHER_NAME] = "joint 'flap' is out of order",
                                           [OTHER_MASK] = "different description of joint 'hinge'",
                                           [OTHER_PLACE] = "different description of joint 'hinge'",
                                           [OTHER_NODE] = "different description of joint 'hinge'",
                                           [OTHER_DRIVE] = "different description of joint 'shaft'",
                                           [OTHER_ROPE] = "different description of joint 'rope'",
                                           [ONE_LESS] = "has 5 joints, this session has 4"};
    scene c;
    create(&c, AS_IT_IS);
    springs(&c, 30);
    run(&c, 0, 2);
    OK(c.session, spar_session_save(c.session, file));
    spar_session_destroy(&c.session);
    for (int way = 1; way < WAYS; way++) {
        double q[7];
        create(&c, way);
        assert_int_equal(spar_session_load(c.session, file), SPAR_ERR_ARGUMENT);
        assert_non_null(strstr(spar_session_message(c.session), said[way]));
        OK(c.session, spar_member_get_motion(c.member[1], q, NULL, NULL));
        assert_true(q[2] == 0);
        OK(c.session, spar_step(c.session, step, NULL, NULL, NULL));
        spar_session_destroy(&c.session);
    }
    remove(file);
}

/* A fixed or pinned root has no velocity, whatever field its member begins with: of beams of every fidelity on joints,
   before the first step and after it, and after the run was loaded. Beams that are linear or modal have no joint. */
static void test_roots_that_stand(void **state) {
    (void)state;
    static const char path[] = "roots_that_stand.spar";
    double K[36], M[36], v[2][6 * 8], q[2][7 * 8];
    scene_diagonal(K, 1e6, 1e6, 1e6, 500, 500, 500);
    scene_diagonal(M, 2, 2, 2, 0.02, 0.02, 0.02);
    for (int low = SPAR_FIDELITY_RIGID; low <= SPAR_FIDELITY_EXACT; low++) {
        for (int loaded = 0; loaded < 2; loaded++) {
            spar_session *s = scene_session();
            spar_member *b = scene_beam(s, "b", 2, 4, 1, K, M);
            const double x[3] = {1, 0, 0}, J[3] = {1, 1, 1};
            OK(s, spar_member_set_root(b, SPAR_ROOT_FIXED));
            OK(s, spar_member_set_fidelity(b, low, low == SPAR_FIDELITY_MODAL ? 9 : 0));
            OK(s, spar_member_set_initial_velocity(b, x, NULL, (const double[]){0, 0.3, 0.2}));
            OK(s, spar_member_commit(b));
            if (low == SPAR_FIDELITY_RIGID || low == SPAR_FIDELITY_EXACT) {
                (void)scene_joint_at(s, "hinge", scene_body(s, "tip", x, 1, J), 0, b, 7, SPAR_FREE_RY, x);
            }
            OK(s, loaded ? spar_session_load(s, path) : SPAR_OK);
            for (int n = 2 * loaded; n < 4; n++) {
                OK(s, !loaded && n == 2 ? spar_session_save(s, path) : SPAR_OK);
                OK(s, spar_member_get_motion(b, q[loaded], v[loaded], NULL));
                for (int k = 0; k < 6; k++) {
                    assert_true(v[loaded][k] == 0);
                }
                scene_run(s, n == 1 ? 0.004 : 0.01, 1);
            }
            OK(s, spar_member_get_motion(b, q[loaded], v[loaded], NULL));
            spar_session_destroy(&s);
        }
        assert_memory_equal(q[0], q[1], sizeof q[0]);
        assert_memory_equal(v[0], v[1], sizeof v[0]);
    }
    (void)remove(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_resume),
                                       cmocka_unit_test(test_within_a_step),
                                       cmocka_unit_test(test_after_rest),
                                       cmocka_unit_test(test_a_joint_more),
                                       cmocka_unit_test(test_of_another_session),
                                       cmocka_unit_test(test_roots_that_stand)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
