/* A fluid's part of save and load. */
#include "state.h"

#include "../base/status.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A state: these, then load and load_accepted [nodes][6] if mapped; then their reproducible sums, bit by bit, if it has
   them; then, if loads came over parts of steps, their ends at t^n and t^{n+1} [nodes][6]; then, if node forces are
   kept, the nodes' places, their forces at t^{n+1}, t^n, t^{n-1}, t^{n-2} [n][3], zeros where the predictor did not
   look so far back. */
enum { S_NODES, S_KEPT, S_PUSHED, S_PUSHES, S_MAPPED, S_PARTS, S_AUDIT, S_HEAD = S_AUDIT + 8 };

enum { PARTS_BEFORE = 1, PARTS_NOW = 2 }; /* S_PARTS: which of the ends are of parts */

enum { IS_MAPPED = 1, HAS_BINS = 2, /* of S_MAPPED */ BIN_WORDS = sizeof(spari_bins) / sizeof(double) };

/* Words of load and load_accepted, with their sums. */
static int64_t state_pair(const spar_fluid *fluid, const double *head) {
    int64_t pair = head[S_MAPPED] != 0 ? 12 * fluid->member->nodes : 0;
    return head[S_MAPPED] == HAS_BINS ? pair * (1 + BIN_WORDS) : pair;
}

/* Words of all nodal loads of a state. */
static int64_t state_loads(const spar_fluid *fluid, const double *head) {
    return state_pair(fluid, head) + (head[S_PARTS] != 0 ? 12 * fluid->member->nodes : 0);
}

static int64_t state_size(const spar_fluid *fluid, const double *head) {
    return S_HEAD + state_loads(fluid, head) + (head[S_KEPT] != 0 ? 15 * (int64_t)head[S_NODES] : 0);
}

static void state_head(const spar_fluid *fluid, double head[S_HEAD]) {
    const spari_nodes *s = spari_fluid_set(fluid, SPAR_NODES_FORCE)->nodes;
    const spari_history *h = fluid->history;
    head[S_NODES] = s ? (double)s->n : 0;
    head[S_KEPT] = h && s;
    head[S_PUSHED] = h && h->pushed;
    head[S_PUSHES] = (double)fluid->pushes;
    head[S_MAPPED] = !fluid->load ? 0 : fluid->bins[0] ? HAS_BINS : IS_MAPPED;
    const spari_parts *p = fluid->parts;
    head[S_PARTS] = p ? (p->ended ? PARTS_BEFORE : 0) + (p->theta > 0 ? PARTS_NOW : 0) : 0;
    memcpy(head + S_AUDIT, fluid->audit, sizeof fluid->audit);
}

int64_t spari_fluid_state_size(const spar_fluid *fluid) {
    double head[S_HEAD];
    state_head(fluid, head);
    return state_size(fluid, head);
}

int spari_fluid_save(const spar_fluid *fluid, const char *call, double *state) {
    const spari_parts *p = fluid->parts;
    if (p && p->theta != 0 && p->theta != 1) {
        return spari_fluid_refuse(
            fluid, SPAR_ERR_STATE, call,
            "it is between two pushes of spar_fluid_push_forces_at (theta = %g); save after theta = 1", p->theta);
    }
    const spari_history *h = fluid->history;
    state_head(fluid, state);
    double *at = state + S_HEAD;
    size_t loads = 6 * (size_t)fluid->member->nodes;
    if (fluid->load) {
        memcpy(at, fluid->load, loads * sizeof *at);
        memcpy(at += loads, fluid->load_accepted, loads * sizeof *at);
        at += loads;
    }
    for (int k = 0; k < 3 && state[S_MAPPED] == HAS_BINS; k += 2) {
        memcpy(at, fluid->bins[k], loads * sizeof *fluid->bins[k]);
        at += loads * BIN_WORDS;
    }
    for (int k = 0; k < 2 && state[S_PARTS] != 0; k++, at += loads) {
        memcpy(at, p->end[k], loads * sizeof *at);
    }
    if (state[S_KEPT] != 0) {
        size_t n = 3 * (size_t)h->n;
        double *places = spari_fluid_places(fluid, spari_fluid_set(fluid, SPAR_NODES_FORCE)->nodes);
        SPARI_FLUID_REQUIRE(fluid, places, SPAR_ERR_MEMORY, "no memory to save the node forces");
        const double *all[] = {places, h->after, h->past[0], h->past[1], h->past[2]};
        for (int k = 0; k < 5 && n > 0; k++, at += n) {
            if (all[k]) {
                memcpy(at, all[k], n * sizeof *at);
            } else {
                memset(at, 0, n * sizeof *at);
            }
        }
        free(places);
    }
    return SPAR_OK;
}

