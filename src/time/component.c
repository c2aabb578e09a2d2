/* A component without ends: a member that no joint ties, solved by the operations of its table. See component.h. */
#include "component.h"

#include "../base/session.h"
#include "newton.h"
#include "newton_stop.h"

#include <float.h>

/* The corrections by the tangent kept. 0 or 1. */
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
    double way; /* how far the stage has moved it, by the first iteration; 0: not known */
} component_stage;

static int guess_component(void *self, spari_guess stays) {
    const component_stage *t = self;
    return t->p->row->predict(t->p, stays);
}

static int begin_component(void *self, int kept) {
    component_stage *t = self;
    t->formed = kept && t->p->row->serves(t->p);
    t->way = 0;
    return t->formed;
}

static const char *iterate_component(void *self, double longest, spari_iterate *it) {
    component_stage *t = self;
    spari_component *p = t->p;
    const spari_component_row *row = p->row;
    double scale = row->balance(p);
    if (!isfinite(scale)) {
        return "met values that are not finite";
    }
    if (!t->formed && row->tangent(p)) {
        return "found a singular tangent";
    }
    t->formed = 1;
    if (solve_component(p)) {
        return "found a singular tangent";
    }
    if (row->solved && row->solved(p)) {
        row->correct(p, 1);
        *it = (spari_iterate){.correction = 0, .tolerance = 0}; /* it ends */
        return NULL;
    }
    it->correction = row->correction_size(p);
    row->correct(p, it->correction > longest ? longest / it->correction : 1);
    t->way = t->way > 0 ? t->way : row->way(p);
    it->tolerance = spari_newton_tolerance(p->member, &p->scheme, t->way);
    it->small = it->correction < 1e-11;
    it->rounded = it->small && row->noise(p) <= 16 * DBL_EPSILON * scale;
    return NULL;
}

static void renew_component(void *self) {
    component_stage *t = self;
    t->formed = 0;
}

static void end_component(void *self, int iterations, int fresh) {
    (void)self, (void)iterations, (void)fresh;
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
    SPARI_REQUIRE(session, !wrong, SPAR_ERR_NUMERIC,
                  "member '%s': its equations have no solution in the step from t = %g (Newton %s); check the angular "
                  "velocity of its root and its follower loads",
                  p->member->name, session->clock.time, wrong);
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

enum { COMPONENT_START_PASSES = 4 };

/* Accelerations at t^0, by refinements as spari_scheme_start has them. */
static int start_component(spari_component *p) {
    int singular = p->row->start(p);
    for (int pass = 0; pass < COMPONENT_START_PASSES && !singular; pass++) {
        p->row->unbalance(p);
        singular = solve_component(p);
        if (!singular) {
            p->row->correct_start(p);
        }
    }
    SPARI_REQUIRE(p->member->session, !singular, SPAR_ERR_NUMERIC,
                  "member '%s': its mass and stiffness together are singular at the start; give mass or rotary inertia "
                  "in every direction of free motion",
                  p->member->name);
    p->row->end_start(p);
    return SPAR_OK;
}

int spari_component_balance(spari_component *p, double dt) {
    int started = p->row->take(p, dt / p->member->session->integrator.substeps);
    if (!started && !p->scheme.still) {
        SPARI_TRY(start_component(p));
    }
    p->row->begin(p);
    return SPAR_OK;
}

int spari_component_advance(spari_component *p, double dt) {
    static const spari_stepper how = {.enter = enter_component, .solve = solve_stage, .finish = finish_component};
    spari_steps *steps = &p->solver->steps;
    SPARI_TRY(spari_component_balance(p, dt));
    const spari_scheme alpha = p->scheme;
    steps->solved = steps->begin;
    return spari_scheme_run(&how, p, &alpha, &p->member->state.cuts, &steps->solved, p->member->session, dt);
}

int spari_component_response(spari_component *p, const double *load, double *motion) {
    p->row->look_back(p);
    if (!p->row->serves(p)) {
        (void)p->row->balance(p);
        if (p->row->tangent(p)) {
            return 1;
        }
    }
    p->row->take_more(p, load);
    if (solve_component(p)) {
        return 1;
    }
    p->row->show_more(p, motion);
    return 0;
}

/* ---- at rest ---- */

enum { COMPONENT_REST_ITERATIONS = 50 };

int spari_component_static(spari_component *p, const double *fluid) {
    const spar_member *m = p->member;
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
        found = (p->row->solved && p->row->solved(p)) || size < 1e-15 || (it > 2 && size > 0.5 * last && size < 1e-9);
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
