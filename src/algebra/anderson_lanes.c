/* What Anderson mixing does of W unknowns at once, for one width of vectors (math/lanes.h).

   Sums are those of every 24th unknown whatever the width, and nothing is fused: the same bits at every width. */
#include "anderson_kernels.h"

#ifdef SPARI_HAS_OBJECT
#define SPARI_WIDTH SPARI_OBJECT_WIDTH
#include "../math/width.h"

/* The sum of a b over the unknowns from..to, whole stripes, each by its weight [24]. */
HERE double NAME(weighed)(const double *a, const double *b, const double *weight, int64_t from, int64_t to) {
    enum { EIGHT = SPARI_MIXED_STRIPE / 3, THIRD = EIGHT / W };
    L sum[SPARI_MIXED_STRIPE / W] = {0};
    double p[EIGHT];
    for (int64_t i = from; i < to; i += SPARI_MIXED_STRIPE) {
        SPARI_UNROLL
        for (int v = 0; v < SPARI_MIXED_STRIPE / W; v++) {
            sum[v] = sum[v] + NAME(get)(a + i + W * v) * NAME(get)(b + i + W * v);
        }
    }
    SPARI_UNROLL
    for (int v = 0; v < THIRD; v++) {
        L x = NAME(get)(weight + W * v) * sum[v], y = NAME(get)(weight + W * (v + THIRD)) * sum[v + THIRD];
        NAME(put)(p + W * v, x + y + NAME(get)(weight + W * (v + 2 * THIRD)) * sum[v + 2 * THIRD]);
    }
    return ((p[0] + p[1]) + (p[2] + p[3])) + ((p[4] + p[5]) + (p[6] + p[7]));
}

/* Stores the change of z in d[1], whose content is no longer needed, and the new z. Sums: products of this change
   with itself and with the change before, of that one with itself, of both with z, and of z with itself. */
TARGET static void NAME(look)(const spari_anderson *m, const double *x, int64_t from, int64_t to, double *sums) {
    const double *old = m->d[0];
    double *z = m->z, *d = m->d[1];
    for (int64_t i = from; i < to; i += W) {
        L now = NAME(get)(x + i);
        NAME(put)(d + i, now - NAME(get)(z + i));
        NAME(put)(z + i, now);
    }
    sums[0] = NAME(weighed)(d, d, m->weight, from, to);
    sums[1] = NAME(weighed)(d, old, m->weight, from, to);
    sums[2] = NAME(weighed)(old, old, m->weight, from, to);
    sums[3] = NAME(weighed)(d, x, m->weight, from, to);
    sums[4] = NAME(weighed)(old, x, m->weight, from, to);
    sums[5] = NAME(weighed)(x, x, m->weight, from, to);
}

/* x minus by[0] times the newer pair and by[1] times the older one. If both are 0, x is unchanged. */
TARGET static void NAME(mix)(const spari_anderson *m, const double *by, double *x, int64_t from, int64_t to) {
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

const spari_mixing_kernels NAME(spari_mixing_kernels) = {.look = NAME(look), .mix = NAME(mix)};
#endif
