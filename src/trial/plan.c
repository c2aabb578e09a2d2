/* Settings that advice tries: how they are written down, run, measured and compared. */
#include "plan.h"

#include "cost.h"
#include "retie.h"

#include "../math/basis.h"
#include "../member/beam.h"
#include "../session/accelerate.h"
#include "../solve/fidelity.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- plans ---- */

static int is_varied(const spar_member *m) {
    return m->kind == SPARI_BEAM && !m->external && !spari_ties_hold_within(m);
}

/* Whether two beams are copies of each other. */
static int alike(const spar_member *a, const spar_member *b) {
    return spari_member_make(a) == spari_member_make(b);
}

const spar_member *spari_plan_member(const spari_advisor *d, int group) {
    const spar_member *m = d->session->members;
    for (int k = 0; d->group[k] != group; k++) {
        m = m->next;
    }
    return m;
}

int spari_plan_groups(spari_advisor *d) {
    const spar_session *s = d->session;
    d->group = spari_zalloc(s->member_count, sizeof *d->group);
    d->known = spari_zalloc(SPARI_KNOWN, sizeof *d->known);
    SPARI_REQUIRE(d->session, d->group && d->known, SPAR_ERR_MEMORY, "%s: no memory", SPARI_ADVISE);
    int k = 0;
    for (const spar_member *m = s->members; m; m = m->next, k++) {
        d->group[k] = -1;
        for (int g = 0; g < d->groups && is_varied(m) && d->group[k] < 0; g++) {
            d->group[k] = alike(spari_plan_member(d, g), m) ? g : -1;
        }
        if (d->group[k] < 0 && is_varied(m) && d->groups < SPARI_GROUPS) {
            d->group[k] = d->groups++;
        }
    }
    return SPAR_OK;
}

spari_plan spari_plan_present(const spari_advisor *d) {
    const spar_session *s = d->session;
    spari_plan p;
    memset(&p, 0, sizeof p);
    p.steps = d->run.steps;
    p.substeps = s->substeps, p.scheme = s->scheme, p.predictor = s->predictor;
    p.rtol = s->coupling_rtol, p.newton = s->newton_rtol;
    for (int g = 0; g < d->groups; g++) {
        const spar_member *m = spari_plan_member(d, g);
        p.group[g].nodes = m->per_element;
        p.group[g].fidelity = m->fidelity;
        p.group[g].modes = m->modes;
    }
    return p;
}

void spari_plan_settings(const spari_plan *p, double *values) {
    SPARI_VARY(values, substeps, p->substeps);
    SPARI_VARY(values, scheme, p->scheme);
    SPARI_VARY(values, predictor, p->predictor);
    SPARI_VARY(values, coupling_rtol, p->rtol);
    SPARI_VARY(values, newton_rtol, p->newton);
}

int64_t spari_plan_steps(const spari_advisor *d, int j) {
    double n = (double)d->run.steps / SPARI_SAMPLES * pow(2, 0.5 * j);
    return SPARI_SAMPLES * (int64_t)fmax(1, floor(n + 0.5));
}

int spari_plan_grid(const spari_advisor *d, int64_t steps) {
    return (int)lround(2 * log2((double)steps / (double)d->run.steps));
}

/* ---- runs ---- */

int spari_plan_fails(int status) {
    return status == SPAR_ERR_NUMERIC || status == SPAR_ERR_USER || status == SPAR_ERR_STATE ||
           status == SPAR_ERR_UNSUPPORTED || status == SPAR_ERR_ARGUMENT || status == SPAR_ERR_MAPPING;
}

int spari_plan_run(spari_advisor *d, const spari_plan *p, int longer, spari_record *record) {
    spar_session *s = d->session;
    spari_wish wish;
    spari_run run = d->run;
    *record = (spari_record){0};
    SPARI_TRY(spari_wish_create(s, &wish));
    spari_plan_settings(p, wish.setting);
    for (int k = 0; k < s->member_count; k++) {
        if (d->group[k] >= 0) {
            const spari_shape *g = &p->group[d->group[k]];
            spari_remake *r = wish.member + k;
            r->per_element = g->nodes, r->fidelity = g->fidelity, r->modes = g->modes, r->points = g->points;
        }
    }
    run.steps = longer * p->steps;
    run.dt = d->run.dt * (double)d->run.steps / (double)p->steps;
    int status = spari_trial_run(s, &run, &wish, record);
    d->trials++;
    spari_wish_free(&wish);
    return status;
}

