/* Failure messages of a session. Every failure leaves the library through spari_fail. */
#ifndef SPARI_MESSAGE_H
#define SPARI_MESSAGE_H

#include "status.h"

/* Writes the message (what, where, remedy) of `session` and returns `status`. With session NULL the message goes to
   the calling thread; spar_session_message(NULL) returns it, because a failed create has no session. Calls that only
   read the session may also write its message. */
int spari_fail(const spar_session *session, int status, const char *format, ...) SPARI_PRINTF(3, 4);
/* Checks the capacity of an array that the host passed to `call`. */
int spari_need_capacity(const spar_session *session, const char *call, int64_t capacity);
/* Returns `status`. If the message of a failure does not name the public call, prepends the name. Used at the public
   interface. */
int spari_named(const spar_session *session, const char *call, int status);
/* Restores an earlier message, text[SPARI_MESSAGE_SIZE], after failures that do not concern the call. */
void spari_put_message_back(const spar_session *session, const char *text);
#ifdef __clang_analyzer__ /* tells the analyser, which reads one file at a time, that a failure is never 0 */
#define spari_fail(session, status, ...) ((spari_fail)(session, status, __VA_ARGS__) ? (status) ? (status) : 1 : 1)
#endif

#define SPARI_REQUIRE(session, condition, status, ...)                                                                 \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            return spari_fail(session, status, __VA_ARGS__);                                                           \
        }                                                                                                              \
    } while (0)

/* Writes a result through a pointer that may be NULL. */
#define SPARI_GIVE(to, value)                                                                                          \
    do {                                                                                                               \
        if (to) {                                                                                                      \
            *(to) = (value);                                                                                           \
        }                                                                                                              \
    } while (0)

#endif
