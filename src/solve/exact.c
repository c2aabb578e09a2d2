/* The exact member: geometrically exact beams and rigid bodies. */
#include "../algebra/pencil.h"
#include "../math/rotation.h"
#include "../member/applied_loads.h"
#include "../member/capped.h"
#include "../member/plane.h"
#include "../time/body_solver.h"
#include "../time/component.h"
#include "../time/fidelity.h"
#include "../time/scheme.h"
#include "../time/steady_rotation.h"
#include "reaction.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- life and time ---- */

static int exact_create(spar_member *m) {
    if (spari_fidelity_is_here(m)) {
        m->solution = spari_solver_create(m, m->body, NULL);
    }
    return m->solution || !spari_fidelity_is_here(m) ? SPAR_OK : SPAR_ERR_MEMORY;
}

static void exact_free(void *solution) {
    spari_solver_free(solution);
}

static void exact_renew(spar_member *m) {
    spari_solver *s = m->solution;
    s->body = m->body;
    s->factored = 0;
}

static void exact_restart(spar_member *m) {
    spari_solver *s = m->solution;
    spari_member_to_unique(m, 7, m->now.q, s->begin.q);
    spari_member_to_unique(m, 6, m->now.v, s->begin.v);
    spari_member_to_unique(m, 6, m->now.a, s->begin.a);
    spari_solver_restart(s);
}

static spari_solver *exact_solver(const spar_member *m) {
    return m->solution;
}

static void exact_take_loads(spar_member *m) {
    spari_scheme_loads(m, &exact_solver(m)->steps);
}

static void exact_publish(spar_member *m) {
    const spari_solver *s = m->solution;
    spari_member_publish(m, s->to.q, s->to.v, s->to.a, &m->after);
}

static void exact_apply_load(spar_member *m, const double *load, double *r) {
    spari_member_gather(m, load, r);
}

static void exact_get_response(spar_member *m, const double *x, double *motion) {
    spari_member_from_unique(m, 6, x, motion);
}

static int exact_effective_load(spar_member *m, double *load) {
    spari_member_even_loads(m, load);
    return SPAR_OK;
}

static void exact_take_static(spar_member *m, const double *fluid) {
    spari_solver *s = m->solution;
    spari_member_gather(m, m->load.dead, s->steps.load);
    spari_member_gather(m, fluid, s->r);
    for (int i = 0; i < 6 * s->n; i++) {
        s->steps.load[i] += s->r[i];
    }
}

/* ---- modes ---- */

/* Unknowns of a node, and how many of the root's its condition holds: fewer in a plane. */
static int node_unknowns(const spar_member *m) {
    return spari_member_plane(m) ? 3 : 6;
}

static int root_constrained(const spar_member *m) {
    int all = spari_member_constrained(m);
    return !spari_member_plane(m) ? all : all == 3 ? 2 : all / 2;
}

static int64_t exact_unknowns(const spar_member *m) {
    return node_unknowns(m) * (int64_t)m->body->unique - root_constrained(m);
}

/* Number of the first unknown of an element; negative where the root's are held. */
static int first_unknown(const spar_member *m, int e) {
    return node_unknowns(m) * e * (m->mesh.per_element - 1) - root_constrained(m);
}

static void reduce_matrix(const spar_member *m, double *S) {
    if (spari_member_plane(m)) {
        spari_plane_reduce(spari_member_plane(m), m->mesh.per_element, S);
    }
}

static int exact_problem(const spar_member *m, spari_pencil *to) {
    int64_t u = m->body->unique, n = 6 * (int64_t)m->mesh.per_element;
    int own = node_unknowns(m) * m->mesh.per_element;
    double *q = spari_zalloc(19 * u + 2 * n * n, sizeof *q), *v = q + 7 * u, *a = v + 6 * u, *S = a + 6 * u,
           *mass = S + n * n;
    if (!q) {
        return SPAR_ERR_MEMORY;
    }
    spari_rotating_frame frame;
    int rotating = spari_rotating_frame_of(m, &m->after, &frame);
    spari_member_to_unique(m, 7, m->after.q, q);
    if (rotating) {
        spari_rotating_frame_nodes(&frame, 1, m, (int)u, q, v, a);
    }
    spari_body body;
    int status = spari_body_cap(m->body, q, to->cap, &body);
    for (int e = 0; e < m->mesh.elements && status == SPAR_OK; e++) {
        spari_steady_rotation_tangent(&body, rotating ? &frame.rotation : NULL, e, q, v, a, 1, S, mass);
        if (spari_carries_loads(m)) {
            spari_applied_tangent(m, e, q, 1, S);
        }
        reduce_matrix(m, S);
        reduce_matrix(m, mass);
        spari_pencil_add_symmetric(to, first_unknown(m, e), own, S, mass);
    }
    spari_body_uncap(m->body, &body);
    free(q);
    return status;
}

