/* State of an accelerator as doubles, for save and load. The same code writes and reads, as in
   restart/common_state.c. */
#include "quasi_newton.h"

#include "../base/status.h"

#include <limits.h>
#include <math.h>
#include <string.h>

enum {
    OWN = 34,
    MEMORY = sizeof(spari_recollection) / sizeof(double),
    HEAD = OWN + 2 * MEMORY,
    COLUMN_HEAD = 6,
    BEGUN = 5
};

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
    return HEAD + of_iteration(a) * a->n + occupied(a) * (COLUMN_HEAD + of_column(a) * a->n) + a->used + BEGUN +
           spari_snapshot_size(&a->before);
}

static int whole_below(double x, double end) {
    return x >= 0 && x < end && x == floor(x);
}

typedef struct state_passage {
    double *at; /* next number of the state */
    int reads;
    int bad; /* a number that was read is not what it must be */
} state_passage;

static void pass_reals(state_passage *t, double *x, int64_t n) {
    if (n > 0) {
        memcpy(t->reads ? x : t->at, t->reads ? t->at : x, (size_t)n * sizeof *x);
    }
    t->at += n;
}

static void pass_finite(state_passage *t, double *x) {
    pass_reals(t, x, 1);
    t->bad |= !isfinite(*x);
}

/* A whole number from 0 to below `end` */
static void pass_whole(state_passage *t, int *x, double end) {
    double number = *x;
    pass_reals(t, &number, 1);
    t->bad |= t->reads && !whole_below(number, end);
    *x = t->bad ? *x : (int)number;
}

/* A count, also beyond an int. */
static void pass_large(state_passage *t, int64_t *x) {
    double number = (double)*x;
    pass_reals(t, &number, 1);
    t->bad |= t->reads && !spari_is_count(number);
    *x = t->bad ? *x : (int64_t)number;
}

static void pass_ratios(state_passage *t, spari_ratios *r) {
    pass_reals(t, &r->weight, 1);
    pass_reals(t, &r->square, 1);
    pass_reals(t, &r->sum, 1);
    pass_reals(t, &r->sum2, 1);
}

static void pass_memory(state_passage *t, const spari_accelerator *a, spari_recollection *m) {
    double words[MEMORY];
    memcpy(words, m, sizeof words);
    pass_reals(t, words, MEMORY);
    memcpy(m, words, sizeof words);
    int sound = m->contradiction >= 0 && m->contradiction <= 1 && m->rho >= 0 && m->rho < 1 && m->scatter >= 0 &&
                m->scatter <= 1 && spari_first_nonfinite(&m->told.pairs, 5) < 0;
    t->bad |= t->reads && !(sound && (a->secants || (m->contradiction == 0 && m->rho == 0)));
}

/* The head of a state, OWN numbers and the memory. */
static void pass_head(state_passage *t, spari_accelerator *a, int *occupied) {
    const int with_images = a->set.imaged ? 2 : 1, with_secants = a->secants ? 2 : 1;
    pass_large(t, &a->n);
    pass_large(t, &a->step);
    pass_large(t, &a->serial);
    pass_whole(t, &a->iteration, INT_MAX);
    pass_whole(t, &a->dropped, INT_MAX);
    pass_reals(t, &a->dt, 1);
    pass_reals(t, &a->ratio, 1);
    pass_reals(t, &a->omega, 1);
    pass_reals(t, &a->omega_accepted, 1);
    pass_reals(t, a->size, 2);
    pass_reals(t, a->weight, 2);
    pass_whole(t, occupied, a->slots + 1.0);
    pass_whole(t, &a->used, (a->slots > 0 ? a->set.columns : 0) + 1.0);
    pass_whole(t, &a->imaged, with_images);
    pass_whole(t, &a->led, with_secants);
    pass_whole(t, &a->ended, with_secants);
    pass_reals(t, &a->residual_first, 1);
    pass_reals(t, &a->residual_least, 1);
    pass_whole(t, &a->rises, INT_MAX);
    pass_ratios(t, &a->ratios);
    pass_ratios(t, &a->ratios_before);
    pass_reals(t, &a->most_weight, 1);
    pass_whole(t, &a->renewed, 2);
    pass_finite(t, &a->reach);
    pass_finite(t, &a->cut);
    pass_finite(t, &a->cut_residual);
    pass_memory(t, a, &a->memory);
    pass_memory(t, a, &a->memory_accepted);
}

