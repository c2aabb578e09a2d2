/* State of a session that every room may use: clock, settings, ranks, members, fluids and messages. */
#ifndef SPARI_SESSION_H
#define SPARI_SESSION_H

#include "message.h"
#include "workspace.h"

#include <math.h>

typedef struct spari_comm spari_comm; /* comm/comm.h */
typedef struct spari_own spari_own;   /* exchange/session_private.h */

/* Progress of the current step. */
typedef enum spari_phase { SPARI_IDLE, SPARI_BEGUN, SPARI_SOLVED, SPARI_CHECKED } spari_phase;

/* A setting: one row of the table in session/settings.c. */
typedef struct spari_setting {
    const char *name; /* full name: "rho_inf of spar_session_set_integrator" */
    const char *key;  /* name of the option or argument; NULL: the effect of a call, compared between ranks only */
    size_t field;     /* offset in spar_session */
    enum { SPARI_IS_REAL, SPARI_IS_WHOLE, SPARI_IS_WORD } kind; /* double, int, or int with words for 0 and 1 */
    int by;                                                     /* call that sets it */
    double least, most;
    const char *range, *words[2]; /* allowed values, in words */
    double initial;
    int flags; /* SPARI_AGREED, ... */
} spari_setting;
enum {
    SPARI_AGREED = 1,      /* must agree across ranks: compared in collective calls */
    SPARI_OF_COUPLING = 2, /* the coupling depends on it: it is created anew after a change, and saved with it */
    SPARI_VARIED = 4       /* varied by trials and advice */
};

struct spar_session {
    spari_comm *comm;
    char message[SPARI_MESSAGE_SIZE];
    int64_t failures; /* messages written so far: shows whether a callback has left one */
    spar_log log;
    void *log_context;
    spar_progress progress; /* of calls that run trials */
    void *progress_context;
    spar_member *members;              /* list, in order of creation */
    spar_fluid *fluids;                /* list of this rank's fluids */
    spar_joint *joints;                /* list, in order of creation */
    struct spari_assembly *assemblies; /* list of assemblies: members solved as one system */
    int joints_stale;                  /* joints have changed since the assemblies were made */
    int member_count, joint_count;

    double gravity[3];
    double gravity_before[3]; /* gravity of the last accepted step */
    double rho_inf;
    int substeps;
    double newton_atol, newton_rtol;
    int newton_max;
    int newton_strict;   /* option newton.stop = tied (default) | strict */
    double newton_share; /* with newton.stop = tied: relative acceleration error that Newton may leave, from the
                            coupling tolerance; infinite: no limit */
    int predictor;       /* order; the same number of loads before t^n is kept */
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
    double motion_atol, motion_rtol;        /* stopping test on the motion; both 0: none */
    int theta_on_group;                     /* option fluid.theta = average (default) | group */
    int far_refuse;                         /* option fluid.far = take (default) | refuse: nodes beyond max_distance */
    int keep_dt, keep_nodes, keep_fidelity, keep_coupling; /* options advise.* = keep */
    int goals;                                             /* SPAR_GOAL_* of the advice */
    double advise_limit;                                   /* option advise.limit */
    double fluid_cost;                                     /* option advise.fluid_cost */
    int audit_off;                                         /* option fluid.audit = on (default) | off */
    struct spari_thread_pool *pool; /* spar_session_set_threads (base/thread_pool.h); NULL: the calling thread alone */
    spari_workspace workspace;      /* work space of the calling thread, for one call; its content is nobody's */
    int coupling_stale;             /* settings of the coupling have changed since it was made */

    double time, time_rest; /* time_rest: rounding error of the clock, carried to the next steps */
    double dt, dt_last[2];  /* dt of the current step, and of the two accepted before */
    int uneven[2]; /* whether an accepted step, and the current one, differ in length from the steps before or rotate
                      too far for generalised-alpha */
    int64_t step, begun; /* accepted steps; steps ever begun */
    int iteration;
    spari_phase phase;
    int past;  /* number of loads known before those of t^n, which limits the order of the next prediction; -1: those of
                  t^n are unknown too */
    int order; /* order of the predictor in the current step */
    int iterating;           /* the last check asked for another iteration */
    int rough;               /* the loads of this iteration are far from converged */
    int started;             /* the clock has started */
    int failed;              /* the last check of the current step failed */
    const char *in_callback; /* callback in progress: the public call that runs the host's fluid solver; or NULL */
    int standing;            /* a static solution is in progress: there is one state, whatever theta a fluid pulls at */
    int trial;               /* a trial is in progress (trial/trial.h) */

    const spari_setting *settings;
    int setting_count;
    int calls_differ; /* the ranks were found in different calls: nothing more can be agreed on */

    spari_own *own; /* private data (exchange/session_private.h) */
};

/* Present value of a setting. */
double spari_setting_value(const spar_session *session, const spari_setting *of);

/* Redirects messages of this thread to text [SPARI_MESSAGE_SIZE] until called with NULL; sessions and logs do not
   see them. Returns the previous destination. */
char *spari_messages_redirect(char *text);

/* Passes a text to the host's log callback, if there is one. */
void spari_log(const spar_session *session, int level, const char *text);

/* Whether two step sizes are equal apart from rounding by the host. */
static inline int spari_steps_are_equal(double h, double last) {
    return fabs(h - last) <= 1e-3 * last;
}
/* Advances the clock by dt with compensated summation (Kahan): exact to the last digit after any number of steps. */
static inline void spari_clock_tick(spar_session *s, double dt) {
    const double step = dt + s->time_rest, then = s->time + step;
    s->time_rest = s->time >= step ? (s->time - then) + step : (step - then) + s->time;
    s->time = then;
}
/* Whether a step of size dt is integrated by generalised-alpha (time/scheme.h). */
static inline int spari_steps_even(const spar_session *s, double dt) {
    return s->step == 0 || (spari_steps_are_equal(dt, s->dt_last[0]) &&
                            (s->step == 1 || spari_steps_are_equal(s->dt_last[0], s->dt_last[1])));
}

#endif
