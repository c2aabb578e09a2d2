/* Symmetric generalised eigenvalue problems, by Cholesky factorisation and GSL's symmetric solver. That solver does
   not terminate if an entry or its square is not finite, so all matrices are scaled to about 1 first. */
#include "eigen.h"
#include "../base/blas.h"

#include "../base/status.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <math.h>

/* Divides A by a power of 4 near its largest entry, which changes no digit of roots and quotients; *exponent: of 2.
   Returns 0 if an entry is not finite. */
static int bring_to_one(gsl_matrix *A, int *exponent) {
    double largest = 0;
    for (size_t i = 0; i < A->size1; i++) {
        for (size_t j = 0; j < A->size2; j++) {
            double size = fabs(gsl_matrix_get(A, i, j));
            if (!isfinite(size)) {
                return 0;
            }
            largest = fmax(largest, size);
        }
    }
    *exponent = 0;
    if (largest > 0) {
        (void)frexp(largest, exponent);
        *exponent &= ~1;
    }
    for (size_t i = 0; i < A->size1 && *exponent != 0; i++) {
        for (size_t j = 0; j < A->size2; j++) {
            gsl_matrix_set(A, i, j, ldexp(gsl_matrix_get(A, i, j), -*exponent));
        }
    }
    return 1;
}

static void unit_columns(gsl_matrix *x) {
    for (size_t k = 0; k < x->size2; k++) {
        gsl_vector_view column = gsl_matrix_column(x, k);
        gsl_vector_scale(&column.vector, 1 / gsl_blas_dnrm2(&column.vector));
    }
}

/* A := L^-1 A L^-T, B := L. Returns 1 if B is not positive definite. */
static int standardise(gsl_matrix *A, gsl_matrix *B) {
    int bad;
    SPARI_BLAS(bad = gsl_linalg_cholesky_decomp1(B) || gsl_eigen_gensymm_standardize(A, B));
    return bad;
}

int spari_eigen(gsl_matrix *A, gsl_matrix *B, gsl_vector *mu, gsl_matrix *x) {
    int of_A, of_B, of_C;
    if (!bring_to_one(A, &of_A) || !bring_to_one(B, &of_B) || standardise(A, B) || !bring_to_one(A, &of_C)) {
        return SPAR_ERR_NUMERIC;
    }
    gsl_eigen_symmv_workspace *w = gsl_eigen_symmv_alloc(A->size1);
    if (!w) {
        return SPAR_ERR_MEMORY;
    }
    int status;
    SPARI_BLAS(status = gsl_eigen_symmv(A, mu, x, w));
    gsl_eigen_symmv_free(w);
    if (status != GSL_SUCCESS) {
        return SPAR_ERR_NUMERIC;
    }
    SPARI_BLAS(gsl_blas_dtrsm(CblasLeft, CblasLower, CblasTrans, CblasNonUnit, 1, B, x));
    unit_columns(x);
    for (size_t k = 0; k < mu->size; k++) {
        gsl_vector_set(mu, k, ldexp(gsl_vector_get(mu, k), of_A + of_C - of_B));
    }
    (void)gsl_eigen_symmv_sort(mu, x, GSL_EIGEN_SORT_VAL_DESC);
    return SPAR_OK;
}

void spari_eigen_add(int at, int n, const double *X, double scale, int64_t size, double *A) {
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            if (at + i >= 0 && at + j >= 0) {
                A[size * (at + i) + at + j] += 0.5 * scale * (X[(int64_t)n * i + j] + X[(int64_t)n * j + i]);
            }
        }
    }
}
