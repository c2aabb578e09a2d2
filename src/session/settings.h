/* Settings of a session. */
#ifndef SPARI_SETTINGS_H
#define SPARI_SETTINGS_H

#include "../base/session.h"

/* Sets the documented defaults; and the table of settings. */
void spari_settings_default(spar_session *session);
/* Settings on which the coupling's memory depends: values[SPARI_MOST_OF_COUPLING]; returns their number. */
enum { SPARI_MOST_OF_COUPLING = 16 };
int spari_settings_of_coupling(const spar_session *session, double *values);
/* Settings that trials vary: their present values[SPARI_MOST_VARIED]; returns their number. */
enum { SPARI_MOST_VARIED = 16 };
int spari_settings_varied(const spar_session *session, double *values);
/* Changes one of these values, by the session's field. */
#define SPARI_VARY(values, field, x) (*spari_settings_place(values, offsetof(spar_session, field)) = (x))
double *spari_settings_place(double *values, size_t field);
/* Puts the values into the session. The caller updates what depends on them: past loads, memory of the coupling. */
void spari_settings_vary(spar_session *session, const double *values);

#endif
