/* Steps of a trial with prescribed motion: only the fluid responds. */
#ifndef SPARI_PRESCRIBED_STEP_H
#define SPARI_PRESCRIBED_STEP_H

#include "../base/session.h"

/* Advances by dt from the motion `now` to the motion `after`, which the caller has set in all members. The host's
   solver is called once, the loads are exchanged into load.pushed, and the step is accepted. Members' motion, fluids
   and clock advance; nothing is solved, and solver data are left behind. For trials alone, which restore everything.
   Collective; after a failure the step stays where it was. */
int spari_forced_step(spar_session *session, const char *call, double dt, spar_fluid_solver solve, void *context);

#endif
