/* Sparse complex systems in band storage: ordering, factors and solution. See band.h. */
#include "band.h"

#include "../base/status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct spari_band {
    int n, width;      /* half the bandwidth */
    int *place;        /* position of an unknown in the band */
    int *swap;         /* row exchanges */
    double complex *A; /* column by column, 3 width + 1 each: entry (i, j) at 2 width + i - j */
    double complex *x; /* [n] workspace */
};

/* ---- ordering ---- */

/* Adjacency lists: the neighbours of i are next[begin[i]] .. next[begin[i + 1] - 1]. */
typedef struct band_graph {
    int n;
    int64_t *begin;
    int *next;
} band_graph;

static const int *at_entry(const int *of, int64_t i, size_t apart) {
    return (const int *)(const void *)((const char *)of + (size_t)i * apart);
}

static int ascending_ints(const void *a, const void *b) {
    int x = *(const int *)a, y = *(const int *)b;
    return (x > y) - (x < y);
}

/* Removes repeated neighbours. */
static void single_neighbours(band_graph *g) {
    int64_t to = 0;
    for (int i = 0; i < g->n; i++) {
        int64_t from = g->begin[i], end = g->begin[i + 1];
        qsort(g->next + from, (size_t)(end - from), sizeof *g->next, ascending_ints);
        g->begin[i] = to;
        for (int64_t k = from; k < end; k++) {
            if (k == from || g->next[k] != g->next[k - 1]) {
                g->next[to++] = g->next[k];
            }
        }
    }
    g->begin[g->n] = to;
}

static int make_graph(band_graph *g, int64_t entries, const int *row, const int *column, size_t apart) {
    g->begin = spari_zalloc((int64_t)g->n + 2, sizeof *g->begin);
    g->next = spari_zalloc(2 * entries, sizeof *g->next);
    if (!g->begin || !g->next) {
        return 1;
    }
    for (int64_t i = 0; i < entries; i++) {
        g->begin[*at_entry(row, i, apart) + 2]++;
        g->begin[*at_entry(column, i, apart) + 2]++;
    }
    for (int i = 0; i < g->n; i++) {
        g->begin[i + 2] += g->begin[i + 1];
    }
    for (int64_t i = 0; i < entries; i++) {
        int r = *at_entry(row, i, apart), c = *at_entry(column, i, apart);
        g->next[g->begin[r + 1]++] = c;
        g->next[g->begin[c + 1]++] = r;
    }
    single_neighbours(g);
    return 0;
}

static int64_t neighbours(const band_graph *g, int i) {
    return g->begin[i + 1] - g->begin[i];
}

/* Breadth-first search from `start`; each level in the order of its parents, low degrees first. queue: output; seen
   [n] is set to `mark`. Returns the number of unknowns reached. */
static int walk_graph(const band_graph *g, int start, int mark, int *seen, int *queue) {
    int end = 0;
    queue[end++] = start;
    seen[start] = mark;
    for (int at = 0; at < end; at++) {
        int first = end, i = queue[at];
        for (int64_t k = g->begin[i]; k < g->begin[i + 1]; k++) {
            int j = g->next[k], place = end;
            if (seen[j] == mark) {
                continue;
            }
            seen[j] = mark;
            for (; place > first && neighbours(g, queue[place - 1]) > neighbours(g, j); place--) {
                queue[place] = queue[place - 1];
            }
            queue[place] = j;
            end++;
        }
    }
    return end;
}

/* place [n]: reverse Cuthill-McKee order, from a peripheral unknown of each connected part. */
static int order_graph(const band_graph *g, int *place) {
    int *seen = spari_zalloc(2 * (int64_t)g->n, sizeof *seen), *queue = seen ? seen + g->n : NULL, done = 0, mark = 0;
    if (!seen) {
        return 1;
    }
    memset(place, -1, (size_t)g->n * sizeof *place);
    for (int i = 0; i < g->n; i++) {
        int start = i, count = 0;
        for (int pass = 0; pass < 3 && place[i] < 0; pass++) {
            count = walk_graph(g, start, ++mark, seen, queue);
            start = queue[count - 1];
        }
        for (int k = 0; k < count; k++) {
            place[queue[k]] = g->n - 1 - done++;
        }
    }
    free(seen);
    return 0;
}

/* ---- the system ---- */

