/* Finds the cheapest settings for a tolerance by trials (settings_trial.h). First a converged reference run; then,
   each with a share of the tolerance, the simplifications of the structure; then coupling and dt together; then
   single and double moves as long as they pay; finally a longer run to check stability. Errors are those of whole
   runs; costs are counted (trial/cost.h). */
#include "../base/environment.h"
#include "../trial/cost.h"
#include "apply.h"
#include "settings_trial.h"

#include "../math/basis.h"
#include "../member/beam.h"
#include "../member/joint.h"
#include "../member/plane.h"
#include "../time/fidelity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double finer_power = 0.7; /* exponent of the cost in the number of steps: finer steps cost less each */

/* ---- the structure ---- */

/* The run against which shapes are measured. */
typedef struct shaping {
    spari_record base;
    double scale;               /* factor from its cost to the expected cost of a trial's time in the run */
    double work[SPARI_GROUPS];  /* of its cost: solving the members of each group, */
    double nodes[SPARI_GROUPS]; /* their nodes' other costs, */
    double count[SPARI_GROUPS]; /* and the number of nodes */
} shaping;

static double base_cost(const spari_advisor *d, const shaping *w) {
    return spari_plan_cost(d, &w->base);
}

/* Whether a trial can pay that reduces the base's cost to `after` at best; a setting that keeps the tolerance
   already must be beaten. before: cost of the present best, about that of the trial. */
static int shape_pays(spari_advisor *d, const shaping *w, double before, double after) {
    double have = fmin(w->scale * before, d->known_good);
    return after <= spari_rule.worth * before && spari_plan_pays(d, before, have - w->scale * after);
}

/* Lower bound of the cost of a run with other nodes of a group: solution and transfer scale with the nodes. */
static double with_nodes(const spari_advisor *d, const shaping *w, int g, double cost, int from, int to) {
    double part = (w->work[g] + w->nodes[g]) / base_cost(d, w);
    return cost * (1 - part + part * to / from);
}

/* Fewest nodes whose error stays in its share; the error decreases with the nodes. If one node less than the
   reference is too few, although a coarse dt had shown it sufficient, the reference was misled. cost: of a run with
   the present nodes. */
static int choose_nodes(spari_advisor *d, spari_plan *p, int g, const shaping *w, double part_before, double *cost) {
    int most = p->group[g].nodes, few = spari_rule.least_nodes - 1, enough = most;
    few = d->groups == 1 && d->few > few ? d->few : few;
    double loss = 0;
    while (enough - few > 1 && shape_pays(d, w, *cost, with_nodes(d, w, g, *cost, enough, few + 1))) {
        int middle = (few + enough) / 2;
        double part, took;
        spari_plan q = *p;
        q.group[g].nodes = middle;
        const spari_use use = {INFINITY, part_before + spari_rule.nodes};
        SPARI_TRY(spari_plan_distance(d, &q, &w->base, use, &part, &took));
        if (part <= spari_rule.nodes) {
            enough = middle;
            *cost = took;
        } else {
            few = middle;
            loss = part - part_before;
        }
    }
    d->misled = d->misled || (!d->thorough && few == most - 1 && loss > spari_rule.nodes);
    p->group[g].nodes = enough;
    return SPAR_OK;
}

/* Cost of a run with another shape of a group, from the cost of an iteration and from its nodes. */
static double with_shape(const spari_advisor *d, const shaping *w, int g, double cost, const spari_shape *from,
                         const spari_shape *to) {
    const spar_member *m = spari_plan_member(d, g);
    const spari_shape *both[2] = {from, to};
    double solved[2], whole = base_cost(d, w);
    for (int k = 0; k < 2; k++) {
        const spari_shape *b = both[k];
        solved[k] = b->fidelity == SPAR_FIDELITY_EXACT ? spari_cost_exact(m, b->elements, b->nodes, b->points)
                                                       : spari_cost_frame(m, b->elements, b->nodes, (int)b->modes);
    }
    double nodes = (double)(to->elements * to->nodes) / (from->elements * from->nodes);
    return cost * (1 + w->work[g] / whole * (solved[1] / solved[0] - 1) + w->nodes[g] / whole * (nodes - 1));
}

/* Largest number of nodes, with this number of elements, that is expected to be cheaper than the present; 0: none. */
static int most_nodes(const spari_advisor *d, const shaping *w, int g, double cost, const spari_shape *now,
                      int elements) {
    spari_shape b = *now;
    b.elements = elements;
    for (b.nodes = SPARI_MAX_NODES; b.nodes >= spari_rule.least_nodes; b.nodes--) {
        if (with_shape(d, w, g, cost, now, &b) <= spari_rule.worth * cost) {
            return b.nodes;
        }
    }
    return 0;
}

/* Tries a number of elements with the most nodes that are cheaper than the present; if these are sufficient, finds
   the fewest. Fewer than half of the present unknowns cannot be sufficient; with more elements, of lower order, not
   much fewer. *found: whether it is better. */
static int try_elements(spari_advisor *d, spari_plan *p, int g, const shaping *w, int elements, double *cost,
                        int *found) {
    const spari_shape now = p->group[g];
    const double before = *cost;
    const double unknowns = spari_rule.unknowns[elements > now.elements];
    int few =
            (int)ceil(unknowns * now.elements * (now.nodes - 1) / elements - 1e-9), /* one element has one node more */
        most = most_nodes(d, w, g, before, &now, elements), enough = most + 1;
    few = few < spari_rule.least_nodes - 1 ? spari_rule.least_nodes - 1 : few;
    *found = 0;
    for (int at = most; enough - few > 1; at = (few + enough) / 2) {
        spari_plan q = *p;
        spari_shape *b = &q.group[g];
        double part, took;
        b->elements = elements, b->nodes = few + 1;
        if (!shape_pays(d, w, *cost, with_shape(d, w, g, before, &now, b))) {
            break;
        }
        b->nodes = at;
        const spari_use use = {spari_rule.at_most * *cost, spari_rule.elements};
        SPARI_TRY(spari_plan_distance(d, &q, &w->base, use, &part, &took));
        if (part <= spari_rule.elements) {
            enough = at;
        } else {
            few = at;
        }
        if (part <= spari_rule.elements && took <= spari_rule.worth * *cost) {
            *p = q;
            *cost = took;
            *found = 1;
        }
    }
    return SPAR_OK;
}

