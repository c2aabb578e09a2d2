/* Exchange between ranks: nodal loads are summed, motion is sent from the owner of a member to the others. */
#ifndef SPARI_RANK_LOADS_AND_MOTION_H
#define SPARI_RANK_LOADS_AND_MOTION_H

#include "../base/session.h"

/* Whether this rank's fluids have usable loads: the status of a refused push, with the call in front of its message.
   Local. */
int spari_session_pushes(spar_session *session, const char *call);
/* Whether the nodes of this rank's fluids are mapped. Local. */
int spari_session_mapped(spar_session *session, const char *call);
/* exchange: sums the fluids' pushed loads over all ranks; collective. pushed: whether any fluid ever pushed loads;
   may be NULL. The second call returns the part of one member, load [nodes][6]. */
int spari_session_exchange_loads(spar_session *session, int *pushed);
void spari_session_take_loads(const spar_session *session, const spar_member *member, double *load);
/* Whether any rank's host has set the motion of a member with joints in this step. Collective. */
int spari_session_moved(spar_session *session, int *moved);
/* Sends motion and dissipation of solved members, from member->after, to all ranks. Collective. */
int spari_session_share_motion(spar_session *session, int status);
/* Allocates the two calls above for the committed members; agrees on a status. Collective. */
int spari_session_seal(spar_session *session, int status);
/* Whether this memory fits the present settings. Local, the same on all ranks. */
int spari_session_is_sealed(const spar_session *session);

#endif
