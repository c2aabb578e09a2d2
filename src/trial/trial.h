/* Trial runs: the session runs some steps from where it stands, with other settings, and goes back to the bit. The
   handles stay where they are, since the host's callbacks know them; what they stand for waits in a copy. */
#ifndef SPARI_TRIAL_H
#define SPARI_TRIAL_H

#include "../comm/comm.h"
#include "../fluid/fluid.h"
#include "../session/own.h"
#include "../session/settings.h"
#include "remake.h"

/* Runs are compared at this many times, evenly spread over them. */
enum { SPARI_SAMPLES = 8 };

/* What runs: steps (a multiple of SPARI_SAMPLES) of dt, with the host's callbacks. */
typedef struct spari_run {
    double dt;
    int64_t steps;
    spar_before_step before;
    spar_fluid_solver solve;
    void *context;
    int (*watch)(spar_session *session,
                 void *watcher); /* NULL, or called after each step: a status that all agree on */
    void *watcher;
    int timed; /* whether the time of the fluid's solutions is wanted */
} spari_run;

/* What is to be otherwise than the session has it. */
typedef struct spari_wish {
    double setting[SPARI_MOST_VARIED]; /* session/settings.h */
    int mute;                          /* SPARI_MUTE_* */
    spari_remake *member;              /* one for each member */
} spari_wish;

/* What a run leaves behind. */
struct spari_record {
    int64_t stations; /* places looked at, all members */
    int members;
    double *motion;   /* [SPARI_SAMPLES][stations][3]: displacements */
    double *beyond;   /* the same beyond what moves with the root, or, where nothing holds it, since the beginning */
    double *reaction; /* [SPARI_SAMPLES][members][6], moments by the member's length */
    double *load; /* [members][6]: fluid loads after the first step, their sum and moment by the length about the root's
                     reference place */
    double *trail;         /* [4][members][6] the same of the last three steps, and their second difference */
    double alternating[2]; /* part of the loads that turns round from step to step, squared, in the second and in the
                              last quarter of the run, relative to the loads of both */
    double seconds;        /* processor time of the steps, all ranks */
    double fluid_seconds;  /* of timed runs: of that, the fluid's */
    double work;           /* what the steps cost without the fluid, and what a solution of the fluid may cost by its */
    double fluid;          /* nodes, counted (cost.h); all ranks */
    int64_t solutions;     /* calls of the fluid solver */
    double report[SPAR_REPORT_COUNT]; /* of the coupling, at the end */
    int asked;                        /* SPARI_MUTE_*: what the host has pulled and pushed */
    int own;                          /* what this rank answers for a run that failed */
};

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
void spari_record_free(spari_record *record);
/* The session takes the record for later comparisons; *record is empty then. Collective. */
int spari_trial_keep(spar_session *session, spari_record *record);
/* Root of the mean square of the difference over that of b's motion beyond its root, of b's reactions, of its loads. */
double spari_record_motion(const spari_record *a, const spari_record *b);
/* How much larger the root of the mean square of the difference is over `longer` times the run, if it goes on as the
   straight line (level and slope not negative) nearest to its samples. */
double spari_record_growth(const spari_record *a, const spari_record *b, double longer);
double spari_record_reaction(const spari_record *a, const spari_record *b);
double spari_record_load(const spari_record *a, const spari_record *b);

#endif
