/* Solves the blade-element momentum equation of an annulus, with Prandtl's losses: see momentum.h. */
#include "momentum.h"
#include "../math/brent.h"
#include "momentum_balance.h"
#include "momentum_kernels.h"
#include <math.h>

enum { SPARI_SCAN = 32, SPARI_BRENT_MAX = 100, SPARI_NEWTON_MAX = 12 };

double spari_prandtl(double f, double sin_phi) {
    double rate;
    return spari_loss_at(f, sin_phi, 0.0, &rate);
}

double spari_swirl_sign(double sin_phi) {
    double rate;
    return spari_sign_at(sin_phi, &rate);
}

static double side_of(double vx) {
    return vx < 0.0 ? -1.0 : 1.0;
}

/* Lift at an oriented inflow angle, multiplied by the solidity. */
static void find_lift(const spari_annulus *annulus, double phi, double *lift, double *rate) {
    double side = side_of(annulus->vx), slope;
    int beyond;
    double place = spari_table_wrap(annulus->table, side * phi - annulus->twist, &beyond);
    *lift = side * annulus->sigma * spari_table_lift_slope(annulus->table, place, annulus->row, &slope);
    *rate = beyond ? 0.0 : annulus->sigma * slope;
}

spari_balance spari_momentum_balance(const spari_annulus *annulus, double phi) {
    spari_inflow_point at = {.loss = 1.0};
    spari_lane_sincos(phi, &at.s, &at.c);
    find_lift(annulus, phi, &at.lift, &at.lift_rate);
    if (annulus->tip >= 0.0) {
        spari_add_loss(annulus->tip, &at);
    }
    if (annulus->hub >= 0.0) {
        spari_add_loss(annulus->hub, &at);
    }
    spari_balance_at(0, annulus->swirl, &at);
    return (spari_balance){annulus->vy * at.g - fabs(annulus->vx) * at.h, at.g, at.h, at.loss};
}

static double residual(double phi, void *annulus) {
    return spari_momentum_balance(annulus, phi).residual;
}

/* Whether the flow speed at the root is positive. */
static int is_sound(const spari_annulus *annulus, double phi, double *speed) {
    spari_balance b = spari_momentum_balance(annulus, phi);
    *speed = (fabs(annulus->vx) * b.g + annulus->vy * b.h) / (b.g * b.g + b.h * b.h);
    return isfinite(*speed) && *speed > 0.0;
}

/* Tries the interval from a to b in `parts` pieces that lie closer towards a; takes the first sound root. */
static int search_bracket(const spari_annulus *annulus, const double range[2], int parts, double *phi, double *speed) {
    double x0 = range[0], r0 = residual(x0, (void *)annulus);
    for (int i = 1; i <= parts; i++) {
        double t = (double)i / parts;
        double x1 = range[0] + (range[1] - range[0]) * t * t, r1 = residual(x1, (void *)annulus);
        if ((r0 < 0.0 && r1 >= 0.0) || (r0 > 0.0 && r1 <= 0.0)) {
            *phi = spari_brent(residual, (void *)annulus, fmin(x0, x1), fmax(x0, x1), 0, SPARI_BRENT_MAX);
            if (is_sound(annulus, *phi, speed)) {
                return 1;
            }
        }
        x0 = x1;
        r0 = r1;
    }
    return 0;
}

/* Searches all quadrants. Returns 1 if there is no root. */
static int search_quadrants(const spari_annulus *annulus, double *wx, double *wy) {
    /* Quadrants in the order of likelihood for vy >= 0 (Ning's: windmill, brake, then tangential flow reversed); the
       halves change places for vy < 0. Each begins at the end where the equation changes fastest; the short pieces are
       what lies between two. */
    static const double range[6][2] = {{SPARI_PHI_MIN, M_PI_2},         {-SPARI_PHI_MIN, -M_PI_2},
                                       {-SPARI_PHI_MIN, SPARI_PHI_MIN}, {M_PI - SPARI_PHI_MIN, M_PI_2},
                                       {SPARI_PHI_MIN - M_PI, -M_PI_2}, {M_PI - SPARI_PHI_MIN, M_PI + SPARI_PHI_MIN}};
    double phi, speed, s, c;
    int first = annulus->vy < 0.0 ? 3 : 0;
    for (int parts = 1; parts <= SPARI_SCAN; parts += SPARI_SCAN - 1) {
        for (int i = 0; i < 6; i++) {
            if (search_bracket(annulus, range[(first + i) % 6], parts, &phi, &speed)) {
                spari_lane_sincos(phi, &s, &c);
                *wx = side_of(annulus->vx) * speed * s;
                *wy = speed * c;
                return 0;
            }
        }
    }
    return 1;
}

static spari_annulus annulus_of(const spari_annuli *a, const spari_newton_lanes *w, int l) {
    return (spari_annulus){a->vx[l],  a->vy[l], w->twist[l], a->sigma[l], a->tip[l],
                           a->hub[l], a->swirl, a->table[l], a->row[l]};
}

static void look_up_lift(const spari_annuli *a, spari_newton_lanes *w, int l) {
    const spari_annulus annulus = annulus_of(a, w, l);
    find_lift(&annulus, w->phi[l], w->lift + l, w->lift_rate + l);
}

/* Looks up the lift of the active annuli and returns their number. */
static int look_up_active(const spari_annuli *a, spari_newton_lanes *w) {
    int count = 0;
    for (int l = 0; l < a->count; l++) {
        if (w->active[l] != 0.0) {
            look_up_lift(a, w, l);
            count++;
        }
    }
    return count;
}

void spari_momentum_solve(spari_annuli *a, int lanes) {
    const spari_momentum_kernels *kernels = spari_momentum_kernels_for(lanes);
    spari_newton_lanes w = {.active = {0}};
    int lifts[SPARI_ANNULI] = {0}, tip = 0, hub = 0;
    kernels->free_flow(a, &w);
    for (int l = 0; l < a->count; l++) {
        look_up_lift(a, &w, l);
        a->wx[l] = a->vx[l];
        a->wy[l] = a->vy[l];
        tip |= a->tip[l] >= 0.0;
        hub |= a->hub[l] >= 0.0;
        lifts[l] = w.lift[l] != 0.0; /* without lift the free flow satisfies the equation (cylinders) */
        w.active[l] = lifts[l] && a->vy[l] > 0.0 && a->vx[l] != 0.0;
    }
    kernels->guess(a, &w);
    for (int i = 0; i < SPARI_NEWTON_MAX && look_up_active(a, &w) > 0; i++) {
        kernels->begin(&w);
        if (tip) {
            kernels->add_loss(a->tip, &w);
        }
        if (hub) {
            kernels->add_loss(a->hub, &w);
        }
        kernels->newton_step(a, &w);
    }
    for (int l = 0; l < a->count; l++) {
        a->no_root[l] = 0;
        if (lifts[l] && w.found[l] == 0.0) {
            const spari_annulus annulus = annulus_of(a, &w, l);
            a->no_root[l] = search_quadrants(&annulus, a->wx + l, a->wy + l);
        }
    }
}
