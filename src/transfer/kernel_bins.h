/* Loads as reproducible sums, which do not depend on the order of the nodes, for one vector width. Included by
   transfer_lanes.c, with its macros. A node's share of the load is computed per lane without fused operations, so its
   bits are the same at every width. */

/* Shape functions phi_l at the nodes of a run, row by row; xi: their coordinates. */
HERE void NAME(shape_rows)(int modes, int count, const double *modal, const double *xi, double (*phi)[SPARI_ROW]) {
    static const double one = 1;
    for (int i = 0; i < count; i += W) {
        L t[SPARI_MAX_NODES], x = NAME(get)(xi + i);
        t[0] = SPLAT(&one), t[1] = x;
        for (int k = 2; k < modes; k++) {
            t[k] = (x + x) * t[k - 1] - t[k - 2];
        }
        for (int l = 0; l < modes; l++) {
            L sum = SPLAT(modal + l);
            for (int k = 1; k < modes; k++) {
                sum += t[k] * SPLAT(modal + (ptrdiff_t)k * modes + l);
            }
            NAME(put)(phi[l] + i, sum);
        }
    }
}

/* Moments of a run's nodes at their projection points, in rows g: 3, or 4 for the consistent kind. in: arm, force,
   moment, three rows each; q: chained quaternions of the line's nodes. Returns the smallest |Q|^2. */
HERE double NAME(lever_rows)(int modes, int count, const double *q, const int consistent, const int has_moment,
                             double (*phi)[SPARI_ROW], const double *const *in, double (*g)[SPARI_ROW]) {
    static const double huge = HUGE_VAL;
    L least = SPLAT(&huge);
    for (int i = 0; i < count; i += W) {
        L quat[4], arm[3], f[3], t[3], s[3], m[3];
        for (int j = 0; j < 4; j++) {
            quat[j] = NAME(get)(phi[0] + i) * SPLAT(q + j);
            for (int l = 1; l < modes; l++) {
                quat[j] += NAME(get)(phi[l] + i) * SPLAT(q + 4 * (ptrdiff_t)l + j);
            }
        }
        L square = NAME(square)(quat), over = 1.0 / square;
        least = NAME(less)(least, square);
        for (int j = 0; j < 3; j++) {
            arm[j] = NAME(get)(in[j] + i), f[j] = NAME(get)(in[3 + j] + i);
        }
        NAME(cross)(quat + 1, arm, t);
        NAME(cross)(quat + 1, t, s);
        for (int j = 0; j < 3; j++) { /* R(Q / |Q|) arm */
            arm[j] += (over + over) * (quat[0] * t[j] + s[j]);
        }
        NAME(cross)(arm, f, m);
        for (int j = 0; has_moment && j < 3; j++) {
            m[j] += NAME(get)(in[6 + j] + i);
        }
        if (consistent) { /* (0, M) Q / |Q|^2 */
            NAME(cross)(m, quat + 1, s);
            NAME(put)(g[3] + i, -(m[0] * quat[1] + m[1] * quat[2] + m[2] * quat[3]) * over);
            for (int j = 0; j < 3; j++) {
                m[j] = (m[j] * quat[0] + s[j]) * over;
            }
        }
        for (int j = 0; j < 3; j++) {
            NAME(put)(g[j] + i, m[j]);
        }
    }
    return NAME(least)(least);
}

