/* Trials of settings for the advice: describe, run, measure, compare. See settings_trial.h. */
#include "settings_trial.h"

#include "../trial/cost.h"
#include "../trial/move_joints.h"

#include "../coupling/schemes.h"
#include "../math/basis.h"
#include "../member/applied.h"
#include "../member/beam.h"
#include "../time/fidelity.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- plans ---- */

static int is_varied(const spar_member *m) {
    return m->kind == SPARI_BEAM && !m->external && !spari_joints_hold_within(m, m->mesh.elements);
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
    d->level = spari_zalloc(SPARI_LEVELS, sizeof *d->level);
    SPARI_REQUIRE(d->session, d->group && d->known && d->level, SPAR_ERR_MEMORY, "%s: no memory", SPARI_ADVISE);
    int k = 0;
    for (const spar_member *m = s->members; m; m = m->next, k++) {
        d->group[k] = -1;
        for (int g = 0; g < d->groups && is_varied(m) && d->group[k] < 0; g++) {
            d->group[k] = spari_member_copy_hash(spari_plan_member(d, g)) == spari_member_copy_hash(m) ? g : -1;
        }
        if (d->group[k] < 0 && is_varied(m) && d->groups < SPARI_GROUPS) {
            d->group[k] = d->groups++;
        }
    }
    return SPAR_OK;
}

/* Whether a load is applied at a node that is the end of an element in only one of the present and the new mesh. */
static int is_loaded_within(const spar_member *m, int elements) {
    const double *follower = spari_applied_follower(m);
    for (int64_t node = 0; node < m->nodes; node++) {
        int any = 0;
        for (int c = 0; c < 6; c++) {
            any = any || m->load.dead[6 * node + c] != 0 || (follower && follower[6 * node + c] != 0);
        }
        if (any && spari_joints_end_node(m, node, (spari_mesh){elements, m->mesh.per_element}) < 0) {
            return 1;
        }
    }
    return 0;
}

const char *spari_plan_holds(const spari_advisor *d, int group, int elements) {
    const char *why = NULL;
    int k = 0;
    for (const spar_member *m = d->session->members; m && !why; m = m->next, k++) {
        if (d->group[k] == group && elements != m->mesh.elements) {
            why = m->beam->node_x                         ? "its nodes are set by the host"
                  : spari_joints_hold_within(m, elements) ? "a joint constrains a node that would lie within an element"
                  : is_loaded_within(m, elements)         ? "a load is applied at a node within an element"
                                                          : NULL;
        }
    }
    return why;
}

spari_plan spari_plan_present(const spari_advisor *d) {
    const spar_session *s = d->session;
    spari_plan p;
    memset(&p, 0, sizeof p);
    p.steps = d->run.steps;
    p.substeps = s->integrator.substeps, p.scheme = s->coupling.scheme, p.predictor = s->coupling.predictor;
    p.rtol = s->coupling.rtol, p.newton = s->newton.rtol, p.strict = s->newton.strict;
    for (int g = 0; g < d->groups; g++) {
        const spar_member *m = spari_plan_member(d, g);
        p.group[g].elements = m->mesh.elements;
        p.group[g].nodes = m->mesh.per_element;
        p.group[g].fidelity = m->fidelity;
        p.group[g].modes = m->modes;
    }
    return p;
}

void spari_plan_settings(const spari_plan *p, double *values) {
    SPARI_VARY(values, integrator.substeps, p->substeps);
    SPARI_VARY(values, coupling.scheme, p->scheme);
    SPARI_VARY(values, coupling.predictor, p->predictor);
    SPARI_VARY(values, coupling.rtol, p->rtol);
    SPARI_VARY(values, newton.rtol, p->newton);
    SPARI_VARY(values, newton.strict, p->strict);
}

int64_t spari_plan_steps(const spari_advisor *d, int j) {
    return (int64_t)fmax(SPARI_MULTIPLE, floor((double)d->run.steps * pow(2, 0.5 * j) + 0.5));
}

int spari_plan_grid(const spari_advisor *d, int64_t steps) {
    return (int)lround(2 * log2((double)steps / (double)d->run.steps));
}

/* ---- runs ---- */

int spari_plan_fails(int status) {
    return status == SPAR_ERR_NUMERIC || status == SPAR_ERR_USER || status == SPAR_ERR_STATE ||
           status == SPAR_ERR_UNSUPPORTED || status == SPAR_ERR_ARGUMENT || status == SPAR_ERR_MAPPING;
}

/* Cost so far, in trials with the present session; if that fails, in runs. */
static double spent_so_far(const spari_advisor *d) {
    return d->now > 0 ? d->spent / d->now : d->trials;
}

void spari_plan_begin(spari_advisor *d, int stage) {
    d->foreseen = spent_so_far(d) / spari_rule.comes_to[stage - 1];
    d->stage = stage;
}

