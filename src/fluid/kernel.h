/* The transfer kernels for one vector width. Included by transfer.c once per width with
     W       nodes handled together
     NAME(x) the name of x at this width
     TARGET  function attributes of the instruction set
   Without GNU vector types W is 1 and everything below is plain C. No include guard: this is a body, not an interface.
 */

#if W > 1
typedef double NAME(lanes) __attribute__((vector_size(8 * W)));
typedef int64_t NAME(bits) __attribute__((vector_size(8 * W)));
#else
typedef double NAME(lanes);
#endif
#define L NAME(lanes)
#define SPARI_INLINE TARGET static inline SPARI_ALWAYS_INLINE

SPARI_INLINE L NAME(get)(const double *p) {
    L v;
    memcpy(&v, p, sizeof v);
    return v;
}

SPARI_INLINE void NAME(put)(double *p, L v) {
    memcpy(p, &v, sizeof v);
}

SPARI_INLINE L NAME(less)(L a, L b) {
#if W > 1
    NAME(bits) m = a < b;
    return (L)(((NAME(bits))a & m) | ((NAME(bits))b & ~m));
#else
    return a < b ? a : b;
#endif
}

/* The lanes added in one fixed order. */
SPARI_INLINE double NAME(total)(L v) {
    double t[W], s = 0;
    memcpy(t, &v, sizeof v);
    for (int i = 0; i < W; i++) {
        s += t[i];
    }
    return s;
}

SPARI_INLINE double NAME(least)(L v) {
    double t[W], s;
    memcpy(t, &v, sizeof v);
    s = t[0];
    for (int i = 1; i < W; i++) {
        s = t[i] < s ? t[i] : s;
    }
    return s;
}

/* s[f] = sum_k T_k(x) c[k][f]; the T_k go to t (rows of SPARI_ROW) when asked for. n is a constant where this is
 * inlined. */
SPARI_INLINE void NAME(sum)(const int n, int modes, const double *c, L x, L *s, double *t) {
    L t0 = x - x + 1.0, t1 = x, twice = x + x;
    SPARI_UNROLL
    for (int f = 0; f < n; f++) {
        s[f] = t0 * c[f];
    }
    if (t) {
        NAME(put)(t, t0);
    }
    for (int k = 1; k < modes; k++) {
        const double *row = c + (ptrdiff_t)k * SPARI_FIELDS;
        SPARI_UNROLL
        for (int f = 0; f < n; f++) {
            s[f] += t1 * row[f];
        }
        if (t) {
            NAME(put)(t + (ptrdiff_t)k * SPARI_ROW, t1);
        }
        L t2 = twice * t1 - t0;
        t0 = t1, t1 = t2;
    }
}

SPARI_INLINE void NAME(cross)(const L *a, const L *b, L *c) {
    L x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    c[0] = x, c[1] = y, c[2] = z;
}

SPARI_INLINE L NAME(square)(const L *q) {
    return q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
}

/* r = R(Q / |Q|) c without a square root: c + 2 / |Q|^2 (w u x c + u x (u x c)) */
SPARI_INLINE void NAME(turn)(const L *q, L over, const L *c, L *r) {
    L t[3], s[3], g = over + over;
    NAME(cross)(q + 1, c, t);
    NAME(cross)(q + 1, t, s);
    for (int i = 0; i < 3; i++) {
        r[i] = c[i] + g * (q[0] * t[i] + s[i]);
    }
}

/* vector part of D Q* / |Q|^2: omega for D = 2 dQ/dt */
SPARI_INLINE void NAME(spin)(const L *d, const L *q, L over, L *w) {
    L t[3];
    NAME(cross)(d + 1, q + 1, t);
    for (int i = 0; i < 3; i++) {
        w[i] = (d[i + 1] * q[0] - d[0] * q[i + 1] - t[i]) * over;
    }
}

