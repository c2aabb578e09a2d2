/* Tangents of an element for one vector width: matrices at points, their sums over points, and the map to nodal
   unknowns. Included by element_lanes.c once per width, after forces_lanes.h. No include guard: this is a body, not
   an interface. docs/explanation/theory.md, "The tangent of a point". */

/* ---- points: lanes are points ---- */

/* Adds x to its place in a row. */
HERE void NAME(add_row)(double *row, L x) {
    NAME(put)(row, NAME(get)(row) + x);
}

/* The columns of the matrix L(q) of x -> Im(q* x). */
HERE void NAME(spins)(const L *q, L (*l)[3]) {
    const L c[4][3] = {{-q[1], -q[2], -q[3]}, {q[0], -q[3], q[2]}, {q[3], q[0], -q[1]}, {-q[2], q[1], q[0]}};
    memcpy(l, c, sizeof c);
}

/* The matrix of x -> x s, a product with a pure quaternion. */
HERE void NAME(right_matrix)(const L *s, L (*m)[4]) {
    const L none = {0};
    const L r[4][4] = {
        {none, -s[0], -s[1], -s[2]}, {s[0], none, s[2], -s[1]}, {s[1], -s[2], none, s[0]}, {s[2], s[1], -s[0], none}};
    memcpy(m, r, sizeof r);
}

/* Derivatives of rotations with respect to Q, by columns: rotation in section axes, 2/N L(r), and body rate at fixed
   Qd. */
typedef struct NAME(point_rotations) {
    L rotation[4][3], rate[4][3];
} NAME(point_rotations);

TARGET static void NAME(turns)(const NAME(point) * s, NAME(point_rotations) * by) {
    L l[4][3];
    NAME(spins)(s->r, by->rotation);
    NAME(spins)(s->d, l);
    for (int j = 0; j < 4; j++) {
        for (int i = 0; i < 3; i++) {
            by->rotation[j][i] *= 2.0 * s->over;
            by->rate[j][i] = -2.0 * s->over * (l[j][i] + s->omega[i] * s->r[j]);
        }
    }
}

/* Derivatives of the strains with respect to Q, u' (first three strains) and Q' (other three), by columns. */
typedef struct NAME(gradient) {
    L q[4][6], du[3][3], dq[4][3];
} NAME(gradient);

TARGET SPARI_APART static void NAME(strain_gradient)(const NAME(point) * s, const NAME(point_rotations) * by,
                                                     NAME(gradient) * J) {
    const L *r = s->r, twice[3] = {2.0 * r[1], 2.0 * r[2], 2.0 * r[3]};
    const L xx = twice[0] * r[1], yy = twice[1] * r[2], zz = twice[2] * r[3], xy = twice[0] * r[2],
            xz = twice[0] * r[3], yz = twice[1] * r[3], wx = twice[0] * r[0], wy = twice[1] * r[0],
            wz = twice[2] * r[0];
    const L R[3][3] = {
        {1.0 - yy - zz, xy - wz, xz + wy}, {xy + wz, 1.0 - xx - zz, yz - wx}, {xz - wy, yz + wx, 1.0 - xx - yy}};
    L l[4][3];
    NAME(spins)(s->p, l);
    memcpy(J->du, R, sizeof R);
    memcpy(J->dq, by->rotation, sizeof by->rotation);
    for (int j = 0; j < 4; j++) {
        NAME(cross)(s->T, by->rotation[j], J->q[j]);
        for (int i = 0; i < 3; i++) {
            J->q[j][3 + i] = -2.0 * s->over * (l[j][i] + s->e[3 + i] * r[j]);
        }
    }
}

