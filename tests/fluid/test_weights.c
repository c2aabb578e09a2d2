/* Motion nodes with weights: a mesh that moves with part of the section's motion, and fades with the distance. Members
 * are external, so that their motion is what the test says; what is expected is X + w (x - X), w v, w a of the same
 * nodes without weights. */
#include "check.h"

#include "fluid/fluid.h"
#include "math/rotation.h"
#include "support/lines.h"
#include "trial/rebuild.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N = 300, /* more than one tile of the kernels */ MOST = 64 };

typedef struct mesh {
    spar_session *session;
    spar_member *member;
    spar_fluid *plain, *weighted;
    int64_t nodes; /* of the member */
    double xr[MOST][3], X[N][3], w[N];
} mesh;

/* Motion of the line at time t, a smooth function of s = x/10: places, turns about one axis per node by angles, so that
   the angular velocity is the angle's rate times the axis. */
static void pose_at(const mesh *m, double t, double size, double (*q)[7], double (*v)[6], double (*a)[6]) {
    for (int l = 0; l < m->nodes; l++) {
        double s = m->xr[l][0] / 10, axis[3] = {0.6, -0.48, 0.64}, angle = size * (0.2 + s) * sin(2 * t),
               rate = 2 * size * (0.2 + s) * cos(2 * t), jerk = -4 * angle, psi[3];
        for (int i = 0; i < 3; i++) {
            q[l][i] = size * s * (i + 1) * sin(t + i);
            v[l][i] = size * s * (i + 1) * cos(t + i), v[l][3 + i] = rate * axis[i];
            a[l][i] = -q[l][i], a[l][3 + i] = jerk * axis[i];
            psi[i] = angle * axis[i];
        }
        spari_quat_exp(psi, q[l] + 3);
    }
}

static void set_pose(const mesh *m, double t, double size) {
    double q[MOST][7], v[MOST][6], a[MOST][6];
    pose_at(m, t, size, q, v, a);
    OK(m->session, spar_member_set_motion(m->member, q[0], v[0], a[0]));
}

static spar_fluid *add_fluid(const mesh *m, const char *name, int kind) {
    spar_fluid *f = NULL;
    OK(m->session, spar_fluid_create(m->member, name, &f));
    OK(m->session, spar_fluid_set_interpolation(f, kind));
    OK(m->session, spar_fluid_set_motion_nodes(f, N, m->X[0]));
    OK(m->session, spar_fluid_set_force_nodes(f, N, m->X[0]));
    return f;
}

/* Two fluids of the same nodes around a curved beam of two elements (a point for elements = 0), the second to be given
   weights; to be mapped. Weights are random, some of them 0 or 1. */
static void mesh_begin(mesh *m, int elements, int kind) {
    unsigned long long seed = 7;
    double eta[21], xyz[21][3];
    const double origin[3] = {1, 2, 3}, unit[4] = {1, 0, 0, 0};
    memset(m, 0, sizeof *m);
    OK(NULL, spar_session_create(&m->session));
    if (elements > 0) {
        for (int i = 0; i < 21; i++) {
            eta[i] = 0.05 * i, xyz[i][0] = 10 * eta[i], xyz[i][1] = 0.8 * eta[i] * eta[i], xyz[i][2] = -0.5 * eta[i];
        }
        OK(m->session, spar_beam_create(m->session, "blade", elements, 6, &m->member));
        OK(m->session, spar_beam_set_axis(m->member, 21, eta, xyz[0], NULL));
    } else {
        OK(m->session, spar_point_create(m->session, "point", origin, unit, &m->member));
    }
    OK(m->session, spar_member_set_external(m->member, 1));
    OK(m->session, spar_member_commit(m->member));
    OK(m->session, spar_member_get_count(m->member, &m->nodes));
    OK(m->session, spar_member_get_reference(m->member, m->xr[0], NULL));
    for (int j = 0; j < N; j++) {
        double s = 0.5 + 0.5 * line_random(&seed);
        m->X[j][0] = 10 * s, m->X[j][1] = 0.8 * s * s + line_random(&seed), m->X[j][2] = line_random(&seed);
        m->w[j] = j % 7 == 0 ? 0 : j % 7 == 1 ? 1 : 0.5 + 0.5 * line_random(&seed);
    }
    m->plain = add_fluid(m, "plain", kind);
    m->weighted = add_fluid(m, "weighted", kind);
}

static void mesh_set_theta(const mesh *m, const char *theta) {
    OK(m->session, spar_fluid_set_option(m->plain, "theta", theta));
    OK(m->session, spar_fluid_set_option(m->weighted, "theta", theta));
}

static void mesh_map(const mesh *m) {
    OK(m->session, spar_fluid_map(m->plain));
    OK(m->session, spar_fluid_map(m->weighted));
}

static void mesh_end(mesh *m) {
    spar_session_destroy(&m->session);
}

typedef struct motion {
    double x[N][3], v[N][3], a[N][3];
} motion;

static void pull(const mesh *m, spar_fluid *f, double theta, motion *to) {
    OK(m->session, spar_fluid_pull_motion(f, theta, to->x[0], to->v[0]));
    OK(m->session, spar_fluid_pull_poses(f, SPAR_NODES_MOTION, theta, NULL, NULL, NULL, NULL, to->a[0], NULL));
}

/* What one node of weight w must be, to within the rounding of three operations on numbers as large as it. */
static void must_be_part(const double part[3], const double home[3], const double whole[3], double w, double scale) {
    for (int i = 0; i < 3; i++) {
        NEAR(part[i], home[i] + w * (whole[i] - home[i]), 4 * DBL_EPSILON * scale);
    }
}

