/* The solver of one body: arrays, the reused tangent, saved state. */
#include "body_solver.h"

#include "../base/poison.h"
#include "../base/session.h"
#include "../math/rotation.h"
#include "../member/added_mass.h"
#include "../member/applied_loads.h"
#include "../member/plane.h"
#include "steady_rotation.h"

#include <stdlib.h>
#include <string.h>

spari_state spari_state_in(double *block, int n) {
    double *v = block + 7 * (int64_t)n, *a = v + 6 * (int64_t)n;
    return (spari_state){block, v, a, a + 6 * (int64_t)n};
}

spari_solver *spari_solver_create(const spar_member *member, const spari_body *body, spari_offset_loads *offset_loads) {
    int64_t n = body->unique, m = 6 * (int64_t)body->per_element;
    spari_solver *s = spari_zalloc(1, sizeof *s);
    if (!s) {
        return NULL;
    }
    s->body = body, s->offset_loads = offset_loads;
    s->n = body->unique;
    int ok = 1;
    for (int k = 0; k < 3; k++) {
        ok = ok && (s->block[k] = spari_zalloc(25 * n, sizeof(double))) != NULL;
    }
    double **sixes[] = {&s->increment, &s->steps.load, &s->steps.load0, &s->steps.load1, &s->r, &s->dx, &s->stage_v};
    for (size_t k = 0; k < sizeof sixes / sizeof *sixes; k++) {
        ok = ok && (*sixes[k] = spari_zalloc(spari_mixed_unknowns(n), sizeof(double))) != NULL;
    }
    ok = ok && (s->tinv = spari_zalloc(9 * n, sizeof(double))) != NULL;
    ok = ok && (s->tangent_q = spari_zalloc(4 * n, sizeof(double))) &&
         (s->rotation = spari_zalloc(4 * n, sizeof(double)));
    ok = ok && (s->best = spari_zalloc(7 * n, sizeof(double)));
    const int64_t spans = (n + SPARI_SPAN - 1) / SPARI_SPAN;
    ok = ok && (s->most = spari_zalloc(2 * spans, sizeof(double)));
    s->most_by = ok ? s->most + spans : NULL;
    if (n > 1) { /* the forces of one node cost less than to compare states */
        ok = ok && (s->start.state = spari_zalloc(25 * n, sizeof(double)));
        s->start.forces = ok ? s->start.state + 19 * n : NULL;
    }
    ok = ok && (s->anderson = spari_anderson_create(n));
    ok = ok && (s->linear = spari_linear_create(body->elements, (int)m, 6));
    ok = ok && !spari_linear_weigh(s->linear, body->length > 0 ? 1 / body->length : 1);
    if (!ok) {
        spari_solver_free(s);
        return NULL;
    }
    for (int k = 0; k < 2 && member->root == SPAR_ROOT_DRIVEN && (member->effects & SPAR_EFFECT_INERTIA); k++) {
        double *block = spari_zalloc(25 * n, sizeof *block);
        if (!block) {
            spari_solver_free(s);
            return NULL;
        }
        s->own[k] = spari_state_in(block, s->n);
    }
    spari_linear_share(s->linear, body->pool);
    s->begin = spari_state_in(s->block[0], s->n);
    s->from = spari_state_in(s->block[1], s->n);
    s->to = spari_state_in(s->block[2], s->n);
    return s;
}

void spari_solver_free(spari_solver *s) {
    if (!s) {
        return;
    }
    for (int k = 0; k < 3; k++) {
        free(s->block[k]);
    }
    free(s->own[0].q);
    free(s->own[1].q);
    free(s->increment);
    free(s->steps.load);
    free(s->steps.load0);
    free(s->steps.load1);
    free(s->r);
    free(s->dx);
    free(s->stage_v);
    free(s->tinv);
    free(s->tangent_q);
    free(s->rotation);
    free(s->best);
    free(s->mixed.q);
    free(s->start.state);
    free(s->most);
    spari_anderson_free(s->anderson);
    spari_linear_free(s->linear);
    spari_condensed_free(s->condensed);
    spari_snapshot_free(&s->before);
    free(s);
}

void spari_solver_restart(spari_solver *s) {
    memcpy(s->begin.b, s->begin.a, (size_t)(6 * s->n) * sizeof *s->begin.b);
    memcpy(s->to.q, s->begin.q, (size_t)(25 * s->n) * sizeof *s->to.q);
    s->steps.started = 0;
    s->steps.begin = (spari_pattern){0, SPARI_EVEN};
    s->power = s->power_begin = 0;
}

