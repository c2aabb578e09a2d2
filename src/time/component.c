/* A component without ends: a member that no joint ties, solved by the operations of its table. See component.h. */
#include "component.h"

#include "../base/session.h"
#include "fidelity.h"
#include "newton.h"
#include "newton_stop.h"

#include <float.h>
#include <stdio.h>

static spari_component component_of(spar_member *m) {
    spari_component p = {.member = m, .row = m->row->component};
    p.row->attach(&p);
    return p;
}

/* The corrections of the accelerations at t^0, of a response, or of an equilibrium. 0 or 1. */
static int solve_component(spari_component *p) {
    double none[6] = {0};
    if (p->row->reduce(p, none)) {
        return 1;
    }
    p->row->expand(p, none);
    return 0;
}

/* ---- a stage of a substep, as newton.h has it ---- */

typedef struct component_stage {
    spari_component *p;
    int formed; /* there is a tangent */
} component_stage;

static int guess_component(void *self, spari_guess stays) {
    const component_stage *t = self;
    return t->p->row->predict(t->p, stays);
}

static int begin_component(void *self, int kept) {
    component_stage *t = self;
    t->formed = kept && t->p->row->serves(t->p);
    return t->formed;
}

static const char *iterate_component(void *self, double longest, spari_iterate *it) {
    component_stage *t = self;
    spari_component *p = t->p;
    double scale = p->row->balance(p), noise = p->row->noise(p), way;
    if (!isfinite(scale) || !isfinite(noise)) {
        return "met values that are not finite";
    }
    if ((!t->formed && p->row->tangent(p)) || p->row->solve(p)) {
        return "found a singular tangent";
    }
    t->formed = 1;
    it->correction = p->row->advance(p, longest, &way);
    it->tolerance = spari_newton_tolerance(p->member, &p->scheme, way);
    it->small = it->correction < 1e-11 || noise <= 64 * DBL_EPSILON * p->solver->body->stiffest;
    it->rounded = noise <= 16 * DBL_EPSILON * scale;
    return NULL;
}

static void renew_component(void *self) {
    component_stage *t = self;
    t->formed = 0;
}

static void end_component(void *self, int iterations, int fresh) {
    const component_stage *t = self;
    t->p->row->end_solution(t->p, iterations, fresh);
}

static int solve_stage(void *self, const spari_scheme *c, const spari_part *part) {
    static const spari_newton how = {INFINITY,        1e-6,         guess_component, begin_component, iterate_component,
                                     renew_component, end_component};
    spari_component *p = self;
    const spar_session *session = p->member->session;
    component_stage stage = {.p = p};
    int iterations = 0;
    p->scheme = *c;
    SPARI_TRY(p->row->stage(p, part));
    const char *wrong = spari_newton_solve(&how, &stage, p->row->serves(p), session->newton.max,
                                           spari_newton_stop_begin(session, &p->solver->trace), &iterations);
    if (wrong) {
        p->row->end_solution(p, 0, 0);
        return spari_fail(session, SPAR_ERR_NUMERIC,
                          "member '%s': Newton %s (%d iterations in several attempts, each of %d at most) in the step "
                          "from t = %g; use a smaller dt, more substeps or a smaller rho_inf, or check the loads",
                          p->member->name, wrong, iterations, session->newton.max, session->clock.time);
    }
    return SPAR_OK;
}

/* ---- a step ---- */

static void enter_component(void *self, const spari_part *part) {
    spari_component *p = self;
    (void)part;
    p->row->enter(p);
}

static int finish_component(void *self, const spari_scheme *c, const spari_part *part) {
    spari_component *p = self;
    (void)c, (void)part;
    p->row->end(p);
    return SPAR_OK;
}

static double rotation_rate_of(const void *self) {
    const spari_component *p = self;
    return spari_stage_rotation_rate(p->solver, p->member);
}

static int component_gains(void *self, const spari_part *part) {
    const spari_component *p = self;
    double gain, size;
    if (spari_stage_is_near(p->solver, p->member, p->scheme.h)) {
        return 0;
    }
    spari_stage_energy(p->solver, p->member, part, &gain, &size);
    return gain > SPARI_GAIN * size;
}

