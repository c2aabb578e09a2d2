/* Dense and banded linear systems, assembled along a chain of elements: see linear.h. */
#include "linear.h"
#include "linear_kernels.h"

#include "../base/status.h"
#include "../base/thread_pool.h"
#include "../math/lanes.h"
#include "dense.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* So many elements, or boundaries of elements, are processed at a time. */
enum { ELEMENTS = 16, GATHERED = 128 };

/* At most this many constrained first unknowns of an element are removed from a dense matrix. */
enum { MOST_LEAD = 8 };

/* All memory is allocated at the beginning: nothing in a step allocates.

   Elements with many inner unknowns: these are eliminated element by element. A chain of the elements' ends remains,
   with blocks of 2 overlap. It has half the numbers of a band over all unknowns, and elements are independent. */
typedef struct linear_rows {
    double *block, *data; /* as allocated; from a cache line on */
    size_t rows, columns, step;
} linear_rows;

struct spari_linear {
    int elements, block, overlap; /* of the chain */
    size_t n, band;               /* unknowns; half bandwidth (banded storage) */
    linear_rows A;     /* dense n x n, column by column, or banded n x (3 band + 1): column by column, rows apart */
    int *swap;         /* dense, else NULL: row i went to swap[i] - 1, one after the other, as LAPACK says it */
    int *order;        /* dense: where row i came from by all of these */
    unsigned fixed;    /* dense, of one element: which of its first unknowns are eliminated */
    size_t lead;       /* dense: so many of them that stand in A no longer */
    size_t order_of;   /* dense: unknowns in A when it is factored */
    double *corners;   /* dense: [n / 8, rounded up][4][8][8]: solve_dense */
    double *y;         /* dense: [n, rounded up to eights] room */
    double *workspace; /* of the last two */
    int *band_swap;    /* banded */
    double moments;    /* spari_linear_weigh; 0: not asked for */
    double
        *weight; /* of rows, workspace: [n], or [elements][own] of a chain whose elements have unknowns to themselves */
    double *symmetric; /* spari_linear_watch; NULL: not asked for */
    /* of a chain whose elements have unknowns to themselves; else NULL, 0 */
    spari_linear *ends;             /* the chain without these */
    size_t own;                     /* how many in each */
    double *parts;                  /* [elements][block][block] column by column, first those, then the ends */
    int *part_swap;                 /* [elements][own] */
    double *z, *ends_x;             /* [elements][block], the ends of one at least; [ends->n] workspace */
    unsigned char *bad;             /* [elements / ELEMENTS, rounded up] workspace */
    spari_thread_pool *const *pool; /* spari_linear_share; NULL: no threads */
};

/* rows of `columns` numbers that are `step` apart, from a cache line on. */
static int alloc_rows(linear_rows *A, size_t rows, size_t columns, size_t step) {
    A->block = spari_zalloc((int64_t)(rows * step) + SPARI_CORNER, sizeof *A->block);
    if (A->block) {
        A->rows = rows, A->columns = columns, A->step = step;
        A->data = A->block + spari_to_line(A->block);
    }
    return A->block != NULL;
}

/* Allocates the matrix, whose size is known. */
static spari_linear *with_workspace(spari_linear *s, int dense) {
    if (dense) {
        int64_t n = (int64_t)s->n, eights = (n + SPARI_CORNER - 1) / SPARI_CORNER * SPARI_CORNER;
        (void)alloc_rows(&s->A, s->n, s->n, (size_t)eights);
        s->swap = spari_zalloc(2 * n, sizeof *s->swap);
        s->order = s->swap ? s->swap + n : NULL;
        s->workspace = spari_zalloc((SPARI_CORNERS * SPARI_CORNER + 1) * eights + SPARI_CORNER, sizeof *s->workspace);
        s->corners = s->workspace ? s->workspace + spari_to_line(s->workspace) : NULL;
        s->y = s->workspace ? s->corners + SPARI_CORNERS * SPARI_CORNER * eights : NULL;
    } else {
        (void)alloc_rows(&s->A, s->n, 3 * s->band + 1, 3 * s->band + 1);
        s->band_swap = spari_zalloc((int64_t)s->n, sizeof *s->band_swap);
    }
    if (!s->A.block || (dense ? !s->swap || !s->corners : !s->band_swap)) {
        spari_linear_free(s);
        return NULL;
    }
    return s;
}

