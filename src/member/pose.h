/* The frame that a member is seen from. */
#ifndef SPARI_POSE_H
#define SPARI_POSE_H

#include "structure.h"

/* Place, orientation and velocity (the acceleration is zero) of the frame that a linear or modal member is seen from:
   those of its root where they are given or joints tie it, else it stands at the reference. Members that are linear
   about their reference otherwise: the same. */
spari_pose spari_member_pose(const spar_member *member, const spari_motion *nodes);
/* Deformation of a node seen from there, displacement and rotation vector in the axes of the pose, and its rates. */
void spari_member_deformation(const spar_member *member, const spari_pose *pose, const spari_motion *nodes,
                              int64_t node, double x[6], double rate[6]);

#endif
