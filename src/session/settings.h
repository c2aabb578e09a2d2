/* What is set for a session. */
#ifndef SPARI_SETTINGS_H
#define SPARI_SETTINGS_H

#include "../base/scene.h"

/* All settings as the header says they begin, and the table of them. */
void spari_settings_default(spar_session *session);
/* Those that the memory of the coupling is made for: values[SPARI_MOST_OF_COUPLING]; answers how many there are. */
enum { SPARI_MOST_OF_COUPLING = 16 };
int spari_settings_of_coupling(const spar_session *session, double *values);

#endif
