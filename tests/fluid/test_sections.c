/* Fluids of sections: motion nodes apart from force nodes, force nodes' places between the times, and the getters that
 * pictures are made with. The beam is external, so that its motion is what the test says. */
#include "check.h"

#include "fluid/fluid.h"
#include "math/rotation.h"
#include "trial/rebuild.h"

#include <spar/spar_aero.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N = 7, M = 4, MOST = 32 };

static const double force_eta[N] = {0, 0.1, 0.35, 0.5, 0.625, 0.85, 1}, motion_eta[M] = {0.025, 0.45, 0.7, 0.95};
static const double force_offset[N][3] = {{0, 0.1, 0}, {0, -0.2, 0.1},   {0.1, 0, 0}, {0, 0, 0},
                                          {0, 0.5, 0}, {0, 0.3, -0.125}, {0, 0.25, 0}};
static const double motion_offset[M][3] = {{0, 0.6, 0.2}, {0, -0.2, 0.1}, {0, 0, 0.3}, {0.1, 0.2, 0.3}};

typedef struct blade {
    spar_session *session;
    spar_member *beam;
    int64_t nodes;
    double xr[MOST][3];
} blade;

/* A curved, twisted beam of two elements; straight ones have the same line whatever their nodes. */
static void blade_begin(blade *b, int straight) {
    double eta[11], xyz[11][3], twist[11];
    memset(b, 0, sizeof *b);
    for (int i = 0; i < 11; i++) {
        eta[i] = 0.1 * i, twist[i] = straight ? 0.2 : 0.4 * (1 - eta[i]);
        xyz[i][0] = 10 * eta[i], xyz[i][1] = straight ? 0 : 0.8 * eta[i] * eta[i], xyz[i][2] = 0;
    }
    OK(NULL, spar_session_create(&b->session));
    OK(b->session, spar_beam_create(b->session, "blade", 2, 6, &b->beam));
    OK(b->session, spar_beam_set_axis(b->beam, 11, eta, xyz[0], twist));
    OK(b->session, spar_member_set_external(b->beam, 1));
    OK(b->session, spar_member_commit(b->beam));
    OK(b->session, spar_member_get_count(b->beam, &b->nodes));
    OK(b->session, spar_member_get_reference(b->beam, b->xr[0], NULL));
}

static void blade_end(blade *b) {
    spar_session_destroy(&b->session);
}

static void move(const blade *b, double t) {
    double q[MOST][7], v[MOST][6];
    for (int l = 0; l < b->nodes; l++) {
        double s = b->xr[l][0] / 10, psi[3] = {0.4 * t * s, -0.3 * t, 0.5 * t * s * s};
        spari_quat_exp(psi, q[l] + 3);
        for (int i = 0; i < 3; i++) {
            q[l][i] = t * (0.2 * i + s * (i + 1)), v[l][i] = 0.2 * i + s * (i + 1), v[l][3 + i] = psi[i];
        }
    }
    OK(b->session, spar_member_set_motion(b->beam, q[0], v[0], NULL));
}

/* Sections at the force places; apart: with motion nodes at others. */
static spar_fluid *line(const blade *b, const char *name, int apart) {
    spar_fluid *f = NULL;
    OK(b->session, spar_fluid_create(b->beam, name, &f));
    OK(b->session, spar_fluid_set_stations(f, N, force_eta, force_offset[0]));
    if (apart) {
        OK(b->session, spar_fluid_set_motion_stations(f, M, motion_eta, motion_offset[0]));
    }
    OK(b->session, spar_fluid_map(f));
    return f;
}

static void some_forces(double (*f)[3], double size) {
    for (int j = 0; j < N; j++) {
        for (int i = 0; i < 3; i++) {
            f[j][i] = size * sin(1.7 * j + i);
        }
    }
}

/* ---- the same places ---- */

/* Motion sections where the force sections are: every pull, the audit and the kept forces have the bits of sections
   that serve both, over three steps. */
