/* The entry of a collective call of a session: compares what the ranks call, and records in session->calls_differ that
   their calls differ. */
#ifndef SPARI_ENTER_H
#define SPARI_ENTER_H

#include "../base/session.h"
#include "comm.h"

/* Agrees on a status and on what is called. */
int spari_enter(spar_session *session, const char *call, int status);
/* The same where arguments have to be alike, alike[count], and all that is set for the session. */
int spari_enter_alike(spar_session *session, const char *call, const spari_alike *alike, int count, int status);

#endif
