/* The host's fluid solver, run inside a call that goes on with what it has pushed: spar_step, or a static solution. */
#ifndef SPARI_LEND_H
#define SPARI_LEND_H

#include "../base/session.h"

/* Refuses, while it runs, a call that would end or move on what is under way, which belongs to the call that runs it.
   Before the ranks meet: the others are not in this call. Local. */
int spari_lend_refuse(spar_session *session, const char *call);
/* Runs it for the step of dt from t^n; solve NULL: nothing to run. SPAR_ERR_COMM: it has led this rank away from the
   others, who know; any other failure is this rank's own. Local. */
int spari_lend(spar_session *session, const char *lender, spar_fluid_solver solve, double dt, void *context);
/* The host's call ahead of a step of dt; NULL: nothing to call, on any rank. Collective. */
int spari_lend_before(spar_session *session, spar_before_step before, double dt, void *context);

#endif
