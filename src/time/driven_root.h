/* The motion of a driven root within a step, and where it jumps. */
#ifndef SPARI_DRIVEN_ROOT_H
#define SPARI_DRIVEN_ROOT_H

#include "../member/structure.h"

/* Motion of a driven root at the part s in (0, 1] of the step: between t^n and t^{n+1} by cubic Hermite. */
spari_pose spari_drive_at(const spar_member *member, double s, double dt);
/* The same of any node that has prescribed motion, from a at t^n to b. */
spari_pose spari_drive_between(const spari_pose *a, const spari_pose *b, double s, double dt);
/* The root at the end of a trapezoidal stage, `span` of a substep of h from one pose to another, `span` <= h. What the
   root jumps by, it jumps by at once, so that the stage and the whole substep have the same jump. */
spari_pose spari_drive_stage(const spari_pose *from, const spari_pose *to, double h, double span);
/* What a driven root does from one pose to another, h later, beyond what its accelerations, then its velocities say: a
   jump of velocity at once, and one of place; in the axes of `to`. The nodes have no part in either. Zero to third
   order in h for smooth driving. */
void spari_drive_jump(const spari_pose *from, const spari_pose *to, double h, double velocity[6], double position[6]);

#endif
