/* Counts the Newton iterations of a step or static solution: see budget.h. */
#include "budget.h"

#include "environment.h"

void spari_budget_begin(spar_session *s) {
    s->callbacks.cancelled = 0;
}

static int is_used_up(const spar_session *s, const spari_spent *spent, int64_t most) {
    return spent->call == s->clock.begun && spent->iterations >= most;
}

/* In trials the trial's own callback is told, between the runs. */
static void tell_progress(spar_session *s, const spari_spent *spent, int64_t most) {
    const char *lender = s->callbacks.in_progress;
    spari_host host;
    spari_host_begin(&host);
    s->callbacks.in_progress = "a solution that tells its progress";
    s->callbacks.cancelled =
        s->callbacks.progress(s, (double)spent->iterations, (double)most, s->callbacks.progress_context);
    s->callbacks.in_progress = lender;
    spari_host_end(&host);
}

int spari_budget_allows(spar_session *s, spari_spent *spent, int64_t most) {
    if (spent->call != s->clock.begun) {
        *spent = (spari_spent){.call = s->clock.begun};
    }
    if (s->callbacks.progress && !s->callbacks.cancelled && !s->state.trial) {
        tell_progress(s, spent, most);
    }
    if (spari_budget_is_over(s, spent, most)) {
        return 0;
    }
    spent->iterations++;
    return 1;
}

int spari_budget_is_over(const spar_session *s, const spari_spent *spent, int64_t most) {
    return s->callbacks.cancelled != 0 || is_used_up(s, spent, most);
}

int spari_budget_cancelled(const spar_session *s, const char *name, const spari_spent *spent) {
    SPARI_REQUIRE(s, !s->callbacks.cancelled, SPAR_ERR_USER,
                  "%s: cancelled by the progress callback (%d) after %lld Newton iterations", name,
                  s->callbacks.cancelled, (long long)spent->iterations);
    return SPAR_OK;
}
