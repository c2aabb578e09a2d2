/* Computations at W quadrature points at once, one per lane. Included once per width with the macros of
   math/width.h; with W = 1 it is plain C for one point. No include guard: this is a body, not an interface.
   docs/explanation/theory.md, "The beam".
   Lanes are independent. Most of the work uses fused multiply-adds if the processor can: results agree to rounding
     at every width. */
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

/* ---- matrices of the sections ---- */

/* y = J x with the rows xx, xy, xz, yy, yz, zz of a block */
HERE void NAME(symmetric_times)(const double *J, const L *x, L *y) {
    L j[6];
    NAME(rows)(6, J, j);
    y[0] = FUSE(j[2], x[2], FUSE(j[1], x[1], j[0] * x[0]));
    y[1] = FUSE(j[4], x[2], FUSE(j[3], x[1], j[1] * x[0]));
    y[2] = FUSE(j[5], x[2], FUSE(j[4], x[1], j[2] * x[0]));
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

/* ---- inertia and weight ---- */

/* Inertia and gravity of a section: forces, and terms of their tangent. Body axes: A = angular acceleration, h = R^T
   (udd - g), y = A x mc + W x (W x mc), mb = J A + W x J W + mc x h. */
typedef struct NAME(point_inertia) {
    L A[3], A0[3], JW[3], h[3], y[3], mb[3], Wc[3];
} NAME(point_inertia);

/* Weight alone: h = -R^T g, mb = mc x h. mass: the ten rows of the points. */
HERE void NAME(weight_forces)(const double *mass, const spari_regime *how, const NAME(point) * s,
                              NAME(point_inertia) * n) {
    const L none = {0};
    L net[3], mc[3];
    for (int i = 0; i < 3; i++) {
        net[i] = none - how->weight[i];
        n->y[i] = none;
    }
    NAME(rows)(3, mass + SPARI_LANES, mc);
    NAME(rotate_back)(s->r, net, n->h);
    NAME(cross)(mc, n->h, n->mb);
}

HERE void NAME(inertia_forces)(const double *mass, int gyroscopic, const spari_regime *how, const NAME(point) * s,
                               NAME(point_inertia) * n) {
    const double *J = mass + SPARI_LANES * 4;
    L mc[3], net[3], rdd[4], JA[3], x[3];
    NAME(rows)(3, mass + SPARI_LANES, mc);
    NAME(rows)(3, s->f + SPARI_LANES * UDD, net);
    for (int i = 0; i < 3 && how->heavy; i++) {
        net[i] -= how->weight[i];
    }
    for (int i = 0; i < 4; i++) {
        rdd[i] = ROW_OF(s->f, QDD + i) * s->over;
    }
    NAME(imag_conj_mul)(s->r, rdd, n->A0);
    for (int i = 0; i < 3; i++) {
        n->A0[i] *= 2.0;
        n->A[i] = n->A0[i] - 2.0 * s->b * s->omega[i];
    }
    NAME(rotate_back)(s->r, net, n->h);
    NAME(symmetric_times)(J, n->A, JA);
    NAME(cross)(n->A, mc, n->y);
    NAME(cross)(mc, n->h, n->mb);
    for (int i = 0; i < 3; i++) {
        n->mb[i] += JA[i];
    }
    if (gyroscopic) {
        NAME(symmetric_times)(J, s->omega, n->JW);
        NAME(cross)(s->omega, mc, n->Wc);
        NAME(cross)(s->omega, n->Wc, x);
        for (int i = 0; i < 3; i++) {
            n->y[i] += x[i];
        }
        NAME(cross)(s->omega, n->JW, x);
        for (int i = 0; i < 3; i++) {
            n->mb[i] += x[i];
        }
    }
}

/* Adds inertia and weight to the forces on (u, Q). Returns the force, in global axes. */
HERE void NAME(mass_forces)(const double *mass, const NAME(point) * s, const NAME(point_inertia) * n, L *force,
                            L *value) {
    L m4[4];
    for (int i = 0; i < 3; i++) {
        force[i] = FUSE(ROW_OF(mass, 0), n->h[i], n->y[i]);
    }
    NAME(rotate)(s->r, force, force);
    NAME(quat_vec)(s->r, n->mb, m4);
    for (int i = 0; i < 3; i++) {
        value[i] += force[i];
    }
    for (int i = 0; i < 4; i++) {
        value[3 + i] += 2.0 * m4[i] * s->over;
    }
}
