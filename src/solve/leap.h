/* A step much longer than the last, of a body whose rotations are large: see scheme.h. */
#ifndef SPARI_LEAP_H
#define SPARI_LEAP_H

#include "solver.h"

/* Takes out of accelerations b [unique][6] in the state `at`, in global axes, what the step of c does not resolve. What
   a member that nothing holds has as a rigid body stays as it is. S, the tangent at the beginning of the step, is kept
   for it. 0, or 1 when it is singular. */
int spari_leap(spari_solver *solver, const spar_member *member, const spari_state *at, const spari_scheme *c,
               double *b);

/* y [unique][6] less what the mean turning of the nodes in the state `at` gives each, omega x (omega x r) about their
   middle, as far as the step of c resolves it: one that vibrates turns too. */
void spari_leap_take_spin(const spari_solver *solver, const spar_member *member, const spari_state *at,
                          const spari_scheme *c, double *y);

#endif
