/* Between lines and nodes: which kernels serve, and what they are given. */
#include "transfer_kernels.h"

#include "../base/status.h"
#include "../base/thread_pool.h"
#include "../math/rotation.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

carrier spari_carrier_of(const double *c) {
    carrier m;
    double unit[4];
    memcpy(m.place, c + SPARI_F_POSITION, sizeof m.place);
    memcpy(m.rate, c + SPARI_F_RATE, sizeof m.rate);
    memcpy(m.q, c + SPARI_F_QUAT, sizeof m.q);
    memcpy(m.omega, c + SPARI_F_SPIN, sizeof m.omega);
    memcpy(m.accel, c + SPARI_F_ACCEL, sizeof m.accel);
    memcpy(m.alpha, c + SPARI_F_TWIST, sizeof m.alpha);
    memcpy(unit, m.q, sizeof unit);
    m.square = spari_quat_dot(unit, unit);
    spari_quat_normalise(unit);
    spari_quat_matrix(unit, m.rotation);
    return m;
}

static const spari_transfer_kernels *choose_kernels(const spari_nodes *s) {
    return spari_transfer_kernels_for(s->lanes ? s->lanes : SPARI_LANES_MAX);
}

/* ---- node sets ---- */

spari_nodes *spari_nodes_create(int64_t n, int elements, int per_element) {
    spari_nodes *s = spari_zalloc(1, sizeof *s);
    if (!s) {
        return NULL;
    }
    s->n = n, s->elements = elements, s->per_element = per_element;
    s->flags = spari_zalloc(n, sizeof *s->flags);
    for (int i = 0; i < 3; i++) {
        s->con[i] = spari_zalloc(n, sizeof *s->con[i]);
    }
    int whole = s->flags && s->con[0] && s->con[1] && s->con[2];
    if (per_element > 1) {
        s->xi = spari_zalloc(n, sizeof *s->xi);
        whole = whole && s->xi;
    }
    if (elements > 1) {
        s->element = spari_zalloc(n, sizeof *s->element);
        s->place = spari_zalloc(n, sizeof *s->place);
        whole = whole && s->element && s->place;
    }
    if (!whole) {
        spari_nodes_free(s);
        return NULL;
    }
    return s;
}

void spari_nodes_free(spari_nodes *s) {
    if (!s) {
        return;
    }
    SPARI_FREE(s->xi, s->flags);
    for (int i = 0; i < 3; i++) {
        free(s->con[i]);
    }
    SPARI_FREE(s->element, s->place, s);
}

spari_nodes *spari_nodes_shorten(const spari_nodes *from, const double *factor) {
    spari_nodes *s = spari_zalloc(1, sizeof *s);
    int whole = s != NULL;
    if (s) {
        *s = *from;
    }
    for (int i = 0; i < 3 && s; i++) {
        s->con[i] = spari_zalloc(from->n, sizeof *s->con[i]);
        whole = whole && s->con[i];
    }
    for (int64_t p = 0; whole && p < from->n; p++) {
        for (int i = 0; i < 3; i++) {
            s->con[i][p] = factor[spari_nodes_node(from, p)] * from->con[i][p];
        }
    }
    if (!whole) {
        spari_nodes_free_shortened(s);
        return NULL;
    }
    return s;
}

void spari_nodes_free_shortened(spari_nodes *s) {
    for (int i = 0; i < 3 && s; i++) {
        free(s->con[i]);
    }
    free(s);
}

/* Orders the tile's nodes by element, keeping their order within an element. */
static void order_tile(const int *element, int count, uint16_t *place) {
    for (int i = 0; i < count; i++) {
        int j = i;
        for (; j > 0 && element[place[j - 1]] > element[i]; j--) {
            place[j] = place[j - 1];
        }
        place[j] = (uint16_t)i;
    }
}

/* The nodes are stored in their own order along the line. */
static int is_in_order(const spari_nodes *s) {
    for (int64_t p = 0; p < s->n; p++) {
        if (s->place[p] != p % SPARI_TILE) {
            return 0;
        }
    }
    return 1;
}

void spari_nodes_put(spari_nodes *s, const int *element, const double *xi, const double *con, const uint8_t *flags) {
    for (int64_t first = 0; s->place && first < s->n; first += SPARI_TILE) {
        order_tile(element + first, spari_tile_count(s, first), s->place + first);
    }
    if (s->place && is_in_order(s)) {
        free(s->place);
        s->place = NULL;
    }
    for (int64_t p = 0; p < s->n; p++) {
        int64_t node = spari_nodes_node(s, p);
        if (s->xi) {
            s->xi[p] = xi[node];
        }
        for (int i = 0; i < 3; i++) {
            s->con[i][p] = con[3 * node + i];
        }
        if (s->element) {
            s->element[p] = element[node];
        }
        s->flags[node] = flags[node];
    }
}

