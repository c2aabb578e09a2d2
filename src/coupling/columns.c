/* Difference columns of the quasi-Newton schemes: newest first, those of accepted steps and of the present one. */
#include "accelerator_data.h"

#include <string.h>

static int first_free_slot(const spari_accelerator *a) {
    int slot = 0;
    for (int j = 0; j < a->count; j++) { /* restarts whenever the slot is taken: there are few columns */
        if (a->column[j].slot == slot) {
            slot++;
            j = -1;
        }
    }
    return slot;
}

/* Columns of the present step; they come first. */
static int count_of_step(const spari_accelerator *a) {
    int k = 0;
    while (k < a->count && a->column[k].step == a->step) {
        k++;
    }
    return k;
}

static spari_column_kind kind_of(const spari_accelerator *a) {
    return !a->imaged ? SPARI_OF_LOADS : a->drifts ? SPARI_OF_RESPONSE : SPARI_OF_MOTION;
}

static void remove_column(spari_accelerator *a, int j) {
    a->count--;
    memmove(a->column + j, a->column + j + 1, (size_t)(a->count - j) * sizeof *a->column);
}

int spari_column_add(spari_accelerator *a) {
    int of_step = count_of_step(a);
    if (of_step == a->set.columns) {
        remove_column(a, of_step - 1);
    }
    spari_column c = {a->step, a->dt, {0}, (int)kind_of(a), a->imaged && a->led, first_free_slot(a)};
    memcpy(c.per, a->per, sizeof c.per);
    memmove(a->column + 1, a->column, (size_t)a->count * sizeof *a->column);
    a->column[0] = c;
    a->count++;
    return c.slot;
}

int spari_column_serves(const spari_accelerator *a, int j) {
    /* Twice as long or half as long secants save evaluations; where a step is halved again and again, those of the long
       steps slow its iteration down (host_amr_wind_coarse). */
    static const double MOST = 2.5;
    const spari_column *c = a->column + j;
    const int own = !a->imaged || a->memory.quantity == SPARI_OWN_STEPS;
    return c->kind == (int)kind_of(a) &&
           (own ? fabs(c->dt - a->dt) <= 0.1 * a->dt : c->dt <= MOST * a->dt && a->dt <= MOST * c->dt);
}

double spari_column_scale(const spari_accelerator *a, int j) {
    return a->memory.quantity == SPARI_OWN_STEPS ? 1
                                                 : a->column[j].per[a->memory.quantity] / a->per[a->memory.quantity];
}

void spari_columns_accept(spari_accelerator *a) {
    while (a->count > 0 && (a->count > a->set.columns || a->step - a->column[a->count - 1].step >= a->set.reuse)) {
        a->count--;
    }
}

void spari_columns_reject(spari_accelerator *a) {
    int of_step = count_of_step(a);
    a->count -= of_step;
    memmove(a->column, a->column + of_step, (size_t)a->count * sizeof *a->column);
}

int spari_orthonormalise(int64_t n, int k, double filter, double *q, double *r) {
    double *v = q + k * n, whole = sqrt(spari_sum_products(v, v, n));
    memset(r, 0, (size_t)k * sizeof *r);
    for (int pass = 0; pass < 2; pass++) {
        for (int j = 0; j < k; j++) {
            double part = spari_sum_products(q + j * n, v, n);
            r[j] += part;
            spari_axpy(-part, q + j * n, v, n);
        }
    }
    r[k] = sqrt(spari_sum_products(v, v, n));
    if (!(r[k] > filter * whole) || !isfinite(r[k])) {
        return 0;
    }
    for (int64_t i = 0; i < n; i++) {
        v[i] /= r[k];
    }
    return 1;
}

int spari_back_substitute(int k, const double *R, int stride, double *alpha) {
    int finite = 1;
    for (int j = k - 1; j >= 0; j--) {
        const double *r = R + (int64_t)j * stride;
        alpha[j] /= r[j];
        finite = finite && isfinite(alpha[j]);
        for (int i = 0; i < j; i++) {
            alpha[i] -= r[i] * alpha[j];
        }
    }
    return finite;
}
