/* Stages of a substep: see stage.h. */
#include "stage.h"

#include "../base/session.h"
#include "../math/rotation.h"
#include "../member/applied_loads.h"
#include "driven_root.h"

#include <string.h>

/* The ends [from, to] of a substep of a root. ratio: of the algorithmic accelerations, see spari_scheme_stretch. */
static spari_ends ends_of_root(const spari_solver *s, const spar_member *m, const spari_scheme *c,
                               const spari_pose *root, double ratio, const spari_state *from, const spari_state *to) {
    spari_ends e = {.from = *from, .to = *to, .absolute = *to};
    if (m->root == SPAR_ROOT_DRIVEN && s->own[0].q && !c->still) {
        const spari_pose before = spari_pose_of(from->q, from->v, from->a);
        e.from = s->own[0], e.to = s->own[1], e.root = root;
        e.root_motion = spari_root_motion(&before, root, s->body->length);
        spari_root_look_from(s, m, &before, from, &e.from);
        spari_root_subtract_jump(s, m, c->span, &before, root, &e.from);
    }
    spari_scheme_stretch(ratio, 6 * s->n, e.from.a, e.from.b);
    return e;
}

static void begin_span(void *context, int64_t from, int64_t to) {
    const spari_solver *s = context;
    const spari_state *b = &s->begin;
    size_t n = (size_t)(to - from) * sizeof *b->q;
    memcpy(s->to.q + 7 * from, b->q + 7 * from, 7 * n);
    memcpy(s->to.v + 6 * from, b->v + 6 * from, 6 * n);
    memcpy(s->to.a + 6 * from, b->a + 6 * from, 6 * n);
    memcpy(s->to.b + 6 * from, b->b + 6 * from, 6 * n);
}

void spari_stage_start(spari_solver *s, spar_member *m, spari_stage *g) {
    spari_solver_spread(s, begin_span, s);
    g->before = m->drive[0];
    g->power = s->power_begin;
    m->state.dissipated_step = 0;
}

void spari_stage_enter(spari_solver *s) {
    spari_state t = s->from;
    s->from = s->to;
    s->to = t;
}

/* ---- members that turn ---- */

static int make_own_states(spari_solver *s) {
    for (int k = 0; k < 2 && !s->own[k].q; k++) {
        double *block = spari_zalloc(25 * (int64_t)s->n, sizeof *block);
        if (!block) {
            return SPAR_ERR_MEMORY;
        }
        s->own[k] = spari_state_in(block, s->n);
    }
    return s->own[1].q ? SPAR_OK : SPAR_ERR_MEMORY;
}

static int make_turning_states(spari_solver *s, const spari_turning_frame *f) {
    if (f->kind == SPARI_TURNS_WITH_FRAME && f->alone && !s->share) {
        s->share = spari_zalloc(s->n, sizeof *s->share);
        SPARI_TRY(s->share ? SPAR_OK : SPAR_ERR_MEMORY);
    }
    return make_own_states(s);
}

/* The difference of the algorithmic acceleration from the true one is what a step hands to the next one. It rotates
   with the member, apart from the mean of a member that flies alone, and does not depend on the frames of the two
   steps. difference: [n][6], rotates it by R = q, or back. */
static void rotate_difference(const spari_solver *s, int follows, const double q[4], int back, double *difference) {
    double mean[3] = {0};
    if (follows) {
        spari_root_mean(s, difference, 6, mean);
    }
    for (int i = 0; i < 6 * s->n; i += 3) {
        const double part = i % 6 == 0 ? 1 : 0;
        double rest[3];
        for (int k = 0; k < 3; k++) {
            rest[k] = difference[i + k] - part * mean[k];
        }
        if (back) {
            spari_rotate_back(q, rest, rest);
        } else {
            spari_rotate(q, rest, rest);
        }
        for (int k = 0; k < 3; k++) {
            difference[i + k] = rest[k] + part * mean[k];
        }
    }
}

static void take_algorithmic(const spari_solver *s, double ratio, const spari_state *from, const spari_ends *e,
                             const double rotation[4]) {
    for (int i = 0; i < 6 * s->n; i++) {
        e->from.b[i] = from->b[i] - from->a[i];
    }
    if (e->root) {
        rotate_difference(s, e->follows != NULL, rotation, 1, e->from.b);
    }
    for (int i = 0; i < 6 * s->n; i++) {
        e->from.b[i] = e->from.a[i] + ratio * e->from.b[i];
    }
}

