/* What the root gives a member. */
#ifndef SPARI_REACTION_H
#define SPARI_REACTION_H

#include "../member/structure.h"

/* What the root gives the member in the motion after. Zero where nothing holds it or spar does not solve for it.
 * Returns SPAR_ERR_MEMORY or 0. */
int spari_member_reaction(const spar_member *member, double load[6]);
/* The same with memory given beforehand: so many doubles. */
int64_t spari_member_reaction_room(const spar_member *member);
void spari_member_reaction_in(const spar_member *member, double *room, double load[6]);

#endif
