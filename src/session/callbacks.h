/* Runs the host's fluid solver inside a call that continues with the pushed loads: spar_step, or a static solution. */
#ifndef SPARI_LEND_H
#define SPARI_LEND_H

#include "../base/session.h"

/* During a callback, refuses calls that would end or advance the step in progress, which belongs to the outer call.
   Checked before the ranks communicate, because the others are not in this call. Local. */
int spari_lend_refuse(spar_session *session, const char *call);
/* Calls the solver for the step of dt from t^n; solve may be NULL. SPAR_ERR_COMM: the solver made a collective call
   on this rank alone, and the others noticed. Other failures are this rank's own. Local. */
int spari_lend(spar_session *session, const char *lender, spar_fluid_solver solve, double dt, void *context);
/* Calls the host's function before a step of dt; NULL on all ranks: nothing to call. Collective. */
int spari_lend_before(spar_session *session, spar_before_step before, double dt, void *context);

#endif
