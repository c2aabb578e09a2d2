/* The scene: what every room may ask of the session it works for: clock, settings, ranks, members and fluids, and where
   messages go. */
#ifndef SPARI_SCENE_H
#define SPARI_SCENE_H

#include "message.h"
#include "workspace.h"

#include <math.h>

typedef struct spari_comm spari_comm; /* comm/comm.h */
typedef struct spari_own spari_own;   /* session/own.h */

/* Where a step stands. */
typedef enum spari_phase { SPARI_IDLE, SPARI_BEGUN, SPARI_SOLVED, SPARI_CHECKED } spari_phase;

/* A setting: a row of the one table of them (session/settings.c). */
typedef struct spari_setting {
    const char *name; /* in full: "rho_inf of spar_session_set_integrator" */
    const char *key;  /* of an option, or the argument's; NULL: what a call has done, compared between ranks only */
    size_t field;     /* of the session */
    enum {
        SPARI_IS_REAL,
        SPARI_IS_WHOLE,
        SPARI_IS_WORD
    } kind; /* a double, an int, an int that has words for 0 and 1 */
    int by; /* the call that sets it */
    double least, most;
    const char *range, *words[2]; /* what may be given, in words */
    double initial;
    int flags; /* SPARI_ALIKE, ... */
} spari_setting;
enum {
    SPARI_ALIKE = 1,       /* all ranks have it the same: compared in collective calls */
    SPARI_OF_COUPLING = 2, /* the memory of the coupling is made for it: made anew when it is set, and saved with it */
    SPARI_VARIED = 4       /* trials run with others, and advice gives it */
};

struct spar_session {
    spari_comm *comm;
    char message[SPARI_MESSAGE_SIZE];
    int64_t failures; /* messages written so far: tells whether a callback has left one */
    spar_log log;
    void *log_context;
    spar_progress progress; /* of calls that make trials */
    void *progress_context;
    spar_member *members;              /* list, in order of creation */
    spar_fluid *fluids;                /* list, this rank's */
    spar_joint *joints;                /* list, in order of creation */
    struct spari_assembly *assemblies; /* list: members that are solved as one */
    int joints_stale;                  /* joints were described since the assemblies were made */
    int member_count, joint_count;

    double gravity[3];
    double gravity_before[3]; /* that of the step accepted last; of the first one: none */
    double rho_inf;
    int substeps;
    double newton_atol, newton_rtol;
    int newton_max;
    int newton_strict;   /* option newton.stop = tied (default) | strict */
    double newton_share; /* tied: of its acceleration, what Newton may leave in the solution under way for the
                            coupling's sake; infinite: all */
    int predictor;       /* its order; as many loads before those of t^n are kept */
    int scheme;
    double coupling_atol, coupling_rtol;
    int coupling_max;
    double relaxation;
    int reproducible;
    int accept_unconverged;               /* option coupling.unconverged = accept */
    int coupling_columns, coupling_reuse; /* of IQN-ILS */
    double coupling_filter;
    double tolerance_drift, tolerance_rtol; /* of a step, m/s and relative; 0: none */
    int coupling_patience;                  /* option coupling.patience */
    int norm_of_loads;                      /* option coupling.norm = motion (default) | loads */
    int added_by_velocity;                  /* option fluid.added_mass = acceleration (default) | velocity */
    int coupling_estimate;                  /* option coupling.estimate = off (default) | on */
    double motion_atol, motion_rtol;        /* stop test on the motion; both 0: none */
    int theta_on_group;                     /* option fluid.theta = average (default) | group */
    int far_refuse; /* option fluid.far = take (default) | refuse: what a map does with nodes beyond max_distance */
    int keep_dt, keep_nodes, keep_fidelity, keep_coupling; /* options advise.* = keep */
    int goals;                                             /* SPAR_GOAL_* that advice is for */
    double advise_limit;                                   /* option advise.limit */
    double fluid_cost;                                     /* option advise.fluid_cost */
    int audit_off;                                         /* option fluid.audit = on (default) | off */
    struct spari_crew *crew; /* spar_session_set_threads (base/crew.h); NULL: the calling thread alone */
    spari_room room;         /* work space of the calling thread, for one call; its content is nobody's */
    int coupling_stale;      /* settings of the coupling have changed since it was made */

    double time, time_rest; /* rest: what rounding has left out of the clock, for the steps to come */
    double dt, dt_last[2];  /* dt of the step under way, and of the two accepted before */
    int uneven[2];       /* a step was of another length than those before it, or turned too far for generalised-alpha:
                            one that was accepted; or the one under way */
    int64_t step, begun; /* accepted; steps that were begun, ever */
    int iteration;
    spari_phase phase;
    int past;      /* loads before those of t^n that there are so far: the order of the next prediction; -1: nobody has
                      given those of t^n either */
    int order;     /* of the predictor in the step under way */
    int iterating; /* the last check asked for another iteration */
    int rough;     /* the loads of the iteration under way are far from the coupling's answer */
    int started;   /* the clock has run */
    int failed;    /* the last check of the step under way failed */
    const char
        *lent;    /* the call that the host's fluid solver runs inside, to which what is under way belongs; or NULL */
    int standing; /* what is under way is a static solution: there is one state, whatever theta a fluid pulls at */
    int trial;    /* a trial run is under way (trial.h) */

    const spari_setting *settings;
    int setting_count;
    int calls_differ; /* the ranks were found in different calls: nothing more can be agreed on */

    spari_own *own; /* what is the session's alone (session/own.h) */
};

/* What it is set to. */
double spari_setting_value(const spar_session *session, const spari_setting *of);

/* While `text` [SPARI_MESSAGE_SIZE] is not NULL, what fails in this thread writes its message there, and no session and
   no log hears of it. Returns where they went before. */
char *spari_messages_aside(char *text);

/* Tells the host's log, if there is one. */
void spari_log(const spar_session *session, int level, const char *text);

/* Steps of one length: hosts' steps differ in their last bits. */
static inline int spari_steps_alike(double h, double last) {
    return fabs(h - last) <= 1e-3 * last;
}
/* The clock goes on by dt: a compensated sum (Kahan), right to its last digit after any number of steps. */
static inline void spari_clock_tick(spar_session *s, double dt) {
    const double step = dt + s->time_rest, then = s->time + step;
    s->time_rest = s->time >= step ? (s->time - then) + step : (step - then) + s->time;
    s->time = then;
}
/* Whether a step dt of the session is taken by generalised-alpha (time/scheme.h). */
static inline int spari_steps_even(const spar_session *s, double dt) {
    return s->step == 0 ||
           (spari_steps_alike(dt, s->dt_last[0]) && (s->step == 1 || spari_steps_alike(s->dt_last[0], s->dt_last[1])));
}

#endif
