/* Candidate settings of the advice, and the results of runs with them. */
#ifndef SPARI_SETTINGS_TRIAL_H
#define SPARI_SETTINGS_TRIAL_H

#include "../trial/handle.h"
#include "../trial/rules.h"

#define SPARI_ADVISE "spar_trial_advise"

enum {
    SPARI_GROUPS = 8,   /* of identical beams; others stay unchanged */
    SPARI_FINEST = 6,   /* maximum halvings of the host's dt for the reference, */
    SPARI_COARSEST = 2, /* and initial doublings */
    SPARI_LEVELS = SPARI_FINEST + SPARI_COARSEST + 1,
    SPARI_KNOWN = 400 /* maximum number of remembered settings */
};

/* Stages of the search, in order. */
enum { SPARI_STAGE_REFERENCE, SPARI_STAGE_SHAPES, SPARI_STAGE_TIME, SPARI_STAGE_MOVES, SPARI_STAGE_LOOKS };

/* Settings of a beam. */
typedef struct spari_shape {
    int elements, nodes, fidelity, points;
    int64_t modes;
} spari_shape;

/* Settings of a run. Compared byte by byte: made by copies of one that began with zeros. */
typedef struct spari_plan {
    int64_t steps;                           /* in the time that the host asked for */
    int substeps, scheme, predictor, strict; /* strict: Newton ends at its rtol only */
    double rtol, newton;
    spari_shape group[SPARI_GROUPS];
} spari_plan;

typedef struct spari_outcome {
    spari_plan plan;
    double error, cost; /* INFINITY: it fails, or was ended because of its cost */
    double solutions;   /* of the fluid, per step */
    int guessed;        /* the run was ended because of its error: both are estimates */
} spari_outcome;

/* A run on the way to the reference. */
typedef struct spari_level {
    spari_plan plan;
    spari_record record; /* empty: it failed */
    double change;       /* change of the motion from the level before, relative to the tolerance; 0: none before */
} spari_level;

typedef struct spari_advisor {
    spar_session *session;
    spari_run run; /* as requested by the host */
    double tolerance;
    double longer;              /* length of the host's run, in trials */
    const spari_search *search; /* settings of the host */
    double limit;               /* of the total cost, in trials with the present session; INFINITY: none */
    int groups, *group;         /* [members] group of each; -1: unchanged */
    spari_level *level;         /* [SPARI_LEVELS] */
    int levels;
    int cap, few;   /* maximum nodes of the reference, 0: any; number that is clearly too few for all beams at once */
    double stalled; /* change by nodes that was attributed to dt, the last time; INFINITY: never, */
    int stalls;     /* and how often it was the same */
    int misled, thorough;   /* misled 1: a coarse dt gave too few nodes; thorough 1: coarse dt are no longer used */
    spari_record reference; /* comparison run for errors */
    double reference_error;
    const spari_record *beside; /* the current run ends if it is farther than `off` from this one; NULL: no limit */
    double off;
    spari_record last_look; /* comparison run of the last longer run: its settings, */
    spari_plan last_look_plan;
    int last_look_longer; /* its length in trials */
    double shortest;      /* period that steps must resolve, as a fraction of the trials' time; 0: none */
    double fluid;         /* cost of a fluid solution, */
    int weighed;          /* known after a completed run */
    double now;           /* cost of a trial with the present session; 0: unknown */
    double spent;         /* cost of all trials, */
    double shown;         /* of those for the reference, for judging the present session, and of longer runs, */
    int64_t solutions;    /* and fluid solutions before their cost was known */
    double runs;          /* savings count in a run of this many trials */
    double known_good;    /* cost of the cheapest settings that the reference has shown to keep the tolerance */
    int good_as_is;       /* these are the present session */
    int skipped;          /* trials that could not have saved their cost */
    spari_outcome *known; /* [SPARI_KNOWN] settings measured against the reference */
    int known_count, trials;
    int64_t dear_steps; /* number of steps of a level that was too expensive, or failed */
    int stage;          /* SPARI_STAGE_*, */
    double foreseen;    /* and the estimated total cost when it began, in the unit of progress; 0: none yet */
    spari_progress progress;
} spari_advisor;

/* Fills groups, group and the memory for known settings; both to be freed. Local. */
int spari_plan_groups(spari_advisor *advisor);
/* A member of the group. */
const spar_member *spari_plan_member(const spari_advisor *advisor, int group);
/* Why a member of the group cannot have this number of elements (nodes given by the host, joints and loads at nodes
   stay where they are); NULL: all can. */
