/* Sparse matrices of dense blocks: see block_matrix.h. */
#include "block_matrix.h"

#include "../base/status.h"
#include "../math/lanes.h"
#include "inertia.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A block row and column in elimination order: the diagonal [size][size], and the entries shared with later blocks,
   as a row of blocks U [size][rows] and a column of blocks L [rows][size]. Of a later block these are its first
   `shared` rows and columns. */
typedef struct block_panel {
    int unit; /* block number before ordering */
    int size, shared, first, rows;
    int near, nears; /* begin and length of the list of later blocks */
    double *D, *U, *L;
    int *pivot;
} block_panel;

struct spari_blocks {
    int n, rows;
    int *position; /* of a block in the order */
    int *start;    /* first row of a block in a vector */
    block_panel *panel;
    int *near;   /* positions of later blocks, increasing */
    int *offset; /* their first column in U and row in L */
    int *pivot;
    double *entry, least;
    int watched, negative; /* whether signs are counted; number of negative ones */
    int64_t entries;
};

/* Of a function that is called with constant lengths. */
#define KNOWN inline SPARI_ALWAYS_INLINE

/* ---- one dense block ---- */

/* Calls f with a known length n where that is common: six unknowns, alone or with the multipliers of a joint, or those
   of a joint that closes a loop. Such loops are several times faster, and sum in the same order. */
#define WITH_LENGTH(f, n, ...)                                                                                         \
    ((n) == 3    ? f(3, __VA_ARGS__)                                                                                   \
     : (n) == 6  ? f(6, __VA_ARGS__)                                                                                   \
     : (n) == 9  ? f(9, __VA_ARGS__)                                                                                   \
     : (n) == 11 ? f(11, __VA_ARGS__)                                                                                  \
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

static KNOWN int factor_block_of(int n, double *A, int *pivot) {
    for (int k = 0; k < n; k++) {
        int best = k;
        for (int i = k + 1; i < n; i++) {
            best = fabs(A[i * n + k]) > fabs(A[best * n + k]) ? i : best;
        }
        pivot[k] = best;
        for (int j = 0; j < n && best != k; j++) {
            double kept = A[k * n + j];
            A[k * n + j] = A[best * n + j];
            A[best * n + j] = kept;
        }
        double p = A[k * n + k];
        if (!(fabs(p) > 0) || !isfinite(p)) {
            return 1;
        }
        for (int i = k + 1; i < n; i++) {
            double f = A[i * n + k] /= p;
            if (f != 0) {
                less_row(n - k - 1, f, A + k * n + k + 1, A + i * n + k + 1);
            }
        }
    }
    return 0;
}

static int factor_block(int n, double *A, int *pivot) {
    return WITH_LENGTH(factor_block_of, n, A, pivot);
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

static KNOWN void solve_few_of(int n, int r, const double *A, const int *pivot, double *x) {
    for (int k = 0; k < n; k++) {
        for (int c = 0; c < r; c++) {
            double kept = x[k * r + c];
            x[k * r + c] = x[pivot[k] * r + c], x[pivot[k] * r + c] = kept;
        }
    }
    SPARI_UNROLL
    for (int k = 1; k < n; k++) {
        less_rows_of(k, r, 1, A + k * n, n, x, x + k * r);
    }
    SPARI_UNROLL
    for (int k = n - 1; k >= 0; k--) {
        less_rows_of(n - 1 - k, r, 1, A + k * n + k + 1, n, x + (k + 1) * r, x + k * r);
        for (int c = 0; c < r; c++) {
            x[k * r + c] /= A[k * n + k];
        }
    }
}

/* Some columns of the solution of a factored block. */
static KNOWN void solve_columns(int width, int n, const double *A, const int *pivot, double *x, int stride) {
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
            less_row(width, A[k * n + i], x + i * stride, row);
        }
        memcpy(x + k * stride, row, (size_t)width * sizeof *row);
    }
    for (int k = n - 1; k >= 0; k--) {
        double row[6], p = 1 / A[k * n + k];
        memcpy(row, x + k * stride, (size_t)width * sizeof *row);
        for (int i = k + 1; i < n; i++) {
            less_row(width, A[k * n + i], x + i * stride, row);
        }
        for (int c = 0; c < width; c++) {
            x[k * stride + c] = row[c] * p;
        }
    }
}

