/* The coupling iteration of a session: the loads of all members stacked into one vector, the stop test, the
   accelerator, and what a run shows of its coupling. */
#ifndef SPARI_COUPLING_H
#define SPARI_COUPLING_H

#include "schemes.h"

#include <spar/spar.h>

typedef struct spari_coupling {
    int64_t n; /* six for every node of every member */
    int members;
    int weighs;        /* iterated: loads are weighed by the motion they cause */
    int estimates;     /* explicit: what another iteration would move is told (option coupling.estimate) */
    int weighed;       /* and were in the last check: `image` holds */
    double *length;    /* of each member: moments count as moment over length, turns as turn times length */
    double *unit;      /* of each member: the power of two next to 1/length, which scales moments without rounding */
    double *x, *g;     /* iterated: loads used and come back, stacked, moments times unit */
    double *shift;     /* weighing motion, with an added mass: what x and g have beyond the loads, likewise; or NULL */
    double *image;     /* weighing motion: [2 n + 1], what g - x and g move, stacked; with a shift [3 n + 1], the loads
                          themselves behind; and room for the ranks' status */
    double *room;      /* likewise: loads of one member */
    double *settled;   /* weighing motion, with columns: [2 n + 1], the residual against the settled fluid, its image */
    double *predicted; /* iterated: loads the step began with, as they are */
    double *motion;    /* motion test: places and quaternions [7] of the iteration before */
    spari_accelerator *accelerator; /* iterated */

    int iterations, most;    /* of the step under way or the last one; room of the next two */
    double *residual, *size; /* change of the loads and the loads, [N], by iteration */
    double moved, travelled; /* motion test: change of the motion in the iteration, and since t^n, [m] */
    double report[SPAR_REPORT_COUNT];
    double defect;                  /* of the last accepted step */
    int grown;                      /* steps in which it has grown without a break */
    int warned, calm;               /* has been told; steps since there was anything to tell */
    double *missed;                 /* explicit: loads pushed less predicted ones, in the last step */
    int turns;                      /* steps on end in which that has grown and turned about */
    double log_growth, log_growth2; /* sums of the logarithms of its growth, and of their squares */
    int unconverged, in_row; /* the step under way is accepted though it has not converged; and those before it */
} spari_coupling;

/* Memory for the settings in force but for the scheme. standing: for a solution that is no step, whose loads are
   weighed by themselves. Local. */
int spari_coupling_create(spar_session *session, int scheme, int standing, spari_coupling **coupling);
/* The same into the session; what there was goes. */
int spari_coupling_prepare(spar_session *session);
/* One for a solution that is no step takes the place of the session's, which waits. Collective; or all is as it was.
   The solution was found: the state has been set anew, and the steps begin anew with their coupling. Or it was not:
   they go on with what they had; what is told of the last iteration is that of this one. */
int spari_coupling_lay_aside(spar_session *session, int scheme);
void spari_coupling_keep(spar_session *session);
void spari_coupling_take_back(spar_session *session);
/* Whether the next check weighs loads by motion, as far as it is known before. */
int spari_coupling_weighs(const spar_session *session);
/* Whether the session's is of the settings in force and of the members there are now. Local, the same on every rank. */
int spari_coupling_fits(const spar_session *session);
void spari_coupling_free(spari_coupling **coupling);
void spari_coupling_begin(spar_session *session);
/* Of its acceleration, what Newton may leave in the next solution for the coupling's sake; infinite: all. */
double spari_coupling_share(const spar_session *session);
/* After the loads have been exchanged: whether they agree with those used, as the tolerances have it; and the next
   loads to use, of a scheme that iterates. SPAR_ERR_NUMERIC: they are beyond numbers. */
int spari_coupling_compare(spar_session *session, int *agreed);
int spari_coupling_next(spar_session *session);
/* Both, as a step wants it: done where they agree, or where it goes on with what there is. */
int spari_coupling_check(spar_session *session, const char *call, int *done);
/* The structure could not be solved with the loads: says so where these have grown from iteration to iteration.
   Returns status. */
int spari_coupling_solve_failed(spar_session *session, const char *call, int status);
/* Whether the last check has found loads that are far from those used: what they do in a step tells nothing. */
int spari_coupling_is_rough(const spar_session *session);
/* Before the histories shift. */
void spari_coupling_accept(spar_session *session);
/* What the equations of motion are has changed: differences of earlier steps say nothing of the next ones. */
void spari_coupling_forget(spar_session *session);
void spari_coupling_reject(spar_session *session);

/* Whether the motion is looked at too, for which it is kept. */
int spari_coupling_wants_motion(const spar_session *session);

#endif
