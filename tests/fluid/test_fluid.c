/* Fluids through the public interface: maps, motion out, loads in, histories, audit, refusals. Members are external or
 * points, so that their motion is what the test says. */
#include "math/rotation.h"
#include "support/lines.h"
#include <cmocka.h>
#include <math.h>
#include <spar/spar.h>
#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* cmocka's own compares floats */
#define CLOSE(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))
#define OK(call) assert_int_equal(call, SPAR_OK)

enum { MOST = 64 };

typedef struct rig {
    spar_session *session;
    spar_member *member;
    int64_t nodes;
    double x[MOST][3], qr[MOST][4], q[MOST][7], v[MOST][6], a[MOST][6];
} rig;

/* A bent, twisted beam of two elements with eight nodes each, moved by the host. */
static void rig_start(rig *r, int on, int off) {
    memset(r, 0, sizeof *r);
    OK(spar_session_create(&r->session));
    OK(spar_beam_create(r->session, "blade", 2, 8, &r->member));
    double eta[21], xyz[21][3], twist[21];
    for (int i = 0; i < 21; i++) {
        eta[i] = 0.05 * i;
        xyz[i][0] = 10 * eta[i], xyz[i][1] = 0.8 * eta[i] * eta[i], xyz[i][2] = -0.5 * pow(eta[i], 3);
        twist[i] = 0.4 * (1 - eta[i]);
    }
    OK(spar_beam_set_axis(r->member, 21, eta, xyz[0], twist));
    OK(spar_member_set_external(r->member, 1));
    OK(spar_member_set_effects(r->member, on, off));
    OK(spar_member_commit(r->member));
    OK(spar_member_get_count(r->member, &r->nodes));
    assert_int_equal(r->nodes, 16);
    OK(spar_member_get_reference(r->member, r->x[0], r->qr[0]));
    for (int l = 0; l < 16; l++) {
        r->q[l][3] = 1;
    }
}

static void rig_end(rig *r) {
    spar_session_destroy(&r->session);
    assert_null(r->session);
}

/* A smooth deformed state, larger with `size`; joints move once. */
static void bend(rig *r, double size) {
    for (int l = 0; l < 16; l++) {
        double s = r->x[l][0] / 10, p[3] = {0.3 * size + s * size, -0.7 * s * size, 0.5 * s * s * size};
        spari_quat_exp(p, r->q[l] + 3);
        for (int i = 0; i < 3; i++) {
            r->q[l][i] = size * (0.3 * i + sin(s * (i + 1)));
            r->v[l][i] = size * cos(3 * s + i), r->v[l][3 + i] = size * sin(2 * s - i);
            r->a[l][i] = size * (s + i), r->a[l][3 + i] = size * s * s;
        }
    }
    OK(spar_member_set_motion(r->member, r->q[0], r->v[0], r->a[0]));
}

static void scatter(double (*x)[3], int n, unsigned long long *seed) {
    for (int j = 0; j < n; j++) {
        double t = 0.5 + 0.5 * line_random(seed);
        x[j][0] = 10 * t, x[j][1] = 0.8 * t * t + 0.4 * line_random(seed), x[j][2] = 0.4 * line_random(seed);
    }
}

static int says(const rig *r, const char *text) {
    return strstr(spar_session_message(r->session), text) != NULL;
}

/* ---- the map ---- */

/* The basis gives the foot from the nodes, the foot and the arm give the node back, the basis sums to one, and the arm
   is perpendicular to the line where the foot is inside. */
static void map_hangs_together(void **state) {
    (void)state;
    enum { N = 300 };
    rig r;
    unsigned long long seed = 12;
    static double x[N][3], eta[N], distance[N], foot[N][3], q[N][4], con[N][3], phi[N][8];
    static int64_t first[N];
    static int flags[N];
    rig_start(&r, 0, 0);
    scatter(x, N, &seed);
    spar_fluid *f;
    OK(spar_fluid_create(r.member, "surface", &f));
    OK(spar_fluid_set_motion_nodes(f, N, x[0]));
    OK(spar_fluid_set_force_nodes(f, 0, NULL));
    OK(spar_fluid_map(f));
    int64_t n;
    OK(spar_fluid_get_count(f, SPAR_NODES_MOTION, &n));
    assert_int_equal(n, N);
    OK(spar_fluid_get_map(f, SPAR_NODES_MOTION, eta, distance, flags));
    OK(spar_fluid_get_nearest(f, SPAR_NODES_MOTION, foot[0], q[0], con[0]));
    OK(spar_fluid_get_basis(f, SPAR_NODES_MOTION, first, phi[0]));
    for (int j = 0; j < N; j++) {
        double sum = 0, at[3] = {0}, turn[4] = {0};
        assert_true(first[j] == 0 || first[j] == 8);
        assert_true(eta[j] >= 0 && eta[j] <= 1);
        assert_int_equal(first[j] == 8, eta[j] > 0.5);
        for (int l = 0; l < 8; l++) {
            sum += phi[j][l];
            for (int i = 0; i < 4; i++) {
                turn[i] += phi[j][l] * r.qr[first[j] + l][i];
                at[i % 3] += i < 3 ? phi[j][l] * r.x[first[j] + l][i] : 0;
            }
        }
        CLOSE(sum, 1, 1e-14);
        spari_quat_normalise(turn);
        CLOSE(fabs(spari_quat_dot(turn, q[j])), 1, 1e-14);
        CLOSE(distance[j], spari_norm(con[j]), 1e-15);
        for (int i = 0; i < 3; i++) {
            CLOSE(at[i], foot[j][i], 1e-13);
            CLOSE(foot[j][i] + con[j][i], x[j][i], 1e-13);
        }
        if (eta[j] > 0.0005 && eta[j] < 0.9995 && fabs(eta[j] - 0.5) > 5e-7) {
            double tangent[3] = {1, 0, 0};
            spari_rotate(q[j], tangent, tangent);
            CLOSE(spari_dot(tangent, con[j]), 0, 2e-3); /* the frames' tangent is the axis', not the polynomial's */
        }
    }
    OK(spar_fluid_get_map(f, SPAR_NODES_FORCE, NULL, NULL, NULL));
    rig_end(&r);
}

/* Sections: feet where they are asked for, arms by R(q_map) offset, one set for motion and forces; at rest the node
   stands at foot + arm and its orientation is q_map. */
static void sections_stand_where_asked(void **state) {
    (void)state;
    enum { N = 7 };
    const double eta[N] = {0, 0.15, 0.4, 0.5, 0.65, 0.9, 1};
    const double offset[N][3] = {{0, 0.1, 0},    {0, -0.2, 0.3}, {0.1, 0, 0}, {0, 0, 0},
                                 {0, 0.5, -0.1}, {0, 0, 1},      {0, 0.25, 0}};
    double got[N], distance[N], foot[N][3], q[N][4], con[N][3], x[N][3], now[N][4], want[3];
    int flags[N];
    rig r;
    rig_start(&r, 0, 0);
    spar_fluid *f;
    OK(spar_fluid_create(r.member, "sections", &f));
    OK(spar_fluid_set_stations(f, N, eta, offset[0]));
    assert_int_equal(spar_fluid_pull_motion(f, 1, x[0], NULL), SPAR_ERR_STATE);
    assert_true(says(&r, "spar_fluid_map") && says(&r, "sections") && says(&r, "blade"));
    OK(spar_fluid_map(f));
    for (int which = 0; which < 2; which++) {
        OK(spar_fluid_get_map(f, which, got, distance, flags));
        OK(spar_fluid_get_nearest(f, which, foot[0], q[0], con[0]));
        for (int j = 0; j < N; j++) {
            CLOSE(got[j], eta[j], 1e-15);
            CLOSE(distance[j], spari_norm(offset[j]), 1e-15);
            assert_int_equal(flags[j], 0);
            spari_rotate(q[j], offset[j], want);
            for (int i = 0; i < 3; i++) {
                CLOSE(con[j][i], want[i], 1e-15);
            }
        }
    }
    OK(spar_fluid_pull_motion(f, 1, x[0], NULL));
    OK(spar_fluid_pull_poses(f, SPAR_NODES_MOTION, 1, NULL, now[0], NULL, NULL, NULL, NULL));
    for (int j = 0; j < N; j++) {
        CLOSE(fabs(spari_quat_dot(now[j], q[j])), 1, 1e-15);
        for (int i = 0; i < 3; i++) {
            CLOSE(x[j][i], foot[j][i] + con[j][i], 1e-14);
        }
    }
    rig_end(&r);
}