/* The same for strain rates, at fixed rates of the fields. */
TARGET SPARI_APART static void NAME(strain_rate_gradient)(const NAME(point) * s, const NAME(point_rotations) * by,
                                                          const NAME(gradient) * J, NAME(gradient) * G) {
    L ld[4][3], lz[4][3], x[3];
    NAME(spins)(s->d, ld);
    NAME(spins)(s->z, lz);
    for (int j = 0; j < 3; j++) {
        NAME(cross)(J->du[j], s->omega, G->du[j]);
    }
    for (int j = 0; j < 4; j++) {
        L along = s->d[j] - 2.0 * s->b * s->r[j];
        NAME(cross)(s->t_rate, by->rotation[j], G->q[j]);
        NAME(cross)(s->T, by->rate[j], x);
        for (int i = 0; i < 3; i++) {
            G->q[j][i] += x[i];
            G->q[j][3 + i] =
                -2.0 * s->over * (lz[j][i] + s->kd0[i] * s->r[j] + s->e[3 + i] * along) - 2.0 * s->b * J->q[j][3 + i];
            G->dq[j][i] = 2.0 * s->over * ld[j][i] - 2.0 * s->b * J->dq[j][i];
        }
        NAME(cross)(J->q[j], s->omega, x);
        for (int i = 0; i < 3; i++) {
            G->q[j][i] += x[i];
        }
    }
}

/* s += n columns of C from `first` on, times x. */
HERE void NAME(add_stress)(const double *C, const int first, const int n, const L *x, L *s) {
    SPARI_UNROLL
    for (int i = 0; i < 6; i++) {
        SPARI_UNROLL
        for (int k = 0; k < n; k++) {
            s[i] = MADD(ROW_OF(C, 6 * i + first + k), x[k], s[i]);
        }
    }
}

HERE L NAME(sum_of)(const int n, const L *a, const L *b) {
    L sum = a[0] * b[0];
    SPARI_UNROLL
    for (int k = 1; k < n; k++) {
        sum = MADD(a[k], b[k], sum);
    }
    return sum;
}

/* w J^T s for stresses s due to Q: column j of the Q, u' and Q' forces. */
HERE void NAME(put_by_q)(const NAME(gradient) * J, const L *s, L w, int j, int64_t ld, double *A) {
    double *down = A + ld * (SLOPE_BY_Q + 7 * j);
    for (int i = 0; i < 4; i++) {
        NAME(add_row)(A + ld * (Q_BY_Q + 4 * i + j), w * NAME(sum_of)(6, J->q[i], s));
        NAME(put)(down + ld * (3 + i), w * NAME(sum_of)(3, J->dq[i], s + 3));
    }
    for (int i = 0; i < 3; i++) {
        NAME(put)(down + ld * i, w * NAME(sum_of)(3, J->du[i], s));
    }
}

/* The same for stresses due to u' or Q': column j. */
HERE void NAME(put_by_slope)(const NAME(gradient) * J, const L *s, L w, int whole, int j, int64_t ld, double *A) {
    const unsigned char(*row)[7] = spari_slope_row[whole];
    for (int i = 0; i < 4 && whole; i++) {
        NAME(put)(A + ld * (Q_BY_SLOPE + 7 * i + j), w * NAME(sum_of)(6, J->q[i], s));
    }
    for (int i = 0; i < (whole ? 7 : j + 1); i++) {
        L x = i < 3 ? NAME(sum_of)(3, J->du[i], s) : NAME(sum_of)(3, J->dq[i - 3], s + 3);
        NAME(put)(A + ld * (SLOPE_BY_SLOPE + row[i][j]), w * x);
    }
}

/* A := w J^T (C J + D G), added to the derivatives of the Q forces with respect to Q; G NULL: without D G. */
TARGET SPARI_APART static void NAME(congruence)(const NAME(gradient) * J, const double *C, const double *D,
                                                const NAME(gradient) * G, const L *weight, int64_t ld, double *A) {
    const L w = *weight;
    for (int j = 0; j < 4; j++) {
        L s[6] = {0};
        NAME(add_stress)(C, 0, 6, J->q[j], s);
        if (G) {
            NAME(add_stress)(D, 0, 6, G->q[j], s);
        }
        NAME(put_by_q)(J, s, w, j, ld, A);
    }
    for (int j = 0; j < 3; j++) {
        L s[6] = {0};
        NAME(add_stress)(C, 0, 3, J->du[j], s);
        if (G) {
            NAME(add_stress)(D, 0, 3, G->du[j], s);
        }
        NAME(put_by_slope)(J, s, w, G != NULL, j, ld, A);
    }
    for (int j = 0; j < 4; j++) {
        L s[6] = {0};
        NAME(add_stress)(C, 3, 3, J->dq[j], s);
        if (G) {
            NAME(add_stress)(D, 3, 3, G->dq[j], s);
        }
        NAME(put_by_slope)(J, s, w, G != NULL, 3 + j, ld, A);
    }
}

