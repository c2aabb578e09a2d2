/* A chain of rigid links in a fluid: what tests of light structures in heavy fluids share. */
#ifndef SPAR_TEST_LINKS_H
#define SPAR_TEST_LINKS_H

#include "scene.h"

/* A fluid at n nodes x [n][3] of a member. */
static inline spar_fluid *links_wet(spar_session *s, spar_member *member, int n, const double *x) {
    spar_fluid *fluid = NULL;
    OK(s, spar_fluid_create(member, "water", &fluid));
    OK(s, spar_fluid_set_motion_nodes(fluid, n, x));
    OK(s, spar_fluid_set_force_nodes(fluid, n, x));
    OK(s, spar_fluid_map(fluid));
    return fluid;
}

/* Links on hinges about y, 1 m in all, the first one on the ground, inclined by `tilt` (rad) from the x axis upwards.
   mass: of each link. Each has a fluid of three nodes. */
static inline void links_create(spar_session *s, int links, double mass, double tilt, spar_member **member,
                                spar_fluid **fluid) {
    const double L = 1.0 / links, m = mass, along[3] = {1, 0, 0}, c[3] = {L / 2, 0, 0};
    const double q[4] = {cos(tilt / 2), 0, -sin(tilt / 2), 0}, straight[4] = {1, 0, 0, 0};
    const double J[3] = {m * L * L / 1200, m * L * L / 12, m * L * L / 12};
    for (int j = 0; j < links; j++) {
        double M[36], d[3], p[3], x[9];
        char name[2] = {(char)('a' + j), 0}, joint[2] = {(char)('A' + j), 0};
        spar_joint *hinge = NULL;
        spari_rotate(q, along, d);
        for (int k = 0; k < 9; k++) {
            p[k % 3] = j * L * d[k % 3];
            x[k] = p[k % 3] + L * (k / 3 + 0.5) / 3 * d[k % 3];
        }
        scene_mass(M, m, c, J);
        OK(s, spar_rigid_create(s, name, p, q, M, &member[j]));
        OK(s, spar_member_set_root(member[j], SPAR_ROOT_FREE));
        OK(s, spar_member_commit(member[j]));
        OK(s, spar_joint_create(s, joint, member[j], 0, j ? member[j - 1] : NULL, 0, SPAR_FREE_RY, &hinge));
        OK(s, spar_joint_set_frame(hinge, p, straight));
        fluid[j] = links_wet(s, member[j], 3, x);
    }
}

#endif