const char *spari_plan_holds(const spari_advisor *advisor, int group, int elements);
/* The present session. */
spari_plan spari_plan_present(const spari_advisor *advisor);
/* The session settings of a plan, in values[SPARI_MOST_VARIED]. */
void spari_plan_settings(const spari_plan *plan, double *values);
/* Steps on a grid of ratios sqrt(2), j = 0: as the host asked; and the nearest grid position. */
int64_t spari_plan_steps(const spari_advisor *advisor, int j);
int spari_plan_grid(const spari_advisor *advisor, int64_t steps);
/* Whether a status means that the settings are unsuitable, and nothing worse. */
int spari_plan_fails(int status);

/* Begins the next stage, and estimates the total cost anew. */
void spari_plan_begin(spari_advisor *advisor, int stage);

/* Whether a trial of this cost can pay, if it reduces the cost of a trial's time in the run by at most `saving`. */
int spari_plan_pays(spari_advisor *advisor, double trial, double saving);

/* The calls below are collective. Runs `longer` times the trials; free the record also after a failure. most:
   maximum cost, beyond which the run ends as failed; INFINITY: no limit. */
int spari_plan_run(spari_advisor *advisor, const spari_plan *plan, int longer, double most, spari_record *record);
/* Error relative to the reference, and cost; INFINITY if the settings fail. Known settings are not run again. A run
   ends if its error is far beyond the tolerance. */
int spari_plan_measure(spari_advisor *advisor, const spari_plan *plan, double most, spari_outcome *out);
/* The same for a completed run. */
int spari_plan_judge(spari_advisor *advisor, const spari_record *record, spari_outcome *out);
/* The same for the runs on the way to the reference. */
int spari_plan_judge_levels(spari_advisor *advisor);
/* Whether it keeps the tolerance; a tenth is reserved for errors of the estimate. */
int spari_plan_is_good(const spari_advisor *advisor, const spari_outcome *outcome);
/* Limits beyond which a run is useless and ends: cost, and share of the tolerance; INFINITY: none. */
typedef struct spari_use {
    double cost, share;
} spari_use;
/* Change of the motion by the plan relative to a run of `base`, in tolerances; INFINITY: it fails. With a reference
   it becomes known, like a measurement. */
int spari_plan_distance(spari_advisor *advisor, const spari_plan *plan, const spari_record *base, spari_use use,
                        double *part, double *cost);
/* The same, and returns the run, to be freed; empty after a failure. */
int spari_plan_compare(spari_advisor *advisor, const spari_plan *plan, const spari_record *base, spari_use use,
                       spari_record *record, double *part);
/* Cost of the run, including the fluid's solutions. */
double spari_plan_cost(const spari_advisor *advisor, const spari_record *record);
/* Runs the present session; *record is to be freed. INFINITY: it fails. */
int spari_plan_try_present(spari_advisor *advisor, const spari_plan *present, spari_record *record);
/* Finds the reference: halves dt, from one coarser than the host's, until the remaining error, estimated from the
   decrease of the changes, is a small fraction of the tolerance. Refuses what it cannot establish. finest: its
   settings. */
int spari_plan_reference(spari_advisor *advisor, const spari_plan *present, spari_plan *finest);
void spari_plan_forget(spari_advisor *advisor);
/* Level on which the structure is chosen: the coarsest close to the reference. */
const spari_level *spari_plan_rough(const spari_advisor *advisor);
/* Number of steps that keep the tolerance with a tight coupling, from the levels. */
int64_t spari_plan_least_steps(const spari_advisor *advisor);
/* Cheapest level that keeps the tolerance; 0: none. */
const spari_level *spari_plan_good_level(const spari_advisor *advisor);
/* Length of the longer run, in trials. Local. */
int spari_plan_look(const spari_advisor *advisor, const spari_plan *plan);
/* Whether the settings stay stable in a longer run, which shows instabilities too slow for a trial; doubtful ones
   are compared with a tightly coupled run. trusts: doubtful ones count as unstable. most: settings that cost more
   per trial count as unstable; INFINITY: no limit. */
int spari_plan_stays(spari_advisor *advisor, const spari_plan *plan, int trusts, double most, int *stays);

#endif
