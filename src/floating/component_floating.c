/* Components that are linear or modal in the frame of their root: time integration of the deformation by
   generalised-alpha, response and equilibrium. See component.h and frame.h. */
#include "../algebra/cblas.h"
#include "../base/session.h"
#include "../math/rotation.h"
#include "../time/component.h"
#include "../time/driven_root.h"
#include "../time/fidelity.h"
#include "../time/substep_motion.h"
#include "frame.h"

#include <math.h>
#include <string.h>

static void attach_frame(spari_component *p) {
    p->frame = p->member->solution;
    p->body = p->member->body;
    p->steps = &p->frame->steps;
    p->left = &p->frame->tangent.left;
}

static spari_rates deformation_rates(const spari_frame *f, const spari_frame_state *s) {
    return (spari_rates){s->v + f->constrained, s->a + f->constrained, s->b + f->constrained, NULL};
}

/* ---- a step ---- */

static int take_frame(spari_component *p, double h) {
    spari_frame *f = p->frame;
    spari_scheme_loads(p->member, &f->steps);
    p->scheme = spari_scheme_of(p->member, f->D != NULL, h);
    return f->steps.started;
}

static void begin_at_start_of_step(spari_frame *f) {
    memcpy(f->to.y, f->begin.y, (size_t)(4 * f->n) * sizeof *f->to.y);
    f->to.root = f->begin.root;
}

static void begin_floating_component(spari_component *p) {
    spari_frame *f = p->frame;
    spari_frame_poison(f);
    begin_at_start_of_step(f);
    p->stage.before = p->member->drive[0];
    p->member->state.dissipated_step = 0;
    p->stage.power = spari_frame_damped_power(f, &f->begin);
}

static void enter_frame(spari_component *p) {
    spari_frame *f = p->frame;
    const spari_frame_state y = f->from;
    f->from = f->to, f->to = y;
}

static int stage_of_frame(spari_component *p, const spari_part *part) {
    const spar_member *m = p->member;
    spari_scheme_mix_loads(m, &p->frame->steps, 6 * p->frame->nodes, part->end);
    spari_stage_drive(m, &p->scheme, part, &p->stage);
    p->stage.ends.root_motion = spari_root_motion(&p->stage.before, &p->stage.root, p->body->length);
    spari_frame_stage(p->frame, m, &p->scheme, part, &p->stage.root);
    return SPAR_OK;
}

static void end_floating_component(spari_component *p) {
    spari_frame *f = p->frame;
    if (p->scheme.rule == SPARI_BACKWARD) {
        spari_scheme_restart(&p->scheme, f->n, f->from.a, f->to.a, f->to.b);
    }
    p->stage.before = p->stage.root;
    spari_scheme_dissipate(p->member, &p->scheme, &p->stage.power, spari_frame_damped_power(f, &f->to));
}

/* ---- an iteration ---- */

