/* The accelerators of the coupling iteration x = G(x), over one stacked vector: x are the loads the structure was
   solved with, g = G(x) those that came back from the fluids. They know no session, no member and no rank: every rank
   runs the same instructions on the same bits.

   Schemes: constant relaxation; Aitken's dynamic relaxation (Irons & Tuck 1969; Kuettler & Wall 2008); interface
   quasi-Newton with least squares, IQN-ILS (Degroote, Bathe & Vierendeels 2009), with the filter QR2 of Haelterman et
   al. (2016): the newest columns first, each kept only if enough of it is independent of those before.

   Inner products are those of the images: <a, b> = a . S b, S symmetric and positive (semidefinite), where the caller
   gives S (g - x) and S g with x and g, and those of other loads when asked: S may be another one in each iteration. A
   fluid whose answers contradict each other (noise, or inner iterations that
   have not ended) is then found by what the columns of the step say of its next answer, and its derivative is fitted
   to all columns instead (secants.h).

   Some of that is memory: a fluid that goes a part of the way in an answer gives the rest with the next ones, dg_k = J
   dx_k + rho dg_(k-1). Where one rho explains what contradicts, differences, residual and the end of the step are those
   of a fluid that has settled (T31, T32).

   Without images, entries i with i % period < split are forces, the others moments (already divided by a length). Each
   of the two is measured by its own size, so that the choice of units changes no iterate. */
#ifndef SPARI_ACCELERATE_H
#define SPARI_ACCELERATE_H

#include <spar/spar.h>

typedef struct spari_accelerator spari_accelerator;

/* A scheme: a row of the table, by SPAR_COUPLING_*. Of the functions NULL is nothing to do. Beside what they do all
   schemes have the user's factor at first, and relaxation by the factor in use where `next` gives no loads. */
typedef struct spari_coupling_scheme {
    const char *name; /* "fixed point" */
    int iterates;     /* 0: the step is solved once, and there is no accelerator */
    int columns;      /* it keeps difference columns, and there is memory for them */
    void (*begin)(spari_accelerator *a);
    /* What the last two iterations show by their difference. */
    void (*learn)(spari_accelerator *a);
    int (*next)(spari_accelerator *a, const double *x, const double *g, double *next); /* 0: no loads */
} spari_coupling_scheme;

/* The table: SPAR_COUPLING_* and the row's name. */
#define SPARI_SCHEMES(ROW)                                                                                             \
    ROW(EXPLICIT, explicit)                                                                                            \
    ROW(FIXED_POINT, fixed_point)                                                                                      \
    ROW(AITKEN, aitken)                                                                                                \
    ROW(IQN_ILS, iqn_ils)
#define SPARI_COUNT_SCHEME(number, name) +1
enum { SPARI_SCHEME_COUNT = 0 SPARI_SCHEMES(SPARI_COUNT_SCHEME) };
const spari_coupling_scheme *spari_coupling_scheme_of(int scheme);

typedef struct spari_accelerator_settings {
    int scheme;    /* SPAR_COUPLING_* of one that iterates */
    double omega;  /* relaxation: constant, or of the first iterations and the most that Aitken begins a step with */
    int columns;   /* IQN-ILS: the most difference columns in use, >= 1 */
    int reuse;     /* IQN-ILS: accepted steps whose columns are used again, >= 0 */
    double filter; /* IQN-ILS: a column stays if more than this part of it is independent of newer ones; 0: any */
    int imaged;    /* IQN-ILS: there is memory for images */
} spari_accelerator_settings;

/* Takes all memory there will be need of; NULL: there is none. */
spari_accelerator *spari_accelerator_create(int64_t n, int period, int split,
                                            const spari_accelerator_settings *settings);
void spari_accelerator_free(spari_accelerator **accelerator);

/* A step begins. Columns of steps with another dt (by more than a tenth) rest while it lasts: dt is in the map. */
void spari_accelerator_begin(spari_accelerator *a, double dt);
typedef struct spari_images {
    const double *now; /* [2 n] of g - x and of g */
    /* Of others, by the S of these: x [count][n] in, image [count][n] out, with room for one more. What is zero costs
       nothing. The same on all ranks; a status. */
    int (*of)(void *context, int64_t count, const double *x, double *image);
    void *context;
} spari_images;

/* From x and g the next x; next may be x. The caller has found x not converged: g - x is not zero. images NULL, or not
   imaged: without. A status: that of images->of. */
int spari_accelerator_next(spari_accelerator *a, const double *x, const double *g, const spari_images *images,
                           double *next);
/* Whether answers contradict each other, so that the next step asks for the last of this one. */
int spari_accelerator_contradicted(const spari_accelerator *a);
/* The residual against what the fluid will have settled to, (T32): r [n] of x and g, which have not been given to
   `next` yet. Returns 0, and leaves r, where the fluid does not remember. */
int spari_accelerator_settle(const spari_accelerator *a, const double *x, const double *g, double *r);
/* The step is accepted: its columns may serve the next ones. g: what came back last, NULL: not known. */
void spari_accelerator_accept(spari_accelerator *a, const double *g);
/* The step is given up: all is as before it began. Its columns go, for what made the host reject the step (a failed
   solution, wild iterates) is in them. */
void spari_accelerator_reject(spari_accelerator *a);

/* Between steps: the map is another one from here on. */
void spari_accelerator_forget(spari_accelerator *a);

/* What the step under way has shown. */
int spari_accelerator_columns(const spari_accelerator *a); /* in the last least-squares problem */
int spari_accelerator_dropped(const spari_accelerator *a); /* columns filtered out in this step */
/* The largest -dx.dg / dx.dx of the step: what takes the place of (added mass)/(mass) in the piston model, whose map
   has the derivative minus that ratio. 0 before the second iteration. */
double spari_accelerator_ratio(const spari_accelerator *a);
/* Whether its columns are in the norm of the images. */
int spari_accelerator_imaged(const spari_accelerator *accelerator);
/* The same ratio over all differences of this step and, fading, of those before, weighed by the roots of their
   lengths, and the standard deviation of a single one. Answers 0, and zeros, where there are too few. */
int spari_accelerator_added_mass(const spari_accelerator *a, double *mean, double *spread);
/* How much the fluid's answers contradict each other, relative to their change: 0 of an exact function, 1 of noise. */
double spari_accelerator_scatter(const spari_accelerator *a);

/* The whole state as doubles, for save and load into an accelerator of the same n and settings. */
int64_t spari_accelerator_state_size(const spari_accelerator *a);
void spari_accelerator_save(const spari_accelerator *a, double *state);
/* Whether `count` doubles can be such a state; load answers the same and changes nothing where they cannot. */
int spari_accelerator_is_state(const spari_accelerator *a, const double *state, int64_t count);
int spari_accelerator_load(spari_accelerator *a, const double *state, int64_t count);

#endif
