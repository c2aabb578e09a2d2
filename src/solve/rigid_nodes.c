/* Nodes that follow a root as one rigid body. */
#include "rigid_nodes.h"

#include "../math/rotation.h"

#include <string.h>

void spari_rigid_nodes_move(const spar_member *m, const spari_pose *root, spari_motion *to) {
    const double *q = root->q, *v = root->v, *a = root->a;
    for (int64_t i = 0; i < m->nodes; i++) {
        double arm[3], r[3], c1[3], c2[3], c3[3];
        for (int k = 0; k < 3; k++) {
            arm[k] = m->xr[3 * i + k] - m->xr[k];
        }
        spari_rotate(q + 3, arm, r);
        spari_cross(v + 3, r, c1);
        spari_cross(v + 3, c1, c2);
        spari_cross(a + 3, r, c3);
        for (int k = 0; k < 3; k++) {
            to->q[7 * i + k] = q[k] + r[k] - arm[k];
            to->v[6 * i + k] = v[k] + c1[k];
            to->a[6 * i + k] = a[k] + c2[k] + c3[k];
            to->v[6 * i + 3 + k] = v[3 + k];
            to->a[6 * i + 3 + k] = a[3 + k];
        }
        memcpy(to->q + 7 * i + 3, q + 3, 4 * sizeof *q);
    }
}

void spari_rigid_nodes_displace(const spar_member *m, const double root[6], double *nodes) {
    for (int64_t i = 0; i < m->nodes; i++) {
        double *x = nodes + 6 * i, r[3];
        for (int k = 0; k < 3; k++) {
            r[k] = m->xr[3 * i + k] + m->after.q[7 * i + k] - m->xr[k] - m->after.q[k];
        }
        spari_cross(root + 3, r, x);
        for (int k = 0; k < 3; k++) {
            x[k] += root[k];
            x[3 + k] = root[3 + k];
        }
    }
}

void spari_rigid_nodes_equilibrium(spar_member *m) {
    const double none[6] = {0};
    spari_pose root = spari_pose_of(m->now.q, none, none);
    if (m->root == SPAR_ROOT_DRIVEN && (spari_norm(m->now.v + 3) > 0 || spari_norm(m->now.a) > 0)) {
        memcpy(root.v, m->now.v, sizeof root.v); /* in steady rotation, as the members that are solved for */
        memcpy(root.a, m->now.a, 3 * sizeof *root.a);
    }
    spari_rigid_nodes_move(m, &root, &m->after);
}
