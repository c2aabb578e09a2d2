/* Joints that cannot be: each is refused with its status and a message that says what, where and the cure, and leaves
   the session as it was. */
#include "scene.h"

static const double upright[4] = {1, 0, 0, 0}, zero[3] = {0, 0, 0};

/* Two bodies 1 m apart, a beam of two elements of three nodes beside them, a hinge to the ground. */
typedef struct yard {
    spar_session *s;
    spar_member *body[2], *beam;
    spar_joint *hinge;
} yard;

static yard open_yard(void) {
    yard y = {.s = scene_session()};
    const double J[3] = {1, 1, 1}, there[3] = {0, 3, 4};
    double mass[36], K[36];
    scene_mass(mass, 1, zero, J);
    scene_diagonal(K, 1, 1, 1, 1, 1, 1);
    for (int k = 0; k < 2; k++) {
        OK(y.s, spar_rigid_create(y.s, k ? "far" : "near", k ? there : zero, upright, mass, &y.body[k]));
        OK(y.s, spar_member_commit(y.body[k]));
    }
    y.beam = scene_beam(y.s, "beam", 2, 3, 1, K, K);
    OK(y.s, spar_member_commit(y.beam));
    OK(y.s, spar_joint_create(y.s, "hinge", y.body[0], 0, NULL, 0, SPAR_FREE_RY, &y.hinge));
    return y;
}

/* The hinge alone: the body turns about y under a moment of 2 N m as J = 1 has it, exactly, for the acceleration is
   constant. What was refused has left nothing behind. */
static void still_sound(yard *y) {
    const double load[6] = {0, 0, 0, 0, 2, 0};
    double z[6];
    OK(y->s, spar_joint_set_load(y->hinge, load));
    scene_run(y->s, 0.1, 10);
    OK(y->s, spar_joint_get_motion(y->hinge, z, NULL, NULL));
    for (int k = 0; k < 6; k++) {
        NEAR(z[k], k == 4 ? 1 : 0, 1e-12);
    }
    spar_session_destroy(&y->s);
}

static void test_create(void **state) {
    (void)state;
    yard y = open_yard(), other = open_yard();
    spar_joint *j = NULL;
    REFUSED(y.s, SPAR_ERR_ARGUMENT,
            "'j' connects node 0 of 'near' to itself; give two different nodes, or b = NULL for the ground",
            spar_joint_create(y.s, "j", y.body[0], 0, y.body[0], 0, 0, &j));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "connects node 2 of 'beam' to itself",
            spar_joint_create(y.s, "j", y.beam, 2, y.beam, 3, 0, &j)); /* where two elements meet a node stands twice */
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "member b, 'far', belongs to another session",
            spar_joint_create(y.s, "j", y.body[0], 0, other.body[1], 0, 0, &j));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "'beam' has nodes 0 to 5; there is no node 6",
            spar_joint_create(y.s, "j", y.beam, 6, NULL, 0, 0, &j));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "there is no node -1",
            spar_joint_create(y.s, "j", y.body[0], 0, y.beam, -1, 0, &j));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "free is 64; give a combination of SPAR_FREE_* bits",
            spar_joint_create(y.s, "j", y.body[0], 0, NULL, 0, 64, &j));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "free is -1", spar_joint_create(y.s, "j", y.body[0], 0, NULL, 0, -1, &j));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "joint 'hinge' already exists",
            spar_joint_create(y.s, "hinge", y.body[0], 0, NULL, 0, 0, &j));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "needs a name", spar_joint_create(y.s, "", y.body[0], 0, NULL, 0, 0, &j));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "member a is NULL", spar_joint_create(y.s, "j", NULL, 0, NULL, 0, 0, &j));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "the pointer to the new joint",
            spar_joint_create(y.s, "j", y.body[0], 0, NULL, 0, 0, NULL));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "its two points coincide at (0, 0, 0)",
            spar_link_create(y.s, "j", y.body[0], 0, zero, y.body[1], 0, zero, &j));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "point_b",
            spar_link_create(y.s, "j", y.body[0], 0, zero, NULL, 0, (double[]){0, NAN, 0}, &j));
    assert_null(j);
    spar_session_destroy(&other.s);
    still_sound(&y);
}

