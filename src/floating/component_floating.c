/* Components that are linear or modal in the frame of their root. The root is integrated as a body of one node, the
   deformation as a vector by generalised-alpha. See component.h and floating_root.h. */
#include "../algebra/cblas.h"
#include "../base/session.h"
#include "../math/rotation.h"
#include "../time/component.h"
#include "../time/driven_root.h"
#include "../time/fidelity.h"
#include "../time/substep_motion.h"
#include "floating_root.h"

#include <math.h>
#include <string.h>

static void attach_frame(spari_component *p) {
    p->frame = p->member->solution;
    spari_floating_root *c = p->frame->floating_root;
    p->solver = c->root;
    p->condensed = c->condensed;
    p->end = c->order;
    p->force = c->force;
}

static const double *rotation_of_frame(const spari_component *p, int node) {
    (void)node; /* all nodes use the frame of the root */
    return p->solver->rotation;
}

static spari_rates deformation_rates(const spari_frame *f, const spari_frame_state *s) {
    return (spari_rates){s->v + f->constrained, s->a + f->constrained, s->b + f->constrained, NULL};
}

/* Evaluates the root at the end of the step, and the motion of the root and the interface nodes for the constraints. A
   prescribed root is at the end of the step already. */
static void look_at_end_of_step(spari_component *p) {
    spari_frame *f = p->frame;
    spari_floating_root *c = f->floating_root;
    spari_frame_state *s = &f->to;
    const spari_state *root = &p->stage.ends.seen;
    p->state = &c->seen;
    if (f->floats) {
        s->root = spari_pose_of(root->q, root->v, root->a);
    }
    if (c->condensed->ends == 0) {
        return;
    }
    memcpy(c->seen.q, s->root.q, 7 * sizeof(double));
    memcpy(c->seen.v, s->root.v, 6 * sizeof(double));
    memcpy(c->seen.a, s->root.a, 6 * sizeof(double));
    for (int e = 1; e <= c->ends; e++) {
        int at = spari_floating_root_at(f, e);
        spari_frame_node(p->member, &s->root, c->node[e - 1], s->y + at, s->v + at, s->a + at, c->seen.q + 7 * e,
                         c->seen.v + 6 * e, c->seen.a + 6 * e);
    }
}

/* Residual forces on the interface nodes from the forces r, in global axes. */
static void show_forces(spari_component *p, const spari_frame_state *s) {
    spari_frame *f = p->frame;
    spari_floating_root *c = f->floating_root;
    for (int e = 0; e < c->condensed->ends; e++) {
        memcpy(c->force + 6 * e, f->r + spari_floating_root_at(f, e), 6 * sizeof(double));
    }
    spari_floating_root_absolute(f, p->member, s->y, c->force);
    for (int k = 0; k < 6 * c->condensed->ends; k += 3) {
        spari_rotate(s->root.q + 3, c->force + k, c->force + k);
    }
}

/* ---- a step ---- */

static int take_frame(spari_component *p, double h) {
    spari_frame *f = p->frame;
    spari_scheme_loads(p->member, &f->steps);
    p->scheme = spari_scheme_of(p->member, f->D != NULL, h);
    return f->steps.started;
}

static void copy_to(spari_frame *f) {
    spari_solver *s = f->floating_root->root;
    memcpy(f->to.y, f->begin.y, (size_t)(4 * f->n) * sizeof *f->to.y);
    f->to.root = f->begin.root;
    memcpy(s->to.q, s->begin.q, 25 * sizeof *s->to.q);
}

static void begin_floating_component(spari_component *p) {
    spari_frame *f = p->frame;
    spari_frame_poison(f);
    spari_solver_poison(p->solver);
    copy_to(f);
    p->stage.before = p->member->drive[0];
    p->member->state.dissipated_step = 0;
    p->stage.power = spari_frame_damped_power(f, &f->begin);
}

