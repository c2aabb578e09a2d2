/* Error due to the nodes of a beam: solves its equations with more nodes from its present shape ((E3) of
   docs/explanation/theory.md). */
#include "node_error.h"

#include "../base/environment.h"
#include "../base/session.h"
#include "../comm/comm.h"
#include "../math/basis.h"
#include "../math/resample.h"
#include "../member/body.h"
#include "../member/check_arguments.h"
#include "../member/plane.h"
#include "../session/step_control.h"
#include "../time/fidelity.h"
#include "../time/substep_motion.h"
#include "../trial/rebuild.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MORE = 4, SLOWER = 2, CORRECTIONS = 5 };
/* Too few nodes leave spurious axial forces, with which the tangent is meaningless. So the first corrections move
   only the stiffest components, those unresolved by a step of the run and by ten of them: this multiple of mass over
   dt^2 is added to the tangent. From SLOWER on there is no mass if the root constrains the member. */
static const double mass[CORRECTIONS] = {4, 0.04, 0, 0, 0};
/* The correction neglects inertia, which amplifies the error of motion relative to that of the shape, by this factor
   on average. */
static const double amplified = 1.7;

/* In the unknowns of the finer beam: state, corrected state, original state; loads. */
typedef struct finer {
    double *q, *v, *a, *begun, *load;
} finer;

static int finer_create(const spar_member *m, const double *load, finer *f) {
    int64_t n = m->body->unique;
    f->q = spari_zalloc(32 * n, sizeof(double));
    SPARI_REQUIRE(m->session, f->q, SPAR_ERR_MEMORY, "no memory for the finer nodes of '%s'", m->name);
    f->v = f->q + 7 * n, f->a = f->v + 6 * n, f->load = f->a + 6 * n, f->begun = f->load + 6 * n;
    spari_member_to_unique(m, 7, m->now.q, f->q);
    spari_member_to_unique(m, 6, m->now.v, f->v);
    spari_member_to_unique(m, 6, m->now.a, f->a);
    spari_member_gather(m, load, f->load);
    memcpy(f->begun, f->q, (size_t)(7 * n) * sizeof *f->q);
    return SPAR_OK;
}

/* One correction of the shape by the force residual, with cm times the mass if the root is free; *size: relative to
   the member's length. 1: the tangent is singular. */
static int correct_shape(const spar_member *m, spari_solver *s, const finer *f, double cm, double *size) {
    spari_body_residual(m->body, f->q, f->v, f->a, 1, s->r, NULL);
    for (int i = 0; i < 6 * s->n; i++) {
        s->r[i] -= f->load[i];
    }
    spari_member_constrain(m, s->n, s->r);
    if (spari_solver_factor(s, m, &(spari_tangent_at){.q = f->q, .v = f->v, .a = f->a, .factor = 1, .cm = cm})) {
        return 1;
    }
    memcpy(s->dx, s->r, (size_t)(6 * s->n) * sizeof *s->dx);
    if (spari_linear_solve(s->linear, s->dx)) {
        return 1;
    }
    double largest = 0;
    const double longest = 0.8;
    for (int i = 0; i < s->n; i++) {
        double u[2] = {0, 0};
        for (int k = 0; k < 6; k++) {
            u[k / 3] += s->dx[6 * i + k] * s->dx[6 * i + k];
        }
        largest = fmax(largest, fmax(sqrt(u[0]) / m->body->length, sqrt(u[1])));
    }
    spari_static_shift(s->n, largest > longest ? longest / largest : 1, s->dx, f->q);
    *size = largest;
    return 0;
}

/* The member is the finer one. -1: no result. */
static double distance(const spar_member *m, const finer *f) {
    spari_solver *s = m->solution;
    double h = m->session->clock.dt_last[0], sum = 0, size = INFINITY, last;
    int constrained = spari_member_constrained(m) == 6;
    if (!constrained && h <= 0) {
        return -1;
    }
    for (int k = h > 0 ? 0 : SLOWER; k < (constrained ? CORRECTIONS : SLOWER); k++) {
        last = size;
        if (correct_shape(m, s, f, mass[k] > 0 ? mass[k] / (h * h) : 0, &size) || !isfinite(size)) {
            return -1;
        }
        if (size < 1e-2 * last && k > SLOWER) {
            break;
        }
    }
    for (int i = 0; i < s->n; i++) {
        for (int k = 0; k < 3; k++) {
            double d = f->q[7 * i + k] - f->begun[7 * i + k];
            sum += d * d;
        }
    }
    return amplified * sqrt(sum / s->n);
}

