/* Newton's method of annuli side by side, for one width of vectors (math/lanes.h). Each loop becomes vectors of the
   width that the target has. Lanes are independent and nothing is fused: the same bits at every width, whatever the
   neighbours of an annulus are. */
#include "momentum_kernels.h"

#include "momentum_balance.h"

#ifdef SPARI_HAS_OBJECT
#define SPARI_WIDTH SPARI_OBJECT_WIDTH
#include "../math/width.h"

/* Last relative step of Newton's method. The error left is of the order of its square. */
#define SPARI_NEWTON_STEP 1e-9

TARGET static void NAME(free_flow)(const spari_annuli *restrict a, spari_newton_lanes *restrict w) {
    for (int l = 0; l < SPARI_ANNULI; l++) {
        w->twist[l] = spari_lane_atan2(a->twist_sine[l], a->twist_cosine[l]);
        w->phi[l] = spari_lane_atan2(fabs(a->vx[l]), a->vy[l]);
    }
}

/* Axial induction of momentum theory for small angles; the lift is linear about that of the free flow. */
TARGET static void NAME(guess)(const spari_annuli *restrict a, spari_newton_lanes *restrict w) {
    for (int l = 0; l < SPARI_ANNULI; l++) {
        double vx = fabs(a->vx[l]), vy = a->vy[l], ratio = vy / (vx > 0.0 ? vx : 1.0);
        double load = w->lift[l] * ratio * ratio;
        double relief = 4.0 + (w->lift_rate[l] > 0.0 ? w->lift_rate[l] : 0.0) * ratio;
        double square = relief * relief - 16.0 * load, root = sqrt(square > 0.0 ? square : 0.0);
        double phi = spari_lane_atan2(vx * (1.0 - 2.0 * load / (relief + root)), vy);
        w->phi[l] = phi;
        w->found[l] = 0.0;
        w->active[l] = w->active[l] != 0.0 && phi > SPARI_PHI_MIN && phi < M_PI_2 ? 1.0 : 0.0;
    }
}

TARGET static void NAME(begin)(spari_newton_lanes *restrict w) {
    for (int l = 0; l < SPARI_ANNULI; l++) {
        double s, c;
        spari_lane_sincos(w->phi[l], &s, &c);
        w->s[l] = s;
        w->c[l] = c;
        w->loss[l] = 1.0;
        w->loss_rate[l] = 0.0;
    }
}

TARGET static void NAME(add_loss)(const double *restrict f, spari_newton_lanes *restrict w) {
    for (int l = 0; l < SPARI_ANNULI; l++) {
        spari_inflow_point at = {.s = w->s[l], .c = w->c[l], .loss = w->loss[l], .loss_rate = w->loss_rate[l]};
        spari_add_loss(f[l], &at);
        w->loss[l] = at.loss;
        w->loss_rate[l] = at.loss_rate;
    }
}

HERE void NAME(iterate)(const int swirl, spari_annuli *restrict a, spari_newton_lanes *restrict w) {
    for (int l = 0; l < SPARI_ANNULI; l++) {
        double vx = fabs(a->vx[l]), vy = a->vy[l], phi = w->phi[l], wx = a->wx[l], wy = a->wy[l];
        spari_inflow_point at = {.s = w->s[l],
                                 .c = w->c[l],
                                 .lift = w->lift[l],
                                 .lift_rate = w->lift_rate[l],
                                 .loss = w->loss[l],
                                 .loss_rate = w->loss_rate[l]};
        spari_balance_at(1, swirl, &at);
        double step = (vx * at.h - vy * at.g) / (vy * at.g_rate - vx * at.h_rate);
        double g = at.g + step * at.g_rate, h = at.h + step * at.h_rate;
        double speed = (vx * g + vy * h) / (g * g + h * h), next = phi + step, least = 0.25 * phi;
        double side = a->vx[l] < 0.0 ? -speed : speed;
        next = next > least ? next : least;
        double was = w->active[l], near = fabs(step) <= SPARI_NEWTON_STEP * phi ? was : 0.0;
        double sound = speed > 0.0 ? near : 0.0;
        sound = speed < INFINITY ? sound : 0.0;
        a->wx[l] = sound != 0.0 ? side * (at.s + step * at.c) : wx;
        a->wy[l] = sound != 0.0 ? speed * (at.c - step * at.s) : wy;
        w->found[l] += sound;
        double left = next > SPARI_PHI_MIN ? was - near : 0.0;
        w->active[l] = next < M_PI_2 ? left : 0.0;
        w->phi[l] = was != 0.0 ? next : phi;
    }
}

TARGET static void NAME(step)(spari_annuli *restrict a, spari_newton_lanes *restrict w) {
    if (a->swirl) {
        NAME(iterate)(1, a, w);
    } else {
        NAME(iterate)(0, a, w);
    }
}

TARGET static void NAME(angles)(const double *restrict y, const double *restrict x, double *restrict angle) {
    for (int l = 0; l < SPARI_ANNULI; l++) {
        angle[l] = spari_lane_atan2(y[l], x[l]);
    }
}

const spari_momentum_kernels NAME(spari_momentum_kernels) = {NAME(free_flow), NAME(guess), NAME(begin),
                                                             NAME(add_loss),  NAME(step),  NAME(angles)};

#endif