static void enter_frame(spari_component *p) {
    spari_frame *f = p->frame;
    const spari_frame_state y = f->from;
    if (f->floats) {
        spari_stage_enter(p->solver);
    }
    f->from = f->to, f->to = y;
}

static int stage_of_frame(spari_component *p, const spari_part *part) {
    const spar_member *m = p->member;
    spari_frame *f = p->frame;
    spari_scheme_mix_loads(m, &f->steps, 6 * f->nodes, part->end);
    if (f->floats) {
        SPARI_TRY(spari_stage_root(p->solver, m, &p->scheme, part, &p->stage));
    } else {
        spari_stage_drive(m, &p->scheme, part, &p->stage);
        p->stage.ends.carried = spari_carried(&p->stage.before, &p->stage.root, p->solver->body->length);
    }
    spari_frame_stage(f, m, &p->scheme, part, &p->stage.root);
    spari_floating_root_rotate(f, &f->from, p->scheme.span);
    p->state = &f->floating_root->seen;
    return SPAR_OK;
}

static void take_velocities_of_frame(spari_component *p) {
    spari_frame *f = p->frame;
    if (f->floats) {
        memcpy(p->solver->from.v, p->member->now.v, 6 * sizeof(double));
    }
    spari_frame_take_velocities(f, p->member, &f->from);
}

static void end_floating_component(spari_component *p) {
    spari_frame *f = p->frame;
    if (f->floats) {
        spari_stage_restart(p->solver, p->member, &p->scheme, &p->stage);
    }
    if (p->scheme.rule == SPARI_BACKWARD) {
        spari_scheme_restart(&p->scheme, f->n, f->from.a, f->to.a, f->to.b);
    }
    p->stage.before = p->stage.root;
    spari_scheme_dissipate(p->member, &p->scheme, &p->stage.power, spari_frame_damped_power(f, &f->to));
}

static void keep_rates_of_frame(spari_component *p, int back) {
    spari_frame *f = p->frame;
    double *kept = f->floating_root->kept, *root = p->stage.ends.to.v, *v = f->to.v;
    memcpy(back ? v : kept, back ? kept : v, (size_t)f->n * sizeof *v);
    if (f->floats) {
        memcpy(back ? root : p->solver->best, back ? p->solver->best : root, 6 * sizeof *v);
    }
    if (back && f->floats) {
        spari_root_show(p->solver, p->member, &p->stage.ends);
        look_at_end_of_step(p);
    }
}

/* ---- an iteration ---- */

static int predict_frame(spari_component *p, spari_guess stays) {
    spari_frame *f = p->frame;
    p->moved_in_step = 0;
    spari_solver *s = p->solver;
    double *x = f->dx + f->constrained;
    int n = f->n - f->constrained;
    if (stays == SPARI_KEEP_SHAPE) { /* the deformation is linear: its starting values are safe */
        return 0;
    }
    if (f->floats && p->scheme.still) {
        spari_alpha_carry(s, p->member, &p->scheme, &p->stage.root, p->stage.rotation, &p->stage.ends, s->increment);
    } else if (f->floats) {
        (void)spari_alpha_predict(s, p->member, &p->scheme, stays, &p->stage.ends, s->increment);
    }
    if (p->scheme.still) {
        memset(x, 0, (size_t)n * sizeof *x);
        memset(f->to.v, 0, (size_t)(3 * f->n) * sizeof *x);
    } else {
        spari_rates from = deformation_rates(f, &f->from);
        from.stage = f->stage_v + f->constrained;
        spari_scheme_predict(&p->scheme, stays, n, from, x, deformation_rates(f, &f->to));
    }
    for (int k = f->constrained; k < f->n; k++) {
        f->to.y[k] = f->from.y[k] + f->dx[k];
    }
    look_at_end_of_step(p);
    return 1;
}

