/* What several tests build: sessions, beams of one section, rigid bodies, steps without a fluid. */
#ifndef SCENE_H
#define SCENE_H

#include "check.h"

#include <stdlib.h>
#include <string.h>

#include "math/rotation.h"

static inline void scene_diagonal(double *m, double a, double b, double c, double d, double e, double f) {
    const double x[6] = {a, b, c, d, e, f};
    memset(m, 0, 36 * sizeof *m);
    for (int i = 0; i < 6; i++) {
        m[7 * i] = x[i];
    }
}

/* mass matrix of a body of mass m, centre of mass c, inertia J (diagonal, about the centre of mass), about its node */
static inline void scene_mass(double *M, double m, const double c[3], const double J[3]) {
    double s[3][3] = {{0, -c[2], c[1]}, {c[2], 0, -c[0]}, {-c[1], c[0], 0}},
           cc = c[0] * c[0] + c[1] * c[1] + c[2] * c[2];
    scene_diagonal(M, m, m, m, J[0], J[1], J[2]);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            M[6 * (3 + i) + j] = M[6 * j + 3 + i] = m * s[i][j];
            M[6 * (3 + i) + 3 + j] += m * ((i == j ? cc : 0) - c[i] * c[j]);
        }
    }
}

/* Newton almost to rounding: for what is compared to rounding, or with a run that is asked otherwise. */
static inline void scene_strict(spar_session *s) {
    OK(s, spar_session_set_newton(s, 1e-15, 1e-12, 50));
}

/* One evaluation of the fluid per step, with predicted loads. */
static inline void scene_explicit(spar_session *s) {
    OK(s, spar_session_set_coupling(s, SPAR_COUPLING_EXPLICIT, 1e-9, 1e-6, 50));
}

static inline spar_session *scene_session(void) {
    spar_session *s = NULL;
    OK(NULL, spar_session_create(&s));
    scene_strict(s);
    return s;
}

/* a straight beam of one section from the origin along x, not yet committed */
static inline spar_member *scene_beam(spar_session *s, const char *name, int elements, int nodes, double length,
                                      const double *K, const double *M) {
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, length, 0, 0};
    spar_member *b = NULL;
    OK(s, spar_beam_create(s, name, elements, nodes, &b));
    OK(s, spar_beam_set_axis(b, 2, eta, xyz, NULL));
    OK(s, spar_beam_set_sections(b, 1, eta, K, M));
    return b;
}

/* a rigid body with its node at the centre of mass, its axes the global ones, committed */
static inline spar_member *scene_body(spar_session *s, const char *name, const double x[3], double m,
                                      const double J[3]) {
    const double centre[3] = {0, 0, 0}, straight[4] = {1, 0, 0, 0};
    double mass[36];
    spar_member *b = NULL;
    scene_mass(mass, m, centre, J);
    OK(s, spar_rigid_create(s, name, x, straight, mass, &b));
    OK(s, spar_member_commit(b));
    return b;
}

/* a joint with its place and axes as they come by themselves */
static inline spar_joint *scene_joint(spar_session *s, const char *name, spar_member *a, int64_t node_a, spar_member *b,
                                      int64_t node_b, int free_motions) {
    spar_joint *j = NULL;
    OK(s, spar_joint_create(s, name, a, node_a, b, node_b, free_motions, &j));
    return j;
}

/* a joint at x, its axes the global ones */
static inline spar_joint *scene_joint_at(spar_session *s, const char *name, spar_member *a, int64_t node_a,
                                         spar_member *b, int64_t node_b, int free_motions, const double x[3]) {
    const double straight[4] = {1, 0, 0, 0};
    spar_joint *j = scene_joint(s, name, a, node_a, b, node_b, free_motions);
    OK(s, spar_joint_set_frame(j, x, straight));
    return j;
}

/* The composite box section of Wang et al., Wind Energy 20 (2017), we.2101: bending and torsion coupled */
static inline void scene_box(double *K, double *M) {
    scene_diagonal(K, 1368.17e3, 88.56e3, 38.78e3, 16.96e3, 59.12e3, 141.47e3);
    K[6 * 3 + 4] = K[6 * 4 + 3] = 17.61e3;
    K[6 * 3 + 5] = K[6 * 5 + 3] = -0.351e3;
    K[6 * 4 + 5] = K[6 * 5 + 4] = -0.370e3;
    scene_diagonal(M, 8.538e-2, 8.538e-2, 8.538e-2, 1.4433e-2, 0.4097e-2, 1.0336e-2);
}

/* n steps without a fluid */
static inline void scene_run(spar_session *s, double dt, int64_t n) {
    for (int64_t i = 0; i < n; i++) {
        OK(s, spar_step_begin(s, dt));
        OK(s, spar_step_solve(s));
        OK(s, spar_step_accept(s));
    }
}

/* motion of the last node */
static inline void scene_tip(const spar_member *m, double q[7]) {
    int64_t n;
    assert_int_equal(spar_member_get_count(m, &n), SPAR_OK);
    double *all = malloc((size_t)n * 7 * sizeof *all);
    assert_int_equal(spar_member_get_motion(m, all, NULL, NULL), SPAR_OK);
    memcpy(q, all + 7 * (n - 1), 7 * sizeof *q);
    free(all);
}

#endif
