/* What advice is chosen from: settings to run the session with, and what runs with them show. */
#ifndef SPARI_PLAN_H
#define SPARI_PLAN_H

#include "rules.h"
#include "trial.h"

#define SPARI_ADVISE "spar_session_advise"

enum {
    SPARI_GROUPS = 8, /* of beams described alike; what is beyond stays as it is */
    SPARI_FINEST = 6, /* the reference halves dt so often at most */
    SPARI_KNOWN = 400 /* settings remembered at most */
};

/* What of a beam is chosen. */
typedef struct spari_shape {
    int nodes, fidelity, points;
    int64_t modes;
} spari_shape;

/* What a run is made with. Compared byte by byte: made by copies of one that began with zeros. */
typedef struct spari_plan {
    int64_t steps; /* of the time that the host asked for */
    int substeps, scheme, predictor, unused;
    double rtol, newton;
    spari_shape group[SPARI_GROUPS];
} spari_plan;

typedef struct spari_outcome {
    spari_plan plan;
    double error, cost; /* INFINITY: it fails */
} spari_outcome;

typedef struct spari_advisor {
    spar_session *session;
    spari_run run; /* as the host asked */
    double tolerance;
    int groups, *group;     /* [members] of which group; -1: as it is */
    spari_record reference; /* the run that errors are taken against */
    double reference_error;
    double fluid;         /* what a solution of the fluid counts for; known once the reference is */
    spari_outcome *known; /* [SPARI_KNOWN] settings measured against the reference */
    int known_count, trials;
} spari_advisor;

/* Fills groups, group and the memory for what is known; both to be freed. Local. */
int spari_plan_groups(spari_advisor *advisor);
/* A member of the group. */
const spar_member *spari_plan_member(const spari_advisor *advisor, int group);
/* The session as it is. */
spari_plan spari_plan_present(const spari_advisor *advisor);
/* Its settings of the session, as trials vary them: of values[SPARI_MOST_VARIED] those that a plan has. */
void spari_plan_settings(const spari_plan *plan, double *values);
/* Steps on a grid of ratios sqrt(2), j = 0: as the host asked; and the nearest place of the grid. */
int64_t spari_plan_steps(const spari_advisor *advisor, int j);
int spari_plan_grid(const spari_advisor *advisor, int64_t steps);
/* Whether a status says that the settings will not do, and nothing worse. */
int spari_plan_fails(int status);

/* All below are collective. A run over `longer` times what the host asked for; the record is to be freed also after a
   failure. */
int spari_plan_run(spari_advisor *advisor, const spari_plan *plan, int longer, spari_record *record);
/* Error against the reference and cost; INFINITY if the settings fail. What is known is not run again. */
int spari_plan_measure(spari_advisor *advisor, const spari_plan *plan, spari_outcome *out);
/* Whether it keeps the tolerance; a tenth of that stays for what an estimate does not see. */
int spari_plan_is_good(const spari_advisor *advisor, const spari_outcome *outcome);
/* Change of the motion that the plan makes against a run of `base`, relative to the tolerance; INFINITY: it fails. */
int spari_plan_distance(spari_advisor *advisor, const spari_plan *plan, const spari_record *base, double *part,
                        double *cost);
/* What the run has cost, the fluid's solutions among it. */
double spari_plan_cost(const spari_advisor *advisor, const spari_record *record);
/* Finds the reference: halves dt until the error that is left, judged by how the changes fall, is a small part of the
   tolerance. finest: its settings. */
int spari_plan_reference(spari_advisor *advisor, const spari_plan *present, spari_plan *finest);
/* Whether the settings stay near a run with half the dt and a tight coupling for longer than the trials were: what
   grows slowly enough to pass a trial is found here. Errors of phase may have grown as the time has. */
int spari_plan_stays(spari_advisor *advisor, const spari_plan *plan, int *stays);

#endif
