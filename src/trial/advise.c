/* The cheapest settings for a tolerance, by trials (plan.h). First a run that is converged; then, one after the other
   with a share of the tolerance for each, what of the structure can be left out; then the coupling and dt together;
   then single and double moves that still pay; at last a longer run, whether what is cheapest stays stable. Errors are
   those of whole runs, costs what is counted in them (cost.h). */
#include "../base/quiet.h"
#include "apply.h"
#include "plan.h"

#include "../math/basis.h"
#include "../member/beam.h"
#include "../solve/fidelity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the structure ---- */

/* The fewest nodes whose error stays in its share; the error falls with the nodes. */
static int choose_nodes(spari_advisor *d, spari_plan *p, int g, const spari_record *base) {
    int few = spari_rule.least_nodes - 1, enough = p->group[g].nodes;
    while (enough - few > 1) {
        int middle = (few + enough) / 2;
        double part, cost;
        spari_plan q = *p;
        q.group[g].nodes = middle;
        SPARI_TRY(spari_plan_distance(d, &q, base, &part, &cost));
        if (part <= spari_rule.nodes) {
            enough = middle;
        } else {
            few = middle;
        }
    }
    p->group[g].nodes = enough;
    return SPAR_OK;
}

/* Takes the plan if it is within the share, and cheaper than the best so far. taken: it is within. */
static int consider(spari_advisor *d, const spari_plan *p, const spari_record *base, double share, spari_plan *best,
                    double *cost, int *taken) {
    double part, took;
    SPARI_TRY(spari_plan_distance(d, p, base, &part, &took));
    *taken = part <= share;
    if (*taken && took < spari_rule.worth * *cost) {
        *best = *p;
        *cost = took;
    }
    return SPAR_OK;
}

/* What is tried of a beam in place of what it is, in this order. after: an earlier row that must have been taken, -1:
   none is needed. */
static const struct {
    int fidelity, after;
    int64_t modes;
} fidelities[] = {{SPAR_FIDELITY_LINEAR, -1, 0},   {SPAR_FIDELITY_MODAL, 0, 16}, {SPAR_FIDELITY_MODAL, 0, 8},
                  {SPAR_FIDELITY_MODAL, 0, 4},     {SPAR_FIDELITY_MODAL, 0, 2},  {SPAR_FIDELITY_RIGID, -1, 0},
                  {SPAR_FIDELITY_PRESCRIBED, 5, 0}};
enum { FIDELITIES = sizeof fidelities / sizeof *fidelities };

/* Whether the member can be of that fidelity: what needs a root that is given is not for one that is free. */
static int is_possible(const spari_advisor *d, int g, int fidelity) {
    return spari_member_root_is_given(spari_plan_member(d, g)) || !spari_fidelity_row(fidelity)->given_root;
}

static int choose_fidelity(spari_advisor *d, spari_plan *p, int g, const spari_record *base) {
    double cost = spari_plan_cost(d, base);
    spari_plan best = *p, q = *p;
    int taken[FIDELITIES] = {0};
    for (int k = 0; k < FIDELITIES; k++) {
        int after = fidelities[k].after;
        if ((after < 0 || taken[after]) && is_possible(d, g, fidelities[k].fidelity)) {
            q.group[g].fidelity = fidelities[k].fidelity;
            q.group[g].modes = fidelities[k].modes;
            SPARI_TRY(consider(d, &q, base, spari_rule.fidelity, &best, &cost, &taken[k]));
        }
    }
    *p = best;
    return SPAR_OK;
}

static int choose_points(spari_advisor *d, spari_plan *p, int g, const spari_record *base) {
    const spari_beam *beam = spari_plan_member(d, g)->beam;
    double part, cost;
    if (spari_beam_rule(beam) != SPAR_QUADRATURE_SECTIONS || beam->points == 1) {
        return SPAR_OK;
    }
    spari_plan q = *p;
    q.group[g].points = 1;
    SPARI_TRY(spari_plan_distance(d, &q, base, &part, &cost));
    if (part <= spari_rule.points) {
        *p = q;
    }
    return SPAR_OK;
}

static int is_elastic(const spari_plan *p, int g) {
    return p->group[g].fidelity >= SPAR_FIDELITY_LINEAR;
}