static double balance_frame(spari_component *p) {
    spari_frame *f = p->frame;
    if (f->floats) {
        spari_alpha_impose_root(p->member, &p->stage.root, &p->stage.ends, p->solver->increment);
    }
    look_at_end_of_step(p);
    double scale = spari_floating_root_forces(f, p->member, &f->to, p->scheme.still, 1, f->r);
    show_forces(p, &f->to);
    return scale;
}

static double noise_of_frame(const spari_component *p) {
    const spari_frame *f = p->frame;
    const spari_condensed *d = p->condensed;
    double most = 0, poison = 0;
    for (int i = f->constrained; i < f->n; i++) {
        int at_end = 0;
        for (int e = 1; e < d->ends; e++) {
            at_end = at_end || i / 6 == d->node[e];
        }
        most = fmax(most, at_end ? 0 : fabs(f->r[i]));
        poison += 0 * f->r[i];
    }
    for (int k = 0; k < 6 * d->ends; k++) {
        most = fmax(most, fabs(p->force[k]));
        poison += 0 * p->force[k];
    }
    return most + poison;
}

static int tangent_of_frame(spari_component *p) {
    spari_frame *f = p->frame;
    if (f->floats) {
        spari_alpha_operators(p->solver, &p->scheme, &p->stage.ends, p->solver->increment);
    }
    return spari_floating_root_tangent(f, p->member, &f->to, p->scheme.cm, p->scheme.cv, p->solver->tinv, f->r);
}

static int frame_serves(const spari_component *p) {
    const spari_frame *f = p->frame;
    return f->factored && spari_alpha_close(p->scheme.cm, f->tangent_cm) &&
           spari_alpha_close(p->scheme.cv, f->tangent_cv);
}

static void see_rotation_of_frame(const spari_component *p) {
    const spari_solver *s = p->solver;
    spari_quat_between(s->tangent_q, p->frame->to.root.q + 3, s->rotation);
}

static int reduce_frame(spari_component *p, double *x) {
    spari_frame *f = p->frame;
    const double *y = f->to.y, *root = f->to.root.q + 3;
    int M = 6 * p->condensed->ends;
    see_rotation_of_frame(p);
    memcpy(f->dx, f->r, (size_t)f->n * sizeof *f->dx);
    if (spari_condensed_reduce(p->condensed, f->linear, f->dx)) {
        return 1;
    }
    for (int k = 0; k < M; k++) { /* force of the rest of the member on the interface nodes */
        int u = 6 * p->condensed->node[k / 6] + k % 6;
        x[k] = u < p->condensed->fixed ? 0 : f->dx[u] - f->r[u];
    }
    spari_floating_root_absolute(f, p->member, y, x);
    for (int k = 0; k < M; k += 3) {
        spari_rotate(root, x + k, x + k);
    }
    for (int k = 0; k < M; k++) {
        x[k] = k < p->condensed->fixed ? 0 : x[k] + p->force[k];
    }
    return 0;
}

static void expand_frame(spari_component *p, double *x) {
    spari_frame *f = p->frame;
    int M = 6 * p->condensed->ends;
    if (f->floats) {
        memcpy(p->solver->dx, x, 6 * sizeof *x);
    }
    for (int k = 0; k < M; k += 3) {
        spari_rotate_back(f->to.root.q + 3, x + k, x + k);
    }
    spari_floating_root_relative(f, p->member, f->to.y, x);
    for (int k = 0; k < M; k++) {
        f->dx[6 * p->condensed->node[k / 6] + k % 6] = x[k];
    }
    spari_condensed_expand(p->condensed, f->dx);
}

/* The largest displacement of a node, divided by the member's length, or rotation, of the unknowns x. */
static double size_of_deformation(const spari_component *p, const double *x) {
    const spari_frame *f = p->frame;
    double largest = 0, *own = f->floating_root->x;
    double *y = f->nodal;
    memcpy(y, x, (size_t)f->n * sizeof *y);
    memset(y, 0, (size_t)f->constrained * sizeof *y);
    const double *w = spari_frame_nodal(f, y, own);
    for (int i = 0; i < f->nodes; i++) {
        largest = fmax(largest, fmax(spari_norm(w + 6 * i) / p->solver->body->length, spari_norm(w + 6 * i + 3)));
    }
    return largest;
}

