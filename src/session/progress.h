/* Progress of a call that runs trials: the host is called before each run and may cancel. */
#ifndef SPARI_PROGRESS_H
#define SPARI_PROGRESS_H

#include "../base/session.h"

typedef struct spari_progress {
    const char *call;
    spar_progress tell; /* callback at the entry of the call; may be NULL */
    void *context;
    int stopped; /* status of the call after it was cancelled; otherwise SPAR_OK */
} spari_progress;

spari_progress spari_progress_of(const spar_session *session, const char *call);
/* SPAR_OK, or SPAR_ERR_LIMIT on all ranks if one of them cancels. No trial fails with this status, so nothing else
   is tried instead. Collective if there is a callback, otherwise nothing. */
int spari_progress_tell(spar_session *session, spari_progress *progress, double done, double expected);
/* The status of a cancelled call, otherwise `status`. */
int spari_progress_ends(const spari_progress *progress, int status);

#endif
