/* Wind shear, and the potential-flow dipole of a tower in the wind.
   A cylinder of radius R in a cross flow U changes the flow at d from its axis, rho = |d|, by the gradient of the
     dipole potential R^2 (U . d) / rho^2, which is (R / rho)^2 (U - 2 (U . d) d / rho^2): -U upstream and downstream
     at the surface, +U beside it. It is applied per slice with the tower radius at the section's height, times (1 +
     t / sqrt(t^2 + rho^2)) / 2 with t the distance below the top. This is the ratio of a semi-infinite to an
     infinite line of dipoles, so a blade that passes the top meets no jump. */
#include "wind.h"
#include "../math/rotation.h"

#include <math.h>
#include <spar/spar_aero.h>

double spari_shear_factor(const spari_shear *shear, double z) {
    if (shear->law == SPAR_SHEAR_LINEAR) {
        return fmax(0.0, 1.0 + shear->parameter * (z - shear->height));
    }
    if (shear->law == SPAR_SHEAR_LOG) {
        return z > shear->parameter ? log(z / shear->parameter) / log(shear->height / shear->parameter) : 0.0;
    }
    return z > 0.0 ? pow(z / shear->height, shear->parameter) : 0.0;
}

/* Adds the tower's influence to the wind at x. Returns 1 if x is inside the tower. */
static int pass_tower(const spari_tower *tower, const double x[3], double wind[3]) {
    double d[3], across[3];
    for (int i = 0; i < 3; i++) {
        d[i] = x[i] - tower->top[i];
    }
    double below = -spari_dot(d, tower->up), along = spari_dot(wind, tower->up);
    for (int i = 0; i < 3; i++) {
        d[i] += below * tower->up[i];
        across[i] = wind[i] - along * tower->up[i];
    }
    double share = fmin(fmax(below / tower->length, 0.0), 1.0);
    double radius = tower->top_radius + share * (tower->base_radius - tower->top_radius), rho = spari_norm(d);
    double far = hypot(below, rho), end = far > 0.0 ? 0.5 * (1.0 + below / far) : 0.5;
    int inside = rho < radius;
    /* inside, without flow, the change decreases to 0 at the axis with the square of the distance */
    double square = inside ? rho / radius : radius / rho;
    square *= square;
    double turned = rho > 0.0 ? 2.0 * spari_dot(across, d) / (rho * rho) : 0.0;
    for (int i = 0; i < 3; i++) {
        wind[i] += end * square * (across[i] - turned * d[i]);
    }
    return inside && below > 0.0;
}

int spari_wind_meet(const spari_wind *wind, int effects, const double x[3], const double inflow[3], double met[3]) {
    double factor = 1.0;
    if (effects & SPAR_AERO_SHEAR) {
        const spari_shear *shear = &wind->shear;
        double d[3] = {x[0] - shear->ground[0], x[1] - shear->ground[1], x[2] - shear->ground[2]};
        factor = spari_shear_factor(shear, spari_dot(d, shear->up));
    }
    for (int i = 0; i < 3; i++) {
        met[i] = factor * inflow[i];
    }
    return (effects & SPAR_AERO_TOWER) && pass_tower(&wind->tower, x, met) ? SPAR_AERO_FLAG_TOWER : 0;
}
