/* Assemblies in what is done with all of their members at once: equilibrium with the fluid, modes; against closed forms
   and the same structure said in one piece. */
#include "scene.h"

#include <stdio.h>
#if defined __GLIBC__ && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33)
#include <malloc.h>
#define ALLOCATED_BYTES (mallinfo2().uordblks + mallinfo2().hblkhd)
#else
#define ALLOCATED_BYTES ((size_t)0)
#endif

static const double upright[4] = {1, 0, 0, 0}, zero[3] = {0, 0, 0};

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
        OK(s, spar_fluid_pull_poses(p->fluid, SPAR_NODES_MOTION, 1, x, q, NULL, NULL, NULL, NULL));
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
    spar_member *raft = scene_body(s, "raft", zero, m, J);
    spar_joint *slide = scene_joint(s, "slide", raft, 0, NULL, 0, SPAR_FREE_Z);
    scene_diagonal(K, 0, 0, 500, 0, 0, 0);
    OK(s, spar_joint_set_spring(slide, K, NULL, preload));
    dip(s, raft, zero, &p);
    OK(s, spar_session_solve_static(s, 3, push_ponds, &p, NULL));
    for (int i = 0; i <= 5; i++) {
        OK(s, spar_joint_get_motion(slide, z, NULL, NULL));
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
    (void)scene_joint(s, "weld", half[1], 0, half[0], 5, 0);
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
    OK(s, spar_joint_get_motion(j, k.z, k.rate, NULL));
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
    spar_member *boom = scene_body(s, "boom", zero, 1, J), *post = scene_body(s, "post", end, 1, J);
    spar_joint *hinge = scene_joint(s, "hinge", boom, 0, NULL, 0, SPAR_FREE_RX),
               *weld = scene_joint(s, "weld", post, 0, boom, 0, 0);
    OK(s, spar_joint_set_frame(weld, end, NULL));
    dip(s, post, end, &p);
    OK(s, spar_step(s, 0.01, push_ponds, &p, NULL));
    keepsake before = look(s, post, weld);
    p.f0 = p.k = 0;
    assert_int_equal(spar_session_solve_static(s, 1, push_ponds, &p, NULL), SPAR_ERR_NUMERIC);
    assert_non_null(strstr(spar_session_message(s), "the rotation about x of joint 'hinge' is not constrained"));
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
    OK(s, spar_joint_get_motion(hinge, z, NULL, NULL));
    NEAR(z[3], t, 1e-10);
    spar_session_destroy(&s);
}

/* Two bodies tied to each other alone: the whole goes where the load takes it, and the body is named. */
static void test_adrift(void **state) {
    (void)state;
    const double J[3] = {1, 1, 1}, end[3] = {1, 0, 0}, load[6] = {0, 0, 1, 0, 0, 0};
    spar_session *s = scene_session();
    spar_member *a = scene_body(s, "hull", zero, 1, J), *b = scene_body(s, "keel", end, 1, J);
    spar_joint *weld = scene_joint(s, "weld", b, 0, a, 0, 0);
    OK(s, spar_joint_set_frame(weld, end, NULL));
    OK(s, spar_member_set_load(a, 0, SPAR_LOAD_DEAD, load));
    assert_int_equal(spar_session_solve_static(s, 1, NULL, NULL, NULL), SPAR_ERR_NUMERIC);
    const char *text = spar_session_message(s);
    assert_non_null(strstr(text, "is not constrained"));
    assert_true(strstr(text, "of 'hull'") || strstr(text, "of 'keel'"));
    spar_session_destroy(&s);
}

/* A joint that comes after a static solution, before the first step, is in the next one: two springs of 500 N/m on 3 kg
   give half of the way. */