/* The chain as the ends of its elements, which have interior unknowns. */
static spari_linear *with_parts(spari_linear *s) {
    int64_t m = s->block, count = s->elements;
    int block = s->block, overlap = s->overlap;
    s->own = (size_t)(block - 2 * overlap);
    s->ends = spari_linear_create(s->elements, 2 * overlap, overlap);
    s->parts = spari_zalloc(count * m * m, sizeof *s->parts);
    s->part_swap = spari_zalloc(count * (int64_t)s->own, sizeof *s->part_swap);
    int64_t corner = 4 * (int64_t)overlap * overlap;
    s->z = spari_zalloc(count * m > corner ? count * m : corner, sizeof *s->z);
    s->ends_x = s->ends ? spari_zalloc((int64_t)s->ends->n, sizeof *s->ends_x) : NULL;
    s->bad = spari_zalloc((count + ELEMENTS - 1) / ELEMENTS, sizeof *s->bad);
    if (!s->parts || !s->part_swap || !s->z || !s->ends_x || !s->bad) {
        spari_linear_free(s);
        return NULL;
    }
    return s;
}

spari_linear *spari_linear_create(int elements, int block, int overlap) {
    spari_linear *s = spari_zalloc(1, sizeof *s);
    if (!s) {
        return NULL;
    }
    s->elements = elements, s->block = block, s->overlap = overlap;
    s->n = (size_t)elements * (size_t)(block - overlap) + (size_t)overlap;
    s->band = (size_t)block - 1;
    if (elements > 1 && overlap > 0 && block >= 4 * overlap) { /* with fewer, the band of all unknowns is as cheap */
        return with_parts(s);
    }
    return with_workspace(s, elements == 1);
}

void spari_linear_free(spari_linear *s) {
    if (s) {
        spari_linear_free(s->ends);
        SPARI_FREE(s->parts, s->part_swap, s->z, s->ends_x, s->bad, s->A.block, s->swap, s->workspace, s->band_swap,
                   s->weight, s->symmetric, s);
    }
}

int spari_linear_weigh(spari_linear *s, double moments) {
    if (moments == 1) {
        return 0;
    }
    s->moments = moments;
    s->weight = s->weight ? s->weight
                          : spari_zalloc(s->ends ? s->elements * (int64_t)s->own : (int64_t)s->n, sizeof *s->weight);
    return !s->weight || (s->ends && spari_linear_weigh(s->ends, moments));
}

/* Weights of n rows from `weight` on, before any is exchanged; NULL if rows are compared as they are. */
static double *weights(const spari_linear *s, double *weight, size_t n) {
    for (size_t i = 0; i < n && s->weight; i++) {
        weight[i] = i % 6 < 3 ? 1 : s->moments;
    }
    return s->weight ? weight : NULL;
}

void spari_linear_share(spari_linear *s, spari_thread_pool *const *pool) {
    s->pool = pool;
}

void spari_linear_zero(spari_linear *s) {
    s->fixed = 0;
    if (s->ends) {
        memset(s->parts, 0, (size_t)s->elements * (size_t)(s->block * s->block) * sizeof *s->parts);
        return;
    }
    memset(s->A.data, 0, s->A.rows * s->A.step * sizeof *s->A.data);
}

/* Entry (i, j). Row j of the storage is column j of the matrix; banded storage has A(i, j) at 2 band + i - j. */
static double *entry(const spari_linear *s, size_t i, size_t j) {
    return s->A.data + j * s->A.step + (s->swap ? i : 2 * s->band + i - j);
}

/* Position of unknown i of an element in its matrix. */
static size_t stand(const spari_linear *s, size_t i) {
    size_t left = (size_t)s->overlap;
    return i < left ? i + s->own : i < left + s->own ? i - left : i;
}

