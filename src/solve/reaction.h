/* The reaction at the root of a member, and the energies of the member. */
#ifndef SPARI_REACTION_H
#define SPARI_REACTION_H

#include "../member/structure.h"

/* The reaction at the root at t^{n+1}, with a workspace of so many doubles. It is zero if the root is free, or if spar
   does not solve for the member. */
int64_t spari_member_reaction_size(const spar_member *member);
void spari_member_reaction_in(const spar_member *member, double *workspace, double load[6]);

/* For the rows of the table: the balance of the whole member, so that the reaction is the rate of its momentum less its
   weight and loads, with the accelerations that are published. Internal forces do not enter. Initial accelerations are
   filtered (assembly.c): only this balance holds with them, not that of the root's node. */
int64_t spari_reaction_of_whole_size(const spar_member *member);
void spari_reaction_of_whole(const spar_member *member, double *workspace, double load[6]);
/* Kinetic, strain and potential energy of the body at t^{n+1}. Returns 0 or SPAR_ERR_MEMORY. */
int spari_energy_of_body(const spar_member *member, double energy[4]);

#endif
