/* Entries of the equations of small motions: see pencil.h. */
#include "pencil.h"

#include "../base/status.h"

#include <stdlib.h>

int spari_pencil_create(spari_pencil *p, int unknowns) {
    *p = (spari_pencil){.n = unknowns};
    p->left = spari_zalloc(unknowns, sizeof *p->left);
    return p->left ? SPAR_OK : SPAR_ERR_MEMORY;
}

void spari_pencil_free(spari_pencil *p) {
    SPARI_FREE(p->entry, p->constraint, p->left);
    *p = (spari_pencil){0};
}

/* Makes room for one more entry of `size` bytes; NULL: no memory. */
static void *grow_entries(void *array, int64_t count, int64_t *capacity, size_t size) {
    if (count < *capacity) {
        return array;
    }
    int64_t more = *capacity > 0 ? 2 * *capacity : 1024;
    void *grown = realloc(array, (size_t)more * size);
    *capacity = grown ? more : *capacity;
    return grown;
}

void spari_pencil_put(spari_pencil *p, spari_pencil_entry entry) {
    if (entry.k == 0 && entry.c == 0 && entry.m == 0) {
        return;
    }
    spari_pencil_entry *grown = grow_entries(p->entry, p->entries, &p->entry_capacity, sizeof *grown);
    p->full = p->full || !grown;
    if (grown) {
        p->entry = grown;
        p->entry[p->entries++] = entry;
    }
}

void spari_pencil_add_constraint(spari_pencil *p, spari_pencil_constraint entry) {
    if (entry.g == 0) {
        return;
    }
    spari_pencil_constraint *grown =
        grow_entries(p->constraint, p->constraint_entries, &p->constraint_capacity, sizeof *grown);
    p->full = p->full || !grown;
    if (grown) {
        p->constraint = grown;
        p->constraint[p->constraint_entries++] = entry;
    }
}

void spari_pencil_add(spari_pencil *p, int at, int n, int64_t apart, const double *K, const double *C,
                      const double *M) {
    for (int i = at < 0 ? -at : 0; i < n; i++) {
        for (int j = at < 0 ? -at : 0; j < n; j++) {
            int64_t k = apart * i + j;
            spari_pencil_entry e = {p->base + at + i, p->base + at + j, K ? K[k] : 0, C ? C[k] : 0, M ? M[k] : 0};
            spari_pencil_put(p, e);
        }
    }
}

void spari_pencil_add_symmetric(spari_pencil *p, int at, int n, const double *K, const double *M) {
    for (int i = at < 0 ? -at : 0; i < n; i++) {
        for (int j = at < 0 ? -at : 0; j < n; j++) {
            int64_t ij = (int64_t)n * i + j, ji = (int64_t)n * j + i;
            spari_pencil_entry e = {p->base + at + i, p->base + at + j, 0.5 * (K[ij] + K[ji]), 0,
                                    0.5 * (M[ij] + M[ji])};
            spari_pencil_put(p, e);
        }
    }
}

void spari_pencil_set_forces(spari_pencil *p, int at, int n, const double *r) {
    for (int i = at < 0 ? -at : 0; i < n; i++) {
        p->left[p->base + at + i] += r[i];
    }
}

void spari_pencil_times(const spari_pencil *p, int64_t first, double a, double b, double c, const double *x,
                        double *y) {
    for (int64_t i = first; i < p->entries; i++) {
        const spari_pencil_entry *e = p->entry + i;
        y[e->row] += (a * e->k + b * e->c + c * e->m) * x[e->column];
    }
}
