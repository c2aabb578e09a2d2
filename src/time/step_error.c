/* The local error of a time step: see step_error.h. */
#include "step_error.h"

#include "../base/session.h"
#include "../math/rotation.h"
#include "fidelity.h"

#include <math.h>
#include <string.h>

/* Velocity and acceleration of node i. For a member with a driven root: relative to the root, in its axes. */
static void rates_from_root(const spar_member *m, const spari_motion *x, int64_t i, double v[6], double a[6]) {
    memcpy(v, x->v + 6 * i, 6 * sizeof *v);
    memcpy(a, x->a + 6 * i, 6 * sizeof *a);
    if (m->root != SPAR_ROOT_DRIVEN) {
        return;
    }
    const double *W = x->v + 3, *A = x->a + 3;
    double d[3], c[3], w[3];
    for (int k = 0; k < 3; k++) {
        d[k] = m->xr[3 * i + k] + x->q[7 * i + k] - m->xr[k] - x->q[k];
        v[k] -= x->v[k];
        a[k] -= x->a[k];
    }
    spari_cross(W, d, c);
    for (int k = 0; k < 3; k++) {
        v[k] -= c[k];
        w[k] = c[k] + 2 * v[k];
    }
    spari_cross(W, w, c);
    spari_cross(A, d, w);
    for (int k = 0; k < 3; k++) {
        a[k] -= c[k] + w[k];
    }
    spari_rotate_back(x->q + 3, v, v);
    spari_rotate_back(x->q + 3, a, a);
}

int spari_step_error_applies(const spar_member *m) {
    return m->row->solved && m->row->moves && (m->effects & SPAR_EFFECT_INERTIA) != 0;
}

/* Sums of squares over nodes, in parts of `span`. */
enum { PARTS = 32, LEAST = 256 };
typedef struct change_sums {
    const spar_member *m;
    int64_t span;
    double length;
    spari_step_change part[PARTS];
} change_sums;

static void add_changes(void *context, int64_t from, int64_t to) {
    change_sums *t = context;
    const spar_member *m = t->m;
    double v[6], a[6], v0[6], a0[6];
    spari_step_change sum = {0, 0};
    for (int64_t i = from; i < to; i++) {
        rates_from_root(m, &m->now, i, v0, a0);
        rates_from_root(m, &m->after, i, v, a);
        for (int k = 0; k < 6; k++) {
            double weight = k < 3 ? 1 : t->length * t->length;
            sum.change += weight * (a[k] - a0[k]) * (a[k] - a0[k]);
            sum.speed += weight * v[k] * v[k];
        }
    }
    t->part[from / t->span] = sum;
}

spari_step_change spari_step_change_of(const spar_member *m) {
    int64_t nodes = m->nodes, span = (nodes + PARTS - 1) / PARTS;
    change_sums t = {.m = m, .span = span < LEAST ? LEAST : span};
    t.length = m->nodes == 1 ? spari_member_length(m) : 0;
    spari_thread_pool_spread(m->session->pool, nodes, t.span, add_changes, &t);
    spari_step_change sum = t.part[0];
    for (int64_t k = 1; k * t.span < nodes; k++) {
        sum.change += t.part[k].change;
        sum.speed += t.part[k].speed;
    }
    double count = (double)nodes;
    return (spari_step_change){sqrt(sum.change / count), sqrt(sum.speed / count)};
}

int spari_step_error_is_known(const spar_session *s) {
    return s->clock.step > 0 || (s->members && s->members->initial.acceleration);
}

double spari_step_error(const spari_scheme *c, double change) {
    return fabs(spari_scheme_error(c)) * c->h * c->h * change;
}
