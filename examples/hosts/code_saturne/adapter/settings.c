/* What the run script sets in the environment. */
#include "cs_base.h"
#include "cs_headers.h"
#include "spar_saturne.h"
#include <stdlib.h>
#include <string.h>

double saturne_number(const char *name, double otherwise) {
    const char *text = getenv(name);
    char *end = NULL;
    if (text == NULL || *text == '\0') {
        return otherwise;
    }
    double value = strtod(text, &end);
    if (*end != '\0') {
        bft_error(__FILE__, __LINE__, 0, "%s = '%s' is not a number", name, text);
    }
    return value;
}

const char *saturne_text(const char *name, const char *otherwise) {
    const char *text = getenv(name);
    return text != NULL && *text != '\0' ? text : otherwise;
}

void saturne_check(int status, const spar_session *session) {
    if (status != SPAR_OK) {
        bft_error(__FILE__, __LINE__, 0, "spar: %s: %s", spar_status_text(status), spar_session_message(session));
    }
}

void saturne_settings(spar_session *session) {
    static const char *const names[] = {"explicit", "fixed-point", "aitken", "iqn-ils"}; /* by SPAR_COUPLING_* */
    const char *name = saturne_text("SPAR_SCHEME", "iqn-ils");
    int scheme = 0;
    while (scheme < 4 && strcmp(name, names[scheme]) != 0) {
        scheme++;
    }
    if (scheme == 4) {
        bft_error(__FILE__, __LINE__, 0, "SPAR_SCHEME = '%s' is none of explicit, fixed-point, aitken, iqn-ils", name);
    }
    saturne_check(spar_session_set_coupling(session, scheme, 1e-9, saturne_number("SPAR_RTOL", 1e-4), 40), session);
    saturne_check(spar_session_set_relaxation(session, saturne_number("SPAR_OMEGA", 1)), session);
    saturne_check(spar_session_set_predictor(session, (int)saturne_number("SPAR_PREDICTOR", 1)), session);
    saturne_check(spar_session_set_option(session, "coupling.reuse", saturne_text("SPAR_REUSE", "5")), session);
}
