/* Equilibrium of members that joints tie together and that turn as one, seen from the frame that turns with them: how
   they turn, and whether what stands (the ground, weight) is the same at every angle. */
#ifndef SPARI_ROTATION_CHECK_H
#define SPARI_ROTATION_CHECK_H

#include "system.h"

/* Finds whether its driven roots, the nodes with prescribed motion, and joints driven against the ground turn it,
   into a->turns and a->turning. What turns otherwise than the rest, or changes with the angle, is refused: a status and
   a message. Ended by end whatever that is. */
int spari_rotation_check_begin(spari_assembly *a);
void spari_rotation_check_end(spari_assembly *a);
/* Of the equilibrium found: whether joints to what stands hold it alike at every angle. */
int spari_rotation_check_joints(spari_assembly *a);

#endif