static void tell_kept(const spari_advisor *d, const spar_member *m, const char *why) {
    char text[SPARI_MESSAGE_SIZE];
    if (d->session->callbacks.log) {
        (void)snprintf(text, sizeof text, "%s: '%.100s' keeps its %d elements: %s", SPARI_ADVISE, m->name,
                       m->mesh.elements, why);
        spari_log(d->session, SPAR_LOG_INFO, text);
    }
}

/* Tries other numbers of elements, from the present ones downwards and upwards, as far as they are better, and two
   beyond. */
static int choose_elements(spari_advisor *d, spari_plan *p, int g, const shaping *w, double *cost) {
    static const int ladder[] = {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64};
    enum { RUNGS = sizeof ladder / sizeof *ladder, TRIED = 2 };
    const int begun = p->group[g].elements;
    const char *holds = NULL;
    int tried = 0;
    for (int way = -1; way <= 1; way += 2) {
        int idle = 0;
        for (int k = way < 0 ? RUNGS - 1 : 0; k >= 0 && k < RUNGS && idle < TRIED; k += way) {
            int found = 0;
            const char *why = spari_plan_holds(d, g, ladder[k]);
            holds = why ? why : holds;
            if ((ladder[k] - begun) * way > 0 && !why) {
                SPARI_TRY(try_elements(d, p, g, w, ladder[k], cost, &found));
                idle = found ? 0 : idle + 1;
                tried = 1;
            }
        }
    }
    if (!tried && holds) {
        tell_kept(d, spari_plan_member(d, g), holds);
    }
    return SPAR_OK;
}

/* Changes of a beam that are tried, in order. after: an earlier row that must have been adopted; -1: none. */
static const struct {
    int fidelity, after;
    int64_t modes;
} fidelities[] = {{SPAR_FIDELITY_LINEAR, -1, 0},   {SPAR_FIDELITY_MODAL, 0, 16}, {SPAR_FIDELITY_MODAL, 0, 8},
                  {SPAR_FIDELITY_MODAL, 0, 4},     {SPAR_FIDELITY_MODAL, 0, 2},  {SPAR_FIDELITY_RIGID, -1, 0},
                  {SPAR_FIDELITY_PRESCRIBED, 5, 0}};
enum { FIDELITIES = sizeof fidelities / sizeof *fidelities };

/* Fraction of the motion relative to the root that belongs to a group with prescribed roots: lost if its members do
   not bend. */
static double bend_of_group(const spari_advisor *d, int g, const spari_record *base) {
    double most = 0;
    int k = 0;
    for (const spar_member *m = d->session->members; m; m = m->next, k++) {
        if (d->group[k] == g && spari_member_root_is_prescribed(m)) {
            most = fmax(most, spari_record_bend(base, d->session, m));
        }
    }
    return most;
}

static int has_joints(const spari_advisor *d, int g) {
    int found = 0, k = 0;
    for (const spar_member *m = d->session->members; m; m = m->next, k++) {
        found = found || (d->group[k] == g && spari_joint_of(m));
    }
    return found;
}

/* Whether the members can have this fidelity. Fidelities that need a prescribed root exclude free members, whose
   first six modes are rigid. Joints exclude linear and modal beams. Members that bend are not rigid. */
static int is_possible(const spari_advisor *d, int g, int fidelity, int64_t modes, const spari_record *base) {
    enum { RIGID_MODES = 6 };
    int given = spari_member_root_is_prescribed(spari_plan_member(d, g));
    if (!given && (spari_fidelity_row(fidelity)->prescribed_root || (modes > 0 && modes < RIGID_MODES))) {
        return 0;
    }
    if (fidelity >= SPAR_FIDELITY_LINEAR) {
        return !has_joints(d, g);
    }
    return !(d->search->goals & SPAR_GOAL_MOTION) || bend_of_group(d, g, base) <= spari_rule.fidelity * d->tolerance;
}

/* Lower bound of the cost of a run with the group at this fidelity; cost: the present one. */
static double least_cost(const spari_advisor *d, const spari_plan *p, int g, int k, const shaping *w, double cost) {
    double solved = 0;
    const spar_member *m = spari_plan_member(d, g);
    if (fidelities[k].fidelity >= SPAR_FIDELITY_LINEAR) {
        solved = w->count[g] * (double)w->base.solutions *
                 spari_cost_frame(m, p->group[g].elements, p->group[g].nodes, (int)fidelities[k].modes);
    }
    return fmax(0, cost - fmax(0, w->work[g] - solved));
}

static int choose_fidelity(spari_advisor *d, spari_plan *p, int g, const shaping *w, double *cost, double *part_of) {
    const double looser = 1.5; /* linear may lead to modal */
    spari_plan best = *p, q = *p;
    double as_it_was = *cost;
    int accepted[FIDELITIES] = {0};
    for (int k = 0; k < FIDELITIES; k++) {
        int after = fidelities[k].after;
        double part, took, least = least_cost(d, p, g, k, w, as_it_was);
        int leads = k == 0 ? 1 : k; /* to modal */
        if ((after >= 0 && !accepted[after]) ||
            !is_possible(d, g, fidelities[k].fidelity, fidelities[k].modes, &w->base) ||
            !shape_pays(d, w, *cost, fmin(least, least_cost(d, p, g, leads, w, as_it_was)))) {
            continue;
        }
        q.group[g].fidelity = fidelities[k].fidelity;
        q.group[g].modes = fidelities[k].modes;
        const spari_use use = {(k == 0 ? looser : spari_rule.at_most) * *cost, spari_rule.fidelity};
        SPARI_TRY(spari_plan_distance(d, &q, &w->base, use, &part, &took));
        accepted[k] = part <= spari_rule.fidelity;
        if (accepted[k] && took < spari_rule.worth * *cost) {
            best = q;
            *cost = took;
            *part_of = part;
        }
    }
    *p = best;
    return SPAR_OK;
}

