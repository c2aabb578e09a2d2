/* Steps of a trial whose motion is known: the fluid alone answers. */
#ifndef SPARI_FORCED_H
#define SPARI_FORCED_H

#include "../base/session.h"

/* A step of dt from the motion now to the motion after, which the caller has put into all members: the host's solver is
   called once, the loads are exchanged into load_pushed, and the step is accepted. What moves is the members' motion,
   the fluids and the clock; nothing is solved, and what solves is left behind: for trials alone, which go back.
   Collective; after a failure the step stays where it was. */
int spari_forced_step(spar_session *session, const char *call, double dt, spar_fluid_solver solve, void *context);

#endif
