/* A constraint of an assembly: poses of its nodes, relative motion, and forces on the nodes. */
#include "constraint.h"

#include "../base/session.h"
#include "../math/rotation.h"
#include "../time/driven_root.h"

#include <math.h>
#include <string.h>

/* Pose, velocity and acceleration of one side of a constraint, in a state of its component or at the part s of the
   step. */
static void find_side(spari_constraint *l, int side, double s, double dt) {
    const spar_joint *j = l->joint;
    const spari_component *of = l->component[side];
    spari_node_pose *p = &l->pose[side];
    spari_pose x = {.q = {0, 0, 0, 1, 0, 0, 0}}; /* the ground */
    if (of) {
        const int u = j->unique[side];
        x = spari_pose_of(of->state->q + 7 * u, of->state->v + 6 * u, of->state->a + 6 * u);
    } else if (j->member[side]) {
        const spari_motion *now = &j->member[side]->now, *after = &j->member[side]->after; /* prescribed */
        const int64_t i = j->seat[side];
        const spari_pose from = spari_pose_of(now->q + 7 * i, now->v + 6 * i, now->a + 6 * i),
                         to = spari_pose_of(after->q + 7 * i, after->v + 6 * i, after->a + 6 * i);
        x = spari_drive_between(&from, &to, s, dt);
    }
    for (int k = 0; k < 3; k++) {
        p->x[k] = x.q[k] + j->reference[side][k];
    }
    memcpy(p->q, x.q + 3, sizeof p->q);
    memcpy(l->v + 6 * side, x.v, sizeof x.v);
    memcpy(l->a + 6 * side, x.a, sizeof x.a);
}

void spari_constraint_times(double B[6][12], const double v[12], double rate[6]) {
    for (int k = 0; k < 6; k++) {
        double sum = 0;
        for (int i = 0; i < 12; i++) {
            sum += B[k][i] * v[i];
        }
        rate[k] = sum;
    }
}

static void find_rates(spari_constraint *l, double dt, double factor) {
    const spari_component *p = l->component[0] ? l->component[0] : l->component[1];
    spari_relative *r = &l->joint->after;
    spari_constraint_times(l->B, l->v, r->rate);
    double rate = p && dt > 0 ? p->scheme.rate : INFINITY; /* of the coordinates in a step; none at one moment */
    l->springs = spari_joint_spring(l->joint, r->z, r->rate, rate, factor, r->load);
}

void spari_constraint_find(spari_constraint *l, double s, double dt, double factor) {
    spar_joint *j = l->joint;
    spari_relative *r = &j->after;
    double near[6];
    memcpy(near, r->z, sizeof near);
    r->found = 1;
    find_side(l, 0, s, dt);
    find_side(l, 1, s, dt);
    spari_kinematics_motion(&j->kinematics, &l->pose[0], &l->pose[1], r->z, l->B);
    spari_joint_count_turns(j, near, r->z);
    find_rates(l, dt, factor);
}

void spari_constraint_find_force(spari_constraint *l) {
    spari_kinematics_forces(l->B, l->joint->after.load, l->force);
}

void spari_constraint_find_rates(spari_constraint *l, double dt, double factor) {
    for (int side = 0; side < 2; side++) {
        const spari_component *p = l->component[side];
        if (p) {
            memcpy(l->v + 6 * side, p->state->v + 6 * l->joint->unique[side], 6 * sizeof *l->v);
        }
    }
    find_rates(l, dt, factor);
}

double spari_constraint_gap(const spari_constraint *l, int k) {
    const spar_joint *j = l->joint;
    double target = j->driven >> k & 1 ? l->drive.z[k] : j->kinematics.line ? j->length : 0;
    return j->after.z[k] - target;
}

void spari_constraint_set_acceleration_gaps(spari_constraint *l) {
    const spar_joint *j = l->joint;
    double drift[6], rate[6];
    spari_kinematics_drift(&j->kinematics, &l->pose[0], &l->pose[1], l->v, drift);
    spari_constraint_times(l->B, l->a, rate);
    for (int k = 0; k < 6; k++) {
        double asked = j->driven >> k & 1 ? l->drive.acceleration[k] : 0;
        l->gap[k] = spari_constraint_holds(l, k) ? rate[k] + drift[k] - asked : 0;
    }
}

double spari_constraint_rate_gap(const spari_constraint *l, int k) {
    return l->joint->after.rate[k] - (l->joint->driven >> k & 1 ? l->drive.rate[k] : 0);
}

int spari_constraint_fixed_side(const spari_constraint *l) {
    const spar_joint *j = l->joint;
    for (int side = 0; side < 2; side++) {
        const spar_member *m = j->member[side];
        if (!l->component[side] && !(m && spari_norm(m->after.v + 6 * j->seat[side]) > 0) &&
            !(m && spari_norm(m->after.v + 6 * j->seat[side] + 3) > 0)) {
            return side;
        }
    }
    return -1;
}

void spari_constraint_rotate_dampers(const spari_constraint *l, const double w[3], double K[12][12]) {
    const spar_joint *j = l->joint;
    int side = spari_constraint_fixed_side(l), given = spari_joint_constrained(j);
    double R[6][12], W[9];
    if (side < 0 || !l->springs) {
        return;
    }
    spari_skew(w, W);
    spari_kinematics_rates(&j->kinematics, &l->pose[0], &l->pose[1], l->v, R);
    for (int k = 0; k < 6; k++) {
        for (int i = 0; i < 9; i++) {
            R[k][6 * (1 - side) + i % 3] += l->B[k][6 * (1 - side) + i / 3] * W[i];
        }
    }
    for (int pq = 0; pq < 36; pq++) {
        int p = pq / 6, q = pq % 6;
        double d = (given >> p & 1) || (given >> q & 1) ? 0 : j->damping[pq];
        for (int i = 0; i < 144 && d != 0; i++) {
            K[i / 12][i % 12] -= d * l->B[p][i / 12] * R[q][i % 12];
        }
    }
}
