/* Messages: the one way a failure leaves the library. Knows a session by its handle alone. */
#ifndef SPARI_MESSAGE_H
#define SPARI_MESSAGE_H

#include "status.h"

/* Writes the message (what, where, the cure) of `session` and returns `status`. session NULL: the message of this
   thread, which spar_session_message(NULL) gives back (a failed create has no session to ask). A call that only reads
   the session writes its message all the same. */
int spari_fail(const spar_session *session, int status, const char *format, ...) SPARI_PRINTF(3, 4);
/* The room in a host's array, which its call has given. */
int spari_need_capacity(const spar_session *session, const char *call, int64_t capacity);
/* Answers `status`; of a failure whose message, from below, does not name the public call, the message then begins with
   it. At the public edge. */
int spari_named(const spar_session *session, const char *call, int status);
/* A message that stood before comes back, text[SPARI_MESSAGE_SIZE]: what failed in between is no failure of the call.
 */
void spari_put_message_back(const spar_session *session, const char *text);
#ifdef __clang_analyzer__ /* reads one file at a time: what it must know is that a failure is never 0 */
#define spari_fail(session, status, ...) ((spari_fail)(session, status, __VA_ARGS__) ? (status) ? (status) : 1 : 1)
#endif

#define SPARI_REQUIRE(session, condition, status, ...)                                                                 \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            return spari_fail(session, status, __VA_ARGS__);                                                           \
        }                                                                                                              \
    } while (0)

#endif
