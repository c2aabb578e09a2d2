/* Loads of members made anew with other nodes, as reproducible sums over the ranks. What a rank's share would become
   there is rounded, and so depends on who has which nodes; the sum over the ranks does not. So that is what goes over,
   and one of the ranks whose nodes it is of has it from then on, until they push again. */
#ifndef SPARI_CARRY_H
#define SPARI_CARRY_H

#include "../fluid/fluid.h"

/* A fluid that has been made anew, what it was, and what its member was. */
typedef struct spari_carried {
    spar_fluid *fluid;
    const spar_fluid *old;
    const spar_member *before;
} spari_carried;

/* fluids[count]: those whose members have other nodes now. any: whether there are members with other nodes, which is
   alike on all ranks; the list need not be, and is refused then: SPAR_ERR_COMM, in a call of that name. Nothing to do,
   and nothing sent, without any, where sums are not reproducible, and on one rank. Collective. */
int spari_carry_loads(spar_session *session, const char *call, int any, const spari_carried *fluids, int64_t count);

#endif
