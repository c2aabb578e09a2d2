/* The tolerance of Newton in a step, balanced with the errors of step and coupling: see newton_tolerance.h. */
#include "newton_tolerance.h"

#include "../base/session.h"
#include "fidelity.h"
#include "step_error.h"

#include <math.h>

/* part: the allowed Newton error relative to the error of the scheme. part_if_free: the same for free roots that joints
   do not hold, whose energy and momentum drift without a restoring force; a body that tumbles for 10^5 steps
   (tests/time/test_newton.c) loses 4e-4 of its energy with a part of 1e-3, of which 1e-4 comes from the scheme. most:
   the allowed error relative to the motion in the step. keeps: decay of the estimates per step, because an acceleration
   passes through 0 when it reverses. */
static const double part = 1e-3, part_if_free = 1e-4, most = 1e-7, keeps = 0.85;

void spari_newton_tolerance_accept(spar_member *m) {
    const spar_session *s = m->session;
    if (s->newton.strict || !(m->assembly || m->row->solver) || !spari_step_error_applies(m) ||
        !spari_step_error_is_known(s)) {
        m->accuracy.jerk = m->accuracy.acceleration = 0;
        return;
    }
    const spari_step_change of = spari_step_change_of(m, m->row->whole && m->nodes > 1 ? m->nodes - 1 : 1);
    double length = spari_member_length(m), jerk = of.change / (s->clock.dt * length),
           acceleration_scale = of.acceleration / length;
    m->accuracy.jerk = fmax(jerk, keeps * m->accuracy.jerk);
    m->accuracy.acceleration = fmax(acceleration_scale, keeps * m->accuracy.acceleration);
}

/* The Newton error acts as a force, and forces change velocities lastingly. For a motion at omega, the position
   error (E1) has to be compared with the velocity error over omega. omega h is the ratio of the change of the
   acceleration over the step to the acceleration. */
double spari_newton_tolerance(const spar_member *m, const spari_scheme *c, double motion, int held) {
    const spar_session *s = m->session;
    double strict = s->newton.atol + s->newton.rtol * motion, change = c->h * m->accuracy.jerk;
    if (c->rule != SPARI_ALPHA) {
        return spari_newton_tolerance_stage(s, c, motion);
    }
    if (s->newton.strict || c->still || !(change > 0)) {
        return strict;
    }
    change = fmin(change, 2 * m->accuracy.acceleration);
    double left = spari_step_error(c, change) * fmin(change / m->accuracy.acceleration, 1);
    left *= held || spari_member_root_is_prescribed(m) ? part : part_if_free;
    left = fmin(left, s->newton.share * m->accuracy.acceleration / c->cm);
    return fmax(strict, fmin(left, most * motion));
}