static void same_places_same_bits(void **state) {
    (void)state;
    blade b;
    blade_begin(&b, 0);
    spar_fluid *f[2] = {line(&b, "shared", 0), line(&b, "apart", 0)};
    OK(b.session, spar_fluid_set_motion_stations(f[1], N, force_eta, force_offset[0]));
    OK(b.session, spar_fluid_map(f[1]));
    for (int k = 0; k < 3; k++) {
        OK(b.session, spar_step_begin(b.session, 0.1));
        move(&b, 0.1 * (k + 1));
        for (int i = 0; i < 3; i++) {
            double x[2][N][3], v[2][N][3], w[2][N][3], q[2][N][4], force[2][N][3] = {{{0}}}, audit[2][8];
            for (int j = 0; j < 2; j++) {
                OK(b.session, spar_fluid_pull_poses(f[j], SPAR_NODES_MOTION, 0.5 * i, x[j][0], q[j][0], v[j][0],
                                                    w[j][0], NULL, NULL));
                some_forces(force[j], 3 + k + i);
                OK(b.session, spar_fluid_push_forces(f[j], force[j][0], NULL));
                OK(b.session, spar_fluid_get_audit(f[j], 8, audit[j]));
                OK(b.session, spar_fluid_pull_forces(f[j], 0.5 * i, force[j][0]));
            }
            assert_memory_equal(x[0], x[1], sizeof x[0]);
            assert_memory_equal(q[0], q[1], sizeof q[0]);
            assert_memory_equal(v[0], v[1], sizeof v[0]);
            assert_memory_equal(w[0], w[1], sizeof w[0]);
            assert_memory_equal(audit[0], audit[1], sizeof audit[0]);
            assert_memory_equal(force[0], force[1], sizeof force[0]);
            assert_true(i < 2 || (force[0][1][1] != 0 && v[0][1][1] != 0));
        }
        OK(b.session, spar_step_solve(b.session));
        OK(b.session, spar_step_accept(b.session));
    }
    blade_end(&b);
}

/* ---- other places ---- */

/* Motion nodes are those of a fluid of their own sections, force nodes those of theirs, at t^n, between, t^{n+1}, in
   average and on the group: bits. What the getters say at t^{n+1} is the same; the foot is the node less the turned
   arm, to rounding; none of them counts as a pull. */
