/* Inertia and gravity of a section at W quadrature points at once, one per lane. Included after
   stiffness_damping_lanes.h, and like it no interface. docs/explanation/theory.md, "The beam". */

/* y = J x with the rows xx, xy, xz, yy, yz, zz of a block */
HERE void NAME(symmetric_times)(const double *J, const L *x, L *y) {
    L j[6];
    NAME(rows)(6, J, j);
    y[0] = FUSE(j[2], x[2], FUSE(j[1], x[1], j[0] * x[0]));
    y[1] = FUSE(j[4], x[2], FUSE(j[3], x[1], j[1] * x[0]));
    y[2] = FUSE(j[5], x[2], FUSE(j[4], x[1], j[2] * x[0]));
}

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
