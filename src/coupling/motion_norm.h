/* Norms of the coupling: loads measured by the motion that they cause, or by themselves. */
#ifndef SPARI_MOTION_NORM_H
#define SPARI_MOTION_NORM_H

#include "../assembly/assembly.h"
#include "../exchange/session_private.h"

#include <stdint.h>

/* Stacked loads of all members, moments times `unit` of the member. */
typedef struct spari_norm_loads {
    int64_t n;
    const double *unit;  /* per member, in order */
    const double *x, *g; /* [n] used, and returned */
    const double *shift; /* [n] contribution of an added mass to g; NULL: none */
    double *image;     /* [2 n + members + 1] out: motion due to g - x, and to g - shift; room for the ranks' status */
    double *workspace; /* 6 per node of the largest member */
    spari_response_of of; /* what the loads move */
} spari_norm_loads;

/* Whether the motion norm is possible (the library knows the flexibility of all members with fluids) and wanted
   (coupling.norm). */
int spari_motion_norm_is_used(const spar_session *session);
/* Fills w->image, and the sizes of g - x and of the loads in this norm. All ranks; the owners' results go to the
   others. *ok: whether it is a norm: finite, nonnegative squares. */
int spari_motion_norm(spar_session *session, const spari_norm_loads *w, double *residual, double *size, int *ok);

/* image [count][n], with room for one more := motions due to `count` loads [count][n], stacked as w->x; uses n, unit
   and workspace of w. All ranks. */
int spari_motion_norm_images(spar_session *session, const spari_norm_loads *w, int64_t count, const double *loads,
                             double *image);
/* Adds to image [n] of loads [n] what the norm counts of loads that constraints carry. After spari_motion_norm, whose
   w->image has it. */
void spari_motion_norm_add_carried(const spar_session *session, const spari_norm_loads *w, const double *loads,
                                   double *image);

/* Removes from x [n], stacked as w->g, the part of x - g that moves nothing: this part becomes that of the returned
   loads. Returns a status. All ranks; a message is sent only if an owner must be asked (spari_fidelity's
   effective_here). room [n + 1]. */
int spari_motion_norm_effective_load(spar_session *session, const spari_norm_loads *w, double *workspace, double *x);

/* Explicit coupling: displacement of the farthest node, m, if the pushed loads replaced the predicted ones, as
   another iteration would do. 0 for members that the library does not solve; infinite if the matrix is singular. n:
   6 per node of all members; image [n + 1]: workspace, and the ranks' status; room: 6 per node of the largest
   member. All ranks. */
int spari_motion_norm_miss(spar_session *session, int64_t n, double *image, double *workspace, double *farthest);

#endif
