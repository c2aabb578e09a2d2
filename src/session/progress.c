/* The host's progress call: see progress.h. */
#include "progress.h"

#include "../base/environment.h"
#include "../comm/comm.h"

spari_progress spari_progress_of(const spar_session *s, const char *call) {
    return (spari_progress){.call = call, .tell = s->progress, .context = s->progress_context};
}

/* Between trials the session stands as the host left it; what would try or save it is refused as within one. */
static int ask_host(spar_session *s, const spari_progress *p, double done, double expected) {
    spari_host host;
    s->calls_differ = 0;
    spari_host_begin(&host);
    s->trial = 1;
    int answer = p->tell(s, done, expected, p->context);
    s->trial = 0;
    spari_host_end(&host);
    if (s->calls_differ) { /* only this rank made a collective call here; the other ranks have found that */
        return SPAR_ERR_COMM;
    }
    int status = answer == 0 ? SPAR_OK
                             : spari_fail(s, SPAR_ERR_USER,
                                          "%s: the host has stopped it: its progress call returned %d, after %.3g of "
                                          "%.3g trials expected",
                                          p->call, answer, done, expected);
    return spari_comm_agree(s->comm, status, s->message, sizeof s->message);
}

int spari_progress_tell(spar_session *s, spari_progress *p, double done, double expected) {
    if (!p->tell) {
        return SPAR_OK;
    }
    p->stopped = ask_host(s, p, done, expected);
    return p->stopped == SPAR_OK ? SPAR_OK : SPAR_ERR_LIMIT;
}

int spari_progress_ends(const spari_progress *p, int status) {
    return p->stopped != SPAR_OK ? p->stopped : status;
}
