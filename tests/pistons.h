/* Pistons: rigid bodies, each with one fluid node, in a fluid that is nothing but added mass. The structure's balance
   holds at t^{n+1}, so that a load x gives the acceleration x/m and the fluid answers g = b - r x with r = (added
   mass)/m: the map of the coupling is known in closed form, whatever dt is. */
#ifndef PISTONS_H
#define PISTONS_H

#include "scene.h"

enum { PISTONS_MOST = 8 };

typedef struct pistons {
    spar_session *session;
    spar_member *body[PISTONS_MOST];
    spar_fluid *fluid[PISTONS_MOST];
    int n, calls;
    double mass[PISTONS_MOST], ratio[PISTONS_MOST], b[PISTONS_MOST];
    double stiffness;              /* fluid spring to the place of rest: zero in the map above */
    int bad_call;                  /* this call of the fluid pushes NaN; 0: none */
    double force[PISTONS_MOST][3]; /* pushed last */
} pistons;

/* Bodies of 2 kg along y, which move along x; integrator without damping. guess: of the added mass, as `ratio`, in the
   structure's equations; NULL: none */
static inline void pistons_create_with(pistons *p, int n, const double *ratio, const double *guess) {
    static const double q[4] = {1, 0, 0, 0}, centre[3] = {0, 0, 0}, inertia[3] = {1, 1, 1};
    memset(p, 0, sizeof *p);
    p->session = scene_session();
    p->n = n;
    OK(p->session, spar_session_set_integrator(p->session, 1, 1));
    for (int i = 0; i < n; i++) {
        double x[3] = {0, i, 0}, mass[36];
        char name[8] = {'p', (char)('0' + i), 0};
        p->mass[i] = 2;
        p->ratio[i] = ratio[i];
        scene_mass(mass, p->mass[i], centre, inertia);
        OK(p->session, spar_rigid_create(p->session, name, x, q, mass, &p->body[i]));
        if (guess) {
            scene_diagonal(mass, 2 * guess[i], 0, 0, 0, 0, 0);
            OK(p->session, spar_member_set_added_mass(p->body[i], 1, NULL, mass));
        }
        OK(p->session, spar_member_commit(p->body[i]));
        OK(p->session, spar_fluid_create(p->body[i], name, &p->fluid[i]));
        OK(p->session, spar_fluid_set_motion_nodes(p->fluid[i], 1, x));
        OK(p->session, spar_fluid_set_force_nodes(p->fluid[i], 1, x));
        OK(p->session, spar_fluid_map(p->fluid[i]));
    }
}

static inline void pistons_create(pistons *p, int n, const double *ratio) {
    pistons_create_with(p, n, ratio, NULL);
}

static inline void pistons_destroy(pistons *p) {
    spar_session_destroy(&p->session);
}

static inline int pistons_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    pistons *p = context;
    (void)t;
    (void)dt;
    (void)iteration;
    p->calls++;
    for (int i = 0; i < p->n; i++) {
        double q[7], a[6];
        OK(s, spar_member_get_motion(p->body[i], q, NULL, a));
        p->force[i][0] = p->b[i] - p->ratio[i] * p->mass[i] * a[0] - p->stiffness * q[0];
        p->force[i][0] = p->calls == p->bad_call ? NAN : p->force[i][0];
        int status = spar_fluid_push_forces(p->fluid[i], p->force[i], NULL);
        if (status != SPAR_OK && p->calls != p->bad_call) {
            return status;
        }
    }
    return 0;
}

#endif