static int predict_frame(spari_component *p, spari_guess stays) {
    spari_frame *f = p->frame;
    p->moved_in_step = 0;
    double *x = f->dx + f->constrained;
    int n = f->n - f->constrained;
    if (stays == SPARI_KEEP_SHAPE) { /* the deformation is linear: its starting values are safe */
        return 0;
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
    return 1;
}

static double balance_frame(spari_component *p) {
    spari_frame *f = p->frame;
    return spari_frame_forces(f, p->member, &f->to, p->scheme.still, 1, f->r);
}

static double residual_of_frame(const spari_component *p) {
    const spari_frame *f = p->frame;
    double most = 0, poison = 0;
    for (int i = f->constrained; i < f->n; i++) {
        most = fmax(most, fabs(f->r[i]));
        poison += 0 * f->r[i];
    }
    return most + poison;
}

static int tangent_of_frame(spari_component *p) {
    return spari_frame_tangent(p->frame, p->scheme.cm, p->scheme.cv);
}

static int frame_serves(const spari_component *p) {
    const spari_frame *f = p->frame;
    return f->tangent.factored != 0 && spari_alpha_close(p->scheme.cm, f->tangent.cm) &&
           spari_alpha_close(p->scheme.cv, f->tangent.cv);
}

static int solve_frame(spari_component *p) {
    spari_frame *f = p->frame;
    memcpy(f->dx, f->r, (size_t)f->n * sizeof *f->dx);
    return spari_linear_solve(f->linear, f->dx);
}

/* The largest displacement of a node, divided by the member's length, or rotation, of the unknowns x. */
static double size_of_deformation(const spari_component *p, const double *x) {
    const spari_frame *f = p->frame;
    double largest = 0, *y = f->nodal;
    memcpy(y, x, (size_t)f->n * sizeof *y);
    memset(y, 0, (size_t)f->constrained * sizeof *y);
    const double *w = spari_frame_nodal(f, y, y + 6 * (int64_t)f->nodes);
    for (int i = 0; i < f->nodes; i++) {
        largest = fmax(largest, fmax(spari_norm(w + 6 * i) / p->body->length, spari_norm(w + 6 * i + 3)));
    }
    return largest;
}

static double correction_of_frame(const spari_component *p) {
    return size_of_deformation(p, p->frame->dx);
}

static void correct_frame(spari_component *p, double cut) {
    spari_frame *f = p->frame;
    f->solves++; /* responses to loads do not count */
    spari_scheme_correct(&p->scheme, cut, f->n - f->constrained, f->dx + f->constrained, f->to.y + f->constrained,
                         deformation_rates(f, &f->to));
}

static double advance_frame(spari_component *p, double longest, double *motion) {
    const spari_frame *f = p->frame;
    const spar_member *m = p->member;
    const int is_linear = !m->load.applied && (!m->added || p->scheme.still); /* no force depends on the motion */
    *motion = 0;
    if (is_linear && f->tangent.cm == p->scheme.cm && f->tangent.cv == p->scheme.cv &&
        memcmp(f->tangent.rates, f->rates, sizeof f->rates) == 0) {
        correct_frame(p, 1); /* one correction with their own tangent solves the equations */
        return 0;
    }
    double size = correction_of_frame(p);
    correct_frame(p, size > longest ? longest / size : 1);
    if (!(p->moved_in_step > 0)) {
        for (int k = 0; k < f->n; k++) {
            f->increment[k] = f->to.y[k] - f->from.y[k];
        }
        p->moved_in_step = fmax(p->stage.ends.root_motion, size_of_deformation(p, f->increment));
    }
    *motion = p->moved_in_step;
    return size;
}

/* The tangent is valid until the equations change. */
static void end_solution_of_frame(spari_component *p, int iterations, spari_tangents tangents) {
    (void)p, (void)iterations, (void)tangents;
}

/* ---- response to loads ---- */

static int tangent_of_frame_after(spari_component *p) {
    if (frame_serves(p)) {
        return 0;
    }
    (void)balance_frame(p);
    return tangent_of_frame(p);
}

static void apply_load_to_frame(spari_component *p, const double *load) {
    spari_frame *f = p->frame;
    spari_member_gather(p->member, load, f->global);
    for (int i = 0; i < 6 * f->nodes; i += 3) {
        spari_rotate_back(f->to.root.q + 3, f->global + i, f->global + i);
    }
    spari_frame_gather(f, f->global, f->r);
    memset(f->r, 0, (size_t)f->constrained * sizeof *f->r);
}

static void carry_over_frame(spari_component *p, double part) {
    spari_frame *f = p->frame;
    const double carried = spari_scheme_carried(&p->scheme);
    memset(f->dx, 0, (size_t)f->constrained * sizeof *f->dx);
    for (int i = 0; i < f->n; i++) {
        f->r[i] *= part;
    }
    spari_frame_add_times(f, f->M, f->dx, carried, f->r);
    if (f->A) {
        spari_frame_add_times(f, f->A, f->dx, carried, f->r);
    }
    memset(f->r, 0, (size_t)f->constrained * sizeof *f->r);
}

static void response_of_frame(spari_component *p, double *motion) {
    spari_frame *f = p->frame;
    memset(f->dx, 0, (size_t)f->constrained * sizeof *f->dx);
    const double *change = spari_frame_nodal(f, f->dx, f->nodal);
    for (int i = 0; i < 6 * f->nodes; i += 3) {
        spari_rotate(f->to.root.q + 3, change + i, f->global + i);
    }
    spari_member_from_unique(p->member, 6, f->global, motion);
}

static void restore_frame(spari_component *p) {
    p->scheme = spari_scheme_last(p->member, p->frame->D != NULL, &p->frame->steps.solved);
}

/* ---- consistent initial accelerations ---- */

static int start_of_frame(spari_component *p) {
    spari_frame *f = p->frame;
    f->steps.started = 0;
    begin_at_start_of_step(f);
    memcpy(f->steps.load, f->steps.load0, (size_t)(6 * f->nodes) * sizeof *f->steps.load);
    (void)spari_frame_forces(f, p->member, &f->to, 0, 1, f->r);
    return spari_frame_tangent(f, p->scheme.cm, 0);
}

static void unbalance_frame(spari_component *p) {
    spari_frame *f = p->frame;
    (void)spari_frame_forces(f, p->member, &f->to, 0, 1, f->r);
}

static void correct_start_of_frame(spari_component *p) {
    spari_frame *f = p->frame;
    for (int k = f->constrained; k < f->n; k++) {
        f->to.a[k] -= p->scheme.cm * f->dx[k];
    }
}

static void end_start_of_frame(spari_component *p) {
    spari_frame *f = p->frame;
    memcpy(f->to.b, f->to.a, (size_t)f->n * sizeof *f->to.b);
    memcpy(f->begin.y, f->to.y, (size_t)(4 * f->n) * sizeof *f->to.y);
    f->tangent.factored = 0;
    f->steps.started = 1;
}

/* ---- equilibrium ---- */

static void begin_static_of_frame(spari_component *p, const double *fluid, int onward) {
    spari_frame *f = p->frame;
    const double zero[6] = {0};
    f->resting = 1;
    spari_member_gather(p->member, p->member->load.dead, f->steps.load);
    spari_member_gather(p->member, fluid, f->steps.load1);
    cblas_daxpy(6 * f->nodes, 1, f->steps.load1, 1, f->steps.load, 1);
    if (!onward) {
        memcpy(f->to.y, f->begin.y, (size_t)f->n * sizeof *f->to.y);
    }
    f->to.root = spari_pose_of(f->begin.root.q, zero, zero);
    memset(f->to.v, 0, (size_t)(3 * f->n) * sizeof *f->to.v);
}

/* The root rotates with the member; frame and deformation rotate with the root. */
static void rotate_root(spari_component *p, double factor) {
    const spar_member *m = p->member;
    spari_pose *root = &p->frame->to.root;
    const double x[3] = {m->xr[0] + root->q[0], m->xr[1] + root->q[1], m->xr[2] + root->q[2]};
    if (p->rotating) {
        spari_rotating_frame_rates(p->rotating, factor, x, root->v, root->a);
    }
}

static double balance_frame_static(spari_component *p, double factor) {
    spari_frame *f = p->frame;
    int rotating = p->rotating && f->M && (p->member->effects & SPAR_EFFECT_INERTIA);
    rotate_root(p, factor);
    return spari_frame_forces(f, p->member, &f->to, !rotating, factor, f->r);
}

static int tangent_of_frame_static(spari_component *p, double factor) {
    (void)factor; /* the factor of the latest forces applies */
    return spari_frame_tangent(p->frame, 0, 0);
}

static void shift_frame(spari_component *p, double cut) {
    spari_frame *f = p->frame;
    for (int k = f->constrained; k < f->n; k++) {
        f->to.y[k] -= cut * f->dx[k];
    }
}

static void keep_positions_of_frame(spari_component *p, int back) {
    spari_frame *f = p->frame;
    double *saved = f->positions, *y = f->to.y;
    memcpy(back ? y : saved, back ? saved : y, (size_t)f->n * sizeof *y);
}

static void discard_static_of_frame(spari_component *p) {
    begin_at_start_of_step(p->frame);
    p->frame->tangent.factored = 0;
    p->frame->resting = 0;
}

static void end_static_of_frame(spari_component *p) {
    keep_positions_of_frame(p, 1);
    rotate_root(p, 1);
    p->frame->tangent.factored = 0;
    p->frame->resting = 0;
    p->member->row->publish(p->member);
}

const spari_component_row spari_component_floating = {
    .attach = attach_frame,
    .take = take_frame,
    .begin = begin_floating_component,
    .enter = enter_frame,
    .stage = stage_of_frame,
    .end = end_floating_component,
    .predict = predict_frame,
    .balance = balance_frame,
    .residual_size = residual_of_frame,
    .tangent = tangent_of_frame,
    .serves = frame_serves,
    .solve = solve_frame,
    .correct_newton = solve_frame,
    .advance = advance_frame,
    .end_solution = end_solution_of_frame,
    .correction_size = correction_of_frame,
    .tangent_after = tangent_of_frame_after,
    .apply_load = apply_load_to_frame,
    .carry_over = carry_over_frame,
    .get_response = response_of_frame,
    .restore_end = restore_frame,
    .start = start_of_frame,
    .unbalance = unbalance_frame,
    .correct_start = correct_start_of_frame,
    .end_start = end_start_of_frame,
    .begin_static = begin_static_of_frame,
    .balance_static = balance_frame_static,
    .tangent_static = tangent_of_frame_static,
    .shift = shift_frame,
    .keep_positions = keep_positions_of_frame,
    .discard_static = discard_static_of_frame,
    .end_static = end_static_of_frame,
};