/* Adds x[count], a whole number of vectors, to a sum. Returns 0 if a number is not finite. */
HERE int NAME(bin_row)(const double *x, int count, spari_bin_cut *cut, spari_bins *sum) {
    static const double zero = 0;
    spari_bins run;
    L least = SPLAT(&zero), part[SPARI_BINS], scale, shift[SPARI_BINS];
    for (int i = 0; i < count; i += W) {
        L v = NAME(get)(x + i);
        least = NAME(less)(least, NAME(less)(v, -v));
    }
    double most = -NAME(least)(least);
    if (cut->top != sum->top) {
        spari_bins_cut(sum->top, cut);
    }
    if (most > cut->most) {
        if (most > DBL_MAX) {
            return 0;
        }
        spari_bins_cut(spari_bins_top(most), cut);
    }
    scale = SPLAT(&cut->scale);
    SPARI_UNROLL
    for (int j = 0; j < SPARI_BINS; j++) {
        part[j] = SPLAT(&zero), shift[j] = SPLAT(cut->shift + j);
    }
    for (int i = 0; i < count; i += W) {
        L v = NAME(get)(x + i) * scale;
        SPARI_UNROLL
        for (int j = 0; j < SPARI_BINS; j++) {
            L p = (v + shift[j]) - shift[j];
            part[j] += p; /* integers far below 2^53: exact in any order */
            v -= p;
        }
    }
    run.top = cut->top;
    for (int j = 0; j < SPARI_BINS; j++) {
        double units = NAME(total)(part[j]) * cut->per_unit[j];
        if (!(fabs(units) <= 0x1p52)) { /* or NaN */
            return 0;
        }
        run.part[j] = (int64_t)units;
    }
    spari_bins_merge(sum, &run);
    return 1;
}

/* Shares of the run in a node of the line, three rows: phi f, and the moment phi m or, for the consistent kind, phi
   times the vector part of g q*. */
HERE void NAME(share_rows)(int count, const double *phi, const double *const *f, double (*g)[SPARI_ROW],
                           const double *q, const int consistent, double (*out)[SPARI_ROW]) {
    for (int i = 0; i < count; i += W) {
        L p = NAME(get)(phi + i), m[3] = {NAME(get)(g[0] + i), NAME(get)(g[1] + i), NAME(get)(g[2] + i)};
        if (consistent) {
            L w = NAME(get)(g[3] + i), u[3] = {SPLAT(q + 1), SPLAT(q + 2), SPLAT(q + 3)}, across[3];
            NAME(cross)(m, u, across);
            for (int j = 0; j < 3; j++) {
                m[j] = (m[j] * SPLAT(q) - w * u[j]) - across[j];
            }
        }
        for (int j = 0; j < 3; j++) {
            NAME(put)(out[j] + i, p * NAME(get)(f[j] + i));
            NAME(put)(out[3 + j] + i, p * m[j]);
        }
    }
    for (int j = 0; j < 6; j++) { /* lanes past the end have no load */
        for (int i = count; i % W; i++) {
            out[j][i] = 0;
        }
    }
}

/* Adds a run of nodes of one element to load [P][6]. The run begins at storage position `first`, its loads in the
   rows f at `at`. */
TARGET static int NAME(bins)(const spari_nodes *s, int64_t first, int count, const double *modal, const double *q,
                             int consistent, int has_moment, double (*f)[SPARI_ROW], int at, double (*work)[SPARI_ROW],
                             double *least, spari_bin_cut *cut, spari_bins *load) {
    double(*own)[SPARI_ROW] = work, (*g)[SPARI_ROW] = work + 4, (*share)[SPARI_ROW] = work + 8,
    (*phi)[SPARI_ROW] = work + 14;
    const double *in[9];
    int whole = 1, up = (count + W - 1) / W * W, modes = s->per_element;
    for (int k = 0; k < 4; k++) { /* lanes past the end repeat the last node */
        const double *from = k < 3 ? s->con[k] : s->xi;
        for (int i = 0; i < up; i++) {
            own[k][i] = from ? from[first + (i < count ? i : count - 1)] : 0;
        }
        in[k] = own[k];
    }
    for (int k = 0; k < 6; k++) {
        in[3 + k] = f[k] + at;
    }
    NAME(shape_rows)(modes, count, modal, own[3], phi);
    double d = consistent ? NAME(lever_rows)(modes, count, q, 1, has_moment, phi, in, g)
                          : NAME(lever_rows)(modes, count, q, 0, has_moment, phi, in, g);
    *least = d < *least ? d : *least;
    for (int l = 0; l < modes; l++) {
        NAME(share_rows)(count, phi[l], in + 3, g, q + 4 * (ptrdiff_t)l, consistent, share);
        for (int j = 0; j < 6; j++) {
            whole = NAME(bin_row)(share[j], up, cut, load + 6 * (ptrdiff_t)l + j) && whole;
        }
    }
    return whole;
}