static int choose_points(spari_advisor *d, spari_plan *p, int g, const shaping *w, double *cost) {
    const spari_beam *beam = spari_plan_member(d, g)->beam;
    double part, took;
    if (spari_beam_rule(beam) != SPAR_QUADRATURE_SECTIONS || beam->points == 1 ||
        !shape_pays(d, w, *cost, fmax(0, *cost - w->work[g]))) {
        return SPAR_OK;
    }
    spari_plan q = *p;
    q.group[g].points = 1;
    SPARI_TRY(spari_plan_distance(d, &q, &w->base, (spari_use){INFINITY, spari_rule.points}, &part, &took));
    if (part <= spari_rule.points) {
        *p = q;
        *cost = took;
    }
    return SPAR_OK;
}

static int is_elastic(const spari_plan *p, int g) {
    return p->group[g].fidelity >= SPAR_FIDELITY_LINEAR;
}

/* For members that do not bend: the fewest nodes with which the loads find the same line. */
static int choose_stiff_nodes(spari_advisor *d, spari_plan *p, int g, const shaping *w, double *cost) {
    double part = INFINITY, took = *cost;
    int now = p->group[g].nodes, own = spari_plan_member(d, g)->mesh.per_element;
    spari_plan q = *p;
    q.group[g].nodes = spari_rule.least_nodes;
    if (!d->search->keep_nodes && q.group[g].nodes < own &&
        shape_pays(d, w, *cost, with_nodes(d, w, g, *cost, now, spari_rule.least_nodes))) {
        const spari_use use = {spari_rule.at_most * *cost, spari_rule.fidelity};
        SPARI_TRY(spari_plan_distance(d, &q, &w->base, use, &part, &took));
    }
    p->group[g].nodes = own < now ? own : now;
    if (part <= spari_rule.fidelity) {
        *p = q;
        *cost = took;
    }
    return SPAR_OK;
}

static int choose_shapes(spari_advisor *d, spari_plan *p, const shaping *w) {
    double cost = base_cost(d, w);
    for (int g = 0; g < d->groups && !d->misled; g++) {
        double part = 0;
        if (!d->search->keep_fidelity) {
            SPARI_TRY(choose_fidelity(d, p, g, w, &cost, &part));
        }
        if (is_elastic(p, g)) {
            SPARI_TRY(choose_points(d, p, g, w, &cost));
            SPARI_TRY(d->search->keep_nodes ? SPAR_OK : choose_nodes(d, p, g, w, part, &cost));
            SPARI_TRY(d->search->keep_nodes || d->misled ? SPAR_OK : choose_elements(d, p, g, w, &cost));
        } else {
            SPARI_TRY(choose_stiff_nodes(d, p, g, w, &cost));
        }
    }
    return SPAR_OK;
}

/* Whether the fluid's added mass is too large for the scheme, according to the reference's coupling. */
static int is_too_heavy(const spari_advisor *d, int scheme) {
    return (scheme == SPAR_COUPLING_EXPLICIT || scheme == SPAR_COUPLING_FIXED_POINT) &&
           d->reference.report[SPAR_REPORT_ADDED_MASS] > spari_rule.heavy;
}

/* Base run for shapes: the reference with a coarser dt, Newton and coupling; explicit, if the result is close. */
static int run_base(spari_advisor *d, const spari_plan *finest, spari_plan *p, spari_record *base) {
    const spari_level *rough = spari_plan_rough(d);
    double away = INFINITY;
    *p = rough->plan;
    memcpy(p->group, finest->group, sizeof p->group);
    p->newton = fmax(p->newton, spari_rule.rough_newton * d->tolerance);
    p->predictor = 1;
    if (!d->search->keep_coupling && !is_too_heavy(d, SPAR_COUPLING_EXPLICIT)) {
        spari_plan q = *p;
        q.scheme = SPAR_COUPLING_EXPLICIT;
        SPARI_TRY(spari_plan_compare(d, &q, &rough->record, (spari_use){INFINITY, spari_rule.rough}, base, &away));
        if (away <= spari_rule.rough) {
            *p = q;
            return SPAR_OK;
        }
        if (base->value && base->off <= 0) {
            spari_outcome o = {.plan = q};
            SPARI_TRY(spari_plan_judge(d, base, &o));
        }
        spari_record_free(base);
    }
    p->rtol = d->search->keep_coupling ? p->rtol : fmax(p->rtol, spari_rule.rough_rtol * d->tolerance);
    return spari_plan_run(d, p, 1, INFINITY, base);
}

/* Splits the base's cost by groups, and estimates the cost of the run with the steps that it needs. */
static void weigh_base(const spari_advisor *d, const spari_plan *p, shaping *w) {
    double rest = w->base.work, nodes = 0;
    int k = 0;
    w->scale = pow((double)spari_plan_least_steps(d) / (double)p->steps, finer_power);
    for (const spar_member *m = d->session->members; m; m = m->next, k++) {
        int g = d->group[k];
        double own = g < 0 ? (double)m->nodes : p->group[g].elements * p->group[g].nodes;
        rest -= w->base.member_work[k];
        nodes += own;
        if (g >= 0) {
            w->work[g] += w->base.member_work[k];
            w->nodes[g] += own;
            w->count[g]++;
        }
    }
    for (int g = 0; g < d->groups; g++) {
        w->nodes[g] *= rest / nodes;
    }
}

