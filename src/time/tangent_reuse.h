/* Which tangents a solution of Newton's method uses, and whether they serve the next one. */
#ifndef SPARI_TANGENT_REUSE_H
#define SPARI_TANGENT_REUSE_H

#include <stdint.h>

/* That of an earlier solution; one that is formed in this solution; or a new one in each iteration. */
typedef enum spari_tangents { SPARI_TANGENT_REUSED, SPARI_TANGENT_NEW, SPARI_TANGENT_EACH } spari_tangents;

typedef struct spari_tangent_reuse {
    int64_t served, spent; /* solutions with a tangent, and their cost with that of the tangent, in iterations */
    int64_t each;          /* solutions in a row that needed a tangent in each iteration, at most SPARI_TANGENT_AGAIN */
} spari_tangent_reuse;

/* After so many solutions with a tangent in each iteration, one is tried with a single tangent. It fails after some 2
   iterations; a tangent in each of 4 costs as much as 40 or more. */
enum { SPARI_TANGENT_AGAIN = 8 };

/* Whether a solution begins with a tangent in each iteration. */
static inline int spari_tangent_is_new_in_each(const spari_tangent_reuse *reuse) {
    return reuse->each > 0 && reuse->each < SPARI_TANGENT_AGAIN;
}

/* A tangent is reused as long as a solution takes no more iterations than `patience`. Beyond, a new tangent is formed
   for the next solution if it pays. A tangent costs about as much as `price` iterations. The mean cost of a solution,
   with the cost of the tangent shared by the solutions it served, has its minimum where a solution first costs more
   than the mean. If new tangents contract no better than old ones, the mean never falls so far.
   Returns whether the tangent is reused after a solution of so many iterations with these tangents. */
static inline int spari_tangent_serves_on(spari_tangent_reuse *reuse, int patience, int price, int iterations,
                                          spari_tangents tangents) {
    if (tangents != SPARI_TANGENT_REUSED) { /* the first iterations may have used another tangent */
        int64_t each = tangents == SPARI_TANGENT_EACH ? reuse->each % SPARI_TANGENT_AGAIN + 1 : 0;
        *reuse = (spari_tangent_reuse){1, price + (iterations < patience ? iterations : patience), each};
        return 1;
    }
    reuse->served++;
    reuse->spent += iterations;
    reuse->each = 0;
    return iterations <= patience || iterations * reuse->served <= reuse->spent;
}

#endif
