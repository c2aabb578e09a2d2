/* Loads on rebuilt members with other nodes, as reproducible sums over the ranks. Transferring each rank's share
   would round it, so the result would depend on the distribution of nodes. The sum over the ranks does not; so the
   sum is transferred, and one of the fluid's ranks holds it until the fluid pushes again. */
#ifndef SPARI_MOVE_LOADS_H
#define SPARI_MOVE_LOADS_H

#include "../fluid/fluid.h"

/* A rebuilt fluid, and the old fluid and member. */
typedef struct spari_moved_loads {
    spar_fluid *fluid;
    const spar_fluid *old;
    const spar_member *before;
} spari_moved_loads;

/* fluids[count]: fluids whose members have other nodes. any: whether there are members with other nodes, which
   agrees on all ranks; the lists need not agree, which is refused: SPAR_ERR_COMM, in the name of `call`. Does and
   sends nothing if `any` is 0, if sums are not reproducible, and on one rank. Collective. */
int spari_move_loads(spar_session *session, const char *call, int any, const spari_moved_loads *fluids, int64_t count);

#endif