/* Entry (i, j) of element e. */
static double *part_entry(const spari_linear *s, size_t e, size_t i, size_t j) {
    size_t m = (size_t)s->block;
    return s->parts + m * (m * e + stand(s, j)) + stand(s, i);
}

/* First and last element that unknown i belongs to. */
static void elements_of(const spari_linear *s, size_t i, size_t *first, size_t *last) {
    size_t step = (size_t)(s->block - s->overlap), e = i / step, end = (size_t)s->elements;
    *last = e < end ? e : end - 1;
    *first = e > 0 && i - e * step < (size_t)s->overlap ? e - 1 : *last;
}

static const spari_linear_kernels *kernels_here(void) {
    return spari_linear_kernels_for(8);
}

void spari_linear_add(spari_linear *s, int element, const double *S) {
    size_t m = (size_t)s->block, e = (size_t)element, first = e * (m - (size_t)s->overlap);
    for (size_t j = 0; j < m; j++) {
        double *column = s->ends ? s->parts + m * (m * e + stand(s, j)) : entry(s, first, first + j);
        SPARI_UNROLL
        for (size_t i = 0; i < m; i++) {
            column[s->ends ? stand(s, i) : i] += S[m * i + j];
        }
    }
}

/* Range [from, to) of unknowns that may have entries with unknown i in A. */
static void reach_of(const spari_linear *s, size_t i, size_t *from, size_t *to) {
    *from = !s->swap && i > s->band ? i - s->band : 0;
    *to = !s->swap && i + s->band + 1 < s->n ? i + s->band + 1 : s->n;
}

void spari_linear_read(const spari_linear *s, int i, double *row, double *column) {
    size_t at = (size_t)i, from, to, first = 0, last = 0, m = (size_t)s->block;
    memset(row, 0, s->n * sizeof *row);
    memset(column, 0, s->n * sizeof *column);
    if (s->ends) {
        elements_of(s, at, &first, &last);
        for (size_t e = first; e <= last; e++) {
            from = e * (m - (size_t)s->overlap);
            for (size_t j = 0; j < m; j++) {
                row[from + j] += *part_entry(s, e, at - from, j);
                column[from + j] += *part_entry(s, e, j, at - from);
            }
        }
        return;
    }
    reach_of(s, at, &from, &to);
    for (size_t j = from; j < to; j++) {
        row[j] = *entry(s, at, j);
        column[j] = *entry(s, j, at);
    }
}

void spari_linear_fix(spari_linear *s, int i) {
    size_t at = (size_t)i, from, to, first = 0, last = 0, m = (size_t)s->block;
    if (s->ends) {
        elements_of(s, at, &first, &last);
        for (size_t e = first; e <= last; e++) {
            size_t own = at - e * (m - (size_t)s->overlap);
            for (size_t j = 0; j < m; j++) {
                *part_entry(s, e, own, j) = *part_entry(s, e, j, own) = 0;
            }
            *part_entry(s, e, own, own) = e == first;
        }
        return;
    }
    reach_of(s, at, &from, &to);
    for (size_t j = from; j < to; j++) {
        *entry(s, at, j) = *entry(s, j, at) = 0;
    }
    *entry(s, at, at) = 1;
    s->fixed |= at < MOST_LEAD ? 1U << at : 0;
}

/* Unknowns of a dense matrix without its constrained first ones, padded to a multiple of eight, because solutions
   process eights faster than a remainder. 0: they stay. */
static size_t size_without_lead(const spari_linear *s) {
    const size_t lead = (size_t)s->overlap, left = s->n > lead ? s->n - lead : 0;
    const size_t eights = (left + SPARI_CORNER - 1) / SPARI_CORNER * SPARI_CORNER;
    return lead > 0 && lead <= MOST_LEAD && left > 0 && eights <= s->n ? eights : 0;
}

/* Removes constrained first unknowns from a dense matrix before it is factored; the others move to the front, and
   identity rows fill the rest. */
