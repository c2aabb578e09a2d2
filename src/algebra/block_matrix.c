/* Sparse matrices of dense blocks: see block_matrix.h. */
#include "block_matrix.h"

#include "../base/status.h"
#include "../math/lanes.h"
#include "inertia.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIX = 6 }; /* unknowns of a tied block */

/* A block row and column in elimination order: the diagonal [size][size], and the entries shared with later blocks,
   as a row of blocks U [size][rows] and a column of blocks L [rows][size]. If it is tied, factoring makes them those
   of its components, first the held ones. */
typedef struct block_panel {
    int unit; /* block number before ordering */
    int size, first, rows;
    int near, nears;         /* begin and length of the list of later blocks */
    int all_rows, all_nears; /* rows and nears, which are 0 while U and L have no entries */
    int held, to;            /* number of held components, and position of the block they depend on (-1: none) */
    int based[2];            /* whether the bases of the tie are not the identity */
    int mixed, order[SIX];   /* whether the factors have the components in another order; this order */
    double *D, *U, *L;
    int *pivot;
    spari_tie *tie;
} block_panel;

struct spari_blocks {
    int n, rows;
    int *position; /* of a block in the order */
    int *start;    /* first row of a block in a vector */
    block_panel *panel;
    int *near;   /* positions of later blocks, increasing */
    int *offset; /* their first column in U and row in L */
    int *pivot;
    double *entry, least[2]; /* entries; smallest pivots, of displacements and of rotations */
    int watched, negative;   /* whether signs are counted; number of negative ones */
    int64_t entries;
};

/* Of a function that is called with constant lengths. */
#define KNOWN inline SPARI_ALWAYS_INLINE

/* ---- one dense block ---- */

/* Calls f with a known length n where that is common: three components or multipliers, one and five of a hinge, six
   unknowns. Such loops are several times faster, and sum in the same order. */
#define WITH_LENGTH(f, n, ...)                                                                                         \
    ((n) == 1   ? f(1, __VA_ARGS__)                                                                                    \
     : (n) == 3 ? f(3, __VA_ARGS__)                                                                                    \
     : (n) == 5 ? f(5, __VA_ARGS__)                                                                                    \
     : (n) == 6 ? f(6, __VA_ARGS__)                                                                                    \
                : f(n, __VA_ARGS__))

/* Calls f with a known width for columns c of a row, six or fewer at once: f keeps them in registers. */
#define IN_COLUMNS(n, call)                                                                                            \
    for (int c = 0, width = 0; c < (n); c += width) {                                                                  \
        width = (n)-c >= 6 ? 6 : (n)-c >= 3 ? 3 : 1;                                                                   \
        if (width == 6) {                                                                                              \
            call(6);                                                                                                   \
        } else if (width == 3) {                                                                                       \
            call(3);                                                                                                   \
        } else {                                                                                                       \
            call(1);                                                                                                   \
        }                                                                                                              \
    }

/* y -= f x */
static KNOWN void less_row(int n, double f, const double *x, double *y) {
    for (int j = 0; j < n; j++) {
        y[j] -= f * x[j];
    }
}

/* Blocks A [n][n] of row stride s. */
static KNOWN int factor_block_of(int n, int s, double *A, int *pivot) {
    for (int k = 0; k < n; k++) {
        int best = k;
        for (int i = k + 1; i < n; i++) {
            best = fabs(A[i * s + k]) > fabs(A[best * s + k]) ? i : best;
        }
        pivot[k] = best;
        for (int j = 0; j < n && best != k; j++) {
            double kept = A[k * s + j];
            A[k * s + j] = A[best * s + j];
            A[best * s + j] = kept;
        }
        double p = A[k * s + k];
        if (!(fabs(p) > 0) || !isfinite(p)) {
            return 1;
        }
        for (int i = k + 1; i < n; i++) {
            double f = A[i * s + k] /= p;
            if (f != 0) {
                less_row(n - k - 1, f, A + k * s + k + 1, A + i * s + k + 1);
            }
        }
    }
    return 0;
}

/* The whole block, or the part of a tied one. */
static KNOWN int factor_whole(int n, double *A, int *pivot) {
    return factor_block_of(n, n, A, pivot);
}

static KNOWN int factor_part(int n, double *A, int *pivot) {
    return factor_block_of(n, SIX, A, pivot);
}

