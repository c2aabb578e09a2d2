/* The discretised member: forces against the energy they come from, the tangent against finite differences of the
   forces, invariance under rigid motion. Oracles: central differences (error h^2 + eps/h, so 1e-7 of the largest entry
   at h = 1e-5), exact identities (1e-12), and for points side by side the same points one by one, or two by two for the
   tangent (1e-13). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "math/basis.h"
#include "math/rotation.h"
#include "member/body.h"
#include "member/quadrature_point.h"

#include <stdlib.h>
#include <string.h>

static int bodies; /* so far: every second one carries pretension */
static int lanes;  /* of the bodies made next; 0: what the processor has */

static double uniform(void) {
    return 2.0 * rand() / RAND_MAX - 1.0;
}

/* symmetric positive definite n x n */
static void random_spd(int n, double *a) {
    double b[36];
    for (int i = 0; i < n * n; i++) {
        b[i] = uniform();
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            a[n * i + j] = i == j;
            for (int k = 0; k < n; k++) {
                a[n * i + j] += b[n * i + k] * b[n * j + k];
            }
        }
    }
}

static spari_workspace workspace; /* of all bodies */

/* elements of Jacobian 1.1 on the x axis (straight), or with random tangents at the points, random section properties
 */
static spari_body *random_body(int elements, int P, int points, int damped, int straight) {
    int counts[8];
    for (int e = 0; e < elements; e++) {
        counts[e] = points;
    }
    spari_body *b = spari_body_create(elements, P, counts, 1, damped, 1, &workspace, NULL);
    double x[24], bary[24], gx[24], gw[24];
    spari_gll(P, x, NULL, bary);
    spari_gauss(points, gx, gw);
    assert_true(bodies++ % 2 == 0 || spari_body_set_pre(b) == 0);
    b->lanes = lanes;
    b->length = 2.0 * elements;
    b->gravity[0] = 0.3, b->gravity[1] = -1.2, b->gravity[2] = -9.0;
    for (int k = 0; k < elements * points; k++) {
        double bend = straight ? 0 : 0.3, t[3] = {1, bend * uniform(), bend * uniform()}, n = spari_norm(t), c[36];
        int slot = b->slot[k / points] + k % points;
        for (int i = 0; i < 3; i++) {
            t[i] /= n;
        }
        spari_slot_put(b->tangent, 3, slot, t);
        b->weight[slot] = gw[k % points] * 1.1;
        spari_lagrange(P, x, bary, gx[k % points], b->phi + k * P, b->dphi + k * P);
        for (int l = 0; l < P; l++) {
            b->dphi[k * P + l] /= 1.1;
        }
        random_spd(6, c);
        spari_slot_put(b->C, 36, slot, c);
        if (damped) {
            random_spd(6, c);
            spari_slot_put(b->D, 36, slot, c);
        }
        for (int i = 0; i < 6 && b->pre; i++) {
            c[i] = uniform();
        }
        if (b->pre) {
            spari_slot_put(b->pre, 6, slot, c);
        }
        double m[10] = {2 + uniform(), 0.4 * uniform(), 0.4 * uniform(), 0.4 * uniform()};
        random_spd(3, c);
        m[4] = c[0], m[5] = c[1], m[6] = c[2], m[7] = c[4], m[8] = c[5], m[9] = c[8];
        spari_slot_put(b->mass, 10, slot, m);
    }
    spari_body_complete(b);
    return b;
}

typedef struct state {
    double q[7 * 32], v[6 * 32], a[6 * 32], psi[3 * 32], tinv[9 * 32];
} state;

static void random_state(int n, double size, state *s) {
    for (int i = 0; i < n; i++) {
        double turn[3];
        for (int j = 0; j < 3; j++) {
            s->q[7 * i + j] = size * uniform();
            turn[j] = size * uniform();
            s->psi[3 * i + j] = 0.5 * uniform();
        }
        spari_quat_exp(turn, s->q + 7 * i + 3);
        spari_tangent_inverse(s->psi + 3 * i, s->tinv + 9 * i);
        for (int j = 0; j < 6; j++) {
            s->v[6 * i + j] = size * uniform();
            s->a[6 * i + j] = size * uniform();
        }
    }
}

