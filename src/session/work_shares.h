/* Solves the members and assemblies of this rank with one or several threads. */
#ifndef SPARI_WORK_SHARES_H
#define SPARI_WORK_SHARES_H

#include "../base/session.h"

/* Allocates for the threads, if there are any; call before the first solution of a step. */
int spari_threads_prepare(spar_session *session);
/* Solves everything on this rank from t^n to t^{n+1}. A failure does not stop the others. The message is that of the
   first in the order of creation, with any number of threads. */
int spari_threads_solve(spar_session *session);
/* Processes one member; must not read or write others. Between the beginning and the end of a step. */
typedef void (*spari_member_task)(spar_member *member, const void *context);
void spari_threads_each(spar_session *session, spari_member_task task, const void *context);
void spari_threads_free(spar_session *session);

#endif
