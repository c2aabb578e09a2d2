/* Section forces from the equilibrium of the part of a beam beyond the section: its loads minus its inertia. They
   are as accurate as the nodal equilibrium, and hence as the reaction; stiffness times strain is one order less
   accurate. */
#ifndef SPARI_SECTION_RESULTANTS_H
#define SPARI_SECTION_RESULTANTS_H

#include "beam.h"

typedef struct spari_beyond spari_beyond;

/* Whether the motion `after` is in equilibrium with its loads, for a member whose nodes are its body's. What holds a
   beam in a plane is not among these loads. */
int spari_beyond_is_known(const spar_member *member);
/* NULL: no memory. */
spari_beyond *spari_beyond_create(const spar_member *member);
void spari_beyond_free(spari_beyond *beyond);
/* Force and moment about the station on the part beyond it, global axes. Nodal loads at the station count at the tip
   and within the line, not at the root. */
void spari_beyond_at(const spari_beyond *beyond, const spari_station *s, double force[6]);
/* Whether the member's equations use reference lever arms and unrotated sections. */
int spari_beyond_is_undeformed(const spar_member *member);

#endif