static double correction_of_frame(const spari_component *p) {
    double root = p->frame->floats ? spari_alpha_size(p->solver, p->solver->dx) : 0;
    return fmax(root, size_of_deformation(p, p->frame->dx));
}

static void correct_frame(spari_component *p, double cut) {
    spari_frame *f = p->frame;
    spari_solver *s = p->solver;
    f->solves++; /* responses to loads do not count */
    for (int k = 0; k < 6 && cut < 1; k++) {
        s->dx[k] *= cut;
    }
    if (f->floats) {
        (void)spari_alpha_correct(s, p->member, &p->scheme, &p->stage.ends, NULL, INFINITY, s->increment, s->dx);
    }
    spari_scheme_correct(&p->scheme, cut, f->n - f->constrained, f->dx + f->constrained, f->to.y + f->constrained,
                         deformation_rates(f, &f->to));
    look_at_end_of_step(p);
}

static double way_of_frame(const spari_component *p) {
    const spari_frame *f = p->frame;
    double *step = f->increment;
    for (int k = 0; k < f->n; k++) {
        step[k] = f->to.y[k] - f->from.y[k];
    }
    double root = f->floats ? spari_alpha_size(p->solver, p->solver->increment) : 0;
    return fmax(root + p->stage.ends.carried, size_of_deformation(p, step));
}

/* ---- an iteration of a member without joints ---- */

static int solve_frame(spari_component *p) {
    double none[6] = {0};
    if (reduce_frame(p, none)) {
        return 1;
    }
    expand_frame(p, none);
    return 0;
}

static double advance_frame(spari_component *p, double longest, double *way) {
    const spari_frame *f = p->frame;
    *way = 0;
    if (!f->floats && spari_carriage_is_linear(f, p->member) && f->tangent_cm == p->scheme.cm &&
        f->tangent_cv == p->scheme.cv && memcmp(f->tangent_turn, f->turn, sizeof f->turn) == 0) {
        correct_frame(p, 1); /* linear equations: one correction with their own tangent */
        return 0;
    }
    double size = correction_of_frame(p);
    correct_frame(p, size > longest ? longest / size : 1);
    *way = p->moved_in_step = p->moved_in_step > 0 ? p->moved_in_step : way_of_frame(p);
    return size;
}

/* The tangent is valid until the equations change. */
static void end_solution_of_frame(spari_component *p, int iterations, int fresh) {
    (void)p, (void)iterations, (void)fresh;
}

static int tangent_of_frame_after(spari_component *p) {
    if (frame_serves(p)) {
        return 0;
    }
    (void)balance_frame(p);
    return tangent_of_frame(p);
}

static void clear_frame(spari_component *p) {
    see_rotation_of_frame(p);
    memset(p->frame->dx, 0, (size_t)p->frame->n * sizeof(double));
}

static void shift_rates_of_frame(spari_component *p, double v, double a, double b) {
    spari_frame *f = p->frame;
    double *dx = p->solver->dx;
    for (int k = 0; k < 6 && f->floats && p->stage.ends.root; k += 3) {
        spari_rotate_back(p->stage.ends.root->q + 3, dx + k, dx + k);
    }
    for (int k = f->constrained; k < f->n; k++) {
        f->to.v[k] -= v * f->dx[k];
        f->to.a[k] -= a * f->dx[k];
        f->to.b[k] -= b * f->dx[k];
    }
    if (f->floats) {
        spari_alpha_shift_rates(p->solver, &p->scheme, &p->stage.ends, v, a, b);
        spari_root_show(p->solver, p->member, &p->stage.ends);
    }
    look_at_end_of_step(p);
}

/* ---- response to loads ---- */

