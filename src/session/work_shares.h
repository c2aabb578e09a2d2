/* The members and assemblies of this rank, solved by one thread or by several at once. */
#ifndef SPARI_THREADS_H
#define SPARI_THREADS_H

#include "../base/session.h"

/* Room for what the threads are given, if there are threads: before the first solution of a step. */
int spari_threads_prepare(spar_session *session);
/* All that this rank solves from t^n to t^{n+1}. One that fails stops none of the others, and the message is that of
   the first in the order of creation: the same with any number of threads. */
int spari_threads_solve(spar_session *session);
/* What is done of each member, and reads and writes nothing of the others: between a step's beginning and its end. */
typedef void (*spari_member_task)(spar_member *member, const void *context);
void spari_threads_each(spar_session *session, spari_member_task task, const void *context);
void spari_threads_free(spar_session *session);

#endif