static int factor_block(int n, int s, double *A, int *pivot) {
    return s == n ? WITH_LENGTH(factor_whole, n, A, pivot) : WITH_LENGTH(factor_part, n, A, pivot);
}

/* Two columns at once. */
#if defined(__GNUC__)
typedef double column_pair __attribute__((vector_size(16)));
static KNOWN column_pair less_times(column_pair y, double f, column_pair x) {
    return y - f * x;
}
#else
typedef struct column_pair {
    double of[2];
} column_pair;
static KNOWN column_pair less_times(column_pair y, double f, column_pair x) {
    return (column_pair){{y.of[0] - f * x.of[0], y.of[1] - f * x.of[1]}};
}
#endif

/* The r columns of y and x are one or two. */
static KNOWN void less_rows_of(int k, int r, int m, const double *A, int stride, const double *x, double *y) {
    for (int i = 0; i < m; i++, A += stride, y += r) {
        if (r == 1) {
            double left = *y;
            for (int l = 0; l < k; l++) {
                left -= A[l] * x[l];
            }
            *y = left;
        } else {
            column_pair left, by;
            memcpy(&left, y, sizeof left);
            for (int l = 0; l < k; l++) {
                memcpy(&by, x + 2 * l, sizeof by);
                left = less_times(left, A[l], by);
            }
            memcpy(y, &left, sizeof left);
        }
    }
}

/* y [m][r] -= A [m][k] x [k][r] */
static KNOWN void less_rows(int r, int m, int k, const double *A, int stride, const double *x, double *y) {
    WITH_LENGTH(less_rows_of, k, r, m, A, stride, x, y);
}

static KNOWN void solve_few_of(int n, int r, int s, const double *A, const int *pivot, double *x) {
    for (int k = 0; k < n; k++) {
        for (int c = 0; c < r; c++) {
            double kept = x[k * r + c];
            x[k * r + c] = x[pivot[k] * r + c], x[pivot[k] * r + c] = kept;
        }
    }
    SPARI_UNROLL
    for (int k = 1; k < n; k++) {
        less_rows_of(k, r, 1, A + k * s, s, x, x + k * r);
    }
    SPARI_UNROLL
    for (int k = n - 1; k >= 0; k--) {
        less_rows_of(n - 1 - k, r, 1, A + k * s + k + 1, s, x + (k + 1) * r, x + k * r);
        for (int c = 0; c < r; c++) {
            x[k * r + c] /= A[k * s + k];
        }
    }
}

static KNOWN void solve_few(int n, int r, const double *A, const int *pivot, double *x) {
    solve_few_of(n, r, n, A, pivot, x);
}

/* Some columns of the solution of a factored block. */
static KNOWN void solve_columns(int width, int n, int s, const double *A, const int *pivot, double *x, int stride) {
    for (int k = 0; k < n; k++) {
        for (int c = 0; c < width && pivot[k] != k; c++) {
            double kept = x[k * stride + c];
            x[k * stride + c] = x[pivot[k] * stride + c], x[pivot[k] * stride + c] = kept;
        }
    }
    for (int k = 0; k < n; k++) {
        double row[6];
        memcpy(row, x + k * stride, (size_t)width * sizeof *row);
        for (int i = 0; i < k; i++) {
            less_row(width, A[k * s + i], x + i * stride, row);
        }
        memcpy(x + k * stride, row, (size_t)width * sizeof *row);
    }
    for (int k = n - 1; k >= 0; k--) {
        double row[6], p = 1 / A[k * s + k];
        memcpy(row, x + k * stride, (size_t)width * sizeof *row);
        for (int i = k + 1; i < n; i++) {
            less_row(width, A[k * s + i], x + i * stride, row);
        }
        for (int c = 0; c < width; c++) {
            x[k * stride + c] = row[c] * p;
        }
    }
}

static void solve_block(int n, int s, const double *A, const int *pivot, int count, double *x, int stride) {
#define SOLVE(width) solve_columns(width, n, s, A, pivot, x + c, stride)
    IN_COLUMNS(count, SOLVE)
#undef SOLVE
}

/* ---- ordering ---- */

/* Neighbours of the remaining blocks during ordering. */
typedef struct block_graph {
    int n;
    int **near, *count;                   /* sorted lists */
    int *waits;                           /* number of blocks that must go first; -1: eliminated */
    int *later, *later_at;                /* blocks that wait for each block */
    int *head, *next, *last, *key, least; /* available blocks by degree, as doubly linked lists */
} block_graph;

