/* Data of an accelerator, shared by accelerator.c (create, step, schemes), quasi_newton.c (quasi-Newton) and
   accelerator_state.c (save and load). */
#ifndef SPARI_QUASI_NEWTON_H
#define SPARI_QUASI_NEWTON_H

#include "../algebra/secants.h"
#include "../time/tangent_snapshot.h"
#include "schemes.h"

#include <math.h>
#include <stdint.h>

/* State of a column slot: free, in use, or out of use until the step ends (resting: returns; dropped: freed, or
   returns after reject). */
typedef enum spari_difference_state { SPARI_FREE, SPARI_LIVE, SPARI_RESTING, SPARI_DROPPED } spari_difference_state;

typedef struct spari_difference {
    spari_difference_state state;
    int64_t step;   /* step in which it was made, by the accelerator's own count */
    int64_t serial; /* increasing with age of creation: the largest is the newest */
    double dt;
    int led; /* imaged: the change of g before it is known */
} spari_difference;

/* Weighted ratios of differences: their mean and their spread. */
typedef struct spari_ratios {
    double weight, square, sum, sum2; /* sums of w, w^2, w r, w r^2 */
} spari_ratios;

/* Deviation of the fluid's results from a function of the loads. */
typedef struct spari_recollection {
    double contradiction; /* of its results, relative to their change */
    double rho;           /* fraction of a change that recurs in the next result; 0: none, or unknown */
    double scatter;       /* contradiction that rho does not explain */
    spari_asymmetry told; /* of the columns; older ones decay */
} spari_recollection;

struct spari_accelerator {
    spari_accelerator_settings set;
    const spari_coupling_scheme *scheme;
    int64_t n;
    int period, split;

    int64_t step, serial;
    int iteration, dropped;
    double dt, ratio;
    spari_ratios ratios;        /* of this step, weighted by the roots of the differences' lengths */
    spari_ratios ratios_before; /* of accepted steps, each relative to its largest weight, decaying */
    double most_weight;
    double omega, omega_accepted; /* Aitken factor: in use, and at the end of the last accepted step (0: none) */

    double size[2], weight[2]; /* of forces and moments */
    double *x, *g;             /* of the iteration before */
    double *image;             /* [2 n] imaged: images of its g - x and g */
    int imaged;                /* in this step: inner products use the images */
    double *change, *response; /* [2][n + 1] changes of g - x and of g since the iteration before; their images */
    int renewed;               /* images of columns were recomputed for this step */
    spari_snapshot before;     /* images before that */
    struct {
        int imaged;
        spari_ratios ratios;
    } begun; /* `imaged` and `ratios_before` at the beginning of the step */
    spari_recollection memory, memory_accepted;
    double *lead;   /* [2][n] imaged: the change of g before the next one; its image */
    double *last;   /* [n] imaged: g at the end of the step before */
    int led, ended; /* whether there is a lead, and a last */
    double residual, residual_first,
        residual_least; /* in the norm of the images: current, first and smallest of the step */
    int rises;          /* iterations since it was far above the smallest */
    double reach;       /* maximum step in units of the residual */
    double cut,
        cut_residual; /* the last step was limited to this fraction of its length (0: not limited), at this residual */

    int slots;                /* twice the columns: resting and dropped ones return after reject */
    spari_difference *column; /* [slots] */
    double *v, *w;            /* [slots][n] differences of the residual g - x, and of g */
    double *iv, *iw;          /* imaged: their images */
    double *b, *ib;           /* imaged: the preceding change of g, and its image */
    double *q, *r;            /* [columns][n] and [columns][columns], r by columns: weighted v = q r */
    double *p;                /* imaged: images of q */
    spari_secants *secants;   /* imaged */
    double *alpha;            /* [columns] */
    int *order;               /* slot of each column of q */
    int used;                 /* columns of q */
};

/* Restores the images of the beginning of the step. */
void spari_differences_restore(spari_accelerator *a);

/* ---- vectors: plain sums in a fixed order, for the same bits on ranks with different processors ---- */

static inline double spari_dot(const double *a, const double *b, int64_t n) {
    double s[4] = {0, 0, 0, 0};
    int64_t i = 0;
    for (; i + 4 <= n; i += 4) {
        for (int k = 0; k < 4; k++) {
            s[k] += a[i + k] * b[i + k];
        }
    }
    for (; i < n; i++) {
        s[0] += a[i] * b[i];
    }
    return (s[0] + s[1]) + (s[2] + s[3]);
}

static inline void spari_axpy(double f, const double *a, double *b, int64_t n) {
    for (int64_t i = 0; i < n; i++) {
        b[i] += f * a[i];
    }
}

static inline double *spari_slot_v(const spari_accelerator *a, int slot) {
    return a->v + slot * a->n;
}

static inline double *spari_slot_w(const spari_accelerator *a, int slot) {
    return a->w + slot * a->n;
}

static inline double *spari_slot_iv(const spari_accelerator *a, int slot) {
    return a->iv + slot * a->n;
}

static inline double *spari_slot_iw(const spari_accelerator *a, int slot) {
    return a->iw + slot * a->n;
}

static inline double *spari_slot_b(const spari_accelerator *a, int slot) {
    return a->b + slot * a->n;
}

static inline double *spari_slot_ib(const spari_accelerator *a, int slot) {
    return a->ib + slot * a->n;
}

/* sqrt(a . image), 0 if rounding makes it negative. */
static inline double spari_size_in(const double *a, const double *image, int64_t n) {
    return sqrt(fmax(spari_dot(a, image, n), 0));
}

/* ---- quasi_newton.c ---- */

/* Factors anew, newest columns first, so that the filter and the limit on their number remove old ones. */
void spari_differences_factor(spari_accelerator *a);
/* Adds the column in a slot to the factorisation. Returns 0 and adds nothing if at most `filter` of it is linearly
   independent. */
int spari_differences_append(spari_accelerator *a, int slot, double filter);
/* Takes a column out of use: one of this step for good, an older one until the step is accepted or rejected. */
void spari_differences_drop(spari_accelerator *a, int slot);
/* Converts the columns of earlier steps to the norm of this one; recomputes their images if the structure has
   rotated or stiffened enough to matter. Returns the status of images->of. */
int spari_differences_renew(spari_accelerator *a, const double *x, const double *g, const spari_images *images);
/* Adds the column of the last two iterations. */
void spari_differences_learn(spari_accelerator *a);
/* Next loads from the columns of this and earlier steps, averaged if they contradict each other. 0: not finite. */
int spari_differences_next(spari_accelerator *a, const double *x, const double *g, double *next);
/* Accepts the step: frees dropped columns, restores resting ones, and limits their number. */
void spari_differences_accept(spari_accelerator *a);
/* r := the residual plus the recurring part of the last change, (T31); returns its length. */
double spari_differences_residual(const spari_accelerator *a, const double *x, const double *g, const double *image,
                                  double *r);

/* Limits of spari_recollection. The scheme acts on a contradiction of the fluid's responses above the first. It
   averages difference columns whose scatter is above the second. */
static const double SPARI_CONTRADICTION_SEEN = 1e-3, SPARI_SCATTER_AVERAGED = 0.05;

/* Fraction of a change of the fluid's result that recurs in the next; 0: none, or unknown. */
static inline double spari_rho_of(const spari_accelerator *a) {
    return a->imaged ? a->memory.rho : 0;
}

#endif