/* Derivative with respect to Q of 2/N r m, the Q force of a constant moment m in section axes: column j. */
HERE void NAME(turned_moment)(const NAME(point) * s, const L (*right)[4], const L *rm, int j, L *x) {
    for (int i = 0; i < 4; i++) {
        x[i] = s->over * s->over * (2.0 * right[i][j] - 4.0 * rm[i] * s->r[j]);
    }
}

/* Geometric stiffness: second derivative of s . e(y) at fixed s, added to A. */
TARGET SPARI_APART static void NAME(add_geometric)(const NAME(point) * s, const NAME(point_rotations) * by,
                                                   const L *weight, int whole, int64_t ld, double *A) {
    const L w = *weight;
    const L none = {0}, in2 = s->over * s->over, F = NAME(dot)(s->s, s->T) + NAME(dot)(s->s + 3, s->e + 3);
    L right[4][4], rk[4], grad[4], t[3], x[4], y[4];
    NAME(right_matrix)(s->s + 3, right);
    NAME(quat_vec)(s->r, s->s + 3, rk);
    NAME(quat_vec)(s->p, s->s + 3, grad);
    NAME(rotate)(s->r, s->T, t);
    NAME(quat_vec)(s->r, s->T, x); /* t r = r T */
    NAME(quat_vec)(x, s->s, y);
    for (int i = 0; i < 4; i++) {
        grad[i] = -2.0 * (grad[i] + y[i]);
    }
    const L left[4][4] = {{none, t[0], t[1], t[2]},
                          {-t[0], none, t[2], -t[1]},
                          {-t[1], -t[2], none, t[0]},
                          {-t[2], t[1], -t[0], none}}; /* rows: t times a unit */
    for (int j = 0; j < 4; j++) {
        double *down = A + ld * (SLOPE_BY_Q + 7 * j), *across = A + ld * (Q_BY_SLOPE + 7 * j);
        L column[7];
        NAME(cross)(by->rotation[j], s->s, column);
        NAME(rotate)(s->r, column, column);
        NAME(turned_moment)(s, (const L(*)[4])right, rk, j, column + 3);
        for (int i = 0; i < 7; i++) {
            NAME(add_row)(down + ld * i, w * column[i]);
            if (whole) {
                NAME(add_row)(across + ld * i, w * column[i]);
            }
        }
        NAME(quat_vec)(left[j], s->s, y);
        for (int i = 0; i < 4; i++) {
            L twice = 8.0 * F * s->r[i] * s->r[j] - 2.0 * (y[i] + grad[i] * s->r[j] + s->r[i] * grad[j]);
            NAME(add_row)(A + ld * (Q_BY_Q + 4 * i + j), w * in2 * (i == j ? twice - 2.0 * F : twice));
        }
    }
}

/* Derivative of the inertia force f and moment m, in section axes, with respect to angular acceleration a, body rate
   w and rotation of the section (NULL: none). */
HERE void NAME(inertia_change)(const double *mass, int gyroscopic, const NAME(point) * s, const NAME(point_inertia) * n,
                               const L *a, const L *w, const L *rotation, L *f, L *m) {
    const double *J = mass + SPARI_LANES * 4;
    L mc[3], x[3], y[3] = {0}, g[3] = {0};
    NAME(rows)(3, mass + SPARI_LANES, mc);
    NAME(cross)(a, mc, f);
    NAME(symmetric_times)(J, a, m);
    if (w && gyroscopic) {
        NAME(cross)(w, mc, x);
        NAME(cross)(s->omega, x, y);
        NAME(cross)(w, n->Wc, x);
        for (int i = 0; i < 3; i++) {
            f[i] += x[i] + y[i];
        }
        NAME(symmetric_times)(J, w, x);
        NAME(cross)(s->omega, x, y);
        NAME(cross)(w, n->JW, x);
        for (int i = 0; i < 3; i++) {
            m[i] += x[i] + y[i];
        }
    }
    if (rotation) {
        NAME(cross)(rotation, n->y, x);
        NAME(cross)(n->h, rotation, y);
        NAME(cross)(mc, y, g);
        for (int i = 0; i < 3; i++) {
            f[i] += x[i], m[i] += g[i];
        }
    }
}

