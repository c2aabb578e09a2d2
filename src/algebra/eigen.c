/* Eigenvalue problems by GSL. Its symmetric solver never ends where an entry is no finite number or its square is none:
   all it is given is brought to the size of 1 first. */
#include "eigen.h"

#include "../base/status.h"
#include "cblas.h"
#include "dense.h"
#include "gsl.h"

#include <math.h>

/* Divides A by a power of 4 near its largest entry, which changes no digit of what roots and quotients give; *exponent:
   of 2. Returns 0 if an entry is not finite. */
static int bring_to_one(int64_t size, double *A, int *exponent) {
    double largest = 0;
    for (int64_t i = 0; i < size; i++) {
        if (!isfinite(A[i])) {
            return 0;
        }
        largest = fmax(largest, fabs(A[i]));
    }
    *exponent = 0;
    if (largest > 0) {
        (void)frexp(largest, exponent);
        *exponent &= ~1;
    }
    for (int64_t i = 0; i < size && *exponent != 0; i++) {
        A[i] = ldexp(A[i], -*exponent);
    }
    return 1;
}

/* L^-1 A L^-T in A, L in B; 0, or 1: B is not positive definite. */
static int standardise(int n, double *A, double *B) {
    gsl_matrix_view a = spari_gsl_matrix(A, n, n), b = spari_gsl_matrix(B, n, n);
    int bad = spari_cholesky(n, B);
    if (!bad) {
        SPARI_GSL(bad = gsl_eigen_gensymm_standardize(&a.matrix, &b.matrix));
    }
    return bad;
}

/* A x = mu x: mu descending, x in rows. */
static int solve_symmetric(int n, double *A, double *mu, double *x) {
    gsl_matrix_view a = spari_gsl_matrix(A, n, n), z = spari_gsl_matrix(x, n, n);
    gsl_vector_view value = spari_gsl_vector(mu, n);
    gsl_eigen_symmv_workspace *w;
    int bad = 0;
    SPARI_GSL(w = gsl_eigen_symmv_alloc((size_t)n));
    if (!w) {
        return SPAR_ERR_MEMORY;
    }
    SPARI_GSL(bad = gsl_eigen_symmv(&a.matrix, &value.vector, &z.matrix, w));
    gsl_eigen_symmv_free(w);
    (void)gsl_eigen_symmv_sort(&value.vector, &z.matrix, GSL_EIGEN_SORT_VAL_DESC);
    (void)gsl_matrix_transpose(&z.matrix);
    return bad ? SPAR_ERR_NUMERIC : SPAR_OK;
}

int spari_eigen(int n, double *A, double *B, double *mu, double *x) {
    int64_t size = (int64_t)n * n;
    int of_A, of_B, of_C;
    if (n < 1) {
        return SPAR_OK;
    }
    if (!bring_to_one(size, A, &of_A) || !bring_to_one(size, B, &of_B) || standardise(n, A, B) ||
        !bring_to_one(size, A, &of_C)) {
        return SPAR_ERR_NUMERIC;
    }
    int status = solve_symmetric(n, A, mu, x);
    if (status == SPAR_OK) {
        SPARI_BLAS(cblas_dtrsm(CblasRowMajor, CblasRight, CblasLower, CblasNoTrans, CblasNonUnit, n, n, 1, B, n, x, n));
    }
    for (int k = 0; k < n && status == SPAR_OK; k++) {
        double *row = x + (int64_t)n * k;
        cblas_dscal(n, 1 / cblas_dnrm2(n, row, 1), row, 1);
        mu[k] = ldexp(mu[k], of_A + of_C - of_B);
    }
    return status;
}

int spari_eigenvalues(int n, double *A, double complex *z) {
    gsl_matrix_view a = spari_gsl_matrix(A, n, n);
    gsl_vector_complex_view value = gsl_vector_complex_view_array((double *)z, (size_t)n);
    gsl_eigen_nonsymm_workspace *w;
    int bad = 0;
    SPARI_GSL(w = gsl_eigen_nonsymm_alloc((size_t)n));
    if (!w) {
        return SPAR_ERR_MEMORY;
    }
    gsl_eigen_nonsymm_params(0, 1, w);
    SPARI_GSL(bad = gsl_eigen_nonsymm(&a.matrix, &value.vector, w));
    gsl_eigen_nonsymm_free(w);
    return bad ? SPAR_ERR_NUMERIC : SPAR_OK;
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
