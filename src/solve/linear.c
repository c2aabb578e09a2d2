/* Dense and banded systems, of a chain of blocks that overlap or of any entries, factored and solved. */
#include "linear.h"
#include "../base/blas.h"

#include "../base/status.h"
#include "../math/lanes.h"

#include <gsl/gsl_cblas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SPARI_WIDTH 2
#include "../math/width.h"
#include "linear_lanes.h"
#ifdef SPARI_X86
#define SPARI_WIDTH 4
#include "../math/width.h"
#include "linear_lanes.h"
#define SPARI_WIDTH 8
#include "../math/width.h"
#include "linear_lanes.h"
#endif
#define SPARI_WIDTH 0
#include "../math/width.h"

/* All memory is taken at the beginning: nothing in a step allocates, and GSL's dense LU does, without looking whether
   it got any. */
struct spari_linear {
    int elements, block, overlap; /* of a chain; else 0 */
    size_t n, band;               /* unknowns; half bandwidth (banded storage) */
    gsl_matrix *A; /* dense n x n, column by column, or banded n x (3 band + 1) as gsl_linalg_LU_band has it */
    int *swap;     /* dense, else NULL: row i went to swap[i] - 1, one after the other, as LAPACK says it */
    gsl_vector_uint *band_swap; /* banded */
    gsl_matrix *symmetric;      /* spari_linear_watch; NULL: not asked for */
};

/* Room for the matrix, whose size is known. */
static spari_linear *with_room(spari_linear *s, int dense) {
    if (dense) {
        s->A = gsl_matrix_calloc(s->n, s->n);
        s->swap = spari_zalloc((int64_t)s->n, sizeof *s->swap);
    } else {
        s->A = gsl_matrix_calloc(s->n, 3 * s->band + 1);
        s->band_swap = gsl_vector_uint_alloc(s->n);
    }
    if (!s->A || (dense ? !s->swap : !s->band_swap)) {
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
    return with_room(s, elements == 1);
}

spari_linear *spari_linear_create_banded(int n, int band) {
    spari_linear *s = spari_zalloc(1, sizeof *s);
    if (!s) {
        return NULL;
    }
    s->n = (size_t)n, s->band = (size_t)band;
    return with_room(s, 3 * s->band + 1 >= s->n);
}

void spari_linear_free(spari_linear *s) {
    if (s) {
        gsl_matrix_free(s->A);
        free(s->swap);
        gsl_vector_uint_free(s->band_swap);
        spari_linear_unwatch(s);
        free(s);
    }
}

void spari_linear_zero(spari_linear *s) {
    gsl_matrix_set_zero(s->A);
}

/* entry (i, j): row j of the storage is column j of the matrix; banded storage has A(i, j) at 2 band + i - j there */
static double *entry(const spari_linear *s, size_t i, size_t j) {
    return s->A->data + j * s->A->tda + (s->swap ? i : 2 * s->band + i - j);
}

double *spari_linear_entries(const spari_linear *s, int64_t *step) {
    *step = (int64_t)s->A->tda - (s->swap ? 0 : 1);
    return entry(s, 0, 0);
}

void spari_linear_add(spari_linear *s, int element, const double *S) {
    size_t first = (size_t)element * (size_t)(s->block - s->overlap), m = (size_t)s->block;
    for (size_t j = 0; j < m; j++) {
        double *column = entry(s, first, first + j);
        for (size_t i = 0; i < m; i++) {
            column[i] += S[m * i + j];
        }
    }
}

/* The unknowns [from, to) that unknown i may have entries with */
static void reach_of(const spari_linear *s, size_t i, size_t *from, size_t *to) {
    *from = !s->swap && i > s->band ? i - s->band : 0;
    *to = !s->swap && i + s->band + 1 < s->n ? i + s->band + 1 : s->n;
}

void spari_linear_read(const spari_linear *s, int i, double *row, double *column) {
    size_t at = (size_t)i, from, to;
    reach_of(s, at, &from, &to);
    memset(row, 0, s->n * sizeof *row);
    memset(column, 0, s->n * sizeof *column);
    for (size_t j = from; j < to; j++) {
        row[j] = *entry(s, at, j);
        column[j] = *entry(s, j, at);
    }
}

void spari_linear_fix(spari_linear *s, int i) {
    size_t at = (size_t)i, from, to;
    reach_of(s, at, &from, &to);
    for (size_t j = from; j < to; j++) {
        *entry(s, at, j) = *entry(s, j, at) = 0;
    }
    *entry(s, at, at) = 1;
}

typedef struct linear_kernels {
    int (*factor_dense)(int64_t n, double least, double *A, int *swap);
    int (*factor_band)(int64_t n, int64_t band, double least, double *columns, int64_t step, unsigned *swap);
    void (*dense)(int64_t n, const double *A, double *x);
    void (*band)(int64_t n, int64_t band, const double *columns, int64_t step, const unsigned *swap, double *x);
    void (*columns)(int64_t n, int64_t count, const double *columns, const double *by, double *x);
    void (*rows)(int64_t n, int64_t count, const double *rows, double by, const double *x, double *y);
} linear_kernels;

#define LINEAR_KERNELS(width)                                                                                          \
    (linear_kernels) {                                                                                                 \
        factor_dense_##width, factor_band_##width, solve_dense_##width, solve_band_##width, take_columns_##width,      \
            add_rows_##width                                                                                           \
    }

static linear_kernels kernels_here(void) {
#ifdef SPARI_X86
    switch (spari_lanes_here(8)) {
    case 8:
        return LINEAR_KERNELS(avx512);
    case 4:
        return LINEAR_KERNELS(avx2);
    default:
        break;
    }
#endif
    return LINEAR_KERNELS(plain);
}

int spari_linear_factor(spari_linear *s) {
    /* before: a search for the largest of what are no numbers may answer anything */
    if (spari_first_nonfinite(s->A->data, (int64_t)(s->A->size1 * s->A->tda)) >= 0) {
        return 1;
    }
    int bad = 0;
    double least = s->elements > 0 ? 1 : 0.1; /* what is no chain has holes, which exchanges fill */
    if (s->swap) {
        bad = kernels_here().factor_dense((int64_t)s->n, least, s->A->data, s->swap);
    } else {
        bad = kernels_here().factor_band((int64_t)s->n, (int64_t)s->band, least, s->A->data, (int64_t)s->A->tda,
                                         s->band_swap->data);
    }
    if (bad) {
        return 1;
    }
    for (size_t i = 0; i < s->n; i++) {
        double pivot = fabs(*entry(s, i, i));
        if (!(pivot > 0) || !isfinite(pivot)) {
            return 1;
        }
    }
    return 0;
}

int spari_linear_sign(const spari_linear *s) {
    int sign = 1;
    for (size_t i = 0; i < s->n; i++) {
        size_t from = s->swap ? (size_t)s->swap[i] - 1 : gsl_vector_uint_get(s->band_swap, i);
        sign = (*entry(s, i, i) < 0) != (from != i) ? -sign : sign;
    }
    return sign;
}

int spari_linear_watch(spari_linear *s) {
    s->symmetric = s->symmetric ? s->symmetric : gsl_matrix_calloc(s->n, s->swap ? s->n : s->band + 1);
    return s->symmetric ? 0 : 1;
}

void spari_linear_unwatch(spari_linear *s) {
    gsl_matrix_free(s->symmetric);
    s->symmetric = NULL;
}

int spari_linear_definite(spari_linear *s) {
    size_t n = s->n, band = s->swap ? n - 1 : s->band;
    /* scaled to a unit diagonal, shifted by what rounding can do to it */
    const double symmetric = 1e-9, shift = 4e-15;
    for (size_t i = 0; i < n; i++) {
        if (!(*entry(s, i, i) > 0)) {
            return 0;
        }
        for (size_t j = i + 1; j < n && j <= i + band; j++) {
            double size = sqrt(*entry(s, i, i) * fabs(*entry(s, j, j)));
            if (fabs(*entry(s, i, j) - *entry(s, j, i)) > symmetric * size) {
                return -1;
            }
        }
    }
    gsl_matrix *L = s->symmetric;
    gsl_matrix_set_zero(L);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = i; j < n && j <= i + band; j++) {
            double size = sqrt(*entry(s, i, i) * *entry(s, j, j)),
                   value = 0.5 * (*entry(s, i, j) + *entry(s, j, i)) / size + (i == j ? shift : 0);
            if (s->swap) {
                gsl_matrix_set(L, i, j, value);
                gsl_matrix_set(L, j, i, value);
            } else {
                gsl_matrix_set(L, i, j - i, value);
            }
        }
    }
    int status;
    SPARI_BLAS(status = s->swap ? gsl_linalg_cholesky_decomp1(L) : gsl_linalg_cholesky_band_decomp(L));
    return status == GSL_SUCCESS;
}