/* ---- nodal fields ---- */

void spari_modal_matrix(int n, double *m) {
    double x[SPARI_MAX_NODES], bary[SPARI_MAX_NODES], phi[SPARI_MAX_NODES];
    const double pi = 3.14159265358979323846;
    spari_gll(n, x, NULL, bary);
    memset(m, 0, sizeof *m * (size_t)(n * n));
    for (int j = 0; j < n; j++) { /* discrete orthogonality at the n Chebyshev points: exact for degree < n */
        double angle = pi * (j + 0.5) / n;
        spari_lagrange(n, x, bary, cos(angle), phi, NULL);
        for (int k = 0; k < n; k++) {
            double t = (k ? 2.0 : 1.0) / n * cos(k * angle);
            for (int l = 0; l < n; l++) {
                m[k * n + l] += t * phi[l];
            }
        }
    }
}

/* Fields of one node that are interpolated. */
static void node_fields(const double *xr, const double *q, const double *v, const double *a, const double chained[4],
                        int consistent, int upto, double g[SPARI_FIELDS]) {
    for (int i = 0; i < 3; i++) {
        g[SPARI_F_POSITION + i] = xr[i] + q[i];
        g[SPARI_F_RATE + i] = upto < SPARI_UPTO_RATE ? 0 : v[i];
    }
    memcpy(g + SPARI_F_QUAT, chained, 4 * sizeof *g);
    if (upto < SPARI_UPTO_RATE) {
        return;
    }
    double spin[4] = {0, v[3], v[4], v[5]};
    if (consistent) {
        spari_quat_mul(spin, chained, g + SPARI_F_SPIN);
    } else {
        memcpy(g + SPARI_F_SPIN, v + 3, 3 * sizeof *g);
        g[SPARI_F_SPIN + 3] = 0;
    }
    if (upto < SPARI_UPTO_ACCEL) {
        return;
    }
    memcpy(g + SPARI_F_ACCEL, a, 3 * sizeof *g);
    if (consistent) { /* 2 q'' = alpha q - |omega|^2 q / 2 */
        double twist[4] = {-0.5 * spari_dot(v + 3, v + 3), a[3], a[4], a[5]};
        spari_quat_mul(twist, chained, g + SPARI_F_TWIST);
    } else {
        memcpy(g + SPARI_F_TWIST, a + 3, 3 * sizeof *g);
        g[SPARI_F_TWIST + 3] = 0;
    }
}

/* Nodes whose fields are summed at once. */
enum { TOGETHER = 8 };

/* to [n][SPARI_FIELDS] += columns [n][count] of the matrix modal [n][n] times g [count][SPARI_FIELDS], the first
   `fields` of them, a number that the compiler knows. */
static inline void add_nodes(const int fields, int n, int count, const double *modal, const double *g, double *to) {
    for (int k = 0; k < n; k++, modal += n, to += SPARI_FIELDS) {
        double sum[SPARI_FIELDS];
        memcpy(sum, to, (size_t)fields * sizeof *to);
        for (int l = 0; l < count; l++) {
            for (int f = 0; f < fields; f++) {
                sum[f] += modal[l] * g[l * SPARI_FIELDS + f];
            }
        }
        memcpy(to, sum, (size_t)fields * sizeof *to);
    }
}