/* ---- the weights themselves ---- */

/* All weights 1: every pull has the bits it has without weights; places, velocities, accelerations, single precision,
   travel; beam and point, both interpolations, at t^n, between (mean and group) and t^{n+1}. */
static void one_is_as_without(void **state) {
    (void)state;
    static motion a, b;
    static float x[2][N][3], v[2][N][3];
    for (int k = 0; k < 8; k++) {
        mesh m;
        double w[N], way[2];
        int64_t node[2];
        mesh_begin(&m, k & 1 ? 2 : 0, k & 2 ? SPAR_INTERPOLATE_CONSISTENT : SPAR_INTERPOLATE_NODAL);
        for (int j = 0; j < N; j++) {
            w[j] = 1;
        }
        mesh_set_theta(&m, k & 4 ? "group" : "average");
        OK(m.session, spar_fluid_set_motion_weights(m.weighted, N, w));
        mesh_map(&m);
        set_pose(&m, 0.3, 1);
        OK(m.session, spar_step_begin(m.session, 0.1));
        set_pose(&m, 0.4, 1);
        for (int i = 0; i < 3; i++) {
            double theta = 0.5 * i;
            pull(&m, m.plain, theta, &a);
            pull(&m, m.weighted, theta, &b);
            assert_memory_equal(&a, &b, sizeof a);
            OK(m.session, spar_fluid_pull_motion_f32(m.plain, theta, x[0][0], v[0][0]));
            OK(m.session, spar_fluid_pull_motion_f32(m.weighted, theta, x[1][0], v[1][0]));
            assert_memory_equal(x[0], x[1], sizeof x[0]);
            assert_memory_equal(v[0], v[1], sizeof v[0]);
        }
        OK(m.session, spar_fluid_get_travel(m.plain, &way[0], &node[0]));
        OK(m.session, spar_fluid_get_travel(m.weighted, &way[1], &node[1]));
        assert_true(way[0] > 0 && way[0] == way[1] && node[0] == node[1]);
        mesh_end(&m);
    }
}

/* Any weights: X + w (x - X), w v, w a to rounding; X to the bit and 0 where w is 0, the bits of the plain node where
   it is 1. The travel is the largest of the weighted ones. Single precision is the rounded double. */
static void part_of_the_motion(void **state) {
    (void)state;
    static motion a, b, before;
    static float x[N][3], v[N][3];
    for (int k = 0; k < 8; k++) {
        mesh m;
        double most = 0, way;
        const double zero[3] = {0, 0, 0};
        mesh_begin(&m, k & 1 ? 2 : 0, k & 2 ? SPAR_INTERPOLATE_CONSISTENT : SPAR_INTERPOLATE_NODAL);
        mesh_set_theta(&m, k & 4 ? "group" : "average");
        OK(m.session, spar_fluid_set_motion_weights(m.weighted, N, m.w));
        mesh_map(&m);
        set_pose(&m, 0.3, 1);
        OK(m.session, spar_step_begin(m.session, 0.1));
        set_pose(&m, 0.4, 1);
        for (int i = 0; i < 3; i++) {
            pull(&m, m.plain, 0.5 * i, &a);
            pull(&m, m.weighted, 0.5 * i, &b);
            OK(m.session, spar_fluid_pull_motion_f32(m.weighted, 0.5 * i, x[0], v[0]));
            for (int j = 0; j < N; j++) {
                must_be_part(b.x[j], m.X[j], a.x[j], m.w[j], 20);
                must_be_part(b.v[j], zero, a.v[j], m.w[j], 20);
                must_be_part(b.a[j], zero, a.a[j], m.w[j], 50);
                for (int c = 0; c < 3; c++) {
                    assert_true(x[j][c] == (float)b.x[j][c] && v[j][c] == (float)b.v[j][c]);
                    assert_true(m.w[j] != 0 || (b.x[j][c] == m.X[j][c] && b.v[j][c] == 0 && b.a[j][c] == 0));
                    assert_true(m.w[j] != 1 || (b.x[j][c] == a.x[j][c] && b.v[j][c] == a.v[j][c]));
                }
            }
            before = i == 0 ? b : before;
        }
        for (int j = 0; j < N; j++) {
            double d[3] = {b.x[j][0] - before.x[j][0], b.x[j][1] - before.x[j][1], b.x[j][2] - before.x[j][2]};
            most = fmax(most, spari_norm(d));
        }
        OK(m.session, spar_fluid_get_travel(m.weighted, &way, NULL));
        NEAR(way, most, 1e-14);
        assert_true(way > 0.01);
        mesh_end(&m);
    }
}

/* The consistent kind: the pulled velocity is the derivative of the pulled place, by central differences of h = 1e-5 s:
   their error is h^2/6 times a third derivative (up to 50) and rounding, 1e-15 * 10 / h. */
static void velocity_is_the_rate(void **state) {
    (void)state;
    static motion at, less, more;
    const double h = 1e-5, t = 0.7;
    mesh m;
    mesh_begin(&m, 2, SPAR_INTERPOLATE_CONSISTENT);
    OK(m.session, spar_fluid_set_motion_weights(m.weighted, N, m.w));
    mesh_map(&m);
    set_pose(&m, t - h, 0.8);
    pull(&m, m.weighted, 1, &less);
    set_pose(&m, t + h, 0.8);
    pull(&m, m.weighted, 1, &more);
    set_pose(&m, t, 0.8);
    pull(&m, m.weighted, 1, &at);
    double fastest = 0;
    for (int j = 0; j < N; j++) {
        for (int c = 0; c < 3; c++) {
            NEAR((more.x[j][c] - less.x[j][c]) / (2 * h), at.v[j][c], 1e-8);
            NEAR((more.v[j][c] - less.v[j][c]) / (2 * h), at.a[j][c], 1e-7);
            fastest = fmax(fastest, fabs(at.v[j][c]));
        }
    }
    assert_true(fastest > 1);
    mesh_end(&m);
}

