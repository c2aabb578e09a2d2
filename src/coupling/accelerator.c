/* Acceleration of the coupling iteration: constant relaxation, Aitken relaxation, and quasi-Newton (quasi_newton.c). */
#include "quasi_newton.h"

#include "../base/poison.h"
#include "../base/status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
             (a->response = spari_zalloc(2 * n + 1, sizeof *a->response)) &&
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
    SPARI_FREE(a->x, a->g, a->image, a->change, a->response, a->v, a->w, a->iv, a->iw, a->b, a->ib, a->lead, a->last,
               a->q, a->r, a->p, a->alpha);
    SPARI_FREE(a->column, a->order);
    spari_secants_free(a->secants);
    spari_snapshot_free(&a->before);
    free(a);
    *accelerator = NULL;
}

/* ---- scaling of forces and moments ---- */

/* Sizes of forces and moments: root of the sum of squares of the loads used and of the loads that came back. */
static void measure_kinds(const spari_accelerator *a, const double *x, const double *g, double size[2]) {
    double s[2] = {0, 0};
    for (int64_t i = 0; i < a->n; i += a->period) {
        for (int k = 0; k < a->period && i + k < a->n; k++) {
            s[k >= a->split] += x[i + k] * x[i + k] + g[i + k] * g[i + k];
        }
    }
    /* a smaller fraction of the other kind gets no larger weight: it may be the rounding error of zero */
    double large = 1e-8 * sqrt(fmax(s[0], s[1]));
    for (int k = 0; k < 2; k++) {
        size[k] = fmax(sqrt(s[k]), large);
        size[k] = size[k] > 0 ? size[k] : 1;
    }
}

/* The step's first loads determine the weights; loads that exceed them tenfold determine new ones. Returns whether
   they changed. */