/* Column j of the derivative of the (u, Q) forces with respect to Q, through force f and moment m. */
HERE void NAME(add_by_q)(const NAME(point) * s, const NAME(point_rotations) * by, L w, const L *f, const L *m, int j,
                         int64_t ld, double *A) {
    L global[3];
    NAME(rotate)(s->r, f, global);
    for (int i = 0; i < 3; i++) {
        NAME(add_row)(A + ld * (BY_Q + 4 * i + j), w * global[i]);
    }
    for (int i = 0; i < 4; i++) {
        NAME(add_row)(A + ld * (Q_BY_Q + 4 * i + j), w * NAME(dot)(by->rotation[i], m));
    }
}

/* The moment mb of inertia and weight rotates with Q. */
HERE void NAME(add_turned_moment)(const NAME(point) * s, const L *mb, L w, int64_t ld, double *K) {
    L right[4][4], rm[4], x[4];
    NAME(right_matrix)(mb, right);
    NAME(quat_vec)(s->r, mb, rm);
    for (int j = 0; j < 4; j++) {
        NAME(turned_moment)(s, (const L(*)[4])right, rm, j, x);
        for (int i = 0; i < 4; i++) {
            NAME(add_row)(K + ld * (Q_BY_Q + 4 * i + j), w * x[i]);
        }
    }
}

/* Inertia: derivatives with respect to displacements, rates and accelerations. */
TARGET SPARI_APART static void NAME(add_inertia)(const double *mass, int gyroscopic, const NAME(point) * s,
                                                 const NAME(point_rotations) * by, const NAME(point_inertia) * n,
                                                 const L *weight, int64_t ld, double *K, double *B, double *M) {
    const L w = *weight;
    L rdd[4], ldd[4][3], f[3], m[3];
    for (int i = 0; i < 4; i++) {
        rdd[i] = ROW_OF(s->f, QDD + i) * s->over;
    }
    NAME(spins)(rdd, ldd);
    NAME(put)(M + ld * MASS_ROW, w * ROW_OF(mass, 0));
    for (int j = 0; j < 4; j++) {
        L by_q[3], by_qd[3], along = s->d[j] - 2.0 * s->b * s->r[j];
        for (int i = 0; i < 3; i++) {
            by_qd[i] = -2.0 * (s->over * s->omega[i] * s->r[j] + s->b * by->rotation[j][i]);
            by_q[i] =
                -2.0 * s->over * (ldd[j][i] + n->A0[i] * s->r[j] + s->omega[i] * along) - 2.0 * s->b * by->rate[j][i];
        }
        NAME(inertia_change)(mass, gyroscopic, s, n, by->rotation[j], NULL, NULL, f, m);
        NAME(add_by_q)(s, by, w, f, m, j, ld, M);
        if (B) {
            NAME(inertia_change)(mass, gyroscopic, s, n, by_qd, by->rotation[j], NULL, f, m);
            NAME(add_by_q)(s, by, w, f, m, j, ld, B);
        }
        NAME(inertia_change)(mass, gyroscopic, s, n, by_q, by->rate[j], by->rotation[j], f, m);
        NAME(add_by_q)(s, by, w, f, m, j, ld, K);
    }
    NAME(add_turned_moment)(s, n->mb, w, ld, K);
}