static int compare_numbers(const void *a, const void *b) {
    int x = *(const int *)a, y = *(const int *)b;
    return (x > y) - (x < y);
}

static int list_neighbours(block_graph *g, int64_t count, const spari_block_pair *pair) {
    for (int64_t k = 0; k < count; k++) {
        g->count[pair[k].a] += pair[k].a != pair[k].b;
        g->count[pair[k].b] += pair[k].a != pair[k].b;
    }
    for (int i = 0; i < g->n; i++) {
        g->near[i] = spari_zalloc(g->count[i] + 1, sizeof **g->near);
        if (!g->near[i]) {
            return 1;
        }
        g->count[i] = 0;
    }
    for (int64_t k = 0; k < count; k++) {
        int a = pair[k].a, b = pair[k].b;
        if (a != b) {
            g->near[a][g->count[a]++] = b;
            g->near[b][g->count[b]++] = a;
        }
    }
    for (int i = 0; i < g->n; i++) {
        int kept = 0, *list = g->near[i];
        qsort(list, (size_t)g->count[i], sizeof *list, compare_numbers);
        for (int k = 0; k < g->count[i]; k++) {
            if (kept == 0 || list[kept - 1] != list[k]) {
                list[kept++] = list[k];
            }
        }
        g->count[i] = kept;
    }
    return 0;
}

static void list_waits(block_graph *g, int64_t count, const spari_block_pair *before) {
    for (int64_t k = 0; k < count; k++) {
        g->waits[before[k].b]++;
        g->later_at[before[k].a + 1]++;
    }
    for (int i = 0; i < g->n; i++) {
        g->later_at[i + 1] += g->later_at[i];
        g->key[i] = g->later_at[i];
    }
    for (int64_t k = 0; k < count; k++) {
        g->later[g->key[before[k].a]++] = before[k].b;
    }
}

static void put_ready(block_graph *g, int i) {
    int d = g->key[i] = g->count[i];
    g->next[i] = g->head[d], g->last[i] = -1;
    if (g->head[d] >= 0) {
        g->last[g->head[d]] = i;
    }
    g->head[d] = i;
    g->least = d < g->least ? d : g->least;
}

static void take_ready(block_graph *g, int i) {
    if (g->last[i] >= 0) {
        g->next[g->last[i]] = g->next[i];
    } else {
        g->head[g->key[i]] = g->next[i];
    }
    if (g->next[i] >= 0) {
        g->last[g->next[i]] = g->last[i];
    }
}

static int graph_create(block_graph *g, int n, int64_t coupled_count, const spari_block_pair *coupled,
                        int64_t before_count, const spari_block_pair *before) {
    *g = (block_graph){.n = n};
    g->near = spari_zalloc(n, sizeof *g->near);
    g->count = spari_zalloc(n, sizeof *g->count);
    g->waits = spari_zalloc(n, sizeof *g->waits);
    g->later = spari_zalloc(before_count + 1, sizeof *g->later);
    g->later_at = spari_zalloc(n + 1, sizeof *g->later_at);
    g->head = spari_zalloc(n, sizeof *g->head);
    g->next = spari_zalloc(n, sizeof *g->next);
    g->last = spari_zalloc(n, sizeof *g->last);
    g->key = spari_zalloc(n, sizeof *g->key);
    if (!g->near || !g->count || !g->waits || !g->later || !g->later_at || !g->head || !g->next || !g->last ||
        !g->key || list_neighbours(g, coupled_count, coupled)) {
        return 1;
    }
    list_waits(g, before_count, before);
    g->least = n;
    for (int i = 0; i < n; i++) {
        g->head[i] = -1;
    }
    for (int i = n - 1; i >= 0; i--) {
        if (g->waits[i] == 0) {
            put_ready(g, i);
        }
    }
    return 0;
}

