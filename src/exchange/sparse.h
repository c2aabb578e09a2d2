/* Each rank knows what it touches, and no more (option ranks.state = touched). Members that joints tie together, or one
   that none ties, are a unit here. A unit's ranks are the one that solves it and those whose fluids have nodes on it:
   loads are summed over these, and its motion goes to these. The ranks that solve anything, and rank 0, are the core:
   there the whole state is, as on every rank without the option, and the coupling is iterated there. The others stand
   aside: they know the motion of the members that they touch. */
#ifndef SPARI_SPREAD_H
#define SPARI_SPREAD_H

#include "../base/session.h"
#include "../comm/comm.h"

typedef struct spari_spread spari_spread;

/* From here on, for the fluids that there are: sets session->apart and ->aside and members' `away`. On all ranks or
   none. Collective. */
int spari_spread_begin(spar_session *session);
/* The whole state is on every rank again, or that at t = 0 is. Local. */
void spari_spread_end(spar_session *session);
/* SPAR_ERR_STATE where ranks know only a part of the state, for a call that needs it whole; alike on all. Local. */
int spari_spread_refuse(spar_session *session, const char *call);
/* Memory for reproducible sums, if they are asked for. Collective. */
int spari_spread_prepare(spar_session *session);

/* As spari_session_exchange_loads, where they are wanted: on the core. */
int spari_spread_loads(spar_session *session);
const double *spari_spread_loads_of(const spar_session *session, const spar_member *member);
/* As spari_session_share_motion, to the core and to the ranks of each unit. */
int spari_spread_motion(spar_session *session, int status);
/* The ranks that iterate the coupling: all of them, or the core. */
spari_comm *spari_spread_core(const spar_session *session);
/* What the core's coupling has found, to all: its status and message, whether the step has ended, and residual and
   size of the loads of its iteration. */
typedef struct spari_found {
    int ended;
    double residual, size;
} spari_found;
int spari_spread_found(spar_session *session, int status, spari_found *found);

#endif
