/* Solves the blade-element momentum equation of an annulus, with Prandtl's losses: see momentum.h. */
#include "momentum.h"
#include "../math/brent.h"
#include <math.h>

/* If cl < 0 the equation has a pole at phi = 0; brackets begin this far from it. */
#define SPARI_PHI_MIN 1e-8
/* sin phi below which the swirl changes smoothly between the two signs. */
#define SPARI_SWIRL_SINE 0.01
/* Last relative step of Newton's method. The error left is of the order of its square. */
#define SPARI_NEWTON_STEP 1e-9
enum { SPARI_SCAN = 32, SPARI_BRENT_MAX = 100, SPARI_NEWTON_MAX = 12 };

/* The equation at one inflow angle; rates are derivatives with respect to the angle. */
typedef struct inflow_point {
    double s, c; /* sine and cosine of the angle */
    double lift, lift_rate, loss, loss_rate;
    double g, g_rate, h, h_rate;
} inflow_point;

double spari_prandtl(double f, double sin_phi) {
    return f < 0.0 ? 1.0 : M_2_PI * acos(exp(-f / fabs(sin_phi)));
}

double spari_swirl_sign(double sin_phi) {
    double x = fmax(-1.0, fmin(1.0, sin_phi / SPARI_SWIRL_SINE));
    return x * (1.5 - 0.5 * x * x);
}

/* Multiplies the loss factor by Prandtl's for f. */
static void add_loss(double f, inflow_point *at) {
    if (f < 0.0) {
        return;
    }
    double x = f / fabs(at->s), e = exp(-x), loss = M_2_PI * acos(e);
    double rate = e < 1.0 ? -M_2_PI * e * x * at->c / (at->s * sqrt(1.0 - e * e)) : 0.0;
    at->loss_rate = at->loss_rate * loss + at->loss * rate;
    at->loss *= loss;
}

/* g for K = k s^2, which is finite at s = 0. The rate is that of s > 0. */
static void set_axial(double big_k, double k_rate, inflow_point *at) {
    double s = at->s, s2 = s * s, loss = at->loss;
    if (s < 0.0) {
        double slope = 20.0 / 3.0 - 4.0 * loss, brake = s - big_k / s;
        double tangent = 0.25 * (sqrt(fmax(0.0, slope * slope * s2 + 32.0 * loss * big_k)) + slope * s);
        at->g = fmin(brake, tangent);
    } else if (big_k <= 2.0 / 3.0 * s2) {
        at->g = big_k == 0.0 ? s : s + big_k / s;
        at->g_rate = big_k == 0.0 ? at->c : at->c + (k_rate - big_k * at->c / s) / s;
    } else {
        double rest = 2.0 * big_k - (4.0 / 3.0 - loss) * s2, root = sqrt(loss * rest);
        double rest_rate = 2.0 * k_rate + at->loss_rate * s2 - 2.0 * (4.0 / 3.0 - loss) * s * at->c;
        at->g = s * (5.0 / 3.0 - loss) + root;
        at->g_rate = at->c * (5.0 / 3.0 - loss) - s * at->loss_rate +
                     (root > 0.0 ? 0.5 * (at->loss_rate * rest + loss * rest_rate) / root : 0.0);
    }
}

/* Completes a point whose sine, cosine and lift are set. */
static void set_balance(const spari_annulus *annulus, inflow_point *at) {
    at->loss = 1.0;
    at->loss_rate = at->g_rate = 0.0;
    add_loss(annulus->tip, at);
    add_loss(annulus->hub, at);
    double share = at->lift / (4.0 * at->loss);
    double share_rate = (0.25 * at->lift_rate - share * at->loss_rate) / at->loss;
    set_axial(share * at->c, share_rate * at->c - share * at->s, at);
    at->h = at->c;
    at->h_rate = -at->s;
    if (annulus->swirl) {
        double sign = spari_swirl_sign(at->s), x = at->s / SPARI_SWIRL_SINE;
        double sign_rate = fabs(x) < 1.0 ? 1.5 * (1.0 - x * x) * at->c / SPARI_SWIRL_SINE : 0.0;
        at->h -= sign * share;
        at->h_rate -= sign * share_rate + sign_rate * share;
    }
}

static double side_of(const spari_annulus *annulus) {
    return annulus->vx < 0.0 ? -1.0 : 1.0;
}

