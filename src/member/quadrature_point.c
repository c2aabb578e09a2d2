/* Gathers the nodal fields of an element for its quadrature points, and selects the mass variant of a section. */
#include "quadrature_point.h"

/* Velocity of a node relative to the rigid motion of the first; without positions, its absolute velocity. */
static void see_node(const spari_body *body, int64_t node, const double *q, const double *v, double out[6]) {
    double arm[3], carried[3];
    if (!body->node_position) {
        memcpy(out, v + 6 * node, 6 * sizeof *out);
        return;
    }
    for (int i = 0; i < 3; i++) {
        arm[i] = body->node_position[3 * node + i] - body->node_position[i] + (q ? q[7 * node + i] - q[i] : 0);
    }
    spari_cross(v + 3, arm, carried);
    for (int i = 0; i < 3; i++) {
        out[i] = v[6 * node + i] - v[i] - carried[i];
        out[3 + i] = v[6 * node + 3 + i] - v[3 + i];
    }
}

void spari_body_see(const spari_body *body, const double *q, const double *v, double *out) {
    for (int64_t node = 0; node < body->unique; node++) {
        see_node(body, node, q, v, out + 6 * node);
    }
}

/* Mass-proportional damping is the inertia of an acceleration: mass_damping times this velocity. */
static void add_mass_damping(const spari_body *body, int e, const double *q, const double *v, double *z) {
    int P = body->per_element;
    for (int l = 0; l < P; l++) {
        double *zn = z + l, seen[6], half[4] = {0}, at[4], turned[4];
        see_node(body, (int64_t)e * (P - 1) + l, q, v, seen);
        for (int i = 0; i < 3; i++) {
            zn[SPARI_MAX_NODES * (UDD + i)] += body->mass_damping * seen[i];
            half[1 + i] = 0.5 * body->mass_damping * seen[3 + i];
        }
        spari_point_rotation(z, l, at);
        spari_quat_mul(half, at, turned);
        for (int i = 0; i < 4; i++) {
            zn[SPARI_MAX_NODES * (QDD + i)] += turned[i];
        }
    }
}

/* Brings each quaternion, with its rates, into the hemisphere of the one before. */
static void chain_nodes(int P, double *z) {
    for (int l = 1; l < P; l++) {
        double before[4], here[4];
        spari_point_rotation(z, l - 1, before);
        spari_point_rotation(z, l, here);
        for (int i = 0; i < 4 && spari_quat_dot(before, here) < 0; i++) {
            z[SPARI_MAX_NODES * (Q + i) + l] *= -1;
            z[SPARI_MAX_NODES * (QD + i) + l] *= -1;
            z[SPARI_MAX_NODES * (QDD + i) + l] *= -1;
        }
    }
}

void spari_point_gather(const spari_body *body, int e, const double *q, const double *v, const double *a, double *z) {
    int P = body->per_element;
    int64_t first = (int64_t)e * (P - 1);
    if (!v || !a) {
        int from = v ? UDD : UD;
        memset(z + SPARI_MAX_NODES * from, 0, (size_t)(SPARI_MAX_NODES * (ROW - from)) * sizeof *z);
    }
    if (spari_lanes_gather(body, q + 7 * first, v ? v + 6 * first : NULL, v && a ? a + 6 * first : NULL, z)) {
        chain_nodes(P, z);
    }
    if (v && a && body->mass_damping > 0) {
        add_mass_damping(body, e, q, v, z);
    }
}

spari_regime spari_point_regime(const spari_body *body, const double *v, const double *a, double factor) {
    spari_regime how = {.moving = v != NULL, .damped = body->C && body->D && v};
    how.beyond = how.damped || body->pre;
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