/* Rows of one run of nodes in one element, buffers beginning at the run. */
SPARI_INLINE L NAME(block)(int modes, const double *c, const int consistent, const int upto, L x, const L *con,
                           double (*buf)[SPARI_ROW], int at) {
    L s[7], r[3], v[7], w[3], a[7], alpha[3], t[3];
    NAME(sum)(7, modes, c + SPARI_F_PLACE, x, s, NULL);
    const L *q = s + SPARI_F_QUAT;
    L square = NAME(square)(q), over = 1.0 / square;
    NAME(turn)(q, over, con, r);
    for (int i = 0; i < 3; i++) {
        NAME(put)(buf[SPARI_R_PLACE + i] + at, s[i] + r[i]);
    }
    if (upto == SPARI_UPTO_PLACE) {
        return square;
    }
    NAME(sum)(consistent ? 7 : 6, modes, c + SPARI_F_RATE, x, v, NULL);
    if (consistent) {
        NAME(spin)(v + 3, q, over, w);
    } else {
        w[0] = v[3], w[1] = v[4], w[2] = v[5];
    }
    NAME(cross)(w, r, t);
    for (int i = 0; i < 3; i++) {
        NAME(put)(buf[SPARI_R_RATE + i] + at, v[i] + t[i]);
    }
    if (upto == SPARI_UPTO_RATE) {
        return square;
    }
    NAME(sum)(consistent ? 7 : 6, modes, c + SPARI_F_ACCEL, x, a, NULL);
    if (consistent) { /* alpha = vec(2 Q'' Q*) / |Q|^2 - omega d ln|Q|^2 / dt */
        L rate = (v[3] * q[0] + v[4] * q[1] + v[5] * q[2] + v[6] * q[3]) * over;
        NAME(spin)(a + 3, q, over, alpha);
        for (int i = 0; i < 3; i++) {
            alpha[i] -= w[i] * rate;
        }
    } else {
        alpha[0] = a[3], alpha[1] = a[4], alpha[2] = a[5];
    }
    L wt[3], ar[3];
    NAME(cross)(w, t, wt);
    NAME(cross)(alpha, r, ar);
    for (int i = 0; i < 3; i++) {
        NAME(put)(buf[SPARI_R_OMEGA + i] + at, w[i]);
        NAME(put)(buf[SPARI_R_ACCEL + i] + at, a[i] + ar[i] + wt[i]);
        NAME(put)(buf[SPARI_R_ALPHA + i] + at, alpha[i]);
    }
    for (int i = 0; i < 4; i++) {
        NAME(put)(buf[SPARI_R_QUAT + i] + at, q[i]);
    }
    return square;
}

/* Nodes of a tile's end that fill no whole vector repeat the last one, so that every lane is a real node. */
SPARI_INLINE void NAME(fetch)(const double *const *from, int n, int64_t p, int count, L *to) {
    for (int f = 0; f < n; f++) {
        if (count >= W) {
            to[f] = NAME(get)(from[f] + p);
        } else {
            double t[W];
            for (int i = 0; i < W; i++) {
                t[i] = from[f][p + (i < count ? i : count - 1)];
            }
            memcpy(&to[f], t, sizeof t);
        }
    }
}

SPARI_INLINE double NAME(run)(const spari_nodes *s, int64_t first, int count, const double *c, const int consistent,
                              const int upto, double (*buf)[SPARI_ROW], int at) {
    const double *from[4] = {s->xi, s->con[0], s->con[1], s->con[2]};
    L least = NAME(get)(spari_huge), in[4];
    for (int i = 0; i < count; i += W) {
        NAME(fetch)(from, 4, first + i, count - i, in);
        least = NAME(less)(least, NAME(block)(s->per_element, c, consistent, upto, in[0], in + 1, buf, at + i));
    }
    return NAME(least)(least);
}

