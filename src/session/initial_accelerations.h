/* Consistent initial conditions, in the parts of a step: see initial_accelerations.c. */
#ifndef SPARI_INITIAL_ACCELERATIONS_H
#define SPARI_INITIAL_ACCELERATIONS_H

#include "../base/session.h"

/* Begins for steps dt, in the name of `call`. Collective. */
int spari_start_begin(spar_session *session, const char *call, double dt);
/* Accelerations at t^0 under the loads in use. Collective. */
int spari_start_solve(spar_session *session, const char *call);
/* Ends: accept makes the result the state at t^0, reject restores the state before. Local. */
void spari_start_accept(spar_session *session);
void spari_start_reject(spar_session *session);
/* Whether initial conditions were computed, and no step made since. */
int spari_start_stands(const spar_session *session);

#endif
