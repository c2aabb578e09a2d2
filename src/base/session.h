/* State of a session that every room may use: clock, settings, ranks, members, fluids and messages. */
#ifndef SPARI_SESSION_H
#define SPARI_SESSION_H

#include "names.h"
#include "setting.h"
#include "workspace.h"

#include <math.h>

typedef struct spari_comm spari_comm; /* comm/comm.h */
typedef struct spari_own spari_own;   /* exchange/session_private.h */

/* Progress of the current step. */
typedef enum spari_phase { SPARI_IDLE, SPARI_BEGUN, SPARI_SOLVED, SPARI_CHECKED } spari_phase;

/* Ranks of the session, and what they agree on. */
typedef struct spari_ranks {
    spari_comm *comm;
    int calls_differ; /* the ranks were found in different calls: nothing more can be agreed on */
    int reproducible;
} spari_ranks;

/* Callbacks of the host. */
typedef struct spari_callbacks {
    spar_log log;
    void *log_context;
    spar_progress progress; /* told of Newton's iterations (budget.h); NULL: none */
    void *progress_context;
    int cancelled;           /* its answer that has cancelled the present solution; 0: none has */
    int muted;               /* a trial run is in progress, which tells the log nothing */
    const char *in_progress; /* callback in progress: the public call that runs the host's fluid solver, or its function
                                before a step; or NULL */
} spari_callbacks;

/* Settings of the time integration. */
typedef struct spari_integrator {
    double rho_inf;
    int substeps;
} spari_integrator;

/* Settings of Newton's method. */
typedef struct spari_newton_settings {
    double atol;
    double rtol;
    int max;
    int budget; /* iterations of a member, or of connected members, in a step */
} spari_newton_settings;

/* Settings of the coupling. */
typedef struct spari_coupling_settings {
    int predictor; /* order; the same number of loads before t^n is kept */
    int scheme;
    double atol;
    double rtol;
    int max;
    double relaxation;
    int accept_unconverged; /* option coupling.unconverged = accept */
    int accept_unstable;    /* option coupling.unstable = accept */
    int columns;            /* of IQN-ILS */
    int reuse;              /* of IQN-ILS */
    double filter;
    int patience;       /* option coupling.patience */
    int norm_of_loads;  /* option coupling.norm = motion (default) | loads */
    int estimate;       /* option coupling.estimate = off (default) | on */
    double motion_atol; /* stopping test on the motion; */
    double motion_rtol; /* both 0: none */
    int stale;          /* settings of the coupling have changed since it was made */
} spari_coupling_settings;

/* Tolerances of the error of a step; 0: none. */
typedef struct spari_tolerance {
    double drift; /* m/s */
    double rtol;  /* relative */
} spari_tolerance;

/* Time and number of the accepted steps, and lengths of the last steps. */
typedef struct spari_clock {
    double time;
    double rest;       /* rounding error of the time, carried to the next steps */
    double dt;         /* of the current step */
    double dt_last[2]; /* of the two accepted before */
    int uneven[2]; /* whether an accepted step, and the current one, differ in length from the steps before or rotate
                      too far for generalised-alpha */
    int64_t step;  /* accepted steps */
    int64_t begun; /* steps and static solutions ever begun */
    int started;
} spari_clock;

/* State of the current step, static solution or trial. */
typedef struct spari_step_state {
    spari_phase phase;
    int iteration;
    int past;  /* number of loads known before those of t^n, which limits the order of the next prediction; -1: those
                  of t^n are unknown too */
    int order; /* order of the predictor in the current step */
    int divergence_told; /* a warning of static divergence has been given in steps */
    int iterating;       /* the last check asked for another iteration */
    int rough;           /* the loads of this iteration are far from converged */
    int renew;           /* the coupling needs the tangents of the end of the solution, not reused ones */
    int failed;          /* the last check of the current step failed */
    int static_solution; /* a static solution, or that of the initial accelerations, is in progress: there is one state,
                            whatever theta a fluid pulls at */
    int trial;           /* a trial is in progress (trial/trial.h) */
} spari_step_state;

enum { SPARI_MOST_WARNINGS = 32 }; /* kept; later ones go to the log alone */

struct spar_session {
    char message[SPARI_MESSAGE_SIZE];
    char unread[SPARI_CAUSE_SIZE];       /* first failure since the host has read the message; "": none */
    int64_t failures;                    /* messages written so far: shows whether a callback has left one */
    char *warnings[SPARI_MOST_WARNINGS]; /* texts of the first warnings */
    int warning_count;
    spari_ranks ranks;
    spari_callbacks callbacks;

    spar_member *members;              /* list, in order of creation */
    spar_fluid *fluids;                /* list of this rank's fluids */
    spar_joint *joints;                /* list, in order of creation */
    struct spari_assembly *assemblies; /* list of assemblies: members solved as one system */
    int joints_stale;                  /* joints have changed since the assemblies were made */
    int member_count;
    int joint_count;
    spar_member *last_member; /* of those lists */
    spar_joint *last_joint;
    spar_fluid *last_fluid;
    spari_names member_names, joint_names;

    double gravity[3];
    double gravity_before[3]; /* gravity of the last accepted step */
    spari_integrator integrator;
    spari_newton_settings newton;
    spari_coupling_settings coupling;
    spari_tolerance tolerance;
    const spari_setting *settings; /* table of all settings */
    int setting_count;

    spari_clock clock;
    spari_step_state state;

    struct spari_thread_pool *pool; /* spar_session_set_threads (base/thread_pool.h); NULL: the calling thread alone */
    spari_workspace workspace;      /* work space of the calling thread, for one call; its content is nobody's */
    spari_workspace bodies;         /* the same for an element of a body (member/body.h) */
    spari_own *own;                 /* private data (exchange/session_private.h) */
};

/* Redirects messages of this thread to text [SPARI_MESSAGE_SIZE] until called with NULL; sessions and logs do not
   see them. Returns the previous destination. */
char *spari_messages_redirect(char *text);

/* Passes a text to the host's log callback, if there is one. */
void spari_log(const spar_session *session, int level, const char *text);
/* Warns the host: to the log, and kept for spar_session_get_warning, outside trials. Call it once per cause. */
void spari_warn(const spar_session *session, const char *format, ...) SPARI_PRINTF(2, 3);

/* Whether two step sizes are equal apart from rounding by the host. */
static inline int spari_steps_are_equal(double h, double last) {
    return fabs(h - last) <= 1e-3 * last;
}
/* Advances the clock by dt with compensated summation (Kahan): exact to the last digit after any number of steps. */
static inline void spari_clock_tick(spari_clock *c, double dt) {
    const double step = dt + c->rest, then = c->time + step;
    c->rest = c->time >= step ? (c->time - then) + step : (step - then) + c->time;
    c->time = then;
}
/* Whether a step of size dt is integrated by generalised-alpha (time/scheme.h). */
static inline int spari_steps_even(const spari_clock *c, double dt) {
    return c->step == 0 || (spari_steps_are_equal(dt, c->dt_last[0]) &&
                            (c->step == 1 || spari_steps_are_equal(c->dt_last[0], c->dt_last[1])));
}

#endif
