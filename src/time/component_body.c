/* Components whose unknowns are the motions of their nodes: exact beams, rigid bodies and rigid beams. See
   component.h. */
#include "../base/session.h"
#include "../comm/comm.h"
#include "../math/rotation.h"
#include "../member/added_mass.h"
#include "../member/applied_loads.h"
#include "../member/joint.h"
#include "../member/plane.h"
#include "component.h"
#include "fidelity.h"
#include "node_kinematics.h"
#include "substep_motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

spari_component spari_component_of(spar_member *m) {
    spari_component p = {.member = m, .row = m->row->component};
    p.row->attach(&p);
    return p;
}

/* ---- interface nodes ---- */

/* The nodes of a member's unknowns that joints tie, in increasing order. node: capacity of two per joint of it. Returns
   how many there are. */
static int find_joint_nodes(const spar_member *m, int *node) {
    int n = 0;
    for (int k = 0; k < m->joint_count; k++) {
        const spar_joint *j = m->joints[k];
        for (int side = 0; side < 2; side++) {
            if (j->member[side] != m) {
                continue;
            }
            int at = 0, joint_node = m->row->whole ? 0 : spari_member_unique(m, j->node[side]);
            while (at < n && node[at] < joint_node) {
                at++;
            }
            if (at < n && node[at] == joint_node) {
                continue;
            }
            memmove(node + at + 1, node + at, (size_t)(n - at) * sizeof *node);
            node[at] = joint_node;
            n++;
        }
    }
    return n;
}

static void attach_nodes(spari_component *p) {
    spari_solver *s = p->solver = p->member->row->solver(p->member);
    p->condensed = s->condensed;
    p->body = s->body;
    p->steps = &s->steps;
    p->left = &s->left;
}

int spari_component_make_ends(const spari_component *p) {
    spari_solver *s = p->member->row->solver(p->member);
    int *node = spari_zalloc(2 * p->member->joint_count + 1, sizeof *node);
    spari_condensed_free(s->condensed);
    s->condensed = node ? spari_condensed_create(find_joint_nodes(p->member, node), node, 6 * s->n) : NULL;
    free(node);
    return s->condensed ? SPAR_OK : SPAR_ERR_MEMORY;
}

/* ---- a step ---- */

static int begin_loads_of_nodes(spari_component *p, double h) {
    p->member->row->take_loads(p->member);
    p->scheme = spari_scheme_of(p->member, p->solver->body->D != NULL, h);
    return p->solver->steps.started;
}

static void begin_nodes(spari_component *p) {
    spari_solver_poison(p->solver);
    spari_stage_start(p->solver, p->member, &p->stage);
}

static void enter_nodes(spari_component *p) {
    spari_stage_enter(p->solver);
}

static int stage_of_nodes(spari_component *p, const spari_part *part) {
    SPARI_TRY(spari_stage_begin(p->solver, p->member, &p->scheme, part, &p->stage));
    p->state = &p->stage.ends.absolute;
    return SPAR_OK;
}

void spari_component_take_velocities(const spari_component *p) {
    const spar_member *m = p->member;
    if (m->row->whole) {
        memcpy(p->solver->from.v, m->now.v, 6 * sizeof(double));
    } else {
        spari_member_to_unique(m, 6, m->now.v, p->solver->from.v);
    }
}

/* In an inclined plane rounding leaves it, and rates would carry it on. */
static void end_nodes(spari_component *p) {
    const double *normal = spari_member_plane(p->member);
    const spari_state *to = &p->solver->to;
    spari_stage_end(p->solver, p->member, &p->scheme, &p->stage);
    if (normal) {
        spari_plane_project(normal, p->solver->n, to->v);
        spari_plane_project(normal, p->solver->n, to->a);
        spari_plane_project(normal, p->solver->n, to->b);
    }
}