/* Merges the neighbours of u and a list b [nb], without u and v. 0 or 1. */
static int merge_neighbours(block_graph *g, int u, int v, int nb, const int *b) {
    const int *a = g->near[u];
    int na = g->count[u], i = 0, k = 0, n = 0, *both = spari_zalloc(na + nb, sizeof *both);
    while (both && (i < na || k < nb)) {
        int x = k >= nb || (i < na && a[i] <= b[k]) ? a[i] : b[k];
        i += i < na && a[i] == x;
        k += k < nb && b[k] == x;
        if (x != u && x != v) {
            both[n++] = x;
        }
    }
    free(g->near[u]);
    g->near[u] = both;
    g->count[u] = both ? n : 0;
    return !both;
}

/* Eliminates the next block; its neighbours become neighbours of each other and of the block that it is tied to. -1: no
   memory. */
static int eliminate_next(block_graph *g, const spari_block_tie *tie) {
    while (g->least < g->n && g->head[g->least] < 0) {
        g->least++;
    }
    int v = g->head[g->least];
    take_ready(g, v);
    g->waits[v] = -1;
    int to = tie && tie[v].held[0] + tie[v].held[1] > 0 ? tie[v].to : -1; /* it is not ready, for v is before it */
    if (to >= 0 && merge_neighbours(g, to, v, g->count[v], g->near[v])) {
        return -1;
    }
    for (int k = 0; k < g->count[v]; k++) {
        int u = g->near[v][k], ready = g->waits[u] == 0;
        if (ready) {
            take_ready(g, u);
        }
        if (merge_neighbours(g, u, v, g->count[v], g->near[v]) || (to >= 0 && merge_neighbours(g, u, v, 1, &to))) {
            return -1;
        }
        if (ready) {
            put_ready(g, u);
        }
    }
    for (int k = g->later_at[v]; k < g->later_at[v + 1]; k++) {
        if (--g->waits[g->later[k]] == 0) {
            put_ready(g, g->later[k]);
        }
    }
    return v;
}

/* ---- memory ---- */

/* Held components come first. */
static void order_components(block_panel *p, const int held[2]) {
    for (int i = 0, n = 0; i < 2 * SIX; i++) {
        int k = i % SIX;
        if ((k % 3 < held[k / 3]) == (i < SIX)) {
            p->order[n++] = k;
        }
    }
    p->held = held[0] + held[1];
    p->based[0] = held[0] > 0, p->based[1] = held[1] > 0;
    p->mixed = held[0] < 3 && held[1] > 0;
}

/* Orders the blocks, with their lists of later blocks, which are positions at the end. 0 or 1. */
static int find_order(spari_blocks *m, block_graph *g, const int *size, const spari_block_tie *tie) {
    int capacity = 0, used = 0;
    for (int p = 0; p < m->n; p++) {
        int v = eliminate_next(g, tie);
        if (v < 0) {
            return 1;
        }
        block_panel *panel = m->panel + p;
        *panel = (block_panel){.unit = v,
                               .size = size[v],
                               .first = m->start[v],
                               .near = used,
                               .nears = g->count[v],
                               .all_nears = g->count[v]};
        if (tie) {
            order_components(panel, tie[v].held);
        }
        m->position[v] = p;
        if (used + panel->nears > capacity) {
            capacity = 2 * (used + panel->nears);
            int *more = realloc(m->near, (size_t)capacity * sizeof *more);
            if (!more) {
                return 1;
            }
            m->near = more;
        }
        memcpy(m->near + used, g->near[v], (size_t)panel->nears * sizeof *m->near);
        used += panel->nears;
    }
    m->offset = spari_zalloc(used + 1, sizeof *m->offset);
    for (int k = 0; k < used; k++) {
        m->near[k] = m->position[m->near[k]];
    }
    for (int p = 0; p < m->n; p++) {
        block_panel *panel = m->panel + p;
        int to = panel->held ? tie[panel->unit].to : -1;
        panel->to = to >= 0 ? m->position[to] : -1;
    }
    return !m->offset;
}

static int64_t tie_entries(const block_panel *p) {
    return p->held ? (int64_t)(sizeof(spari_tie) / sizeof(double)) + SIX * (int64_t)p->held : 0;
}

