/* Linear and modal beams: creation of their frames, and their rows of the table of fidelities. */
#include "frame.h"

#include "../base/session.h"
#include "../member/added_mass.h"
#include "../member/applied_loads.h"
#include "../member/beam.h"
#include "../solve/reaction.h"
#include "../time/component.h"
#include "../time/fidelity.h"

#include <stdlib.h>

/* ---- life ---- */

static int carve_states(spari_frame *f) {
    spari_frame_state *states[3] = {&f->begin, &f->from, &f->to};
    for (int k = 0; k < 3; k++) {
        double *block = spari_zalloc(4 * (int64_t)f->n, sizeof *block);
        if (!block) {
            return 1;
        }
        states[k]->y = block, states[k]->v = block + f->n;
        states[k]->a = block + 2 * f->n, states[k]->b = block + 3 * f->n;
        states[k]->root.q[3] = 1;
    }
    return 0;
}

static int allocate_matrices(spari_frame *f, const spar_member *m) {
    int rotates = m->root == SPAR_ROOT_DRIVEN && (m->effects & SPAR_EFFECT_INERTIA), ok = 1;
    double **matrices[] = {&f->K, &f->M, &f->D, &f->A};
    const int wanted[] = {1, m->body->mass != NULL, m->body->D != NULL, m->added != NULL};
    for (int k = 0; k < 4; k++) {
        ok = ok && (!wanted[k] || (*matrices[k] = spari_zalloc(f->size, sizeof(double))));
    }
    for (int k = 0; k < SPARI_SPIN_PRODUCTS; k++) {
        ok = ok && (!rotates || ((f->N[k] = spari_zalloc(f->size, sizeof(double))) &&
                                 (f->f[k] = spari_zalloc(6 * (int64_t)f->nodes, sizeof(double)))));
        ok = ok && (!f->M || (f->rigid[k] = spari_zalloc(6 * (int64_t)f->nodes, sizeof(double))));
    }
    ok = ok && (!m->body->pre || (f->pull = spari_zalloc(6 * (int64_t)f->nodes, sizeof *f->pull)));
    for (int k = 0; k < 3; k++) {
        ok = ok && (!rotates || (f->G[k] = spari_zalloc(f->size, sizeof(double))));
        ok = ok && (!rotates || (f->E[k] = spari_zalloc(f->size, sizeof(double))));
    }
    ok = ok && (f->linear = spari_linear_create(f->elements, f->block, f->overlap));
    return ok && !spari_linear_weigh(f->linear, m->body->length > 0 ? 1 / m->body->length : 1) ? 0 : 1;
}

static int allocate_work(spari_frame *f, const spar_member *m) {
    int64_t wide = f->n > 6 * f->nodes ? f->n : 6 * (int64_t)f->nodes;
    double **vectors[] = {&f->steps.load, &f->steps.load0, &f->steps.load1, &f->r,       &f->dx,
                          &f->increment,  &f->stage_v,     &f->loads,       &f->elastic, &f->positions};
    int ok = carve_states(f) == 0;
    for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++) {
        ok = ok && (*vectors[k] = spari_zalloc(wide, sizeof(double)));
    }
    ok = ok && (f->nodal = spari_zalloc(18 * (int64_t)f->nodes, sizeof(double)));
    ok = ok && (f->global = spari_zalloc(19 * (int64_t)f->nodes, sizeof(double)));
    ok = ok && (f->element = spari_zalloc((int64_t)f->block * f->block, sizeof(double)));
    if (f->N[0] || f->D) { /* else the sums are K and 0 */
        ok = ok && (f->sumC = spari_zalloc(f->size, sizeof(double)));
    }
    if (f->N[0]) {
        ok = ok && (f->sumK = spari_zalloc(f->size, sizeof(double))) && (f->sumf = spari_zalloc(f->n, sizeof(double)));
    }
    int64_t block = 6 * (int64_t)m->mesh.per_element;
    ok = ok && (!f->A || !m->learned || (f->dense_A = spari_zalloc(block * (block + f->n), sizeof(double))));
    return !ok;
}

static void frame_free(void *solution) {
    spari_frame *f = solution;
    if (!f) {
        return;
    }
    SPARI_FREE(f->basis, f->A, f->K, f->M, f->D, f->sumK, f->sumC, f->sumf, f->begin.y, f->from.y, f->to.y,
               f->steps.load, f->steps.load0, f->steps.load1, f->r, f->dx, f->increment, f->stage_v, f->nodal,
               f->global, f->element, f->dense_A, f->gram, f->pull, f->loads, f->elastic, f->positions);
    for (int k = 0; k < SPARI_SPIN_PRODUCTS; k++) {
        SPARI_FREE(f->N[k], f->f[k], f->rigid[k]);
    }
    for (int k = 0; k < 3; k++) {
        SPARI_FREE(f->G[k], f->E[k], f->P[k]);
    }
    spari_linear_free(f->linear);
    spari_snapshot_free(&f->before);
    free(f);
}

