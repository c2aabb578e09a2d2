/* The transfer kernels for one width of vectors (math/lanes.h); W nodes are in a vector. Without GNU vector types W is
   1 and everything below is plain C.

   Two vectors are worked on side by side (PAIR nodes): the chains of multiply-adds are then long enough apart to hide
   their latency, and each coefficient is spread over the lanes once for both. */
#include "transfer_kernels.h"

#include "../base/status.h"
#include <float.h>
#include <math.h>
#include <string.h>

#if defined(__has_builtin) /* in Clang, and in GCC from 12 on; GCC's own shuffle is older */
#if __has_builtin(__builtin_shufflevector)
#define SPARI_SHUFFLEVECTOR 1
#endif
#endif

#ifdef SPARI_HAS_OBJECT
#define SPARI_WIDTH SPARI_OBJECT_WIDTH
#include "../math/width.h"

#if W > 1
typedef int64_t NAME(bits) __attribute__((vector_size(8 * W)));
#endif
#define PAIR (2 * W)
#ifdef SPARI_SHUFFLEVECTOR /* indices run through the lanes of a, then of b */
#define MIX(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#else
#define MIX(a, b, ...) __builtin_shuffle(a, b, (NAME(bits)){__VA_ARGS__})
#endif

HERE L NAME(less)(L a, L b) {
#ifdef LEAST
    return LEAST(a, b);
#elif W > 1
    NAME(bits) m = a < b;
    return (L)(((NAME(bits))a & m) | ((NAME(bits))b & ~m));
#else
    return a < b ? a : b;
#endif
}

HERE L NAME(size)(L a) {
#if W > 1
    return (L)((NAME(bits))a & INT64_MAX);
#else
    return fabs(a);
#endif
}

/* Sum of the lanes in a fixed order. */
HERE double NAME(total)(L v) {
    double t[W], s = 0;
    memcpy(t, &v, sizeof v);
    for (int i = 0; i < W; i++) {
        s += t[i];
    }
    return s;
}

HERE double NAME(least)(L v) {
    double t[W], s;
    memcpy(t, &v, sizeof v);
    s = t[0];
    for (int i = 1; i < W; i++) {
        s = t[i] < s ? t[i] : s;
    }
    return s;
}

/* ---- triples in memory, rows in tiles ---- */

/* Interleaves three vectors into W triples x0 y0 z0 x1 ... as in memory, and back. */
HERE void NAME(weave)(const L *v, L *out) {
    const L x = v[0], y = v[1], z = v[2];
#if W == 2
    out[0] = MIX(x, y, 0, 2), out[1] = MIX(z, x, 0, 3), out[2] = MIX(y, z, 1, 3);
#elif W == 4
    L xy = MIX(x, y, 0, 4, 2, 6), yz = MIX(y, z, 1, 5, 3, 7), zx = MIX(z, x, 0, 5, 2, 7);
    out[0] = MIX(xy, zx, 0, 1, 4, 5), out[1] = MIX(yz, xy, 0, 1, 6, 7), out[2] = MIX(zx, yz, 2, 3, 6, 7);
#elif W == 8
    L a = MIX(x, y, 0, 8, 0, 1, 9, 1, 2, 10), b = MIX(x, y, 0, 3, 11, 0, 4, 12, 0, 5),
      c = MIX(x, y, 13, 0, 6, 14, 0, 7, 15, 0);
    out[0] = MIX(a, z, 0, 1, 8, 3, 4, 9, 6, 7);
    out[1] = MIX(b, z, 10, 1, 2, 11, 4, 5, 12, 7);
    out[2] = MIX(c, z, 0, 13, 2, 3, 14, 5, 6, 15);
#else
    out[0] = x, out[1] = y, out[2] = z;
#endif
}

HERE void NAME(put_triples)(const L *v, double *out) {
    L t[3];
    NAME(weave)(v, t);
    NAME(put)(out, t[0]);
    NAME(put)(out + W, t[1]);
    NAME(put)(out + 2 * W, t[2]);
}

HERE void NAME(unweave)(const double *in, L *x, L *y, L *z) {
#if W == 2
    L a = NAME(get)(in), b = NAME(get)(in + 2), c = NAME(get)(in + 4);
    *x = MIX(a, b, 0, 3);
    *y = MIX(a, c, 1, 2);
    *z = MIX(b, c, 0, 3);
#elif W == 4
    L a = NAME(get)(in), b = NAME(get)(in + 4), c = NAME(get)(in + 8);
    L xy = MIX(a, b, 0, 1, 6, 7), zx = MIX(a, c, 2, 3, 4, 5), yz = MIX(b, c, 0, 1, 6, 7);
    *x = MIX(xy, zx, 0, 5, 2, 7);
    *y = MIX(xy, yz, 1, 4, 3, 6);
    *z = MIX(zx, yz, 0, 5, 2, 7);
#elif W == 8
    L a = NAME(get)(in), b = NAME(get)(in + 8), c = NAME(get)(in + 16);
    *x = MIX(MIX(a, b, 0, 3, 6, 9, 12, 15, 0, 0), c, 0, 1, 2, 3, 4, 5, 10, 13);
    *y = MIX(MIX(a, b, 1, 4, 7, 10, 13, 0, 0, 0), c, 0, 1, 2, 3, 4, 8, 11, 14);
    *z = MIX(MIX(a, b, 2, 5, 8, 11, 14, 0, 0, 0), c, 0, 1, 2, 3, 4, 9, 12, 15);
#else
    double t[3];
    memcpy(t, in, sizeof t);
    *x = t[0], *y = t[1], *z = t[2];
#endif
}

TARGET static void NAME(store_triples)(double (*row)[SPARI_ROW], int count, double *out) {
    int i = 0;
    for (; i + W <= count; i += W) {
        const L v[3] = {NAME(get)(row[0] + i), NAME(get)(row[1] + i), NAME(get)(row[2] + i)};
        NAME(put_triples)(v, out + 3 * (ptrdiff_t)i);
    }
    for (; i < count; i++) {
        double t[3] = {row[0][i], row[1][i], row[2][i]};
        memcpy(out + 3 * (ptrdiff_t)i, t, sizeof t);
    }
}

TARGET static void NAME(load_triples)(const double *in, int count, double (*row)[SPARI_ROW]) {
    int i = 0;
    for (; i + W <= count; i += W) {
        L x, y, z;
        NAME(unweave)(in + 3 * (ptrdiff_t)i, &x, &y, &z);
        NAME(put)(row[0] + i, x);
        NAME(put)(row[1] + i, y);
        NAME(put)(row[2] + i, z);
    }
    for (; i < count; i++) {
        double t[3];
        memcpy(t, in + 3 * (ptrdiff_t)i, sizeof t);
        row[0][i] = t[0], row[1][i] = t[1], row[2][i] = t[2];
    }
}

/* Copies to the host's array, which may have any alignment. past: with non-temporal stores of whole cache lines, if
   available. An array larger than the caches would be evicted before it is read again, and a line written as a whole
   need not be read first. */