/* Of what does not bend: the fewest, where the loads find the same line. */
static int choose_stiff_nodes(spari_advisor *d, spari_plan *p, int g, const spari_record *base) {
    double part = INFINITY, cost;
    p->group[g].nodes = spari_plan_member(d, g)->per_element;
    spari_plan q = *p;
    q.group[g].nodes = spari_rule.least_nodes;
    if (!d->session->keep_nodes && q.group[g].nodes < p->group[g].nodes) {
        SPARI_TRY(spari_plan_distance(d, &q, base, &part, &cost));
    }
    *p = part <= spari_rule.fidelity ? q : *p;
    return SPAR_OK;
}

static int choose_shapes(spari_advisor *d, spari_plan *p, const spari_record *base) {
    for (int g = 0; g < d->groups; g++) {
        if (!d->session->keep_fidelity) {
            SPARI_TRY(choose_fidelity(d, p, g, base));
        }
        if (is_elastic(p, g)) {
            SPARI_TRY(choose_points(d, p, g, base));
            SPARI_TRY(d->session->keep_nodes ? SPAR_OK : choose_nodes(d, p, g, base));
        } else {
            SPARI_TRY(choose_stiff_nodes(d, p, g, base));
        }
    }
    return SPAR_OK;
}

/* Whether the fluid that comes along is too heavy for the scheme, as the reference's coupling has found it. */
static int is_too_heavy(const spari_advisor *d, int scheme) {
    return (scheme == SPAR_COUPLING_EXPLICIT || scheme == SPAR_COUPLING_FIXED_POINT) &&
           d->reference.report[SPAR_REPORT_ADDED_MASS] > spari_rule.heavy;
}

/* A run that shapes are measured against: the reference's, with a coarser dt, Newton and coupling: explicit, if that
   does not lead far away. */
static int run_base(spari_advisor *d, spari_plan *p, spari_record *base) {
    const spari_level *rough = spari_plan_rough(d);
    double away = INFINITY;
    *p = rough->plan;
    p->newton = fmax(p->newton, spari_rule.rough_newton * d->tolerance);
    if (!d->session->keep_coupling && !is_too_heavy(d, SPAR_COUPLING_EXPLICIT)) {
        spari_plan q = *p;
        q.scheme = SPAR_COUPLING_EXPLICIT;
        SPARI_TRY(spari_plan_compare(d, &q, &rough->record, base, &away));
        if (away <= spari_rule.rough) {
            *p = q;
            return SPAR_OK;
        }
        spari_record_free(base);
    }
    p->rtol = d->session->keep_coupling ? p->rtol : fmax(p->rtol, spari_rule.rough_rtol * d->tolerance);
    return spari_plan_run(d, p, 1, base);
}

/* Each choice is measured against it. */
static SPARI_APART int choose_structure(spari_advisor *d, spari_plan *chosen) {
    spari_plan p;
    spari_record base = {0};
    int status = run_base(d, &p, &base);
    status = status == SPAR_OK ? choose_shapes(d, &p, &base) : status;
    spari_record_free(&base);
    *chosen = p;
    return spari_plan_fails(status) ? SPAR_OK : status;
}

/* ---- dt and coupling ---- */

/* The coarsest steps that keep the tolerance, from grid place j on; *best improves if that is cheaper. */
static int coarsest_steps(spari_advisor *d, spari_plan p, int j, spari_outcome *best) {
    const int finest = 2 * SPARI_FINEST, coarsest = (int)floor(2 * log2((double)SPARI_MULTIPLE / (double)d->run.steps));
    int good = finest + 1, bad = coarsest - 1, at = j, failed = 0; /* twice: finer steps will not help */
    while (good - bad > 1 && d->known_count < spari_rule.tried && failed < 2) {
        spari_outcome o;
        p.steps = spari_plan_steps(d, at);
        SPARI_TRY(spari_plan_measure(d, &p, &o));
        double ratio = isfinite(o.error) ? o.error / d->tolerance : 4;
        int is_good = spari_plan_is_good(d, &o);
        failed += !isfinite(o.error);
        if (is_good) {
            good = at;
            *best = o.cost < spari_rule.worth * best->cost ? o : *best;
            if (ratio > 0.5 * spari_rule.good) {
                return SPAR_OK; /* the next place has twice the error */
            }
        } else {
            bad = at;
            if (o.cost > best->cost && isfinite(o.cost)) {
                return SPAR_OK; /* finer steps cost more still */
            }
        }
        /* with an error of order 2 in dt the next place is near; then halve the gap */
        int leap = (int)lround(log2(fmax(ratio, 1e-2)));
        leap = is_good ? (leap < -1 ? leap : -1) : (leap > 1 ? leap : 1);
        at += leap;
        if (at >= good || at <= bad) {
            at = (good + bad) / 2;
            at = at >= good ? good - 1 : at <= bad ? bad + 1 : at;
        }
    }
    return SPAR_OK;
}

