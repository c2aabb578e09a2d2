/* Results of a trial run: data of the session at evenly spaced times, for any number of steps, and its cost. */
#ifndef SPARI_RUN_RECORD_H
#define SPARI_RUN_RECORD_H

#include "../exchange/session_private.h"

/* Numbers of the host's own, at most. */
enum { SPARI_MOST_NUMBERS = 32 };
/* Number of times at which runs are compared; between steps, cubic interpolation. */
enum { SPARI_SAMPLES = 128 };
/* Blocks of a sample. Goals are in the order of SPAR_GOAL_*. */
enum {
    SPARI_OF_MOTION,   /* displacements of positions along the members */
    SPARI_OF_REACTION, /* [members][6], moments divided by the member's length */
    SPARI_OF_SECTION,  /* [beams with sections][PLACES][6], likewise */
    SPARI_OF_LOAD,     /* [members][6]: sum and moment of the fluid's loads, likewise */
    SPARI_OF_NUMBERS,  /* of the host's */
    SPARI_OF_JOINT,    /* [joints][6]: part of the reactions, if these are a goal */
    SPARI_OF_BEYOND,   /* displacements relative to the root's motion, or for a free member since the beginning */
    SPARI_BLOCKS
};
#define SPARI_GOAL(block) (1 << (block))

enum { SPARI_LOADS = 9 }; /* times at which the fluid's loads are compared: the end of the first step, and 8 more */

typedef struct spari_record {
    int64_t steps, steps_done, stations; /* of the run, and completed; positions of all members */
    int64_t first[SPARI_BLOCKS + 1];     /* begin of a block in a sample, and size of a sample */
    int goals, members;                  /* blocks recorded beside the motion */
    double *value;                       /* [SPARI_SAMPLES][first[SPARI_BLOCKS]] */
    double *recent;                      /* [4][the same], of the last steps */
    const double *numbers;               /* [SPARI_MOST_NUMBERS] of the host, in the trial; read at each step */
    double *start, *workspace;           /* initial displacements; workspace for reactions */
    double *basis;                       /* [stations][SPARI_MAX_NODES] for the positions along beams */
    double *load;  /* [SPARI_LOADS][members][6]: fluid loads after the first step and at even times: their sum, and
                      moment divided by the length about the root's reference position */
    double *trail; /* [4][members][6] the same in the last three steps, and their second difference */
    double alternating[2]; /* square of the alternating part of the loads, in the second and in the last quarter of the
                              run, relative to the loads of both */
    double seconds;        /* processor time of the steps, all ranks */
    int64_t solutions;     /* calls of the fluid solver */
    double report[SPAR_REPORT_COUNT]; /* of the coupling, at the end */
    int asked;                        /* SPARI_MUTE_*: what the host has pulled and pushed */
    int own;                          /* this rank's own status of a failed run */
} spari_record;

/* Allocates for a run of `steps`, and records its beginning; goals: SPARI_GOAL or-ed. Free it also after a failure.
   Local. */
int spari_record_create(spar_session *session, int64_t steps, int goals, spari_record *record);
void spari_record_free(spari_record *record);
void spari_record_begin(spari_record *record, const spar_session *session);
/* Records the state after step i of 1 .. steps. SPAR_ERR_NUMERIC: it is not finite. Collective. */
int spari_record_look(spari_record *record, spar_session *session, int64_t i);
/* Sum of the fluids' loads on each member [members][6], and their moment divided by the length about the root's
   reference position. */
void spari_record_loads(const spar_session *session, double *load);

/* Root mean square of the difference relative to that of b; for the motion, relative to b's motion beyond its root. */
double spari_record_distance(const spari_record *a, const spari_record *b, int block);
double spari_record_load(const spari_record *a, const spari_record *b);
/* Largest of these errors over the goals, extrapolated to a run `longer` times as long by their growth from the
   second third to the last. */
double spari_record_error(const spari_record *a, const spari_record *b, int goals, double longer);
/* Largest root mean square, over the positions, of the motion relative to the root. */
double spari_record_reach(const spari_record *record);
/* Shortest period, as a fraction of the run's time, of motion larger than this fraction: 0: none. */
double spari_record_shortest(const spari_record *record, double part);
/* Whether the run covers a steady state or full periods. */
int spari_record_vouches(const spari_record *record);
/* Growth of its motion from the second third to the last. */
double spari_record_swells(const spari_record *record);

#endif
