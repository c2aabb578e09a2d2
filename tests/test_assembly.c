/* Assemblies in what a session does with all of its members at once: equilibrium with the fluid, against closed forms
   and the same structure said in one piece. */
#include "scene.h"

#include <stdio.h>

static const double upright[4] = {1, 0, 0, 0}, zero[3] = {0, 0, 0};

static spar_member *make_body(spar_session *s, const char *name, const double x[3], double m, const double J[3]) {
    double mass[36];
    spar_member *b = NULL;
    scene_mass(mass, m, zero, J);
    OK(s, spar_rigid_create(s, name, x, upright, mass, &b));
    OK(s, spar_member_commit(b));
    return b;
}

static spar_joint *tie(spar_session *s, const char *name, spar_member *a, int64_t node_a, spar_member *b,
                       int64_t node_b, int free_motions) {
    spar_joint *j = NULL;
    OK(s, spar_joint_create(s, name, a, node_a, b, node_b, free_motions, &j));
    return j;
}

/* ---- equilibrium with a fluid ---- */

/* A fluid at one point: a force along z of f0 - k z. */
typedef struct pond {
    spar_fluid *fluid;
    double f0, k;
    int fails_at; /* the call it gives up in; 0: never */
    int calls;
    struct pond *next;
} pond;

static int push_ponds(spar_session *s, double t, double dt, int iteration, void *context) {
    (void)t, (void)dt, (void)iteration;
    for (pond *p = context; p; p = p->next) {
        double x[3], q[4];
        OK(s, spar_fluid_pull_poses(p->fluid, 1, x, q, NULL, NULL, NULL, NULL));
        const double force[3] = {0, 0, p->f0 - p->k * x[2]};
        OK(s, spar_fluid_push_forces(p->fluid, force, NULL));
        if (++p->calls == p->fails_at) {
            return SPAR_ERR_USER;
        }
    }
    return SPAR_OK;
}

static void dip(spar_session *s, spar_member *m, const double x[3], pond *p) {
    OK(s, spar_fluid_create(m, "pond", &p->fluid));
    OK(s, spar_fluid_set_motion_nodes(p->fluid, 1, x));
    OK(s, spar_fluid_set_force_nodes(p->fluid, 1, x));
    OK(s, spar_fluid_map(p->fluid));
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 0, 1e-12, 50));
}

/* A raft of 3 kg on a vertical slide, its spring of 500 N/m preloaded with 20 N, on water of 300 N/m that carries 100 N
   at z = 0: z = (100 + 20 - m g) / (500 + 300), the joint gives 20 - 500 z; five steps from there stay. Closed forms to
   rounding. */
static void test_raft(void **state) {
    (void)state;
    const double m = 3, g = 9.81, J[3] = {1, 1, 1}, expected = (120 - m * g) / 800;
    double K[36], preload[6] = {0, 0, 20, 0, 0, 0}, z[6], load[6];
    pond p = {.f0 = 100, .k = 300};
    spar_session *s = scene_session();
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -g}));
    spar_member *raft = make_body(s, "raft", zero, m, J);
    spar_joint *slide = tie(s, "slide", raft, 0, NULL, 0, SPAR_FREE_Z);
    scene_diagonal(K, 0, 0, 500, 0, 0, 0);
    OK(s, spar_joint_set_spring(slide, K, NULL, preload));
    dip(s, raft, zero, &p);
    OK(s, spar_session_solve_static(s, 3, push_ponds, &p, NULL));
    for (int i = 0; i <= 5; i++) {
        OK(s, spar_joint_get_motion(slide, z, NULL));
        OK(s, spar_joint_get_load(slide, load));
        NEAR(z[2], expected, 1e-13);
        NEAR(load[2], 20 - 500 * expected, 1e-10);
        for (int k = 0; k < 6; k++) {
            assert_true(k == 2 || (fabs(z[k]) < 1e-14 && fabs(load[k]) < 1e-10));
        }
        OK(s, spar_step(s, 0.01, push_ponds, &p, NULL));
    }
    spar_session_destroy(&s);
}

/* A cantilever of two elements, and two beams of one welded, side by side in one session, each with its tip in a pond
   that pushes it far up: one shape to 1e-11 m, and it is far from straight. */
