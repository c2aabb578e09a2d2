/* Save and load of a fluid: writes its state, and assembles a state from saved pieces, which all ranks must have
   before any puts it in force. */
#include "state.h"

#include "../base/status.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Layout of a state, in order:
   - the words below;
   - if mapped, load and load_accepted [nodes][6], and their reproducible sums, if kept;
   - if loads came over parts of steps, their ends at t^n and t^{n+1} [nodes][6], and their sums, if kept;
   - if node forces or the host's own numbers are kept, the positions of these nodes;
   - if node forces are kept, forces at t^{n+1}, t^n, t^{n-1}, t^{n-2} [n][3], zeros beyond the predictor's order;
   - if the host's numbers are kept, these at t^n and t^{n+1} [n][width]. */
enum {
    S_NODES,
    S_KEPT,
    S_PUSHED,
    S_PUSHES,
    S_MAPPED,
    S_PARTS,
    S_WIDTH,
    S_STATES, /* numbers at t^{n+1} were pushed */
    S_AUDIT,
    S_HEAD = SPARI_FLUID_HEAD
};

/* Blocks of data per node: positions, forces at t^{n+1}, t^n, t^{n-1}, t^{n-2}, the host's numbers at t^n, t^{n+1}. */
enum { POSITIONS, FORCES, NUMBERS = 5 };

enum { PARTS_BEFORE = 1, PARTS_NOW = 2 }; /* S_PARTS: which of the ends come from parts */

enum { IS_MAPPED = 1, HAS_BINS = 2, /* of S_MAPPED */ BIN_WORDS = sizeof(spari_bins) / sizeof(double) };

/* Words of two nodal loads and their sums. */
static int64_t state_pair(const spar_member *m, const double *head) {
    return 12 * m->nodes * (head[S_MAPPED] == HAS_BINS ? 1 + BIN_WORDS : 1);
}

/* Words before the ends of parts. */
static int64_t state_ends(const spar_member *m, const double *head) {
    return S_HEAD + (head[S_MAPPED] != 0 ? state_pair(m, head) : 0);
}

/* Words of the head and all nodal loads of a state. */
static int64_t state_loads(const spar_member *m, const double *head) {
    return state_ends(m, head) + (head[S_PARTS] != 0 ? state_pair(m, head) : 0);
}

static spari_by_node state_by_node(const double *head) {
    const int forces = head[S_KEPT] != 0, numbers = head[S_WIDTH] != 0;
    spari_by_node by = {.nodes = forces || numbers ? (int64_t)head[S_NODES] : 0};
    for (int k = 0; k < SPARI_FLUID_BLOCKS && (forces || numbers); k++) {
        by.width[k] = k == POSITIONS ? 3 : k < NUMBERS ? (forces ? 3 : 0) : (int64_t)head[S_WIDTH];
        by.all += by.width[k];
    }
    return by;
}

static int64_t state_size(const spar_member *m, const double *head) {
    const spari_by_node by = state_by_node(head);
    return state_loads(m, head) + by.nodes * by.all;
}

static void state_head(const spar_fluid *fluid, double head[S_HEAD]) {
    const spari_nodes *s = spari_fluid_set(fluid, SPAR_NODES_FORCE)->nodes;
    const spari_history *h = fluid->history;
    head[S_NODES] = s ? (double)s->n : 0;
    head[S_KEPT] = h && s ? 1 + h->known : 0;
    head[S_PUSHED] = h && h->pushed;
    head[S_PUSHES] = (double)fluid->pushes;
    head[S_MAPPED] = !fluid->load ? 0 : fluid->bins[0] ? HAS_BINS : IS_MAPPED;
    const spari_parts *p = fluid->parts;
    head[S_PARTS] = p ? (p->ended ? PARTS_BEFORE : 0) + (p->theta > 0 ? PARTS_NOW : 0) : 0;
    const spari_states *t = s ? fluid->states : NULL;
    head[S_WIDTH] = t ? (double)t->width : 0;
    head[S_STATES] = t && t->pushed;
    memcpy(head + S_AUDIT, fluid->audit, sizeof fluid->audit);
}

