#include "linear.h"

#include "../session/status.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct spari_linear {
    int elements, block, overlap;
    size_t n, band;         /* unknowns; half bandwidth (banded storage) */
    gsl_matrix *A;          /* dense n x n, or banded n x (3 band + 1) as gsl_linalg_LU_band wants it */
    gsl_permutation *p;     /* dense */
    int swaps;              /* dense: sign of the permutation */
    gsl_vector_uint *pivot; /* banded */
};

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
        s->p = gsl_permutation_alloc(s->n);
    } else {
        s->A = gsl_matrix_calloc(s->n, 3 * s->band + 1);
        s->pivot = gsl_vector_uint_alloc(s->n);
    }
    if (!s->A || (elements == 1 ? !s->p : !s->pivot)) {
        spari_linear_free(s);
        return NULL;
    }
    return s;
}

void spari_linear_free(spari_linear *s) {
    if (s) {
        gsl_matrix_free(s->A);
        gsl_permutation_free(s->p);
        gsl_vector_uint_free(s->pivot);
        free(s);
    }
}

void spari_linear_zero(spari_linear *s) {
    gsl_matrix_set_zero(s->A);
}

/* entry (i, j): banded storage keeps column j in row j, A(i, j) at 2 band + i - j */
static double *entry(const spari_linear *s, size_t i, size_t j) {
    return s->elements == 1 ? s->A->data + i * s->A->tda + j : s->A->data + j * s->A->tda + (2 * s->band + i - j);
}

void spari_linear_add(spari_linear *s, int element, const double *S) {
    size_t first = (size_t)element * (size_t)(s->block - s->overlap), m = (size_t)s->block;
    for (size_t i = 0; i < m; i++) {
        for (size_t j = 0; j < m; j++) {
            *entry(s, first + i, first + j) += S[m * i + j];
        }
    }
}

void spari_linear_fix(spari_linear *s, int i) {
    size_t at = (size_t)i, from = 0, to = s->n;
    if (s->elements > 1) {
        from = at > s->band ? at - s->band : 0;
        to = at + s->band + 1 < s->n ? at + s->band + 1 : s->n;
    }
    for (size_t j = from; j < to; j++) {
        *entry(s, at, j) = *entry(s, j, at) = 0;
    }
    *entry(s, at, at) = 1;
}

int spari_linear_factor(spari_linear *s) {
    int status;
    if (s->elements == 1) {
        status = gsl_linalg_LU_decomp(s->A, s->p, &s->swaps);
    } else {
        status = gsl_linalg_LU_band_decomp(s->n, s->band, s->band, s->A, s->pivot);
    }
    if (status != GSL_SUCCESS) {
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
    int sign = s->elements == 1 ? s->swaps : 1;
    for (size_t i = 0; i < s->n; i++) {
        sign = *entry(s, i, i) < 0 ? -sign : sign;
        if (s->elements > 1 && gsl_vector_uint_get(s->pivot, i) != i) {
            sign = -sign;
        }
    }
    return sign;
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
    gsl_matrix *L = gsl_matrix_calloc(n, s->elements == 1 ? n : band + 1);
    if (!L) {
        return -2;
    }
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
    int status = s->elements == 1 ? gsl_linalg_cholesky_decomp1(L) : gsl_linalg_cholesky_band_decomp(L);
    gsl_matrix_free(L);
    return status == GSL_SUCCESS;
}

int spari_linear_solve(spari_linear *s, double *x) {
    gsl_vector_view v = gsl_vector_view_array(x, s->n);
    if (s->elements == 1) {
        gsl_linalg_LU_svx(s->A, s->p, &v.vector);
    } else {
        gsl_linalg_LU_band_svx(s->band, s->band, s->A, s->pivot, &v.vector);
    }
    return spari_first_nonfinite(x, (int64_t)s->n) < 0 ? 0 : 1;
}

int64_t spari_linear_state_size(const spari_linear *s) {
    return (int64_t)(s->A->size1 * s->A->size2 + s->n);
}

void spari_linear_save(const spari_linear *s, double *state) {
    for (size_t i = 0; i < s->A->size1; i++, state += s->A->size2) {
        memcpy(state, s->A->data + i * s->A->tda, s->A->size2 * sizeof *state);
    }
    for (size_t i = 0; i < s->n; i++) {
        state[i] = s->p ? (double)s->p->data[i] : (double)gsl_vector_uint_get(s->pivot, i);
    }
}

void spari_linear_load(spari_linear *s, const double *state) {
    for (size_t i = 0; i < s->A->size1; i++, state += s->A->size2) {
        memcpy(s->A->data + i * s->A->tda, state, s->A->size2 * sizeof *state);
    }
    for (size_t i = 0; i < s->n; i++) {
        if (s->p) {
            s->p->data[i] = (size_t)state[i];
        } else {
            gsl_vector_uint_set(s->pivot, i, (unsigned)state[i]);
        }
    }
}