static void either_set_is_where_asked(void **state) {
    (void)state;
    blade b;
    int kind[2];
    double x[2][N][3], v[2][N][3], q[2][N][4], w[2][N][3], a[2][N][3], alpha[2][N][3], foot[N][3], rest[N][4],
        con[N][3], arm[3], back[4], turn[4];
    blade_begin(&b, 0);
    spar_fluid *both = line(&b, "apart", 1), *motion = NULL, *force = line(&b, "forces", 0),
               *unpulled = line(&b, "unpulled", 0);
    OK(b.session, spar_fluid_create(b.beam, "motion", &motion));
    OK(b.session, spar_fluid_set_stations(motion, M, motion_eta, motion_offset[0]));
    OK(b.session, spar_fluid_map(motion));
    OK(b.session, spar_fluid_get_kind(both, SPAR_NODES_MOTION, &kind[0]));
    OK(b.session, spar_fluid_get_kind(both, SPAR_NODES_FORCE, &kind[1]));
    assert_int_equal(kind[0], SPAR_KIND_STATIONS);
    assert_int_equal(kind[1], SPAR_KIND_STATIONS | SPAR_KIND_FORCES);
    OK(b.session, spar_fluid_get_kind(motion, SPAR_NODES_MOTION, &kind[0]));
    assert_int_equal(kind[0], SPAR_KIND_STATIONS | SPAR_KIND_SHARED | SPAR_KIND_FORCES);
    move(&b, 0.2);
    for (int i = 0; i < 6; i++) {
        double theta = 0.5 * (i % 3);
        if (i % 3 == 0) {
            OK(b.session, i > 0 ? spar_step_reject(b.session) : SPAR_OK);
            spar_fluid *all[] = {both, motion, force, unpulled};
            for (int k = 0; k < 4; k++) {
                OK(b.session, spar_fluid_set_option(all[k], "theta", i < 3 ? "average" : "group"));
            }
            OK(b.session, spar_step_begin(b.session, 0.1));
            move(&b, 0.7);
        }
        OK(b.session,
           spar_fluid_pull_poses(both, SPAR_NODES_MOTION, theta, x[0][0], q[0][0], v[0][0], NULL, NULL, NULL));
        OK(b.session,
           spar_fluid_pull_poses(motion, SPAR_NODES_MOTION, theta, x[1][0], q[1][0], v[1][0], NULL, NULL, NULL));
        assert_memory_equal(x[0], x[1], M * sizeof x[0][0]);
        assert_memory_equal(q[0], q[1], M * sizeof q[0][0]);
        assert_memory_equal(v[0], v[1], M * sizeof v[0][0]);
        OK(b.session, spar_fluid_pull_poses(both, SPAR_NODES_FORCE, theta, x[0][0], q[0][0], v[0][0], w[0][0], a[0][0],
                                            alpha[0][0]));
        OK(b.session, spar_fluid_pull_poses(force, SPAR_NODES_MOTION, theta, x[1][0], q[1][0], v[1][0], w[1][0],
                                            a[1][0], alpha[1][0]));
        assert_memory_equal(x[0], x[1], sizeof x[0]);
        assert_memory_equal(q[0], q[1], sizeof q[0]);
        assert_memory_equal(v[0], v[1], sizeof v[0]);
        assert_memory_equal(w[0], w[1], sizeof w[0]);
        assert_memory_equal(a[0], a[1], sizeof a[0]);
        assert_memory_equal(alpha[0], alpha[1], sizeof alpha[0]);
        assert_true(i % 3 == 0 || (w[0][1][0] != 0 && a[0][1][0] != 0));
    }
    int asked = spari_fluid_asked(both);
    OK(b.session, spar_fluid_get_positions(both, SPAR_NODES_FORCE, x[0][0], q[0][0], v[0][0], foot[0]));
    assert_int_equal(spari_fluid_asked(both), asked);
    assert_memory_equal(x[0], x[1], sizeof x[0]);
    assert_memory_equal(q[0], q[1], sizeof q[0]);
    assert_memory_equal(v[0], v[1], sizeof v[0]);
    OK(b.session, spar_fluid_get_nearest(both, SPAR_NODES_FORCE, NULL, rest[0], con[0]));
    for (int j = 0; j < N; j++) {
        spari_quat_conj(rest[j], back);
        spari_quat_mul(q[0][j], back, turn);
        spari_rotate(turn, con[j], arm);
        for (int i = 0; i < 3; i++) {
            NEAR(foot[j][i], x[0][j][i] - arm[i], 1e-14 * 20);
        }
    }
    OK(b.session, spar_fluid_get_positions(unpulled, SPAR_NODES_MOTION, x[0][0], q[0][0], v[0][0], NULL));
    OK(b.session, spar_fluid_get_forces(unpulled, x[0][0]));
    assert_int_equal(spari_fluid_asked(unpulled), 0);
    blade_end(&b);
}

/* Force, moment about the origin and power of the forces at the force nodes come through, though motion nodes are
   elsewhere: the audit to 1e-13 of the sums of sizes, and the total against the nodes' own places. */
static void loads_are_conserved(void **state) {
    (void)state;
    blade b;
    double force[N][3], x[N][3], v[N][3], audit[8], total[6], want[6] = {0}, power = 0, t[3];
    blade_begin(&b, 0);
    spar_fluid *f = line(&b, "apart", 1);
    OK(b.session, spar_step_begin(b.session, 0.1));
    move(&b, 0.8);
    some_forces(force, 20);
    OK(b.session, spar_fluid_push_forces(f, force[0], NULL));
    OK(b.session, spar_fluid_get_audit(f, 8, audit));
    assert_true(audit[SPAR_AUDIT_FORCE_ERROR] < 1e-13 && audit[SPAR_AUDIT_MOMENT_ERROR] < 1e-13 &&
                audit[SPAR_AUDIT_POWER_ERROR] < 1e-13 && audit[SPAR_AUDIT_NODES] == N);
    OK(b.session, spar_fluid_pull_poses(f, SPAR_NODES_FORCE, 1, x[0], NULL, v[0], NULL, NULL, NULL));
    for (int j = 0; j < N; j++) {
        spari_cross(x[j], force[j], t);
        power += spari_dot(force[j], v[j]);
        for (int i = 0; i < 3; i++) {
            want[i] += force[j][i], want[3 + i] += t[i];
        }
    }
    NEAR(audit[SPAR_AUDIT_POWER], power, 1e-12 * 2000);
    assert_true(fabs(power) > 10);
    OK(b.session, spar_fluid_sum_loads(f, NULL, total, total + 3));
    for (int i = 0; i < 6; i++) {
        NEAR(total[i], want[i], 1e-12 * 2000);
    }
    assert_true(spari_norm(want + 3) > 10);
    blade_end(&b);
}