/* A blade and its hub turn as one body; weights of the two fluids add to 1: what both move a node by is the body's
   motion, to rounding (places up to 15 m, speeds up to 60 m/s). */
static void parts_add_to_the_whole(void **state) {
    (void)state;
    mesh m;
    static motion a, b;
    const double unit[4] = {1, 0, 0, 0}, turn[3] = {0.5, 1.1, -2.0}, spin[3] = {1, -2, 3}, shift[3] = {0.3, -1, 2},
                 rate[3] = {4, 5, -6}, centre[3] = {0, 0, 0};
    double rest[N], rotation[4], q[MOST][7], v[MOST][6];
    spar_member *hub;
    spar_fluid *of_hub;
    mesh_begin(&m, 2, SPAR_INTERPOLATE_NODAL);
    OK(m.session, spar_point_create(m.session, "hub", centre, unit, &hub));
    OK(m.session, spar_member_set_external(hub, 1));
    OK(m.session, spar_member_commit(hub));
    OK(m.session, spar_fluid_create(hub, "of hub", &of_hub));
    OK(m.session, spar_fluid_set_motion_nodes(of_hub, N, m.X[0]));
    for (int j = 0; j < N; j++) {
        rest[j] = 1 - m.w[j];
    }
    OK(m.session, spar_fluid_set_motion_weights(m.weighted, N, m.w));
    OK(m.session, spar_fluid_set_motion_weights(of_hub, N, rest));
    mesh_map(&m);
    OK(m.session, spar_fluid_map(of_hub));
    spari_quat_exp(turn, rotation);
    for (int l = 0; l <= m.nodes; l++) { /* the last is the hub */
        double x[3] = {0, 0, 0}, r[3], wr[3];
        memcpy(x, l < m.nodes ? m.xr[l] : centre, sizeof x);
        spari_rotate(rotation, x, r);
        spari_cross(spin, r, wr);
        for (int i = 0; i < 3; i++) {
            q[l][i] = shift[i] + r[i] - x[i];
            v[l][i] = rate[i] + wr[i], v[l][3 + i] = spin[i];
        }
        memcpy(q[l] + 3, rotation, sizeof rotation);
    }
    OK(m.session, spar_member_set_motion(m.member, q[0], v[0], NULL));
    OK(m.session, spar_member_set_motion(hub, q[m.nodes], v[m.nodes], NULL));
    OK(m.session, spar_fluid_pull_motion(m.weighted, 1, a.x[0], a.v[0]));
    OK(m.session, spar_fluid_pull_motion(of_hub, 1, b.x[0], b.v[0]));
    for (int j = 0; j < N; j++) {
        double r[3], wr[3];
        spari_rotate(rotation, m.X[j], r);
        spari_cross(spin, r, wr);
        for (int i = 0; i < 3; i++) {
            NEAR(m.X[j][i] + (a.x[j][i] - m.X[j][i]) + (b.x[j][i] - m.X[j][i]), shift[i] + r[i], 1e-13);
            NEAR(a.v[j][i] + b.v[j][i], rate[i] + wr[i], 1e-12);
        }
    }
    mesh_end(&m);
}

/* Weights given after the map hold the places that feet and arms give, within rounding; those before, the host's. They
   can be read back, go when nodes are replaced, and can be taken away. Loads are not weighed. */
static void life_of_weights(void **state) {
    (void)state;
    static motion a, b;
    double got[N], audit[2][3], force[N][3];
    mesh m;
    mesh_begin(&m, 2, SPAR_INTERPOLATE_NODAL);
    mesh_map(&m);
    OK(m.session, spar_fluid_get_motion_weights(m.weighted, got));
    assert_true(got[0] == 1 && got[N - 1] == 1);
    OK(m.session, spar_fluid_set_motion_weights(m.weighted, N, m.w));
    OK(m.session, spar_fluid_get_motion_weights(m.weighted, got));
    assert_memory_equal(got, m.w, sizeof got);
    mesh_map(&m); /* again: they stay */
    set_pose(&m, 0.5, 1);
    pull(&m, m.plain, 1, &a);
    pull(&m, m.weighted, 1, &b);
    for (int j = 0; j < N; j++) {
        must_be_part(b.x[j], m.X[j], a.x[j], m.w[j], 20);
        memcpy(force[j], a.v[j], sizeof force[j]);
    }
    for (int k = 0; k < 2; k++) { /* the same force, moment and power come in by either fluid */
        OK(m.session, spar_fluid_push_forces(k ? m.weighted : m.plain, force[0], NULL));
        OK(m.session, spar_fluid_get_audit(k ? m.weighted : m.plain, 3, audit[k]));
    }
    for (int i = 0; i < 3; i++) { /* 300 nodes, mapped twice */
        NEAR(audit[1][i], audit[0][i], 1e-12 * fabs(audit[0][i]));
        assert_true(fabs(audit[0][i]) > 10);
    }
    OK(m.session, spar_fluid_set_motion_weights(m.weighted, 0, NULL));
    pull(&m, m.weighted, 1, &b);
    assert_memory_equal(&a, &b, sizeof a);
    OK(m.session, spar_fluid_set_motion_weights(m.weighted, N, m.w));
    OK(m.session, spar_fluid_set_motion_nodes(m.weighted, 1, m.X[3]));
    OK(m.session, spar_fluid_get_motion_weights(m.weighted, got));
    assert_true(got[0] == 1);
    OK(m.session, spar_fluid_set_motion_nodes(m.weighted, 0, NULL));
    OK(m.session, spar_fluid_set_motion_weights(m.weighted, 0, m.w));
    OK(m.session, spar_fluid_fade_motion(m.weighted, 0, 1, 0, NULL, NULL));
    OK(m.session, spar_fluid_get_motion_weights(m.weighted, NULL));
    OK(m.session, spar_fluid_map(m.weighted));
    OK(m.session, spar_fluid_pull_motion(m.weighted, 1, NULL, NULL));
    mesh_end(&m);
}

