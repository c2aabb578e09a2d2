/* The kernels of annuli side by side (momentum_lanes.c): one table for each width of vectors. */
#ifndef SPARI_MOMENTUM_KERNELS_H
#define SPARI_MOMENTUM_KERNELS_H

#include "../math/lanes.h"
#include "momentum.h"

/* If cl < 0 the equation has a pole at phi = 0; brackets begin this far from it. */
#define SPARI_PHI_MIN 1e-8

/* Newton's method of each annulus. */
typedef struct spari_newton_lanes {
    double twist[SPARI_ANNULI], phi[SPARI_ANNULI], lift[SPARI_ANNULI], lift_rate[SPARI_ANNULI];
    double s[SPARI_ANNULI], c[SPARI_ANNULI], loss[SPARI_ANNULI], loss_rate[SPARI_ANNULI]; /* see momentum_balance.h */
    double active[SPARI_ANNULI], found[SPARI_ANNULI];                                     /* 0 or 1 */
} spari_newton_lanes;

/* The steps of the method, for all annuli of a group. */
typedef struct spari_momentum_kernels {
    /* Finds the twist, and phi of the free flow. */
    void (*free_flow)(const spari_annuli *a, spari_newton_lanes *w);
    /* Guesses phi from the lift of the free flow. */
    void (*guess)(const spari_annuli *a, spari_newton_lanes *w);
    /* Finds sine and cosine of phi, without loss. */
    void (*begin)(spari_newton_lanes *w);
    /* Adds the loss of tip or hub, where f >= 0. */
    void (*add_loss)(const double *f, spari_newton_lanes *w);
    /* The rest of one iteration, where active. */
    void (*newton_step)(spari_annuli *a, spari_newton_lanes *w);
    /* angle := atan2(y, x), [SPARI_ANNULI] */
    void (*angles)(const double *y, const double *x, double *angle);
} spari_momentum_kernels;

SPARI_KERNEL_TABLES(spari_momentum_kernels)

#endif
