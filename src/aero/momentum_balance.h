/* The equation of momentum.h at one inflow angle, without branches: for single angles and for lanes. */
#ifndef SPARI_MOMENTUM_BALANCE_H
#define SPARI_MOMENTUM_BALANCE_H

#include "../math/elementary.h"

/* sin phi below which the swirl changes smoothly between the two signs. */
#define SPARI_SWIRL_SINE 0.01
/* exp(-x) is not resolved beyond this x. */
#define SPARI_LOSS_MOST 708.0

/* The equation at one inflow angle; rates are derivatives with respect to the angle. */
typedef struct spari_inflow_point {
    double s, c;                             /* sine and cosine of the angle */
    double lift, lift_rate, loss, loss_rate; /* loss: the product of those in force, 1 without */
    double g, g_rate, h, h_rate;
} spari_inflow_point;

/* Prandtl's factor 2/pi acos(exp(-x)) with x = f / |s|, and its rate. acos(e) is atan2(sqrt(1 - e^2), e), which keeps
   its digits close to e = 1. */
static inline SPARI_ALWAYS_INLINE double spari_loss_at(double f, double s, double c, double *rate) {
    double x = f / fabs(s), e, less;
    x = x > SPARI_LOSS_MOST ? SPARI_LOSS_MOST : x;
    x = f < 0.0 ? 0.0 : x;
    spari_lane_exp(-x, &e, &less);
    double root = sqrt((0.0 - less) * (1.0 + e)), loss = M_2_PI * spari_lane_atan2(root, e);
    double steep = -M_2_PI * e * x * c / (s * (root > 0.0 ? root : 1.0));
    *rate = root > 0.0 ? steep : 0.0;
    return f < 0.0 ? 1.0 : loss;
}

/* g for s >= 0 and K = k s^2, which is finite at s = 0. */
static inline SPARI_ALWAYS_INLINE void spari_windmill(double big_k, double k_rate, spari_inflow_point *at) {
    double s = at->s, s2 = s * s, loss = at->loss;
    double momentum = s + big_k / s, momentum_rate = at->c + (k_rate - big_k * at->c / s) / s;
    momentum = big_k == 0.0 ? s : momentum;
    momentum_rate = big_k == 0.0 ? at->c : momentum_rate;
    double rest = 2.0 * big_k - (4.0 / 3.0 - loss) * s2, square = loss * rest;
    double root = sqrt(square > 0.0 ? square : 0.0);
    double rest_rate = 2.0 * k_rate + at->loss_rate * s2 - 2.0 * (4.0 / 3.0 - loss) * s * at->c;
    double root_rate = 0.5 * (at->loss_rate * rest + loss * rest_rate) / (root > 0.0 ? root : 1.0);
    double buhl = s * (5.0 / 3.0 - loss) + root;
    double buhl_rate = at->c * (5.0 / 3.0 - loss) - s * at->loss_rate + (root > 0.0 ? root_rate : 0.0);
    int64_t light = big_k <= 2.0 / 3.0 * s2;
    at->g = light != 0 ? momentum : buhl;
    at->g_rate = light != 0 ? momentum_rate : buhl_rate;
}

/* g for s < 0, without its rate. */
static inline SPARI_ALWAYS_INLINE double spari_brake(double big_k, const spari_inflow_point *at) {
    double s = at->s, slope = 20.0 / 3.0 - 4.0 * at->loss, brake = s - big_k / s;
    double square = slope * slope * s * s + 32.0 * at->loss * big_k;
    double tangent = 0.25 * (sqrt(square > 0.0 ? square : 0.0) + slope * s);
    return fmin(brake, tangent);
}

/* Smooth sign of sin phi, and its derivative with respect to sin phi. */
static inline SPARI_ALWAYS_INLINE double spari_sign_at(double s, double *rate) {
    double x = s / SPARI_SWIRL_SINE;
    x = x > 1.0 ? 1.0 : x;
    x = x < -1.0 ? -1.0 : x;
    *rate = 1.5 * (1.0 - x * x) / SPARI_SWIRL_SINE;
    return x * (1.5 - 0.5 * x * x);
}

/* Multiplies the loss factor by Prandtl's for f; f < 0: by 1. */
static inline SPARI_ALWAYS_INLINE void spari_add_loss(double f, spari_inflow_point *at) {
    double rate, loss = spari_loss_at(f, at->s, at->c, &rate);
    at->loss_rate = at->loss_rate * loss + at->loss * rate;
    at->loss *= loss;
}

/* Completes a point whose sine, cosine, lift and loss are set. windmill: the sine is known to be positive. */
static inline SPARI_ALWAYS_INLINE void spari_balance_at(const int windmill, int swirl, spari_inflow_point *at) {
    double share = at->lift / (4.0 * at->loss);
    double share_rate = (0.25 * at->lift_rate - share * at->loss_rate) / at->loss;
    double big_k = share * at->c, k_rate = share_rate * at->c - share * at->s;
    if (windmill || at->s >= 0.0) {
        spari_windmill(big_k, k_rate, at);
    } else {
        at->g = spari_brake(big_k, at);
        at->g_rate = 0.0;
    }
    at->h = at->c;
    at->h_rate = -at->s;
    if (swirl) {
        double rate, sign = spari_sign_at(at->s, &rate);
        at->h -= sign * share;
        at->h_rate -= sign * share_rate + rate * at->c * share;
    }
}

#endif
