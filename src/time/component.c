/* Newton's method for a component without ends, a member that no joint ties: see component.h. */
#include "component.h"

#include "../base/session.h"
#include "fidelity.h"
#include "newton.h"
#include "newton_tolerance.h"

#include <float.h>

spari_component spari_component_of(spar_member *m) {
    spari_component p = {.member = m, .row = m->row->component};
    p.row->attach(&p);
    return p;
}

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
    if ((!t->formed && p->row->tangent(p)) || p->row->correct_newton(p)) {
        return "found a singular tangent";
    }
    t->formed = 1;
    it->correction = p->row->advance(p, longest, &way);
    it->tolerance = spari_newton_tolerance(p->member, &p->scheme, way);
    it->small = it->correction < 1e-11 || noise <= 64 * DBL_EPSILON * p->body->stiffest;
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

const char *spari_component_newton(spari_component *p, int *iterations) {
    static const spari_newton how = {INFINITY,        1e-6,         guess_component, begin_component, iterate_component,
                                     renew_component, end_component};
    const spar_session *session = p->member->session;
    component_stage stage = {.p = p};
    const char *wrong = spari_newton_solve(&how, &stage, p->row->serves(p), session->newton.max,
                                           spari_newton_stop_begin(session, p->trace), iterations);
    if (wrong) {
        p->row->end_solution(p, 0, 0);
    }
    return wrong;
}
