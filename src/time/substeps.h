/* The substeps of a step: their rule, generalised-alpha or TR-BDF2, and their halving where one has no solution. */
#ifndef SPARI_SUBSTEPS_H
#define SPARI_SUBSTEPS_H

#include "scheme.h"

/* The operations of a member, or of an assembly, in a substep. self: its data. */
typedef struct spari_stepper {
    /* The end of the last substep becomes the beginning of the next one. */
    void (*enter)(void *self, const spari_part *part);
    /* The largest mean angular velocity of stiff members that rotate freely; NULL: there are none. */
    double (*rotation_rate)(const void *self);
    /* Solves a stage. Returns a status, with a message. */
    int (*solve)(void *self, const spari_scheme *c, const spari_part *part);
    /* Ends the substep. Returns a status, with a message. */
    int (*finish)(void *self, const spari_scheme *c, const spari_part *part);
    /* Whether the solution has more energy than the state before it and the work of the loads account for. NULL:
       substeps are not halved. */
    int (*gains)(void *self, const spari_part *part);
    /* Its name, for messages. */
    void (*name)(const void *self, char *text, int size);
} spari_stepper;

/* Part of the energy that a substep may gain where its motion is hardly resolved; and where Newton has found it only
   with a new tangent in each iteration, which may lead to another solution; a tenth and ten times as much: theory.md,
   (E4). */
#define SPARI_GAIN 0.1
#define SPARI_GAIN_FAR 0.01

/* Advances from t^n to t^n + dt in the session's substeps. A substep is halved, down to 1/1024, if it has no
   solution or if its solution gains energy (Newton has found another equilibrium). *cuts keeps the halvings for the
   next calls of the step. alpha: the coefficients of a substep. *pattern: of the steps that led to t^n; becomes that
   of the steps to t^{n+1}. Returns a status of the stepper, with a message. */
int spari_substeps_run(const spari_stepper *how, void *self, const spari_scheme *alpha, spari_cuts *cuts,
                       spari_pattern *pattern, const spar_session *session, double dt);
/* Whether a member rotates so fast in steps dt that TR-BDF2, or nearly so, integrates it. The same on all ranks. */
int spari_substeps_rotate_fast(const spar_session *session, double dt);

#endif
