#include "plain.h"

#include <math.h>
#include <string.h>

#define PASTE(x, kind) plain_##x##_##kind
#define EXPAND(x, kind) PASTE(x, kind)
#define PLAIN(x) EXPAND(x, PLAIN_KIND)

/* R(q / |q|) c */
static void turn(const double *sum, const double *c, double *r) {
    double s = 1 / sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2] + sum[3] * sum[3]);
    double w = s * sum[0], x = s * sum[1], y = s * sum[2], z = s * sum[3];
    double tx = 2 * (y * c[2] - z * c[1]), ty = 2 * (z * c[0] - x * c[2]), tz = 2 * (x * c[1] - y * c[0]);
    r[0] = c[0] + w * tx + y * tz - z * ty;
    r[1] = c[1] + w * ty + z * tx - x * tz;
    r[2] = c[2] + w * tz + x * ty - y * tx;
}

enum { FIELDS = 13, MOST = 24 };

void PLAIN(motion)(const plain_map *m, double *x, double *v) {
    double node[MOST][FIELDS]; /* place, quaternion, velocities */
    for (int l = 0; l < m->p; l++) {
        for (int i = 0; i < 3; i++) {
            node[l][i] = m->xr[3 * l + i] + m->q[7 * l + i];
        }
        memcpy(node[l] + 3, m->q + 7 * l + 3, 4 * sizeof(double));
        memcpy(node[l] + 7, m->v + 6 * l, 6 * sizeof(double));
    }
    for (int64_t j = 0; j < m->n; j++) {
        const double *phi = m->weight + j * m->p, *c = m->con + 3 * j;
        double s0 = 0, s1 = 0, s2 = 0, q0 = 0, q1 = 0, q2 = 0, q3 = 0, v0 = 0, v1 = 0, v2 = 0, w0 = 0, w1 = 0, w2 = 0;
        for (int l = 0; l < m->p; l++) {
            double f = phi[l];
            const double *a = node[l];
            s0 += f * a[0], s1 += f * a[1], s2 += f * a[2];
            q0 += f * a[3], q1 += f * a[4], q2 += f * a[5], q3 += f * a[6];
            v0 += f * a[7], v1 += f * a[8], v2 += f * a[9];
            w0 += f * a[10], w1 += f * a[11], w2 += f * a[12];
        }
        double q[4] = {q0, q1, q2, q3}, r[3];
        turn(q, c, r);
        x[3 * j] = s0 + r[0], x[3 * j + 1] = s1 + r[1], x[3 * j + 2] = s2 + r[2];
        v[3 * j] = v0 + w1 * r[2] - w2 * r[1];
        v[3 * j + 1] = v1 + w2 * r[0] - w0 * r[2];
        v[3 * j + 2] = v2 + w0 * r[1] - w1 * r[0];
    }
}

void PLAIN(loads)(const plain_map *m, const double *force, double *load) {
    double node[MOST][4], sum[MOST][6] = {{0}};
    for (int l = 0; l < m->p; l++) {
        memcpy(node[l], m->q + 7 * l + 3, sizeof node[l]);
    }
    for (int64_t j = 0; j < m->n; j++) {
        const double *phi = m->weight + j * m->p, *f = force + 3 * j;
        double q0 = 0, q1 = 0, q2 = 0, q3 = 0, r[3];
        for (int l = 0; l < m->p; l++) {
            q0 += phi[l] * node[l][0], q1 += phi[l] * node[l][1];
            q2 += phi[l] * node[l][2], q3 += phi[l] * node[l][3];
        }
        double q[4] = {q0, q1, q2, q3};
        turn(q, m->con + 3 * j, r);
        double m0 = r[1] * f[2] - r[2] * f[1], m1 = r[2] * f[0] - r[0] * f[2], m2 = r[0] * f[1] - r[1] * f[0];
        for (int l = 0; l < m->p; l++) {
            sum[l][0] += phi[l] * f[0], sum[l][1] += phi[l] * f[1], sum[l][2] += phi[l] * f[2];
            sum[l][3] += phi[l] * m0, sum[l][4] += phi[l] * m1, sum[l][5] += phi[l] * m2;
        }
    }
    memcpy(load, sum, sizeof *load * 6 * (size_t)m->p);
}

/* A rigid transfer: x = x_r + R c, v = v_r + omega x R c, c the arm in the reference; nothing but the arms is kept. */
void PLAIN(rigid_motion)(const plain_rigid *m, double *x, double *v) {
    const double *R = m->R, *w = m->omega;
    for (int64_t j = 0; j < m->n; j++) {
        const double *c = m->con + 3 * j;
        double r0 = R[0] * c[0] + R[1] * c[1] + R[2] * c[2], r1 = R[3] * c[0] + R[4] * c[1] + R[5] * c[2],
               r2 = R[6] * c[0] + R[7] * c[1] + R[8] * c[2];
        x[3 * j] = m->x[0] + r0, x[3 * j + 1] = m->x[1] + r1, x[3 * j + 2] = m->x[2] + r2;
        v[3 * j] = m->v[0] + w[1] * r2 - w[2] * r1;
        v[3 * j + 1] = m->v[1] + w[2] * r0 - w[0] * r2;
        v[3 * j + 2] = m->v[2] + w[0] * r1 - w[1] * r0;
    }
}

void PLAIN(rigid_loads)(const plain_rigid *m, const double *force, double load[6]) {
    const double *R = m->R;
    double s0 = 0, s1 = 0, s2 = 0, m0 = 0, m1 = 0, m2 = 0;
    for (int64_t j = 0; j < m->n; j++) {
        const double *c = m->con + 3 * j, *f = force + 3 * j;
        double r0 = R[0] * c[0] + R[1] * c[1] + R[2] * c[2], r1 = R[3] * c[0] + R[4] * c[1] + R[5] * c[2],
               r2 = R[6] * c[0] + R[7] * c[1] + R[8] * c[2];
        s0 += f[0], s1 += f[1], s2 += f[2];
        m0 += r1 * f[2] - r2 * f[1], m1 += r2 * f[0] - r0 * f[2], m2 += r0 * f[1] - r1 * f[0];
    }
    load[0] = s0, load[1] = s1, load[2] = s2, load[3] = m0, load[4] = m1, load[5] = m2;
}