static int place_entries(spari_blocks *m) {
    for (int p = 0; p < m->n; p++) {
        block_panel *panel = m->panel + p;
        qsort(m->near + panel->near, (size_t)panel->nears, sizeof *m->near, compare_numbers);
        for (int k = panel->near; k < panel->near + panel->nears; k++) {
            m->offset[k] = panel->rows;
            panel->rows += m->panel[m->near[k]].size;
        }
        panel->all_rows = panel->rows;
        m->entries += tie_entries(panel) + panel->size * (panel->size + 2 * (int64_t)panel->rows);
    }
    m->entry = spari_zalloc(m->entries + 1, sizeof *m->entry);
    m->pivot = spari_zalloc(m->rows + 1, sizeof *m->pivot);
    if (!m->entry || !m->pivot) {
        return 1;
    }
    double *at = m->entry;
    for (int p = 0; p < m->n; p++) {
        block_panel *panel = m->panel + p;
        panel->pivot = m->pivot + panel->first;
        panel->tie = panel->held ? (spari_tie *)at : NULL;
        panel->D = at + tie_entries(panel);
        panel->U = panel->D + panel->size * panel->size;
        panel->L = panel->U + (int64_t)panel->size * panel->rows;
        at = panel->L + (int64_t)panel->size * panel->rows;
    }
    return 0;
}

spari_blocks *spari_blocks_create(int n, const int *size, const spari_block_tie *tie, int64_t coupled_count,
                                  const spari_block_pair *coupled, int64_t before_count,
                                  const spari_block_pair *before) {
    spari_blocks *m = spari_zalloc(1, sizeof *m);
    block_graph g = {0};
    if (!m) {
        return NULL;
    }
    m->n = n;
    m->position = spari_zalloc(n + 1, sizeof *m->position);
    m->start = spari_zalloc(n + 1, sizeof *m->start);
    m->panel = spari_zalloc(n + 1, sizeof *m->panel);
    m->near = spari_zalloc(1, sizeof *m->near);
    int failed = !m->position || !m->start || !m->panel || !m->near;
    for (int i = 0; i < n && !failed; i++) {
        m->start[i] = m->rows;
        m->rows += size[i];
        m->rows += tie ? tie[i].held[0] + tie[i].held[1] : 0;
    }
    failed = failed || graph_create(&g, n, coupled_count, coupled, before_count, before) ||
             find_order(m, &g, size, tie) || place_entries(m);
    for (int i = 0; g.near && i < n; i++) {
        free(g.near[i]);
    }
    SPARI_FREE(g.near, g.count, g.waits, g.later, g.later_at, g.head, g.next, g.last, g.key);
    if (failed) {
        spari_blocks_free(m);
        return NULL;
    }
    return m;
}

void spari_blocks_free(spari_blocks *m) {
    if (m) {
        SPARI_FREE(m->position, m->start, m->panel, m->near, m->offset, m->pivot, m->entry, m);
    }
}

int spari_blocks_rows(const spari_blocks *m) {
    return m->rows;
}

int spari_blocks_first(const spari_blocks *m, int i) {
    return m->start[i];
}

void spari_blocks_zero(spari_blocks *m) {
    for (int p = 0; p < m->n; p++) {
        block_panel *panel = m->panel + p;
        memset(panel->D, 0, (size_t)(panel->size * panel->size) * sizeof *m->entry);
        panel->rows = panel->nears = 0;
    }
}

spari_tie *spari_blocks_tie(spari_blocks *m, int i) {
    return m->panel[m->position[i]].tie;
}

/* U and L of a panel will have entries. */
static inline void couple_panel(block_panel *p) {
    if (p->nears < p->all_nears) {
        p->rows = p->all_rows, p->nears = p->all_nears;
        memset(p->U, 0, 2 * (size_t)p->size * (size_t)p->rows * sizeof *p->U);
    }
}

/* First row of the later block q in a panel. */
static int offset_of(const spari_blocks *m, const block_panel *panel, int q) {
    int low = panel->near, high = panel->near + panel->nears;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        low = m->near[middle] <= q ? middle : low;
        high = m->near[middle] <= q ? high : middle;
    }
    return m->offset[low];
}

/* Block (p, q) by positions. */
static KNOWN double *block_at(const spari_blocks *m, int p, int q, int *stride) {
    block_panel *panel = m->panel + (p < q ? p : q);
    if (p == q) {
        *stride = panel->size;
        return panel->D;
    }
    couple_panel(panel);
    *stride = p < q ? panel->rows : panel->size;
    return p < q ? panel->U + offset_of(m, panel, q) : panel->L + (int64_t)panel->size * offset_of(m, panel, p);
}

double *spari_blocks_at(spari_blocks *m, int i, int j, int *stride) {
    return block_at(m, m->position[i], m->position[j], stride);
}

