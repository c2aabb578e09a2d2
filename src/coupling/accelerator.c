/* Acceleration of the coupling iteration: constant relaxation, Aitken relaxation, and quasi-Newton
   (fluid_secants.c, iqn_ils.c). */
#include "accelerator_data.h"

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
    a->memory.quantity = a->accepted.memory.quantity = SPARI_OWN_STEPS; /* until steps of other lengths tell another */
    a->scheme = spari_coupling_scheme_of(settings->scheme);
    a->n = n;
    a->period = period;
    a->split = split;
    a->omega = settings->omega;
    int64_t m = a->scheme->columns ? settings->columns : 0, k = settings->imaged ? m : 0, nk = k > 0 ? n : 0;
    int ok = (a->x = spari_zalloc(n, sizeof *a->x)) && (a->g = spari_zalloc(n, sizeof *a->g)) &&
             (a->change = spari_zalloc(2 * n, sizeof *a->change)) &&
             (a->response = spari_zalloc(2 * n + 1, sizeof *a->response)) &&
             (a->column = spari_zalloc(2 * m, sizeof *a->column)) && (a->p = spari_zalloc(2 * m * n, sizeof *a->p)) &&
             (a->y = spari_zalloc(2 * m * n, sizeof *a->y)) && (a->b = spari_zalloc(2 * k * n, sizeof *a->b)) &&
             (a->axes = spari_zalloc(2 * k * (n / 6 * 4), sizeof *a->axes)) &&
             (a->stretch = spari_zalloc(nk, sizeof *a->stretch)) && (a->lead = spari_zalloc(nk, sizeof *a->lead)) &&
             (a->last = spari_zalloc(nk, sizeof *a->last)) && (a->base = spari_zalloc(2 * nk, sizeof *a->base)) &&
             (a->basis = spari_zalloc(m * n, sizeof *a->basis)) &&
             (a->loads = spari_zalloc((k + 1) * nk, sizeof *a->loads)) &&
             (a->images = spari_zalloc((k + 1) * nk + 1, sizeof *a->images)) &&
             (a->matrix = spari_zalloc(m * m, sizeof *a->matrix)) && (a->alpha = spari_zalloc(m, sizeof *a->alpha)) &&
             (a->slots = spari_zalloc(m, sizeof *a->slots)) &&
             (a->combinations = spari_zalloc(k * k, sizeof *a->combinations)) &&
             (a->left = spari_zalloc(k + 1, sizeof *a->left));
    if (!ok) {
        spari_accelerator_free(&a);
    }
    for (int64_t i = 0; a && i < nk; i++) {
        a->stretch[i] = 1;
    }
    return a;
}

double *spari_accelerator_weights(spari_accelerator *a) {
    return a->stretch;
}

