/* Forces of a body, and its energy: sums over the quadrature points. docs/theory.md, "The beam". */
#include "linear_body.h"
#include "point.h"

/* ---- forces ---- */

/* Nodal force of the 4-vector g: delta q . g = delta theta . 1/2 Im(g q*) */
static void add_moment(const double g[4], const double q[4], double m[3]) {
    double c[4], p[4];
    spari_quat_conj(q, c);
    spari_quat_mul(g, c, p);
    for (int i = 0; i < 3; i++) {
        m[i] += 0.5 * p[1 + i];
    }
}

/* What the point gives back, times its weight: value (u, Q), slope (u', Q'). Returns the size of its forces. */
static double point_forces(const spari_body *body, int k, const spari_regime *how, const double *f, double *back,
                           double *power) {
    spari_point s;
    double *value = back, *slope = back + BACK, w = body->weight[k], scale = 0;
    memset(back, 0, BACK_ROW * sizeof *back);
    spari_point_fields(f, &s);
    if (body->C) {
        spari_point_strain(body, k, how->moving, &s);
        spari_point_elastic_forces(&s, value, slope);
        *power += body->D && how->moving ? w * s.damped : 0;
        scale = spari_norm(s.s) + spari_norm(s.s + 3) / body->length;
    }
    if (how->accelerated || how->heavy) {
        spari_point_inertia n;
        double force[3], m4[4];
        if (how->accelerated) {
            spari_point_inertia_forces(body, k, how, &s, &n);
        } else {
            spari_point_weight(body, k, how, &s, &n);
        }
        for (int i = 0; i < 3; i++) {
            force[i] = n.y[i] + body->mass[10 * (int64_t)k] * n.h[i];
        }
        spari_rotate(s.r, force, force);
        quat_vec(s.r, n.mb, m4);
        for (int i = 0; i < 3; i++) {
            value[i] += force[i];
        }
        for (int i = 0; i < 4; i++) {
            value[3 + i] += 2 * m4[i] / s.N;
        }
        double size = w * (spari_norm(force) + spari_norm(n.mb) / body->length);
        scale = size > scale ? size : scale;
    }
    for (int i = 0; i < BACK_ROW; i++) {
        back[i] *= w;
    }
    return scale;
}

double spari_body_residual(const spari_body *body, const double *q, const double *v, const double *a, double factor,
                           double *r, double *power) {
    return body->linear[0] ? spari_linear_residual(body, q, v, a, factor, r, power)
                           : spari_body_exact_residual(body, q, v, a, factor, r, power);
}

double spari_body_exact_residual(const spari_body *body, const double *q, const double *v, const double *a,
                                 double factor, double *r, double *power) {
    int P = body->per_element;
    const spari_regime how = spari_point_regime(body, v, a, factor);
    double *z = body->scratch, *g = z + (int64_t)P * ROW, *f = g + (int64_t)P * BACK, scale = 0, damped = 0;
    memset(r, 0, (size_t)body->unique * 6 * sizeof *r);
    for (int e = 0; e < body->elements; e++) {
        int first = body->first[e], n = body->first[e + 1] - first;
        double *back = f + (int64_t)n * POINT_ROW;
        spari_point_gather(body, e, q, v, a, z);
        spari_point_interpolate(body, e, z, how.moving, f);
        for (int k = 0; k < n; k++) {
            double size =
                point_forces(body, first + k, &how, f + (int64_t)POINT_ROW * k, back + (int64_t)BACK_ROW * k, &damped);
            scale = size > scale ? size : scale;
        }
        spari_point_collect(body, e, back, g);
        for (int l = 0; l < P; l++) {
            double *rl = r + 6 * ((int64_t)e * (P - 1) + l);
            for (int i = 0; i < 3; i++) {
                rl[i] += g[BACK * l + i];
            }
            add_moment(g + BACK * l + 3, z + ROW * l + Q, rl + 3);
        }
    }
    if (power) {
        *power = damped;
    }
    return scale;
}

/* ---- energy ---- */

void spari_body_energy(const spari_body *body, const double *q, const double *v, double energy[4]) {
    int moving = v != NULL;
    double *z = body->scratch, *f = z + (int64_t)body->per_element * (ROW + BACK);
    memset(energy, 0, 4 * sizeof *energy);
    if (body->linear[0]) {
        spari_linear_energy(body, q, v, energy);
        return;
    }
    for (int e = 0; e < body->elements; e++) {
        spari_point_gather(body, e, q, v, NULL, z);
        spari_point_interpolate(body, e, z, moving, f);
        for (int k = body->first[e]; k < body->first[e + 1]; k++) {
            spari_point s;
            double w = body->weight[k];
            spari_point_fields(f + (int64_t)POINT_ROW * (k - body->first[e]), &s);
            if (body->C) {
                double n[6];
                spari_point_strain(body, k, moving, &s);
                matrix6_times(body->C + 36 * (int64_t)k, s.e, n);
                for (int i = 0; i < 6; i++) {
                    energy[1] += 0.5 * w * n[i] * s.e[i];
                    energy[3] += body->D && moving ? w * s.ed[i] * (s.s[i] - n[i]) : 0;
                }
            }
            if (body->mass) {
                const double *mass = body->mass + 10 * (int64_t)k;
                double vb[3], JW[3], x[3], offset[3];
                spari_rotate_back(s.r, s.f + UD, vb);
                symmetric_times(mass + 4, s.omega, JW);
                spari_cross(s.omega, mass + 1, x);
                spari_rotate(s.r, mass + 1, offset);
                energy[0] += w * (0.5 * mass[0] * spari_dot(vb, vb) + spari_dot(vb, x) + 0.5 * spari_dot(JW, s.omega));
                for (int i = 0; i < 3; i++) {
                    energy[2] -= w * body->gravity[i] * (mass[0] * s.f[U + i] + offset[i] - mass[1 + i]);
                }
            }
        }
    }
}
