/* The host's functions, called inside a call of the library's. */
#ifndef SPARI_CALLBACKS_H
#define SPARI_CALLBACKS_H

#include "../base/session.h"

/* ---- the fluid solver, or the function before a step, in a call that goes on afterwards ---- */

/* Refuses, while it runs, a call that would end or move on what is under way, which belongs to the call that runs it;
   and a session that is NULL.
   Before the ranks meet: the others are not in this call. Local. */
int spari_callback_refuse(spar_session *session, const char *call);
/* Calls the solver for the step of dt from t^n; solve may be NULL. SPAR_ERR_COMM: the solver made a collective call
   on this rank alone, and the others noticed. Other failures are this rank's own. Local. */
int spari_callback_run(spar_session *session, const char *lender, spar_fluid_solver solve, double dt, void *context);
/* Calls the host's function before a step of dt; NULL on all ranks: nothing to call. Collective. */
int spari_callback_before_step(spar_session *session, const char *lender, spar_before_step before, double dt,
                               void *context);

/* ---- progress: the host hears how far a call that makes trials is, ahead of each of its runs, and may stop it ---- */

typedef struct spari_progress {
    const char *call;
    spar_progress tell; /* NULL: nobody */
    void *context;
    int stopped; /* what the call is to answer, once it has been stopped; else SPAR_OK */
} spari_progress;

/* SPAR_OK, or SPAR_ERR_LIMIT on all ranks, where one of them stops: no trial fails with that, so that nothing else is
   tried in its place. Collective where there is somebody, else nothing. */
int spari_progress_tell(spar_session *session, spari_progress *progress, double done, double expected);
/* The status of a call that has been stopped, else `status`. */
int spari_progress_ends(const spari_progress *progress, int status);

/* Warns if the last iteration shows that the fluid amplifies changes of its loads on a structure without inertia.
   Returns whether it does (static.c). */
int spari_session_warn_divergence(spar_session *session, const char *call);

#endif