static const char *describe_plan(const spari_advisor *d, const spari_plan *p, char *text, size_t size) {
    const spari_coupling_scheme *scheme = spari_coupling_scheme_of(p->scheme);
    double dt = d->run.dt * (double)d->run.steps / (double)p->steps;
    int at = snprintf(text, size, "dt %.4g", dt);
    if (p->substeps > 1) {
        at += snprintf(text + at, size - (size_t)at, " in %d substeps", p->substeps);
    }
    at += snprintf(text + at, size - (size_t)at, ", %s", scheme->name);
    if (scheme->iterates) {
        at += snprintf(text + at, size - (size_t)at, " %.0e", p->rtol);
    }
    at += snprintf(text + at, size - (size_t)at, ", predictor %d, Newton %.0e", p->predictor, p->newton);
    for (int g = 0; g < d->groups && (size_t)at + 80 < size; g++) {
        const spari_shape *b = &p->group[g];
        at += snprintf(text + at, size - (size_t)at, ", %s", spari_fidelity_name(b->fidelity));
        if (b->modes > 0) {
            at += snprintf(text + at, size - (size_t)at, " %lld", (long long)b->modes);
        }
        at += snprintf(text + at, size - (size_t)at, " of %d nodes", b->nodes);
        if (b->points > 0) {
            at += snprintf(text + at, size - (size_t)at, " and %d points", b->points);
        }
    }
    return text;
}

static void tell_plan(const spari_advisor *d, const spari_plan *p, double error, double cost) {
    spar_session *s = d->session;
    char what[SPARI_MESSAGE_SIZE / 2], text[SPARI_MESSAGE_SIZE];
    if (!s->log) {
        return;
    }
    (void)describe_plan(d, p, what, sizeof what);
    if (isfinite(error)) {
        (void)snprintf(text, sizeof text, "%s: trial %d: %s: error %.3g, cost %.4g", SPARI_ADVISE, d->trials, what,
                       error, cost);
    } else {
        (void)snprintf(text, sizeof text, "%s: trial %d: %s: fails: %.300s", SPARI_ADVISE, d->trials, what, s->message);
    }
    spari_log(s, SPAR_LOG_INFO, text);
}

double spari_plan_cost(const spari_advisor *d, const spari_record *r) {
    return r->work + d->fluid * (double)r->solutions;
}

/* How much larger an error is over the time that the host will run: errors of phase grow with time. */
static double later(const spari_advisor *d, const spari_record *r, const spari_record *base) {
    const double doubt = 2; /* of what was not seen, as against what was */
    double longer = d->session->horizon / (d->run.dt * (double)d->run.steps);
    return longer > 1 ? 1 + doubt * (spari_record_growth(r, base, longer) - 1) : 1;
}

int spari_plan_measure(spari_advisor *d, const spari_plan *p, spari_outcome *out) {
    for (int k = 0; k < d->known_count; k++) {
        if (memcmp(&d->known[k].plan, p, sizeof *p) == 0) {
            *out = d->known[k];
            return SPAR_OK;
        }
    }
    spari_record r;
    *out = (spari_outcome){*p, INFINITY, INFINITY};
    int status = spari_plan_run(d, p, 1, &r);
    if (status == SPAR_OK) {
        out->error = spari_record_motion(&r, &d->reference) * later(d, &r, &d->reference) + d->reference_error;
        out->cost = spari_plan_cost(d, &r);
    }
    spari_record_free(&r);
    if (status != SPAR_OK && !spari_plan_fails(status)) {
        return status;
    }
    tell_plan(d, p, out->error, out->cost);
    if (d->known_count < SPARI_KNOWN) {
        d->known[d->known_count++] = *out;
    }
    return SPAR_OK;
}

int spari_plan_is_good(const spari_advisor *d, const spari_outcome *o) {
    return o->error <= spari_rule.good * d->tolerance;
}

int spari_plan_distance(spari_advisor *d, const spari_plan *p, const spari_record *base, double *part, double *cost) {
    spari_record r;
    int status = spari_plan_run(d, p, 1, &r);
    *part = status == SPAR_OK ? spari_record_motion(&r, base) * later(d, &r, base) / d->tolerance : INFINITY;
    *cost = spari_plan_cost(d, &r);
    tell_plan(d, p, *part * d->tolerance, *cost);
    spari_record_free(&r);
    return spari_plan_fails(status) ? SPAR_OK : status;
}

/* ---- the reference ---- */

static spari_plan reference_plan(const spari_advisor *d, const spari_plan *present, int level) {
    const spar_session *s = d->session;
    spari_plan p = *present;
    p.newton = fmin(p.newton, spari_rule.reference_newton);
    p.substeps = 1;
    p.predictor = 1;
    if (!s->keep_coupling) {
        p.scheme = SPAR_COUPLING_IQN_ILS;
        p.rtol = spari_rule.reference_rtol;
    }
    p.steps = s->keep_dt ? present->steps : spari_plan_steps(d, 2 * level);
    for (int g = 0; g < d->groups; g++) {
        spari_shape *b = &p.group[g];
        if (!s->keep_fidelity) {
            b->fidelity = SPAR_FIDELITY_EXACT;
            b->modes = 0;
        }
        if (!s->keep_nodes) {
            b->nodes = b->nodes + 2 + level < SPARI_MAX_NODES ? b->nodes + 2 + level : SPARI_MAX_NODES;
        }
    }
    return p;
}