/* ---- mixed integration points ---- */

static int64_t mixed_size(const spari_solver *s) {
    return 13 * (int64_t)s->n + 6 * (int64_t)s->body->slot[s->body->elements];
}

void spari_solver_mix(spari_solver *s, int on) {
    spari_mixed_points *m = &s->mixed;
    if (on && !m->q && (m->q = spari_zalloc(mixed_size(s), sizeof *m->q))) {
        m->dx = m->q + 7 * (int64_t)s->n;
        m->strain = m->dx + 6 * (int64_t)s->n;
    }
    m->on = on && m->q;
    m->part = 0;
    if (m->on) {
        memcpy(m->q, s->from.q, (size_t)(7 * s->n) * sizeof *m->q);
        memset(m->dx, 0, (size_t)(6 * s->n) * sizeof *m->dx);
    }
}

void spari_solver_remember_correction(spari_solver *s, const double *q, const double *rotation) {
    spari_mixed_points *m = &s->mixed;
    memcpy(m->q, q, (size_t)(7 * s->n) * sizeof *m->q);
    memcpy(m->dx, s->dx, (size_t)(6 * s->n) * sizeof *m->dx);
    m->part = 1;
    for (int i = 0; i < 6 * s->n && rotation; i += 3) {
        spari_rotate(rotation + 4 * (i / 6), m->dx + i, m->dx + i);
    }
}

void spari_solver_poison(spari_solver *s) {
    double *const sixes[] = {s->increment, s->steps.load, s->r, s->dx, s->stage_v};
    int64_t n = s->n, spans = (n + SPARI_SPAN - 1) / SPARI_SPAN, block = 6 * (int64_t)s->body->per_element;
    for (size_t k = 0; k < sizeof sixes / sizeof *sixes; k++) {
        spari_poison(sixes[k], 6 * n); /* vectors also read the numbers behind, which are zero */
    }
    spari_poison(s->tinv, 9 * n);
    spari_poison(s->rotation, 4 * n);
    spari_poison(s->best, 7 * n);
    spari_poison(s->most, 2 * spans);
    spari_poison(s->to.q, 25 * n);
    spari_poison(s->own[0].q, 25 * n);
    spari_poison(s->own[1].q, 25 * n);
    spari_poison(s->mixed.q, s->mixed.q ? mixed_size(s) : 0);
    spari_poison(spari_body_matrix(s->body), block * block);
}

void spari_solver_begin(spari_solver *s) {
    s->begun = (spari_reuse){s->factored, s->tangent_cm, s->tangent_cv, s->reuse, s->left};
    spari_snapshot_open(&s->before, 1);
    s->start.known = 0;
}

static int64_t before_size(const spari_solver *s) {
    return 4 * (int64_t)s->n + spari_linear_state_size(s->linear) +
           (s->condensed ? spari_condensed_state_size(s->condensed) : 0);
}

/* Saves the factors before they are overwritten. */
static void keep_factors(spari_solver *s) {
    int64_t own = 4 * (int64_t)s->n, factors = spari_linear_state_size(s->linear);
    double *to = s->begun.factored ? spari_snapshot_take(&s->before, before_size(s)) : NULL;
    if (to) {
        memcpy(to, s->tangent_q, (size_t)own * sizeof *to);
        spari_linear_save(s->linear, to + own);
        if (s->condensed) {
            spari_condensed_save(s->condensed, to + own + factors);
        }
    }
}

void spari_solver_reject(spari_solver *s) {
    const spari_reuse *b = &s->begun;
    if (!s->before.open) {
        return;
    }
    s->factored = b->factored && s->before.saved >= 0;
    s->tangent_cm = b->cm, s->tangent_cv = b->cv;
    s->reuse = b->tangent;
    s->left = b->left;
    if (s->before.saved > 0) {
        const double *from = s->before.data, *factors = from + 4 * (int64_t)s->n;
        memcpy(s->tangent_q, from, (size_t)(4 * s->n) * sizeof *from);
        spari_linear_load(s->linear, factors);
        if (s->condensed) {
            spari_condensed_load(s->condensed, s->condensed->fixed, factors + spari_linear_state_size(s->linear));
        }
    }
}

