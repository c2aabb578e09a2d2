/* Eigenvalues of structure and fluid in a few shapes: (s^2 M + s C + K - A(s)) x = 0, A the response of the fluid. */
#ifndef SPARI_REDUCED_MODEL_H
#define SPARI_REDUCED_MODEL_H

#include "../algebra/prony.h"
#include "fluid_response.h"

typedef struct spari_reduced {
    int n;
    double dt;
    int64_t memory;
    double *M, *C, *K; /* [n][n] */
    double *A[3];      /* [n][n] response to displacement, velocity and acceleration: exact, or the closest fit */
    double fastest;    /* largest rate of the shapes, 1/s */
    spari_fluid_response response;
    spari_decay tail; /* memory > 0: decay of the loads after the motion has ended, */
    double misfit;    /* and its deviation from the loads, relative to the largest */
} spari_reduced;

/* Allocates M, C, K and A; n, dt and memory must be set. Returns 0 or SPAR_ERR_MEMORY. Free it in any case. */
int spari_reduced_create(spari_reduced *reduced);
void spari_reduced_free(spari_reduced *reduced);
/* After M, C, K and the response are set: computes the closest second-degree fit, and the decay. Returns 0 or a
   status; SPAR_ERR_NUMERIC: the response is not finite. */
int spari_reduced_prepare(spari_reduced *reduced);
/* Eigenvalues nearest to the shift, at most n; x [n][reduced->n], with unit x^H M x. *found: their number. Returns 0
   or a status. */
int spari_reduced_solve(const spari_reduced *reduced, int n, double complex shift, int *found, double complex *value,
                        double complex *x);

#endif
