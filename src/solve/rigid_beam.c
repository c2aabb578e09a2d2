/* The rigid beam: its nodes follow one body at the root, which has the mass of the whole beam. The solver of rigid
   bodies advances it. */
#include "rigid_beam.h"

#include "../algebra/pencil.h"
#include "../math/rotation.h"
#include "../member/applied_loads.h"
#include "../member/beam.h"
#include "../time/component.h"
#include "../time/fidelity.h"
#include "../time/steady_rotation.h"
#include "reaction.h"
#include "rigid_nodes.h"

#include <stdlib.h>
#include <string.h>

/* ---- description ---- */

static int rigid_check(const spar_member *m) {
    SPARI_REQUIRE(m->session, m->beam->mass, SPAR_ERR_STATE,
                  "member '%s' has no mass, which a rigid member needs; give its sections mass", m->name);
    return SPAR_OK;
}

static int rigid_effects(const spar_member *m, int effects) {
    (void)m; /* the same for every root */
    return effects & ~SPAR_EFFECT_DAMPING;
}

/* ---- the body that carries it ---- */

/* Adds the mass m[10] of weight w at x: mass, first and second moments about the root. */
static void add_mass(double w, const double *m, const double *x, const double root[3], double out[10]) {
    double a[3] = {x[0] - root[0], x[1] - root[1], x[2] - root[2]}, ac = spari_dot(a, m + 1), aa = spari_dot(a, a);
    out[0] += w * m[0];
    for (int i = 0; i < 3; i++) {
        out[1 + i] += w * (m[0] * a[i] + m[1 + i]);
    }
    /* J + (m a.a + 2 a.mc) I - m a a^T - a mc^T - mc a^T */
    static const int row[6] = {0, 0, 0, 1, 1, 2}, col[6] = {0, 1, 2, 1, 2, 2};
    for (int t = 0; t < 6; t++) {
        int i = row[t], j = col[t];
        out[4 + t] +=
            w * (m[4 + t] + (i == j ? m[0] * aa + 2 * ac : 0) - m[0] * a[i] * a[j] - a[i] * m[1 + j] - m[1 + i] * a[j]);
    }
}

/* The same of the whole beam, from its quadrature. */
static void whole_mass(const spari_body *beam, const double root[3], double out[10]) {
    memset(out, 0, 10 * sizeof *out);
    for (int e = 0; e < beam->elements; e++) {
        for (int k = beam->first[e]; k < beam->first[e + 1]; k++) {
            int64_t slot = beam->slot[e] + k - beam->first[e];
            double m[10];
            spari_slot_get(beam->mass, 10, slot, m);
            add_mass(beam->weight[slot], m, beam->position + 3 * (int64_t)k, root, out);
        }
    }
}

static void rigid_free(void *solution) {
    spari_rigid_beam *b = solution;
    if (b) {
        spari_body_free(b->body);
        spari_solver_free(b->solver);
        free(b);
    }
}

static int rigid_create(spar_member *m) {
    spari_rigid_beam *b = m->solution = spari_zalloc(1, sizeof *b);
    if (!b) {
        return SPAR_ERR_MEMORY;
    }
    spari_body *body = b->body =
        spari_body_create(1, 1, (const int[]){1}, 0, 0, 1, &m->session->bodies, &m->session->pool);
    if (!body) {
        return SPAR_ERR_MEMORY;
    }
    body->phi[0] = body->weight[0] = 1;
    body->gyroscopic = (m->effects & SPAR_EFFECT_GYROSCOPIC) != 0;
    body->length = m->body->length;
    memcpy(body->position, m->xr, 3 * sizeof(double));
    if (m->body->mass) { /* else neither inertia nor weight is in force */
        double mass[10];
        whole_mass(m->body, m->xr, mass);
        spari_slot_put(body->mass, 10, 0, mass);
    }
    spari_body_complete(body);
    b->offset_loads.gravity = body->gravity;
    if (spari_fidelity_is_here(m)) {
        b->solver = spari_solver_create(m, body, &b->offset_loads);
        return b->solver ? SPAR_OK : SPAR_ERR_MEMORY;
    }
    return SPAR_OK;
}

/* ---- time ---- */

/* Sums nodal loads to force and moment on the root, and to first moments of the forces over the reference offsets. */
static void sum_on_root(const spar_member *m, const double *load, double sum[6], double moments[9]) {
    for (int64_t i = 0; i < m->nodes; i++) {
        const double *f = load + 6 * i;
        for (int k = 0; k < 6; k++) {
            sum[k] += f[k];
        }
        for (int r = 0; r < 3; r++) {
            double arm = m->xr[3 * i + r] - m->xr[r];
            for (int c = 0; c < 3; c++) {
                moments[3 * r + c] += arm * f[c];
            }
        }
    }
}

static void rigid_restart(spar_member *m) {
    const spari_rigid_beam *b = m->solution;
    spari_solver *s = b->solver;
    memcpy(s->begin.q, m->now.q, 7 * sizeof(double));
    memcpy(s->begin.v, m->now.v, 6 * sizeof(double));
    memcpy(s->begin.a, m->now.a, 6 * sizeof(double));
    spari_solver_restart(s);
}

