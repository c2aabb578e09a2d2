/* How a step changes a member's acceleration, which the error of the step in time goes by (E1). */
#ifndef SPARI_STEP_ERROR_H
#define SPARI_STEP_ERROR_H

#include "../member/structure.h"
#include "scheme.h"

/* Roots of mean squares over nodes, of one node its turns count as well, on arms of the member's length; of a driven
   root's member as seen from there: of the change of the acceleration over the step, of the acceleration and the
   velocity at its end. */
typedef struct spari_step_change {
    double change, acceleration, speed;
} spari_step_change;

/* Whether the member's motion comes out of the scheme. */
int spari_step_error_applies(const spar_member *member);
/* Of the step that has just been solved, over every `stride`-th node. */
spari_step_change spari_step_change_of(const spar_member *member, int64_t stride);
/* Accelerations at t = 0 are known only where a start has been balanced. */
int spari_step_error_is_known(const spar_session *session);
/* What a substep errs by, of the change of the acceleration over it. */
double spari_step_error(const spari_scheme *c, double change);

#endif
