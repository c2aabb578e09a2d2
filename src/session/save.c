/* State to and from a file: declared for hosts to compile against, and refused by this version. */
#include "session.h"

static int refuse(const spar_session *session, const char *call, const char *path) {
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", call);
    spar_session *s = (spar_session *)session; /* whose message is written; its state is not touched */
    int status = SPAR_OK;
    if (!path || !path[0]) {
        status = spari_fail(s, SPAR_ERR_ARGUMENT, "%s: the path is empty", call);
    } else {
        status = spari_fail(s, SPAR_ERR_UNSUPPORTED,
                            "%s: this version of the library does not keep sessions in files; keep the host's own "
                            "state and start the session anew",
                            call);
    }
    return spari_comm_agree(s->comm, status, s->message, sizeof s->message);
}

int spar_session_save(const spar_session *session, const char *path) {
    return refuse(session, "spar_session_save", path);
}

int spar_session_load(spar_session *session, const char *path) {
    return refuse(session, "spar_session_load", path);
}
