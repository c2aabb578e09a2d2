/* The last advice, until it is put in force. */
#ifndef SPARI_APPLY_H
#define SPARI_APPLY_H

#include "../session/settings.h"

struct spari_advised {
    double dt, setting[SPARI_MOST_VARIED]; /* session/settings.h */
    int given;                             /* the search is complete */
    uint64_t of;                           /* members for which it is valid: spari_advised_of at that time */
};

/* Hash of the members' present description. */
uint64_t spari_advised_of(const spar_session *session);

#endif
