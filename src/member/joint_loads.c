/* Loads of joints on the nodes of a member, and accelerations of joint coordinates, in the motion `after`. */
#include "joint.h"

#include <string.h>

static void pose_of_seat(const spar_joint *j, int side, spari_node_pose *p) {
    const spar_member *m = j->member[side];
    *p = (spari_node_pose){.q = {1, 0, 0, 0}};
    if (m) {
        const double *q = m->after.q + 7 * j->seat[side];
        for (int k = 0; k < 3; k++) {
            p->x[k] = m->xr[3 * j->seat[side] + k] + q[k];
        }
        memcpy(p->q, q + 3, sizeof p->q);
    }
}

void spari_joint_poses(const spar_joint *j, spari_node_pose pose[2]) {
    pose_of_seat(j, 0, &pose[0]);
    pose_of_seat(j, 1, &pose[1]);
}

void spari_joints_on(const spar_member *m, int64_t node, double load[6]) {
    for (int n = 0; n < m->joint_count; n++) {
        const spar_joint *j = m->joints[n];
        for (int side = 0; side < 2; side++) {
            if (!j->placed || j->member[side] != m || j->seat[side] != node) {
                continue;
            }
            spari_node_pose pose[2];
            double z[6], B[6][12], f[12];
            spari_joint_poses(j, pose);
            spari_kinematics_motion(&j->kinematics, &pose[0], &pose[1], z, B);
            spari_kinematics_forces(B, j->after.load, f);
            for (int k = 0; k < 6; k++) {
                load[k] += f[6 * side + k];
            }
        }
    }
}

void spari_joints_on_external(const spar_member *m, double *load) {
    for (int64_t i = 0; m->external && m->joint_count > 0 && i < m->nodes; i++) {
        spari_joints_on(m, i, load + 6 * i);
    }
}

static int is_given(const spar_member *m) {
    return m && (m->external || m->kind == SPARI_POINT);
}

int spari_joints_hold_prescribed(const spar_session *s) {
    int count = 0;
    for (const spar_joint *j = s->joints; j && !count; j = j->next) {
        count = is_given(j->member[0]) || is_given(j->member[1]);
    }
    return count;
}

int spari_joints_hold_moved(const spar_session *s) {
    int count = 0;
    for (const spar_joint *j = s->joints; j && !count; j = j->next) {
        for (int side = 0; side < 2; side++) {
            count = count || (is_given(j->member[side]) && j->member[side]->state.motion_given);
        }
    }
    return count;
}

void spari_joint_acceleration(const spar_joint *j, double acceleration[6]) {
    spari_node_pose pose[2];
    double z[6], B[6][12], v[12] = {0}, a[12] = {0};
    memset(acceleration, 0, 6 * sizeof *acceleration);
    if (j->after.found == 0) { /* whether it is placed does not affect the run */
        return;
    }
    for (int side = 0; side < 2; side++) {
        const spar_member *m = j->member[side];
        if (m) {
            memcpy(v + 6 * side, m->after.v + 6 * j->seat[side], 6 * sizeof *v);
            memcpy(a + 6 * side, m->after.a + 6 * j->seat[side], 6 * sizeof *a);
        }
    }
    spari_joint_poses(j, pose);
    spari_kinematics_motion(&j->kinematics, &pose[0], &pose[1], z, B);
    spari_kinematics_drift(&j->kinematics, &pose[0], &pose[1], v, acceleration);
    for (int k = 0; k < 72; k++) {
        acceleration[k / 12] += B[k / 12][k % 12] * a[k % 12];
    }
}
