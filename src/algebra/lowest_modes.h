/* Lowest modes of a sparse symmetric pencil with constraints, by shift-and-invert. */
#ifndef SPARI_LOWEST_MODES_H
#define SPARI_LOWEST_MODES_H

#include "pencil.h"

typedef struct spari_modes_problem {
    const spari_pencil *pencil; /* K, M and G */
    const int *block;           /* block of each unknown, see shifted.h */
    int less;                   /* rows of W, at most 6 */
    const double *W;            /* [less][n]: the mass is M - W^T W, and K must be positive definite; NULL: M */
} spari_modes_problem;

/* K x = omega^2 M x with G x = 0: the n smallest omega^2, ascending, and their modes of unit modal mass. Motions
   without mass come last, with omega^2 infinite and x = 0. Redundant rows of G do no harm.
     square: out, [n] omega^2
     x: out, [n][unknowns]
     available: out, number of modes, the unknowns that the constraints leave free
   Returns 0; SPAR_ERR_MEMORY; SPAR_ERR_ARGUMENT: n > available; SPAR_ERR_STATE: no shift makes the stiffness positive
   definite; SPAR_ERR_NUMERIC: not converged, or a number is not finite. */
int spari_lowest_modes(const spari_modes_problem *problem, int n, double *square, double *x, int *available);

#endif