void spari_component_keep_rates(spari_component *p, int back) {
    spari_solver *s = p->solver;
    double *v = p->stage.ends.to.v;
    memcpy(back ? v : s->best, back ? s->best : v, (size_t)(6 * s->n) * sizeof *v);
    if (back) {
        spari_root_show(s, p->member, &p->stage.ends);
    }
}

/* ---- an iteration ---- */

/* Whether a coupling may solve the step again from the same starting values. Fluids may be on other ranks. */
static int starts_again(const spari_component *p) {
    const spar_session *s = p->member->session;
    return p->solver->start.state && p->scheme.rule == SPARI_ALPHA && s->integrator.substeps == 1 &&
           s->coupling.scheme != SPAR_COUPLING_EXPLICIT && (s->fluids || spari_comm_size(s->ranks.comm) > 1);
}

static int predict_nodes(spari_component *p, spari_guess stays) {
    double *x = p->solver->increment;
    spari_anderson_begin(p->solver->anderson);
    p->solver->start.at_start = starts_again(p);
    if (p->scheme.still) {
        spari_alpha_carry(p->solver, p->member, &p->scheme, &p->stage.root, p->stage.rotation, &p->stage.ends, x);
        return stays != SPARI_KEEP_SHAPE;
    }
    return spari_alpha_predict(p->solver, p->member, &p->scheme, stays, &p->stage.ends, x);
}

static void subtract_loads(void *context, int64_t from, int64_t to) {
    const spari_solver *s = context;
    for (int64_t i = 6 * from; i < 6 * to; i++) {
        s->r[i] -= s->steps.load[i];
    }
}

void spari_component_impose_root(spari_component *p) {
    spari_alpha_impose_root(p->member, &p->stage.root, &p->stage.ends, p->solver->increment);
}

/* Forces of the body, and their scale, at a state whose q, v and a are one block. */
static double body_forces(spari_solver *s, const spari_state *at, int still) {
    const spari_body *body = s->body;
    spari_start_forces *k = &s->start;
    const size_t state = (size_t)(19 * s->n) * sizeof *at->q, forces = (size_t)(6 * s->n) * sizeof *s->r;
    const int at_start = k->at_start;
    k->at_start = 0;
    if (at_start && k->known && memcmp(k->gravity, body->gravity, sizeof k->gravity) == 0 &&
        memcmp(k->state, at->q, state) == 0) {
        memcpy(s->r, k->forces, forces);
        s->power = k->power;
        return k->scale;
    }
    double scale =
        spari_body_residual(body, at->q, still && !body->D ? NULL : at->v, still ? NULL : at->a, 1, s->r, &s->power);
    if (at_start) {
        memcpy(k->gravity, body->gravity, sizeof k->gravity);
        memcpy(k->state, at->q, state);
        memcpy(k->forces, s->r, forces);
        k->scale = scale, k->power = s->power, k->known = 1;
    }
    return scale;
}

static double balance_nodes(spari_component *p) {
    spari_solver *s = p->solver;
    const spari_state *at = &p->stage.ends.absolute;
    spari_component_impose_root(p);
    double scale = body_forces(s, at, p->scheme.still);
    spari_solver_spread(s, subtract_loads, s);
    if (spari_solver_has_applied(s, p->member)) {
        scale = fmax(scale, spari_applied_residual(p->member, at->q, 1, s->r));
    }
    if (s->offset_loads) {
        spari_offset_loads_residual(s->offset_loads, at->q + 3, s->r + 3);
    }
    if (p->member->added) {
        scale = fmax(scale, spari_added_times(p->member, SPARI_UNKNOWNS, SPARI_UNKNOWNS, at->a, 1, s->r));
    }
    spari_member_constrain(p->member, s->n, s->r);
    return scale;
}

/* Forces and corrections in the axes of the tangent. */
typedef struct node_rotation {
    const spari_solver *s;
    spari_node_work work;
} node_rotation;