/* A stage that takes longer than its share predicts that all will. */
static int tell_progress(spari_advisor *d) {
    double done = spent_so_far(d), expected = d->foreseen;
    if (expected <= 0) {
        expected = d->now > 0 || d->trials == 0 ? spari_rule.asks / sqrt(d->tolerance) : spari_rule.asks_runs;
    }
    expected = fmax(expected, done / spari_rule.comes_to[d->stage]);
    expected = fmax(done, fmin(expected, d->limit));
    return spari_progress_tell(d->session, &d->progress, done, expected);
}

int spari_plan_pays(spari_advisor *d, double trial, double saving) {
    int pays = d->runs * saving >= trial;
    d->skipped += !pays;
    return pays;
}

int spari_plan_run(spari_advisor *d, const spari_plan *p, int longer, double most, spari_record *record) {
    spar_session *s = d->session;
    spari_trial_settings trial_settings;
    spari_run run = d->run;
    run.most = isfinite(most) ? most : 0;
    run.fluid = d->fluid;
    *record = (spari_record){0};
    SPARI_REQUIRE(s, d->now <= 0 || d->spent < d->limit * d->now, SPAR_ERR_LIMIT,
                  "%s: %d trials have cost %.3g times a trial with the present settings; the option limit "
                  "allows %.3g: give a larger limit, a larger tolerance, or no limit (0)",
                  SPARI_ADVISE, d->trials, d->spent / d->now, d->limit);
    SPARI_TRY(tell_progress(d));
    SPARI_TRY(spari_trial_settings_create(s, &trial_settings));
    spari_plan_settings(p, trial_settings.setting);
    for (int k = 0; k < s->member_count; k++) {
        if (d->group[k] >= 0) {
            const spari_shape *g = &p->group[d->group[k]];
            spari_rebuild *r = trial_settings.member + k;
            r->elements = g->elements, r->per_element = g->nodes, r->fidelity = g->fidelity, r->modes = g->modes,
            r->points = g->points;
        }
    }
    run.beside = d->beside, run.off = d->off;
    run.steps = longer * p->steps;
    run.dt = d->run.dt * (double)d->run.steps / (double)p->steps;
    int status = spari_trial_run(s, &run, &trial_settings, record);
    d->trials++;
    d->spent += record->work + d->fluid * (double)record->solutions;
    d->solutions += d->weighed ? 0 : record->solutions;
    spari_trial_settings_free(&trial_settings);
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
    at += snprintf(text + at, size - (size_t)at, ", predictor %d, Newton ", p->predictor);
    at += snprintf(text + at, size - (size_t)at, p->strict ? "%.0e" : "balanced", p->newton);
    for (int g = 0; g < d->groups && (size_t)at + 80 < size; g++) {
        const spari_shape *b = &p->group[g];
        at += snprintf(text + at, size - (size_t)at, ", %s", spari_fidelity_name(b->fidelity));
        if (b->modes > 0) {
            at += snprintf(text + at, size - (size_t)at, " %lld", (long long)b->modes);
        }
        at += snprintf(text + at, size - (size_t)at, " of %d x %d nodes", b->elements, b->nodes);
        if (b->points > 0) {
            at += snprintf(text + at, size - (size_t)at, " and %d points", b->points);
        }
    }
    return text;
}