/* A trial's member with other nodes: weights hold there, and to the bit afterwards. A beam that is straight, so that
   the line through other nodes is the same one; its motion is linear in s. */
static void trials_keep_weights(void **state) {
    (void)state;
    static motion a, b, back;
    const double eta[2] = {0, 1}, line[6] = {0, 0, 0, 10, 0, 0};
    double q[MOST][7] = {{0}}, v[MOST][6] = {{0}}, seen[N];
    mesh m = {0}, *r = &m;
    spar_member *b1, old;
    spar_fluid *was;
    mesh_begin(r, 0, 0);
    OK(m.session, spar_beam_create(m.session, "straight", 1, 4, &b1));
    OK(m.session, spar_beam_set_axis(b1, 2, eta, line, NULL));
    OK(m.session, spar_member_set_external(b1, 1));
    OK(m.session, spar_member_commit(b1));
    m.member = b1;
    OK(m.session, spar_member_get_count(b1, &m.nodes));
    OK(m.session, spar_member_get_reference(b1, m.xr[0], NULL));
    spar_fluid *f = add_fluid(&m, "in a trial", SPAR_INTERPOLATE_NODAL);
    OK(m.session, spar_fluid_set_motion_weights(f, N, m.w));
    OK(m.session, spar_fluid_map(f));
    for (int l = 0; l < m.nodes; l++) {
        q[l][3] = 1;
        for (int i = 0; i < 3; i++) {
            q[l][i] = 0.02 * (i + 1) * m.xr[l][0], v[l][i] = 0.3 * (i + 1) * m.xr[l][0];
        }
    }
    OK(m.session, spar_member_set_motion(b1, q[0], v[0], NULL));
    OK(m.session, spar_fluid_pull_motion(f, 1, a.x[0], a.v[0]));
    spari_rebuild wish = spari_rebuild_of(b1);
    wish.per_element = 7;
    OK(m.session, spari_member_rebuild(b1, &wish, &old));
    memcpy(b1->after.q, b1->now.q, (size_t)(7 * b1->nodes) * sizeof(double));
    memcpy(b1->after.v, b1->now.v, (size_t)(6 * b1->nodes) * sizeof(double));
    OK(m.session, spari_fluid_rebuild(f, &old, &was));
    OK(m.session, spar_fluid_get_motion_weights(f, seen));
    assert_memory_equal(seen, m.w, sizeof seen);
    OK(m.session, spar_fluid_pull_motion(f, 1, b.x[0], b.v[0]));
    for (int j = 0; j < N; j++) {
        for (int i = 0; i < 3; i++) {
            NEAR(b.x[j][i], a.x[j][i], 1e-13);
            NEAR(b.v[j][i], a.v[j][i], 1e-12);
            assert_true(m.w[j] != 0 || b.x[j][i] == m.X[j][i]);
        }
    }
    spari_fluid_restore(f, was);
    spari_member_restore(b1, &old);
    OK(m.session, spar_fluid_pull_motion(f, 1, back.x[0], back.v[0]));
    assert_memory_equal(back.x, a.x, sizeof a.x);
    assert_memory_equal(back.v, a.v, sizeof a.v);
    mesh_end(&m);
}

/* A saved session with weights goes on in one whose host has given the same nodes and weights: to the bit. */
static void saved_and_loaded(void **state) {
    (void)state;
    static motion a, b;
    const char *file = "weights.spar";
    mesh m[2];
    for (int k = 0; k < 2; k++) {
        mesh_begin(&m[k], 2, SPAR_INTERPOLATE_NODAL);
        OK(m[k].session, spar_fluid_set_motion_weights(m[k].weighted, N, m[k].w));
        mesh_map(&m[k]);
    }
    set_pose(&m[0], 0.3, 1);
    OK(m[0].session, spar_session_save(m[0].session, file));
    OK(m[1].session, spar_session_load(m[1].session, file));
    pull(&m[0], m[0].weighted, 1, &a);
    pull(&m[1], m[1].weighted, 1, &b);
    assert_memory_equal(&a, &b, sizeof a);
    assert_true(a.v[3][0] != 0);
    mesh_end(&m[0]);
    mesh_end(&m[1]);
    assert_int_equal(remove(file), 0);
}

/* ---- fading ---- */

/* Weight of one node at distance d. */
static double fade(const mesh *m, double within, double beyond, double d) {
    double distance[N], w[N];
    for (int j = 0; j < N; j++) {
        distance[j] = d;
    }
    OK(m->session, spar_fluid_fade_motion(m->weighted, within, beyond, N, distance, NULL));
    OK(m->session, spar_fluid_get_motion_weights(m->weighted, w));
    return w[0];
}

