/* Generalised-alpha and TR-BDF2 for every member: see scheme.h. */
#include "scheme.h"

#include "../base/session.h"
#include "../member/added_mass.h"
#include "../member/applied_loads.h"
#include "../member/body.h"
#include "driven_root.h"

#include <math.h>
#include <string.h>

enum { SPAN = 4096 };

spari_scheme spari_scheme_of(const spar_member *member, int damped, double h) {
    double rho = member->session->integrator.rho_inf;
    spari_scheme c = {.rule = SPARI_ALPHA, .h = h, .span = h};
    c.alpha_m = (2 * rho - 1) / (rho + 1);
    c.alpha_f = rho / (rho + 1);
    c.gamma = 0.5 + c.alpha_f - c.alpha_m;
    c.beta = 0.25 * (0.5 + c.gamma) * (0.5 + c.gamma);
    c.still = !(member->effects & SPAR_EFFECT_INERTIA);
    if (c.still) {
        c.rate = 1 / h;
        c.cm = 0, c.cv = damped ? c.rate : 0;
    } else {
        c.cm = (1 - c.alpha_m) / (h * h * c.beta * (1 - c.alpha_f));
        c.rate = c.cv = c.gamma / (h * c.beta);
    }
    c.cb = c.cm * (1 - c.alpha_f) / (1 - c.alpha_m);
    return c;
}

static void add_dead(void *context, int64_t from, int64_t to) {
    const spari_steps *t = context;
    for (int64_t i = from; i < to; i++) {
        t->load0[i] += t->load[i];
        t->load1[i] += t->load[i];
    }
}

void spari_scheme_loads(const spar_member *member, spari_steps *steps) {
    const int64_t n = 6 * (int64_t)member->body->unique;
    const double *before = spari_dead_before(member);
    spari_member_gather(member, member->load.history[0], steps->load0);
    spari_member_gather(member, member->load.used, steps->load1);
    spari_member_gather(member, member->load.dead, steps->load);
    if (before == member->load.dead) {
        spari_thread_pool_spread(member->session->pool, n, SPAN, add_dead, steps);
        return;
    }
    for (int64_t i = 0; i < n; i++) {
        steps->load1[i] += steps->load[i];
    }
    spari_member_gather(member, before, steps->load);
    for (int64_t i = 0; i < n; i++) {
        steps->load0[i] += steps->load[i];
    }
}

/* Gravity and applied loads at this time of a step. */
static void applied_at(const spar_member *m, double left) {
    const spar_session *s = m->session;
    spari_applied_at(m, left);
    if (m->body && (m->effects & SPAR_EFFECT_GRAVITY) && spari_gravity_changes(s)) {
        for (int k = 0; k < 3; k++) {
            m->body->gravity[k] = s->gravity[k] + left * (s->gravity_before[k] - s->gravity[k]);
        }
    }
}

/* Loads at the part s of a step. */
typedef struct loads_within {
    const spari_steps *t;
    double s;
} loads_within;

static void mix_loads(void *context, int64_t from, int64_t to) {
    const loads_within *w = context;
    const spari_steps *t = w->t;
    for (int64_t i = from; i < to; i++) {
        t->load[i] = (1 - w->s) * t->load0[i] + w->s * t->load1[i];
    }
}

void spari_scheme_mix_loads(const spar_member *m, const spari_steps *t, int loads, double s) {
    applied_at(m, 1 - s);
    spari_thread_pool_spread(m->session->pool, loads, SPAN, mix_loads, &(loads_within){t, s});
    if (m->added && s < 1) {
        (void)spari_added_times(m, SPARI_NODES, SPARI_UNKNOWNS, m->now.a, 1 - s, t->load);
    }
}

void spari_scheme_dissipate(spar_member *m, const spari_scheme *c, double *before, double power) {
    m->state.dissipated_step += 0.5 * c->h * (*before + power);
    *before = power;
}

/* ---- substeps and stages ---- */

/* TR-BDF2: w; c is SPARI_STAGE, d is SPARI_DIAGONAL. */
#define WEIGHT (0.25 * M_SQRT2)

spari_scheme spari_scheme_stage(const spari_scheme *alpha, spari_rule rule) {
    spari_scheme c = *alpha;
    double g = SPARI_DIAGONAL * c.h;
    c.rule = rule;
    c.span = rule == SPARI_TRAPEZOIDAL ? SPARI_STAGE * c.h : c.h;
    if (c.still) {
        c.rate = 1 / c.span;
        c.cv = c.cv > 0 ? c.rate : 0;
    } else {
        c.cm = c.cb = 1 / (g * g);
        c.rate = c.cv = 1 / g;
    }
    return c;
}