static void test_describe(void **state) {
    (void)state;
    yard y = open_yard();
    const double long_q[4] = {1, 0.1, 0, 0}, none[6] = {0};
    double K[36] = {0}, load[6] = {1, 0, 0, 0, 0, 0};
    spar_joint *line = NULL, *free_joint = NULL;
    OK(y.s, spar_joint_create(y.s, "free", y.body[1], 0, NULL, 0, 63, &free_joint));
    OK(y.s, spar_link_create(y.s, "line", y.body[1], 0, (double[]){0, 3, 4}, NULL, 0, zero, &line));
    OK(y.s, spar_link_set_spring(line, 0, 0, 5, 0));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "q", spar_joint_set_frame(y.hinge, zero, long_q));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "x", spar_joint_set_frame(y.hinge, (double[]){0, INFINITY, 0}, NULL));
    REFUSED(y.s, SPAR_ERR_STATE, "is a line, which has no frame; set its points when it is created",
            spar_joint_set_frame(line, zero, NULL));
    K[0] = 10;
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "stiffness has 10 on x, which the joint constrains; springs act on free motions",
            spar_joint_set_spring(y.hinge, K, NULL, NULL));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "damping has 10 on x", spar_joint_set_spring(y.hinge, NULL, K, NULL));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "preload has 1 on x", spar_joint_set_spring(y.hinge, NULL, NULL, load));
    K[1] = 3;
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "stiffness is not symmetric: entries (0,1) and (1,0) are 3 and 0",
            spar_joint_set_spring(free_joint, K, NULL, NULL));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "x", spar_joint_set_load(y.hinge, load));
    REFUSED(y.s, SPAR_ERR_STATE, "call spar_link_set_spring", spar_joint_set_spring(line, NULL, NULL, NULL));
    REFUSED(y.s, SPAR_ERR_STATE, "is not a line", spar_link_set_spring(y.hinge, 1, 0, 1, 0));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "stiffness is -1; give 0 or more", spar_link_set_spring(line, -1, 0, 1, 0));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "mask is 8, free is 16: only free motions can be driven",
            spar_joint_set_driven(y.hinge, SPAR_FREE_RX));
    REFUSED(y.s, SPAR_ERR_STATE, "is not driven; call spar_joint_set_driven",
            spar_joint_drive(y.hinge, none, NULL, NULL));
    still_sound(&y);
}

/* The short form says what the long one does: one body on each, the same motion to the bit; what it refuses leaves no
   joint, so that the name is free. */
static void test_short_form(void **state) {
    (void)state;
    const double J[3] = {1, 2, 3}, x[2][3] = {{0, 0, 0}, {0, 0, 0}}, preload[6] = {0, 3, 0, 0, 0, 0};
    double mass[36], K[36] = {0}, C[36] = {0}, z[2][6];
    yard y = {.s = scene_session()};
    spar_session *other = scene_session();
    spar_joint *j[2] = {NULL, NULL};
    scene_mass(mass, 2, zero, J);
    for (int k = 0; k < 2; k++) {
        OK(y.s, spar_rigid_create(y.s, k ? "b" : "a", x[k], upright, mass, &y.body[k]));
        OK(y.s, spar_member_commit(y.body[k]));
    }
    K[7] = 50, C[7] = 1;
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "'spring': stiffness has 50 on y, which the joint constrains",
            spar_spring_create(y.s, "spring", y.body[0], 0, SPAR_FREE_X, K, C, preload, &j[0]));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "free is 64",
            spar_spring_create(y.s, "spring", y.body[0], 0, 64, K, C, preload, &j[0]));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "there is no node 1",
            spar_spring_create(y.s, "spring", y.body[0], 1, 2, K, C, preload, &j[0]));
    OK(y.s, spar_spring_create(y.s, "spring", y.body[0], 0, SPAR_FREE_Y, K, C, preload, &j[0]));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "joint 'spring' already exists",
            spar_spring_create(y.s, "spring", y.body[0], 0, SPAR_FREE_Y, K, C, NULL, NULL));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "needs a name",
            spar_spring_create(y.s, NULL, y.body[0], 0, SPAR_FREE_Y, K, C, NULL, NULL));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "the member is NULL",
            spar_spring_create(y.s, "none", NULL, 0, SPAR_FREE_Y, K, C, NULL, NULL));
    REFUSED(other, SPAR_ERR_ARGUMENT, "belongs to another session",
            spar_spring_create(other, "spring", y.body[0], 0, SPAR_FREE_Y, K, C, NULL, NULL));
    assert_int_equal(spar_spring_create(NULL, "spring", y.body[0], 0, SPAR_FREE_Y, K, C, NULL, NULL),
                     SPAR_ERR_ARGUMENT);
    spar_session_destroy(&other);
    OK(y.s, spar_joint_create(y.s, "b.0", y.body[1], 0, NULL, 0, SPAR_FREE_Y, &j[1]));
    OK(y.s, spar_joint_set_spring(j[1], K, C, preload));
    scene_run(y.s, 0.05, 30);
    for (int k = 0; k < 2; k++) {
        OK(y.s, spar_joint_get_motion(j[k], z[k], NULL, NULL));
    }
    assert_memory_equal(z[0], z[1], sizeof z[0]);
    assert_true(z[0][1] > 0.01);
    spar_session_destroy(&y.s);
}

