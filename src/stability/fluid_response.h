/* The fluid's answer to small motions of the structure, found by trials: the members are moved along shapes by a given
   law of time, nothing is solved, and the loads are what the host's solver makes of it. */
#ifndef SPARI_ANSWER_H
#define SPARI_ANSWER_H

#include "small_motions.h"
#include "../trial/trial.h"

/* A pulse of so many steps: a bell of 1.25 steps, 8 of which to either side are all that doubles see of it; its samples
   have then no more than 1e-13 of frequencies that they cannot show. Behind it the motion has been at rest for the two
   steps that a host may difference over. */
enum { SPARI_PULSE = 22, SPARI_PULSE_MIDDLE = 9 };

typedef struct spari_answer_ask {
    const spari_swing *swing;
    spari_run run;    /* dt, before, solve, context, progress */
    int64_t memory;   /* steps of dt that loads last for after the motion has ended; 0: none */
    double amplitude; /* of a node's displacement by its member's length, and of its turn */
    int modes;
    int64_t nodes;       /* of all members */
    const double *shape; /* [modes][nodes][6] */
    const double *rate;  /* [modes] a rate of its motion, 1/s, > 0 */
} spari_answer_ask;

/* Loads [modes][modes] on shape i (row) by a unit of motion along shape j. */
typedef struct spari_answer {
    int64_t count; /* memory 0: 3, of displacement, velocity and acceleration; else the samples at the ends of steps */
    double *load;  /* [count][modes][modes] */
    double x[SPARI_PULSE], v[SPARI_PULSE], a[SPARI_PULSE]; /* the pulse at the ends of its steps */
} spari_answer;

/* Finds it about the present state, to which the session is back; a status and a message. Free the answer whatever that
   is. SPAR_ERR_STATE: the fluid's loads there are not those in use. Collective. */
int spari_answer_find(spar_session *session, const char *call, const spari_answer_ask *ask, spari_answer *answer);
void spari_answer_free(spari_answer *answer);

#endif