/* moves degree of freedom d by h: q, and v, a with it as the integrator does */
static void disturb(const state *s, int d, double h, double cm, double cv, state *t) {
    int node = d / 6, k = d % 6;
    *t = *s;
    double x[6] = {0};
    if (k < 3) {
        t->q[7 * node + k] += h;
        x[k] = h;
    } else {
        double turn[3] = {0}, p[4];
        turn[k - 3] = h;
        spari_quat_exp(turn, p);
        spari_quat_mul(p, s->q + 7 * node + 3, t->q + 7 * node + 3);
        for (int i = 0; i < 3; i++) {
            x[3 + i] = s->tinv[9 * node + 3 * i + k - 3] * h;
        }
    }
    for (int i = 0; i < 6; i++) {
        t->v[6 * node + i] += cv * x[i];
        t->a[6 * node + i] += cm * x[i];
    }
}

/* Which rates are given: none, velocities, accelerations too. */
enum { AT_REST, WITH_V, WITH_A };

typedef struct tangent_case {
    int elements, P, points, damped, gyroscopic, rates;
    double cm, cv;
} tangent_case;

static void check_tangent(tangent_case c) {
    spari_body *b = random_body(c.elements, c.P, c.points, c.damped, 0);
    int n = b->unique, N = 6 * n, m = 6 * c.P;
    state s, t;
    double *full = calloc((size_t)(N * N), sizeof *full), *S = calloc((size_t)(m * m), sizeof *S), r1[192], r2[192];
    b->gyroscopic = c.gyroscopic;
    random_state(n, 0.6, &s);
    for (int e = 0; e < c.elements; e++) {
        spari_body_tangent(b, e, s.q, c.rates >= WITH_V ? s.v : NULL, c.rates >= WITH_A ? s.a : NULL, 0.7, c.cm, c.cv,
                           s.tinv, S);
        for (int i = 0; i < m; i++) {
            for (int j = 0; j < m; j++) {
                full[N * (6 * e * (c.P - 1) + i) + 6 * e * (c.P - 1) + j] += S[m * i + j];
            }
        }
    }
    double worst = 0, big = 0, h = 1e-5;
    for (int d = 0; d < N; d++) {
        for (int side = 0; side < 2; side++) {
            disturb(&s, d, side ? -h : h, c.cm, c.cv, &t);
            spari_body_residual(b, t.q, c.rates >= WITH_V ? t.v : NULL, c.rates >= WITH_A ? t.a : NULL, 0.7,
                                side ? r2 : r1, NULL);
        }
        for (int i = 0; i < N; i++) {
            double fd = (r1[i] - r2[i]) / (2 * h);
            big = fmax(big, fabs(fd));
            worst = fmax(worst, fabs(fd - full[N * i + d]));
        }
    }
    if (!(worst < 1e-7 * big)) {
        print_error("elements %d P %d points %d damped %d gyro %d rates %d cm %g cv %g: worst %g of %g\n", c.elements,
                    c.P, c.points, c.damped, c.gyroscopic, c.rates, c.cm, c.cv, worst, big);
    }
    assert_true(worst < 1e-7 * big);
    free(full);
    free(S);
    spari_body_free(b);
}

static void test_tangent(void **unused) {
    (void)unused;
    static const tangent_case cases[] = {
        {1, 2, 2, 0, 1, WITH_A, 0, 0},  {1, 4, 4, 0, 1, WITH_A, 3, 0},   {1, 4, 4, 0, 1, WITH_A, 3, 2},
        {1, 4, 4, 0, 0, WITH_A, 3, 2},  {1, 5, 5, 1, 1, WITH_A, 0, 2},   {3, 4, 4, 1, 1, WITH_A, 3, 2},
        {1, 6, 6, 0, 1, AT_REST, 0, 0}, {1, 3, 3, 1, 1, AT_REST, 0, 0},  {2, 5, 7, 1, 1, WITH_V, 0, 2},
        {1, 9, 11, 1, 1, WITH_A, 3, 2}, {1, 11, 10, 0, 1, WITH_A, 3, 2},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        check_tangent(cases[k]);
    }
}

