/* Frame of reference of a member, and its deformation relative to it. */
#ifndef SPARI_POSE_H
#define SPARI_POSE_H

#include "structure.h"

/* Position, orientation and velocity (the acceleration is zero) of the floating frame of a linear or modal member:
   that of its root if the root is prescribed or connected by joints, otherwise the reference. The same for members
   that are linear about their reference. */
spari_pose spari_member_pose(const spar_member *member, const spari_motion *nodes);
/* Deformation of a node relative to this frame: displacement and rotation vector in its axes, and their rates. */
void spari_member_deformation(const spar_member *member, const spari_pose *pose, const spari_motion *nodes,
                              int64_t node, double x[6], double rate[6]);

#endif
