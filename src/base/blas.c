/* The process-wide lock around BLAS calls: see blas.h. */
#include "blas.h"

#include <pthread.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static void take_lock(void) {
    (void)pthread_mutex_lock(&lock);
}

/* A lock that another thread holds would stay locked in the child of a fork. */
static void prepare_for_fork(void) {
    (void)pthread_atfork(take_lock, spari_blas_end, spari_blas_end);
}

void spari_blas_begin(void) {
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    (void)pthread_once(&once, prepare_for_fork);
    take_lock();
}

void spari_blas_end(void) {
    (void)pthread_mutex_unlock(&lock);
}
