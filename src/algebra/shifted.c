/* Shifted symmetric matrices with constraints: see shifted.h. A constraint group (the rows of a joint) is a block of
   multipliers. A pivot block of multipliers is regular if it follows a block of unknowns that no later group touches
   and in which its rows are independent. Most joints have such a block, as the end of a beam: their rows are then
   independent of all others without a test. Only the remaining groups, which close loops, are orthogonalised. They
   follow both of their blocks. */
#include "shifted.h"

#include "../base/status.h"
#include "dense.h"
#include "inertia.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* dependent_row: a row of G is dependent if its remainder is smaller than this, as in redundant.c.
   independent_in_block: the same limit for the rows of a group in its own block. */
static const double dependent_row = 1e-9, independent_in_block = 1e-6;
enum { MOST_IN_BLOCK = 6 };

void spari_shifted_free(spari_shifted *a) {
    SPARI_FREE(a->begin, a->column, a->k, a->g, a->group, a->x);
    spari_blocks_free(a->matrix);
    *a = (spari_shifted){0};
}

/* ---- K and M by rows ---- */

/* Adds up repeated entries of each row. at [n]: workspace */
static void add_repeated(spari_shifted *a, int64_t *at) {
    int64_t to = 0;
    for (int i = 0; i < a->n; i++) {
        at[i] = -1;
    }
    for (int i = 0; i < a->n; i++) {
        int64_t from = a->begin[i], first = to;
        for (int64_t e = from; e < a->begin[i + 1]; e++) {
            int j = a->column[e];
            double k = a->k[e], m = a->m[e];
            if (at[j] < first) {
                at[j] = to++;
                a->column[at[j]] = j;
                a->k[at[j]] = a->m[at[j]] = 0;
            }
            a->k[at[j]] += k;
            a->m[at[j]] += m;
        }
        a->begin[i] = first;
    }
    a->begin[a->n] = to;
}

static int read_matrices(spari_shifted *a, const spari_pencil *p) {
    int64_t *at = spari_zalloc((int64_t)a->n + 1, sizeof *at);
    a->begin = spari_zalloc((int64_t)a->n + 2, sizeof *a->begin);
    a->column = spari_zalloc(p->entries + 1, sizeof *a->column);
    a->k = spari_zalloc(2 * p->entries + 2, sizeof *a->k);
    if (!at || !a->begin || !a->column || !a->k) {
        free(at);
        return SPAR_ERR_MEMORY;
    }
    a->m = a->k + p->entries + 1;
    for (int64_t e = 0; e < p->entries; e++) {
        a->begin[p->entry[e].row + 1]++;
    }
    for (int i = 0; i < a->n; i++) {
        a->begin[i + 1] += a->begin[i];
        at[i] = a->begin[i];
    }
    for (int64_t e = 0; e < p->entries; e++) {
        int64_t to = at[p->entry[e].row]++;
        a->column[to] = p->entry[e].column;
        a->k[to] = p->entry[e].k;
        a->m[to] = p->entry[e].m;
    }
    add_repeated(a, at);
    free(at);
    for (int i = 0; i < a->n; i++) {
        for (int64_t e = a->begin[i]; e < a->begin[i + 1]; e++) {
            int massive = a->column[e] == i && a->m[e] > 0;
            a->highest = massive ? fmax(a->highest, fabs(a->k[e]) / a->m[e]) : a->highest;
        }
    }
    return SPAR_OK;
}

/* ---- constraints ---- */

typedef struct constraint_group {
    int block[2]; /* the least and the largest */
    int row, rows;
    int own; /* block in which its rows are independent and that no remaining group touches; -1: none */
} constraint_group;

typedef struct constraint_groups {
    const spari_pencil *p;
    int count;
    constraint_group *group;
    int64_t *begin; /* [constraints + 1] entries of each row, in `entry` */
    spari_pencil_constraint *entry;
    int *touched, *sum; /* [blocks] remaining groups that touch it: how many, and the sum of their numbers */
    int *queue, queued;
    char *kept; /* [constraints] rows that are independent */
} constraint_groups;