/* Weight alone: its moment about the node changes with the rotation of the section. */
TARGET SPARI_APART static void NAME(add_weight)(const double *mass, const NAME(point) * s,
                                                const NAME(point_rotations) * by, const NAME(point_inertia) * n,
                                                const L *weight, int64_t ld, double *K) {
    const L w = *weight;
    const L none[3] = {0};
    L mc[3], m[3];
    NAME(rows)(3, mass + SPARI_LANES, mc);
    for (int j = 0; j < 4; j++) {
        NAME(cross)(n->h, by->rotation[j], m);
        NAME(cross)(mc, m, m);
        NAME(add_by_q)(s, by, w, none, m, j, ld, K);
    }
    NAME(add_turned_moment)(s, n->mb, w, ld, K);
}

/* Clears rows to which others add. */
HERE void NAME(clear_rows)(int rows, int64_t ld, double *A) {
    for (int i = 0; i < rows; i++) {
        NAME(put)(A + ld * i, (L){0});
    }
}

TARGET SPARI_APART static void NAME(elastic_matrices)(const spari_body *body, int64_t slot, const spari_tangent_work *t,
                                                      const NAME(point) * s, const NAME(point_rotations) * by,
                                                      const L *w, int64_t at) {
    const double *C = SPARI_BLOCK(body->C, 36, slot), *D = t->damped ? SPARI_BLOCK(body->D, 36, slot) : NULL;
    NAME(gradient) J, G;
    NAME(strain_gradient)(s, by, &J);
    if (t->whole) {
        NAME(strain_rate_gradient)(s, by, &J, &G);
        NAME(congruence)(&J, C, SPARI_BLOCK(body->D, 36, slot), &G, w, t->slots, t->K + at);
    } else {
        NAME(congruence)(&J, C, NULL, NULL, w, t->slots, t->K + at);
    }
    NAME(add_geometric)(s, by, w, t->whole, t->slots, t->K + at);
    if (D) {
        NAME(congruence)(&J, D, NULL, NULL, w, t->slots, t->B + at);
    }
}

/* Clears the results of strain_rate for undamped sections. */
HERE void NAME(no_strain_rate)(NAME(point) * s) {
    const L none = {0};
    for (int i = 0; i < 4; i++) {
        s->z[i] = none;
    }
    for (int i = 0; i < 3; i++) {
        s->t_rate[i] = s->kd0[i] = none;
    }
}

/* The section forces follow the linear strains of body.h, "Mixed integration points". Those of damping do not: their
   linear strain rates would save one iteration in ten where they are largest. */
HERE void NAME(follow_mixed_strain)(const spari_body *body, int64_t slot, NAME(point) * s) {
    const double *mixed = SPARI_BLOCK(body->mixed_strain, 6, slot);
    L e[6];
    for (int i = 0; i < 6; i++) {
        e[i] = ROW_OF(mixed, i) - s->e[i];
    }
    NAME(add_stress)(SPARI_BLOCK(body->C, 36, slot), 0, 6, e, s->s);
}

/* Matrices and forces of the W points from number `at` of the element on. */
HERE void NAME(point_matrices)(const spari_body *body, int64_t slot, const spari_regime *how,
                               const spari_tangent_work *t, const double *f, int64_t at) {
    const double *mass = body->mass ? SPARI_BLOCK(body->mass, 10, slot) : NULL;
    const L w = NAME(get)(body->weight + slot);
    L value[7] = {0}, slope[7] = {0}, force[3];
    NAME(point) s;
    NAME(point_rotations) by;
    NAME(point_inertia) n;
    NAME(fields)(how->moving, f, &s);
    NAME(no_strain_rate)(&s);
    NAME(turns)(&s, &by);
    NAME(clear_rows)(SLOPE_BY_Q, t->slots, t->K + at);
    if (t->rates) {
        NAME(clear_rows)(SLOPE_BY_Q, t->slots, t->B + at);
    }
    if (t->elastic) {
        NAME(strain)
        (SPARI_BLOCK(body->tangent, 3, slot), SPARI_BLOCK(body->C, 36, slot), &s);
        if (how->beyond) {
            NAME(beyond_strain)(how->damped, body, slot, &s);
        }
        if (body->mixed_strain) {
            NAME(follow_mixed_strain)(body, slot, &s);
        }
        NAME(elastic_forces)(&s, value, slope);
        NAME(elastic_matrices)(body, slot, t, &s, &by, &w, at);
    }
    if (t->masses) {
        NAME(clear_rows)(SLOPE_BY_Q, t->slots, t->M + at);
        NAME(inertia_forces)(mass, body->gyroscopic, how, &s, &n);
        NAME(add_inertia)
        (mass, body->gyroscopic, &s, &by, &n, &w, t->slots, t->K + at, t->rates ? t->B + at : NULL, t->M + at);
        NAME(mass_forces)(mass, &s, &n, force, value);
    } else if (how->heavy) {
        NAME(weight_forces)(mass, how, &s, &n);
        NAME(add_weight)(mass, &s, &by, &n, &w, t->slots, t->K + at);
        NAME(mass_forces)(mass, &s, &n, force, value);
    }
    NAME(give_back)(w, value, slope, SPARI_BLOCK(t->back, BACK_ROWS, at));
}