spari_scheme spari_scheme_last(const spar_member *m, int damped, const spari_pattern *pattern) {
    const spari_scheme c = spari_scheme_of(m, damped, pattern->h);
    return pattern->even < SPARI_EVEN && !c.still ? spari_scheme_stage(&c, SPARI_BACKWARD) : c;
}

void spari_mean_rotation(int64_t n, const double *v, double w[3]) {
    memset(w, 0, 3 * sizeof *w);
    for (int64_t i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++) {
            w[k] += v[6 * i + 3 + k] / (double)n;
        }
    }
}

int spari_member_rotates_stiffly(const spar_member *m) {
    return m->body && m->fidelity != SPAR_FIDELITY_RIGID && m->body->unique > 1 && !spari_member_root_is_prescribed(m);
}

spari_scheme spari_scheme_resize(const spari_scheme *alpha, double h) {
    spari_scheme c = *alpha;
    double r = alpha->h / h;
    c.h = c.span = h;
    c.cm *= r * r, c.cb *= r * r;
    c.cv *= r, c.rate *= r;
    return c;
}

void spari_scheme_stretch(double ratio, int n, const double *a, double *b) {
    for (int i = 0; i < n && ratio > 0 && ratio != 1; i++) {
        b[i] = a[i] + ratio * (b[i] - a[i]);
    }
}

/* b^n = a^n + (alpha_m - alpha_f) h a', with a' from the change of a over the step. For motions that the step does
   not resolve this change is arbitrary. With a factor up to 0.8 it excites nothing after two steps of TR-BDF2, for
   any rho_inf (tests/stability/random_steps.c). */
void spari_scheme_restart(const spari_scheme *c, int n, const double *a0, const double *a, double *b) {
    double f = fmax(c->alpha_m - c->alpha_f, -0.8);
    for (int i = 0; i < n; i++) {
        b[i] = a[i] + f * (a[i] - a0[i]);
    }
}

/* Starting values of a stage of TR-BDF2: v = v_h + g a and x = x_h + g v, with v_h and x_h of what is known. */
static void predict_stage(const spari_scheme *c, spari_guess stays, int n, spari_rates from, double *x,
                          spari_rates to) {
    const double h = c->h, g = 1 / c->rate;
    for (int k = 0; k < n; k++) {
        double v0 = from.v[k], a0 = from.a[k], v = v0 + g * a0, p = g * v0, a = a0;
        if (c->rule == SPARI_BACKWARD) {
            double as = from.b[k];
            v = v0 + h * WEIGHT * (a0 + as);
            p = h * WEIGHT * (v0 + from.stage[k]);
            a = as + (1 - SPARI_STAGE) / SPARI_STAGE * (as - a0);
        }
        if (stays != SPARI_KEEP_ACCELERATION) {
            double way = stays == SPARI_KEEP_POSITION ? 0 : c->span * v0;
            a = ((way - p) / g - v) / g;
        }
        to.a[k] = to.b[k] = a;
        to.v[k] = v + g * a;
        x[k] = p + g * to.v[k];
    }
}

void spari_scheme_predict(const spari_scheme *c, spari_guess stays, int n, spari_rates from, double *x,
                          spari_rates to) {
    double h = c->h;
    if (c->rule != SPARI_ALPHA) {
        predict_stage(c, stays, n, from, x, to);
        return;
    }
    for (int k = 0; k < n; k++) {
        double b = from.b[k], a = from.a[k], v = from.v[k], next;
        if (stays == SPARI_KEEP_ACCELERATION) {
            to.a[k] = a;
            next = (a - c->alpha_m * b) / (1 - c->alpha_m);
        } else { /* the b for which x = h v or 0, and the corresponding a */
            next = (1 - 0.5 / c->beta) * b - (stays == SPARI_KEEP_POSITION ? v / (h * c->beta) : 0);
            to.a[k] = ((1 - c->alpha_m) * next + c->alpha_m * b - c->alpha_f * a) / (1 - c->alpha_f);
        }
        x[k] = h * v + h * h * ((0.5 - c->beta) * b + c->beta * next);
        to.v[k] = v + h * ((1 - c->gamma) * b + c->gamma * next);
        to.b[k] = next;
    }
}

void spari_scheme_correct(const spari_scheme *c, double cut, int n, const double *dx, double *x, spari_rates to) {
    const double rate = c->rate, cm = c->cm, cb = c->cb;
    for (int k = 0; k < n; k++) {
        double step = -cut * dx[k];
        x[k] += step;
        to.v[k] += rate * step;
        to.a[k] += cm * step;
        to.b[k] += cb * step;
    }
}