/* r . delta = d(strain energy - gravity work) for a virtual displacement of every node */
static void test_forces_are_the_gradient_of_the_energy(void **unused) {
    (void)unused;
    spari_body *b = random_body(2, 5, 6, 0, 0);
    state s, t;
    double r[192], e1[4], e2[4], h = 1e-5;
    random_state(b->unique, 0.6, &s);
    spari_body_residual(b, s.q, NULL, NULL, 1, r, NULL);
    for (int d = 0; d < 6 * b->unique; d++) {
        disturb(&s, d, h, 0, 0, &t);
        spari_body_energy(b, t.q, NULL, e1);
        disturb(&s, d, -h, 0, 0, &t);
        spari_body_energy(b, t.q, NULL, e2);
        double fd = (e1[1] + e1[2] - e2[1] - e2[2]) / (2 * h);
        assert_true(fabs(fd - r[d]) < 1e-7);
    }
    spari_body_free(b);
}

/* turning the state turns the forces and leaves the energies: 1e-12 of the largest force */
static void test_frame_indifference(void **unused) {
    (void)unused;
    spari_body *b = random_body(2, 5, 6, 1, 1);
    state s, t;
    double r[192], r2[192], e1[4], e2[4], psi[3] = {1.3, -2.2, 0.7}, p[4], big = 0, gll[24];
    random_state(b->unique, 0.6, &s);
    spari_body_residual(b, s.q, s.v, s.a, 0, r, NULL);
    spari_body_energy(b, s.q, s.v, e1);
    spari_quat_exp(psi, p);
    spari_gll(5, gll, NULL, NULL);
    t = s;
    for (int i = 0; i < b->unique; i++) {
        int e = i > 4, l = i - 4 * e;
        double x0[3] = {1.1 * (2 * e + 1 + gll[l]), 0, 0}, x[3];
        for (int j = 0; j < 3; j++) {
            x[j] = x0[j] + s.q[7 * i + j];
        }
        spari_rotate(p, x, x);
        for (int j = 0; j < 3; j++) {
            t.q[7 * i + j] = x[j] - x0[j];
        }
        spari_quat_mul(p, s.q + 7 * i + 3, t.q + 7 * i + 3);
        for (int k = 0; k < 6; k += 3) {
            spari_rotate(p, s.v + 6 * i + k, t.v + 6 * i + k);
            spari_rotate(p, s.a + 6 * i + k, t.a + 6 * i + k);
        }
    }
    spari_body_residual(b, t.q, t.v, t.a, 0, r2, NULL);
    spari_body_energy(b, t.q, t.v, e2);
    for (int i = 0; i < 6 * b->unique; i++) {
        big = fmax(big, fabs(r[i]));
    }
    for (int i = 0; i < 6 * b->unique; i += 3) {
        double f[3];
        spari_rotate(p, r + i, f);
        for (int j = 0; j < 3; j++) {
            assert_true(fabs(f[j] - r2[i + j]) < 1e-12 * big);
        }
    }
    assert_true(fabs(e1[0] - e2[0]) < 1e-12 * e1[0]);
    assert_true(fabs(e1[1] - e2[1]) < 1e-12 * e1[1]);
    assert_true(fabs(e1[3] - e2[3]) < 1e-12 * e1[3]);
    spari_body_free(b);
}

/* the power of the forces is the rate of kinetic and strain energy plus what is dissipated: central difference in time,
 * 1e-6 */
static void test_power_balance(void **unused) {
    (void)unused;
    spari_body *b = random_body(1, 5, 7, 1, 0);
    state s, t;
    double r[192], e0[4], e1[4], e2[4], h = 1e-5, power = 0, *out[2] = {e1, e2};
    memset(b->gravity, 0, sizeof b->gravity);
    random_state(b->unique, 0.6, &s);
    spari_body_residual(b, s.q, s.v, s.a, 0, r, NULL);
    spari_body_energy(b, s.q, s.v, e0);
    for (int i = 0; i < 6 * b->unique; i++) {
        power += r[i] * s.v[i];
    }
    for (int side = 0; side < 2; side++) {
        double dt = side ? -h : h;
        t = s;
        for (int i = 0; i < b->unique; i++) {
            double turn[3], p[4];
            for (int j = 0; j < 3; j++) {
                t.q[7 * i + j] += dt * s.v[6 * i + j] + 0.5 * dt * dt * s.a[6 * i + j];
                turn[j] = dt * s.v[6 * i + 3 + j] + 0.5 * dt * dt * s.a[6 * i + 3 + j];
            }
            spari_quat_exp(turn, p);
            spari_quat_mul(p, s.q + 7 * i + 3, t.q + 7 * i + 3);
            for (int j = 0; j < 6; j++) {
                t.v[6 * i + j] += dt * s.a[6 * i + j];
            }
        }
        spari_body_energy(b, t.q, t.v, out[side]);
    }
    double rate = (e1[0] + e1[1] - e2[0] - e2[1]) / (2 * h) + e0[3];
    assert_true(fabs(rate - power) < 1e-6 * fabs(power));
    spari_body_free(b);
}

