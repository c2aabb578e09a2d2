/* The parts of the small-motion equations: members side by side, each with its unknowns. */
#ifndef SPARI_MOTION_PARTS_H
#define SPARI_MOTION_PARTS_H

#include "../algebra/pencil.h"
#include "../member/structure.h"

typedef struct spari_motion_part {
    const spar_member *member;
    int at, size;  /* position and number of its unknowns */
    double own[3]; /* its angular velocity */
} spari_motion_part;

typedef struct spari_small_motions {
    spar_session *session;
    spari_motion_part *
        part; /* in the order of creation, so that the result does not depend on the member for which it is requested */
    int parts, size;
    double w[3]; /* angular velocity of the frame */
    int loose;   /* for shapes alone: each part has a frame of its own; time-dependent terms are ignored */
    int modes;   /* symmetric stiffness and mass alone */
    int alone;   /* without joints */
    double cap;  /* of exact beams, see spari_small_motions_cap */
    spari_pencil pencil;
    double *workspace; /* of a shape */
} spari_small_motions;

/* The part of a member, or NULL. */
static inline const spari_motion_part *spari_small_motions_part(const spari_small_motions *motions,
                                                                const spar_member *member) {
    for (int i = 0; i < motions->parts && member; i++) {
        if (motions->part[i].member == member) {
            return motions->part + i;
        }
    }
    return NULL;
}

#endif
