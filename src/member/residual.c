/* Forces and energy of a body: sums over quadrature points; and its linear strains. docs/explanation/theory.md, "The
 * beam". */
#include "../base/thread_pool.h"
#include "../math/basis.h"
#include "quadrature_point.h"

/* ---- forces ---- */

/* What the forces of elements are asked of. */
typedef struct force_state {
    spari_regime how;
    const double *q, *v, *a;
    double *r;
} force_state;

static void add_forces(const spari_body *body, int tile, int from, int to, void *context) {
    const force_state *s = context;
    double *z = spari_body_scratch(body), *g = z + ROW * SPARI_MAX_NODES, *f = g + BACK * SPARI_MAX_NODES,
           *back = f + SPARI_LANES * POINT_ROWS, *sum = body->tally + 2 * (int64_t)tile;
    spari_tally tally = {{0}, {0}};
    for (int e = from; e < to; e++) {
        spari_point_gather(body, e, s->q, s->v, s->a, z);
        spari_lanes_forces(body, e, &s->how, z, f, back, &tally);
        spari_lanes_collect(body, e, back, g);
        spari_lanes_add(body, g, z, s->r + 6 * (int64_t)e * (body->per_element - 1));
    }
    sum[0] = sum[1] = 0;
    for (int i = 0; i < SPARI_LANES; i++) {
        sum[0] = tally.most[i] > sum[0] ? tally.most[i] : sum[0];
        sum[1] += tally.power[i];
    }
}

/* Forces of a rigid body of one node, as inertia_gravity_lanes.h has them for a point. Returns the size of their terms,
   which balance each other in a free motion. */
static double forces_of_one(const spari_body *body, const spari_regime *how, const double *q, const double *v,
                            const double *a, double r[6]) {
    const double *mass = body->mass, *rotation = q + 3;
    const double m = mass[0], mc[3] = {mass[SPARI_LANES], mass[2 * SPARI_LANES], mass[3 * SPARI_LANES]};
    const int moves = how->shown == SPARI_ACCELERATED;
    double net[3], h[3], y[3] = {0}, moment[3], force[3], size = 0, turning = 0;
    for (int i = 0; i < 3; i++) {
        net[i] = (moves ? a[i] : 0) - how->weight[i];
    }
    spari_rotate_back(rotation, net, h);
    spari_cross(mc, h, moment);
    size = m * (spari_norm(how->weight) + (moves ? spari_norm(a) : 0));
    turning = spari_norm(moment);
    if (moves) {
        double A[3], W[3], JA[3], JW[3], x[3], z[3];
        spari_rotate_back(rotation, a + 3, A);
        symmetric_times_one(mass + SPARI_LANES * 4, A, JA);
        spari_cross(A, mc, y);
        size += spari_norm(y);
        turning += spari_norm(JA);
        if (body->gyroscopic) {
            spari_rotate_back(rotation, v + 3, W);
            symmetric_times_one(mass + SPARI_LANES * 4, W, JW);
            spari_cross(W, mc, x);
            spari_cross(W, x, z);
            spari_cross(W, JW, x);
            size += spari_norm(z);
            turning += spari_norm(x);
        }
        for (int i = 0; i < 3; i++) {
            y[i] += body->gyroscopic ? z[i] : 0;
            moment[i] += JA[i] + (body->gyroscopic ? x[i] : 0);
        }
    }
    for (int i = 0; i < 3; i++) {
        force[i] = body->weight[0] * (m * h[i] + y[i]);
        moment[i] *= body->weight[0];
    }
    spari_rotate(rotation, force, r);
    spari_rotate(rotation, moment, r + 3);
    return body->weight[0] * (size + turning / body->length);
}

/* Power of mass-proportional damping: twice mass_damping times the kinetic energy of the motion relative to the first
 * node. */
static double mass_damping_power(const spari_body *body, const double *q, const double *v) {
    double energy[4];
    spari_body_see(body, q, v, body->seen);
    spari_body_energy(body, q, body->seen, energy);
    return 2 * body->mass_damping * energy[0];
}

enum { CLEARED = 256 };

static void clear_forces(void *context, int64_t from, int64_t to) {
    double *r = context;
    memset(r + 6 * from, 0, (size_t)(6 * (to - from)) * sizeof *r);
}

double spari_body_residual(const spari_body *body, const double *q, const double *v, const double *a, double factor,
                           double *r, double *power) {
    force_state s = {.how = spari_point_regime(body, v, a, factor), .q = q, .v = v, .a = a, .r = r};
    double scale = 0, damped = 0;
    if (body->unique == 1 && s.how.shown != SPARI_MASSLESS && !body->C) {
        if (power) {
            *power = 0;
        }
        return forces_of_one(body, &s.how, q, v, a, r);
    }
    spari_thread_pool_spread(body->pool ? *body->pool : NULL, body->unique, CLEARED, clear_forces, r);
    spari_body_sweep(body, add_forces, &s);
    for (int64_t tile = 0; tile < spari_body_tiles(body); tile++) {
        const double *sum = body->tally + 2 * tile;
        scale = sum[0] > scale ? sum[0] : scale;
        damped += sum[1];
    }
    if (power) {
        *power = damped + (v && a && body->mass_damping > 0 ? mass_damping_power(body, q, v) : 0);
    }
    return scale;
}

/* ---- energy ---- */

static void add_strain_energy(const spari_body *body, int64_t slot, double w, int damped, point_one *s,
                              double energy[4]) {
    strain_one(SPARI_BLOCK(body->tangent, 3, slot), SPARI_BLOCK(body->C, 36, slot), s);
    for (int i = 0; i < 6; i++) {
        double before = body->pre ? SPARI_BLOCK(body->pre, 6, slot)[SPARI_LANES * i] : 0;
        energy[1] += w * (0.5 * s->s[i] + before) * s->e[i];
    }
    if (damped) {
        beyond_strain_one(1, body, slot, s);
        energy[3] += w * s->damped;
    }
}

