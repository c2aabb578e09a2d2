/* Serialises all BLAS calls of the process. OpenBLAS built for one thread (Debian's 0.3.21) hands out its work
   memory without a lock, so two threads that multiply, factor or solve at once corrupt each other's numbers. Scalar
   products, vector sums and dger use no work memory and need no lock. GSL's factorisations call BLAS and need the
   lock too. */
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
