/* The handle spar_trial: settings and callbacks of the host, results of its calls. */
#ifndef SPARI_HANDLE_H
#define SPARI_HANDLE_H

#include "trial.h"

/* Settings of the advice. */
typedef struct spari_search {
    int keep_dt;       /* option dt = keep */
    int keep_nodes;    /* option nodes = keep */
    int keep_coupling; /* option coupling = keep */
    int goals;         /* SPAR_GOAL_* */
    int limit;         /* option limit: trials */
} spari_search;

/* A row of the report of effects. */
typedef struct spari_effect {
    int in_force, fails;
    double size, motion, reaction, share;
} spari_effect;

/* The last advice. */
typedef struct spari_advised {
    int given;                             /* the search is complete */
    uint64_t of;                           /* members for which it is valid: spari_advised_of at that time */
    double dt, setting[SPARI_MOST_VARIED]; /* session/settings.h */
    int substeps, scheme, predictor;
    double coupling_rtol, newton_rtol;
    int64_t members;
    spari_rebuild *beam; /* [members] */
    double error, cost, present_error;
    int present_fails;
    int64_t runs;
    double work;
} spari_advised;

enum { SPARI_MOST_MODES = 200, SPARI_MOST_MEMORY = 1000000 }; /* of small motions */

struct spar_trial {
    spar_session *session;
    spar_trial *next; /* in the session's list */
    int64_t number;   /* in the order of creation: ranks must use the same trial */
    double dt;
    int64_t steps; /* 0: not set */
    spar_before_step before;
    void *before_context;
    spar_fluid_solver solve;
    void *solve_context;
    spar_progress progress;
    void *progress_context;
    spari_search search;
    int64_t modes; /* of small motions; 0: not set */
    double amplitude;
    int64_t memory;
    double numbers[SPARI_MOST_NUMBERS]; /* of the host, this rank's; 0: not pushed */
    char message[SPARI_MESSAGE_SIZE];   /* of the session, before the call under way */
    int running;                        /* a collective call is under way; */
    int gone;                           /* in which the host has destroyed the trial */
    int ran;                            /* there are results of spar_trial_run */
    double motion, reaction, load, seconds;
    int64_t evaluations;
    spari_record kept; /* the run that others are compared with; empty: none */
    int reported;      /* there are results of spar_trial_report_effects */
    spari_effect effect[SPAR_ROW_COUNT];
    spari_advised advised;
};

/* The run that the trial describes; progress: for calls of many runs, else NULL. */
spari_run spari_trial_run_of(const spar_trial *trial, spari_progress *progress);
spari_progress spari_trial_progress(const spar_trial *trial, const char *call);

/* Refuses a trial without steps, and what spari_trial_check refuses. Local. */
int spari_trial_ready(spar_trial *trial, const char *call);
/* The same for calls whose number of steps must be a multiple of SPARI_MULTIPLE. */
int spari_trial_ready_for_runs(spar_trial *trial, const char *call);
/* Enters a collective call, with the status of its checks: compares the settings of the trial and further arguments
   (at most SPARI_MOST_ARGUMENTS) across the ranks. If it succeeds, the trial is running until spari_trial_leave, which
   is called in any case after that, and is the last use of the trial: the host may have destroyed it meanwhile.
   leave: returns the status of the call. After a success the session has the message that it had before. */
enum { SPARI_MOST_ARGUMENTS = 4 };
int spari_trial_enter(spar_trial *trial, const char *call, const spari_agreed *arguments, int count, int status);
int spari_trial_leave(spar_trial *trial, const char *call, int status);

#endif