static void test_joint_that_comes_later(void **state) {
    (void)state;
    const double J[3] = {1, 1, 1}, g = 9.81;
    double K[36], z[6];
    spar_session *s = scene_session();
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -g}));
    spar_member *raft = scene_body(s, "raft", zero, 3, J);
    spar_joint *slide = scene_joint(s, "slide", raft, 0, NULL, 0, SPAR_FREE_Z), *second;
    scene_diagonal(K, 0, 0, 500, 0, 0, 0);
    OK(s, spar_joint_set_spring(slide, K, NULL, NULL));
    OK(s, spar_session_solve_static(s, 1, NULL, NULL, NULL));
    second = scene_joint(s, "second", raft, 0, NULL, 0, 63);
    OK(s, spar_joint_set_spring(second, K, NULL, NULL));
    for (int i = 0; i < 2; i++) {
        OK(s, spar_session_solve_static(s, 1, NULL, NULL, NULL));
        OK(s, spar_joint_get_motion(slide, z, NULL, NULL));
        NEAR(z[2], -3 * g / 1000, 1e-13);
        OK(s, spar_step(s, 0.1, NULL, NULL, NULL));
    }
    spar_session_destroy(&s);
}

/* ---- modes ---- */

static const double two_pi = 6.283185307179586;

/* A cantilever of two elements, and two beams of one welded, bent by a load: the same 12 frequencies to 1e-8 of each
   (eigenvalues to rounding in 1e3 times the lowest), and the tip's part in each shape, up to its sign. The section is
   Wang et al.'s box (scene.h), which couples what it can. */
static void test_modes_of_a_weld(void **state) {
    (void)state;
    enum { P = 6, N = 12 };
    const double place[3] = {1, 0, 0}, load[6] = {0, 300, 900, 20, 0, 0};
    static double f[2][N], shapes[2][N * 6 * 2 * P];
    double K[36], M[36];
    scene_box(K, M);
    for (int welded = 0; welded <= 1; welded++) {
        spar_session *s = scene_session();
        spar_member *first = scene_beam(s, "first", welded ? 1 : 2, P, welded ? 1 : 2, K, M), *last = first;
        OK(s, spar_member_commit(first));
        if (welded) {
            last = scene_beam(s, "second", 1, P, 1, K, M);
            OK(s, spar_member_set_placement(last, place, NULL));
            OK(s, spar_member_set_root(last, SPAR_ROOT_FREE));
            OK(s, spar_member_commit(last));
            (void)scene_joint(s, "weld", last, 0, first, P - 1, 0);
        }
        int64_t n;
        OK(s, spar_member_get_count(last, &n));
        OK(s, spar_member_set_load(last, n - 1, SPAR_LOAD_DEAD, load));
        OK(s, spar_member_solve_static(first, 4));
        OK(s, spar_member_solve_modes(last, N, f[welded], shapes[welded]));
        double again[N];
        OK(s, spar_member_solve_modes(first, N, again, NULL));
        assert_memory_equal(again, f[welded], sizeof again);
        spar_session_destroy(&s);
    }
    for (int k = 0; k < N; k++) {
        const double *one = shapes[0] + (ptrdiff_t)(12 * P * k + 6 * (2 * P - 1)),
                     *two = shapes[1] + (ptrdiff_t)(6 * P * k + 6 * (P - 1));
        double size = 0, along = 0;
        NEAR(f[1][k], f[0][k], 1e-8 * f[0][k]);
        for (int i = 0; i < 6; i++) {
            size = fmax(size, fabs(one[i]));
            along += one[i] * two[i];
        }
        for (int i = 0; i < 6; i++) {
            NEAR(copysign(1, along) * two[i], one[i], 1e-6 * size);
        }
    }
}

/* Two inertias on one shaft, k between them, in bearings: they turn freely as one, and against each other with omega^2
   = k (1 / J1 + 1 / J2), moments in balance, J1 a1^2 + J2 a2^2 = 1; that is all they can do. */
