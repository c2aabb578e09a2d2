/* How much loads weigh: by the motion that the structure answers them with, or by themselves. */
#ifndef SPARI_WEIGH_H
#define SPARI_WEIGH_H

#include "../exchange/session_private.h"

#include <stdint.h>

/* What is weighed: stacked loads of all members, moments times `unit` of the member. */
typedef struct spari_weighed {
    int64_t n;
    const double *unit;  /* of each member, in order */
    const double *x, *g; /* [n] used, and come back */
    const double *shift; /* [n] what g has beyond the loads, where an added mass is in them; NULL: nothing */
    double *image; /* [2 n + 1] out: the motion that g - x calls for, and that of g; with a shift [3 n + 1], also that
                      of the loads; room for the ranks' status */
    double *room;  /* 6 of each node of the largest member */
} spari_weighed;

/* Whether the flexibility of all members that fluids act on is known to the library, and wanted (coupling.norm). */
int spari_weighs_motion(const spar_session *session);
/* Fills w->image, and the sizes of g - x and of the loads in that norm. All ranks: what an owner finds goes to the
   others. *ok: whether the norm is one: both are numbers, of squares that are not negative, and the flexibility is
   symmetric. */
int spari_weigh(spar_session *session, const spari_weighed *w, double *residual, double *size, int *ok);

/* image [count][n] with room for one more := the motions that `count` loads [count][n] call for, stacked as w->x, of
   which it takes n, unit and room. All ranks. */
int spari_weigh_images(spar_session *session, const spari_weighed *w, int64_t count, const double *loads,
                       double *image);

/* x [n], stacked as w->g, keeps of x - g what moves something: loads that move nothing are those that came back. A
   status. All ranks; a message only where an owner has to be asked (spari_fidelity's felt_here). room [n + 1]. */
int spari_weigh_felt(spar_session *session, const spari_weighed *w, double *room, double *x);

/* Explicit: how far the farthest node would be from where it is, m, under the loads pushed in place of those predicted:
   what another iteration would move. 0 of members that the library does not solve; infinite where the matrix is
   singular. n: 6 of each node of all members; image [n + 1]: room, and for the ranks' status; room: for 6
   of each node of the largest member. All ranks. */
int spari_weigh_miss(spar_session *session, int64_t n, double *image, double *room, double *farthest);

#endif
