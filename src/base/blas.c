/* The process-wide lock around BLAS calls: see blas.h. */
#include "blas.h"

#include <pthread.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

void spari_blas_begin(void) {
    (void)pthread_mutex_lock(&lock);
}

void spari_blas_end(void) {
    (void)pthread_mutex_unlock(&lock);
}
