/* A member made anew from its description, with other settings, in the state it is in: what a trial run is made with.
   The handle stays where it is, so that the host's calls reach the member made anew; what it was waits in a copy. */
#ifndef SPARI_REMAKE_H
#define SPARI_REMAKE_H

#include "../member/structure.h"

struct spari_remake {
    int per_element; /* beams: nodes per element */
    int fidelity;    /* SPAR_FIDELITY_* */
    int64_t modes;   /* of a modal member */
    int points;      /* beams: quadrature points of the rule in force; 0: as described */
    int left_out;    /* SPAR_EFFECT_* that are not to be there */
    int elements;    /* beams: how many, 0: as many as there are. One whose nodes were given keeps its own */
};

/* The member as it is. */
spari_remake spari_remake_of(const spar_member *member);
/* Makes `member` anew. Its state at t^n goes over: displacements and rotations by the elements' own interpolation,
   loads by its transpose, so that their sum is kept. Accelerations begin from the balance of forces. *old: what it was;
   give it to spari_member_restore, also after a failure. Local. */
int spari_member_remake(spar_member *member, const spari_remake *wish, spar_member *old);
void spari_member_restore(spar_member *member, const spar_member *old);
/* It stays as it was made anew: what it was goes. */
void spari_member_adopt(spar_member *member, spar_member *old);

#endif