/* Two places that are to be one are 5 m apart; the step says so, and goes on once the joint is placed elsewhere. */
static void test_contradiction(void **state) {
    (void)state;
    yard y = open_yard();
    spar_joint *weld = NULL;
    OK(y.s, spar_joint_create(y.s, "weld", y.body[1], 0, y.body[0], 0, 0, &weld));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "joint 'weld': node 0 of 'far' and node 0 of 'near' are 5 m apart in the reference",
            spar_step(y.s, 0.1, NULL, NULL, NULL));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "5 m apart", spar_member_solve_static(y.body[0], 1));
    OK(y.s, spar_joint_set_frame(weld, zero, NULL));
    OK(y.s, spar_step(y.s, 0.1, NULL, NULL, NULL));
    spar_session_destroy(&y.s);
}

/* A beam that one body carries cannot be tied to itself; two nodes of one that bends can. */
static void test_two_nodes_of_one(void **state) {
    (void)state;
    for (int bends = 0; bends <= 1; bends++) {
        double K[36];
        spar_joint *j = NULL;
        spar_session *s = scene_session();
        scene_diagonal(K, 1e3, 1e3, 1e3, 1, 1, 1);
        spar_member *b = scene_beam(s, "beam", 1, 4, 1, K, K);
        OK(s, spar_member_set_fidelity(b, bends ? SPAR_FIDELITY_EXACT : SPAR_FIDELITY_RIGID, 0));
        OK(s, spar_member_commit(b));
        OK(s, spar_link_create(s, "string", b, 0, zero, b, 3, (double[]){1, 0, 0}, &j));
        assert_int_equal(spar_step(s, 0.01, NULL, NULL, NULL), bends ? SPAR_OK : SPAR_ERR_ARGUMENT);
        assert_true(bends || strstr(spar_session_message(s), "two nodes of 'beam', which moves as one rigid body"));
        spar_session_destroy(&s);
    }
}

/* Once the clock runs joints are what they are. */
static void test_late(void **state) {
    (void)state;
    yard y = open_yard();
    spar_joint *j = NULL;
    OK(y.s, spar_step(y.s, 0.1, NULL, NULL, NULL));
    REFUSED(y.s, SPAR_ERR_STATE, "the clock has started; create joints before the first step",
            spar_joint_create(y.s, "j", y.body[1], 0, NULL, 0, 0, &j));
    REFUSED(y.s, SPAR_ERR_STATE, "create joints before the first step",
            spar_link_create(y.s, "j", y.body[1], 0, zero, NULL, 0, (double[]){1, 0, 0}, &j));
    REFUSED(y.s, SPAR_ERR_STATE, "describe joints before the first step", spar_joint_set_frame(y.hinge, zero, NULL));
    REFUSED(y.s, SPAR_ERR_STATE, "before the first step", spar_joint_set_driven(y.hinge, SPAR_FREE_RY));
    OK(y.s, spar_step(y.s, 0.1, NULL, NULL, NULL));
    spar_session_destroy(&y.s);
}