void spari_solver_accept(spari_solver *s) {
    spari_snapshot_close(&s->before);
    spari_state t = s->begin;
    s->begin = s->to;
    s->to = t;
    s->steps.begin = s->steps.solved;
    s->power_begin = s->power;
}

/* The data from which the tangents of elements are formed. */
typedef struct tangent_state {
    const spari_solver *s;
    const spar_member *member;
    const spari_tangent_at *at;
} tangent_state;

static void add_tangents(const spari_body *body, int tile, int from, int to, void *context) {
    const tangent_state *state = context;
    const spari_tangent_at *t = state->at;
    const spari_solver *s = state->s;
    const spar_member *m = state->member;
    const double *normal = spari_member_plane(m);
    double *matrix = spari_body_matrix(body);
    (void)tile;
    for (int e = from; e < to; e++) {
        if (t->rotation) {
            spari_steady_rotation_tangent(body, t->rotation, e, t->q, t->v, t->a, t->factor, matrix, t->mass);
        } else {
            spari_body_tangent(body, e, t->q, t->v, t->a, t->factor, t->cm, t->cv, t->tinv, matrix);
        }
        if (spari_solver_has_applied(s, m) && t->factor != 0) {
            spari_applied_tangent(m, e, t->q, t->factor, matrix);
        }
        if (s->offset_loads && t->factor != 0) {
            spari_offset_loads_tangent(s->offset_loads, t->q + 3, matrix);
        }
        if (t->tinv && m->added) { /* part of the balance of a step, not of the initial one */
            spari_added_tangent(m, e, t->cm, t->tinv, matrix);
        }
        if (normal) {
            spari_plane_tangent(normal, body->per_element, matrix);
        }
        spari_linear_add(s->linear, e, matrix);
    }
}

/* Forms the tangent with separate columns of the interface nodes, and with the root condition. */
void spari_solver_form(spari_solver *s, const spar_member *member, const spari_tangent_at *at) {
    tangent_state t = {s, member, at};
    int end = spari_member_constrained(member);
    keep_factors(s);
    s->factored = 0;
    spari_linear_zero(s->linear);
    if (at->rotation) { /* no threads: there is only one `mass` */
        add_tangents(s->body, 0, 0, s->body->elements, &t);
    } else {
        spari_body_sweep(s->body, add_tangents, &t);
    }
    if (s->condensed) {
        spari_condensed_take(s->condensed, s->linear, end);
    }
    for (int i = 0; i < end; i++) {
        spari_linear_fix(s->linear, i);
    }
}

int spari_solver_factor(spari_solver *s, const spar_member *member, const spari_tangent_at *at) {
    spari_solver_form(s, member, at);
    s->factors++;
    if (spari_linear_factor(s->linear) || (s->condensed && spari_condensed_form(s->condensed, s->linear))) {
        return 1;
    }
    s->factored = 1;
    s->tangent_cm = at->cm, s->tangent_cv = at->cv;
    for (int i = 0; i < s->n; i++) {
        memcpy(s->tangent_q + 4 * i, at->q + 7 * i + 3, 4 * sizeof *at->q);
    }
    return 0;
}

void spari_solver_effort(const spari_solver *s, spari_effort *e) {
    const spari_body *b = s->body;
    *e = (spari_effort){.iterations = s->newton,
                        .tangents = s->factors,
                        .left = s->left,
                        .nodes = b->unique,
                        .elements = b->elements,
                        .per_element = b->per_element,
                        .points = b->first[b->elements],
                        .unknowns = 6 * b->unique,
                        .band = spari_effort_band(6 * b->unique, 6 * b->per_element)};
}

/* Per node: 25 doubles at either end of the step, and 4 for the rotation at the reused tangent; 9 with which a
   tangent is formed. */
enum { STATE_HEAD = 17, STATE_NODE = 54, STATE_OPERATOR = 9, STATE_BEGUN = 7 };

/* The factors, or, if there are none, the data from which those for a response are formed. */
static int64_t tangent_size(const spari_solver *s, int factored) {
    return factored ? spari_linear_state_size(s->linear) : STATE_OPERATOR * (int64_t)s->n;
}

int64_t spari_solver_state_size(const spari_solver *s) {
    return STATE_HEAD + STATE_NODE * (int64_t)s->n + tangent_size(s, s->factored) + STATE_BEGUN +
           spari_snapshot_size(&s->before);
}

