/* The functions of LAPACK that the library calls. They are Fortran's: the lengths of character arguments come last.
   Call them within SPARI_BLAS, with workspaces that the library has allocated. LAPACK ends the program when an argument
   is illegal, for some functions when an entry is NaN. So sizes must be positive and entries finite. */
#ifndef SPARI_LAPACK_H
#define SPARI_LAPACK_H

#include "../base/blas.h"

#include <complex.h>
#include <stddef.h>

void dsyev_(const char *vectors, const char *triangle, const int *n, double *A, const int *step, double *values,
            double *work, const int *size, int *info, size_t, size_t);
void dgeev_(const char *left, const char *right, const int *n, double *A, const int *step, double *re, double *im,
            double *x, const int *of_x, double *y, const int *of_y, double *work, const int *size, int *info, size_t,
            size_t);
void zgees_(const char *vectors, const char *sort, int (*chosen)(const double complex *), const int *n,
            double complex *A, const int *step, int *count, double complex *values, double complex *Q, const int *of_Q,
            double complex *work, const int *size, double *more, int *flags, int *info, size_t, size_t);
void ztrexc_(const char *vectors, const int *n, double complex *S, const int *step, double complex *Q, const int *of_Q,
             const int *from, const int *to, int *info, size_t);
void dgesvd_(const char *left, const char *right, const int *m, const int *n, double *A, const int *step,
             double *values, double *U, const int *of_U, double *VT, const int *of_VT, double *work, const int *size,
             int *info, size_t, size_t);

void dpotrf_(const char *triangle, const int *n, double *A, const int *step, int *info, size_t);
void dpbtrf_(const char *triangle, const int *n, const int *band, double *A, const int *step, int *info, size_t);
void dgels_(const char *transposed, const int *m, const int *n, const int *columns, double *A, const int *step,
            double *b, const int *of_b, double *work, const int *size, int *info, size_t);
void dgeqp3_(const int *m, const int *n, double *A, const int *step, int *order, double *tau, double *work,
             const int *size, int *info);
void dorgqr_(const int *m, const int *n, const int *reflectors, double *A, const int *step, const double *tau,
             double *work, const int *size, int *info);

#endif