/* Loads at one end of the step, with the part `left` of the step still to come: load [6] on the root, and first
   moments. They contain fluid loads, dead loads, and the member's applied loads at the motion q of its nodes. */
static void loads_on_root(const spar_member *m, const double *fluid, double left, const double *q, double *load,
                          double moments[9]) {
    double dead[6] = {0}, dead_moments[9] = {0}, *workspace = spari_body_scratch(m->body);
    memset(load, 0, 6 * sizeof *load);
    memset(moments, 0, 9 * sizeof *moments);
    sum_on_root(m, left > 0 ? spari_dead_before(m) : m->load.dead, dead, dead_moments);
    sum_on_root(m, fluid, load, moments);
    if (m->load.applied) {
        memset(workspace, 0, (size_t)(6 * m->nodes) * sizeof *workspace);
        spari_applied_at(m, left);
        spari_applied_nodal(m, q, workspace);
        spari_applied_at(m, 0);
        sum_on_root(m, workspace, load, moments);
    }
    for (int k = 0; k < 6; k++) {
        load[k] += dead[k];
    }
    for (int k = 0; k < 9; k++) {
        moments[k] += dead_moments[k];
    }
}

/* Follower loads are evaluated at the motion of the last pass. A few passes converge. */
enum { PASSES = 20 };

static int rigid_repeat(spar_member *m, double dt, int (*advance)(spar_member *m, double dt)) {
    const spari_rigid_beam *b = m->solution;
    const spari_solver *s = b->solver;
    double before[7], *q = s->begin.q, change = 1;
    for (int pass = 0; pass < PASSES && change >= 1e-13; pass++) {
        memcpy(before, q, sizeof before);
        if (m->load.applied) {
            const spari_pose last = spari_pose_of(q, s->to.v, s->to.a);
            spari_rigid_nodes_move(m, &last, &m->after);
        }
        SPARI_TRY(advance(m, dt));
        q = s->to.q;
        change = 0;
        for (int k = 0; k < 7 && m->load.applied; k++) {
            change = fmax(change, fabs(q[k] - before[k]));
        }
    }
    return SPAR_OK;
}

/* Of a node from the root, in the motion after. */
static void arm_after(const spar_member *m, int64_t node, double arm[3]) {
    for (int k = 0; k < 3; k++) {
        arm[k] = m->xr[3 * node + k] + m->after.q[7 * node + k] - m->xr[k] - m->after.q[k];
    }
}

/* Adds a load to force and moment on the root, with the rotated offsets. */
static void rigid_apply_load(spar_member *m, const double *load, double *sum) {
    double moments[9] = {0};
    memset(sum, 0, 6 * sizeof *sum);
    sum_on_root(m, load, sum, moments);
    for (int64_t i = 0; i < m->nodes; i++) {
        double arm[3], moment[3];
        arm_after(m, i, arm);
        spari_cross(arm, load + 6 * i, moment);
        for (int k = 0; k < 3; k++) {
            sum[3 + k] += moment[k];
        }
    }
}

static void rigid_get_response(spar_member *m, const double *root, double *motion) {
    spari_rigid_nodes_displace(m, root, motion);
}

/* The same force and moment on the root, without its reaction, from equal forces and equal moments on all nodes. */
static int rigid_effective_load(spar_member *m, double *load) {
    double sum[6], middle[3] = {0}, moment[3];
    rigid_apply_load(m, load, sum);
    memset(sum, 0, (size_t)spari_member_constrained(m) * sizeof *sum);
    for (int64_t i = 0; i < m->nodes; i++) {
        double arm[3];
        arm_after(m, i, arm);
        for (int k = 0; k < 3; k++) {
            middle[k] += arm[k] / (double)m->nodes;
        }
    }
    spari_cross(middle, sum, moment);
    for (int64_t i = 0; i < 6 * m->nodes; i++) {
        int k = (int)(i % 6);
        load[i] = (sum[k] - (k < 3 ? 0 : moment[k - 3])) / (double)m->nodes;
    }
    return SPAR_OK;
}

/* ---- tied by joints ---- */

static spari_solver *rigid_solver(const spar_member *m) {
    const spari_rigid_beam *b = m->solution;
    return b->solver;
}

/* Follower loads are evaluated at the latest iterate. */
static void rigid_take_loads(spar_member *m) {
    spari_rigid_beam *b = m->solution;
    memcpy(b->body->gravity, m->body->gravity, sizeof b->body->gravity);
    loads_on_root(m, m->load.history[0], 1, m->now.q, b->solver->steps.load0, b->offset_loads.begin);
    loads_on_root(m, m->load.used, 0, m->after.q, b->solver->steps.load1, b->offset_loads.end);
}

static void rigid_take_static(spar_member *m, const double *fluid) {
    spari_rigid_beam *b = m->solution;
    memcpy(b->body->gravity, m->body->gravity, sizeof b->body->gravity);
    loads_on_root(m, fluid, 0, m->now.q, b->solver->steps.load, b->offset_loads.end);
    memset(b->offset_loads.begin, 0, sizeof b->offset_loads.begin);
}