static int set_weights(spari_accelerator *a, const double *x, const double *g) {
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

int spari_accelerator_settled(const spari_accelerator *a, const double *x, const double *g, double *r) {
    double rho = spari_rho_of(a);
    const double *before = a->iteration > 0 ? a->g : a->ended ? a->last : NULL;
    for (int64_t i = 0; rho > 0 && before && i < a->n; i++) {
        r[i] = g[i] - x[i] + rho / (1 - rho) * (g[i] - before[i]);
    }
    return rho > 0 && before;
}

/* ---- Aitken ---- */

/* Kuettler & Wall (2008): a step begins with the last factor, limited by the user's factor. */
static void aitken_begin(spari_accelerator *a) {
    a->omega = a->omega_accepted > 0 ? fmin(a->omega_accepted, a->set.omega) : a->set.omega;
}

/* omega <- -omega r'.(r - r') / |r - r'|^2, r' the residual before; if the residual stalls, omega is unchanged. */
static void aitken_learn(spari_accelerator *a) {
    double product[2] = {0, 0}, square[2] = {0, 0};
    for (int64_t i = 0; i < a->n; i += a->period) {
        for (int k = 0; k < a->period && i + k < a->n; k++) {
            int kind = k >= a->split;
            double before = a->g[i + k] - a->x[i + k], change = a->change[i + k];
            double response = a->imaged ? a->response[i + k] : change;
            product[kind] += before * response;
            square[kind] += change * response;
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

static const spari_coupling_scheme scheme_explicit = {.name = "explicit"},
                                   scheme_fixed_point = {.name = "fixed point", .iterates = 1},
                                   scheme_aitken = {.name = "Aitken",
                                                    .iterates = 1,
                                                    .begin = aitken_begin,
                                                    .learn = aitken_learn},
                                   scheme_iqn_ils = {.name = "IQN-ILS",
                                                     .iterates = 1,
                                                     .columns = 1,
                                                     .learn = spari_differences_learn,
                                                     .next = spari_differences_next};

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
    a->ratios = (spari_ratios){0};
    a->most_weight = 0;
    a->begun.imaged = a->imaged;
    a->begun.ratios = a->ratios_before;
    spari_snapshot_open(&a->before, 1);
    spari_poison(a->change, a->change ? 2 * a->n : 0);
    spari_poison(a->response, 2 * a->n);
    spari_poison(a->alpha, a->slots > 0 ? a->set.columns : 0);
    a->omega = a->set.omega;
    if (a->scheme->begin) {
        a->scheme->begin(a);
    }
    for (int s = 0; s < a->slots; s++) {
        if (a->column[s].state == SPARI_LIVE && fabs(a->column[s].dt - dt) > 0.1 * dt) {
            a->column[s].state = SPARI_RESTING;
        }
    }
}

/* Sum of a and b with weights multiplied by p and q. */
static spari_ratios join(const spari_ratios *a, double p, const spari_ratios *b, double q) {
    return (spari_ratios){p * a->weight + q * b->weight, p * p * a->square + q * q * b->square, p * a->sum + q * b->sum,
                          p * a->sum2 + q * b->sum2};
}

/* -dx.dg / dx.dx of the last two iterations */
static void estimate_ratio(spari_accelerator *a) {
    double product = 0, square = 0;
    for (int64_t i = 0; i < a->n; i++) {
        double w = a->weight[i % a->period >= a->split], dg = a->change[a->n + i], dx = dg - a->change[i];
        double response = a->imaged ? a->response[a->n + i] - a->response[i] : w * w * dx;
        product -= response * dg;
        square += response * dx;
    }
    double ratio = product / square;
    if (isfinite(ratio) && fabs(ratio) > fabs(a->ratio)) {
        a->ratio = ratio;
    }
    if (isfinite(ratio) && isfinite(square)) {
        double w = sqrt(sqrt(square));
        const spari_ratios one = {w, w * w, w * ratio, w * ratio * ratio};
        a->most_weight = fmax(a->most_weight, w);
        a->ratios = join(&a->ratios, 1, &one, 1);
    }
}

/* Ratios of earlier steps, together with those of this step if there are any. */
static spari_ratios all_ratios(const spari_accelerator *a, double fade) {
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

/* Columns of one norm are useless in another. */
static void set_norm(spari_accelerator *a, int imaged) {
    if (imaged != a->imaged) {
        for (int s = 0; s < a->slots; s++) {
            if (a->column[s].state == SPARI_LIVE) {
                spari_differences_drop(a, s);
            }
        }
        a->iteration = a->used = 0;
        a->ratios = a->ratios_before = (spari_ratios){0};
        a->most_weight = 0;
    }
    a->imaged = imaged;
}

int spari_accelerator_imaged(const spari_accelerator *a) {
    return a->imaged;
}

static void measure(spari_accelerator *a, const double *x, const double *g, const double *image) {
    a->residual = a->imaged ? spari_differences_residual(a, x, g, image, a->change) : 0;
    if (a->iteration == 1) {
        a->residual_first = a->residual_least = a->residual;
        a->rises = 0;
        a->cut = 0;
    }
    a->rises = a->residual > 4 * a->residual_least ? a->rises + 1 : 0;
    a->residual_least = fmin(a->residual_least, a->residual);
}

/* A residual that rises twice after it was nearly converged is dominated by columns below the fluid's scatter. */
static void suspect(spari_accelerator *a) {
    if (a->secants && a->imaged && a->memory.scatter <= SPARI_SCATTER_AVERAGED && a->rises >= 2 &&
        a->residual_least < 0.03 * a->residual_first) {
        a->memory.scatter = 2 * SPARI_SCATTER_AVERAGED;
    }
}

/* Differences since the iteration before. They are mapped with the current flexibility. Differencing two mapped
   loads would difference flexibilities times the full loads, which may be much larger. */
static int learn(spari_accelerator *a, const double *x, const double *g, const spari_images *images) {
    for (int64_t i = 0; i < a->n; i++) {
        a->change[a->n + i] = g[i] - a->g[i];
        a->change[i] = a->change[a->n + i] - (x[i] - a->x[i]);
    }
    if (images && a->imaged) {
        SPARI_TRY(images->of(images->context, 2, a->change, a->response));
    }
    estimate_ratio(a);
    if (a->scheme->learn) {
        a->scheme->learn(a);
    }
    a->led = a->imaged && a->secants;
    if (a->led) {
        memcpy(a->lead, a->change + a->n, (size_t)a->n * sizeof *a->lead);
        memcpy(a->lead + a->n, a->response + a->n, (size_t)a->n * sizeof *a->lead);
    }
    return SPAR_OK;
}

/* Difference between the step's first result and the last one of the step before. */
static int lead_in(spari_accelerator *a, const double *g, const spari_images *images) {
    a->led = images && a->ended && spari_accelerator_contradicted(a);
    for (int64_t i = 0; a->led && i < a->n; i++) {
        a->lead[i] = g[i] - a->last[i];
    }
    return a->led ? images->of(images->context, 1, a->lead, a->lead + a->n) : SPAR_OK;
}

int spari_accelerator_next(spari_accelerator *a, const double *x, const double *g, const spari_images *images,
                           double *next) {
    const double *image = images ? images->now : NULL;
    set_norm(a, image && a->set.imaged);
    a->iteration++;
    int reweighed = set_weights(a, x, g);
    if (reweighed && a->slots > 0 && !a->imaged) {
        spari_differences_factor(a);
    }
    if (a->iteration == 1 && a->imaged && a->slots > 0) {
        SPARI_TRY(spari_differences_renew(a, x, g, images));
        spari_differences_factor(a);
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
    if (image && a->imaged) {
        memcpy(a->image, image, (size_t)(2 * a->n) * sizeof *image);
    }
    compute_next(a, a->x, a->g, next);
    return SPAR_OK;
}

void spari_accelerator_accept(spari_accelerator *a, const double *g) {
    spari_differences_accept(a);
    if (a->iteration > 1) {
        a->omega_accepted = a->omega;
    }
    static const double FADE = 0.8;
    a->ratios_before = all_ratios(a, FADE);
    a->ratios = (spari_ratios){0};
    a->most_weight = 0;
    a->memory_accepted = a->memory;
    a->ended = g && spari_accelerator_contradicted(a);
    if (a->ended) {
        memcpy(a->last, g, (size_t)a->n * sizeof *g);
    }
    a->used = 0;
    a->renewed = 0;
    spari_snapshot_close(&a->before);
    a->step++;
}

void spari_accelerator_reject(spari_accelerator *a) {
    for (int s = 0; s < a->slots; s++) {
        spari_difference *c = a->column + s;
        if (c->state != SPARI_FREE) {
            c->state = c->step == a->step ? SPARI_FREE : SPARI_LIVE;
        }
    }
    a->ratios = (spari_ratios){0};
    a->most_weight = 0;
    a->memory = a->memory_accepted;
    if (a->before.open) {
        a->imaged = a->begun.imaged;
        a->ratios_before = a->begun.ratios;
        spari_differences_restore(a);
    }
    spari_snapshot_close(&a->before);
    a->used = 0;
    a->iteration = 0;
}

void spari_accelerator_forget(spari_accelerator *a) {
    for (int s = 0; s < a->slots; s++) {
        a->column[s].state = SPARI_FREE;
    }
    a->omega_accepted = 0;
    a->ratios = a->ratios_before = (spari_ratios){0};
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
    spari_ratios all = all_ratios(a, 1);
    double count =
        all.square > 0 ? all.weight * all.weight / all.square : 0; /* equivalent number of ratios of equal weight */
    int enough = count >= ENOUGH;
    *mean = enough ? all.sum / all.weight : 0;
    *spread = enough ? sqrt(fmax(all.sum2 / all.weight - *mean * *mean, 0) * count / (count - 1)) : 0;
    enough = enough && isfinite(*mean) && isfinite(*spread);
    *mean = enough ? *mean : 0;
    *spread = enough ? *spread : 0;
    return enough;
}
