/* Calls of GSL. SPARI_GSL holds the lock of BLAS (base/blas.h), because GSL's factorisations call BLAS. It also
   switches GSL's error handler off for the call: the process has one handler, the default one aborts, and outside of
   these calls it is the host's. Every call that can fail, allocations included, stands in SPARI_GSL. */
#ifndef SPARI_GSL_H
#define SPARI_GSL_H

#include "../base/blas.h"

#include <gsl/gsl_eigen.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>

#define SPARI_GSL(call)                                                                                                \
    do {                                                                                                               \
        spari_blas_begin();                                                                                            \
        gsl_error_handler_t *host_handler = gsl_set_error_handler_off();                                               \
        call;                                                                                                          \
        (void)gsl_set_error_handler(host_handler);                                                                     \
        spari_blas_end();                                                                                              \
    } while (0)

static inline gsl_matrix_view spari_gsl_matrix(double *A, int rows, int columns) {
    return gsl_matrix_view_array(A, (size_t)rows, (size_t)columns);
}

static inline gsl_vector_view spari_gsl_vector(double *x, int n) {
    return gsl_vector_view_array(x, (size_t)n);
}

#endif
