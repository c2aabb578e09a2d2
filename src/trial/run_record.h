/* What a trial run leaves behind: figures of the scene at times evenly spread over it, whatever its steps, and what it
   cost. */
#ifndef SPARI_RECORD_H
#define SPARI_RECORD_H

#include "../exchange/session_private.h"

/* Runs are compared at so many times; what lies between ends of steps is interpolated by cubics. */
enum { SPARI_SAMPLES = 128 };
/* Parts of a sample. Those that are goals in the order of SPAR_GOAL_*. */
enum {
    SPARI_OF_MOTION,   /* displacements of places along the members */
    SPARI_OF_REACTION, /* [members][6], moments by the member's length */
    SPARI_OF_SECTION,  /* [beams with sections][PLACES][6], likewise */
    SPARI_OF_LOAD,     /* [members][6]: sum and moment of the fluid's loads, likewise */
    SPARI_OF_NUMBERS,  /* of the host's */
    SPARI_OF_JOINT,    /* [joints][6]: a part of the reactions, where these are a goal */
    SPARI_OF_BEYOND,   /* displacements beyond what moves with the root, or, where nothing holds it, since the begin */
    SPARI_BLOCKS
};
#define SPARI_GOAL(block) (1 << (block))

enum { SPARI_LOADS = 9 }; /* times at which those of the fluid are compared: the first step's end, and 8 */

struct spari_record {
    int64_t steps, taken, stations;  /* of the run, and so many it came to; places looked at, all members */
    int64_t first[SPARI_BLOCKS + 1]; /* where a block begins in a sample, and what a sample has */
    int goals, members;              /* blocks that are looked at, beside the motion */
    double *value;                   /* [SPARI_SAMPLES][first[SPARI_BLOCKS]] */
    double *recent;                  /* [4][the same], of the last steps */
    double *start, *room;            /* displacements at the beginning; work for reactions */
    double *basis;                   /* [stations][SPARI_MAX_NODES] of the places along beams */
    double *load; /* [SPARI_LOADS][members][6]: fluid loads after the first step and at even times, their sum and moment
                     by the length about the root's reference place */
    double *trail;         /* [4][members][6] the same of the last three steps, and their second difference */
    double alternating[2]; /* part of the loads that turns round from step to step, squared, in the second and in the
                              last quarter of the run, relative to the loads of both */
    double seconds;        /* processor time of the steps, all ranks */
    double fluid_seconds;  /* of timed runs: of that, the fluid's */
    double work;           /* what the steps cost without the fluid, and what a solution of the fluid may cost by its */
    double fluid;          /* nodes, counted (cost.h); all ranks */
    int64_t solutions;     /* calls of the fluid solver */
    int dear;              /* the run has ended because of what it cost, */
    double off;            /* or of its error, which would have come to about so much; 0: it has not */
    double *member_work;   /* [members] of the work, what solving for each took; this rank's, then all ranks' */
    double report[SPAR_REPORT_COUNT]; /* of the coupling, at the end */
    int asked;                        /* SPARI_MUTE_*: what the host has pulled and pushed */
    int own;                          /* what this rank answers for a run that failed */
};

/* Memory for a run of so many steps, and its beginning looked at; goals: SPARI_GOAL or-ed. To be freed also after a
   failure. Local. */
int spari_record_create(spar_session *session, int64_t steps, int goals, spari_record *record);
void spari_record_free(spari_record *record);
void spari_record_begin(spari_record *record, const spar_session *session);
/* Looks at the state after step i of 1 .. steps. SPAR_ERR_NUMERIC: it is not finite. Collective. */
int spari_record_look(spari_record *record, spar_session *session, int64_t i);
/* Sum of the fluids' loads on each member [members][6], and their moment by the length about the root's reference
 * place.
 */
void spari_record_loads(const spar_session *session, double *load);

/* Root of the mean square of the difference over that of b's; of the motion: over b's beyond its root. */
double spari_record_distance(const spari_record *a, const spari_record *b, int block);
double spari_record_load(const spari_record *a, const spari_record *b);
/* The largest of those of the goals, over a run that is `longer` times theirs, if they go on growing as they
   do from the second third of it to the last. */
double spari_record_error(const spari_record *a, const spari_record *b, int goals, double longer);
/* What the error of a run that has come to step i will be at least, whatever follows. */
double spari_record_least_error(const spari_record *a, const spari_record *b, int goals, int64_t i);
/* The finer run goes on towards where the two of them point: by so much of their difference. */
void spari_record_extrapolate(spari_record *finer, const spari_record *coarser, double part);
/* Numbers that its samples are. */
int64_t spari_record_size(const spari_record *record);
/* What the motion beyond its root of one of the session's members is of all such motion. */
double spari_record_bend(const spari_record *record, const spar_session *session, const spar_member *member);
/* How far the motion beyond the root goes, the largest root of the mean square over places. */
double spari_record_reach(const spari_record *record);
/* The shortest period, as a part of the run's time, of what moves by more than this part of the motion: 0: nothing. */
double spari_record_shortest(const spari_record *record, double part);
/* Whether the run shows what goes on after it: its motion has settled, or turned as often as a period does. */
int spari_record_vouches(const spari_record *record);
/* How much larger its motion is in the last third than in the one before. */
double spari_record_swells(const spari_record *record);

#endif