/* Weights by the header: 1.1 - 1.2 s between s = 1/6 and 5/6, 1 - 43.2 s^3 + 129.6 s^4 before, the mirror image behind
   (by hand at 1/12, 1/6, 1/4, 1/2, 3/4, 5/6, 11/12: 157/160, 9/10, 4/5, 1/2, 1/5, 1/10, 3/160); the same beyond the
   ends; falls all the way, by 1.2 at most; first and second differences have no jump at 0, 1/6, 5/6, 1: those of steps
   h differ from the derivative by h times the next one, which is below 86 (second) and 260 (third), at most on one
   side. */
static void fades_smoothly(void **state) {
    (void)state;
    mesh m;
    mesh_begin(&m, 2, SPAR_INTERPOLATE_NODAL);
    const double near = 0.04, far = 0.18, span = far - near, h = 1e-3;
    const double part[] = {1.0 / 12, 1.0 / 6, 0.25, 0.5, 0.75, 5.0 / 6, 11.0 / 12},
                 weight[] = {157.0 / 160, 0.9, 0.8, 0.5, 0.2, 0.1, 3.0 / 160};
    for (int k = 0; k < 7; k++) {
        NEAR(fade(&m, near, far, near + part[k] * span), weight[k], 1e-14);
    }
    assert_true(fade(&m, near, far, near) == 1 && fade(&m, near, far, 0) == 1 && fade(&m, near, far, -5) == 1);
    assert_true(fade(&m, near, far, far) == 0 && fade(&m, near, far, 1e300) == 0);
    assert_true(fade(&m, -DBL_MAX, DBL_MAX, 0) == 0.5);
    const double seam[] = {0, 1.0 / 6, 5.0 / 6, 1};
    for (int k = 0; k < 4; k++) {
        double w[5];
        for (int i = 0; i < 5; i++) {
            w[i] = fade(&m, near, far, near + (seam[k] + (i - 2) * h) * span);
        }
        double slope[2] = {(w[2] - w[0]) / (2 * h), (w[4] - w[2]) / (2 * h)},
               bend[2] = {(w[2] - 2 * w[1] + w[0]) / (h * h), (w[4] - 2 * w[3] + w[2]) / (h * h)};
        for (int i = 0; i < 2; i++) {
            NEAR(slope[i], k == 1 || k == 2 ? -1.2 : 0, 5e-4);
            NEAR(bend[i], 0, 0.27);
        }
    }
    for (int k = 0; k < 200; k++) {
        double a = fade(&m, near, far, near + k * span / 200), b = fade(&m, near, far, near + (k + 1) * span / 200);
        assert_true(a > b);
        assert_true(a - b < 1.2001 / 200);
    }
    mesh_end(&m);
}

/* From the line: the same weights as from the distances of spar_fluid_get_map, before the map as after it; held nodes
   stay. From host's distances: those. */
static void fades_from_the_line(void **state) {
    (void)state;
    mesh m;
    double distance[N], w[3][N];
    int held[N];
    mesh_begin(&m, 2, SPAR_INTERPOLATE_NODAL);
    OK(m.session, spar_fluid_fade_motion(m.weighted, 0.4, 1, N, NULL, NULL));
    OK(m.session, spar_fluid_get_motion_weights(m.weighted, w[0]));
    mesh_map(&m);
    OK(m.session, spar_fluid_get_map(m.weighted, SPAR_NODES_MOTION, NULL, distance, NULL));
    for (int j = 0; j < N; j++) {
        held[j] = j % 3 == 0 ? -1 : 0;
    }
    OK(m.session, spar_fluid_fade_motion(m.weighted, 0.4, 1, N, distance, NULL));
    OK(m.session, spar_fluid_get_motion_weights(m.weighted, w[1]));
    OK(m.session, spar_fluid_fade_motion(m.weighted, 0.4, 1, N, NULL, held));
    OK(m.session, spar_fluid_get_motion_weights(m.weighted, w[2]));
    int whole = 0, none = 0;
    for (int j = 0; j < N; j++) {
        double s = fmin(fmax((distance[j] - 0.4) / 0.6, 0), 1);
        NEAR(w[0][j], w[1][j], 1e-12);
        double t = fmin(s, 1 - s), end = t * t * t * (43.2 - 129.6 * t);
        NEAR(w[1][j], t > 1.0 / 6 ? 1.1 - 1.2 * s : s < 0.5 ? 1 - end : end, 1e-13);
        NEAR(w[2][j], held[j] ? 0 : w[0][j], held[j] ? 0 : 1e-12);
        whole += w[0][j] == 1, none += w[0][j] == 0;
    }
    assert_true(whole > 5 && none > 5 && whole + none < N - 50);
    mesh_end(&m);
}

/* The velocities of a fade from the line are the derivatives of its positions, as in velocity_is_the_rate. Nodes up to
   `within` have the bits that they have without it, those from `beyond` on stand still; a fade given before the map,
   after it, and mapped again is the same. */
