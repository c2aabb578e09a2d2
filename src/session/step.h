/* Performs a step with the host's fluid solver. */
#ifndef SPARI_STEP_H
#define SPARI_STEP_H

#include "../base/session.h"

/* Iterates a begun step until it can be accepted. After a failure it has been rejected. Collective. */
int spari_step_run(spar_session *session, const char *call, spar_fluid_solver solve, void *context);

#endif