/* Resultant force and moment of the loads [6 nodes] about the root, with lever arms of the deformed member. The modal
   unknowns contain those of the reference already. */
static void sum_about_root(const spari_component *p, const double *load, double sum[6]) {
    const spari_frame *f = p->frame;
    const double *x = spari_frame_nodal(f, f->to.y, f->floating_root->x);
    memset(sum, 0, 6 * sizeof *sum);
    for (int i = 0; i < f->nodes; i++) {
        double arm[3], turn[3];
        spari_member_arm(p->member, i, arm);
        for (int k = 0; k < 3; k++) {
            sum[k] += load[6 * i + k];
            sum[3 + k] += load[6 * i + 3 + k];
            arm[k] += x[6 * i + k];
        }
        spari_cross(arm, load + 6 * i, turn);
        for (int k = 0; k < 3; k++) {
            sum[3 + k] += turn[k];
        }
    }
}

/* Adds loads to the forces r and to those on the interface nodes. */
static void take_more_of_frame(spari_component *p, const double *load) {
    spari_frame *f = p->frame;
    double *own = f->turned;
    spari_member_gather(p->member, load, own);
    for (int i = 0; i < 6 * f->nodes; i += 3) {
        spari_rotate_back(f->to.root.q + 3, own + i, own + i);
    }
    spari_frame_gather(f, own, f->r);
    if (f->floats) {
        sum_about_root(p, own, f->r);
    }
    memset(f->r, 0, (size_t)(f->floats ? spari_member_constrained(p->member) : f->constrained) * sizeof *f->r);
    show_forces(p, &f->to);
}

/* motion [6 nodes] += rigid motion of the present nodes with the root */
static void add_motion_of_root(const spari_component *p, const double *root, double *motion) {
    const spari_frame *f = p->frame;
    const double *q = f->to.root.q + 3, *x = spari_frame_nodal(f, f->to.y, f->floating_root->x);
    for (int i = 0; i < f->nodes; i++) {
        double arm[3], turn[3], *out = motion + 6 * i;
        spari_member_arm(p->member, i, arm);
        for (int k = 0; k < 3; k++) {
            arm[k] += x[6 * i + k];
        }
        spari_rotate(q, arm, arm);
        spari_cross(root + 3, arm, turn);
        for (int k = 0; k < 3; k++) {
            out[k] += root[k] + turn[k];
            out[3 + k] += root[3 + k];
        }
    }
}

static void show_more_of_frame(spari_component *p, double *motion) {
    spari_frame *f = p->frame;
    memset(f->dx, 0, (size_t)f->constrained * sizeof *f->dx);
    const double *change = spari_frame_nodal(f, f->dx, f->nodal);
    for (int i = 0; i < 6 * f->nodes; i += 3) {
        spari_rotate(f->to.root.q + 3, change + i, f->turned + i);
    }
    if (f->floats) {
        add_motion_of_root(p, p->solver->dx, f->turned);
    }
    spari_member_from_unique(p->member, 6, f->turned, motion);
}

static void look_back_at_frame(spari_component *p) {
    spari_solver *s = p->solver;
    p->scheme = spari_scheme_last(p->member, p->frame->D != NULL, &p->solver->steps.solved);
    p->stage.ends = (spari_ends){s->from, s->to, s->to, NULL, 0};
    look_at_end_of_step(p);
}

/* ---- consistent initial accelerations ---- */