static void test_welded_in_a_fluid(void **state) {
    (void)state;
    const double place[2][3] = {{0, 1, 0}, {1, 1, 0}};
    double K[36], tip[2][7];
    scene_diagonal(K, 1e6, 1e6, 1e6, 200, 300, 400);
    spar_session *s = scene_session();
    spar_member *one = scene_beam(s, "one", 2, 6, 2, K, NULL),
                *half[2] = {scene_beam(s, "inner", 1, 6, 1, K, NULL), scene_beam(s, "outer", 1, 6, 1, K, NULL)};
    OK(s, spar_member_commit(one));
    for (int k = 0; k < 2; k++) {
        OK(s, spar_member_set_placement(half[k], place[k], NULL));
        OK(s, spar_member_set_root(half[k], k ? SPAR_ROOT_FREE : SPAR_ROOT_FIXED));
        OK(s, spar_member_commit(half[k]));
    }
    (void)tie(s, "weld", half[1], 0, half[0], 5, 0);
    pond at_half = {.f0 = 400, .k = 150}, at_one = {.f0 = 400, .k = 150, .next = &at_half};
    dip(s, one, (double[]){2, 0, 0}, &at_one);
    dip(s, half[1], (double[]){2, 1, 0}, &at_half);
    OK(s, spar_session_solve_static(s, 10, push_ponds, &at_one, NULL));
    scene_tip(one, tip[0]);
    scene_tip(half[1], tip[1]);
    for (int k = 0; k < 7; k++) {
        NEAR(tip[1][k], tip[0][k], 1e-11);
    }
    assert_true(tip[0][2] > 1);
    spar_session_destroy(&s);
}

/* What a refused call must not change: motions and loads of a joint and a member, to the bit. */
typedef struct keepsake {
    double z[6], rate[6], load[6], q[7], v[6], a[6], loads[6];
} keepsake;

static keepsake look(spar_session *s, const spar_member *m, const spar_joint *j) {
    keepsake k;
    OK(s, spar_joint_get_motion(j, k.z, k.rate));
    OK(s, spar_joint_get_load(j, k.load));
    OK(s, spar_member_get_motion(m, k.q, k.v, k.a));
    OK(s, spar_member_get_loads(m, k.loads));
    return k;
}

/* A boom on a hinge about x without a spring, a post welded to it that reaches y = 1 into a pond: without loads nothing
   holds it, the free motion is named and the state stays, as it does when the fluid gives up in its second call. With
   a spring of 3 N m the angle t is where the pond's moment is the spring's, (1 - 0.2 sin t) cos t = 3 t. */
static void test_refused(void **state) {
    (void)state;
    const double J[3] = {1, 1, 1}, end[3] = {0, 1, 0};
    double K[36], z[6], t = 0;
    pond p = {.f0 = 1, .k = 0.2};
    spar_session *s = scene_session();
    spar_member *boom = make_body(s, "boom", zero, 1, J), *post = make_body(s, "post", end, 1, J);
    spar_joint *hinge = tie(s, "hinge", boom, 0, NULL, 0, SPAR_FREE_RX), *weld = tie(s, "weld", post, 0, boom, 0, 0);
    OK(s, spar_joint_set_frame(weld, end, NULL));
    dip(s, post, end, &p);
    OK(s, spar_step(s, 0.01, push_ponds, &p, NULL));
    keepsake before = look(s, post, weld);
    p.f0 = p.k = 0;
    assert_int_equal(spar_session_solve_static(s, 1, push_ponds, &p, NULL), SPAR_ERR_NUMERIC);
    assert_non_null(strstr(spar_session_message(s), "nothing holds the turn about x of joint 'hinge'"));
    keepsake after = look(s, post, weld);
    assert_memory_equal(&before, &after, sizeof after);
    p.f0 = 1, p.k = 0.2;
    scene_diagonal(K, 0, 0, 0, 3, 0, 0);
    OK(s, spar_joint_set_spring(hinge, K, NULL, NULL));
    p.fails_at = p.calls + 2;
    assert_int_equal(spar_session_solve_static(s, 1, push_ponds, &p, NULL), SPAR_ERR_USER);
    after = look(s, post, weld);
    assert_memory_equal(&before, &after, sizeof after);
    p.fails_at = 0;
    OK(s, spar_session_solve_static(s, 1, push_ponds, &p, NULL));
    for (int i = 0; i < 200; i++) {
        t = (1 - 0.2 * sin(t)) * cos(t) / 3;
    }
    OK(s, spar_joint_get_motion(hinge, z, NULL));
    NEAR(z[3], t, 1e-10);
    spar_session_destroy(&s);
}

/* Two bodies tied to each other alone: the whole goes where the load takes it, and the body is named. */
static void test_adrift(void **state) {
    (void)state;
    const double J[3] = {1, 1, 1}, end[3] = {1, 0, 0}, load[6] = {0, 0, 1, 0, 0, 0};
    spar_session *s = scene_session();
    spar_member *a = make_body(s, "hull", zero, 1, J), *b = make_body(s, "keel", end, 1, J);
    spar_joint *weld = tie(s, "weld", b, 0, a, 0, 0);
    OK(s, spar_joint_set_frame(weld, end, NULL));
    OK(s, spar_member_set_load(a, 0, SPAR_LOAD_DEAD, load));
    assert_int_equal(spar_session_solve_static(s, 1, NULL, NULL, NULL), SPAR_ERR_NUMERIC);
    const char *text = spar_session_message(s);
    assert_non_null(strstr(text, "nothing holds"));
    assert_true(strstr(text, "of 'hull'") || strstr(text, "of 'keel'"));
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_raft),
        cmocka_unit_test(test_welded_in_a_fluid),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_adrift),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