/* Each choice is measured against the base. */
static SPARI_APART int choose_structure(spari_advisor *d, const spari_plan *finest, spari_plan *chosen) {
    spari_plan p;
    shaping w = {.scale = 1};
    int status = run_base(d, finest, &p, &w.base);
    if (status == SPAR_OK) {
        spari_outcome o = {.plan = p};
        weigh_base(d, &p, &w);
        status = spari_plan_judge(d, &w.base, &o);
        status = status == SPAR_OK ? choose_shapes(d, &p, &w) : status;
    }
    spari_record_free(&w.base);
    *chosen = p;
    return spari_plan_fails(status) ? SPAR_OK : status;
}

/* ---- dt and coupling ---- */

/* Steps on the dt grid to move, for an error of this order in dt. */
static int long_step_of(double ratio, double order) {
    return (int)lround(2 / order * log2(fmax(ratio, 1e-2)));
}

/* Order of the error in dt shown by two measurements. */
static double order_of(const spari_outcome *a, const spari_outcome *b) {
    double steps = log((double)b->plan.steps / (double)a->plan.steps), fall = log(a->error / b->error);
    return isfinite(fall) && fabs(steps) > 0.1 ? fmin(fmax(fall / steps, 0.7), 4) : 2;
}

/* Coarsest steps that keep the tolerance, from grid position j on; *best improves if that is cheaper. */
static int coarsest_steps(spari_advisor *d, spari_plan p, int j, spari_outcome *best) {
    const int finest = 2 * SPARI_FINEST, coarsest = (int)floor(2 * log2((double)SPARI_MULTIPLE / (double)d->run.steps));
    int good = finest + 1, bad = coarsest - 1, at = j, failed = 0; /* twice: finer steps will not help */
    spari_outcome o, last = {.error = INFINITY};
    while (good - bad > 1 && d->known_count < spari_rule.tried && failed < 2) {
        p.steps = spari_plan_steps(d, at);
        SPARI_TRY(spari_plan_measure(d, &p, spari_rule.at_most * best->cost, &o));
        double ratio = isfinite(o.error) ? o.error / d->tolerance : 4,
               order =
                   isfinite(o.error) && isfinite(last.error) && !o.guessed && !last.guessed ? order_of(&last, &o) : 2;
        int is_good = spari_plan_is_good(d, &o);
        failed += !isfinite(o.error);
        last = o;
        if (is_good) {
            good = at;
            *best = o.cost < spari_rule.worth * best->cost ? o : *best;
            if (ratio > 0.5 * spari_rule.good) {
                return SPAR_OK; /* the next position has twice the error */
            }
        } else {
            bad = at;
            if (o.cost > best->cost && isfinite(o.cost)) {
                return SPAR_OK; /* finer steps cost even more */
            }
        }
        /* by the order the next position is near; then halve the gap */
        int long_step = long_step_of(ratio / spari_rule.good, order);
        long_step = is_good ? (long_step < -1 ? long_step : -1) : (long_step > 1 ? long_step : 1);
        at += long_step;
        if (at >= good || at <= bad) {
            at = (good + bad) / 2;
            at = at >= good ? good - 1 : at <= bad ? bad + 1 : at;
        }
    }
    return SPAR_OK;
}

/* Whether an iterated scheme can be cheaper: it needs at least two solutions per step, and at least the steps of a
   tight coupling. */
static int may_iterate(const spari_advisor *d, const spari_outcome *best) {
    const double saved = 1.6;
    return !isfinite(best->cost) || best->plan.scheme != SPAR_COUPLING_EXPLICIT ||
           (double)best->plan.steps > saved * (double)spari_plan_least_steps(d);
}

static spari_plan coupled_by(const spari_plan *structure, int scheme, int predictor, double rtol) {
    spari_plan p = *structure;
    p.scheme = scheme, p.predictor = predictor, p.rtol = rtol;
    return p;
}

/* Searches from the steps that a tight coupling needs, from others, or from the host's own. */
static int search_steps(spari_advisor *d, const spari_plan *p, int64_t from, spari_outcome *best) {
    spari_outcome o;
    spari_plan q = *p;
    if (!d->search->keep_dt) {
        return coarsest_steps(d, q, spari_plan_grid(d, from > 0 ? from : spari_plan_least_steps(d)), best);
    }
    q.steps = d->run.steps;
    SPARI_TRY(spari_plan_measure(d, &q, INFINITY, &o));
    *best = spari_plan_is_good(d, &o) && o.cost < best->cost ? o : *best;
    return SPAR_OK;
}

/* Grid position to begin with: what a tight coupling needs, or more if a structure run, also an explicit one, shows
   it. seen: that run; of infinite error if there is none. */
static int begin_explicit(const spari_advisor *d, const spari_plan *structure, spari_outcome *seen) {
    int least = spari_plan_grid(d, spari_plan_least_steps(d)), begin = least;
    seen->error = INFINITY;
    for (int k = 0; k < d->known_count; k++) {
        const spari_outcome *o = &d->known[k];
        double ratio = o->error / (spari_rule.good * d->tolerance);
        if (isfinite(o->error) && o->plan.scheme == SPAR_COUPLING_EXPLICIT && o->plan.substeps == structure->substeps &&
            memcmp(o->plan.group, structure->group, sizeof structure->group) == 0) {
            int at = spari_plan_grid(d, o->plan.steps), long_step = long_step_of(ratio, 2);
            begin = ratio > 1 ? at + (long_step > 1 ? long_step : 1) : at;
            *seen = *o;
        }
    }
    return begin > least ? begin : least;
}

/* Explicit coupling at a grid position, from one predictor on: the better of them; the second if the first does not
   keep the tolerance. */
