/* The host's fluid solver inside a call of the library's: see callbacks.h. */
#include "callbacks.h"

#include "../base/environment.h"
#include "../comm/comm.h"

int spari_lend_refuse(spar_session *s, const char *call) {
    SPARI_REQUIRE(s, !s->lent, SPAR_ERR_STATE,
                  "%s: %s is under way and has called this fluid solver; pull, push and return from it, or make the "
                  "step by spar_step_begin, spar_step_solve, spar_step_check, spar_step_accept",
                  call, s->lent);
    return SPAR_OK;
}

int spari_lend(spar_session *s, const char *lender, spar_fluid_solver solve, double dt, void *context) {
    if (!solve) {
        return SPAR_OK;
    }
    int64_t failures = s->failures;
    spari_host host;
    s->calls_differ = 0;
    spari_host_begin(&host);
    s->lent = lender;
    int answer = solve(s, s->time, dt, s->iteration, context);
    s->lent = NULL;
    spari_host_end(&host);
    if (s->calls_differ) { /* only this rank made a collective call here; the other ranks have found that */
        return SPAR_ERR_COMM;
    }
    if (answer == 0) {
        return SPAR_OK;
    }
    int told = s->failures != failures; /* what went wrong there */
    return spari_fail(s, SPAR_ERR_USER, "%s: the fluid solver returned %d in iteration %d%s%.800s", lender, answer,
                      s->iteration, told ? ": " : "", told ? s->message : "");
}

int spari_lend_before(spar_session *s, spar_before_step before, double dt, void *context) {
    if (!before) {
        return SPAR_OK;
    }
    int64_t failures = s->failures;
    s->calls_differ = 0;
    spari_host host;
    spari_host_begin(&host);
    int answer = before(s, s->time, dt, context), status = SPAR_OK;
    spari_host_end(&host);
    if (s->calls_differ) { /* only this rank made a collective call here; the other ranks have found that */
        return SPAR_ERR_COMM;
    }
    if (answer != 0 && s->failures == failures) {
        status = spari_fail(s, SPAR_ERR_USER, "the host's call before a step returned %d", answer);
    } else if (answer != 0) {
        status = SPAR_ERR_USER;
    }
    return spari_comm_agree(s->comm, status, s->message, sizeof s->message);
}