int64_t spari_fluid_state_size(const spar_fluid *fluid) {
    double head[S_HEAD];
    state_head(fluid, head);
    return state_size(fluid->member, head);
}

/* Nodal loads of a fluid that are saved together, with their reproducible sums. */
typedef struct load_pair {
    double *value[2];
    spari_bins *sum[2]; /* NULL: none */
} load_pair;

enum { IN_USE, ENDS }; /* of spari_taking too */

static load_pair load_pair_of(const spar_fluid *f, int which) {
    return which == IN_USE
               ? (load_pair){{f->load, f->load_accepted}, {f->bins[SPARI_OF_PUSHED], f->bins[SPARI_OF_ACCEPTED]}}
               : (load_pair){{f->parts->end[0], f->parts->end[1]}, {f->bins[SPARI_OF_BEGIN], f->bins[SPARI_OF_END]}};
}

/* Returns the position after them. */
static double *put_load_pair(double *at, int64_t n, load_pair pair) {
    for (int k = 0; k < 2; k++, at += n) {
        memcpy(at, pair.value[k], (size_t)n * sizeof *at);
    }
    for (int k = 0; k < 2 && pair.sum[0]; k++, at += n * BIN_WORDS) {
        memcpy(at, pair.sum[k], (size_t)n * sizeof *pair.sum[k]);
    }
    return at;
}

/* Data per node; NULL: not kept. */
static void find_blocks_of(double *positions, const spari_history *h, const spari_states *t,
                           double *block[SPARI_FLUID_BLOCKS]) {
    memset(block, 0, SPARI_FLUID_BLOCKS * sizeof *block);
    block[POSITIONS] = positions;
    for (int k = 0; k < NUMBERS - FORCES && h; k++) {
        block[FORCES + k] = k == 0 ? h->after : h->past[k - 1];
    }
    if (t) {
        block[NUMBERS] = t->now, block[NUMBERS + 1] = t->next;
    }
}

static int put_by_node(const spar_fluid *fluid, const char *call, const spari_by_node *by, double *at) {
    double *positions = spari_fluid_positions(fluid, spari_fluid_set(fluid, SPAR_NODES_FORCE)->nodes);
    double *block[SPARI_FLUID_BLOCKS];
    SPARI_FLUID_REQUIRE_OF(fluid, call, positions, SPAR_ERR_MEMORY, "no memory to save its states");
    find_blocks_of(positions, fluid->history, fluid->states, block);
    for (int k = 0; k < SPARI_FLUID_BLOCKS; k++) {
        int64_t n = by->nodes * by->width[k];
        if (block[k]) {
            spari_give(at, block[k], n);
        } else {
            memset(at, 0, (size_t)n * sizeof *at);
        }
        at += n;
    }
    free(positions);
    return SPAR_OK;
}

int spari_fluid_save(const spar_fluid *fluid, const char *call, double *state) {
    const spari_parts *p = fluid->parts;
    SPARI_FLUID_REQUIRE_OF(
        fluid, call, !p || p->theta == 0 || p->theta == 1, SPAR_ERR_STATE,
        "a push in several parts is incomplete (spar_fluid_push_forces_at, theta = %g); save after theta = 1",
        p->theta);
    state_head(fluid, state);
    double *at = state + S_HEAD;
    int64_t loads = 6 * fluid->member->nodes;
    if (fluid->load) {
        at = put_load_pair(at, loads, load_pair_of(fluid, IN_USE));
    }
    if (p && state[S_PARTS] != 0) {
        at = put_load_pair(at, loads, load_pair_of(fluid, ENDS));
    }
    const spari_by_node by = state_by_node(state);
    return by.nodes > 0 ? put_by_node(fluid, call, &by, at) : SPAR_OK;
}

/* ---- assembling a state ---- */

void spari_fluid_give_up(spar_fluid *fluid) {
    spari_taking_free(fluid->taking);
    fluid->taking = NULL;
}

