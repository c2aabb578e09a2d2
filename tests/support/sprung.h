/* A body on a spring that holds it to the ground, in a fluid that pushes a load b(t) and the load of its added mass. */
#ifndef SPRUNG_H
#define SPRUNG_H

#include "scene.h"

typedef struct sprung {
    spar_session *s;
    spar_member *body;
    spar_fluid *fluid;
    double mass, added;                 /* of the body, of the fluid, kg */
    int by_velocity;                    /* the fluid takes accelerations from the velocities at both ends of the step */
    double v[3];                        /* velocity at t^n */
    double (*load)(double t, void *of); /* b(t) */
    void *of;
    int calls;
} sprung;

static const double body_mass = 2, period = 1, pi = 3.14159265358979323846;

/* Stiffness for the period of body and fluid together. */
static inline double stiffness_of(double mass) {
    return mass * (2 * pi / period) * (2 * pi / period);
}

/* mass: of the body; added: of the fluid; the spring belongs to both together. */
static inline void create(sprung *w, double mass, double added) {
    static const double x[3] = {0}, box[3] = {1, 1, 1};
    double M[36], K[36];
    const double k = stiffness_of(mass + added);
    memset(w, 0, sizeof *w);
    OK(NULL, spar_session_create(&w->s));
    w->mass = mass, w->added = added;
    scene_mass(M, mass, x, box);
    scene_diagonal(K, k, k, k, 1, 1, 1);
    OK(w->s, spar_rigid_create(w->s, "body", x, NULL, M, &w->body));
    OK(w->s, spar_member_commit(w->body));
    spar_joint *spring = scene_joint(w->s, "spring", w->body, 0, NULL, 0, 63);
    OK(w->s, spar_joint_set_spring(spring, K, NULL, NULL));
    OK(w->s, spar_fluid_create(w->body, "water", &w->fluid));
    OK(w->s, spar_fluid_set_motion_nodes(w->fluid, 1, x));
    OK(w->s, spar_fluid_set_force_nodes(w->fluid, 1, x));
    OK(w->s, spar_fluid_map(w->fluid));
}

static inline int solve(spar_session *s, double t, double dt, int iteration, void *context) {
    sprung *w = context;
    double q[7], v[6], a[6], b = w->load(t + dt, w->of);
    w->calls++;
    OK(s, spar_member_get_motion(w->body, q, v, a));
    if (iteration == 0) {
        OK(s, spar_fluid_pull_motion(w->fluid, 0, NULL, w->v));
    }
    for (int k = 0; k < 3; k++) {
        a[k] = w->by_velocity ? (v[k] - w->v[k]) / dt : a[k];
    }
    const double force[3] = {b - w->added * a[0], 0.5 * b - w->added * a[1], -w->added * a[2]};
    return spar_fluid_push_forces(w->fluid, force, NULL);
}

static inline void place(const sprung *w, double x[3]) {
    double q[7];
    OK(w->s, spar_member_get_motion(w->body, q, NULL, NULL));
    memcpy(x, q, 3 * sizeof *x);
}

static inline double slow(double t, void *of) {
    (void)of;
    return sin(4 * t);
}

#endif