static void solve_block(int n, const double *A, const int *pivot, int count, double *x, int stride) {
#define SOLVE(width) solve_columns(width, n, A, pivot, x + c, stride)
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

/* Merges the neighbours of u and v, without u and v. 0 or 1. */
static int merge_neighbours(block_graph *g, int u, int v) {
    const int *a = g->near[u], *b = g->near[v];
    int na = g->count[u], nb = g->count[v], i = 0, k = 0, n = 0, *both = spari_zalloc(na + nb, sizeof *both);
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

/* Eliminates the next block; its neighbours become neighbours of each other. -1: no memory. */
static int eliminate_next(block_graph *g) {
    while (g->least < g->n && g->head[g->least] < 0) {
        g->least++;
    }
    int v = g->head[g->least];
    take_ready(g, v);
    g->waits[v] = -1;
    for (int k = 0; k < g->count[v]; k++) {
        int u = g->near[v][k], ready = g->waits[u] == 0;
        if (ready) {
            take_ready(g, u);
        }
        if (merge_neighbours(g, u, v)) {
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

/* Orders the blocks, with their lists of later blocks, which are positions at the end. 0 or 1. */
static int find_order(spari_blocks *m, block_graph *g, const int *size, const int *shared) {
    int capacity = 0, used = 0;
    for (int p = 0; p < m->n; p++) {
        int v = eliminate_next(g);
        if (v < 0) {
            return 1;
        }
        block_panel *panel = m->panel + p;
        *panel = (block_panel){.unit = v,
                               .size = size[v],
                               .shared = shared ? shared[v] : size[v],
                               .first = m->start[v],
                               .near = used,
                               .nears = g->count[v]};
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
    return !m->offset;
}

static int place_entries(spari_blocks *m) {
    for (int p = 0; p < m->n; p++) {
        block_panel *panel = m->panel + p;
        qsort(m->near + panel->near, (size_t)panel->nears, sizeof *m->near, compare_numbers);
        for (int k = panel->near; k < panel->near + panel->nears; k++) {
            m->offset[k] = panel->rows;
            panel->rows += m->panel[m->near[k]].shared;
        }
        m->entries += panel->size * (panel->size + 2 * (int64_t)panel->rows);
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
        panel->D = at;
        panel->U = panel->D + panel->size * panel->size;
        panel->L = panel->U + (int64_t)panel->size * panel->rows;
        at = panel->L + (int64_t)panel->size * panel->rows;
    }
    return 0;
}

spari_blocks *spari_blocks_create(int n, const int *size, const int *shared, int64_t coupled_count,
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
    }
    failed = failed || graph_create(&g, n, coupled_count, coupled, before_count, before) ||
             find_order(m, &g, size, shared) || place_entries(m);
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
    memset(m->entry, 0, (size_t)m->entries * sizeof *m->entry);
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

double *spari_blocks_at(spari_blocks *m, int i, int j, int *stride) {
    int p = m->position[i], q = m->position[j];
    const block_panel *panel = m->panel + (p < q ? p : q);
    if (p == q) {
        *stride = panel->size;
        return panel->D;
    }
    *stride = p < q ? panel->rows : panel->size;
    return p < q ? panel->U + offset_of(m, panel, q) : panel->L + (int64_t)panel->size * offset_of(m, panel, p);
}

/* ---- factors ---- */

static KNOWN void less_product_of(int n, int m, int k, const double *A, int sa, const double *B, int sb, double *C,
                                  int sc) {
    for (int i = 0; i < m; i++) {
        double row[6];
        memcpy(row, C + i * sc, (size_t)n * sizeof *row);
        for (int l = 0; l < k; l++) {
            less_row(n, A[i * sa + l], B + l * sb, row);
        }
        memcpy(C + i * sc, row, (size_t)n * sizeof *row);
    }
}

/* C [m][n] -= A [m][k] B [k][n], with row strides sa, sb, sc */
static void less_product(int m, int n, int k, const double *A, int sa, const double *B, int sb, double *C, int sc) {
#define PRODUCT(width) less_product_of(width, m, k, A, sa, B + c, sb, C + c, sc)
    IN_COLUMNS(n, PRODUCT)
#undef PRODUCT
}

/* Updates the later blocks with L D^-1 U of a factored panel; U then holds D^-1 U. */
static void update_later(spari_blocks *m, const block_panel *panel) {
    int s = panel->size;
    for (int k = panel->near; k < panel->near + panel->nears; k++) {
        block_panel *a = m->panel + m->near[k];
        int at = m->offset[k], to = a->near;
        less_product(a->shared, a->shared, s, panel->L + at * s, s, panel->U + at, panel->rows, a->D, a->size);
        for (int l = k + 1; l < panel->near + panel->nears; l++) {
            while (m->near[to] != m->near[l]) {
                to++;
            }
            int bt = m->offset[l], b = m->panel[m->near[l]].shared;
            less_product(a->shared, b, s, panel->L + at * s, s, panel->U + bt, panel->rows, a->U + m->offset[to],
                         a->rows);
            less_product(b, a->shared, s, panel->L + bt * s, s, panel->U + at, panel->rows,
                         a->L + (int64_t)m->offset[to] * a->size, a->size);
        }
    }
}

void spari_blocks_watch(spari_blocks *m, int on) {
    m->watched = on;
}

int spari_blocks_negative(const spari_blocks *m) {
    return m->negative;
}

int spari_blocks_factor(spari_blocks *m) {
    m->least = INFINITY;
    m->negative = 0;
    for (int p = 0; p < m->n; p++) {
        block_panel *panel = m->panel + p;
        if (m->watched && panel->size <= SPARI_INERTIA) {
            m->negative += spari_inertia_negative(panel->size, panel->D, panel->size);
        }
        if (factor_block(panel->size, panel->D, panel->pivot)) {
            m->least = 0;
            return 1;
        }
        for (int k = 0; k < panel->size; k++) {
            m->least = fmin(m->least, fabs(panel->D[k * panel->size + k]));
        }
        if (panel->rows > 0) {
            solve_block(panel->size, panel->D, panel->pivot, panel->rows, panel->U, panel->rows);
            update_later(m, panel);
        }
    }
    return 0;
}

double spari_blocks_least_pivot(const spari_blocks *m) {
    return m->least;
}

static KNOWN int solve_in(const spari_blocks *m, int r, double *x) {
    double sum = 0;
    for (int p = 0; p < m->n; p++) {
        const block_panel *panel = m->panel + p;
        double *own = x + r * panel->first;
        int s = panel->size;
        WITH_LENGTH(solve_few_of, s, r, panel->D, panel->pivot, own);
        for (int k = panel->near; k < panel->near + panel->nears; k++) {
            const block_panel *a = m->panel + m->near[k];
            less_rows(r, a->shared, s, panel->L + m->offset[k] * s, s, own, x + r * a->first);
        }
    }
    for (int p = m->n - 1; p >= 0; p--) {
        const block_panel *panel = m->panel + p;
        double *own = x + r * panel->first;
        for (int k = panel->near; k < panel->near + panel->nears; k++) {
            const block_panel *a = m->panel + m->near[k];
            less_rows(r, panel->size, a->shared, panel->U + m->offset[k], panel->rows, x + r * a->first, own);
        }
        for (int k = 0; k < r * panel->size; k++) {
            sum += 0 * own[k];
        }
    }
    return !isfinite(sum);
}

int spari_blocks_solve(spari_blocks *m, int columns, double *x) {
    return columns == 1 ? solve_in(m, 1, x) : solve_in(m, 2, x);
}