static void fade_moves_as_its_rate(void **state) {
    (void)state;
    static motion at, less, more, plain, late;
    const double h = 1e-5, t = 0.7, size = 0.05;
    mesh m;
    double distance[N];
    int whole = 0, none = 0, part = 0;
    mesh_begin(&m, 2, SPAR_INTERPOLATE_CONSISTENT);
    OK(m.session, spar_fluid_fade_motion(m.weighted, 0.4, 1, N, NULL, NULL));
    mesh_map(&m);
    OK(m.session, spar_fluid_get_map(m.weighted, SPAR_NODES_MOTION, NULL, distance, NULL));
    set_pose(&m, t - h, size);
    pull(&m, m.weighted, 1, &less);
    set_pose(&m, t + h, size);
    pull(&m, m.weighted, 1, &more);
    set_pose(&m, t, size);
    pull(&m, m.weighted, 1, &at);
    pull(&m, m.plain, 1, &plain);
    for (int j = 0; j < N; j++) {
        for (int c = 0; c < 3; c++) {
            NEAR((more.x[j][c] - less.x[j][c]) / (2 * h), at.v[j][c], 1e-8);
            NEAR((more.v[j][c] - less.v[j][c]) / (2 * h), at.a[j][c], 1e-7);
            assert_true(distance[j] > 0.4 || (at.x[j][c] == plain.x[j][c] && at.v[j][c] == plain.v[j][c]));
            assert_true(distance[j] < 1 || (at.x[j][c] == m.X[j][c] && at.v[j][c] == 0 && at.a[j][c] == 0));
        }
        whole += distance[j]<0.4, none += distance[j]> 1, part += distance[j] > 0.5 && distance[j] < 0.9;
    }
    assert_true(whole > 20 && none > 20 && part > 20);
    mesh_map(&m);
    OK(m.session, spar_fluid_set_motion_weights(m.weighted, 0, NULL));
    pull(&m, m.weighted, 1, &late);
    for (int j = 0; j < N; j++) { /* positions from nearest points and arms: rounding of numbers up to 10 */
        for (int c = 0; c < 3; c++) {
            NEAR(late.x[j][c], plain.x[j][c], 1e-13);
        }
    }
    OK(m.session, spar_fluid_fade_motion(m.weighted, 0.4, 1, N, NULL, NULL));
    pull(&m, m.weighted, 1, &late);
    for (int j = 0; j < N; j++) {
        for (int c = 0; c < 3; c++) {
            NEAR(late.x[j][c], at.x[j][c], 1e-13);
        }
    }
    mesh_end(&m);
}

/* ---- a cantilever that bends, and the mesh around it ---- */

enum { WIDE = 376, HIGH = 201, GRID = WIDE * HIGH };
static const double cell = 0.002, span = 0.35;

/* Turek and Hron's flag in a channel, 0.35 m long, walls 0.2 m from its line; vertices every 2 mm, those within the
   walls and as far before the root and behind the tip. */
typedef struct flag {
    spar_session *session;
    spar_member *beam;
    spar_fluid *fluid;
    double eta[8];
    int warnings;
    double (*X)[3], (*x)[3];
} flag;

static void count(const spar_session *session, int level, const char *text, void *context) {
    flag *f = context;
    (void)session;
    f->warnings += level == SPAR_LOG_WARNING && strstr(text, "fade") != NULL;
}

static void flag_begin(flag *f) {
    const double eta[2] = {0, 1}, line[6] = {0, 0, 0, span, 0, 0};
    double xr[8][3];
    memset(f, 0, sizeof *f);
    OK(NULL, spar_session_create(&f->session));
    OK(f->session, spar_session_set_log(f->session, count, f));
    OK(f->session, spar_beam_create(f->session, "flag", 1, 8, &f->beam));
    OK(f->session, spar_beam_set_axis(f->beam, 2, eta, line, NULL));
    OK(f->session, spar_member_set_external(f->beam, 1));
    OK(f->session, spar_member_commit(f->beam));
    OK(f->session, spar_member_get_reference(f->beam, xr[0], NULL));
    for (int l = 0; l < 8; l++) {
        f->eta[l] = xr[l][0] / span;
    }
    f->X = calloc(GRID, sizeof *f->X), f->x = calloc(GRID, sizeof *f->x);
    assert_non_null(f->X);
    assert_non_null(f->x);
    for (int i = 0; i < WIDE; i++) {
        for (int k = 0; k < HIGH; k++) {
            f->X[i * HIGH + k][0] = (i - 100) * cell, f->X[i * HIGH + k][1] = (k - 100) * cell;
        }
    }
    OK(f->session, spar_fluid_create(f->beam, "mesh", &f->fluid));
    OK(f->session, spar_fluid_set_motion_nodes(f->fluid, GRID, f->X[0]));
    OK(f->session, spar_fluid_map(f->fluid));
}

static void flag_end(flag *f) {
    spar_session_destroy(&f->session);
    free(f->X);
    free(f->x);
}

/* Where a line of curvature c (1 - eta), that does not stretch, is at eta: x, y, and its slope. */
static void bent_line(double c, double eta, double at[3]) {
    const int steps = 400;
    memset(at, 0, 3 * sizeof *at);
    for (int i = 0; i < steps; i++) { /* midpoints: error 1e-6 of the length */
        double z = (i + 0.5) / steps * eta, angle = c * span * (z - z * z / 2);
        at[0] += cos(angle) * span * eta / steps, at[1] += sin(angle) * span * eta / steps;
    }
    at[2] = c * span * (eta - eta * eta / 2);
}

/* The tip is `tip` away from its reference position, across. Returns the status of the pull. */
static int bend(flag *f, double tip) {
    double q[8][7] = {{0}}, v[8][6] = {{0}}, at[3], low = 0, high = 9;
    for (int i = 0; i < 60; i++) {
        double c = (low + high) / 2;
        bent_line(c, 1, at);
        low = at[1] < tip ? c : low, high = at[1] < tip ? high : c;
    }
    for (int l = 0; l < 8; l++) {
        bent_line(low, f->eta[l], at);
        const double psi[3] = {0, 0, at[2]};
        q[l][0] = at[0] - f->eta[l] * span, q[l][1] = at[1];
        spari_quat_exp(psi, q[l] + 3);
    }
    OK(f->session, spar_member_set_motion(f->beam, q[0], v[0], NULL));
    return spar_fluid_pull_motion(f->fluid, 1, f->x[0], NULL);
}