int spari_fluid_is_state(const spar_member *m, const double *head, int64_t count, int64_t *loads, spari_by_node *by) {
    if (!spari_is_count(head[S_NODES]) || !spari_is_count(head[S_PUSHES]) || !spari_is_count(head[S_PARTS]) ||
        !spari_is_count(head[S_WIDTH]) || !spari_is_count(head[S_KEPT]) || head[S_KEPT] > 1 + SPARI_MOST_PAST ||
        head[S_PARTS] > PARTS_BEFORE + PARTS_NOW || head[S_WIDTH] > SPARI_MOST_STATES || count != state_size(m, head)) {
        return 0;
    }
    *loads = state_loads(m, head);
    *by = state_by_node(head);
    return 1;
}

/* Sum of the heads, without the loads. */
static void sum_heads(spari_taking *t, int count, const double *const *heads) {
    for (int k = 0; k < count; k++) {
        const double *head = heads[k];
        if (head[S_KEPT] != 0 && (head[S_NODES] > 0 || t->head[S_KEPT] == 0)) {
            t->head[S_KEPT] = t->head[S_KEPT] == 0 ? head[S_KEPT] : fmin(t->head[S_KEPT], head[S_KEPT]);
        }
        t->head[S_PUSHED] = t->head[S_PUSHED] != 0 || head[S_PUSHED] != 0;
        t->head[S_STATES] = t->head[S_STATES] != 0 || head[S_STATES] != 0;
        t->head[S_WIDTH] = fmax(t->head[S_WIDTH], head[S_WIDTH]);
        t->head[S_PUSHES] += head[S_PUSHES];
        t->head[S_MAPPED] = t->head[S_MAPPED] != 0 || head[S_MAPPED] != 0;
        t->head[S_PARTS] = (int)t->head[S_PARTS] | (int)head[S_PARTS];
        memcpy(t->head + S_AUDIT, head + S_AUDIT, sizeof(double[S_HEAD - S_AUDIT]));
    }
}

/* Allocates nodal loads. */
static int alloc_loads(spar_fluid *fluid, const char *call, spari_taking *t) {
    int64_t n = 12 * fluid->member->nodes;
    SPARI_FLUID_REQUIRE_OF(fluid, call, t->head[S_PARTS] == 0 || spari_parts_prepare(fluid) == SPAR_OK, SPAR_ERR_MEMORY,
                           "no memory for loads over parts of a step");
    if (fluid->load && (fluid->member->session->ranks.reproducible || fluid->bins[0]) &&
        spari_fluid_make_bins(fluid) != SPAR_OK) {
        return spari_fluid_refuse(fluid, SPAR_ERR_MEMORY, call, "no memory for reproducible sums of its loads");
    }
    int ok = 1;
    for (int p = IN_USE; p <= (fluid->parts ? ENDS : IN_USE); p++) {
        t->load[p] = spari_zalloc(n, sizeof **t->load);
        t->bins[p] = fluid->bins[0] ? spari_zalloc(n, sizeof **t->bins) : NULL;
        ok = ok && t->load[p] && (t->bins[p] || !fluid->bins[0]);
    }
    SPARI_FLUID_REQUIRE_OF(fluid, call, ok, SPAR_ERR_MEMORY, "no memory for its loads");
    return SPAR_OK;
}

/* Sort key of a node: its height along a direction in which no two nodes of a regular grid coincide. */
static double height_of(const double *position) {
    return position[0] + 0.7548776662466927 * position[1] + 0.5698402909980532 * position[2];
}

static int compare_heights(const void *a, const void *b) {
    const double *const *x = a, *const *y = b;
    double left = height_of(*x), right = height_of(*y);
    return left < right ? -1 : left > right ? 1 : *x < *y ? -1 : *x > *y;
}