HERE void NAME(copy)(const void *from, size_t bytes, void *to, const int past) {
    size_t i = 0;
#ifdef STREAM
    if (past) {
        const size_t head = (64 - ((uintptr_t)to & 63)) & 63;
        i = head < bytes ? head : bytes;
        memcpy(to, from, i);
        for (; i + 64 <= bytes; i += 64) {
            const double *line = (const void *)((const char *)from + i);
            double *there = (void *)((char *)to + i);
            SPARI_UNROLL
            for (int k = 0; k < 8; k += W) {
                STREAM(there + k, NAME(get)(line + k));
            }
        }
    }
#else
    (void)past;
#endif
    memcpy((char *)to + i, (const char *)from + i, bytes - i);
}

enum { NAME(PART) = 128 }; /* nodes that are collected before they are copied */

TARGET static void NAME(give_triples)(double (*row)[SPARI_ROW], int count, double *out, int past) {
    double triples[3 * NAME(PART)];
    if (!past) {
        NAME(store_triples)(row, count, out);
        return;
    }
    for (int i = 0; i < count; i += NAME(PART)) {
        int n = count - i < NAME(PART) ? count - i : NAME(PART);
        NAME(store_triples)((double(*)[SPARI_ROW])(row[0] + i), n, triples);
        NAME(copy)(triples, 3 * (size_t)n * sizeof *out, out + 3 * (ptrdiff_t)i, past);
    }
}

/* Single precision: computations are in double, and only the copied numbers are converted. */
TARGET static void NAME(give_singles)(double (*row)[SPARI_ROW], int count, float *out, int past) {
    double triples[3 * NAME(PART)];
    float singles[3 * NAME(PART)];
    for (int i = 0; i < count; i += NAME(PART)) {
        int n = count - i < NAME(PART) ? count - i : NAME(PART);
        NAME(store_triples)((double(*)[SPARI_ROW])(row[0] + i), n, triples);
        for (int k = 0; k < 3 * n; k++) {
            singles[k] = (float)triples[k];
        }
        NAME(copy)(singles, 3 * (size_t)n * sizeof *out, out + 3 * (ptrdiff_t)i, past);
    }
}

#if W == 8 && defined(STREAM)
/* 16 triples of floats to three rows of doubles. */
HERE void NAME(unweave_singles)(const float *in, double *x, double *y, double *z) {
    const __m512i ab[3] = {_mm512_setr_epi32(0, 3, 6, 9, 12, 15, 18, 21, 24, 27, 30, 0, 0, 0, 0, 0),
                           _mm512_setr_epi32(1, 4, 7, 10, 13, 16, 19, 22, 25, 28, 31, 0, 0, 0, 0, 0),
                           _mm512_setr_epi32(2, 5, 8, 11, 14, 17, 20, 23, 26, 29, 0, 0, 0, 0, 0, 0)};
    const __m512i c[3] = {_mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 17, 20, 23, 26, 29),
                          _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 18, 21, 24, 27, 30),
                          _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 16, 19, 22, 25, 28, 31)};
    const __m512 v[3] = {_mm512_loadu_ps(in), _mm512_loadu_ps(in + 16), _mm512_loadu_ps(in + 32)};
    double *const row[3] = {x, y, z};
    SPARI_UNROLL
    for (int k = 0; k < 3; k++) {
        __m512 t = _mm512_permutex2var_ps(_mm512_permutex2var_ps(v[0], ab[k], v[1]), c[k], v[2]);
        NAME(put)(row[k], _mm512_cvtps_pd(_mm512_castps512_ps256(t)));
        NAME(put)(row[k] + 8, _mm512_cvtps_pd(_mm512_extractf32x8_ps(t, 1)));
    }
}
#endif

TARGET static void NAME(load_singles)(const float *in, int count, double (*row)[SPARI_ROW]) {
    double triples[3 * NAME(PART)];
    float singles[3 * NAME(PART)];
    int i = 0;
#if W == 8 && defined(STREAM)
    for (; i + 16 <= count; i += 16) {
        NAME(unweave_singles)(in + 3 * (ptrdiff_t)i, row[0] + i, row[1] + i, row[2] + i);
    }
#endif
    for (; i < count; i += NAME(PART)) {
        int n = count - i < NAME(PART) ? count - i : NAME(PART);
        memcpy(singles, in + 3 * (ptrdiff_t)i, 3 * (size_t)n * sizeof *in);
        for (int k = 0; k < 3 * n; k++) {
            triples[k] = singles[k];
        }
        NAME(load_triples)(triples, n, (double(*)[SPARI_ROW])(row[0] + i));
    }
}

/* ---- sums over the modes ---- */

#ifndef SUMMED
#define SUMMED 14 /* maximum number of fields at once */
#endif

#if W == 8
/* s[f] = sum_k T_k c[k][f] for both vectors, in 32 registers; T_k is computed along the way.
   n, skip: number of fields; `skip` fields are omitted after the third
   t: where T_k is stored, row k at t + k * stride; NULL: not stored
   x: of both vectors
   All arguments but the memory are constants after inlining. */
HERE void NAME(sum)(const int n, const int skip, int modes, const double *c, const L *x, double *t,
                    const ptrdiff_t stride, L (*s)[SUMMED]) {
    static const double one = 1;
    L a[SUMMED], b[SUMMED], t0 = x[0], t1 = x[1], before0 = SPLAT(&one), before1 = before0, x0 = t0 + t0, x1 = t1 + t1;
    if (t) {
        NAME(put)(t, before0);
        NAME(put)(t + W, before0);
    }
    SPARI_UNROLL_ALL
    for (int f = 0; f < n; f++) {
        a[f] = b[f] = SPLAT(c + (f < 3 ? f : f + skip));
    }
    for (int k = 1; k < modes; k++) {
        const double *row = c + (ptrdiff_t)k * SPARI_FIELDS;
        SPARI_UNROLL_ALL
        for (int f = 0; f < n; f++) {
            L r = SPLAT(row + (f < 3 ? f : f + skip));
            a[f] = MADD(t0, r, a[f]);
            b[f] = MADD(t1, r, b[f]);
        }
        if (t) {
            NAME(put)(t + k * stride, t0);
            NAME(put)(t + k * stride + W, t1);
        }
        L after0 = MSUB(x0, t0, before0), after1 = MSUB(x1, t1, before1);
        before0 = t0, before1 = t1, t0 = after0, t1 = after1;
    }
    SPARI_UNROLL_ALL
    for (int f = 0; f < n; f++) {
        s[0][f] = a[f], s[1][f] = b[f];
    }
}
#else
/* T_k of two vectors, row k at t + k * stride; at least two modes. */
HERE void NAME(chebyshev)(int modes, const L *x, double *t, const ptrdiff_t stride) {
    static const double one = 1;
    L a0 = SPLAT(&one), b0 = a0, a1 = x[0], b1 = x[1], a2 = a1 + a1, b2 = b1 + b1;
    NAME(put)(t, a0);
    NAME(put)(t + W, b0);
    NAME(put)(t + stride, a1);
    NAME(put)(t + stride + W, b1);
    for (int k = 2; k < modes; k++) {
        L a = MSUB(a2, a1, a0), b = MSUB(b2, b1, b0);
        a0 = a1, a1 = a, b0 = b1, b1 = b;
        NAME(put)(t + k * stride, a1);
        NAME(put)(t + k * stride + W, b1);
    }
}