void spari_field_fill(int elements, int per_element, const double *modal, int consistent, int upto, const double *xr,
                      const double *q, const double *v, const double *a, double *c) {
    static const int width[] = {SPARI_F_SPIN, SPARI_F_ACCEL, SPARI_FIELDS};
    double chained[4 * SPARI_MAX_NODES], g[TOGETHER * SPARI_FIELDS];
    const int P = per_element;
    consistent = consistent && P > 1; /* with one node both kinds are equal */
    for (int e = 0; e < elements; e++, c += (ptrdiff_t)P * SPARI_FIELDS) {
        for (int k = 0; k < P; k++) {
            memset(c + (ptrdiff_t)k * SPARI_FIELDS, 0, sizeof *c * (size_t)width[upto]);
        }
        spari_chain(P, q + 7 * (ptrdiff_t)e * P + 3, 7, chained);
        for (int from = 0; from < P; from += TOGETHER) {
            int count = P - from < TOGETHER ? P - from : TOGETHER;
            for (int l = 0; l < count; l++) {
                ptrdiff_t node = (ptrdiff_t)e * P + from + l;
                node_fields(xr + 3 * node, q + 7 * node, v + 6 * node, a + 6 * node, chained + 4 * (from + l),
                            consistent, upto, g + (ptrdiff_t)l * SPARI_FIELDS);
            }
            if (upto < SPARI_UPTO_RATE) {
                add_nodes(SPARI_F_SPIN, P, count, modal + from, g, c);
            } else if (upto < SPARI_UPTO_ACCEL) {
                add_nodes(SPARI_F_ACCEL, P, count, modal + from, g, c);
            } else {
                add_nodes(SPARI_FIELDS, P, count, modal + from, g, c);
            }
        }
    }
}

/* ---- tiles ---- */

/* Length of the run of one element that begins at storage position p, within count. */
static int run_length(const spari_nodes *s, int64_t p, int count) {
    if (!s->element) {
        return count;
    }
    int i = 1;
    while (i < count && s->element[p + i] == s->element[p]) {
        i++;
    }
    return i;
}

double spari_tile_motion(const spari_nodes *s, int64_t first, const double *c, int consistent, int what,
                         double (*buf)[SPARI_ROW]) {
    const spari_transfer_kernels *kernel = choose_kernels(s);
    double least = HUGE_VAL;
    int count = spari_tile_count(s, first);
    ptrdiff_t block = (ptrdiff_t)s->per_element * SPARI_FIELDS;
    for (int at = 0; at < count;) {
        int run = run_length(s, first + at, count - at);
        double d = kernel->motion(s, first + at, run, c + spari_nodes_element(s, first + at) * block, consistent, what,
                                  buf, at);
        least = d < least ? d : least;
        at += run;
    }
    return least;
}

/* Whether to use non-temporal stores. */
static int is_past(const spari_nodes *s) {
    return s->n >= SPARI_PAST;
}

/* Only the widest vectors write whole lines, as non-temporal stores need. Narrower ones store triples through the
   caches, at any number of nodes: this takes less time than a tile that is copied with non-temporal stores. */
int spari_can_move_to(const spari_nodes *s, int single) {
    int lines = spari_lanes_here(s->lanes ? s->lanes : SPARI_LANES_MAX) == 8;
    return !s->place && s->per_element > 1 && (lines || !single);
}

double spari_move_to(const spari_nodes *s, int64_t first, int64_t count, const double *c, int consistent, int single,
                     void *x, void *v) {
    const spari_transfer_kernels *kernel = choose_kernels(s);
    const size_t triple = 3 * (single ? sizeof(float) : sizeof(double));
    const ptrdiff_t block = (ptrdiff_t)s->per_element * SPARI_FIELDS;
    double least = HUGE_VAL;
    for (int64_t at = first; at < first + count;) {
        const size_t skip = (size_t)at * triple;
        int run = run_length(s, at, (int)(first + count - at));
        double d = kernel->move_to(s, at, run, c + spari_nodes_element(s, at) * block, consistent, single,
                                   x ? (char *)x + skip : NULL, v ? (char *)v + skip : NULL, is_past(s));
        least = d < least ? d : least;
        at += run;
    }
    return least;
}

double spari_carry(const spari_nodes *s, const double *c, double *x, double *v) {
    const carrier m = spari_carrier_of(c);
    choose_kernels(s)->carry(s, &m, x, v);
    return m.square;
}

/* Rows of a tile through a layout, component by component; each component may be an array of its own. */
static void fetch_at(const spari_nodes *s, int64_t first, int count, spari_source x, double (*f)[SPARI_ROW]) {
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < count; i++) {
            f[k][i] = spari_source_at(x, spari_nodes_node(s, first + i), k);
        }
    }
}

/* The same for triples of nodes that are not stored in order. */
static void fetch_placed(const spari_nodes *s, int64_t first, int count, spari_source x, double (*f)[SPARI_ROW]) {
    for (int i = 0; i < count; i++) {
        int64_t node = first + s->place[first + i];
        double t[3];
        if (x.d) {
            memcpy(t, x.d + 3 * node, sizeof t); /* the host's array may have any alignment */
        } else {
            float single[3];
            memcpy(single, x.f + 3 * node, sizeof single);
            t[0] = single[0], t[1] = single[1], t[2] = single[2];
        }
        f[0][i] = t[0], f[1][i] = t[1], f[2][i] = t[2];
    }
}