static void rotate_span_back(void *context, int64_t from, int64_t to) {
    const node_rotation *t = context;
    t->s->most[from / SPARI_SPAN] = spari_nodes_rotate_back(&t->work, from, to);
}

static void rotate_span_forth(void *context, int64_t from, int64_t to) {
    const node_rotation *t = context;
    spari_nodes_rotate_forth(&t->work, from, to);
}

static node_rotation rotation_since_tangent(const spari_component *p) {
    const spari_solver *s = p->solver;
    return (node_rotation){s,
                           {.lanes = s->body->lanes,
                            .dx = s->dx,
                            .tangent_q = s->tangent_q,
                            .q = p->state->q,
                            .r = s->r,
                            .per_length = 1 / s->body->length,
                            .rotation = s->rotation}};
}

/* The nodes have rotated since the reused tangent was formed. Forces are therefore rotated back node by node, and the
   corrections forward. For a rigid rotation of the member this is exact. For a beam that oscillates and bends, one
   tangent then lasts some forty times longer than in fixed axes.
   Returns the largest force, moments over the length, infinite if one is not finite. */
static double rotate_back(const spari_component *p) {
    node_rotation t = rotation_since_tangent(p);
    spari_solver_spread(p->solver, rotate_span_back, &t);
    return spari_solver_most(p->solver);
}

/* Whether all nodes are interface nodes, as in a rigid body. Its forces and corrections then stay in global axes: the
   system rotates the tangent. */
static int is_all_ends(const spari_component *p) {
    return p->condensed && p->condensed->length == 0;
}

/* As rotate_back. */
static double size_of_residual(const spari_component *p) {
    const spari_solver *s = p->solver;
    double most = 0, poison = 0;
    const double per_length = 1 / s->body->length;
    if (!is_all_ends(p)) {
        return rotate_back(p);
    }
    for (int k = 0; k < 6 * s->n; k++) {
        double size = fabs(k % 6 < 3 ? s->r[k] : per_length * s->r[k]);
        most = size > most ? size : most;
        poison += 0 * size;
    }
    return isfinite(poison) ? most : INFINITY;
}

void spari_component_find_rotations(const spari_component *p) {
    const spari_solver *s = p->solver;
    for (int i = 0; i < s->n && is_all_ends(p); i++) {
        double back[4];
        spari_quat_conj(s->tangent_q + 4 * i, back);
        spari_quat_mul(p->state->q + 7 * i + 3, back, s->rotation + 4 * i);
    }
}

static int form_tangent(const spari_component *p, const spari_state *at) {
    spari_solver *s = p->solver;
    const spari_scheme *c = &p->scheme;
    const double *v = c->still && !s->body->D ? NULL : at->v, *a = c->still ? NULL : at->a;
    return spari_solver_factor(s, p->member, &(spari_tangent_at){at->q, v, a, s->tinv, 1, c->cm, c->cv, NULL, NULL});
}

static int tangent_of_nodes(spari_component *p) {
    spari_solver *s = p->solver;
    const spari_mixed_points *m = &s->mixed;
    const spari_body *body = s->body;
    spari_body mixed = *body;
    spari_alpha_operators(s, &p->scheme, &p->stage.ends, s->increment);
    if (m->on) {
        spari_body_mixed_strains(body, m->q, m->dx, m->part, m->strain);
        mixed.mixed_strain = m->strain;
        s->body = &mixed;
    }
    int singular = form_tangent(p, &p->stage.ends.absolute);
    s->body = body;
    if (singular) {
        return 1;
    }
    (void)size_of_residual(p); /* the axes of the tangent are new */
    spari_anderson_begin(s->anderson);
    return 0;
}

static int nodes_serve(const spari_component *p) {
    const spari_solver *s = p->solver;
    return s->factored && spari_alpha_close(p->scheme.cm, s->tangent_cm) &&
           spari_alpha_close(p->scheme.cv, s->tangent_cv);
}

