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

/* Takes the plan if it is within the share and cheaper than the best so far. */
static int consider(spari_advisor *d, const spari_plan *p, const spari_record *base, double share, spari_plan *best,
                    double *cost, int *taken) {
    double part, took;
    SPARI_TRY(spari_plan_distance(d, p, base, &part, &took));
    *taken = part <= share && took < spari_rule.worth * *cost;
    if (*taken) {
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

static int choose_newton(spari_advisor *d, spari_plan *p, const spari_record *base) {
    static const double tolerance[] = {1e-3, 1e-6, 1e-9};
    for (size_t k = 0; k < sizeof tolerance / sizeof *tolerance; k++) {
        double part, cost;
        spari_plan q = *p;
        q.newton = tolerance[k];
        SPARI_TRY(spari_plan_distance(d, &q, base, &part, &cost));
        if (part <= spari_rule.newton) {
            *p = q;
            return SPAR_OK;
        }
    }
    return SPAR_OK;
}

static int is_elastic(const spari_plan *p, int g) {
    return p->group[g].fidelity >= SPAR_FIDELITY_LINEAR;
}

/* Each choice is measured against the run before it, all with the host's dt and the reference's coupling. */
static int choose_structure(spari_advisor *d, const spari_plan *finest, spari_plan *chosen) {
    const spar_session *s = d->session;
    spari_plan p = *finest;
    spari_record base;
    p.steps = d->run.steps;
    p.rtol = fmax(p.rtol, 1e-2 * d->tolerance);
    int status = spari_plan_run(d, &p, 1, &base);
    while (spari_plan_fails(status) && p.steps < finest->steps) {
        spari_record_free(&base);
        p.steps *= 2;
        status = spari_plan_run(d, &p, 1, &base);
    }
    for (int g = 0; g < d->groups && status == SPAR_OK; g++) {
        status = s->keep_fidelity ? SPAR_OK : choose_fidelity(d, &p, g, &base);
        if (status == SPAR_OK && is_elastic(&p, g)) {
            status = choose_points(d, &p, g, &base);
            status = status == SPAR_OK && !s->keep_nodes ? choose_nodes(d, &p, g, &base) : status;
        } else if (status == SPAR_OK) {
            p.group[g].nodes = spari_plan_member(d, g)->per_element;
        }
    }
    if (status == SPAR_OK) { /* Newton's tolerance by itself, against the same shapes */
        spari_record_free(&base);
        status = spari_plan_run(d, &p, 1, &base);
        status = status == SPAR_OK ? choose_newton(d, &p, &base) : status;
    }
    spari_record_free(&base);
    *chosen = p;
    return spari_plan_fails(status) ? SPAR_OK : status;
}

/* ---- dt and coupling ---- */

/* The coarsest steps that keep the tolerance, from grid place j on; *best improves if that is cheaper. */
static int coarsest_steps(spari_advisor *d, spari_plan p, int *j, spari_outcome *best) {
    const int finest = 2 * SPARI_FINEST, coarsest = (int)floor(2 * log2((double)SPARI_SAMPLES / (double)d->run.steps));
    int good = finest + 1, bad = coarsest - 1, at = *j;
    while (good - bad > 1 && d->known_count < spari_rule.tried) {
        spari_outcome o;
        p.steps = spari_plan_steps(d, at);
        SPARI_TRY(spari_plan_measure(d, &p, &o));
        double ratio = isfinite(o.error) ? o.error / d->tolerance : 100;
        if (spari_plan_is_good(d, &o)) {
            good = at;
            if (o.cost < spari_rule.worth * best->cost) {
                *best = o;
                *j = at;
            }
        } else {
            bad = at;
            if (o.cost > best->cost && isfinite(o.cost)) {
                return SPAR_OK; /* finer steps cost more still */
            }
        }
        /* with an error of order 2 in dt the next place is near; then halve the gap */
        int leap = (int)lround(log2(fmax(ratio, 1e-3)));
        leap = leap > 0 ? leap : leap < 0 ? leap : spari_plan_is_good(d, &o) ? -1 : 1;
        at += leap;
        if (at >= good || at <= bad) {
            at = (good + bad) / 2;
            at = at >= good ? good - 1 : at <= bad ? bad + 1 : at;
        }
    }
    return SPAR_OK;
}

static int choose_time(spari_advisor *d, const spari_plan *structure, spari_outcome *best) {
    static const struct {
        int scheme, predictor;
        double rtol;
    } coupling[] = {{SPAR_COUPLING_EXPLICIT, 1, 0},       {SPAR_COUPLING_EXPLICIT, 2, 0},
                    {SPAR_COUPLING_FIXED_POINT, 1, 1e-2}, {SPAR_COUPLING_FIXED_POINT, 2, 1e-2},
                    {SPAR_COUPLING_IQN_ILS, 1, 1e-2},     {SPAR_COUPLING_IQN_ILS, 2, 1e-2},
                    {SPAR_COUPLING_IQN_ILS, 1, 1e-3},     {SPAR_COUPLING_IQN_ILS, 1, 1e-5}};
    const spar_session *s = d->session;
    int j = 0, kept = s->keep_coupling;
    for (size_t k = 0; k < (kept ? 2 : sizeof coupling / sizeof *coupling); k++) {
        spari_plan p = *structure;
        p.scheme = kept ? s->scheme : coupling[k].scheme;
        p.rtol = kept || coupling[k].rtol <= 0 ? s->coupling_rtol : coupling[k].rtol;
        p.predictor = coupling[k].predictor;
        if (s->keep_dt) {
            spari_outcome o;
            p.steps = d->run.steps;
            SPARI_TRY(spari_plan_measure(d, &p, &o));
            *best = spari_plan_is_good(d, &o) && o.cost < best->cost ? o : *best;
        } else {
            SPARI_TRY(coarsest_steps(d, p, &j, best));
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

/* Moves as long as one pays and keeps the tolerance. */
static int improve(spari_advisor *d, spari_outcome *best) {
    int rounds = d->groups > 0 ? d->groups : 1, moved = 1;
    while (moved && d->known_count < spari_rule.tried) {
        moved = 0;
        for (size_t k = 0; k < sizeof moves / sizeof *moves && d->known_count < spari_rule.tried; k++) {
            for (int g = 0; g < rounds; g++) {
                spari_plan p = best->plan;
                spari_outcome o;
                if (!moves[k].first(d, &p, g) || (moves[k].second && !moves[k].second(d, &p, g))) {
                    continue;
                }
                SPARI_TRY(spari_plan_measure(d, &p, &o));
                if (spari_plan_is_good(d, &o) && o.cost < spari_rule.worth * best->cost) {
                    *best = o;
                    moved = 1;
                }
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

/* The finest settings known not to fail, where the shares left nothing: they are tried as they are. */
static int search_plans(spari_advisor *d, const spari_plan *present, spari_outcome *now, spari_outcome *best) {
    spari_plan finest, structure;
    SPARI_TRY(spari_plan_reference(d, present, &finest));
    SPARI_TRY(spari_plan_measure(d, present, now));
    SPARI_TRY(choose_structure(d, &finest, &structure));
    SPARI_TRY(choose_time(d, &structure, best));
    if (!isfinite(best->cost)) {
        SPARI_TRY(choose_time(d, &finest, best));
    }
    if (spari_plan_is_good(d, now) && now->cost < best->cost) {
        *best = *now;
    }
    if (isfinite(best->cost)) {
        SPARI_TRY(improve(d, best));
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
    };
    memcpy(advice, made, sizeof made);
    spari_advised *advised = d->session->own->advised;
    *advised = (spari_advised){.dt = made[SPAR_ADVICE_DT], .given = 1, .of = spari_advised_of(d->session)};
    (void)spari_settings_varied(d->session, advised->setting);
    spari_plan_settings(p, advised->setting);
}

static int check_request(spar_session *s, double tolerance, const spari_run *run, int64_t capacity) {
    SPARI_TRY(spari_trial_check(s, SPARI_ADVISE, run));
    SPARI_REQUIRE(s, tolerance > 0 && tolerance < 1, SPAR_ERR_ARGUMENT, "%s: the tolerance is %g; give one in (0, 1)",
                  SPARI_ADVISE, tolerance);
    SPARI_TRY(spari_need_capacity(s, SPARI_ADVISE, capacity));
    SPARI_REQUIRE(s, run->solve, SPAR_ERR_UNSUPPORTED,
                  "%s: without a fluid solver there are no trials; give the one that spar_step is given", SPARI_ADVISE);
    return SPAR_OK;
}

int spar_session_advise(spar_session *session, double tolerance, double dt, int64_t steps, spar_before_step before,
                        spar_fluid_solver solve, void *context, int64_t capacity, double *advice) {
    SPARI_QUIET;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", SPARI_ADVISE);
    spar_session *s = session;
    spari_advisor d = {.session = s,
                       .run = {.dt = dt, .steps = steps, .before = before, .solve = solve, .context = context},
                       .tolerance = tolerance};
    spari_outcome now = {0}, best = {.cost = INFINITY, .error = INFINITY};
    SPARI_TRY(spari_trial_enter(s, SPARI_ADVISE, &d.run, tolerance, 0, check_request(s, tolerance, &d.run, capacity)));
    char message[SPARI_MESSAGE_SIZE];
    memcpy(message, s->message, sizeof message);
    spari_remake **room = NULL;
    int status = spari_plan_groups(&d);
    status = status == SPAR_OK ? make_remakes(&d, &room) : status;
    status = spari_comm_agree(s->comm, status, s->message, sizeof s->message);
    if (status == SPAR_OK) {
        spari_plan present = spari_plan_present(&d);
        status = search_plans(&d, &present, &now, &best);
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
    spari_record_free(&d.reference);
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
