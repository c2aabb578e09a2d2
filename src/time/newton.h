/* Newton's method for a substep (assembly/assembly.c). It ends on corrections and forces that it has measured in the
   solution under way. An attempt that fails is followed by a more careful one from other starting values. The loops
   stand in a header so that the compiler inlines the operations. */
#ifndef SPARI_NEWTON_H
#define SPARI_NEWTON_H

#include "scheme.h"
#include "tangent_reuse.h"

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
    /* Begins an attempt with these tangents. Returns whether an earlier one serves. */
    int (*begin)(void *self, spari_tangents tangents);
    /* Corrects once, by `longest` at most. Returns NULL, or the reason of a failure. */
    const char *(*iterate)(void *self, double longest, spari_iterate *it);
    /* The next iteration forms a tangent. */
    void (*renew)(void *self);
    /* Newton has converged after so many iterations, with these tangents. */
    void (*end)(void *self, int iterations, spari_tangents tangents);
} spari_newton;

/* An attempt: its tangents, with short corrections if each iteration has a new one, and its starting values. */
typedef struct spari_attempt {
    spari_tangents tangents;
    spari_guess stays;
} spari_attempt;

/* SPARI_SLOW: with a larger contraction rate, the tangent is formed again. SPARI_LONGEST: the longest correction of
   an attempt with a new tangent in every iteration. */
#define SPARI_SLOW 0.5
#define SPARI_LONGEST 0.5

/* Two corrections show the contraction of their largest part. Other parts, too small to be seen beside it, may contract
   less: in a strip that is stiff along its line, the first correction closes what that stiffness sees, and little else.
   A contraction below this limit counts as this limit. A tenth leaves 17 times as much in the
   rotor of benchmarks/scenes.c, ten times as large a limit costs it a quarter more iterations
   (docs/explanation/theory.md, (E4)). */
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
    const int each = try.tangents == SPARI_TANGENT_EACH;
    double last = 0, force = 0, least = INFINITY, longest = each ? SPARI_LONGEST : INFINITY;
    int same = 0, stalled = 0; /* the last correction had the same tangent; so many did not halve the least one */
    if (!how->begin(self, try.tangents) && !each) {
        try.tangents = SPARI_TANGENT_NEW;
    }
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
            how->end(self, it, try.tangents);
            return NULL;
        }
        if ((theta > 2 || n.correction > how->farthest) && !each) {
            return "diverges";
        }
        same = !each && theta <= SPARI_SLOW;
        if (!same) {
            how->renew(self);
            try.tangents = each ? SPARI_TANGENT_EACH : SPARI_TANGENT_NEW;
        }
        last = n.correction;
        force = n.force;
    }
    return "does not converge";
}

/* first: the tangents of the first attempt. *left: as above. Returns NULL, or the reason why the last attempt failed.
 */
static inline const char *spari_newton_solve(const spari_newton *how, void *self, spari_tangents first, int most,
                                             double *left, int *iterations) {
    enum { EACH, REUSED, NEW, MORE };
    static const spari_attempt attempts[] = {[EACH] = {SPARI_TANGENT_EACH, SPARI_KEEP_ACCELERATION},
                                             [REUSED] = {SPARI_TANGENT_REUSED, SPARI_KEEP_ACCELERATION},
                                             [NEW] = {SPARI_TANGENT_NEW, SPARI_KEEP_ACCELERATION},
                                             [MORE] = {SPARI_TANGENT_EACH, SPARI_KEEP_SHAPE},
                                             [MORE + 1] = {SPARI_TANGENT_EACH, SPARI_KEEP_VELOCITY},
                                             [MORE + 2] = {SPARI_TANGENT_EACH, SPARI_KEEP_POSITION}};
    const char *wrong = NULL;
    size_t k = first == SPARI_TANGENT_EACH ? EACH : first == SPARI_TANGENT_REUSED ? REUSED : NEW;
    for (; k < sizeof attempts / sizeof *attempts; k = k == EACH ? MORE : k + 1) {
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