/* Motion nodes replaced between steps leave force nodes, their map and kept forces alone; sections that bear forces
   keep them whether they serve both sets or not; loose force nodes beside motion sections do not. */
static void force_sections_stay(void **state) {
    (void)state;
    blade b;
    int kind;
    int64_t n;
    double force[N][3], got[N][3], x[2][N][3];
    blade_begin(&b, 0);
    spar_fluid *f = line(&b, "line", 0), *loose = NULL;
    some_forces(force, 2);
    OK(b.session, spar_fluid_push_forces(f, force[0], NULL));
    OK(b.session, spar_fluid_get_positions(f, SPAR_NODES_FORCE, x[0][0], NULL, NULL, NULL));
    OK(b.session, spar_fluid_set_motion_stations(f, M, motion_eta, NULL));
    OK(b.session, spar_fluid_get_kind(f, SPAR_NODES_FORCE, &kind));
    assert_int_equal(kind, SPAR_KIND_STATIONS | SPAR_KIND_FORCES);
    REFUSED(b.session, SPAR_ERR_STATE, "spar_fluid_map", spar_fluid_pull_motion(f, 1, x[1][0], NULL));
    OK(b.session, spar_fluid_map(f));
    OK(b.session, spar_fluid_get_count(f, SPAR_NODES_MOTION, &n));
    assert_int_equal(n, M);
    OK(b.session, spar_fluid_get_count(f, SPAR_NODES_FORCE, &n));
    assert_int_equal(n, N);
    OK(b.session, spar_fluid_get_positions(f, SPAR_NODES_FORCE, x[1][0], NULL, NULL, NULL));
    assert_memory_equal(x[0], x[1], sizeof x[0]);
    OK(b.session, spar_fluid_get_forces(f, got[0]));
    assert_memory_equal(got, force, sizeof got);
    OK(b.session, spar_fluid_set_stations(f, N, force_eta, NULL)); /* both again */
    OK(b.session, spar_fluid_get_kind(f, SPAR_NODES_MOTION, &kind));
    assert_true(kind & SPAR_KIND_SHARED);
    OK(b.session, spar_fluid_create(b.beam, "loose", &loose));
    OK(b.session, spar_fluid_set_force_nodes(loose, N, x[0][0]));
    OK(b.session, spar_fluid_set_motion_stations(loose, M, motion_eta, NULL));
    OK(b.session, spar_fluid_map(loose));
    OK(b.session, spar_fluid_get_kind(loose, SPAR_NODES_FORCE, &kind));
    assert_int_equal(kind, 0);
    REFUSED(b.session, SPAR_ERR_STATE, "SPAR_EFFECT_FLUID_HISTORY", spar_fluid_get_forces(loose, got[0]));
    OK(b.session, spar_fluid_pull_motion(loose, 1, x[0][0], NULL));
    blade_end(&b);
}

