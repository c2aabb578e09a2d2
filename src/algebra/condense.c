/* Static condensation of a member to its interface nodes: see condense.h. */
#include "condense.h"

#include "../base/status.h"

#include <string.h>

spari_condensed *spari_condensed_create(int ends, const int *node, int unknowns) {
    spari_condensed *c = spari_zalloc(1, sizeof *c);
    int64_t m = 6 * (int64_t)ends;
    int first = 0, last = unknowns / 6;
    if (!c) {
        return NULL;
    }
    while (first < ends && node[first] == first) {
        first++;
    }
    for (int k = ends - 1; k >= 0 && node[k] == last - 1; k--) {
        last--;
    }
    c->first = 6 * first, c->length = last > first ? 6 * (last - first) : 0;
    c->ends = ends, c->n = unknowns;
    c->node = spari_zalloc(ends, sizeof *c->node);
    if (c->node) {
        memcpy(c->node, node, (size_t)ends * sizeof *node);
    }
    c->W = spari_zalloc(spari_condensed_state_size(c) + 1, sizeof *c->W);
    c->rows = c->W + m * c->length;
    c->K = c->rows + m * c->length;
    c->end_values = spari_zalloc(m, sizeof *c->end_values);
    c->row = spari_zalloc(unknowns, sizeof *c->row);
    c->column = spari_zalloc(unknowns, sizeof *c->column);
    if (!c->node || !c->W || !c->end_values || !c->row || !c->column) {
        spari_condensed_free(c);
        return NULL;
    }
    return c;
}

void spari_condensed_free(spari_condensed *c) {
    if (c) {
        SPARI_FREE(c->node, c->W, c->end_values, c->row, c->column, c);
    }
}

/* Unknown of the member for unknown j of the interface nodes */
static int unknown_of(const spari_condensed *c, int j) {
    return 6 * c->node[j / 6] + j % 6;
}

static int is_fixed(const spari_condensed *c, int unknown) {
    return unknown < c->fixed;
}

void spari_condensed_take(spari_condensed *c, spari_linear *tangent, int fixed) {
    int m = 6 * c->ends;
    const size_t length = (size_t)c->length;
    c->fixed = fixed;
    for (int j = 0; j < m; j++) {
        double *row = c->rows + length * (size_t)j, *column = c->W + length * (size_t)j;
        spari_linear_read(tangent, unknown_of(c, j), c->row, c->column);
        for (int k = 0; k < m; k++) {
            int u = unknown_of(c, k), out = is_fixed(c, u) || is_fixed(c, unknown_of(c, j));
            c->K[m * j + k] = out ? k == j : c->row[u];
            c->row[u] = c->column[u] = 0;
        }
        if (is_fixed(c, unknown_of(c, j))) {
            memset(row, 0, length * sizeof *row);
            memset(column, 0, length * sizeof *column);
            continue;
        }
        memcpy(row, c->row + c->first, length * sizeof *row);
        memcpy(column, c->column + c->first, length * sizeof *column);
        for (int i = c->first; i < fixed && i < c->first + c->length; i++) {
            row[i - c->first] = column[i - c->first] = 0;
        }
    }
    for (int j = 0; j < m; j++) {
        spari_linear_fix(tangent, unknown_of(c, j));
    }
}

int spari_condensed_form(spari_condensed *c, spari_linear *factors) {
    int m = 6 * c->ends;
    const size_t length = (size_t)c->length;
    for (int k = 0; k < m && length > 0; k++) {
        double *column = c->W + length * (size_t)k;
        memset(c->column, 0, (size_t)c->n * sizeof *column);
        memcpy(c->column + c->first, column, length * sizeof *column);
        if (spari_linear_solve(factors, c->column)) {
            return 1;
        }
        memcpy(column, c->column + c->first, length * sizeof *column);
        memset(c->end_values, 0, (size_t)m * sizeof *c->end_values);
        spari_linear_add_rows(c->length, m, c->rows, -1, column, c->end_values);
        for (int j = 0; j < m; j++) {
            c->K[m * j + k] += c->end_values[j];
        }
    }
    return spari_first_nonfinite(c->K, (int64_t)m * m) >= 0;
}

int spari_condensed_reduce(const spari_condensed *c, spari_linear *factors, double *r) {
    int m = 6 * c->ends;
    for (int j = 0; j < m; j++) {
        int u = unknown_of(c, j);
        c->end_values[j] = is_fixed(c, u) ? 0 : r[u];
        r[u] = 0;
    }
    if (c->length > 0) {
        if (spari_linear_solve(factors, r)) {
            return 1;
        }
        spari_linear_add_rows(c->length, m, c->rows, -1, r + c->first, c->end_values);
    }
    for (int j = 0; j < m; j++) {
        r[unknown_of(c, j)] = c->end_values[j];
    }
    return 0;
}

void spari_condensed_expand(const spari_condensed *c, double *x) {
    int m = 6 * c->ends;
    for (int j = 0; j < m; j++) {
        c->end_values[j] = x[unknown_of(c, j)];
    }
    if (c->length > 0) {
        spari_linear_less_columns(c->length, m, c->W, c->end_values, x + c->first);
    }
}

int64_t spari_condensed_state_size(const spari_condensed *c) {
    int64_t m = 6 * (int64_t)c->ends;
    return m * (2 * (int64_t)c->length + m);
}

void spari_condensed_save(const spari_condensed *c, double *state) {
    spari_give(state, c->W, spari_condensed_state_size(c));
}

void spari_condensed_load(spari_condensed *c, int fixed, const double *state) {
    c->fixed = fixed;
    spari_give(c->W, state, spari_condensed_state_size(c));
}