spari_band *spari_band_create(int n, int64_t entries, const int *row, const int *column, size_t apart) {
    spari_band *b = spari_zalloc(1, sizeof *b);
    band_graph g = {.n = n};
    if (!b) {
        return NULL;
    }
    b->n = n;
    b->place = spari_zalloc(n, sizeof *b->place);
    b->swap = spari_zalloc(n, sizeof *b->swap);
    b->x = spari_zalloc(n, sizeof *b->x);
    int bad =
        !b->place || !b->swap || !b->x || make_graph(&g, entries, row, column, apart) || order_graph(&g, b->place);
    SPARI_FREE(g.begin, g.next);
    for (int64_t i = 0; i < entries && !bad; i++) {
        int apart_by = abs(b->place[*at_entry(row, i, apart)] - b->place[*at_entry(column, i, apart)]);
        b->width = apart_by > b->width ? apart_by : b->width;
    }
    b->A = bad ? NULL : spari_zalloc((int64_t)n * (3 * (int64_t)b->width + 1), sizeof *b->A);
    if (!b->A) {
        spari_band_free(b);
        return NULL;
    }
    return b;
}

void spari_band_free(spari_band *b) {
    if (b) {
        SPARI_FREE(b->place, b->swap, b->A, b->x, b);
    }
}

void spari_band_zero(spari_band *b) {
    memset(b->A, 0, (size_t)b->n * (3 * (size_t)b->width + 1) * sizeof *b->A);
}

static double complex *band_entry(const spari_band *b, int i, int j) {
    return b->A + (int64_t)j * (3 * (int64_t)b->width + 1) + 2 * b->width + i - j;
}

void spari_band_add(spari_band *b, int row, int column, double complex x) {
    *band_entry(b, b->place[row], b->place[column]) += x;
}

/* y [n] -= f x, without C's treatment of NaN in complex products: the factors are checked at the end. */
static void take_off_column(int n, double complex f, const double complex *x, double complex *y) {
    const double *a = (const double *)x, re = creal(f), im = cimag(f);
    double *b = (double *)y;
    for (int i = 0; i < 2 * n; i += 2) {
        b[i] -= re * a[i] - im * a[i + 1];
        b[i + 1] -= re * a[i + 1] + im * a[i];
    }
}

int spari_band_factor(spari_band *b) {
    int n = b->n, w = b->width, reach = 0;
    for (int k = 0; k < n; k++) {
        int last = k + w < n ? k + w : n - 1, pivot = k;
        double complex *column = band_entry(b, k, k);
        for (int i = k + 1; i <= last; i++) {
            pivot = cabs(column[i - k]) > cabs(column[pivot - k]) ? i : pivot;
        }
        double size = cabs(column[pivot - k]);
        if (!(size > 0) || !isfinite(size)) {
            return 1;
        }
        b->swap[k] = pivot;
        int far = pivot + w < n ? pivot + w : n - 1;
        reach = far > reach ? far : reach;
        for (int j = k; j <= reach && pivot != k; j++) {
            double complex *x = band_entry(b, k, j), *y = band_entry(b, pivot, j), kept = *x;
            *x = *y;
            *y = kept;
        }
        for (int i = 1; i <= last - k; i++) {
            column[i] /= column[0];
        }
        for (int j = k + 1; j <= reach; j++) {
            double complex *at = band_entry(b, k, j);
            take_off_column(last - k, *at, column + 1, at + 1);
        }
    }
    return 0;
}

void spari_band_solve(spari_band *b, double complex *x) {
    int n = b->n, w = b->width;
    for (int i = 0; i < n; i++) {
        b->x[b->place[i]] = x[i];
    }
    for (int k = 0; k < n; k++) {
        double complex swapped = b->x[b->swap[k]];
        b->x[b->swap[k]] = b->x[k];
        b->x[k] = swapped;
        take_off_column((k + w < n ? k + w : n - 1) - k, b->x[k], band_entry(b, k, k) + 1, b->x + k + 1);
    }
    for (int k = n - 1; k >= 0; k--) {
        int first = k - 2 * w > 0 ? k - 2 * w : 0;
        b->x[k] /= *band_entry(b, k, k);
        take_off_column(k - first, b->x[k], band_entry(b, first, k), b->x + first);
    }
    for (int i = 0; i < n; i++) {
        x[i] = b->x[b->place[i]];
    }
}