TARGET static void NAME(element_matrices)(const spari_body *body, int e, const spari_regime *how,
                                          const spari_tangent_work *t) {
    int P = body->per_element;
    int wanted = (how->moving ? SPARI_RATES : 0) | (t->masses ? SPARI_ACCELERATIONS : 0) |
                 (t->elastic ? SPARI_SLOPES : 0) | (how->damped ? SPARI_RATE_SLOPES : 0);
    for (int k = 0; k < t->points; k += W) {
        int64_t slot = body->slot[e] + k;
        double *f = t->f + k % SPARI_LANES;
        NAME(interpolate)(wanted, P, SPARI_BLOCK(body->shape, 2 * P, slot), t->z, f);
        NAME(point_matrices)(body, slot, how, t, f, k);
    }
}

/* ---- sums over the points: lanes are pairs of nodes ---- */

/* Pairs i <= j in one row, j running. Entries written beyond the end for one j are overwritten for the next. */
TARGET static void NAME(pair_products)(const spari_tangent_work *t, const double *phi, const double *dphi) {
    int P = t->P;
    for (int k = 0; k < t->points; k++, phi += P, dphi += P) {
        double *to = t->products + PRODUCTS * t->stride * k;
        for (int i = 0; i < P; to += P - i, i++) {
            for (int j = i; j < P; j += W) {
                L a = NAME(get)(phi + j), b = NAME(get)(dphi + j);
                double *at = to + j - i;
                NAME(put)(at + VALUE_VALUE * t->stride, SPLAT(phi + i) * a);
                NAME(put)(at + VALUE_SLOPE * t->stride, SPLAT(phi + i) * b);
                NAME(put)(at + SLOPE_VALUE * t->stride, SPLAT(dphi + i) * a);
                NAME(put)(at + SLOPE_SLOPE * t->stride, SPLAT(dphi + i) * b);
            }
        }
    }
}

/* Tile of rows and vectors that stay in registers. */
enum { NAME(TILE_ROWS) = W > 4 ? 7 : 4, NAME(TILE_VECTORS) = W > 2 ? 3 : 2 };

HERE void NAME(sum_tile)(const int rows, const int vectors, const spari_tangent_work *t, const double *points,
                         const double *product, double *pairs) {
    const int64_t step = PRODUCTS * t->stride, n = t->points;
    const double *row[7];
    L sum[7][3] = {0}, x[3];
    for (int i = 0; i < rows; i++) {
        row[i] = points + t->slots * i;
    }
    for (int64_t k = 0; k < n; k++, product += step) {
        SPARI_UNROLL
        for (int l = 0; l < vectors; l++) {
            x[l] = NAME(get)(product + W * l);
        }
        SPARI_UNROLL
        for (int i = 0; i < rows; i++) {
            L a = SPLAT(row[i] + k);
            SPARI_UNROLL
            for (int l = 0; l < vectors; l++) {
                sum[i][l] = MADD(a, x[l], sum[i][l]);
            }
        }
    }
    SPARI_UNROLL
    for (int i = 0; i < rows; i++, pairs += t->stride) {
        SPARI_UNROLL
        for (int l = 0; l < vectors; l++) {
            NAME(put)(pairs + W * l, sum[i][l]);
        }
    }
}