/* Whether a scheme that iterates can be cheaper: it has two solutions in a step at least, and not fewer steps than a
   tight coupling needs. */
static int may_iterate(const spari_advisor *d, const spari_outcome *best) {
    const double saved = 1.6;
    return !isfinite(best->cost) || best->plan.scheme != SPAR_COUPLING_EXPLICIT ||
           (double)best->plan.steps > saved * (double)spari_plan_least_steps(d);
}

static int choose_time(spari_advisor *d, const spari_plan *structure, spari_outcome *best) {
    static const struct {
        int scheme, predictor;
        double rtol;
    } coupling[] = {{SPAR_COUPLING_EXPLICIT, 1, 0},       {SPAR_COUPLING_EXPLICIT, 2, 0},
                    {SPAR_COUPLING_FIXED_POINT, 1, 1e-2}, {SPAR_COUPLING_IQN_ILS, 1, 1e-2},
                    {SPAR_COUPLING_IQN_ILS, 2, 1e-2},     {SPAR_COUPLING_IQN_ILS, 1, 1e-3}};
    enum { SCHEMES = sizeof coupling / sizeof *coupling, LOOSE = SCHEMES - 1 };
    const spar_session *s = d->session;
    int kept = s->keep_coupling;
    for (size_t k = 0; k < (kept ? 2 : SCHEMES); k++) {
        spari_plan p = *structure;
        p.scheme = kept ? s->scheme : coupling[k].scheme;
        p.rtol = kept || coupling[k].rtol <= 0 ? s->coupling_rtol : coupling[k].rtol;
        p.predictor = coupling[k].predictor;
        if (!kept && is_too_heavy(d, p.scheme)) {
            continue;
        }
        if (p.scheme != SPAR_COUPLING_EXPLICIT && !kept &&
            (!may_iterate(d, best) || (k == LOOSE && isfinite(best->cost)))) {
            continue;
        }
        if (s->keep_dt) {
            spari_outcome o;
            p.steps = d->run.steps;
            SPARI_TRY(spari_plan_measure(d, &p, &o));
            *best = spari_plan_is_good(d, &o) && o.cost < best->cost ? o : *best;
        } else {
            int64_t from = isfinite(best->cost) && p.scheme == SPAR_COUPLING_EXPLICIT ? best->plan.steps
                                                                                      : spari_plan_least_steps(d);
            SPARI_TRY(coarsest_steps(d, p, spari_plan_grid(d, from), best));
        }
    }
    return SPAR_OK;
}

/* ---- moves ---- */

/* Changes one thing of the plan; 0: there is no such change. */
typedef int (*move)(const spari_advisor *d, spari_plan *p, int g);

static int coarser(const spari_advisor *d, spari_plan *p, int g) {
    (void)g;
    int64_t steps = spari_plan_steps(d, spari_plan_grid(d, p->steps) - 1);
    int moved = !d->session->keep_dt && steps < p->steps;
    p->steps = moved ? steps : p->steps;
    return moved;
}

static int finer(const spari_advisor *d, spari_plan *p, int g) {
    (void)g;
    p->steps = spari_plan_steps(d, spari_plan_grid(d, p->steps) + 1);
    return !d->session->keep_dt;
}

static int fewer_nodes(const spari_advisor *d, spari_plan *p, int g) {
    return !d->session->keep_nodes && p->group[g].nodes-- > spari_rule.least_nodes;
}