void spari_accelerator_free(spari_accelerator **accelerator) {
    spari_accelerator *a = accelerator ? *accelerator : NULL;
    if (!a) {
        return;
    }
    SPARI_FREE(a->x, a->g, a->change, a->response, a->column, a->p, a->y, a->b, a->axes, a->stretch, a->lead, a->last,
               a->base, a->basis, a->loads, a->images, a->matrix, a->alpha, a->slots, a->combinations, a->left);
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

/* The step's first loads determine the weights; loads that exceed them tenfold determine new ones. */
static void set_weights(spari_accelerator *a, const double *x, const double *g) {
    double size[2];
    measure_kinds(a, x, g, size);
    if (a->iteration > 1 && size[0] <= 10 * a->size[0] && size[1] <= 10 * a->size[1]) {
        return;
    }
    for (int k = 0; k < 2; k++) {
        a->size[k] = size[k];
        a->weight[k] = 1 / size[k];
    }
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

static const spari_coupling_scheme
    scheme_explicit = {.name = "explicit"},
    scheme_fixed_point = {.name = "fixed point", .iterates = 1},
    scheme_aitken = {.name = "Aitken", .iterates = 1, .begin = aitken_begin, .learn = aitken_learn},
    scheme_iqn_ils = {
        .name = "IQN-ILS", .iterates = 1, .columns = 1, .learn = spari_iqn_ils_learn, .next = spari_iqn_ils_next};

const spari_coupling_scheme *spari_coupling_scheme_of(int scheme) {
#define SPARI_SCHEME(number, name) [SPAR_COUPLING_##number] = &scheme_##name,
    static const spari_coupling_scheme *const table[] = {SPARI_SCHEMES(SPARI_SCHEME)};
#undef SPARI_SCHEME
    return table[scheme];
}

/* ---- the step ---- */

void spari_accelerator_begin(spari_accelerator *a, double dt) {
    a->dt = dt;
    spari_accelerator_set_rates(a, 1 / dt, 1 / dt);
    a->iteration = 0;
    a->used = a->stalled = a->filtered = 0;
    a->cut = 0;
    a->led = a->ended;
    a->ratio = 0;
    a->ratios = (spari_ratios){0};
    a->most_weight = 0;
    spari_poison(a->change, a->change ? 2 * a->n : 0);
    spari_poison(a->response, 2 * a->n);
    a->omega = a->set.omega;
    if (a->scheme->begin) {
        a->scheme->begin(a);
    }
}

void spari_accelerator_set_rates(spari_accelerator *a, double rate, double acceleration) {
    a->per[SPARI_ACCELERATION] = rate * acceleration;
    a->per[SPARI_CHANGE_OF_VELOCITY] = rate / a->dt;
    a->per[SPARI_VELOCITY] = rate;
}

/* Sum of a and b with weights multiplied by p and q. */
static spari_ratios join(const spari_ratios *a, double p, const spari_ratios *b, double q) {
    return (spari_ratios){p * a->weight + q * b->weight, p * p * a->square + q * q * b->square, p * a->sum + q * b->sum,
                          p * a->sum2 + q * b->sum2};
}

/* -dx.dg / dx.dx of the last two iterations. The motion due to dx is `moved` minus `part` (NULL: 0); moved NULL: the
   load norm. */
static void estimate_ratio(spari_accelerator *a, const double *moved, const double *part) {
    double product = 0, square = 0;
    for (int64_t i = 0; i < a->n; i++) {
        double w = a->weight[i % a->period >= a->split], dg = a->change[a->n + i], dx = dg - a->change[i];
        double response = moved ? moved[i] - (part ? part[i] : 0) : w * w * dx;
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

/* In another norm an iteration begins anew: differences of the two have no meaning. */
static void set_norm(spari_accelerator *a, int imaged) {
    if (imaged != a->imaged) {
        a->led = a->led && a->iteration == 0;
        a->iteration = a->used = 0;
        a->ratios = a->ratios_before = (spari_ratios){0};
        a->most_weight = 0;
    }
    a->imaged = imaged;
}

int spari_accelerator_imaged(const spari_accelerator *a) {
    return a->imaged;
}

/* Changes since the iteration before. */
static void note_change(spari_accelerator *a, const double *x, const double *g) {
    for (int64_t i = 0; i < a->n; i++) {
        a->change[a->n + i] = g[i] - a->g[i];
        a->change[i] = a->change[a->n + i] - (x[i] - a->x[i]);
    }
}

/* Differences since the iteration before. They are mapped with the current flexibility. Differencing two mapped
   loads would difference flexibilities times the full loads, which may be much larger. */
static int learn(spari_accelerator *a, const double *x, const double *g, const spari_images *images) {
    note_change(a, x, g);
    if (!a->imaged || !images) {
        estimate_ratio(a, NULL, NULL);
    } else if (a->scheme->columns) {
        estimate_ratio(a, images->moved, NULL);
        double *dx = a->response;
        for (int64_t i = 0; i < a->n; i++) {
            dx[i] = x[i] - a->x[i];
        }
        return spari_fluid_secants_learn(a, dx, images);
    } else {
        SPARI_TRY(images->of(images->context, 2, a->change, a->response));
        estimate_ratio(a, a->response + a->n, a->response);
    }
    if (a->scheme->learn) {
        a->scheme->learn(a);
    }
    return SPAR_OK;
}

int spari_accelerator_next(spari_accelerator *a, const double *x, const double *g, const spari_images *images,
                           double *next) {
    set_norm(a, images && a->set.imaged);
    a->iteration++;
    set_weights(a, x, g);
    if (a->iteration > 1) {
        SPARI_TRY(learn(a, x, g, images));
    } else if (a->led) {
        for (int64_t i = 0; i < a->n; i++) {
            a->lead[i] = g[i] - a->last[i];
        }
    }
    if (a->n == 0) {
        return SPAR_OK;
    }
    memcpy(a->x, x, (size_t)a->n * sizeof *x);
    memcpy(a->g, g, (size_t)a->n * sizeof *g);
    if (a->imaged && a->scheme->columns) {
        return spari_fluid_secants_next(a, images, next);
    }
    compute_next(a, a->x, a->g, next);
    return SPAR_OK;
}

void spari_accelerator_end(spari_accelerator *a, const double *x, const double *g, const spari_images *images) {
    if (a->iteration > 0 && a->imaged) {
        note_change(a, x, g);
        estimate_ratio(a, images->moved, NULL);
        spari_fluid_secants_end(a, images);
    }
}

void spari_accelerator_accept(spari_accelerator *a, const double *g) {
    static const double FADE = 0.8;
    spari_columns_accept(a);
    spari_fluid_secants_accept(a);
    if (a->iteration > 1) {
        a->omega_accepted = a->omega;
    }
    a->ratios_before = all_ratios(a, FADE);
    a->ratios = (spari_ratios){0};
    a->most_weight = 0;
    a->ended = g && a->set.imaged && a->scheme->columns;
    if (a->ended) {
        memcpy(a->last, g, (size_t)a->n * sizeof *g);
    }
    a->accepted.imaged = a->imaged, a->accepted.drifts = a->drifts;
    a->accepted.ratios = a->ratios_before;
    a->accepted.memory = a->memory;
    a->used = 0;
    a->step++;
}

void spari_accelerator_reject(spari_accelerator *a) {
    spari_columns_reject(a);
    a->ratios = (spari_ratios){0};
    a->most_weight = 0;
    a->imaged = a->accepted.imaged, a->drifts = a->accepted.drifts;
    a->ratios_before = a->accepted.ratios;
    a->memory = a->accepted.memory;
    a->used = 0;
    a->iteration = 0;
}

void spari_accelerator_forget(spari_accelerator *a) {
    a->count = 0;
    a->omega_accepted = 0;
    a->ratios = a->ratios_before = a->accepted.ratios = (spari_ratios){0};
    a->most_weight = 0;
    a->used = 0;
}

int spari_accelerator_columns(const spari_accelerator *a) {
    return a->used;
}

int spari_accelerator_dropped(const spari_accelerator *a) {
    return a->stalled + a->filtered;
}

double spari_accelerator_ratio(const spari_accelerator *a) {
    return a->ratio;
}

double spari_accelerator_carried_over(const spari_accelerator *a) {
    return spari_rho_of(a);
}

double spari_accelerator_limited_rotation(const spari_accelerator *a) {
    return a->imaged && a->cut > 0 ? a->memory.reach / a->cut : 0;
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