/* The line is straight, at an angle. Returns the status of the pull. */
static int rotate(flag *f, double angle) {
    double q[8][7] = {{0}}, v[8][6] = {{0}};
    const double psi[3] = {0, 0, angle};
    for (int l = 0; l < 8; l++) {
        double s = f->eta[l] * span;
        q[l][0] = s * (cos(angle) - 1), q[l][1] = s * sin(angle);
        spari_quat_exp(psi, q[l] + 3);
    }
    OK(f->session, spar_member_set_motion(f->beam, q[0], v[0], NULL));
    return spar_fluid_pull_motion(f->fluid, 1, f->x[0], NULL);
}

/* The least area of a corner of a cell, relative to that at rest: below 0 the cell is folded. */
static double least_corner(const flag *f) {
    double least = HUGE_VAL;
    for (int i = 0; i + 1 < WIDE; i++) {
        for (int k = 0; k + 1 < HIGH; k++) {
            const int at[4] = {i * HIGH + k, (i + 1) * HIGH + k, (i + 1) * HIGH + k + 1, i * HIGH + k + 1};
            for (int c = 0; c < 4; c++) {
                const double *x = f->x[at[c]], *on = f->x[at[(c + 1) % 4]], *back = f->x[at[(c + 3) % 4]];
                double area = (on[0] - x[0]) * (back[1] - x[1]) - (on[1] - x[1]) * (back[0] - x[0]);
                least = fmin(least, area / (cell * cell));
            }
        }
    }
    return least;
}

/* FSI2's largest deflection, 95 mm, with a fade from 0.02 m to the walls: no cell has less than a quarter of its area
   (an implementation of the formulas of the header in numpy, cells of 0.25 mm: 0.289). With w = 1 - 10 s^3 + 15 s^4 - 6
   s^5 over whole arms, the fade of earlier releases, cells fold (numpy: -0.028). The fade warns before cells fold,
   once; where layers pass each other the pull is refused, and goes on once the member is back. */
static void bent_cantilever_keeps_its_mesh(void **state) {
    (void)state;
    flag f;
    double *w = calloc(GRID, sizeof *w), *distance = calloc(GRID, sizeof *distance);
    assert_non_null(w);
    assert_non_null(distance);
    flag_begin(&f);
    OK(f.session, spar_fluid_get_map(f.fluid, SPAR_NODES_MOTION, NULL, distance, NULL));
    for (int j = 0; j < GRID; j++) {
        double s = fmin(fmax((distance[j] - 0.02) / 0.18, 0), 1);
        w[j] = 1 - s * s * s * (10 - 15 * s + 6 * s * s);
    }
    OK(f.session, spar_fluid_set_motion_weights(f.fluid, GRID, w));
    OK(f.session, bend(&f, 0.095));
    assert_true(least_corner(&f) < 0);
    OK(f.session, spar_fluid_fade_motion(f.fluid, 0.02, 0.2, GRID, NULL, NULL));
    OK(f.session, bend(&f, 0.095));
    printf("least Jacobian with the tip 95 mm out: %.3f\n", least_corner(&f));
    assert_true(least_corner(&f) > 0.25);
    double least = 1, tip = 0.1;
    for (; f.warnings == 0; tip += 0.001) {
        OK(f.session, bend(&f, tip));
        least = least_corner(&f);
    }
    printf("warned with the tip %.0f mm out, Jacobian %.3f\n", 1000 * tip - 1, least);
    assert_true(fabs(least - 0.2) < 0.015); /* a step of the tip changes it by 0.009 */
    for (; bend(&f, tip) == SPAR_OK; tip += 0.001) {
        least = least_corner(&f);
    }
    printf("refused with the tip %.0f mm out, the last accepted Jacobian %.3f\n", 1000 * tip, least);
    assert_true(fabs(least) < 0.015);
    assert_int_equal(f.warnings, 1);
    REFUSED(f.session, SPAR_ERR_NUMERIC, "folds", bend(&f, tip));
    REFUSED(f.session, SPAR_ERR_NUMERIC, "0.02 to 0.2 m", bend(&f, 0.18));
    OK(f.session, bend(&f, 0.095));
    assert_true(least_corner(&f) > 0.25);
    flag_end(&f);
    free(w);
    free(distance);
}

/* Far from the line the rotation of a section acts on an arm of twice `within`: with a rigid line that rotates by 1.2
   rad about its root, a node moves as its nearest point, but for 2 sin(0.6) times twice `within`. Beyond a right angle
   the mesh around folds. The width of the fade leaves weights above 1 - 1e-6. */
static void far_nodes_do_not_rotate(void **state) {
    (void)state;
    const double within = 0.005;
    flag f;
    flag_begin(&f);
    OK(f.session, spar_fluid_fade_motion(f.fluid, within, 1000, GRID, NULL, NULL));
    OK(f.session, rotate(&f, 1.2));
    double most = 0;
    for (int j = 0; j < GRID; j++) {
        double s = fmin(fmax(f.X[j][0], 0), span),
               d[2] = {f.x[j][0] - f.X[j][0] - s * (cos(1.2) - 1), f.x[j][1] - f.X[j][1] - s * sin(1.2)};
        most = fmax(most, hypot(d[0], d[1]));
    }
    NEAR(most, 2 * sin(0.6) * 2 * within, 1e-5);
    assert_true(least_corner(&f) > 0.3); /* cos(1.2) = 0.36 */
    REFUSED(f.session, SPAR_ERR_NUMERIC, "folds", rotate(&f, 1.6));
    flag_end(&f);
}

/* ---- refusals ---- */

