/* Between the ranks: loads up, motion down. */
#ifndef SPARI_EXCHANGE_H
#define SPARI_EXCHANGE_H

#include "../base/session.h"

/* Whether this rank's fluids have loads to go on with: the status of a push that was refused, with the call in front of
   its message. Local. */
int spari_session_pushes(spar_session *session, const char *call);
/* The sum over all ranks of what the fluids pushed; then the part of one member, into load [nodes][6]. The first is
   collective. pushed: whether any fluid ever pushed loads; may be NULL. */
int spari_session_exchange_loads(spar_session *session, int *pushed);
void spari_session_take_loads(const spar_session *session, const spar_member *member, double *load);
/* Whether the host of any rank has given a member that joints tie its motion, in the step under way. Collective. */
int spari_session_moved(spar_session *session, int *moved);
/* Motion and dissipation of the members each rank has solved for, from member->after, to all ranks.
 * Collective. */
int spari_session_share_motion(spar_session *session, int status);
/* Memory for the two calls above, for the members committed by now; agrees on a status. Collective. */
int spari_session_seal(spar_session *session, int status);
/* Whether that memory will do for the settings of now. Local, the same answer on all ranks. */
int spari_session_is_sealed(const spar_session *session);

#endif