/* Saved and loaded into a session of the same description: motion, kept forces and force places to the bit. */
static void apart_saved_and_loaded(void **state) {
    (void)state;
    const char *file = "sections.spar";
    blade b[2];
    spar_fluid *f[2];
    double force[N][3], x[2][N][3], p[2][N][3], got[2][N][3];
    for (int k = 0; k < 2; k++) {
        blade_begin(&b[k], 0);
        f[k] = line(&b[k], "apart", 1);
    }
    for (int k = 0; k < 2; k++) {
        OK(b[0].session, spar_step_begin(b[0].session, 0.1));
        move(&b[0], 0.1 * (k + 1));
        some_forces(force, 5 + k);
        OK(b[0].session, spar_step_solve(b[0].session));
        OK(b[0].session, spar_fluid_push_forces(f[0], force[0], NULL));
        OK(b[0].session, spar_step_accept(b[0].session));
    }
    OK(b[0].session, spar_session_save(b[0].session, file));
    OK(b[1].session, spar_session_load(b[1].session, file));
    for (int k = 0; k < 2; k++) {
        OK(b[k].session, spar_step_begin(b[k].session, 0.1)); /* predicts the forces from the history */
        OK(b[k].session, spar_fluid_pull_motion(f[k], 0.5, x[k][0], NULL));
        OK(b[k].session, spar_fluid_pull_poses(f[k], SPAR_NODES_FORCE, 0.5, p[k][0], NULL, NULL, NULL, NULL, NULL));
        OK(b[k].session, spar_fluid_pull_forces(f[k], 0.5, got[k][0]));
    }
    assert_memory_equal(x[0], x[1], M * sizeof x[0][0]);
    assert_memory_equal(p[0], p[1], sizeof p[0]);
    assert_memory_equal(got[0], got[1], sizeof got[0]);
    assert_true(spari_norm(got[0][1]) > 1);
    blade_end(&b[0]);
    blade_end(&b[1]);
    assert_int_equal(remove(file), 0);
}

/* ---- stations given anew ---- */

static void step_with(const blade *b, spar_fluid *f, double (*force)[3]) {
    OK(b->session, spar_step_begin(b->session, 0.1));
    OK(b->session, spar_step_solve(b->session));
    OK(b->session, spar_fluid_push_forces(f, force[0], NULL));
    OK(b->session, spar_step_accept(b->session));
}

static void forces_are(const blade *b, spar_fluid *f, double theta, int n, double (*want)[3], double factor) {
    double got[N][3];
    OK(b->session, spar_fluid_pull_forces(f, theta, got[0]));
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < 3; i++) {
            NEAR(got[j][i], factor * want[j][i], 1e-12);
        }
    }
}

/* Between two steps as many stations are given anew as there were: with the same force in every step the kept ones are
   this force at any theta, before the push and after. */
static void as_many_stations_keep_forces(void **state) {
    (void)state;
    blade b;
    double force[N][3];
    blade_begin(&b, 0);
    spar_fluid *f = line(&b, "line", 1);
    some_forces(force, 60);
    for (int k = 0; k < 3; k++) {
        step_with(&b, f, force);
    }
    OK(b.session, spar_fluid_set_stations(f, N, force_eta, NULL));
    OK(b.session, spar_fluid_map(f));
    forces_are(&b, f, 1, N, force, 1);
    OK(b.session, spar_step_begin(b.session, 0.1));
    forces_are(&b, f, 0.5, N, force, 1);
    OK(b.session, spar_step_solve(b.session));
    OK(b.session, spar_fluid_push_forces(f, force[0], NULL));
    forces_are(&b, f, 0, N, force, 1);
    forces_are(&b, f, 0.5, N, force, 1);
    OK(b.session, spar_step_accept(b.session));
    blade_end(&b);
}

#ifndef SPREAD_H
/* Other stations, while the fluid has loads: their forces are refused until they are pushed. Then those count for the
   whole step; the steps after extrapolate from them alone, at first constant, then linear. A run loaded in between
   knows as little. */
