/* Factorisations of dense matrices: by GSL, or by LAPACK in a library without GSL. Singular values are LAPACK's, where
   there is one. */
#include "dense.h"

#include "../base/status.h"
#include "cblas.h"
#ifndef SPARI_WITHOUT_GSL
#include "gsl.h"
#endif
#ifdef SPARI_HAVE_LAPACK
#include "lapack.h"
#endif

#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifndef SPARI_WITHOUT_GSL
int spari_cholesky(int n, double *A) {
    gsl_matrix_view a = spari_gsl_matrix(A, n, n);
    int status;
    SPARI_GSL(status = gsl_linalg_cholesky_decomp1(&a.matrix));
    return status != GSL_SUCCESS;
}

void spari_cholesky_solve(int n, const double *L, double *x) {
    gsl_matrix_const_view l = gsl_matrix_const_view_array(L, (size_t)n, (size_t)n);
    gsl_vector_view y = spari_gsl_vector(x, n);
    SPARI_GSL((void)gsl_linalg_cholesky_svx(&l.matrix, &y.vector));
}

int spari_cholesky_band(int n, int band, double *A) {
    gsl_matrix_view a = spari_gsl_matrix(A, n, band + 1);
    int status;
    SPARI_GSL(status = gsl_linalg_cholesky_band_decomp(&a.matrix));
    return status != GSL_SUCCESS;
}

/* GSL's QR takes no memory of its own; its LU and SVD do, without looking whether they got any. */
int spari_least_squares(int m, int n, double *A, int columns, double *b) {
    double *workspace = spari_zalloc(2 * (int64_t)n + m, sizeof *workspace);
    if (!workspace) {
        return SPAR_ERR_MEMORY;
    }
    gsl_matrix_view a = spari_gsl_matrix(A, m, n);
    gsl_vector_view tau = spari_gsl_vector(workspace, n), x = spari_gsl_vector(workspace + n, n);
    gsl_vector_view left = spari_gsl_vector(workspace + 2 * (int64_t)n, m);
    int bad;
    SPARI_GSL(bad = gsl_linalg_QR_decomp(&a.matrix, &tau.vector));
    for (int c = 0; c < columns && !bad; c++) {
        gsl_vector_view right = spari_gsl_vector(b + (int64_t)m * c, m);
        SPARI_GSL(bad = gsl_linalg_QR_lssolve(&a.matrix, &tau.vector, &right.vector, &x.vector, &left.vector));
        memcpy(right.vector.data, workspace + n, (size_t)n * sizeof *workspace);
    }
    free(workspace);
    return bad ? SPAR_ERR_NUMERIC : SPAR_OK;
}

/* G^T = Q R with pivoted columns. */
int spari_independent_rows(int h, int n, double *G, double least, int *order, int want, double *Q) {
    int most = n < h ? n : h, rank = 0, sign;
    double *workspace = spari_zalloc((int64_t)n * h + n + h, sizeof *workspace);
    gsl_permutation p = {(size_t)h, spari_zalloc(h, sizeof *p.data)};
    if (!workspace || !p.data) {
        SPARI_FREE(workspace, p.data);
        return -1;
    }
    gsl_matrix_view a = spari_gsl_matrix(workspace, n, h);
    gsl_vector_view tau = spari_gsl_vector(workspace + (int64_t)n * h, most);
    gsl_vector_view norm = spari_gsl_vector(workspace + (int64_t)n * h + most, h);
    for (int64_t i = 0; i < (int64_t)h * n; i++) {
        workspace[h * (i % n) + i / n] = G[i];
    }
    for (size_t c = 0; c < (size_t)h; c++) {
        gsl_vector_view column = gsl_matrix_column(&a.matrix, c);
        double size = gsl_blas_dnrm2(&column.vector);
        gsl_vector_scale(&column.vector, size > 0 ? 1 / size : 0);
    }
    SPARI_GSL((void)gsl_linalg_QRPT_decomp(&a.matrix, &tau.vector, &p, &sign, &norm.vector));
    while (rank < most && fabs(workspace[(int64_t)(h + 1) * rank]) > least) {
        rank++;
    }
    for (int i = 0; i < h; i++) {
        order[i] = (int)p.data[i];
    }
    for (int k = 0; k < want; k++) {
        gsl_vector_view unit = spari_gsl_vector(Q + (int64_t)n * k, n);
        gsl_vector_set_basis(&unit.vector, (size_t)k);
        SPARI_GSL((void)gsl_linalg_QR_Qvec(&a.matrix, &tau.vector, &unit.vector));
    }
    SPARI_FREE(workspace, p.data);
    return rank;
}
#else
/* By columns the matrices are transposed, and the lower triangle is the upper one. */
int spari_cholesky(int n, double *A) {
    int bad = 0;
    if (n > 0) {
        SPARI_BLAS(dpotrf_("U", &n, A, &n, &bad, 1));
    }
    return bad != 0;
}

