/* Trial runs: the session runs some steps from where it stands, with other settings, and goes back to the bit. The
   handles stay where they are, since the host's callbacks know them; what they stand for waits in a copy. */
#ifndef SPARI_TRIAL_H
#define SPARI_TRIAL_H

#include "../comm/comm.h"
#include "../exchange/session_private.h"
#include "../fluid/fluid.h"
#include "../session/callbacks.h"
#include "../session/settings.h"
#include "rebuild.h"
#include "run_record.h"

/* Steps of a run come in such numbers. */
enum { SPARI_MULTIPLE = 8 };

/* What runs: steps (a multiple of SPARI_MULTIPLE) of dt, with the host's callbacks. */
typedef struct spari_run {
    double dt;
    double length; /* of advice: of the host's own run, s */
    int64_t steps;
    spar_before_step before;
    spar_fluid_solver solve;
    void *context;
    int (*watch)(spar_session *session,
                 void *watcher); /* NULL, or called after each step: a status that all agree on */
    void *watcher;
    int (*instead)(spar_session *session, void *of); /* NULL, or what is done there in place of steps, with `of`; the
                                                        record stays empty. Collective, a status that all agree on */
    void *of;
    int timed;          /* whether the time of the fluid's solutions is wanted */
    int goals;          /* what the record has beside the motion (record.h) */
    double most, fluid; /* a run that comes to cost more is of no use and ends, SPAR_ERR_NUMERIC; 0: no such limit.
                           With what a solution of the fluid counts for */
    const spari_record *beside; /* nor is one that is further `off` from this one (spari_record_error), and ends
                                   likewise; NULL: none */
    double off;
    spari_progress *progress; /* who hears of each run ahead of it, of calls that make many; else NULL */
} spari_run;

/* What is to be otherwise than the session has it. */
typedef struct spari_wish {
    double setting[SPARI_MOST_VARIED]; /* session/settings.h */
    int mute;                          /* SPARI_MUTE_* */
    spari_remake *member;              /* one for each member */
} spari_wish;

/* Refuses what cannot be tried: a step under way, a trial under way, members not committed, bad numbers. Local. */
int spari_trial_check(spar_session *session, const char *call, const spari_run *run);
/* Entry of a call that makes trials, with status of the check: all ranks try the same. tolerance, compare: of the calls
   that have them, else 0. Collective. */
int spari_trial_enter(spar_session *session, const char *call, const spari_run *run, double tolerance, int compare,
                      int status);
/* The session as it is. Frees: spari_wish_free. Collective. */
int spari_wish_create(spar_session *session, spari_wish *wish);
void spari_wish_free(spari_wish *wish);
/* Runs and goes back. The record's memory is taken here; free it with spari_record_free, also after a failure, however
   early. Answers the failing rank's status on all of them, so that they go on alike; record.own is what the host is to
   be told. Collective. */
int spari_trial_run(spar_session *session, const spari_run *run, const spari_wish *wish, spari_record *record);
/* The session takes the record for later comparisons; *record is empty then. Collective. */
int spari_trial_keep(spar_session *session, spari_record *record);
#endif
