/* State of an accelerator as doubles, for save and load. The same code counts, writes and reads. */
#include "quasi_newton.h"

#include "../base/status.h"

#include <limits.h>
#include <math.h>
#include <string.h>

typedef struct state_passage {
    enum { COUNT, SAVE, LOAD } job;
    double *state;
    int64_t at, size; /* next number, and how many a state to load has */
    int bad;          /* a number that was read is not what it must be */
} state_passage;

static void pass_reals(state_passage *t, double *x, int64_t n) {
    t->bad |= t->job == LOAD && n > t->size - t->at;
    if (t->bad || n <= 0) {
        return;
    }
    if (t->job != COUNT) {
        double *there = t->state + t->at;
        memcpy(t->job == LOAD ? x : there, t->job == LOAD ? there : x, (size_t)n * sizeof *x);
    }
    t->at += n;
}

static void pass_finite(state_passage *t, double *x) {
    pass_reals(t, x, 1);
    t->bad |= t->job == LOAD && !isfinite(*x);
}

/* A whole number from 0 to below `end` */
static void pass_whole(state_passage *t, int *x, double end) {
    double number = *x;
    pass_reals(t, &number, 1);
    t->bad |= t->job == LOAD && !(number >= 0 && number < end && number == floor(number));
    if (t->job == LOAD && !t->bad) {
        *x = (int)number;
    }
}

/* A count, also beyond an int. */
static void pass_large(state_passage *t, int64_t *x) {
    double number = (double)*x;
    pass_reals(t, &number, 1);
    t->bad |= t->job == LOAD && !spari_is_count(number);
    if (t->job == LOAD && !t->bad) {
        *x = (int64_t)number;
    }
}

static void pass_ratios(state_passage *t, spari_ratios *r) {
    pass_reals(t, &r->weight, 1);
    pass_reals(t, &r->square, 1);
    pass_reals(t, &r->sum, 1);
    pass_reals(t, &r->sum2, 1);
}

static void pass_memory(state_passage *t, const spari_accelerator *a, spari_recollection *m) {
    enum { MEMORY = sizeof *m / sizeof(double) };
    double words[MEMORY];
    memcpy(words, m, sizeof words);
    pass_reals(t, words, MEMORY);
    memcpy(m, words, sizeof words);
    int sound = m->contradiction >= 0 && m->contradiction <= 1 && m->rho >= 0 && m->rho < 1 && m->scatter >= 0 &&
                m->scatter <= 1 && spari_first_nonfinite(&m->told.pairs, 5) < 0;
    t->bad |= t->job == LOAD && !(sound && (a->secants || (m->contradiction == 0 && m->rho == 0)));
}

static void pass_head(state_passage *t, spari_accelerator *a, int *occupied) {
    const int with_images = a->set.imaged ? 2 : 1, with_secants = a->secants ? 2 : 1;
    int64_t n = a->n;
    pass_large(t, &n);
    t->bad |= n != a->n;
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
    pass_whole(t, &a->begun.imaged, with_images);
    pass_ratios(t, &a->begun.ratios);
}

/* A column: that of slot s, or the next in the state. Without images it has the first two vectors. Each has a slot of
   its own, and none of this step is out of use. */
static void pass_column(state_passage *t, const spari_accelerator *a, int s) {
    spari_difference c = a->column[s];
    int state = (int)c.state;
    pass_whole(t, &s, a->slots);
    pass_whole(t, &state, SPARI_DROPPED + 1.0);
    pass_large(t, &c.step);
    pass_large(t, &c.serial);
    pass_reals(t, &c.dt, 1);
    pass_whole(t, &c.led, a->secants ? 2 : 1);
    c.state = (spari_difference_state)state;
    t->bad |= t->job == LOAD && (a->column[s].state != SPARI_FREE || c.state == SPARI_FREE || c.step > a->step ||
                                 (c.step == a->step && c.state != SPARI_LIVE));
    if (t->job == LOAD && !t->bad) {
        a->column[s] = c;
    }
    double *const vector[6] = {spari_slot_v(a, s),  spari_slot_w(a, s), spari_slot_iv(a, s),
                               spari_slot_iw(a, s), spari_slot_b(a, s), spari_slot_ib(a, s)};
    for (int k = 0; k < (a->set.imaged ? 6 : 2); k++) {
        pass_reals(t, vector[k], a->n);
    }
}