static void test_drivetrain(void **state) {
    (void)state;
    const double J[2] = {3, 50}, k = 700, omega = sqrt(k * (1 / J[0] + 1 / J[1]));
    double K[36], f[3], shape[2][2][6];
    spar_session *s = scene_session();
    spar_member *b[2] = {scene_body(s, "generator", zero, 1, (double[]){J[0], 2, 2}),
                         scene_body(s, "rotor", zero, 40, (double[]){J[1], 30, 30})};
    (void)scene_joint(s, "bearing", b[0], 0, NULL, 0, SPAR_FREE_RX);
    spar_joint *shaft = scene_joint(s, "shaft", b[1], 0, b[0], 0, SPAR_FREE_RX);
    scene_diagonal(K, 0, 0, 0, k, 0, 0);
    OK(s, spar_joint_set_spring(shaft, K, NULL, NULL));
    for (int i = 0; i < 2; i++) {
        OK(s, spar_member_solve_modes(b[i], 2, f, shape[i][0]));
        NEAR(f[0], 0, 1e-4 * omega);
        NEAR(two_pi * f[1], omega, 1e-9 * omega);
    }
    NEAR(shape[0][0][3], shape[1][0][3], 1e-9);
    NEAR(J[0] * shape[0][1][3] + J[1] * shape[1][1][3], 0, 1e-9);
    NEAR(J[0] * pow(shape[0][1][3], 2) + J[1] * pow(shape[1][1][3], 2), 1, 1e-12);
    assert_int_equal(spar_member_solve_modes(b[0], 3, f, NULL), SPAR_ERR_ARGUMENT);
    assert_non_null(strstr(spar_session_message(s), "the assembly has 2"));
    OK(s, spar_member_solve_modes(b[0], 0, NULL, NULL));
    spar_session_destroy(&s);
}

/* ---- constraints ---- */

enum { CHAIN = 4 };

/* Links of 0.5 m and 1 kg that hang on hinges about y and z in turn, the lowest welded; a load pushes the last aside.
 */
static spar_session *hang_chain(spar_joint *joint[CHAIN]) {
    const double down[3] = {0, 0, -0.25}, J[3] = {0.02, 0.03, 0.01}, push[6] = {0.3, 0.2, 0, 0, 0, 0.01};
    double mass[36];
    spar_session *s = scene_session();
    spar_member *above = NULL, *link = NULL;
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -9.81}));
    scene_mass(mass, 1, down, J);
    for (int k = 0; k < CHAIN; k++) {
        const double x[3] = {0, 0, -0.5 * k};
        OK(s, spar_rigid_create(s, (const char *[]){"first", "second", "third", "fourth"}[k], x, upright, mass, &link));
        OK(s, spar_member_commit(link));
        joint[k] = scene_joint(s, (const char *[]){"1", "2", "3", "4"}[k], link, 0, above, 0,
                               k == CHAIN - 1 ? 0
                               : k % 2        ? SPAR_FREE_RX
                                              : SPAR_FREE_RY);
        OK(s, spar_joint_set_frame(joint[k], x, NULL));
        above = link;
    }
    OK(s, spar_member_set_load(link, 0, SPAR_LOAD_DEAD, push));
    return s;
}

/* How far the worst hold is off, m and rad, and m/s and rad/s. */
static double worst_hold(spar_session *s, spar_joint *const joint[CHAIN]) {
    double worst = 0;
    for (int k = 0; k < CHAIN; k++) {
        double z[6], rate[6];
        int free_motion = k == CHAIN - 1 ? -1 : k % 2 ? 3 : 4;
        OK(s, spar_joint_get_motion(joint[k], z, rate, NULL));
        for (int i = 0; i < 6; i++) {
            worst = i == free_motion ? worst : fmax(worst, fmax(fabs(z[i]), fabs(rate[i])));
        }
    }
    return worst;
}

/* Whatever the step, a microsecond or a second, holds hold in place and rate: 1e-12, and the chain moves. */
static void test_any_step(void **state) {
    (void)state;
    for (double dt = 1e-6; dt < 2; dt *= 10) {
        spar_joint *joint[CHAIN];
        double z[6];
        spar_session *s = hang_chain(joint);
        OK(s, spar_session_set_integrator(s, 0.8, 1));
        for (int i = 0; i < 20; i++) {
            OK(s, spar_step(s, dt, NULL, NULL, NULL));
            assert_true(worst_hold(s, joint) < 1e-12);
        }
        OK(s, spar_joint_get_motion(joint[0], z, NULL, NULL));
        assert_true(fabs(z[4]) > 1e-13 && fabs(z[4]) < 1);
        spar_session_destroy(&s);
    }
}

/* Nothing adds up over 1e5 steps: 1e-12 still. */
static void test_many_steps(void **state) {
    (void)state;
    spar_joint *joint[CHAIN];
    spar_session *s = hang_chain(joint);
    OK(s, spar_session_set_integrator(s, 0.95, 1));
    for (int i = 0; i < 100000; i++) {
        OK(s, spar_step(s, 2e-3, NULL, NULL, NULL));
        if (i % 1000 == 0 || i > 99990) {
            assert_true(worst_hold(s, joint) < 1e-12);
        }
    }
    spar_session_destroy(&s);
}

