/* Solves the blade-element momentum equation of an annulus, with Prandtl's losses: see momentum.h. */
#include "momentum.h"
#include "../math/brent.h"
#include <math.h>

/* If cl < 0 the equation has a pole at phi = 0; brackets begin this far from it. */
#define SPARI_PHI_MIN 1e-8
/* sin phi below which the swirl changes smoothly between the two signs. */
#define SPARI_SWIRL_SINE 0.01
enum { SPARI_SCAN = 32, SPARI_BRENT_MAX = 100 };

double spari_prandtl(double f, double sin_phi) {
    return f < 0.0 ? 1.0 : M_2_PI * acos(exp(-f / fabs(sin_phi)));
}

double spari_swirl_sign(double sin_phi) {
    double x = fmax(-1.0, fmin(1.0, sin_phi / SPARI_SWIRL_SINE));
    return x * (1.5 - 0.5 * x * x);
}

/* g for sin phi = s, F and K = k s^2, which is finite at s = 0. */
static double axial(double s, double big_k, double loss) {
    double s2 = s * s;
    if (s < 0.0) {
        double slope = 20.0 / 3.0 - 4.0 * loss, brake = s - big_k / s;
        double tangent = 0.25 * (sqrt(fmax(0.0, slope * slope * s2 + 32.0 * loss * big_k)) + slope * s);
        return fmin(brake, tangent);
    }
    if (big_k <= 2.0 / 3.0 * s2) {
        return big_k == 0.0 ? s : s + big_k / s;
    }
    return s * (5.0 / 3.0 - loss) + sqrt(loss * (2.0 * big_k - (4.0 / 3.0 - loss) * s2));
}

spari_balance spari_momentum_balance(const spari_annulus *annulus, double phi) {
    double side = annulus->vx < 0.0 ? -1.0 : 1.0;
    double s = sin(phi), c = cos(phi);
    int beyond;
    double place = spari_table_wrap(annulus->table, side * phi - annulus->twist, &beyond);
    double lift = side * annulus->sigma * spari_table_lift(annulus->table, place, annulus->row);
    spari_balance b;
    b.loss = annulus->tip < 0.0 ? 1.0 : spari_prandtl(annulus->tip, s);
    if (annulus->hub >= 0.0) {
        b.loss *= spari_prandtl(annulus->hub, s);
    }
    double share = lift / (4.0 * b.loss);
    b.g = axial(s, share * c, b.loss);
    b.h = annulus->swirl ? c - spari_swirl_sign(s) * share : c;
    b.residual = annulus->vy * b.g - fabs(annulus->vx) * b.h;
    return b;
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

/* Whether the free flow satisfies the equation, as without lift (cylinders). */
static int is_free(const spari_annulus *annulus) {
    int beyond;
    double place = spari_table_wrap(annulus->table, atan2(annulus->vx, annulus->vy) - annulus->twist, &beyond);
    return spari_table_lift(annulus->table, place, annulus->row) == 0.0;
}

int spari_momentum_solve(const spari_annulus *annulus, double *wx, double *wy) {
    /* Quadrants in the order of likelihood for vy >= 0 (Ning's: windmill, brake, then tangential flow reversed); the
       halves change places for vy < 0. Each begins at the end where the equation changes fastest; the short pieces are
       what lies between two. */
    static const double range[6][2] = {{SPARI_PHI_MIN, M_PI_2},         {-SPARI_PHI_MIN, -M_PI_2},
                                       {-SPARI_PHI_MIN, SPARI_PHI_MIN}, {M_PI - SPARI_PHI_MIN, M_PI_2},
                                       {SPARI_PHI_MIN - M_PI, -M_PI_2}, {M_PI - SPARI_PHI_MIN, M_PI + SPARI_PHI_MIN}};
    double phi, speed;
    *wx = annulus->vx;
    *wy = annulus->vy;
    if (is_free(annulus)) {
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
