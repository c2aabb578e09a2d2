/* One call of BLAS at a time in the process: OpenBLAS for one thread (Debian's 0.3.21) hands out its work
   memory without a lock, so that two threads' products, factors or solutions at once get each other's numbers. Scalar
   products, sums of vectors and dger have no such memory. Held around factorisations too, which call them. */
#ifndef SPARI_BLAS_H
#define SPARI_BLAS_H

void spari_blas_begin(void);
void spari_blas_end(void);

#define SPARI_BLAS(call)                                                                                               \
    do {                                                                                                               \
        spari_blas_begin();                                                                                            \
        call;                                                                                                          \
        spari_blas_end();                                                                                              \
    } while (0)

#endif
