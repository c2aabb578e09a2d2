/* A step much longer than the last. Generalised-alpha carries an acceleration from step to step; of motions that the
   new step h no longer resolves (omega h >> 1) it would throw velocities of omega^2 h times their amplitude, which grow
   with every longer step: the scheme's overshoot in velocity. Such motions are taken out of it, and left to the
   scheme's own damping: of the acceleration b stays b - (I - cm S^-1 M)^2 b with S = K + cv C + cm M, in which
   (undamped) a mode of z = omega^2 / cm keeps 1 - (z / (1 + z))^2: all but z^2, of order h^4, of what is resolved, 2 /
   z of what is not. */
#ifndef SPARI_LEAP_H
#define SPARI_LEAP_H

#include "solver.h"

enum { SPARI_LEAP_PASSES = 2 };

/* Whether a step is so much longer than the one before (0: none). Below, what rho_inf = 0.9 takes out in a step is more
   than what a longer one brings: 1.05^2 0.9 < 1. */
static inline int spari_is_leap(double before, double h) {
    return before > 0 && h > 1.05 * before;
}

/* Of accelerations b [unique][6] in the state `at`, in global axes; cm, cv of the new step. What a member that nothing
   holds has as a rigid body stays as it is. S, the tangent at the beginning of the step, is kept for it. 0, or 1 when
   it is singular. */
int spari_leap(spari_solver *solver, const spar_member *member, const spari_state *at, double cm, double cv, double *b);

#endif
