/* What is set for a session. */
#ifndef SPARI_SETTINGS_H
#define SPARI_SETTINGS_H

#include "../base/session.h"

/* All settings as the header says they begin, and the table of them. */
void spari_settings_default(spar_session *session);
/* Those that the memory of the coupling is made for: values[SPARI_MOST_OF_COUPLING]; answers how many there are. */
enum { SPARI_MOST_OF_COUPLING = 16 };
int spari_settings_of_coupling(const spar_session *session, double *values);
/* Those that trials vary: values[SPARI_MOST_VARIED] as the session has them; answers how many there are. */
enum { SPARI_MOST_VARIED = 16 };
int spari_settings_varied(const spar_session *session, double *values);
/* Another value for one of them, by the session's field. */
#define SPARI_VARY(values, field, x) (*spari_settings_place(values, offsetof(spar_session, field)) = (x))
double *spari_settings_place(double *values, size_t field);
/* The session has them so from now on. What depends on them is the caller's: past loads, the memory of the coupling. */
void spari_settings_vary(spar_session *session, const double *values);

#endif