void spari_solver_save(const spari_solver *s, double *state) {
    const double head[STATE_HEAD] = {s->n,
                                     s->factored,
                                     s->tangent_cm,
                                     s->tangent_cv,
                                     s->steps.begin.h,
                                     s->steps.solved.h,
                                     s->steps.started,
                                     (double)s->newton,
                                     (double)s->factors,
                                     s->power,
                                     s->power_begin,
                                     s->steps.begin.even,
                                     (double)s->reuse.served,
                                     (double)s->reuse.spent,
                                     s->left,
                                     s->steps.solved.even,
                                     (double)s->reuse.each};
    size_t n = (size_t)s->n;
    memcpy(state, head, sizeof head);
    memcpy(state += STATE_HEAD, s->begin.q, 25 * n * sizeof *state);
    memcpy(state += 25 * n, s->to.q, 25 * n * sizeof *state);
    memcpy(state += 25 * n, s->tangent_q, 4 * n * sizeof *state);
    if (s->factored) {
        spari_linear_save(s->linear, state + 4 * n);
    } else {
        memcpy(state + 4 * n, s->tinv, STATE_OPERATOR * n * sizeof *state);
    }
    const spari_reuse *b = &s->begun;
    const double begun[STATE_BEGUN] = {b->factored,
                                       b->cm,
                                       b->cv,
                                       (double)b->tangent.served,
                                       (double)b->tangent.spent,
                                       b->left,
                                       (double)b->tangent.each};
    state += 4 * n + (size_t)tangent_size(s, s->factored);
    memcpy(state, begun, sizeof begun);
    spari_snapshot_save(&s->before, state + STATE_BEGUN);
}

int spari_solver_is_state(const spari_solver *s, const double *state, int64_t count) {
    int64_t own = STATE_HEAD + STATE_NODE * (int64_t)s->n;
    if (count < STATE_HEAD || state[0] != s->n || !spari_is_count(state[7]) || !spari_is_count(state[8]) ||
        !spari_is_count(state[12]) || !spari_is_count(state[13]) || !spari_is_remaining(state[14]) ||
        !spari_pattern_is(state[4], state[11]) || !spari_pattern_is(state[5], state[15])) {
        return 0;
    }
    const int64_t begun = own + tangent_size(s, state[1] != 0);
    const double *b = state + begun, *before = b + STATE_BEGUN;
    return count >= begun + STATE_BEGUN && spari_is_count(b[3]) && spari_is_count(b[4]) && spari_is_count(b[6]) &&
           spari_is_remaining(b[5]) && spari_snapshot_is(before, count - begun - STATE_BEGUN, before_size(s)) &&
           (before[1] <= 0 || spari_linear_is_state(s->linear, before + SPARI_SNAPSHOT_HEAD + 4 * (int64_t)s->n)) &&
           (state[1] == 0 || spari_linear_is_state(s->linear, state + own));
}

void spari_solver_load(spari_solver *s, const double *state) {
    size_t n = (size_t)s->n;
    s->factored = state[1] != 0;
    s->tangent_cm = state[2], s->tangent_cv = state[3];
    s->steps.begin = (spari_pattern){state[4], (int)state[11]};
    s->steps.solved = (spari_pattern){state[5], (int)state[15]};
    s->steps.started = state[6] != 0;
    s->newton = (int64_t)state[7], s->factors = (int64_t)state[8];
    s->power = state[9], s->power_begin = state[10];
    s->reuse = (spari_tangent_reuse){(int64_t)state[12], (int64_t)state[13], (int64_t)state[16]};
    s->left = state[14];
    s->start.known = 0;
    memcpy(s->begin.q, state += STATE_HEAD, 25 * n * sizeof *state);
    memcpy(s->to.q, state += 25 * n, 25 * n * sizeof *state);
    memcpy(s->tangent_q, state += 25 * n, 4 * n * sizeof *state);
    if (s->factored) {
        spari_linear_load(s->linear, state + 4 * n);
    } else {
        memcpy(s->tinv, state + 4 * n, STATE_OPERATOR * n * sizeof *state);
    }
    state += 4 * n + (size_t)tangent_size(s, s->factored);
    s->begun = (spari_reuse){
        state[0] != 0, state[1], state[2], {(int64_t)state[3], (int64_t)state[4], (int64_t)state[6]}, state[5]};
    spari_snapshot_load(&s->before, state + STATE_BEGUN, s->factored);
}