/* Fields [from, from + n) of `sum` below, as many as fit in registers. */
HERE void NAME(sum_some)(const int from, const int n, const int skip, int modes, const double *c, const double *t,
                         const ptrdiff_t stride, L (*s)[SUMMED]) {
    L a[6], b[6];
    SPARI_UNROLL
    for (int f = 0; f < n; f++) {
        a[f] = b[f] = SPLAT(c + (from + f < 3 ? from + f : from + f + skip));
    }
    for (int k = 1; k < modes; k++) {
        const double *row = c + (ptrdiff_t)k * SPARI_FIELDS;
        L ta = NAME(get)(t + k * stride), tb = NAME(get)(t + k * stride + W);
        SPARI_UNROLL
        for (int f = 0; f < n; f++) {
            L r = SPLAT(row + (from + f < 3 ? from + f : from + f + skip));
            a[f] = MADD(ta, r, a[f]);
            b[f] = MADD(tb, r, b[f]);
        }
    }
    SPARI_UNROLL
    for (int f = 0; f < n; f++) {
        s[0][from + f] = a[f], s[1][from + f] = b[f];
    }
}

/* s[f] = sum_k T_k c[k][f] for both vectors, in groups of fields that fit in registers.
   n, skip: number of fields; `skip` fields are omitted after the third; constants after inlining
   x: of both vectors
   t: where T_k is stored, row k at t + k * stride */
HERE void NAME(sum)(const int n, const int skip, int modes, const double *c, const L *x, double *t,
                    const ptrdiff_t stride, L (*s)[SUMMED]) {
    const int part = n <= 6 ? n : n <= 12 ? (n + 1) / 2 : (n + 2) / 3;
    NAME(chebyshev)(modes, x, t, stride);
    NAME(sum_some)(0, part, skip, modes, c, t, stride, s);
    if (part < n) {
        NAME(sum_some)(part, n <= 12 ? n - part : part, skip, modes, c, t, stride, s);
    }
    if (2 * part < n) {
        NAME(sum_some)(2 * part, n - 2 * part, skip, modes, c, t, stride, s);
    }
}
#endif

/* ---- rotations ---- */

/* Without fused operations, for sums with equal bits at every width. */
HERE void NAME(cross)(const L *a, const L *b, L *c) {
    L x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    c[0] = x, c[1] = y, c[2] = z;
}

HERE L NAME(square)(const L *q) {
    return (q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3]);
}

/* The same with the fewest operations: a x b, and c + a x b. */
HERE void NAME(fused_cross)(const L *a, const L *b, L *r) {
    L x = NMADD(a[2], b[1], a[1] * b[2]), y = NMADD(a[0], b[2], a[2] * b[0]), z = NMADD(a[1], b[0], a[0] * b[1]);
    r[0] = x, r[1] = y, r[2] = z;
}

HERE void NAME(add_cross)(const L *c, const L *a, const L *b, L *r) {
    L x = NMADD(a[2], b[1], MADD(a[1], b[2], c[0])), y = NMADD(a[0], b[2], MADD(a[2], b[0], c[1])),
      z = NMADD(a[1], b[0], MADD(a[0], b[1], c[2]));
    r[0] = x, r[1] = y, r[2] = z;
}

HERE L NAME(fused_square)(const L *q) {
    return MADD(q[3], q[3], MADD(q[2], q[2], MADD(q[1], q[1], q[0] * q[0])));
}

/* r = R(Q / |Q|) c without a square root: c + twice (w u x c + u x (u x c)), twice: 2 / |Q|^2 */
HERE void NAME(rotation)(const L *q, L twice, const L *c, L *r) {
    L t[3], s[3];
    NAME(fused_cross)(q + 1, c, t);
    s[0] = q[0] * t[0], s[1] = q[0] * t[1], s[2] = q[0] * t[2];
    NAME(add_cross)(s, q + 1, t, s);
    for (int i = 0; i < 3; i++) {
        r[i] = MADD(twice, s[i], c[i]);
    }
}

/* vector part of D Q* / |Q|^2: omega for D = 2 dQ/dt */
HERE void NAME(spin)(const L *d, const L *q, L over, L *w) {
    L t[3];
    for (int i = 0; i < 3; i++) {
        t[i] = NMADD(d[0], q[i + 1], d[i + 1] * q[0]);
    }
    NAME(add_cross)(t, q + 1, d + 1, t);
    for (int i = 0; i < 3; i++) {
        w[i] = t[i] * over;
    }
}

/* ---- motion of nodes ---- */

/* Accelerations of one vector of nodes: alpha = vec(2 Q'' Q*) / |Q|^2 - omega d ln|Q|^2 / dt for the consistent
   kind.
   d, twist: the nodal fields; u: which of the two vectors */
HERE void NAME(accelerate)(const int consistent, const L *q, L over, const L *d, const L *accel, const L *twist,
                           const L *r, const L *w, const L *wr, L *out) {
    L alpha[3] = {twist[0], twist[1], twist[2]};
    if (consistent) {
        L rate = MADD(d[3], q[3], MADD(d[2], q[2], MADD(d[1], q[1], d[0] * q[0]))) * over;
        NAME(spin)(twist, q, over, alpha);
        for (int i = 0; i < 3; i++) {
            alpha[i] = NMADD(w[i], rate, alpha[i]);
        }
    }
    NAME(add_cross)(accel, alpha, r, out);
    NAME(add_cross)(out, w, wr, out);
    out[3] = alpha[0], out[4] = alpha[1], out[5] = alpha[2];
}

/* Rows SPARI_R_* of one vector from its interpolated fields (position, rate, Q, spin, accel, twist), as far as
   requested. Returns |Q|^2. */
HERE L NAME(move_one)(const int consistent, const int what, const L *place, const L *rate, const L *q, const L *spin,
                      const L *accel, const L *twist, const L *con, L *out) {
    const int upto = what & SPARI_UPTO;
    static const double two = 2;
    L square = NAME(fused_square)(q), twice = SPLAT(&two) / square, r[3], w[3], wr[3];
    NAME(rotation)(q, twice, con, r);
    for (int i = 0; i < 3; i++) {
        out[SPARI_R_POSITION + i] = place[i] + r[i];
    }
    for (int i = 0; i < 4; i++) {
        out[SPARI_R_QUAT + i] = q[i];
    }
    if (upto < SPARI_UPTO_RATE) {
        return square;
    }
    L over = twice * 0.5;
    w[0] = spin[0], w[1] = spin[1], w[2] = spin[2];
    if (consistent) {
        NAME(spin)(spin, q, over, w);
    }
    NAME(add_cross)(rate, w, r, out + SPARI_R_RATE);
    for (int i = 0; i < 3; i++) {
        out[SPARI_R_OMEGA + i] = w[i];
    }
    if (upto >= SPARI_UPTO_ACCEL) {
        NAME(fused_cross)(w, r, wr);
        NAME(accelerate)(consistent, q, over, spin, accel, twist, r, w, wr, out + SPARI_R_ACCEL);
    }
    return square;
}