static void rigid_publish(spar_member *m) {
    const spari_solver *s = rigid_solver(m);
    const spari_pose root = spari_pose_of(s->to.q, s->to.v, s->to.a);
    spari_rigid_nodes_move(m, &root, &m->after);
}

/* ---- energy and modes ---- */

/* A body that does not deform has no strain energy, to the last digit. */
static int rigid_energy(const spar_member *m, double energy[4]) {
    SPARI_TRY(spari_energy_of_body(m, energy));
    energy[1] = 0;
    return SPAR_OK;
}

static int64_t rigid_unknowns(const spar_member *m) {
    return 6 - spari_member_constrained(m);
}

/* What modes and small motions of the state start from: the loads on the root, sum [6] and first moments, and its
   steady rotation. */
typedef struct rigid_state {
    double sum[6], v[6], a[6];
    spari_offset_loads moments;
    spari_steady_rotation rotation;
    int rotating;
} rigid_state;

static int rigid_state_of(const spar_member *m, rigid_state *at) {
    const spari_rigid_beam *b = m->solution;
    double *load = spari_zalloc(6 * m->nodes, sizeof *load);
    *at = (rigid_state){.rotating = 0};
    if (!load) {
        return SPAR_ERR_MEMORY;
    }
    int status = spar_member_get_loads(m, load);
    sum_on_root(m, load, at->sum, at->moments.Z);
    free(load);
    at->rotating = spari_steady_rotation_of(m, m->after.v, m->after.a, &at->rotation);
    for (int k = 0; k < 3; k++) {
        at->v[k] = at->rotation.v0[k], at->v[3 + k] = at->rotation.w[k];
        at->a[k] = at->rotation.a0[k];
    }
    memcpy(b->body->gravity, m->body->gravity, sizeof b->body->gravity);
    return status;
}

static int rigid_problem(const spar_member *m, spari_pencil *to) {
    const spari_rigid_beam *b = m->solution;
    double S[36], mass[36];
    rigid_state at;
    SPARI_TRY(rigid_state_of(m, &at));
    spari_steady_rotation_tangent(b->body, at.rotating ? &at.rotation : NULL, 0, m->after.q, at.v, at.a, 1, S, mass);
    spari_offset_loads_tangent(&at.moments, m->after.q + 3, S);
    spari_pencil_add_symmetric(to, -spari_member_constrained(m), 6, S, mass);
    return SPAR_OK;
}

static int rigid_linearise(const spar_member *m, const double w[3], spari_pencil *to) {
    const spari_rigid_beam *b = m->solution;
    double K[36], C[36], M[36], r[6];
    rigid_state at;
    SPARI_TRY(rigid_state_of(m, &at));
    const int constrained = spari_member_constrained(m), rotating = at.rotating || spari_norm(w) > 0;
    const double *v = rotating ? at.v : NULL, *a = rotating ? at.a : NULL;
    spari_steady_rotation_pencil(b->body, w, at.rotation.w, 0, m->after.q, v, a, K, C, M);
    spari_offset_loads_tangent(&at.moments, m->after.q + 3, K);
    spari_pencil_add(to, -constrained, 6, 6, K, C, M);
    to->scale = fmax(to->scale, spari_body_residual(b->body, m->after.q, v, a, 1, r, NULL));
    spari_offset_loads_residual(&at.moments, m->after.q + 3, r + 3);
    for (int k = 0; k < 6; k++) {
        r[k] -= at.sum[k];
        to->scale = fmax(to->scale, fabs(at.sum[k]));
    }
    spari_pencil_set_forces(to, -constrained, 6, r);
    return SPAR_OK;
}

static void rigid_shape(const spar_member *m, const double *x, double *workspace, double *nodes) {
    memset(workspace, 0, 6 * sizeof *workspace);
    memcpy(workspace + spari_member_constrained(m), x, (size_t)rigid_unknowns(m) * sizeof *workspace);
    spari_rigid_nodes_displace(m, workspace, nodes);
}

const spari_fidelity spari_fidelity_rigid = {
    .moves = 1,
    .solved = 1,
    .whole = 1,
    .frame = SPARI_FRAME_PRESCRIBED,
    .check = rigid_check,
    .effects = rigid_effects,
    .create = rigid_create,
    .free = rigid_free,
    .restart = rigid_restart,
    .repeat = rigid_repeat,
    .effective_load = rigid_effective_load,
    .effective_here = 1,
    .equilibrium = spari_rigid_nodes_equilibrium,
    .reaction_size = spari_reaction_of_whole_size,
    .reaction = spari_reaction_of_whole,
    .energy = rigid_energy,
    .unknowns = rigid_unknowns,
    .problem = rigid_problem,
    .shape = rigid_shape,
    .linearise = rigid_linearise,
    SPARI_BODY_ROW,
    .solver = rigid_solver,
    .take_loads = rigid_take_loads,
    .take_static = rigid_take_static,
    .apply_load = rigid_apply_load,
    .get_response = rigid_get_response,
    .publish = rigid_publish,
};
