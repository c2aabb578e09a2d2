/* Worker threads (spar_session_set_threads). A run distributes items over the threads; the function for an item
   writes to that item alone, so results are the same bits with any number of threads. A NULL pool means the calling
   thread alone, and so does the pool of the parent in a forked child. */
#ifndef SPARI_CREW_H
#define SPARI_CREW_H

#include <stdint.h>

enum { SPARI_CREW_MOST = 64 };

typedef struct spari_crew spari_crew;
/* Processes one item. worker: 0 (the calling thread) to threads - 1. */
typedef void (*spari_task)(void *context, int64_t item, int worker);

/* The calling thread and threads - 1 waiting threads. NULL: no memory, or no more threads. */
spari_crew *spari_crew_create(int threads);
void spari_crew_free(spari_crew *crew);
/* 1 if crew is NULL */
int spari_crew_threads(const spari_crew *crew);
/* Processes items 0 to items - 1 and returns when all are done. The floating-point environment is the caller's
   (environment.h). Called from inside an item, or with crew NULL, it processes them in order in the calling thread. */
void spari_crew_run(spari_crew *crew, int64_t items, spari_task task, void *context);
/* Processes the numbers [from, to). */
typedef void (*spari_span)(void *context, int64_t from, int64_t to);
/* Processes 0 to n - 1 in spans, as spari_crew_run does items. The result for a number may depend on that number
   alone. */
void spari_crew_spans(spari_crew *crew, int64_t n, int64_t span, spari_span work, void *context);
static inline void spari_crew_spread(spari_crew *crew, int64_t n, int64_t span, spari_span work, void *context) {
    if (n <= span) {
        work(context, 0, n);
    } else {
        spari_crew_spans(crew, n, span, work, context);
    }
}
/* Whether a run would use several threads: there is a pool, and this thread is not inside an item. */
int spari_crew_is_free(const spari_crew *crew);

/* Allocates workspace of at least this size for every worker but the first, which has the caller's. 0, or 1: no
   memory. */
int spari_crew_keep(spari_crew *crew, int64_t doubles);
/* Workspace of a worker. NULL: that much has not been allocated. */
double *spari_crew_room(const spari_crew *crew, int worker, int64_t doubles);

#endif
