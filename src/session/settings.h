/* What is set for a session. */
#ifndef SPARI_SETTINGS_H
#define SPARI_SETTINGS_H

#include "../base/scene.h"

/* All settings as the header says they begin, and the table of those that ranks make alike. */
void spari_settings_default(spar_session *session);

#endif
