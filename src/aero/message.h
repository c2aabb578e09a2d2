/* Failure messages of blade elements: they go to the session, by spar_session_fail. */
#ifndef SPARI_AERO_MESSAGE_H
#define SPARI_AERO_MESSAGE_H

#include "../base/status.h"

/* Writes the message (what, where, remedy) of `session` and returns `status`. With session NULL the message goes to
   the calling thread. Calls that only read may also write a message. */
int spari_aero_fail(const spar_session *session, int status, const char *format, ...) SPARI_PRINTF(3, 4);
/* Returns `status`. If the message of a failure does not name the public call, prepends the name. */
int spari_aero_named(const spar_session *session, const char *call, int status);
/* Restores an earlier message after failures that do not concern the call. */
void spari_aero_put_message_back(const spar_session *session, const char *text);
#ifdef __clang_analyzer__ /* tells the analyser, which reads one file at a time, that a failure is never 0 */
#define spari_aero_fail(session, status, ...)                                                                          \
    ((spari_aero_fail)(session, status, __VA_ARGS__) ? (status) ? (status) : 1 : 1)
#endif

#define SPARI_AERO_REQUIRE(session, condition, status, ...)                                                            \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            return spari_aero_fail(session, status, __VA_ARGS__);                                                      \
        }                                                                                                              \
    } while (0)

#endif
