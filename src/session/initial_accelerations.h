/* The balanced start, in the pieces that a step is made of: see initial_accelerations.c. */
#ifndef SPARI_START_H
#define SPARI_START_H

#include "../base/session.h"

/* Begins it for steps dt; call: in whose name. Collective. */
int spari_start_begin(spar_session *session, const char *call, double dt);
/* Accelerations at t^0 under the loads in use. Collective. */
int spari_start_solve(spar_session *session, const char *call);
/* It ends: what was found holds at t^0, or all is as it was. Local. */
void spari_start_accept(spar_session *session);
void spari_start_reject(spar_session *session);
/* Whether one has been made, and no step since. */
int spari_start_stands(const spar_session *session);

#endif
