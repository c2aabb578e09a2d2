/* The shifted symmetric matrix of K x = omega^2 M x with constraints G x = 0, [K + sigma M, G^T; G, 0], as sparse
   blocks: factors, solutions, and the number of eigenvalues below -sigma (Sylvester's law of inertia). */
#ifndef SPARI_SHIFTED_H
#define SPARI_SHIFTED_H

#include "block_matrix.h"
#include "pencil.h"

typedef struct spari_shifted {
    int n, rank;    /* unknowns; independent constraints */
    double highest; /* largest |K_ii| / M_ii; 0: none */
    int64_t *begin; /* [n + 1] rows of K and M */
    int *column;
    double *k, *m;
    const int *block; /* [n] block of each unknown, ascending, at most 6 unknowns each */
    int blocks;
    int64_t entries; /* of G, whose dependent rows are left out */
    spari_pencil_constraint *g;
    int *group;      /* block of each independent row of G */
    int less;        /* M is reduced by the products of these rows: M - W^T W */
    const double *W; /* [less][n] */
    spari_blocks *matrix;
    double sigma, *x; /* workspace [n + rank] */
    int below;        /* eigenvalues omega^2 below -sigma, after factoring */
} spari_shifted;

/* Reads the symmetric pencil, which is not used later. A row of G has entries in at most two blocks. Returns 0 or
   SPAR_ERR_MEMORY; free it in any case. */
int spari_shifted_create(spari_shifted *a, const spari_pencil *p, const int *block, int less, const double *W);
void spari_shifted_free(spari_shifted *a);
/* Factors at sigma. Returns 0, or 1 if a pivot is 0 or not finite. */
int spari_shifted_factor(spari_shifted *a, double sigma);
/* x [n] := (K + sigma M)^-1 x within the constraints. Returns 0, or 1 if a number is not finite. */
int spari_shifted_solve(spari_shifted *a, double *x);
/* y [n] := M x */
void spari_shifted_mass(const spari_shifted *a, const double *x, double *y);

#endif