int spari_component_reduce(spari_component *p, int rotated, double *x) {
    const spari_condensed *c = p->condensed;
    spari_solver *s = p->solver;
    if (is_all_ends(p)) {
        for (int k = 0; k < 6 * s->n; k++) {
            x[k] = k < c->fixed ? 0 : s->r[k];
        }
        return 0;
    }
    if (!rotated) {
        (void)rotate_back(p);
    }
    if (spari_condensed_reduce(c, s->linear, s->dx)) {
        return 1;
    }
    for (int k = 0; k < 6 * c->ends; k += 3) {
        int node = c->node[k / 6];
        spari_rotate(spari_component_rotation(p, node), s->dx + 6 * node + k % 6, x + k);
    }
    return 0;
}

void spari_component_clear(spari_component *p) {
    spari_solver *s = p->solver;
    if (is_all_ends(p)) {
        return;
    }
    (void)rotate_back(p); /* for the rotations */
    memset(s->dx, 0, (size_t)(6 * s->n) * sizeof *s->dx);
}

static void rotate_forth(spari_component *p) {
    node_rotation t = rotation_since_tangent(p);
    spari_solver_spread(p->solver, rotate_span_forth, &t);
}

void spari_component_expand(spari_component *p, const double *x) {
    const spari_condensed *c = p->condensed;
    spari_solver *s = p->solver;
    if (is_all_ends(p)) {
        memcpy(s->dx, x, (size_t)(6 * s->n) * sizeof *x);
        return;
    }
    for (int k = 0; k < 6 * c->ends; k += 3) {
        int node = c->node[k / 6];
        spari_rotate_back(spari_component_rotation(p, node), x + k, s->dx + 6 * node + k % 6);
    }
    spari_condensed_expand(c, s->dx);
    rotate_forth(p);
}

static double correction_of_nodes(const spari_component *p) {
    return spari_alpha_size(p->solver, p->solver->dx);
}

double spari_component_correct(spari_component *p, double cut) {
    spari_solver *s = p->solver;
    for (int k = 0; k < 6 * s->n && cut < 1; k++) {
        s->dx[k] *= cut;
    }
    s->newton++;
    if (s->mixed.on) {
        spari_solver_remember_correction(s, p->stage.ends.absolute.q, NULL);
    }
    return p->stage.ends.root_motion +
           spari_alpha_correct(s, p->member, &p->scheme, &p->stage.ends, NULL, INFINITY, s->increment, s->dx).motion;
}

/* ---- an iteration of a member without joints ---- */

static int solve_nodes(spari_component *p) {
    (void)rotate_back(p);
    int singular = spari_linear_solve(p->solver->linear, p->solver->dx);
    rotate_forth(p);
    return singular;
}

static int correct_nodes(spari_component *p) {
    const spari_solver *s = p->solver;
    if (spari_linear_solve(s->linear, s->dx)) {
        return 1;
    }
    spari_anderson_step(s->anderson, s->body->pool ? *s->body->pool : NULL, s->body->lanes, s->body->length, s->dx);
    return 0;
}

static double advance_nodes(spari_component *p, double longest, double *motion) {
    spari_solver *s = p->solver;
    if (s->mixed.on) {
        spari_solver_remember_correction(s, p->stage.ends.absolute.q, s->rotation);
    }
    const spari_corrected size =
        spari_alpha_correct(s, p->member, &p->scheme, &p->stage.ends, s->rotation, longest, s->increment, s->dx);
    s->mixed.part = size.by > longest ? longest / size.by : 1;
    s->newton++;
    *motion = size.motion + p->stage.ends.root_motion;
    return size.by;
}

/* Of the tangent of one member (spari_tangent_serves_on). */
enum { PATIENCE = 5, PRICE = 10 };

