/* Equilibrium of an assembly in steady rotation, in the rotating frame: finds the rotation, and checks that
   everything that does not rotate (the ground, weight) acts in the same way at every angle. */
#ifndef SPARI_ROTATION_CHECK_H
#define SPARI_ROTATION_CHECK_H

#include "system.h"

/* Finds the steady rotation of the assembly, into a->rotates and a->rotating. Driven roots, nodes with prescribed
   motion and joints driven against the ground define it. Motions that differ from it, or that change with the angle,
   are refused: a status and a message. Call spari_rotation_check_end afterwards in any case. */
int spari_rotation_check_begin(spari_assembly *a);
void spari_rotation_check_end(spari_assembly *a);
/* Checks the equilibrium: joints to parts that do not rotate have to act in the same way at every angle. */
int spari_rotation_check_joints(spari_assembly *a);

#endif
