/* The session: one clock, its members, its fluids on this rank, one communicator. */
#ifndef SPARI_SESSION_H
#define SPARI_SESSION_H

#include "../comm/comm.h"
#include "../fluid/fluid.h"
#include "../member/member.h"
#include "coupling.h"

typedef struct spari_record spari_record; /* trial.h */

/* Where a step stands. */
typedef enum spari_phase { SPARI_IDLE, SPARI_BEGUN, SPARI_SOLVED, SPARI_CHECKED } spari_phase;

struct spar_session {
    spari_comm *comm;
    char message[SPARI_MESSAGE_SIZE];
    int64_t failures; /* messages written so far: tells whether a callback has left one */
    spar_log log;
    void *log_context;
    spar_member *members; /* list, in order of creation */
    spar_fluid *fluids;   /* list, this rank's */
    int member_count;

    double gravity[3];
    double rho_inf;
    int substeps;
    double newton_atol, newton_rtol;
    int newton_max;
    int predictor; /* its order; as many loads before those of t^n are kept */
    int scheme;
    double coupling_atol, coupling_rtol;
    int coupling_max;
    double relaxation;
    int accept_unconverged;               /* option coupling.unconverged = accept */
    int coupling_columns, coupling_reuse; /* of IQN-ILS */
    double coupling_filter;
    double coupling_target;          /* error the advised dt aims at */
    double motion_atol, motion_rtol; /* stop test on the motion; both 0: none */
    int theta_on_group;              /* option fluid.theta = average (default) | group */
    int far_refuse; /* option fluid.far = take (default) | refuse: what a map does with nodes beyond max_distance */
    int keep_dt, keep_nodes, keep_fidelity, keep_coupling; /* options advise.* = keep */
    double horizon;                                        /* option advise.horizon */
    int audit_off;                                         /* option fluid.audit = on (default) | off */

    double time, dt, dt_last[2]; /* dt of the step under way, and of the two accepted before */
    int64_t step;
    int iteration;
    spari_phase phase;
    int past;           /* loads before those of t^n that there are so far: the order of the next prediction */
    int order;          /* of the predictor in the step under way */
    int iterating;      /* the last check asked for another iteration */
    int started;        /* the clock has run */
    int failed;         /* the last check of the step under way failed */
    int trial;          /* a trial run is under way (trial.h) */
    int parted;         /* the ranks were found to be at different things: nothing more is to be agreed on */
    spari_record *kept; /* of a trial that others are compared with; NULL: none */
    double *pack;       /* loads of all members, stacked, for the ranks' sum: [6 * nodes of all members + 1] */
    int64_t pack_count;
    int64_t *first;           /* several ranks: where the block of each rank's members begins in `motion` */
    spari_coupling *coupling; /* from the first step on */
    int coupling_stale;       /* settings have changed since it was made */
    double *motion;           /* several ranks: motion of all solved members, by owner */
};

/* Entry of a collective call: agrees on a status and on what is called. */
int spari_session_enter(spar_session *session, const char *call, int status);
/* The same where arguments have to be alike, alike[count], and all that is set for the session. */
int spari_session_enter_alike(spar_session *session, const char *call, const spari_alike *alike, int count, int status);
/* The same of a call on one member. */
int spari_member_enter(const spar_member *member, const char *call, const spari_alike *alike, int count, int status);
/* Whether this rank's fluids have loads to go on with: the status of a push that was refused, with the call in front of
   its message. Local. */
int spari_session_pushes(spar_session *session, const char *call);
/* The sum over all ranks of what the fluids pushed; then the part of one member, into load [nodes][6]. The first is
   collective. */
int spari_session_exchange_loads(spar_session *session);
void spari_session_take_loads(const spar_session *session, const spar_member *member, double *load);
/* Motion and dissipation of the members each rank has solved for, from member->after, to all ranks.
 * Collective. */
int spari_session_share_motion(spar_session *session, int status);
/* Memory for the two calls above, for the members committed by now; agrees on a status. Collective. */
int spari_session_seal(spar_session *session, int status);

#endif
