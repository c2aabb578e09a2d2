/* Small motions about the present state, of what joints tie together or of all that a session solves for: the equations
   of the parts side by side, and the joints between them. */
#ifndef SPARI_SWING_H
#define SPARI_SWING_H

#include "../member/joint.h"
#include "../algebra/pencil.h"

typedef struct swing_part {
    const spar_member *member;
    int at, size;  /* its unknowns among all */
    double own[3]; /* its angular velocity */
} swing_part;

typedef struct spari_swing {
    spar_session *session;
    swing_part *part; /* in the order of creation, so that the answer is the same whichever member is asked */
    int parts, size;
    double w[3]; /* the frame's angular velocity */
    int loose;   /* for shapes alone: each part is seen from a frame of its own, whatever changes with time */
    spari_pencil pencil;
    double *room; /* of a shape */
} spari_swing;

/* The parts: of a member, and all that joints tie to it; first NULL: all that spar solves for. Then their equations, in
   the frame where these do not change with time. A status and a message; free it whatever that is. */
int spari_swing_create(spari_swing *swing, spar_session *session, const spar_member *first);
/* The same of all that spar solves for, for shapes alone: in any state, also one that does not stay. */
int spari_swing_create_loose(spari_swing *swing, spar_session *session);
void spari_swing_free(spari_swing *swing);
/* The part that a member is, or NULL. */
static inline const swing_part *spari_swing_part(const spari_swing *swing, const spar_member *member) {
    for (int i = 0; i < swing->parts && member; i++) {
        if (swing->part[i].member == member) {
            return swing->part + i;
        }
    }
    return NULL;
}
/* The n eigenvalues nearest to the shift (see pencil.h), and x [n][size], of unit x^H M x; a status and a message. */
int spari_swing_solve(spari_swing *swing, int n, double complex shift, double complex *value, double complex *x);
/* A vector x of all unknowns as the motion of a member's nodes [nodes][6][2]. */
void spari_swing_shape(const spari_swing *swing, const swing_part *part, const double complex *x, double *nodes);

/* The entries of a joint, once those of the parts are there; SPAR_ERR_UNSUPPORTED: they change with time in this frame.
 *holds: how many rows of G there are. */
int spari_swing_add_joint(spari_swing *swing, const spar_joint *joint, int *holds);

#endif
