/* Accelerations as fluids see them where a step has several substeps, and from the first step of another length on: the
   mean over the step, carried on to its end by the mean before, (T15) of docs/theory.md. Loads are linear between the
   ends of a step; under them, in substeps and in the stages of TR-BDF2, a mode of the structure that the step does not
   resolve ends with an acceleration of the wrong sign, and an added mass that answered to that would feed it. A member
   with an added mass in its equations has that in every stage and needs none of this; one that is to learn it does
   until it is known. */
#ifndef SPARI_MEANS_H
#define SPARI_MEANS_H

#include "structure.h"

struct spari_means {
    double *mean;    /* [nodes][6] over the step that led to t^n */
    double *seen[2]; /* [nodes][6] at t^n and of the motion after */
    double dt;       /* of that step */
    int has[2];      /* whether these are there; else fluids see the motion's own */
};

/* Makes room where there is none and fluids may need it; a status and a message. Local. */
int spari_means_make(spar_member *member);
/* The same where the session takes substeps, or has taken steps of several lengths. */
int spari_means_keep(spar_member *member);
void spari_means_free(spari_means *means);
/* What fluids see at t^n (0) and of the motion after (1): [nodes][6]. */
const double *spari_means_seen(const spar_member *member, int after);
/* The motion after has been found; the step is accepted, or given up; the motion now has been set anew. */
void spari_means_find(spar_member *member);
void spari_means_accept(spar_member *member);
void spari_means_reject(spar_member *member);
void spari_means_forget(spar_member *member);
/* To a member made anew. */
void spari_means_carry(const spar_member *from, spar_member *member);

#endif
