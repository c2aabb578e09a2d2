/* Worker threads (spar_session_set_threads). A run distributes items over the threads; the function for an item
   writes to that item alone, so results are the same bits with any number of threads. A NULL pool means the calling
   thread alone, and so does the pool of the parent in a forked child. */
#ifndef SPARI_THREAD_POOL_H
#define SPARI_THREAD_POOL_H

#include <stdint.h>

enum { SPARI_MOST_THREADS = 64 };

typedef struct spari_thread_pool spari_thread_pool;
/* Processes one item. worker: 0 (the calling thread) to threads - 1. */
typedef void (*spari_task)(void *context, int64_t item, int worker);

/* The calling thread and threads - 1 waiting threads. NULL: no memory, or no more threads. */
spari_thread_pool *spari_thread_pool_create(int threads);
void spari_thread_pool_free(spari_thread_pool *pool);
/* 1 if thread pool is NULL */
int spari_thread_pool_threads(const spari_thread_pool *pool);
/* Processes items 0 to items - 1 and returns when all are done. The floating-point environment is the caller's
   (environment.h). Called from inside an item, or with thread pool NULL, it processes them in order in the calling
   thread. */
void spari_thread_pool_run(spari_thread_pool *pool, int64_t items, spari_task task, void *context);
/* Processes the numbers [from, to). */
typedef void (*spari_span)(void *context, int64_t from, int64_t to);
/* Processes 0 to n - 1 in spans, as spari_thread_pool_run does items. The result for a number may depend on that number
   alone. */
void spari_thread_pool_run_spans(spari_thread_pool *pool, int64_t n, int64_t span, spari_span work, void *context);
static inline void spari_thread_pool_spread(spari_thread_pool *pool, int64_t n, int64_t span, spari_span work,
                                            void *context) {
    if (n <= span) {
        work(context, 0, n);
    } else {
        spari_thread_pool_run_spans(pool, n, span, work, context);
    }
}
/* Whether a run would use several threads: there is a pool, and this thread is not inside an item. */
int spari_thread_pool_is_free(const spari_thread_pool *pool);

/* Allocates workspace of at least this size for every worker but the first, which has the caller's. 0, or 1: no
   memory. */
int spari_thread_pool_reserve(spari_thread_pool *pool, int64_t doubles);
/* Workspace of a worker. NULL: that much has not been allocated. */
double *spari_thread_pool_workspace(const spari_thread_pool *pool, int worker, int64_t doubles);
/* The worker of the pool that the calling thread is: 0 unless it is inside an item of one of the others. */
int spari_thread_pool_worker(const spari_thread_pool *pool);

#endif