/* Each has its status and message, and leaves the weights as they were. */
static void bad_weights_are_refused(void **state) {
    (void)state;
    static motion a;
    const double bad[] = {NAN, -1e-9, 1.0000001, INFINITY, -INFINITY}, eta[2] = {0, 1};
    double q[N][4], matrix[N][9], got[N], turn[N][3];
    mesh m;
    mesh_begin(&m, 2, SPAR_INTERPOLATE_NODAL);
    spar_session *s = m.session;
    OK(s, spar_fluid_set_motion_weights(m.weighted, N, m.w));
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        double w[N], d[N] = {0};
        memcpy(w, m.w, sizeof w);
        w[17] = bad[k], d[17] = NAN;
        REFUSED(s, SPAR_ERR_ARGUMENT, "motion node 17", spar_fluid_set_motion_weights(m.weighted, N, w));
        REFUSED(s, SPAR_ERR_ARGUMENT, "17", spar_fluid_fade_motion(m.weighted, 0, 1, N, d, NULL));
    }
    assert_int_equal(spar_fluid_set_motion_weights(NULL, N, m.w), SPAR_ERR_ARGUMENT);
    REFUSED(s, SPAR_ERR_ARGUMENT, "299 weights", spar_fluid_set_motion_weights(m.weighted, N - 1, m.w));
    REFUSED(s, SPAR_ERR_ARGUMENT, "weights for", spar_fluid_set_motion_weights(m.weighted, -1, m.w));
    REFUSED(s, SPAR_ERR_ARGUMENT, "NULL", spar_fluid_set_motion_weights(m.weighted, N, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "NULL", spar_fluid_get_motion_weights(m.weighted, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "blending", spar_fluid_fade_motion(m.weighted, 1, 1, N, NULL, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "blending", spar_fluid_fade_motion(m.weighted, NAN, 1, N, NULL, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "blending", spar_fluid_fade_motion(m.weighted, 0, INFINITY, N, NULL, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "weights for", spar_fluid_fade_motion(m.weighted, 0, 1, 0, NULL, NULL));
    mesh_map(&m);
    REFUSED(s, SPAR_ERR_UNSUPPORTED, "weights",
            spar_fluid_pull_poses(m.weighted, SPAR_NODES_MOTION, 1, NULL, q[0], NULL, NULL, NULL, NULL));
    REFUSED(s, SPAR_ERR_UNSUPPORTED, "weights",
            spar_fluid_pull_poses(m.weighted, SPAR_NODES_MOTION, 1, NULL, NULL, NULL, turn[0], NULL, NULL));
    REFUSED(s, SPAR_ERR_UNSUPPORTED, "weights",
            spar_fluid_pull_poses(m.weighted, SPAR_NODES_MOTION, 1, a.x[0], NULL, NULL, NULL, NULL, turn[0]));
    REFUSED(s, SPAR_ERR_UNSUPPORTED, "weights", spar_fluid_pull_matrices(m.weighted, 1, 0, matrix[0]));
    REFUSED(s, SPAR_ERR_UNSUPPORTED, "weights", spar_fluid_check_matrices(m.weighted, 0, matrix[0]));
    OK(s, spar_fluid_pull_poses(m.weighted, SPAR_NODES_MOTION, 1, a.x[0], NULL, a.v[0], NULL, a.a[0], NULL));
    OK(s, spar_step_begin(s, 0.1));
    REFUSED(s, SPAR_ERR_STATE, "in progress", spar_fluid_set_motion_weights(m.weighted, N, m.w));
    REFUSED(s, SPAR_ERR_STATE, "in progress", spar_fluid_set_motion_weights(m.weighted, 0, NULL));
    REFUSED(s, SPAR_ERR_STATE, "in progress", spar_fluid_fade_motion(m.weighted, 0, 1, N, NULL, NULL));
    OK(s, spar_step_reject(s));
    OK(s, spar_fluid_get_motion_weights(m.weighted, got));
    assert_memory_equal(got, m.w, sizeof got);
    OK(s, spar_fluid_set_stations(m.plain, 2, eta, NULL));
    REFUSED(s, SPAR_ERR_STATE, "sections", spar_fluid_set_motion_weights(m.plain, 2, m.w));
    REFUSED(s, SPAR_ERR_STATE, "sections", spar_fluid_fade_motion(m.plain, 0, 1, 2, NULL, NULL));
    spar_member *raw;
    spar_fluid *f;
    OK(s, spar_beam_create(s, "raw", 1, 4, &raw));
    OK(s, spar_fluid_create(raw, "on it", &f));
    OK(s, spar_fluid_set_motion_nodes(f, 2, m.X[0]));
    REFUSED(s, SPAR_ERR_STATE, "commit", spar_fluid_fade_motion(f, 0, 1, 2, NULL, NULL));
    OK(s, spar_fluid_fade_motion(f, 0, 1, 2, eta, NULL));
    mesh_end(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_is_as_without),
        cmocka_unit_test(part_of_the_motion),
        cmocka_unit_test(velocity_is_the_rate),
        cmocka_unit_test(parts_add_to_the_whole),
        cmocka_unit_test(life_of_weights),
        cmocka_unit_test(trials_keep_weights),
        cmocka_unit_test(saved_and_loaded),
        cmocka_unit_test(fades_smoothly),
        cmocka_unit_test(fades_from_the_line),
        cmocka_unit_test(fade_moves_as_its_rate),
        cmocka_unit_test(bent_cantilever_keeps_its_mesh),
        cmocka_unit_test(far_nodes_do_not_rotate),
        cmocka_unit_test(bad_weights_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
