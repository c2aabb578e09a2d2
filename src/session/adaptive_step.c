/* Performs a whole step with step-size control: spar_step_adaptive. */
#include "../base/environment.h"
#include "../comm/enter.h"
#include "../exchange/session_private.h"
#include "../member/check_arguments.h"
#include "callbacks.h"
#include "step.h"
#include "step_control.h"

#include <math.h>

static int check_within(spar_session *s, const char *call, const double *dt, double first) {
    SPARI_REQUIRE(s, dt, SPAR_ERR_ARGUMENT, "%s: dt is NULL", call);
    SPARI_TRY(spari_need_dt(s, call, first));
    SPARI_REQUIRE(s, spari_step_control_is_set(s), SPAR_ERR_STATE,
                  "%s: no tolerance is set; call spar_session_set_tolerance first", call);
    SPARI_TRY(spari_need_no_trial(s, call));
    return spari_need_idle(s, call);
}

/* Decrease of error/tolerance between two attempts as a power of dt: 2 or more for a smooth resolved motion, 1 for a
   jump of acceleration, 0 for a jump of velocity, -1 for rounding of positions (divided by dt^2 in the
   accelerations). */
typedef struct tries {
    double dt, ratio;
    double power;
    int stuck; /* consecutive attempts whose error hardly decreased */
} tries;

static void count_try(tries *t, double dt, double ratio) {
    static const double falls = 0.5;
    int again = t->dt > 0 && dt < t->dt && ratio > 0 && t->ratio > 0;
    t->power = again ? log(t->ratio / ratio) / log(t->dt / dt) : 2;
    t->stuck = t->power < falls ? t->stuck + 1 : 0;
    t->dt = dt, t->ratio = ratio;
}

/* Relative to the time since the beginning: a smaller dt is dominated by rounding of the clock. */
static const double clock_resolves = 1e-12;

static int fail_within(const spar_session *s, const char *call, const tries *t) {
    const char *why = "the motion needs smaller steps; start with a smaller dt or set a larger drift";
    int at_clock = 0.2 * t->dt <= clock_resolves * fabs(s->clock.time); /* propose_dt reduces to a fifth at most */
    if (t->stuck && t->power < -0.5) {
        why = "rounding of positions makes the error grow as dt decreases; set a larger drift or rtol";
    } else if (t->stuck || at_clock) {
        why = "the error does not decrease with dt: a velocity is discontinuous (an impact, a jump in a prescribed "
              "rate); smooth the jump, set a larger drift, or take this step with spar_step";
    }
    return spari_fail(s, SPAR_ERR_NUMERIC,
                      "%s: from t = %g no dt down to %g meets the tolerance; the error at the last dt is %.2g times "
                      "the tolerance: %s",
                      call, s->clock.time, t->dt, t->ratio, why);
}

int spar_step_adaptive(spar_session *session, double *dt, spar_before_step before, spar_fluid_solver solve,
                       void *context, double *dt_done) {
    SPARI_GUARD_ENVIRONMENT;
    enum { TRIES = 12, STUCK = 7 };
    SPARI_TRY(spari_callback_refuse(session, __func__));
    spar_session *s = session;
    double none = 0, *next = dt ? dt : &none, h = *next;
    const spari_agreed must_agree[] = {spari_real("dt", h), spari_given("before", before != NULL)};
    SPARI_TRY(spari_enter_agreed(s, __func__, must_agree, 2, check_within(s, __func__, dt, h)));
    tries done = {0};
    for (int k = 0; k < TRIES && done.stuck < STUCK && (k == 0 || h > clock_resolves * fabs(s->clock.time)); k++) {
        SPARI_TRY(spari_named(s, __func__, spari_callback_before_step(s, __func__, before, h, context)));
        SPARI_TRY(spari_named(s, __func__, spar_step_begin(s, h)));
        SPARI_TRY(spari_step_run(s, __func__, solve, context));
        count_try(&done, h, spari_step_control_ratio(s));
        if (done.ratio <= 1) {
            SPARI_TRY(spari_named(s, __func__, spar_step_accept(s)));
            *next = s->own->step_control.next;
            SPARI_GIVE(dt_done, h);
            return SPAR_OK;
        }
        SPARI_TRY(spari_named(s, __func__, spar_step_reject(s)));
        h = s->own->step_control.next;
    }
    return fail_within(s, __func__, &done);
}