/* Nodal loads [nodes][6] in equilibrium with the present accelerations: the residual of the present equations. */
static int find_loads(const spar_member *m, double **load) {
    const spari_body *body = m->body;
    int64_t n = body->unique;
    double *x = spari_zalloc(25 * n, sizeof *x), *r = x + 19 * n;
    *load = spari_zalloc(6 * m->nodes, sizeof **load);
    int status = x && *load ? SPAR_OK : SPAR_ERR_MEMORY;
    if (status == SPAR_OK) {
        spari_member_to_unique(m, 7, m->now.q, x);
        spari_member_to_unique(m, 6, m->now.v, x + 7 * n);
        spari_member_to_unique(m, 6, m->now.a, x + 13 * n);
        spari_body_residual(body, x, x + 7 * n, x + 13 * n, 1, r, NULL);
        spari_member_constrain(m, n, r);
        spari_member_from_unique(m, 6, r, *load);
        for (int64_t e = 1; e < m->mesh.elements;
             e++) { /* of the two nodes at an element boundary, one has the whole load */
            memset(*load + 6 * e * m->mesh.per_element, 0, 6 * sizeof **load);
        }
        spari_member_even_loads(m, *load);
    }
    free(x);
    SPARI_REQUIRE(m->session, status == SPAR_OK, status, "no memory for the loads of '%s'", m->name);
    return SPAR_OK;
}

int spari_nodes_error(spar_member *m, double *error) {
    spari_rebuild settings = spari_rebuild_of(m);
    int P = m->mesh.per_element, n = P + MORE < SPARI_MAX_NODES ? P + MORE : SPARI_MAX_NODES;
    double *load = NULL, *onto = spari_zalloc(6 * (int64_t)m->mesh.elements * n, sizeof *onto);
    spar_member old;
    finer f = {NULL, NULL, NULL, NULL, NULL};
    int status = onto ? find_loads(m, &load) : spari_fail(m->session, SPAR_ERR_MEMORY, "no memory for '%s'", m->name);
    if (status == SPAR_OK) {
        spari_resample_loads(m->mesh, (spari_mesh){m->mesh.elements, n}, load, onto);
        settings.per_element = n;
        settings.left_out = SPAR_EFFECT_WORK; /* a new work account would reset those of the joints */
        int owner = m->owner;
        m->owner = spari_comm_rank(m->session->ranks.comm);
        status = spari_member_rebuild(m, &settings, &old);
        old.owner = owner;
        status = status == SPAR_OK ? finer_create(m, onto, &f) : status;
        *error = status == SPAR_OK ? distance(m, &f) : 0;
        spari_member_restore(m, &old);
    }
    SPARI_FREE(f.q, load, onto);
    return status;
}

int spari_nodes_error_applies(const spar_member *m) {
    return m->kind == SPARI_BEAM && !m->external && m->row->solved && m->fidelity >= SPAR_FIDELITY_LINEAR;
}

int spar_member_estimate_error(spar_member *member, double *step, double *nodes) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_committed(member, __func__));
    spar_member *m = member;
    spar_session *s = m->session;
    double found[2] = {0, 0};
    SPARI_REQUIRE(
        s, !step || spari_step_control_is_set(s), SPAR_ERR_STATE,
        "%s: step errors are not recorded; call spar_session_set_tolerance first, or request the error of the nodes",
        __func__);
    SPARI_REQUIRE(s, !s->state.static_solution && !s->state.trial, SPAR_ERR_STATE,
                  "%s: a static solution, initial accelerations or a trial is in progress; call this between steps",
                  __func__);
    SPARI_REQUIRE(s, !nodes || s->state.phase == SPARI_IDLE, SPAR_ERR_STATE,
                  "%s: a step is in progress; request the error of the nodes between steps", __func__);
    if (step) {
        found[0] = s->state.phase >= SPARI_SOLVED ? spari_step_control_error(m) : m->accuracy.step_error;
    }
    if (nodes && spari_nodes_error_applies(m)) {
        found[1] = -1;
        const int finds = m->fidelity == SPAR_FIDELITY_EXACT && m->mesh.per_element < SPARI_MAX_NODES;
        SPARI_TRY(finds ? spari_named(s, __func__, spari_nodes_error(m, found + 1)) : SPAR_OK);
    }
    SPARI_GIVE(step, found[0]);
    SPARI_GIVE(nodes, found[1]);
    return SPAR_OK;
}