static int start_of_frame(spari_component *p) {
    spari_frame *f = p->frame;
    spari_solver *s = p->solver;
    const double unit[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    int end = spari_member_constrained(p->member);
    if (p->member->root != SPAR_ROOT_DRIVEN) {
        memset(s->begin.a, 0, (size_t)end * sizeof(double));
        memset(s->begin.v, 0, (size_t)end * sizeof(double));
    }
    f->steps.started = 0;
    copy_to(f); /* the rates are shifted at the end of the step, which equals its beginning here */
    p->stage.ends = (spari_ends){s->begin, s->begin, s->begin, NULL, 0};
    memcpy(f->steps.load, f->steps.load0, (size_t)(6 * f->nodes) * sizeof *f->steps.load);
    look_at_end_of_step(p);
    spari_floating_root_rotate(f, &f->to, 0);
    (void)spari_floating_root_forces(f, p->member, &f->to, 0, 1, f->r);
    memset(f->r, 0, (size_t)f->n * sizeof *f->r);
    return spari_floating_root_tangent(f, p->member, &f->to, p->scheme.cm, 0, unit, f->r);
}

static void unbalance_frame(spari_component *p) {
    spari_frame *f = p->frame;
    look_at_end_of_step(p);
    (void)spari_floating_root_forces(f, p->member, &f->to, 0, 1, f->r);
    show_forces(p, &f->to);
}

static void correct_start_of_frame(spari_component *p) {
    spari_frame *f = p->frame;
    spari_solver *s = p->solver;
    for (int k = 0; k < 6 && f->floats; k++) {
        s->begin.a[k] -= p->scheme.cm * s->dx[k];
    }
    for (int k = f->constrained; k < f->n; k++) {
        f->to.a[k] -= p->scheme.cm * f->dx[k];
    }
    look_at_end_of_step(p);
}

static void end_start_of_frame(spari_component *p) {
    spari_frame *f = p->frame;
    spari_solver *s = p->solver;
    if (f->floats) {
        spari_stage_remember(s, p->member, &p->scheme);
    }
    memcpy(f->to.b, f->to.a, (size_t)f->n * sizeof *f->to.b);
    memcpy(f->begin.y, f->to.y, (size_t)(4 * f->n) * sizeof *f->to.y);
    f->begin.root = f->to.root;
    f->factored = 0;
    f->steps.started = s->steps.started = 1;
}

static void shift_start_of_frame(spari_component *p) {
    spari_frame *f = p->frame;
    memcpy(f->begin.v, f->to.v, (size_t)f->n * sizeof *f->to.v);
}

/* ---- equilibrium ---- */

static void rest_frame(spari_component *p, const double *fluid, int onward) {
    spari_frame *f = p->frame;
    spari_solver *s = p->solver;
    spari_member_gather(p->member, p->member->load.dead, f->steps.load);
    spari_member_gather(p->member, fluid, f->steps.load1);
    cblas_daxpy(6 * f->nodes, 1, f->steps.load1, 1, f->steps.load, 1);
    if (!onward) {
        memcpy(s->to.q, s->begin.q, 7 * sizeof *s->to.q);
        memcpy(f->to.y, f->begin.y, (size_t)f->n * sizeof *f->to.y);
    }
    if (!f->floats) {
        const double zero[6] = {0};
        f->to.root = spari_pose_of(f->begin.root.q, zero, zero);
    }
    memset(s->to.v, 0, 18 * sizeof *s->to.v);
    memset(f->to.v, 0, (size_t)(3 * f->n) * sizeof *f->to.v);
    p->stage.ends = (spari_ends){s->to, s->to, s->to, NULL, 0};
    look_at_end_of_step(p);
}

/* The root rotates with the member; frame and deformation rotate with the root. */
static void rotate_root(spari_component *p, double factor) {
    const spar_member *m = p->member;
    spari_frame *f = p->frame;
    spari_state *to = &p->solver->to;
    const double *q = f->floats ? to->q : f->to.root.q;
    double x[3];
    for (int k = 0; k < 3; k++) {
        x[k] = m->xr[k] + q[k];
    }
    if (f->floats) {
        spari_rotating_frame_rates(p->rotating, factor, x, to->v, to->a);
    } else {
        spari_rotating_frame_rates(p->rotating, factor, x, f->to.root.v, f->to.root.a);
    }
    look_at_end_of_step(p);
}

static double balance_frame_at_rest(spari_component *p, double factor) {
    spari_frame *f = p->frame;
    int rotating = p->rotating && f->M && (p->member->effects & SPAR_EFFECT_INERTIA);
    spari_steady_rotation part = {{0}, {0}, {0}};
    if (p->rotating) {
        rotate_root(p, factor);
    }
    if (rotating) {
        part = spari_steady_rotation_part(&p->rotating->rotation, factor);
        spari_floating_root_rotate(f, &f->to, 0);
    }
    f->floating_root->steady = rotating;
    memcpy(f->floating_root->steady_rotation, part.w, sizeof part.w);
    double scale = spari_floating_root_forces(f, p->member, &f->to, !rotating, factor, f->r);
    show_forces(p, &f->to);
    return scale;
}

static int tangent_of_frame_at_rest(spari_component *p, double factor) {
    const double unit[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    (void)factor; /* the factor of the latest forces applies */
    int singular = spari_floating_root_tangent(p->frame, p->member, &p->frame->to, 0, 0, unit, p->frame->r);
    p->frame->floating_root->steady = 0;
    return singular;
}

static void shift_frame(spari_component *p, double cut) {
    spari_frame *f = p->frame;
    if (f->floats) {
        spari_static_shift(1, cut, p->solver->dx, p->solver->to.q);
    }
    for (int k = f->constrained; k < f->n; k++) {
        f->to.y[k] -= cut * f->dx[k];
    }
    look_at_end_of_step(p);
}

static void keep_positions_of_frame(spari_component *p, int back) {
    spari_frame *f = p->frame;
    spari_solver *s = p->solver;
    double *kept = f->floating_root->kept + f->n, *y = f->to.y;
    memcpy(back ? s->to.q : s->best, back ? s->best : s->to.q, 7 * sizeof *y);
    memcpy(back ? y : kept, back ? kept : y, (size_t)f->n * sizeof *y);
    look_at_end_of_step(p);
}

static void discard_rest_of_frame(spari_component *p) {
    copy_to(p->frame);
    p->frame->factored = 0;
    p->frame->floating_root->steady = 0;
}

static void end_rest_of_frame(spari_component *p) {
    keep_positions_of_frame(p, 1);
    if (p->rotating) {
        rotate_root(p, 1);
    }
    p->frame->factored = 0;
    p->frame->floating_root->steady = 0;
    p->member->row->publish(p->member);
}

const spari_component_row spari_component_floating = {
    .attach = attach_frame,
    .take = take_frame,
    .begin = begin_floating_component,
    .enter = enter_frame,
    .stage = stage_of_frame,
    .take_velocities = take_velocities_of_frame,
    .end = end_floating_component,
    .keep_rates = keep_rates_of_frame,
    .predict = predict_frame,
    .balance = balance_frame,
    .noise = noise_of_frame,
    .tangent = tangent_of_frame,
    .serves = frame_serves,
    .reduce = reduce_frame,
    .expand = expand_frame,
    .correction_size = correction_of_frame,
    .correct = correct_frame,
    .way = way_of_frame,
    .solve = solve_frame,
    .advance = advance_frame,
    .end_solution = end_solution_of_frame,
    .tangent_after = tangent_of_frame_after,
    .clear = clear_frame,
    .shift_rates = shift_rates_of_frame,
    .take_more = take_more_of_frame,
    .show_more = show_more_of_frame,
    .look_back = look_back_at_frame,
    .start = start_of_frame,
    .unbalance = unbalance_frame,
    .correct_start = correct_start_of_frame,
    .end_start = end_start_of_frame,
    .shift_start = shift_start_of_frame,
    .rest = rest_frame,
    .balance_rest = balance_frame_at_rest,
    .tangent_rest = tangent_of_frame_at_rest,
    .shift = shift_frame,
    .keep_positions = keep_positions_of_frame,
    .discard_rest = discard_rest_of_frame,
    .end_rest = end_rest_of_frame,
    .rotation = rotation_of_frame,
};
