/* Vectors and rotations of W points or nodes, one per lane, with loads and stores from arrays of nodes. Included
   once per width with the macros of width.h; with W = 1 it is plain C. No include guard: this is a body, not an
   interface.
   Lanes are independent and nothing is fused, so the results have the same bits at every width. With SPARI_FUSED
     (quadrature points) vectors and the functions marked "fused" use fused multiply-add if the processor has it. */

/* a b + c */
#undef FUSE
#ifdef SPARI_FUSED
#define FUSE(a, b, c) MADD(a, b, c)
#else
#define FUSE(a, b, c) ((a) * (b) + (c))
#endif

/* ---- loads and stores of nodes ---- */

/* Component p of W nodes, whose arrays have `width` numbers per node: of consecutive nodes, or (not whole) of the
   nodes `at`. */
#undef NODE_AT
#define NODE_AT(l) ((p)[width * (whole ? (l) : at[l])])
HERE L NAME(pick)(const int whole, const int64_t *at, const int width, const double *p) {
    (void)at;
#if W == 1
    return NODE_AT(0);
#elif W == 2
    return (L){NODE_AT(0), NODE_AT(1)};
#elif W == 4
    return (L){NODE_AT(0), NODE_AT(1), NODE_AT(2), NODE_AT(3)};
#else
    return (L){NODE_AT(0), NODE_AT(1), NODE_AT(2), NODE_AT(3), NODE_AT(4), NODE_AT(5), NODE_AT(6), NODE_AT(7)};
#endif
}

HERE void NAME(drop)(const int whole, const int64_t *at, const int width, double *p, L x) {
    (void)at;
#if W == 1
    NODE_AT(0) = x;
#else
    SPARI_UNROLL
    for (int l = W - 1; l >= 0; l--) {
        NODE_AT(l) = x[l];
    }
#endif
}

/* Two adjacent components: nodes are loaded and stored two numbers at a time and transposed in pairs. */
#undef PAIRED
#ifdef LOW
#define PAIRED 1
#define PAIR_OF(l) _mm_loadu_pd(&NODE_AT(l))
HERE void NAME(pick_pair)(const int whole, const int64_t *at, const int width, const double *p, L *x) {
    (void)at;
#if W == 2
    L even = PAIR_OF(0), odd = PAIR_OF(1);
#elif W == 4
    L even = _mm256_insertf128_pd(_mm256_castpd128_pd256(PAIR_OF(0)), PAIR_OF(2), 1);
    L odd = _mm256_insertf128_pd(_mm256_castpd128_pd256(PAIR_OF(1)), PAIR_OF(3), 1);
#else
    L even = _mm512_insertf64x2(_mm512_castpd128_pd512(PAIR_OF(0)), PAIR_OF(2), 1);
    L odd = _mm512_insertf64x2(_mm512_castpd128_pd512(PAIR_OF(1)), PAIR_OF(3), 1);
    even = _mm512_insertf64x2(_mm512_insertf64x2(even, PAIR_OF(4), 2), PAIR_OF(6), 3);
    odd = _mm512_insertf64x2(_mm512_insertf64x2(odd, PAIR_OF(5), 2), PAIR_OF(7), 3);
#endif
    x[0] = LOW(even, odd);
    x[1] = HIGH(even, odd);
}

HERE void NAME(drop_pair)(const int whole, const int64_t *at, const int width, double *p, const L *x) {
    (void)at;
    L even = LOW(x[0], x[1]), odd = HIGH(x[0], x[1]);
    SPARI_UNROLL
    for (int l = W - 2; l >= 0; l -= 2) {
        memcpy(&NODE_AT(l + 1), (double *)&odd + l, 2 * sizeof *p);
        memcpy(&NODE_AT(l), (double *)&even + l, 2 * sizeof *p);
    }
}
#endif

/* n consecutive components; if n is odd, the last pair overlaps the one before. */
HERE void NAME(pick_rows)(const int whole, const int64_t *at, const int width, const int n, const double *p, L *x) {
#ifdef PAIRED
    SPARI_UNROLL
    for (int i = 0; i + 1 < n; i += 2) {
        NAME(pick_pair)(whole, at, width, p + i, x + i);
    }
    if (n % 2 == 1) {
        NAME(pick_pair)(whole, at, width, p + n - 2, x + n - 2);
    }
#else
    SPARI_UNROLL
    for (int i = 0; i < n; i++) {
        x[i] = NAME(pick)(whole, at, width, p + i);
    }
#endif
}

HERE void NAME(drop_rows)(const int whole, const int64_t *at, const int width, const int n, double *p, const L *x) {
#ifdef PAIRED
    SPARI_UNROLL
    for (int i = 0; i + 1 < n; i += 2) {
        NAME(drop_pair)(whole, at, width, p + i, x + i);
    }
    if (n % 2 == 1) {
        NAME(drop_pair)(whole, at, width, p + n - 2, x + n - 2);
    }
#else
    SPARI_UNROLL
    for (int i = 0; i < n; i++) {
        NAME(drop)(whole, at, width, p + i, x[i]);
    }
#endif
}

/* The next W of `left` nodes. If there are fewer, the remaining lanes repeat the last node; they are stored first,
   so that the last node's own result overwrites them. Returns whether there are W. */
HERE int NAME(next_nodes)(int64_t left, int64_t *at) {
    for (int l = 0; l < W && left < W; l++) {
        at[l] = l < left ? l : left - 1;
    }
    return left >= W;
}

