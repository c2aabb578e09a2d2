/* A body that moves in all directions, in a fluid that is a full 6x6 added mass: what is learned of it is known. */
#ifndef BUOY_H
#define BUOY_H

#include "scene.h"

/* Numbers in [-1, 1] that repeat. */
static inline double draw(unsigned long long *seed) {
    *seed = *seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return (double)(*seed >> 11) * 0x1p-52 - 1;
}

/* Mass 1 in a fluid of a full 6x6 added mass, in the axes that the body has at t^n, and a spring to its place in x;
   loads that change at random from step to step, but not within one, keep it going, and noise of a given size. */
typedef struct buoy {
    spar_session *session;
    spar_member *body;
    spar_fluid *fluid;
    double added[36], axes[4], spring, noise;
    unsigned long long seed, noises;
    double drive[6];
    int calls, failing; /* this call of the fluid fails */
} buoy;

/* Symmetric, positive definite: a diagonal of `size` and less, with couplings of all kinds. */
static inline void full_matrix(double size, double A[36]) {
    scene_diagonal(A, size, 0.6 * size, 0.8 * size, 0.5 * size, 0.7 * size, 0.4 * size);
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < i; j++) {
            A[6 * i + j] = A[6 * j + i] = 0.05 * size * ((i * 7 + j * 3) % 5 - 2);
        }
    }
}

static inline int buoy_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    buoy *b = context;
    double x[3], a[6], own[6], f[6] = {0};
    (void)t, (void)dt;
    if (++b->calls == b->failing) {
        return 77;
    }
    OK(s, spar_fluid_pull_poses(b->fluid, SPAR_NODES_MOTION, 1, x, NULL, NULL, NULL, a, a + 3));
    for (int k = 0; k < 6 && iteration == 0; k++) {
        b->drive[k] = draw(&b->seed);
    }
    spari_rotate_back(b->axes, a, own);
    spari_rotate_back(b->axes, a + 3, own + 3);
    for (int i = 0; i < 36; i++) {
        f[i / 6] -= b->added[i] * own[i % 6];
    }
    spari_rotate(b->axes, f, f);
    spari_rotate(b->axes, f + 3, f + 3);
    for (int k = 0; k < 6; k++) {
        f[k] += b->drive[k] - (k == 0 ? b->spring * x[0] : 0);
        f[k] *= 1 + b->noise * draw(&b->noises);
    }
    return spar_fluid_push_forces(b->fluid, f, f + 3);
}

static inline void buoy_create(buoy *b, double size, int learn) {
    static const double x[3] = {0, 0, 0}, c[3] = {0.1, 0, 0.05}, J[3] = {1, 0.5, 0.7};
    static const double q[4] = {0.8, 0, 0.6, 0};
    double mass[36];
    memset(b, 0, sizeof *b);
    b->session = scene_session();
    full_matrix(size, b->added);
    memcpy(b->axes, q, sizeof q);
    scene_mass(mass, 1, c, J);
    OK(b->session, spar_rigid_create(b->session, "buoy", x, q, mass, &b->body));
    OK(b->session, spar_member_learn_added_mass(b->body, learn, NULL));
    OK(b->session, spar_member_commit(b->body));
    OK(b->session, spar_fluid_create(b->body, "fluid", &b->fluid));
    OK(b->session, spar_fluid_set_motion_nodes(b->fluid, 1, x));
    OK(b->session, spar_fluid_set_force_nodes(b->fluid, 1, x));
    OK(b->session, spar_fluid_map(b->fluid));
    OK(b->session, spar_session_set_integrator(b->session, 1, 1));
    OK(b->session, spar_session_set_coupling(b->session, SPAR_COUPLING_IQN_ILS, 1e-12, 1e-10, 300));
}

/* The axes that the fluid's mass stands in are those that the body has before a step. */
static inline void buoy_turn(buoy *b) {
    static const double own[4] = {0.8, 0, 0.6, 0};
    double q[7];
    OK(b->session, spar_member_get_motion(b->body, q, NULL, NULL));
    spari_quat_mul(q + 3, own, b->axes);
}

static inline int buoy_step(buoy *b, double dt) {
    int n;
    buoy_turn(b);
    OK(b->session, spar_step(b->session, dt, buoy_fluid, b, &n));
    return n;
}

static inline double largest_difference(const double *a, const double *b, int n) {
    double most = 0;
    for (int i = 0; i < n; i++) {
        most = fmax(most, fabs(a[i] - b[i]));
    }
    return most;
}

#endif
