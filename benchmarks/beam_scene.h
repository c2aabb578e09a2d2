/* Beams that the benchmarks step, and small tools: the clock, medians, calls that must succeed. */
#ifndef BEAM_SCENE_H
#define BEAM_SCENE_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "nrel5mw.h"

#include "member/body.h"
#include "member/structure.h"
#include "time/body_solver.h"

/* ---- small tools ---- */

/* The processor's time, us: what the wall says when nothing else runs, and unlike it when something does. */
static inline double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e6 + (double)t.tv_nsec * 1e-3;
}

static inline int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static inline double median(double *x, int n) {
    qsort(x, (size_t)n, sizeof *x, ascending);
    return n % 2 ? x[n / 2] : 0.5 * (x[n / 2 - 1] + x[n / 2]);
}

static inline void must(const spar_session *session, int status, const char *what) {
    if (status != SPAR_OK) {
        fprintf(stderr, "%s: %s: %s\n", what, spar_status_text(status), spar_session_message(session));
        exit(1);
    }
}

#define MUST(session, call) must(session, call, #call)

static inline void tip(const spar_member *member, double u[3]) {
    int64_t n;
    spar_member_get_count(member, &n);
    double *q = malloc((size_t)(7 * n) * sizeof *q);
    spar_member_get_motion(member, q, NULL, NULL);
    memcpy(u, q + 7 * (n - 1), 3 * sizeof *u);
    free(q);
}

/* ---- scenes: a session with one member, and what drives it ---- */

typedef struct scene {
    spar_session *session;
    spar_member *member;
    double dt;
    nrel5mw *turbine; /* NULL: nothing drives the root */
    nrel5mw_rotor rotor;
    int steps;
} scene;

/* Composite box beam of Wang et al. (Wind Energy 20, 2017), length 10, tip force 150 along z from rest */
static inline void box_scene(scene *s, int elements, int nodes, double dt, double rho) {
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 10, 0, 0}, load[6] = {0, 0, 150, 0, 0, 0};
    const double k[6] = {1368.17e3, 88.56e3, 38.78e3, 16.96e3, 59.12e3, 141.47e3};
    const double m[6] = {8.538e-2, 8.538e-2, 8.538e-2, 1.4433e-2, 0.4097e-2, 1.0336e-2};
    double K[36] = {0}, M[36] = {0};
    for (int i = 0; i < 6; i++) {
        K[7 * i] = k[i], M[7 * i] = m[i];
    }
    K[6 * 3 + 4] = K[6 * 4 + 3] = 17.61e3;
    K[6 * 3 + 5] = K[6 * 5 + 3] = -0.351e3;
    K[6 * 4 + 5] = K[6 * 5 + 4] = -0.370e3;
    memset(s, 0, sizeof *s);
    s->dt = dt;
    MUST(NULL, spar_session_create(&s->session));
    MUST(s->session, spar_session_set_integrator(s->session, rho, 1));
    MUST(s->session, spar_beam_create(s->session, "box", elements, nodes, &s->member));
    MUST(s->session, spar_beam_set_axis(s->member, 2, eta, xyz, NULL));
    MUST(s->session, spar_beam_set_sections(s->member, 1, eta, K, M));
    MUST(s->session, spar_beam_set_quadrature(s->member, SPAR_QUADRATURE_GAUSS, nodes));
    MUST(s->session, spar_member_commit(s->member));
    MUST(s->session, spar_member_set_load(s->member, (int64_t)elements * nodes - 1, SPAR_LOAD_DEAD, load));
}

static const double turning = 1.0006; /* rad/s */

/* A blade of the NREL 5-MW rotor, from rest relative to its root that turns at 1.0006 rad/s, under gravity; 49
   stations. points 0: the quadrature the description implies (per section interval) */
static inline void blade_scene(scene *s, nrel5mw *turbine, int nodes, int points, double dt, double rho) {
    const double gravity[3] = {0, 0, -9.81}, zero[3] = {0, 0, 0};
    double omega[3];
    memset(s, 0, sizeof *s);
    s->dt = dt, s->turbine = turbine;
    nrel5mw_rotor_default(turbine, &s->rotor);
    MUST(NULL, spar_session_create(&s->session));
    MUST(s->session, spar_session_set_gravity(s->session, gravity));
    MUST(s->session, spar_session_set_integrator(s->session, rho, 1));
    if (nrel5mw_create_blade(turbine, &s->rotor, s->session, 0, 1, nodes, &s->member) != SPAR_OK) {
        fprintf(stderr, "%s\n", turbine->message);
        exit(1);
    }
    if (points > 0) {
        MUST(s->session, spar_beam_set_quadrature(s->member, SPAR_QUADRATURE_GAUSS, points));
    }
    MUST(s->session, spar_member_commit(s->member));
    for (int i = 0; i < 3; i++) {
        omega[i] = turning * s->rotor.axis[i];
    }
    MUST(s->session, spar_member_set_initial_velocity(s->member, s->rotor.hub, zero, omega));
}

static inline void step(scene *s) {
    if (s->turbine) {
        double q[7], v[6], a[6];
        nrel5mw_root_motion(s->turbine, &s->rotor, 0, turning * s->dt * (s->steps + 1), turning, 0, q, v, a);
        MUST(s->session, spar_member_drive(s->member, q, v, a));
    }
    s->steps++;
    MUST(s->session, spar_step_begin(s->session, s->dt));
    MUST(s->session, spar_step_solve(s->session));
    MUST(s->session, spar_step_accept(s->session));
}

#endif
