/* The eigenvalues of structure and fluid in a few shapes: (s^2 M + s C + K - A(s)) x = 0, A the fluid's answer. */
#ifndef SPARI_REDUCED_H
#define SPARI_REDUCED_H

#include "../algebra/prony.h"
#include "fluid_response.h"

typedef struct spari_reduced {
    int n;
    double dt;
    int64_t memory;
    double *M, *C, *K; /* [n][n] */
    double *A[3];      /* [n][n] the answer to displacement, velocity and acceleration: all of it, or what is nearest */
    double fastest;    /* rate, 1/s, that the shapes go up to */
    spari_answer answer;
    spari_decay tail; /* memory > 0: how the loads come to rest once the motion has ended, */
    double misfit;    /* and what that is off the loads, relative to the largest of all */
} spari_reduced;

/* n, dt and memory are in it: memory for M, C, K and A. 0 or SPAR_ERR_MEMORY. Free it whatever that is. */
int spari_reduced_create(spari_reduced *reduced);
void spari_reduced_free(spari_reduced *reduced);
/* M, C, K and the answer are there: what is nearest to it of the second degree, and how it comes to rest. 0 or a
   status: SPAR_ERR_NUMERIC: it has no numbers. */
int spari_reduced_prepare(spari_reduced *reduced);
/* Those nearest to the shift, at most n; x [n][reduced->n], of unit x^H M x. *found: how many. 0 or a status. */
int spari_reduced_solve(const spari_reduced *reduced, int n, double complex shift, int *found, double complex *value,
                        double complex *x);

#endif