/* ---- energy ---- */

static spar_member *make_accounted(spar_session *s, const char *name, const double x[3], double m, const double c[3],
                                   const double J[3]) {
    double mass[36];
    spar_member *b = NULL;
    scene_mass(mass, m, c, J);
    OK(s, spar_rigid_create(s, name, x, upright, mass, &b));
    OK(s, spar_member_set_effects(b, SPAR_EFFECT_WORK, 0));
    OK(s, spar_member_commit(b));
    return b;
}

/* Kinetic and potential energy. */
static double energy_of(spar_session *s, const spar_member *m) {
    double e[SPAR_ENERGY_COUNT];
    OK(s, spar_member_get_energy(m, SPAR_ENERGY_COUNT, e));
    return e[SPAR_ENERGY_KINETIC] + e[SPAR_ENERGY_GRAVITY];
}

/* What a run may lose of its balance, J, at worst: of all, and of one member. */
typedef struct ledger {
    double all, member, spring, damper, drive, load;
} ledger;

/* An arm on a hinge with spring, damper, preload and a motor; on it a slide that is driven, with a weight, and a bob on
   a ball joint that turns about all axes, with a spring and damper that couple two of them, held by a line too. */
static ledger keep_ledger(double dt) {
    const double c[3] = {0.5, 0, 0.1}, down[3] = {0, 0.1, -0.4}, J[3] = {0.3, 0.5, 0.4}, tip[3] = {1, 0, 0},
                 peg[3] = {1, 1, 0.5}, end[3] = {1, 0.1, -0.4}, motor[6] = {0, 0, 0, 0, -3, 0},
                 wound[6] = {0, 0, 0, 0, 2, 0};
    double K[36] = {0}, C[36] = {0};
    spar_session *s = scene_session();
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -9.81}));
    OK(s, spar_session_set_integrator(s, 1, 1));
    spar_member *b[3] = {make_accounted(s, "arm", zero, 2, c, J), make_accounted(s, "weight", tip, 1, zero, J),
                         make_accounted(s, "bob", tip, 1, down, J)};
    spar_joint *j[4] = {scene_joint(s, "hinge", b[0], 0, NULL, 0, SPAR_FREE_RY),
                        scene_joint(s, "slide", b[1], 0, b[0], 0, SPAR_FREE_Z),
                        scene_joint(s, "ball", b[2], 0, b[0], 0, 56), NULL};
    OK(s, spar_joint_set_frame(j[1], tip, NULL));
    OK(s, spar_joint_set_frame(j[2], tip, NULL));
    OK(s, spar_link_create(s, "line", b[2], 0, end, NULL, 0, peg, &j[3]));
    OK(s, spar_link_set_spring(j[3], 20, 0.3, 0.9, 0));
    K[28] = 15, C[28] = 0.5;
    OK(s, spar_joint_set_spring(j[0], K, C, wound));
    OK(s, spar_joint_set_load(j[0], motor));
    memset(K, 0, sizeof K);
    memset(C, 0, sizeof C);
    K[21] = 4, K[28] = 5, K[35] = 6, K[22] = K[27] = 1;
    C[21] = 0.2, C[28] = 0.3, C[35] = 0.1, C[22] = C[27] = 0.1;
    OK(s, spar_joint_set_spring(j[2], K, C, NULL));
    OK(s, spar_joint_set_driven(j[1], SPAR_FREE_Z));
    ledger worst = {0};
    double first = 0, first_of[3] = {0};
    for (int i = 1; i <= (int)lround(1.5 / dt); i++) {
        double t = i * dt, z[6] = {0}, v[6] = {0}, a[6] = {0}, all = 0;
        z[2] = 0.1 * (1 - cos(5 * t)), v[2] = 0.5 * sin(5 * t), a[2] = 2.5 * cos(5 * t);
        OK(s, spar_joint_drive(j[1], z, v, a));
        OK(s, spar_step(s, dt, NULL, NULL, NULL));
        for (int k = 0; k < 3; k++) {
            double work[SPAR_WORK_COUNT], e = energy_of(s, b[k]);
            OK(s, spar_member_get_work(b[k], SPAR_WORK_COUNT, work));
            all += e;
            e -= work[SPAR_WORK_JOINTS];
            first_of[k] = i == 1 ? e : first_of[k];
            worst.member = fmax(worst.member, fabs(e - first_of[k]));
        }
        worst.spring = worst.damper = worst.drive = worst.load = 0;
        for (int k = 0; k < 4; k++) {
            double e[SPAR_JOINT_ENERGY_COUNT];
            OK(s, spar_joint_get_energy(j[k], SPAR_JOINT_ENERGY_COUNT, e));
            worst.spring += e[SPAR_JOINT_ENERGY_SPRING], worst.damper += e[SPAR_JOINT_ENERGY_DAMPER];
            worst.drive += e[SPAR_JOINT_ENERGY_DRIVE], worst.load += e[SPAR_JOINT_ENERGY_LOAD];
        }
        all += worst.spring + worst.damper - worst.drive - worst.load;
        first = i == 1 ? all : first;
        worst.all = fmax(worst.all, fabs(all - first));
    }
    spar_session_destroy(&s);
    return worst;
}