/* ---- factors ---- */

static KNOWN void less_product_of(int k, int n, int m, const double *A, int sa, int ta, const double *B, int sb,
                                  double *C, int sc) {
    for (int i = 0; i < m; i++) {
        double row[6];
        memcpy(row, C + i * sc, (size_t)n * sizeof *row);
        for (int l = 0; l < k; l++) {
            less_row(n, A[i * sa + l * ta], B + l * sb, row);
        }
        memcpy(C + i * sc, row, (size_t)n * sizeof *row);
    }
}

/* C [m][n] -= A [m][k] B [k][n], with row strides sa, sb, sc, and ta between the columns of A */
static void less_product_by(int m, int n, int k, const double *A, int sa, int ta, const double *B, int sb, double *C,
                            int sc) {
#define PRODUCT(width) WITH_LENGTH(less_product_of, k, width, m, A, sa, ta, B + c, sb, C + c, sc)
    IN_COLUMNS(n, PRODUCT)
#undef PRODUCT
}

static void less_product(int m, int n, int k, const double *A, int sa, const double *B, int sb, double *C, int sc) {
    less_product_by(m, n, k, A, sa, 1, B, sb, C, sc);
}

/* Updates the later blocks with L D^-1 U of a factored panel; U then holds D^-1 U. Of a tied one these are the parts of
   the components that are not held. */
static void update_later(spari_blocks *m, const block_panel *panel) {
    int s = panel->size, h = panel->held, n = panel->rows;
    const double *U = panel->U + h * (int64_t)n, *L = panel->L + h;
    for (int k = panel->near; k < panel->near + panel->nears; k++) {
        block_panel *a = m->panel + m->near[k];
        int at = m->offset[k], to = a->near;
        if (k + 1 < panel->near + panel->nears) {
            couple_panel(a);
        }
        less_product(a->size, a->size, s - h, L + at * s, s, U + at, n, a->D, a->size);
        for (int l = k + 1; l < panel->near + panel->nears; l++) {
            while (m->near[to] != m->near[l]) {
                to++;
            }
            int bt = m->offset[l], b = m->panel[m->near[l]].size;
            less_product(a->size, b, s - h, L + at * s, s, U + bt, n, a->U + m->offset[to], a->rows);
            less_product(b, a->size, s - h, L + bt * s, s, U + at, n, a->L + (int64_t)m->offset[to] * a->size, a->size);
        }
    }
}

/* ---- ties ---- */

/* y := A^T x of r columns, A [3][3]; sa, ta: strides of A, exchanged for A x. */
static KNOWN void times_basis(int r, const double *A, int sa, int ta, double *x, int stride) {
    for (int c = 0; c < r; c++) {
        const double a = x[c], b = x[stride + c], d = x[2 * stride + c];
        for (int i = 0; i < 3; i++) {
            x[i * stride + c] = A[ta * i] * a + A[sa + ta * i] * b + A[2 * sa + ta * i] * d;
        }
    }
}

/* x [6][r] in the order of the factors, or back. */
static KNOWN void reorder(int r, const block_panel *p, int back, double *x, int stride) {
    double from[SIX][SIX];
    for (int i = 0; i < SIX; i++) {
        memcpy(from[i], x + i * stride, (size_t)r * sizeof *x);
    }
    for (int i = 0; i < SIX; i++) {
        memcpy(x + (back ? p->order[i] : i) * stride, from[back ? i : p->order[i]], (size_t)r * sizeof *x);
    }
}

/* f [6][r] := the components of the forces f, first the held ones. */
static KNOWN void to_components(int r, const block_panel *p, double *f, int stride) {
    const double *d = p->tie->arm;
    for (int c = 0; c < r; c++) {
        const double x = f[c], y = f[stride + c], z = f[2 * stride + c];
        f[3 * stride + c] += d[1] * z - d[2] * y;
        f[4 * stride + c] += d[2] * x - d[0] * z;
        f[5 * stride + c] += d[0] * y - d[1] * x;
    }
    for (int part = 0; part < 2; part++) {
        if (p->based[part]) {
            times_basis(r, p->tie->basis[part], 3, 1, f + 3 * part * stride, stride);
        }
    }
    if (p->mixed) {
        reorder(r, p, 0, f, stride);
    }
}

