/* The session: one clock, its members, its fluids on this rank, one communicator. */
#ifndef SPARI_SESSION_H
#define SPARI_SESSION_H

#include "../base/scene.h"
#include "../comm/comm.h"
#include "../fluid/fluid.h"
#include "../member/member.h"
#include "coupling.h"

typedef struct spari_record spari_record; /* trial.h */

/* What no other room sees. */
struct spari_own {
    double *pack; /* loads of all members, stacked, for the ranks' sum: [6 * nodes of all members + 1] */
    int64_t pack_count;
    int64_t *first;           /* several ranks: where the block of each rank's members begins in `motion` */
    double *motion;           /* several ranks: motion of all solved members, by owner */
    spari_coupling *coupling; /* from the first step on */
    spari_record *kept;       /* of a trial that others are compared with; NULL: none */
};

/* Whether this rank's fluids have loads to go on with: the status of a push that was refused, with the call in front of
   its message. Local. */
int spari_session_pushes(spar_session *session, const char *call);
/* The sum over all ranks of what the fluids pushed; then the part of one member, into load [nodes][6]. The first is
   collective. */
int spari_session_exchange_loads(spar_session *session);
void spari_session_take_loads(const spar_session *session, const spar_member *member, double *load);
/* Motion and dissipation of the members each rank has solved for, from member->after, to all ranks.
 * Collective. */
int spari_session_share_motion(spar_session *session, int status);
/* Memory for the two calls above, for the members committed by now; agrees on a status. Collective. */
int spari_session_seal(spar_session *session, int status);

#endif