/* A whole turn of the set-up: orientation now = R(q) R(q_map), places turned with it, for a rigid body and a point
 * alike. */
static void bodies_carry_their_nodes(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        spar_session *s;
        spar_member *m;
        spar_fluid *f;
        const double at[3] = {1, 2, 3}, attitude[4] = {0.8, 0, 0.6, 0};
        double mass[36] = {0}, psi[3] = {0.4, -1.2, 2}, q[7] = {5, -1, 2}, v[6] = {1, 2, 3, 0.5, -0.4, 0.3};
        OK(spar_session_create(&s));
        if (kind == 0) {
            OK(spar_point_create(s, "hub", at, attitude, &m));
        } else {
            for (int i = 0; i < 6; i++) {
                mass[7 * i] = 2;
            }
            OK(spar_rigid_create(s, "hub", at, attitude, mass, &m));
            OK(spar_member_set_external(m, 1));
        }
        OK(spar_member_commit(m));
        const double node[2][3] = {{1.5, 2, 3}, {1, 2, 3}};
        double x[2][3], dx[2][3], now[2][4], omega[2][3], want[3], r[3];
        OK(spar_fluid_create(m, "shell", &f));
        OK(spar_fluid_set_motion_nodes(f, 2, node[0]));
        OK(spar_fluid_set_force_nodes(f, 2, node[0]));
        OK(spar_fluid_map(f));
        double con[2][3];
        int flags[2];
        OK(spar_fluid_get_nearest(f, SPAR_NODES_MOTION, x[0], now[0], con[0]));
        OK(spar_fluid_get_map(f, SPAR_NODES_MOTION, NULL, NULL, flags));
        assert_int_equal(flags[0] | flags[1], 0);
        CLOSE(con[0][0], 0.5, 1e-15);
        CLOSE(x[0][1], 2, 1e-15);
        spari_quat_exp(psi, q + 3);
        OK(spar_member_set_motion(m, q, v, NULL));
        OK(spar_fluid_pull_motion(f, 1, x[0], dx[0]));
        OK(spar_fluid_pull_poses(f, SPAR_NODES_MOTION, 1, NULL, now[0], NULL, omega[0], NULL, NULL));
        for (int j = 0; j < 2; j++) {
            double expect[4];
            spari_rotate(q + 3, con[j], r);
            spari_cross(v + 3, r, want);
            spari_quat_mul(q + 3, attitude, expect);
            CLOSE(fabs(spari_quat_dot(expect, now[j])), 1, 1e-15);
            assert_true(now[j][0] >= 0);
            for (int i = 0; i < 3; i++) {
                CLOSE(x[j][i], at[i] + q[i] + r[i], 1e-14);
                CLOSE(dx[j][i], v[i] + want[i], 1e-14);
                CLOSE(omega[j][i], v[3 + i], 0);
            }
        }
        const double force[2][3] = {{0, 0, 2}, {1, 1, 1}};
        double load[6], audit[8];
        OK(spar_fluid_push_forces(f, force[0], NULL));
        OK(spar_fluid_get_audit(f, 8, audit));
        CLOSE(audit[0], sqrt(1 + 1 + 9), 1e-14);
        assert_true(audit[3] < 1e-15 && audit[4] < 1e-15 && audit[5] < 1e-15 && audit[7] == 2);
        OK(spar_step_begin(s, 0.1));
        if (kind == 0) {
            OK(spar_member_get_loads(m, load));
            spari_rotate(q + 3, con[0], r);
            spari_cross(r, force[0], want);
            for (int i = 0; i < 3; i++) {
                CLOSE(load[i], force[0][i] + force[1][i], 1e-15);
                CLOSE(load[3 + i], want[i], 1e-15);
            }
        }
        OK(spar_step_reject(s));
        spar_session_destroy(&s);
    }
}

/* All of a section's motion from one call: the same bits as from the others; alpha of the consistent kind is the
   derivative of omega (checked with the kernels). Matrices: columns, or rows, are the turned axes. */
static void poses_and_matrices(void **state) {
    (void)state;
    enum { N = 5 };
    const double eta[N] = {0, 0.3, 0.5, 0.8, 1}, offset[N][3] = {{0, 0.1, 0}, {0, 0.2, 0.1}};
    double x[2][N][3], q[2][N][4], v[2][N][3], omega[2][N][3], accel[2][N][3], alpha[N][3], m[N][9], t[N][9], axis[3];
    rig r;
    rig_start(&r, 0, 0);
    spar_fluid *f;
    OK(spar_fluid_create(r.member, "sections", &f));
    OK(spar_fluid_set_stations(f, N, eta, offset[0]));
    OK(spar_fluid_map(f));
    bend(&r, 0.8);
    OK(spar_fluid_pull_poses(f, SPAR_NODES_MOTION, 1, x[0][0], q[0][0], v[0][0], omega[0][0], accel[0][0], alpha[0]));
    OK(spar_fluid_pull_motion(f, 1, x[1][0], v[1][0]));
    OK(spar_fluid_pull_poses(f, SPAR_NODES_MOTION, 1, NULL, q[1][0], NULL, omega[1][0], accel[1][0], NULL));
    assert_memory_equal(x[0], x[1], sizeof x[0]);
    assert_memory_equal(q[0], q[1], sizeof q[0]);
    assert_memory_equal(v[0], v[1], sizeof v[0]);
    assert_memory_equal(omega[0], omega[1], sizeof omega[0]);
    assert_memory_equal(accel[0], accel[1], sizeof accel[0]);
    for (int i = 0; i < 3; i++) {
        CLOSE(alpha[0][i], r.a[0][3 + i], 1e-14); /* at the root node */
    }
    OK(spar_fluid_pull_matrices(f, 1, SPAR_MATRIX_LOCAL_TO_GLOBAL, m[0]));
    OK(spar_fluid_pull_matrices(f, 1, SPAR_MATRIX_GLOBAL_TO_LOCAL, t[0]));
    for (int j = 0; j < N; j++) {
        for (int k = 0; k < 3; k++) {
            double unit[3] = {k == 0, k == 1, k == 2};
            spari_rotate(q[0][j], unit, axis);
            for (int i = 0; i < 3; i++) {
                CLOSE(m[j][3 * i + k], axis[i], 1e-15);
                CLOSE(t[j][3 * k + i], axis[i], 1e-15);
            }
        }
    }
    /* the self-test tells what is wrong */
    OK(spar_fluid_check_matrices(f, SPAR_MATRIX_LOCAL_TO_GLOBAL, m[0]));
    OK(spar_fluid_check_matrices(f, SPAR_MATRIX_GLOBAL_TO_LOCAL, t[0]));
    assert_int_equal(spar_fluid_check_matrices(f, SPAR_MATRIX_LOCAL_TO_GLOBAL, t[0]), SPAR_ERR_ARGUMENT);
    assert_true(says(&r, "node 0") && says(&r, "transposed"));
    for (int i = 0; i < 3; i++) {
        m[3][3 * i] *= -1;
    }
    assert_int_equal(spar_fluid_check_matrices(f, SPAR_MATRIX_LOCAL_TO_GLOBAL, m[0]), SPAR_ERR_ARGUMENT);
    assert_true(says(&r, "node 3") && says(&r, "determinant -1"));
    OK(spar_fluid_pull_matrices(f, 1, SPAR_MATRIX_LOCAL_TO_GLOBAL, m[0]));
    memcpy(m[1], m[4], sizeof m[1]);
    assert_int_equal(spar_fluid_check_matrices(f, SPAR_MATRIX_LOCAL_TO_GLOBAL, m[0]), SPAR_ERR_ARGUMENT);
    assert_true(says(&r, "node 1") && says(&r, "not the rotation of this section"));
    m[1][4] = NAN;
    assert_int_equal(spar_fluid_check_matrices(f, SPAR_MATRIX_LOCAL_TO_GLOBAL, m[0]), SPAR_ERR_ARGUMENT);
    assert_true(says(&r, "is not a number"));
    assert_int_equal(spar_fluid_pull_matrices(f, 1, 2, m[0]), SPAR_ERR_ARGUMENT);
    /* NULL is for a fluid that has no nodes */
    spar_fluid *empty;
    OK(spar_fluid_create(r.member, "empty", &empty));
    OK(spar_fluid_pull_matrices(empty, 1, SPAR_MATRIX_LOCAL_TO_GLOBAL, NULL));
    assert_int_equal(spar_fluid_pull_matrices(f, 1, SPAR_MATRIX_LOCAL_TO_GLOBAL, NULL), SPAR_ERR_ARGUMENT);
    rig_end(&r);
}