/* Allocates data per node and the search arrays. */
static int alloc_nodes(spar_fluid *fluid, const char *call, spari_taking *t, const spari_nodes *s) {
    int kept = t->head[S_KEPT] != 0, width = (int)t->head[S_WIDTH];
    t->n = s->n;
    t->history = kept ? spari_history_create(s->n, fluid->member->session->coupling.predictor) : NULL;
    if (t->history) {
        t->history->sections = spari_fluid_set(fluid, SPAR_NODES_FORCE)->sections;
    }
    t->states = width > 0 ? spari_states_create(s->n, width) : NULL;
    t->positions = spari_fluid_positions(fluid, s);
    t->sorted = spari_zalloc(s->n, sizeof *t->sorted);
    t->found = spari_zalloc(s->n, 1);
    SPARI_FLUID_REQUIRE_OF(fluid, call,
                           (t->history || !kept) && (t->states || width == 0) && t->positions && t->sorted && t->found,
                           SPAR_ERR_MEMORY, "no memory for its states");
    find_blocks_of(t->positions, t->history, t->states, t->block);
    for (int64_t i = 0; i < s->n; i++) {
        t->sorted[i] = t->positions + 3 * i;
    }
    qsort(t->sorted, (size_t)s->n, sizeof *t->sorted, compare_heights);
    return SPAR_OK;
}

/* The saved run must have the same number of values per node on all ranks, equal to the number kept here, if any. */
static int check_widths(const spar_fluid *fluid, const char *call, int count, const double *const *heads,
                        const spari_nodes *s) {
    double width = fluid->taking->head[S_WIDTH];
    for (int k = 0; k < count; k++) {
        SPARI_FLUID_REQUIRE_OF(fluid, call, heads[k][S_NODES] == 0 || heads[k][S_WIDTH] == width, SPAR_ERR_ARGUMENT,
                               "the ranks of the saved run have %g and %g states per node (spar_fluid_set_states); set "
                               "the same number on all ranks",
                               width, heads[k][S_WIDTH]);
    }
    double here = fluid->states && s && s->n > 0 ? (double)fluid->states->width : width;
    SPARI_FLUID_REQUIRE_OF(fluid, call, here == width, SPAR_ERR_ARGUMENT,
                           "it has %g states per node (spar_fluid_set_states), the saved run has %g", here, width);
    return SPAR_OK;
}

int spari_fluid_take(spar_fluid *fluid, const char *call, int count, const double *const *heads) {
    const spari_nodes *s = spari_fluid_set(fluid, SPAR_NODES_FORCE)->nodes;
    spari_fluid_give_up(fluid);
    spari_taking *t = fluid->taking = spari_zalloc(1, sizeof *t);
    SPARI_FLUID_REQUIRE_OF(fluid, call, t, SPAR_ERR_MEMORY, "no memory to load it");
    sum_heads(t, count, heads);
    SPARI_FLUID_REQUIRE_OF(fluid, call, t->head[S_MAPPED] == 0 || fluid->load, SPAR_ERR_STATE,
                           "it is not mapped yet; give its nodes and call spar_fluid_map first");
    SPARI_TRY(alloc_loads(fluid, call, t));
    SPARI_FLUID_REQUIRE_OF(
        fluid, call, !fluid->history || !s || s->n == 0 || t->head[S_KEPT] != 0, SPAR_ERR_ARGUMENT,
        "node forces are requested (SPAR_EFFECT_FLUID_HISTORY), but the saved run does not contain them");
    SPARI_TRY(check_widths(fluid, call, count, heads, s));
    return (t->head[S_KEPT] != 0 || t->head[S_WIDTH] != 0) && s ? alloc_nodes(fluid, call, t, s) : SPAR_OK;
}

/* ---- loads ---- */

/* Copies the sums of a pair of loads: a state may be unaligned. */
static void bins_of_pair(const spar_member *m, const double *pair, int64_t i, spari_bins *sum) {
    memcpy(sum, pair + 12 * m->nodes + i * BIN_WORDS, sizeof *sum);
}

/* Whether the sums have valid bins. */
static int are_bins(const spar_member *m, const double *pair) {
    spari_bins sum;
    for (int64_t i = 0; i < 12 * m->nodes; i++) {
        bins_of_pair(m, pair, i, &sum);
        if (sum.top < 0 || sum.top > spari_bins_top(DBL_MAX)) {
            return 0;
        }
    }
    return 1;
}

/* Adds x[n] of a state; the first state is copied, because 0 + -0 is not -0. */
static void add_of_state(double *sum, const double *x, int64_t n, int first) {
    for (int64_t i = 0; i < n; i++) {
        sum[i] = first ? x[i] : sum[i] + x[i];
    }
}

