/* Triples where the host keeps them: by component, in records, in double and single precision, against the same fluid
 * packed, to the bit; what lies between the numbers is not touched. */
#include "check.h"

#include "fluid/fluid.h"
#include "math/rotation.h"
#include "support/lines.h"

#include <spar/spar_aero.h>
#include <stdlib.h>
#include <string.h>

enum { N = 300 /* more than one tile of the kernels */, MOST = 32, ROOM = 16 * N };

/* Packed, by component (with a gap and without), in records, components and nodes both apart. */
static const int64_t layouts[][2] = {{3, 1}, {1, N}, {1, N + 7}, {8, 1}, {9, 4}, {2, 2 * N + 1}};
enum { LAYOUTS = sizeof layouts / sizeof *layouts };

typedef struct pair {
    spar_session *session;
    spar_member *member;
    spar_fluid *packed, *other;
    int64_t nodes;
    double xr[MOST][3], X[N][3], force[N][3], moment[N][3];
} pair;

static spar_fluid *add(const pair *p, const char *name) {
    spar_fluid *f = NULL;
    OK(p->session, spar_fluid_create(p->member, name, &f));
    OK(p->session, spar_fluid_set_motion_nodes(f, N, p->X[0]));
    OK(p->session, spar_fluid_set_force_nodes(f, N, p->X[0]));
    OK(p->session, spar_fluid_map(f));
    return f;
}

/* A beam of some elements, or a point: its kernels store otherwise. Node forces are kept. */
static void pair_begin(pair *p, int elements) {
    unsigned long long seed = 3;
    const double eta[2] = {0, 1}, xyz[2][3] = {{0, 0, 0}, {10, 1, 0}};
    memset(p, 0, sizeof *p);
    OK(NULL, spar_session_create(&p->session));
    if (elements > 0) {
        OK(p->session, spar_beam_create(p->session, "beam", elements, 5, &p->member));
        OK(p->session, spar_beam_set_axis(p->member, 2, eta, xyz[0], NULL));
    } else {
        OK(p->session, spar_point_create(p->session, "point", NULL, NULL, &p->member));
    }
    OK(p->session, spar_member_set_external(p->member, 1));
    OK(p->session, spar_member_set_effects(p->member, SPAR_EFFECT_FLUID_HISTORY, 0));
    OK(p->session, spar_member_commit(p->member));
    OK(p->session, spar_member_get_count(p->member, &p->nodes));
    OK(p->session, spar_member_get_reference(p->member, p->xr[0], NULL));
    for (int j = 0; j < N; j++) {
        for (int i = 0; i < 3; i++) {
            p->X[j][i] = (i == 0 ? 5 : 0) + (i == 0 ? 5 : 0.5) * line_random(&seed);
            p->force[j][i] = line_random(&seed), p->moment[j][i] = line_random(&seed);
        }
    }
    p->packed = add(p, "packed");
    p->other = add(p, "other");
}

static void pair_move(const pair *p, double t) {
    double q[MOST][7], v[MOST][6], a[MOST][6];
    for (int l = 0; l < p->nodes; l++) {
        double s = 0.1 * p->xr[l][0], psi[3] = {0.4 * t * s, -0.3 * t, 0.5 * t * s};
        spari_quat_exp(psi, q[l] + 3);
        for (int i = 0; i < 6; i++) {
            v[l][i] = sin(t + i + s), a[l][i] = cos(2 * t - i + s);
        }
        memcpy(q[l], v[l], 3 * sizeof q[l][0]);
    }
    OK(p->session, spar_member_set_motion(p->member, q[0], v[0], a[0]));
}

/* Arrays of this test: all guard bytes, but for what a layout says. */
static const double guard = -7.25e77;
static const float guard_f32 = -7.25e7F;

static int is_of(const int64_t l[2], int64_t at) {
    for (int i = 0; i < 3; i++) {
        int64_t rest = at - i * l[1];
        if (rest >= 0 && rest % l[0] == 0 && rest / l[0] < N) {
            return 1;
        }
    }
    return 0;
}

static void clear(double *x, float *f) {
    for (int i = 0; i < ROOM; i++) {
        x[i] = guard, f[i] = guard_f32;
    }
}

/* The numbers of the layout are those of the packed array; all others are as before. */
static void must_be_laid(const int64_t l[2], const double *got, const double *want) {
    for (int64_t j = 0; j < N; j++) {
        for (int i = 0; i < 3; i++) {
            assert_memory_equal(&got[j * l[0] + i * l[1]], &want[3 * j + i], sizeof *got);
        }
    }
    for (int64_t at = 0; at < ROOM; at++) {
        assert_true(is_of(l, at) || got[at] == guard);
    }
}