/* Residual in steady rotation, under the loads in use. */
static int exact_left(const spar_member *m, const double *q, const double *v, const double *a, spari_pencil *to) {
    int64_t u = m->body->unique;
    double *load = spari_zalloc(6 * m->nodes + 12 * u, sizeof *load), *r = load + 6 * m->nodes, *sum = r + 6 * u;
    if (!load) {
        return SPAR_ERR_MEMORY;
    }
    int status = spar_member_get_loads(m, load);
    if (status == SPAR_OK) {
        to->scale = fmax(to->scale, spari_body_residual(m->body, q, v, a, 1, r, NULL));
        spari_member_gather(m, load, sum);
        for (int64_t i = 0; i < 6 * u; i++) {
            r[i] -= sum[i];
            to->scale = fmax(to->scale, fabs(sum[i]));
        }
        to->noise = fmax(to->noise, m->body->stiffest);
        if (spari_member_plane(m)) {
            spari_plane_collect(spari_member_plane(m), u, r, r);
        }
        spari_pencil_set_forces(to, -root_constrained(m), (int)(node_unknowns(m) * u), r);
    }
    free(load);
    return status;
}

static int exact_linearise(const spar_member *m, const double w[3], spari_pencil *to) {
    int64_t u = m->body->unique, n = 6 * (int64_t)m->mesh.per_element;
    int own = node_unknowns(m) * m->mesh.per_element;
    double *q = spari_zalloc(19 * u + 3 * n * n, sizeof *q), *v = q + 7 * u, *a = v + 6 * u, *K = a + 6 * u,
           *C = K + n * n, *M = C + n * n;
    if (!q) {
        return SPAR_ERR_MEMORY;
    }
    spari_rotating_frame frame;
    int rotating = spari_rotating_frame_of(m, &m->after, &frame) || spari_norm(w) > 0;
    spari_member_to_unique(m, 7, m->after.q, q);
    if (rotating) {
        spari_rotating_frame_nodes(&frame, 1, m, (int)u, q, v, a);
    } else {
        v = a = NULL;
    }
    spari_body body;
    int status = spari_body_cap(m->body, q, to->cap, &body);
    for (int e = 0; e < m->mesh.elements && status == SPAR_OK; e++) {
        spari_steady_rotation_pencil(&body, w, frame.rotation.w, e, q, v, a, K, C, M);
        if (spari_carries_loads(m)) {
            spari_applied_tangent(m, e, q, 1, K);
        }
        reduce_matrix(m, K);
        reduce_matrix(m, C);
        reduce_matrix(m, M);
        spari_pencil_add(to, first_unknown(m, e), own, own, K, C, M);
    }
    spari_body_uncap(m->body, &body);
    status = status == SPAR_OK ? exact_left(m, q, v, a, to) : status;
    free(q);
    return status;
}

static void exact_shape(const spar_member *m, const double *x, double *workspace, double *nodes) {
    int64_t constrained = root_constrained(m);
    memset(workspace, 0, (size_t)constrained * sizeof *workspace);
    memcpy(workspace + constrained, x, (size_t)exact_unknowns(m) * sizeof *workspace);
    if (spari_member_plane(m)) {
        spari_plane_spread(spari_member_plane(m), m->body->unique, workspace, workspace);
    }
    spari_member_from_unique(m, 6, workspace, nodes);
}

const spari_fidelity spari_fidelity_exact = {
    .moves = 1,
    .solved = 1,
    .lower = SPAR_FIDELITY_MODAL,
    .frame = SPARI_FRAME_INERTIAL,
    .create = exact_create,
    .free = exact_free,
    .renew = exact_renew,
    .restart = exact_restart,
    .effective_load = exact_effective_load,
    .reaction_size = spari_reaction_of_whole_size,
    .reaction = spari_reaction_of_whole,
    .energy = spari_energy_of_body,
    .unknowns = exact_unknowns,
    .problem = exact_problem,
    .shape = exact_shape,
    .linearise = exact_linearise,
    SPARI_BODY_ROW,
    .solver = exact_solver,
    .take_loads = exact_take_loads,
    .take_static = exact_take_static,
    .apply_load = exact_apply_load,
    .get_response = exact_get_response,
    .publish = exact_publish,
};