static int groups_create(constraint_groups *c, const spari_shifted *a, const spari_pencil *p) {
    *c = (constraint_groups){.p = p};
    c->group = spari_zalloc(p->constraints + 1, sizeof *c->group);
    c->begin = spari_zalloc((int64_t)p->constraints + 2, sizeof *c->begin);
    c->entry = spari_zalloc(p->constraint_entries + 1, sizeof *c->entry);
    c->touched = spari_zalloc(2 * (int64_t)a->blocks + 2, sizeof *c->touched);
    c->queue = spari_zalloc((int64_t)a->blocks + 2 * (int64_t)p->constraints + 1, sizeof *c->queue);
    c->kept = spari_zalloc(p->constraints + 1, sizeof *c->kept);
    if (!c->group || !c->begin || !c->entry || !c->touched || !c->queue || !c->kept) {
        return SPAR_ERR_MEMORY;
    }
    c->sum = c->touched + a->blocks + 1;
    for (int64_t e = 0; e < p->constraint_entries; e++) { /* position one row further on, until they are placed */
        c->begin[p->constraint[e].row + 2]++;
    }
    for (int r = 0; r < p->constraints; r++) {
        c->begin[r + 2] += c->begin[r + 1];
    }
    for (int64_t e = 0; e < p->constraint_entries; e++) {
        c->entry[c->begin[p->constraint[e].row + 1]++] = p->constraint[e];
    }
    return SPAR_OK;
}

/* Consecutive rows between the same blocks form a group. Rows without an entry belong to none. */
static void find_groups(constraint_groups *c, const spari_shifted *a) {
    for (int r = 0; r < c->p->constraints; r++) {
        constraint_group *last = c->group + c->count - 1, next = {{a->blocks, -1}, r, 1, -1};
        for (int64_t e = c->begin[r]; e < c->begin[r + 1]; e++) {
            int b = a->block[c->entry[e].column];
            next.block[0] = b < next.block[0] ? b : next.block[0];
            next.block[1] = b > next.block[1] ? b : next.block[1];
        }
        if (next.block[1] < 0) {
            continue;
        }
        if (c->count > 0 && last->row + last->rows == r && last->rows < MOST_IN_BLOCK &&
            last->block[0] == next.block[0] && last->block[1] == next.block[1]) {
            last->rows++;
        } else {
            c->group[c->count++] = next;
        }
    }
}

static void touch_block(constraint_groups *c, int b, int g, int by) {
    c->touched[b] += by;
    c->sum[b] += by * g;
    if (by < 0 && c->touched[b] == 1) {
        c->queue[c->queued++] = b;
    }
}

static void touch_blocks(constraint_groups *c, int g, int by) {
    const constraint_group *of = c->group + g;
    touch_block(c, of->block[0], g, by);
    if (of->block[1] != of->block[0]) {
        touch_block(c, of->block[1], g, by);
    }
}

/* Whether the rows of a group are independent in one of its blocks, which begins with unknown `first`. 0 or 1; -1: no
   memory. */
static int independent_in(const constraint_groups *c, const spari_shifted *a, const constraint_group *of, int b,
                          int first) {
    double G[MOST_IN_BLOCK * MOST_IN_BLOCK] = {0}, Q[1];
    int order[MOST_IN_BLOCK];
    for (int r = 0; r < of->rows; r++) {
        for (int64_t e = c->begin[of->row + r]; e < c->begin[of->row + r + 1]; e++) {
            int j = c->entry[e].column;
            if (a->block[j] == b) {
                G[MOST_IN_BLOCK * r + j - first] += c->entry[e].g;
            }
        }
    }
    int rank = spari_independent_rows(of->rows, MOST_IN_BLOCK, G, independent_in_block, order, 0, Q);
    return rank < 0 ? -1 : rank == of->rows;
}

/* Finds the groups with a block of their own, from the outer ends of the assembly inwards. */
static int find_own_blocks(constraint_groups *c, const spari_shifted *a, const int *first) {
    for (int g = 0; g < c->count; g++) {
        touch_blocks(c, g, 1);
    }
    for (int b = 0; b < a->blocks; b++) {
        if (c->touched[b] == 1) {
            c->queue[c->queued++] = b;
        }
    }
    for (int i = 0; i < c->queued; i++) {
        int b = c->queue[i], g = c->sum[b];
        if (c->touched[b] != 1) {
            continue;
        }
        int independent = independent_in(c, a, c->group + g, b, first[b]);
        if (independent < 0) {
            return SPAR_ERR_MEMORY;
        }
        if (independent) {
            c->group[g].own = b;
            memset(c->kept + c->group[g].row, 1, (size_t)c->group[g].rows);
            touch_blocks(c, g, -1);
        }
    }
    return SPAR_OK;
}

/* The independent rows of the groups without a block of their own, by orthogonalisation over the unknowns they touch.
   number, row: workspaces of the unknowns and of the rows */
