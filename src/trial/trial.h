/* Trial runs: the session runs some steps from its present state with other settings, and is restored to the bit.
   Handles stay valid, because the host's callbacks use them; copies hold the original objects. */
#ifndef SPARI_TRIAL_H
#define SPARI_TRIAL_H

#include "../comm/enter.h"
#include "../exchange/session_private.h"
#include "../fluid/fluid.h"
#include "../session/callbacks.h"
#include "../session/settings.h"
#include "rebuild.h"
#include "run_record.h"

/* The number of steps of a run is a multiple of this. */
enum { SPARI_MULTIPLE = 8 };

/* A run: steps (a multiple of SPARI_MULTIPLE) of dt, with the host's callbacks. */
typedef struct spari_run {
    double dt;
    int64_t steps;
    spar_before_step before;
    void *before_context;
    spar_fluid_solver solve;
    void *solve_context;
    const double *numbers; /* [SPARI_MOST_NUMBERS] of the host, for the goal SPARI_OF_NUMBERS */
    int (*watch)(spar_session *session,
                 void *watcher); /* called after each step; may be NULL: a status that all ranks agree on */
    void *watcher;
    int (*instead)(spar_session *session, void *of); /* called with `of` instead of steps; may be NULL; the record stays
                                                        empty. Collective, a status that all ranks agree on */
    void *of;
    int goals;                /* blocks recorded beside the motion (run_record.h) */
    spari_progress *progress; /* called before each run, for calls with many runs; else NULL */
} spari_run;

/* Settings of a trial. */
typedef struct spari_trial_settings {
    double setting[SPARI_MOST_VARIED]; /* session/settings.h */
    int mute;                          /* SPARI_MUTE_* */
    spari_rebuild *member;             /* [members] */
} spari_trial_settings;

/* Refuses trials during a step or a trial, or with uncommitted members. Local. */
int spari_trial_check(spar_session *session, const char *call);
/* Refuses a number of steps that is no multiple of SPARI_MULTIPLE, and an end that is not finite. Local. */
int spari_trial_check_steps(spar_session *session, const char *call, double dt, int64_t steps);
/* Present settings. Free with spari_trial_settings_free. Collective. */
int spari_trial_settings_create(spar_session *session, spari_trial_settings *trial_settings);
void spari_trial_settings_free(spari_trial_settings *trial_settings);
/* Runs and restores. Allocates the record; free it with spari_record_free, also after any failure. Returns the
   failing rank's status on all of them, so that they continue equally; record.own is this rank's status for the
   host. Collective. */
int spari_trial_run(spar_session *session, const spari_run *run, const spari_trial_settings *trial_settings,
                    spari_record *record);
#endif
