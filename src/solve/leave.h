/* What Newton may leave in a step (option newton.stop = tied): parts of what the step errs by in any case, and of what
   its coupling asks for; strict where that is not known. */
#ifndef SPARI_LEAVE_H
#define SPARI_LEAVE_H

#include "../base/scene.h"
#include "scheme.h"

/* The step is accepted, and its motion not yet that of t^n: what the next steps err by is estimated. */
void spari_leave_accept(spar_member *member);
/* The correction, as Newton's iteration takes it, that may be left to a substep which has moved the member by `way`. */
double spari_leave(const spar_member *member, const spari_scheme *c, double way);
/* A solution begins: strict, a contraction of those before does not count. */
static inline spari_trace *spari_leave_begin(const spar_session *session, spari_trace *trace) {
    trace->rate = session->newton_strict ? 0 : trace->rate;
    return trace;
}

#endif
