/* What advice is chosen from: settings to run the session with, and what runs with them show. */
#ifndef SPARI_PLAN_H
#define SPARI_PLAN_H

#include "../trial/rules.h"
#include "../trial/trial.h"

#define SPARI_ADVISE "spar_session_advise"

enum {
    SPARI_GROUPS = 8,   /* of beams described alike; what is beyond stays as it is */
    SPARI_FINEST = 6,   /* the reference halves the host's dt so often at most, */
    SPARI_COARSEST = 2, /* and begins with it doubled so often */
    SPARI_LEVELS = SPARI_FINEST + SPARI_COARSEST + 1,
    SPARI_KNOWN = 400 /* settings remembered at most */
};

/* What asking goes through, in this order. */
enum { SPARI_STAGE_REFERENCE, SPARI_STAGE_SHAPES, SPARI_STAGE_TIME, SPARI_STAGE_MOVES, SPARI_STAGE_LOOKS };

/* What of a beam is chosen. */
typedef struct spari_shape {
    int elements, nodes, fidelity, points;
    int64_t modes;
} spari_shape;

/* What a run is made with. Compared byte by byte: made by copies of one that began with zeros. */
typedef struct spari_plan {
    int64_t steps;                           /* of the time that the host asked for */
    int substeps, scheme, predictor, strict; /* strict: Newton ends at its rtol and nowhere before */
    double rtol, newton;
    spari_shape group[SPARI_GROUPS];
} spari_plan;

typedef struct spari_outcome {
    spari_plan plan;
    double error, cost; /* INFINITY: it fails; a run that was ended for its cost has that */
    double solutions;   /* of the fluid, in a step */
    int guessed;        /* the run was ended for its error: both are what they would have come to, about */
} spari_outcome;

/* A run of those that lead to the reference. */
typedef struct spari_level {
    spari_plan plan;
    spari_record record; /* empty: it failed */
    double change;       /* of the motion from the one before, relative to the tolerance; 0: there is none */
} spari_level;

typedef struct spari_advisor {
    spar_session *session;
    spari_run run; /* as the host asked */
    double tolerance;
    double longer;      /* the host's run, relative to the trials */
    int goals;          /* SPAR_GOAL_* */
    double limit;       /* of all that is spent, in trials with the session as it is; INFINITY: none */
    int groups, *group; /* [members] of which group; -1: as it is */
    spari_level *level; /* [SPARI_LEVELS] */
    int levels;
    int cap, few;           /* nodes that the reference has at most, 0: any; so many are clearly too few for all beams
                               at once */
    double stalled;         /* change by nodes that was taken for one by dt, the last time; INFINITY: none was, */
    int stalls;             /* and so many times it was the same */
    int misled, thorough;   /* 1: a coarse dt had asked for too few; 1: no more is it asked */
    spari_record reference; /* what they lead to: errors are taken against it */
    double reference_error;
    const spari_record
        *beside; /* the run that is made ends where it is further `off` from this one; NULL: it does not */
    double off;
    spari_record calm; /* what the last look was compared with: how it was made, */
    spari_plan calm_plan;
    int calm_longer;   /* over so many times the trials */
    double shortest;   /* period that steps have to resolve, as a part of the trials' time; 0: any will do */
    double fluid;      /* what a solution of the fluid counts for, */
    int weighed;       /* known once a run has come to its end */
    double now;        /* what a trial with the session as it is costs; 0: not known yet */
    double spent;      /* what all trials have cost, */
    double shown;      /* what those had that led to the reference, judged the session as it is, or looked further, */
    int64_t solutions; /* and those of the fluid before that was weighed */
    double runs;       /* what is saved counts in a run of so many times the trials */
    double known_good; /* cost of the cheapest settings that the reference has shown to keep the tolerance */
    int good_as_is;    /* those are the session as it is */
    int skipped;       /* trials not made because they could not save as much as they cost */
    spari_outcome *known; /* [SPARI_KNOWN] settings measured against the reference */
    int known_count, trials;
    int64_t dear_steps; /* with so few a level came to cost too much, or failed */
    int stage;          /* SPARI_STAGE_*, */
    double foreseen;    /* and what all was reckoned to come to as it began, in the unit of progress; 0: not yet */
    spari_progress progress;
} spari_advisor;

/* Fills groups, group and the memory for what is known; both to be freed. Local. */
int spari_plan_groups(spari_advisor *advisor);
/* A member of the group. */
const spar_member *spari_plan_member(const spari_advisor *advisor, int group);
/* Why one of the group cannot have so many elements, since what the host gave by nodes, and what it has tied or loaded
   at nodes, stays where it is; NULL: all can. */
