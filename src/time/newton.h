/* Newton's method for a substep (assembly/assembly.c). It ends on corrections and forces that it has measured in the
   solution under way. An attempt that fails is followed by a more careful one from other starting values. The loops
   stand in a header so that the compiler inlines the operations. */
#ifndef SPARI_NEWTON_H
#define SPARI_NEWTON_H

#include "scheme.h"

#include <math.h>
#include <stddef.h>

/* Result of one iteration. */
typedef struct spari_iterate {
    double correction, tolerance;  /* its size, and the remaining correction that is allowed */
    double force, force_tolerance; /* the unbalanced forces before it, and those that may remain */
    int rounded;                   /* the residual consists of rounding errors */
    int small;                     /* as small as rounding allows, once it contracts no more */
    int stiff;                     /* the residual is within rounding errors of the largest stiffness */
} spari_iterate;

typedef struct spari_newton {
    double farthest; /* a larger correction counts as divergence */
    /* Computes starting values. Returns 0 if this kind does not exist here. */
    int (*predict)(void *self, spari_guess stays);
    /* Begins an attempt, with the earlier tangent if `reused` and if it may serve. Returns whether there is a tangent.
     */
    int (*begin)(void *self, int reused);
    /* Corrects once, by `longest` at most. Returns NULL, or the reason of a failure. */
    const char *(*iterate)(void *self, double longest, spari_iterate *it);
    /* The next iteration forms a tangent. */
    void (*renew)(void *self);
    /* Newton has converged after so many iterations. fresh: a tangent was formed in this attempt. */
    void (*end)(void *self, int iterations, int fresh);
} spari_newton;

/* An attempt: with the reused tangent; with a new one; with a new one in every iteration and short corrections. */
typedef struct spari_attempt {
    int reused, full;
    spari_guess stays;
} spari_attempt;

/* SPARI_SLOW: with a larger contraction rate, the tangent is formed again. SPARI_LONGEST: the longest correction of
   an attempt with a new tangent in every iteration. */
#define SPARI_SLOW 0.5
#define SPARI_LONGEST 0.5

/* Two corrections show the contraction of their largest part. Other parts, too small to be seen beside it, may contract
   less: in a strip that is stiff along its line, the first correction closes what that stiffness sees, and little else.
   A contraction below this limit counts as this limit. */
#define SPARI_LEAST_RATE 0.02

/* What remains after the last of two corrections with the same tangent, from their sizes (Hairer & Wanner, Solving
   ODEs II, IV.8). Without the first one (0), as much as the last one. */
static inline double spari_newton_remaining(double before, double last) {
    double theta = before > 0 ? last / before : 1;
    theta = theta > SPARI_LEAST_RATE ? theta : SPARI_LEAST_RATE;
    return theta < 1 ? theta / (1 - theta) * last : last;
}

/* Beside a large stiffness, rounding may be larger than what still can be corrected. So many corrections in turn that
   do not halve the least one show that nothing can. */
#define SPARI_STALLED 3

/* Ends once the remaining correction and the remaining unbalanced forces are both below their tolerances. Both are
   needed: a beam is stiffer along its line than across it by EA L^2 / EI, so that corrections of a small rotation leave
   large forces. *left: the remaining correction. Returns NULL, or the reason of a failure. */
static inline const char *spari_newton_attempt(const spari_newton *how, void *self, spari_attempt try, int most,
                                               double *left, int *iterations) {
    double last = 0, force = 0, least = INFINITY, longest = try.full ? SPARI_LONGEST : INFINITY;
    int same = 0, stalled = 0; /* the last correction had the same tangent; so many did not halve the least one */
    int fresh = !how->begin(self, try.reused);
    for (int it = 1; it <= most; it++, ++*iterations) {
        spari_iterate n;
        const char *wrong = how->iterate(self, longest, &n);
        if (wrong) {
            return wrong; /* cppcheck-suppress returnDanglingLifetime ; a constant text, not of n */
        }
        double theta = last > 0 ? n.correction / last : 0;
        *left = spari_newton_remaining(same ? last : 0, n.correction);
        int balanced = spari_newton_remaining(same ? force : 0, n.force) <= n.force_tolerance;
        stalled = n.correction > 0.5 * least ? stalled + 1 : 0;
        least = n.correction < least ? n.correction : least;
        if ((*left <= n.tolerance && balanced) || n.rounded || (theta > 0.5 && n.small) ||
            (stalled >= SPARI_STALLED && n.stiff)) {
            how->end(self, it, fresh);
            return NULL;
        }
        if ((theta > 2 || n.correction > how->farthest) && !try.full) {
            return "diverges";
        }
        same = !try.full && theta <= SPARI_SLOW;
        if (!same) {
            how->renew(self);
            fresh = 1;
        }
        last = n.correction;
        force = n.force;
    }
    return "does not converge";
}

/* reused: there is a tangent that may serve. *left: as above. Returns NULL, or the reason why the last attempt failed.
 */
static inline const char *spari_newton_solve(const spari_newton *how, void *self, int reused, int most, double *left,
                                             int *iterations) {
    static const spari_attempt attempts[] = {{1, 0, SPARI_KEEP_ACCELERATION},
                                             {0, 0, SPARI_KEEP_ACCELERATION},
                                             {0, 1, SPARI_KEEP_SHAPE},
                                             {0, 1, SPARI_KEEP_VELOCITY},
                                             {0, 1, SPARI_KEEP_POSITION}};
    const char *wrong = NULL;
    for (size_t k = reused ? 0 : 1; k < sizeof attempts / sizeof *attempts; k++) {
        if (!how->predict(self, attempts[k].stays)) {
            continue;
        }
        wrong = spari_newton_attempt(how, self, attempts[k], most, left, iterations);
        if (!wrong) {
            return NULL;
        }
    }
    return wrong;
}

#endif