static void end_solution_of_nodes(spari_component *p, int iterations, spari_tangents tangents) {
    spari_solver *s = p->solver;
    if (iterations == 0) {
        s->factored = 0;
        return;
    }
    spari_alpha_impose_root(p->member, &p->stage.root, &p->stage.ends, s->increment);
    s->factored =
        spari_tangent_serves_on(&s->reuse, PATIENCE, PRICE, iterations, tangents) && !p->member->session->state.renew;
    if (!s->factored) { /* for a response */
        spari_alpha_operators(s, &p->scheme, &p->stage.ends, s->increment);
    }
}

static int tangent_after_step(spari_component *p) {
    return p->solver->factored ? 0 : form_tangent(p, &p->solver->to);
}

void spari_component_shift_rates(spari_component *p, double v, double a, double b) {
    spari_solver *s = p->solver;
    for (int k = 0; k < 6 * s->n; k += 3) {
        if (p->stage.ends.root) {
            spari_rotate_back(p->stage.ends.root->q + 3, s->dx + k, s->dx + k);
        }
    }
    spari_alpha_shift_rates(s, &p->scheme, &p->stage.ends, v, a, b);
    spari_root_show(s, p->member, &p->stage.ends);
}

/* ---- response to loads ---- */

static void apply_load_to_nodes(spari_component *p, const double *load) {
    p->member->row->apply_load(p->member, load, p->solver->r);
    spari_member_constrain(p->member, p->solver->n, p->solver->r);
}

/* The mass alone takes part: damping is small beside it, and what S lacks then the coupling measures. */
static void carry_over_nodes(spari_component *p, double part) {
    spari_solver *s = p->solver;
    spari_body inert = *s->body;
    double *rest = s->best, *force = s->steps.load;
    const double carried = spari_scheme_carried(&p->scheme);
    inert.C = inert.D = inert.pre = NULL;
    inert.gyroscopic = 0;
    memset(rest, 0, (size_t)(6 * s->n) * sizeof *rest);
    (void)spari_body_residual(&inert, s->to.q, rest, s->dx, 0, force, NULL);
    for (int i = 0; i < 6 * s->n; i++) {
        s->r[i] = part * s->r[i] + carried * force[i];
    }
    if (p->member->added) {
        (void)spari_added_times(p->member, SPARI_UNKNOWNS, SPARI_UNKNOWNS, s->dx, carried, s->r);
    }
    spari_member_constrain(p->member, s->n, s->r);
}

static void response_of_nodes(spari_component *p, double *motion) {
    p->member->row->get_response(p->member, p->solver->dx, motion);
}

static void restore_nodes(spari_component *p) {
    spari_solver *s = p->solver;
    p->scheme = spari_scheme_last(p->member, s->body->D != NULL, &s->steps.solved);
    p->stage.ends = (spari_ends){s->from, s->to, s->to, NULL, 0};
    p->state = &p->stage.ends.absolute;
}

/* ---- consistent initial accelerations ---- */

static int start_nodes(spari_component *p) {
    spari_solver *s = p->solver;
    int end = spari_member_constrained(p->member);
    if (p->member->root != SPAR_ROOT_DRIVEN) {
        memset(s->begin.a, 0, (size_t)end * sizeof(double));
        memset(s->begin.v, 0, (size_t)end * sizeof(double));
    }
    p->state = &s->begin;
    p->stage.ends = (spari_ends){s->begin, s->begin, s->begin, NULL, 0};
    return spari_solver_factor(s, p->member, &(spari_tangent_at){.q = s->begin.q, .cm = p->scheme.cm});
}

/* At t^0. Also computes the damping power. */
static void unbalance_nodes(spari_component *p) {
    spari_solver *s = p->solver;
    const spari_state *b = &s->begin;
    spari_body_residual(s->body, b->q, b->v, b->a, 1, s->r, s->body->D ? &s->power_begin : NULL);
    if (spari_solver_has_applied(s, p->member)) {
        spari_applied_residual(p->member, b->q, 1, s->r);
    }
    if (s->offset_loads) {
        spari_offset_loads_at(s->offset_loads, 0);
        spari_offset_loads_residual(s->offset_loads, b->q + 3, s->r + 3);
    }
    for (int i = 0; i < 6 * s->n; i++) {
        s->r[i] -= s->steps.load0[i];
    }
    spari_member_constrain(p->member, s->n, s->r);
}