/* Triples of the host's as rows in storage order, and back. */
static void fetch_rows(const spari_transfer_kernels *kernel, const spari_nodes *s, int64_t first, int count,
                       spari_source x, double (*f)[SPARI_ROW]) {
    if (x.layout) {
        fetch_at(s, first, count, x, f);
    } else if (s->place) {
        fetch_placed(s, first, count, x, f);
    } else if (x.d) {
        kernel->load(x.d + 3 * first, count, f);
    } else {
        kernel->load_singles(x.f + 3 * first, count, f);
    }
}

void spari_tile_store(const spari_nodes *s, int64_t first, double (*row)[SPARI_ROW], double *x) {
    int count = spari_tile_count(s, first);
    if (!s->place) {
        choose_kernels(s)->give(row, count, x + 3 * first, is_past(s));
        return;
    }
    for (int i = 0; i < count; i++) {
        double t[3] = {row[0][i], row[1][i], row[2][i]};
        memcpy(x + 3 * (first + s->place[first + i]), t, sizeof t);
    }
}

void spari_tile_store_f32(const spari_nodes *s, int64_t first, double (*row)[SPARI_ROW], float *x) {
    int count = spari_tile_count(s, first);
    if (!s->place) {
        choose_kernels(s)->give_singles(row, count, x + 3 * first, is_past(s));
        return;
    }
    for (int i = 0; i < count; i++) {
        float t[3] = {(float)row[0][i], (float)row[1][i], (float)row[2][i]};
        memcpy(x + 3 * (first + s->place[first + i]), t, sizeof t);
    }
}

void spari_tiles_end(void) {
#if defined(__GNUC__) && defined(__x86_64__)
    _mm_sfence(); /* after non-temporal stores */
#endif
}

void spari_tile_store_at(const spari_nodes *s, int64_t first, double (*row)[SPARI_ROW], const spari_layout *layout,
                         double *d, float *f) {
    int count = spari_tile_count(s, first);
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < count; i++) {
            ptrdiff_t at = (ptrdiff_t)(spari_nodes_node(s, first + i) * layout->node + k * layout->component);
            if (d) {
                memcpy(d + at, &row[k][i], sizeof *d);
            } else {
                float single = (float)row[k][i];
                memcpy(f + at, &single, sizeof single);
            }
        }
    }
}

/* Transposed transform: f_l = sum_k m[k][l] F_k. */
static void spread(int elements, int per_element, const double *modal, int consistent, const double *q,
                   const double *work, double *load) {
    double chained[4 * SPARI_MAX_NODES], back[4], g[7], m[4];
    consistent = consistent && per_element > 1;
    for (int e = 0; e < elements; e++) {
        ptrdiff_t node = (ptrdiff_t)e * per_element;
        const double *sums = work + node * 14;
        if (consistent) {
            spari_chain(per_element, q + 7 * node + 3, 7, chained);
        }
        for (int l = 0; l < per_element; l++) {
            double *to = load + 6 * (node + l);
            memset(g, 0, sizeof g);
            for (int k = 0; k < per_element; k++) {
                for (int f = 0; f < 7; f++) {
                    g[f] += modal[k * per_element + l] * (sums[(k * 7 + f) * 2] + sums[(k * 7 + f) * 2 + 1]);
                }
            }
            memcpy(to, g, 3 * sizeof *to);
            if (consistent) {
                spari_quat_conj(chained + 4 * l, back);
                spari_quat_mul(g + 3, back, m);
                memcpy(to + 3, m + 1, 3 * sizeof *to);
            } else {
                memcpy(to + 3, g + 3, 3 * sizeof *to);
            }
        }
    }
}

/* ---- sums of loads ---- */

/* Sums over nodes, in one block of doubles: modal sums [elements][P][7][2] and those of the audit, each with its
   rounding error; then the extremes, minima first. */
typedef struct load_sums {
    double *modal, *audit, *tops, *least;
} load_sums;

static load_sums sums_at(double *block, int64_t nodes) {
    double *audit = block + 14 * nodes;
    return (load_sums){block, audit, audit + 18, audit + 21};
}