static int try_explicit(spari_advisor *d, const spari_plan *structure, int at, int predictor, spari_outcome *better) {
    *better = (spari_outcome){.error = INFINITY, .cost = INFINITY};
    for (; predictor <= 2 && !is_too_heavy(d, SPAR_COUPLING_EXPLICIT) && !spari_plan_is_good(d, better); predictor++) {
        spari_outcome o;
        spari_plan p = coupled_by(structure, SPAR_COUPLING_EXPLICIT, predictor, d->session->coupling.rtol);
        p.steps = d->search->keep_dt ? d->run.steps : spari_plan_steps(d, at);
        SPARI_TRY(spari_plan_measure(d, &p, INFINITY, &o));
        *better = o.error < better->error ? o : *better;
    }
    return SPAR_OK;
}

/* Whether another accelerator or predictor can pay: if it reduced the solutions of the best per step to one. */
static int other_pays(spari_advisor *d, const spari_outcome *best) {
    double least = best->cost / fmax(best->solutions, 1);
    return !isfinite(best->cost) || (least < spari_rule.worth * best->cost &&
                                     spari_plan_pays(d, best->cost, spari_rule.hope * (best->cost - least)));
}

static int try_iterated(spari_advisor *d, const spari_plan *structure, spari_outcome *best) {
    static const struct {
        int scheme, predictor;
        double rtol;
    } coupling[] = {{SPAR_COUPLING_IQN_ILS, 2, 1e-2},
                    {SPAR_COUPLING_FIXED_POINT, 1, 1e-2},
                    {SPAR_COUPLING_IQN_ILS, 1, 1e-2},
                    {SPAR_COUPLING_IQN_ILS, 1, 1e-3}};
    enum { SCHEMES = sizeof coupling / sizeof *coupling, TIGHT = SCHEMES - 1 };
    for (int k = 0; k < SCHEMES; k++) {
        if (is_too_heavy(d, coupling[k].scheme) || (k == TIGHT && isfinite(best->cost)) || !may_iterate(d, best) ||
            !other_pays(d, best)) {
            continue;
        }
        const spari_plan p = coupled_by(structure, coupling[k].scheme, coupling[k].predictor, coupling[k].rtol);
        SPARI_TRY(search_steps(d, &p, 0, best));
    }
    return SPAR_OK;
}

static int choose_time(spari_advisor *d, const spari_plan *structure, spari_outcome *best) {
    const spar_session *s = d->session;
    double goal = spari_rule.good * d->tolerance;
    spari_outcome direct, seen;
    for (int predictor = 1; predictor <= 2 && d->search->keep_coupling; predictor++) {
        const spari_plan p = coupled_by(structure, s->coupling.scheme, predictor, s->coupling.rtol);
        SPARI_TRY(search_steps(d, &p, 0, best));
    }
    if (d->search->keep_coupling) {
        return SPAR_OK;
    }
    int least = spari_plan_grid(d, spari_plan_least_steps(d)), begin = begin_explicit(d, structure, &seen),
        lags = begin > least + 1;
    if (spari_plan_is_good(d, &seen) && begin == spari_plan_grid(d, seen.plan.steps)) {
        direct = seen; /* with a looser Newton it does not justify a run */
    } else {
        SPARI_TRY(try_explicit(d, structure, lags ? least : begin, lags ? 2 : 1, &direct));
    }
    int far = isfinite(direct.error) && direct.error > spari_rule.near * goal;
    if (isfinite(direct.error) && !far) {
        SPARI_TRY(search_steps(d, &direct.plan, direct.plan.steps, best));
    }
    SPARI_TRY(try_iterated(d, structure, best));
    if (!far) {
        return SPAR_OK;
    }
    double order = isfinite(seen.error) && !direct.guessed ? order_of(&seen, &direct) : 2;
    if (seen.error < direct.error) {
        direct = seen;
        direct.plan.newton = structure->newton;
        direct.plan.steps = spari_plan_steps(d, begin);
    }
    /* what keeps the tolerance costs at best: a run of finer steps, which cost less each */
    double cost = pow(fmax(1, direct.error / goal), finer_power / order) * direct.cost;
    if (!isfinite(best->cost) || (cost < best->cost && spari_plan_pays(d, cost, best->cost - cost))) {
        SPARI_TRY(search_steps(d, &direct.plan, direct.plan.steps, best));
    }
    return SPAR_OK;
}

/* ---- moves ---- */

/* Changes one setting of the plan; 0: impossible. */
typedef int (*move)(const spari_advisor *d, spari_plan *p, int g);

static int coarser(const spari_advisor *d, spari_plan *p, int g) {
    (void)g;
    int64_t steps = spari_plan_steps(d, spari_plan_grid(d, p->steps) - 1);
    int moved = !d->search->keep_dt && steps < p->steps;
    p->steps = moved ? steps : p->steps;
    return moved;
}

static int finer(const spari_advisor *d, spari_plan *p, int g) {
    (void)g;
    p->steps = spari_plan_steps(d, spari_plan_grid(d, p->steps) + 1);
    return !d->search->keep_dt;
}

static int fewer_nodes(const spari_advisor *d, spari_plan *p, int g) {
    return !d->search->keep_nodes && p->group[g].nodes-- > spari_rule.least_nodes;
}

static int more_nodes(const spari_advisor *d, spari_plan *p, int g) {
    return !d->search->keep_nodes && is_elastic(p, g) && p->group[g].nodes++ < SPARI_MAX_NODES;
}

static int fewer_points(const spari_advisor *d, spari_plan *p, int g) {
    int moved = is_elastic(p, g) && p->group[g].points == 0 &&
                spari_beam_rule(spari_plan_member(d, g)->beam) == SPAR_QUADRATURE_SECTIONS;
    p->group[g].points = moved ? 1 : p->group[g].points;
    return moved;
}

