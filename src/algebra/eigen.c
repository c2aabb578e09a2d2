/* Symmetric generalised eigenvalue problems, by Cholesky factorisation and GSL's symmetric solver. That solver does
   not terminate if an entry or its square is not finite, so all matrices are scaled to about 1 first. */
#include "eigen.h"

#include "../base/status.h"
#include "cblas.h"

#ifdef SPARI_HAVE_LAPACK
#include "lapack.h"
#else
#include "gsl.h"
#endif
#include <math.h>
#include <stdlib.h>

#ifndef CMPLX /* the system's header has it for GCC alone; here both parts are finite */
#define CMPLX(re, im) ((double complex)((re) + (im)*_Complex_I))
#endif

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

/* solve_symmetric: A x = mu x, mu ascending, the vectors as rows in place of A. solve_real: eigenvalues of A in parts.
   Both return 0 where they converge, -1 without memory. */
#ifdef SPARI_HAVE_LAPACK
static int solve_symmetric(int n, double *A, double *mu, double *workspace) {
    int bad, size = SPARI_SYMMETRIC_ROOM(n);
    SPARI_BLAS(dsyev_("V", "U", &n, A, &n, mu, workspace, &size, &bad, 1, 1));
    return bad;
}

static int solve_real(int n, double *A, double *re, double *im, double *workspace) {
    int bad, one = 1, size = SPARI_SYMMETRIC_ROOM(n);
    SPARI_BLAS(dgeev_("N", "N", &n, A, &n, re, im, NULL, &one, NULL, &one, workspace, &size, &bad, 1, 1));
    return bad;
}
#else
static int solve_symmetric(int n, double *A, double *mu, double *workspace) {
    gsl_matrix_view a = spari_gsl_matrix(A, n, n), z = spari_gsl_matrix(workspace + 4 * n, n, n);
    gsl_vector_view value = spari_gsl_vector(mu, n);
    gsl_eigen_symmv_workspace w = {(size_t)n, workspace, workspace + n, workspace + 2 * n, workspace + 3 * n};
    int bad;
    SPARI_GSL(bad = gsl_eigen_symmv(&a.matrix, &value.vector, &z.matrix, &w));
    (void)gsl_eigen_symmv_sort(&value.vector, &z.matrix, GSL_EIGEN_SORT_VAL_ASC);
    (void)gsl_matrix_transpose_memcpy(&a.matrix, &z.matrix);
    return bad;
}

static int solve_real(int n, double *A, double *re, double *im, double *workspace) {
    gsl_matrix_view a = spari_gsl_matrix(A, n, n);
    gsl_vector_complex_view value = gsl_vector_complex_view_array(workspace, (size_t)n);
    gsl_eigen_nonsymm_workspace *w;
    int bad = -1;
    SPARI_GSL(w = gsl_eigen_nonsymm_alloc((size_t)n));
    if (w) {
        gsl_eigen_nonsymm_params(0, 1, w);
        SPARI_GSL(bad = gsl_eigen_nonsymm(&a.matrix, &value.vector, w));
        gsl_eigen_nonsymm_free(w);
    }
    for (int i = 0; i < n; i++) {
        re[i] = workspace[2 * i], im[i] = workspace[2 * i + 1];
    }
    return bad;
}
#endif

int spari_symmetric(int n, double *A, double *mu, double *workspace) {
    int of_A;
    if (n < 1) {
        return SPAR_OK;
    }
    if (!bring_to_one((int64_t)n * n, A, &of_A) || solve_symmetric(n, A, mu, workspace)) {
        return SPAR_ERR_NUMERIC;
    }
    for (int k = 0; k < n; k++) {
        mu[k] = ldexp(mu[k], of_A);
    }
    return SPAR_OK;
}

int spari_eigenvalues(int n, double *A, double complex *z) {
    double *re = spari_zalloc(2 * (int64_t)n + SPARI_SYMMETRIC_ROOM((int64_t)n), sizeof *re), *im = re + n;
    int of_A, bad = -1;
    if (re) {
        bad = bring_to_one((int64_t)n * n, A, &of_A) ? solve_real(n, A, re, im, im + n) : 1;
    }
    int status = bad < 0 ? SPAR_ERR_MEMORY : bad ? SPAR_ERR_NUMERIC : SPAR_OK;
    for (int i = 0; i < n && status == SPAR_OK; i++) {
        z[i] = CMPLX(ldexp(re[i], of_A), ldexp(im[i], of_A));
    }
    free(re);
    return status;
}
