/* Rotations: quaternions, matrices, rotation vectors and their tangent operators. */
#include "rotation.h"

#include <stddef.h>

void spari_quat_matrix(const double q[4], double r[9]) {
    double w = q[0], x = q[1], y = q[2], z = q[3];
    r[0] = 1 - 2 * (y * y + z * z), r[1] = 2 * (x * y - w * z), r[2] = 2 * (x * z + w * y);
    r[3] = 2 * (x * y + w * z), r[4] = 1 - 2 * (x * x + z * z), r[5] = 2 * (y * z - w * x);
    r[6] = 2 * (x * z - w * y), r[7] = 2 * (y * z + w * x), r[8] = 1 - 2 * (x * x + y * y);
}

/* Shepperd's method: the largest component is computed first, so that no small number is divided by. */
void spari_matrix_quat(const double r[9], double q[4]) {
    double trace = r[0] + r[4] + r[8];
    double four[4] = {1 + trace, 1 + 2 * r[0] - trace, 1 + 2 * r[4] - trace, 1 + 2 * r[8] - trace};
    int k = 0;
    for (int i = 1; i < 4; i++) {
        k = four[i] > four[k] ? i : k;
    }
    double big = 0.5 * sqrt(four[k]), s = 0.25 / big;
    double skew[3] = {r[7] - r[5], r[2] - r[6], r[3] - r[1]};
    if (k == 0) {
        q[0] = big, q[1] = skew[0] * s, q[2] = skew[1] * s, q[3] = skew[2] * s;
    } else {
        int i = k - 1, j = (i + 1) % 3, l = (i + 2) % 3;
        q[0] = skew[i] * s;
        q[1 + i] = big;
        q[1 + j] = (r[3 * i + j] + r[3 * j + i]) * s;
        q[1 + l] = (r[3 * i + l] + r[3 * l + i]) * s;
    }
    spari_quat_normalise(q);
    if (q[0] < 0) {
        q[0] = -q[0], q[1] = -q[1], q[2] = -q[2], q[3] = -q[3];
    }
}

void spari_quat_exp(const double psi[3], double q[4]) {
    double half = 0.5 * spari_norm(psi);
    /* sin(h)/(2h): two terms of the series are exact to double precision below 1e-4 */
    double s = half < 1e-4 ? 0.5 * (1 - half * half / 6) : 0.5 * sin(half) / half;
    q[0] = cos(half);
    q[1] = s * psi[0], q[2] = s * psi[1], q[3] = s * psi[2];
}

void spari_quat_log(const double q[4], double psi[3]) {
    double sine = spari_norm(q + 1), sign = q[0] < 0 ? -1.0 : 1.0;
    double s;
    if (sine < 1e-150) {
        s = 2;
    } else {
        s = 2 * atan2(sine, fabs(q[0])) / sine;
    }
    for (int i = 0; i < 3; i++) {
        psi[i] = sign * s * q[1 + i];
    }
}

/* t = I + a psi~ + b psi~ psi~ */
static void spin_polynomial(const double psi[3], double a, double b, double t[9]) {
    double x = psi[0], y = psi[1], z = psi[2];
    t[0] = 1 - b * (y * y + z * z), t[1] = b * x * y - a * z, t[2] = b * x * z + a * y;
    t[3] = b * x * y + a * z, t[4] = 1 - b * (x * x + z * z), t[5] = b * y * z - a * x;
    t[6] = b * x * z - a * y, t[7] = b * y * z + a * x, t[8] = 1 - b * (x * x + y * y);
}

/* T = I + (1 - cos p)/p^2 psi~ + (p - sin p)/p^3 psi~^2, e.g. Geradin & Cardona, Flexible Multibody Dynamics, ch. 4 */
void spari_tangent(const double psi[3], double t[9]) {
    double p2 = spari_dot(psi, psi), a, b;
    if (p2 < 1e-2) { /* the series avoids cancellation in the closed forms */
        a = 0.5 - p2 * (1.0 / 24 - p2 * (1.0 / 720 - p2 * (1.0 / 40320 - p2 / 3628800)));
        b = 1.0 / 6 - p2 * (1.0 / 120 - p2 * (1.0 / 5040 - p2 * (1.0 / 362880 - p2 / 39916800)));
    } else {
        double p = sqrt(p2), s = sin(0.5 * p);
        a = 2 * s * s / p2;
        b = (p - sin(p)) / (p2 * p);
    }
    spin_polynomial(psi, a, b, t);
}

/* T^-1 = I - psi~/2 + (1 - (p/2) cot(p/2))/p^2 psi~^2 */
static double inverse_of_second_order(const double psi[3]) {
    double p2 = spari_dot(psi, psi), half;
    if (p2 < 1e-2) {
        return 1.0 / 12 + p2 * (1.0 / 720 + p2 * (1.0 / 30240 + p2 * (1.0 / 1209600 + p2 / 47900160)));
    }
    half = 0.5 * sqrt(p2);
    return (1 - half * cos(half) / sin(half)) / p2;
}

void spari_tangent_inverse(const double psi[3], double t[9]) {
    spin_polynomial(psi, -0.5, inverse_of_second_order(psi), t);
}

static int is_negative(const double q[4]) {
    for (int i = 0; i < 4; i++) {
        if (q[i] != 0) {
            return q[i] < 0;
        }
    }
    return 0;
}

void spari_chain(int n, const double *q, int stride, double *out) {
    for (int l = 0; l < n; l++) {
        const double *from = q + (ptrdiff_t)l * stride;
        double *to = out + (ptrdiff_t)4 * l, s = 1;
        if (l == 0 ? is_negative(from) : spari_quat_dot(from, to - 4) < 0) {
            s = -1;
        }
        for (int i = 0; i < 4; i++) {
            to[i] = s * from[i];
        }
    }
}
