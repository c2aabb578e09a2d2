/* Steps to a tolerance: see pace.h. */
#include "pace.h"

#include "../base/quiet.h"
#include "../comm/comm.h"
#include "../math/rotation.h"
#include "../solve/fidelity.h"
#include "../solve/scheme.h"
#include "own.h"

#include <math.h>

/* ---- the error of a step ---- */

/* Velocity and acceleration of node i, of a driven root's member as seen from there, in its axes. */
static void rates_from_root(const spar_member *m, const spari_motion *x, int64_t i, double v[6], double a[6]) {
    memcpy(v, x->v + 6 * i, 6 * sizeof *v);
    memcpy(a, x->a + 6 * i, 6 * sizeof *a);
    if (m->root != SPAR_ROOT_DRIVEN) {
        return;
    }
    const double *W = x->v + 3, *A = x->a + 3;
    double d[3], c[3], w[3];
    for (int k = 0; k < 3; k++) {
        d[k] = m->xr[3 * i + k] + x->q[7 * i + k] - m->xr[k] - x->q[k];
        v[k] -= x->v[k];
        a[k] -= x->a[k];
    }
    spari_cross(W, d, c);
    for (int k = 0; k < 3; k++) {
        v[k] -= c[k];
        w[k] = c[k] + 2 * v[k];
    }
    spari_cross(W, w, c);
    spari_cross(A, d, w);
    for (int k = 0; k < 3; k++) {
        a[k] -= c[k] + w[k];
    }
    spari_rotate_back(x->q + 3, v, v);
    spari_rotate_back(x->q + 3, a, a);
}

/* Whether the member's motion comes out of the scheme. */
static int is_integrated(const spar_member *m) {
    return m->row->solved && m->row->moves && (m->effects & SPAR_EFFECT_INERTIA) != 0;
}

/* Mean squares over the nodes, of one node its turns count as well, on arms of the member's length: of the change of
   the acceleration over the step, and of the velocity at its end. */
static void mean_squares(const spar_member *m, double *change, double *speed) {
    double v[6], a[6], v0[6], a0[6], length = m->nodes == 1 ? spari_member_length(m) : 0;
    *change = *speed = 0;
    for (int64_t i = 0; i < m->nodes; i++) {
        rates_from_root(m, &m->now, i, v0, a0);
        rates_from_root(m, &m->after, i, v, a);
        for (int k = 0; k < 6; k++) {
            double weight = k < 3 ? 1 : length * length;
            *change += weight * (a[k] - a0[k]) * (a[k] - a0[k]);
            *speed += weight * v[k] * v[k];
        }
    }
    *change /= (double)m->nodes;
    *speed /= (double)m->nodes;
}

/* Accelerations at t = 0 are known only where a start has been balanced. */
static int tells(const spar_session *s) {
    return s->step > 0 || (s->members && s->members->begun);
}

/* The error, and the member's speed. (E1) */
static double find_error(const spar_member *m, double *speed) {
    double change, h = m->session->dt / m->session->substeps;
    *speed = 0;
    if (!is_integrated(m)) {
        return 0;
    }
    const spari_scheme c = spari_scheme_of(m, 0, h);
    mean_squares(m, &change, speed);
    *speed = sqrt(*speed);
    return tells(m->session) ? fabs(c.beta + 0.5 * (c.alpha_m - c.alpha_f) - 1.0 / 6) * h * h * sqrt(change) : 0;
}

double spari_pace_error(const spar_member *m) {
    double speed;
    return find_error(m, &speed);
}

/* ---- what it says of dt ---- */

/* The error of a member is of order 2 in dt where it counts by the time that it took to come. */
static double judge_member(const spar_member *m, double *error, double *speed) {
    const spar_session *s = m->session;
    *error = find_error(m, speed);
    *speed = fmax(*speed, m->speed);
    return *error / s->dt / (s->tolerance_drift + s->tolerance_rtol * *speed);
}

/* Where a motion turns round its acceleration stands still, and its velocity has the error: what has been found fades
   from step to step. */
static double fade(const spari_pace *p, double ratio) {
    return fmax(fmax(ratio, 0.85 * p->ratio), 1e-6);
}

/* PI control (Gustafsson, ACM TOMS 17, 1991), (E2). Small changes are not worth a new tangent. */
static double next_dt(const spar_session *s, double ratio) {
    static const double safety = 0.9, integral = 0.35, proportional = 0.2, most = 2, least = 0.2, up = 1.2;
    const spari_pace *p = &s->own->pace;
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
    return s->dt * fmax(by, least);
}

double spari_pace_judge(const spar_session *s) {
    double ratio = 0, error, speed;
    for (const spar_member *m = s->members; m; m = m->next) {
        ratio = fmax(ratio, judge_member(m, &error, &speed));
    }
    return ratio;
}

int spari_pace_check(const spar_session *s, const char *call) {
    SPARI_REQUIRE(
        s, !spari_pace_is_set(s) || !(s->touched && spari_comm_size(s->comm) > 1), SPAR_ERR_STATE,
        "%s: a tolerance (drift of spar_session_set_tolerance) needs the motion of all members on every rank: "
        "leave the option ranks.state at all, or set no tolerance",
        call);
    return SPAR_OK;
}

void spari_pace_accept(spar_session *s) {
    if (!spari_pace_is_set(s) || s->trial) {
        return;
    }
    spari_pace *p = &s->own->pace;
    double ratio = 0, speed;
    for (spar_member *m = s->members; m; m = m->next) {
        ratio = fmax(ratio, judge_member(m, &m->step_error, &speed));
        m->speed = speed;
    }
    p->next = tells(s) ? next_dt(s, ratio) : s->dt;
    p->ratio = tells(s) ? fade(p, ratio) : 0;
    p->last = ratio;
    p->cut = 0;
}

void spari_pace_reject(spar_session *s) {
    if (!spari_pace_is_set(s) || s->trial || s->phase < SPARI_SOLVED || s->failed || s->standing) {
        return;
    }
    spari_pace *p = &s->own->pace;
    double ratio = spari_pace_judge(s);
    if (ratio > 1) {
        p->rejected++;
        p->next = next_dt(s, ratio);
        p->cut = 1;
    }
}

int spar_session_get_pace(const spar_session *session, int64_t capacity, double *pace) {
    SPARI_QUIET;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    const spar_session *s = session;
    const spari_pace *p = &s->own->pace;
    SPARI_REQUIRE(s, spari_pace_is_set(s), SPAR_ERR_STATE,
                  "%s: no tolerance is set, and steps are not judged; call spar_session_set_tolerance first", __func__);
    SPARI_TRY(spari_need_capacity(s, __func__, capacity));
    int judged = s->phase >= SPARI_SOLVED && !s->standing && !s->trial;
    SPARI_REQUIRE(s, judged || p->next > 0, SPAR_ERR_STATE,
                  "%s: no step has been solved since the tolerance was set; make one first", __func__);
    double ratio = judged ? spari_pace_judge(s) : p->last;
    const double all[SPAR_PACE_COUNT] = {
        [SPAR_PACE_RATIO] = ratio,
        [SPAR_PACE_NEXT_DT] = !judged    ? p->next
                              : tells(s) ? next_dt(s, ratio)
                                         : s->dt,
        [SPAR_PACE_REJECT] = judged && ratio > 1,
        [SPAR_PACE_REJECTED] = (double)p->rejected,
    };
    spari_fill(capacity, pace, SPAR_PACE_COUNT, all);
    return SPAR_OK;
}
