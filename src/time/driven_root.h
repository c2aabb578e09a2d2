/* The motion of a driven root within a step, and its jumps. */
#ifndef SPARI_DRIVEN_ROOT_H
#define SPARI_DRIVEN_ROOT_H

#include "../member/structure.h"

/* Motion of a driven root at the part s in (0, 1] of the step: between t^n and t^{n+1} by cubic Hermite. */
spari_pose spari_drive_at(const spar_member *member, double s, double dt);
/* The same for any node with prescribed motion, from a at t^n to b. */
spari_pose spari_drive_between(const spari_pose *a, const spari_pose *b, double s, double dt);
/* The root at the end of a trapezoidal stage, which ends after `span` <= h of a substep h from one pose to another.
   A jump of the root happens at once: the stage and the whole substep have the same jump. */
spari_pose spari_drive_stage(const spari_pose *from, const spari_pose *to, double h, double span);
/* The jump of a driven root from one pose to another, h later: the part of the motion that its accelerations, then
   its velocities do not explain. velocity, position: in the axes of `to`. Nodes do not follow the jump. It is of
   third order in h for smooth driving. */
void spari_drive_jump(const spari_pose *from, const spari_pose *to, double h, double velocity[6], double position[6]);

#endif
