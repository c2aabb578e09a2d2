/* A step by the host's fluid solver. */
#ifndef SPARI_STEP_H
#define SPARI_STEP_H

#include "../base/session.h"

/* What has been begun, until it is to be accepted; where it fails it has been rejected. Collective. */
int spari_step_run(spar_session *session, const char *call, spar_fluid_solver solve, void *context);

#endif
