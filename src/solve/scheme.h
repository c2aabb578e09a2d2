/* Generalised-alpha: its coefficients, and all that every member integrated with it does in the same way, however its
   state looks: the substeps of a step, starting values, corrections, accelerations at t^0, steps much longer than the
   last. The members of a session are integrated alike.

   A step much longer than the last: generalised-alpha carries an acceleration from step to step; of motions that the
   new step h no longer resolves (omega h >> 1) it would throw velocities of omega^2 h times their amplitude, which grow
   with every longer step: the scheme's overshoot in velocity. Such motions are taken out of it, and left to the
   scheme's own damping: of the acceleration b stays b - (I - cm S^-1 M)^2 b with S = K + cv C + cm M, in which
   (undamped) a mode of z = omega^2 / cm keeps 1 - (z / (1 + z))^2: all but z^2, of order h^4, of what is resolved, 2 /
   z of what is not. */
#ifndef SPARI_SCHEME_H
#define SPARI_SCHEME_H

#include "../member/structure.h"
#include "linear.h"

#include <float.h>

typedef struct spari_scheme {
    double h, alpha_m, alpha_f, beta, gamma;
    double cm, cv,
        cb;      /* d a / d x, d v / d x (where forces depend on rates) and d b / d x of the Newton increments x */
    double rate; /* d v / d x in any case */
    int still;   /* no inertia: equilibrium at each time, rates from the increments */
} spari_scheme;

/* What Newton's iteration has shown in the last solution: its contraction (0: not known), and by it what is left of the
   motion: of the member's length, rad. */
typedef struct spari_trace {
    double rate, left;
} spari_trace;
/* Whether two numbers of a file can be that. */
static inline int spari_trace_is(const double *x) {
    return x[0] >= 0 && x[0] < 1 && x[1] >= 0 && x[1] <= DBL_MAX;
}

/* Where a member's steps stand, and its loads [unique][6] within one. */
typedef struct spari_steps {
    double *load, *load0, *load1; /* at a substep's end, at t^n and at t^{n+1} */
    double h_begin, h_solved;     /* the (sub)steps that led to t^n and to t^{n+1}; 0: none yet */
    int started;                  /* accelerations at t^0 are known */
} spari_steps;

/* One substep: of n to its end. */
typedef struct spari_part {
    double s;                /* where in the step it ends, in (0, 1] */
    spari_pose before, root; /* a driven root at its ends */
    double ratio;            /* of the algorithmic accelerations it begins with: spari_scheme_stretch */
    int leaps;               /* it is much longer than the last */
} spari_part;

/* What differs from member to member. `self`: what is kept of it. */
typedef struct spari_integrand {
    /* accelerations at t^0 */
    int (*start)(void *self, const spar_member *m, const spari_scheme *c);
    /* begins at t^n; the power that damping takes out there */
    double (*begin)(void *self);
    /* to the part's end under steps->load; *power there */
    int (*substep)(void *self, const spar_member *m, const spari_scheme *c, const spari_part *part, double *power);
} spari_integrand;

/* Of substeps h, with the session's spectral radius. damped: forces depend on rates where there is no inertia. */
spari_scheme spari_scheme_of(const spar_member *member, int damped, double h);
/* Loads at the ends of the step, fluid and dead ones, of the nodes. */
void spari_scheme_loads(const spar_member *member, spari_steps *steps);
/* Accelerations at t^0, for steps dt, under load0; then as a step begins. 0, or a status and a message of start. */
int spari_scheme_balance(const spari_integrand *how, void *self, spari_steps *steps, spar_member *member, double dt);
/* From t^n to t^n + dt in the session's substeps, under `loads` numbers between load0 and load1; writes
   member->dissipated_step. 0, or a status and a message of start or substep. */
int spari_scheme_advance(const spari_integrand *how, void *self, spari_steps *steps, int loads, spar_member *member,
                         int damped, double dt);

/* Of a member with a guess of the fluid's added mass: load [unique][6] at the part s of a step, between those at t^n
   and the corrected ones at t^{n+1}, becomes one between corrected ones. */
void spari_scheme_begin_added(const spar_member *member, double s, double *load);

/* Of a step h to the one before (0: none), for spari_scheme_stretch. */
double spari_scheme_ratio(double before, double h);
/* The algorithmic acceleration b^n stands for the acceleration at t^n + (alpha_m - alpha_f) h: with a new h its
   distance from a^n is multiplied by the ratio of the steps; without this uneven steps are of first order. b := a +
   ratio (b - a) */
void spari_scheme_stretch(double ratio, int n, const double *a, double *b);

/* What stays over the step in the starting values of Newton. Smooth motion: the acceleration. Where stiff parts ring,
   their acceleration says nothing of the next: the velocity. Where the step is longer than the motion lasts: the place.
   Where a driven root jumps: the shape, the place as seen from there. */
typedef enum spari_guess {
    SPARI_KEEP_ACCELERATION,
    SPARI_KEEP_SHAPE,
    SPARI_KEEP_VELOCITY,
    SPARI_KEEP_PLACE
} spari_guess;

/* Rates of n unknowns, and true and algorithmic accelerations. */
typedef struct spari_rates {
    double *v, *a, *b;
} spari_rates;

/* Starting values with inertia: increments x and the rates they come with. */
void spari_scheme_predict(const spari_scheme *c, spari_guess stays, int n, spari_rates from, double *x, spari_rates to);
/* x and what hangs on it less `cut` times the correction dx. */
void spari_scheme_correct(const spari_scheme *c, double cut, int n, const double *dx, double *x, spari_rates to);

/* A vector of the unknowns, of accelerations y or of the state, into r. */
typedef void (*spari_forces)(void *self, const spar_member *m, const double *y, double *r);

/* Accelerations at t^0: those of the initial rigid-body field, and what the balance of forces there asks beyond them,
   through M + K / cm, factored in A, instead of M: parts that are stiff or light against this step (or have no mass at
   all) would start with accelerations that the step cannot follow. Each refinement solves for what is left; with
   z = omega^2 / cm a mode keeps 1 - (z / (1 + z))^4 of its acceleration. unbalance: inertia and internal forces less
   loads of the accelerations a. The first `held` of the n unknowns keep theirs. 0, or 1 when A is singular. */
int spari_scheme_start(const spari_scheme *c, spari_linear *A, int held, int n, spari_forces unbalance, void *self,
                       const spar_member *m, double *r, double *a);
/* A step to `h` after one of `before` (0: none) is much longer. */
int spari_scheme_leaps(double before, double h);
/* What is taken out of the accelerations that a much longer step begins with, y := (I - cm S^-1 M)^2 y. */
typedef struct spari_filter {
    void (*push)(void *self);           /* forces become M y */
    int (*solve)(void *self);           /* x becomes S^-1 times them; 0, or 1 when S is singular */
    void (*take)(void *self, double f); /* y becomes y - f x */
} spari_filter;
int spari_scheme_filter(const spari_scheme *c, const spari_filter *how, void *self);
/* The same of a vector y [n], S factored in A; the first `held` stay. r [n] room. 0, or 1 when it is singular. */
int spari_scheme_filter_vector(const spari_scheme *c, spari_linear *A, int held, int n, spari_forces times_mass,
                               void *self, const spar_member *m, double *r, double *y);

#endif