/* Those of the iteration before. */
static void pass_vectors(state_passage *t, const spari_accelerator *a) {
    pass_reals(t, a->x, a->n);
    pass_reals(t, a->g, a->n);
    pass_reals(t, a->image, a->set.imaged ? 2 * a->n : 0);
    pass_reals(t, a->lead, a->secants ? 2 * a->n : 0);
    pass_reals(t, a->last, a->secants ? a->n : 0);
}

/* The column in slot s. Without images it has the first two vectors. */
static void pass_column(state_passage *t, const spari_accelerator *a, int s) {
    double *const vector[6] = {spari_slot_v(a, s),  spari_slot_w(a, s), spari_slot_iv(a, s),
                               spari_slot_iw(a, s), spari_slot_b(a, s), spari_slot_ib(a, s)};
    spari_difference *c = a->column + s;
    double what[COLUMN_HEAD] = {s, c->state, (double)c->step, (double)c->serial, c->dt, c->led};
    pass_reals(t, what, COLUMN_HEAD);
    if (t->reads) {
        *c = (spari_difference){(spari_difference_state)(int)what[1], (int64_t)what[2], (int64_t)what[3], what[4],
                                (int)what[5]};
    }
    for (int k = 0; k < of_column(a); k++) {
        pass_reals(t, vector[k], a->n);
    }
}

/* For a reject: the beginning of the step, BEGUN numbers. The images from then follow as a snapshot. */
static void pass_beginning(state_passage *t, spari_accelerator *a) {
    pass_whole(t, &a->begun.imaged, a->set.imaged ? 2 : 1);
    pass_ratios(t, &a->begun.ratios);
}

void spari_accelerator_save(const spari_accelerator *a, double *state) {
    state_passage t = {.at = state};
    spari_accelerator own = *a;
    int count = occupied(a);
    pass_head(&t, &own, &count);
    pass_vectors(&t, a);
    for (int s = 0; s < a->slots; s++) {
        if (a->column[s].state != SPARI_FREE) {
            pass_column(&t, a, s);
        }
    }
    for (int j = 0; j < a->used; j++) {
        *t.at++ = a->order[j];
    }
    pass_beginning(&t, &own);
    spari_snapshot_save(&a->before, t.at);
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

/* Length of a snapshot of images (quasi_newton.c), of which `count` numbers are there; -1: it is none. */
static int64_t images_before(const spari_accelerator *a, const double *from, int64_t count) {
    int64_t length = a->slots;
    if (!a->set.imaged || count < length) {
        return -1;
    }
    for (int s = 0; s < a->slots; s++) {
        if (from[s] != -1 && from[s] != 0 && from[s] != 1) {
            return -1;
        }
        length += from[s] < 0 ? 0 : (from[s] > 0 ? 4 : 2) * a->n;
    }
    return length;
}

int spari_accelerator_load(spari_accelerator *a, const double *state, int64_t count) {
    spari_accelerator then = *a;
    state_passage t = {.at = (double *)(uintptr_t)state, .reads = 1};
    int columns = 0;
    if (count < HEAD) {
        return 0;
    }
    pass_head(&t, &then, &columns);
    const int64_t n = a->n, first = HEAD + of_iteration(a) * n, used = then.used,
                  order = first + columns * (COLUMN_HEAD + of_column(a) * n), images = order + used + BEGUN,
                  left = count - images - SPARI_SNAPSHOT_HEAD;
    if (t.bad || then.n != n || left < 0 || !are_columns(a, state + first, columns, (double)then.step)) {
        return 0;
    }
    for (int64_t j = order; j < order + used; j++) {
        if (!whole_below(state[j], a->slots)) {
            return 0;
        }
    }
    t.at = (double *)(uintptr_t)state + order + used;
    pass_beginning(&t, &then);
    if (t.bad ||
        !spari_snapshot_is(t.at, left + SPARI_SNAPSHOT_HEAD, images_before(a, t.at + SPARI_SNAPSHOT_HEAD, left))) {
        return 0;
    }
    *a = then;
    t.at = (double *)(uintptr_t)state + HEAD;
    spari_snapshot_close(&a->before);
    pass_vectors(&t, a);
    for (int s = 0; s < a->slots; s++) {
        a->column[s].state = SPARI_FREE;
    }
    for (int k = 0; k < columns; k++) {
        pass_column(&t, a, (int)*t.at);
    }
    a->used = 0;
    for (int64_t j = 0; j < used; j++) { /* in the original order: the same bits */
        (void)spari_differences_append(a, (int)t.at[j], 0);
    }
    spari_snapshot_load(&a->before, state + images, 1);
    return 1;
}
