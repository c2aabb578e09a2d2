/* Texts of statuses, the release, and what the build has. */
#include "status.h"

#include <string.h>

/* One table of code, name and text, in the order of the codes. */
#define SPARI_STATUS_TABLE(ROW)                                                                                        \
    ROW(SPAR_OK, "no error")                                                                                           \
    ROW(SPAR_ERR_ARGUMENT, "an argument is not allowed")                                                               \
    ROW(SPAR_ERR_STATE, "the call is not allowed in this state")                                                       \
    ROW(SPAR_ERR_MEMORY, "out of memory")                                                                              \
    ROW(SPAR_ERR_NUMERIC, "the computation did not converge or is singular")                                           \
    ROW(SPAR_ERR_MAPPING, "a node could not be mapped")                                                                \
    ROW(SPAR_ERR_COMM, "the communication failed")                                                                     \
    ROW(SPAR_ERR_PEER, "another rank failed")                                                                          \
    ROW(SPAR_ERR_IO, "a file could not be read or written")                                                            \
    ROW(SPAR_ERR_UNSUPPORTED, "not supported by this build")                                                           \
    ROW(SPAR_ERR_USER, "a callback of the host failed")                                                                \
    ROW(SPAR_ERR_LIMIT, "a work limit is reached")

static const struct {
    int code;
    const char *text;
} table[] = {
#define SPARI_ROW(code, text) {code, #code ": " text},
    SPARI_STATUS_TABLE(SPARI_ROW)
#undef SPARI_ROW
};

int spari_is_status(int status) {
    return status >= 0 && (size_t)status < sizeof table / sizeof table[0] && table[status].code == status;
}

const char *spar_status_text(int status) {
    return spari_is_status(status) ? table[status].text : "unknown status";
}

const char *spar_version(void) {
    return SPARI_VERSION;
}

int spar_has(const char *feature) {
    static const char *const features[] = {
#ifdef SPARI_HAVE_MPI
        "mpi",
#endif
#ifdef SPARI_HAVE_FORTRAN
        "fortran",
#endif
#ifdef SPARI_HAVE_OPENBLAS
        "openblas",
#endif
#ifdef SPARI_HAVE_LAPACK
        "lapack",
#endif
#ifndef SPARI_WITHOUT_GSL
        "gsl",
#endif
        NULL,
    };
    if (!feature) {
        return 0;
    }
    for (size_t i = 0; i < sizeof features / sizeof features[0]; i++) {
        if (features[i] && strcmp(feature, features[i]) == 0) {
            return 1;
        }
    }
    return 0;
}
