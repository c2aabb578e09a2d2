/* Rotations by quaternions, scalar first: [w, x, y, z]. Arrays are contiguous. Outputs may not alias inputs unless
   stated. */
#ifndef SPARI_ROTATION_H
#define SPARI_ROTATION_H

#include <math.h>

/* fmax without a call; x: not NaN */
static inline double spari_larger(double x, double y) {
    return y > x ? y : x;
}

static inline void spari_cross(const double a[3], const double b[3], double c[3]) {
    double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    c[0] = x, c[1] = y, c[2] = z; /* c may be a or b */
}

static inline double spari_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double spari_norm(const double a[3]) {
    return sqrt(spari_dot(a, a));
}

/* s x = a x x, row-major */
static inline void spari_skew(const double a[3], double s[9]) {
    s[0] = s[4] = s[8] = 0;
    s[1] = -a[2], s[2] = a[1], s[5] = -a[0];
    s[3] = a[2], s[6] = -a[1], s[7] = a[0];
}

/* c = a b; c may be a or b */
static inline void spari_quat_mul(const double a[4], const double b[4], double c[4]) {
    double w = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    double x = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    double y = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    double z = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
    c[0] = w, c[1] = x, c[2] = y, c[3] = z;
}

static inline void spari_quat_conj(const double q[4], double c[4]) {
    c[0] = q[0], c[1] = -q[1], c[2] = -q[2], c[3] = -q[3];
}

/* turn = b a*: the rotation from a to b, in global axes; turn may be a or b */
static inline void spari_quat_between(const double a[4], const double b[4], double rotation[4]) {
    double back[4];
    spari_quat_conj(a, back);
    spari_quat_mul(b, back, rotation);
}

static inline double spari_quat_dot(const double a[4], const double b[4]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

static inline void spari_quat_normalise(double q[4]) {
    double s = 1.0 / sqrt(spari_quat_dot(q, q));
    q[0] *= s, q[1] *= s, q[2] *= s, q[3] *= s;
}

/* y = R(q) x for unit q; y may be x */
static inline void spari_rotate(const double q[4], const double x[3], double y[3]) {
    double t[3], s[3];
    spari_cross(q + 1, x, t);
    t[0] *= 2, t[1] *= 2, t[2] *= 2;
    spari_cross(q + 1, t, s);
    for (int i = 0; i < 3; i++) {
        y[i] = x[i] + q[0] * t[i] + s[i];
    }
}

/* y = R(q)^T x for unit q; y may be x */
static inline void spari_rotate_back(const double q[4], const double x[3], double y[3]) {
    double c[4];
    spari_quat_conj(q, c);
    spari_rotate(c, x, y);
}

/* Whether x has a component perpendicular to the unit vector `axis`, beyond rounding. */
static inline int spari_across(const double axis[3], const double x[3]) {
    double part[3];
    spari_cross(axis, x, part);
    return spari_norm(part) > 1e-9 * spari_norm(x);
}

/* y = R x; y may be x. For many vectors this takes half the time of spari_rotate. */
static inline void spari_matrix_times(const double r[9], const double x[3], double y[3]) {
    double a = r[0] * x[0] + r[1] * x[1] + r[2] * x[2], b = r[3] * x[0] + r[4] * x[1] + r[5] * x[2];
    double c = r[6] * x[0] + r[7] * x[1] + r[8] * x[2];
    y[0] = a, y[1] = b, y[2] = c;
}

/* y = R^T x; y may be x */
static inline void spari_matrix_times_back(const double r[9], const double x[3], double y[3]) {
    double a = r[0] * x[0] + r[3] * x[1] + r[6] * x[2], b = r[1] * x[0] + r[4] * x[1] + r[7] * x[2];
    double c = r[2] * x[0] + r[5] * x[1] + r[8] * x[2];
    y[0] = a, y[1] = b, y[2] = c;
}

/* row-major R(q), unit q */
void spari_quat_matrix(const double q[4], double r[9]);
/* unit quaternion of a proper rotation matrix, scalar part >= 0 */
void spari_matrix_quat(const double r[9], double q[4]);
/* exp of the rotation vector; accurate for small and for large angles */
void spari_quat_exp(const double psi[3], double q[4]);
/* rotation vector of the shorter rotation, |psi| <= pi */
void spari_quat_log(const double q[4], double psi[3]);
/* Tangent operator of the exponential map and its inverse, row-major: exp(psi + d psi) = exp(T d psi) exp(psi) to
   first order. */
void spari_tangent(const double psi[3], double t[9]);
void spari_tangent_inverse(const double psi[3], double t[9]);

/* Brings n quaternions q [n][4] (stride in doubles) into one chain of hemispheres, out [n][4]. The result does not
   depend on the input signs: the leading component of the first is made positive, each other follows its
   predecessor. */
void spari_chain(int n, const double *q, int stride, double *out);

#endif
