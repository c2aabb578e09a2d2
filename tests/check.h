/* What tests demand of a call and of a number. */
#ifndef CHECK_H
#define CHECK_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include <math.h>
#include <spar/spar_all.h>
#include <string.h>

/* The call must succeed; else the message says why. */
#define OK(session, call)                                                                                              \
    do {                                                                                                               \
        int status_ = (call);                                                                                          \
        if (status_ != SPAR_OK) {                                                                                      \
            fail_msg("%s: %s: %s", #call, spar_status_text(status_), spar_session_message(session));                   \
        }                                                                                                              \
    } while (0)

/* The call must fail with this status, and a message that says `text`. */
#define REFUSED(session, expected, text, call)                                                                         \
    do {                                                                                                               \
        int refused_ = (call);                                                                                         \
        if (refused_ != (expected)) {                                                                                  \
            fail_msg("%s: status %d (%s), expected %d", #call, refused_, spar_status_text(refused_), (expected));      \
        }                                                                                                              \
        if (!strstr(spar_session_message(session), (text))) {                                                          \
            fail_msg("%s: the message '%s' does not say '%s'", #call, spar_session_message(session), (text));          \
        }                                                                                                              \
    } while (0)

/* Effects for spar_member_set_effects: these and no others. */
#define EFFECTS_ONLY(effects)                                                                                          \
    (effects), ((SPAR_EFFECT_INERTIA | SPAR_EFFECT_GYROSCOPIC | SPAR_EFFECT_GRAVITY | SPAR_EFFECT_DAMPING |            \
                 SPAR_EFFECT_FLUID_MOMENT | SPAR_EFFECT_FLUID_HISTORY | SPAR_EFFECT_WORK | SPAR_EFFECT_MASSES |        \
                 SPAR_EFFECT_FOUNDATION | SPAR_EFFECT_PRETENSION) &                                                    \
                ~(effects))

/* |got - expected| <= tolerance, with both printed when not */
#define NEAR(got, expected, tolerance)                                                                                 \
    do {                                                                                                               \
        double got_ = (got), expected_ = (expected), tolerance_ = (tolerance);                                         \
        if (!(fabs(got_ - expected_) <= tolerance_)) {                                                                 \
            fail_msg("%s is %.17g, expected %.17g within %g (off by %g)", #got, got_, expected_, tolerance_,           \
                     got_ - expected_);                                                                                \
        }                                                                                                              \
    } while (0)

#endif