static void must_be_laid_f32(const int64_t l[2], const float *got, const float *want) {
    for (int64_t j = 0; j < N; j++) {
        for (int i = 0; i < 3; i++) {
            assert_memory_equal(&got[j * l[0] + i * l[1]], &want[3 * j + i], sizeof *got);
        }
    }
    for (int64_t at = 0; at < ROOM; at++) {
        assert_true(is_of(l, at) || got[at] == guard_f32);
    }
}

static double x[2][ROOM], v[2][ROOM], w[2][ROOM], a[2][ROOM], alpha[2][ROOM];
static float x32[2][ROOM], v32[2][ROOM];

static void compare_pulls(const pair *p, const int64_t l[2], double theta) {
    static double q[2][N][4];
    spar_fluid *f[2] = {p->packed, p->other};
    for (int k = 0; k < 2; k++) {
        double *all[] = {x[k], v[k], w[k], a[k], alpha[k]};
        for (int i = 0; i < 5; i++) {
            clear(all[i], i % 2 ? x32[k] : v32[k]);
        }
        OK(p->session, spar_fluid_pull_motion_f32(f[k], theta, x32[k], v32[k]));
        OK(p->session,
           spar_fluid_pull_poses(f[k], SPAR_NODES_MOTION, theta, x[k], q[k][0], v[k], w[k], a[k], alpha[k]));
    }
    must_be_laid(l, x[1], x[0]);
    must_be_laid(l, v[1], v[0]);
    must_be_laid(l, w[1], w[0]);
    must_be_laid(l, a[1], a[0]);
    must_be_laid(l, alpha[1], alpha[0]);
    must_be_laid_f32(l, x32[1], x32[0]);
    must_be_laid_f32(l, v32[1], v32[0]);
    assert_memory_equal(q[0], q[1], sizeof q[0]); /* always packed */
    clear(x[1], x32[1]);
    clear(v[1], v32[1]);
    OK(p->session, spar_fluid_pull_motion(f[0], theta, x[0], v[0]));
    OK(p->session, spar_fluid_pull_motion(f[1], theta, x[1], v[1]));
    must_be_laid(l, x[1], x[0]);
    must_be_laid(l, v[1], v[0]);
}

/* All pulls at motion nodes, of beams of one element and more and of a point, at t^n, between and t^{n+1}. */
static void pulls_lie_where_asked(void **state) {
    (void)state;
    for (int elements = 0; elements < 4; elements++) {
        pair p;
        pair_begin(&p, elements);
        pair_move(&p, 0.3);
        OK(p.session, spar_step_begin(p.session, 0.1));
        pair_move(&p, 0.7);
        for (int k = 0; k < LAYOUTS; k++) {
            OK(p.session, spar_fluid_set_layout(p.other, SPAR_NODES_MOTION, layouts[k][0], layouts[k][1]));
            for (int i = 0; i < 3; i++) {
                compare_pulls(&p, layouts[k], 0.5 * i);
            }
        }
        spar_session_destroy(&p.session);
    }
}

/* Numbers of the layout from packed ones, guards (not a number) between. */
static void lay(const int64_t l[2], const double *from, double *to, float *to_f32) {
    for (int i = 0; i < ROOM; i++) {
        to[i] = NAN, to_f32[i] = NAN;
    }
    for (int64_t j = 0; j < 3 * N; j++) {
        int64_t at = j / 3 * l[0] + j % 3 * l[1];
        to[at] = from[j];
        to_f32[at] = (float)from[j];
    }
}

/* Pushes of one kind to both fluids: at t^{n+1} in double, in single, and over a part of the step. The audit, what is
   kept and the places of the force nodes are to the bit those of the packed one. */
