/* The pace of the steps: what a step's error was, by the accelerations at its ends, and the dt that a tolerance leaves
   for the next ((E1), (E2) of docs/theory.md). Off: nothing is kept or computed. */
#ifndef SPARI_PACE_H
#define SPARI_PACE_H

#include "../base/session.h"

static inline int spari_pace_is_set(const spar_session *session) {
    return session->tolerance_drift > 0;
}
/* The step under way, whose motion has been found, becomes the last one; or it is given up. Local. */
void spari_pace_accept(spar_session *session);
void spari_pace_reject(spar_session *session);
/* The error of the step under way over the tolerance. Local. */
double spari_pace_judge(const spar_session *session);
/* Root of the mean square over the nodes of the error that the step under way adds, m. */
double spari_pace_error(const spar_member *member);

#endif
