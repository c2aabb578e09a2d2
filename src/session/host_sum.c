/* Sums over the ranks for code on top of a session, which then needs no MPI. */
#include "../base/environment.h"
#include "../base/session.h"
#include "../comm/enter.h"

#include <stdlib.h>
#include <string.h>

static int check_sum(spar_session *s, const char *call, int status, int64_t n, const double *x) {
    SPARI_REQUIRE(s, spari_is_status(status), SPAR_ERR_ARGUMENT, "%s: the status is %d; give SPAR_OK or a SPAR_ERR_*",
                  call, status);
    SPARI_REQUIRE(s, n >= 0 && n <= SPARI_MOST, SPAR_ERR_ARGUMENT, "%s: %lld numbers; give 0 to 2^40", call,
                  (long long)n);
    SPARI_REQUIRE(s, x || n == 0, SPAR_ERR_ARGUMENT, "%s: the numbers are NULL", call);
    return status;
}

int spar_session_sum(spar_session *session, int status, int64_t n, double *x) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    spar_session *s = session;
    double *workspace = NULL; /* one more: see comm.h */
    int own = check_sum(s, __func__, status, n, x);
    if (own == SPAR_OK) {
        workspace = spari_zalloc(n + 1, sizeof *workspace);
        own = workspace ? SPAR_OK
                        : spari_fail(s, SPAR_ERR_MEMORY, "%s: no memory for %lld numbers", __func__, (long long)n);
    }
    if (workspace && n > 0) {
        memcpy(workspace, x, (size_t)n * sizeof *x);
    }
    const spari_agreed must_agree[] = {spari_whole("n", n)};
    int result = spari_enter_agreed(s, __func__, must_agree, 1, own);
    if (result == SPAR_OK) {
        result = spari_sum(s, workspace, n);
    }
    if (result == SPAR_OK && workspace && n > 0) {
        memcpy(x, workspace, (size_t)n * sizeof *x);
    }
    free(workspace);
    return result;
}
