/* Equilibrium of members that joints tie together and that turn as one, seen from the frame that turns with them: how
   they turn, and whether what stands (the ground, weight) is the same at every angle. */
#ifndef SPARI_TURNING_H
#define SPARI_TURNING_H

#include "system.h"

/* Finds whether its driven roots, the nodes that move as they are told, and joints driven against the ground turn it,
   into a->turns and a->turning. What turns otherwise than the rest, or changes with the angle, is refused: a status and
   a message. Ended by end whatever that is. */
int spari_turning_begin(spari_assembly *a);
void spari_turning_end(spari_assembly *a);
/* Of the equilibrium found: whether joints to what stands hold it alike at every angle. */
int spari_turning_check(spari_assembly *a);

#endif