/* ---- nodes side by side ---- */

enum { MOST_NODES = 19 };

static void plain_gather(int P, const double *q, const double *v, const double *a, double *z) {
    memset(z, 0, ROW * SPARI_MAX_NODES * sizeof *z);
    double before[4] = {0};
    for (int l = 0; l < P; l++) {
        double ql[4], half[4] = {0}, rate[4] = {0}, d[4] = {0}, dd[4] = {0}, spin[4] = {0}, fields[ROW] = {0};
        double sign = l > 0 && spari_quat_dot(q + 7 * l + 3, before) < 0 ? -1 : 1;
        for (int k = 0; k < 4; k++) {
            before[k] = ql[k] = sign * q[7 * l + 3 + k];
        }
        for (int k = 0; k < 3; k++) {
            half[1 + k] = v ? 0.5 * v[6 * l + 3 + k] : 0;
            rate[1 + k] = v && a ? 0.5 * a[6 * l + 3 + k] : 0;
            fields[U + k] = q[7 * l + k];
            fields[UD + k] = v ? v[6 * l + k] : 0;
            fields[UDD + k] = v && a ? a[6 * l + k] : 0;
        }
        spari_quat_mul(half, ql, d);
        spari_quat_mul(rate, ql, dd);
        spari_quat_mul(half, d, spin);
        for (int k = 0; k < 4; k++) {
            fields[Q + k] = ql[k], fields[QD + k] = d[k], fields[QDD + k] = a ? dd[k] + spin[k] : 0;
        }
        for (int k = 0; k < ROW; k++) {
            z[SPARI_MAX_NODES * k + l] = fields[k];
        }
    }
}

static void plain_add(int P, const double *g, const double *z, double *r) {
    for (int l = 0; l < P; l++) {
        double g4[4], q[4], back[4], p[4];
        spari_point_rotation(z, l, q);
        spari_quat_conj(q, back);
        for (int k = 0; k < 4; k++) {
            g4[k] = g[SPARI_MAX_NODES * (3 + k) + l];
        }
        spari_quat_mul(g4, back, p);
        for (int k = 0; k < 3; k++) {
            r[6 * l + k] += g[SPARI_MAX_NODES * k + l];
            r[6 * l + 3 + k] += 0.5 * p[1 + k];
        }
    }
}

static void assert_near(int n, const double *x, const double *exact) {
    for (int i = 0; i < n; i++) {
        assert_true(fabs(x[i] - exact[i]) <= 1e-15 * 8); /* of numbers of size 1 */
    }
}

static void numbers(int n, double *x) {
    for (int i = 0; i < n; i++) {
        x[i] = uniform();
    }
}

