/* What an accelerator is made of, for the three files that share it: accelerator.c (its life, the step, the schemes),
   quasi_newton.c (quasi-Newton) and accelerator_state.c (save and load). */
#ifndef SPARI_COLUMNS_H
#define SPARI_COLUMNS_H

#include "../algebra/secants.h"
#include "../time/tangent_snapshot.h"
#include "schemes.h"

#include <math.h>
#include <stdint.h>

/* What a column is: memory for one, in use, or out of use until the step ends (and then gone, or back after reject). */
typedef enum spari_column_state { SPARI_FREE, SPARI_LIVE, SPARI_RESTING, SPARI_DROPPED } spari_column_state;

typedef struct spari_column {
    spari_column_state state;
    int64_t step;   /* of the accelerator's own count: in which it was made */
    int64_t serial; /* the larger the newer */
    double dt;
    int led; /* imaged: the change of g before it is known */
} spari_column;

/* Ratios of differences, by weight: what they come to, and how far they agree. */
typedef struct spari_ratios {
    double weight, square, sum, sum2; /* sums of w, w^2, w r, w r^2 */
} spari_ratios;

/* How far the fluid's answers are a function of the loads. */
typedef struct spari_recollection {
    double contradiction; /* of its answers, relative to their change */
    double rho;           /* the part of a change that comes again with the next answer; 0: none, or not known */
    double scatter;       /* the contradiction that rho leaves */
    spari_asymmetry told; /* of the columns, older ones fading */
} spari_recollection;

struct spari_accelerator {
    spari_accelerator_settings set;
    const spari_coupling_scheme *scheme;
    int64_t n;
    int period, split;

    int64_t step, serial;
    int iteration, dropped;
    double dt, ratio;
    spari_ratios ratios;        /* of this step, weighed by the roots of the differences' lengths */
    spari_ratios ratios_before; /* of those accepted, each over its largest weight, and fading */
    double most_weight;
    double omega, omega_accepted; /* of Aitken: in use, and at the end of the last accepted step (0: none) */

    double size[2], weight[2]; /* of forces and moments */
    double *x, *g;             /* of the iteration before */
    double *image;             /* [2 n] imaged: of its g - x and g */
    int imaged;                /* in the step: inner products are those of the images */
    double *change, *answer;   /* [2][n + 1] of g - x and of g since the iteration before; their images */
    int renewed;               /* images of columns, for the step under way */
    spari_snapshot before;     /* as they were before that */
    struct {
        int imaged;
        spari_ratios ratios;
    } begun; /* `imaged` and `ratios_before` as the step began */
    spari_recollection memory, memory_accepted;
    double *lead;                                    /* [2][n] imaged: the change of g that the next follows; image */
    double *last;                                    /* [n] imaged: g at the end of the step before */
    int led, ended;                                  /* whether there is a lead, and a last */
    double residual, residual_first, residual_least; /* in the norm of the images: now, and of the step */
    int rises;                                       /* iterations since it was far above the least */
    double reach;                                    /* a step is no longer than so many residuals */
    double cut, cut_residual; /* the last step was cut to so much of its length (0: it was not), from that residual */

    int slots;              /* twice the columns: those at rest or dropped come back when the step is rejected */
    spari_column *column;   /* [slots] */
    double *v, *w;          /* [slots][n] differences of the residual g - x, and of g */
    double *iv, *iw;        /* imaged: their images */
    double *b, *ib;         /* imaged: the change of g before, and its image */
    double *q, *r;          /* [columns][n] and [columns][columns], r by columns: weighted v = q r */
    double *p;              /* imaged: images of q */
    spari_secants *secants; /* imaged */
    double *alpha;          /* [columns] */
    int *order;             /* slot of each column of q */
    int used;               /* columns of q */
};

/* The images are again as the step began. */
void spari_columns_restore(spari_accelerator *a);

/* ---- vectors: plain sums in a fixed order, so that all ranks get the same bits whatever their processors ---- */

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

/* The root of a . image, 0 where rounding makes that negative. */
static inline double spari_size_in(const double *a, const double *image, int64_t n) {
    return sqrt(fmax(spari_dot(a, image, n), 0));
}

/* ---- quasi_newton.c ---- */

/* Factors anew, the newest columns first, so that the filter and the limit on their number take out old ones. */
void spari_columns_factor(spari_accelerator *a);
/* Adds the column in a slot to the factorisation. Returns 0, and adds nothing, where no more than `filter` of it is
   new. */
int spari_columns_append(spari_accelerator *a, int slot, double filter);
/* Out of use: a column of this step for good, an older one until it is known whether the step is accepted. */
void spari_columns_drop(spari_accelerator *a, int slot);
/* The columns of earlier steps in the norm of this one, anew where the structure has turned, or stiffened, so far that
   it tells. A status: that of images->of. */
int spari_columns_renew(spari_accelerator *a, const double *x, const double *g, const spari_images *images);
/* The column of the last two iterations. */
void spari_columns_learn(spari_accelerator *a);
/* By the columns of this step and of earlier ones, which are averaged where they contradict each other. 0: no loads. */
int spari_columns_next(spari_accelerator *a, const double *x, const double *g, double *next);
/* The step is accepted: what was dropped goes, what rested comes back, no more stay than there may be. */
void spari_columns_accept(spari_accelerator *a);
/* r := the residual with what comes again of the last change, (T31); returns its length. */
double spari_columns_residual(const spari_accelerator *a, const double *x, const double *g, const double *image,
                              double *r);

/* Limits of spari_recollection. The scheme acts on a contradiction of the fluid's responses above the first. It
   averages difference columns whose scatter is above the second. */
static const double SPARI_CONTRADICTION_SEEN = 1e-3, SPARI_SCATTER_AVERAGED = 0.05;

/* How much of a change of the fluid's answer comes again with the next; 0: none, or not known. */
static inline double spari_rho_of(const spari_accelerator *a) {
    return a->imaged ? a->memory.rho : 0;
}

#endif
