/* IQN-ILS (Degroote, Bathe & Vierendeels 2009) with columns of earlier iterations, and its extension to fluids whose
   results contradict each other: see schemes.h. */
#include "quasi_newton.h"

#include "../base/status.h"

#include <string.h>

/* ---- memory of the fluid ---- */

int spari_accelerator_contradicted(const spari_accelerator *a) {
    return a->imaged && a->slots > 0 && a->memory.contradiction > SPARI_CONTRADICTION_SEEN;
}

/* change, image := the change in slot s without the fluid's memory, from v or w and its image */
static void forget_lead(const spari_accelerator *a, int s, double *change, double *image) {
    double rho = spari_rho_of(a);
    if (rho > 0) {
        spari_axpy(-rho, spari_slot_b(a, s), change, a->n);
        spari_axpy(-rho, spari_slot_ib(a, s), image, a->n);
    }
}

double spari_differences_residual(const spari_accelerator *a, const double *x, const double *g, const double *image,
                                  double *r) {
    double square = 0, rho = a->led ? spari_rho_of(a) : 0;
    for (int64_t i = 0; i < a->n; i++) {
        r[i] = g[i] - x[i];
        double response = image[i];
        if (rho > 0) {
            r[i] += rho * a->lead[i];
            response += rho * a->lead[a->n + i];
        }
        square += r[i] * response;
    }
    return sqrt(fmax(square, 0));
}

/* ---- columns ---- */

/* out = in, each entry divided by the size of its kind */
static void over_sizes(const spari_accelerator *a, const double *in, double *out) {
    for (int64_t i = 0; i < a->n; i += a->period) {
        for (int k = 0; k < a->period && i + k < a->n; k++) {
            out[i + k] = a->weight[k >= a->split] * in[i + k];
        }
    }
}

/* Such columns are not used in the factorisation as long as the fluid has memory. */
static int is_unled(const spari_accelerator *a, int slot) {
    return spari_rho_of(a) > 0 && !a->column[slot].led;
}

/* Adds a column to the factorisation by twofold Gram-Schmidt (Giraud et al. 2005: orthogonal to rounding). Returns 0
   and adds nothing if at most `filter` of it is linearly independent. */
