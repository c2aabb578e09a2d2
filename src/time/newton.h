/* Newton's iteration of a substep, of one member (body_newton.c) or of members that joints tie (assembly.c): attempts
   that get more careful, each from starting values of its own, and when one has converged. The loops stand here, to be
   compiled with what they call. */
#ifndef SPARI_NEWTON_H
#define SPARI_NEWTON_H

#include "scheme.h"

#include <math.h>
#include <stddef.h>

/* What an iteration has done. */
typedef struct spari_iterate {
    double correction, tolerance; /* its size, and what may be left */
    int rounded;                  /* the forces left are rounding */
    int small;                    /* as small as rounding makes it, if it does not contract any more */
} spari_iterate;

typedef struct spari_newton {
    double farthest; /* a larger correction leads elsewhere */
    double least;    /* a contraction that is kept for the next solution counts as no less */
    /* Starting values; 0: there are none of that kind. */
    int (*predict)(void *self, spari_guess stays);
    /* An attempt begins, with the tangent kept if it may; whether there is one. */
    int (*begin)(void *self, int kept);
    /* Corrects once, by `longest` at most; NULL, or what went wrong. */
    const char *(*iterate)(void *self, double longest, spari_iterate *it);
    /* The next iteration forms a tangent. */
    void (*renew)(void *self);
    /* It has converged, after so many; fresh: a tangent was formed in this attempt. */
    void (*end)(void *self, int iterations, int fresh);
} spari_newton;

/* How hard it tries: with the tangent it has, with a new one, with a new one in every iteration and short corrections.
 */
typedef struct spari_attempt {
    int kept, full;
    spari_guess stays;
} spari_attempt;

/* A tangent that contracts slower is formed anew; corrections with a new one each time are no longer than so much. */
#define SPARI_SLOW 0.5
#define SPARI_LONGEST 0.5

/* Where a solution ends before it shows a contraction, the one kept from those before is trusted less. */
#define SPARI_AGEING 1.5

static inline double spari_newton_kept(const spari_newton *how, double rate) {
    return rate <= 0 ? 0 : rate < how->least ? how->least : rate < SPARI_SLOW ? rate : SPARI_SLOW;
}

/* theta is the observed contraction, theta / (1 - theta) times the last correction what is left (Hairer & Wanner,
   Solving ODEs II, IV.8). NULL, or what went wrong. */
static inline const char *spari_newton_attempt(const spari_newton *how, void *self, spari_attempt try, int most,
                                               spari_trace *trace, int *iterations) {
    double last = 0, longest = try.full ? SPARI_LONGEST : INFINITY, known = try.full ? 0 : trace->rate, worst = 0;
    int fresh = !how->begin(self, try.kept);
    for (int it = 1; it <= most; it++, ++*iterations) {
        spari_iterate n;
        const char *wrong = how->iterate(self, longest, &n);
        if (wrong) {
            return wrong; /* cppcheck-suppress returnDanglingLifetime ; a constant text, not of n */
        }
        double theta = last > 0 ? n.correction / last : 0;
        double left = last > 0 && theta < 1 && !try.full ? theta / (1 - theta) * n.correction : n.correction;
        left = last > 0 ? left : left * (known > 0 ? known / (1 - known) : 1);
        worst = theta > worst ? theta : worst;
        if (left <= n.tolerance || n.rounded || (theta > 0.5 && n.small)) {
            trace->left = left;
            trace->rate = n.rounded ? trace->rate : spari_newton_kept(how, last > 0 ? worst : SPARI_AGEING * known);
            how->end(self, it, fresh);
            return NULL;
        }
        if ((theta > 2 || n.correction > how->farthest) && !try.full) {
            return "diverges";
        }
        if (try.full || theta > SPARI_SLOW) {
            how->renew(self);
            fresh = 1;
            worst = 0;
        }
        last = n.correction;
    }
    return "does not converge";
}

/* kept: there is a tangent that may serve. trace: of the last solution; the first iteration goes by its rate. NULL, or
 * what went wrong in the last attempt. */
static inline const char *spari_newton_solve(const spari_newton *how, void *self, int kept, int most,
                                             spari_trace *trace, int *iterations) {
    static const spari_attempt attempts[] = {{1, 0, SPARI_KEEP_ACCELERATION},
                                             {0, 0, SPARI_KEEP_ACCELERATION},
                                             {0, 1, SPARI_KEEP_SHAPE},
                                             {0, 1, SPARI_KEEP_VELOCITY},
                                             {0, 1, SPARI_KEEP_POSITION}};
    const char *wrong = NULL;
    for (size_t k = kept ? 0 : 1; k < sizeof attempts / sizeof *attempts; k++) {
        if (!how->predict(self, attempts[k].stays)) {
            continue;
        }
        wrong = spari_newton_attempt(how, self, attempts[k], most, trace, iterations);
        if (!wrong) {
            return NULL;
        }
    }
    return wrong;
}

#endif
