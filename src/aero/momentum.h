/* Blade element and momentum balance of one annulus as one equation for the inflow angle (Ning 2014,
   doi 10.1002/we.1636).

   In the plane of the section, p is the direction of the shaft axis (downwind) and s that of the flow a turning blade
   meets. The free flow is vx p + vy s, the flow with induction W (sin phi p + cos phi s). With solidity sigma = B c /
   (2 pi r), loss factor F, lift alone (drag takes no part in either induction) and S = sign(vx), balance of axial and
   of angular momentum give |vx| / W = g(phi),   vy / W = h(phi) = cos phi - S sign(phi) sigma cl / (4 F), where, with k
   = S sigma cl cos phi / (4 F sin^2 phi), g = sin phi (1 + k)                                              k <= 2/3,
   phi > 0: momentum theory g = sin phi (5/3 - F + sqrt(2 F k - F (4/3 - F)))                k > 2/3, phi > 0: Buhl's
   empirical curve g = sin phi (1 - k)                                              phi < 0: propeller brake, sound for
   k > 1 (angles turned so that vx counts as positive). The residual vy g - |vx| h has no pole and no singular place in
   (-pi, 0) and in (0, pi), for any vx >= 0 and any vy: it is Ning's with the denominators cleared, and Buhl's root
   written so that its removable singularity is gone. The swirl goes with the mass flow's size, so the brake's torque
   keeps its sign. In the brake Ning takes the signed flow; the sign here follows from the torque the wake must carry.
 */
#ifndef SPARI_MOMENTUM_H
#define SPARI_MOMENTUM_H

#include "polar.h"
#include <gsl/gsl_roots.h>

typedef struct spari_annulus {
    double vx, vy;   /* free flow along p and s */
    double twist;    /* from s to the chord, towards p */
    double sigma;    /* B c / (2 pi r) */
    double tip, hub; /* B (R - r) / (2 r) and B (r - Rh) / (2 Rh) >= 0; negative: that loss is off */
    int swirl;       /* tangential induction */
    const spari_table *table;
    gsl_interp_accel *accel;
} spari_annulus;

/* What the equation says at an inflow angle, angles and flow turned so that vx >= 0. */
typedef struct spari_balance {
    double residual; /* vy g - |vx| h */
    double g, h;     /* |vx| / W and vy / W if phi were the root */
    double k, loss;  /* Ning's k and the factor F */
} spari_balance;

/* Prandtl's factor 2/pi acos(exp(-f / |sin phi|)); f < 0: 1. */
double spari_prandtl(double f, double sin_phi);
spari_balance spari_momentum_balance(const spari_annulus *annulus, double phi);

/* Flow with induction: *wx along p, *wy along s. Returns 0, or 1 when no inflow angle balances: then the flow is the
   free one. No memory is taken: solver is a Brent solver of the caller's. */
int spari_momentum_solve(const spari_annulus *annulus, gsl_root_fsolver *solver, double *wx, double *wy);

#endif