static void other_stations_have_unknown_forces(void **state) {
    (void)state;
    const char *file = "stations.spar";
    blade b[2];
    double force[N][3], got[N][3];
    int kind[2];
    spar_fluid *f[2];
    some_forces(force, 60);
    for (int k = 0; k < 2; k++) {
        blade_begin(&b[k], 0);
        f[k] = line(&b[k], "line", 0);
    }
    for (int k = 0; k < 3; k++) {
        step_with(&b[0], f[0], force);
    }
    for (int k = 0; k < 2; k++) {
        OK(b[k].session, spar_fluid_set_stations(f[k], M, motion_eta, NULL));
        OK(b[k].session, spar_fluid_map(f[k]));
        OK(b[k].session, spar_fluid_get_kind(f[k], SPAR_NODES_FORCE, &kind[k]));
    }
    assert_int_equal(kind[0] & SPAR_KIND_FORCES, 0);
    assert_int_equal(kind[1] & SPAR_KIND_FORCES, SPAR_KIND_FORCES); /* no loads: zeros are right */
    OK(b[0].session, spar_session_save(b[0].session, file));
    OK(b[1].session, spar_session_load(b[1].session, file));
    for (int k = 0; k < 2; k++) {
        REFUSED(b[k].session, SPAR_ERR_STATE, "not known before they are pushed", spar_fluid_get_forces(f[k], got[0]));
        OK(b[k].session, spar_step_begin(b[k].session, 0.1));
        REFUSED(b[k].session, SPAR_ERR_STATE, "not known before they are pushed",
                spar_fluid_pull_forces(f[k], 0.5, got[0]));
        OK(b[k].session, spar_step_solve(b[k].session));
        OK(b[k].session, spar_fluid_push_forces(f[k], force[0], NULL));
        forces_are(&b[k], f[k], 0, M, force, 1);
        forces_are(&b[k], f[k], 0.25, M, force, 1);
        OK(b[k].session, spar_step_accept(b[k].session));
        OK(b[k].session, spar_step_begin(b[k].session, 0.1));
        forces_are(&b[k], f[k], 1, M, force, 1);
        OK(b[k].session, spar_step_reject(b[k].session));
        for (int j = 0; j < M; j++) {
            for (int i = 0; i < 3; i++) {
                got[j][i] = 3 * force[j][i];
            }
        }
        step_with(&b[k], f[k], got);
        OK(b[k].session, spar_step_begin(b[k].session, 0.1));
        forces_are(&b[k], f[k], 1, M, force, 5);
        forces_are(&b[k], f[k], 0.5, M, force, 4);
        blade_end(&b[k]);
    }
    assert_int_equal(remove(file), 0);
}
#endif

/* In a trial with other nodes both sets stay where they are, at rest to rounding, and come back to the bit. */
static void apart_in_a_trial(void **state) {
    (void)state;
    blade b;
    spar_member old;
    spar_fluid *was;
    double x[3][N][3], p[3][N][3], q[2][N][4];
    blade_begin(&b, 1);
    spar_fluid *f = line(&b, "apart", 1);
    OK(b.session, spar_fluid_pull_poses(f, SPAR_NODES_MOTION, 1, x[0][0], q[0][0], NULL, NULL, NULL, NULL));
    OK(b.session, spar_fluid_pull_poses(f, SPAR_NODES_FORCE, 1, p[0][0], NULL, NULL, NULL, NULL, NULL));
    spari_rebuild wish = spari_rebuild_of(b.beam);
    wish.per_element = 9;
    OK(b.session, spari_member_rebuild(b.beam, &wish, &old));
    OK(b.session, spari_fluid_rebuild(f, &old, &was));
    memcpy(b.beam->after.q, b.beam->now.q, (size_t)(7 * b.beam->nodes) * sizeof(double));
    OK(b.session, spar_fluid_pull_poses(f, SPAR_NODES_MOTION, 1, x[1][0], q[1][0], NULL, NULL, NULL, NULL));
    OK(b.session, spar_fluid_pull_poses(f, SPAR_NODES_FORCE, 1, p[1][0], NULL, NULL, NULL, NULL, NULL));
    spari_fluid_restore(f, was);
    spari_member_restore(b.beam, &old);
    OK(b.session, spar_fluid_pull_motion(f, 1, x[2][0], NULL));
    OK(b.session, spar_fluid_pull_poses(f, SPAR_NODES_FORCE, 1, p[2][0], NULL, NULL, NULL, NULL, NULL));
    for (int j = 0; j < N; j++) {
        for (int i = 0; i < 3; i++) {
            NEAR(p[1][j][i], p[0][j][i], 1e-13);
            NEAR(j < M ? x[1][j][i] - x[0][j][i] : 0, 0, 1e-13);
        }
        NEAR(j < M ? fabs(spari_quat_dot(q[0][j], q[1][j])) : 1, 1, 1e-13);
    }
    assert_memory_equal(x[2], x[0], M * sizeof x[0][0]);
    assert_memory_equal(p[2], p[0], sizeof p[0]);
    blade_end(&b);
}