static void leave_out_lead(spari_linear *s) {
    const size_t lead = (size_t)s->overlap, step = s->A.step, eights = size_without_lead(s), left = s->n - lead;
    s->lead = 0, s->order_of = s->n;
    if (eights == 0 || ~s->fixed & ((1U << lead) - 1)) {
        return;
    }
    s->lead = lead, s->order_of = eights;
    for (size_t j = 0; j < eights; j++) {
        double *column = s->A.data + step * j;
        size_t own = j < left ? left : 0;
        memmove(column, column + (own ? (step + 1) * lead : 0), own * sizeof *column);
        memset(column + own, 0, (eights - own) * sizeof *column);
        column[j] = own ? column[j] : 1;
    }
}

/* Prepares what a dense solution needs beyond the factors. loaded: the factors were not computed here, where a part
   of it is done. */
static void ready_dense(spari_linear *s, int loaded) {
    double *corner = s->corners;
    const size_t n = s->order_of;
    for (size_t i = 0; i < n; i++) {
        s->order[i] = (int)i;
    }
    for (size_t i = 0; i < n; i++) {
        int there = s->order[s->swap[i] - 1];
        s->order[s->swap[i] - 1] = s->order[i];
        s->order[i] = there;
    }
    for (size_t j = 0; j < n; j += SPARI_CORNER, corner += SPARI_CORNERS * SPARI_CORNER * SPARI_CORNER) {
        kernels_here()->corner((int64_t)n, (int64_t)j, loaded, s->A.data, (int64_t)s->A.step, corner);
    }
}

static int factor_matrix(spari_linear *s) {
    /* before: a search for the largest of what are no numbers may answer anything */
    if (spari_first_nonfinite(s->A.data, (int64_t)(s->A.rows * s->A.step)) >= 0) {
        return 1;
    }
    int bad = 0;
    if (s->swap) {
        leave_out_lead(s);
        bad = kernels_here()->factor_dense((int64_t)s->order_of, (int64_t)s->order_of, s->A.data, (int64_t)s->A.step,
                                           s->swap, weights(s, s->weight, s->order_of), s->corners);
    } else {
        bad = kernels_here()->factor_band((int64_t)s->n, (int64_t)s->band, s->A.data, (int64_t)s->A.step, s->band_swap,
                                          weights(s, s->weight, s->n));
    }
    if (bad) {
        return 1;
    }
    for (size_t i = 0; i < (s->swap ? s->order_of : s->n); i++) {
        double pivot = fabs(*entry(s, i, i));
        if (!(pivot > 0) || !isfinite(pivot)) {
            return 1;
        }
    }
    if (s->swap) {
        ready_dense(s, 0);
    }
    return 0;
}

/* ---- element by element ---- */

/* Eliminates the interior unknowns of an element, which leaves the block of its ends. */
static int factor_element(const spari_linear *s, size_t e) {
    size_t m = (size_t)s->block;
    double *A = s->parts + m * m * e, *weight = weights(s, s->weight ? s->weight + s->own * e : NULL, s->own);
    if (spari_first_nonfinite(A, (int64_t)(m * m)) >= 0 ||
        kernels_here()->factor_dense((int64_t)m, (int64_t)s->own, A, (int64_t)m, s->part_swap + s->own * e, weight,
                                     NULL)) {
        return 1;
    }
    for (size_t i = 0; i < s->own; i++) {
        if (!isfinite(A[(m + 1) * i])) {
            return 1;
        }
    }
    return 0;
}

static void factor_elements(void *context, int64_t from, int64_t to) {
    const spari_linear *s = context;
    int bad = 0;
    for (int64_t e = from; e < to && !bad; e++) {
        bad = factor_element(s, (size_t)e);
    }
    s->bad[from / ELEMENTS] = bad != 0;
}

/* Distributes the elements over the threads. */
static void spread_elements(const spari_linear *s, spari_span work, void *context) {
    spari_thread_pool_spread(s->pool ? *s->pool : NULL, s->elements, ELEMENTS, work, context);
}

static int is_any_bad(const spari_linear *s) {
    unsigned char bad = 0;
    for (int k = 0; k < (s->elements + ELEMENTS - 1) / ELEMENTS; k++) {
        bad |= s->bad[k];
    }
    return bad;
}

