/* A whole step to a tolerance. */
#include "../base/quiet.h"
#include "../comm/enter.h"
#include "lend.h"
#include "own.h"
#include "pace.h"
#include "step.h"

#include <math.h>

static int check_within(spar_session *s, const char *call, const double *dt, double first) {
    SPARI_REQUIRE(s, dt && isfinite(first) && first > 0, SPAR_ERR_ARGUMENT,
                  "%s: dt is NULL, or not a positive number of seconds", call);
    SPARI_REQUIRE(s, spari_pace_is_set(s), SPAR_ERR_STATE,
                  "%s: no tolerance is set; call spar_session_set_tolerance first", call);
    SPARI_REQUIRE(s, !s->trial, SPAR_ERR_STATE, "%s: a trial run is under way", call);
    SPARI_REQUIRE(s, s->phase == SPARI_IDLE, SPAR_ERR_STATE, "%s: a step is under way; accept or reject it first",
                  call);
    return spari_pace_check(s, call);
}

int spar_step_within(spar_session *session, double *dt, spar_before_step before, spar_fluid_solver solve, void *context,
                     double *taken) {
    SPARI_QUIET;
    enum { TRIES = 12 };
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    spar_session *s = session;
    SPARI_TRY(spari_lend_refuse(s, __func__));
    double none = 0, *next = dt ? dt : &none, h = *next;
    const spari_alike alike[] = {spari_real("dt", h), spari_given("before", before != NULL)};
    SPARI_TRY(spari_enter_alike(s, __func__, alike, 2, check_within(s, __func__, dt, h)));
    for (int k = 0; k < TRIES; k++) {
        SPARI_TRY(spari_named(s, __func__, spari_lend_before(s, before, h, context)));
        SPARI_TRY(spari_named(s, __func__, spar_step_begin(s, h)));
        SPARI_TRY(spari_step_run(s, __func__, solve, context));
        if (spari_pace_judge(s) <= 1) {
            SPARI_TRY(spari_named(s, __func__, spar_step_accept(s)));
            *next = s->own->pace.next;
            if (taken) {
                *taken = h;
            }
            return SPAR_OK;
        }
        SPARI_TRY(spari_named(s, __func__, spar_step_reject(s)));
        h = s->own->pace.next;
    }
    return spari_fail(
        s, SPAR_ERR_NUMERIC,
        "%s: from t = %g no dt down to %g keeps the tolerance: loads or a root's motion jump there, or it "
        "is smaller than a step's rounding; give a larger drift, or take this step by spar_step",
        __func__, s->time, h);
}