/* Rows and forces of 1 to 19 nodes at every width, nodes in either hemisphere, with and without rates. */
static void test_nodes(void **unused) {
    (void)unused;
    double q[7 * MOST_NODES], v[6 * MOST_NODES], a[6 * MOST_NODES], g[BACK * SPARI_MAX_NODES], r[6 * MOST_NODES + 2];
    double exact[ROW * SPARI_MAX_NODES], z[ROW * SPARI_MAX_NODES] = {0}, sum[6 * MOST_NODES + 2];
    for (int k = 0; k < 9 * MOST_NODES; k++) {
        int P = k / 9 + 1, rates = k % 3;
        spari_body b = {.elements = 1, .per_element = P, .unique = P, .lanes = 2 << (k % 9 / 3)};
        numbers(7 * P, q);
        numbers(6 * P, v);
        numbers(6 * P, a);
        numbers(BACK * SPARI_MAX_NODES, g);
        numbers(6 * P + 2, r);
        for (int l = 0; l < P; l++) {
            spari_quat_normalise(q + 7 * l + 3);
        }
        spari_point_gather(&b, 0, q, rates > 0 ? v : NULL, rates > 1 ? a : NULL, z);
        plain_gather(P, q, rates > 0 ? v : NULL, rates > 1 ? a : NULL, exact);
        for (int row = 0; row < ROW; row++) {
            assert_near(P, z + SPARI_MAX_NODES * row, exact + SPARI_MAX_NODES * row);
        }
        memcpy(sum, r, sizeof r);
        spari_lanes_add(&b, g, z, sum);
        plain_add(P, g, exact, r);
        assert_near(6 * P + 2, sum, r); /* no node beyond the last */
    }
}

/* ---- points side by side ---- */

/* The fields of one point, a block of which only the first lane is used, by plain sums over the nodes. */
static void plain_fields(const spari_body *b, int k, const double *z, double *f) {
    int P = b->per_element;
    memset(f, 0, sizeof(double) * SPARI_LANES * POINT_ROWS);
    for (int l = 0; l < P; l++) {
        for (int i = 0; i < ROW; i++) {
            f[SPARI_LANES * i] += b->phi[k * P + l] * z[SPARI_MAX_NODES * i + l];
        }
        for (int i = 0; i < UDD; i++) {
            f[SPARI_LANES * (DU + i)] += b->dphi[k * P + l] * z[SPARI_MAX_NODES * i + l];
        }
    }
}

/* What the point gives back, value and slope of 7 each. Returns the size of its forces. */
static double plain_point(const spari_body *b, int64_t slot, const spari_regime *how, const double *f, double *value,
                          double *slope, double *power) {
    point_one s = {0};
    double w = b->weight[slot], size = 0;
    const double *mass = b->mass ? SPARI_BLOCK(b->mass, 10, slot) : NULL;
    memset(value, 0, 7 * sizeof *value);
    memset(slope, 0, 7 * sizeof *slope);
    fields_one(how->moving, f, &s);
    if (b->C) {
        strain_one(SPARI_BLOCK(b->tangent, 3, slot), SPARI_BLOCK(b->C, 36, slot), &s);
        beyond_strain_one(how->damped, b, slot, &s);
        elastic_forces_one(&s, value, slope);
        *power += how->damped ? w * s.damped : 0;
        size = spari_norm(s.s) + spari_norm(s.s + 3) / b->length;
    }
    if (how->shown != SPARI_MASSLESS) {
        point_inertia_one n;
        double force[3];
        if (how->shown == SPARI_ACCELERATED) {
            inertia_forces_one(mass, b->gyroscopic, how, &s, &n);
        } else {
            weight_forces_one(mass, how, &s, &n);
        }
        mass_forces_one(mass, &s, &n, force, value);
        size = fmax(size, w * (spari_norm(force) + spari_norm(n.mb) / b->length));
    }
    return size;
}

/* spari_body_residual point by point. */
static double plain_residual(const spari_body *b, const state *s, const double *v, const double *a, double factor,
                             double *r, double *power) {
    const spari_regime how = spari_point_regime(b, v, a, factor);
    int P = b->per_element;
    double z[ROW * SPARI_MAX_NODES], q[4], f[SPARI_LANES * POINT_ROWS], value[7], slope[7], scale = 0;
    memset(r, 0, sizeof *r * 6 * (size_t)b->unique);
    *power = 0;
    for (int e = 0; e < b->elements; e++) {
        double g[24][7] = {{0}};
        spari_point_gather(b, e, s->q, v, a, z);
        for (int k = b->first[e]; k < b->first[e + 1]; k++) {
            int64_t slot = b->slot[e] + k - b->first[e];
            plain_fields(b, k, z, f);
            scale = fmax(scale, plain_point(b, slot, &how, f, value, slope, power));
            for (int l = 0; l < P; l++) {
                for (int i = 0; i < 7; i++) {
                    g[l][i] += b->weight[slot] * (b->phi[k * P + l] * value[i] + b->dphi[k * P + l] * slope[i]);
                }
            }
        }
        for (int l = 0; l < P; l++) {
            double c[4], p[4], *rl = r + 6 * (e * (P - 1) + l);
            spari_point_rotation(z, l, q);
            spari_quat_conj(q, c);
            spari_quat_mul(g[l] + 3, c, p);
            for (int i = 0; i < 3; i++) {
                rl[i] += g[l][i];
                rl[3 + i] += 0.5 * p[1 + i];
            }
        }
    }
    return scale;
}