/* Nothing is lost, to dt^2: of the whole (energies of members and springs, less what drive and motor give, and the
   dampers take), and of each member beside what joints give it; every part of the account has its share. */
static void test_ledger(void **state) {
    (void)state;
    ledger a = keep_ledger(0.004), b = keep_ledger(0.002);
    NEAR(log2(a.all / b.all), 2, 0.2);
    NEAR(log2(a.member / b.member), 2, 0.2);
    assert_true(b.all < 1e-3 && b.member < 1e-3);
    assert_true(b.damper > 0.1 && fabs(b.drive) > 0.1 && fabs(b.load) > 0.1 && fabs(b.spring) > 0.1);
}

/* A flywheel on a bearing with a motor of 2 N m: the motor gives 2 times the angle, and that is the kinetic energy. A
   joint of members without SPAR_EFFECT_WORK has no account. */
static void test_motor(void **state) {
    (void)state;
    const double J[3] = {1, 1, 0.5}, load[6] = {0, 0, 0, 0, 0, 2};
    double z[6], e[SPAR_JOINT_ENERGY_COUNT];
    spar_session *s = scene_session();
    spar_member *wheel = make_accounted(s, "wheel", zero, 1, zero, J), *other = scene_body(s, "other", zero, 1, J);
    spar_joint *bearing = scene_joint(s, "bearing", wheel, 0, NULL, 0, SPAR_FREE_RZ), *spare;
    spare = scene_joint(s, "spare", other, 0, NULL, 0, 63);
    OK(s, spar_joint_set_load(bearing, load));
    scene_run(s, 0.01, 100);
    OK(s, spar_joint_get_motion(bearing, z, NULL, NULL));
    OK(s, spar_joint_get_energy(bearing, SPAR_JOINT_ENERGY_COUNT, e));
    NEAR(e[SPAR_JOINT_ENERGY_LOAD], 2 * z[5], 1e-12);
    NEAR(e[SPAR_JOINT_ENERGY_LOAD], energy_of(s, wheel), 1e-10);
    NEAR(z[5], 2 / 0.5 / 2, 1e-12); /* a constant acceleration is exact */
    assert_int_equal(spar_joint_get_energy(spare, SPAR_JOINT_ENERGY_COUNT, e), SPAR_ERR_STATE);
    assert_non_null(strstr(spar_session_message(s), "SPAR_EFFECT_WORK"));
    spar_session_destroy(&s);
}

/* Pairs of bodies, each pair on a hinge of its own: as many assemblies. All fall by g t^2 / 2 and no hinge carries a
   load. Returns the bytes that are allocated after a step (glibc; elsewhere, and under sanitizers, 0). */
