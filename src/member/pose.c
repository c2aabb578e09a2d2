/* Frame of reference of a member, and its deformation relative to it: see pose.h. */
#include "pose.h"

#include "../math/rotation.h"

#include <string.h>

spari_pose spari_member_pose(const spar_member *m, const spari_motion *nodes) {
    spari_pose pose = {.q[3] = 1};
    if (m->frame != SPARI_FRAME_INERTIAL && spari_member_root_is_prescribed(m)) {
        memcpy(pose.q, nodes->q, sizeof pose.q);
    }
    if (m->frame != SPARI_FRAME_INERTIAL && m->root == SPAR_ROOT_DRIVEN) {
        memcpy(pose.v, nodes->v, sizeof pose.v);
    }
    return pose;
}

void spari_member_deformation(const spar_member *m, const spari_pose *pose, const spari_motion *nodes, int64_t node,
                              double x[6], double rate[6]) {
    const double *q = nodes->q + 7 * node, *v = nodes->v + 6 * node;
    double arm[3], d[3], back[4], p[4], omega[3], turn[3], T[9];
    for (int k = 0; k < 3; k++) {
        arm[k] = m->xr[3 * node + k] - m->xr[k];
        d[k] = arm[k] + q[k] - pose->q[k];
    }
    for (int k = 0; k < 6; k++) {
        rate[k] = v[k] - pose->v[k];
    }
    spari_rotate_back(pose->q + 3, d, d);
    spari_rotate_back(pose->q + 3, pose->v + 3, omega);
    spari_rotate_back(pose->q + 3, rate, rate);
    spari_rotate_back(pose->q + 3, rate + 3, rate + 3);
    spari_cross(omega, d, turn);
    spari_quat_conj(pose->q + 3, back);
    spari_quat_mul(back, q + 3, p);
    spari_quat_log(p, x + 3);
    spari_tangent_inverse(x + 3, T);
    double spin[3] = {rate[3], rate[4], rate[5]};
    for (int k = 0; k < 3; k++) {
        x[k] = d[k] - arm[k];
        rate[k] -= turn[k];
        rate[3 + k] = T[3 * k] * spin[0] + T[3 * k + 1] * spin[1] + T[3 * k + 2] * spin[2];
    }
}