static int lower_fidelity(const spari_advisor *d, spari_plan *p, int g) {
    spari_shape *b = &p->group[g];
    if (d->search->keep_fidelity) {
        return 0;
    }
    if (b->modes > 1) {
        b->modes /= 2;
        return 1;
    }
    int lower = spari_member_plane(spari_plan_member(d, g)) ? 0 : spari_fidelity_row(b->fidelity)->lower;
    if (lower > 0) {
        b->fidelity = lower;
        b->modes = spari_fidelity_row(lower)->takes_modes ? spari_rule.modes : 0;
        return 1;
    }
    return 0;
}

static int looser_newton(const spari_advisor *d, spari_plan *p, int g) {
    (void)d, (void)g;
    p->newton *= 1e3;
    p->strict = 1;
    return p->newton <= spari_rule.loosest_newton;
}

static int other_predictor(const spari_advisor *d, spari_plan *p, int g) {
    (void)d, (void)g;
    p->predictor = 3 - p->predictor;
    return p->predictor == 1 || p->predictor == 2;
}

static int more_substeps(const spari_advisor *d, spari_plan *p, int g) {
    p->substeps *= 2;
    return p->substeps <= spari_rule.most_substeps && coarser(d, p, g) && coarser(d, p, g);
}

static const struct {
    move first, second;
} moves[] = {{coarser, NULL},           {fewer_nodes, NULL},        {fewer_points, NULL},  {lower_fidelity, NULL},
             {looser_newton, NULL},     {other_predictor, coarser}, {more_substeps, NULL}, {finer, fewer_nodes},
             {coarser, more_nodes},     {finer, lower_fidelity},    {finer, fewer_points}, {coarser, coarser},
             {fewer_nodes, fewer_nodes}};

/* Whether further search can pay: its cost so far is less than a fraction of its savings. */
static int pays(const spari_advisor *d, const spari_outcome *best) {
    double now = d->now > 0 ? d->now : best->cost, spent = d->spent - (d->good_as_is ? 0 : d->shown),
           saved = d->runs * (d->known_good - best->cost);
    return d->known_count < spari_rule.tried && d->spent + best->cost < d->limit * now &&
           spent + best->cost <= spari_rule.worth_asking * saved;
}

/* Moves as long as one pays and keeps the tolerance. */
static int improve(spari_advisor *d, spari_outcome *best) {
    enum { MOVES = sizeof moves / sizeof *moves };
    int rounds = d->groups > 0 ? d->groups : 1, idle = 0; /* moves since the last that paid */
    for (int k = 0; idle < MOVES && pays(d, best); k = (k + 1) % MOVES, idle++) {
        for (int g = 0; g < rounds && pays(d, best); g++) {
            spari_plan p = best->plan;
            spari_outcome o;
            if (!moves[k].first(d, &p, g) || (moves[k].second && !moves[k].second(d, &p, g))) {
                continue;
            }
            SPARI_TRY(spari_plan_measure(d, &p, spari_rule.at_most * best->cost, &o));
            if (spari_plan_is_good(d, &o) && o.cost < spari_rule.worth * best->cost) {
                *best = o;
                idle = 0;
            }
        }
    }
    return SPAR_OK;
}

/* ---- stability of the result ---- */

/* Of one kind in time, whatever the steps. */
static int is_same_kind(const spari_plan *a, const spari_plan *b) {
    return a->scheme == b->scheme && a->predictor == b->predictor && a->substeps == b->substeps;
}

/* Whether a is bound to be unstable where b is: the same in time, with no finer steps and no tighter coupling. */
static int is_no_stabler(const spari_plan *a, const spari_plan *b) {
    return is_same_kind(a, b) && a->steps <= b->steps && (a->scheme == SPAR_COUPLING_EXPLICIT || a->rtol >= b->rtol);
}

/* The cheapest of what is known that keeps the tolerance, of another kind than what drifts away; or, at last, of the
   same one with finer steps. */
static spari_outcome next_best(spari_advisor *d, const spari_plan *drifts, int same) {
    spari_outcome next = {.error = INFINITY, .cost = INFINITY};
    for (int i = 0; i < d->known_count; i++) {
        spari_outcome *o = &d->known[i];
        if (is_no_stabler(&o->plan, drifts)) {
            o->error = INFINITY;
        } else if (spari_plan_is_good(d, o) && o->cost < next.cost && (same || !is_same_kind(&o->plan, drifts))) {
            next = *o;
        }
    }
    return next;
}

/* Maximum useful cost of a longer run, in trials: above the cost of the alternative the setting is not wanted in any
   case. Unstable settings make Newton iterate more. */
static double most_of_look(const spari_advisor *d, const spari_outcome *now, const spari_plan *looked) {
    double most = d->good_as_is ? now->cost : INFINITY;
    for (int k = 0; k < d->known_count; k++) {
        const spari_outcome *o = &d->known[k];
        most = spari_plan_is_good(d, o) && !is_no_stabler(&o->plan, looked) ? fmin(most, o->cost) : most;
    }
    return spari_rule.at_most * most;
}

/* Alternatives to an unstable setting: the other predictor, iterated schemes; finer steps; any known, more expensive
   setting. */
static int try_stabler(spari_advisor *d, const spari_outcome *now, const spari_plan *drifts, spari_outcome *best) {
    spari_plan p = *drifts;
    spari_outcome o = {.error = INFINITY, .cost = INFINITY};
    double most = d->good_as_is ? now->cost : INFINITY;
    if (other_predictor(d, &p, 0)) {
        SPARI_TRY(spari_plan_measure(d, &p, most, &o));
    }
    *best = next_best(d, drifts, 0);
    if (!(best->cost < most) && !d->search->keep_coupling) {
        o = (spari_outcome){.error = INFINITY, .cost = INFINITY};
        SPARI_TRY(try_iterated(d, drifts, &o));
        *best = next_best(d, drifts, 0);
    }
    *best = isfinite(best->cost) ? *best : next_best(d, drifts, 1);
    return SPAR_OK;
}