int spari_differences_append(spari_accelerator *a, int slot, double filter) {
    int k = a->used;
    if (k == a->set.columns || is_unled(a, slot)) {
        return 0;
    }
    double *q = a->q + k * a->n, *r = a->r + (int64_t)k * a->set.columns, *images = a->imaged ? a->p : a->q;
    double *p = images + k * a->n;
    if (a->imaged) {
        memcpy(q, spari_slot_v(a, slot), (size_t)a->n * sizeof *q);
        memcpy(p, spari_slot_iv(a, slot), (size_t)a->n * sizeof *p);
        forget_lead(a, slot, q, p);
    } else {
        over_sizes(a, spari_slot_v(a, slot), q);
    }
    double whole = spari_size_in(q, p, a->n);
    for (int j = 0; j < k; j++) {
        r[j] = 0;
    }
    for (int pass = 0; pass < 2; pass++) {
        for (int j = 0; j < k; j++) {
            double c = spari_dot(images + j * a->n, q, a->n);
            r[j] += c;
            spari_axpy(-c, a->q + j * a->n, q, a->n);
            if (a->imaged) {
                spari_axpy(-c, a->p + j * a->n, p, a->n);
            }
        }
    }
    r[k] = spari_size_in(q, p, a->n);
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

/* An independent part of a column smaller than the fluid's scatter is scatter. */
static double least_new(const spari_accelerator *a) {
    return a->imaged ? fmax(a->set.filter, a->memory.scatter) : a->set.filter;
}

static int newest_before(const spari_accelerator *a, int64_t serial) {
    int found = -1;
    for (int s = 0; s < a->slots; s++) {
        if (a->column[s].state == SPARI_LIVE && a->column[s].serial < serial &&
            (found < 0 || a->column[s].serial > a->column[found].serial)) {
            found = s;
        }
    }
    return found;
}

void spari_differences_drop(spari_accelerator *a, int slot) {
    a->column[slot].state = a->column[slot].step == a->step ? SPARI_FREE : SPARI_DROPPED;
}

void spari_differences_factor(spari_accelerator *a) {
    int64_t serial = a->serial + 1;
    a->used = 0;
    for (int s = newest_before(a, serial); s >= 0; s = newest_before(a, serial)) {
        serial = a->column[s].serial;
        int full = a->used == a->set.columns;
        if (!spari_differences_append(a, s, least_new(a))) {
            a->dropped += !full;
            /* those removed below SPARI_CONTRADICTION_SEEN have nothing to say; above, they are averaged with */
            if (a->memory.scatter <= SPARI_CONTRADICTION_SEEN && !is_unled(a, s)) {
                spari_differences_drop(a, s);
            }
        }
    }
}

static int free_slot(const spari_accelerator *a) {
    for (int s = 0; s < a->slots; s++) {
        if (a->column[s].state == SPARI_FREE) {
            return s;
        }
    }
    return -1; /* cannot happen: at most `columns` are of this step, at most `columns` are older */
}

/* Leaves at most all columns but one of this step: the oldest goes. */
static void limit_columns(spari_accelerator *a) {
    int count = 0, oldest = -1;
    for (int s = 0; s < a->slots; s++) {
        const spari_difference *c = a->column + s;
        if (c->state == SPARI_LIVE && c->step == a->step) {
            count++;
            oldest = oldest < 0 || c->serial < a->column[oldest].serial ? s : oldest;
        }
    }
    if (count == a->set.columns) {
        spari_differences_drop(a, oldest);
        spari_differences_factor(a);
    }
}

static spari_secant secant_of(const spari_accelerator *a, int slot) {
    int led = a->column[slot].led;
    return (spari_secant){spari_slot_v(a, slot),  spari_slot_w(a, slot),  led ? spari_slot_b(a, slot) : NULL,
                          spari_slot_iv(a, slot), spari_slot_iw(a, slot), led ? spari_slot_ib(a, slot) : NULL};
}

/* Columns in use older than `serial`, newest first; of this step alone, or of all. */
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

/* Linearly independent part above which a column adds a direction. */
static const double INDEPENDENT = 1e-2;

/* Error of the newest column relative to its prediction by the other columns of the step, with memory rho: negative
   if they cannot predict it. */
static double defect_of(spari_accelerator *a, int newest, double rho) {
    const spari_secant c = secant_of(a, newest);
    gather_secants(a, INDEPENDENT, a->column[newest].serial, 1);
    spari_secants_remember(a->secants, rho);
    (void)spari_secants_fit(a->secants, 0);
    return spari_secants_defect(a->secants, &c);
}

/* Decays earlier contradiction by a column that fits. */
static double faded(double seen, double defect) {
    static const double MEMORY = 0.8;
    return defect >= 0 ? fmax(fmin(defect, 1), MEMORY * seen) : seen;
}

/* Estimates rho (T31). Returns the asymmetry with rho relative to the symmetric part. With too few pairs rho is
   unchanged. */
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

/* Evaluates the newest column: its contradiction with the others of the step, whether memory explains it, and the
   remaining scatter. */
static void weigh_responses(spari_accelerator *a, int newest) {
    spari_recollection *m = &a->memory;
    double defect = defect_of(a, newest, 0), was = m->rho, left = 1;
    m->contradiction = faded(m->contradiction, defect);
    if (m->contradiction > SPARI_CONTRADICTION_SEEN) {
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

void spari_differences_learn(spari_accelerator *a) {
    limit_columns(a);
    int s = free_slot(a), moved = 0;
    size_t bytes = (size_t)a->n * sizeof *a->change;
    memcpy(spari_slot_v(a, s), a->change, bytes);
    memcpy(spari_slot_w(a, s), a->change + a->n, bytes);
    if (a->imaged) {
        memcpy(spari_slot_iv(a, s), a->response, bytes);
        memcpy(spari_slot_iw(a, s), a->response + a->n, bytes);
    }
    for (int64_t i = 0; i < a->n; i++) {
        moved |= a->change[i] != 0;
    }
    if (!moved) { /* the residual stalls: the column gives no information */
        a->dropped++;
        return;
    }
    a->column[s] = (spari_difference){SPARI_LIVE, a->step, ++a->serial, a->dt, a->imaged && a->led};
    if (a->column[s].led) {
        memcpy(spari_slot_b(a, s), a->lead, bytes);
        memcpy(spari_slot_ib(a, s), a->lead + a->n, bytes);
    }
    double rho = a->memory.rho;
    if (a->imaged) {
        weigh_responses(a, s);
    }
    if (a->memory.rho != rho || !spari_differences_append(a, s, least_new(a))) {
        spari_differences_factor(a);
    }
}

/* Maximum length of a step. For an added mass, (I - J)^-1 does not lengthen in the norm of the images, so the
   solution is within the first residual's length of the step's first loads. A step much longer than that, or than
   the residual, comes from wrong columns, or from an eigenvalue of J near 1. In the latter case a limited step
   reduces the residual as predicted, and the next one may be ten times longer. */
static double longest(spari_accelerator *a) {
    static const double LONG = 10;
    int held = a->cut > 0 && a->residual <= (1 - 0.5 * a->cut) * a->cut_residual;
    a->reach = held ? 10 * a->reach : LONG;
    a->cut = 0;
    return a->reach * fmin(a->residual, a->residual_first);
}

/* Limits a step made with alpha. */
static void trust(spari_accelerator *a, const double *x, double *next) {
    double step = 0, most = longest(a), rho = spari_rho_of(a);
    for (int64_t i = 0; i < a->n; i++) {
        double response = a->image[i] + (rho > 0 && a->led ? rho * a->lead[a->n + i] : 0);
        for (int j = 0; j < a->used; j++) {
            int slot = a->order[j];
            response += a->alpha[j] * (spari_slot_iw(a, slot)[i] - (rho > 0 ? rho * spari_slot_ib(a, slot)[i] : 0));
        }
        step += (next[i] - x[i]) * response;
    }
    if (step > most * most) {
        double cut = most / sqrt(step);
        a->cut = cut, a->cut_residual = a->residual;
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

/* The same in the norm of the images, as x + (W - V) alpha + the residual outside the columns: no rounding error if
   the residual is much larger than the loads. */
static int quasi_newton_imaged(spari_accelerator *a, const double *x, const double *g, double *next) {
    int64_t n = a->n;
    int m = a->used;
    (void)spari_differences_residual(a, x, g, a->image, next);
    memset(a->alpha, 0, (size_t)m * sizeof *a->alpha);
    for (int pass = 0; pass < 2; pass++) {
        for (int j = 0; j < m; j++) {
            double part = spari_dot(a->p + j * n, next, n);
            a->alpha[j] -= part;
            spari_axpy(-part, a->q + j * n, next, n);
        }
    }
    back_substitute(a);
    if (spari_first_nonfinite(a->alpha, m) >= 0) {
        return 0;
    }
    for (int j = 0; j < m; j++) {
        const double *v = spari_slot_v(a, a->order[j]), *w = spari_slot_w(a, a->order[j]);
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

/* next = g + W alpha, alpha the least squares of V alpha = -(g - x). `next` may be x. Returns 0 if the result is not
   finite. */
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
        spari_axpy(a->alpha[j], spari_slot_w(a, a->order[j]), next, a->n);
    }
    return 1;
}

/* Step with the derivative fitted to all columns. Returns 0 if the result is not finite. */
static int step_by_average(spari_accelerator *a, const double *x, const double *g, double *next) {
    static const double PART = 0.5, FILTER = 0.3;
    double *r = a->change;
    gather_secants(a, fmin(fmax(a->set.filter, PART * a->memory.scatter), FILTER), a->serial + 1, 0);
    spari_secants_remember(a->secants, a->memory.rho);
    double length = spari_differences_residual(a, x, g, a->image, r);
    return spari_secants_fit(a->secants, a->memory.scatter * a->memory.scatter) > 0 &&
           spari_secants_step(a->secants, x, r, length, longest(a), next);
}

int spari_differences_next(spari_accelerator *a, const double *x, const double *g, double *next) {
    return (a->imaged && a->memory.scatter > SPARI_SCATTER_AVERAGED && step_by_average(a, x, g, next)) ||
           (a->used > 0 && quasi_newton(a, x, g, next));
}

/* ---- from step to step ---- */

/* Whether column and image in slot s belong to another flexibility S than g - x and g with theirs: v . S y differs
   from y . S v. */
static int is_of_another(const spari_accelerator *a, int s, const double *x, const double *g, const double *image) {
    static const double OFF = 0.01;
    const double *v = spari_slot_v(a, s), *iv = spari_slot_iv(a, s);
    double square = spari_dot(v, iv, a->n), r = 0, whole = 0, residual = 0, size = 0;
    for (int64_t i = 0; i < a->n; i++) {
        r += (g[i] - x[i]) * iv[i] - v[i] * image[i];
        whole += g[i] * iv[i] - v[i] * image[a->n + i];
        residual += (g[i] - x[i]) * image[i];
        size += g[i] * image[a->n + i];
    }
    return !(r * r <= OFF * OFF * square * residual) || !(whole * whole <= OFF * OFF * square * size);
}

/* Copies a column's images, and those of its lead if any, to `at`, or back; returns the position after them. */
static double *copy_images(const spari_accelerator *a, int s, int led, double *at, int back) {
    double *const own[] = {spari_slot_iv(a, s), spari_slot_iw(a, s), spari_slot_b(a, s), spari_slot_ib(a, s)};
    for (int k = 0; k < (led ? 4 : 2); k++, at += a->n) {
        memcpy(back ? own[k] : at, back ? at : own[k], (size_t)a->n * sizeof *at);
    }
    return at;
}

/* Saves the images before they are overwritten: per slot whether its column has a lead (-1: no column), then the
   images. */
static void keep_images(spari_accelerator *a) {
    int64_t count = a->slots;
    for (int s = 0; s < a->slots; s++) {
        count += a->column[s].state == SPARI_FREE ? 0 : (a->column[s].led ? 4 : 2) * a->n;
    }
    double *to = spari_snapshot_take(&a->before, count), *at = to ? to + a->slots : NULL;
    for (int s = 0; s < a->slots && to; s++) {
        to[s] = a->column[s].state == SPARI_FREE ? -1 : a->column[s].led;
        at = to[s] < 0 ? at : copy_images(a, s, a->column[s].led, at, 0);
    }
}

void spari_differences_restore(spari_accelerator *a) {
    double *from = a->before.data, *at = a->before.saved > 0 ? from + a->slots : NULL;
    for (int s = 0; s < a->slots && at; s++) {
        if (from[s] >= 0) {
            a->column[s].led = from[s] > 0;
            at = copy_images(a, s, a->column[s].led, at, 1);
        }
    }
    a->renewed = a->before.saved < 0; /* no memory for them */
}

int spari_differences_renew(spari_accelerator *a, const double *x, const double *g, const spari_images *images) {
    int other = a->renewed;
    for (int s = 0; s < a->slots && !other; s++) {
        other = a->column[s].state == SPARI_LIVE && is_of_another(a, s, x, g, images->now);
    }
    if (!other) {
        return SPAR_OK;
    }
    size_t bytes = (size_t)a->n * sizeof *a->v;
    int led = 0;
    keep_images(a);
    for (int s = 0; s < a->slots; s++) {
        spari_difference *c = a->column + s;
        c->led &= spari_accelerator_contradicted(a); /* otherwise unused */
        led |= c->led;
        if (c->state == SPARI_FREE) {
            memset(spari_slot_v(a, s), 0, bytes);
            memset(spari_slot_w(a, s), 0, bytes);
        }
        if (c->state == SPARI_FREE || !c->led) {
            memset(spari_slot_b(a, s), 0, bytes);
        }
    }
    a->renewed = 1;
    if (led) {
        SPARI_TRY(images->of(images->context, a->slots, a->b, a->ib));
    }
    SPARI_TRY(images->of(images->context, a->slots, a->v, a->iv));
    return images->of(images->context, a->slots, a->w, a->iw);
}

static int oldest_live(const spari_accelerator *a, int *count) {
    int oldest = -1;
    *count = 0;
    for (int s = 0; s < a->slots; s++) {
        if (a->column[s].state == SPARI_LIVE) {
            *count += 1;
            oldest = oldest < 0 || a->column[s].serial < a->column[oldest].serial ? s : oldest;
        }
    }
    return oldest;
}

void spari_differences_accept(spari_accelerator *a) {
    for (int s = 0; s < a->slots; s++) {
        spari_difference *c = a->column + s;
        if (c->state == SPARI_DROPPED || a->step - c->step >= a->set.reuse) {
            c->state = SPARI_FREE;
        }
        c->state = c->state == SPARI_RESTING ? SPARI_LIVE : c->state;
    }
    int count, oldest = oldest_live(a, &count);
    for (; count > a->set.columns; oldest = oldest_live(a, &count)) {
        a->column[oldest].state = SPARI_FREE;
    }
}
