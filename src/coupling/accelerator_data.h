/* Data of an accelerator, shared by accelerator.c (create, step, Aitken), columns.c (difference columns),
   fluid_secants.c (quasi-Newton in the motion norm), iqn_ils.c (in the load norm) and accelerator_state.c (save and
   load). */
#ifndef SPARI_ACCELERATOR_DATA_H
#define SPARI_ACCELERATOR_DATA_H

#include "schemes.h"

#include <math.h>
#include <stdint.h>

/* Kinds of columns. A column serves with others of its kind.
   SPARI_OF_LOADS: p is the change of the residual, in the load norm
   SPARI_OF_MOTION: p is the motion that the structure made
   SPARI_OF_RESPONSE: p is the motion by the tangent, S dx. Where S is not the response over the whole step (substeps),
     or the motion drowns in the rounding of positions. S is then no more than a norm, as in IQN-ILS. */
typedef enum spari_column_kind { SPARI_OF_LOADS, SPARI_OF_MOTION, SPARI_OF_RESPONSE } spari_column_kind;

/* What a fluid may answer in a motion: its acceleration as fluids see it, its change of velocity over dt, its velocity.
   In steps of one length it makes no difference. SPARI_OWN_STEPS: none of them, so secants serve in steps like their
   own only. */
typedef enum spari_quantity {
    SPARI_ACCELERATION,
    SPARI_CHANGE_OF_VELOCITY,
    SPARI_VELOCITY,
    SPARI_QUANTITIES,
    SPARI_OWN_STEPS = SPARI_QUANTITIES
} spari_quantity;

/* Differences of two successive iterations: p by its kind, y of the loads that came back, and b the change of these
   before y. Motions and their loads are in the axes of the sections. */
typedef struct spari_column {
    int64_t step;                     /* in which it was made, by the accelerator's own count */
    double dt, per[SPARI_QUANTITIES]; /* those of its step */
    int kind;                         /* SPARI_OF_* */
    int led;                          /* b is known */
    int slot;                         /* of its vectors */
} spari_column;

/* Weighted ratios of differences: their mean and their spread. */
typedef struct spari_ratios {
    double weight, square, sum, sum2; /* sums of w, w^2, w r, w r^2 */
} spari_ratios;

/* Memory of the fluid between evaluations: rho, and the decaying sums that it is estimated from, (T32). */
typedef struct spari_recollection {
    double rho;
    double reach; /* largest rotation of a section by one correction, rad; 0: the first */
    double off;   /* error of the tangent's prediction of a motion, relative to it; decaying */
    double pairs, ww, wb, bb;
    /* decaying sums of what older secants do not predict: in axes of the sections and in fixed ones; as functions of
       each quantity */
    double surprise[2], surprise_of[SPARI_QUANTITIES + 1];
    int quantity; /* of which the loads are functions: the one that has predicted best (spari_quantity) */
} spari_recollection;

struct spari_accelerator {
    spari_accelerator_settings set;
    const spari_coupling_scheme *scheme;
    int64_t n;
    int period, split;

    int64_t step;
    int iteration;
    int used, stalled, filtered; /* columns of the last least-squares problem; differences without a motion in this
                                    step; columns filtered out of the last problem */
    double dt, per[SPARI_QUANTITIES], ratio; /* per: each quantity of a motion of 1 */
    spari_ratios ratios;                     /* of this step, weighted by the roots of the differences' lengths */
    spari_ratios ratios_before;              /* of accepted steps, each relative to its largest weight, decaying */
    double most_weight;
    double omega, omega_accepted; /* Aitken factor: in use, and at the end of the last accepted step (0: none) */
    int imaged;                   /* the iteration before used the motion norm */
    int drifts;                   /* imaged: the tangent does not predict the motion: SPARI_OF_RESPONSE */
    spari_recollection memory;
    struct {
        int imaged, drifts;
        spari_ratios ratios;
        spari_recollection memory;
    } accepted; /* the same at the end of the last accepted step */