int spari_linear_solve(spari_linear *s, double *x) {
    int64_t n = (int64_t)s->n;
    if (s->swap) {
        for (int64_t i = 0; i < n; i++) {
            double there = x[s->swap[i] - 1];
            x[s->swap[i] - 1] = x[i];
            x[i] = there;
        }
        kernels_here().dense(n, s->A->data, x);
    } else {
        kernels_here().band(n, (int64_t)s->band, s->A->data, (int64_t)s->A->tda, s->band_swap->data, x);
    }
    return spari_first_nonfinite(x, n) < 0 ? 0 : 1;
}

void spari_linear_less_columns(int n, int count, const double *columns, const double *by, double *x) {
    kernels_here().columns(n, count, columns, by, x);
}

void spari_linear_add_rows(int n, int count, const double *rows, double by, const double *x, double *y) {
    kernels_here().rows(n, count, rows, by, x, y);
}

int64_t spari_linear_state_size(const spari_linear *s) {
    return (int64_t)(s->A->size1 * s->A->size2 + s->n);
}

void spari_linear_save(const spari_linear *s, double *state) {
    for (size_t i = 0; i < s->A->size1; i++, state += s->A->size2) {
        memcpy(state, s->A->data + i * s->A->tda, s->A->size2 * sizeof *state);
    }
    for (size_t i = 0; i < s->n; i++) {
        state[i] = s->swap ? s->swap[i] : (double)gsl_vector_uint_get(s->band_swap, i);
    }
}

int spari_linear_is_state(const spari_linear *s, const double *state) {
    double first = s->swap ? 1 : 0;
    state += s->A->size1 * s->A->size2;
    for (size_t i = 0; i < s->n; i++) {
        if (!(state[i] >= first && state[i] < first + (double)s->n)) {
            return 0;
        }
    }
    return 1;
}

void spari_linear_load(spari_linear *s, const double *state) {
    for (size_t i = 0; i < s->A->size1; i++, state += s->A->size2) {
        memcpy(s->A->data + i * s->A->tda, state, s->A->size2 * sizeof *state);
    }
    for (size_t i = 0; i < s->n; i++) {
        if (s->swap) {
            s->swap[i] = (int)state[i];
        } else {
            gsl_vector_uint_set(s->band_swap, i, (unsigned)state[i]);
        }
    }
}
