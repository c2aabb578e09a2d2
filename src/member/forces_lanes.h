/* Forces of an element for one vector width: interpolates nodal fields to quadrature points, computes the forces
   there, and sums them to the nodes. Included by element_lanes.c once per width with the macros of math/width.h. No
   include guard: this is a body, not an interface. */
#include "stiffness_damping_lanes.h"
/* uses the one above */
#include "inertia_gravity_lanes.h"

/* ---- from nodes to points: lanes are points ---- */

/* n fields from `first` on at W points: f = sum_l shape_l z_l, with the shape functions or their derivatives. */
HERE void NAME(sum_nodes)(const int n, int P, const double *shape, int first, const double *z, double *f) {
    L sum[7], a = NAME(get)(shape);
    z += SPARI_MAX_NODES * first;
    SPARI_UNROLL
    for (int i = 0; i < n; i++) {
        sum[i] = a * SPLAT(z + SPARI_MAX_NODES * i);
    }
    for (int l = 1; l < P; l++) {
        shape += 2 * SPARI_LANES, z++;
        a = NAME(get)(shape);
        SPARI_UNROLL
        for (int i = 0; i < n; i++) {
            sum[i] = MADD(a, SPLAT(z + SPARI_MAX_NODES * i), sum[i]);
        }
    }
    SPARI_UNROLL
    for (int i = 0; i < n; i++) {
        NAME(put)(f + SPARI_LANES * i, sum[i]);
    }
}

/* The fields `wanted` at W points, from the block of shape functions to the block of fields. */
HERE void NAME(interpolate)(int wanted, int P, const double *shape, const double *z, double *f) {
    const double *slope = shape + SPARI_LANES;
    if (wanted & SPARI_PLACES) {
        NAME(sum_nodes)(7, P, shape, U, z, f + SPARI_LANES * U);
        NAME(sum_nodes)(7, P, shape, UD, z, f + SPARI_LANES * UD);
    } else {
        NAME(sum_nodes)(4, P, shape, Q, z, f + SPARI_LANES * Q);
        if (wanted & SPARI_RATES) {
            NAME(sum_nodes)(4, P, shape, QD, z, f + SPARI_LANES * QD);
        }
    }
    if (wanted & SPARI_ACCELERATIONS) {
        NAME(sum_nodes)(7, P, shape, UDD, z, f + SPARI_LANES * UDD);
    }
    if (wanted & SPARI_SLOPES) {
        NAME(sum_nodes)(7, P, slope, U, z, f + SPARI_LANES * DU);
    }
    if (wanted & SPARI_RATE_SLOPES) {
        NAME(sum_nodes)(7, P, slope, UD, z, f + SPARI_LANES * DUD);
    }
}

TARGET static void NAME(interpolate_block)(int wanted, int P, const double *shape, const double *z, double *f) {
    for (int at = 0; at < SPARI_LANES; at += W) {
        NAME(interpolate)(wanted, P, shape + at, z, f + at);
    }
}

/* ---- forces at points ---- */

/* Adds to a row of the tally. Each lane has its own place, so the order is the same at every width. */
HERE void NAME(tally_sum)(double *row, L x) {
    NAME(put)(row, NAME(get)(row) + x);
}

HERE void NAME(tally_most)(double *row, L x) {
    NAME(put)(row, NAME(larger)(x, NAME(get)(row)));
}

/* Force terms of value (u, Q) and slope (u', Q') times the point's weight w, 14 rows. */
HERE void NAME(give_back)(L w, const L *value, const L *slope, double *back) {
    SPARI_UNROLL
    for (int i = 0; i < 7; i++) {
        NAME(put)(back + SPARI_LANES * i, w * value[i]);
        NAME(put)(back + SPARI_LANES * (BACK + i), w * slope[i]);
    }
}

/* Force terms of a point times its weight: value (u, Q), slope (u', Q'), 14 rows. Adds sizes of forces and power to
   the tally. */