/* The cheapest setting that keeps the tolerance and is stable. The present session is kept if a longer run of the
   others costs more than they save; it is not checked itself, because the host uses it. */
static int find_stable(spari_advisor *d, const spari_outcome *now, spari_outcome *best) {
    int stays = 0;
    for (int k = 0; k < spari_rule.doubted && isfinite(best->cost); k++) {
        double look = spari_plan_look(d, &best->plan) * best->cost;
        int others = memcmp(&best->plan, &now->plan, sizeof now->plan) != 0;
        if (d->good_as_is && (!others || !spari_plan_pays(d, look, now->cost - best->cost))) {
            d->skipped += !others;
            *best = *now;
            return SPAR_OK;
        }
        double before = d->spent;
        SPARI_TRY(spari_plan_stays(d, &best->plan, k < spari_rule.trusted, most_of_look(d, now, &best->plan), &stays));
        d->shown += d->spent - before;
        if (stays) {
            return SPAR_OK;
        }
        const spari_plan drifts = best->plan;
        SPARI_TRY(try_stabler(d, now, &drifts, best));
    }
    return spari_fail(
        d->session, SPAR_ERR_NUMERIC,
        "%s: settings that meet the tolerance in the trials drift afterwards; use more steps or a larger tolerance",
        SPARI_ADVISE);
}

/* The cheapest of what is known to keep the tolerance: among it are runs that were made for the structure. */
static void take_known(const spari_advisor *d, spari_outcome *best) {
    for (int k = 0; k < d->known_count; k++) {
        const spari_outcome *o = &d->known[k];
        *best = spari_plan_is_good(d, o) && o->cost < best->cost ? *o : *best;
    }
}

/* Lower bound of the structure's cost for any steps and coupling that keep the tolerance, from its own runs:
   explicit coupling with the steps of a tight one; 0: unknown. */
static double least_in_time(const spari_advisor *d, const spari_plan *structure) {
    double least = 0, steps = (double)spari_plan_least_steps(d);
    for (int k = 0; k < d->known_count; k++) {
        const spari_outcome *o = &d->known[k];
        if (isfinite(o->error) && o->plan.scheme == SPAR_COUPLING_EXPLICIT && o->plan.substeps == structure->substeps &&
            memcmp(o->plan.group, structure->group, sizeof structure->group) == 0) {
            double cost = o->cost * pow(steps / (double)o->plan.steps, finer_power);
            least = least > 0 ? fmin(least, cost) : cost;
        }
    }
    return least;
}

/* Coupling and dt, first with a looser Newton. If the structure's shares left nothing, the reference's settings are
   tried as they are. */
static int choose_rest(spari_advisor *d, spari_plan structure, const spari_plan *finest, spari_outcome *best) {
    static const double newton[] = {1e-3, 1e-6};
    spari_outcome have = *best;
    take_known(d, &have);
    if (least_in_time(d, &structure) > spari_rule.worth * have.cost) {
        *best = have;
        return SPAR_OK;
    }
    for (size_t k = 0; k < sizeof newton / sizeof *newton && !isfinite(best->cost); k++) {
        structure.newton = newton[k];
        SPARI_TRY(choose_time(d, &structure, best));
    }
    if (!isfinite(best->cost)) {
        SPARI_TRY(choose_time(d, finest, best));
    }
    take_known(d, best);
    return SPAR_OK;
}

/* Records the present knowledge: the cheapest setting that keeps the tolerance (the session as it is, or the
   cheapest level with sufficiently fine steps at order 2), and the cost so far. The rest of the search must save its
   own cost. */
static void take_stock(spari_advisor *d, const spari_outcome *now) {
    double goal = spari_rule.good * d->tolerance;
    d->shown = d->spent;
    d->good_as_is = spari_plan_is_good(d, now);
    d->known_good = d->good_as_is ? now->cost : INFINITY;
    for (int k = 0; k < d->known_count; k++) {
        const spari_outcome *o = &d->known[k];
        double cost = o->cost * sqrt(fmax(1, o->error / goal));
        d->known_good = memcmp(&o->plan, &now->plan, sizeof o->plan) != 0 ? fmin(d->known_good, cost) : d->known_good;
    }
}

static int search_structure(spari_advisor *d, const spari_plan *present, const spari_record *run, spari_outcome *now,
                            spari_plan *finest, spari_plan *structure) {
    for (int twice = 0; twice < 2; twice++) {
        SPARI_TRY(spari_plan_reference(d, present, finest));
        *now = (spari_outcome){.plan = *present, .error = INFINITY, .cost = INFINITY};
        SPARI_TRY(run->value ? spari_plan_judge(d, run, now) : SPAR_OK);
        SPARI_TRY(spari_plan_judge_levels(d));
        take_stock(d, now);
        spari_plan_begin(d, SPARI_STAGE_SHAPES);
        SPARI_TRY(choose_structure(d, finest, structure));
        if (!d->misled) {
            break;
        }
        spari_plan_forget(d);
        d->known_count = d->cap = d->misled = 0;
        d->thorough = 1;
    }
    return SPAR_OK;
}

