/* What the root gives a member, and its energies. */
#ifndef SPARI_REACTION_H
#define SPARI_REACTION_H

#include "../member/structure.h"

/* What the root gives the member in the motion after. Zero where nothing holds it or spar does not solve for it.
 * Returns SPAR_ERR_MEMORY or 0. */
int spari_member_reaction(const spar_member *member, double load[6]);
/* The same with memory given beforehand: so many doubles. */
int64_t spari_member_reaction_size(const spar_member *member);
void spari_member_reaction_in(const spar_member *member, double *workspace, double load[6]);

/* For the rows of the table. From the balance of the root's own node, for members whose internal forces are at hand. */
int64_t spari_reaction_at_root_size(const spar_member *member);
void spari_reaction_at_root(const spar_member *member, double *workspace, double load[6]);
/* From the balance of the whole: inertia less weight less loads, each where its node is; in linear theory about axes
   that stand, where its node is in the reference. Internal forces have no part in it. */
int64_t spari_reaction_of_whole_size(const spar_member *member);
void spari_reaction_of_whole(const spar_member *member, double *workspace, double load[6]);
/* Kinetic, strain and potential energy of the body in the motion after. 0, or SPAR_ERR_MEMORY. */
int spari_energy_of_body(const spar_member *member, double energy[4]);

#endif
