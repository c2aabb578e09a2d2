/* Identifies the fluid's added mass from coupling iterations, in the form that a host can give (added_mass.h). Each
   difference of two iterations of a step compares the change of the loads with the change of the accelerations. See
   docs/explanation/theory.md, "Known added mass". Every rank that has the motion and the loads of a member finds the
   same mass. */
#ifndef SPARI_ADDED_MASS_FIT_H
#define SPARI_ADDED_MASS_FIT_H

#include "added_mass.h"

enum { SPARI_LEARNED_STATIONS = 20 }; /* maximum number of stations */

/* After spari_added_create: allocates for the present nodes, and puts the mass known so far into m->added. Returns a
   status without a message. */
int spari_learned_create(spar_member *m);
void spari_learned_free(spari_learned *learned);
/* After a trial: the fit is shared with the rebuilt member, which measured with its own nodes; restores the metric
   of m's nodes. */
void spari_learned_take_back(const spar_member *m);

/* Begins or rejects a step: discards its differences. */
void spari_learned_begin(spar_member *m);
/* Records load.pushed, from the fluids, as the response to the motion `after`. `iteration`: number of the check in
   the step, from 1. */
void spari_learned_note(spar_member *m, int iteration);
/* Accepts a step. Returns whether the mass in the equations must change (spari_learned_put). */
int spari_learned_accept(spar_member *m);
void spari_learned_put(spar_member *m);

/* State as `count` doubles, to be read and written in place; and the data of the current step. */
double *spari_learned_state(const spar_member *m, int64_t *count);
double *spari_learned_last(const spar_member *m, int64_t *count);
/* Adds the description to a part. */
void spari_learned_part(const spar_member *m, spari_described *part);

#endif
