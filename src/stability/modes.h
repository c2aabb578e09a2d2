/* Modes about the present state. */
#ifndef SPARI_MODES_H
#define SPARI_MODES_H

#include "../member/structure.h"

/* n frequencies, Hz, and shapes [n][nodes][6] (may be NULL) of a member, connected: with all that joints connect to it;
   otherwise without joints. A status and a message. */
int spari_modes(const spar_member *member, int connected, int64_t n, double *frequency, double *shapes);

#endif
