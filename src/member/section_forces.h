/* Section forces from the balance of the part of a beam beyond them: its loads less its inertia. They are as exact as
   the nodal balance, and with it the reaction; the stiffness times the strains is an order less. */
#ifndef SPARI_BEYOND_H
#define SPARI_BEYOND_H

#include "beam.h"

typedef struct spari_beyond spari_beyond;

/* Whether the motion after is one that its loads balance, of a member whose nodes are its body's. */
int spari_beyond_is_known(const spar_member *member);
/* NULL: no memory. */
spari_beyond *spari_beyond_create(const spar_member *member);
void spari_beyond_free(spari_beyond *beyond);
/* Force and moment of the part beyond the station about it, global axes. Of loads at a node there: those of the tip and
   of nodes within the line count, those of the root do not. */
void spari_beyond_at(const spari_beyond *beyond, const spari_station *s, double force[6]);
/* Whether the member's equations know no arms but those of the reference, nor sections that turn. */
int spari_beyond_is_undeformed(const spar_member *member);

#endif