HERE void NAME(point_forces)(const int shown, const spari_body *body, int64_t slot, const spari_regime *how,
                             const double *f, double *back, spari_tally *tally, int at) {
    const double *mass = shown == SPARI_MASSLESS ? NULL : SPARI_BLOCK(body->mass, 10, slot);
    const L none = {0}, w = NAME(get)(body->weight + slot);
    const double per_length = 1 / body->length;
    L value[7], slope[7], scale = none;
    NAME(point) s;
    for (int i = 0; i < 7; i++) {
        value[i] = slope[i] = none;
    }
    NAME(fields)(how->wanted & SPARI_RATES, f, &s);
    if (body->C) {
        NAME(strain)(SPARI_BLOCK(body->tangent, 3, slot), SPARI_BLOCK(body->C, 36, slot), &s);
        if (how->beyond) {
            NAME(beyond_strain)(how->damped, body, slot, &s);
            if (how->damped) {
                NAME(tally_sum)(tally->power + at, w * s.damped);
            }
        }
        NAME(elastic_forces)(&s, value, slope);
        scale = NAME(norm)(s.s) + NAME(norm)(s.s + 3) * per_length;
    }
    if (shown != SPARI_MASSLESS) {
        NAME(point_inertia) n;
        L force[3];
        if (shown == SPARI_ACCELERATED) {
            NAME(inertia_forces)(mass, body->gyroscopic, how, &s, &n);
        } else {
            NAME(weight_forces)(mass, how, &s, &n);
        }
        NAME(mass_forces)(mass, &s, &n, force, value);
        NAME(tally_most)(tally->most + at, w * (NAME(norm)(force) + NAME(norm)(n.mb) * per_length));
    }
    NAME(tally_most)(tally->most + at, scale);
    NAME(give_back)(w, value, slope, back);
}

/* The n points from `slot` on: fields in the block f, results in the blocks back. */
HERE void NAME(element_forces)(const int shown, const spari_body *body, int64_t slot, int n, const spari_regime *how,
                               const double *z, double *f, double *back, spari_tally *tally) {
    int P = body->per_element;
    for (int k = 0; k < n; k += W) {
        int at = k % SPARI_LANES;
        double *to = SPARI_BLOCK(back, BACK_ROWS, k);
        NAME(interpolate)(how->wanted, P, SPARI_BLOCK(body->shape, 2 * P, slot + k), z, f + at);
        NAME(point_forces)(shown, body, slot + k, how, f + at, to, tally, at);
    }
}

/* Variants of a section: without mass, with its weight alone, or with inertia. */
TARGET static void NAME(massless_forces)(const spari_body *body, int64_t slot, int n, const spari_regime *how,
                                         const double *z, double *f, double *back, spari_tally *tally) {
    NAME(element_forces)(SPARI_MASSLESS, body, slot, n, how, z, f, back, tally);
}

TARGET static void NAME(weighed_forces)(const spari_body *body, int64_t slot, int n, const spari_regime *how,
                                        const double *z, double *f, double *back, spari_tally *tally) {
    NAME(element_forces)(SPARI_WEIGHED, body, slot, n, how, z, f, back, tally);
}

TARGET static void NAME(accelerated_forces)(const spari_body *body, int64_t slot, int n, const spari_regime *how,
                                            const double *z, double *f, double *back, spari_tally *tally) {
    NAME(element_forces)(SPARI_ACCELERATED, body, slot, n, how, z, f, back, tally);
}

/* ---- from points to nodes: lanes are nodes ---- */

/* g[7][SPARI_MAX_NODES] = sum over n points of phi times the value terms plus phi' times the slope terms. Lanes past
   the last node hold shape functions of the next point and are not used. */
HERE void NAME(sum_points)(const int sloped, int P, int n, const double *phi, const double *dphi, const double *back,
                           double *g) {
    for (int l = 0; l < P; l += W) {
        L sum[7];
        SPARI_UNROLL
        for (int i = 0; i < 7; i++) {
            sum[i] = (L){0};
        }
        for (int k = 0; k < n; k++) {
            const double *to = SPARI_BLOCK(back, BACK_ROWS, k);
            L a = NAME(get)(phi + (int64_t)k * P + l);
            SPARI_UNROLL
            for (int i = 0; i < 7; i++) {
                sum[i] = MADD(a, SPLAT(to + SPARI_LANES * i), sum[i]);
            }
            if (sloped) {
                L b = NAME(get)(dphi + (int64_t)k * P + l);
                SPARI_UNROLL
                for (int i = 0; i < 7; i++) {
                    sum[i] = MADD(b, SPLAT(to + SPARI_LANES * (BACK + i)), sum[i]);
                }
            }
        }
        SPARI_UNROLL
        for (int i = 0; i < 7; i++) {
            NAME(put)(g + SPARI_MAX_NODES * i + l, sum[i]);
        }
    }
}

TARGET static void NAME(collect)(int sloped, int P, int n, const double *phi, const double *dphi, const double *back,
                                 double *g) {
    if (sloped) {
        NAME(sum_points)(1, P, n, phi, dphi, back, g);
    } else {
        NAME(sum_points)(0, P, n, phi, dphi, back, g);
    }
}