static int factor_ends(spari_linear *s) {
    size_t m = (size_t)s->block, corner = 2 * (size_t)s->overlap;
    spari_linear_zero(s->ends);
    for (size_t e = 0; e < (size_t)s->elements; e++) {
        const double *A = s->parts + m * m * e + (m + 1) * s->own;
        double *S = s->z; /* row by row */
        for (size_t i = 0; i < corner; i++) {
            for (size_t j = 0; j < corner; j++) {
                S[corner * i + j] = A[m * j + i];
            }
        }
        spari_linear_add(s->ends, (int)e, S);
    }
    return spari_linear_factor(s->ends);
}

int spari_linear_factor(spari_linear *s) {
    if (s->ends) {
        spread_elements(s, factor_elements, s);
        return is_any_bad(s) || factor_ends(s);
    }
    return factor_matrix(s);
}

int spari_linear_sign(const spari_linear *s) {
    size_t m = (size_t)s->block, count = s->ends ? s->own * (size_t)s->elements : s->swap ? s->order_of : s->n;
    int sign = s->ends ? spari_linear_sign(s->ends) : 1;
    for (size_t k = 0; k < count; k++) {
        size_t i = s->ends ? k % s->own : k, e = s->ends ? k / s->own : 0;
        double pivot = s->ends ? s->parts[m * m * e + (m + 1) * i] : *entry(s, i, i);
        size_t from = (size_t)(s->ends ? s->part_swap[k] - 1 : s->swap ? s->swap[i] - 1 : s->band_swap[i]);
        sign = (pivot < 0) != (from != i) ? -sign : sign;
    }
    return sign;
}

int spari_linear_watch(spari_linear *s) {
    s->symmetric = s->symmetric ? s->symmetric
                                : spari_zalloc((int64_t)(s->n * (s->swap ? s->n : s->band + 1)), sizeof *s->symmetric);
    return s->symmetric ? 0 : 1;
}

void spari_linear_unwatch(spari_linear *s) {
    free(s->symmetric);
    s->symmetric = NULL;
}

/* Entry (i, j), in A or in elements. */
static double value_at(const spari_linear *s, size_t i, size_t j) {
    size_t first, last, of_first, of_last;
    if (!s->ends) {
        return *entry(s, i, j);
    }
    double sum = 0;
    elements_of(s, i, &first, &last);
    elements_of(s, j, &of_first, &of_last);
    for (size_t e = first > of_first ? first : of_first; e <= last && e <= of_last; e++) {
        size_t from = e * (size_t)(s->block - s->overlap);
        sum += *part_entry(s, e, i - from, j - from);
    }
    return sum;
}

int spari_linear_definite(spari_linear *s) {
    size_t n = s->n, band = s->swap ? n - 1 : s->band;
    /* after scaling to a unit diagonal; shift: bound of the rounding error */
    const double symmetric = 1e-9, shift = 4e-15;
    for (size_t i = 0; i < n; i++) {
        if (!(value_at(s, i, i) > 0)) {
            return 0;
        }
        for (size_t j = i + 1; j < n && j <= i + band; j++) {
            double size = sqrt(value_at(s, i, i) * fabs(value_at(s, j, j)));
            if (fabs(value_at(s, i, j) - value_at(s, j, i)) > symmetric * size) {
                return -1;
            }
        }
    }
    double *L = s->symmetric;
    size_t width = s->swap ? n : band + 1;
    memset(L, 0, n * width * sizeof *L);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = i; j < n && j <= i + band; j++) {
            double size = sqrt(value_at(s, i, i) * value_at(s, j, j)),
                   value = 0.5 * (value_at(s, i, j) + value_at(s, j, i)) / size + (i == j ? shift : 0);
            if (s->swap) {
                L[width * i + j] = L[width * j + i] = value;
            } else {
                L[width * i + j - i] = value;
            }
        }
    }
    return !(s->swap ? spari_cholesky((int)n, L) : spari_cholesky_band((int)n, (int)band, L));
}

/* Arguments of the solution x with interior unknowns. */
typedef struct linear_elements {
    spari_linear *s;
    double *x;
    const spari_linear_kernels *kernels;
} linear_elements;

