/* Steps of any length, for the tests that run scenes through them: the sequences, and what a scene of members and
   joints has of energy and force. */
#ifndef SEQUENCES_H
#define SEQUENCES_H

#include "scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Alternating by 1 %, by 1:3, shrinking by 0.5 % a step, every tenth a twentieth, one a millionth of a second; random
   between h / factor and h, in each step or for one to five steps, so that generalised-alpha takes some of them; by
   half to either side, smoothly, four times a second. */
enum { EVEN, ONE_PERCENT, ONE_TO_THREE, SHRINKING, OUTPUT_TIMES, SHORT, RANDOM, REPEATED, SMOOTH };

static uint64_t sequence_seed;

/* A number in [0, 1), the next of those that the seed gives. */
static inline double sequence_uniform(void) {
    sequence_seed = sequence_seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(sequence_seed >> 11) / 9007199254740992.0;
}

/* Length of step k. The steps of a sequence are asked for in turn. */
static inline double sequence_step(int pattern, int k, double h, double factor) {
    static double kept;
    static int left;
    switch (pattern) {
    case ONE_PERCENT:
        return h * (k % 2 ? 1.01 : 0.99);
    case ONE_TO_THREE:
        return h * (k % 2 ? 1.5 : 0.5);
    case SHRINKING:
        return h * pow(0.995, k % 300);
    case OUTPUT_TIMES:
        return k % 10 == 9 ? h / 20 : h;
    case SHORT:
        return k == 37 ? 1e-6 : h;
    case RANDOM:
        return h * pow(factor, -sequence_uniform());
    case REPEATED:
        if (k == 0 || left-- == 0) {
            kept = h * pow(factor, -sequence_uniform());
            left = (int)(5 * sequence_uniform());
        }
        return kept;
    case SMOOTH:
        return h * (1 + 0.5 * sin(8 * 3.14159265358979323846 * k * h));
    default:
        return h;
    }
}

/* The random sequences of a scene: four factors, of both kinds, as often as SPAR_SEQUENCES or else the test says. */
static inline int sequence_count(int otherwise) {
    const char *n = getenv("SPAR_SEQUENCES");
    return 8 * (n ? atoi(n) : otherwise);
}

/* Number k of them: what it is; rho_inf goes round. Seeds the numbers. */
static inline void sequence_take(int scene, int k, int *pattern, double *factor, double *rho) {
    static const double factors[4] = {1.1, 3, 1e3, 1e6}, rhos[4] = {0.9, 0.5, 0, 1};
    *pattern = k / 4 % 2 ? REPEATED : RANDOM;
    *factor = factors[k % 4];
    *rho = rhos[(k + k / 8) % 4];
    sequence_seed = 1000u * (uint64_t)scene + 7919u * (uint64_t)k;
}

enum { SEQUENCE_MEMBERS = 12, SEQUENCE_NODES = 40 };

/* A scene: its members have SPAR_EFFECT_WORK, so that joints account for what they give and take. */
typedef struct sequence_world {
    spar_session *s;
    spar_member *m[SEQUENCE_MEMBERS];
    spar_joint *j[SEQUENCE_MEMBERS];
    int members, joints;
    double t, stored; /* stored: in springs at t = 0, which joints do not tell before a step */
} sequence_world;

/* Length of the largest force of n joints; without joints, of a member's root. first 3: moment. */
static inline double largest_force(spar_session *s, int n, spar_joint *const *j, const spar_member *m, int first) {
    double f[6], most = 0;
    for (int i = 0; i < n || i == 0; i++) {
        if (n) {
            OK(s, spar_joint_get_load(j[i], f));
        } else {
            OK(s, spar_member_get_reaction(m, f));
        }
        most = fmax(most, sqrt(spari_dot(f + first, f + first)));
    }
    return most;
}

static inline double sequence_force(const sequence_world *w, int first) {
    return largest_force(w->s, w->joints, w->j, w->m[0], first);
}

/* Energy of members and springs, and what dampers have taken, less the work of drives, driven roots and kept loads:
   stays what it was. kinetic: its largest part, for the scale. */
static inline double sequence_energy(const sequence_world *w, double *kinetic) {
    double sum = 0, e[5], work[SPAR_WORK_COUNT], joint[SPAR_JOINT_ENERGY_COUNT];
    *kinetic = 0;
    for (int i = 0; i < w->members; i++) {
        OK(w->s, spar_member_get_energy(w->m[i], 5, e));
        OK(w->s, spar_member_get_work(w->m[i], SPAR_WORK_COUNT, work));
        *kinetic += e[SPAR_ENERGY_KINETIC];
        sum += e[SPAR_ENERGY_KINETIC] + e[SPAR_ENERGY_STRAIN] + e[SPAR_ENERGY_GRAVITY] + e[SPAR_ENERGY_DISSIPATED];
        sum -= work[SPAR_WORK_LOADS] + work[SPAR_WORK_ROOT];
    }
    for (int i = 0; i < w->joints; i++) {
        OK(w->s, spar_joint_get_energy(w->j[i], SPAR_JOINT_ENERGY_COUNT, joint));
        sum += joint[SPAR_JOINT_ENERGY_SPRING] + joint[SPAR_JOINT_ENERGY_DAMPER] - joint[SPAR_JOINT_ENERGY_DRIVE] -
               joint[SPAR_JOINT_ENERGY_LOAD];
    }
    return sum;
}

/* The largest angular velocity of a node now. */
static inline double sequence_spin(const sequence_world *w) {
    double v[6 * SEQUENCE_NODES], most = 0;
    for (int i = 0; i < w->members; i++) {
        int64_t n;
        OK(w->s, spar_member_get_count(w->m[i], &n));
        OK(w->s, spar_member_get_motion(w->m[i], NULL, v, NULL));
        for (int64_t k = 0; k < n; k++) {
            most = fmax(most, sqrt(spari_dot(v + 6 * k + 3, v + 6 * k + 3)));
        }
    }
    return most;
}

#endif
