/* Small-motion equations about the present state, for connected members or for everything that a session solves: the
   equations of the parts side by side, and the joints between them. */
#ifndef SPARI_SMALL_MOTIONS_H
#define SPARI_SMALL_MOTIONS_H

#include "../algebra/pencil.h"
#include "../member/joint.h"

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
    spari_pencil pencil;
    double *workspace; /* of a shape */
} spari_small_motions;

/* SPAR_ERR_UNSUPPORTED if spar does not know the member's mass. */
int spari_need_mass(const spar_member *member);
/* Collects the parts: a member and everything that joints connect to it; first NULL: everything that spar solves.
   Then forms their equations, in a frame where the coefficients are constant. A status and a message; free it in any
   case. */
int spari_small_motions_create(spari_small_motions *motions, spar_session *session, const spar_member *first);
/* The same for everything that spar solves, for shapes alone: in any state, also an unsteady one. */
int spari_small_motions_create_loose(spari_small_motions *motions, spar_session *session);
/* The same for modes: the symmetric parts of stiffness and mass, in any state. connected: with all that joints connect
   to the member; otherwise without joints. */
int spari_small_motions_create_modes(spari_small_motions *motions, const spar_member *first, int connected);
void spari_small_motions_free(spari_small_motions *motions);
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
/* The n eigenvalues nearest to the shift (see pencil.h), and x [n][size], with unit x^H M x; a status and a message. */
int spari_small_motions_solve(spari_small_motions *motions, int n, double complex shift, double complex *value,
                              double complex *x);
/* Converts a vector x of all unknowns to the motion of a member's nodes [nodes][6][2]. */
void spari_small_motions_shape(const spari_small_motions *motions, const spari_motion_part *part,
                               const double complex *x, double *nodes);

/* Adds the entries of a joint, after those of the parts; SPAR_ERR_UNSUPPORTED: they depend on time in this frame.
   constraints: number of rows of G. */
int spari_small_motions_add_joint(spari_small_motions *motions, const spar_joint *joint, int *constraints);

#endif
