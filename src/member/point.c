/* What quadrature points are given: the fields of an element's nodes, and what of its mass a section shows. */
#include "point.h"

#include "../math/basis.h"

/* Nodal 4-vectors and their rates: q' = 1/2 w q, q'' = 1/2 alpha q + 1/2 w q'. */
void spari_point_gather(const spari_body *body, int e, const double *q, const double *v, const double *a, double *z) {
    int P = body->per_element;
    for (int l = 0; l < P; l++) {
        int64_t node = (int64_t)e * (P - 1) + l;
        const double *qn = q + 7 * node;
        double *zn = z + ROW * l, *ql = zn + Q;
        memset(zn, 0, ROW * sizeof *zn);
        memcpy(zn + U, qn, 3 * sizeof *zn);
        double sign = l > 0 && spari_quat_dot(qn + 3, ql - ROW) < 0 ? -1.0 : 1.0;
        for (int i = 0; i < 4; i++) {
            ql[i] = sign * qn[3 + i];
        }
        if (v) {
            const double *vn = v + 6 * node;
            double half[4] = {0, 0.5 * vn[3], 0.5 * vn[4], 0.5 * vn[5]};
            memcpy(zn + UD, vn, 3 * sizeof *zn);
            spari_quat_mul(half, ql, zn + QD);
            if (a) {
                const double *an = a + 6 * node;
                double half_rate[4] = {0, 0.5 * an[3], 0.5 * an[4], 0.5 * an[5]}, spin[4];
                memcpy(zn + UDD, an, 3 * sizeof *zn);
                spari_quat_mul(half_rate, ql, zn + QDD);
                spari_quat_mul(half, zn + QD, spin);
                for (int i = 0; i < 4; i++) {
                    zn[QDD + i] += spin[i];
                }
            }
        }
    }
}

spari_regime spari_point_regime(const spari_body *body, const double *v, const double *a, double factor) {
    spari_regime how = {.moving = v != NULL, .damped = body->C && body->D && v};
    for (int i = 0; i < 3; i++) {
        how.weight[i] = factor * body->gravity[i];
        how.heavy = how.heavy || (how.weight[i] != 0 && body->mass);
    }
    how.shown = v && a && body->mass ? SPARI_ACCELERATED : how.heavy ? SPARI_WEIGHED : SPARI_MASSLESS;
    if (how.damped || how.shown == SPARI_ACCELERATED) {
        how.wanted |= SPARI_RATES;
    }
    how.wanted |= how.shown == SPARI_ACCELERATED ? SPARI_ACCELERATIONS : 0;
    how.wanted |= body->C ? SPARI_SLOPES : 0;
    how.wanted |= how.damped ? SPARI_RATE_SLOPES : 0;
    return how;
}
