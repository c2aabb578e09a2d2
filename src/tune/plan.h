/* Settings that the advice tries, and its trials with them. */
#ifndef SPARI_PLAN_H
#define SPARI_PLAN_H

#include "../trial/handle.h"

#define SPARI_ADVISE "spar_trial_advise"

/* Settings of a trial. */
typedef struct spari_plan {
    int64_t steps; /* in the time that the host asked for */
    int more;      /* nodes of each element beyond those that a beam has, < 0: fewer */
    int scheme, predictor;
    double rtol, newton;
} spari_plan;

/* A trial. */
typedef struct spari_tried {
    spari_plan plan;
    spari_record record; /* empty: the trial failed */
    double error;        /* of the run that the host asked for, relative; INFINITY: it fails */
    double cost;         /* solutions of structure and fluid, weighed by the nodes */
    int tight;           /* one of the chain that leads to the reference */
} spari_tried;

typedef struct spari_advisor {
    spar_session *session;
    const spari_search *search;
    spari_run run; /* as the host asked */
    spari_progress progress;
    double tolerance, longer; /* longer: length of the host's run, in trials */
    spari_plan present;
    spari_tried *tried; /* [most] */
    int count, most;    /* trials made, and allowed */
    int chain[32], links, reference;
    double reference_error, order; /* of the reference; observed power of dt */
    double step_error, node_error; /* estimates from the first trial, relative to the motion */
    double drift;                  /* the steps' if all were as those of the last third */
    int64_t estimated;             /* steps of that trial */
    double mass;                   /* ratio of the added mass that the iterations have shown */
    int own_coupling;              /* the fluid does not allow a tighter one */
    double shortest;               /* period that steps must resolve, as a fraction of a trial; 0: none */
} spari_advisor;

spari_plan spari_plan_present(const spar_session *session, int64_t steps);
/* The session settings of a plan, in values[SPARI_MOST_VARIED]. */
void spari_plan_settings(const spari_plan *plan, double *values);
/* Settings of a member in a plan. */
spari_rebuild spari_plan_rebuild(const spar_member *member, const spari_plan *plan);
/* Whether there are beams whose nodes can be varied by this number. */
int spari_plan_has_nodes(const spari_advisor *advisor, int more);
/* Makes a trial. *index: of it; -1: no more trials are allowed. A trial that fails is kept, with an infinite error.
   Collective. */
int spari_plan_try(spari_advisor *advisor, const spari_plan *plan, int *index);
/* Error of trial a against trial b over the host's run. Collective. */
int spari_plan_distance(spari_advisor *advisor, int a, int b, double *error);
/* Tells the log. */
void spari_plan_tell(const spari_advisor *advisor, const spari_tried *tried);

#endif
