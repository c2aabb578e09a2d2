/* Messages, log and warnings of a session; messages of the thread if there is no session. */
#include "session.h"

#include "environment.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Message of a failed create, which has no session. */
static _Thread_local char thread_message[SPARI_MESSAGE_SIZE];
/* The first of its failures since the host has read it; "": none. */
static _Thread_local char thread_unread[SPARI_CAUSE_SIZE];
/* Redirects messages of this thread; NULL: no redirection. */
static _Thread_local char *redirected;

char *spari_messages_redirect(char *text) {
    char *before = redirected;
    redirected = text;
    return before;
}

void spari_log(const spar_session *s, int level, const char *text) {
    if (s->callbacks.log && !s->callbacks.muted) {
        spari_host host;
        spari_host_begin(&host);
        s->callbacks.log(s, level, text, s->callbacks.log_context);
        spari_host_end(&host);
    }
}

/* Calls that only read a session may write its message. No session object is const: all are allocated on the heap. */
static spar_session *teller(const spar_session *session) {
    return (spar_session *)(uintptr_t)session;
}

void spari_warn(const spar_session *session, const char *format, ...) {
    char text[SPARI_MESSAGE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (length < 0 || redirected) {
        return;
    }
    spar_session *s = teller(session);
    if (!s->state.trial && s->warning_count < SPARI_MOST_WARNINGS) {
        char *copy = malloc(strlen(text) + 1);
        if (copy) { /* without memory the log alone has the warning */
            memcpy(copy, text, strlen(text) + 1);
            s->warnings[s->warning_count++] = copy;
        }
    }
    spari_log(s, SPAR_LOG_WARNING, text);
}

const char *spar_session_get_warning(const spar_session *session, int64_t i) {
    return session && i >= 0 && i < session->warning_count ? session->warnings[i] : "";
}

/* Shortens a message that is too long, as with a long name in it: its middle goes, its beginning and the remedy
   stay. */
static void shorten(char *text) {
    static const char gap[] = " ... ";
    size_t n = strlen(text), head = SPARI_MESSAGE_SIZE / 2, tail = SPARI_MESSAGE_SIZE - head - sizeof gap;
    if (n >= SPARI_MESSAGE_SIZE) {
        memmove(text + head + sizeof gap - 1, text + n - tail, tail + 1);
        memcpy(text + head, gap, sizeof gap - 1);
    }
}

static char *message_of(const spar_session *session) {
    if (redirected) {
        return redirected;
    }
    return session ? teller(session)->message : thread_message;
}

/* A host that ignores a status sees what follows from it: a failure that it has not read stays in the next message. One
   that has a log has seen it. text: [size], the new message. */
static void add_cause(const spar_session *session, char *text, size_t size) {
    enum { SAME = 60 }; /* a message may quote its cause, cut */
    char first[SPARI_CAUSE_SIZE], head[SAME], *unread = session ? teller(session)->unread : thread_unread;
    if (session && session->callbacks.log) {
        return;
    }
    (void)snprintf(first, sizeof first, "%s", unread[0] ? unread : thread_unread);
    const char *body = strstr(first, ": "); /* two calls may refuse the same */
    (void)snprintf(head, sizeof head, "%.*s", SAME - 1, body ? body : first);
    if (!first[0]) {
        (void)snprintf(unread, SPARI_CAUSE_SIZE, "%.*s", SPARI_CAUSE_SIZE - 1, text);
        return;
    }
    thread_unread[0] = '\0';
    (void)memcpy(unread, first, sizeof first);
    const size_t n = strlen(text);
    if (!strstr(text, head)) {
        (void)snprintf(text + n, size - n, "; an earlier failure: %s", first);
    }
}

int(spari_fail)(const spar_session *session, int status, const char *format, ...) {
    /* The text is formatted before it is copied: an argument may point into the old message. */
    static _Thread_local char text[7 * SPARI_MESSAGE_SIZE]; /* large for a small stack */
    va_list arguments;
    va_start(arguments, format);
    if (vsnprintf(text, sizeof text, format, arguments) < 0) {
        snprintf(text, sizeof text, "%s", spar_status_text(status));
    }
    va_end(arguments);
    if (!redirected) {
        add_cause(session, text, sizeof text);
    }
    shorten(text);
    memcpy(message_of(session), text, strlen(text) + 1);
    if (session && !redirected) {
        teller(session)->failures++;
        spari_log(session, SPAR_LOG_ERROR, session->message);
    }
    return status;
}

int spari_need_capacity(const spar_session *session, const char *call, int64_t capacity) {
    SPARI_REQUIRE(session, capacity >= 0 && capacity <= SPARI_MOST, SPAR_ERR_ARGUMENT,
                  "%s: capacity is %lld; give the length of the array, 0 to 2^40", call, (long long)capacity);
    return SPAR_OK;
}

int spar_session_fail(spar_session *session, int status, const char *message) {
    SPARI_REQUIRE(session, status >= SPAR_OK && status <= SPAR_ERR_LIMIT, SPAR_ERR_ARGUMENT,
                  "%s: the status is %d; give a SPAR_ERR_*, or SPAR_OK to write the message alone", __func__, status);
    SPARI_REQUIRE(session, message && (message[0] || status == SPAR_OK), SPAR_ERR_ARGUMENT,
                  "%s: the message is missing; give a text that describes the failure", __func__);
    if (status != SPAR_OK) {
        (void)spari_fail(session, status, "%s", message);
        return SPAR_OK;
    }
    char text[SPARI_MESSAGE_SIZE] = "";
    (void)snprintf(text, sizeof text, "%s", message);
    spari_put_message_back(session, text);
    return SPAR_OK;
}

void spari_put_message_back(const spar_session *session, const char *text) {
    if (session && !redirected) {
        teller(session)->unread[0] = '\0';
    }
    memcpy(message_of(session), text, SPARI_MESSAGE_SIZE);
}

int spari_named(const spar_session *session, const char *call, int status) {
    char text[SPARI_MESSAGE_SIZE], *message = message_of(session);
    if (status != SPAR_OK && !strstr(message, call)) {
        size_t n = strlen(call), rest = strlen(message) + 1;
        memcpy(text, message, rest);
        rest = n + 2 + rest > sizeof text ? sizeof text - n - 2 : rest;
        memcpy(message, call, n);
        memcpy(message + n, ": ", 2);
        memcpy(message + n + 2, text, rest);
        message[SPARI_MESSAGE_SIZE - 1] = '\0';
    }
    return status;
}

const char *spar_session_message(const spar_session *session) {
    (session ? teller(session)->unread : thread_unread)[0] = '\0';
    return session ? session->message : thread_message;
}

void spar_log_stderr(const spar_session *session, int level, const char *text, void *context) {
    (void)session;
    (void)context;
    if (text && level <= SPAR_LOG_WARNING) {
        (void)fprintf(stderr, "spar: %s: %s\n", level == SPAR_LOG_ERROR ? "error" : "warning", text);
    }
}