/* PAIR nodes of one element. in: xi and con of each vector; out: the requested rows of each. Returns the smaller
   |Q|^2 per lane. */
HERE L NAME(move)(int modes, const double *c, const int consistent, const int what, const L (*in)[2],
                  L (*out)[SPARI_ROWS]) {
    const int upto = what & SPARI_UPTO, spins = consistent ? 4 : 3;
    const int rates = upto >= SPARI_UPTO_RATE,
              turned = rates ? SPARI_F_QUAT : 3; /* without rates, Q directly follows the positions */
    L field[2][SUMMED], second[2][SUMMED], least[2];
#if W == 8
    double *t = NULL;
#else
    L polynomials[2 * SPARI_MAX_NODES];
    double *t = (double *)polynomials;
#endif
    NAME(sum)(rates ? SPARI_F_SPIN + spins : 7, rates ? 0 : 3, modes, c, in[0], t, PAIR, field);
    if (upto >= SPARI_UPTO_ACCEL) {
        NAME(sum)(3 + spins, 0, modes, c + SPARI_F_ACCEL, in[0], t, PAIR, second);
    }
    SPARI_UNROLL
    for (int u = 0; u < 2; u++) {
        const L *f = field[u], *g = second[u], con[3] = {in[1][u], in[2][u], in[3][u]};
        least[u] =
            NAME(move_one)(consistent, what, f, f + SPARI_F_RATE, f + turned, f + SPARI_F_SPIN, g, g + 3, con, out[u]);
    }
    return NAME(less)(least[0], least[1]);
}

HERE void NAME(put_row)(const int width, const L *x, double (*row)[SPARI_ROW], int at) {
    SPARI_UNROLL
    for (int i = 0; i < width; i++) {
        NAME(put)(row[i] + at, x[i]);
    }
}

/* Stores the requested rows of one vector in the tile. */
HERE void NAME(put_rows)(const int what, const L *x, double (*buf)[SPARI_ROW], int at) {
    const int upto = what & SPARI_UPTO, poses = what & SPARI_POSES, rates = upto >= SPARI_UPTO_RATE;
    NAME(put_row)(rates ? 6 : 3, x, buf, at); /* positions, velocities */
    NAME(put_row)(poses ? 4 : 0, x + SPARI_R_QUAT, buf + SPARI_R_QUAT, at);
    NAME(put_row)(poses && rates ? 3 : 0, x + SPARI_R_OMEGA, buf + SPARI_R_OMEGA, at);
    NAME(put_row)(upto >= SPARI_UPTO_ACCEL ? 6 : 0, x + SPARI_R_ACCEL, buf + SPARI_R_ACCEL, at);
}

/* Pointers to n rows of a run for nodes `begin` to `end`. Whole pairs of vectors are read in place. The remainder is
   copied to pad, where the lanes past the end repeat the last node or are zero. */
HERE void NAME(begin_rows)(const double *const *from, const int n, const int zero, int64_t first, int begin, int end,
                           double (*pad)[PAIR], const double **to) {
    const int count = end - begin;
    SPARI_UNROLL
    for (int f = 0; f < n; f++) {
        to[f] = from[f] + first + begin;
    }
    if (count % PAIR == 0) {
        return;
    }
    for (int f = 0; f < n; f++) {
        for (int i = 0; i < PAIR; i++) {
            pad[f][i] = i < count ? to[f][i] : zero ? 0 : to[f][count - 1];
        }
        to[f] = pad[f];
    }
}

HERE void NAME(get_pair)(const double *const *from, const int n, int i, L (*to)[2]) {
    SPARI_UNROLL
    for (int f = 0; f < n; f++) {
        to[f][0] = NAME(get)(from[f] + i), to[f][1] = NAME(get)(from[f] + i + W);
    }
}

/* Prefetches n rows of the nodes, which are long. Each row is a separate stream, which hardware prefetching ends at
   a page boundary. */
HERE void NAME(ask_ahead)(const spari_nodes *s, const double *const *from, const int n, int64_t p) {
    if (s->n >= SPARI_FAR && p + SPARI_ASK + PAIR <= s->n) {
        SPARI_UNROLL
        for (int f = 0; f < n; f++) {
            for (int k = 0; k < PAIR; k += 8) {
                SPARI_AHEAD(from[f] + p + SPARI_ASK + k);
            }
        }
    }
}

/* Motion of two vectors of nodes, from node p of all on, number i in the rows. Returns the smallest |Q|^2. */
HERE L NAME(move_pair)(const spari_nodes *s, const double *const *from, const double *const *row, int64_t p, int i,
                       const double *c, const int consistent, const int what, L (*out)[SPARI_ROWS]) {
    L in[4][2];
    NAME(ask_ahead)(s, from, 4, p);
    NAME(get_pair)(row, 4, i, in);
    return NAME(move)(s->per_element, c, consistent, what, (const L(*)[2])in, out);
}

HERE double NAME(run)(const spari_nodes *s, int64_t first, int count, const double *c, const int consistent,
                      const int what, double (*buf)[SPARI_ROW], int at) {
    static const double huge = HUGE_VAL;
    const double *const from[4] = {s->xi, s->con[0], s->con[1], s->con[2]};
    double pad[4][PAIR];
    L least = SPLAT(&huge), out[2][SPARI_ROWS];
    for (int begin = 0, end = count - count % PAIR; begin < count; begin = end, end = count) {
        const double *row[4];
        NAME(begin_rows)(from, 4, 0, first, begin, end, pad, row);
        for (int i = begin; i < end; i += PAIR) {
            least = NAME(less)(least, NAME(move_pair)(s, from, row, first + i, i - begin, c, consistent, what, out));
            NAME(put_rows)(what, out[0], buf, at + i);
            NAME(put_rows)(what, out[1], buf, at + i + W);
        }
    }
    return NAME(least)(least);
}

/* ---- one node for all nodes: point, rigid body ---- */

HERE void NAME(splat)(const int n, const double *from, L *to) {
    SPARI_UNROLL
    for (int i = 0; i < n; i++) {
        to[i] = SPLAT(from + i);
    }
}

/* r = R c */
HERE void NAME(rotate)(const L *rotation, const L *c, L *r) {
    SPARI_UNROLL
    for (int i = 0; i < 3; i++) {
        r[i] = MADD(rotation[3 * i + 2], c[2], MADD(rotation[3 * i + 1], c[1], rotation[3 * i] * c[0]));
    }
}

