/* Entry of the collective calls of a session: see enter.h. */
#include "enter.h"

#include <assert.h>

static int enter(spar_session *s, const char *call, const spari_alike *alike, int count, int status) {
    int answer = spari_comm_enter(s->comm, call, alike, count, status, s->message, sizeof s->message);
    if (answer == SPAR_ERR_COMM) {
        s->calls_differ = 1;
        (void)spari_fail(s, answer, "%s", s->message); /* for the log */
    }
    return answer;
}

static spari_alike alike_of(const spar_session *s, const spari_setting *of) {
    double x = spari_setting_value(s, of);
    return of->kind == SPARI_IS_REAL ? spari_real(of->name, x) : spari_whole(of->name, (int64_t)x);
}

int spari_enter(spar_session *s, const char *call, int status) {
    return enter(s, call, NULL, 0, status);
}

int spari_enter_alike(spar_session *s, const char *call, const spari_alike *alike, int count, int status) {
    spari_alike all[SPARI_MOST_ALIKE];
    int n = 0;
    if (spari_comm_size(s->comm) == 1) {
        return status;
    }
    assert(count + s->setting_count <= SPARI_MOST_ALIKE);
    for (int i = 0; i < s->setting_count; i++) {
        if (s->settings[i].flags & SPARI_ALIKE) {
            all[n++] = alike_of(s, s->settings + i);
        }
    }
    for (int i = 0; i < count; i++) {
        all[n++] = alike[i];
    }
    return enter(s, call, all, n, status);
}
