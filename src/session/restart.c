/* Save and load of a session: part of the interface, refused in this release. */
#include "session.h"

static int refuse(spar_session *session, const char *path, const char *call) {
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", call);
    SPARI_REQUIRE(session, path && path[0], SPAR_ERR_ARGUMENT, "%s: no path given", call);
    return spari_fail(session, SPAR_ERR_UNSUPPORTED,
                      "%s: '%s': this release of spar cannot keep a session in a file; set the run up anew", call,
                      path);
}

int spar_session_save(const spar_session *session, const char *path) {
    /* the message is the one thing of a session that a reader of it may change */
    return refuse((spar_session *)(uintptr_t)session, path, "spar_session_save");
}

int spar_session_load(spar_session *session, const char *path) {
    return refuse(session, path, "spar_session_load");
}
