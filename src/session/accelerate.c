/* Acceleration of the coupling's iteration: relaxation, Aitken's, and quasi-Newton from columns of earlier
   iterations. */
#include "accelerate.h"

#include "../base/status.h"
#include "secants.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What a column is: memory for one, in use, or out of use until the step ends (and then gone, or back after reject). */
typedef enum column_state { FREE, LIVE, RESTING, DROPPED } column_state;

typedef struct column {
    column_state state;
    int64_t step;   /* of the accelerator's own count: in which it was made */
    int64_t serial; /* the larger the newer */
    double dt;
    int led; /* imaged: the change of g before it is known */
} column;

/* Ratios of differences, by weight: what they come to, and how far they agree. */
typedef struct tally {
    double weight, square, sum, sum2; /* sums of w, w^2, w r, w r^2 */
} tally;

/* How far the fluid's answers are a function of the loads. */
typedef struct memory {
    double contradiction; /* of its answers, relative to their change */
    double rho;           /* the part of a change that comes again with the next answer; 0: none, or not known */
    double scatter;       /* the contradiction that rho leaves */
    spari_asymmetry told; /* of the columns, older ones fading */
} memory;

struct spari_accelerator {
    spari_accelerator_settings set;
    const spari_coupling_scheme *scheme;
    int64_t n;
    int period, split;

    int64_t step, serial;
    int iteration, dropped;
    double dt, ratio;
    tally ratios, ratios_before; /* of this step, weighed by the roots of the differences' lengths; of those accepted,
                                    each over its largest weight, and fading */
    double most_weight;
    double omega, omega_accepted; /* of Aitken: in use, and at the end of the last accepted step (0: none) */

    double size[2], weight[2]; /* of forces and moments */
    double *x, *g;             /* of the iteration before */
    double *image;             /* [2 n] imaged: of its g - x and g */
    int imaged;                /* in the step: inner products are those of the images */
    double *change, *answer;   /* [2][n + 1] of g - x and of g since the iteration before; their images */
    int renewed;               /* images of columns, for the step under way or one that was rejected since */
    memory memory, memory_accepted;
    double *lead;                                    /* [2][n] imaged: the change of g that the next follows; image */
    double *last;                                    /* [n] imaged: g at the end of the step before */
    int led, ended;                                  /* whether there is a lead, and a last */
    double residual, residual_first, residual_least; /* in the norm of the images: now, and of the step */
    int rises;                                       /* iterations since it was far above the least */

    int slots;              /* twice the columns: those at rest or dropped come back when the step is rejected */
    column *column;         /* [slots] */
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

/* ---- memory ---- */

spari_accelerator *spari_accelerator_create(int64_t n, int period, int split,
                                            const spari_accelerator_settings *settings) {
    spari_accelerator *a = spari_zalloc(1, sizeof *a);
    if (!a) {
        return NULL;
    }
    a->set = *settings;
    a->scheme = spari_coupling_scheme_of(settings->scheme);
    a->n = n;
    a->period = period;
    a->split = split;
    a->omega = settings->omega;
    int64_t m = a->scheme->columns ? settings->columns : 0;
    a->slots = (int)(2 * m);
    int64_t k = settings->imaged ? m : 0;
    int ok = (a->x = spari_zalloc(n, sizeof *a->x)) && (a->g = spari_zalloc(n, sizeof *a->g)) &&
             (a->column = spari_zalloc(2 * m, sizeof *a->column)) && (a->v = spari_zalloc(2 * m * n, sizeof *a->v)) &&
             (a->w = spari_zalloc(2 * m * n, sizeof *a->w)) && (a->q = spari_zalloc(m * n, sizeof *a->q)) &&
             (a->r = spari_zalloc(m * m, sizeof *a->r)) && (a->alpha = spari_zalloc(m, sizeof *a->alpha)) &&
             (a->order = spari_zalloc(m, sizeof *a->order)) && (a->image = spari_zalloc(2 * n, sizeof *a->image)) &&
             (a->change = spari_zalloc(2 * n, sizeof *a->change)) &&
             (a->answer = spari_zalloc(2 * n + 1, sizeof *a->answer)) &&
             (a->iv = spari_zalloc(2 * k * n + 1, sizeof *a->iv)) &&
             (a->iw = spari_zalloc(2 * k * n + 1, sizeof *a->iw)) && (a->b = spari_zalloc(2 * k * n, sizeof *a->b)) &&
             (a->ib = spari_zalloc(2 * k * n + 1, sizeof *a->ib)) &&
             (a->lead = spari_zalloc(k > 0 ? 2 * n + 1 : 0, sizeof *a->lead)) &&
             (a->last = spari_zalloc(k > 0 ? n : 0, sizeof *a->last)) && (a->p = spari_zalloc(k * n, sizeof *a->p)) &&
             (k == 0 || (a->secants = spari_secants_create(n, (int)k)));
    if (!ok) {
        spari_accelerator_free(&a);
    }
    return a;
}

void spari_accelerator_free(spari_accelerator **accelerator) {
    spari_accelerator *a = accelerator ? *accelerator : NULL;
    if (!a) {
        return;
    }
    double *all[] = {a->x, a->g,  a->image, a->change, a->answer, a->v, a->w, a->iv,   a->iw,
                     a->b, a->ib, a->lead,  a->last,   a->q,      a->r, a->p, a->alpha};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        free(all[i]);
    }
    free(a->column);
    free(a->order);
    spari_secants_free(a->secants);
    free(a);
    *accelerator = NULL;
}

/* ---- vectors: plain sums in a fixed order, so that all ranks get the same bits whatever their processors ---- */

