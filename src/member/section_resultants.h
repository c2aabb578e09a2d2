/* Section forces from the equilibrium of the part of a beam beyond the section: its loads minus its inertia. They
   are as accurate as the nodal equilibrium, and hence as the reaction, except near a jump of mass, foundation or fluid
   load inside an element, which nodal sums smooth; stiffness times strain is one order less accurate. */
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
/* Force and moment about the station on the part beyond it, global axes: force[0] of what acts at the reference and on
   sections that are not rotated, force[1] of what acts where the line is, and on rotated sections. Nodal loads at the
   station count at the tip and within the line, not at the root. */
void spari_beyond_at(const spari_beyond *beyond, const spari_station *s, double force[2][6]);
/* Whether the member's equations use reference lever arms and unrotated sections, for all forces but weight. */
int spari_member_is_undeformed(const spar_member *member);

/* The motion of the inertia forces in a member's equations, of its unique nodes: 7, 6, 6, and workspace of 6. A linear
   member at rest has its accelerations at the reference. Damping by mass is in the accelerations. */
typedef struct spari_inertial {
    double *q, *v, *a, *workspace;
    int still; /* without inertia */
} spari_inertial;
void spari_inertial_fill(const spar_member *member, const spari_inertial *to);

#endif