/* x [6][r] := the displacement and rotation that have the components x. */
static KNOWN void from_components(int r, const block_panel *p, double *x) {
    const double *d = p->tie->arm;
    if (p->mixed) {
        reorder(r, p, 1, x, r);
    }
    for (int part = 0; part < 2; part++) {
        if (p->based[part]) {
            times_basis(r, p->tie->basis[part], 1, 3, x + 3 * part * r, r);
        }
    }
    for (int c = 0; c < r; c++) {
        const double a = x[3 * r + c], b = x[4 * r + c], e = x[5 * r + c];
        x[c] += b * d[2] - e * d[1];
        x[r + c] += e * d[0] - a * d[2];
        x[2 * r + c] += a * d[1] - b * d[0];
    }
}

/* The entries of a tied block, of its components. */
static void change_to_components(block_panel *p) {
#define CHANGE(width) to_components(width, p, p->U + c, p->rows)
    to_components(6, p, p->D, SIX);
    IN_COLUMNS(p->rows, CHANGE)
#undef CHANGE
    for (int i = 0; i < SIX; i++) {
        to_components(1, p, p->D + SIX * i, 1);
    }
    for (int i = 0; i < p->rows; i++) {
        to_components(1, p, p->L + SIX * (int64_t)i, 1);
    }
}

/* The held components y = gap - N x take their entries to x, the unknowns of block `to`. */
static void carry_held(spari_blocks *m, const block_panel *p) {
    int h = p->held, n = m->panel[p->to].size, stride;
    const double *N = p->tie->rows[0];
    double less[SIX * SIX] = {0}, *D = block_at(m, p->to, p->to, &stride);
    less_product(h, SIX, h, p->D, SIX, N, SIX, less, SIX);
    less_product_by(n, SIX, h, N, 1, SIX, less, SIX, D, stride);
    for (int k = p->near; k < p->near + p->nears; k++) {
        int q = m->near[k], rows = m->panel[q].size, at = m->offset[k];
        double *A = block_at(m, p->to, q, &stride);
        less_product_by(n, rows, h, N, 1, SIX, p->U + at, p->rows, A, stride);
        A = block_at(m, q, p->to, &stride);
        less_product(rows, n, h, p->L + at * SIX, SIX, N, SIX, A, stride);
    }
}

/* Eliminates the components that are not held, then the held ones. */
static int factor_tied(spari_blocks *m, block_panel *p) {
    int h = p->held, free = SIX - h, n = p->rows;
    double *S = p->D + (SIX + 1) * h, *left = p->D + SIX * h;
    change_to_components(p);
    m->negative += m->watched ? spari_inertia_negative(free, S, SIX) : 0;
    if (factor_block(free, SIX, S, p->pivot)) {
        return 1;
    }
    solve_block(free, SIX, S, p->pivot, h, left, SIX);
    solve_block(free, SIX, S, p->pivot, n, p->U + (int64_t)h * n, n);
    less_product(h, h, free, p->D + h, SIX, left, SIX, p->D, SIX);
    less_product(h, n, free, p->D + h, SIX, p->U + (int64_t)h * n, n, p->U, n);
    less_product(n, h, free, p->L + h, SIX, left, SIX, p->L, SIX);
    return 0;
}

void spari_blocks_watch(spari_blocks *m, int on) {
    m->watched = on;
}

int spari_blocks_negative(const spari_blocks *m) {
    return m->negative;
}

static int factor_untied(spari_blocks *m, block_panel *p) {
    if (m->watched && p->size <= SPARI_INERTIA) {
        m->negative += spari_inertia_negative(p->size, p->D, p->size);
    }
    if (factor_block(p->size, p->size, p->D, p->pivot)) {
        return 1;
    }
    solve_block(p->size, p->size, p->D, p->pivot, p->rows, p->U, p->rows);
    return 0;
}

int spari_blocks_factor(spari_blocks *m) {
    m->least[0] = m->least[1] = INFINITY;
    m->negative = 0;
    for (int p = 0; p < m->n; p++) {
        block_panel *panel = m->panel + p;
        if (panel->held ? factor_tied(m, panel) : factor_untied(m, panel)) {
            m->least[0] = m->least[1] = 0;
            return 1;
        }
        for (int k = panel->held; k < panel->size; k++) {
            double pivot = fabs(panel->D[k * panel->size + k]),
                   *least = m->least + (panel->size == SIX && (panel->mixed ? panel->order[k] : k) >= 3);
            *least = pivot < *least ? pivot : *least;
        }
        update_later(m, panel);
        if (panel->to >= 0) {
            carry_held(m, panel);
        }
    }
    return 0;
}

