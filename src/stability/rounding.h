/* What rounding of the stiffness leaves of modes and eigenvalues, measured for each of them. Where stiff strains hide
   soft ones, the equations are solved again with less stiff ones, and each pair is taken where it is best known. */
#ifndef SPARI_ROUNDING_H
#define SPARI_ROUNDING_H

#include "small_motions.h"

/* Pairs sought, by increasing distance from the shift: |lambda|^2 for x^H M x = 1, the values as numbers, and x. */
typedef struct spari_pairs {
    int n, width, vectors;              /* pairs; numbers of a value; real vectors of a pair */
    double *square, *value, *x, *error; /* [n], [n][width], [n][vectors][unknowns], [n] relative error of square */
    int (*solve)(void *context, struct spari_pairs *pairs); /* from the equations as they are; a status and a message */
    void *context;
} spari_pairs;

/* Solves for pairs of the motions. cures: less stiff strains may help. SPAR_ERR_NUMERIC: rounding hides a pair. */
int spari_pairs_solve(spari_small_motions *motions, spari_pairs *pairs, int cures);

#endif
