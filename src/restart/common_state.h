/* Data of a session that are common to all ranks, as in a file: ranks, names and descriptions of members and joints,
   clock, state of members and joints, coupling. Directories of the states of single ranks follow, rank by rank (save.c,
   load.c). */
#ifndef SPARI_COMMON_STATE_H
#define SPARI_COMMON_STATE_H

#include "../base/saved_file.h"
#include "../base/session.h"

typedef struct spari_coupling spari_coupling; /* coupling/coupling.h */

/* Whether the session can be saved or loaded now. Local. */
int spari_saved_check_call(const spar_session *session, const char *call, const char *path);
int spari_saved_broken(const spar_session *session);
int spari_saved_no_memory(const spar_session *session);

void spari_saved_put(spari_image *image, spar_session *session);

/* A directory: of each state its kind, the number of the member or assembly and that of words, of a fluid also the name
   and the head (fluid/fluid.h). The kind SPARI_SAVED_END ends it. */
enum { SPARI_SAVED_MEMBER, SPARI_SAVED_ASSEMBLY, SPARI_SAVED_FLUID, SPARI_SAVED_END };

typedef struct spari_saved {
    spari_image image;        /* all words, with the directories */
    int64_t clock;            /* position of the clock */
    int phase;                /* phase of the step */
    int ranks;                /* of the saved run */
    spari_coupling *coupling; /* created from the image; NULL: none that fits */
} spari_saved;

/* Checks that it belongs to this session and is valid; image.at: its end, where the directories begin. Local. */
int spari_saved_check(spar_session *session, spari_saved *saved);
/* Loads it after the check. Local. */
void spari_saved_load(spar_session *session, spari_saved *saved);
void spari_saved_free(spari_saved *saved);

#endif
