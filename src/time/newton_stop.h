/* What Newton may leave in a step (option newton.stop = tied): parts of what the step errs by in any case, and of what
   its coupling asks for; strict where that is not known. */
#ifndef SPARI_NEWTON_STOP_H
#define SPARI_NEWTON_STOP_H

#include "../base/session.h"
#include "scheme.h"

#include <math.h>

/* The step is accepted, and its motion not yet that of t^n: what the next steps err by is estimated. */
void spari_newton_stop_accept(spar_member *member);
/* The correction, as Newton's iteration takes it, that may be left to a substep which has moved the member by `way`. */
double spari_newton_tolerance(const spar_member *member, const spari_scheme *c, double way);
/* The same of a stage of TR-BDF2, strict and beyond: its accelerations answer to increments with cm = 11.7 / h^2, where
   generalised-alpha has 4 / h^2, and the next step, which may be much longer, begins with them. So atol is no more than
   1e-6 h^2 either. */
static inline double spari_newton_tolerance_stage(const spar_session *session, const spari_scheme *c, double way) {
    return 0.25 * (fmin(session->newton_atol, 1e-6 * c->h * c->h) + session->newton_rtol * way);
}
/* A solution begins: strict, a contraction of those before does not count. */
static inline spari_trace *spari_newton_stop_begin(const spar_session *session, spari_trace *trace) {
    trace->rate = session->newton_strict ? 0 : trace->rate;
    return trace;
}

#endif
