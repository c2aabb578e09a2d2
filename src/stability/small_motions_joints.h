/* Joints in the small-motion equations. */
#ifndef SPARI_SMALL_MOTIONS_JOINTS_H
#define SPARI_SMALL_MOTIONS_JOINTS_H

#include "../member/joint.h"
#include "motion_parts.h"

/* Adds the entries of a joint, after those of the parts; SPAR_ERR_UNSUPPORTED: they depend on time in this frame.
   constraints: number of rows of G. */
int spari_small_motions_add_joint(spari_small_motions *motions, const spar_joint *joint, int *constraints);

#endif