void spari_cholesky_solve(int n, const double *L, double *x) {
    SPARI_BLAS(cblas_dtrsv(CblasRowMajor, CblasLower, CblasNoTrans, CblasNonUnit, n, L, n, x, 1));
    SPARI_BLAS(cblas_dtrsv(CblasRowMajor, CblasLower, CblasTrans, CblasNonUnit, n, L, n, x, 1));
}

int spari_cholesky_band(int n, int band, double *A) {
    int bad, step = band + 1;
    SPARI_BLAS(dpbtrf_("L", &n, &band, A, &step, &bad, 1));
    return bad != 0;
}

int spari_least_squares(int m, int n, double *A, int columns, double *b) {
    int bad, size = n + 32 * (n > columns ? n : columns);
    double *workspace = spari_zalloc(size, sizeof *workspace);
    if (!workspace) {
        return SPAR_ERR_MEMORY;
    }
    SPARI_BLAS(dgels_("T", &n, &m, &columns, A, &n, b, &m, workspace, &size, &bad, 1));
    free(workspace);
    return bad ? SPAR_ERR_NUMERIC : SPAR_OK;
}

int spari_independent_rows(int h, int n, double *G, double least, int *order, int want, double *Q) {
    int most = n < h ? n : h, reflectors = want < most ? want : most, size = 32 * (h + n), rank = 0, bad;
    double *tau = spari_zalloc(most + size, sizeof *tau);
    if (!tau) {
        return -1;
    }
    memset(order, 0, (size_t)h * sizeof *order);
    for (int64_t i = 0; i < h; i++) {
        double length = cblas_dnrm2(n, G + n * i, 1);
        cblas_dscal(n, length > 0 ? 1 / length : 0, G + n * i, 1);
    }
    SPARI_BLAS(dgeqp3_(&n, &h, G, &n, order, tau, tau + most, &size, &bad));
    while (rank < most && fabs(G[(int64_t)(n + 1) * rank]) > least) {
        rank++;
    }
    for (int i = 0; i < h; i++) {
        order[i]--;
    }
    memcpy(Q, G, (size_t)reflectors * (size_t)n * sizeof *Q);
    if (want > 0) {
        SPARI_BLAS(dorgqr_(&n, &want, &reflectors, Q, &n, tau, tau + most, &size, &bad));
    }
    free(tau);
    return rank;
}
#endif

#ifdef SPARI_HAVE_LAPACK
/* By columns A is A^T = V S U^T: its left vectors are those of V, its right ones come as rows, which are U by columns.
 */
int spari_singular_values(int n, double *A, double *S, double *V) {
    int size = 8 * n, bad;
    double *workspace = spari_zalloc((int64_t)n * n + size, sizeof *workspace), *U = workspace + size;
    if (!workspace) {
        return SPAR_ERR_MEMORY;
    }
    SPARI_BLAS(dgesvd_("A", "A", &n, &n, A, &n, S, V, &n, U, &n, workspace, &size, &bad, 1, 1));
    memcpy(A, U, (size_t)n * (size_t)n * sizeof *A);
    for (int i = 0; i < n * n; i++) {
        int j = n * (i % n) + i / n;
        double x = V[i];
        V[i] = i < j ? V[j] : V[i];
        V[j] = i < j ? x : V[j];
    }
    free(workspace);
    return bad ? SPAR_ERR_NUMERIC : SPAR_OK;
}
#else
int spari_singular_values(int n, double *A, double *S, double *V) {
    gsl_matrix_view a = spari_gsl_matrix(A, n, n), v = spari_gsl_matrix(V, n, n);
    gsl_vector_view s = spari_gsl_vector(S, n);
    int bad;
    SPARI_GSL(bad = gsl_linalg_SV_decomp_jacobi(&a.matrix, &v.matrix, &s.vector)); /* the others take memory, unasked */
    return bad ? SPAR_ERR_NUMERIC : SPAR_OK;
}
#endif