/* Single precision at the edge: what comes out is the double rounded; what goes in gives the load of the same numbers
 * in double. */
static void single_precision_at_the_edge(void **state) {
    (void)state;
    enum { N = 21 };
    rig r;
    unsigned long long seed = 6;
    double node[N][3], x[N][3], v[N][3], q[N][4], omega[N][3], accel[N][3], alpha[N][3], force[N][3], load[2][MOST][6],
        back[N][3];
    float xs[N][3], vs[N][3], qs[N][4], omegas[N][3], accels[N][3], alphas[N][3], again[2][N][3], forces[N][3],
        backs[N][3];
    rig_start(&r, SPAR_EFFECT_FLUID_HISTORY, 0);
    scatter(node, N, &seed);
    spar_fluid *f;
    OK(spar_fluid_create(r.member, "surface", &f));
    OK(spar_fluid_set_motion_nodes(f, N, node[0]));
    OK(spar_fluid_set_force_nodes(f, N, node[0]));
    OK(spar_fluid_map(f));
    bend(&r, 0.5);
    OK(spar_fluid_pull_motion(f, 1, x[0], v[0]));
    OK(spar_fluid_pull_motion_f32(f, 1, xs[0], vs[0]));
    OK(spar_fluid_pull_poses(f, SPAR_NODES_MOTION, 1, NULL, q[0], NULL, omega[0], accel[0], alpha[0]));
    OK(spar_fluid_pull_poses_f32(f, SPAR_NODES_MOTION, 1, again[0][0], qs[0], again[1][0], omegas[0], accels[0],
                                 alphas[0]));
    assert_memory_equal(again[0], xs, sizeof xs);
    assert_memory_equal(again[1], vs, sizeof vs);
    for (int j = 0; j < N; j++) {
        for (int i = 0; i < 4; i++) {
            assert_true(qs[j][i] == (float)q[j][i]);
        }
        for (int i = 0; i < 3; i++) {
            assert_true(xs[j][i] == (float)x[j][i] && vs[j][i] == (float)v[j][i]);
            assert_true(omegas[j][i] == (float)omega[j][i] && accels[j][i] == (float)accel[j][i]);
            assert_true(alphas[j][i] == (float)alpha[j][i]);
            forces[j][i] = (float)line_random(&seed);
            force[j][i] = forces[j][i];
        }
    }
    for (int k = 0; k < 2; k++) {
        OK(k ? spar_fluid_push_forces(f, force[0], force[0]) : spar_fluid_push_forces_f32(f, forces[0], forces[0]));
        OK(spar_step_begin(r.session, 0.1));
        OK(spar_member_get_loads(r.member, load[k][0]));
        OK(spar_fluid_pull_forces(f, 1, back[0]));
        OK(spar_fluid_pull_forces_f32(f, 1, backs[0]));
        assert_memory_equal(back, force, sizeof back);
        assert_memory_equal(backs, forces, sizeof backs);
        if (k == 0) { /* again from the start, as nothing has been accepted */
            OK(spar_step_solve(r.session));
            OK(spar_step_reject(r.session));
            rig_end(&r);
            rig_start(&r, SPAR_EFFECT_FLUID_HISTORY, 0);
            OK(spar_fluid_create(r.member, "surface", &f));
            OK(spar_fluid_set_force_nodes(f, N, node[0]));
            OK(spar_fluid_map(f));
            bend(&r, 0.5);
        }
    }
    assert_memory_equal(load[0], load[1], sizeof(double) * 6 * 16);
    forces[2][1] = NAN;
    assert_int_equal(spar_fluid_push_forces_f32(f, forces[0], NULL), SPAR_ERR_ARGUMENT);
    assert_true(says(&r, "force of node 2, component 1"));
    rig_end(&r);
}

/* ---- time ---- */

