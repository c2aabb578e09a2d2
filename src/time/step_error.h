/* The local error of a time step, estimated from the change of acceleration over the step: (E1) of
   docs/explanation/theory.md. */
#ifndef SPARI_STEP_ERROR_H
#define SPARI_STEP_ERROR_H

#include "../member/structure.h"
#include "scheme.h"

/* Root mean squares over the nodes: of the change of the acceleration over the step, and of the velocity at its end.
   For a member of one node, rotations count too, times the length of the member. For a member with a driven root the
   motion is relative to the root. */
typedef struct spari_step_change {
    double change, speed;
} spari_step_change;

/* Whether the scheme computes the member's motion. */
int spari_step_error_applies(const spar_member *member);
/* The values of the step that has just been solved. */
spari_step_change spari_step_change_of(const spar_member *member);
/* Whether the error is known. In the first step this needs consistent initial accelerations. */
int spari_step_error_is_known(const spar_session *session);
/* The error of a substep with this change of the acceleration. */
double spari_step_error(const spari_scheme *c, double change);

#endif