/* The sums of a state for load (0) or load_accepted (1), copied: a state need not lie where a whole number may. */
static void state_bins(const spar_fluid *fluid, const double *state, int which, int64_t i, spari_bins *sum) {
    int64_t loads = 6 * fluid->member->nodes;
    memcpy(sum, state + S_HEAD + 2 * loads + (which * loads + i) * BIN_WORDS, sizeof *sum);
}

/* Whether the sums have bins that numbers can have. */
static int are_bins(const spar_fluid *fluid, const double *state) {
    spari_bins sum;
    for (int64_t i = 0; state[S_MAPPED] == HAS_BINS && i < 12 * fluid->member->nodes; i++) {
        state_bins(fluid, state, 0, i, &sum);
        if (sum.top < 0 || sum.top > spari_bins_top(DBL_MAX)) {
            return 0;
        }
    }
    return 1;
}

int spari_fluid_is_state(const spar_fluid *fluid, const double *state, int64_t count) {
    return count >= S_HEAD && spari_is_count(state[S_NODES]) && spari_is_count(state[S_PUSHES]) &&
           spari_is_count(state[S_PARTS]) && state[S_PARTS] <= PARTS_BEFORE + PARTS_NOW &&
           count == state_size(fluid, state) && are_bins(fluid, state);
}

/* Of a state; 0 where their forces are not in it. */
static int64_t kept_nodes(const double *state) {
    return state[S_KEPT] != 0 ? (int64_t)state[S_NODES] : 0;
}

/* Where the places of a state begin. */
static const double *state_places(const spar_fluid *fluid, const double *state) {
    return state + S_HEAD + state_loads(fluid, state);
}

static int compare_places(const void *a, const void *b) {
    const double *const *x = a, *const *y = b;
    return memcmp(*x, *y, 3 * sizeof **x);
}

/* Whether the places are those of the nodes here, in their order, but for what another processor rounds otherwise:
   places are put together from feet and arms. */
static int same_places(const spar_fluid *fluid, const double *a, const double *b, int64_t n) {
    double room = 1e-9 * spari_member_length(fluid->member);
    for (int64_t i = 0; i < 3 * n; i++) {
        if (!(fabs(a[i] - b[i]) <= room + 1e-12 * fabs(b[i]))) {
            return 0;
        }
    }
    return 1;
}

/* For each node the place of it in one of the states, or NULL where there is none: in the same order, or else bit by
   bit the same. */
static const double **find_nodes(const spar_fluid *fluid, int count, const double *const *states, const double *places,
                                 int64_t n) {
    int64_t total = 0, at = 0;
    for (int k = 0; k < count; k++) {
        total += kept_nodes(states[k]);
    }
    const double **sorted = spari_zalloc(total, sizeof *sorted), **found = spari_zalloc(n, sizeof *found);
    if (!sorted || !found) {
        free(sorted);
        free(found);
        return NULL;
    }
    for (int k = 0; k < count; k++) {
        const double *x = state_places(fluid, states[k]);
        for (int64_t i = 0; i < kept_nodes(states[k]); i++) {
            sorted[at++] = x + 3 * i;
        }
    }
    /* the same nodes in the same order, places that are there twice among them: no search */
    if (count == 1 && total == n && (n == 0 || same_places(fluid, sorted[0], places, n))) {
        memcpy(found, sorted, (size_t)n * sizeof *found);
    } else {
        qsort(sorted, (size_t)total, sizeof *sorted, compare_places);
        for (int64_t i = 0; i < n; i++) {
            const double *key = places + 3 * i;
            const double **hit = bsearch(&key, sorted, (size_t)total, sizeof *sorted, compare_places);
            found[i] = hit ? *hit : NULL;
        }
    }
    free(sorted);
    return found;
}

