/* Newton's stopping rule (option newton.stop = balanced). Newton stops once its estimated error is negligible compared
   with the time-step error and with the coupling tolerance. Where these are not known, the strict tolerances hold. */
#ifndef SPARI_NEWTON_TOLERANCE_H
#define SPARI_NEWTON_TOLERANCE_H

#include "../base/session.h"
#include "scheme.h"

#include <math.h>

/* Updates the estimates of the step error. Called when a step is accepted, before its motion becomes that of t^n. */
void spari_newton_tolerance_accept(spar_member *member);
/* The remaining correction that is allowed in a substep that has moved the member by `motion`. held: joints leave the
   member no free motion of the whole. */
double spari_newton_tolerance(const spar_member *member, const spari_scheme *c, double motion, int held);
/* The same for a stage of TR-BDF2. The strict tolerances hold, and atol is at most 1e-6 h^2. The reason:
   accelerations follow from increments with cm = 11.7 / h^2 (generalised-alpha: 4 / h^2), and the next step, which
   may be much longer, begins with these accelerations. */
static inline double spari_newton_tolerance_stage(const spar_session *session, const spari_scheme *c, double motion) {
    return 0.25 * (fmin(session->newton.atol, 1e-6 * c->h * c->h) + session->newton.rtol * motion);
}

#endif
