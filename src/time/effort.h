/* The effort of solving for a member, as counts. Unlike times, they are the same on every machine and under every
   load. */
#ifndef SPARI_EFFORT_H
#define SPARI_EFFORT_H

#include <stdint.h>

/* Limits of static solutions: load steps of a call, and additional ones by halving. */
enum { SPARI_STATIC_MOST = 100000, SPARI_STATIC_MORE = 5000 };

typedef struct spari_effort {
    int64_t iterations, tangents;     /* since the member was made: of Newton, and formed and factored */
    int nodes, elements, per_element; /* the size of each of them */
    int points;                       /* quadrature points of an iteration; 0: it multiplies matrices */
    double left;                      /* remaining correction of the last solution */
    int unknowns, band;               /* of the linear system, and how many of them a row couples at most */
} spari_effort;

/* A row of a chain of elements couples two of them; the fill-in of a factorisation is included. */
static inline int spari_effort_band(int unknowns, int block) {
    return unknowns < 2 * block ? unknowns : 2 * block;
}

#endif
