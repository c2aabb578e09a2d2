/* Which rank solves what: members that joints tie go as one, to the rank that the host has given one of them, or else
   the dearest first to the rank that has least to do; members without joints likewise. The same on all ranks. */
#ifndef SPARI_OWNERS_H
#define SPARI_OWNERS_H

#include "../base/session.h"

/* What solving for a member, or for all those of an assembly and its joints, is expected to take in an iteration,
   instructions; 0: its motion is prescribed. Committed; local, the same on all ranks. */
double spari_member_expected(const spar_member *member);
double spari_assembly_expected(const struct spari_assembly *assembly);
/* Owners for the assemblies that there are. Local; a status and a message, none of SPAR_ERR_MEMORY. */
int spari_owners_of_assemblies(spar_session *session);
/* For members without joints, once: they move there. Before the first step, and before there is anything that a solver
   keeps. On all ranks or none; collective, where there is more than one. */
int spari_owners_assign(spar_session *session);

#endif
