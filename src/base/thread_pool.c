/* A pool of POSIX threads: see thread_pool.h. */
#include "thread_pool.h"

#include "environment.h"
#include "poison.h"
#include "status.h"
#include "workspace.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <unistd.h>

/* Polls before a thread sleeps: about ten microseconds, the time that sleeping and waking take. */
enum { SPIN = 4000 };

/* Range of items that a worker takes first: [next, end). Each worker has the same range in each round of equal size,
   so that its data are in its cache. A worker that has finished takes items of the others. Counters written by
   several threads are on cache lines of their own. */
typedef struct share {
    atomic_llong next;
    int64_t end;
    char apart[112];
} share;

typedef struct worker_thread {
    spari_thread_pool *pool;
    pthread_t thread;
    int number;
    spari_workspace workspace;
} worker_thread;

struct spari_thread_pool {
    int threads;
    pid_t process;          /* process that created the threads: a forked child has the memory but not the threads */
    worker_thread *workers; /* [threads]; the first is the calling thread */
    share *share;           /* [threads] */
    int64_t kept;           /* size of each worker's workspace, in doubles */
    pthread_mutex_t lock;
    pthread_cond_t begun, ended;
    atomic_long round;  /* number of rounds so far */
    atomic_int at_work; /* threads that have not finished the round */
    atomic_int stop;    /* tells the threads to end */
    spari_task task;
    void *context;
    fenv_t surroundings;
};

/* This thread is working on an item of this pool, as this worker. */
static _Thread_local const spari_thread_pool *inside;
static _Thread_local int inside_as;

static inline void rest(void) {
#if defined(__GNUC__) && defined(__x86_64__)
    __builtin_ia32_pause();
#endif
}

/* Takes items until none is left, beginning with its own. */
static void work_on(spari_thread_pool *c, int worker) {
    inside = c, inside_as = worker;
    for (int k = 0; k < c->threads; k++) {
        share *s = c->share + (worker + k) % c->threads;
        for (int64_t i; (i = atomic_fetch_add_explicit(&s->next, 1, memory_order_relaxed)) < s->end;) {
            c->task(c->context, i, worker);
        }
    }
    inside = NULL;
}

static void share_out(spari_thread_pool *c, int64_t items) {
    int64_t each = items / c->threads, more = items % c->threads, from = 0;
    for (int k = 0; k < c->threads; k++) {
        share *s = c->share + k;
        s->end = from + each + (k < more);
        atomic_store_explicit(&s->next, from, memory_order_relaxed);
        from = s->end;
    }
}

/* Waits for the round after `last`. */
static long next_round(spari_thread_pool *c, long last) {
    long round = last;
    for (int k = 0; k < SPIN && round == last; k++) {
        rest();
        round = atomic_load_explicit(&c->round, memory_order_acquire);
    }
    if (round == last) {
        (void)pthread_mutex_lock(&c->lock);
        while ((round = atomic_load_explicit(&c->round, memory_order_acquire)) == last) {
            (void)pthread_cond_wait(&c->begun, &c->lock);
        }
        (void)pthread_mutex_unlock(&c->lock);
    }
    return round;
}

static void *serve(void *argument) {
    const worker_thread *h = argument;
    spari_thread_pool *c = h->pool;
    for (long round = 0;;) {
        round = next_round(c, round);
        if (atomic_load(&c->stop)) {
            return NULL;
        }
        spari_environment_begin();
        (void)fesetenv(&c->surroundings); /* rounding mode and denormal handling of the calling thread */
        work_on(c, h->number);
        spari_environment_end();
        if (atomic_fetch_sub_explicit(&c->at_work, 1, memory_order_acq_rel) == 1) {
            (void)pthread_mutex_lock(&c->lock);
            (void)pthread_cond_signal(&c->ended);
            (void)pthread_mutex_unlock(&c->lock);
        }
    }
}

/* Wakes all threads for a round, or to end. */
static void wake_workers(spari_thread_pool *c) {
    (void)pthread_mutex_lock(&c->lock);
    atomic_fetch_add_explicit(&c->round, 1, memory_order_release);
    (void)pthread_cond_broadcast(&c->begun);
    (void)pthread_mutex_unlock(&c->lock);
}

static void wait_for_workers(spari_thread_pool *c) {
    for (int k = 0; k < SPIN && atomic_load_explicit(&c->at_work, memory_order_acquire) > 0; k++) {
        rest();
    }
    if (atomic_load_explicit(&c->at_work, memory_order_acquire) > 0) {
        (void)pthread_mutex_lock(&c->lock);
        while (atomic_load_explicit(&c->at_work, memory_order_acquire) > 0) {
            (void)pthread_cond_wait(&c->ended, &c->lock);
        }
        (void)pthread_mutex_unlock(&c->lock);
    }
}

