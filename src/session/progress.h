/* The host hears how far a call that makes trials is, ahead of each of its runs, and may stop it. */
#ifndef SPARI_PROGRESS_H
#define SPARI_PROGRESS_H

#include "../base/session.h"

typedef struct spari_progress {
    const char *call;
    spar_progress tell; /* as it was at the entry of the call; NULL: nobody */
    void *context;
    int stopped; /* what the call is to answer, once it has been stopped; else SPAR_OK */
} spari_progress;

spari_progress spari_progress_of(const spar_session *session, const char *call);
/* SPAR_OK, or SPAR_ERR_LIMIT on all ranks, where one of them stops: no trial fails with that, so that nothing else is
   tried in its place. Collective where there is somebody, else nothing. */
int spari_progress_tell(spar_session *session, spari_progress *progress, double done, double expected);
/* The status of a call that has been stopped, else `status`. */
int spari_progress_ends(const spari_progress *progress, int status);

#endif
