/* What mixing does of W unknowns at once. Included by mixing.c once per width with the macros of math/width.h. No
   include guard: this is a body, not an interface.

   Sums are those of every 24th unknown whatever the width, and nothing is fused: the same bits at every width. */

/* The sum of a b over the unknowns from..to, whole stripes: displacements, turns. */
HERE void NAME(dot)(const double *a, const double *b, int64_t from, int64_t to, double *out) {
    L sum[STRIPE / W] = {0};
    double part[STRIPE];
    for (int64_t i = from; i < to; i += STRIPE) {
        SPARI_UNROLL
        for (int v = 0; v < STRIPE / W; v++) {
            sum[v] = sum[v] + NAME(get)(a + i + W * v) * NAME(get)(b + i + W * v);
        }
    }
    for (int v = 0; v < STRIPE / W; v++) {
        NAME(put)(part + W * v, sum[v]);
    }
    for (int side = 0; side < 2; side++) {
        const double *p = part + 3 * side;
        out[side] = ((p[0] + p[1] + p[2]) + (p[6] + p[7] + p[8])) + ((p[12] + p[13] + p[14]) + (p[18] + p[19] + p[20]));
    }
}

/* d[1], which is not needed any more, becomes the change of z, z what it is now. Sums of products:
   of that by itself, by the change before, of that one by itself, of both by z, and of z by itself. */
TARGET static void NAME(look)(const spari_mixing *m, const double *x, int64_t from, int64_t to, double *sums) {
    const double *old = m->d[0];
    double *z = m->z, *d = m->d[1];
    for (int64_t i = from; i < to; i += W) {
        L now = NAME(get)(x + i);
        NAME(put)(d + i, now - NAME(get)(z + i));
        NAME(put)(z + i, now);
    }
    NAME(dot)(d, d, from, to, sums);
    NAME(dot)(d, old, from, to, sums + 2);
    NAME(dot)(old, old, from, to, sums + 4);
    NAME(dot)(d, x, from, to, sums + 6);
    NAME(dot)(old, x, from, to, sums + 8);
    NAME(dot)(x, x, from, to, sums + 10);
}

/* x less by[0] times the newer pair and by[1] times the older one; neither: x itself, whatever they are. */
TARGET static void NAME(mix)(const spari_mixing *m, const double *by, double *x, int64_t from, int64_t to) {
    const double *d = m->d[0], *old = m->w[1], newer = by[0], older = by[1];
    double *c = m->c, *w = m->w[0];
    const int mixes = newer != 0 || older != 0;
    for (int64_t i = from; i < to; i += W) {
        L pair = NAME(get)(c + i) + NAME(get)(d + i);
        L now = NAME(get)(x + i);
        if (mixes) {
            now = now - newer * pair - older * NAME(get)(old + i);
        }
        NAME(put)(w + i, pair);
        NAME(put)(c + i, now);
        NAME(put)(x + i, now);
    }
}
