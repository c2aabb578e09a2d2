/* Distributes the solution of members and assemblies over threads: see work_shares.h. */
#include "work_shares.h"

#include "../assembly/assembly.h"
#include "../base/environment.h"
#include "../base/thread_pool.h"
#include "../coupling/coupling.h"
#include "../exchange/session_private.h"
#include "../fluid/fluid.h"
#include "../member/body.h"
#include "../member/structure.h"
#include "../solve/life.h"
#include "../time/fidelity.h"
#include "callbacks.h"

#include <stdlib.h>

/* A member without joints to others, or an assembly. */
typedef struct spari_unit {
    spar_member *member;
    spari_assembly *assembly;
    int status;
    char message[SPARI_MESSAGE_SIZE]; /* of a failure */
} spari_unit;

/* Refuses motions that are not finite: loads or a root's motion near the largest double. */
static int check_motion(const spar_member *m) {
    const spari_motion *x = &m->after;
    const struct {
        const double *value;
        int width;
    } all[] = {{x->q, 7}, {x->v, 6}, {x->a, 6}};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        int64_t bad = spari_first_nonfinite(all[k].value, all[k].width * m->nodes);
        SPARI_REQUIRE(m->session, bad < 0, SPAR_ERR_NUMERIC,
                      "member '%s': the motion of node %lld is not finite in the step from t = %g; check its loads, "
                      "gravity, the motion of its root, and their units",
                      m->name, (long long)(bad / all[k].width), m->session->clock.time);
    }
    return spari_member_check_rotations(m);
}

static int solve_unit(spar_session *s, spar_member *m, spari_assembly *a) {
    if (a) {
        return spari_assembly_advance(a, s->clock.dt, spari_coupling_weighs(s));
    }
    SPARI_TRY(m->row->component ? spari_lone_advance(m, s->clock.dt) : m->row->advance(m, s->clock.dt));
    return m->row->moves ? check_motion(m) : SPAR_OK;
}

static int is_unit(const spar_member *m) {
    return !m->assembly && (m->row->component || m->row->advance) && spari_fidelity_is_here(m);
}

/* Members with prescribed motion come first, because assemblies read it. */
static int is_prescribed(const spar_member *m) {
    return !m->row->component;
}

/* ---- sequential ---- */

/* After a failure, whose message stays, the others are still solved. */
static int solve_next(spar_session *s, spar_member *m, spari_assembly *a, int status) {
    char unheard[SPARI_MESSAGE_SIZE];
    if (status == SPAR_OK) {
        return solve_unit(s, m, a);
    }
    (void)spari_messages_redirect(unheard);
    (void)solve_unit(s, m, a);
    (void)spari_messages_redirect(NULL);
    return status;
}

static int solve_in_turn(spar_session *s, int status) {
    for (spar_member *m = s->members; m; m = m->next) {
        status = is_unit(m) && !is_prescribed(m) ? solve_next(s, m, NULL, status) : status;
    }
    for (spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        status = solve_next(s, NULL, a, status);
    }
    return status;
}

/* ---- parallel ---- */

static void solve_item(void *context, int64_t item, int worker) {
    spar_session *s = context;
    spari_unit *u = s->own->unit + item;
    (void)worker;
    (void)spari_messages_redirect(u->message);
    u->status = solve_unit(s, u->member, u->assembly);
    (void)spari_messages_redirect(NULL);
}

static int64_t list_units(const spar_session *s, spari_unit *unit) {
    int64_t n = 0;
    for (spar_member *m = s->members; m; m = m->next) {
        if (is_unit(m) && !is_prescribed(m)) {
            unit[n].member = m, unit[n++].assembly = NULL;
        }
    }
    for (spari_assembly *a = s->assemblies; a; a = spari_assembly_next(a)) {
        unit[n].member = NULL, unit[n++].assembly = a;
    }
    return n;
}

/* With fewer units than threads the elements of each unit are distributed instead (spari_body_sweep); also for a host
   that hears of each iteration, in its own thread. */
static int solve_units(spar_session *s) {
    int ready = s->pool && s->own->listed == s->member_count; /* not in a step that came from a file */
    int64_t n = ready ? list_units(s, s->own->unit) : 0;
    int status = SPAR_OK;
    for (spar_member *m = s->members; m; m = m->next) {
        status = is_unit(m) && is_prescribed(m) ? solve_next(s, m, NULL, status) : status;
    }
    if (n < 2 || n < spari_thread_pool_threads(s->pool) || s->callbacks.progress) {
        return solve_in_turn(s, status);
    }
    spari_thread_pool_run(s->pool, n, solve_item, s);
    for (const spari_unit *u = s->own->unit; u < s->own->unit + n && status == SPAR_OK; u++) {
        SPARI_REQUIRE(s, u->status == SPAR_OK, u->status, "%s", u->message);
    }
    return status;
}

