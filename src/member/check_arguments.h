/* Argument checks shared by the public calls on members. They return 0, or a status with a message that begins with
   the name of the call. */
#ifndef SPARI_CHECK_ARGUMENTS_H
#define SPARI_CHECK_ARGUMENTS_H

#include "../comm/comm.h"
#include "structure.h"

int spari_need_member(const spar_member *member, const char *call);
/* The member must not be committed. */
int spari_need_open(spar_member *member, const char *call);
int spari_need_committed(const spar_member *member, const char *call);
/* All members must be committed. */
int spari_need_all_committed(const spar_session *session, const char *call);
/* No trial run, or no step, may be in progress. */
int spari_need_no_trial(const spar_session *session, const char *call);
int spari_need_idle(const spar_session *session, const char *call);
/* A beam, committed or not. */
int spari_need_any_beam(const spar_member *member, const char *call);
/* The member must be an uncommitted beam. */
int spari_need_beam(spar_member *member, const char *call);
/* Copies n stations with `width` numbers each to the table; `what` names them in messages. eta NULL: zeros. Without
   memory nothing changes. */
int spari_line_table_set(const spar_member *member, const char *call, const char *what, int64_t n, int width,
                         const double *eta, const double *value, spari_line_table *table);
/* Returns a table to a host: *count stations (may be NULL), and up to `capacity` of eta and value. */
int spari_line_table_get(const spar_member *member, const char *call, int width, const spari_line_table *table,
                         int64_t capacity, int64_t *count, double *eta, double *value);
/* Entry of a collective call on one member, as spari_enter_agreed. */
int spari_member_enter(const spar_member *member, const char *call, const spari_agreed *must_agree, int count,
                       int status);
/* x[n] must be finite and not NULL; `what` names it. */
int spari_need_finite(spar_session *session, const char *call, const char *name, const char *what, int64_t n,
                      const double *x);
/* dt must be positive, and its square must not underflow or overflow. */
int spari_need_dt(spar_session *session, const char *call, double dt);
/* n unit quaternions, `stride` doubles apart */
int spari_need_unit(spar_session *session, const char *call, const char *name, const char *what, int64_t n,
                    const double *q, int stride);
/* eta[n] in [0,1]. Order: strictly increasing, increasing but for jumps (two stations at the same eta), or any. */
typedef enum spari_order { SPARI_INCREASING, SPARI_WITH_JUMPS, SPARI_UNORDERED } spari_order;
int spari_need_eta(spar_session *session, const char *call, const char *name, int64_t n, const double *eta,
                   spari_order order);
/* n stations of a beam, at most `most`, 0: removes all; `width` finite numbers `what` at each. */
int spari_need_stations(const spar_member *beam, const char *call, int64_t n, int64_t most, const double *eta,
                        spari_order order, const char *what, int width, const double *value);

#endif
