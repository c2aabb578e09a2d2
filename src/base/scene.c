/* Messages: of a session, and of the thread where there is none. */
#include "scene.h"

#include "quiet.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* A failed create has no session that could keep its message. */
static _Thread_local char thread_message[SPARI_MESSAGE_SIZE];

void spari_log(const spar_session *s, int level, const char *text) {
    if (s->log) {
        spari_host host;
        spari_host_begin(&host);
        s->log(s, level, text, s->log_context);
        spari_host_end(&host);
    }
}

int(spari_fail)(spar_session *session, int status, const char *format, ...) {
    /* Formatted aside first: an argument may point into the message that is about to be replaced. */
    char text[SPARI_MESSAGE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    if (vsnprintf(text, sizeof text, format, arguments) < 0) {
        snprintf(text, sizeof text, "%s", spar_status_text(status));
    }
    va_end(arguments);
    memcpy(session ? session->message : thread_message, text, sizeof text);
    if (session) {
        session->failures++;
        spari_log(session, SPAR_LOG_ERROR, session->message);
    }
    return status;
}

const char *spar_session_message(const spar_session *session) {
    return session ? session->message : thread_message;
}