void spari_blocks_least_pivots(const spari_blocks *m, double least[2]) {
    memcpy(least, m->least, sizeof m->least);
}

/* x_later -= L own, of `count` unknowns of the panel from `from` on */
static KNOWN void less_later(const spari_blocks *m, const block_panel *p, int r, int from, int count, const double *own,
                             double *x) {
    for (int k = p->near; k < p->near + p->nears; k++) {
        const block_panel *a = m->panel + m->near[k];
        less_rows(r, a->size, count, p->L + m->offset[k] * p->size + from, p->size, own, x + r * a->first);
    }
}

/* y -= U x_later, of `count` rows from `from` on */
static KNOWN void less_of_later(const spari_blocks *m, const block_panel *p, int r, int from, int count,
                                const double *x, double *y) {
    for (int k = p->near; k < p->near + p->nears; k++) {
        const block_panel *a = m->panel + m->near[k];
        less_rows(r, count, a->size, p->U + from * (int64_t)p->rows + m->offset[k], p->rows, x + r * a->first, y);
    }
}

/* h: p->held. Forward: of the forces f and the gaps, the part of the held components goes to the later blocks. */
static KNOWN void begin_tied(int h, const spari_blocks *m, const block_panel *p, int r, double *x) {
    double *own = x + r * p->first, *free = own + r * h, *gap = own + r * SIX;
    to_components(r, p, own, r);
    solve_few_of(SIX - h, r, SIX, p->D + (SIX + 1) * h, p->pivot, free);
    less_rows_of(SIX - h, r, h, p->D + h, SIX, free, own);
    less_rows_of(h, r, h, p->D, SIX, gap, own);
    less_later(m, p, r, h, SIX - h, free, x);
    less_later(m, p, r, 0, h, gap, x);
    double *to = p->to < 0 ? NULL : x + r * m->panel[p->to].first;
    for (int k = 0; k < h && to; k++) {
        for (int i = 0; i < SIX; i++) {
            for (int c = 0; c < r; c++) {
                to[i * r + c] -= p->tie->rows[k][i] * own[k * r + c];
            }
        }
    }
}

/* Backward. */
static KNOWN void end_tied(int h, const spari_blocks *m, const block_panel *p, int r, double *x) {
    double *own = x + r * p->first, *free = own + r * h, *gap = own + r * SIX, held[2 * SIX] = {0};
    if (p->to >= 0) {
        less_rows_of(SIX, r, h, p->tie->rows[0], SIX, x + r * m->panel[p->to].first, held);
    }
    less_rows_of(h, r, h, p->D, SIX, held, own);
    less_of_later(m, p, r, 0, SIX, x, own);
    for (int k = 0; k < r * h; k++) {
        double force = -own[k];
        own[k] = held[k] + gap[k];
        gap[k] = force;
    }
    less_rows_of(h, r, SIX - h, p->D + SIX * h, SIX, own, free);
    from_components(r, p, own);
}

static KNOWN int solve_in(const spari_blocks *m, int r, double *x) {
    double sum = 0;
    for (int i = 0; i < m->n; i++) {
        const block_panel *p = m->panel + i;
        double *own = x + r * p->first;
        if (p->held) {
            WITH_LENGTH(begin_tied, p->held, m, p, r, x);
        } else {
            WITH_LENGTH(solve_few, p->size, r, p->D, p->pivot, own);
            less_later(m, p, r, 0, p->size, own, x);
        }
    }
    for (int i = m->n - 1; i >= 0; i--) {
        const block_panel *p = m->panel + i;
        double *own = x + r * p->first;
        if (p->held) {
            WITH_LENGTH(end_tied, p->held, m, p, r, x);
        } else {
            less_of_later(m, p, r, 0, p->size, x, own);
        }
        for (int k = 0; k < r * (p->size + p->held); k++) {
            sum += 0 * own[k];
        }
    }
    return !isfinite(sum);
}

int spari_blocks_solve(spari_blocks *m, int columns, double *x) {
    return columns == 1 ? solve_in(m, 1, x) : solve_in(m, 2, x);
}
