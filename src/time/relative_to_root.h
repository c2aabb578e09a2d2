/* The motion of the nodes relative to a driven root, in the axes of the root. In these axes a steady rotation is
   rest, and stiff directions stay (docs/evidence/beam.md). */
#ifndef SPARI_RELATIVE_TO_ROOT_H
#define SPARI_RELATIVE_TO_ROOT_H

#include "body_solver.h"
#include "scheme.h"

/* The ends of a substep in the variables of the scheme: relative to a driven root, else absolute. `absolute` is the end
   as the body takes it. */
typedef struct spari_ends {
    spari_state from, to, absolute;
    const spari_pose *root; /* reference of the motion at the end: a driven root, or a rigid motion; NULL: none */
    double root_motion; /* how far the reference moves the member: rotation, and displacement relative to its length */
} spari_ends;

/* How far a root moves the member: rotation, and displacement relative to its length. */
double spari_root_motion(const spari_pose *from, const spari_pose *to, double length);
/* own := the motion of all nodes relative to a root. b is relative already. */
void spari_root_look_from(const spari_solver *solver, const spar_member *member, const spari_pose *root,
                          const spari_state *state, spari_state *own);
/* The inverse: sets the absolute motion that the body takes. */
void spari_root_show(const spari_solver *solver, const spar_member *member, spari_ends *ends);
/* If the root jumps within h, the nodes keep position and velocity: the jump is subtracted from `own`. */
void spari_root_subtract_jump(const spari_solver *solver, const spar_member *member, double h, const spari_pose *from,
                              const spari_pose *to, const spari_state *own);

#endif