static void correct_start_of_nodes(spari_component *p) {
    spari_solver *s = p->solver;
    for (int n = 0; n < 6 * s->n; n++) {
        s->begin.a[n] -= p->scheme.cm * s->dx[n];
    }
}

static void end_start_of_nodes(spari_component *p) {
    spari_solver *s = p->solver;
    spari_stage_remember(s, p->member, &p->scheme);
    s->steps.started = 1;
    s->factored = 0;
}

/* ---- equilibrium ---- */

static void begin_static_of_nodes(spari_component *p, const double *fluid, int onward) {
    spari_solver *s = p->solver;
    p->member->row->take_static(p->member, fluid);
    if (!onward) {
        memcpy(s->to.q, s->begin.q, (size_t)(7 * s->n) * sizeof *s->to.q);
    }
    memset(s->to.v, 0, (size_t)(18 * s->n) * sizeof *s->to.v);
    p->state = &s->to;
    p->stage.ends = (spari_ends){s->to, s->to, s->to, NULL, 0};
}

/* Rates of the nodes at their present positions, in the steady rotation of the member. */
static void rotate_nodes(spari_component *p, double f) {
    const spari_state *to = &p->solver->to;
    if (p->rotating) {
        spari_rotating_frame_nodes(p->rotating, f, p->member, p->solver->n, to->q, to->v, to->a);
    }
}

static int rotates_with_mass(const spari_component *p) {
    return p->rotating && p->solver->body->mass && (p->member->effects & SPAR_EFFECT_INERTIA);
}

static double balance_nodes_static(spari_component *p, double f) {
    spari_solver *s = p->solver;
    const spari_body body = spari_body_in_part(s->body, f);
    rotate_nodes(p, f);
    double scale = rotates_with_mass(p) ? spari_steady_rotation_residual(&body, s->to.q, s->to.v, s->to.a, f, s->r)
                                        : spari_body_residual(&body, s->to.q, NULL, NULL, f, s->r, NULL);
    for (int k = 0; k < 6 * s->n; k++) {
        s->r[k] -= f * s->steps.load[k];
        scale = fmax(scale, fabs(f * s->steps.load[k]));
    }
    if (spari_solver_has_applied(s, p->member)) {
        scale = fmax(scale, spari_applied_residual(p->member, s->to.q, f, s->r));
    }
    if (s->offset_loads) {
        spari_offset_loads_at(s->offset_loads, f);
        spari_offset_loads_residual(s->offset_loads, s->to.q + 3, s->r + 3);
    }
    spari_member_constrain(p->member, s->n, s->r);
    return scale;
}

static spari_tangent_at tangent_static(const spari_component *p, double f, spari_steady_rotation *rotation) {
    const spari_solver *s = p->solver;
    spari_tangent_at t = {.q = s->to.q, .factor = f};
    if (rotates_with_mass(p)) {
        *rotation = spari_steady_rotation_part(&p->rotating->rotation, f);
        t.v = s->to.v, t.a = s->to.a;
        t.rotation = rotation, t.mass = p->rotating->mass;
    }
    return t;
}

static int tangent_of_nodes_static(spari_component *p, double f) {
    const spari_body body = spari_body_in_part(p->solver->body, f), *whole = p->solver->body;
    spari_steady_rotation rotation;
    const spari_tangent_at t = tangent_static(p, f, &rotation);
    p->solver->body = &body;
    int singular = spari_solver_factor(p->solver, p->member, &t);
    p->solver->body = whole;
    return singular;
}