/* ---- per lane ---- */

HERE L NAME(root)(L x) {
#ifdef ROOT
    return ROOT(x);
#else
    double t[W];
    memcpy(t, &x, sizeof x);
    for (int i = 0; i < W; i++) {
        t[i] = sqrt(t[i]);
    }
    return NAME(get)(t);
#endif
}

/* The larger of a and b; b if one is NaN. */
HERE L NAME(larger)(L a, L b) {
#ifdef MOST
    return MOST(a, b);
#else
    double x[W], y[W];
    NAME(put)(x, a);
    NAME(put)(y, b);
    for (int i = 0; i < W; i++) {
        y[i] = x[i] > y[i] ? x[i] : y[i];
    }
    return NAME(get)(y);
#endif
}

/* Whether any lane of a is larger than the lane of b. */
HERE int NAME(any_above)(L a, L b) {
#ifdef ABOVE
    return ABOVE(a, b) != 0;
#else
    int any = 0;
    double x[W], y[W];
    NAME(put)(x, a);
    NAME(put)(y, b);
    for (int i = 0; i < W; i++) {
        any |= x[i] > y[i];
    }
    return any;
#endif
}

/* The largest of the lanes and of `so_far`. */
HERE double NAME(largest)(double so_far, L x) {
    double t[W];
    NAME(put)(t, x);
    for (int i = 0; i < W; i++) {
        so_far = t[i] > so_far ? t[i] : so_far;
    }
    return so_far;
}

/* ---- vectors and rotations ---- */

HERE void NAME(cross)(const L *a, const L *b, L *c) {
    L x = FUSE(a[1], b[2], -(a[2] * b[1])), y = FUSE(a[2], b[0], -(a[0] * b[2])), z = FUSE(a[0], b[1], -(a[1] * b[0]));
    c[0] = x, c[1] = y, c[2] = z; /* c may be a or b */
}

HERE L NAME(dot)(const L *a, const L *b) {
    return FUSE(a[2], b[2], FUSE(a[1], b[1], a[0] * b[0]));
}

HERE L NAME(quat_dot)(const L *a, const L *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

HERE L NAME(norm)(const L *a) {
    return NAME(root)(NAME(dot)(a, a));
}

/* y = R(q) x for unit q; y may be x */
HERE void NAME(rotate)(const L *q, const L *x, L *y) {
    L t[3], s[3];
    NAME(cross)(q + 1, x, t);
    t[0] *= 2.0, t[1] *= 2.0, t[2] *= 2.0;
    NAME(cross)(q + 1, t, s);
    for (int i = 0; i < 3; i++) {
        y[i] = FUSE(q[0], t[i], x[i]) + s[i];
    }
}

/* y = R(q)^T x for unit q; y may be x */
HERE void NAME(rotate_back)(const L *q, const L *x, L *y) {
    const L c[4] = {q[0], -q[1], -q[2], -q[3]};
    NAME(rotate)(c, x, y);
}

/* y = R x, R row-major; y may be x */
HERE void NAME(matrix_times)(const double *R, const L *x, L *y) {
    L a = R[0] * x[0] + R[1] * x[1] + R[2] * x[2], b = R[3] * x[0] + R[4] * x[1] + R[5] * x[2];
    L c = R[6] * x[0] + R[7] * x[1] + R[8] * x[2];
    y[0] = a, y[1] = b, y[2] = c;
}

/* y = R^T x; y may be x */
HERE void NAME(matrix_times_back)(const double *R, const L *x, L *y) {
    L a = R[0] * x[0] + R[3] * x[1] + R[6] * x[2], b = R[1] * x[0] + R[4] * x[1] + R[7] * x[2];
    L c = R[2] * x[0] + R[5] * x[1] + R[8] * x[2];
    y[0] = a, y[1] = b, y[2] = c;
}

/* c = a b */
HERE void NAME(quat_mul)(const L *a, const L *b, L *c) {
    c[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    c[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    c[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    c[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
}

/* Im(a* b), fused */
HERE void NAME(imag_conj_mul)(const L *a, const L *b, L *c) {
    SPARI_UNROLL
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        c[i] = FUSE(-b[0], a[1 + i], a[0] * b[1 + i]) - FUSE(a[1 + j], b[1 + k], -(a[1 + k] * b[1 + j]));
    }
}

/* quaternion product of the pure quaternion s and q */
HERE void NAME(vec_quat)(const L *s, const L *q, L *c) {
    c[0] = -s[0] * q[1] - s[1] * q[2] - s[2] * q[3];
    c[1] = s[0] * q[0] + s[1] * q[3] - s[2] * q[2];
    c[2] = s[1] * q[0] - s[0] * q[3] + s[2] * q[1];
    c[3] = s[0] * q[2] - s[1] * q[1] + s[2] * q[0];
}

/* quaternion product of q and the pure quaternion s, fused */
HERE void NAME(quat_vec)(const L *q, const L *s, L *c) {
    c[0] = FUSE(-q[3], s[2], FUSE(-q[2], s[1], -q[1] * s[0]));
    c[1] = FUSE(-q[3], s[1], FUSE(q[2], s[2], q[0] * s[0]));
    c[2] = FUSE(q[3], s[0], FUSE(-q[1], s[2], q[0] * s[1]));
    c[3] = FUSE(-q[2], s[0], FUSE(q[1], s[1], q[0] * s[2]));
}