static void add_mass_energy(const spari_body *body, int64_t slot, double w, const point_one *s, double energy[4]) {
    double mass[10], u[3], ud[3], vb[3], JW[3], x[3], offset[3];
    spari_slot_get(body->mass, 10, slot, mass);
    rows_one(3, s->f + SPARI_LANES * U, u);
    rows_one(3, s->f + SPARI_LANES * UD, ud);
    spari_rotate_back(s->r, ud, vb);
    symmetric_times_one(SPARI_BLOCK(body->mass, 10, slot) + SPARI_LANES * 4, s->omega, JW);
    spari_cross(s->omega, mass + 1, x);
    spari_rotate(s->r, mass + 1, offset);
    energy[0] += w * (0.5 * mass[0] * spari_dot(vb, vb) + spari_dot(vb, x) + 0.5 * spari_dot(JW, s->omega));
    for (int i = 0; i < 3; i++) {
        energy[2] -= w * body->gravity[i] * (mass[0] * u[i] + offset[i] - mass[1 + i]);
    }
}

void spari_body_energy(const spari_body *body, const double *q, const double *v, double energy[4]) {
    int damped = body->C && body->D && v;
    int wanted = SPARI_PLACES | (body->C ? SPARI_SLOPES : 0) | (damped ? SPARI_RATE_SLOPES : 0);
    double *z = spari_body_scratch(body), *f = z + ROW * SPARI_MAX_NODES;
    memset(energy, 0, 4 * sizeof *energy);
    for (int e = 0; e < body->elements; e++) {
        spari_point_gather(body, e, q, v, NULL, z);
        spari_lanes_interpolate(body, e, wanted, z, f);
        for (int k = 0; k < body->first[e + 1] - body->first[e]; k++) {
            int64_t slot = body->slot[e] + k;
            double w = body->weight[slot];
            point_one s;
            fields_one(v != NULL, SPARI_BLOCK(f, POINT_ROWS, k), &s);
            if (body->C) {
                add_strain_energy(body, slot, w, damped, &s, energy);
            }
            if (body->mass) {
                add_mass_energy(body, slot, w, &s, energy);
            }
        }
    }
}

/* ---- mixed integration points ---- */

/* The correction of an iterate, and its linear strains. */
typedef struct strain_state {
    const double *q, *dq;
    double part, *strain;
} strain_state;

static void put_mixed_strains(const spari_body *body, int tile, int from, int to, void *context) {
    static const double none[36 * SPARI_LANES] = {0}; /* without section forces */
    const strain_state *state = context;
    double *z = spari_body_scratch(body), *f = z + ROW * SPARI_MAX_NODES;
    (void)tile;
    for (int e = from; e < to; e++) {
        spari_point_gather(body, e, state->q, state->dq, NULL, z);
        spari_lanes_interpolate(body, e, SPARI_RATES | SPARI_SLOPES | SPARI_RATE_SLOPES, z, f);
        for (int k = 0; k < body->first[e + 1] - body->first[e]; k++) {
            int64_t slot = body->slot[e] + k;
            double *strain = SPARI_BLOCK(state->strain, 6, slot);
            point_one s;
            fields_one(1, SPARI_BLOCK(f, POINT_ROWS, k), &s);
            strain_one(SPARI_BLOCK(body->tangent, 3, slot), none, &s);
            strain_rate_one(none, &s);
            for (int i = 0; i < 6; i++) {
                strain[SPARI_LANES * i] = s.e[i] - state->part * s.ed[i];
            }
        }
    }
}

void spari_body_mixed_strains(const spari_body *body, const double *q, const double *dq, double part, double *strain) {
    spari_body_sweep(body, put_mixed_strains, &(strain_state){q, dq, part, strain});
}

/* ---- centre of mass ---- */

static void add_center(const spari_body *body, int64_t slot, const double *position, const point_one *s, double *mass,
                       double center[6]) {
    double m[10], u[3], ud[3], x[3], spin[3], offset[3];
    const double w = body->weight[slot];
    spari_slot_get(body->mass, 10, slot, m);
    rows_one(3, s->f + SPARI_LANES * U, u);
    rows_one(3, s->f + SPARI_LANES * UD, ud);
    spari_cross(s->omega, m + 1, x);
    spari_rotate(s->r, x, spin);
    spari_rotate(s->r, m + 1, offset);
    *mass += w * m[0];
    for (int i = 0; i < 3; i++) {
        center[i] += w * (m[0] * (position[i] + u[i]) + offset[i]);
        center[3 + i] += w * (m[0] * ud[i] + spin[i]);
    }
}

double spari_body_center(const spari_body *body, const double *q, const double *v, double center[6]) {
    double *z = spari_body_scratch(body), *f = z + ROW * SPARI_MAX_NODES, mass = 0;
    memset(center, 0, 6 * sizeof *center);
    for (int e = 0; e < body->elements && body->mass; e++) {
        spari_point_gather(body, e, q, v, NULL, z);
        spari_lanes_interpolate(body, e, SPARI_PLACES, z, f);
        for (int k = 0; k < body->first[e + 1] - body->first[e]; k++) {
            point_one s;
            fields_one(1, SPARI_BLOCK(f, POINT_ROWS, k), &s);
            add_center(body, body->slot[e] + k, body->position + 3 * (int64_t)(body->first[e] + k), &s, &mass, center);
        }
    }
    for (int i = 0; i < 6 && mass > 0; i++) {
        center[i] /= mass;
    }
    return mass;
}
