/* Entry of the collective calls of a session. Compares calls and arguments across ranks, and records if the ranks
   are in different calls. */
#ifndef SPARI_ENTER_H
#define SPARI_ENTER_H

#include "../base/session.h"
#include "comm.h"

/* Agrees on a status and on the call. */
int spari_enter(spar_session *session, const char *call, int status);
/* Also compares arguments alike[count] and all settings of the session. */
int spari_enter_agreed(spar_session *session, const char *call, const spari_agreed *must_agree, int count, int status);

/* As spari_comm_agree and spari_comm_sum, with the session's message. */
int spari_agree(spar_session *session, int status);
#ifdef __clang_analyzer__ /* as in comm.h */
#define spari_agree(session, status) ((spari_agree)(session, status) ? 1 : (status))
#endif
int spari_sum(spar_session *session, double *x, int64_t n);
/* Whether `here` is true on any rank. Collective. */
int spari_anywhere(spar_session *session, int here, int *any);

#endif