/* The matrices, of the nodes or of m->modes modes. */
static int fill_frame(spari_frame *f, const spar_member *m) {
    double *arm = spari_frame_arms(m);
    int more = (int)m->modes + spari_member_constrained(m) - 6, most = 6 * (f->nodes - 1);
    int cols = 6 + (more < most ? more : most);
    int status = arm && allocate_matrices(f, m) == 0 ? spari_frame_form(f, m->body, arm) : SPAR_ERR_MEMORY;
    if (status == SPAR_OK && f->A) {
        for (int e = 0; e < f->elements; e++) {
            spari_added_tangent(m, e, 1, NULL, f->A + (int64_t)f->block * f->block * e);
        }
    }
    for (int e = 0; e < f->elements && status == SPAR_OK && m->load.foundation; e++) {
        spari_foundation_tangent(m, e, 1, f->K + (int64_t)f->block * f->block * e);
    }
    if (status == SPAR_OK && m->modes > 0) {
        status = spari_frame_fill_basis(f, arm, cols);
        status = status == SPAR_OK && spari_frame_project(f, m, cols) ? SPAR_ERR_MEMORY : status;
    }
    free(arm);
    status = status == SPAR_OK && allocate_work(f, m) ? SPAR_ERR_MEMORY : status;
    const double accelerates[3] = {f->N[0] != NULL};
    status = status == SPAR_OK ? spari_frame_weigh(f, m, accelerates) : status;
    return status == SPAR_OK ? spari_frame_weigh(f, m, m->body->gravity) : status;
}

static int frame_create(spar_member *m) {
    SPARI_REQUIRE(m->session, spari_member_root_is_prescribed(m) || (m->effects & SPAR_EFFECT_INERTIA), SPAR_ERR_STATE,
                  "member '%s' is linear without inertia and free to move as a rigid body: fix or drive its root, or "
                  "keep SPAR_EFFECT_INERTIA",
                  m->name);
    spari_frame *f = m->solution = spari_zalloc(1, sizeof *f);
    if (!f) {
        return SPAR_ERR_MEMORY;
    }
    f->constrained = spari_member_constrained(m);
    f->nodes = m->body->unique;
    f->elements = m->mesh.elements, f->block = 6 * m->mesh.per_element, f->overlap = 6, f->n = 6 * f->nodes;
    f->size = (int64_t)f->elements * f->block * f->block;
    int status = fill_frame(f, m);
    f->factors = 0; /* factorisations of the set-up do not count */
    SPARI_REQUIRE(m->session, status == SPAR_OK || status == SPAR_ERR_MEMORY, status,
                  "member '%s': its stiffness is not positive definite, or it has fewer modes with mass than "
                  "requested; give every section mass and rotary inertia, or request fewer modes",
                  m->name);
    return status;
}

/* ---- requirements on the description ---- */

static int modal_check(const spar_member *m) {
    int constrained = spari_member_constrained(m);
    int64_t most = 6 * ((int64_t)m->mesh.elements * (m->mesh.per_element - 1) + 1) - constrained,
            least = 6 - constrained;
    SPARI_REQUIRE(m->session, m->beam->mass, SPAR_ERR_STATE,
                  "member '%s' has no mass, which a modal member needs; give its sections mass", m->name);
    SPARI_REQUIRE(m->session, m->modes <= most, SPAR_ERR_ARGUMENT,
                  "member '%s': %lld modes are requested; its nodes have %lld", m->name, (long long)m->modes,
                  (long long)most);
    SPARI_REQUIRE(m->session, m->modes >= least, SPAR_ERR_ARGUMENT,
                  "member '%s': %lld modes; its first %lld are rigid-body modes; request at least these", m->name,
                  (long long)m->modes, (long long)least);
    return SPAR_OK;
}

/* ---- further operations of the rows ---- */

static int64_t frame_unknowns(const spar_member *m) {
    const spari_frame *f = m->solution;
    return f->n - f->constrained;
}

static void frame_effort(const spar_member *m, spari_effort *e) {
    const spari_frame *f = m->solution;
    *e = (spari_effort){.iterations = f->solves,
                        .tangents = f->factors,
                        .nodes = f->nodes,
                        .elements = f->elements,
                        .per_element = m->mesh.per_element,
                        .unknowns = f->n,
                        .band = spari_effort_band(f->n, f->block)};
}

/* Operations that the two rows share. */
#define SPARI_FRAMED                                                                                                   \
    .moves = 1, .solved = 1, .frame = SPARI_FRAME_LINEAR, .create = frame_create, .free = frame_free,                  \
    .remass = spari_frame_remass, .restart = spari_frame_restart, .effective_load = spari_frame_effective_load,        \
    .accept = spari_frame_accept, .begin = spari_frame_begin, .reject = spari_frame_reject, .effort = frame_effort,    \
    .reaction_size = spari_reaction_of_whole_size, .reaction = spari_reaction_of_whole, .energy = spari_frame_energy,  \
    .unknowns = frame_unknowns, .problem = spari_frame_problem, .shape = spari_frame_shape,                            \
    .linearise = spari_frame_linearise, .state_size = spari_frame_state_size, .save = spari_frame_save,                \
    .is_state = spari_frame_is_state, .load = spari_frame_load, .component = &spari_component_floating,                \
    .publish = spari_frame_publish

const spari_fidelity spari_fidelity_linear = {SPARI_FRAMED, .lower = SPAR_FIDELITY_MODAL};
const spari_fidelity spari_fidelity_modal = {SPARI_FRAMED, .effective_here = 1, .massive = 1, .takes_modes = 1,
                                             .check = modal_check};
