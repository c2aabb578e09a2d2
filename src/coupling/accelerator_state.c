/* State of an accelerator as doubles, for save and load. The same code counts, writes and reads. */
#include "accelerator_data.h"

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
    pass_finite(t, &m->rho);
    pass_finite(t, &m->reach);
    pass_finite(t, &m->off);
    pass_finite(t, &m->pairs);
    pass_finite(t, &m->ww);
    pass_finite(t, &m->wb);
    pass_finite(t, &m->bb);
    for (int i = 0; i < 2; i++) {
        pass_finite(t, m->surprise + i);
    }
    for (int i = 0; i <= SPARI_QUANTITIES; i++) {
        pass_finite(t, m->surprise_of + i);
    }
    pass_whole(t, &m->quantity, SPARI_QUANTITIES + 1.0);
    t->bad |= t->job == LOAD && !(m->rho >= 0 && m->rho < 1 && m->pairs >= 0 && (a->set.imaged || m->rho == 0));
}

static void pass_head(state_passage *t, spari_accelerator *a) {
    const int with_images = a->set.imaged ? 2 : 1;
    int64_t n = a->n;
    pass_large(t, &n);
    t->bad |= n != a->n;
    pass_large(t, &a->step);
    pass_whole(t, &a->iteration, INT_MAX);
    pass_whole(t, &a->stalled, INT_MAX);
    pass_whole(t, &a->filtered, INT_MAX);
    pass_whole(t, &a->used, (a->scheme->columns ? a->set.columns : 0) + 1.0);
    pass_reals(t, &a->dt, 1);
    pass_reals(t, a->per, SPARI_QUANTITIES);
    pass_reals(t, &a->ratio, 1);
    pass_reals(t, &a->omega, 1);
    pass_reals(t, &a->omega_accepted, 1);
    pass_reals(t, a->size, 2);
    pass_reals(t, a->weight, 2);
    pass_whole(t, &a->imaged, with_images);
    pass_whole(t, &a->drifts, with_images);
    pass_whole(t, &a->fixed, with_images);
    pass_whole(t, &a->led, with_images);
    pass_whole(t, &a->ended, with_images);
    pass_ratios(t, &a->ratios);
    pass_ratios(t, &a->ratios_before);
    pass_reals(t, &a->most_weight, 1);
    pass_finite(t, &a->turned);
    pass_finite(t, &a->cut);
    pass_finite(t, &a->before);
    pass_memory(t, a, &a->memory);
    pass_memory(t, a, &a->accepted.memory);
    pass_whole(t, &a->accepted.imaged, with_images);
    pass_whole(t, &a->accepted.drifts, with_images);
    pass_ratios(t, &a->accepted.ratios);
}

/* Column j, whose slot is j after a load. Those of the present step come first, and no step has more than allowed. */
static void pass_column(state_passage *t, spari_accelerator *a, int j) {
    spari_column *c = a->column + j, own = *c;
    pass_large(t, &own.step);
    pass_reals(t, &own.dt, 1);
    pass_reals(t, own.per, SPARI_QUANTITIES);
    pass_whole(t, &own.kind, a->set.imaged ? SPARI_OF_RESPONSE + 1.0 : 1);
    pass_whole(t, &own.led, a->set.imaged ? 2 : 1);
    if (t->job == LOAD) {
        own.slot = j;
        t->bad |= own.step > (j > 0 ? a->column[j - 1].step : a->step) ||
                  (j >= a->set.columns && own.step == a->column[j - a->set.columns].step);
        *c = own;
    }
    int64_t at = own.slot * a->n;
    pass_reals(t, a->p + at, a->n);
    pass_reals(t, a->y + at, a->n);
    pass_reals(t, a->b + at, own.led ? a->n : 0);
    pass_reals(t, a->axes + own.slot * (a->n / 6 * 4), own.kind != SPARI_OF_LOADS ? a->n / 6 * 4 : 0);
}

static void pass_scheme_state(state_passage *t, spari_accelerator *a) {
    pass_head(t, a);
    pass_reals(t, a->x, a->n);
    pass_reals(t, a->g, a->n);
    pass_reals(t, a->lead, a->led ? a->n : 0);
    pass_reals(t, a->last, a->ended ? a->n : 0);
    pass_reals(t, a->base, a->imaged && a->scheme->columns ? 2 * a->n : 0); /* other schemes have none */
    pass_whole(t, &a->count, (a->scheme->columns ? 2 * a->set.columns : 0) + 1.0);
    for (int j = 0; j < a->count && !t->bad; j++) {
        pass_column(t, a, j);
    }
    a->count = t->job == LOAD && t->bad ? 0 : a->count;
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
    return !t.bad;
}
