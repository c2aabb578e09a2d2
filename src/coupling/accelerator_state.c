/* State of an accelerator as doubles, for save and load. */
#include "quasi_newton.h"

#include "../base/status.h"

#include <limits.h>
#include <math.h>
#include <string.h>

enum { OWN = 34, MEMORY = sizeof(spari_recollection) / sizeof(double), HEAD = OWN + 2 * MEMORY, COLUMN_HEAD = 6 };

/* Vectors of length n per column. */
static int64_t of_column(const spari_accelerator *a) {
    return a->set.imaged ? 6 : 2;
}

/* Vectors of the iteration before: x and g, their images, the memory model. */
static int64_t of_iteration(const spari_accelerator *a) {
    return 2 + (a->set.imaged ? 2 : 0) + (a->secants ? 3 : 0);
}

static int occupied(const spari_accelerator *a) {
    int count = 0;
    for (int s = 0; s < a->slots; s++) {
        count += a->column[s].state != SPARI_FREE;
    }
    return count;
}

int64_t spari_accelerator_state_size(const spari_accelerator *a) {
    return HEAD + of_iteration(a) * a->n + occupied(a) * (COLUMN_HEAD + of_column(a) * a->n) + a->used;
}

/* The vectors of a column; without images the first two. */
static void column_vectors(const spari_accelerator *a, int s, double *vectors[6]) {
    double *const all[] = {spari_slot_v(a, s),  spari_slot_w(a, s), spari_slot_iv(a, s),
                           spari_slot_iw(a, s), spari_slot_b(a, s), spari_slot_ib(a, s)};
    memcpy(vectors, all, sizeof all);
}

/* Returns the position after it. */
static double *save_column(const spari_accelerator *a, int s, double *state) {
    const spari_difference *c = a->column + s;
    const double what[COLUMN_HEAD] = {s, c->state, (double)c->step, (double)c->serial, c->dt, c->led};
    double *vectors[6];
    column_vectors(a, s, vectors);
    memcpy(state, what, sizeof what);
    state += COLUMN_HEAD;
    for (int k = 0; k < of_column(a); k++, state += a->n) {
        memcpy(state, vectors[k], (size_t)a->n * sizeof *state);
    }
    return state;
}

static const double *load_column(spari_accelerator *a, const double *state) {
    int s = (int)state[0];
    double *vectors[6];
    a->column[s] = (spari_difference){(spari_difference_state)(int)state[1], (int64_t)state[2], (int64_t)state[3],
                                      state[4], (int)state[5]};
    column_vectors(a, s, vectors);
    state += COLUMN_HEAD;
    for (int k = 0; k < of_column(a); k++, state += a->n) {
        memcpy(vectors[k], state, (size_t)a->n * sizeof *state);
    }
    return state;
}

void spari_accelerator_save(const spari_accelerator *a, double *state) {
    const double own[OWN] = {(double)a->n,
                             (double)a->step,
                             (double)a->serial,
                             a->iteration,
                             a->dropped,
                             a->dt,
                             a->ratio,
                             a->omega,
                             a->omega_accepted,
                             a->size[0],
                             a->size[1],
                             a->weight[0],
                             a->weight[1],
                             occupied(a),
                             a->used,
                             a->imaged,
                             a->led,
                             a->ended,
                             a->residual_first,
                             a->residual_least,
                             a->rises,
                             a->ratios.weight,
                             a->ratios.square,
                             a->ratios.sum,
                             a->ratios.sum2,
                             a->ratios_before.weight,
                             a->ratios_before.square,
                             a->ratios_before.sum,
                             a->ratios_before.sum2,
                             a->most_weight,
                             a->renewed,
                             a->reach,
                             a->cut,
                             a->cut_residual};
    size_t bytes = (size_t)a->n * sizeof *state;
    memcpy(state, own, sizeof own);
    memcpy(state += OWN, &a->memory, sizeof a->memory);
    memcpy(state += MEMORY, &a->memory_accepted, sizeof a->memory);
    memcpy(state += MEMORY, a->x, bytes);
    memcpy(state += a->n, a->g, bytes);
    state += a->n;
    if (a->set.imaged) {
        memcpy(state, a->image, 2 * bytes);
        state += 2 * a->n;
    }
    if (a->secants) {
        memcpy(state, a->lead, 2 * bytes);
        memcpy(state + 2 * a->n, a->last, bytes);
        state += 3 * a->n;
    }
    for (int s = 0; s < a->slots; s++) {
        state = a->column[s].state == SPARI_FREE ? state : save_column(a, s, state);
    }
    for (int j = 0; j < a->used; j++) {
        state[j] = a->order[j];
    }
}

static int whole_below(double x, double end) {
    return x >= 0 && x < end && x == floor(x);
}