static int definite_static(spari_component *p, double f) {
    const spari_body body = spari_body_in_part(p->solver->body, f), *whole = p->solver->body;
    spari_steady_rotation rotation;
    const spari_tangent_at t = tangent_static(p, f, &rotation);
    p->solver->body = &body;
    spari_solver_form(p->solver, p->member, &t);
    p->solver->body = whole;
    return spari_linear_definite(p->solver->linear);
}

static void shift_nodes(spari_component *p, double cut) {
    spari_static_shift(p->solver->n, cut, p->solver->dx, p->solver->to.q);
}

static void keep_positions_of_nodes(spari_component *p, int back) {
    spari_solver *s = p->solver;
    memcpy(back ? s->to.q : s->best, back ? s->best : s->to.q, (size_t)(7 * s->n) * sizeof(double));
}

static void discard_static_of_nodes(spari_component *p) {
    spari_solver *s = p->solver;
    spari_snapshot_close(&s->before);
    memcpy(s->to.q, s->begin.q, (size_t)(25 * s->n) * sizeof(double));
    s->factored = 0;
}

static void end_static_of_nodes(spari_component *p) {
    keep_positions_of_nodes(p, 1);
    rotate_nodes(p, 1);
    p->solver->factored = 0;
    spari_snapshot_close(&p->solver->before);
    p->member->row->publish(p->member);
}

const spari_component_row spari_component_body = {
    .attach = attach_nodes,
    .take = begin_loads_of_nodes,
    .begin = begin_nodes,
    .enter = enter_nodes,
    .stage = stage_of_nodes,
    .end = end_nodes,
    .predict = predict_nodes,
    .balance = balance_nodes,
    .residual_size = size_of_residual,
    .tangent = tangent_of_nodes,
    .serves = nodes_serve,
    .correction_size = correction_of_nodes,
    .solve = solve_nodes,
    .correct_newton = correct_nodes,
    .advance = advance_nodes,
    .end_solution = end_solution_of_nodes,
    .tangent_after = tangent_after_step,
    .apply_load = apply_load_to_nodes,
    .carry_over = carry_over_nodes,
    .get_response = response_of_nodes,
    .restore_end = restore_nodes,
    .start = start_nodes,
    .unbalance = unbalance_nodes,
    .correct_start = correct_start_of_nodes,
    .end_start = end_start_of_nodes,
    .begin_static = begin_static_of_nodes,
    .balance_static = balance_nodes_static,
    .tangent_static = tangent_of_nodes_static,
    .definite_static = definite_static,
    .shift = shift_nodes,
    .keep_positions = keep_positions_of_nodes,
    .discard_static = discard_static_of_nodes,
    .end_static = end_static_of_nodes,
};

/* ---- operations of the table of fidelities ---- */

static spari_solver *solver_of(const spar_member *m) {
    return m->row->solver(m);
}

void spari_body_remass(spar_member *m) {
    spari_solver *s = solver_of(m);
    if (s) {
        s->factored = 0;
        s->start.known = 0;
    }
}

void spari_body_begin(spar_member *m) {
    spari_solver_begin(solver_of(m));
}

void spari_body_accept(spar_member *m) {
    spari_solver_accept(solver_of(m));
}

void spari_body_reject(spar_member *m) {
    spari_solver_reject(solver_of(m));
}

void spari_body_effort(const spar_member *m, spari_effort *effort) {
    spari_solver_effort(solver_of(m), effort);
}

int64_t spari_body_state_size(const spar_member *m) {
    return spari_solver_state_size(solver_of(m));
}

void spari_body_save(const spar_member *m, double *state) {
    spari_solver_save(solver_of(m), state);
}

int spari_body_is_state(const spar_member *m, const double *state, int64_t count) {
    return spari_solver_is_state(solver_of(m), state, count);
}

void spari_body_load(spar_member *m, const double *state) {
    spari_solver_load(solver_of(m), state);
}