const char *spari_plan_holds(const spari_advisor *advisor, int group, int elements);
/* The session as it is. */
spari_plan spari_plan_present(const spari_advisor *advisor);
/* Its settings of the session, as trials vary them: of values[SPARI_MOST_VARIED] those that a plan has. */
void spari_plan_settings(const spari_plan *plan, double *values);
/* Steps on a grid of ratios sqrt(2), j = 0: as the host asked; and the nearest place of the grid. */
int64_t spari_plan_steps(const spari_advisor *advisor, int j);
int spari_plan_grid(const spari_advisor *advisor, int64_t steps);
/* Whether a status says that the settings will not do, and nothing worse. */
int spari_plan_fails(int status);

/* The next stage begins: what asking will come to is reckoned anew. */
void spari_plan_begin(spari_advisor *advisor, int stage);

/* Whether a trial of that cost can pay, if it brings the cost of a trial's time in the run down by so much at most. */
int spari_plan_pays(spari_advisor *advisor, double trial, double saving);

/* All below are collective. A run over `longer` times what the host asked for; the record is to be freed also after a
   failure. most: where it comes to cost more it ends, as one that fails; INFINITY: whatever it costs. */
int spari_plan_run(spari_advisor *advisor, const spari_plan *plan, int longer, double most, spari_record *record);
/* Error against the reference and cost; INFINITY if the settings fail. What is known is not run again. A run ends
   where its error is far beyond the tolerance. */
int spari_plan_measure(spari_advisor *advisor, const spari_plan *plan, double most, spari_outcome *out);
/* The same of a run that has been made. */
int spari_plan_judge(spari_advisor *advisor, const spari_record *record, spari_outcome *out);
/* The same of the runs that led to the reference. */
int spari_plan_judge_levels(spari_advisor *advisor);
/* Whether it keeps the tolerance; a tenth of that stays for what an estimate does not see. */
int spari_plan_is_good(const spari_advisor *advisor, const spari_outcome *outcome);
/* Where a run is of no use any more, and ends: at a cost, beyond a share of the tolerance; INFINITY: nowhere. */
typedef struct spari_use {
    double cost, share;
} spari_use;
/* Change of the motion that the plan makes against a run of `base`, relative to the tolerance; INFINITY: it fails. Once
   there is a reference it is known like what is measured. */
int spari_plan_distance(spari_advisor *advisor, const spari_plan *plan, const spari_record *base, spari_use use,
                        double *part, double *cost);
/* The same, keeping the run, which is to be freed; it is empty where it fails. */
int spari_plan_compare(spari_advisor *advisor, const spari_plan *plan, const spari_record *base, spari_use use,
                       spari_record *record, double *part);
/* What the run has cost, the fluid's solutions among it. */
double spari_plan_cost(const spari_advisor *advisor, const spari_record *record);
/* Runs the session as it is; *record is to be freed. INFINITY: it fails. */
int spari_plan_try_present(spari_advisor *advisor, const spari_plan *present, spari_record *record);
/* Finds the reference: halves dt, from one that is coarser than the host's, until the error that is left, judged by how
   the changes fall, is a small part of the tolerance; refuses what it cannot vouch for. finest: its settings. */
int spari_plan_reference(spari_advisor *advisor, const spari_plan *present, spari_plan *finest);
void spari_plan_forget(spari_advisor *advisor);
/* The level that the structure is chosen on: the coarsest that is not far from the reference. */
const spari_level *spari_plan_rough(const spari_advisor *advisor);
/* So many steps keep the tolerance with a tight coupling, as the levels show. */
int64_t spari_plan_least_steps(const spari_advisor *advisor);
/* The cheapest of the levels that keep the tolerance, as they lead to the reference; 0: none does. */
const spari_level *spari_plan_good_level(const spari_advisor *advisor);
/* So many times the trials' time that takes. Local. */
int spari_plan_look(const spari_advisor *advisor, const spari_plan *plan);
/* Whether the settings stay where they are for longer than the trials were: what grows slowly enough to pass a trial is
   found here; where it may be so, beside a run with a tight coupling. trusts: what looks unstable is. most: what costs
   more than so much in a trial's time does not stay; INFINITY: whatever it costs. */
int spari_plan_stays(spari_advisor *advisor, const spari_plan *plan, int trusts, double most, int *stays);

#endif