/* Adds one of a pair of loads as a reproducible sum: the saved sum, if there is one. */
static void add_bins_of_pair(spari_bins *sum, const spar_member *m, const double *pair, int which, int has_bins) {
    int64_t first = which * 6 * m->nodes;
    for (int64_t i = 0; i < 6 * m->nodes; i++) {
        spari_bins add = {0};
        if (has_bins) {
            bins_of_pair(m, pair, first + i, &add);
        } else {
            spari_bins_add(&add, pair[first + i]);
            spari_bins_double(&add);
        }
        spari_bins_merge(sum + i, &add);
    }
}

int spari_fluid_take_loads(spar_fluid *fluid, const double *state, int takes_loads) {
    const spar_member *m = fluid->member;
    spari_taking *t = fluid->taking;
    const double *loads = state + S_HEAD, *ends = state + state_ends(m, state);
    int64_t n = 6 * m->nodes;
    int has_bins = state[S_MAPPED] == HAS_BINS;
    if (has_bins && (!are_bins(m, loads) || (state[S_PARTS] != 0 && !are_bins(m, ends)))) {
        return 0;
    }
    if (!takes_loads || state[S_MAPPED] == 0) {
        return 1;
    }
    for (int k = 0; k < 4; k++) {
        int p = k / 2, which = k % 2, has = p == IN_USE || (int)state[S_PARTS] & (which ? PARTS_NOW : PARTS_BEFORE);
        int from = has ? which : 1 - which; /* ends without sums are the loads in use */
        const double *pair = p == ENDS && has ? ends : loads;
        if (t->load[p]) {
            add_of_state(t->load[p] + which * n, pair + from * n, n, t->added == 0);
        }
        if (t->bins[p]) {
            add_bins_of_pair(t->bins[p] + which * n, m, pair, from, has_bins);
        }
    }
    t->added++;
    return 1;
}

/* ---- data per node ---- */

/* Distance within which a saved node matches. Positions are computed from nearest points and lever arms, which round
   differently on another processor or with other nodes. */
static double position_tolerance(const spar_fluid *fluid, const double *position) {
    return 1e-9 * spari_member_length(fluid->member) +
           1e-12 * fmax(fabs(position[0]), fmax(fabs(position[1]), fabs(position[2])));
}

static double distance_between(const double *a, const double *b) {
    return fmax(fabs(a[0] - b[0]), fmax(fabs(a[1] - b[1]), fabs(a[2] - b[2])));
}

