/* Stability of explicit coupling: whether the error of the predicted loads grows from step to step.
   Explicit coupling sends the error of the predicted loads through the structure and the fluid once per step. From an
   added mass of 1, 1/3, 1/7 of the mass on (predictor order 0, 1, 2) the error obeys a linear recurrence with a
   spectral radius above 1. It then grows geometrically, whatever the structure and the loads do, until it is as
   large as the loads. The root is negative (the error alternates in sign), or complex if the fluid responds to
   differences of velocities or positions. Resolved loads have a small error of prediction; loads that change at random
   in each step have a large one, which does not grow geometrically. */
#ifndef SPARI_EXPLICIT_STABILITY_H
#define SPARI_EXPLICIT_STABILITY_H

#include <spar/spar.h>

/* Growth by about the same factor, several times in turn. */
typedef struct spari_growth {
    int count;
    double log_sum, log_square; /* sums of the logarithms of the factors, and of their squares */
    double log_last;            /* logarithm of the last factor */
} spari_growth;

/* Growth from one block of steps to the next: the largest errors of a complex root. */
typedef struct spari_growth_block {
    int steps;     /* of the current block so far */
    double error;  /* its largest error of the predicted loads, */
    double size;   /* its largest loads, [N] */
    double cosine; /* sum of the cosines between successive errors; negative if they alternate */
    double last;   /* largest error of the block before; 0: none */
    double part;   /* the same relative to its largest loads */
    spari_growth growth;
} spari_growth_block;

enum { SPARI_GROWTH_BLOCKS = 2 };

/* A step with predicted loads. */
typedef struct spari_predicted_step {
    double error, size; /* of the predicted loads, and the loads, [N] */
    double before;      /* error of the step before */
    double turned;      /* cosine between both errors */
    double answered;    /* cosine between predicted loads and loads */
} spari_predicted_step;

typedef struct spari_explicit_stability {
    spari_growth steps; /* growth from step to step, with alternating sign */
    int opposed;        /* steps in turn in which the loads were opposite to the predicted loads */
    spari_growth_block block[SPARI_GROWTH_BLOCKS];
    double error, size; /* of the last step, [N] */
} spari_explicit_stability;

void spari_explicit_stability_add(spari_explicit_stability *is, const spari_predicted_step *step);
/* Number of steps over which the error has grown so that the coupling is unstable; 0: it is not. factor: growth per
   step. */
int spari_explicit_is_unstable(const spari_explicit_stability *is, double *factor);

#endif