/* Arguments of the sum of loads. */
typedef struct gathering {
    const spari_nodes *s;
    const spari_transfer_kernels *kernel;
    const double *c;
    int consistent, has_moment, audited;
    spari_source force, moment;
    int64_t nodes, slab, first; /* nodes of the line; fluid nodes per slab; slab of the first workspace */
    int64_t rows;               /* doubles of workspace before the sums */
    double *work;
} gathering;

static void clear_sums(double *block, int64_t nodes) {
    memset(block, 0, (size_t)spari_gather_share(nodes) * sizeof *block);
    *sums_at(block, nodes).least = HUGE_VAL;
}

/* The host's forces of the tile after this one, for prefetching with many nodes. */
static const char *forces_ahead(const spari_nodes *s, int64_t first, spari_source force, int size) {
    if (s->n < SPARI_FAR || force.layout || first + 2 * SPARI_TILE > s->n) {
        return NULL;
    }
    return (force.d ? (const char *)force.d : (const char *)force.f) + 3 * (first + SPARI_TILE) * size;
}

/* Adds a run of one element. It lies before `end`, the end of the slab. f: rows of workspace. */
static void add_run(const gathering *g, int64_t p, int run, int64_t end, tile_loads *loads, double (*f)[SPARI_ROW],
                    const load_sums *to) {
    const spari_nodes *s = g->s;
    const int64_t after = p + run;
    const int element = spari_nodes_element(s, p);
    const ptrdiff_t node = (ptrdiff_t)element * s->per_element;
    loads->nodes += run;
    loads->end = after >= end || spari_nodes_element(s, after) != element || loads->nodes >= SPARI_HELD;
    double d = g->kernel->loads(s, p, run, g->c + node * SPARI_FIELDS, g->consistent, g->has_moment, loads, g->audited,
                                f, to->modal + node * 14, to->audit, to->tops);
    *to->least = d < *to->least ? d : *to->least;
    loads->begin = loads->end;
    loads->nodes = loads->end ? 0 : loads->nodes;
    loads->at += run;
}

/* Its rows are the first six of the workspace. */
static void add_tile(const gathering *g, int64_t first, int64_t end, tile_loads *loads, const load_sums *to) {
    const spari_nodes *s = g->s;
    double(*f)[SPARI_ROW] = loads->row;
    int count = spari_tile_count(s, first);
    fetch_rows(g->kernel, s, first, count, g->force, f);
    if (g->has_moment) {
        fetch_rows(g->kernel, s, first, count, g->moment, f + 3);
    }
    for (int i = count; i < SPARI_ROW; i++) { /* lanes past the end are multiplied by zeros */
        f[0][i] = f[1][i] = f[2][i] = 0;
    }
    loads->next = forces_ahead(s, first, g->force, loads->size);
    loads->at = 0;
    while (loads->at < count) {
        int run = run_length(s, first + loads->at, count - loads->at);
        add_run(g, first + loads->at, run, end, loads, f + 6, to);
    }
}

static void add_slab(const gathering *g, int64_t slab, double *rows, double *block) {
    const load_sums to = sums_at(block, g->nodes);
    int64_t from = slab * g->slab, end = from + g->slab < g->s->n ? from + g->slab : g->s->n;
    tile_loads loads = {.row = (double(*)[SPARI_ROW])rows, .begin = 1};
    loads.size = g->force.d ? sizeof *g->force.d : sizeof *g->force.f;
    loads.held = rows + spari_gather_held(g->s->per_element);
    clear_sums(block, g->nodes);
    for (int64_t first = from; first < end; first += SPARI_TILE) {
        add_tile(g, first, end, &loads, &to);
    }
}

static spari_thread_pool *pool_of(const spari_nodes *s) {
    return s->pool ? *s->pool : NULL;
}

/* Workspace of a thread, which begins with its rows. */
static double *work_of(const gathering *g, int worker) {
    int64_t size = g->rows + spari_gather_share(g->nodes);
    return worker == 0 ? g->work : spari_thread_pool_workspace(pool_of(g->s), worker, size);
}

/* If several slabs are summed at once, each has a block of its own, whichever thread fills it. */
static double *block_of(const gathering *g, int64_t k) {
    return work_of(g, (int)k) + g->rows;
}

static void gather_item(void *context, int64_t item, int worker) {
    const gathering *g = context;
    add_slab(g, g->first + item, work_of(g, worker), block_of(g, item));
}

