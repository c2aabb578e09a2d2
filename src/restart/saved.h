/* What of a session is alike on every rank, as it is in a file: ranks, names and descriptions of members and joints,
   the clock, the state of members and joints, the coupling. Behind it there is what is one rank's own, rank by rank
   (save.c, load.c). */
#ifndef SPARI_SAVED_H
#define SPARI_SAVED_H

#include "../base/saved_file.h"
#include "../base/session.h"

typedef struct spari_coupling spari_coupling; /* coupling.h */

/* Whether there is anything to save, or to load into. Local. */
int spari_saved_check_call(const spar_session *session, const char *call, const char *path);
int spari_saved_broken(const spar_session *session);
int spari_saved_no_memory(const spar_session *session);

void spari_saved_put(spari_image *image, spar_session *session);

typedef struct spari_saved {
    spari_image image;        /* that it is read from, from the first word; no words behind it need be there */
    int64_t clock;            /* where the clock begins */
    int phase;                /* where the step stood */
    int ranks;                /* of the saved run */
    spari_coupling *coupling; /* made from the image; NULL: none that fits */
} spari_saved;

/* Whether it is of this session, and can be taken; image.at: where it ends. Again after a failure. Local. */
int spari_saved_check(spar_session *session, spari_saved *saved);
/* Takes it, after that. Local. */
void spari_saved_load(spar_session *session, spari_saved *saved);
void spari_saved_free(spari_saved *saved);

#endif
