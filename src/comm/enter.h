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

#endif