/* Node forces from the states: to find (h NULL), or to copy. */
static int take_forces(const spar_fluid *fluid, const char *call, int count, const double *const *states,
                       spari_history *h) {
    const spari_nodes *s = spari_fluid_set(fluid, SPAR_NODES_FORCE)->nodes;
    int copy = h != NULL;
    double *places = spari_fluid_places(fluid, s);
    const double **found = places ? find_nodes(fluid, count, states, places, s->n) : NULL;
    int64_t missing = found ? -1 : s->n;
    for (int64_t i = 0; found && i < s->n; i++) {
        int64_t n = 0; /* of the state the node is in */
        missing = !found[i] && missing < 0 ? i : missing;
        for (int k = 0; k < count && found[i] && copy; k++) {
            const double *x = state_places(fluid, states[k]);
            n = found[i] >= x && found[i] < x + 3 * kept_nodes(states[k]) ? kept_nodes(states[k]) : n;
        }
        for (int k = 0; k < 4 && h; k++) {
            double *to = k == 0 ? h->after : h->past[k - 1];
            if (to) {
                /* none is missing when they are copied. NOLINTNEXTLINE(clang-analyzer-core.NonNullParamChecker) */
                memcpy(to + 3 * i, found[i] + 3 * n * (k + 1), 3 * sizeof *to);
            }
        }
    }
    int ok = found != NULL;
    free(places);
    free(found);
    if (!ok) {
        return spari_fluid_refuse(fluid, SPAR_ERR_MEMORY, call, "no memory to find the node forces");
    }
    if (missing >= 0) {
        return spari_fluid_refuse(fluid, SPAR_ERR_ARGUMENT, call,
                                  "force node %lld is not in the saved run; load with the nodes it had",
                                  (long long)missing);
    }
    return SPAR_OK;
}

int spari_fluid_ready(spar_fluid *fluid, const char *call, int count, const double *const *states) {
    const spari_nodes *s = spari_fluid_set(fluid, SPAR_NODES_FORCE)->nodes;
    int kept = 0, mapped_then = 0, on = fluid->history != NULL;
    spari_history_free(fluid->history_next); /* of a load that another rank could not do */
    fluid->history_next = NULL;
    for (int k = 0; k < count; k++) {
        kept |= states[k][S_KEPT] != 0;
        mapped_then |= states[k][S_MAPPED] != 0;
    }
    if (mapped_then && !fluid->load) {
        return spari_fluid_refuse(fluid, SPAR_ERR_STATE, call,
                                  "it is not mapped yet; give its nodes and call spar_fluid_map first");
    }
    for (int k = 0; k < count; k++) {
        if (states[k][S_PARTS] != 0 && spari_parts_prepare(fluid) != SPAR_OK) {
            return spari_fluid_refuse(fluid, SPAR_ERR_MEMORY, call, "no memory for loads over parts of a step");
        }
    }
    if (fluid->load && fluid->member->session->reproducible && spari_fluid_make_bins(fluid) != SPAR_OK) {
        return spari_fluid_refuse(fluid, SPAR_ERR_MEMORY, call, "no memory for reproducible sums of its loads");
    }
    if (on && s && s->n > 0 && !kept) {
        return spari_fluid_refuse(
            fluid, SPAR_ERR_ARGUMENT, call,
            "node forces are asked for (SPAR_EFFECT_FLUID_HISTORY), and the saved run did not keep them");
    }
    if (!kept || !s) {
        return SPAR_OK;
    }
    SPARI_TRY(take_forces(fluid, call, count, states, NULL));
    if (!on || fluid->history->n != s->n) { /* not in use before all ranks can load */
        fluid->history_next = spari_history_create(s->n, fluid->member->session->predictor);
        if (!fluid->history_next) {
            return spari_fluid_refuse(fluid, SPAR_ERR_MEMORY, call, "no memory for the node forces");
        }
    }
    return SPAR_OK;
}

