/* Creates and destroys a session, and returns its time. */
#include "../coupling/coupling.h"
#include "../exchange/session_private.h"
#include "callbacks.h"
#include "settings.h"
#include "work_shares.h"

#include "../assembly/assembly.h"
#include "../base/environment.h"
#include "../comm/comm.h"
#include "../fluid/fluid.h"
#include "../member/joint.h"
#include "../member/structure.h"
#include "../solve/life.h"

#include <stdio.h>
#include <stdlib.h>

static spar_session *session_new(void) {
    struct whole {
        spar_session initial;
        spari_own own;
    } *whole = spari_zalloc(1, sizeof *whole);
    if (!whole) {
        return NULL;
    }
    spar_session *s = &whole->initial; /* first member: freed as one */
    s->own = &whole->own;
    spari_settings_default(s);
    return s;
}

int spar_session_create(spar_session **session) {
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the pointer to the new session is NULL", __func__);
    spar_session *s = session_new();
    int status = s ? spari_comm_create_self(&s->ranks.comm) : SPAR_ERR_MEMORY;
    if (!s || status != SPAR_OK) {
        free(s);
        return spari_fail(NULL, SPAR_ERR_MEMORY, "%s: no memory for the session", __func__);
    }
    *session = s;
    return SPAR_OK;
}

/* All ranks get a session or none: steps that can fail on one rank are agreed on over the communicator. */
int spar_session_create_fcomm(int comm, spar_session **session) {
    char why[SPARI_MESSAGE_SIZE / 2] = "no memory for the session";
    spari_comm *ranks = NULL;
    spar_session *s = session ? session_new() : NULL;
    int status = s ? SPAR_OK : SPAR_ERR_MEMORY;
    if (!session) {
        status = SPAR_ERR_ARGUMENT;
        (void)snprintf(why, sizeof why, "the pointer to the new session is NULL");
    }
    status = spari_comm_create_fortran(comm, &ranks, status, why, sizeof why);
    if (status != SPAR_OK || !s) {
        free(s);
        return spari_fail(NULL, status, "%s: %s", __func__, why);
    }
    s->ranks.comm = ranks;
    *session = s;
    return SPAR_OK;
}

void spar_session_destroy(spar_session **session) {
    if (!session || !*session) {
        return;
    }
    spar_session *s = *session;
    for (spar_fluid *f = s->fluids, *next; f; f = next) {
        next = spari_fluid_next(f);
        spari_fluid_free(f);
    }
    spari_assemblies_free(s);
    for (spar_joint *j = s->joints, *next; j; j = next) {
        next = j->next;
        spari_joint_free(j);
    }
    for (spar_member *m = s->members, *next; m; m = next) {
        next = m->next;
        spari_member_free(m);
    }
    for (int i = 0; i < s->warning_count; i++) {
        free(s->warnings[i]);
    }
    spari_threads_free(s);
    spari_names_free(&s->member_names);
    spari_names_free(&s->joint_names);
    spari_workspace_free(&s->workspace);
    spari_workspace_free(&s->bodies);
    spari_comm_destroy(&s->ranks.comm);
    spari_coupling_free(&s->own->coupling);
    spari_coupling_free(&s->own->suspended);
    if (s->own->free_trials) {
        s->own->free_trials(s->own->trials);
    }
    SPARI_FREE(s->own->exchange.pack, s->own->bins, s->own->exchange.first, s->own->exchange.motion, s);
    *session = NULL;
}

int spar_session_set_log(spar_session *session, spar_log log, void *context) {
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    session->callbacks.log = log;
    session->callbacks.log_context = context;
    return SPAR_OK;
}

int spar_session_set_progress(spar_session *session, spar_progress progress, void *context) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_callback_refuse(session, __func__));
    session->callbacks.progress = progress;
    session->callbacks.progress_context = context;
    return SPAR_OK;
}

int spar_session_get_time(const spar_session *session, double *t, int64_t *step, int *iteration) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    SPARI_GIVE(t, session->clock.time);
    SPARI_GIVE(step, session->clock.step);
    SPARI_GIVE(iteration, session->state.iteration);
    return SPAR_OK;
}

int spar_session_get_phase(const spar_session *session, int *phase) {
    static const int result[] = {
        [SPARI_BEGUN] = SPAR_PHASE_BEGUN, [SPARI_SOLVED] = SPAR_PHASE_SOLVED, [SPARI_CHECKED] = SPAR_PHASE_CHECKED};
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    if (phase) {
        int rest = session->clock.started ? SPAR_PHASE_BETWEEN : SPAR_PHASE_START;
        *phase = session->state.phase == SPARI_IDLE ? rest : result[session->state.phase];
    }
    return SPAR_OK;
}