/* The ends of a substep of a member that turns. */
static spari_ends ends_of_turning(const spari_solver *s, const spar_member *m, const spari_scheme *c,
                                  const spari_part *part, spari_stage *g) {
    const spari_turning_frame *f = &g->turning;
    spari_ends e = {.from = s->own[0], .to = s->own[1], .absolute = s->to};
    spari_pose before;
    if (f->kind == SPARI_TURNS_WITH_FRAME || !f->rests) {
        before = spari_turning_frame_at(f, part->from * part->dt);
        g->turned = spari_turning_frame_at(f, part->end * part->dt);
    }
    if (f->kind == SPARI_TURNS_AS_BODY) {
        e.centre = f->centre, e.origin = f->rests ? NULL : &g->turned;
        spari_centre_look(e.centre, f->rests ? NULL : &before, &s->from, &e.from);
    } else {
        e.root = &g->turned;
        e.root_motion = spari_root_motion(&before, &g->turned, s->body->length);
        if (f->alone) {
            spari_turning_shares(s, s->share);
            spari_root_follow(s, m, &s->from, &before);
            e.follows = &g->turned;
        }
        spari_root_look_from(s, m, &before, &s->from, &e.from);
    }
    if (c->rule == SPARI_ALPHA) {
        take_algorithmic(s, part->ratio > 0 ? part->ratio : 1, &s->from, &e, before.q + 3);
    }
    return e;
}

/* After the substep: the inverse of take_algorithmic, in global axes. */
static void give_algorithmic(const spari_solver *s, const spari_ends *e) {
    double *b = e->absolute.b;
    for (int i = 0; i < 6 * s->n; i++) {
        b[i] = e->to.b[i] - e->to.a[i];
    }
    if (e->root) {
        rotate_difference(s, e->follows != NULL, e->root->q + 3, 0, b);
    }
    for (int i = 0; i < 6 * s->n; i++) {
        b[i] += e->absolute.a[i];
    }
    memcpy(e->to.b, b, (size_t)(6 * s->n) * sizeof *b); /* where spari_root_show reads it */
}

/* ---- the first step ---- */

void spari_steady_rate(const spar_member *m, const double w[3], const double a[3], double rate[3]) {
    double pushed[3];
    for (int k = 0; k < 3; k++) {
        pushed[k] = a[k] - m->body->gravity[k];
    }
    spari_cross(w, pushed, rate);
}

/* b^0 = a^0 + (alpha_m - alpha_f) h times the rate of the acceleration in the variables of the scheme. In a turning
   frame a steady rotation has none. For a rigid body also v^0 -= C h^2 times this rate: generalised-alpha has
   velocities that differ from the true ones by this, with C of (E1), because h v + h^2 ((1/2 - beta) b^n +
   beta b^{n+1}) is the whole increment. */
void spari_stage_remember(spari_solver *s, const spar_member *m, const spari_scheme *c) {
    double h = (c->alpha_m - c->alpha_f) * c->h, C = spari_scheme_error(c), centre[3], rate[3], block[25];
    spari_state *begin = &s->begin, at = spari_state_in(block, 1);
    memcpy(begin->b, begin->a, (size_t)(6 * s->n) * sizeof *begin->b);
    if (m->root == SPAR_ROOT_DRIVEN && s->own[0].q) {
        const spari_pose root = spari_pose_of(begin->q, begin->v, begin->a);
        spari_root_look_from(s, m, &root, begin, &s->own[0]);
        memcpy(begin->b, s->own[0].a, (size_t)(6 * s->n) * sizeof *begin->b);
        return;
    }
    if (m->session->clock.step == 0 && spari_turning_centre(s, m, centre)) {
        spari_centre_look(centre, NULL, begin, &at);
        spari_steady_rate(m, at.v + 3, at.a, rate);
        for (int k = 0; k < 3; k++) {
            begin->b[k] += h * rate[k];
            begin->v[k] -= C * c->h * c->h * rate[k];
        }
    }
}

/* ---- stages ---- */

void spari_stage_drive(const spar_member *m, const spari_scheme *c, const spari_part *part, spari_stage *g) {
    g->root = spari_drive_at(m, part->to, part->dt);
    if (c->rule == SPARI_TRAPEZOIDAL) {
        g->root = spari_drive_stage(&g->before, &g->root, c->h, c->span);
    }
}

int spari_stage_begin(spari_solver *s, const spar_member *m, const spari_scheme *c, const spari_part *part,
                      spari_stage *g) {
    spari_scheme_mix_loads(m, &s->steps, 6 * s->n, part->end);
    if (s->offset_loads) {
        spari_offset_loads_at(s->offset_loads, part->end);
        memcpy(s->offset_loads->gravity, m->body->gravity, sizeof m->body->gravity);
    }
    if (c->rule != SPARI_BACKWARD && !c->still) {
        spari_turning_frame_find(s, m, c->rule, part->dt, &g->carrier, &g->turning);
    }
    const int turns = !c->still && g->turning.kind != SPARI_TURNS_NOT;
    spari_stage_drive(m, c, part, g);
    g->rotation[0] = 1;
    memset(g->rotation + 1, 0, 3 * sizeof *g->rotation);
    if (m->root == SPAR_ROOT_DRIVEN) {
        spari_quat_between(g->before.q + 3, g->root.q + 3, g->rotation);
    }
    if (turns) {
        SPARI_REQUIRE(m->session, make_turning_states(s, &g->turning) == SPAR_OK, SPAR_ERR_MEMORY,
                      "member '%s': no memory for its rotation", m->name);
        g->ends = ends_of_turning(s, m, c, part, g);
    } else {
        g->ends = ends_of_root(s, m, c, &g->root, c->rule == SPARI_ALPHA ? part->ratio : 1, &s->from, &s->to);
    }
    if (c->rule == SPARI_BACKWARD) {
        size_t size = (size_t)(6 * s->n) * sizeof(double);
        memcpy(s->stage_v, g->ends.to.v, size);
        memcpy(g->ends.from.b, g->ends.to.a, size);
    }
    return SPAR_OK;
}

