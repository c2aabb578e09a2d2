/* Rebuilds a member from its description with other settings, in its present state, for trials. The handle stays
   valid, so the host's calls reach the rebuilt member; a copy holds the old one. */
#ifndef SPARI_REBUILD_H
#define SPARI_REBUILD_H

#include "../member/structure.h"

struct spari_rebuild {
    int per_element; /* beams: nodes per element */
    int fidelity;    /* SPAR_FIDELITY_* */
    int64_t modes;   /* of a modal member */
    int points;      /* beams: quadrature points of the rule in force; 0: as described */
    int left_out;    /* SPAR_EFFECT_* to switch off */
    int elements;    /* beams: number; 0: unchanged. A beam with given nodes keeps its own */
};

/* Present settings of the member. */
spari_rebuild spari_rebuild_of(const spar_member *member);
/* Rebuilds `member`. Its state at t^n is transferred: displacements and rotations by interpolation, loads by its
   transpose, so their sum is conserved. Accelerations follow from the equations of motion. *old: the member before;
   pass it to spari_member_restore, also after a failure. Local. */
int spari_member_rebuild(spar_member *member, const spari_rebuild *settings, spar_member *old);
void spari_member_restore(spar_member *member, const spar_member *old);
/* Keeps the rebuilt member and frees the old one. */
void spari_member_adopt(spar_member *member, spar_member *old);

#endif