static int is_of_this_process(const spari_thread_pool *c) {
    return c->process == getpid();
}

static void dismiss(spari_thread_pool *c) {
    if (is_of_this_process(c)) { /* a forked child has no threads to wait for */
        atomic_store(&c->stop, 1);
        wake_workers(c);
        for (int k = 1; k < c->threads; k++) {
            (void)pthread_join(c->workers[k].thread, NULL);
        }
        (void)pthread_cond_destroy(&c->ended);
        (void)pthread_cond_destroy(&c->begun);
        (void)pthread_mutex_destroy(&c->lock);
    }
    for (int k = 1; k < c->threads; k++) {
        spari_workspace_free(&c->workers[k].workspace);
    }
    SPARI_FREE(c->workers, c->share, c);
}

/* Signals of the process go to the host's threads. */
static int start_worker(worker_thread *h) {
    sigset_t all, before;
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_SETMASK, &all, &before);
    int failed = pthread_create(&h->thread, NULL, serve, h);
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    return failed;
}

spari_thread_pool *spari_thread_pool_create(int threads) {
    spari_thread_pool *c = spari_zalloc(1, sizeof *c);
    worker_thread *workers = spari_zalloc(threads, sizeof *workers);
    share *shares = spari_zalloc(threads, sizeof *shares);
    if (!c || !workers || !shares) {
        SPARI_FREE(c, workers, shares);
        return NULL;
    }
    c->workers = workers, c->share = shares;
    c->process = getpid();
    (void)pthread_mutex_init(&c->lock, NULL); /* cannot fail with default attributes */
    (void)pthread_cond_init(&c->begun, NULL);
    (void)pthread_cond_init(&c->ended, NULL);
    for (c->threads = 1; c->threads < threads; c->threads++) {
        worker_thread *h = workers + c->threads;
        *h = (worker_thread){.pool = c, .number = c->threads};
        if (start_worker(h) != 0) {
            dismiss(c);
            return NULL;
        }
    }
    return c;
}

void spari_thread_pool_free(spari_thread_pool *pool) {
    if (pool) {
        dismiss(pool);
    }
}

int spari_thread_pool_threads(const spari_thread_pool *pool) {
    return pool && is_of_this_process(pool) ? pool->threads : 1;
}

int spari_thread_pool_is_free(const spari_thread_pool *pool) {
    return pool && !inside && is_of_this_process(pool);
}

void spari_thread_pool_run(spari_thread_pool *pool, int64_t items, spari_task task, void *context) {
    if (items < 2 || !spari_thread_pool_is_free(pool)) {
        for (int64_t i = 0; i < items; i++) {
            task(context, i, 0);
        }
        return;
    }
#ifdef SPAR_POISON
    for (int k = 1; k < pool->threads; k++) { /* results of a round may stay there until the next */
        spari_poison(spari_workspace_at(&pool->workers[k].workspace, pool->kept), pool->kept);
    }
#endif
    pool->task = task, pool->context = context;
    (void)fegetenv(&pool->surroundings);
    share_out(pool, items);
    atomic_store_explicit(&pool->at_work, pool->threads - 1, memory_order_relaxed);
    wake_workers(pool);
    work_on(pool, 0);
    wait_for_workers(pool);
}

typedef struct span_task {
    int64_t n, span;
    spari_span work;
    void *context;
} span_task;

static void do_span(void *context, int64_t item, int worker) {
    const span_task *s = context;
    int64_t from = item * s->span;
    (void)worker;
    s->work(s->context, from, from + s->span < s->n ? from + s->span : s->n);
}

void spari_thread_pool_run_spans(spari_thread_pool *pool, int64_t n, int64_t span, spari_span work, void *context) {
    span_task s = {n, span, work, context};
    spari_thread_pool_run(pool, (n + span - 1) / span, do_span, &s);
}

int spari_thread_pool_reserve(spari_thread_pool *pool, int64_t doubles) {
    if (!pool || doubles <= pool->kept) {
        return 0;
    }
    for (int k = 1; k < pool->threads; k++) {
        if (spari_workspace_reserve(&pool->workers[k].workspace, doubles)) {
            return 1;
        }
    }
    pool->kept = doubles;
    return 0;
}

double *spari_thread_pool_workspace(const spari_thread_pool *pool, int worker, int64_t doubles) {
    return pool && doubles <= pool->kept ? spari_workspace_at(&pool->workers[worker].workspace, doubles) : NULL;
}

int spari_thread_pool_worker(const spari_thread_pool *pool) {
    return pool && inside == pool ? inside_as : 0;
}
