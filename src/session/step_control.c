/* Step-size control: see step_control.h. */
#include "step_control.h"

#include "../base/environment.h"
#include "../exchange/session_private.h"
#include "../time/step_error.h"

#include <math.h>

/* ---- the error of a step ---- */

/* Step error, and speed of the member. (E1) */
static double find_error(const spar_member *m, double *speed) {
    const spar_session *s = m->session;
    *speed = 0;
    if (!spari_step_error_applies(m)) {
        return 0;
    }
    const spari_scheme c = spari_scheme_of(m, 0, s->clock.dt / s->integrator.substeps);
    const spari_step_change of = spari_step_change_of(m);
    *speed = of.speed;
    return spari_step_error_is_known(s) ? spari_step_error(&c, of.change) : 0;
}

double spari_step_control_error(const spar_member *m) {
    double speed;
    return find_error(m, &speed);
}

/* ---- next dt ---- */

/* Error of a member; it is of order 2 in dt if it is significant relative to its duration. */
static double judge_member(const spar_member *m, double *error, double *speed) {
    const spar_session *s = m->session;
    *error = find_error(m, speed);
    *speed = fmax(*speed, m->accuracy.speed);
    return *error / s->clock.dt / (s->tolerance.drift + s->tolerance.rtol * *speed);
}

/* Decays the last ratio: at a turning point the acceleration is stationary and the error is in the velocity, so the
   present error is too small. */
static double fade(const spari_step_control *p, double ratio) {
    return fmax(fmax(ratio, 0.85 * p->ratio), 1e-6);
}

/* PI control (Gustafsson, ACM TOMS 17, 1991), (E2). Small changes of dt are not worth a new tangent. */
static double propose_dt(const spar_session *s, double ratio) {
    static const double safety = 0.9, integral = 0.35, proportional = 0.2, most = 2, least = 0.2, up = 1.2;
    const spari_step_control *p = &s->own->step_control;
    ratio = fade(p, ratio);
    double by = safety / sqrt(ratio);
    if (ratio <= 1 && p->ratio > 0) {
        by = safety * pow(ratio, -integral) * pow(p->ratio, proportional);
    }
    if (ratio <= 1) {
        by = by > safety && by < up ? 1 : fmin(by, p->cut > 0 ? 1 : most);
    } else {
        by = fmin(by, safety);
    }
    return s->clock.dt * fmax(by, least);
}

double spari_step_control_ratio(const spar_session *s) {
    double ratio = 0, error, speed;
    for (const spar_member *m = s->members; m; m = m->next) {
        ratio = fmax(ratio, judge_member(m, &error, &speed));
    }
    return ratio;
}

void spari_step_control_accept(spar_session *s) {
    double ratio = 0, speed;
    for (spar_member *m = s->members; m && s->state.trial; m = m->next) { /* advice reads it; dt does not follow it */
        m->accuracy.step_error = find_error(m, &speed);
    }
    if (!spari_step_control_is_set(s) || s->state.trial) {
        return;
    }
    spari_step_control *p = &s->own->step_control;
    for (spar_member *m = s->members; m; m = m->next) {
        ratio = fmax(ratio, judge_member(m, &m->accuracy.step_error, &speed));
        m->accuracy.speed = speed;
    }
    p->next = spari_step_error_is_known(s) ? propose_dt(s, ratio) : s->clock.dt;
    p->ratio = spari_step_error_is_known(s) ? fade(p, ratio) : 0;
    p->last = ratio;
    p->cut = 0;
}

void spari_step_control_reject(spar_session *s) {
    if (!spari_step_control_is_set(s) || s->state.trial || s->state.phase < SPARI_SOLVED || s->state.failed ||
        s->state.static_solution) {
        return;
    }
    spari_step_control *p = &s->own->step_control;
    double ratio = spari_step_control_ratio(s);
    if (ratio > 1) {
        p->rejected++;
        p->next = propose_dt(s, ratio);
        p->cut = 1;
    }
}

int spar_session_get_step_control(const spar_session *session, double *ratio, double *next_dt, int *reject,
                                  int64_t *rejected) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    const spar_session *s = session;
    const spari_step_control *p = &s->own->step_control;
    SPARI_REQUIRE(s, spari_step_control_is_set(s), SPAR_ERR_STATE,
                  "%s: no tolerance is set, so step errors are not estimated; call spar_session_set_tolerance first",
                  __func__);
    int judged = s->state.phase >= SPARI_SOLVED && !s->state.static_solution && !s->state.trial;
    SPARI_REQUIRE(s, judged || p->next > 0, SPAR_ERR_STATE,
                  "%s: no step has been solved since the tolerance was set; make one first", __func__);
    const double now = judged ? spari_step_control_ratio(s) : p->last;
    SPARI_GIVE(ratio, now);
    SPARI_GIVE(next_dt, !judged ? p->next : spari_step_error_is_known(s) ? propose_dt(s, now) : s->clock.dt);
    SPARI_GIVE(reject, judged && now > 1);
    SPARI_GIVE(rejected, p->rejected);
    return SPAR_OK;
}
