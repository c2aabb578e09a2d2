/* IQN-ILS in the load norm (Degroote, Bathe & Vierendeels 2009), with columns of earlier steps and the QR2 filter of
   Haelterman et al. (2016): newest columns first, each kept only if enough of it is linearly independent of those
   before. For structures whose flexibility the library does not know. */
#include "accelerator_data.h"

#include <string.h>

void spari_iqn_ils_learn(spari_accelerator *a) {
    int moved = 0;
    for (int64_t i = 0; i < a->n; i++) {
        moved |= a->change[i] != 0;
    }
    if (!moved) { /* the residual stalls: the column gives no information */
        a->stalled++;
        return;
    }
    int64_t at = spari_column_add(a) * a->n;
    memcpy(a->p + at, a->change, (size_t)a->n * sizeof *a->p);
    memcpy(a->y + at, a->change + a->n, (size_t)a->n * sizeof *a->y);
}

/* out = in, each entry divided by the size of its kind */
static void over_sizes(const spari_accelerator *a, const double *in, double *out) {
    for (int64_t i = 0; i < a->n; i += a->period) {
        for (int k = 0; k < a->period && i + k < a->n; k++) {
            out[i + k] = a->weight[k >= a->split] * in[i + k];
        }
    }
}

/* alpha := the least-squares solution of V alpha = -(g - x); a->slots: its columns. Returns whether it is
   finite. */
static int fit_columns(spari_accelerator *a, const double *x, const double *g) {
    int64_t n = a->n;
    a->used = a->filtered = 0;
    for (int j = 0; j < a->count && a->used < a->set.columns; j++) {
        if (spari_column_serves(a, j)) {
            double *r = a->matrix + (int64_t)a->used * a->set.columns;
            over_sizes(a, a->p + a->column[j].slot * n, a->basis + a->used * n);
            if (spari_orthonormalise(n, a->used, a->set.filter, a->basis, r)) {
                a->slots[a->used++] = a->column[j].slot;
            } else {
                a->filtered++;
            }
        }
    }
    for (int j = 0; j < a->used; j++) {
        const double *q = a->basis + j * n;
        double s[2] = {0, 0};
        for (int64_t i = 0; i < n; i += a->period) {
            for (int k = 0; k < a->period && i + k < n; k++) {
                s[k >= a->split] += q[i + k] * (g[i + k] - x[i + k]);
            }
        }
        a->alpha[j] = -(s[0] * a->weight[0] + s[1] * a->weight[1]);
    }
    return spari_back_substitute(a->used, a->matrix, a->set.columns, a->alpha);
}

/* next = g + W alpha */
int spari_iqn_ils_next(spari_accelerator *a, const double *x, const double *g, double *next) {
    if (!fit_columns(a, x, g) || a->used == 0) {
        return 0;
    }
    memcpy(next, g, (size_t)a->n * sizeof *next);
    for (int j = 0; j < a->used; j++) {
        spari_axpy(a->alpha[j], a->y + a->slots[j] * a->n, next, a->n);
    }
    return 1;
}
