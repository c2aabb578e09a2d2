/* The fluid's added mass as the iterations of the coupling show it, in the form of the guess that a host gives
   (added_mass.h): of each difference of two iterations of a step, the loads that came back against the accelerations that
   they answer to. See docs/theory.md, "Known added mass". Every rank that has the motion and the loads of a member
   learns the same. */
#ifndef SPARI_LEARNED_H
#define SPARI_LEARNED_H

#include "added_mass.h"

enum { SPARI_LEARNED_STATIONS = 20 }; /* at most */

/* After spari_added_create: room for what is learned on the nodes that there are, and what has been learned into
   m->added. A status without a message. */
int spari_learned_create(spar_member *m);
void spari_learned_free(spari_learned *learned);
/* What is learned is shared with what the member was made anew as, which measured it by its own nodes: again by those
   of m. */
void spari_learned_take_back(const spar_member *m);

/* A step begins or is given up: its differences are forgotten. */
void spari_learned_begin(spar_member *m);
/* load_pushed, as the fluids gave it, answers to the motion after: the check number `iteration` of the step, from 1. */
void spari_learned_note(spar_member *m, int iteration);
/* The step is accepted. Returns whether another mass is to stand in the equations: spari_learned_put. */
int spari_learned_accept(spar_member *m);
void spari_learned_put(spar_member *m);

/* What is kept, as `count` doubles that are written and read in place; and of the step under way. */
double *spari_learned_state(const spar_member *m, int64_t *count);
double *spari_learned_last(const spar_member *m, int64_t *count);
/* What of the description it is, into a hash. */
uint64_t spari_learned_hash(const spar_member *m, uint64_t hash);

#endif
