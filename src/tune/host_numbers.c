/* The host's own numbers as a goal of the advice. */
#include "../base/environment.h"
#include "../base/session.h"
#include "../exchange/session_private.h"

#include <string.h>

int spar_session_push_numbers(spar_session *session, int64_t n, const double *numbers) {
    SPARI_QUIET;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    SPARI_REQUIRE(session, n >= 0 && n <= SPARI_MOST_NUMBERS && (numbers || n == 0), SPAR_ERR_ARGUMENT,
                  "%s: %lld numbers%s; give 0 to %d", __func__, (long long)n, numbers ? "" : " without an array",
                  SPARI_MOST_NUMBERS);
    int64_t bad = numbers ? spari_first_nonfinite(numbers, n) : -1;
    SPARI_REQUIRE(session, bad < 0, SPAR_ERR_ARGUMENT, "%s: number %lld is %g; give finite ones", __func__,
                  (long long)bad, numbers[bad]);
    double *own = session->own->number;
    memset(own, 0, sizeof session->own->number);
    for (int64_t i = 0; i < n; i++) {
        own[i] = numbers[i];
    }
    return SPAR_OK;
}