/* Ends of parts, a sum over the states; of a state without them, its loads. */
static void load_parts(spar_fluid *fluid, int count, const double *const *states, int takes_loads) {
    spari_parts *p = fluid->parts;
    if (!p) {
        return;
    }
    int64_t n = 6 * fluid->member->nodes;
    int have = 0;
    for (int k = 0; k < count; k++) {
        have |= (int)states[k][S_PARTS];
    }
    p->ended = (have & PARTS_BEFORE) != 0;
    p->theta = have & PARTS_NOW ? 1 : 0;
    p->plain = 0;
    for (int which = 0; which < 2; which++) {
        memset(p->end[which], 0, (size_t)n * sizeof(double));
        for (int k = 0; k < count && takes_loads; k++) {
            const double *load = states[k] + S_HEAD + (which == 0 ? n : 0);
            const double *end = (int)states[k][S_PARTS] & (which == 0 ? PARTS_BEFORE : PARTS_NOW)
                                    ? states[k] + S_HEAD + state_pair(fluid, states[k]) + which * n
                                    : load;
            for (int64_t i = 0; i < n && states[k][S_MAPPED] != 0; i++) {
                p->end[which][i] = k > 0 ? p->end[which][i] + end[i] : end[i];
            }
        }
    }
}

/* The sum of the states' loads, as they were summed then. */
static void load_bins(spar_fluid *fluid, int count, const double *const *states) {
    double *value[2] = {fluid->load, fluid->load_accepted};
    for (int which = 0; which < 2; which++) {
        for (int64_t i = 0; i < 6 * fluid->member->nodes; i++) {
            spari_bins sum = {0}, add;
            for (int k = 0; k < count; k++) {
                if (states[k][S_MAPPED] == HAS_BINS) {
                    state_bins(fluid, states[k], which, i, &add);
                    spari_bins_merge(&sum, &add);
                } else if (states[k][S_MAPPED] != 0) {
                    spari_bins_add(&sum, states[k][S_HEAD + which * 6 * fluid->member->nodes + i]);
                }
            }
            value[which][i] = spari_bins_value(&sum);
            fluid->bins[2 * which][i] = sum;
        }
    }
}

void spari_fluid_load(spar_fluid *fluid, int count, const double *const *states, int takes_loads) {
    const spari_nodes *s = spari_fluid_set(fluid, SPAR_NODES_FORCE)->nodes;
    size_t loads = fluid->load ? 6 * (size_t)fluid->member->nodes : 0;
    int kept = 0, taken = 0;
    fluid->pushes = 0;
    spari_fluid_forget_refusal(fluid);
    load_parts(fluid, count, states, takes_loads);
    if (fluid->history_next) {
        spari_history_free(fluid->history);
        fluid->history = fluid->history_next, fluid->history_next = NULL;
    }
    spari_history *h = fluid->history;
    if (h) {
        h->pushed = 0;
    }
    if (fluid->load) {
        memset(fluid->load, 0, loads * sizeof *fluid->load);
        memset(fluid->load_accepted, 0, loads * sizeof *fluid->load);
    }
    for (int k = 0; k < count; k++) {
        const double *load = states[k] + S_HEAD;
        fluid->pushes += (int64_t)states[k][S_PUSHES];
        if (h) {
            h->pushed |= states[k][S_PUSHED] != 0;
        }
        kept |= states[k][S_KEPT] != 0;
        memcpy(fluid->audit, states[k] + S_AUDIT, sizeof fluid->audit);
        int gives = takes_loads && fluid->load && !fluid->bins[0] && states[k][S_MAPPED] != 0;
        for (size_t i = 0; gives && i < loads; i++) { /* the first as it is: 0 + -0 is not -0 */
            fluid->load[i] = taken ? fluid->load[i] + load[i] : load[i];
            fluid->load_accepted[i] = taken ? fluid->load_accepted[i] + load[loads + i] : load[loads + i];
        }
        taken |= gives;
    }
    if (fluid->bins[0]) {
        load_bins(fluid, takes_loads ? count : 0, states);
    }
    if (kept && s) {
        (void)take_forces(fluid, __func__, count, states, h); /* what can be missing was looked for before */
    }
}
