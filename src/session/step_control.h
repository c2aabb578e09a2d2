/* Step-size control: error of a step, estimated from the accelerations at its ends, and the dt that a tolerance
   permits for the next step ((E1), (E2) of docs/explanation/theory.md). If it is off, nothing is stored or computed. */
#ifndef SPARI_STEP_CONTROL_H
#define SPARI_STEP_CONTROL_H

#include "../base/session.h"

static inline int spari_step_control_is_set(const spar_session *session) {
    return session->tolerance.drift > 0;
}
/* The step under way, whose motion has been found, becomes the last one; or it is given up. Local. */
void spari_step_control_accept(spar_session *session);
void spari_step_control_reject(spar_session *session);
/* Error of the current step relative to the tolerance. Local. */
double spari_step_control_ratio(const spar_session *session);
/* Root mean square over the nodes of the error added by the current step, m. */
double spari_step_control_error(const spar_member *member);

#endif