static void tell_plan(const spari_advisor *d, const spari_plan *p, double error, double cost) {
    spar_session *s = d->session;
    char what[SPARI_MESSAGE_SIZE / 2], text[SPARI_MESSAGE_SIZE];
    if (!s->callbacks.log || d->progress.stopped != SPAR_OK) {
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

/* Error of a relative to b, over a run `longer` times as long; all ranks use rank 0's bits. */
static int compare_runs(spari_advisor *d, const spari_record *a, const spari_record *b, double longer, double *error) {
    spar_session *s = d->session;
    double found[2] = {spari_comm_rank(s->ranks.comm) == 0 ? spari_record_error(a, b, d->search->goals, longer) : 0, 0};
    SPARI_TRY(spari_comm_sum(s->ranks.comm, found, 1, SPAR_OK, s->message, sizeof s->message));
    *error = found[0];
    return SPAR_OK;
}

/* Whether dt resolves the significant motion. */
static int resolves(const spari_advisor *d, const spari_plan *p) {
    return d->shortest <= 0 || d->shortest * (double)p->steps >= spari_rule.resolves;
}

static void remember(spari_advisor *d, const spari_outcome *o) {
    if (d->known_count < SPARI_KNOWN) {
        d->known[d->known_count++] = *o;
    }
}

/* Without messages. */
static int judge_silently(spari_advisor *d, const spari_record *r, spari_outcome *out) {
    double error;
    SPARI_TRY(compare_runs(d, r, &d->reference, d->longer, &error));
    out->error = resolves(d, &out->plan) ? error + d->reference_error : INFINITY;
    out->cost = spari_plan_cost(d, r);
    out->solutions = (double)r->solutions / (double)out->plan.steps;
    remember(d, out);
    return SPAR_OK;
}

int spari_plan_judge(spari_advisor *d, const spari_record *r, spari_outcome *out) {
    SPARI_TRY(judge_silently(d, r, out));
    tell_plan(d, &out->plan, out->error, out->cost);
    return SPAR_OK;
}

int spari_plan_judge_levels(spari_advisor *d) {
    for (int k = 0; k < d->levels; k++) {
        spari_outcome o = {.plan = d->level[k].plan};
        SPARI_TRY(judge_silently(d, &d->level[k].record, &o));
    }
    return SPAR_OK;
}

/* A run that ends when it is farther from another than is useful. */
static int run_beside(spari_advisor *d, const spari_plan *p, const spari_record *other, spari_use use,
                      spari_record *r) {
    d->beside = isfinite(use.share) ? other : NULL, d->off = use.share * d->tolerance;
    int status = spari_plan_run(d, p, 1, use.cost, r);
    d->beside = NULL;
    return status;
}

int spari_plan_measure(spari_advisor *d, const spari_plan *p, double most, spari_outcome *out) {
    for (int k = 0; k < d->known_count; k++) {
        if (memcmp(&d->known[k].plan, p, sizeof *p) == 0) {
            *out = d->known[k];
            return SPAR_OK;
        }
    }
    spari_record r = {0};
    *out = (spari_outcome){.plan = *p, .error = INFINITY, .cost = INFINITY};
    if (!resolves(d, p)) {
        return SPAR_OK; /* never advised, whatever a trial shows */
    }
    double off = spari_rule.near * spari_rule.good * d->tolerance - d->reference_error;
    int status = run_beside(d, p, &d->reference, (spari_use){most, off / d->tolerance}, &r);
    if (status == SPAR_OK) {
        status = spari_plan_judge(d, &r, out);
    } else if (spari_plan_fails(status)) {
        out->guessed = r.off > 0;
        out->error = out->guessed ? r.off + d->reference_error : INFINITY;
        out->cost = out->guessed ? spari_plan_cost(d, &r) * (double)p->steps / (double)r.steps_done
                    : r.dear     ? fmax(most, spari_plan_cost(d, &r))
                                 : INFINITY;
        remember(d, out);
        tell_plan(d, p, INFINITY, 0);
        status = SPAR_OK;
    }
    spari_record_free(&r);
    return status;
}

int spari_plan_is_good(const spari_advisor *d, const spari_outcome *o) {
    return o->error <= spari_rule.good * d->tolerance;
}

int spari_plan_compare(spari_advisor *d, const spari_plan *p, const spari_record *base, spari_use use, spari_record *r,
                       double *part) {
    int status = run_beside(d, p, base, use, r);
    *part = r->off > 0 ? r->off / d->tolerance : INFINITY;
    if (status == SPAR_OK) {
        status = compare_runs(d, r, base, d->longer, part);
        *part /= d->tolerance;
    }
    tell_plan(d, p, status == SPAR_OK ? *part * d->tolerance : INFINITY, spari_plan_cost(d, r));
    return spari_plan_fails(status) ? SPAR_OK : status;
}

int spari_plan_distance(spari_advisor *d, const spari_plan *p, const spari_record *base, spari_use use, double *part,
                        double *cost) {
    spari_record r;
    int status = spari_plan_compare(d, p, base, use, &r, part);
    if (status == SPAR_OK && isfinite(*part) && r.off <= 0 && d->reference.value) {
        spari_outcome o = {.plan = *p};
        status = judge_silently(d, &r, &o);
    }
    *cost = spari_plan_cost(d, &r);
    spari_record_free(&r);
    return status;
}

/* ---- the reference ---- */

static const spari_use whole = {INFINITY, INFINITY};
enum { MOST_MORE = 10 }; /* maximum additional nodes of the reference */

/* Cost of a fluid solution, from the first completed run. */
static void weigh_fluid(spari_advisor *d, const spari_record *r) {
    spar_session *s = d->session;
    char text[SPARI_MESSAGE_SIZE];
    if (d->weighed) {
        return;
    }
    d->fluid = spari_cost_solution(d->search->fluid_cost, r->fluid, r->fluid_seconds, r->solutions);
    d->spent += d->fluid * (double)d->solutions;
    d->weighed = 1;
    d->run.timed = 0;
    if (s->callbacks.log) {
        (void)snprintf(text, sizeof text,
                       "%s: cost of one fluid solution: %.4g (%.4g from its nodes); cost of one second: %.4g",
                       SPARI_ADVISE, d->fluid, r->fluid, spari_rule.price.second);
        spari_log(s, SPAR_LOG_INFO, text);
    }
    if (spari_cost_wavers(d->search->fluid_cost, r->fluid, r->fluid_seconds, r->solutions)) {
        spari_warn(s,
                   "%s: the fluid's time, %.3g s per solution, is between two cost classes, so the advice may vary "
                   "between runs; set the option fluid_cost of the trial",
                   SPARI_ADVISE, r->fluid_seconds / (double)r->solutions);
    }
}

int spari_plan_try_present(spari_advisor *d, const spari_plan *present, spari_record *record) {
    d->run.timed = d->search->fluid_cost <= 0;
    int status = spari_plan_run(d, present, 1, INFINITY, record);
    if (status == SPAR_OK) {
        weigh_fluid(d, record);
        d->now = spari_plan_cost(d, record);
    } else if (spari_plan_fails(status)) {
        tell_plan(d, present, INFINITY, 0);
        spari_record_free(record);
        status = SPAR_OK;
    }
    return status;
}

/* level 0: the host's dt; more: additional nodes. From level 0 on the coupling tolerance decreases with dt like the
   error of predicted loads. Otherwise the prediction alone meets the tolerance at a fine dt, and its lag, which
   accumulates over the run, changes the observed order. */
static spari_plan reference_plan(const spari_advisor *d, const spari_plan *present, int level, int more) {
    const double falls = d->search->keep_dt ? 1 : pow(4, -fmax(0, level));
    spari_plan p = *present;
    p.newton = fmax(spari_rule.reference_newton * d->tolerance, 1e-12);
    p.strict = 1;
    p.substeps = 1;
    p.predictor = 2;
    if (!d->search->keep_coupling) {
        p.scheme = SPAR_COUPLING_IQN_ILS;
        p.rtol = fmax(spari_rule.reference_rtol * d->tolerance * falls, 1e-10);
        p.newton = fmax(fmin(p.newton, p.rtol), 1e-12);
    }
    p.steps = d->search->keep_dt ? present->steps : spari_plan_steps(d, 2 * level);
    for (int g = 0; g < d->groups; g++) {
        spari_shape *b = &p.group[g];
        if (!d->search->keep_fidelity) {
            b->fidelity = SPAR_FIDELITY_EXACT;
            b->modes = 0;
        }
        if (!d->search->keep_nodes) {
            b->nodes = b->nodes + more < SPARI_MAX_NODES ? b->nodes + more : SPARI_MAX_NODES;
            b->nodes = d->cap > 0 && b->nodes > d->cap ? d->cap : b->nodes;
        }
    }
    return p;
}

/* A dt coarser than the host's must be cheap. */
static double most_of_level(const spari_advisor *d, const spari_plan *p) {
    return d->now > 0 && p->steps < d->run.steps ? spari_rule.coarse_most * d->now : INFINITY;
}

/* Runs it as the next level, which stays empty where it fails. */
static int run_level(spari_advisor *d, const spari_plan *p, int *made) {
    spari_level *l = &d->level[d->levels];
    l->plan = *p;
    double most = spari_rule.level_most / spari_rule.coarse_most * most_of_level(d, p); /* it need not be cheap */
    int status = spari_plan_run(d, p, 1, most, &l->record);
    *made = status == SPAR_OK;
    if (*made) {
        d->levels++;
    } else {
        d->dear_steps = p->steps;
        spari_record_free(&l->record);
    }
    return spari_plan_fails(status) ? SPAR_OK : status;
}

/* What a level is run with where it is for comparisons only. */
static spari_plan rough_plan(const spari_advisor *d, const spari_plan *present, int level, int more) {
    spari_plan p = reference_plan(d, present, level, more);
    p.newton = fmax(p.newton, spari_rule.rough_newton * d->tolerance);
    p.rtol = d->search->keep_coupling ? p.rtol : fmax(p.rtol, spari_rule.rough_rtol * d->tolerance);
    p.predictor = 1;
    return p;
}

/* Coarsest level that completes. */
static int run_coarsest(spari_advisor *d, const spari_plan *present, int *level, int more, spari_record *run) {
    int last = d->search->keep_dt ? 0 : SPARI_FINEST, status;
    spari_plan p = rough_plan(d, present, *level, more);
    for (; (status = spari_plan_run(d, &p, 1, most_of_level(d, &p), run)) != SPAR_OK;
         p = rough_plan(d, present, ++*level, more)) {
        d->dear_steps = run->dear ? d->dear_steps : p.steps;
        spari_record_free(run);
        tell_plan(d, &p, INFINITY, 0);
        SPARI_TRY(spari_plan_fails(status) ? SPAR_OK : status);
        SPARI_REQUIRE(d->session, *level < last, status, "%s: no reference run completes: %.400s", SPARI_ADVISE,
                      d->session->message);
    }
    weigh_fluid(d, run);
    return SPAR_OK;
}

/* Whether to try a finer dt because more nodes reduce the change only little: then the change is due to dt, and a
   finer dt shows the effect of the nodes. If it shows the same, the nodes are the cause from then on. */
static int is_dt(spari_advisor *d, int level, double part, double before) {
    const double same = 0.8;
    int stalls = part > before && isfinite(part) && level < SPARI_FINEST && !d->search->keep_dt;
    if (stalls && d->stalls <= 1) {
        d->stalls = part > same * d->stalled ? d->stalls + 1 : 1;
        d->stalled = part;
    }
    return stalls && d->stalls <= 1;
}

/* Fewer nodes than a run with `most`: one more than the number that changes little, because finer dt need no finer
   line. *shown: smallest change by fewer nodes; if it is small the run has enough nodes. *finer: see above. */
static int fewer_reference_nodes(spari_advisor *d, const spari_plan *present, int level, const spari_record *base,
                                 double *shown, double *two, int *finer) {
    int few = spari_rule.least_nodes - 1, most = few;
    for (int g = 0; g < d->groups; g++) {
        int nodes = rough_plan(d, present, level, 0).group[g].nodes;
        most = nodes > most ? nodes : most;
    }
    int enough = most;
    double before = INFINITY;
    const double near = 5; /* factor from the target: one more node may be sufficient */
    few = d->few > few && d->few < most ? d->few : few;
    while (enough - few > 2 || (enough == most && enough - few > 1 && *shown > spari_rule.reference_nodes &&
                                before < near * spari_rule.reference_nodes)) {
        double part, cost;
        d->cap = enough - few > 2 ? (few + enough) / 2 : few + 1;
        const spari_plan p = rough_plan(d, present, level, 0);
        SPARI_TRY(spari_plan_distance(d, &p, base, (spari_use){most_of_level(d, &p), 1}, &part, &cost));
        if (part <= spari_rule.reference_fewer) {
            enough = d->cap;
        } else if (is_dt(d, level, part, 0.9 * before)) {
            *finer = 1;
            break;
        } else {
            few = d->cap;
            before = part;
            d->few = part > 1 ? few : d->few;
        }
        *two = d->cap == most - 2 ? part : *two;
        *shown = fmin(*shown, part);
    }
    d->cap = few + 2 < most ? few + 2 : 0;
    return SPAR_OK;
}

/* Adds nodes to a run until two more change little; *shown: change by the fewer nodes, then by the last two. */
static int more_reference_nodes(spari_advisor *d, const spari_plan *present, int level, int *more, spari_record *few,
                                double before, double *shown, int *finer) {
    spari_record many = {0};
    double part = *shown;
    int status = SPAR_OK;
    spari_plan p = rough_plan(d, present, level, *more);
    while (status == SPAR_OK && *more < MOST_MORE && part > spari_rule.reference_nodes) {
        const spari_plan q = rough_plan(d, present, level, *more + 2);
        if (memcmp(&q, &p, sizeof p) == 0) {
            break; /* there are no more */
        }
        p = q;
        status = spari_plan_compare(d, &p, few, whole, &many, &part);
        if (is_dt(d, level, part, 0.5 * before)) {
            *finer = 1;
            break;
        }
        before = part;
        *more += part > spari_rule.reference_nodes && isfinite(part) ? 2 : 0;
        spari_record_free(few);
        *few = many;
        many = (spari_record){0};
        part = isfinite(part) ? part : 0;
    }
    spari_record_free(&many);
    *shown = part;
    return status;
}

/* Number of nodes of the reference: the present one, fewer, or more until two more change little; *left: estimated
   remaining error. The coarsest dt, coupling and Newton are used. */
static int reference_nodes(spari_advisor *d, const spari_plan *present, int *level, int *more, double *left) {
    const double spectral = 0.25; /* maximum fraction of the error that remains with two more nodes */
    const int begun = d->thorough || d->search->keep_dt ? 2 : 0;
    int status, finer;
    do {
        spari_record base = {0};
        double shown = INFINITY, two = INFINITY; /* changes by fewer nodes: the smallest, and by two */
        finer = 0;
        *more = begun;
        status = run_coarsest(d, present, level, begun, &base);
        if (status == SPAR_OK && begun == 0 && !d->search->keep_nodes) {
            status = fewer_reference_nodes(d, present, *level, &base, &shown, &two, &finer);
        }
        *left = spectral * shown * d->tolerance;
        if (status == SPAR_OK && shown > spari_rule.reference_nodes && !finer) {
            status = more_reference_nodes(d, present, *level, more, &base, two, &shown, &finer);
            *left = isfinite(shown) ? shown * d->tolerance : 0;
        }
        spari_record_free(&base);
        *level += finer;
    } while (status == SPAR_OK && finer);
    return status;
}

/* Error of the last level, from the decrease of the changes; *extrapolate: remaining part of the last change, 0:
   unknown. */
static double left_in_levels(const spari_advisor *d, double *extrapolate) {
    double change = d->level[d->levels - 1].change, before = d->levels > 2 ? d->level[d->levels - 2].change : 0,
           rate = before > 0 && change > 0 ? before / change : 2;
    *extrapolate = 0;
    if (before > 0 && rate >= spari_rule.regular[0] && rate <= spari_rule.regular[1]) {
        *extrapolate = 1 / (fmin(rate, 4) - 1);
        return spari_rule.believed * *extrapolate * change * d->tolerance;
    }
    return change / (fmin(fmax(rate, 1.25), 4) - 1) * d->tolerance;
}

/* Error of a level due to its own steps, in tolerances. */
static double error_of_level(const spari_advisor *d, int k) {
    double after = 0, part = 0, last = d->levels > 1 ? left_in_levels(d, &part) / d->tolerance : 0;
    for (int i = k + 1; i < d->levels; i++) {
        after += d->level[i].change;
    }
    return after + (part > 0 ? last / spari_rule.believed : last);
}

static int copy_reference(spari_advisor *d) {
    double part = 0;
    spari_level *l = &d->level[d->levels - 1];
    if (d->levels > 1) {
        (void)left_in_levels(d, &part);
    }
    d->reference = l->record;
    d->reference.value = spari_copy(l->record.value, spari_record_size(&l->record));
    d->reference.recent = spari_copy(l->record.recent, spari_record_size(&l->record) / SPARI_SAMPLES * 4);
    d->reference.load = d->reference.trail = d->reference.start = d->reference.workspace = NULL;
    d->reference.basis = d->reference.member_work = NULL;
    int status = d->reference.value && d->reference.recent
                     ? SPAR_OK
                     : spari_fail(d->session, SPAR_ERR_MEMORY, "%s: no memory", SPARI_ADVISE);
    SPARI_TRY(spari_comm_agree(d->session->ranks.comm, status, d->session->message, sizeof d->session->message));
    if (part > 0) {
        spari_record_extrapolate(&d->reference, &d->level[d->levels - 2].record, part);
    }
    return SPAR_OK;
}

void spari_plan_forget(spari_advisor *d) {
    spari_record_free(&d->reference);
    spari_record_free(&d->last_look);
    for (int k = 0; k < d->levels; k++) {
        spari_record_free(&d->level[k].record);
    }
    d->levels = 0;
}

/* Whether half the dt can pay although the present error is sufficient: a more accurate reference leaves more of the
   tolerance to dt, of order 2, in runs that cost at least about a level that keeps the tolerance. */
static int finer_pays(spari_advisor *d) {
    const spari_level *last = &d->level[d->levels - 1], *good = spari_plan_good_level(d);
    double margin = spari_rule.good - d->reference_error / d->tolerance, cost = spari_plan_cost(d, &last->record),
           run = good ? spari_plan_cost(d, &good->record) : cost;
    return d->reference_error > spari_rule.reference_most * d->tolerance ||
           spari_plan_pays(d, 2 * cost, run * (1 - sqrt(margin / spari_rule.good)));
}

/* Halves dt until the errors of steps and nodes are a small fraction of the tolerance, or small enough if the next
   run would not pay. */
static int refine(spari_advisor *d, const spari_plan *present, int level, int more, double nodes) {
    int made, keeps = d->search->keep_dt, ends = keeps ? level : SPARI_FINEST;
    double goal = spari_rule.reference_ends * d->tolerance, part;
    d->reference_error = INFINITY;
    for (; level <= ends && d->levels < SPARI_LEVELS && d->reference_error > goal; level++) {
        if (isfinite(d->reference_error) && !finer_pays(d)) {
            break;
        }
        const spari_plan p = reference_plan(d, present, level, more);
        SPARI_TRY(run_level(d, &p, &made));
        spari_level *l = d->levels > 0 ? &d->level[d->levels - 1] : d->level;
        if (made && d->levels == 1) {
            d->reference_error = keeps ? nodes : INFINITY;
        } else if (made) {
            SPARI_TRY(compare_runs(d, &l->record, &d->level[d->levels - 2].record, d->longer, &l->change));
            l->change /= d->tolerance;
            d->reference_error = left_in_levels(d, &part) + nodes;
        }
        tell_plan(d, &p, made ? l->change * d->tolerance : INFINITY, made ? spari_plan_cost(d, &l->record) : 0);
    }
    return SPAR_OK;
}

/* Warns if the motion still grows at the end of the trials: a longer run is then not covered. */
static void tell_growth(const spari_advisor *d, double T, double swells) {
    if (d->longer > spari_rule.foreseen && swells > spari_rule.swells) {
        spari_warn(d->session,
                   "%s: the motion still grows in the trials of %.4g s (%.3g times from the second third to the "
                   "last): the trials do not show the motion after %.4g s, and only phase errors are extrapolated; "
                   "give more steps if the motion changes later",
                   SPARI_ADVISE, T, swells, T * d->longer);
    }
}

/* Checks what trials of this length can establish about the run. */
static int check_reference(spari_advisor *d) {
    const spar_session *s = d->session;
    double T = d->run.dt * (double)d->run.steps, said[4] = {0};
    SPARI_REQUIRE(s, d->reference_error <= spari_rule.reference_most * d->tolerance, SPAR_ERR_NUMERIC,
                  "%s: no reference to compare with: with dt/%.3g and finer nodes the error of the reference is about "
                  "%.3g, but must be below %.3g for a tolerance of %g; give a larger tolerance, start with a smaller "
                  "dt, or check that the fluid solver is repeatable",
                  SPARI_ADVISE, (double)d->level[d->levels - 1].plan.steps / (double)d->run.steps, d->reference_error,
                  spari_rule.reference_most * d->tolerance, d->tolerance);
    if (spari_comm_rank(s->ranks.comm) == 0) {
        said[0] = spari_record_shortest(&d->reference, d->tolerance);
        said[1] = d->longer > spari_rule.foreseen ? spari_record_vouches(&d->reference) : 1;
        said[2] = spari_record_swells(&d->reference);
    }
    SPARI_TRY(spari_comm_sum(s->ranks.comm, said, 3, SPAR_OK, d->session->message, sizeof d->session->message));
    d->shortest = said[0];
    SPARI_REQUIRE(s, said[1] > 0, SPAR_ERR_NUMERIC,
                  "%s: trials of %.4g s do not represent a run of %.4g s: the trials cover neither a steady state nor "
                  "a full period; give more steps, or the length %.4g",
                  SPARI_ADVISE, T, T * d->longer, T);
    tell_growth(d, T, said[2]);
    return SPAR_OK;
}

int spari_plan_reference(spari_advisor *d, const spari_plan *present, spari_plan *finest) {
    int level = d->search->keep_dt ? 0 : -SPARI_COARSEST, more; /* the coarsest there may be */
    double nodes;
    while (level < 0 && spari_plan_steps(d, 2 * level) < 2 * SPARI_MULTIPLE) {
        level++;
    }
    SPARI_TRY(reference_nodes(d, present, &level, &more, &nodes));
    SPARI_TRY(refine(d, present, level, more, nodes));
    SPARI_REQUIRE(d->session, d->levels > 0, SPAR_ERR_NUMERIC, "%s: no reference run completes: %.400s", SPARI_ADVISE,
                  d->session->message);
    SPARI_TRY(copy_reference(d));
    SPARI_TRY(check_reference(d));
    *finest = d->level[d->levels - 1].plan;
    return SPAR_OK;
}

const spari_level *spari_plan_rough(const spari_advisor *d) {
    int k = 0;
    while (k < d->levels - 1 && error_of_level(d, k) > spari_rule.rough) {
        k++;
    }
    return &d->level[k];
}

const spari_level *spari_plan_good_level(const spari_advisor *d) {
    const spari_level *good = NULL;
    for (int k = 0; k < d->levels; k++) {
        const spari_level *l = &d->level[k];
        if (error_of_level(d, k) <= spari_rule.good && resolves(d, &l->plan) &&
            (!good || spari_plan_cost(d, &l->record) < spari_plan_cost(d, &good->record))) {
            good = l;
        }
    }
    return good;
}

int64_t spari_plan_least_steps(const spari_advisor *d) {
    double resolving = d->shortest > 0 ? ceil(spari_rule.resolves / d->shortest) : 0;
    resolving = fmax(resolving, 1.4 * (double)d->dear_steps); /* the next grid position */
    for (int k = 0; k < d->levels; k++) {
        double error = error_of_level(d, k);
        if (error <= spari_rule.good) { /* of order 2 */
            double steps = (double)d->level[k].plan.steps * sqrt(fmax(error, 0.25) / spari_rule.good);
            return (int64_t)fmax(steps, resolving);
        }
    }
    return (int64_t)fmax((double)d->level[d->levels - 1].plan.steps, resolving);
}

/* ---- stability ---- */

/* Whether a part of the loads that turns round with every step grows, and not with the motion itself, as the finer run
   shows it, until it counts in the host's run; `longer`: the look's. */
static int seesaws(const spari_advisor *d, const spari_plan *p, const spari_record *r, const spari_record *finer,
                   int longer) {
    double same = fmax(1, finer->alternating[1] / fmax(finer->alternating[0], DBL_MIN)),
           grows = r->alternating[1] / fmax(r->alternating[0], DBL_MIN) / same,
           more = fmax(0, d->longer - longer) / (0.5 * longer), limit = spari_rule.seesaw * d->tolerance;
    /* Square of the part of the loads that alternates because an iterated coupling ends at its tolerance: as much
       either way, in each of the second differences' four parts. It does not grow; the error of the motion has it. */
    double left = spari_coupling_scheme_of(p->scheme)->iterates ? 16 * p->rtol * p->rtol : 0;
    return grows > spari_rule.grows && r->alternating[1] > left &&
           r->alternating[1] * pow(grows, fmin(more, 100)) > limit * limit;
}

/* Comparison settings for the longer run: tight coupling, and half the dt if the coupling is tight already. */
static spari_plan last_look_plan(const spari_advisor *d, const spari_plan *p) {
    spari_plan q = *p;
    int keeps = d->search->keep_coupling;
    q.predictor = 1;
    q.newton = fmin(q.newton, fmax(spari_rule.stays_newton, spari_rule.rough_newton * d->tolerance));
    q.strict = 1;
    q.steps = keeps || spari_coupling_scheme_of(p->scheme)->iterates ? 2 * p->steps : p->steps;
    q.scheme = keeps ? p->scheme : SPAR_COUPLING_IQN_ILS;
    q.rtol = keeps ? p->rtol : fmax(spari_rule.stays_rtol, spari_rule.rough_rtol * d->tolerance);
    return q;
}

/* Runs them, unless the last comparison used the same. */
static int run_last_look(spari_advisor *d, const spari_plan *q, int longer, const spari_record *run, double limit) {
    int status = SPAR_OK;
    if (!d->last_look.value || d->last_look_longer != longer || memcmp(&d->last_look_plan, q, sizeof *q) != 0) {
        spari_record_free(&d->last_look);
        d->last_look_plan = *q, d->last_look_longer = longer;
        d->beside = run, d->off = limit; /* approximately: that run's error is relative to this one */
        status = spari_plan_run(d, q, longer, INFINITY, &d->last_look);
        d->beside = NULL;
    }
    return status;
}

/* Phase errors may have grown with time. */
static int stays_beside(spari_advisor *d, const spari_plan *p, int longer, const spari_record *run, int *stays) {
    const spari_plan q = last_look_plan(d, p);
    const double limit = longer * d->tolerance;
    double error = INFINITY;
    int status = run_last_look(d, &q, longer, run, limit);
    if (status == SPAR_OK) {
        status = compare_runs(d, run, &d->last_look, 1, &error);
    }
    *stays = status == SPAR_OK && error <= limit && !seesaws(d, p, run, &d->last_look, longer);
    tell_plan(d, &q, error, spari_plan_cost(d, &d->last_look));
    if (status != SPAR_OK) {
        spari_record_free(&d->last_look);
    }
    return spari_plan_fails(status) ? SPAR_OK : status;
}

int spari_plan_look(const spari_advisor *d, const spari_plan *p) {
    int longer = spari_rule.longer, least = spari_rule.least_steps;
    longer = p->steps * longer < least ? (int)(least / p->steps) + 1 : longer;
    return (int)fmin(longer, ceil(d->longer)); /* times after the host's run are irrelevant */
}

/* Result of the longer run: nothing suspicious; doubtful, to be compared with another run; or certain: an
   alternation in the loads that grows and is significant, while the motion does not grow. */
enum { LOOKS_FINE, LOOKS_DOUBTFUL, LOOKS_UNSTABLE };

static int verdict_of(const spari_advisor *d, const spari_plan *p, const spari_record *run, int longer) {
    double limit = spari_rule.seesaw * d->tolerance;
    int away = spari_record_reach(run) > spari_rule.looks_away * spari_record_reach(&d->reference),
        turns = seesaws(d, p, run, &d->reference, longer),
        counts = run->alternating[1] > spari_rule.evident * limit * limit;
    return turns && counts && !away ? LOOKS_UNSTABLE : turns || away ? LOOKS_DOUBTFUL : LOOKS_FINE;
}

int spari_plan_stays(spari_advisor *d, const spari_plan *p, int trusts, double most, int *stays) {
    int longer = spari_plan_look(d, p);
    spari_record run;
    double seen[2] = {0, 0};
    *stays = 1;
    if (longer == 1) {
        return SPAR_OK;
    }
    int status = spari_plan_run(d, p, longer, longer * most, &run);
    *stays = 0;
    if (status == SPAR_OK) {
        seen[0] = verdict_of(d, p, &run, longer);
        status =
            spari_comm_sum(d->session->ranks.comm, seen, 1, SPAR_OK, d->session->message, sizeof d->session->message);
        *stays = status == SPAR_OK && seen[0] == LOOKS_FINE;
    }
    tell_plan(d, p, status == SPAR_OK ? seen[0] : INFINITY, spari_plan_cost(d, &run));
    if (status == SPAR_OK && !*stays && !(trusts && seen[0] == LOOKS_UNSTABLE)) {
        status = stays_beside(d, p, longer, &run, stays);
    }
    spari_record_free(&run);
    return spari_plan_fails(status) ? SPAR_OK : status;
}
