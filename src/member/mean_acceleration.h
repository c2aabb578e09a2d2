/* Accelerations for fluids in steps with several substeps, and after the first change of dt: the mean over the step,
   extrapolated to its end with the mean before, (T15) of docs/explanation/theory.md.
   Loads are linear over a step. In substeps and stages of TR-BDF2, a mode that the step does not resolve then ends
     with an acceleration of the wrong sign, and an added mass that responds to it would amplify the mode. A member
     with an added mass in its equations has it in every stage and does not need this. A member that learns its added
     mass needs it until the mass is known. */
#ifndef SPARI_MEAN_ACCELERATION_H
#define SPARI_MEAN_ACCELERATION_H

#include "structure.h"

struct spari_means {
    double *mean;    /* [nodes][6] over the step that ended at t^n */
    double *seen[2]; /* [nodes][6] at t^n and of the motion `after` */
    double dt;       /* of that step */
    int has[2];      /* whether these exist; otherwise fluids get the accelerations of the motion */
};

/* Allocates if needed; a status and a message. Local. */
int spari_means_make(spar_member *member);
/* The same, if the session uses substeps or has changed dt. */
int spari_means_keep(spar_member *member);
void spari_means_free(spari_means *means);
/* Accelerations for fluids at t^n (0) and of the motion `after` (1): [nodes][6]. */
const double *spari_means_seen(const spar_member *member, int after);
/* The acceleration that comes with a change of velocity of 1 for fluids that see means; 0: they see those of the
   motion. Local, the same on every rank. */
double spari_means_rate(const spar_session *session);
/* Events: the motion `after` is computed; the step is accepted, or rejected; the motion `now` was set. */
void spari_means_find(spar_member *member);
void spari_means_accept(spar_member *member);
void spari_means_reject(spar_member *member);
void spari_means_forget(spar_member *member);
/* Copies to a rebuilt member. */
void spari_means_carry(const spar_member *from, spar_member *member);

#endif
