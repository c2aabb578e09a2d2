/* Corrections of one Newton solution with a kept tangent, each mixed with those before it (Anderson's mixing of depth
   two: Walker & Ni, SIAM J. Numer. Anal. 49 (2011), 1715-1735). A kept tangent takes the forces of what stretches next
   to nothing in directions that have turned since: errors along and across go over into one another, by I - T^-1 K
   whose largest eigenvalues are pairs of +-lambda. Of such a pair two earlier corrections take both. Nothing is kept
   from one solution to the next. Numbers have the same bits however many lanes and threads there are. */
#ifndef SPARI_MIXING_H
#define SPARI_MIXING_H

#include "../base/thread_pool.h"

/* Unknowns of four nodes: lanes of every width begin with the same component. */
enum { SPARI_MIXED_SUMS = 6, SPARI_MIXED_STRIPE = 24 };
static inline int64_t spari_mixed_unknowns(int64_t nodes) {
    return (6 * nodes + SPARI_MIXED_STRIPE - 1) / SPARI_MIXED_STRIPE * SPARI_MIXED_STRIPE;
}

typedef struct spari_mixing {
    int64_t unknowns;                  /* six of a node, in whole stripes */
    int64_t seen;                      /* corrections since the beginning */
    double *z, *c;                     /* the last as the tangent has it, and as it was taken */
    double *d[2];                      /* of the last two pairs, the newer first: by how much z changed, */
    double *w[2];                      /* and that and what was taken in between */
    double weight[SPARI_MIXED_STRIPE]; /* of squares of displacements and turns */
    double *room;                      /* the memory of all */
    double *sums;                      /* [spans][SPARI_MIXED_SUMS] */
} spari_mixing;

/* Of so many nodes; NULL: no memory. */
spari_mixing *spari_mixing_create(int64_t nodes);
void spari_mixing_free(spari_mixing *mixing);
/* A solution begins, or has a new tangent. */
static inline void spari_mixing_begin(spari_mixing *mixing) {
    mixing->seen = 0;
}
/* x [nodes][6], a correction as the tangent has it, displacements by `length` and rad, becomes the one to take; beyond
   it there is room for whole stripes, and zeros. lanes: at once at most, 0: what the processor has (tests try all). */
void spari_mixing_take(spari_mixing *mixing, spari_crew *crew, int lanes, double length, double *x);

#endif
