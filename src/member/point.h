/* What happens at one quadrature point, for the forces, the tangent and the energy of a body: fields of the nodes
   summed to the point, strains, section forces, inertia. docs/theory.md, "The beam". */
#ifndef SPARI_POINT_H
#define SPARI_POINT_H

#include "../math/rotation.h"
#include "body.h"

#include <string.h>

/* ---- small algebra ---- */

/* The 3x4 matrix of x -> Im(q* x), row-major. */
static inline void body_spin(const double q[4], double *l) {
    double w = q[0], x = q[1], y = q[2], z = q[3];
    double m[3][4] = {{-x, w, z, -y}, {-y, -z, w, x}, {-z, y, -x, w}};
    memcpy(l, m, sizeof m);
}

/* Im(a* b) */
static inline void imag_conj_mul(const double a[4], const double b[4], double c[3]) {
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        c[i] = a[0] * b[1 + i] - b[0] * a[1 + i] - (a[1 + j] * b[1 + k] - a[1 + k] * b[1 + j]);
    }
}

/* quaternion product of q and the pure quaternion s */
static inline void quat_vec(const double q[4], const double s[3], double c[4]) {
    double pure[4] = {0, s[0], s[1], s[2]};
    spari_quat_mul(q, pure, c);
}

static inline void symmetric_times(const double j[6], const double x[3], double y[3]) {
    y[0] = j[0] * x[0] + j[1] * x[1] + j[2] * x[2];
    y[1] = j[1] * x[0] + j[3] * x[1] + j[4] * x[2];
    y[2] = j[2] * x[0] + j[4] * x[1] + j[5] * x[2];
}

static inline void matrix6_times(const double *c, const double e[6], double s[6]) {
    for (int i = 0; i < 6; i++) {
        double sum = 0;
        for (int j = 0; j < 6; j++) {
            sum += c[6 * i + j] * e[j];
        }
        s[i] = sum;
    }
}

/* ---- fields ---- */

/* Fields of a node as the elements sum them: u and its two rates, q and its two rates. Rows are padded to whole
 * vectors. */
enum { U = 0, Q = 3, UD = 7, QD = 10, UDD = 14, QDD = 17, ROW = 24 };
/* A row at a quadrature point: values, then derivatives along the line of u, q and their rates. */
enum { DU = ROW, DQ = ROW + 3, DUD = ROW + 7, DQD = ROW + 10, POINT_ROW = ROW + 16 };
/* What a point gives back: what multiplies phi (u, Q), then what multiplies phi' (u', Q'). */
enum { BACK = 8, BACK_ROW = 2 * BACK };

/* Nodal 4-vectors and their rates, z [P][ROW]. Neighbours are brought into one hemisphere, so that an element may turn
   by more than half a revolution from end to end. */
void spari_point_gather(const spari_body *body, int e, const double *q, const double *v, const double *a, double *z);
/* All fields at all points of element e, f [points][POINT_ROW], from its nodes' rows. */
void spari_point_interpolate(const spari_body *body, int e, const double *z, int moving, double *f);
/* g [P][BACK]: what the points give back [points][BACK_ROW], summed onto the nodes. */
void spari_point_collect(const spari_body *body, int e, const double *back, double *g);

/* ---- one point ---- */

/* What the fields are at one point, quaternion parts divided by |Q|. */
typedef struct spari_point {
    const double *f;  /* its row of fields */
    double N;         /* |Q| */
    double r[4];      /* Q / N, unit */
    double p[4];      /* dQ/ds / N */
    double omega[3];  /* body rate 2 Im(r* d) */
    double d[4];      /* Qd / N */
    double T[3];      /* R^T (x0' + u') */
    double e[6];      /* strains */
    double ed[6];     /* strain rates */
    double s[6];      /* section force and moment, turned back to the reference */
    double b;         /* r . d */
    double z[4];      /* dQd/ds / N */
    double t_rate[3]; /* R^T u'-dot */
    double kd0[3];    /* 2 Im(d* p + r* z) */
    double damped;    /* power that damping takes out, per length */
} spari_point;

void spari_point_fields(const double *f, spari_point *s);
/* Strains, their rates and the section forces: e = (R^T (x0' + u') - x0', 2 Im(Q* Q')/|Q|^2) */
void spari_point_strain(const spari_body *body, int k, int moving, spari_point *s);
/* Forces that the strains of a point do work on: gradients of s . e by (u, Q) and (u', Q'). */
void spari_point_elastic_forces(const spari_point *s, double *value, double *slope);

/* What of its mass a section shows. */
typedef struct spari_regime {
    int moving, accelerated; /* rates are given; accelerations too */
    int heavy;
    double weight[3]; /* gravity times its factor */
} spari_regime;

spari_regime spari_point_regime(const spari_body *body, const double *v, const double *a, double factor);

/* Inertia and gravity of a section: forces and what is needed for their tangent. Body axes: A = angular acceleration,
   h = R^T (udd - g), y = A x mc + W x (W x mc), mb = J A + W x J W + mc x h. */
typedef struct spari_point_inertia {
    double A[3], A0[3], JW[3], h[3], y[3], mb[3], Wc[3];
} spari_point_inertia;

/* The weight alone: h = -R^T g, mb = mc x h. */
void spari_point_weight(const spari_body *body, int k, const spari_regime *how, const spari_point *s,
                        spari_point_inertia *n);
void spari_point_inertia_forces(const spari_body *body, int k, const spari_regime *how, const spari_point *s,
                                spari_point_inertia *n);

#endif