/* One strip of pairs, `vectors` wide. */
HERE void NAME(sum_strip)(const int vectors, const spari_tangent_work *t, int rows, const double *points,
                          const double *product, double *pairs) {
    int i = 0;
    for (; i + NAME(TILE_ROWS) <= rows; i += NAME(TILE_ROWS)) {
        NAME(sum_tile)(NAME(TILE_ROWS), vectors, t, points + t->slots * i, product, pairs + t->stride * i);
    }
    for (; i < rows; i++) {
        NAME(sum_tile)(1, vectors, t, points + t->slots * i, product, pairs + t->stride * i);
    }
}

TARGET static void NAME(sum_pairs)(const spari_tangent_work *t, int rows, const double *points, const double *product,
                                   double *pairs) {
    int64_t p = 0;
    for (; p + (NAME(TILE_VECTORS) - 1) * W < t->pairs; p += NAME(TILE_VECTORS) * W) {
        NAME(sum_strip)(NAME(TILE_VECTORS), t, rows, points, product + p, pairs + p);
    }
    if (p + W < t->pairs) {
        NAME(sum_strip)(2, t, rows, points, product + p, pairs + p);
        p += 2 * W;
    } else if (p < t->pairs) {
        NAME(sum_strip)(1, t, rows, points, product + p, pairs + p);
        p += W;
    }
    for (int i = 0; i < rows; i++) { /* vector loads read past the last pair */
        NAME(put)(pairs + t->stride * i + p, (L){0});
    }
}

/* ---- to the unknowns of the nodes: lanes are pairs ---- */

/* Maps of the first and second node of each pair. Entries written beyond the end for one j are overwritten for the
   next. */
HERE void NAME(spread_maps)(const spari_tangent_work *t) {
    const double *from = t->maps;
    for (int row = 0; row < 36; row++, from += t->map_stride) {
        double *first = t->ends[0] + t->stride * row, *second = t->ends[1] + t->stride * row;
        for (int i = 0; i < t->P; first += t->P - i, second += t->P - i, i++) {
            for (int j = i; j < t->P; j += W) {
                NAME(put)(first + j - i, SPLAT(from + i));
                NAME(put)(second + j - i, NAME(get)(from + j));
            }
        }
    }
}

/* One 4 x 3 map of the first (0) or second nodes of the pairs from `at` on. */
HERE void NAME(map_of)(const spari_tangent_work *t, int which, int end, int64_t at, L (*map)[3]) {
    const double *from = t->ends[end] + 12 * t->stride * which + at;
    SPARI_UNROLL
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++, from += t->stride) {
            map[i][k] = NAME(get)(from);
        }
    }
}

/* Row i of the 7 x 7 blocks of stiffness or rates of the pairs from `at` on, (i, j), or with side 1 (j, i). */
HERE void NAME(block_row)(const spari_pair_sums *sums, int64_t stride, int64_t at, int side, const int i, L *x) {
    const double *by_q = sums->by_q + stride * 4 * i + at;
    const L none = {0};
    SPARI_UNROLL
    for (int j = 0; j < 7; j++) {
        x[j] = j < 3 ? none : NAME(get)(by_q + stride * (j - 3));
    }
    if (sums->slopes) {
        const unsigned char *row = spari_slope_row[sums->whole][i];
        const double *from = sums->from[side] + stride * i + at, *slopes = sums->slopes + at;
        SPARI_UNROLL
        for (int j = 0; j < 7; j++) {
            x[j] += NAME(get)(slopes + stride * row[j]);
        }
        SPARI_UNROLL
        for (int j = 0; j < 4; j++) {
            x[3 + j] += NAME(get)(from + stride * 7 * j);
        }
        if (i >= 3) {
            const double *across = sums->across[side] + stride * 7 * (i - 3) + at;
            SPARI_UNROLL
            for (int j = 0; j < 7; j++) {
                x[j] += NAME(get)(across + stride * j);
            }
        }
    }
}