static void compare_pushes(const pair *p, const int64_t l[2], int kind) {
    static double f[2][ROOM], m[2][ROOM], audit[2][8], total[2][6];
    static float f32[2][ROOM], m32[2][ROOM];
    spar_fluid *fluid[2] = {p->packed, p->other};
    for (int k = 0; k < 2; k++) {
        const int64_t *here = k ? l : layouts[0];
        lay(here, p->force[0], f[k], f32[k]);
        lay(here, p->moment[0], m[k], m32[k]);
        OK(p->session, kind == 0   ? spar_fluid_push_forces(fluid[k], f[k], m[k])
                       : kind == 1 ? spar_fluid_push_forces_f32(fluid[k], f32[k], m32[k])
                                   : spar_fluid_push_forces_at(fluid[k], 0.5, f[k], m[k]));
        OK(p->session, spar_fluid_get_audit(fluid[k], 8, audit[k]));
        OK(p->session, spar_fluid_sum_loads(fluid[k], NULL, total[k], total[k] + 3));
        clear(x[k], x32[k]);
        clear(v[k], v32[k]);
        clear(w[k], v32[k]);
        OK(p->session, spar_fluid_pull_forces(fluid[k], 0.5, x[k]));
        OK(p->session, spar_fluid_pull_forces_f32(fluid[k], 0.5, x32[k]));
        OK(p->session, spar_fluid_pull_poses(fluid[k], SPAR_NODES_FORCE, 0.5, v[k], NULL, w[k], NULL, NULL, NULL));
    }
    assert_memory_equal(audit[0], audit[1], sizeof audit[0]);
    assert_memory_equal(total[0], total[1], sizeof total[0]);
    assert_true(spari_norm(total[0]) > 1);
    must_be_laid(l, x[1], x[0]);
    must_be_laid_f32(l, x32[1], x32[0]);
    must_be_laid(l, v[1], v[0]);
    must_be_laid(l, w[1], w[0]);
}

static void pushes_come_from_where_asked(void **state) {
    (void)state;
    for (int elements = 0; elements < 4; elements++) {
        for (int k = 0; k < LAYOUTS; k++) {
            for (int kind = 0; kind < 3; kind++) {
                pair p;
                pair_begin(&p, elements);
                OK(p.session, spar_session_set_reproducible(p.session, k % 2));
                OK(p.session, spar_step_begin(p.session, 0.1));
                pair_move(&p, 0.7);
                OK(p.session, spar_fluid_set_layout(p.other, SPAR_NODES_FORCE, layouts[k][0], layouts[k][1]));
                compare_pushes(&p, layouts[k], kind);
                spar_session_destroy(&p.session);
            }
        }
    }
}

/* A trial that leaves things out answers by the layout too. */
static void left_out_by_layout(void **state) {
    (void)state;
    pair p;
    pair_begin(&p, 2);
    const int64_t *l = layouts[2];
    OK(p.session, spar_fluid_set_layout(p.other, SPAR_NODES_MOTION, l[0], l[1]));
    OK(p.session, spar_fluid_set_layout(p.other, SPAR_NODES_FORCE, l[0], l[1]));
    pair_move(&p, 0.4);
    spar_fluid *f[2] = {p.packed, p.other};
    for (int k = 0; k < 2; k++) {
        spari_fluid_mute(f[k], SPARI_MUTE_VELOCITY | SPARI_MUTE_POSES | SPARI_MUTE_HISTORY);
        double *all[] = {x[k], v[k], w[k], a[k]};
        for (int i = 0; i < 4; i++) {
            clear(all[i], x32[k]);
        }
        OK(p.session, spar_fluid_pull_poses(f[k], SPAR_NODES_MOTION, 1, x[k], NULL, v[k], w[k], NULL, NULL));
        OK(p.session, spar_fluid_pull_forces(f[k], 1, a[k]));
        spari_fluid_mute(f[k], 0);
    }
    must_be_laid(l, x[1], x[0]);
    must_be_laid(l, v[1], v[0]);
    must_be_laid(l, w[1], w[0]);
    must_be_laid(l, a[1], a[0]);
    assert_true(v[0][4] == 0 && w[0][4] == 0 && x[0][4] != 0);
    spar_session_destroy(&p.session);
}

/* ---- setting it ---- */

/* It can be read, is packed by (3, 1), goes with the nodes of its set and not with the other's; a number that is none
   is found where it is. Blade elements refuse it: their arrays are packed. */
