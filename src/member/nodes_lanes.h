/* Nodes of an element, W at once: converts nodal motion to fields, and field forces to nodal forces. Included by
   element_lanes.c once per width with the macros of math/width.h. No include guard: this is a body, not an
   interface.
   Nodal arrays store the numbers of a node contiguously; the rows z [ROW][SPARI_MAX_NODES] and g
     [BACK][SPARI_MAX_NODES] store nodes contiguously. Nothing is fused: the same bits at every width. */

HERE void NAME(put_row)(const int n, int row, const L *x, double *z) {
    SPARI_UNROLL
    for (int i = 0; i < n; i++) {
        NAME(put)(z + SPARI_MAX_NODES * (row + i), x[i]);
    }
}

HERE void NAME(get_row)(const int n, int row, const double *z, L *x) {
    SPARI_UNROLL
    for (int i = 0; i < n; i++) {
        x[i] = NAME(get)(z + SPARI_MAX_NODES * (row + i));
    }
}

/* Positions and quaternions, and their rates: q' = 1/2 w q, q'' = 1/2 alpha q + 1/2 w q'. */
HERE void NAME(put_fields)(const int whole, const int64_t *at, const double *q, const double *v, const double *a,
                           double *z) {
    L position[7], rate[6], half[3], rotation[4], spin[4];
    NAME(pick_rows)(whole, at, 7, 7, q, position);
    NAME(put_row)(7, U, position, z);
    if (!v) {
        return;
    }
    NAME(pick_rows)(whole, at, 6, 6, v, rate);
    for (int i = 0; i < 3; i++) {
        half[i] = 0.5 * rate[3 + i];
    }
    NAME(vec_quat)(half, position + Q, rotation);
    NAME(put_row)(3, UD, rate, z);
    NAME(put_row)(4, QD, rotation, z);
    if (!a) {
        return;
    }
    NAME(vec_quat)(half, rotation, spin);
    NAME(pick_rows)(whole, at, 6, 6, a, rate);
    for (int i = 0; i < 3; i++) {
        half[i] = 0.5 * rate[3 + i];
    }
    NAME(vec_quat)(half, position + Q, rotation);
    for (int i = 0; i < 4; i++) {
        rotation[i] = rotation[i] + spin[i];
    }
    NAME(put_row)(3, UDD, rate, z);
    NAME(put_row)(4, QDD, rotation, z);
}

/* Whether one of W quaternions from `first` on is in the other hemisphere than the one before it. Entries beyond
   them must be numbers. */
HERE int NAME(are_opposed)(int first, const double *z) {
    L q[4], before[4], none = {0};
    int from = first > 0 ? first : 1;
    NAME(get_row)(4, Q, z + from, q);
    NAME(get_row)(4, Q, z + from - 1, before);
    return NAME(any_above)(none, NAME(quat_dot)(q, before));
}

/* The first W of `left` nodes from `first` on, of arrays that begin with the element's first node. Returns whether
   one is in another hemisphere than its neighbour. */
TARGET static int NAME(gather_nodes)(int first, int left, const double *q, const double *v, const double *a,
                                     double *z) {
    int64_t at[W];
    q += 7 * first, v = v ? v + 6 * first : NULL, a = a ? a + 6 * first : NULL;
    if (first == 0) { /* the last is compared with the entry after it */
        for (int i = 0; i < 4; i++) {
            z[SPARI_MAX_NODES * (Q + i) + W] = 0;
        }
    }
    if (NAME(next_nodes)(left, at)) {
        NAME(put_fields)(1, at, q, v, a, z + first);
    } else {
        NAME(put_fields)(0, at, q, v, a, z + first);
    }
    return NAME(are_opposed)(first, z);
}

/* Nodal forces from the seven field forces: delta q . g = delta theta . 1/2 Im(g q*). Lanes past the last node are
   overwritten. */
HERE void NAME(add_block)(const int whole, const int64_t *at, const double *g, const double *z, double *r) {
    L q[4], back[BACK], rotation[4], sum[6];
    NAME(get_row)(BACK, 0, g, back);
    NAME(get_row)(4, Q, z, q);
    const L conj[4] = {q[0], -q[1], -q[2], -q[3]};
    NAME(quat_mul)(back + 3, conj, rotation);
    NAME(pick_rows)(whole, at, 6, 6, r, sum);
    for (int i = 0; i < 3; i++) {
        sum[i] = sum[i] + back[i];
        sum[3 + i] = sum[3 + i] + 0.5 * rotation[1 + i];
    }
    NAME(drop_rows)(whole, at, 6, 6, r, sum);
}

/* Adds them to r, which begins with the element's first node. */
TARGET static void NAME(add_nodes)(int first, int left, const double *g, const double *z, double *r) {
    int64_t at[W];
    if (NAME(next_nodes)(left, at)) {
        NAME(add_block)(1, at, g + first, z + first, r + 6 * first);
    } else {
        NAME(add_block)(0, at, g + first, z + first, r + 6 * first);
    }
}