    double size[2], weight[2]; /* of forces and moments */
    double *x, *g;             /* of the iteration before */
    double *change, *response; /* [2][n + 1] changes of g - x and of g since the iteration before; their images */

    int count;            /* columns */
    spari_column *column; /* [2 set.columns] newest first */
    double *p, *y;        /* [2 set.columns][n] by slot */
    double *b;            /* imaged: the same */
    double *axes;         /* imaged: [2 set.columns][n / 6][4] of the sections, by slot */
    int fixed;            /* imaged: the columns are kept in fixed axes */
    double *stretch;      /* imaged: [n] weights of motions in sums of squares */
    double *lead, *last;  /* [n] imaged: the change of g before the next one; g at the end of the step before */
    int led, ended;       /* whether they are known */
    double *base;         /* imaged: [2][n] loads used, and returned, from which the last correction went on */
    double turned;        /* imaged: largest rotation by the last correction, rad */
    double cut, before;   /* imaged: the last correction was limited to this part of it (0: not limited), and the size
                             of its residual in motion */

    double *basis;               /* [columns][n] orthonormal columns, or motions */
    double *loads, *images;      /* imaged: [columns + 2][n] loads of these motions, and their images */
    double *matrix, *alpha;      /* [columns][columns], [columns] */
    int *slots;                  /* [columns] of the columns in use */
    double *combinations, *left; /* imaged: [columns][columns], [columns + 1] */
};

/* ---- vectors: plain sums in a fixed order, for the same bits on ranks with different processors ---- */

static inline double spari_sum_products(const double *a, const double *b, int64_t n) {
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

/* Orthonormalises vector k of q [k + 1][n] against those before it, which are orthonormal, by twofold Gram-Schmidt
   (Giraud et al. 2005: orthogonal to rounding). r [k + 1] := its coefficients in them and in itself. Returns 0, and
   leaves no vector, if at most `filter` of it is linearly independent. */
int spari_orthonormalise(int64_t n, int k, double filter, double *q, double *r);
/* alpha := R^-1 alpha for upper triangular R, by columns of `stride` numbers. Returns whether the result is finite. */
int spari_back_substitute(int k, const double *R, int stride, double *alpha);

/* ---- columns.c ---- */

/* Adds the newest column, of the present kind, and returns its slot. If all columns of the step are in use, the oldest
   of these goes. */
int spari_column_add(spari_accelerator *a);
/* Whether column j serves in this iteration: of the present kind and, in the load norm, of this dt to a tenth. */
int spari_column_serves(const spari_accelerator *a, int j);
/* The factor of the motion of column j for which the quantity that the fluid answers is that of its own step. */
double spari_column_scale(const spari_accelerator *a, int j);
/* The step is accepted: columns of too many steps before go, and the oldest beyond the number allowed. */
void spari_columns_accept(spari_accelerator *a);
/* The step is rejected: its columns go. */
void spari_columns_reject(spari_accelerator *a);

/* ---- iqn_ils.c ---- */

void spari_iqn_ils_learn(spari_accelerator *a);
/* Returns 0 if the result is not finite, or there is no column. */
int spari_iqn_ils_next(spari_accelerator *a, const double *x, const double *g, double *next);

/* ---- fluid_secants.c ---- */

/* Adds the secant of the last two iterations, whose loads used have changed by dx. Returns the status of images->of. */
int spari_fluid_secants_learn(spari_accelerator *a, const double *dx, const spari_images *images);
/* Adds the last secant of a converged step. */
void spari_fluid_secants_end(spari_accelerator *a, const spari_images *images);
/* The step is accepted: keeps the columns in the axes in which they hold better. */
void spari_fluid_secants_accept(spari_accelerator *a);
/* Next loads, from a->x and a->g. Returns the status of images->of. */
int spari_fluid_secants_next(spari_accelerator *a, const spari_images *images, double *next);

/* Fraction of a change of the fluid's loads that recurs in the next; 0: none, or unknown. */
static inline double spari_rho_of(const spari_accelerator *a) {
    return a->imaged ? a->memory.rho : 0;
}

#endif
