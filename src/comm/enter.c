/* Entry of the collective calls of a session: see enter.h. */
#include "enter.h"

#include <assert.h>

static int enter(spar_session *s, const char *call, const spari_agreed *must_agree, int count, int status) {
    int result = spari_comm_enter(s->ranks.comm, call, must_agree, count, status, s->message, sizeof s->message);
    if (result == SPAR_ERR_COMM) {
        s->ranks.calls_differ = 1;
        (void)spari_fail(s, result, "%s", s->message); /* for the log */
    }
    return result;
}

int spari_enter(spar_session *s, const char *call, int status) {
    return enter(s, call, NULL, 0, status);
}

int spari_enter_agreed(spar_session *s, const char *call, const spari_agreed *must_agree, int count, int status) {
    spari_agreed all[SPARI_MOST_AGREED];
    int n = 0;
    if (spari_comm_size(s->ranks.comm) == 1) {
        return status;
    }
    assert(count + s->setting_count <= SPARI_MOST_AGREED);
    for (int i = 0; i < s->setting_count; i++) {
        const spari_setting *of = s->settings + i;
        double x = spari_setting_value(s, of);
        if (of->flags & SPARI_AGREED) {
            all[n++] = of->kind == SPARI_IS_REAL ? spari_real(of->name, x) : spari_whole(of->name, (int64_t)x);
        }
    }
    for (int i = 0; i < count; i++) {
        all[n++] = must_agree[i];
    }
    return enter(s, call, all, n, status);
}

int(spari_agree)(spar_session *s, int status) {
    return spari_comm_agree(s->ranks.comm, status, s->message, sizeof s->message);
}

int spari_sum(spar_session *s, double *x, int64_t n) {
    return spari_comm_sum(s->ranks.comm, x, n, SPAR_OK, s->message, sizeof s->message);
}

int spari_anywhere(spar_session *s, int here, int *any) {
    double count[2] = {here, 0};
    SPARI_TRY(spari_sum(s, count, 1));
    *any = count[0] > 0;
    return SPAR_OK;
}
