/* How a step changes a member's acceleration, which the error of the step in time goes by (E1). */
#ifndef SPARI_CHANGE_H
#define SPARI_CHANGE_H

#include "../member/structure.h"
#include "scheme.h"

/* Roots of mean squares over nodes, of one node its turns count as well, on arms of the member's length; of a driven
   root's member as seen from there: of the change of the acceleration over the step, of the acceleration and the
   velocity at its end. */
typedef struct spari_change {
    double change, acceleration, speed;
} spari_change;

/* Whether the member's motion comes out of the scheme. */
int spari_change_is(const spar_member *member);
/* Of the step that has just been solved, over every `stride`-th node. */
spari_change spari_change_of(const spar_member *member, int64_t stride);
/* Accelerations at t = 0 are known only where a start has been balanced. */
int spari_change_tells(const spar_session *session);
/* What a substep errs by, of the change of the acceleration over it. */
double spari_change_error(const spari_scheme *c, double change);

#endif
