/* What was advised last, until it comes into force. */
#ifndef SPARI_APPLY_H
#define SPARI_APPLY_H

#include "../session/settings.h"

struct spari_advised {
    double dt, setting[SPARI_MOST_VARIED]; /* session/settings.h */
    int given;                             /* the advice has come to its end */
    uint64_t of;                           /* the members it is for: spari_advised_of when it was given */
};

/* The members as they are described now, as one number. */
uint64_t spari_advised_of(const spar_session *session);

#endif