/* Eliminates the interior unknowns of each element; z: the remaining right-hand side of its ends. */
static void forth_elements(void *context, int64_t from, int64_t to) {
    const linear_elements *t = context;
    const spari_linear *s = t->s;
    size_t m = (size_t)s->block, own = s->own, o = (size_t)s->overlap;
    for (size_t e = (size_t)from; e < (size_t)to; e++) {
        double *z = s->z + m * e;
        const int *swap = s->part_swap + own * e;
        memcpy(z, t->x + (m - o) * e + o, own * sizeof(double));
        for (size_t i = 0; i < own; i++) {
            double there = z[swap[i] - 1];
            z[swap[i] - 1] = z[i];
            z[i] = there;
        }
        memset(z + own, 0, (m - own) * sizeof *z);
        t->kernels->forth_dense((int64_t)m, (int64_t)own, s->parts + m * m * e, z);
    }
}

static void back_elements(void *context, int64_t from, int64_t to) {
    const linear_elements *t = context;
    const spari_linear *s = t->s;
    size_t m = (size_t)s->block, own = s->own, o = (size_t)s->overlap;
    for (size_t e = (size_t)from; e < (size_t)to; e++) {
        double *z = s->z + m * e, *x = t->x + (m - o) * e;
        memcpy(z + own, s->ends_x + o * e, 2 * o * sizeof(double));
        t->kernels->back_dense((int64_t)m, (int64_t)own, s->parts + m * m * e, z);
        memcpy(x, z + own, o * sizeof(double));
        memcpy(x + o, z, own * sizeof(double));
    }
    s->bad[from / ELEMENTS] = spari_first_nonfinite(s->z + m * (size_t)from, (int64_t)m * (to - from)) >= 0;
}

/* Right-hand side of the unknowns between elements e - 1 and e. */
static void gather_ends(void *context, int64_t from, int64_t to) {
    const linear_elements *t = context;
    const spari_linear *s = t->s;
    size_t m = (size_t)s->block, own = s->own, o = (size_t)s->overlap, last = (size_t)s->elements;
    for (size_t e = (size_t)from; e < (size_t)to; e++) {
        for (size_t i = 0; i < o; i++) {
            double left = e > 0 ? s->z[m * e - o + i] : 0, right = e < last ? s->z[m * e + own + i] : 0;
            s->ends_x[o * e + i] = t->x[(m - o) * e + i] + left + right;
        }
    }
}

static int solve_by_ends(spari_linear *s, double *x) {
    size_t m = (size_t)s->block, o = (size_t)s->overlap, last = (size_t)s->elements;
    linear_elements t = {s, x, kernels_here()};
    spread_elements(s, forth_elements, &t);
    spari_thread_pool_spread(s->pool ? *s->pool : NULL, s->elements + 1, GATHERED, gather_ends, &t);
    int bad = spari_linear_solve(s->ends, s->ends_x);
    spread_elements(s, back_elements, &t);
    memcpy(x + (m - o) * last, s->ends_x + o * last, o * sizeof(double));
    return is_any_bad(s) || bad;
}

static int solve_left(spari_linear *s, double *x) {
    const int64_t left = (int64_t)(s->n - s->lead), n = (int64_t)s->order_of;
    double poison = 0;
    for (size_t i = 0; i < s->lead; i++) {
        poison += 0 * x[i];
    }
    x += s->lead;
    double *y = s->y;
    const int *order = s->order;
    SPARI_UNROLL
    for (int64_t i = 0; i < left; i++) {
        y[i] = x[order[i]];
    }
    memset(s->y + left, 0, (size_t)(n - left) * sizeof *x);
    int bad = kernels_here()->dense(n, s->A.data, (int64_t)s->A.step, s->corners, s->y);
    memcpy(x, s->y, (size_t)left * sizeof *x);
    return bad || poison != 0;
}

int spari_linear_solve(spari_linear *s, double *x) {
    int64_t n = (int64_t)s->n;
    if (s->ends) {
        return solve_by_ends(s, x);
    }
    if (s->swap) {
        return solve_left(s, x);
    }
    kernels_here()->forth(n, (int64_t)s->band, s->A.data, (int64_t)s->A.step, s->band_swap, x);
    kernels_here()->back(n, (int64_t)s->band, s->A.data, (int64_t)s->A.step, x);
    return spari_first_nonfinite(x, n) < 0 ? 0 : 1;
}