static int more_nodes(const spari_advisor *d, spari_plan *p, int g) {
    return !d->session->keep_nodes && is_elastic(p, g) && p->group[g].nodes++ < SPARI_MAX_NODES;
}

static int fewer_points(const spari_advisor *d, spari_plan *p, int g) {
    int moved = is_elastic(p, g) && p->group[g].points == 0 &&
                spari_beam_rule(spari_plan_member(d, g)->beam) == SPAR_QUADRATURE_SECTIONS;
    p->group[g].points = moved ? 1 : p->group[g].points;
    return moved;
}

static int lower_fidelity(const spari_advisor *d, spari_plan *p, int g) {
    spari_shape *b = &p->group[g];
    if (d->session->keep_fidelity) {
        return 0;
    }
    if (b->modes > 1) {
        b->modes /= 2;
        return 1;
    }
    int lower = spari_fidelity_row(b->fidelity)->lower;
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

/* Whether asking on can pay: what it has cost is less than a part of what it has saved. */
static int pays(const spari_advisor *d, const spari_outcome *best) {
    double runs = fmax(d->longer, spari_rule.least_runs), now = d->now > 0 ? d->now : best->cost;
    return d->known_count < spari_rule.tried && d->spent + best->cost < d->limit * now &&
           d->spent + best->cost <= spari_rule.worth_asking * runs * (now - best->cost);
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
            SPARI_TRY(spari_plan_measure(d, &p, &o));
            if (spari_plan_is_good(d, &o) && o.cost < spari_rule.worth * best->cost) {
                *best = o;
                idle = 0;
            }
        }
    }
    return SPAR_OK;
}

/* ---- the answer ---- */

/* Whether a is bound to be unstable where b is: the same in time, with no finer steps and no tighter coupling. */
static int is_no_stabler(const spari_plan *a, const spari_plan *b) {
    return a->scheme == b->scheme && a->predictor == b->predictor && a->substeps == b->substeps &&
           a->steps <= b->steps && (a->scheme == SPAR_COUPLING_EXPLICIT || a->rtol >= b->rtol);
}

/* The cheapest of all settings that keep the tolerance and stay stable. */
static int find_stable(spari_advisor *d, spari_outcome *best) {
    int stays = 0;
    for (int k = 0; k < spari_rule.doubted && isfinite(best->cost); k++) {
        SPARI_TRY(spari_plan_stays(d, &best->plan, &stays));
        if (stays) {
            return SPAR_OK;
        }
        spari_outcome next = {.error = INFINITY, .cost = INFINITY};
        for (int i = 0; i < d->known_count; i++) {
            spari_outcome *o = &d->known[i];
            if (is_no_stabler(&o->plan, &best->plan)) {
                o->error = INFINITY;
            } else if (spari_plan_is_good(d, o) && o->cost < next.cost) {
                next = *o;
            }
        }
        *best = next;
    }
    return spari_fail(d->session, SPAR_ERR_NUMERIC,
                      "%s: settings that keep the tolerance over the trials drift away after them; ask with more steps "
                      "or a larger tolerance",
                      SPARI_ADVISE);
}

/* The session as it is, measured when there is something to measure it against. */
static int judge_present(spari_advisor *d, const spari_plan *present, const spari_record *run, spari_outcome *now) {
    *now = (spari_outcome){*present, INFINITY, INFINITY};
    return run->value ? spari_plan_judge(d, run, now) : SPAR_OK;
}

/* Coupling and dt, with a Newton that is looser first. Where the shares of the structure left nothing the reference's
   settings are tried as they are. */
static int choose_rest(spari_advisor *d, spari_plan structure, const spari_plan *finest, spari_outcome *best) {
    static const double newton[] = {1e-3, 1e-6};
    for (size_t k = 0; k < sizeof newton / sizeof *newton && !isfinite(best->cost); k++) {
        structure.newton = newton[k];
        SPARI_TRY(choose_time(d, &structure, best));
    }
    return isfinite(best->cost) ? SPAR_OK : choose_time(d, finest, best);
}