static void name_component(const void *self, char *text, int size) {
    const spari_component *p = self;
    (void)snprintf(text, (size_t)size, "member '%s'", p->member->name);
}

enum { START_PASSES = 4 };

/* Accelerations at t^0: those of the initial rigid-body field, and what the balance of forces requires beyond them,
   through M + K / cm instead of M. Parts that are stiff or light against this step (or have no mass at all) would
   start with accelerations that the step cannot follow. Each pass solves for the remaining part. With z = omega^2 / cm
   a mode keeps 1 - (z / (1 + z))^4 of its acceleration. */
static int start_component(spari_component *p) {
    int singular = p->row->start(p);
    for (int pass = 0; pass < START_PASSES && !singular; pass++) {
        p->row->unbalance(p);
        singular = solve_component(p);
        if (!singular) {
            p->row->correct_start(p);
        }
    }
    if (singular) {
        p->row->end_solution(p, 0, 0);
        return spari_fail(p->member->session, SPAR_ERR_NUMERIC,
                          "member '%s': its mass and stiffness together are singular at the start; give mass or rotary "
                          "inertia in every direction of free motion",
                          p->member->name);
    }
    p->row->end_start(p);
    return SPAR_OK;
}

static int begin_step(spari_component *p, double dt) {
    int started = p->row->take(p, dt / p->member->session->integrator.substeps);
    if (!started && !p->scheme.still) {
        SPARI_TRY(start_component(p));
    }
    p->row->begin(p);
    return SPAR_OK;
}

int spari_component_balance(spar_member *m, double dt) {
    spari_component p = component_of(m);
    SPARI_TRY(begin_step(&p, dt));
    m->row->publish(m);
    return SPAR_OK;
}

int spari_component_advance(spar_member *m, double dt) {
    static const spari_stepper nodes = {enter_component,  rotation_rate_of, solve_stage,
                                        finish_component, component_gains,  name_component},
                               frame = {.enter = enter_component, .solve = solve_stage, .finish = finish_component};
    spari_component p = component_of(m);
    spari_steps *steps = &p.solver->steps;
    SPARI_TRY(begin_step(&p, dt));
    const spari_scheme alpha = p.scheme;
    steps->solved = steps->begin;
    SPARI_TRY(spari_scheme_run(p.frame ? &frame : &nodes, &p, &alpha, &m->state.cuts, &steps->solved, m->session, dt));
    m->row->publish(m);
    return SPAR_OK;
}

int spari_component_response(spar_member *m, const double *load, double *motion) {
    spari_component p = component_of(m);
    p.row->look_back(&p);
    if (p.row->tangent_after(&p)) {
        return 1;
    }
    p.row->take_more(&p, load);
    if (solve_component(&p)) {
        return 1;
    }
    p.row->show_more(&p, motion);
    return 0;
}

/* ---- at rest ---- */

enum { COMPONENT_REST_ITERATIONS = 50 };

int spari_component_static(spar_member *m, const double *fluid) {
    spari_component own = component_of(m), *p = &own;
    spari_rotating_frame rotating = {.mass = NULL};
    double last = 0;
    int found = 0, singular = 0;
    if (m->root == SPAR_ROOT_DRIVEN && spari_steady_rotation_of(m, m->now.v, m->now.a, &rotating.rotation)) {
        for (int k = 0; k < 3; k++) {
            rotating.centre[k] = m->xr[k] + m->now.q[k];
        }
        p->rotating = &rotating;
    }
    p->scheme = (spari_scheme){.cm = 0, .cv = 0};
    p->row->rest(p, fluid, 0);
    for (int it = 0; it < COMPONENT_REST_ITERATIONS && !found && !singular; it++) {
        singular =
            !isfinite(p->row->balance_rest(p, 1)) || (it == 0 && p->row->tangent_rest(p, 1)) || solve_component(p);
        if (singular) {
            break;
        }
        double size = p->row->correction_size(p);
        p->row->shift(p, 1);
        found = size < 1e-15 || (it > 2 && size > 0.5 * last && size < 1e-9);
        last = size;
    }
    if (found) {
        p->row->keep_positions(p, 0);
        p->row->end_rest(p);
    } else {
        p->row->discard_rest(p);
    }
    p->rotating = NULL;
    return !found;
}