/* A driven hinge is driven before the step begins, not within it. */
static void test_drive_in_step(void **state) {
    (void)state;
    yard y = open_yard();
    const double motion[6] = {0, 0, 0, 0, 0.1, 0};
    OK(y.s, spar_joint_set_driven(y.hinge, SPAR_FREE_RY));
    OK(y.s, spar_step_begin(y.s, 0.1));
    REFUSED(y.s, SPAR_ERR_STATE, "at its end before spar_step_begin", spar_joint_drive(y.hinge, motion, NULL, NULL));
    REFUSED(y.s, SPAR_ERR_STATE, "a step is in progress", spar_joint_drive(y.hinge, (double[6]){NAN}, NULL, NULL));
    OK(y.s, spar_step_reject(y.s));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "motion", spar_joint_drive(y.hinge, (double[6]){NAN}, NULL, NULL));
    spar_session_destroy(&y.s);
}

/* Three driven rotations are a rotation vector: right up to half a turn, refused from there on, and what was driven
   last stays; a driven hinge counts its turns. */
static void test_half_a_turn(void **state) {
    (void)state;
    yard y = open_yard();
    spar_joint *ball;
    double q[2][7], turn[6] = {0, 0, 0, 0, 0, 3.1};
    OK(y.s, spar_joint_create(y.s, "ball", y.body[1], 0, NULL, 0, SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ, &ball));
    OK(y.s, spar_joint_set_driven(ball, SPAR_FREE_RX | SPAR_FREE_RZ));
    OK(y.s, spar_joint_set_driven(y.hinge, SPAR_FREE_RY));
    for (int i = 1; i <= 31; i++) {
        turn[5] = 0.1 * i;
        OK(y.s, spar_joint_drive(ball, turn, (double[6]){0, 0, 0, 0, 0, 1}, NULL));
        OK(y.s, spar_joint_drive(y.hinge, (double[6]){0, 0, 0, 0, 0.1 * i, 0}, NULL, NULL));
        OK(y.s, spar_step(y.s, 0.1, NULL, NULL, NULL));
    }
    OK(y.s, spar_member_get_motion(y.body[1], q[0], NULL, NULL));
    NEAR(fabs(q[0][6]), sin(1.55), 1e-9);
    turn[3] = 0.6, turn[5] = 3.1; /* 3.158 */
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "'ball': a rotation of 3.158 rad; with three free rotations",
            spar_joint_drive(ball, turn, NULL, NULL));
    OK(y.s,
       spar_joint_drive(ball, (double[6]){0, 0, 0, 0, 9, 3.1}, NULL, NULL)); /* what is not driven does not count */
    OK(y.s, spar_joint_drive(y.hinge, (double[6]){0, 0, 0, 0, 3.2, 0}, NULL, NULL));
    OK(y.s, spar_step(y.s, 0.1, NULL, NULL, NULL));
    spar_session_destroy(&y.s);
}

/* Masses whose product with 1/dt^2 is beyond the range of numbers: the start of the first member tied is singular, and
   those behind it are not begun. A status, on every call. */
static void test_start_beyond_numbers(void **state) {
    (void)state;
    spar_session *s = scene_session();
    const double heavy = 1e303, J[3] = {1, 1, 1}, ends[2][3] = {{0, 0, 0}, {1, 0, 0}};
    double K[36], M[36];
    scene_diagonal(K, 1e7, 1e6, 1e6, 3e3, 4e3, 5e3);
    scene_diagonal(M, heavy, heavy, heavy, 1, 1, 1);
    spar_member *body[2], *beam = scene_beam(s, "beam", 1, 4, 1, K, M);
    body[0] = scene_body(s, "near", ends[0], heavy, J);
    body[1] = scene_body(s, "far", ends[1], heavy, J);
    OK(s, spar_member_set_root(beam, SPAR_ROOT_FREE));
    OK(s, spar_member_commit(beam));
    (void)scene_joint(s, "j", beam, 3, body[1], 0, SPAR_FREE_RY);
    (void)scene_joint(s, "k", beam, 0, body[0], 0, SPAR_FREE_RY);
    for (int k = 0; k < 2; k++) {
        OK(s, spar_step_begin(s, 2.6e-4));
        REFUSED(s, SPAR_ERR_NUMERIC, "singular at the start", spar_step_solve(s));
        OK(s, spar_step_reject(s));
    }
    spar_session_destroy(&s);
}

