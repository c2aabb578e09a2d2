/* The last advice of a trial, until it is put in force. */
#ifndef SPARI_APPLY_H
#define SPARI_APPLY_H

#include "../base/session.h"

/* Hash of the members' present description. */
uint64_t spari_advised_of(const spar_session *session);

#endif