/* What a solution of the fluid counts for, by the reference runs. */
static void weigh_fluid(spari_advisor *d, double seconds, int64_t solutions) {
    spar_session *s = d->session;
    char text[SPARI_MESSAGE_SIZE];
    d->fluid = spari_cost_solution(s, d->reference.fluid, seconds, solutions);
    if (s->log) {
        (void)snprintf(text, sizeof text,
                       "%s: one solution of the fluid is counted as %.4g (%.4g by its nodes), one second as %.4g",
                       SPARI_ADVISE, d->fluid, d->reference.fluid, spari_rule.price.second);
        spari_log(s, SPAR_LOG_INFO, text);
    }
}

int spari_plan_reference(spari_advisor *d, const spari_plan *present, spari_plan *finest) {
    spar_session *s = d->session;
    double change = 0, before = 0, seconds = 0;
    int64_t solutions = 0;
    d->reference_error = INFINITY;
    d->run.timed = s->fluid_cost <= 0;
    int ends = s->keep_dt && s->keep_nodes ? 0 : s->keep_dt ? 2 : SPARI_FINEST;
    for (int level = 0; level <= ends && d->reference_error > spari_rule.reference_ends * d->tolerance; level++) {
        spari_record finer;
        spari_plan p = reference_plan(d, present, level);
        int status = spari_plan_run(d, &p, 1, &finer);
        if (status != SPAR_OK) {
            spari_record_free(&finer);
            if (!spari_plan_fails(status)) {
                return status;
            }
            tell_plan(d, &p, INFINITY, 0);
            continue; /* too coarse, perhaps */
        }
        seconds += finer.fluid_seconds, solutions += finer.solutions;
        before = change;
        change = d->reference.motion ? spari_record_motion(&d->reference, &finer) : 0;
        if (d->reference.motion) { /* what is left: the changes to come, a geometric series */
            double rate = before > 0 && change > 0 ? fmin(fmax(before / change, 1.25), 4) : 2;
            d->reference_error = change / (rate - 1) * later(d, &d->reference, &finer);
        } else if (ends == 0) {
            d->reference_error = 0;
        }
        tell_plan(d, &p, change, spari_plan_cost(d, &finer));
        spari_record_free(&d->reference);
        d->reference = finer;
        *finest = p;
    }
    d->run.timed = 0;
    weigh_fluid(d, seconds, solutions);
    SPARI_REQUIRE(s, d->reference.motion, SPAR_ERR_NUMERIC, "%s: no reference run comes to its end: %.400s",
                  SPARI_ADVISE, s->message);
    SPARI_REQUIRE(
        s, d->reference_error <= spari_rule.reference_most * d->tolerance, SPAR_ERR_NUMERIC,
        "%s: no reference to compare with: with dt/%lld and finer nodes its own error is about %.3g, and must "
        "be below %.3g to judge a tolerance of %g; give a larger one, begin with a smaller dt, or look "
        "whether the fluid solver is repeatable",
        SPARI_ADVISE, (long long)(finest->steps / d->run.steps), d->reference_error,
        spari_rule.reference_most * d->tolerance, d->tolerance);
    return SPAR_OK;
}

/* ---- stability ---- */

/* Whether a part of the loads that turns round with every step is there and grows, and not with the motion itself, as
   the finer run shows it. */
static int seesaws(const spari_record *r, const spari_record *finer) {
    double same = fmax(1, finer->alternating[1] / fmax(finer->alternating[0], DBL_MIN));
    return r->alternating[1] > spari_rule.seesaw && r->alternating[1] > spari_rule.grows * same * r->alternating[0];
}

int spari_plan_stays(spari_advisor *d, const spari_plan *p, int *stays) {
    int longer = spari_rule.longer, least = spari_rule.least_steps;
    longer = p->steps * longer < least ? (int)(least / p->steps) + 1 : longer;
    spari_plan q = *p;
    spari_record run, finer = {0};
    int status = spari_plan_run(d, p, longer, &run);
    if (status == SPAR_OK) {
        q.steps = 2 * p->steps;
        q.predictor = 1;
        q.newton = fmin(q.newton, spari_rule.stays_newton);
        if (!d->session->keep_coupling) {
            q.scheme = SPAR_COUPLING_IQN_ILS;
            q.rtol = spari_rule.stays_rtol;
        }
        status = spari_plan_run(d, &q, longer, &finer);
    }
    double error = status == SPAR_OK ? spari_record_motion(&run, &finer) : INFINITY;
    *stays = error <= longer * d->tolerance && !seesaws(&run, &finer);
    tell_plan(d, p, error, spari_plan_cost(d, &run));
    spari_record_free(&run);
    spari_record_free(&finer);
    return spari_plan_fails(status) ? SPAR_OK : status;
}