/* What getters say of joints before the first step is 0, as the header has it, whatever was asked before: a body that
   turns at 2 rad/s about a hinge 1 m beside it (its point speeds up by 4 m/s^2), on a spring that is not at rest. Calls
   that look at the joints, refused or not, place them. */
static void test_asked_before(void **state) {
    (void)state;
    double K[36], seen[3][22];
    const double x[3] = {1, 0, 0}, J[3] = {1, 1, 1};
    scene_diagonal(K, 0, 0, 0, 0, 7, 0);
    spar_session *s = scene_session();
    double mass[36];
    spar_member *b = NULL;
    scene_mass(mass, 1, zero, J);
    OK(s, spar_rigid_create(s, "b", x, upright, mass, &b));
    OK(s, spar_member_set_effects(b, SPAR_EFFECT_WORK, 0));
    OK(s, spar_member_set_initial_velocity(b, zero, zero, (double[]){0, 2, 0}));
    OK(s, spar_member_commit(b));
    spar_joint *hinge = scene_joint_at(s, "hinge", b, 0, NULL, 0, SPAR_FREE_RY, zero), *line = NULL;
    OK(s, spar_joint_set_spring(hinge, K, NULL, NULL));
    OK(s, spar_link_create(s, "line", b, 0, x, NULL, 0, (double[]){3, 0, 0}, &line));
    OK(s, spar_link_set_spring(line, 10, 1, 1.5, 0));
    for (int asked = 0; asked < 3; asked++) {
        double f;
        memset(seen[asked], 0, sizeof seen[asked]);
        if (asked == 1) {
            REFUSED(s, SPAR_ERR_ARGUMENT, "modes", spar_member_solve_modes(b, 1000, K, NULL));
        } else if (asked == 2) {
            OK(s, spar_member_solve_modes(b, 1, &f, NULL));
        }
        OK(s, spar_joint_get_motion(hinge, seen[asked], seen[asked] + 6, seen[asked] + 12));
        OK(s, spar_joint_get_motion(line, NULL, NULL, K));
        OK(s, spar_joint_get_energy(hinge, 1, seen[asked] + 18));
        OK(s, spar_joint_get_energy(line, 1, seen[asked] + 19));
        seen[asked][20] = K[0];
        for (int i = 0; i < 22; i++) {
            assert_true(seen[asked][i] == 0);
        }
    }
    OK(s, spar_step_begin(s, 1e-3));
    OK(s, spar_step_solve(s));
    OK(s, spar_joint_get_motion(line, NULL, NULL, K));
    OK(s, spar_joint_get_energy(line, 1, seen[0]));
    NEAR(seen[0][0], 0.5 * 10 * 0.25, 0.05);
    assert_true(fabs(K[0]) > 1);
    OK(s, spar_step_reject(s));
    OK(s, spar_joint_get_motion(line, NULL, NULL, K));
    assert_true(K[0] == 0);
    spar_session_destroy(&s);
}

/* A step whose square is no number. */
static void test_no_step(void **state) {
    (void)state;
    yard y = open_yard();
    double short_one = 1e-160;
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "dt is 1e-160; give a positive number of seconds, 1e-100 or more",
            spar_step_begin(y.s, short_one));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "dt is 1e-160", spar_step(y.s, short_one, NULL, NULL, NULL));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "dt is 1e-160", spar_session_solve_initial(y.s, short_one, NULL, NULL, NULL));
    REFUSED(y.s, SPAR_ERR_ARGUMENT, "dt is 1e-160", spar_step_adaptive(y.s, &short_one, NULL, NULL, NULL, NULL));
    still_sound(&y);
    y = open_yard();
    OK(y.s, spar_step(y.s, 1e-100, NULL, NULL, NULL));
    spar_session_destroy(&y.s);
}