/* One body in every regime: forces, power and the size of forces to 1e-13 of the largest. */
static void check_lanes(spari_body *b) {
    state s;
    double r[192], exact[192], power, plain_power;
    random_state(b->unique, 0.6, &s);
    for (int regime = 0; regime < 6; regime++) {
        const double *v = regime > 1 ? s.v : NULL, *a = regime > 3 ? s.a : NULL, factor = regime % 2 ? 0.7 : 0;
        double big = 0, scale = spari_body_residual(b, s.q, v, a, factor, r, &power);
        double plain_scale = plain_residual(b, &s, v, a, factor, exact, &plain_power);
        for (int i = 0; i < 6 * b->unique; i++) {
            big = fmax(big, fabs(exact[i]));
        }
        for (int i = 0; i < 6 * b->unique; i++) {
            assert_true(fabs(r[i] - exact[i]) <= 1e-13 * fmax(big, plain_scale));
        }
        assert_true(fabs(scale - plain_scale) <= 1e-13 * plain_scale);
        assert_true(fabs(power - plain_power) <= 1e-13 * plain_power);
    }
}

/* Every width against the points one by one: 1 to 19 points an element, so whole vectors and what remains of them;
   2 to 9 nodes; without damping, without gyroscopic forces, without mass, without stiffness. */
static void test_lanes(void **unused) {
    (void)unused;
    for (lanes = 2; lanes <= SPARI_LANES; lanes *= 2) {
        for (int points = 1; points < 20; points++) {
            spari_body *b = random_body(1 + points % 2, 2 + points % 8, points, points % 3 > 0, 0);
            double *C = b->C, *D = b->D, *mass = b->mass;
            b->gyroscopic = points % 5 > 0;
            check_lanes(b);
            b->mass = NULL;
            check_lanes(b);
            b->mass = mass, b->C = b->D = NULL;
            check_lanes(b);
            b->C = C, b->D = D;
            spari_body_free(b);
        }
    }
    lanes = 0;
}

/* Tangents of one body in every regime, by the portable kernels and by wider ones: to 1e-13 of the largest entry. */
static void check_tangent_lanes(spari_body *b) {
    int m = 6 * b->per_element;
    double *S[2] = {calloc((size_t)(m * m), sizeof(double)), calloc((size_t)(m * m), sizeof(double))};
    state s;
    random_state(b->unique, 0.6, &s);
    for (int regime = 0; regime < 12; regime++) {
        const double *v = regime > 3 ? s.v : NULL, *a = regime > 7 ? s.a : NULL, factor = regime % 2 ? 0.7 : 0;
        double cm = regime % 4 > 1 ? 3 : 0, cv = regime % 4 > 1 ? 2 : 0, big = 0;
        for (int wide = 4; wide <= SPARI_LANES; wide *= 2) {
            for (int k = 0; k < 2; k++) {
                b->lanes = k ? wide : 2;
                spari_body_tangent(b, b->elements - 1, s.q, v, a, factor, cm, cv, s.tinv, S[k]);
            }
            for (int i = 0; i < m * m; i++) {
                big = fmax(big, fabs(S[0][i]));
            }
            for (int i = 0; i < m * m; i++) {
                assert_true(fabs(S[1][i] - S[0][i]) <= 1e-13 * big);
            }
        }
    }
    free(S[0]);
    free(S[1]);
}

/* Every width against the portable kernels, on bodies as of test_lanes; 2 to 12 nodes, so that rows of pairs end in
   one, two or three vectors. */