/* All columns in use. Neither those of this step nor the older ones are more than allowed. */
static void pass_columns(state_passage *t, const spari_accelerator *a, int occupied) {
    int of_step = 0;
    for (int s = 0; s < a->slots && t->job == LOAD; s++) {
        a->column[s].state = SPARI_FREE;
    }
    for (int k = 0, s = 0; k < occupied && !t->bad; k++, s++) {
        while (t->job != LOAD && a->column[s].state == SPARI_FREE) {
            s++;
        }
        pass_column(t, a, s);
    }
    for (int s = 0; s < a->slots; s++) {
        of_step += a->column[s].state != SPARI_FREE && a->column[s].step == a->step;
    }
    t->bad |= t->job == LOAD && (of_step > a->set.columns || occupied - of_step > a->set.columns);
}

/* Length of the snapshot of images (quasi_newton.c) that begins with the next number; -1: it is none. */
static int64_t images_before(const state_passage *t, const spari_accelerator *a) {
    const double *from = t->state + t->at + SPARI_SNAPSHOT_HEAD;
    int64_t length = a->slots;
    if (!a->set.imaged || t->size - t->at - SPARI_SNAPSHOT_HEAD < length) {
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

/* For a reject: images from the beginning of the step. */
static void pass_snapshot(state_passage *t, spari_accelerator *a) {
    double *there = t->job == COUNT ? NULL : t->state + t->at;
    if (t->job == SAVE) {
        spari_snapshot_save(&a->before, there);
    } else if (t->job == LOAD) {
        t->bad |= t->bad || !spari_snapshot_is(there, t->size - t->at, images_before(t, a));
        spari_snapshot_close(&a->before);
        if (!t->bad) {
            spari_snapshot_load(&a->before, there, 1);
        }
    }
    t->at += spari_snapshot_size(&a->before);
}

/* a: a copy, unless a state is loaded. */
static void pass_scheme_state(state_passage *t, spari_accelerator *a) {
    int occupied = 0;
    for (int s = 0; s < a->slots; s++) {
        occupied += a->column[s].state != SPARI_FREE;
    }
    pass_head(t, a, &occupied);
    pass_reals(t, a->x, a->n);
    pass_reals(t, a->g, a->n);
    pass_reals(t, a->image, a->set.imaged ? 2 * a->n : 0);
    pass_reals(t, a->lead, a->secants ? 2 * a->n : 0);
    pass_reals(t, a->last, a->secants ? a->n : 0);
    pass_columns(t, a, occupied);
    for (int j = 0; j < a->used; j++) {
        pass_whole(t, a->order + j, a->slots);
    }
    pass_snapshot(t, a);
}

int64_t spari_accelerator_state_size(const spari_accelerator *a) {
    state_passage t = {.job = COUNT};
    spari_accelerator own = *a;
    pass_scheme_state(&t, &own);
    return t.at;
}

void spari_accelerator_save(const spari_accelerator *a, double *state) {
    state_passage t = {.job = SAVE, .state = state};
    spari_accelerator own = *a;
    pass_scheme_state(&t, &own);
}

int spari_accelerator_load(spari_accelerator *a, const double *state, int64_t count) {
    state_passage t = {.job = LOAD, .state = (double *)(uintptr_t)state, .size = count};
    pass_scheme_state(&t, a);
    const int used = t.bad ? 0 : a->used;
    a->used = 0;
    for (int j = 0; j < used; j++) { /* in the original order: the same bits */
        (void)spari_differences_append(a, a->order[j], 0);
    }
    return !t.bad;
}
