/* Failure messages of blade elements, given to the session by its public calls: see message.h. */
#include "message.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Calls that only read may write a message. No session object is const: all are allocated on the heap. */
static spar_session *session_to_tell(const spar_session *session) {
    return (spar_session *)(uintptr_t)session;
}

int(spari_aero_fail)(const spar_session *session, int status, const char *format, ...) {
    static _Thread_local char text[7 * SPARI_MESSAGE_SIZE]; /* large for a small stack */
    va_list arguments;
    va_start(arguments, format);
    if (vsnprintf(text, sizeof text, format, arguments) < 0) {
        (void)snprintf(text, sizeof text, "%s", spar_status_text(status));
    }
    va_end(arguments);
    (void)spar_session_fail(session_to_tell(session), status, text);
    return status;
}

void spari_aero_put_message_back(const spar_session *session, const char *text) {
    (void)spar_session_fail(session_to_tell(session), SPAR_OK, text);
}

int spari_aero_named(const spar_session *session, const char *call, int status) {
    const char *message = spar_session_message(session);
    if (status != SPAR_OK && !strstr(message, call)) {
        char text[2 * SPARI_MESSAGE_SIZE];
        (void)snprintf(text, sizeof text, "%s: %s", call, message);
        spari_aero_put_message_back(session, text);
    }
    return status;
}