HERE void NAME(mass_row)(const double *of_M, int64_t stride, int64_t at, const int i, L *x) {
    SPARI_UNROLL
    for (int j = 0; j < 7; j++) {
        if (j >= 3) {
            x[j] = NAME(get)(of_M + stride * (4 * i + j - 3) + at);
        } else if (i >= 3) { /* symmetric */
            x[j] = NAME(get)(of_M + stride * (4 * j + i - 3) + at);
        } else {
            x[j] = i == j ? NAME(get)(of_M + stride * MASS_ROW + at) : (L){0};
        }
    }
}

/* y (a row of 6) += x (c u, map theta) */
HERE void NAME(add_columns)(const L *x, double c, const L (*map)[3], L *y) {
    const L times = SPLAT(&c);
    SPARI_UNROLL
    for (int j = 0; j < 3; j++) {
        y[j] = MADD(times, x[j], y[j]);
        SPARI_UNROLL
        for (int k = 0; k < 4; k++) {
            y[3 + j] = MADD(x[3 + k], map[k][j], y[3 + j]);
        }
    }
}

/* Pairs (i, j) from `at` on, or with side 1 (j, i), mapped to the unknowns of the second node: 7 x 6. */
TARGET SPARI_APART static void NAME(columns_of)(const spari_tangent_work *t, int64_t at, int side, L (*y)[6]) {
    L map[3][4][3];
    for (int k = 0; k < 3; k++) {
        NAME(map_of)(t, k, !side, at, map[k]);
    }
    for (int r = 0; r < 7; r++) {
        L x[7], sum[6] = {0};
        NAME(block_row)(&t->of_K, t->stride, at, side, r, x);
        NAME(add_columns)(x, 1, (const L(*)[3])map[0], sum);
        if (t->rates) {
            NAME(block_row)(&t->of_B, t->stride, at, side, r, x);
            NAME(add_columns)(x, t->cv, (const L(*)[3])map[1], sum);
        }
        if (t->masses) {
            NAME(mass_row)(t->of_M, t->stride, at, r, x);
            NAME(add_columns)(x, t->cm, (const L(*)[3])map[2], sum);
        }
        memcpy(y[r], sum, sizeof sum);
    }
}

/* Their 6 x 6 blocks: rows of Q mapped to the first node. where: position of each block in S. */
TARGET SPARI_APART static void NAME(put_blocks)(const spari_tangent_work *t, int64_t at, int side, const int64_t *where,
                                                const L (*y)[6], double *S) {
    const int64_t row = 6 * (int64_t)t->P;
    L map[4][3], x[6];
    NAME(map_of)(t, 0, side, at, map);
    SPARI_UNROLL
    for (int a = 0; a < 6; a++) {
        SPARI_UNROLL
        for (int b = 0; b < 6; b++) {
            x[b] = y[a][b];
            if (a >= 3) {
                x[b] = y[3][b] * map[0][a - 3];
                SPARI_UNROLL
                for (int k = 1; k < 4; k++) {
                    x[b] = MADD(y[3 + k][b], map[k][a - 3], x[b]);
                }
            }
        }
        NAME(drop_rows)(0, where, 1, 6, S + row * a, x);
    }
}

TARGET static void NAME(project)(const spari_tangent_work *t, double *S) {
    const int64_t row = 6 * (int64_t)t->P;
    int64_t where[2][W];
    int i = 0, j = 0;
    NAME(spread_maps)(t);
    for (int64_t at = 0; at < t->pairs; at += W) {
        for (int l = 0; l < W; l++) { /* lanes past the last pair are stored at its position first, and overwritten */
            where[0][l] = 6 * (row * i + j), where[1][l] = 6 * (row * j + i);
            if (at + l + 1 < t->pairs && ++j == t->P) {
                j = ++i;
            }
        }
        for (int side = 0; side < 2; side++) {
            L y[7][6];
            NAME(columns_of)(t, at, side, y);
            NAME(put_blocks)(t, at, side, where[side], (const L(*)[6])y, S);
        }
    }
}