/* A linear or modal beam that was committed takes no joint, spring or link: refused where they are created. */
static void test_reduced_beam(void **state) {
    (void)state;
    static const int kinds[2] = {SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL};
    const double from[3] = {1, 0, 0}, to[3] = {1, 0, 2}, load[6] = {0, 0, 1e-3, 0, 0, 0};
    double K[36], spring[36] = {[14] = 1}, q[2][7];
    scene_diagonal(K, 1, 1, 1, 1, 1, 1);
    for (int k = 0; k < 2; k++) {
        for (int refused = 0; refused < 2; refused++) {
            yard y = open_yard();
            spar_member *b = scene_beam(y.s, "reduced", 2, 3, 1, K, K);
            spar_joint *j = NULL;
            OK(y.s, spar_member_set_fidelity(b, kinds[k], 6));
            OK(y.s, spar_member_commit(b));
            if (refused) {
                REFUSED(y.s, SPAR_ERR_UNSUPPORTED, "spar_joint_create: 'j': 'reduced' is a linear or modal beam",
                        spar_joint_create(y.s, "j", b, 5, NULL, 0, 0, &j));
                REFUSED(y.s, SPAR_ERR_UNSUPPORTED, "commit it with SPAR_FIDELITY_EXACT",
                        spar_joint_create(y.s, "j", y.body[1], 0, b, 0, SPAR_FREE_RY, &j));
                REFUSED(y.s, SPAR_ERR_UNSUPPORTED, "spar_spring_create",
                        spar_spring_create(y.s, "j", b, 5, SPAR_FREE_Z, spring, NULL, NULL, &j));
                REFUSED(y.s, SPAR_ERR_UNSUPPORTED, "spar_link_create",
                        spar_link_create(y.s, "j", b, 5, from, y.body[1], 0, to, &j));
            }
            OK(y.s, spar_member_set_load(b, 5, SPAR_LOAD_DEAD, load));
            scene_run(y.s, 0.1, 10);
            scene_tip(b, q[refused]);
            spar_session_destroy(&y.s);
        }
        assert_true(q[0][2] > 1e-5);
        assert_memory_equal(q[0], q[1], sizeof q[0]);
    }
}

/* The joint comes first: refused at the commit, and the beam can still become exact. */
static void test_reduced_beam_at_commit(void **state) {
    (void)state;
    static const int kinds[2] = {SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL};
    double K[36];
    scene_diagonal(K, 1, 1, 1, 1, 1, 1);
    for (int k = 0; k < 2; k++) {
        yard y = open_yard();
        spar_member *b = scene_beam(y.s, "reduced", 2, 3, 1, K, K);
        spar_joint *j = NULL;
        OK(y.s, spar_member_set_fidelity(b, kinds[k], 6));
        OK(y.s, spar_joint_create(y.s, "weld", b, 5, NULL, 0, 0, &j));
        REFUSED(y.s, SPAR_ERR_UNSUPPORTED,
                "'reduced' is a linear or modal beam, which joint 'weld' cannot connect; use SPAR_FIDELITY_EXACT",
                spar_member_commit(b));
        OK(y.s, spar_member_set_fidelity(b, SPAR_FIDELITY_EXACT, 0));
        OK(y.s, spar_member_commit(b));
        still_sound(&y);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_create),
        cmocka_unit_test(test_describe),
        cmocka_unit_test(test_contradiction),
        cmocka_unit_test(test_two_nodes_of_one),
        cmocka_unit_test(test_late),
        cmocka_unit_test(test_short_form),
        cmocka_unit_test(test_drive_in_step),
        cmocka_unit_test(test_half_a_turn),
        cmocka_unit_test(test_start_beyond_numbers),
        cmocka_unit_test(test_no_step),
        cmocka_unit_test(test_asked_before),
        cmocka_unit_test(test_reduced_beam),
        cmocka_unit_test(test_reduced_beam_at_commit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