static void life_of_layouts(void **state) {
    (void)state;
    pair p;
    int64_t node, component;
    const double eta[2] = {0, 1};
    pair_begin(&p, 2);
    spar_session *s = p.session;
    for (int which = 0; which < 2; which++) {
        OK(s, spar_fluid_set_layout(p.other, which, 1, N));
    }
    OK(s, spar_fluid_get_layout(p.other, SPAR_NODES_FORCE, &node, &component));
    assert_true(node == 1 && component == N);
    static double f[ROOM];
    static float unused[ROOM];
    lay(layouts[1], p.force[0], f, unused);
    f[2 * N + 17] = INFINITY;
    OK(s, spar_step_begin(s, 0.1));
    REFUSED(s, SPAR_ERR_ARGUMENT, "force of node 17, component 2", spar_fluid_push_forces(p.other, f, NULL));
    OK(s, spar_fluid_set_layout(p.other, SPAR_NODES_MOTION, 8, 1)); /* within a step too */
    OK(s, spar_step_reject(s));
    OK(s, spar_fluid_set_motion_nodes(p.other, N, p.X[0]));
    OK(s, spar_fluid_get_layout(p.other, SPAR_NODES_MOTION, &node, &component));
    assert_true(node == 3 && component == 1);
    OK(s, spar_fluid_get_layout(p.other, SPAR_NODES_FORCE, NULL, &component));
    assert_true(component == N);
    OK(s, spar_fluid_set_stations(p.other, 2, eta, NULL));
    OK(s, spar_fluid_get_layout(p.other, SPAR_NODES_FORCE, &node, NULL));
    assert_true(node == 3);
    OK(s, spar_fluid_map(p.other));
    spar_aero *aero = NULL;
    OK(s, spar_fluid_set_layout(p.other, SPAR_NODES_FORCE, 1, 2));
    REFUSED(s, SPAR_ERR_ARGUMENT, "layout", spar_aero_create(1, &p.other, &aero));
    OK(s, spar_fluid_set_layout(p.other, SPAR_NODES_FORCE, 3, 1));
    OK(s, spar_aero_create(1, &p.other, &aero));
    OK(s, spar_fluid_set_layout(p.other, SPAR_NODES_MOTION, 4, 1));
    const double wind[2][3] = {{5, 0, 0}, {5, 0, 0}};
    spar_polar *polar = NULL;
    OK(s, spar_polar_create(2, eta, eta, eta, NULL, &polar));
    for (int i = 0; i < 2; i++) {
        OK(s, spar_aero_set_section(aero, i, 1, 0, polar));
    }
    REFUSED(s, SPAR_ERR_STATE, "layout", spar_aero_solve(aero, 1.2, wind[0], 1));
    spar_aero_destroy(&aero);
    spar_polar_destroy(&polar);
    spar_session_destroy(&p.session);
}

static void bad_layouts_are_refused(void **state) {
    (void)state;
    pair p;
    int64_t node, component;
    pair_begin(&p, 1);
    spar_session *s = p.session;
    OK(s, spar_fluid_set_layout(p.other, SPAR_NODES_MOTION, 8, 2));
    const int64_t bad[][2] = {{0, 1},         {3, 0}, {-3, 1},          {3, -1},
                              {1, 1},         {2, 1}, {1, N - 1},       {4, 2},
                              {6, 3},         {3, 3}, {INT64_MAX, 1},   {1, INT64_MAX},
                              {INT64_MIN, 1}, {2, N}, {5, 5 * (N - 1)}, {INT64_C(1) << 41, 1}};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        REFUSED(s, SPAR_ERR_ARGUMENT, "node stride",
                spar_fluid_set_layout(p.other, SPAR_NODES_MOTION, bad[k][0], bad[k][1]));
    }
    assert_int_equal(spar_fluid_set_layout(NULL, 0, 3, 1), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_get_layout(NULL, 0, &node, NULL), SPAR_ERR_ARGUMENT);
    REFUSED(s, SPAR_ERR_ARGUMENT, "set 2", spar_fluid_set_layout(p.other, 2, 3, 1));
    REFUSED(s, SPAR_ERR_ARGUMENT, "set -1", spar_fluid_get_layout(p.other, -1, &node, &component));
    OK(s, spar_fluid_get_layout(p.other, SPAR_NODES_MOTION, &node, &component));
    assert_true(node == 8 && component == 2);
    OK(s, spar_fluid_set_motion_nodes(p.other, 0, NULL)); /* of none or one nothing can overlap */
    OK(s, spar_fluid_set_layout(p.other, SPAR_NODES_MOTION, 1, 1));
    OK(s, spar_fluid_map(p.other));
    OK(s, spar_fluid_pull_motion(p.other, 1, NULL, NULL));
    OK(s, spar_fluid_set_motion_nodes(p.other, 1, p.X[0]));
    OK(s, spar_fluid_set_layout(p.other, SPAR_NODES_MOTION, 1, 1));
    spar_session_destroy(&p.session);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pulls_lie_where_asked),   cmocka_unit_test(pushes_come_from_where_asked),
        cmocka_unit_test(left_out_by_layout),      cmocka_unit_test(life_of_layouts),
        cmocka_unit_test(bad_layouts_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
