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

/* Solutions with a tangent, and their cost with that of the tangent, in iterations. */
typedef struct spari_tangent_reuse {
    int64_t served, spent;
} spari_tangent_reuse;

/* A tangent is reused as long as a solution takes no more iterations than `patience`. Beyond, a new tangent is formed
   for the next solution if it pays. A tangent costs about as much as `price` iterations. The mean cost of a solution,
   with the cost of the tangent shared by the solutions it served, has its minimum where a solution first costs more
   than the mean. If new tangents contract no better than old ones, the mean never falls so far.
   Returns whether the tangent is reused after a solution of so many iterations. fresh: it was formed in this solution.
 */
static inline int spari_tangent_serves_on(spari_tangent_reuse *reuse, int patience, int price, int iterations,
                                          int fresh) {
    if (fresh) { /* the first iterations may have used another tangent */
        *reuse = (spari_tangent_reuse){1, price + (iterations < patience ? iterations : patience)};
        return 1;
    }
    reuse->served++;
    reuse->spent += iterations;
    return iterations <= patience || iterations * reuse->served <= reuse->spent;
}

/* A row of a chain of elements couples two of them; the fill-in of a factorisation is included. */
static inline int spari_effort_band(int unknowns, int block) {
    return unknowns < 2 * block ? unknowns : 2 * block;
}

#endif
