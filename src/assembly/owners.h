/* The owner of a member is the rank that solves it. Members that joints connect have one owner: the rank that the
   host has given to one of them. Other assemblies, and members without joints, go to the least loaded rank, most
   expensive first. The result is the same on all ranks. */
#ifndef SPARI_OWNERS_H
#define SPARI_OWNERS_H

#include "../base/session.h"

/* Estimated cost of an iteration for a member, or for an assembly with its joints, in instructions; 0: its motion is
   prescribed. Committed members; local; the same on all ranks. */
double spari_member_expected(const spar_member *member);
double spari_assembly_expected(const struct spari_assembly *assembly);
/* Finds the owners of the assemblies. Local. Returns a status, with a message except for SPAR_ERR_MEMORY. */
int spari_owners_of_assemblies(spar_session *session);
/* Moves members without joints to their owners, once: before the first step, and before any solver has a state.
   Succeeds on all ranks or on none. Collective on several ranks. */
int spari_owners_assign(spar_session *session);

#endif