static void test_tangent_lanes(void **unused) {
    (void)unused;
    for (int points = 1; points < 20; points++) {
        spari_body *b = random_body(1 + points % 2, 2 + points % 11, points, points % 3 > 0, 0);
        double *C = b->C, *D = b->D, *mass = b->mass;
        b->gyroscopic = points % 5 > 0;
        check_tangent_lanes(b);
        b->mass = NULL;
        check_tangent_lanes(b);
        b->mass = mass, b->C = b->D = NULL;
        check_tangent_lanes(b);
        b->C = C, b->D = D;
        spari_body_free(b);
    }
}

/* Slots left over in an element's last block do not count: energies are sums over the points alone, and a body that
   is not finite in one element has finite forces in the others. */
static void test_left_over_slots(void **unused) {
    (void)unused;
    for (lanes = 2; lanes <= SPARI_LANES; lanes *= 2) {
        spari_body *b = random_body(3, 3, 3, 1, 0);
        state s;
        double r[192];
        random_state(b->unique, 0.6, &s);
        s.q[0] = NAN;
        spari_body_residual(b, s.q, s.v, s.a, 1, r, NULL);
        assert_true(isnan(r[0]));
        for (int i = 6 * 3; i < 6 * b->unique; i++) {
            assert_true(isfinite(r[i]));
        }
        spari_body_free(b);
    }
    lanes = 0;
}

/* Tangents with the linear strains of a correction (member/body.h, "Mixed integration points"): without a correction
   those of the state; with one of size h their difference is of second order, a quarter for h / 2. */
static void test_mixed_strains(void **unused) {
    (void)unused;
    for (int damped = 0; damped < 2; damped++) {
        spari_body *b = random_body(2, 4, 5, damped, 0);
        const int n = b->unique, m = 24;
        state s, dx;
        double apart[3] = {0}, *strain = calloc((size_t)(6 * b->slot[2]), sizeof *strain);
        double S[24 * 24], mixed[24 * 24], big = 0;
        spari_body with = *b;
        with.mixed_strain = strain;
        random_state(n, 0.3, &s);
        random_state(n, 1, &dx);
        for (int k = 0; k < 3; k++) {
            const double h = k == 0 ? 0 : k == 1 ? 2e-3 : 1e-3;
            state after = s;
            for (int i = 0; i < n; i++) { /* the correction -h dx.v */
                double psi[3], p[4];
                for (int j = 0; j < 3; j++) {
                    after.q[7 * i + j] -= h * dx.v[6 * i + j];
                    psi[j] = -h * dx.v[6 * i + 3 + j];
                }
                spari_quat_exp(psi, p);
                spari_quat_mul(p, s.q + 7 * i + 3, after.q + 7 * i + 3);
            }
            spari_body_mixed_strains(b, s.q, dx.v, h, strain);
            spari_body_tangent(b, 1, after.q, after.v, NULL, 1, 0, 3, NULL, S);
            spari_body_tangent(&with, 1, after.q, after.v, NULL, 1, 0, 3, NULL, mixed);
            for (int i = 0; i < m * m; i++) {
                big = fmax(big, fabs(S[i]));
                apart[k] = fmax(apart[k], fabs(mixed[i] - S[i]));
            }
        }
        assert_true(apart[0] <= 1e-14 * big && apart[1] > 1e-9 * big);
        assert_true(fabs(apart[1] / apart[2] - 4) < 0.1);
        free(strain);
        spari_body_free(b);
    }
}

/* All the rest at every width. */
static void test_other_widths(void **unused) {
    for (lanes = 2; lanes < SPARI_LANES; lanes *= 2) {
        test_tangent(unused);
        test_forces_are_the_gradient_of_the_energy(unused);
        test_frame_indifference(unused);
        test_power_balance(unused);
        test_mixed_strains(unused);
    }
    lanes = 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tangent),
        cmocka_unit_test(test_forces_are_the_gradient_of_the_energy),
        cmocka_unit_test(test_frame_indifference),
        cmocka_unit_test(test_power_balance),
        cmocka_unit_test(test_nodes),
        cmocka_unit_test(test_lanes),
        cmocka_unit_test(test_tangent_lanes),
        cmocka_unit_test(test_left_over_slots),
        cmocka_unit_test(test_mixed_strains),
        cmocka_unit_test(test_other_widths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
