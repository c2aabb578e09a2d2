/* The substeps of a step: see substeps.h. */
#include "substeps.h"

#include "../base/session.h"
#include "../math/rotation.h"

#include <math.h>

static spari_pattern pattern_after(const spari_pattern *last, double h) {
    if (last->h > 0 && !spari_steps_are_equal(h, last->h)) {
        return (spari_pattern){h, 0};
    }
    return (spari_pattern){h, last->h > 0 && last->even < SPARI_EVEN ? last->even + 1 : last->even};
}

/* In free rotation at W, generalised-alpha amplifies unresolved parts from 1 - rho_inf = 1.5 W h on
   (docs/evidence/beam.md, "Stiff members that turn"); with rho_inf = 1 those of omega h > 4 / (W h). TR-BDF2 does
   not. */
static int exceeds_limit(double rotation_rate, const spari_scheme *c, const spar_session *session) {
    static const double least = 0.05;
    return 1.5 * rotation_rate * c->h > fmax(1 - session->integrator.rho_inf, least);
}

int spari_substeps_rotate_fast(const spar_session *s, double dt) {
    const spari_scheme c = {.h = dt / s->integrator.substeps};
    int rotates = 0;
    for (const spar_member *m = s->members; m && !rotates; m = m->next) {
        if (spari_member_rotates_stiffly(m)) {
            double w[3];
            spari_mean_rotation(m->nodes, m->now.v, w);
            rotates = exceeds_limit(1.1 * spari_norm(w), &c, s);
        }
    }
    return rotates;
}

/* Solves a substep. Its initial state stays for another try. Returns the status; *c: the rule of the last stage. */
static int try_part(const spari_stepper *how, void *self, const spari_scheme *alpha, int even, spari_part *part,
                    spari_scheme *c) {
    *c = *alpha;
    part->end = part->to;
    if (even < SPARI_EVEN && !c->still) {
        *c = spari_scheme_stage(alpha, SPARI_TRAPEZOIDAL);
        part->end = part->from + SPARI_STAGE * (part->to - part->from);
        SPARI_TRY(how->solve(self, c, part));
        *c = spari_scheme_stage(alpha, SPARI_BACKWARD);
        part->end = part->to;
    }
    return how->solve(self, c, part);
}

/* The same, with the check that the solution gains no energy. The session gets the message of a failure if `last`. */
static int try_to_stay(const spari_stepper *how, void *self, const spari_scheme *alpha, int even, spari_part *part,
                       spari_scheme *c, const spar_session *session, int last) {
    char text[SPARI_MESSAGE_SIZE], *before = last ? NULL : spari_messages_redirect(text);
    int status = try_part(how, self, alpha, even, part, c);
    if (!last) {
        (void)spari_messages_redirect(before);
        SPARI_REQUIRE(session, status == SPAR_OK || status == SPAR_ERR_NUMERIC, status, "%s", text);
    }
    if (status == SPAR_OK && how->gains && !c->still && !session->state.rough && how->gains(self, part)) {
        status = SPAR_ERR_NUMERIC;
        char name[160];
        how->name(self, name, sizeof name);
        SPARI_REQUIRE(session, !last, status,
                      "%s: the step from t = %g gains energy without a load, even in 1024 parts; use a smaller dt, or "
                      "check the loads",
                      name, session->clock.time);
    }
    return status;
}

enum { PARTS = 1024 };

/* One substep of the session, halved where necessary. */
static int run_substep(const spari_stepper *how, void *self, const spari_scheme *whole, spari_cuts *cuts,
                       spari_pattern *pattern, const spar_session *session, double dt, double from, double to) {
    int at = 0, size = PARTS, again = 0;
    double tried = 0;
    while (at < PARTS) {
        const unsigned node = (unsigned)(PARTS / size + at / size); /* of the tree of halvings */
        if (size > 1 && cuts->given_up[node / 32] >> node % 32 & 1) {
            size /= 2;
            continue;
        }
        const spari_scheme alpha = size < PARTS ? spari_scheme_resize(whole, whole->h * size / PARTS) : *whole;
        spari_pattern next = pattern_after(pattern, alpha.h);
        spari_part part = {.dt = dt, .again = again};
        spari_scheme c;
        part.from = at == 0 ? from : from + (to - from) * at / PARTS;
        part.to = at + size == PARTS ? to : from + (to - from) * (at + size) / PARTS;
        part.alpha = again ? 0 : pattern->even == SPARI_EVEN ? pattern->h : tried;
        part.ratio = pattern->h > 0 ? alpha.h / pattern->h : 0;
        int tries_anew = again || tried > 0; /* the first try has overwritten the algorithmic accelerations */
        if (!tries_anew) {
            how->enter(self, &part);
        }
        if (tries_anew || (how->rotation_rate && exceeds_limit(how->rotation_rate(self), &alpha, session))) {
            next.even = 0;
        }
        part.last = next.even == SPARI_EVEN - 1;
        int last = size == 1 || !how->gains,
            status = try_to_stay(how, self, &alpha, next.even, &part, &c, session, last);
        if (status == SPAR_ERR_NUMERIC && !last) {
            again = c.rule != SPARI_ALPHA;
            tried = again ? 0 : alpha.h;
            cuts->given_up[node / 32] |= (uint32_t)1 << node % 32;
            cuts->halved++;
            continue;
        }
        SPARI_TRY(status);
        SPARI_TRY(how->finish(self, &c, &part));
        *pattern = next;
        at += size;
        again = 0, tried = 0;
        while (size < PARTS && at % (2 * size) == 0) {
            size *= 2;
        }
    }
    return SPAR_OK;
}

int spari_substeps_run(const spari_stepper *how, void *self, const spari_scheme *alpha, spari_cuts *cuts,
                       spari_pattern *pattern, const spar_session *session, double dt) {
    int substeps = session->integrator.substeps;
    if (cuts->begun != session->clock.begun || session->state.rough) {
        *cuts = (spari_cuts){.begun = session->clock.begun};
    }
    for (int k = 1; k <= substeps; k++) {
        SPARI_TRY(
            run_substep(how, self, alpha, cuts, pattern, session, dt, (k - 1.0) / substeps, (double)k / substeps));
    }
    return SPAR_OK;
}
