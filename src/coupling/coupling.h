/* The coupling iteration of a session: stacked loads of all members, convergence test, accelerator, and the report
   of a run. */
#ifndef SPARI_COUPLING_H
#define SPARI_COUPLING_H

#include "explicit_stability.h"
#include "schemes.h"

#include <spar/spar_coupling.h>

typedef struct spari_coupling {
    int64_t n; /* six per node of every member */
    int members;
    int weighs;        /* iterated: loads are measured by the motion they cause */
    int estimates;     /* explicit: the effect of another iteration is estimated (option coupling.estimate) */
    int weighed;       /* the same in the last check: `image` is valid */
    int idle;          /* all loads of the step are zero so far: no fluid, or one at rest */
    double *length;    /* per member: moments are divided by it, rotations multiplied */
    double *unit;      /* per member: power of two closest to 1/length, which scales moments without rounding */
    double *x, *g;     /* iterated: loads used and returned, stacked, moments times unit */
    double *shift;     /* motion norm, with an added mass: contribution of the added mass to x and g; or NULL */
    double *image;     /* motion norm: [2 n + members + 1] motion due to g - x and to g - shift, stacked; and room
                          (motion_norm.h) */
    double *workspace; /* motion norm: loads of one member */
    double *settled;   /* motion norm, with columns: [2 n + 1] residual relative to the settled fluid, and its image */
    double *predicted; /* iterated: predicted loads of the step, unscaled */
    double *motion;    /* motion test: positions and quaternions [7] of the iteration before */
    double *before; /* motion norm, with columns: [n / 6][7] positions and quaternions, or velocities, of the iteration
                       before that was not converged */
    double *path;   /* [n] motion since then, stacked as image */
    double *axes;   /* [n / 6][4] of the sections */
    spari_accelerator *accelerator; /* iterated */

    int iterations, most;    /* of the current or the last step; capacity of the next two */
    double *residual, *size; /* change of the loads, and the loads, [N], by iteration */
    double moved, travelled; /* motion test: change of the motion in the iteration, and since t^n, [m] */
    double report[SPAR_REPORT_COUNT];
    double defect;              /* of the last accepted step */
    int grown;                  /* consecutive steps in which it has grown */
    int warned, steps_unwarned; /* a warning was given; steps since the last reason for one */
    double *missed;             /* pushed minus predicted loads of the last step with one evaluation of the fluid, */
    double *missing;            /* and of the step in progress */
    int was_explicit;           /* the last accepted step was one of them */
    spari_explicit_stability stability; /* of accepted steps with one evaluation of the fluid */
    int unconverged, in_row;            /* the current step is accepted unconverged; number of such steps before it */
} spari_coupling;

/* Allocates for the present settings but this scheme. static_solution: for a solution that is not a step, in the load
   norm. Local. */
int spari_coupling_create(spar_session *session, int scheme, int static_solution, spari_coupling **coupling);
/* The same for the session, replacing the existing one. */
int spari_coupling_prepare(spar_session *session);
/* Replace the session's coupling by a temporary one for a solution that is not a step, and end it. Collective; on
   failure nothing has changed. If the solution was found, the steps begin anew. If not, they continue with their own
   coupling, and the reported last iteration is that of the solution. */
int spari_coupling_suspend(spar_session *session, int scheme);
void spari_coupling_keep(spar_session *session);
void spari_coupling_resume(spar_session *session);
/* Whether the next check uses the motion norm, as far as is known in advance. */
int spari_coupling_weighs(const spar_session *session);
/* Whether the session's coupling fits the present settings and members. Local, the same on every rank. */
int spari_coupling_fits(const spar_session *session);
void spari_coupling_free(spari_coupling **coupling);
void spari_coupling_begin(spar_session *session);
/* After the loads have been exchanged: whether they agree with those used, to the tolerances; and the next loads, if
   the scheme iterates. SPAR_ERR_NUMERIC: they are not finite. */
int spari_coupling_compare(spar_session *session, int *agreed);
int spari_coupling_next(spar_session *session);
/* Both, as a step needs it: done if they agree, or if the step goes on with the present loads. */
int spari_coupling_check(spar_session *session, const char *call, int *done);
/* Explains a failed structural solution if the loads have grown from iteration to iteration. Returns status. */
int spari_coupling_solve_failed(spar_session *session, const char *call, int status);
/* Whether reused tangents have predicted the motion too badly for the coupling. */
int spari_coupling_renews_tangents(const spar_session *session);
/* Whether the last check found loads far from those used, so that their effects in a step give no information. */
int spari_coupling_is_rough(const spar_session *session);
/* Before the histories shift. */
void spari_coupling_accept(spar_session *session);
/* The equations of motion have changed: discards differences of earlier steps. */
void spari_coupling_forget(spar_session *session);
void spari_coupling_reject(spar_session *session);

/* Whether the motion is tested too, which needs the motion of the iteration before. */
int spari_coupling_wants_motion(const spar_session *session);

#endif
