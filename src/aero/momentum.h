/* Blade-element momentum balance of one annulus as one equation for the inflow angle phi (Ning 2014,
   doi 10.1002/we.1636).

   In the plane of the section, p is the direction of the shaft axis (downwind) and s that of the tangential flow. The
   free flow is vx p + vy s, the flow with induction W (sin phi p + cos phi s). Notation: solidity
   sigma = B c / (2 pi r), loss factor F, lift alone (drag does not take part in the induction), angles oriented so that
   vx counts as positive, and k = sigma cl cos phi / (4 F sin^2 phi). Balance of axial and of angular momentum gives
       vx / W = g(phi),   vy / W = h(phi) = cos phi - sign(phi) sigma cl / (4 F).
   g = sin phi / (1 - a) follows from the thrust coefficient CT = 4 F k (1 - a)^2 of the annulus:

       CT                                          range                          model
       4 F a (1 - a)                               k <= 2/3, phi > 0 (a <= 0.4)   momentum theory
       8/9 + (4F - 40/9) a + (50/9 - 4F) a^2       k > 2/3, phi > 0 (a < 1)       Buhl's empirical curve
       max(4 F a (a - 1), 2 + (20/3 - 4F) (a - 1)) phi < 0 (a > 1)                propeller brake, k > 1

   Ning's brake is the first argument of max alone. It has a jump from a = 1 to where 4 F a (a - 1) = 2, across which
   the flow of a blade that deflects downwind would oscillate. Buhl's curve, continued by its tangent, bridges the jump.
   So that the swirl has no jump at phi = 0 either, sign(phi) changes smoothly from -1 to 1 within half a degree.

   The residual vy g - vx h is Ning's multiplied by the denominators, with Buhl's root written without its removable
   singularity. For cl > 0 it is continuous across phi = 0. It has no pole elsewhere for any vx >= 0 and any vy. */
#ifndef SPARI_MOMENTUM_H
#define SPARI_MOMENTUM_H

#include "polar.h"

typedef struct spari_annulus {
    double vx, vy;   /* free flow along p and s */
    double twist;    /* from s to the chord, towards p */
    double sigma;    /* B c / (2 pi r) */
    double tip, hub; /* B (R - r) / (2 r) and B (r - Rh) / (2 Rh) >= 0; negative: this loss is off */
    int swirl;       /* tangential induction */
    const spari_table *table;
    int64_t *row; /* of the table: where the next look-up begins */
} spari_annulus;

/* Annuli are solved so many side by side. */
enum { SPARI_ANNULI = 8 };

/* The first `count` of these annuli, as above. The twist is given by its sine and cosine, or multiples of both. wx, wy:
   out, the flow with induction, which is the free flow where no_root says 1. */
typedef struct spari_annuli {
    int count, swirl;
    double vx[SPARI_ANNULI], vy[SPARI_ANNULI], twist_sine[SPARI_ANNULI], twist_cosine[SPARI_ANNULI];
    double sigma[SPARI_ANNULI], tip[SPARI_ANNULI], hub[SPARI_ANNULI];
    const spari_table *table[SPARI_ANNULI];
    int64_t *row[SPARI_ANNULI];
    double wx[SPARI_ANNULI], wy[SPARI_ANNULI];
    int no_root[SPARI_ANNULI];
} spari_annuli;

/* The equation at an inflow angle, with angles and flow oriented so that vx >= 0. */
typedef struct spari_balance {
    double residual; /* vy g - vx h */
    double g, h;     /* vx / W and vy / W if phi were the root */
    double loss;     /* the factor F */
} spari_balance;

/* Prandtl's factor 2/pi acos(exp(-f / |sin phi|)); f < 0: 1. */
double spari_prandtl(double f, double sin_phi);
/* Smooth sign of sin phi: -1 or 1 except near 0. */
double spari_swirl_sign(double sin_phi);
spari_balance spari_momentum_balance(const spari_annulus *annulus, double phi);

/* Newton's method side by side; annuli that it leaves are searched by brackets. The result of an annulus depends on
   this annulus alone. lanes: the widest vectors to use, 2, 4 or 8; all give the same bits. */
void spari_momentum_solve(spari_annuli *annuli, int lanes);

#endif
