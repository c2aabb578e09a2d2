/* Acceleration of the coupling iteration x = G(x) on one stacked vector: x are the loads with which the structure
   was solved, g = G(x) the loads that came back from the fluids. Independent of session, member and ranks: every
   rank executes the same operations on the same bits.
   Schemes: constant relaxation; Aitken relaxation (Irons & Tuck 1969; Kuettler & Wall 2008); interface quasi-Newton
     with least squares, IQN-ILS (Degroote, Bathe & Vierendeels 2009): iqn_ils.c.
   Images. If the caller passes the motion since the iteration before, S (g - x) and S g with x and g, and S times
     other loads on request, IQN-ILS learns the fluid alone: fluid_secants.c. S, the flexibility, may change in each
     iteration and need not be symmetric.
   Memory. A fluid that responds only partly gives the rest with the next results, dg_k = J dx_k + rho dg_(k-1).
     Secants, residual and convergence are then those of the settled fluid (T32, T34).
   Without images, entries i with i % period < split are forces, the others moments (already divided by a length).
     Each kind is scaled by its own size, so iterates do not depend on units. */
#ifndef SPARI_SCHEMES_H
#define SPARI_SCHEMES_H

#include <spar/spar_coupling.h>

typedef struct spari_accelerator spari_accelerator;

/* A scheme: a row of the table, by SPAR_COUPLING_*. Functions may be NULL. All schemes begin with the user's
   relaxation factor, and relax with the factor in use if `next` fails. */
typedef struct spari_coupling_scheme {
    const char *name; /* "fixed point" */
    int iterates;     /* 0: the step is solved once, without accelerator */
    int columns;      /* uses difference columns, which need memory */
    void (*begin)(spari_accelerator *a);
    /* Evaluates the difference of the last two iterations; next loads, 0: no result. Columns in the motion norm:
       fluid_secants.c in place of these. */
    void (*learn)(spari_accelerator *a);
    int (*next)(spari_accelerator *a, const double *x, const double *g, double *next);
} spari_coupling_scheme;

/* The table: SPAR_COUPLING_* and the name of the row. */
#define SPARI_SCHEMES(ROW)                                                                                             \
    ROW(EXPLICIT, explicit)                                                                                            \
    ROW(FIXED_POINT, fixed_point)                                                                                      \
    ROW(AITKEN, aitken)                                                                                                \
    ROW(IQN_ILS, iqn_ils)
#define SPARI_COUNT_SCHEME(number, name) +1
enum { SPARI_SCHEME_COUNT = 0 SPARI_SCHEMES(SPARI_COUNT_SCHEME) };
const spari_coupling_scheme *spari_coupling_scheme_of(int scheme);

typedef struct spari_accelerator_settings {
    int scheme; /* SPAR_COUPLING_* of an iterating scheme */
    double
        omega; /* relaxation: constant, or of the first iterations and the maximum at the beginning of an Aitken step */
    int columns;   /* IQN-ILS: maximum number of columns in use, >= 1 */
    int reuse;     /* IQN-ILS: number of accepted steps whose columns are reused, >= 0 */
    double filter; /* IQN-ILS: minimum linearly independent part of columns; 0: any */
    int imaged;    /* IQN-ILS: allocate images */
} spari_accelerator_settings;

/* Allocates all memory; NULL: no memory. */
spari_accelerator *spari_accelerator_create(int64_t n, int period, int split,
                                            const spari_accelerator_settings *settings);
void spari_accelerator_free(spari_accelerator **accelerator);
/* [n] weights of motions in the sums of squares of the motion norm, for lengths that are no powers of two; 1 until they
   are set. */
double *spari_accelerator_weights(spari_accelerator *a);

/* Begins a step. */
void spari_accelerator_begin(spari_accelerator *a, double dt);
/* After it: the velocity that comes with a motion of 1, and the acceleration, as fluids see it, that comes with this
   velocity. Without this call those of u = v dt = a dt^2. */
void spari_accelerator_set_rates(spari_accelerator *a, double rate, double acceleration);
typedef struct spari_images {
    const double *now; /* [2 n] of g - x and of g */
    /* Images of other vectors with the same S: x [count][n] in, image [count][n] out, with room for one more. Zero
       vectors cost nothing. The same on all ranks; returns a status. */
    int (*of)(void *context, int64_t count, const double *x, double *image);
    void *context;
    /* for columns */
    const double *moved; /* [n] motion since the iteration before */
    const double *axes;  /* [n / 6][4] of the sections, as quaternions; NULL: those of the loads */
    double (*rotation)(void *context, const double *motion); /* of the section that rotates most, rad */
} spari_images;

/* Next x from x and g; next may be x. x must not be converged: g - x is not zero. images may be NULL. Returns the
   status of images->of. */
int spari_accelerator_next(spari_accelerator *a, const double *x, const double *g, const spari_images *images,
                           double *next);
/* Residual relative to the settled fluid, (T34): r [n] for x and g, which were not passed to `next` yet. Returns 0,
   with r unchanged, if the fluid has no memory. */
int spari_accelerator_settled(const spari_accelerator *a, const double *x, const double *g, double *r);
/* A converged step ends with loads g that were not passed to `next`: the last secant, which later steps use. moved and
   axes of images are needed. */
void spari_accelerator_end(spari_accelerator *a, const double *x, const double *g, const spari_images *images);
/* Accepts the step: its columns may serve in later ones. g: the last result; NULL: unknown. */
void spari_accelerator_accept(spari_accelerator *a, const double *g);
/* Rejects the step: restores the state of its beginning. Its columns are discarded, because they contain the cause
   of the rejection (a failed solution, wild iterates). */
void spari_accelerator_reject(spari_accelerator *a);

/* Between steps: the map has changed. */
void spari_accelerator_forget(spari_accelerator *a);

/* Statistics of the current step. */
int spari_accelerator_columns(const spari_accelerator *a); /* in the last least-squares problem */
int spari_accelerator_dropped(const spari_accelerator *a); /* columns filtered out in this step */
/* The largest -dx.dg / dx.dx of the step: in the piston model the ratio (added mass)/(mass), because the derivative
   of the map is minus this ratio. 0 before the second iteration. */
double spari_accelerator_ratio(const spari_accelerator *a);
/* Whether tangents that are reused between solutions have predicted the motion too badly. */
int spari_accelerator_renews(const spari_accelerator *a);
/* Whether its columns use the norm of the images. */
int spari_accelerator_imaged(const spari_accelerator *accelerator);
/* The fraction of a change of the fluid's loads that recurs in the next evaluation; the rotation that the last
   correction would have given a section, rad, if it was limited; else 0. */
double spari_accelerator_carried_over(const spari_accelerator *a);
double spari_accelerator_limited_rotation(const spari_accelerator *a);
/* Mean and standard deviation of this ratio over the differences of this step and, decaying, of earlier ones,
   weighted by the roots of their lengths. Returns 0, and zeros, if there are too few. */
int spari_accelerator_added_mass(const spari_accelerator *a, double *mean, double *spread);

/* State as doubles, for save and load into an accelerator with the same n and settings. */
int64_t spari_accelerator_state_size(const spari_accelerator *a);
void spari_accelerator_save(const spari_accelerator *a, double *state);
/* Returns whether `count` doubles are a valid state; if not, load another or free the accelerator. */
int spari_accelerator_load(spari_accelerator *a, const double *state, int64_t count);

#endif
