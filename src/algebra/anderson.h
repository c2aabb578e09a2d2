/* Anderson acceleration of depth two (Walker & Ni, SIAM J. Numer. Anal. 49 (2011), 1715-1735) for the corrections of
   one Newton solution with a reused tangent.
   A reused tangent applies axial forces in directions that have rotated since. Longitudinal and transverse errors
     then couple: the largest eigenvalues of I - T^-1 K are pairs +-lambda. Two earlier corrections eliminate both.
   Nothing is kept between solutions. Results have the same bits for any number of lanes and threads. */
#ifndef SPARI_ANDERSON_H
#define SPARI_ANDERSON_H

#include "../base/thread_pool.h"

/* Unknowns of four nodes: at every vector width, lanes begin with the same component. */
enum { SPARI_MIXED_SUMS = 6, SPARI_MIXED_STRIPE = 24 };
static inline int64_t spari_mixed_unknowns(int64_t nodes) {
    return (6 * nodes + SPARI_MIXED_STRIPE - 1) / SPARI_MIXED_STRIPE * SPARI_MIXED_STRIPE;
}

typedef struct spari_anderson {
    int64_t unknowns;                  /* six per node, rounded up to whole stripes */
    int64_t seen;                      /* corrections so far */
    double *z, *c;                     /* last correction from the tangent, and as applied */
    double *d[2];                      /* of the last two pairs, newer first: the change of z */
    double *w[2];                      /* the change of z plus the correction applied in between */
    double weight[SPARI_MIXED_STRIPE]; /* of squares of displacements and rotations */
    double *workspace;                 /* memory of all arrays */
    double *sums;                      /* [spans][SPARI_MIXED_SUMS] */
} spari_anderson;

/* For a number of nodes. NULL: no memory. */
spari_anderson *spari_anderson_create(int64_t nodes);
void spari_anderson_free(spari_anderson *anderson);
/* Begins a solution, or continues with a new tangent. */
static inline void spari_anderson_begin(spari_anderson *anderson) {
    anderson->seen = 0;
}
/* Replaces x [nodes][6], a correction from the tangent, by the mixed correction. Displacements are scaled by
   `length`. x has room for whole stripes, filled with zeros. lanes: maximum number of lanes; 0: as the processor has
   (tests try all). */
void spari_anderson_step(spari_anderson *anderson, spari_thread_pool *pool, int lanes, double length, double *x);

#endif
