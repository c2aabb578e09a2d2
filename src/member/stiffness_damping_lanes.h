/* The law of a section at W quadrature points at once, one per lane: strains, and the section forces of stiffness,
   damping and pretension. Included once per width with the macros of math/width.h; with W = 1 it is plain C for one
   point. No include guard: this is a body, not an interface. docs/explanation/theory.md, "The beam".
   Lanes are independent. Most of the work uses fused multiply-adds if the processor can: results agree to rounding at
   every width. */
#include "../math/rotation_lanes.h"

/* Row i of a block: fields of points, or their properties. */
#undef ROW_OF
#define ROW_OF(block, i) NAME(get)((block) + SPARI_LANES * (i))

HERE void NAME(rows)(const int n, const double *block, L *x) {
    SPARI_UNROLL
    for (int i = 0; i < n; i++) {
        x[i] = ROW_OF(block, i);
    }
}

/* s = C e with the 36 rows of a block */
HERE void NAME(matrix6_times)(const double *C, const L *e, L *s) {
    SPARI_UNROLL
    for (int i = 0; i < 6; i++) {
        s[i] = ROW_OF(C, 6 * i) * e[0];
        SPARI_UNROLL
        for (int j = 1; j < 6; j++) {
            s[i] = FUSE(ROW_OF(C, 6 * i + j), e[j], s[i]);
        }
    }
}

/* ---- strains and section forces ---- */

/* Fields at a point, quaternion parts divided by |Q|. */
typedef struct NAME(point) {
    const double *f; /* its block of fields */
    L N, over;       /* |Q|, 1 / |Q| */
    L r[4];          /* Q / N, unit */
    L omega[3];      /* body rate 2 Im(r* d) */
    L d[4];          /* Qd / N */
    L b;             /* r . d */
    L p[4];          /* dQ/ds / N; from here on set by strain */
    L T[3];          /* R^T (x0' + u') */
    L e[6];          /* strains */
    L s[6];          /* section force and moment, rotated back to the reference */
    L z[4];          /* dQd/ds / N; from here on set if damping acts */
    L t_rate[3];     /* R^T u'-dot */
    L kd0[3];        /* 2 Im(d* p + r* z) */
    L ed[6];         /* strain rates */
    L damped;        /* power dissipated by damping, per length */
} NAME(point);

HERE void NAME(fields)(int moving, const double *f, NAME(point) * s) {
    const L none = {0};
    L q[4];
    s->f = f;
    NAME(rows)(4, f + SPARI_LANES * Q, q);
    s->N = NAME(root)(NAME(quat_dot)(q, q));
    s->over = 1.0 / s->N;
    for (int i = 0; i < 4; i++) {
        s->r[i] = q[i] * s->over;
        s->d[i] = moving ? ROW_OF(f, QD + i) * s->over : none;
    }
    s->b = none;
    s->omega[0] = s->omega[1] = s->omega[2] = none;
    if (moving) {
        s->b = NAME(quat_dot)(s->r, s->d);
        NAME(imag_conj_mul)(s->r, s->d, s->omega);
        for (int i = 0; i < 3; i++) {
            s->omega[i] *= 2.0;
        }
    }
}

/* Strain rates, and the section forces of damping D. */
HERE void NAME(strain_rate)(const double *D, NAME(point) * s) {
    L rotation[3], a[3], b[3], sd[6];
    for (int i = 0; i < 4; i++) {
        s->z[i] = ROW_OF(s->f, DQD + i) * s->over;
    }
    NAME(rows)(3, s->f + SPARI_LANES * DUD, s->t_rate);
    NAME(rotate_back)(s->r, s->t_rate, s->t_rate);
    NAME(cross)(s->T, s->omega, rotation);
    NAME(imag_conj_mul)(s->d, s->p, a);
    NAME(imag_conj_mul)(s->r, s->z, b);
    for (int i = 0; i < 3; i++) {
        s->kd0[i] = 2.0 * (a[i] + b[i]);
        s->ed[i] = s->t_rate[i] + rotation[i];
        s->ed[3 + i] = s->kd0[i] - 2.0 * s->e[3 + i] * s->b;
    }
    NAME(matrix6_times)(D, s->ed, sd);
    s->damped = sd[0] * s->ed[0];
    for (int i = 0; i < 6; i++) {
        s->s[i] += sd[i];
        s->damped = i ? s->damped + sd[i] * s->ed[i] : s->damped;
    }
}

/* Strains and the section forces: e = (R^T (x0' + u') - x0', 2 Im(Q* Q')/|Q|^2), with the reference tangent x0' and
   the stiffness C of the points. */
HERE void NAME(strain)(const double *tangent, const double *C, NAME(point) * s) {
    L t[3], kappa[3];
    for (int i = 0; i < 4; i++) {
        s->p[i] = ROW_OF(s->f, DQ + i) * s->over;
    }
    for (int i = 0; i < 3; i++) {
        t[i] = ROW_OF(tangent, i) + ROW_OF(s->f, DU + i);
    }
    NAME(rotate_back)(s->r, t, s->T);
    NAME(imag_conj_mul)(s->r, s->p, kappa);
    for (int i = 0; i < 3; i++) {
        s->e[i] = s->T[i] - ROW_OF(tangent, i);
        s->e[3 + i] = 2.0 * kappa[i];
    }
    NAME(matrix6_times)(C, s->e, s->s);
}

/* Section forces beyond stiffness: pretension, which rotates with the section, and damping. */
HERE void NAME(beyond_strain)(int damped, const spari_body *body, int64_t slot, NAME(point) * s) {
    if (body->pre) {
        const double *pre = SPARI_BLOCK(body->pre, 6, slot);
        for (int i = 0; i < 6; i++) {
            s->s[i] += body->pre_part * ROW_OF(pre, i);
        }
    }
    if (damped) {
        NAME(strain_rate)(SPARI_BLOCK(body->D, 36, slot), s);
    }
}

/* Internal forces: gradients of s . e with respect to (u, Q) and (u', Q'). */
HERE void NAME(elastic_forces)(const NAME(point) * s, L *value, L *slope) {
    L x[3], n4[4], k4[4], pk[4];
    NAME(rotate)(s->r, s->s, slope);
    NAME(cross)(s->s, s->T, x); /* moment of the section force about the section */
    NAME(quat_vec)(s->r, x, n4);
    NAME(quat_vec)(s->r, s->s + 3, k4);
    NAME(quat_vec)(s->p, s->s + 3, pk);
    L dots = NAME(dot)(s->e + 3, s->s + 3);
    for (int i = 0; i < 4; i++) {
        slope[3 + i] = 2.0 * k4[i] * s->over;
        value[3 + i] = 2.0 * FUSE(-dots, s->r[i], n4[i] - pk[i]) * s->over;
    }
}