static double dot(const double *a, const double *b, int64_t n) {
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

static void axpy(double f, const double *a, double *b, int64_t n) {
    for (int64_t i = 0; i < n; i++) {
        b[i] += f * a[i];
    }
}

static double *slot_v(const spari_accelerator *a, int slot) {
    return a->v + slot * a->n;
}

static double *slot_w(const spari_accelerator *a, int slot) {
    return a->w + slot * a->n;
}

static double *slot_iv(const spari_accelerator *a, int slot) {
    return a->iv + slot * a->n;
}

static double *slot_iw(const spari_accelerator *a, int slot) {
    return a->iw + slot * a->n;
}

static double *slot_b(const spari_accelerator *a, int slot) {
    return a->b + slot * a->n;
}

static double *slot_ib(const spari_accelerator *a, int slot) {
    return a->ib + slot * a->n;
}

/* The root of a . image, 0 where rounding makes that negative. */
static double size_in(const double *a, const double *image, int64_t n) {
    return sqrt(fmax(dot(a, image, n), 0));
}

/* ---- weights ---- */

/* Sizes of forces and moments, as the root of the sum of squares of loads used and loads that came back. */
static void measure_kinds(const spari_accelerator *a, const double *x, const double *g, double size[2]) {
    double s[2] = {0, 0};
    for (int64_t i = 0; i < a->n; i += a->period) {
        for (int k = 0; k < a->period && i + k < a->n; k++) {
            s[k >= a->split] += x[i + k] * x[i + k] + g[i + k] * g[i + k];
        }
    }
    /* what is less than that of the other kind is not worth more: it may be the rounding of what should be zero */
    double large = 1e-8 * sqrt(fmax(s[0], s[1]));
    for (int k = 0; k < 2; k++) {
        size[k] = fmax(sqrt(s[k]), large);
        size[k] = size[k] > 0 ? size[k] : 1;
    }
}

/* The step's first loads give the weights; loads that outgrow them tenfold give new ones. Returns whether they changed.
 */
static int weigh(spari_accelerator *a, const double *x, const double *g) {
    double size[2];
    measure_kinds(a, x, g, size);
    if (a->iteration > 1 && size[0] <= 10 * a->size[0] && size[1] <= 10 * a->size[1]) {
        return 0;
    }
    for (int k = 0; k < 2; k++) {
        a->size[k] = size[k];
        a->weight[k] = 1 / size[k];
    }
    return 1;
}

/* out = in, each entry over the size of its kind */
static void over_sizes(const spari_accelerator *a, const double *in, double *out) {
    for (int64_t i = 0; i < a->n; i += a->period) {
        for (int k = 0; k < a->period && i + k < a->n; k++) {
            out[i + k] = a->weight[k >= a->split] * in[i + k];
        }
    }
}

/* ---- memory of the fluid ---- */

/* Contradiction above QUIET is looked at; above LOUD columns that it is left in are averaged. */
static const double QUIET = 1e-3, LOUD = 0.05;

int spari_accelerator_contradicted(const spari_accelerator *a) {
    return a->imaged && a->slots > 0 && a->memory.contradiction > QUIET;
}

static double rho_of(const spari_accelerator *a) {
    return a->imaged ? a->memory.rho : 0;
}

/* change, image := what the fluid answers by itself of the one in slot s, as if it did not remember, from v or w and
   its image */
static void forget_lead(const spari_accelerator *a, int s, double *change, double *image) {
    double rho = rho_of(a);
    if (rho > 0) {
        axpy(-rho, slot_b(a, s), change, a->n);
        axpy(-rho, slot_ib(a, s), image, a->n);
    }
}

/* r := the residual with what comes again of the last change, (T31); returns its length. */
static double residual_to_come(const spari_accelerator *a, const double *x, const double *g, const double *image,
                               double *r) {
    double square = 0, rho = a->led ? rho_of(a) : 0;
    for (int64_t i = 0; i < a->n; i++) {
        r[i] = g[i] - x[i];
        double answer = image[i];
        if (rho > 0) {
            r[i] += rho * a->lead[i];
            answer += rho * a->lead[a->n + i];
        }
        square += r[i] * answer;
    }
    return sqrt(fmax(square, 0));
}

int spari_accelerator_settle(const spari_accelerator *a, const double *x, const double *g, double *r) {
    double rho = rho_of(a);
    const double *before = a->iteration > 0 ? a->g : a->ended ? a->last : NULL;
    for (int64_t i = 0; rho > 0 && before && i < a->n; i++) {
        r[i] = g[i] - x[i] + rho / (1 - rho) * (g[i] - before[i]);
    }
    return rho > 0 && before;
}

/* ---- columns ---- */

/* Of no use in the factorisation as long as the fluid remembers. */
static int is_unled(const spari_accelerator *a, int slot) {
    return rho_of(a) > 0 && !a->column[slot].led;
}

/* Adds a column to the factorisation, by Gram-Schmidt done twice (Giraud et al. 2005: orthogonal to rounding). Returns
   0, and adds nothing, where too little of it is new: no more than `filter`. */
static int append(spari_accelerator *a, int slot, double filter) {
    int k = a->used;
    if (k == a->set.columns || is_unled(a, slot)) {
        return 0;
    }
    double *q = a->q + k * a->n, *r = a->r + (int64_t)k * a->set.columns, *images = a->imaged ? a->p : a->q;
    double *p = images + k * a->n;
    if (a->imaged) {
        memcpy(q, slot_v(a, slot), (size_t)a->n * sizeof *q);
        memcpy(p, slot_iv(a, slot), (size_t)a->n * sizeof *p);
        forget_lead(a, slot, q, p);
    } else {
        over_sizes(a, slot_v(a, slot), q);
    }
    double whole = size_in(q, p, a->n);
    for (int j = 0; j < k; j++) {
        r[j] = 0;
    }
    for (int pass = 0; pass < 2; pass++) {
        for (int j = 0; j < k; j++) {
            double c = dot(images + j * a->n, q, a->n);
            r[j] += c;
            axpy(-c, a->q + j * a->n, q, a->n);
            if (a->imaged) {
                axpy(-c, a->p + j * a->n, p, a->n);
            }
        }
    }
    r[k] = size_in(q, p, a->n);
    if (!(r[k] > filter * whole) || !isfinite(r[k])) {
        return 0;
    }
    for (int64_t i = 0; i < a->n; i++) {
        q[i] /= r[k];
        p[i] = a->imaged ? p[i] / r[k] : q[i];
    }
    a->order[k] = slot;
    a->used++;
    return 1;
}

/* Of what is new in a column less than the fluid's scatter is that. */
static double least_new(const spari_accelerator *a) {
    return a->imaged ? fmax(a->set.filter, a->memory.scatter) : a->set.filter;
}

static int newest_before(const spari_accelerator *a, int64_t serial) {
    int found = -1;
    for (int s = 0; s < a->slots; s++) {
        if (a->column[s].state == LIVE && a->column[s].serial < serial &&
            (found < 0 || a->column[s].serial > a->column[found].serial)) {
            found = s;
        }
    }
    return found;
}

/* Out of use: a column of this step for good, an older one until it is known whether the step is accepted. */
static void drop_column(spari_accelerator *a, int slot) {
    a->column[slot].state = a->column[slot].step == a->step ? FREE : DROPPED;
}

/* Factors anew, the newest columns first, so that the filter and the limit on their number take out old ones. */
static void factor_columns(spari_accelerator *a) {
    int64_t serial = a->serial + 1;
    a->used = 0;
    for (int s = newest_before(a, serial); s >= 0; s = newest_before(a, serial)) {
        serial = a->column[s].serial;
        int full = a->used == a->set.columns;
        if (!append(a, s, least_new(a))) {
            a->dropped += !full;
            /* those taken out below QUIET have nothing to say; above, they are averaged with */
            if (a->memory.scatter <= QUIET && !is_unled(a, s)) {
                drop_column(a, s);
            }
        }
    }
}

static int free_slot(const spari_accelerator *a) {
    for (int s = 0; s < a->slots; s++) {
        if (a->column[s].state == FREE) {
            return s;
        }
    }
    return -1; /* does not happen: at most `columns` are of this step, at most `columns` are older */
}

/* The columns of this step, at most all but one: the oldest goes. */
static void limit_columns(spari_accelerator *a) {
    int count = 0, oldest = -1;
    for (int s = 0; s < a->slots; s++) {
        const column *c = a->column + s;
        if (c->state == LIVE && c->step == a->step) {
            count++;
            oldest = oldest < 0 || c->serial < a->column[oldest].serial ? s : oldest;
        }
    }
    if (count == a->set.columns) {
        drop_column(a, oldest);
        factor_columns(a);
    }
}

static spari_secant secant_of(const spari_accelerator *a, int slot) {
    int led = a->column[slot].led;
    return (spari_secant){slot_v(a, slot),  slot_w(a, slot),  led ? slot_b(a, slot) : NULL,
                          slot_iv(a, slot), slot_iw(a, slot), led ? slot_ib(a, slot) : NULL};
}

/* The columns in use that are older than `serial`, the newest first; of this step alone, or of all. */
static void gather_secants(spari_accelerator *a, double filter, int64_t serial, int of_step) {
    spari_secants_begin(a->secants, filter);
    for (int s = newest_before(a, serial); s >= 0; s = newest_before(a, serial)) {
        const spari_secant c = secant_of(a, s);
        serial = a->column[s].serial;
        if ((of_step && a->column[s].step != a->step) || !spari_secants_add(a->secants, &c)) {
            break;
        }
    }
}

/* What is new in a column, so that its direction counts as one. */
static const double INDEPENDENT = 1e-2;

/* How far the newest column is from what the others of the step make of it, as of a fluid that remembers rho: negative
   where they cannot tell. */
static double defect_of(spari_accelerator *a, int newest, double rho) {
    const spari_secant c = secant_of(a, newest);
    gather_secants(a, INDEPENDENT, a->column[newest].serial, 1);
    spari_secants_remember(a->secants, rho);
    (void)spari_secants_fit(a->secants, 0);
    return spari_secants_defect(a->secants, &c);
}

/* A column that fits forgets a part of what was seen before. */
static double faded(double seen, double defect) {
    static const double MEMORY = 0.8;
    return defect >= 0 ? fmax(fmin(defect, 1), MEMORY * seen) : seen;
}

/* (T31). Returns what rho leaves of the asymmetry, over what is symmetric. Where too few pairs tell, rho stays. */
static double recall(spari_accelerator *a) {
    static const double FADE = 0.95, EXPLAINED = 0.5, MOST_OF_IT = 0.95;
    enum { PAIRS = 3 };
    spari_asymmetry *told = &a->memory.told;
    int fresh = told->pairs > 0 ? 1 : a->slots;
    *told = (spari_asymmetry){told->pairs, FADE * told->ww, FADE * told->both, FADE * told->bb, FADE * told->symmetric};
    gather_secants(a, INDEPENDENT, a->serial + 1, 0);
    spari_secants_tell(a->secants, fresh, told);
    if (told->pairs >= PAIRS) {
        int explained = told->both > 0 && told->both * told->both > EXPLAINED * told->ww * told->bb;
        a->memory.rho = explained ? fmin(told->both / told->bb, MOST_OF_IT) : 0;
    }
    double rho = a->memory.rho, left = told->ww - rho * (2 * told->both - rho * told->bb);
    return sqrt(fmax(left, 0) / told->symmetric);
}

/* What the newest column shows: how far it contradicts the others of the step, whether memory explains that, and what
   is left then. */
static void weigh_answers(spari_accelerator *a, int newest) {
    memory *m = &a->memory;
    double defect = defect_of(a, newest, 0), was = m->rho, left = 1;
    m->contradiction = faded(m->contradiction, defect);
    if (m->contradiction > QUIET) {
        left = recall(a);
    } else {
        m->rho = 0;
        m->told = (spari_asymmetry){0};
    }
    if (m->rho > 0) {
        defect = defect_of(a, newest, m->rho);
        m->scatter = was > 0 ? fmin(faded(m->scatter, defect), left) : faded(0, defect);
    } else {
        m->scatter = faded(m->scatter, defect);
    }
}

/* The column of the last two iterations. */
static void add_column(spari_accelerator *a) {
    limit_columns(a);
    int s = free_slot(a), moved = 0;
    size_t bytes = (size_t)a->n * sizeof *a->change;
    memcpy(slot_v(a, s), a->change, bytes);
    memcpy(slot_w(a, s), a->change + a->n, bytes);
    if (a->imaged) {
        memcpy(slot_iv(a, s), a->answer, bytes);
        memcpy(slot_iw(a, s), a->answer + a->n, bytes);
    }
    for (int64_t i = 0; i < a->n; i++) {
        moved |= a->change[i] != 0;
    }
    if (!moved) { /* the residual stalls: the column says nothing */
        a->dropped++;
        return;
    }
    a->column[s] = (column){LIVE, a->step, ++a->serial, a->dt, a->imaged && a->led};
    if (a->column[s].led) {
        memcpy(slot_b(a, s), a->lead, bytes);
        memcpy(slot_ib(a, s), a->lead + a->n, bytes);
    }
    double rho = a->memory.rho;
    if (a->imaged) {
        weigh_answers(a, s);
    }
    if (a->memory.rho != rho || !append(a, s, least_new(a))) {
        factor_columns(a);
    }
}

/* (I - J)^-1 of an added mass lengthens nothing in the norm of the images: the solution is no farther from the loads
   that the step began with than the first residual is long. A step much longer than that, or than the residual, comes
   of columns that are wrong. */
static double longest(const spari_accelerator *a) {
    static const double LONG = 10;
    return LONG * fmin(a->residual, a->residual_first);
}

/* Cuts a step made with alpha to that. */
static void trust(const spari_accelerator *a, const double *x, double *next) {
    double step = 0, most = longest(a), rho = rho_of(a);
    for (int64_t i = 0; i < a->n; i++) {
        double answer = a->image[i] + (rho > 0 && a->led ? rho * a->lead[a->n + i] : 0);
        for (int j = 0; j < a->used; j++) {
            int slot = a->order[j];
            answer += a->alpha[j] * (slot_iw(a, slot)[i] - (rho > 0 ? rho * slot_ib(a, slot)[i] : 0));
        }
        step += (next[i] - x[i]) * answer;
    }
    if (step > most * most) {
        double cut = most / sqrt(step);
        for (int64_t i = 0; i < a->n; i++) {
            next[i] = x[i] + cut * (next[i] - x[i]);
        }
    }
}

/* alpha := R^-1 alpha */
static void back_substitute(spari_accelerator *a) {
    for (int j = a->used - 1; j >= 0; j--) {
        const double *r = a->r + (int64_t)j * a->set.columns;
        a->alpha[j] /= r[j];
        for (int i = 0; i < j; i++) {
            a->alpha[i] -= r[i] * a->alpha[j];
        }
    }
}

/* The same in the norm of the images, as x + (W - V) alpha + what the columns leave of the residual: a residual many
   times larger than the loads leaves no rounding. */
static int quasi_newton_imaged(spari_accelerator *a, const double *x, const double *g, double *next) {
    int64_t n = a->n;
    int m = a->used;
    (void)residual_to_come(a, x, g, a->image, next);
    memset(a->alpha, 0, (size_t)m * sizeof *a->alpha);
    for (int pass = 0; pass < 2; pass++) {
        for (int j = 0; j < m; j++) {
            double part = dot(a->p + j * n, next, n);
            a->alpha[j] -= part;
            axpy(-part, a->q + j * n, next, n);
        }
    }
    back_substitute(a);
    if (spari_first_nonfinite(a->alpha, m) >= 0) {
        return 0;
    }
    for (int j = 0; j < m; j++) {
        const double *v = slot_v(a, a->order[j]), *w = slot_w(a, a->order[j]);
        for (int64_t i = 0; i < n; i++) {
            next[i] += a->alpha[j] * (w[i] - v[i]);
        }
    }
    for (int64_t i = 0; i < n; i++) {
        next[i] += x[i];
    }
    trust(a, x, next);
    return 1;
}

/* next = g + W alpha, alpha the least squares of V alpha = -(g - x): the loads whose residual is as small as the
   columns know how. `next` may be x. Returns 0 where that gives no numbers. */
static int quasi_newton(spari_accelerator *a, const double *x, const double *g, double *next) {
    int m = a->used;
    if (a->imaged) {
        return quasi_newton_imaged(a, x, g, next);
    }
    for (int j = 0; j < m; j++) {
        const double *q = a->q + j * a->n;
        double s[2] = {0, 0};
        for (int64_t i = 0; i < a->n; i += a->period) {
            for (int k = 0; k < a->period && i + k < a->n; k++) {
                s[k >= a->split] += q[i + k] * (g[i + k] - x[i + k]);
            }
        }
        a->alpha[j] = -(s[0] * a->weight[0] + s[1] * a->weight[1]);
    }
    back_substitute(a);
    if (spari_first_nonfinite(a->alpha, m) >= 0) {
        return 0;
    }
    memcpy(next, g, (size_t)a->n * sizeof *next);
    for (int j = 0; j < m; j++) {
        axpy(a->alpha[j], slot_w(a, a->order[j]), next, a->n);
    }
    return 1;
}

/* next by the derivative that fits all columns. Returns 0 where that gives no numbers. */
static int step_by_average(spari_accelerator *a, const double *x, const double *g, double *next) {
    static const double PART = 0.5, FILTER = 0.3;
    double *r = a->change;
    gather_secants(a, fmin(fmax(a->set.filter, PART * a->memory.scatter), FILTER), a->serial + 1, 0);
    spari_secants_remember(a->secants, a->memory.rho);
    double length = residual_to_come(a, x, g, a->image, r);
    return spari_secants_fit(a->secants, a->memory.scatter * a->memory.scatter) > 0 &&
           spari_secants_step(a->secants, x, r, length, longest(a), next);
}

/* By the columns of this step and of earlier ones, which are averaged where they contradict each other. */
static int next_by_columns(spari_accelerator *a, const double *x, const double *g, double *next) {
    return (a->imaged && a->memory.scatter > LOUD && step_by_average(a, x, g, next)) ||
           (a->used > 0 && quasi_newton(a, x, g, next));
}

/* ---- Aitken ---- */

/* Kuettler & Wall (2008): a step begins with the last factor, as far as the user's allows. */
static void aitken_begin(spari_accelerator *a) {
    a->omega = a->omega_accepted > 0 ? fmin(a->omega_accepted, a->set.omega) : a->set.omega;
}

/* omega <- -omega r'.(r - r') / |r - r'|^2, r' the residual before; where the residual stalls omega stays. */
static void aitken_learn(spari_accelerator *a) {
    double product[2] = {0, 0}, square[2] = {0, 0};
    for (int64_t i = 0; i < a->n; i += a->period) {
        for (int k = 0; k < a->period && i + k < a->n; k++) {
            int kind = k >= a->split;
            double before = a->g[i + k] - a->x[i + k], change = a->change[i + k];
            double answer = a->imaged ? a->answer[i + k] : change;
            product[kind] += before * answer;
            square[kind] += change * answer;
        }
    }
    double w[2] = {a->weight[0] * a->weight[0], a->weight[1] * a->weight[1]};
    if (a->imaged) {
        w[0] = w[1] = 1;
    }
    double omega = -a->omega * (product[0] * w[0] + product[1] * w[1]) / (square[0] * w[0] + square[1] * w[1]);
    if (isfinite(omega) && omega != 0) {
        a->omega = omega;
    }
}

/* ---- the schemes ---- */

static const spari_coupling_scheme
    scheme_explicit = {.name = "explicit"},
    scheme_fixed_point = {.name = "fixed point", .iterates = 1},
    scheme_aitken = {.name = "Aitken", .iterates = 1, .begin = aitken_begin, .learn = aitken_learn},
    scheme_iqn_ils = {.name = "IQN-ILS", .iterates = 1, .columns = 1, .learn = add_column, .next = next_by_columns};

const spari_coupling_scheme *spari_coupling_scheme_of(int scheme) {
#define SPARI_SCHEME(number, name) [SPAR_COUPLING_##number] = &scheme_##name,
    static const spari_coupling_scheme *const table[] = {SPARI_SCHEMES(SPARI_SCHEME)};
#undef SPARI_SCHEME
    return table[scheme];
}

/* ---- the step ---- */

void spari_accelerator_begin(spari_accelerator *a, double dt) {
    a->dt = dt;
    a->iteration = 0;
    a->dropped = 0;
    a->used = 0;
    a->ratio = 0;
    a->ratios = (tally){0};
    a->most_weight = 0;
    a->omega = a->set.omega;
    if (a->scheme->begin) {
        a->scheme->begin(a);
    }
    for (int s = 0; s < a->slots; s++) {
        if (a->column[s].state == LIVE && fabs(a->column[s].dt - dt) > 0.1 * dt) {
            a->column[s].state = RESTING;
        }
    }
}

/* a and b, their weights times p and q. */
static tally join(const tally *a, double p, const tally *b, double q) {
    return (tally){p * a->weight + q * b->weight, p * p * a->square + q * q * b->square, p * a->sum + q * b->sum,
                   p * a->sum2 + q * b->sum2};
}

/* -dx.dg / dx.dx of the last two iterations */
static void estimate_ratio(spari_accelerator *a) {
    double product = 0, square = 0;
    for (int64_t i = 0; i < a->n; i++) {
        double w = a->weight[i % a->period >= a->split], dg = a->change[a->n + i], dx = dg - a->change[i];
        double answer = a->imaged ? a->answer[a->n + i] - a->answer[i] : w * w * dx;
        product -= answer * dg;
        square += answer * dx;
    }
    double ratio = product / square;
    if (isfinite(ratio) && fabs(ratio) > fabs(a->ratio)) {
        a->ratio = ratio;
    }
    if (isfinite(ratio) && isfinite(square)) {
        double w = sqrt(sqrt(square));
        const tally one = {w, w * w, w * ratio, w * ratio * ratio};
        a->most_weight = fmax(a->most_weight, w);
        a->ratios = join(&a->ratios, 1, &one, 1);
    }
}

/* Those of earlier steps with those of this one, if it has any. */
static tally all_ratios(const spari_accelerator *a, double fade) {
    double length = a->most_weight;
    return length > 0 ? join(&a->ratios_before, fade, &a->ratios, 1 / length) : a->ratios_before;
}

static void compute_next(spari_accelerator *a, const double *x, const double *g, double *next) {
    if (a->scheme->next && a->scheme->next(a, x, g, next)) {
        return;
    }
    for (int64_t i = 0; i < a->n; i++) {
        next[i] = a->omega == 1 ? g[i] : x[i] + a->omega * (g[i] - x[i]);
    }
}

/* Columns of one norm say nothing in another. */
static void set_norm(spari_accelerator *a, int imaged) {
    if (imaged != a->imaged) {
        for (int s = 0; s < a->slots; s++) {
            if (a->column[s].state == LIVE) {
                drop_column(a, s);
            }
        }
        a->imaged = imaged;
        a->iteration = a->used = 0;
        a->ratios = a->ratios_before = (tally){0};
        a->most_weight = 0;
    }
}

int spari_accelerator_imaged(const spari_accelerator *a) {
    return a->imaged;
}

static void measure(spari_accelerator *a, const double *x, const double *g, const double *image) {
    a->residual = a->imaged ? residual_to_come(a, x, g, image, a->change) : 0;
    if (a->iteration == 1) {
        a->residual_first = a->residual_least = a->residual;
        a->rises = 0;
    }
    a->rises = a->residual > 4 * a->residual_least ? a->rises + 1 : 0;
    a->residual_least = fmin(a->residual_least, a->residual);
}

/* What rises again, twice, after it had all but ended is driven by columns below the fluid's scatter. */
static void suspect(spari_accelerator *a) {
    if (a->secants && a->imaged && a->memory.scatter <= LOUD && a->rises >= 2 &&
        a->residual_least < 0.03 * a->residual_first) {
        a->memory.scatter = 2 * LOUD;
    }
}

/* What has changed since the iteration before. Its images are taken by the flexibility as it is now: that of the
   iteration before may be another one, and the difference of two images then is one of flexibilities times whole loads,
   which may be many times as large. */
static int learn(spari_accelerator *a, const double *x, const double *g, const spari_images *images) {
    for (int64_t i = 0; i < a->n; i++) {
        a->change[a->n + i] = g[i] - a->g[i];
        a->change[i] = a->change[a->n + i] - (x[i] - a->x[i]);
    }
    if (a->imaged) {
        SPARI_TRY(images->of(images->context, 2, a->change, a->answer));
    }
    estimate_ratio(a);
    if (a->scheme->learn) {
        a->scheme->learn(a);
    }
    a->led = a->imaged && a->secants;
    if (a->led) {
        memcpy(a->lead, a->change + a->n, (size_t)a->n * sizeof *a->lead);
        memcpy(a->lead + a->n, a->answer + a->n, (size_t)a->n * sizeof *a->lead);
    }
    return SPAR_OK;
}

/* What the step's first answer has changed since the last one of the step before. */
static int lead_in(spari_accelerator *a, const double *g, const spari_images *images) {
    a->led = a->ended && spari_accelerator_contradicted(a);
    for (int64_t i = 0; a->led && i < a->n; i++) {
        a->lead[i] = g[i] - a->last[i];
    }
    return a->led ? images->of(images->context, 1, a->lead, a->lead + a->n) : SPAR_OK;
}

/* Whether column and image in slot s belong to another flexibility S than g - x and g with theirs: v . S y is not
   y . S v. */
static int is_of_another(const spari_accelerator *a, int s, const double *x, const double *g, const double *image) {
    static const double OFF = 0.01;
    const double *v = slot_v(a, s), *iv = slot_iv(a, s);
    double square = dot(v, iv, a->n), r = 0, whole = 0, residual = 0, size = 0;
    for (int64_t i = 0; i < a->n; i++) {
        r += (g[i] - x[i]) * iv[i] - v[i] * image[i];
        whole += g[i] * iv[i] - v[i] * image[a->n + i];
        residual += (g[i] - x[i]) * image[i];
        size += g[i] * image[a->n + i];
    }
    return !(r * r <= OFF * OFF * square * residual) || !(whole * whole <= OFF * OFF * square * size);
}

/* The columns of earlier steps in the norm of this one, anew where the structure has turned, or stiffened, so far that
   it tells. */
static int renew_images(spari_accelerator *a, const double *x, const double *g, const spari_images *images) {
    int other = a->renewed;
    for (int s = 0; s < a->slots && !other; s++) {
        other = a->column[s].state == LIVE && is_of_another(a, s, x, g, images->now);
    }
    if (!other) {
        return SPAR_OK;
    }
    size_t bytes = (size_t)a->n * sizeof *a->v;
    int led = 0;
    for (int s = 0; s < a->slots; s++) {
        column *c = a->column + s;
        c->led &= spari_accelerator_contradicted(a); /* else nobody asks for it */
        led |= c->led;
        if (c->state == FREE) {
            memset(slot_v(a, s), 0, bytes);
            memset(slot_w(a, s), 0, bytes);
        }
        if (c->state == FREE || !c->led) {
            memset(slot_b(a, s), 0, bytes);
        }
    }
    a->renewed = 1;
    if (led) {
        SPARI_TRY(images->of(images->context, a->slots, a->b, a->ib));
    }
    SPARI_TRY(images->of(images->context, a->slots, a->v, a->iv));
    return images->of(images->context, a->slots, a->w, a->iw);
}

int spari_accelerator_next(spari_accelerator *a, const double *x, const double *g, const spari_images *images,
                           double *next) {
    const double *image = images ? images->now : NULL;
    set_norm(a, image && a->set.imaged);
    a->iteration++;
    int reweighed = weigh(a, x, g);
    if (reweighed && a->slots > 0 && !a->imaged) {
        factor_columns(a);
    }
    if (a->iteration == 1 && a->imaged && a->slots > 0) {
        SPARI_TRY(renew_images(a, x, g, images));
        factor_columns(a);
    }
    SPARI_TRY(a->iteration > 1 ? learn(a, x, g, images) : lead_in(a, g, images));
    measure(a, x, g, image);
    if (a->iteration > 1) {
        suspect(a);
    }
    if (a->n == 0) {
        return SPAR_OK;
    }
    memcpy(a->x, x, (size_t)a->n * sizeof *x);
    memcpy(a->g, g, (size_t)a->n * sizeof *g);
    if (a->imaged) {
        memcpy(a->image, image, (size_t)(2 * a->n) * sizeof *image);
    }
    compute_next(a, a->x, a->g, next);
    return SPAR_OK;
}

static int oldest_live(const spari_accelerator *a, int *count) {
    int oldest = -1;
    *count = 0;
    for (int s = 0; s < a->slots; s++) {
        if (a->column[s].state == LIVE) {
            *count += 1;
            oldest = oldest < 0 || a->column[s].serial < a->column[oldest].serial ? s : oldest;
        }
    }
    return oldest;
}

void spari_accelerator_accept(spari_accelerator *a, const double *g) {
    for (int s = 0; s < a->slots; s++) {
        column *c = a->column + s;
        if (c->state == DROPPED || a->step - c->step >= a->set.reuse) {
            c->state = FREE;
        }
        c->state = c->state == RESTING ? LIVE : c->state;
    }
    int count, oldest = oldest_live(a, &count);
    for (; count > a->set.columns; oldest = oldest_live(a, &count)) {
        a->column[oldest].state = FREE;
    }
    if (a->iteration > 1) {
        a->omega_accepted = a->omega;
    }
    static const double FADE = 0.8;
    a->ratios_before = all_ratios(a, FADE);
    a->ratios = (tally){0};
    a->most_weight = 0;
    a->memory_accepted = a->memory;
    a->ended = g && spari_accelerator_contradicted(a);
    if (a->ended) {
        memcpy(a->last, g, (size_t)a->n * sizeof *g);
    }
    a->used = 0;
    a->renewed = 0;
    a->step++;
}

void spari_accelerator_reject(spari_accelerator *a) {
    for (int s = 0; s < a->slots; s++) {
        column *c = a->column + s;
        if (c->state != FREE) {
            c->state = c->step == a->step ? FREE : LIVE;
        }
    }
    a->ratios = (tally){0};
    a->most_weight = 0;
    a->memory = a->memory_accepted;
    a->ended = 0; /* nobody knows what the fluid goes back to */
    a->used = 0;
    a->iteration = 0;
}

void spari_accelerator_forget(spari_accelerator *a) {
    for (int s = 0; s < a->slots; s++) {
        a->column[s].state = FREE;
    }
    a->omega_accepted = 0;
    a->ratios = a->ratios_before = (tally){0};
    a->most_weight = 0;
    a->used = 0;
}

int spari_accelerator_columns(const spari_accelerator *a) {
    return a->used;
}

int spari_accelerator_dropped(const spari_accelerator *a) {
    return a->dropped;
}

double spari_accelerator_ratio(const spari_accelerator *a) {
    return a->ratio;
}

int spari_accelerator_added_mass(const spari_accelerator *a, double *mean, double *spread) {
    static const double ENOUGH = 2.5;
    tally all = all_ratios(a, 1);
    double count = all.square > 0 ? all.weight * all.weight / all.square : 0; /* as many of equal weight */
    int enough = count >= ENOUGH;
    *mean = enough ? all.sum / all.weight : 0;
    *spread = enough ? sqrt(fmax(all.sum2 / all.weight - *mean * *mean, 0) * count / (count - 1)) : 0;
    enough = enough && isfinite(*mean) && isfinite(*spread);
    *mean = enough ? *mean : 0;
    *spread = enough ? *spread : 0;
    return enough;
}

double spari_accelerator_scatter(const spari_accelerator *a) {
    return a->memory.scatter;
}

/* ---- save and load ---- */

enum { OWN = 31, MEMORY = sizeof(memory) / sizeof(double), HEAD = OWN + 2 * MEMORY, COLUMN_HEAD = 6 };

/* Vectors of length n that are kept of each column. */
static int64_t of_column(const spari_accelerator *a) {
    return a->set.imaged ? 6 : 2;
}

/* And of the iteration before: x and g, their images, what the fluid remembers. */
static int64_t of_iteration(const spari_accelerator *a) {
    return 2 + (a->set.imaged ? 2 : 0) + (a->secants ? 3 : 0);
}

static int occupied(const spari_accelerator *a) {
    int count = 0;
    for (int s = 0; s < a->slots; s++) {
        count += a->column[s].state != FREE;
    }
    return count;
}

int64_t spari_accelerator_state_size(const spari_accelerator *a) {
    return HEAD + of_iteration(a) * a->n + occupied(a) * (COLUMN_HEAD + of_column(a) * a->n) + a->used;
}

/* The vectors of a column; of one that is not imaged the first two. */
static void column_vectors(const spari_accelerator *a, int s, double *vectors[6]) {
    double *const all[] = {slot_v(a, s), slot_w(a, s), slot_iv(a, s), slot_iw(a, s), slot_b(a, s), slot_ib(a, s)};
    memcpy(vectors, all, sizeof all);
}

/* Returns what comes behind it. */
static double *save_column(const spari_accelerator *a, int s, double *state) {
    const column *c = a->column + s;
    const double what[COLUMN_HEAD] = {s, c->state, (double)c->step, (double)c->serial, c->dt, c->led};
    double *vectors[6];
    column_vectors(a, s, vectors);
    memcpy(state, what, sizeof what);
    state += COLUMN_HEAD;
    for (int k = 0; k < of_column(a); k++, state += a->n) {
        memcpy(state, vectors[k], (size_t)a->n * sizeof *state);
    }
    return state;
}

static const double *load_column(spari_accelerator *a, const double *state) {
    int s = (int)state[0];
    double *vectors[6];
    a->column[s] = (column){(column_state)(int)state[1], (int64_t)state[2], (int64_t)state[3], state[4], (int)state[5]};
    column_vectors(a, s, vectors);
    state += COLUMN_HEAD;
    for (int k = 0; k < of_column(a); k++, state += a->n) {
        memcpy(vectors[k], state, (size_t)a->n * sizeof *state);
    }
    return state;
}

void spari_accelerator_save(const spari_accelerator *a, double *state) {
    const double own[OWN] = {(double)a->n,
                             (double)a->step,
                             (double)a->serial,
                             a->iteration,
                             a->dropped,
                             a->dt,
                             a->ratio,
                             a->omega,
                             a->omega_accepted,
                             a->size[0],
                             a->size[1],
                             a->weight[0],
                             a->weight[1],
                             occupied(a),
                             a->used,
                             a->imaged,
                             a->led,
                             a->ended,
                             a->residual_first,
                             a->residual_least,
                             a->rises,
                             a->ratios.weight,
                             a->ratios.square,
                             a->ratios.sum,
                             a->ratios.sum2,
                             a->ratios_before.weight,
                             a->ratios_before.square,
                             a->ratios_before.sum,
                             a->ratios_before.sum2,
                             a->most_weight,
                             a->renewed};
    size_t bytes = (size_t)a->n * sizeof *state;
    memcpy(state, own, sizeof own);
    memcpy(state += OWN, &a->memory, sizeof a->memory);
    memcpy(state += MEMORY, &a->memory_accepted, sizeof a->memory);
    memcpy(state += MEMORY, a->x, bytes);
    memcpy(state += a->n, a->g, bytes);
    state += a->n;
    if (a->set.imaged) {
        memcpy(state, a->image, 2 * bytes);
        state += 2 * a->n;
    }
    if (a->secants) {
        memcpy(state, a->lead, 2 * bytes);
        memcpy(state + 2 * a->n, a->last, bytes);
        state += 3 * a->n;
    }
    for (int s = 0; s < a->slots; s++) {
        state = a->column[s].state == FREE ? state : save_column(a, s, state);
    }
    for (int j = 0; j < a->used; j++) {
        state[j] = a->order[j];
    }
}

static int whole_below(double x, double end) {
    return x >= 0 && x < end && x == floor(x);
}

/* Columns in slots of their own, not more of this step nor of older ones than there can be. */
static int are_columns(const spari_accelerator *a, const double *first, int64_t occupied, double step) {
    int64_t width = COLUMN_HEAD + of_column(a) * a->n, of_step = 0;
    for (int64_t k = 0; k < occupied; k++) {
        const double *c = first + k * width;
        int now = c[2] == step;
        of_step += now;
        if (!whole_below(c[0], a->slots) || !(c[1] == LIVE || (!now && (c[1] == RESTING || c[1] == DROPPED))) ||
            !whole_below(c[2], step + 1) || !spari_is_count(c[3]) || !whole_below(c[5], a->secants ? 2 : 1)) {
            return 0;
        }
        for (const double *other = first; other != c; other += width) {
            if (other[0] == c[0]) {
                return 0;
            }
        }
    }
    return of_step <= a->set.columns && occupied - of_step <= a->set.columns;
}

/* What the fluid is seen to remember, as it is in a struct memory. */
static int is_memory(const spari_accelerator *a, const double *state) {
    memory m;
    memcpy(&m, state, sizeof m);
    int sound = m.contradiction >= 0 && m.contradiction <= 1 && m.rho >= 0 && m.rho < 1 && m.scatter >= 0 &&
                m.scatter <= 1 && spari_first_nonfinite(&m.told.pairs, 5) < 0;
    return sound && (a->secants || (m.contradiction == 0 && m.rho == 0));
}

int spari_accelerator_is_state(const spari_accelerator *a, const double *state, int64_t count) {
    if (count < HEAD || !spari_is_count(state[1]) || !spari_is_count(state[2]) || !whole_below(state[3], INT_MAX) ||
        !whole_below(state[4], INT_MAX) || state[0] != (double)a->n || !whole_below(state[13], a->slots + 1.0) ||
        !whole_below(state[14], (a->slots > 0 ? a->set.columns : 0) + 1.0)) {
        return 0;
    }
    int64_t occupied = (int64_t)state[13], used = (int64_t)state[14];
    if (count != HEAD + of_iteration(a) * a->n + occupied * (COLUMN_HEAD + of_column(a) * a->n) + used) {
        return 0;
    }
    if (!whole_below(state[15], a->set.imaged ? 2 : 1) || !whole_below(state[20], INT_MAX) ||
        !whole_below(state[30], 2) || !is_memory(a, state + OWN) || !is_memory(a, state + OWN + MEMORY) ||
        !whole_below(state[16], a->secants ? 2 : 1) || !whole_below(state[17], a->secants ? 2 : 1) ||
        !are_columns(a, state + HEAD + of_iteration(a) * a->n, occupied, state[1])) {
        return 0;
    }
    for (int64_t j = count - used; j < count; j++) {
        if (!whole_below(state[j], a->slots)) {
            return 0;
        }
    }
    return 1;
}

int spari_accelerator_load(spari_accelerator *a, const double *state, int64_t count) {
    if (!spari_accelerator_is_state(a, state, count)) {
        return 0;
    }
    int occupied = (int)state[13], used = (int)state[14];
    size_t bytes = (size_t)a->n * sizeof *state;
    a->step = (int64_t)state[1], a->serial = (int64_t)state[2];
    a->iteration = (int)state[3], a->dropped = (int)state[4];
    a->dt = state[5], a->ratio = state[6], a->omega = state[7], a->omega_accepted = state[8];
    memcpy(a->size, state + 9, sizeof a->size);
    memcpy(a->weight, state + 11, sizeof a->weight);
    a->imaged = (int)state[15], a->residual_first = state[18];
    a->led = (int)state[16], a->ended = (int)state[17];
    memcpy(&a->memory, state + OWN, sizeof a->memory);
    memcpy(&a->memory_accepted, state + OWN + MEMORY, sizeof a->memory);
    a->residual_least = state[19], a->rises = (int)state[20];
    a->ratios = (tally){state[21], state[22], state[23], state[24]};
    a->ratios_before = (tally){state[25], state[26], state[27], state[28]};
    a->most_weight = state[29];
    a->renewed = (int)state[30];
    memcpy(a->x, state += HEAD, bytes);
    memcpy(a->g, state += a->n, bytes);
    state += a->n;
    if (a->set.imaged) {
        memcpy(a->image, state, 2 * bytes);
        state += 2 * a->n;
    }
    if (a->secants) {
        memcpy(a->lead, state, 2 * bytes);
        memcpy(a->last, state + 2 * a->n, bytes);
        state += 3 * a->n;
    }
    for (int s = 0; s < a->slots; s++) {
        a->column[s].state = FREE;
    }
    for (int k = 0; k < occupied; k++) {
        state = load_column(a, state);
    }
    a->used = 0;
    for (int j = 0; j < used; j++) { /* in the order of the first time: the same bits */
        (void)append(a, (int)state[j], 0);
    }
    return 1;
}