static SPARI_APART int search_plans(spari_advisor *d, const spari_plan *present, spari_outcome *now,
                                    spari_outcome *best) {
    spari_plan finest, structure;
    spari_record run = {0};
    int status = spari_plan_try_present(d, present, &run);
    status = status == SPAR_OK ? spari_plan_reference(d, present, &finest) : status;
    status = status == SPAR_OK ? judge_present(d, present, &run, now) : status;
    spari_record_free(&run);
    SPARI_TRY(status);
    spari_plan_begin(d, SPARI_STAGE_SHAPES);
    SPARI_TRY(choose_structure(d, &structure));
    spari_plan_begin(d, SPARI_STAGE_TIME);
    SPARI_TRY(choose_rest(d, structure, &finest, best));
    if (spari_plan_is_good(d, now) && now->cost < best->cost) {
        *best = *now;
    }
    if (isfinite(best->cost)) {
        spari_plan_begin(d, SPARI_STAGE_MOVES);
        SPARI_TRY(improve(d, best));
        spari_plan_begin(d, SPARI_STAGE_LOOKS);
        return find_stable(d, best);
    }
    double least = INFINITY;
    for (int k = 0; k < d->known_count; k++) {
        least = fmin(least, d->known[k].error);
    }
    return spari_fail(d->session, SPAR_ERR_NUMERIC,
                      "%s: of %d trials none keeps the tolerance %g; the least error is %.3g; give a larger tolerance, "
                      "or begin with a smaller dt",
                      SPARI_ADVISE, d->trials, d->tolerance, least);
}

/* Memory for the advice, before the work begins: for members that have none yet [members], else NULL. */
static int make_remakes(const spari_advisor *d, spari_remake ***room) {
    spari_own *own = d->session->own;
    own->advised = own->advised ? own->advised : spari_zalloc(1, sizeof *own->advised);
    spari_remake **all = *room = spari_zalloc(d->session->member_count, sizeof(spari_remake *));
    int k = 0, ok = all && own->advised;
    for (const spar_member *m = d->session->members; m && ok; m = m->next, k++) {
        ok = m->advice || (all[k] = spari_zalloc(1, sizeof *all[k]));
    }
    return ok ? SPAR_OK : spari_fail(d->session, SPAR_ERR_MEMORY, "%s: no memory", SPARI_ADVISE);
}

static void free_room(const spari_advisor *d, spari_remake **room) {
    for (int k = 0; room && k < d->session->member_count; k++) {
        free(room[k]);
    }
    free(room);
}

static void hand_over(spari_advisor *d, const spari_outcome *now, const spari_outcome *best, spari_remake **room,
                      double *advice) {
    const spari_plan *p = &best->plan;
    int k = 0;
    for (spar_member *m = d->session->members; m; m = m->next, k++) {
        m->advice = m->advice ? m->advice : room[k];
        room[k] = room[k] == m->advice ? NULL : room[k];
        *m->advice = spari_remake_of(m);
        if (d->group[k] >= 0) {
            const spari_shape *b = &p->group[d->group[k]];
            *m->advice = (spari_remake){b->nodes, b->fidelity, b->modes, b->points, 0};
        }
    }
    const double made[SPAR_ADVICE_COUNT] = {
        [SPAR_ADVICE_DT] = d->run.dt * (double)d->run.steps / (double)p->steps,
        [SPAR_ADVICE_SUBSTEPS] = p->substeps,
        [SPAR_ADVICE_SCHEME] = p->scheme,
        [SPAR_ADVICE_COUPLING_RTOL] = p->rtol,
        [SPAR_ADVICE_PREDICTOR] = p->predictor,
        [SPAR_ADVICE_NEWTON_RTOL] = p->newton,
        [SPAR_ADVICE_ERROR] = best->error,
        [SPAR_ADVICE_COST] = isfinite(now->cost) && now->cost > 0 ? best->cost / now->cost : -1,
        [SPAR_ADVICE_PRESENT_ERROR] = isfinite(now->error) ? now->error : -1,
        [SPAR_ADVICE_TRIALS] = d->trials,
        [SPAR_ADVICE_WORK] = d->now > 0 ? d->spent / d->now : -1,
    };
    memcpy(advice, made, sizeof made);
    spari_advised *advised = d->session->own->advised;
    *advised = (spari_advised){.dt = made[SPAR_ADVICE_DT], .given = 1, .of = spari_advised_of(d->session)};
    (void)spari_settings_varied(d->session, advised->setting);
    spari_plan_settings(p, advised->setting);
}