TARGET static double NAME(tile_motion)(const spari_nodes *s, int64_t first, int count, const double *c, int consistent,
                                       int upto, double (*buf)[SPARI_ROW], int at) {
    if (consistent) {
        switch (upto) {
        case SPARI_UPTO_PLACE:
            return NAME(run)(s, first, count, c, 1, SPARI_UPTO_PLACE, buf, at);
        case SPARI_UPTO_RATE:
            return NAME(run)(s, first, count, c, 1, SPARI_UPTO_RATE, buf, at);
        default:
            return NAME(run)(s, first, count, c, 1, SPARI_UPTO_ACCEL, buf, at);
        }
    }
    switch (upto) {
    case SPARI_UPTO_PLACE:
        return NAME(run)(s, first, count, c, 0, SPARI_UPTO_PLACE, buf, at);
    case SPARI_UPTO_RATE:
        return NAME(run)(s, first, count, c, 0, SPARI_UPTO_RATE, buf, at);
    default:
        return NAME(run)(s, first, count, c, 0, SPARI_UPTO_ACCEL, buf, at);
    }
}

/* Moment at the foot of one block, and what the audit wants to know of it. g: rows of the moment field at this block.
 */
SPARI_INLINE L NAME(load_block)(int modes, const double *c, const int consistent, const int has_moment, const L *in,
                                const L *fm, double *t, double (*g)[SPARI_ROW], int at, const int audited, L *sums,
                                L *tops) {
    L q[4], r[3], m[3], zero = in[0] - in[0];
    NAME(sum)(4, modes, c + SPARI_F_QUAT, in[0], q, t);
    L square = NAME(square)(q), over = 1.0 / square;
    NAME(turn)(q, over, in + 1, r);
    NAME(cross)(r, fm, m);
    if (has_moment) {
        for (int i = 0; i < 3; i++) {
            m[i] += fm[3 + i];
        }
    }
    if (consistent) { /* (0, M) Q / |Q|^2, the adjoint of vec(D Q*) / |Q|^2 */
        L u[3];
        NAME(cross)(m, q + 1, u);
        NAME(put)(g[0] + at, -(m[0] * q[1] + m[1] * q[2] + m[2] * q[3]) * over);
        for (int i = 0; i < 3; i++) {
            NAME(put)(g[1 + i] + at, (m[i] * q[0] + u[i]) * over);
        }
    } else {
        for (int i = 0; i < 3; i++) {
            NAME(put)(g[i] + at, m[i]);
        }
    }
    if (!audited) {
        return square;
    }
    L x[3], v[7], w[3], xf[3], wr[3];
    NAME(sum)(3, modes, c + SPARI_F_PLACE, in[0], x, NULL);
    NAME(sum)(consistent ? 7 : 6, modes, c + SPARI_F_RATE, in[0], v, NULL);
    if (consistent) {
        NAME(spin)(v + 3, q, over, w);
    } else {
        w[0] = v[3], w[1] = v[4], w[2] = v[5];
    }
    for (int i = 0; i < 3; i++) {
        x[i] += r[i];
    }
    NAME(cross)(x, fm, xf);
    NAME(cross)(w, r, wr);
    for (int i = 0; i < 3; i++) {
        v[i] += wr[i];
        sums[i] += fm[i];
        sums[3 + i] += has_moment ? xf[i] + fm[3 + i] : xf[i];
        sums[6] += fm[i] * v[i];
        sums[7] += NAME(less)(fm[i], -fm[i]); /* minus |f| */
        if (has_moment) {
            sums[6] += fm[3 + i] * w[i];
            sums[8] += NAME(less)(fm[3 + i], -fm[3 + i]);
        }
    }
    tops[0] = NAME(less)(tops[0], zero - (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]));
    tops[1] = NAME(less)(tops[1], zero - (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
    tops[2] = NAME(less)(tops[2], zero - (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]));
    return square;
}