/* ---- blade elements on them ---- */

/* A blade with a lift line of 2 pi alpha in a wind, its control points half a chord behind the centres that the loads
   act at. It turns about its own line at 3 rad/s: the flow at the control points is the wind less 3 rad/s x 0.5 m. The
   same loads come from a blade at rest with the control points at the centres in the wind so changed, and act at the
   force nodes: their moment is that of the positions of the force nodes that spar_fluid_pull_poses gives. */
static void control_points_of_their_own(void **state) {
    (void)state;
    const double alpha[2] = {-0.5, 0.5}, cl[2] = {-3.14159265358979, 3.14159265358979}, cd[2] = {0.01, 0.01},
                 behind[N][3] = {{0, -0.5, 0}, {0, -0.5, 0}, {0, -0.5, 0}, {0, -0.5, 0},
                                 {0, -0.5, 0}, {0, -0.5, 0}, {0, -0.5, 0}};
    double load[2][N][3], x[N][3], q[N][4], total[6], want[6] = {0}, t[3];
    spar_polar *polar = NULL;
    OK(NULL, spar_polar_create(2, alpha, cl, cd, NULL, &polar));
    for (int k = 0; k < 2; k++) {
        blade b;
        spar_aero *aero = NULL;
        double wind[N][3], motion[MOST][7] = {{0}}, rate[MOST][6] = {{0}};
        blade_begin(&b, 1);
        spar_fluid *f = NULL;
        OK(b.session, spar_fluid_create(b.beam, "line", &f));
        OK(b.session, spar_fluid_set_stations(f, N, force_eta, NULL));
        if (k == 0) {
            OK(b.session, spar_fluid_set_motion_stations(f, N, force_eta, behind[0]));
        }
        OK(b.session, spar_fluid_map(f));
        OK(b.session, spar_aero_create(1, &f, &aero));
        for (int l = 0; l < b.nodes; l++) {
            motion[l][3] = 1, rate[l][3] = k == 0 ? 3 : 0;
        }
        OK(b.session, spar_member_set_motion(b.beam, motion[0], rate[0], NULL));
        OK(b.session, spar_fluid_pull_poses(f, SPAR_NODES_MOTION, 1, NULL, q[0], NULL, NULL, NULL, NULL));
        for (int j = 0; j < N; j++) {
            /* v = 3 e_x x (-0.5 e_y), of the section's axes: -1.5 m/s along its z */
            double up[3] = {0, 0, k == 0 ? 0 : 1.5}, flow[3] = {0, -12, 4};
            spari_rotate(q[j], up, t);
            for (int i = 0; i < 3; i++) {
                wind[j][i] = flow[i] + t[i];
            }
            OK(b.session, spar_aero_set_section(aero, j, 1.0, 0.0, polar));
        }
        OK(b.session, spar_aero_solve(aero, 1.2, wind[0], 1));
        OK(b.session, spar_aero_get_loads(aero, NULL, load[k][0], NULL));
        OK(b.session, spar_fluid_pull_poses(f, SPAR_NODES_FORCE, 1, x[0], NULL, NULL, NULL, NULL, NULL));
        memset(want, 0, sizeof want);
        for (int j = 0; j < N; j++) {
            spari_cross(x[j], load[k][j], t);
            for (int i = 0; i < 3; i++) {
                want[i] += load[k][j][i], want[3 + i] += t[i];
            }
        }
        OK(b.session, spar_fluid_sum_loads(f, NULL, total, total + 3));
        for (int i = 0; i < 6; i++) {
            NEAR(total[i], want[i], 1e-9);
        }
        assert_true(spari_norm(want) > 100);
        if (k == 0) { /* another number of them is none of sections */
            OK(b.session, spar_fluid_set_motion_stations(f, M, motion_eta, NULL));
            OK(b.session, spar_fluid_map(f));
            REFUSED(b.session, SPAR_ERR_STATE, "make a new one", spar_aero_solve(aero, 1.2, wind[0], 1));
        }
        spar_aero_destroy(&aero);
        blade_end(&b);
    }
    for (int j = 0; j < N; j++) {
        for (int i = 0; i < 3; i++) {
            NEAR(load[0][j][i], load[1][j][i], 1e-10 * spari_norm(load[1][3]));
        }
    }
    spar_polar_destroy(&polar);
}