void spari_linear_less_columns(int n, int count, const double *columns, const double *by, double *x) {
    kernels_here()->columns(n, count, columns, by, x);
}

void spari_linear_add_rows(int n, int count, const double *rows, double by, const double *x, double *y) {
    kernels_here()->rows(n, count, rows, by, x, y);
}

/* ---- states ---- */

int64_t spari_linear_state_size(const spari_linear *s) {
    if (s->ends) {
        int64_t of_element = (int64_t)s->block * s->block + (int64_t)s->own;
        return s->elements * of_element + spari_linear_state_size(s->ends);
    }
    return (int64_t)(s->A.rows * s->A.columns + s->n) + (s->swap ? 1 : 0);
}

/* The same code saves, checks and loads a state. */
typedef struct linear_passage {
    double *at; /* next number of the state */
    enum { SAVE, CHECK, LOAD } job;
    int bad; /* a number is not what it must be */
} linear_passage;

static void pass_factors(linear_passage *t, double *x, size_t n) {
    if (t->job == SAVE) {
        memcpy(t->at, x, n * sizeof *x);
    } else if (t->job == LOAD) {
        memcpy(x, t->at, n * sizeof *x);
    }
    t->at += n;
}

/* Numbers of rows, from `first` to below `end`. */
static void pass_swaps(linear_passage *t, int *swap, size_t n, int first, size_t end) {
    for (size_t i = 0; i < n; i++, t->at++) {
        if (t->job == SAVE) {
            *t->at = swap[i];
        } else if (t->job == LOAD) {
            swap[i] = (int)*t->at;
        } else {
            t->bad |= !(*t->at >= first && *t->at < (double)end);
        }
    }
}

/* Row exchanges of a dense matrix, preceded by the number of unknowns that were left out of it. */
static void pass_dense(linear_passage *t, spari_linear *s) {
    double lead = t->job == SAVE ? (double)s->lead : *t->at;
    const size_t size = lead > 0 ? size_without_lead(s) : s->n;
    const size_t left = lead > 0 && size > 0 ? s->n - (size_t)s->overlap : size;
    t->bad |= lead != 0 && !(lead == s->overlap && size > 0);
    pass_factors(t, &lead, 1);
    pass_swaps(t, s->swap, left, 1, left + 1); /* a solution reads only these rows of its right-hand side */
    pass_swaps(t, s->swap + left, size - left, (int)left + 1, size + 1);
    pass_swaps(t, s->swap + size, s->n - size, 0, s->n + 1); /* not in use */
    if (t->job == LOAD) {
        s->lead = (size_t)lead, s->order_of = size;
        ready_dense(s, 1);
    }
}

static void pass_system(linear_passage *t, spari_linear *s) {
    if (s->ends) {
        size_t elements = (size_t)s->elements;
        pass_factors(t, s->parts, elements * (size_t)(s->block * s->block));
        pass_swaps(t, s->part_swap, elements * s->own, 1, s->own + 1);
        pass_system(t, s->ends);
        return;
    }
    for (size_t i = 0; i < s->A.rows; i++) {
        pass_factors(t, s->A.data + i * s->A.step, s->A.columns);
    }
    if (s->swap) {
        pass_dense(t, s);
    } else {
        pass_swaps(t, s->band_swap, s->n, 0, s->n);
    }
}

void spari_linear_save(const spari_linear *s, double *state) {
    linear_passage t = {state, SAVE, 0};
    pass_system(&t, (spari_linear *)(uintptr_t)s); /* which saving does not change */
}

int spari_linear_is_state(const spari_linear *s, const double *state) {
    linear_passage t = {(double *)(uintptr_t)state, CHECK, 0};
    pass_system(&t, (spari_linear *)(uintptr_t)s);
    return !t.bad;
}

void spari_linear_load(spari_linear *s, const double *state) {
    linear_passage t = {(double *)(uintptr_t)state, LOAD, 0};
    pass_system(&t, s);
}
