/* Newton's corrections mixed with those before them: see anderson.h. */
#include "anderson_kernels.h"

#include "../base/status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SPAN = 256 * 6, VECTORS = 6 };

static int64_t spans_of(int64_t unknowns) {
    return (unknowns + SPAN - 1) / SPAN;
}

spari_anderson *spari_anderson_create(int64_t nodes) {
    spari_anderson *m = spari_zalloc(1, sizeof *m);
    int64_t n = spari_mixed_unknowns(nodes);
    int64_t all = VECTORS * n + SPARI_MIXED_SUMS * spans_of(n) + 8;
    if (!m || !(m->workspace = spari_zalloc(all, sizeof *m->workspace))) {
        free(m);
        return NULL;
    }
    m->unknowns = n;
    m->z = m->workspace + spari_to_line(m->workspace);
    m->c = m->z + n;
    m->d[0] = m->c + n, m->d[1] = m->d[0] + n;
    m->w[0] = m->d[1] + n, m->w[1] = m->w[0] + n;
    m->sums = m->w[1] + n;
    return m;
}

void spari_anderson_free(spari_anderson *m) {
    if (m) {
        free(m->workspace);
        free(m);
    }
}

typedef struct anderson_pass {
    const spari_anderson *m;
    const spari_mixing_kernels *kernels;
    double *x, by[2];
} anderson_pass;

static void look_at_span(void *context, int64_t from, int64_t to) {
    const anderson_pass *t = context;
    const spari_anderson *m = t->m;
    /* after two corrections without mixing (the second is in w[0]): the first pair */
    if (m->seen == 2) {
        const double *x = m->w[0];
        double *d = m->d[0], *z = m->z, *c = m->c;
        for (int64_t i = from; i < to; i++) {
            d[i] = x[i] - z[i];
            z[i] = c[i] = x[i];
        }
    }
    t->kernels->look(m, t->x, from, to, m->sums + SPARI_MIXED_SUMS * (from / SPAN));
}

static void mix_span(void *context, int64_t from, int64_t to) {
    const anderson_pass *t = context;
    t->kernels->mix(t->m, t->by, t->x, from, to);
}

static void keep_span(void *context, int64_t from, int64_t to) {
    const anderson_pass *t = context;
    double *kept = t->m->seen == 0 ? t->m->z : t->m->w[0];
    memcpy(kept + from, t->x + from, (size_t)(to - from) * sizeof *kept);
}

static void exchange(double **a) {
    double *there = a[0];
    a[0] = a[1];
    a[1] = there;
}

/* Below this ratio of successive corrections mixing saves nothing and is skipped. The first pair has a higher limit,
   because it contains the second-order part of the first correction, which is large. */
static const double slow = 0.03, slow_at_first = 0.2;

static int is_within_a_pair(double x) {
    return fabs(x) <= 1;
}

/* by: minimises |z - by[0] d[0] - by[1] d[1]|. Uses the newer pair alone if the pairs are dependent, or if a
   coefficient exceeds 1, which contradicts a contracting tangent. Uses no pair if that fails too. */
static void find_parts(const spari_anderson *m, double by[2]) {
    double sums[SPARI_MIXED_SUMS];
    memcpy(sums, m->sums, sizeof sums);
    for (int64_t k = 1; k < spans_of(m->unknowns); k++) { /* in the order of the spans */
        for (int i = 0; i < SPARI_MIXED_SUMS; i++) {
            sums[i] += m->sums[SPARI_MIXED_SUMS * k + i];
        }
    }
    double newer = sums[0], both = sums[1], older = sums[2], z_newer = sums[3], z_older = sums[4];
    double area = newer * older - both * both, least = m->seen == 2 ? slow_at_first : slow;
    by[0] = by[1] = 0;
    if (!(sums[5] > least * least * newer) || !isfinite(newer)) {
        return;
    }
    if (area > 1e-8 * newer * older) {
        by[0] = (older * z_newer - both * z_older) / area;
        by[1] = (newer * z_older - both * z_newer) / area;
    }
    if (!(area > 1e-8 * newer * older) || !is_within_a_pair(by[0]) || !is_within_a_pair(by[1])) {
        by[0] = fabs(z_newer) < newer ? z_newer / newer : 0;
        by[1] = 0;
    }
}

void spari_anderson_step(spari_anderson *m, spari_thread_pool *pool, int lanes, double length, double *x) {
    for (int i = 0; i < SPARI_MIXED_STRIPE; i++) {
        m->weight[i] = i % 6 < 3 ? 1 / (length * length) : 1;
    }
    anderson_pass t = {.m = m, .x = x};
    if (m->seen < 2) { /* a pair of eigenvalues +-lambda does not show in one change: two corrections are applied
                          without mixing */
        spari_thread_pool_spread(pool, m->unknowns, SPAN, keep_span, &t);
        m->seen++;
        return;
    }
    t.kernels = spari_mixing_kernels_for(lanes ? lanes : 8);
    spari_thread_pool_spread(pool, m->unknowns, SPAN, look_at_span, &t);
    exchange(m->d);
    exchange(m->w);
    find_parts(m, t.by);
    spari_thread_pool_spread(pool, m->unknowns, SPAN, mix_span, &t);
    m->seen++;
}
