/* Calls the functions of the host from inside a public call: see callbacks.h. */
#include "callbacks.h"

#include "../base/environment.h"
#include "../comm/enter.h"

int spari_callback_refuse(spar_session *s, const char *call) {
    SPARI_REQUIRE(NULL, s, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", call);
    SPARI_REQUIRE(s, !s->callbacks.in_progress, SPAR_ERR_STATE,
                  "%s: %s is in progress and has called this function of the host; in a fluid solver only pull and "
                  "push, before a step only drive roots and set loads, or make the steps with spar_step_begin, "
                  "spar_step_solve, spar_step_check, spar_step_accept",
                  call, s->callbacks.in_progress);
    return SPAR_OK;
}

int spari_callback_run(spar_session *s, const char *lender, spar_fluid_solver solve, double dt, void *context) {
    if (!solve) {
        return SPAR_OK;
    }
    int64_t failures = s->failures;
    spari_host host;
    s->ranks.calls_differ = 0;
    spari_host_begin(&host);
    s->callbacks.in_progress = lender;
    int result = solve(s, s->clock.time, dt, s->state.iteration, context);
    s->callbacks.in_progress = NULL;
    spari_host_end(&host);
    if (s->ranks.calls_differ) { /* only this rank made a collective call here; the other ranks have found that */
        return SPAR_ERR_COMM;
    }
    if (result == 0) {
        return SPAR_OK;
    }
    int told = s->failures != failures; /* the failure there */
    return spari_fail(s, SPAR_ERR_USER, "%s: the fluid solver returned %d in iteration %d%s%.800s", lender, result,
                      s->state.iteration, told ? ": " : "", told ? s->message : "");
}

int spari_callback_before_step(spar_session *s, const char *lender, spar_before_step before, double dt, void *context) {
    if (!before) {
        return SPAR_OK;
    }
    int64_t failures = s->failures;
    s->ranks.calls_differ = 0;
    spari_host host;
    spari_host_begin(&host);
    s->callbacks.in_progress = lender;
    int result = before(s, s->clock.time, dt, context), status = SPAR_OK;
    s->callbacks.in_progress = NULL;
    spari_host_end(&host);
    if (s->ranks.calls_differ) { /* only this rank made a collective call here; the other ranks have found that */
        return SPAR_ERR_COMM;
    }
    if (result != 0 && s->failures == failures) {
        status = spari_fail(s, SPAR_ERR_USER, "the host's callback before the step returned %d", result);
    } else if (result != 0) {
        status = SPAR_ERR_USER;
    }
    return spari_agree(s, status);
}

/* ---- how far trials are ---- */

/* Between trials the session stands as the host left it; what would try or save it is refused as within one. */
static int ask_host(spar_session *s, const spari_progress *p, double done, double expected) {
    spari_host host;
    s->ranks.calls_differ = 0;
    spari_host_begin(&host);
    s->state.trial = 1;
    int result = p->tell(s, done, expected, p->context);
    s->state.trial = 0;
    spari_host_end(&host);
    if (s->ranks.calls_differ) { /* only this rank made a collective call here; the other ranks have found that */
        return SPAR_ERR_COMM;
    }
    int status = result == 0
                     ? SPAR_OK
                     : spari_fail(s, SPAR_ERR_USER,
                                  "%s: cancelled by the progress callback (%d) after %.3g of %.3g expected trials",
                                  p->call, result, done, expected);
    return spari_agree(s, status);
}

int spari_progress_tell(spar_session *s, spari_progress *p, double done, double expected) {
    if (!p->tell) {
        return SPAR_OK;
    }
    p->stopped = ask_host(s, p, done, expected);
    return p->stopped == SPAR_OK ? SPAR_OK : SPAR_ERR_LIMIT;
}

int spari_progress_ends(const spari_progress *p, int status) {
    return p->stopped != SPAR_OK ? p->stopped : status;
}
