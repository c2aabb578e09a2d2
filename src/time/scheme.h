/* Time integration by generalised-alpha and TR-BDF2: coefficients, loads, starting values, corrections and
   changes of dt. substeps.c runs it. All members of a session use the same integration, whatever their
   unknowns are. */
#ifndef SPARI_SCHEME_H
#define SPARI_SCHEME_H

#include "../algebra/linear.h"
#include "../member/structure.h"

#include <float.h>
#include <math.h>

/* The part of a substep that the trapezoidal stage of TR-BDF2 takes. */
#define SPARI_STAGE (2 - M_SQRT2)

typedef enum spari_rule { SPARI_ALPHA, SPARI_TRAPEZOIDAL, SPARI_BACKWARD } spari_rule;

typedef struct spari_scheme {
    spari_rule rule;
    double h;    /* of the substep */
    double span; /* from its beginning to the end of the stage */
    double alpha_m, alpha_f, beta, gamma;
    double cm, cv,
        cb;      /* d a / d x, d v / d x (where forces depend on rates) and d b / d x of the Newton increments x */
    double rate; /* d v / d x in any case */
    int still;   /* no inertia: equilibrium at each time, rates from the increments */
} spari_scheme;

/* Whether a number of a file can be Newton's estimated remaining correction. */
static inline int spari_is_remaining(double x) {
    return x >= 0 && x <= DBL_MAX;
}

/* The history of the substeps: the length of the last one (0: none yet), and how many before it had the same length,
   at most SPARI_EVEN. With SPARI_EVEN of them generalised-alpha continues. A run also begins with generalised-alpha:
   the stages of TR-BDF2 interpolate loads linearly in the step, and the loads at t = 0 are often not known. */
typedef struct spari_pattern {
    double h;
    int even;
} spari_pattern;
enum { SPARI_EVEN = 2 };
/* Whether two numbers of a file can be such values. */
static inline int spari_pattern_is(double h, double even) {
    return h >= 0 && h <= DBL_MAX && (even == 0 || even == 1 || even == 2);
}

/* Loads [unique][6] of a member within a step, and the pattern of its steps. */
typedef struct spari_steps {
    double *load, *load0, *load1; /* at the end of a stage, at t^n and at t^{n+1} */
    spari_pattern begin, solved;  /* of the (sub)steps that led to t^n and to t^{n+1} */
    int started;                  /* accelerations at t^0 are known */
} spari_steps;

/* A substep. Times are parts of the step dt, in [0, 1]. */
typedef struct spari_part {
    double dt;
    double from, to; /* where it begins and ends, */
    double end;      /* and where the stage under way ends */
    double ratio;    /* factor for the algorithmic accelerations at its beginning: spari_scheme_stretch */
    int last;        /* generalised-alpha goes on after it, if dt stays */
    double alpha;    /* length of the last substep, if that was generalised-alpha's; else 0 */
    int again;       /* a longer substep from here failed with TR-BDF2 */
} spari_part;

/* Of substeps h, with the session's spectral radius. damped: forces depend on rates where there is no inertia. */
spari_scheme spari_scheme_of(const spar_member *member, int damped, double h);
/* Loads at the ends of the step, fluid and dead ones, of the nodes. */
void spari_scheme_loads(const spar_member *member, spari_steps *steps);
/* The loads at the part s of a step, those corrected by a guess of the fluid's added mass included. */
void spari_scheme_mix_loads(const spar_member *member, const spari_steps *steps, int loads, double s);

/* C of (E1): the position error of a generalised-alpha step, per h^2 and change of the acceleration. */
static inline double spari_scheme_error(const spari_scheme *c) {
    return c->beta + 0.5 * (c->alpha_m - c->alpha_f) - 1.0 / 6;
}
/* The same coefficients for a stage of TR-BDF2. */
spari_scheme spari_scheme_stage(const spari_scheme *alpha, spari_rule rule);
/* After a step of TR-BDF2, (T35): part of M dx that a correction dx of its first stage adds to the loads of the second;
   and the part of the load itself that changes the velocity. */
static inline double spari_scheme_carried(const spari_scheme *backward) {
    return M_SQRT2 * backward->cm;
}
#define SPARI_DIAGONAL (1 - 0.5 * M_SQRT2)
/* The coefficients that the last substep of a pattern has ended with. */
spari_scheme spari_scheme_last(const spar_member *member, int damped, const spari_pattern *pattern);
/* The same coefficients for another length. */
spari_scheme spari_scheme_resize(const spari_scheme *alpha, double h);
/* If dt is within 0.1 % of the last step, generalised-alpha continues. Its algorithmic acceleration b^n, which
   stands for the acceleration at t^n + (alpha_m - alpha_f) h, follows: b := a + ratio (b - a). */
void spari_scheme_stretch(double ratio, int n, const double *a, double *b);
/* Whether the member has stiff parts that rotate freely. TR-BDF2 finds their velocities from positions. In a stage
   the velocities are off by a multiple of h^2 times the third derivative of the position, which is W^3 times the
   radius for a rotation at W. If dt changes, this error excites oscillations. Relative to the mean rigid motion of
   the member, the rotation is rest. */
int spari_member_rotates_stiffly(const spar_member *member);
/* w: the mean angular velocity of n nodes with velocities v [n][6]. */
void spari_mean_rotation(int64_t n, const double *v, double w[3]);
/* After a substep of TR-BDF2 from accelerations a0 to a: the b that generalised-alpha would go on with. */
void spari_scheme_restart(const spari_scheme *c, int n, const double *a0, const double *a, double *b);

/* The quantity that starting values keep constant over the step:
   - acceleration: smooth motion;
   - velocity: stiff parts oscillate, and their acceleration does not predict the next one;
   - position: the step is longer than the motion lasts;
   - shape, relative to the root: a driven root jumps. */
typedef enum spari_guess {
    SPARI_KEEP_ACCELERATION,
    SPARI_KEEP_SHAPE,
    SPARI_KEEP_VELOCITY,
    SPARI_KEEP_POSITION
} spari_guess;

/* Rates of n unknowns, and true and algorithmic accelerations. At the beginning of a backward-difference stage b has
   the accelerations at the end of the trapezoidal one, and `stage` its velocities. */
typedef struct spari_rates {
    double *v, *a, *b;
    const double *stage;
} spari_rates;

/* Starting values with inertia: increments x and the rates they come with. */
void spari_scheme_predict(const spari_scheme *c, spari_guess stays, int n, spari_rates from, double *x, spari_rates to);
/* Subtracts `cut` times the correction dx from x, and the corresponding changes from its rates. */
void spari_scheme_correct(const spari_scheme *c, double cut, int n, const double *dx, double *x, spari_rates to);

/* Called after a substep, for the energy that damping dissipates. *before is the power at its beginning, and becomes
   `power`. */
void spari_scheme_dissipate(spar_member *member, const spari_scheme *c, double *before, double power);

#endif