static int find_loop_rows(constraint_groups *c, int *number, int *row) {
    int rows = 0, columns = 0;
    for (int g = 0; g < c->count; g++) {
        for (int r = c->group[g].row; c->group[g].own < 0 && r < c->group[g].row + c->group[g].rows; r++) {
            row[rows++] = r;
            for (int64_t e = c->begin[r]; e < c->begin[r + 1]; e++) {
                int *of = number + c->entry[e].column;
                *of = *of ? *of : ++columns;
            }
        }
    }
    if (rows == 0) {
        return SPAR_OK;
    }
    double *G = spari_zalloc((int64_t)rows * columns, sizeof *G), Q[1];
    int *order = spari_zalloc(rows, sizeof *order), rank = -1;
    for (int i = 0; i < rows && G && order; i++) {
        for (int64_t e = c->begin[row[i]]; e < c->begin[row[i] + 1]; e++) {
            G[(int64_t)columns * i + number[c->entry[e].column] - 1] += c->entry[e].g;
        }
    }
    rank = G && order ? spari_independent_rows(rows, columns, G, dependent_row, order, 0, Q) : -1;
    for (int i = 0; i < rank; i++) {
        c->kept[row[order[i]]] = 1;
    }
    SPARI_FREE(G, order);
    return rank >= 0 ? SPAR_OK : SPAR_ERR_MEMORY;
}

/* ---- the matrix ---- */

typedef struct block_pattern {
    int n, *size;
    int64_t coupled_count, before_count;
    spari_block_pair *coupled, *before;
} block_pattern;

static void couple(block_pattern *t, int a, int b) {
    t->coupled[t->coupled_count++] = (spari_block_pair){a, b};
}

static void couple_unknowns(const spari_shifted *a, block_pattern *t, int *seen) {
    for (int i = 0; i < a->n; i++) {
        int b = a->block[i];
        for (int64_t e = a->begin[i]; e < a->begin[i + 1]; e++) {
            int other = a->block[a->column[e]];
            if (other < b && seen[other] != b + 1) {
                seen[other] = b + 1;
                couple(t, other, b);
            }
        }
    }
}

/* Blocks of multipliers: independent rows, their order of elimination, and their entries. */
static void add_multipliers(spari_shifted *a, const constraint_groups *c, block_pattern *t) {
    for (int g = 0; g < c->count; g++) {
        const constraint_group *of = c->group + g;
        int number = t->n, rows = 0;
        for (int r = of->row; r < of->row + of->rows; r++) {
            for (int64_t e = c->begin[r]; e < c->begin[r + 1] && c->kept[r]; e++) {
                a->g[a->entries++] = (spari_pencil_constraint){a->rank, c->entry[e].column, c->entry[e].g};
            }
            if (c->kept[r]) {
                a->group[a->rank++] = number;
                rows++;
            }
        }
        if (rows == 0) {
            continue;
        }
        t->size[t->n++] = rows;
        for (int side = 0; side < 2; side++) {
            couple(t, of->block[side], number);
            if (of->own < 0 || of->own == of->block[side]) {
                t->before[t->before_count++] = (spari_block_pair){of->block[side], number};
            }
        }
    }
}

static int make_matrix(spari_shifted *a, const constraint_groups *c) {
    int most = a->blocks + c->count + 1;
    block_pattern t = {.n = a->blocks, .size = spari_zalloc(most, sizeof *t.size)};
    int *seen = spari_zalloc(most, sizeof *seen);
    t.coupled = spari_zalloc(a->begin[a->n] + 2 * (int64_t)c->count + 1, sizeof *t.coupled);
    t.before = spari_zalloc(2 * (int64_t)c->count + 1, sizeof *t.before);
    a->g = spari_zalloc(c->p->constraint_entries + 1, sizeof *a->g);
    a->group = spari_zalloc(c->p->constraints + 1, sizeof *a->group);
    if (t.size && seen && t.coupled && t.before && a->g && a->group) {
        for (int i = 0; i < a->n; i++) {
            t.size[a->block[i]]++;
        }
        couple_unknowns(a, &t, seen);
        add_multipliers(a, c, &t);
        a->matrix = spari_blocks_create(t.n, t.size, NULL, t.coupled_count, t.coupled, t.before_count, t.before);
        a->x = spari_zalloc((int64_t)a->n + a->rank + 1, sizeof *a->x);
    }
    SPARI_FREE(t.size, seen, t.coupled, t.before);
    if (!a->matrix || !a->x) {
        return SPAR_ERR_MEMORY;
    }
    spari_blocks_watch(a->matrix, 1);
    return SPAR_OK;
}