/* Nearest node within this distance that has been found already, or not yet; -1: none. */
static int64_t find_node(const spar_fluid *fluid, const double *position, int found) {
    const spari_taking *t = fluid->taking;
    double nearest = position_tolerance(fluid, position), height = height_of(position), most = 3 * nearest;
    int64_t low = 0, high = t->n, n = high, best = -1;
    while (low < high) {
        int64_t middle = low + (high - low) / 2;
        if (height_of(t->sorted[middle]) < height - most) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    for (; low < n && height_of(t->sorted[low]) <= height + most; low++) {
        int64_t i = (t->sorted[low] - t->positions) / 3;
        double distance = distance_between(t->sorted[low], position);
        if (t->found[i] == found && distance <= nearest && (best < 0 || distance < nearest)) {
            best = i;
            nearest = distance;
        }
    }
    return best;
}

/* Data of node `to` from node `from` of `count` nodes in consecutive blocks. */
static void put_node(spari_taking *t, int64_t to, const spari_by_node *by, const double *rows, int64_t count,
                     int64_t from) {
    for (int k = 0; k < SPARI_FLUID_BLOCKS; rows += by->width[k] * count, k++) {
        if (k > POSITIONS && t->block[k]) {
            spari_give(t->block[k] + by->width[k] * to, rows + by->width[k] * from, by->width[k]);
        }
    }
    t->found[to] = 1;
}

void spari_fluid_take_nodes(spar_fluid *fluid, const double *head, int64_t first, int64_t count, const double *rows) {
    spari_taking *t = fluid->taking;
    const spari_by_node by = state_by_node(head);
    int64_t here = t->positions ? t->n : 0;
    for (int64_t i = 0; i < count && here > 0; i++) {
        const double *position = rows + 3 * i, *own = by.nodes == here ? t->positions + 3 * (first + i) : NULL;
        /* same nodes in the same order, possibly repeated: no search */
        int same = own && !t->found[first + i] && distance_between(position, own) <= position_tolerance(fluid, own);
        int64_t to = same ? first + i : find_node(fluid, position, 0);
        if (to >= 0) {
            put_node(t, to, &by, rows, count, i);
        }
    }
}

/* A node whose position occurred fewer times in the file gets the data of another node at this position. */
static int share_node(spar_fluid *fluid, int64_t to) {
    spari_taking *t = fluid->taking;
    const spari_by_node by = state_by_node(t->head);
    int64_t i = find_node(fluid, t->positions + 3 * to, 1);
    for (int k = FORCES; k < SPARI_FLUID_BLOCKS && i >= 0; k++) {
        if (t->block[k]) {
            memcpy(t->block[k] + by.width[k] * to, t->block[k] + by.width[k] * i, (size_t)by.width[k] * sizeof(double));
        }
    }
    t->found[to] = i >= 0;
    return i >= 0;
}

int64_t spari_fluid_first_missing(spar_fluid *fluid) {
    const spari_taking *t = fluid->taking;
    for (int64_t i = 0; t->positions && i < t->n; i++) {
        if (!t->found[i] && !share_node(fluid, i)) {
            return i;
        }
    }
    return -1;
}

int spari_fluid_loaded_whole(spar_fluid *fluid, const char *call) {
    int64_t i = spari_fluid_first_missing(fluid);
    SPARI_FLUID_REQUIRE_OF(fluid, call, i < 0, SPAR_ERR_ARGUMENT,
                           "force node %lld is not in the saved run; use the nodes of the saved run", (long long)i);
    return SPAR_OK;
}

/* ---- putting in force ---- */

static void load_load_pair(const spar_fluid *fluid, load_pair to, const double *value, const spari_bins *sum) {
    const int64_t n = 6 * fluid->member->nodes;
    for (int which = 0; which < 2; which++) {
        memcpy(to.value[which], value + which * n, (size_t)n * sizeof *value);
        for (int64_t i = 0; sum && i < n; i++) {
            to.sum[which][i] = sum[which * n + i];
            to.value[which][i] = 0.5 * spari_bins_value(sum + which * n + i);
        }
    }
}

void spari_fluid_load(spar_fluid *fluid) {
    spari_taking *t = fluid->taking;
    fluid->pushes = (int64_t)t->head[S_PUSHES];
    memcpy(fluid->audit, t->head + S_AUDIT, sizeof fluid->audit);
    spari_fluid_forget_refusal(fluid);
    if (fluid->parts) {
        int have = (int)t->head[S_PARTS];
        fluid->parts->ended = (have & PARTS_BEFORE) != 0;
        fluid->parts->theta = have & PARTS_NOW ? 1 : 0;
        fluid->parts->plain = 0;
        load_load_pair(fluid, load_pair_of(fluid, ENDS), t->load[ENDS], t->bins[ENDS]);
    }
    if (fluid->load) {
        load_load_pair(fluid, load_pair_of(fluid, IN_USE), t->load[IN_USE], t->bins[IN_USE]);
    }
    if (t->history) {
        spari_history_free(fluid->history);
        fluid->history = t->history, t->history = NULL;
    }
    if (t->states) {
        spari_states_free(fluid->states);
        fluid->states = t->states, t->states = NULL;
        fluid->states->pushed = t->head[S_STATES] != 0;
    }
    if (fluid->history && t->head[S_KEPT] != 0) {
        fluid->history->known = (int)t->head[S_KEPT] - 1;
    }
    if (fluid->history) {
        fluid->history->pushed = t->head[S_PUSHED] != 0;
    }
    spari_fluid_give_up(fluid);
    spari_fluid_warn_present(fluid);
}