/* sum_k over one run: modal[k][f] += sum_i t[k][i] row_f[i]; two k at a time keep their sums in registers. */
SPARI_INLINE void NAME(project)(const int rows, int modes, int count, double (*t)[SPARI_ROW], double (*f)[SPARI_ROW],
                                double (*g)[SPARI_ROW], int at, double *modal) {
    for (int k = 0; k < modes; k += 2) {
        int k1 = k + 1 < modes ? k + 1 : k;
        L a[7], b[7], zero = NAME(get)(spari_zeros);
        SPARI_UNROLL
        for (int j = 0; j < rows; j++) {
            a[j] = zero, b[j] = zero;
        }
        for (int i = 0; i < count; i += W) {
            L ta = NAME(get)(t[k] + i), tb = NAME(get)(t[k1] + i);
            SPARI_UNROLL
            for (int j = 0; j < rows; j++) {
                L y = NAME(get)(j < 3 ? f[j] + at + i : g[j - 3] + i);
                a[j] += ta * y;
                b[j] += tb * y;
            }
        }
        for (int j = 0; j < rows; j++) {
            spari_add(modal + ((ptrdiff_t)k * 7 + j) * 2, NAME(total)(a[j]));
            if (k1 > k) {
                spari_add(modal + ((ptrdiff_t)k1 * 7 + j) * 2, NAME(total)(b[j]));
            }
        }
    }
}

SPARI_INLINE double NAME(load_run)(const spari_nodes *s, int64_t first, int count, const double *c,
                                   const int consistent, const int has_moment, double (*f)[SPARI_ROW], int at,
                                   const int audited, double *modal, double *sums, double *tops) {
    double t[SPARI_MAX_NODES][SPARI_ROW], g[4][SPARI_ROW];
    const double *from[4] = {s->xi, s->con[0], s->con[1], s->con[2]};
    const double *loads[6] = {f[0], f[1], f[2], f[3], f[4], f[5]};
    int modes = s->per_element;
    L least = NAME(get)(spari_huge), zero = NAME(get)(spari_zeros), in[4], fm[6], add[9], top[3];
    for (int i = 0; i < 9; i++) {
        add[i] = zero;
    }
    top[0] = top[1] = top[2] = zero;
    for (int i = 0; i < count; i += W) {
        NAME(fetch)(from, 4, first + i, count - i, in);
        NAME(fetch)(loads, has_moment ? 6 : 3, at + i, count - i, fm);
        if (count - i < W) { /* the repeated lanes carry nothing */
            double keep[W];
            for (int j = 0; j < W; j++) {
                keep[j] = j < count - i;
            }
            for (int j = 0; j < (has_moment ? 6 : 3); j++) {
                fm[j] *= NAME(get)(keep);
            }
        }
        least = NAME(less)(
            least, NAME(load_block)(modes, c, consistent, has_moment, in, fm, t[0] + i, g, i, audited, add, top));
    }
    for (int k = 0; k < modes; k++) {
        for (int i = count; i % W; i++) {
            t[k][i] = 0;
        }
    }
    NAME(project)(consistent ? 7 : 6, modes, count, t, f, g, at, modal);
    if (audited) {
        for (int i = 0; i < 9; i++) {
            spari_add(sums + 2 * i, NAME(total)(add[i]));
        }
        for (int i = 0; i < 3; i++) {
            double m = NAME(least)(top[i]);
            tops[i] = m < tops[i] ? m : tops[i];
        }
    }
    return NAME(least)(least);
}

TARGET static double NAME(tile_loads)(const spari_nodes *s, int64_t first, int count, const double *c, int consistent,
                                      int has_moment, double (*f)[SPARI_ROW], int at, int audited, double *modal,
                                      double *sums, double *tops) {
    if (consistent) {
        if (audited) {
            return NAME(load_run)(s, first, count, c, 1, has_moment, f, at, 1, modal, sums, tops);
        }
        return NAME(load_run)(s, first, count, c, 1, has_moment, f, at, 0, modal, sums, tops);
    }
    if (audited) {
        return NAME(load_run)(s, first, count, c, 0, has_moment, f, at, 1, modal, sums, tops);
    }
    return NAME(load_run)(s, first, count, c, 0, has_moment, f, at, 0, modal, sums, tops);
}

#undef L
#undef SPARI_INLINE