int spari_shifted_create(spari_shifted *a, const spari_pencil *p, const int *block, int less, const double *W) {
    *a = (spari_shifted){.n = p->n, .block = block, .less = less, .W = W};
    a->blocks = p->n > 0 ? block[p->n - 1] + 1 : 0;
    constraint_groups c = {0};
    int *first = spari_zalloc((int64_t)a->blocks + p->n + p->constraints + 1, sizeof *first);
    int status = first ? read_matrices(a, p) : SPAR_ERR_MEMORY;
    status = status == SPAR_OK ? groups_create(&c, a, p) : status;
    if (status == SPAR_OK) {
        for (int i = p->n - 1; i >= 0; i--) {
            first[block[i]] = i;
        }
        find_groups(&c, a);
        status = find_own_blocks(&c, a, first);
        status = status == SPAR_OK ? find_loop_rows(&c, first + a->blocks, first + a->blocks + p->n) : status;
    }
    status = status == SPAR_OK ? make_matrix(a, &c) : status;
    SPARI_FREE(c.group, c.begin, c.entry, c.touched, c.queue, c.kept, first);
    return status;
}

/* Negative eigenvalues of K - s M + s W^T W beyond those of the factored K - s M: with the bordered matrix [K - s M,
   W^T; W, -1 / s], which has `less` negative ones more than the former, and those of its Schur complement. */
static int below_by_reduction(spari_shifted *a) {
    double S[MOST_IN_BLOCK * MOST_IN_BLOCK], s = -a->sigma;
    for (int i = 0; i < a->less && s != 0; i++) {
        memcpy(a->x, a->W + (int64_t)a->n * i, (size_t)a->n * sizeof *a->x);
        memset(a->x + a->n, 0, (size_t)a->rank * sizeof *a->x);
        (void)spari_blocks_solve(a->matrix, 1, a->x);
        for (int j = 0; j < a->less; j++) {
            double sum = i == j ? -1 / s : 0;
            for (int k = 0; k < a->n; k++) {
                sum -= a->W[(int64_t)a->n * j + k] * a->x[k];
            }
            S[a->less * i + j] = sum;
        }
    }
    return s != 0 && a->less > 0 ? spari_inertia_negative(a->less, S, a->less) - (s > 0 ? a->less : 0) : 0;
}

int spari_shifted_factor(spari_shifted *a, double sigma) {
    a->sigma = sigma;
    spari_blocks_zero(a->matrix);
    for (int i = 0; i < a->n; i++) {
        int last = -1, stride = 0;
        double *at = NULL;
        for (int64_t e = a->begin[i]; e < a->begin[i + 1]; e++) {
            int j = a->column[e], b = a->block[j];
            if (!at || b != last) {
                at = spari_blocks_at(a->matrix, a->block[i], b, &stride);
                last = b;
            }
            at[(i - spari_blocks_first(a->matrix, a->block[i])) * stride + j - spari_blocks_first(a->matrix, b)] +=
                a->k[e] + sigma * a->m[e];
        }
    }
    for (int64_t e = 0; e < a->entries; e++) {
        int g = a->group[a->g[e].row], b = a->block[a->g[e].column], stride;
        int row = a->n + a->g[e].row - spari_blocks_first(a->matrix, g);
        int column = a->g[e].column - spari_blocks_first(a->matrix, b);
        double *at = spari_blocks_at(a->matrix, g, b, &stride);
        at[row * stride + column] += a->g[e].g;
        at = spari_blocks_at(a->matrix, b, g, &stride);
        at[column * stride + row] += a->g[e].g;
    }
    int bad = spari_blocks_factor(a->matrix);
    a->below = bad ? -1 : spari_blocks_negative(a->matrix) - a->rank + below_by_reduction(a);
    return bad;
}

int spari_shifted_solve(spari_shifted *a, double *x) {
    memcpy(a->x, x, (size_t)a->n * sizeof *x);
    memset(a->x + a->n, 0, (size_t)a->rank * sizeof *x);
    int bad = spari_blocks_solve(a->matrix, 1, a->x);
    memcpy(x, a->x, (size_t)a->n * sizeof *x);
    return bad;
}

void spari_shifted_mass(const spari_shifted *a, const double *x, double *y) {
    for (int i = 0; i < a->n; i++) {
        double sum = 0;
        for (int64_t e = a->begin[i]; e < a->begin[i + 1]; e++) {
            sum += a->m[e] * x[a->column[e]];
        }
        y[i] = sum;
    }
    for (int l = 0; l < a->less; l++) {
        const double *w = a->W + (int64_t)a->n * l;
        double sum = 0;
        for (int i = 0; i < a->n; i++) {
            sum += w[i] * x[i];
        }
        for (int i = 0; i < a->n; i++) {
            y[i] -= sum * w[i];
        }
    }
}
