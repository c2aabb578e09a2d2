/* What generalised-alpha is for every member: see scheme.h. */
#include "scheme.h"

#include "../base/scene.h"
#include "../member/added.h"
#include "../member/body.h"
#include "drive.h"

#include <math.h>
#include <string.h>

enum { START_PASSES = 4, LEAP_PASSES = 2, SPAN = 4096 };

spari_scheme spari_scheme_of(const spar_member *member, int damped, double h) {
    double rho = member->session->rho_inf;
    spari_scheme c = {.h = h};
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
    spari_member_gather(member, member->load_history[0], steps->load0);
    spari_member_gather(member, member->load_used, steps->load1);
    spari_member_gather(member, member->dead, steps->load);
    spari_crew_spread(member->session->crew, 6 * (int64_t)member->body->unique, SPAN, add_dead, steps);
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

void spari_scheme_begin_added(const spar_member *m, double s, double *load) {
    if (m->added && s < 1) {
        (void)spari_added_times(m, SPARI_NODES, SPARI_UNKNOWNS, m->now.a, 1 - s, load);
    }
}

/* A much larger step gets no more than four times the distance: it is mostly what an unresolved part left there. */
double spari_scheme_ratio(double before, double h) {
    return before > 0 && h != before ? fmin(h / before, 4) : 1;
}

/* Below, what rho_inf = 0.9 takes out in a step is more than what a longer one brings: 1.05^2 0.9 < 1. */
int spari_scheme_leaps(double before, double h) {
    return before > 0 && h > 1.05 * before;
}

static int start_once(const spari_integrand *how, void *self, spari_steps *t, spar_member *m, const spari_scheme *c) {
    if (!t->started && !c->still) {
        SPARI_TRY(how->start(self, m, c));
        t->started = 1;
    }
    return SPAR_OK;
}

int spari_scheme_balance(const spari_integrand *how, void *self, spari_steps *t, spar_member *m, double dt) {
    const spari_scheme c = spari_scheme_of(m, 0, dt / m->session->substeps);
    SPARI_TRY(start_once(how, self, t, m, &c));
    (void)how->begin(self);
    return SPAR_OK;
}

int spari_scheme_advance(const spari_integrand *how, void *self, spari_steps *t, int loads, spar_member *m, int damped,
                         double dt) {
    int substeps = m->session->substeps;
    const spari_scheme c = spari_scheme_of(m, damped, dt / substeps);
    SPARI_TRY(start_once(how, self, t, m, &c));
    spari_part part = {.root = m->drive[0], .ratio = spari_scheme_ratio(t->h_begin, c.h)};
    part.leaps = !c.still && spari_scheme_leaps(t->h_begin, c.h);
    t->h_solved = c.h;
    m->dissipated_step = 0;
    double before, power = how->begin(self);
    for (int k = 1; k <= substeps; k++) {
        part.s = (double)k / substeps;
        part.before = part.root;
        part.root = spari_drive_at(m, part.s, dt);
        spari_crew_spread(m->session->crew, loads, SPAN, mix_loads, &(loads_within){t, part.s});
        spari_scheme_begin_added(m, part.s, t->load);
        before = power;
        SPARI_TRY(how->substep(self, m, &c, &part, &power));
        m->dissipated_step += 0.5 * c.h * (before + power);
        part.ratio = 1;
        part.leaps = 0;
    }
    return SPAR_OK;
}

void spari_scheme_stretch(double ratio, int n, const double *a, double *b) {
    for (int i = 0; i < n && ratio != 1; i++) {
        b[i] = a[i] + ratio * (b[i] - a[i]);
    }
}

void spari_scheme_predict(const spari_scheme *c, spari_guess stays, int n, spari_rates from, double *x,
                          spari_rates to) {
    double h = c->h;
    for (int k = 0; k < n; k++) {
        double b = from.b[k], a = from.a[k], v = from.v[k], next;
        if (stays == SPARI_KEEP_ACCELERATION) {
            to.a[k] = a;
            next = (a - c->alpha_m * b) / (1 - c->alpha_m);
        } else { /* the b that makes x = h v or 0, and the a that goes with it */
            next = (1 - 0.5 / c->beta) * b - (stays == SPARI_KEEP_PLACE ? v / (h * c->beta) : 0);
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

int spari_scheme_start(const spari_scheme *c, spari_linear *A, int held, int n, spari_forces unbalance, void *self,
                       const spar_member *m, double *r, double *a) {
    for (int pass = 0; pass < START_PASSES; pass++) {
        unbalance(self, m, a, r);
        memset(r, 0, (size_t)held * sizeof *r);
        if (spari_linear_solve(A, r)) {
            return 1;
        }
        for (int i = held; i < n; i++) {
            a[i] -= c->cm * r[i];
        }
    }
    return 0;
}

int spari_scheme_filter(const spari_scheme *c, const spari_filter *how, void *self) {
    for (int pass = 0; pass < LEAP_PASSES; pass++) {
        how->push(self);
        if (how->solve(self)) {
            return 1;
        }
        how->take(self, c->cm);
    }
    return 0;
}

typedef struct filtered {
    spari_linear *A;
    int held, n;
    spari_forces times_mass;
    void *self;
    const spar_member *member;
    double *r, *y;
} filtered;

static void push_vector(void *self) {
    const filtered *f = self;
    f->times_mass(f->self, f->member, f->y, f->r);
    memset(f->r, 0, (size_t)f->held * sizeof *f->r);
}

static int solve_vector(void *self) {
    const filtered *f = self;
    return spari_linear_solve(f->A, f->r);
}

static void take_vector(void *self, double by) {
    const filtered *f = self;
    for (int i = 0; i < f->n; i++) {
        f->y[i] -= by * f->r[i];
    }
}

int spari_scheme_filter_vector(const spari_scheme *c, spari_linear *A, int held, int n, spari_forces times_mass,
                               void *self, const spar_member *m, double *r, double *y) {
    static const spari_filter how = {push_vector, solve_vector, take_vector};
    filtered f = {A, held, n, times_mass, self, m, r, y};
    return spari_scheme_filter(c, &how, &f);
}
