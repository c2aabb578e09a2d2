/* Threads that a host has asked for (spar_session_set_threads), and what they do together: so many items, each done by
   whichever thread is free, by functions that write to their own item alone. What comes out may depend on the items but
   on nothing else: the same bits with any number of threads. A crew that is NULL is the calling thread alone,
   and so is one in a child of the process that made it (fork). */
#ifndef SPARI_CREW_H
#define SPARI_CREW_H

#include <stdint.h>

enum { SPARI_CREW_MOST = 64 };

typedef struct spari_crew spari_crew;
/* One item; worker 0 (the thread that called) to threads - 1. */
typedef void (*spari_task)(void *context, int64_t item, int worker);

/* The calling thread and threads - 1 more, which wait. NULL: there is no memory, or there are no more threads. */
spari_crew *spari_crew_create(int threads);
void spari_crew_free(spari_crew *crew);
/* 1 for none */
int spari_crew_threads(const spari_crew *crew);
/* Items 0 to items - 1; returns when all are done. The surroundings (quiet.h) are those of the caller. From inside an
   item, and without a crew: one after the other in the calling thread. */
void spari_crew_run(spari_crew *crew, int64_t items, spari_task task, void *context);
/* [from, to) of them. */
typedef void (*spari_span)(void *context, int64_t from, int64_t to);
/* 0 to n - 1 in spans of `span`, as run does items. What comes out of a number may depend on nothing but that number.
 */
void spari_crew_spans(spari_crew *crew, int64_t n, int64_t span, spari_span work, void *context);
static inline void spari_crew_spread(spari_crew *crew, int64_t n, int64_t span, spari_span work, void *context) {
    if (n <= span) {
        work(context, 0, n);
    } else {
        spari_crew_spans(crew, n, span, work, context);
    }
}
/* Whether run would share them out: there is a crew, and none of its items is under way in this thread. */
int spari_crew_is_free(const spari_crew *crew);

/* Work space of every worker but the first, who has the caller's: so many doubles at least. 0, or 1: no memory. */
int spari_crew_keep(spari_crew *crew, int64_t doubles);
/* NULL: that much has not been kept. */
double *spari_crew_room(const spari_crew *crew, int worker, int64_t doubles);

#endif