/* Lift at an oriented inflow angle, multiplied by the solidity. */
static void find_lift(const spari_annulus *annulus, double phi, inflow_point *at) {
    double side = side_of(annulus), slope;
    int beyond;
    double place = spari_table_wrap(annulus->table, side * phi - annulus->twist, &beyond);
    at->lift = side * annulus->sigma * spari_table_lift_slope(annulus->table, place, annulus->row, &slope);
    at->lift_rate = beyond ? 0.0 : annulus->sigma * slope;
}

static double residual_at(const spari_annulus *annulus, const inflow_point *at) {
    return annulus->vy * at->g - fabs(annulus->vx) * at->h;
}

spari_balance spari_momentum_balance(const spari_annulus *annulus, double phi) {
    inflow_point at = {.s = sin(phi), .c = cos(phi)};
    find_lift(annulus, phi, &at);
    set_balance(annulus, &at);
    return (spari_balance){residual_at(annulus, &at), at.g, at.h, at.loss};
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

/* Axial induction of momentum theory for small angles; the lift is linear about that of the free flow. */
static double guess_induction(const spari_annulus *annulus, const inflow_point *at) {
    double ratio = annulus->vy / fabs(annulus->vx);
    double load = at->lift * ratio * ratio, relief = 4.0 + fmax(0.0, at->lift_rate) * ratio;
    double root = sqrt(fmax(0.0, relief * relief - 16.0 * load));
    return 2.0 * load / (relief + root);
}

/* Newton's method in the quadrant of the free flow, which has vy > 0.
   at: in, the lift at the free flow. Returns 0 unless it converges there. The
   result depends on the annulus alone, not on an earlier solution. */
static int follow_newton(const spari_annulus *annulus, inflow_point *at, double *wx, double *wy) {
    double vx = fabs(annulus->vx), phi = atan2(vx * (1.0 - guess_induction(annulus, at)), annulus->vy);
    for (int i = 0; i < SPARI_NEWTON_MAX && phi > SPARI_PHI_MIN && phi < M_PI_2; i++) {
        at->s = sin(phi);
        at->c = cos(phi);
        find_lift(annulus, phi, at);
        set_balance(annulus, at);
        double step = -residual_at(annulus, at) / (annulus->vy * at->g_rate - vx * at->h_rate);
        if (fabs(step) <= SPARI_NEWTON_STEP * phi) {
            double g = at->g + step * at->g_rate, h = at->h + step * at->h_rate;
            double speed = (vx * g + annulus->vy * h) / (g * g + h * h);
            *wx = side_of(annulus) * speed * (at->s + step * at->c);
            *wy = speed * (at->c - step * at->s);
            return isfinite(speed) && speed > 0.0;
        }
        phi = fmax(phi + step, 0.25 * phi);
    }
    return 0;
}

int spari_momentum_solve(const spari_annulus *annulus, double *wx, double *wy) {
    /* Quadrants in the order of likelihood for vy >= 0 (Ning's: windmill, brake, then tangential flow reversed); the
       halves change places for vy < 0. Each begins at the end where the equation changes fastest; the short pieces are
       what lies between two. */
    static const double range[6][2] = {{SPARI_PHI_MIN, M_PI_2},         {-SPARI_PHI_MIN, -M_PI_2},
                                       {-SPARI_PHI_MIN, SPARI_PHI_MIN}, {M_PI - SPARI_PHI_MIN, M_PI_2},
                                       {SPARI_PHI_MIN - M_PI, -M_PI_2}, {M_PI - SPARI_PHI_MIN, M_PI + SPARI_PHI_MIN}};
    double phi, speed;
    inflow_point at;
    find_lift(annulus, atan2(fabs(annulus->vx), annulus->vy), &at);
    int lifts = at.lift != 0.0; /* without lift the free flow satisfies the equation (cylinders) */
    if (lifts && annulus->vy > 0.0 && annulus->vx != 0.0 && follow_newton(annulus, &at, wx, wy)) {
        return 0;
    }
    *wx = annulus->vx;
    *wy = annulus->vy;
    if (!lifts) {
        return 0;
    }
    int first = annulus->vy < 0.0 ? 3 : 0;
    for (int parts = 1; parts <= SPARI_SCAN; parts += SPARI_SCAN - 1) {
        for (int i = 0; i < 6; i++) {
            if (search_bracket(annulus, range[(first + i) % 6], parts, &phi, &speed)) {
                *wx = (annulus->vx < 0.0 ? -speed : speed) * sin(phi);
                *wy = speed * cos(phi);
                return 0;
            }
        }
    }
    return 1;
}