int spari_threads_solve(spar_session *s) {
    SPARI_TRY(solve_units(s));
    for (spar_member *m = s->members; m && s->assemblies; m = m->next) {
        SPARI_TRY(m->assembly ? check_motion(m) : SPAR_OK);
    }
    return SPAR_OK;
}

static int make_units(spar_session *s, int64_t most) {
    spari_unit *unit = spari_zalloc(most, sizeof *unit);
    spar_member **member = spari_zalloc(most, sizeof(spar_member *));
    if (!unit || !member) {
        SPARI_FREE(unit, member);
        return spari_fail(s, SPAR_ERR_MEMORY, "no memory for the worker threads");
    }
    SPARI_FREE(s->own->unit, s->own->member);
    s->own->unit = unit, s->own->member = member, s->own->unit_capacity = most;
    return SPAR_OK;
}

int spari_threads_prepare(spar_session *s) {
    int64_t most = (int64_t)s->member_count + s->joint_count; /* a joint between driven nodes is a unit of its own */
    s->own->listed = 0;
    if (!s->pool) {
        return SPAR_OK;
    }
    SPARI_TRY(most > s->own->unit_capacity ? make_units(s, most) : SPAR_OK);
    for (spar_member *m = s->members; m; m = m->next) {
        s->own->member[s->own->listed++] = m;
    }
    return SPAR_OK;
}

/* ---- per member ---- */

/* Members per thread item. */
enum { BATCH = 16 };

typedef struct member_batch {
    spar_member **member;
    spari_member_task task;
    const void *context;
} member_batch;

static void do_batch(void *context, int64_t from, int64_t to) {
    const member_batch *t = context;
    for (int64_t k = from; k < to; k++) {
        t->task(t->member[k], t->context);
    }
}

void spari_threads_each(spar_session *s, spari_member_task task, const void *context) {
    if (s->pool && s->own->listed == s->member_count && s->own->listed > BATCH) {
        spari_thread_pool_run_spans(s->pool, s->own->listed, BATCH, do_batch,
                                    &(member_batch){s->own->member, task, context});
        return;
    }
    for (spar_member *m = s->members; m; m = m->next) {
        task(m, context);
    }
}

void spari_threads_free(spar_session *s) {
    spari_thread_pool_free(s->pool);
    SPARI_FREE(s->own->unit, s->own->member);
    s->pool = NULL;
    s->own->unit = NULL, s->own->member = NULL, s->own->unit_capacity = s->own->listed = 0;
}

/* ---- public calls ---- */

/* Allocates the threads' workspace for the largest element and for the fluids' tiles. */
static int reserve_workspace(const spar_session *s, spari_thread_pool *pool) {
    int failed = 0;
    for (const spar_member *m = s->members; m && !failed; m = m->next) {
        failed = m->body && spari_thread_pool_reserve(pool, spari_body_workspace_size(m->body));
    }
    for (const spar_fluid *f = s->fluids; f && !failed; f = spari_fluid_next(f)) {
        failed = spari_thread_pool_reserve(pool, spari_fluid_workspace_size(f));
    }
    return failed;
}

int spar_session_set_threads(spar_session *session, int threads) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    spar_session *s = session;
    SPARI_REQUIRE(s, s->state.phase == SPARI_IDLE, SPAR_ERR_STATE,
                  "%s: a step is in progress; change the number of threads between steps", __func__);
    SPARI_TRY(spari_callback_refuse(session, __func__));
    SPARI_REQUIRE(s, threads >= 1 && threads <= SPARI_MOST_THREADS, SPAR_ERR_ARGUMENT, "%s: %d threads; give 1 to %d",
                  __func__, threads, SPARI_MOST_THREADS);
    if (threads == spari_thread_pool_threads(s->pool)) {
        return SPAR_OK;
    }
    spari_thread_pool *pool = threads > 1 ? spari_thread_pool_create(threads) : NULL;
    if (threads > 1 && (!pool || reserve_workspace(s, pool))) {
        spari_thread_pool_free(pool);
        return spari_fail(s, SPAR_ERR_MEMORY,
                          "%s: the system has no memory for %d threads, or allows fewer; request fewer", __func__,
                          threads);
    }
    spari_threads_free(s);
    s->pool = pool;
    return SPAR_OK;
}

int spar_session_get_threads(const spar_session *session, int *threads) {
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    SPARI_GIVE(threads, spari_thread_pool_threads(session->pool));
    return SPAR_OK;
}