/* Stores triples a + b of W nodes in the host's array; `count` of them exist. */
HERE void NAME(give)(const L *a, const L *b, int count, double *out) {
    double part[3 * W];
    const L v[3] = {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
    NAME(put_triples)(v, count < W ? part : out);
    if (count < W) {
        memcpy(out, part, 3 * (size_t)count * sizeof *out);
    }
}

/* Stores positions and velocities of all nodes directly in the host's triples. */
HERE void NAME(carry_all)(const spari_nodes *s, const carrier *m, const int places, const int rates, double *x,
                          double *v) {
    L rotation[9], place[3], rate[3], w[3];
    NAME(splat)(9, m->rotation, rotation);
    NAME(splat)(3, m->place, place);
    NAME(splat)(3, m->rate, rate);
    NAME(splat)(3, m->omega, w);
    for (int64_t p = 0; p < s->n; p += W) {
        int count = s->n - p < W ? (int)(s->n - p) : W;
        L c[3], r[3], wr[3];
        SPARI_UNROLL
        for (int i = 0; i < 3; i++) {
            double part[W] = {0};
            if (count < W) {
                memcpy(part, s->con[i] + p, (size_t)count * sizeof *part);
            }
            c[i] = NAME(get)(count < W ? part : s->con[i] + p);
        }
        NAME(rotate)(rotation, c, r);
        if (places) {
            NAME(give)(place, r, count, x + 3 * p);
        }
        if (rates) {
            NAME(cross)(w, r, wr);
            NAME(give)(rate, wr, count, v + 3 * p);
        }
    }
}

TARGET static void NAME(carry_to)(const spari_nodes *s, const carrier *m, double *x, double *v) {
    if (x && v) {
        NAME(carry_all)(s, m, 1, 1, x, v);
    } else if (x) {
        NAME(carry_all)(s, m, 1, 0, x, v);
    } else if (v) {
        NAME(carry_all)(s, m, 0, 1, x, v);
    }
}

/* Lever arms of two vectors of nodes. */
HERE void NAME(fetch_nodes)(const spari_nodes *s, const double *const *from, int64_t p, int count, L (*to)[2]) {
    double pad[3][PAIR];
    const double *row[3];
    NAME(ask_ahead)(s, from, 3, p);
    NAME(begin_rows)(from, 3, 0, p, 0, count < PAIR ? count : PAIR, pad, row);
    NAME(get_pair)(row, 3, 0, to);
}

/* Computes the rows of a tile. */
HERE void NAME(carry)(const spari_nodes *s, int64_t first, int count, const carrier *m, const int what,
                      double (*buf)[SPARI_ROW]) {
    const double *const *from = (const double *const *)s->con;
    const int upto = what & SPARI_UPTO;
    L rotation[9], place[3], rate[3], w[3], accel[3], alpha[3], c[3][2];
    NAME(splat)(9, m->rotation, rotation);
    NAME(splat)(3, m->place, place);
    NAME(splat)(3, m->rate, rate);
    NAME(splat)(3, m->omega, w);
    NAME(splat)(3, m->accel, accel);
    NAME(splat)(3, m->alpha, alpha);
    for (int at = 0; at < count; at += PAIR) {
        NAME(fetch_nodes)(s, from, first + at, count - at, c);
        SPARI_UNROLL
        for (int u = 0; u < 2; u++) {
            L arm[3] = {c[0][u], c[1][u], c[2][u]}, r[3], wr[3], ar[3], wwr[3];
            NAME(rotate)(rotation, arm, r);
            SPARI_UNROLL
            for (int i = 0; i < 3; i++) {
                NAME(put)(buf[SPARI_R_POSITION + i] + at + W * u, place[i] + r[i]);
            }
            if (upto < SPARI_UPTO_RATE) {
                continue;
            }
            NAME(cross)(w, r, wr);
            SPARI_UNROLL
            for (int i = 0; i < 3; i++) {
                NAME(put)(buf[SPARI_R_RATE + i] + at + W * u, rate[i] + wr[i]);
            }
            if (upto < SPARI_UPTO_ACCEL) {
                continue;
            }
            NAME(cross)(w, wr, wwr);
            NAME(cross)(alpha, r, ar);
            SPARI_UNROLL
            for (int i = 0; i < 3; i++) {
                NAME(put)(buf[SPARI_R_ACCEL + i] + at + W * u, accel[i] + ar[i] + wwr[i]);
            }
        }
    }
    if (what & SPARI_POSES) {
        for (int at = 0; at < count; at += W) {
            SPARI_UNROLL
            for (int i = 0; i < 4; i++) {
                NAME(put)(buf[SPARI_R_QUAT + i] + at, SPLAT(m->q + i));
            }
            if (upto >= SPARI_UPTO_RATE) {
                NAME(put_row)(3, w, buf + SPARI_R_OMEGA, at);
            }
            if (upto >= SPARI_UPTO_ACCEL) {
                NAME(put_row)(3, alpha, buf + SPARI_R_ALPHA, at);
            }
        }
    }
}

/* Nodes of a point or rigid body. */
TARGET SPARI_APART static double NAME(motion_carried)(const spari_nodes *s, int64_t first, int count, const double *c,
                                                      int what, double (*buf)[SPARI_ROW]) {
    const carrier m = spari_carrier_of(c);
    switch (what) {
    case SPARI_UPTO_POSITION:
        NAME(carry)(s, first, count, &m, SPARI_UPTO_POSITION, buf);
        break;
    case SPARI_UPTO_RATE:
        NAME(carry)(s, first, count, &m, SPARI_UPTO_RATE, buf);
        break;
    case SPARI_UPTO_POSITION | SPARI_POSES:
        NAME(carry)(s, first, count, &m, SPARI_UPTO_POSITION | SPARI_POSES, buf);
        break;
    case SPARI_UPTO_RATE | SPARI_POSES:
        NAME(carry)(s, first, count, &m, SPARI_UPTO_RATE | SPARI_POSES, buf);
        break;
    default:
        NAME(carry)(s, first, count, &m, SPARI_UPTO_ACCEL | SPARI_POSES, buf);
    }
    return m.square;
}

/* One function per request, so that none needs the stack of all. */
#define RUN(name, consistent, what)                                                                                    \
    TARGET SPARI_APART static double NAME(run_##name)(const spari_nodes *s, int64_t first, int count, const double *c, \
                                                      double(*buf)[SPARI_ROW], int at) {                               \
        return NAME(run)(s, first, count, c, consistent, what, buf, at);                                               \
    }
RUN(places, 0, SPARI_UPTO_POSITION) /* the same for both kinds */
RUN(nodal_rates, 0, SPARI_UPTO_RATE)
RUN(consistent_rates, 1, SPARI_UPTO_RATE)
RUN(poses, 0, SPARI_UPTO_POSITION | SPARI_POSES)
RUN(nodal_rates_poses, 0, SPARI_UPTO_RATE | SPARI_POSES)
RUN(consistent_rates_poses, 1, SPARI_UPTO_RATE | SPARI_POSES)
RUN(nodal_all, 0, SPARI_UPTO_ACCEL | SPARI_POSES)
RUN(consistent_all, 1, SPARI_UPTO_ACCEL | SPARI_POSES)
#undef RUN

TARGET static double NAME(motion)(const spari_nodes *s, int64_t first, int count, const double *c, int consistent,
                                  int what, double (*buf)[SPARI_ROW], int at) {
    if (s->per_element == 1) {
        return NAME(motion_carried)(s, first, count, c, what, buf);
    }
    static double (*const run[2][SPARI_POSES + SPARI_UPTO])(const spari_nodes *, int64_t, int, const double *,
                                                            double(*)[SPARI_ROW], int) = {
        {[SPARI_UPTO_POSITION] = NAME(run_places),
         [SPARI_UPTO_RATE] = NAME(run_nodal_rates),
         [SPARI_UPTO_POSITION | SPARI_POSES] = NAME(run_poses),
         [SPARI_UPTO_RATE | SPARI_POSES] = NAME(run_nodal_rates_poses),
         [SPARI_UPTO_ACCEL] = NAME(run_nodal_all),
         [SPARI_UPTO_ACCEL | SPARI_POSES] = NAME(run_nodal_all)},
        {[SPARI_UPTO_POSITION] = NAME(run_places),
         [SPARI_UPTO_RATE] = NAME(run_consistent_rates),
         [SPARI_UPTO_POSITION | SPARI_POSES] = NAME(run_poses),
         [SPARI_UPTO_RATE | SPARI_POSES] = NAME(run_consistent_rates_poses),
         [SPARI_UPTO_ACCEL] = NAME(run_consistent_all),
         [SPARI_UPTO_ACCEL | SPARI_POSES] = NAME(run_consistent_all)}};
    return run[!!consistent][what](s, first, count, c, buf, at);
}

#include "kernel_direct.h"

/* ---- loads of nodes ---- */

/* Contribution of one vector to the audit: fluid-side totals, and largest sizes (as smallest negatives). */
HERE void NAME(audit)(const int has_moment, const L *place, const L *r, const L *rate, const L *w, const L *f,
                      const L *m, L *sums, L *tops) {
    static const double zero = 0;
    const L none = SPLAT(&zero);
    L x[3], v[3];
    for (int i = 0; i < 3; i++) {
        x[i] = place[i] + r[i];
    }
    NAME(add_cross)(rate, w, r, v);
    NAME(add_cross)(sums + 3, x, f, sums + 3);
    for (int i = 0; i < 3; i++) {
        sums[i] += f[i];
        sums[6] = MADD(f[i], v[i], sums[6]);
        sums[7] += NAME(size)(f[i]);
        if (has_moment) {
            sums[3 + i] += m[i];
            sums[6] = MADD(m[i], w[i], sums[6]);
            sums[8] += NAME(size)(m[i]);
        }
    }
    tops[0] = NAME(less)(tops[0], NMADD(x[2], x[2], NMADD(x[1], x[1], NMADD(x[0], x[0], none))));
    tops[1] = NAME(less)(tops[1], NMADD(v[2], v[2], NMADD(v[1], v[1], NMADD(v[0], v[0], none))));
    tops[2] = NAME(less)(tops[2], NMADD(w[2], w[2], NMADD(w[1], w[1], NMADD(w[0], w[0], none))));
}

/* Moment term to be summed at the projection point of a node with moment M, stored in rows g: M, or for the
   consistent kind (0, M) Q / |Q|^2, the adjoint of vec(D Q*) / |Q|^2. */
HERE void NAME(put_moment)(const int consistent, const L *m, const L *q, L over, double (*g)[SPARI_ROW], int at) {
    if (!consistent) {
        NAME(put_row)(3, m, g, at);
        return;
    }
    L s[4];
    s[0] = -MADD(m[2], q[3], MADD(m[1], q[2], m[0] * q[1])) * over;
    for (int i = 0; i < 3; i++) {
        s[1 + i] = m[i] * q[0];
    }
    NAME(add_cross)(s + 1, m, q + 1, s + 1);
    for (int i = 0; i < 3; i++) {
        s[1 + i] *= over;
    }
    NAME(put_row)(4, s, g, at);
}

/* Moments of PAIR nodes at their projection points, stored in rows g at `at`; T_k in t. in: xi, con, force, moment. */
HERE L NAME(lever)(int modes, const double *c, const int consistent, const int has_moment, const int audited,
                   const L (*in)[2], double *t, double (*g)[SPARI_ROW], int at, L *sums, L *tops) {
    static const double two = 2;
    const int fields = !audited ? 4 : consistent ? SPARI_F_SPIN + 4 : SPARI_F_SPIN + 3;
    L field[2][SUMMED], least[2];
    NAME(sum)(fields, 0, modes, audited ? c : c + SPARI_F_QUAT, in[0], t, SPARI_ROW, field);
    SPARI_UNROLL
    for (int u = 0; u < 2; u++, at += W) {
        const L con[3] = {in[1][u], in[2][u], in[3][u]}, f[3] = {in[4][u], in[5][u], in[6][u]};
        const L *all = field[u], *q = audited ? all + SPARI_F_QUAT : all, *spin = all + SPARI_F_SPIN;
        L square = NAME(fused_square)(q), twice = SPLAT(&two) / square, over = twice * 0.5, r[3], m[3], moment[3];
        least[u] = square;
        NAME(rotation)(q, twice, con, r);
        if (has_moment) {
            moment[0] = in[7][u], moment[1] = in[8][u], moment[2] = in[9][u];
            NAME(add_cross)(moment, r, f, m);
        } else {
            NAME(fused_cross)(r, f, m);
        }
        NAME(put_moment)(consistent, m, q, over, g, at);
        if (audited) {
            L w[3] = {spin[0], spin[1], spin[2]};
            if (consistent) {
                NAME(spin)(spin, q, over, w);
            }
            NAME(audit)(has_moment, all, r, all + SPARI_F_RATE, w, f, moment, sums, tops);
        }
    }
    return NAME(less)(least[0], least[1]);
}

/* Sums of the lanes of n vectors, each in its own order. */
HERE void NAME(totals)(const int n, const L *v, double *sum) {
#if W == 8
    SPARI_UNROLL_ALL
    for (int j = 0; j < n; j += 8) {
        static const double zero = 0;
        L a[8], b[4], c[2], d;
        SPARI_UNROLL
        for (int i = 0; i < 8; i++) {
            a[i] = SPLAT(&zero);
            if (j + i < n) {
                a[i] = v[j + i];
            }
        }
        SPARI_UNROLL
        for (int i = 0; i < 4; i++) {
            b[i] = MIX(a[2 * i], a[2 * i + 1], 0, 8, 2, 10, 4, 12, 6, 14) +
                   MIX(a[2 * i], a[2 * i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
        }
        SPARI_UNROLL
        for (int i = 0; i < 2; i++) {
            c[i] = MIX(b[2 * i], b[2 * i + 1], 0, 1, 8, 9, 4, 5, 12, 13) +
                   MIX(b[2 * i], b[2 * i + 1], 2, 3, 10, 11, 6, 7, 14, 15);
        }
        d = MIX(c[0], c[1], 0, 1, 2, 3, 8, 9, 10, 11) + MIX(c[0], c[1], 4, 5, 6, 7, 12, 13, 14, 15);
        memcpy(sum + j, &d, (size_t)(n - j < 8 ? n - j : 8) * sizeof *sum);
    }
#else
    SPARI_UNROLL_ALL
    for (int j = 0; j < n; j++) {
        sum[j] = NAME(total)(v[j]);
    }
#endif
}

/* take: n accumulators from held, or zeros. give: stores them in held, or adds their lanes to sum. */
HERE void NAME(take_held)(const int n, int begin, const double *held, L *a) {
    static const double zero = 0;
    SPARI_UNROLL_ALL
    for (int j = 0; j < n; j++) {
        a[j] = SPLAT(&zero);
        if (!begin) {
            a[j] = NAME(get)(held + (ptrdiff_t)j * W);
        }
    }
}

HERE int NAME(give_held)(const int n, int end, const L *a, double *held, double *sum) {
    if (end) {
        NAME(totals)(n, a, sum);
        return 1;
    }
    SPARI_UNROLL_ALL
    for (int j = 0; j < n; j++) {
        NAME(put)(held + (ptrdiff_t)j * W, a[j]);
    }
    return 0;
}

/* Modes k to k + most - 1 of a run: modal[k][f] += sum_i t[k][i] row_f[i]. Modes beyond the last repeat it and are
   dropped. The sums are in registers. */
HERE void NAME(project_some)(const int most, const int rows, int k, int modes, int count, double (*t)[SPARI_ROW],
                             const tile_loads *f, double (*g)[SPARI_ROW], double *modal, const char **next,
                             const char *last) {
    L a[4 * 7];
    const char *ask = *next;
    double sum[4 * 7], *held = f->held + (ptrdiff_t)k * rows * W;
    const double *mode[4], *row[7];
    SPARI_UNROLL
    for (int m = 0; m < most; m++) {
        mode[m] = t[k + m < modes ? k + m : modes - 1];
    }
    SPARI_UNROLL
    for (int j = 0; j < rows; j++) {
        row[j] = j < 3 ? f->row[j] + f->at : g[j - 3];
    }
    NAME(take_held)(most * rows, f->begin, held, a);
    for (int i = 0; i < count; i += W) {
        L T[4];
        SPARI_UNROLL
        for (int m = 0; m < most; m++) {
            T[m] = NAME(get)(mode[m] + i);
        }
        if (ask < last) {
            SPARI_AHEAD(ask);
            ask += 64;
        }
        SPARI_UNROLL
        for (int j = 0; j < rows; j++) {
            L y = NAME(get)(row[j] + i);
            SPARI_UNROLL
            for (int m = 0; m < most; m++) {
                a[m * rows + j] = MADD(T[m], y, a[m * rows + j]);
            }
        }
    }
    *next = ask;
    if (NAME(give_held)(most * rows, f->end, a, held, sum)) {
        for (int m = 0; m < most && k + m < modes; m++) {
            for (int j = 0; j < rows; j++) {
                spari_add(modal + ((ptrdiff_t)(k + m) * 7 + j) * 2, sum[m * rows + j]);
            }
        }
    }
}

/* Number of passes over the rows: as many modes at a time as there are registers. */
HERE int NAME(times)(int modes) {
    return W == 8 ? modes / 4 + (modes % 4 + 1) / 2 : (modes + 1) / 2;
}

/* Prefetches of the host's forces of a later tile are spread over the work: one line per vector and pass, and the
   remaining bytes per pair of vectors before that. */
HERE int NAME(ask_before)(const tile_loads *f, int modes) {
    const int rest = 3 * PAIR * f->size - 128 * NAME(times)(modes);
    return f->next && rest > 0 ? rest : 0;
}

HERE void NAME(project)(const int rows, int modes, int count, double (*t)[SPARI_ROW], const tile_loads *f,
                        double (*g)[SPARI_ROW], double *modal) {
    const char *next = NULL, *last = NULL;
    int k = 0;
    if (f->next) {
        next = f->next + (ptrdiff_t)3 * f->at * f->size;
        last = next + (ptrdiff_t)3 * count * f->size;
        next += (ptrdiff_t)NAME(ask_before)(f, modes) * (count / PAIR);
    }
#if W == 8
    for (; k + 2 < modes; k += 4) {
        NAME(project_some)(4, rows, k, modes, count, t, f, g, modal, &next, last);
    }
#endif
    for (; k < modes; k += 2) {
        NAME(project_some)(2, rows, k, modes, count, t, f, g, modal, &next, last);
    }
}

/* Prefetches the host's forces of a later tile. */
HERE void NAME(ask_loads)(const tile_loads *f, int at) {
    if (f->next) {
        SPARI_UNROLL
        for (int k = 0; k < 3 * PAIR * f->size; k += 64) {
            SPARI_AHEAD(f->next + (ptrdiff_t)3 * (f->at + at) * f->size + k);
        }
    }
}

/* Loads of PAIR nodes; lanes past the end of a run have no load. */
HERE void NAME(fetch_loads)(const tile_loads *f, const int rows, int at, int count, L (*to)[2]) {
    const double *const from[6] = {f->row[0], f->row[1], f->row[2], f->row[3], f->row[4], f->row[5]};
    double pad[6][PAIR];
    const double *row[6];
    NAME(ask_loads)(f, at);
    NAME(begin_rows)(from, rows, 1, f->at + at, 0, count < PAIR ? count : PAIR, pad, row);
    NAME(get_pair)(row, rows, 0, to);
}

HERE void NAME(add_audit)(const L *add, const L *top, double *sums, double *tops) {
    double total[9];
    NAME(totals)(9, add, total);
    for (int i = 0; i < 9; i++) {
        spari_add(sums + 2 * i, total[i]);
    }
    for (int i = 0; i < 3; i++) {
        double m = NAME(least)(top[i]);
        tops[i] = m < tops[i] ? m : tops[i];
    }
}

/* Contribution of a tile to a point or rigid body: sums of forces and moments, and the moment of R Z. */
HERE void NAME(add_carried)(const carrier *m, const int has_moment, const L *Z, const L *total, double *modal) {
    double z[9], load[6];
    SPARI_UNROLL
    for (int i = 0; i < 9; i++) {
        z[i] = NAME(total)(Z[i]);
    }
    SPARI_UNROLL
    for (int i = 0; i < 3; i++) {
        const double *a = m->rotation + 3 * ((i + 1) % 3), *b = m->rotation + 3 * ((i + 2) % 3);
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        load[i] = NAME(total)(total[i]);
        load[3 + i] = a[0] * z[k] + a[1] * z[3 + k] + a[2] * z[6 + k] - b[0] * z[j] - b[1] * z[3 + j] - b[2] * z[6 + j];
        load[3 + i] += has_moment ? NAME(total)(total[3 + i]) : 0;
    }
    SPARI_UNROLL
    for (int i = 0; i < 6; i++) {
        spari_add(modal + (ptrdiff_t)2 * i, load[i]);
    }
}

/* Loads on a point or rigid body: the force, and the moment of R Z with Z = sum c f^T. The rotation is applied once,
   after the sum over the tile. */
HERE void NAME(load_carrier)(const spari_nodes *s, int64_t first, int count, const carrier *m, const int has_moment,
                             const tile_loads *f, const int audited, double *modal, double *sums, double *tops) {
    static const double zero = 0;
    const double *const *from = (const double *const *)s->con;
    const int rows = has_moment ? 6 : 3;
    const L none = SPLAT(&zero);
    L c[3][2], in[6][2], Z[9], total[6], add[9], top[3], rotation[9], place[3], rate[3], w[3];
    SPARI_UNROLL
    for (int i = 0; i < 9; i++) {
        Z[i] = add[i] = none;
    }
    SPARI_UNROLL
    for (int i = 0; i < 3; i++) {
        total[i] = total[3 + i] = top[i] = none;
    }
    NAME(splat)(9, m->rotation, rotation);
    NAME(splat)(3, m->place, place);
    NAME(splat)(3, m->rate, rate);
    NAME(splat)(3, m->omega, w);
    for (int at = 0; at < count; at += PAIR) {
        NAME(fetch_nodes)(s, from, first + at, count - at, c);
        NAME(fetch_loads)(f, rows, at, count - at, in);
        SPARI_UNROLL
        for (int u = 0; u < 2; u++) {
            SPARI_UNROLL
            for (int i = 0; i < rows; i++) {
                total[i] += in[i][u];
            }
            SPARI_UNROLL
            for (int i = 0; i < 9; i++) {
                Z[i] = MADD(c[i / 3][u], in[i % 3][u], Z[i]);
            }
            if (audited) {
                L arm[3] = {c[0][u], c[1][u], c[2][u]}, r[3], force[3] = {in[0][u], in[1][u], in[2][u]}, moment[3];
                NAME(rotate)(rotation, arm, r);
                for (int i = 0; i < 3; i++) {
                    moment[i] = has_moment ? in[3 + i][u] : none;
                }
                NAME(audit)(has_moment, place, r, rate, w, force, moment, add, top);
            }
        }
    }
    NAME(add_carried)(m, has_moment, Z, total, modal);
    if (audited) {
        NAME(add_audit)(add, top, sums, tops);
    }
}

HERE double NAME(gather)(const spari_nodes *s, int64_t first, int count, const double *c, const int consistent,
                         const int has_moment, const tile_loads *f, const int audited, double (*work)[SPARI_ROW],
                         double *modal, double *sums, double *tops) {
    static const double huge = HUGE_VAL;
    double(*g)[SPARI_ROW] = work, (*t)[SPARI_ROW] = work + 4, pad[10][PAIR];
    const double *const from[4] = {s->xi, s->con[0], s->con[1], s->con[2]}, *const loads[6] = {f->row[0], f->row[1],
                                                                                               f->row[2], f->row[3],
                                                                                               f->row[4], f->row[5]};
    const int modes = s->per_element, rows = has_moment ? 6 : 3, before = NAME(ask_before)(f, modes);
    const char *ask = before ? f->next + (ptrdiff_t)3 * f->at * f->size : NULL;
    double *held = f->held + (ptrdiff_t)7 * (modes + 3) * W;
    L least = SPLAT(&huge), in[10][2], add[9], top[3];
    if (audited) {
        NAME(take_held)(9, f->begin, held, add);
        NAME(take_held)(3, f->begin, held + (ptrdiff_t)9 * W, top);
    }
    for (int begin = 0, end = count - count % PAIR; begin < count; begin = end, end = count) {
        const double *row[10];
        NAME(begin_rows)(from, 4, 0, first, begin, end, pad, row);
        NAME(begin_rows)(loads, rows, 1, f->at, begin, end, pad + 4, row + 4);
        for (int i = begin; i < end; i += PAIR) {
            NAME(ask_ahead)(s, from, 4, first + i);
            for (int k = 0; k < before; k += 64, ask += 64) {
                SPARI_AHEAD(ask);
            }
            NAME(get_pair)(row, 4 + rows, i - begin, in);
            least = NAME(less)(least, NAME(lever)(modes, c, consistent, has_moment, audited, (const L(*)[2])in,
                                                  t[0] + i, g, i, add, top));
        }
    }
    for (int k = 0; k < modes; k++) {
        for (int i = count; i % W; i++) {
            t[k][i] = 0;
        }
    }
    NAME(project)(consistent ? 7 : 6, modes, count, t, f, g, modal);
    if (audited && f->end) {
        NAME(add_audit)(add, top, sums, tops);
    } else if (audited) {
        NAME(give_held)(9, 0, add, held, NULL);
        NAME(give_held)(3, 0, top, held + (ptrdiff_t)9 * W, NULL);
    }
    return NAME(least)(least);
}

/* One function per request, so that none needs the stack of all. */
#define GATHER(name, consistent, moment, audited)                                                                      \
    TARGET SPARI_APART static double NAME(gather_##name)(                                                              \
        const spari_nodes *s, int64_t first, int count, const double *c, const tile_loads *f,                          \
        double(*work)[SPARI_ROW], double *modal, double *sums, double *tops) {                                         \
        return NAME(gather)(s, first, count, c, consistent, moment, f, audited, work, modal, sums, tops);              \
    }
GATHER(nodal, 0, 0, 0)
GATHER(consistent, 1, 0, 0)
GATHER(nodal_audited, 0, 0, 1)
GATHER(consistent_audited, 1, 0, 1)
GATHER(nodal_moment, 0, 1, 0)
GATHER(consistent_moment, 1, 1, 0)
GATHER(nodal_moment_audited, 0, 1, 1)
GATHER(consistent_moment_audited, 1, 1, 1)
#undef GATHER

/* Loads of a point or rigid body. */
TARGET SPARI_APART static double NAME(loads_carried)(const spari_nodes *s, int64_t first, int count, const double *c,
                                                     int has_moment, const tile_loads *f, int audited, double *modal,
                                                     double *sums, double *tops) {
    const carrier m = spari_carrier_of(c);
    switch (2 * !!has_moment + !!audited) {
    case 0:
        NAME(load_carrier)(s, first, count, &m, 0, f, 0, modal, sums, tops);
        break;
    case 1:
        NAME(load_carrier)(s, first, count, &m, 0, f, 1, modal, sums, tops);
        break;
    case 2:
        NAME(load_carrier)(s, first, count, &m, 1, f, 0, modal, sums, tops);
        break;
    default:
        NAME(load_carrier)(s, first, count, &m, 1, f, 1, modal, sums, tops);
    }
    return m.square;
}

TARGET static double NAME(loads)(const spari_nodes *s, int64_t first, int count, const double *c, int consistent,
                                 int has_moment, const tile_loads *f, int audited, double (*work)[SPARI_ROW],
                                 double *modal, double *sums, double *tops) {
    if (s->per_element == 1) {
        return NAME(loads_carried)(s, first, count, c, has_moment, f, audited, modal, sums, tops);
    }
    static double (*const sum[2][2][2])(const spari_nodes *, int64_t, int, const double *, const tile_loads *,
                                        double(*)[SPARI_ROW], double *, double *, double *) = {
        {{NAME(gather_nodal), NAME(gather_consistent)}, {NAME(gather_nodal_audited), NAME(gather_consistent_audited)}},
        {{NAME(gather_nodal_moment), NAME(gather_consistent_moment)},
         {NAME(gather_nodal_moment_audited), NAME(gather_consistent_moment_audited)}}};
    return sum[!!has_moment][!!audited][!!consistent](s, first, count, c, f, work, modal, sums, tops);
}

#include "kernel_bins.h"

const spari_transfer_kernels NAME(spari_transfer_kernels) = {
    .motion = NAME(motion),
    .loads = NAME(loads),
    .bins = NAME(bins),
    .carry = NAME(carry_to),
    .move_to = NAME(move_to),
    .give = NAME(give_triples),
    .give_singles = NAME(give_singles),
    .load = NAME(load_triples),
    .load_singles = NAME(load_singles),
};
#endif
