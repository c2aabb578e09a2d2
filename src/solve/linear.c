/* A chain of blocks that overlap, factored and solved from end to end. */
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
    int elements, block, overlap;
    size_t n, band; /* unknowns; half bandwidth (banded storage) */
    gsl_matrix *A;  /* dense n x n, column by column, or banded n x (3 band + 1) as gsl_linalg_LU_band wants it */
    int *swap;      /* dense: row i went to swap[i] - 1, one after the other, as LAPACK says it */
    gsl_vector_uint *band_swap; /* banded */
    gsl_matrix *symmetric;      /* spari_linear_watch; NULL: not asked for */
};

#ifdef SPARI_HAVE_LAPACK
extern void dgetrf_(const int *m, const int *n, double *a, const int *lda, int *ipiv, int *info);
#endif

spari_linear *spari_linear_create(int elements, int block, int overlap) {
    spari_linear *s = spari_zalloc(1, sizeof *s);
    if (!s) {
        return NULL;
    }
    s->elements = elements, s->block = block, s->overlap = overlap;
    s->n = (size_t)elements * (size_t)(block - overlap) + (size_t)overlap;
    s->band = (size_t)block - 1;
    if (elements == 1) {
        s->A = gsl_matrix_calloc(s->n, s->n);
        s->swap = spari_zalloc((int64_t)s->n, sizeof *s->swap);
    } else {
        s->A = gsl_matrix_calloc(s->n, 3 * s->band + 1);
        s->band_swap = gsl_vector_uint_alloc(s->n);
    }
    if (!s->A || (elements == 1 ? !s->swap : !s->band_swap)) {
        spari_linear_free(s);
        return NULL;
    }
    return s;
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
    return s->A->data + j * s->A->tda + (s->elements == 1 ? i : 2 * s->band + i - j);
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
    *from = s->elements > 1 && i > s->band ? i - s->band : 0;
    *to = s->elements > 1 && i + s->band + 1 < s->n ? i + s->band + 1 : s->n;
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

/* LU with row exchanges, in place; 0 or 1 */
static int factor_dense(spari_linear *s) {
    int n = (int)s->n, info = 0;
#ifdef SPARI_HAVE_LAPACK
    SPARI_BLAS(dgetrf_(&n, &n, s->A->data, &n, s->swap, &info));
#else
    for (int k = 0; k < n && !info; k++) {
        double *at = s->A->data + (int64_t)k * n + k;
        int p = k + (int)cblas_idamax(n - k, at, 1);
        s->swap[k] = p + 1;
        info = !(fabs(at[p - k]) > 0);
        if (!info) {
            cblas_dswap(n, s->A->data + k, n, s->A->data + p, n);
            cblas_dscal(n - k - 1, 1 / *at, at + 1, 1);
            cblas_dger(CblasColMajor, n - k - 1, n - k - 1, -1, at + 1, 1, at + n, n, at + n + 1, n);
        }
    }
#endif
    return info != 0;
}

int spari_linear_factor(spari_linear *s) {
    /* before: a search for the largest of what are no numbers may answer anything */
    if (spari_first_nonfinite(s->A->data, (int64_t)(s->A->size1 * s->A->tda)) >= 0) {
        return 1;
    }
    int bad = 0;
    if (s->elements == 1) {
        bad = factor_dense(s);
    } else {
        SPARI_BLAS(bad = gsl_linalg_LU_band_decomp(s->n, s->band, s->band, s->A, s->band_swap) != GSL_SUCCESS);
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
        size_t from = s->elements == 1 ? (size_t)s->swap[i] - 1 : gsl_vector_uint_get(s->band_swap, i);
        sign = (*entry(s, i, i) < 0) != (from != i) ? -sign : sign;
    }
    return sign;
}

int spari_linear_watch(spari_linear *s) {
    s->symmetric = s->symmetric ? s->symmetric : gsl_matrix_calloc(s->n, s->elements == 1 ? s->n : s->band + 1);
    return s->symmetric ? 0 : 1;
}

void spari_linear_unwatch(spari_linear *s) {
    gsl_matrix_free(s->symmetric);
    s->symmetric = NULL;
}

int spari_linear_definite(spari_linear *s) {
    size_t n = s->n, band = s->elements == 1 ? n - 1 : s->band;
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
            if (s->elements == 1) {
                gsl_matrix_set(L, i, j, value);
                gsl_matrix_set(L, j, i, value);
            } else {
                gsl_matrix_set(L, i, j - i, value);
            }
        }
    }
    int status;
    SPARI_BLAS(status = s->elements == 1 ? gsl_linalg_cholesky_decomp1(L) : gsl_linalg_cholesky_band_decomp(L));
    return status == GSL_SUCCESS;
}

typedef struct linear_kernels {
    void (*dense)(int64_t n, const double *A, double *x);
    void (*band)(int64_t n, int64_t band, const double *columns, int64_t step, const unsigned *swap, double *x);
} linear_kernels;

static linear_kernels kernels_here(void) {
#ifdef SPARI_X86
    switch (spari_lanes_here(8)) {
    case 8:
        return (linear_kernels){solve_dense_avx512, solve_band_avx512};
    case 4:
        return (linear_kernels){solve_dense_avx2, solve_band_avx2};
    default:
        break;
    }
#endif
    return (linear_kernels){solve_dense_plain, solve_band_plain};
}

int spari_linear_solve(spari_linear *s, double *x) {
    int64_t n = (int64_t)s->n;
    if (s->elements == 1) {
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