static void join_sums(const double *block, double *total, int64_t nodes) {
    const load_sums to = sums_at(total, nodes);
    const double *tops = block + 14 * nodes + 18;
    for (int64_t i = 0; i < 14 * nodes + 18; i += 2) {
        spari_add(total + i, block[i]);
        spari_add(total + i, block[i + 1]);
    }
    for (int i = 0; i < 4; i++) { /* minimum */
        to.tops[i] = tops[i] < to.tops[i] ? tops[i] : to.tops[i];
    }
}

/* Sums all loads into one block. */
static void sum_all_loads(gathering *g, double *total) {
    int64_t slabs = spari_slabs(g->s->n, g->slab);
    spari_thread_pool *pool = pool_of(g->s);
    if (slabs < 2) {
        add_slab(g, 0, g->work, total);
        return;
    }
    int shared =
        spari_thread_pool_is_free(pool) && spari_thread_pool_workspace(pool, 1, g->rows + spari_gather_share(g->nodes));
    int64_t most = shared ? spari_thread_pool_threads(pool) : 1;
    clear_sums(total, g->nodes);
    for (g->first = 0; g->first < slabs; g->first += most) {
        int64_t here = slabs - g->first < most ? slabs - g->first : most;
        spari_thread_pool_run(pool, here, gather_item, g);
        for (int64_t k = 0; k < here; k++) {
            join_sums(block_of(g, k), total, g->nodes);
        }
    }
}

static void finish_audit(const load_sums *of, spari_audit *audit) {
    const double *sums = of->audit;
    for (int i = 0; i < 3; i++) {
        audit->force[i] = sums[2 * i] + sums[2 * i + 1];
        audit->moment[i] = sums[2 * (i + 3)] + sums[2 * (i + 3) + 1];
    }
    audit->power = sums[12] + sums[13];
    audit->force_sum = sums[14] + sums[15];
    audit->moment_sum = sums[16] + sums[17];
    audit->x_max = sqrt(0 - of->tops[0]), audit->v_max = sqrt(0 - of->tops[1]); /* 0 minus avoids negative zero */
    audit->omega_max = sqrt(0 - of->tops[2]);
}

double spari_gather_loads(const spari_nodes *s, const double *modal, const double *c, int consistent, const double *q,
                          spari_source force, spari_source moment, double *work, double *load, spari_audit *audit) {
    int64_t nodes = (int64_t)s->elements * s->per_element;
    gathering g = {.s = s, .kernel = choose_kernels(s), .c = c, .consistent = consistent, .force = force};
    g.moment = moment, g.has_moment = moment.d || moment.f, g.audited = audit != NULL;
    g.nodes = nodes, g.work = work, g.rows = spari_gather_rows(s->per_element);
    double *block = work + g.rows + spari_gather_share(nodes);
    g.slab = SPARI_SUM_SLAB * (1 + nodes / 1024); /* joining the sums costs little compared with computing them */
    sum_all_loads(&g, block);
    const load_sums total = sums_at(block, nodes);
    spread(s->elements, s->per_element, modal, consistent, q, total.modal, load);
    if (audit) {
        finish_audit(&total, audit);
    }
    return *total.least;
}

double spari_bin_loads(const spari_nodes *s, const double *modal, int consistent, const double *q, spari_source force,
                       spari_source moment, double *work, spari_bins *load, int *finite) {
    const spari_transfer_kernels *kernel = choose_kernels(s);
    const int has_moment = moment.d || moment.f, P = s->per_element;
    double(*f)[SPARI_ROW] = (double(*)[SPARI_ROW])work, chained[4 * SPARI_MAX_NODES], least = HUGE_VAL;
    spari_bin_cut cut;
    spari_bins_cut(0, &cut);
    memset(f, 0, 6 * sizeof *f);
    memset(load, 0, sizeof *load * 6 * (size_t)s->elements * (size_t)P);
    *finite = 1;
    for (int64_t first = 0; first < s->n; first += SPARI_TILE) {
        int count = spari_tile_count(s, first);
        fetch_rows(kernel, s, first, count, force, f);
        if (has_moment) {
            fetch_rows(kernel, s, first, count, moment, f + 3);
        }
        for (int at = 0; at < count;) {
            int run = run_length(s, first + at, count - at);
            ptrdiff_t node = (ptrdiff_t)spari_nodes_element(s, first + at) * P;
            spari_chain(P, q + 7 * node + 3, 7, chained);
            *finite = kernel->bins(s, first + at, run, modal, chained, consistent && P > 1, has_moment, f, at, f + 6,
                                   &least, &cut, load + 6 * node) &&
                      *finite;
            at += run;
        }
    }
    return least;
}