static SPARI_APART int search_plans(spari_advisor *d, const spari_plan *present, spari_outcome *now,
                                    spari_outcome *best) {
    spari_plan finest, structure;
    spari_record run = {0};
    int status = spari_plan_try_present(d, present, &run);
    status = status == SPAR_OK ? search_structure(d, present, &run, now, &finest, &structure) : status;
    spari_record_free(&run);
    SPARI_TRY(status);
    spari_plan_begin(d, SPARI_STAGE_TIME);
    SPARI_TRY(choose_rest(d, structure, &finest, best));
    if (spari_plan_is_good(d, now) && now->cost < best->cost) {
        *best = *now;
    }
    if (isfinite(best->cost)) {
        spari_plan_begin(d, SPARI_STAGE_MOVES);
        SPARI_TRY(improve(d, best));
        spari_plan_begin(d, SPARI_STAGE_LOOKS);
        return find_stable(d, now, best);
    }
    double least = INFINITY;
    for (int k = 0; k < d->known_count; k++) {
        least = fmin(least, d->known[k].error);
    }
    return spari_fail(d->session, SPAR_ERR_NUMERIC,
                      "%s: none of %d trials meets the tolerance %g; the smallest error is %.3g; give a larger "
                      "tolerance, or start with a smaller dt",
                      SPARI_ADVISE, d->trials, d->tolerance, least);
}

static void hand_over(spari_advisor *d, const spari_outcome *now, const spari_outcome *best, spari_rebuild *beam,
                      spari_advised *advised) {
    const spari_plan *p = &best->plan;
    const int64_t runs = d->trials, skipped = d->skipped;
    int64_t k = 0;
    for (const spar_member *m = d->session->members; m; m = m->next, k++) {
        beam[k] = spari_rebuild_of(m);
        if (d->group[k] >= 0) {
            const spari_shape *b = &p->group[d->group[k]];
            beam[k] = (spari_rebuild){b->nodes, b->fidelity, b->modes, b->points, 0, b->elements};
        }
    }
    const int counts = d->now > 0;
    free(advised->beam);
    *advised = (spari_advised){.given = 1,
                               .of = spari_advised_of(d->session),
                               .dt = d->run.dt * (double)d->run.steps / (double)p->steps,
                               .substeps = p->substeps,
                               .scheme = p->scheme,
                               .coupling_rtol = p->rtol,
                               .predictor = p->predictor,
                               .newton_rtol = p->newton,
                               .members = k,
                               .beam = beam,
                               .error = best->error,
                               .cost = isfinite(now->cost) && now->cost > 0 ? best->cost / now->cost : 0,
                               .present_fails = !isfinite(now->error),
                               .present_error = isfinite(now->error) ? now->error : 0,
                               .runs = runs,
                               .skipped = skipped,
                               .work = counts ? d->spent / d->now : 0,
                               .shown = counts ? d->shown / d->now : 0,
                               .saved = counts ? d->runs * (d->known_good - best->cost) / d->now : 0};
    (void)spari_settings_varied(d->session, advised->setting);
    spari_plan_settings(p, advised->setting);
}

static int check_request(spar_trial *t, double tolerance, double length) {
    const double most = 1e300;
    spar_session *s = t->session;
    SPARI_TRY(spari_trial_ready_for_runs(t, SPARI_ADVISE));
    SPARI_REQUIRE(s, tolerance > 0 && tolerance < 1, SPAR_ERR_ARGUMENT, "%s: the tolerance is %g; give one in (0, 1)",
                  SPARI_ADVISE, tolerance);
    SPARI_REQUIRE(s, length > 0 && length <= most, SPAR_ERR_ARGUMENT,
                  "%s: the length is %g; give the duration of the planned run in seconds", SPARI_ADVISE, length);
    SPARI_REQUIRE(s, t->solve, SPAR_ERR_UNSUPPORTED,
                  "%s: the trial has no fluid solver; give spar_trial_set_callbacks the solver passed to spar_step",
                  SPARI_ADVISE);
    return SPAR_OK;
}

static int find_advice(spar_trial *t, double tolerance, double length) {
    spar_session *s = t->session;
    spari_advisor d = {.session = s,
                       .tolerance = tolerance,
                       .search = &t->search,
                       .limit = t->search.limit > 0 ? t->search.limit : INFINITY,
                       .stalled = INFINITY,
                       .longer = fmax(1, length / (t->dt * (double)t->steps)),
                       .progress = spari_trial_progress(t, SPARI_ADVISE)};
    d.run = spari_trial_run_of(t, &d.progress);
    d.run.goals = t->search.goals;
    d.runs = fmax(d.longer, spari_rule.least_runs);
    spari_outcome now = {0}, best = {.cost = INFINITY, .error = INFINITY};
    char message[SPARI_MESSAGE_SIZE];
    memcpy(message, s->message, sizeof message);
    spari_rebuild *beam = spari_zalloc(s->member_count, sizeof *beam);
    int status = beam ? spari_plan_groups(&d) : spari_fail(s, SPAR_ERR_MEMORY, "%s: no memory", SPARI_ADVISE);
    status = spari_comm_agree(s->ranks.comm, status, s->message, sizeof s->message);
    if (status == SPAR_OK) {
        spari_plan present = spari_plan_present(&d);
        status = spari_progress_ends(&d.progress, search_plans(&d, &present, &now, &best));
    }
    if (status == SPAR_OK) {
        memcpy(s->message, message, sizeof message); /* a failure in a trial is no failure of the session */
        hand_over(&d, &now, &best, beam, &t->advised);
    } else {
        free(beam);
    }
    free(d.group);
    free(d.known);
    spari_plan_forget(&d);
    free(d.level);
    return status;
}

int spar_trial_advise(spar_trial *trial, double tolerance, double length) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, trial, SPAR_ERR_ARGUMENT, "%s: the trial is NULL; create it first", SPARI_ADVISE);
    const spari_agreed arguments[] = {spari_real("tolerance", tolerance), spari_real("length", length)};
    SPARI_TRY(spari_trial_enter(trial, SPARI_ADVISE, arguments, 2, check_request(trial, tolerance, length)));
    int status = spari_named(trial->session, SPARI_ADVISE, find_advice(trial, tolerance, length));
    spari_trial_leave(trial);
    return status;
}