static int check_request(spar_session *s, double tolerance, const spari_run *run, int64_t capacity) {
    const double most = 1e300;
    SPARI_TRY(spari_trial_check(s, SPARI_ADVISE, run));
    SPARI_REQUIRE(s, tolerance > 0 && tolerance < 1, SPAR_ERR_ARGUMENT, "%s: the tolerance is %g; give one in (0, 1)",
                  SPARI_ADVISE, tolerance);
    SPARI_REQUIRE(s, run->length > 0 && run->length <= most, SPAR_ERR_ARGUMENT,
                  "%s: the length is %g; say how many seconds the run will last that the advice is for", SPARI_ADVISE,
                  run->length);
    SPARI_TRY(spari_need_capacity(s, SPARI_ADVISE, capacity));
    SPARI_REQUIRE(s, run->solve, SPAR_ERR_UNSUPPORTED,
                  "%s: without a fluid solver there are no trials; give the one that spar_step is given", SPARI_ADVISE);
    return SPAR_OK;
}

int spar_session_advise(spar_session *session, double tolerance, double dt, int64_t steps, double length,
                        spar_before_step before, spar_fluid_solver solve, void *context, int64_t capacity,
                        double *advice) {
    SPARI_QUIET;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", SPARI_ADVISE);
    spar_session *s = session;
    spari_advisor d = {
        .session = s,
        .run = {.dt = dt, .length = length, .steps = steps, .before = before, .solve = solve, .context = context},
        .tolerance = tolerance,
        .limit = INFINITY,
        .progress = spari_progress_of(s, SPARI_ADVISE)};
    d.run.progress = &d.progress;
    spari_outcome now = {0}, best = {.cost = INFINITY, .error = INFINITY};
    SPARI_TRY(spari_trial_enter(s, SPARI_ADVISE, &d.run, tolerance, 0, check_request(s, tolerance, &d.run, capacity)));
    char message[SPARI_MESSAGE_SIZE];
    memcpy(message, s->message, sizeof message);
    spari_remake **room = NULL;
    d.goals = d.run.goals = s->goals;
    d.limit = s->advise_limit > 0 ? s->advise_limit : INFINITY;
    d.longer = fmax(1, length / (dt * (double)steps));
    int status = spari_plan_groups(&d);
    status = status == SPAR_OK ? make_remakes(&d, &room) : status;
    status = spari_comm_agree(s->comm, status, s->message, sizeof s->message);
    if (status == SPAR_OK) {
        spari_plan present = spari_plan_present(&d);
        status = spari_progress_ends(&d.progress, search_plans(&d, &present, &now, &best));
    }
    if (status == SPAR_OK) {
        memcpy(s->message, message, sizeof message); /* what failed in a trial is no failure of the session's */
        double made[SPAR_ADVICE_COUNT];
        hand_over(&d, &now, &best, room, made);
        spari_fill(capacity, advice, SPAR_ADVICE_COUNT, made);
    }
    free_room(&d, room);
    free(d.group);
    free(d.known);
    spari_plan_forget(&d);
    free(d.level);
    return spari_named(s, SPARI_ADVISE, status);
}

int spar_member_get_advice(const spar_member *member, int *fidelity, int64_t *modes, int *nodes_per_element,
                           int *points) {
    SPARI_REQUIRE(NULL, member, SPAR_ERR_ARGUMENT, "%s: the member is NULL; create it first", __func__);
    SPARI_REQUIRE(member->session, member->advice, SPAR_ERR_STATE,
                  "%s: '%s' has no advice yet; call spar_session_advise first", __func__, member->name);
    const spari_remake *a = member->advice;
    if (fidelity) {
        *fidelity = a->fidelity;
    }
    if (modes) {
        *modes = a->modes;
    }
    if (nodes_per_element) {
        *nodes_per_element = a->per_element;
    }
    if (points) {
        *points = a->points;
    }
    return SPAR_OK;
}