/* rad, or relative to the length: for a smaller motion a substep has one solution only. */
static const double near = 0.1;

/* The change of position, or the distance that the change of velocity covers in h. */
static double moved_by(const spari_solver *s, double h) {
    double most = 0;
    for (int i = 0; i < s->n; i++) {
        const double *u = s->from.v + 6 * i, *v = s->to.v + 6 * i;
        const double dv[3] = {h * (v[0] - u[0]), h * (v[1] - u[1]), h * (v[2] - u[2])},
                     dw[3] = {h * (v[3] - u[3]), h * (v[4] - u[4]), h * (v[5] - u[5])};
        const double *p = s->from.q + 7 * i, *q = s->to.q + 7 * i;
        const double way[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
        double rotation[4], psi[3];
        spari_quat_between(p + 3, q + 3, rotation);
        spari_quat_log(rotation, psi);
        double far = fmax(spari_norm(way), spari_norm(dv)) / s->body->length;
        most = fmax(most, fmax(far, fmax(spari_norm(psi), spari_norm(dw))));
    }
    return most;
}

/* The work of the loads at the part `at` of the step, in the state x, along the substep. s->dx holds their residual,
   which has the other sign. */
static double work_of_loads(spari_solver *s, const spar_member *m, const spari_state *x, double at) {
    double sum = 0;
    spari_scheme_mix_loads(m, &s->steps, 6 * s->n, at);
    memcpy(s->dx, s->steps.load, (size_t)(6 * s->n) * sizeof *s->dx);
    for (int i = 0; i < 6 * s->n; i++) {
        s->dx[i] *= -1;
    }
    if (spari_solver_has_applied(s, m)) {
        (void)spari_applied_residual(m, x->q, 1, s->dx);
    }
    for (int i = 0; i < s->n; i++) {
        double rotation[4], psi[3];
        spari_quat_between(s->from.q + 7 * i + 3, s->to.q + 7 * i + 3, rotation);
        spari_quat_log(rotation, psi);
        for (int k = 0; k < 3; k++) {
            sum -= s->dx[6 * i + k] * (s->to.q[7 * i + k] - s->from.q[7 * i + k]) + s->dx[6 * i + 3 + k] * psi[k];
        }
    }
    return sum;
}

void spari_stage_energy(spari_solver *s, const spar_member *m, const spari_part *part, double *gain, double *size) {
    double before[4], after[4];
    double work = 0.5 * (work_of_loads(s, m, &s->from, part->from) + work_of_loads(s, m, &s->to, part->to));
    spari_scheme_mix_loads(m, &s->steps, 6 * s->n, 0.5 * (part->from + part->to)); /* gravity may change too */
    spari_body_energy(s->body, s->from.q, s->from.v, before);
    spari_body_energy(s->body, s->to.q, s->to.v, after);
    spari_scheme_mix_loads(m, &s->steps, 6 * s->n, part->to);
    *size = before[0] + before[1] + fabs(work) + fabs(after[2] - before[2]);
    *gain = after[0] + after[1] + after[2] - before[0] - before[1] - before[2] - work;
}

int spari_stage_is_near(const spari_solver *s, const spar_member *m, double h) {
    return m->root == SPAR_ROOT_DRIVEN || m->added || s->offset_loads || !(moved_by(s, h) > near);
}

/* The algorithmic acceleration of a member with a driven root is relative to the root, all others are in global
   axes. */
void spari_stage_end(const spari_solver *s, spar_member *m, const spari_scheme *c, spari_stage *g) {
    const spari_ends *e = &g->ends;
    const int driven = m->root == SPAR_ROOT_DRIVEN && e->root, turns = e->centre || (e->root && !driven);
    if (c->rule == SPARI_BACKWARD) {
        spari_scheme_restart(c, 6 * s->n, e->from.a, e->to.a, e->to.b);
    }
    if (turns) {
        give_algorithmic(s, e);
    } else if (c->rule == SPARI_BACKWARD && e->root) {
        memcpy(e->absolute.b, e->to.b, (size_t)(6 * s->n) * sizeof *e->to.b);
    }
    g->before = g->root;
    spari_scheme_dissipate(m, c, &g->power, s->power);
}