/* Whether columns are in distinct slots, and not more of this step or of older ones than allowed. */
static int are_columns(const spari_accelerator *a, const double *first, int64_t occupied, double step) {
    int64_t width = COLUMN_HEAD + of_column(a) * a->n, of_step = 0;
    for (int64_t k = 0; k < occupied; k++) {
        const double *c = first + k * width;
        int now = c[2] == step;
        of_step += now;
        if (!whole_below(c[0], a->slots) ||
            !(c[1] == SPARI_LIVE || (!now && (c[1] == SPARI_RESTING || c[1] == SPARI_DROPPED))) ||
            !whole_below(c[2], step + 1) || !spari_is_count(c[3]) || !whole_below(c[5], a->secants ? 2 : 1)) {
            return 0;
        }
        for (const double *other = first; other != c; other += width) {
            if (other[0] == c[0]) {
                return 0;
            }
        }
    }
    return of_step <= a->set.columns && occupied - of_step <= a->set.columns;
}

/* Whether this is a valid spari_recollection. */
static int is_memory(const spari_accelerator *a, const double *state) {
    spari_recollection m;
    memcpy(&m, state, sizeof m);
    int sound = m.contradiction >= 0 && m.contradiction <= 1 && m.rho >= 0 && m.rho < 1 && m.scatter >= 0 &&
                m.scatter <= 1 && spari_first_nonfinite(&m.told.pairs, 5) < 0;
    return sound && (a->secants || (m.contradiction == 0 && m.rho == 0));
}

static int is_accelerator_state(const spari_accelerator *a, const double *state, int64_t count) {
    if (count < HEAD || !spari_is_count(state[1]) || !spari_is_count(state[2]) || !whole_below(state[3], INT_MAX) ||
        !whole_below(state[4], INT_MAX) || state[0] != (double)a->n || !whole_below(state[13], a->slots + 1.0) ||
        !whole_below(state[14], (a->slots > 0 ? a->set.columns : 0) + 1.0)) {
        return 0;
    }
    int64_t occupied = (int64_t)state[13], used = (int64_t)state[14];
    if (count != HEAD + of_iteration(a) * a->n + occupied * (COLUMN_HEAD + of_column(a) * a->n) + used) {
        return 0;
    }
    if (spari_first_nonfinite(state + 31, 3) >= 0 || !whole_below(state[15], a->set.imaged ? 2 : 1) ||
        !whole_below(state[20], INT_MAX) || !whole_below(state[30], 2) || !is_memory(a, state + OWN) ||
        !is_memory(a, state + OWN + MEMORY) || !whole_below(state[16], a->secants ? 2 : 1) ||
        !whole_below(state[17], a->secants ? 2 : 1) ||
        !are_columns(a, state + HEAD + of_iteration(a) * a->n, occupied, state[1])) {
        return 0;
    }
    for (int64_t j = count - used; j < count; j++) {
        if (!whole_below(state[j], a->slots)) {
            return 0;
        }
    }
    return 1;
}

int spari_accelerator_load(spari_accelerator *a, const double *state, int64_t count) {
    if (!is_accelerator_state(a, state, count)) {
        return 0;
    }
    int occupied = (int)state[13], used = (int)state[14];
    size_t bytes = (size_t)a->n * sizeof *state;
    spari_snapshot_close(&a->before);
    a->step = (int64_t)state[1], a->serial = (int64_t)state[2];
    a->iteration = (int)state[3], a->dropped = (int)state[4];
    a->dt = state[5], a->ratio = state[6], a->omega = state[7], a->omega_accepted = state[8];
    memcpy(a->size, state + 9, sizeof a->size);
    memcpy(a->weight, state + 11, sizeof a->weight);
    a->imaged = (int)state[15], a->residual_first = state[18];
    a->led = (int)state[16], a->ended = (int)state[17];
    memcpy(&a->memory, state + OWN, sizeof a->memory);
    memcpy(&a->memory_accepted, state + OWN + MEMORY, sizeof a->memory);
    a->residual_least = state[19], a->rises = (int)state[20];
    a->ratios = (spari_ratios){state[21], state[22], state[23], state[24]};
    a->ratios_before = (spari_ratios){state[25], state[26], state[27], state[28]};
    a->most_weight = state[29];
    a->renewed = (int)state[30];
    a->reach = state[31], a->cut = state[32], a->cut_residual = state[33];
    memcpy(a->x, state += HEAD, bytes);
    memcpy(a->g, state += a->n, bytes);
    state += a->n;
    if (a->set.imaged) {
        memcpy(a->image, state, 2 * bytes);
        state += 2 * a->n;
    }
    if (a->secants) {
        memcpy(a->lead, state, 2 * bytes);
        memcpy(a->last, state + 2 * a->n, bytes);
        state += 3 * a->n;
    }
    for (int s = 0; s < a->slots; s++) {
        a->column[s].state = SPARI_FREE;
    }
    for (int k = 0; k < occupied; k++) {
        state = load_column(a, state);
    }
    a->used = 0;
    for (int j = 0; j < used; j++) { /* in the original order: the same bits */
        (void)spari_differences_append(a, (int)state[j], 0);
    }
    return 1;
}