/* ---- refusals ---- */

static void bad_sections_are_refused(void **state) {
    (void)state;
    blade b;
    const double beyond[2] = {0, 1.5}, from_minus_one[2] = {-1, 1}, eta[2] = {0, 0.5},
                 offset[2][3] = {{0, 0, 0}, {0, NAN, 0}};
    double x[N][3], before[N][3];
    int kind;
    blade_begin(&b, 0);
    spar_session *s = b.session;
    spar_fluid *f = line(&b, "line", 1);
    OK(s, spar_fluid_pull_motion(f, 1, before[0], NULL));
    assert_int_equal(spar_fluid_set_motion_stations(NULL, 2, eta, NULL), SPAR_ERR_ARGUMENT);
    REFUSED(s, SPAR_ERR_ARGUMENT, "-1 sections", spar_fluid_set_motion_stations(f, -1, eta, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "without coordinates", spar_fluid_set_motion_stations(f, 2, NULL, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "section 1: eta = 1.5 lies outside [0,1]",
            spar_fluid_set_motion_stations(f, 2, beyond, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "section 0: eta = -1 lies outside [0,1]",
            spar_fluid_set_stations(f, 2, from_minus_one, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "section 1", spar_fluid_set_motion_stations(f, 2, eta, offset[0]));
    REFUSED(s, SPAR_ERR_ARGUMENT, "theta",
            spar_fluid_pull_poses(f, SPAR_NODES_FORCE, 1.5, x[0], NULL, NULL, NULL, NULL, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "set 2", spar_fluid_pull_poses(f, 2, 1, x[0], NULL, NULL, NULL, NULL, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "set -1", spar_fluid_pull_poses_f32(f, -1, 1, NULL, NULL, NULL, NULL, NULL, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "set 2", spar_fluid_get_positions(f, 2, x[0], NULL, NULL, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "set -1", spar_fluid_get_kind(f, -1, &kind));
    REFUSED(s, SPAR_ERR_ARGUMENT, "NULL", spar_fluid_get_kind(f, 0, NULL));
    REFUSED(s, SPAR_ERR_ARGUMENT, "NULL", spar_fluid_get_forces(f, NULL));
    OK(s, spar_step_begin(s, 0.1));
    REFUSED(s, SPAR_ERR_STATE, "in progress", spar_fluid_set_motion_stations(f, 2, eta, NULL));
    OK(s, spar_step_reject(s));
    OK(s, spar_fluid_pull_motion(f, 1, x[0], NULL));
    assert_memory_equal(x, before, M * sizeof x[0]);
    OK(s, spar_fluid_set_motion_stations(f, 0, NULL, NULL)); /* none at all */
    OK(s, spar_fluid_map(f));
    OK(s, spar_fluid_pull_motion(f, 1, NULL, NULL));
    OK(s, spar_fluid_get_positions(f, SPAR_NODES_MOTION, NULL, NULL, NULL, NULL));
    blade_end(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_places_same_bits),
        cmocka_unit_test(either_set_is_where_asked),
        cmocka_unit_test(loads_are_conserved),
        cmocka_unit_test(force_sections_stay),
        cmocka_unit_test(apart_saved_and_loaded),
        cmocka_unit_test(as_many_stations_keep_forces),
#ifndef SPREAD_H /* what is known, a rank knows of its own nodes */
        cmocka_unit_test(other_stations_have_unknown_forces),
#endif
        cmocka_unit_test(apart_in_a_trial),
        cmocka_unit_test(control_points_of_their_own),
        cmocka_unit_test(bad_sections_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