/* The average (T12) at theta, the ends exactly; on the group a quarter turn about z halves to an eighth turn. */
static void theta_lies_between_the_times(void **state) {
    (void)state;
    enum { N = 20 };
    rig r;
    unsigned long long seed = 2;
    double node[N][3], x[4][N][3], v[4][N][3], q[3][N][4], w[3][N][3], a[3][N][3];
    const double theta[4] = {0, 1, 0.5, 0.25};
    rig_start(&r, 0, 0);
    scatter(node, N, &seed);
    spar_fluid *f;
    OK(spar_fluid_create(r.member, "surface", &f));
    OK(spar_fluid_set_motion_nodes(f, N, node[0]));
    OK(spar_fluid_map(f));
    bend(&r, 0.2);
    OK(spar_step_begin(r.session, 0.1));
    bend(&r, 0.7);
    OK(spar_step_solve(r.session));
    for (int k = 0; k < 4; k++) {
        OK(spar_fluid_pull_motion(f, theta[k], x[k][0], v[k][0]));
    }
    for (int k = 0; k < 3; k++) {
        OK(spar_fluid_pull_poses(f, SPAR_NODES_MOTION, theta[k], NULL, q[k][0], NULL, w[k][0], a[k][0], NULL));
    }
    for (int j = 0; j < N; j++) {
        for (int i = 0; i < 3; i++) {
            for (int k = 2; k < 4; k++) {
                CLOSE(x[k][j][i], (1 - theta[k]) * x[0][j][i] + theta[k] * x[1][j][i], 1e-14);
                CLOSE(v[k][j][i], (1 - theta[k]) * v[0][j][i] + theta[k] * v[1][j][i], 1e-14);
            }
            CLOSE(w[2][j][i], 0.5 * (w[0][j][i] + w[1][j][i]), 1e-14);
            CLOSE(a[2][j][i], 0.5 * (a[0][j][i] + a[1][j][i]), 1e-13);
        }
        /* halfway between two unit quaternions both are equally far */
        CLOSE(fabs(spari_quat_dot(q[2][j], q[0][j])), fabs(spari_quat_dot(q[2][j], q[1][j])), 1e-14);
    }
    assert_int_equal(spar_fluid_pull_motion(f, 1.5, x[0][0], NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_pull_motion(f, NAN, x[0][0], NULL), SPAR_ERR_ARGUMENT);
    rig_end(&r);
}

static void group_interpolation_keeps_the_radius(void **state) {
    (void)state;
    const double origin[3] = {0}, none[4] = {1, 0, 0, 0}, node[3] = {2, 0, 0};
    double x[3], q[7] = {0, 0, 0, sqrt(0.5), 0, 0, sqrt(0.5)};
    spar_session *s;
    spar_member *m;
    spar_fluid *f;
    OK(spar_session_create(&s));
    OK(spar_point_create(s, "hub", origin, none, &m));
    OK(spar_member_commit(m));
    OK(spar_fluid_create(m, "arm", &f));
    OK(spar_fluid_set_option(f, "theta", "group"));
    OK(spar_fluid_set_motion_nodes(f, 1, node));
    OK(spar_fluid_map(f));
    OK(spar_step_begin(s, 1));
    OK(spar_member_set_motion(m, q, NULL, NULL));
    OK(spar_step_solve(s));
    OK(spar_fluid_pull_motion(f, 0.5, x, NULL));
    CLOSE(x[0], 2 * cos(M_PI / 4), 1e-15);
    CLOSE(x[1], 2 * sin(M_PI / 4), 1e-15);
    CLOSE(x[2], 0, 1e-15);
    spar_session_destroy(&s);
}

/* The average of the two times, (T12), cuts the corner of a turn by phi: R cos(phi/2), that is R (1 - phi^2/8) but for
   R phi^4/384. On the group the radius stays. */
static void half_step_cuts_the_corner(void **state) {
    (void)state;
    const double none[4] = {1, 0, 0, 0}, node[3] = {2, 0, 0}, phi = 0.2;
    for (int group = 0; group < 2; group++) {
        double x[3], q[7] = {0, 0, 0, cos(phi / 2), 0, 0, sin(phi / 2)};
        spar_session *s;
        spar_member *m;
        spar_fluid *f;
        OK(spar_session_create(&s));
        OK(spar_point_create(s, "hub", NULL, none, &m));
        OK(spar_member_commit(m));
        OK(spar_fluid_create(m, "arm", &f));
        OK(spar_fluid_set_option(f, "theta", group ? "group" : "average"));
        OK(spar_fluid_set_motion_nodes(f, 1, node));
        OK(spar_fluid_map(f));
        OK(spar_step_begin(s, 1));
        OK(spar_member_set_motion(m, q, NULL, NULL));
        OK(spar_step_solve(s));
        OK(spar_fluid_pull_motion(f, 0.5, x, NULL));
        double radius = hypot(x[0], x[1]);
        CLOSE(atan2(x[1], x[0]), phi / 2, 1e-15);
        CLOSE(radius, group ? 2 : 2 * cos(phi / 2), 1e-15);
        CLOSE(radius, group ? 2 : 2 * (1 - phi * phi / 8), 2 * pow(phi, 4) / 384);
        spar_session_destroy(&s);
    }
}

/* What is not asked for is not needed for the rest: any part of a pull alone gives the bits of the whole, of a beam and
   of a point; velocities are v + omega x r there. */
static void pulls_give_what_is_asked_for(void **state) {
    (void)state;
    enum { N = 300 }; /* more than a tile */
    static double node[N][3], x[N][3], v[N][3], q[N][4], w[N][3], a[N][3], alpha[N][3], y[4][N][4];
    for (int kind = 0; kind < 3; kind++) {
        rig r;
        unsigned long long seed = 9;
        spar_fluid *f;
        spar_member *point;
        double turn[4], qp[7] = {0.1, -0.2, 0.3}, vp[6] = {1, 2, 3, 0.4, 0.5, -0.6}, ap[6] = {3, 2, 1, -1, 0.5, 2};
        const double psi[3] = {0.3, 0.5, -0.2};
        rig_start(&r, 0, 0);
        bend(&r, 0.4);
        scatter(node, N, &seed);
        spari_quat_exp(psi, turn);
        memcpy(qp + 3, turn, sizeof turn);
        OK(spar_point_create(r.session, "point", NULL, NULL, &point));
        OK(spar_member_commit(point));
        OK(spar_member_set_motion(point, qp, vp, ap));
        OK(spar_fluid_create(kind == 2 ? point : r.member, "surface", &f));
        OK(spar_fluid_set_interpolation(f, kind ? SPAR_INTERPOLATE_CONSISTENT : SPAR_INTERPOLATE_NODAL));
        OK(spar_fluid_set_motion_nodes(f, N, node[0]));
        OK(spar_fluid_map(f));
        OK(spar_fluid_pull_poses(f, SPAR_NODES_MOTION, 1, x[0], q[0], v[0], w[0], a[0], alpha[0]));
        OK(spar_fluid_pull_motion(f, 1, y[0][0], NULL));
        assert_memory_equal(y[0], x, sizeof x);
        OK(spar_fluid_pull_motion(f, 1, NULL, y[0][0]));
        assert_memory_equal(y[0], v, sizeof v);
        OK(spar_fluid_pull_motion(f, 1, y[0][0], y[1][0]));
        assert_memory_equal(y[0], x, sizeof x);
        assert_memory_equal(y[1], v, sizeof v);
        OK(spar_fluid_pull_poses(f, SPAR_NODES_MOTION, 1, NULL, y[0][0], NULL, NULL, NULL, NULL));
        assert_memory_equal(y[0], q, sizeof q);
        OK(spar_fluid_pull_poses(f, SPAR_NODES_MOTION, 1, NULL, NULL, NULL, y[0][0], NULL, NULL));
        assert_memory_equal(y[0], w, sizeof w);
        OK(spar_fluid_pull_poses(f, SPAR_NODES_MOTION, 1, NULL, NULL, NULL, NULL, y[0][0], NULL));
        assert_memory_equal(y[0], a, sizeof a);
        OK(spar_fluid_pull_poses(f, SPAR_NODES_MOTION, 1, y[0][0], y[1][0], y[2][0], y[3][0], NULL, NULL));
        assert_memory_equal(y[0], x, sizeof x);
        assert_memory_equal(y[1], q, sizeof q);
        assert_memory_equal(y[2], v, sizeof v);
        assert_memory_equal(y[3], w, sizeof w);
        for (int j = 0; j < N && kind == 2; j++) {
            double arm[3], wr[3], wwr[3], ar[3];
            spari_rotate(turn, node[j], arm);
            spari_cross(vp + 3, arm, wr);
            spari_cross(vp + 3, wr, wwr);
            spari_cross(ap + 3, arm, ar);
            for (int i = 0; i < 3; i++) {
                CLOSE(x[j][i], qp[i] + arm[i], 1e-14);
                CLOSE(v[j][i], vp[i] + wr[i], 1e-13);
                CLOSE(a[j][i], ap[i] + ar[i] + wwr[i], 1e-13);
                CLOSE(w[j][i], vp[3 + i], 0);
                CLOSE(alpha[j][i], ap[3 + i], 0);
            }
            CLOSE(fabs(spari_quat_dot(q[j], turn)), 1, 1e-15);
        }
        rig_end(&r);
    }
}

/* Node forces at theta between f^n and f^{n+1}; predicted at the begin of a step by (T11), with the ratio of
   the steps; a rejected step leaves no trace. f(t) = 2 + 3 t: linear prediction is exact from the third step on. */
static void node_forces_are_kept_and_predicted(void **state) {
    (void)state;
    rig r;
    rig_start(&r, SPAR_EFFECT_FLUID_HISTORY, 0);
    const double node[3] = {5, 0.2, 0.3};
    const double dt[4] = {0.1, 0.3, 0.2, 0.05};
    double force[3], got[3], t = 0;
    spar_fluid *f;
    OK(spar_fluid_create(r.member, "line", &f));
    OK(spar_fluid_set_force_nodes(f, 1, node));
    OK(spar_fluid_map(f));
    OK(spar_fluid_pull_forces(f, 0.5, got));
    CLOSE(fabs(got[0]) + fabs(got[1]) + fabs(got[2]), 0, 0); /* nothing pushed yet */
    for (int i = 0; i < 3; i++) {
        force[i] = 2 * (i + 1);
    }
    OK(spar_fluid_push_forces(f, force, NULL)); /* at t^0 */
    for (int k = 0; k < 4; k++) {
        OK(spar_step_begin(r.session, dt[k]));
        OK(spar_fluid_pull_forces(f, 1, got));
        for (int i = 0; i < 3; i++) {
            CLOSE(got[i], (2 + 3 * (k == 0 ? 0 : t + dt[k])) * (i + 1), 1e-13); /* order 0 in the first step */
        }
        OK(spar_step_solve(r.session));
        if (k == 2) { /* once astray and back */
            force[0] = 77;
            OK(spar_fluid_push_forces(f, force, NULL));
            OK(spar_step_reject(r.session));
            OK(spar_fluid_pull_forces(f, 1, got));
            CLOSE(got[0], 2 + 3 * t, 1e-13);
            OK(spar_step_begin(r.session, dt[k]));
            OK(spar_step_solve(r.session));
        }
        for (int i = 0; i < 3; i++) {
            force[i] = (2 + 3 * (t + dt[k])) * (i + 1);
        }
        OK(spar_fluid_push_forces(f, force, NULL));
        OK(spar_fluid_pull_forces(f, 0.25, got));
        for (int i = 0; i < 3; i++) {
            CLOSE(got[i], (2 + 3 * (t + 0.25 * dt[k])) * (i + 1), 1e-13);
        }
        int done;
        OK(spar_step_check(r.session, &done));
        OK(spar_step_accept(r.session));
        t += dt[k];
    }
    rig_end(&r);
}

/* What was not asked for is refused with the cure, before a push as after it: a getter switches nothing on. */
static void unasked_history_is_refused(void **state) {
    (void)state;
    rig r;
    const double node[3] = {5, 0.2, 0.3}, force[3] = {1, 2, 3};
    double got[3];
    rig_start(&r, 0, 0);
    spar_fluid *f;
    OK(spar_fluid_create(r.member, "line", &f));
    OK(spar_fluid_set_force_nodes(f, 1, node));
    OK(spar_fluid_map(f));
    assert_int_equal(spar_fluid_pull_forces(f, 1, got), SPAR_ERR_STATE);
    OK(spar_fluid_push_forces(f, force, NULL));
    assert_int_equal(spar_fluid_pull_forces(f, 1, got), SPAR_ERR_STATE);
    assert_true(says(&r, "SPAR_EFFECT_FLUID_HISTORY"));
    rig_end(&r);
}

/* Stations imply a history. Switched off it is gone for good, with what was pushed; switched on, any force nodes have
   it. */
static void history_is_an_effect(void **state) {
    (void)state;
    const double eta[2] = {0.25, 0.75}, force[2][3] = {{1, 2, 3}, {4, 5, 6}};
    enum { KINDS = 4 };
    static const struct {
        int on, off, kept; /* kept: 1 of stations, 2 of force nodes */
    } effects[KINDS] = {{0, 0, 1},
                        {0, SPAR_EFFECT_FLUID_MOMENT, 1},
                        {0, SPAR_EFFECT_FLUID_HISTORY, 0},
                        {SPAR_EFFECT_FLUID_HISTORY, 0, 3}};
    for (int k = 0; k < 2 * KINDS; k++) {
        rig r;
        double node[2][3] = {{2, 0, 0}, {7, 0, 0}}, got[2][3];
        int sections = k < KINDS, kept = effects[k % KINDS].kept & (sections ? 1 : 2);
        spar_fluid *f;
        rig_start(&r, effects[k % KINDS].on, effects[k % KINDS].off);
        OK(spar_fluid_create(r.member, "line", &f));
        OK(sections ? spar_fluid_set_stations(f, 2, eta, NULL) : spar_fluid_set_force_nodes(f, 2, node[0]));
        OK(spar_fluid_map(f));
        OK(spar_fluid_push_forces(f, force[0], NULL));
        assert_int_equal(spar_fluid_pull_forces(f, 1, got[0]), kept ? SPAR_OK : SPAR_ERR_STATE);
        if (kept) {
            assert_memory_equal(got, force, sizeof got);
        }
        rig_end(&r);
    }
}

#ifndef SPREAD_H
/* What exceeds single precision is refused, with its node; what is just below passes; in double precision all does. */
static void too_large_for_single(void **state) {
    (void)state;
    static const double size[3] = {1e38, 1e39, 1e39};
    for (int k = 0; k < 3; k++) {
        rig r;
        double x[2][3] = {{1, 0, 0}, {2, 0, 0}}, force[2][3] = {{1, 0, 0}, {0, size[k], 0}};
        float xs[2][3], vs[2][3];
        spar_fluid *f = NULL;
        rig_start(&r, SPAR_EFFECT_FLUID_HISTORY, 0);
        OK(spar_fluid_create(r.member, "far", &f));
        OK(spar_fluid_set_motion_nodes(f, 2, x[0]));
        OK(spar_fluid_set_force_nodes(f, 2, x[0]));
        OK(spar_fluid_map(f));
        for (int l = 0; l < 16; l++) {
            r.q[l][1] = k < 2 ? size[k] : 0, r.v[l][2] = k < 2 ? 0 : size[k];
        }
        OK(spar_member_set_motion(r.member, r.q[0], r.v[0], NULL));
        OK(spar_fluid_pull_motion(f, 1, x[0], NULL));
        assert_int_equal(spar_fluid_pull_motion_f32(f, 1, xs[0], vs[0]), k > 0 ? SPAR_ERR_NUMERIC : SPAR_OK);
        assert_int_equal(says(&r, k == 1 ? "the position of node 0 is too large" : "the velocity of node 0 is too"),
                         k > 0);
        OK(spar_fluid_push_forces(f, force[0], NULL));
        OK(spar_fluid_pull_forces(f, 1, x[0]));
        assert_int_equal(spar_fluid_pull_forces_f32(f, 1, xs[0]), k > 0 ? SPAR_ERR_NUMERIC : SPAR_OK);
        assert_int_equal(says(&r, "the force of node 1, 1e+39, is too large"), k > 0);
        rig_end(&r);
    }
}
#endif

/* ---- nodes in the present configuration ---- */

enum { PRESENT = 200 };

static spar_fluid *surface(const rig *r, const char *name, double (*x)[3], int present) {
    spar_fluid *f = NULL;
    OK(spar_fluid_create(r->member, name, &f));
    OK(spar_fluid_set_motion_nodes(f, PRESENT, x[0]));
    OK(spar_fluid_set_force_nodes(f, PRESENT, x[0]));
    OK(present ? spar_fluid_map_current(f) : spar_fluid_map(f));
    return f;
}

static void same_map(const spar_fluid *a, const spar_fluid *b) {
    static double eta[2][PRESENT], con[2][PRESENT][3], x[2][PRESENT][3], v[2][PRESENT][3];
    static int flags[2][PRESENT];
    for (int which = 0; which < 2; which++) {
        for (int k = 0; k < 2; k++) {
            const spar_fluid *f = k == 0 ? a : b;
            OK(spar_fluid_get_map(f, which, eta[k], NULL, flags[k]));
            OK(spar_fluid_get_nearest(f, which, NULL, NULL, con[k][0]));
            OK(spar_fluid_get_positions(f, which, x[k][0], NULL, v[k][0], NULL));
        }
        for (int j = 0; j < PRESENT; j++) {
            CLOSE(eta[0][j], eta[1][j], 1e-12);
            assert_int_equal(flags[0][j] & SPAR_MAP_END, flags[1][j] & SPAR_MAP_END);
            for (int i = 0; i < 3; i++) {
                CLOSE(con[0][j][i], con[1][j][i], 1e-11);
                CLOSE(x[0][j][i], x[1][j][i], 1e-11);
                CLOSE(v[0][j][i], v[1][j][i], 1e-11);
            }
        }
    }
}

/* Reference nodes, among them some beyond the ends, go where a bent, sheared and stretched beam moves them. A second
   fluid with these positions as present ones has the same map as the first, and both move together afterwards: to
   rounding, of either interpolation. */
static void present_nodes_have_the_map_of_reference_nodes(void **state) {
    (void)state;
    static double x[PRESENT][3], now[PRESENT][3];
    for (int k = 0; k < 4; k++) {
        rig r;
        unsigned long long seed = 77;
        rig_start(&r, 0, 0);
        scatter(x, PRESENT, &seed);
        for (int j = 0; j < PRESENT; j += 10) {
            x[j][0] += j % 20 ? 10.3 - x[j][0] : -0.2 - x[j][0];
        }
        spar_fluid *f = surface(&r, "reference", x, 0);
        OK(spar_fluid_set_interpolation(f, k % 2 ? SPAR_INTERPOLATE_CONSISTENT : SPAR_INTERPOLATE_NODAL));
        bend(&r, k < 2 ? 0.5 : 0);
        OK(spar_fluid_get_positions(f, SPAR_NODES_MOTION, now[0], NULL, NULL, NULL));
        spar_fluid *g = surface(&r, "present", now, 1);
        OK(spar_fluid_set_interpolation(g, k % 2 ? SPAR_INTERPOLATE_CONSISTENT : SPAR_INTERPOLATE_NODAL));
        same_map(f, g);
        bend(&r, -0.3);
        same_map(f, g);
        assert_string_equal(spar_session_get_warning(r.session, 0), "");
        rig_end(&r);
    }
}

#ifndef SPREAD_H
/* A deformed mesh that is given as the reference is told, once; the reference mesh is not. */
static void a_deformed_mesh_as_reference_is_told(void **state) {
    (void)state;
    static double x[PRESENT][3], now[PRESENT][3];
    rig r;
    unsigned long long seed = 78;
    rig_start(&r, 0, 0);
    scatter(x, PRESENT, &seed);
    spar_fluid *f = surface(&r, "mesh", x, 0);
    bend(&r, 1);
    OK(spar_fluid_get_positions(f, SPAR_NODES_MOTION, now[0], NULL, NULL, NULL));
    OK(spar_fluid_set_motion_nodes(f, PRESENT, x[0]));
    OK(spar_fluid_map(f));
    assert_string_equal(spar_session_get_warning(r.session, 0), "");
    for (int k = 0; k < 2; k++) {
        OK(spar_fluid_set_motion_nodes(f, PRESENT, now[0]));
        OK(spar_fluid_map(f));
        assert_non_null(strstr(spar_session_get_warning(r.session, 0), "spar_fluid_map_current"));
        assert_string_equal(spar_session_get_warning(r.session, 1), "");
    }
    rig_end(&r);
}
#endif

/* A run goes on from a deformed mesh: the fluid is mapped without nodes, the file is loaded, then the nodes are given
   where they are. */
static void restarts_from_a_deformed_mesh(void **state) {
    (void)state;
    static double x[PRESENT][3], now[PRESENT][3], force[PRESENT][3], got[2][PRESENT][3];
    const char *file = "deformed.spar";
    rig r[2];
    spar_fluid *f[2];
    unsigned long long seed = 79;
    double load[2][MOST][6];
    scatter(x, PRESENT, &seed);
    scatter(force, PRESENT, &seed);
    for (int k = 0; k < 2; k++) {
        rig_start(&r[k], 0, 0);
        f[k] = k == 0 ? surface(&r[k], "mesh", x, 0) : NULL;
    }
    OK(spar_step_begin(r[0].session, 0.1));
    bend(&r[0], 0.5);
    OK(spar_fluid_push_forces(f[0], force[0], NULL));
    OK(spar_step_solve(r[0].session));
    OK(spar_step_accept(r[0].session));
    OK(spar_session_save(r[0].session, file));
    OK(spar_fluid_get_positions(f[0], SPAR_NODES_MOTION, now[0], NULL, NULL, NULL));
    OK(spar_fluid_create(r[1].member, "mesh", &f[1]));
    OK(spar_fluid_map(f[1]));
    OK(spar_session_load(r[1].session, file));
    OK(spar_fluid_set_motion_nodes(f[1], PRESENT, now[0]));
    OK(spar_fluid_set_force_nodes(f[1], PRESENT, now[0]));
    OK(spar_fluid_map_current(f[1]));
    same_map(f[0], f[1]);
    for (int k = 0; k < 2; k++) {
        OK(spar_member_get_loads(r[k].member, load[k][0]));
        OK(spar_step_begin(r[k].session, 0.1));
        bend(&r[k], 0.7);
        OK(spar_fluid_pull_motion(f[k], 0.5, got[k][0], NULL));
        rig_end(&r[k]);
    }
    assert_memory_equal(load[0], load[1], 16 * sizeof load[0][0]);
    for (int j = 0; j < PRESENT; j++) {
        CLOSE(got[0][j][1], got[1][j][1], 1e-11);
    }
    assert_int_equal(remove(file), 0);
}

#ifndef SPREAD_H
/* Nodes anywhere around a strongly bent beam, up to 200 m away: each is where it was given once it is mapped, or it is
   refused because no reference position leads there. Both happen. */
static void present_nodes_are_right_or_refused(void **state) {
    (void)state;
    enum { POINTS = 400 };
    rig r;
    unsigned long long seed = 80;
    int64_t n[2] = {0, 0};
    rig_start(&r, 0, 0);
    bend(&r, 5);
    spar_fluid *f = NULL;
    OK(spar_fluid_create(r.member, "mesh", &f));
    for (int k = 0; k < POINTS; k++) {
        double x[3], back[3];
        for (int i = 0; i < 3; i++) {
            x[i] = 200 * line_random(&seed);
        }
        OK(spar_fluid_set_motion_nodes(f, 1, x));
        int status = spar_fluid_map_current(f);
        assert_true(status == SPAR_OK || (status == SPAR_ERR_MAPPING && says(&r, "folded")));
        n[status == SPAR_OK]++;
        if (status == SPAR_OK) {
            OK(spar_fluid_get_positions(f, SPAR_NODES_MOTION, back, NULL, NULL, NULL));
            for (int i = 0; i < 3; i++) {
                CLOSE(back[i], x[i], 1e-6);
            }
        } else if (n[0] == 1) { /* a refusal changes nothing: what was given is still there, as a reference position */
            OK(spar_fluid_map(f));
            bend(&r, 0);
            OK(spar_fluid_get_positions(f, SPAR_NODES_MOTION, back, NULL, NULL, NULL));
            for (int i = 0; i < 3; i++) {
                CLOSE(back[i], x[i], 1e-12);
            }
            bend(&r, 5);
        }
    }
    assert_true(n[0] > 10 && n[1] > 100);
    rig_end(&r);
}
#endif

static void present_nodes_that_cannot_be(void **state) {
    (void)state;
    rig r;
    double x[3] = {4, 0.5, 0}, w = 1;
    rig_start(&r, 0, 0);
    spar_fluid *f = NULL;
    OK(spar_fluid_create(r.member, "mesh", &f));
    OK(spar_fluid_set_motion_nodes(f, 1, x));
    OK(spar_fluid_set_motion_weights(f, 1, &w));
    assert_int_equal(spar_fluid_map_current(f), SPAR_ERR_UNSUPPORTED);
    assert_true(says(&r, "weights"));
    OK(spar_fluid_map(f));
    OK(spar_step_begin(r.session, 0.1));
    assert_int_equal(spar_fluid_map_current(f), SPAR_ERR_STATE);
    rig_end(&r);
}

/* ---- loads ---- */

static void total(const rig *r, double (*load)[6], double sum[6]) {
    double t[3];
    memset(sum, 0, 6 * sizeof *sum);
    for (int l = 0; l < r->nodes; l++) {
        double x[3] = {r->x[l][0] + r->q[l][0], r->x[l][1] + r->q[l][1], r->x[l][2] + r->q[l][2]};
        spari_cross(x, load[l], t);
        for (int i = 0; i < 3; i++) {
            sum[i] += load[l][i], sum[3 + i] += t[i] + load[l][3 + i];
        }
    }
}

/* Two fluids on one member: their loads add; the member has the force and the moment of all nodes; the audit agrees.
   Replacing the nodes of one leaves the other's map and load alone. With SPAR_EFFECT_FLUID_MOMENT off moments are not
   read, arms are. */
static void loads_of_fluids_add(void **state) {
    (void)state;
    enum { N = 60 };
    for (int moments = 0; moments < 2; moments++) {
        rig r;
        unsigned long long seed = 5;
        double node[2][N][3], x[N][3], force[2][N][3], moment[2][N][3], load[MOST][6], sum[6], want[6] = {0}, t[3],
                                                                                               audit[8];
        rig_start(&r, 0, moments ? 0 : SPAR_EFFECT_FLUID_MOMENT);
        spar_fluid *f[2];
        bend(&r, 0.9);
        for (int k = 0; k < 2; k++) {
            OK(spar_fluid_create(r.member, k ? "b" : "a", &f[k]));
            scatter(node[k], N, &seed);
            OK(spar_fluid_set_interpolation(f[k], k ? SPAR_INTERPOLATE_CONSISTENT : SPAR_INTERPOLATE_NODAL));
            OK(spar_fluid_set_motion_nodes(f[k], N, node[k][0]));
            OK(spar_fluid_set_force_nodes(f[k], N, node[k][0]));
            OK(spar_fluid_map(f[k]));
            OK(spar_fluid_pull_motion(f[k], 1, x[0], NULL));
            for (int j = 0; j < N; j++) {
                for (int i = 0; i < 3; i++) {
                    force[k][j][i] = line_random(&seed), moment[k][j][i] = line_random(&seed);
                }
                spari_cross(x[j], force[k][j], t);
                for (int i = 0; i < 3; i++) {
                    want[i] += force[k][j][i], want[3 + i] += t[i] + moments * moment[k][j][i];
                }
            }
            OK(spar_fluid_push_forces(f[k], force[k][0], moment[k][0]));
            OK(spar_fluid_get_audit(f[k], 8, audit));
            assert_true(audit[0] > 0 && audit[1] > 0 && audit[2] != 0);
            assert_true(audit[3] < 1e-13 && audit[4] < 1e-13 && audit[5] < 1e-13);
            assert_true(audit[6] > 10 && audit[6] < 20 && audit[7] == N);
        }
        OK(spar_fluid_set_motion_nodes(f[1], 3, node[0][0]));
        OK(spar_fluid_map(f[1]));
        OK(spar_step_begin(r.session, 0.1));
        OK(spar_member_get_loads(r.member, load[0]));
        total(&r, load, sum);
        for (int i = 0; i < 6; i++) {
            CLOSE(sum[i], want[i], 1e-11); /* 120 nodes, |x| 15 */
        }
        rig_end(&r);
    }
}

/* ---- policies and refusals ---- */

static void far_nodes_are_flagged_or_refused(void **state) {
    (void)state;
    rig r;
    rig_start(&r, 0, 0);
    const double node[3][3] = {{5, 0.2, 0}, {5, 3, 0}, {20, 0, 0}};
    int flags[3];
    spar_fluid *f;
    OK(spar_fluid_create(r.member, "surface", &f));
    OK(spar_fluid_set_projection(f, SPAR_PROJECT_BOUNDED, 1.0));
    OK(spar_fluid_set_motion_nodes(f, 3, node[0]));
    OK(spar_fluid_map(f));
    OK(spar_fluid_get_map(f, SPAR_NODES_MOTION, NULL, NULL, flags));
    assert_int_equal(flags[0], 0);
    assert_int_equal(flags[1], SPAR_MAP_FAR);
    assert_int_equal(flags[2], SPAR_MAP_FAR | SPAR_MAP_END);
    int64_t count;
    OK(spar_fluid_get_flag_count(f, SPAR_NODES_MOTION, SPAR_MAP_FAR, &count));
    assert_int_equal(count, 2);
    OK(spar_fluid_get_flag_count(f, SPAR_NODES_MOTION, SPAR_MAP_END, &count));
    assert_int_equal(count, 1);
    OK(spar_fluid_set_option(f, "far", "refuse"));
    OK(spar_fluid_set_motion_nodes(f, 3, node[0]));
    assert_int_equal(spar_fluid_map(f), SPAR_ERR_MAPPING);
    assert_true(says(&r, "2 of 3") && says(&r, "node 1") && says(&r, "surface"));
    OK(spar_fluid_set_projection(f, SPAR_PROJECT_BOUNDED, 0));
    OK(spar_fluid_map(f)); /* no limit: the same nodes are taken */
    OK(spar_fluid_get_map(f, SPAR_NODES_MOTION, NULL, NULL, flags));
    assert_int_equal(flags[1], 0);
    rig_end(&r);
}

/* Force and moment of a whole fluid about a point: the sums over its own nodes, where they are, of what it pushed, to
   the rounding of 60 nodes with |x| 15; another fluid's loads are not in them. The moment moves with the structure, the
   loads of which stay on its nodes: of a shift d by d x force. */
static void totals_are_of_one_fluid(void **state) {
    (void)state;
    enum { N = 60 };
    rig r;
    unsigned long long seed = 7;
    double node[N][3], x[N][3], force[2][N][3], want[6] = {0}, got[6], t[3], arm[3], before[6];
    const double point[3] = {3, -1, 2}, shift[3] = {0.1, 0.2, -0.3};
    spar_fluid *f[2];
    rig_start(&r, 0, 0);
    scatter(node, N, &seed);
    for (int k = 0; k < 2; k++) {
        OK(spar_fluid_create(r.member, k ? "b" : "a", &f[k]));
        OK(spar_fluid_sum_loads(f[k], NULL, got, got + 3));
        assert_true(spari_norm(got) + spari_norm(got + 3) == 0);
        OK(spar_fluid_set_motion_nodes(f[k], N, node[0]));
        OK(spar_fluid_set_force_nodes(f[k], N, node[0]));
        OK(spar_fluid_map(f[k]));
    }
    OK(spar_step_begin(r.session, 0.1));
    bend(&r, 0.9);
    OK(spar_fluid_pull_motion(f[0], 1, x[0], NULL));
    for (int k = 0; k < 2; k++) {
        for (int j = 0; j < N; j++) {
            for (int i = 0; i < 3; i++) {
                force[k][j][i] = line_random(&seed);
                arm[i] = x[j][i] - point[i];
            }
            spari_cross(arm, force[k][j], t);
            for (int i = 0; k == 0 && i < 3; i++) {
                want[i] += force[k][j][i], want[3 + i] += t[i];
            }
        }
        OK(spar_fluid_push_forces(f[k], force[k][0], NULL));
    }
    OK(spar_fluid_sum_loads(f[0], point, got, got + 3));
    for (int i = 0; i < 6; i++) {
        CLOSE(got[i], want[i], 1e-12);
    }
    for (int l = 0; l < 16; l++) {
        for (int i = 0; i < 3; i++) {
            r.q[l][i] += shift[i];
        }
    }
    OK(spar_member_set_motion(r.member, r.q[0], NULL, NULL));
    OK(spar_fluid_sum_loads(f[0], point, before, before + 3));
    spari_cross(shift, got, t);
    for (int i = 0; i < 3; i++) {
        CLOSE(before[i], got[i], 0);
        CLOSE(before[3 + i], got[3 + i] + t[i], 1e-12);
    }
    /* what the host claims: those very sums, to the rounding of the transfer; then a node pushed twice, of 1e-9 of all
     */
    OK(spar_fluid_check_loads(f[0], point, before, before + 3, 1e-13));
    OK(spar_fluid_check_loads(f[0], point, before, NULL, 1e-13));
    OK(spar_fluid_check_loads(f[1], NULL, got, NULL, 1e300));
    memcpy(got, before, sizeof got);
    got[1] += 1e-9 * spari_norm(force[0][0]);
    assert_int_equal(spar_fluid_check_loads(f[0], point, got, NULL, 1e-13), SPAR_ERR_ARGUMENT);
    assert_true(says(&r, "forces pushed on all ranks") && says(&r, "from exactly one rank"));
    got[1] = before[1];
    got[4] *= 1 + 1e-9;
    assert_int_equal(spar_fluid_check_loads(f[0], point, got, got + 3, 1e-13), SPAR_ERR_ARGUMENT);
    assert_true(says(&r, "moments pushed"));
    const double bad[3] = {0, NAN, 0};
    assert_int_equal(spar_fluid_check_loads(NULL, point, before, NULL, 1), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_check_loads(f[0], point, NULL, NULL, 1), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_check_loads(f[0], point, bad, NULL, 1), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_check_loads(f[0], point, before, bad, 1), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_check_loads(f[0], point, before, NULL, 0), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_check_loads(f[0], point, before, NULL, NAN), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_sum_loads(NULL, point, got, got + 3), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_sum_loads(f[0], bad, got, got + 3), SPAR_ERR_ARGUMENT);
    assert_true(says(&r, "the point is (0, nan, 0)"));
    OK(spar_fluid_sum_loads(f[0], point, NULL, NULL));
    rig_end(&r);
}

/* How far the nodes have gone in the step is the distance of their places at theta 0 and 1, to rounding; between steps
   and after a rejected one nothing moves. */
static void travel_is_of_the_step(void **state) {
    (void)state;
    enum { N = 150 };
    rig r;
    unsigned long long seed = 8;
    static double node[N][3], x[2][N][3];
    double largest, want = 0;
    int64_t at, expected = -1;
    spar_fluid *f;
    rig_start(&r, 0, 0);
    OK(spar_fluid_create(r.member, "a", &f));
    OK(spar_fluid_get_travel(f, &largest, &at));
    assert_true(largest == 0 && at == -1);
    scatter(node, N, &seed);
    OK(spar_fluid_set_motion_nodes(f, N, node[0]));
    assert_int_equal(spar_fluid_get_travel(f, &largest, &at), SPAR_ERR_STATE);
    OK(spar_fluid_map(f));
    bend(&r, 0.4);
    OK(spar_fluid_get_travel(f, &largest, &at));
    assert_true(largest == 0 && at == 0);
    for (int step = 0; step < 2; step++) {
        OK(spar_step_begin(r.session, 0.1));
        bend(&r, 0.9);
        OK(spar_step_solve(r.session));
        OK(spar_fluid_pull_motion(f, 0, x[0][0], NULL));
        OK(spar_fluid_pull_motion(f, 1, x[1][0], NULL));
        for (int j = 0; j < N && step == 0; j++) {
            double d[3] = {x[1][j][0] - x[0][j][0], x[1][j][1] - x[0][j][1], x[1][j][2] - x[0][j][2]};
            expected = spari_norm(d) > want ? j : expected;
            want = fmax(want, spari_norm(d));
        }
        OK(spar_fluid_get_travel(f, &largest, &at));
        assert_true(want > 0.5);
        CLOSE(largest, want, 1e-13);
        assert_int_equal(at, expected);
        OK(step == 0 ? spar_step_reject(r.session) : spar_step_accept(r.session));
        OK(spar_fluid_get_travel(f, &largest, NULL));
        CLOSE(largest, 0, 0);
    }
    assert_int_equal(spar_fluid_get_travel(NULL, &largest, NULL), SPAR_ERR_ARGUMENT);
    rig_end(&r);
}

/* Each refusal has its status and leaves things as they were. */
static void bad_calls_are_refused(void **state) {
    (void)state;
    rig r;
    rig_start(&r, 0, 0);
    double node[2][3] = {{5, 0, 0}, {6, NAN, 0}}, force[3] = {1, 2, 3}, eta[1] = {1.1}, x[3], before[8], after[8];
    spar_fluid *f = NULL, *g;
    spar_member *raw;
    assert_int_equal(spar_fluid_create(NULL, "a", &f), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_create(r.member, NULL, &f), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_create(r.member, "a", NULL), SPAR_ERR_ARGUMENT);
    OK(spar_fluid_create(r.member, "a", &f));
    assert_int_equal(spar_fluid_set_motion_nodes(NULL, 0, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_set_motion_nodes(f, -1, node[0]), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_set_motion_nodes(f, 1, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_set_motion_nodes(f, 2, node[0]), SPAR_ERR_ARGUMENT);
    assert_true(says(&r, "motion node 1, component 1"));
    assert_int_equal(spar_fluid_set_stations(f, 1, eta, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_set_projection(f, 7, 0), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_set_interpolation(f, 7), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_get_map(f, 2, NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
    OK(spar_fluid_set_motion_nodes(f, 0, NULL));
    OK(spar_fluid_set_force_nodes(f, 1, node[0]));
    assert_int_equal(spar_fluid_push_forces(f, force, NULL), SPAR_ERR_STATE); /* not mapped */
    OK(spar_fluid_map(f));
    OK(spar_fluid_pull_motion(f, 1, NULL, NULL));
    OK(spar_fluid_push_forces(f, force, NULL));
    OK(spar_fluid_get_audit(f, 8, before));
    assert_int_equal(spar_fluid_push_forces(f, NULL, NULL), SPAR_ERR_ARGUMENT);
    force[1] = INFINITY;
    assert_int_equal(spar_fluid_push_forces(f, force, NULL), SPAR_ERR_ARGUMENT);
    assert_true(says(&r, "force of node 0, component 1"));
    force[1] = 2;
    x[0] = NAN, x[1] = x[2] = 0;
    assert_int_equal(spar_fluid_push_forces(f, force, x), SPAR_ERR_ARGUMENT);
    OK(spar_fluid_get_audit(f, 8, after));
    assert_memory_equal(before, after, sizeof before);
    OK(spar_fluid_push_forces(f, force, NULL));
    /* a member that is not committed */
    OK(spar_beam_create(r.session, "raw", 1, 4, &raw));
    OK(spar_fluid_create(raw, "b", &g));
    OK(spar_fluid_set_motion_nodes(g, 1, node[0]));
    assert_int_equal(spar_fluid_map(g), SPAR_ERR_STATE);
    assert_true(says(&r, "spar_member_commit"));
    spar_fluid_destroy(&g);
    assert_null(g);
    spar_fluid_destroy(&g);
    spar_fluid_destroy(NULL);
    rig_end(&r);
}

/* Inside a step nodes stay as they are; outside, loads do. A refused push is told again by the check, until its own
   fluid pushes well: another fluid's good push does not hide it. */
static void order_of_calls(void **state) {
    (void)state;
    rig r;
    rig_start(&r, 0, 0);
    const double node[3] = {5, 0, 0}, good[3] = {1, 2, 3}, bad[3] = {1, NAN, 3};
    int done;
    spar_fluid *f[2];
    for (int k = 0; k < 2; k++) {
        OK(spar_fluid_create(r.member, k ? "b" : "a", &f[k]));
        OK(spar_fluid_set_force_nodes(f[k], 1, node));
        OK(spar_fluid_map(f[k]));
    }
    OK(spar_step_begin(r.session, 0.1));
    assert_int_equal(spar_fluid_set_force_nodes(f[0], 1, node), SPAR_ERR_STATE);
    assert_int_equal(spar_fluid_map(f[0]), SPAR_ERR_STATE);
    OK(spar_step_solve(r.session));
    assert_int_equal(spar_fluid_push_forces(f[0], bad, NULL), SPAR_ERR_ARGUMENT);
    OK(spar_fluid_push_forces(f[1], good, NULL));
    assert_int_equal(spar_step_check(r.session, &done), SPAR_ERR_ARGUMENT);
    OK(spar_fluid_push_forces(f[0], good, NULL));
    OK(spar_step_check(r.session, &done));
    OK(spar_step_accept(r.session));
    assert_int_equal(spar_fluid_push_forces(f[0], good, NULL), SPAR_ERR_STATE);
    assert_true(says(&r, "spar_step_begin"));
    rig_end(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(map_hangs_together),
        cmocka_unit_test(sections_stand_where_asked),
        cmocka_unit_test(bodies_carry_their_nodes),
        cmocka_unit_test(poses_and_matrices),
        cmocka_unit_test(single_precision_at_the_edge),
        cmocka_unit_test(theta_lies_between_the_times),
        cmocka_unit_test(group_interpolation_keeps_the_radius),
        cmocka_unit_test(half_step_cuts_the_corner),
        cmocka_unit_test(pulls_give_what_is_asked_for),
        cmocka_unit_test(node_forces_are_kept_and_predicted),
        cmocka_unit_test(unasked_history_is_refused),
        cmocka_unit_test(history_is_an_effect),
#ifndef SPREAD_H /* messages and warnings are of one rank, and number its nodes */
        cmocka_unit_test(present_nodes_are_right_or_refused),
        cmocka_unit_test(too_large_for_single),
        cmocka_unit_test(a_deformed_mesh_as_reference_is_told),
#endif
        cmocka_unit_test(present_nodes_have_the_map_of_reference_nodes),
        cmocka_unit_test(restarts_from_a_deformed_mesh),
        cmocka_unit_test(present_nodes_that_cannot_be),
        cmocka_unit_test(loads_of_fluids_add),
        cmocka_unit_test(totals_are_of_one_fluid),
        cmocka_unit_test(travel_is_of_the_step),
        cmocka_unit_test(far_nodes_are_flagged_or_refused),
        cmocka_unit_test(bad_calls_are_refused),
        cmocka_unit_test(order_of_calls),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
