/* Response of the fluid to small motions of the structure, found by trials: members move along shapes as prescribed
   functions of time, nothing is solved, and the host's solver computes the loads. */
#ifndef SPARI_FLUID_RESPONSE_H
#define SPARI_FLUID_RESPONSE_H

#include "../trial/trial.h"
#include "small_motions.h"

/* Steps of a pulse: a bell of 1.25 steps, of which 8 to either side cover double precision, so at most 1e-13 of its
   spectrum is beyond the sampling limit. Then two steps at rest, because a host may difference over two steps. */
enum { SPARI_PULSE = 22, SPARI_PULSE_MIDDLE = 9 };

typedef struct spari_response_query {
    const spari_small_motions *motions;
    spari_run run;    /* dt, callbacks, progress */
    int64_t memory;   /* steps of dt for which loads last after the motion has ended; 0: none */
    double amplitude; /* relative to the member's length for displacements; rad for rotations */
    int modes;
    int64_t nodes;       /* of all members */
    const double *shape; /* [modes][nodes][6] */
    const double *rate;  /* [modes] typical rate of its motion, 1/s, > 0 */
} spari_response_query;

/* Loads [modes][modes] on shape i (row) due to a unit of motion along shape j. */
typedef struct spari_fluid_response {
    int64_t count; /* without memory 3: of displacement, velocity and acceleration; otherwise samples at the ends of
                      steps */
    double *load;  /* [count][modes][modes] */
    double x[SPARI_PULSE], v[SPARI_PULSE], a[SPARI_PULSE]; /* the pulse at the ends of its steps */
} spari_fluid_response;

/* Finds the response about the present state, and restores the session; a status and a message. Free the result in
   any case. SPAR_ERR_STATE: the fluid's loads there are not those in use. Collective. */
int spari_fluid_response_find(spar_session *session, const char *call, const spari_response_query *ask,
                              spari_fluid_response *response);
void spari_fluid_response_free(spari_fluid_response *response);

#endif