static size_t drop_pairs(int pairs) {
    const double g = 9.81, dt = 0.01, J[3] = {1, 2, 3};
    const size_t before = ALLOCATED_BYTES;
    spar_session *s = scene_session();
    spar_member *last = NULL;
    spar_joint *hinge = NULL;
    OK(s, spar_session_set_gravity(s, (double[]){0, 0, -g}));
    for (int i = 0; i < pairs; i++) {
        char name[3][32];
        for (int k = 0; k < 3; k++) {
            snprintf(name[k], sizeof name[k], "pair %d part %d", i, k);
        }
        const double x[3] = {3.0 * i, 0, 0};
        spar_member *first = scene_body(s, name[0], x, 1, J);
        last = scene_body(s, name[1], x, 2, J);
        hinge = scene_joint(s, name[2], first, 0, last, 0, SPAR_FREE_RX);
    }
    double q[7], load[6];
    OK(s, spar_step(s, dt, NULL, NULL, NULL));
    OK(s, spar_member_get_motion(last, q, NULL, NULL));
    OK(s, spar_joint_get_load(hinge, load));
    NEAR(q[2], -g * dt * dt / 2, 1e-14);
    for (int k = 0; k < 6; k++) {
        NEAR(load[k], 0, 1e-12);
    }
    const size_t after = ALLOCATED_BYTES;
    spar_session_destroy(&s);
    return after > before ? after - before : 0;
}

/* Twice as many assemblies take twice the memory: each has that of its own members and joints. */
static void test_memory_is_linear(void **state) {
    (void)state;
    const size_t some = drop_pairs(300), twice = drop_pairs(600);
    assert_true(twice <= some * 21 / 10);
}

/* Glass fibres of 1 m, clamped, with a tenth of their mass at the end, in a gravity that bends them by the same angle:
   welded to a body, and with the mass attached to the section. The thinnest is 6e9 times as stiff along as across:
   the rounding of its condensed stiffness is small beside the bending stiffness, and no reason to refuse. Expected: the
   same tip, to Newton's tolerance on this stiffness, 1e-5. */
static void test_thin_fibres(void **state) {
    (void)state;
    static const double diameter[3] = {1e-3, 1e-4, 5e-5};
    for (int k = 0; k < 3; k++) {
        const double d = diameter[k], ratio = 1e6 * d * d, end = 1, centre[3] = {0, 0, 0}, tip[3] = {1, 0, 0};
        const double m = 0.1 * 2500 * 3.14159265358979 / 4 * d * d, J[3] = {m * d * d, m * d * d, m * d * d};
        double property[SPAR_SECTION_COUNT], K[36], M[36], own[36], q[2][7];
        for (int welded = 0; welded < 2; welded++) {
            spar_session *s = NULL;
            OK(s, spar_session_create(&s));
            const double gravity[3] = {0, 0, -9.81 * (ratio < 1 ? ratio : 1)};
            OK(s, spar_session_set_gravity(s, gravity));
            OK(s, spar_section_from_shape(SPAR_SHAPE_CIRCLE, 1, &d, 70e9, 0.2, 2500, SPAR_SECTION_COUNT, property));
            OK(s, spar_section_build(SPAR_SECTION_COUNT, property, K, M));
            spar_member *b = scene_beam(s, "fibre", 1, 8, 1, K, M);
            OK(s, spar_member_set_root(b, SPAR_ROOT_FIXED));
            scene_mass(own, m, centre, J);
            OK(s, spar_beam_set_masses(b, !welded, &end, own));
            OK(s, spar_member_commit(b));
            if (welded) {
                (void)scene_joint(s, "weld", scene_body(s, "bead", tip, m, J), 0, b, 7, 0);
            }
            OK(s, spar_member_solve_static(b, 4));
            scene_tip(b, q[welded]);
            spar_session_destroy(&s);
        }
        assert_true(q[0][2] < -0.3);
        NEAR(q[1][2], q[0][2], 1e-5);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_thin_fibres),
        cmocka_unit_test(test_raft),
        cmocka_unit_test(test_welded_in_a_fluid),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_adrift),
        cmocka_unit_test(test_joint_that_comes_later),
        cmocka_unit_test(test_modes_of_a_weld),
        cmocka_unit_test(test_drivetrain),
        cmocka_unit_test(test_any_step),
        cmocka_unit_test(test_many_steps),
        cmocka_unit_test(test_ledger),
        cmocka_unit_test(test_motor),
        cmocka_unit_test(test_memory_is_linear),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
