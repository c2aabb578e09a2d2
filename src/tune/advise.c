/* Finds settings for a tolerance: estimates from one trial propose them, a few trials confirm them.
   docs/explanation/advice.md describes the algorithm. */
#include "../base/environment.h"
#include "../coupling/schemes.h"
#include "../math/basis.h"
#include "apply.h"
#include "node_error.h"
#include "plan.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FINEST = 64, COARSEST = 4, RESOLVES = 10, LEAST_STEPS = 16 };

/* Shares of the tolerance. */
static const double foreseen = 2.5; /* a longer run, in trials, must be represented by them */
static const double good = 0.9, aim = 0.6, of_reference = 0.25;

/* Whether a has the scheme of b, and no more nodes. */
static int of_same_kind(const spari_plan *a, const spari_plan *b) {
    return a->scheme == b->scheme && a->more <= b->more;
}

static int of_one_kind(const spari_plan *a, const spari_plan *b) {
    return of_same_kind(a, b) && of_same_kind(b, a);
}

static int plan_is_explicit(const spari_plan *p) {
    return !spari_coupling_scheme_of(p->scheme)->iterates;
}

/* Whether the iterations of the first trial have shown so much added mass that the session's own way of solving a step
   is only tightened, never loosened. */
static int is_heavy(const spari_advisor *d) {
    return d->mass > 0.3;
}

static int keeps_coupling(const spari_advisor *d) {
    return d->search->keep_coupling || d->own_coupling;
}

/* ---- estimate ---- */

/* Sums the estimated errors of the steps, and keeps the largest of the nodes at four times. */
typedef struct observer {
    int64_t steps, done;
    double step, late, nodes; /* late: of the last third */
} observer;

static int observe(spar_session *s, void *context) {
    observer *o = context;
    double sum = 0, nodes = 0;
    int64_t i = ++o->done;
    int count = 0, looks = i * 4 / o->steps != (i - 1) * 4 / o->steps;
    for (spar_member *m = s->members; m; m = m->next, count++) {
        double error = 0;
        sum += m->accuracy.step_error * m->accuracy.step_error;
        if (looks && spari_nodes_error_applies(m) && m->fidelity == SPAR_FIDELITY_EXACT &&
            m->mesh.per_element < SPARI_MAX_NODES) {
            SPARI_TRY(spari_nodes_error(m, &error));
            nodes += error > 0 ? error * error : 0;
        }
    }
    o->step += sqrt(sum / count);
    o->late += 3 * i > 2 * o->steps ? sqrt(sum / count) : 0;
    o->nodes = fmax(o->nodes, sqrt(nodes / count));
    return SPAR_OK;
}

/* The session as it is; if that fails, with smaller steps. */
static int try_session_as_it_is(spari_advisor *d) {
    enum { HALVINGS = 3 };
    spari_plan p = d->present;
    observer o;
    int i = -1;
    for (int k = 0; k <= HALVINGS; k++, p.steps *= 2) {
        o = (observer){.steps = p.steps};
        d->run.watch = observe, d->run.watcher = &o;
        SPARI_TRY(spari_plan_try(d, &p, &i));
        d->run.watch = NULL;
        if (i < 0 || d->tried[i].record.value) {
            break;
        }
    }
    SPARI_REQUIRE(d->session, i >= 0 && d->tried[i].record.value, SPAR_ERR_NUMERIC,
                  "%s: neither the session as it is nor one with dt/8 completes: %.400s", SPARI_ADVISE,
                  d->session->message);
    const spari_record *r = &d->tried[i].record;
    double found[5] = {0, 0, 0, 0, 0}, reach = spari_record_reach(r);
    if (spari_comm_rank(d->session->ranks.comm) == 0 && reach > 0) {
        found[0] = o.step / reach, found[1] = o.nodes / reach;
        found[2] = 3 * o.late / reach, found[3] = r->report[SPAR_REPORT_ADDED_MASS];
    }
    SPARI_TRY(spari_sum(d->session, found, 4));
    d->step_error = found[0], d->node_error = found[1], d->drift = found[2], d->mass = found[3];
    d->estimated = p.steps;
    d->chain[d->links++] = i;
    d->tried[i].tight = 1;
    char text[SPARI_MESSAGE_SIZE];
    (void)snprintf(text, sizeof text, "%s: estimates: steps %.3g, nodes %.3g, drift %.3g", SPARI_ADVISE, found[0],
                   found[1], found[2]);
    spari_log(d->session, SPAR_LOG_INFO, text);
    return SPAR_OK;
}

/* ---- reference ---- */

/* Coupling and Newton so tight that only dt and nodes count. The tolerance falls with dt^2: else the predictor alone
   meets it, and its lag hides what a smaller dt changes. */
static double tight_rtol(const spari_advisor *d, int64_t steps) {
    double part = fmin(1, (double)d->present.steps / (double)steps),
           rtol = fmax(0.04 * d->tolerance * part * part, 1e-10);
    return is_heavy(d) ? fmin(rtol, d->present.rtol) : rtol;
}

static spari_plan tight(const spari_advisor *d, int64_t steps) {
    spari_plan p = d->present;
    p.steps = steps;
    if (!keeps_coupling(d)) {
        p.scheme = SPAR_COUPLING_IQN_ILS;
        p.rtol = tight_rtol(d, steps);
    }
    if (!is_heavy(d)) {
        p.newton = fmin(p.newton, fmin(fmax(1e-3 * d->tolerance, 1e-12), keeps_coupling(d) ? 1 : p.rtol));
        p.predictor = keeps_coupling(d) ? p.predictor : 2;
    }
    p.more = d->search->keep_nodes ? 0 : d->node_error > 0.3 * d->tolerance ? 4 : 2;
    return p;
}

/* Error of the last link, from how the differences fall. */
static int judge_reference(spari_advisor *d) {
    const int *c = d->chain + d->links;
    double last, before = 0, by = (double)d->tried[c[-1]].plan.steps / (double)d->tried[c[-2]].plan.steps;
    SPARI_TRY(spari_plan_distance(d, c[-2], c[-1], &last));
    d->order = 1;
    if (d->links > 2) {
        double by_before = (double)d->tried[c[-2]].plan.steps / (double)d->tried[c[-3]].plan.steps;
        SPARI_TRY(spari_plan_distance(d, c[-3], c[-2], &before));
        d->order = before > 0 && last > 0 ? log(before / last) / log(by_before) : 2;
    }
    d->order = fmax(0.5, fmin(d->order, 2));
    d->reference = c[-1];
    d->reference_error = by > 1 ? last / (pow(by, d->order) - 1) : 0.25 * last; /* the same dt: of nodes */
    return SPAR_OK;
}

/* Makes a trial of the chain. Where the fluid does not allow the tight coupling, the session's own is kept. */
static int try_link(spari_advisor *d, int64_t steps, int *made) {
    int i;
    spari_plan p = tight(d, steps);
    SPARI_TRY(spari_plan_try(d, &p, &i));
    if (i >= 0 && !d->tried[i].record.value && !d->own_coupling) {
        d->own_coupling = 1;
        p = tight(d, steps);
        SPARI_TRY(spari_plan_try(d, &p, &i));
    }
    *made = i >= 0 && d->tried[i].record.value;
    if (*made) {
        d->tried[i].tight = 1;
        d->chain[d->links++] = i;
    }
    return SPAR_OK;
}

static int find_reference(spari_advisor *d) {
    const int64_t begun = d->tried[d->chain[0]].plan.steps;
    int64_t steps = begun;
    double doubt = d->step_error / sqrt(3) / (aim * d->tolerance);
    int times = 1;
    while (times < 4 && doubt > 4 && !d->search->keep_dt) {
        times *= 2, doubt /= 4;
    }
    int made;
    if (times > 1) {
        steps *= times;
        SPARI_TRY(try_link(d, steps, &made));
    }
    int by = d->search->keep_dt ? 1 : 2;
    while (steps < FINEST * begun && d->count < d->most) {
        steps *= by;
        SPARI_TRY(try_link(d, steps, &made));
        if (!made || d->links < 2) {
            continue;
        }
        SPARI_TRY(judge_reference(d));
        if (d->reference_error <= of_reference * d->tolerance || d->search->keep_dt) {
            break;
        }
        by = d->reference_error > 16 * of_reference * d->tolerance ? 4 : 2;
    }
    return SPAR_OK;
}

/* ---- errors ---- */

/* Where the differences of a trial do not grow, an error that stays may hide one of phase, which the errors of the
   steps in the last third lead one to expect; as far as the whole difference allows. */
static int add_drift(spari_advisor *d, int i, double *error) {
    const double longer = d->longer, grows = 1.5, by = (double)d->estimated / (double)d->tried[i].plan.steps;
    double seen;
    d->longer = 1;
    int status = spari_plan_distance(d, i, d->reference, &seen);
    d->longer = longer;
    if (status == SPAR_OK && isfinite(*error) && *error < grows * seen) {
        double drift = plan_is_explicit(&d->tried[i].plan) ? seen : fmin(d->drift * by * by / sqrt(3), seen);
        drift *= longer;
        *error = fmax(*error, sqrt(seen * seen + drift * drift));
    }
    return status;
}

/* Error of a trial: its distance from the reference, and no less than finer trials lead one to expect. */
static int judge_trial(spari_advisor *d, int i) {
    spari_tried *t = &d->tried[i];
    double e;
    SPARI_TRY(spari_plan_distance(d, i, d->reference, &e));
    SPARI_TRY(add_drift(d, i, &e));
    t->error = i == d->reference ? d->reference_error : e + d->reference_error;
    if (i == d->reference || !t->record.value) {
        return SPAR_OK;
    }
    for (int k = 0; k < d->count; k++) {
        const spari_tried *o = &d->tried[k];
        if (k != i && o->record.value && o->plan.steps < 2 * d->tried[d->reference].plan.steps &&
            o->plan.steps > t->plan.steps && k != d->reference && (o->tight || of_same_kind(&o->plan, &t->plan))) {
            double own = o->error - d->reference_error,
                   expected = own * pow((double)o->plan.steps / (double)t->plan.steps, d->order);
            t->error = fmax(t->error, expected + d->reference_error);
        }
    }
    return SPAR_OK;
}

static int64_t most_steps_of_dt(const spari_advisor *d) {
    double least = d->shortest > 0 ? ceil(RESOLVES / d->shortest) : 0;
    least = fmax(least, ceil((double)d->present.steps / (is_heavy(d) ? 1 : COARSEST))); /* trials see a part of a run */
    return (int64_t)fmax(least, LEAST_STEPS);
}

static int judge_chain(spari_advisor *d) {
    spar_session *s = d->session;
    const double T = d->run.dt * (double)d->run.steps, swells = 1.3;
    double said[4] = {0};
    for (int k = d->links - 1; k >= 0; k--) {
        SPARI_TRY(judge_trial(d, d->chain[k]));
        spari_plan_tell(d, &d->tried[d->chain[k]]);
    }
    if (spari_comm_rank(s->ranks.comm) == 0) {
        const spari_record *r = &d->tried[d->reference].record;
        said[0] = spari_record_shortest(r, d->tolerance);
        said[1] = d->longer > foreseen ? spari_record_vouches(r) : 1;
        said[2] = spari_record_swells(r);
    }
    SPARI_TRY(spari_sum(s, said, 3));
    d->shortest = said[0];
    int found = d->reference_error <= 0.5 * d->tolerance;
    SPARI_REQUIRE(s, found || d->count < d->most, SPAR_ERR_LIMIT,
                  "%s: %d trials, which the option limit allows, reach an error of %.3g of the reference, but it must "
                  "be below %.3g for the tolerance %g; give a larger limit, a smaller dt, or a larger tolerance",
                  SPARI_ADVISE, d->count, d->reference_error, 0.5 * d->tolerance, d->tolerance);
    SPARI_REQUIRE(
        s, found, SPAR_ERR_NUMERIC,
        "%s: no reference: with dt/%.3g the error of the reference is about %.3g, but must be below %.3g for "
        "the tolerance %g; start with a smaller dt, give a larger tolerance, or check that the fluid solver is "
        "repeatable and smooth",
        SPARI_ADVISE, (double)d->tried[d->reference].plan.steps / (double)d->run.steps, d->reference_error,
        0.5 * d->tolerance, d->tolerance);
    SPARI_REQUIRE(s, said[1] > 0, SPAR_ERR_NUMERIC,
                  "%s: trials of %.4g s do not represent a run of %.4g s: the trials cover neither a steady state nor "
                  "a full period; give more steps, or the length %.4g",
                  SPARI_ADVISE, T, T * d->longer, T);
    if (d->longer > foreseen && said[2] > swells) {
        spari_warn(s,
                   "%s: the motion still grows in the trials of %.4g s (%.3g times from the second third to the "
                   "last): the trials do not show the motion after %.4g s, and only phase errors are extrapolated; "
                   "give more steps if the motion changes later",
                   SPARI_ADVISE, T, said[2], T * d->longer);
    }
    return SPAR_OK;
}

/* ---- candidates ---- */

static int is_good(const spari_advisor *d, int i) {
    return d->tried[i].record.value && d->tried[i].error <= good * d->tolerance;
}

/* Whether loads that alternate with every step grow, and more than in the reference; or errors grow faster than those
   of a phase. */
static int is_unstable(const spari_advisor *d, int i) {
    const spari_record *r = &d->tried[i].record, *b = &d->tried[d->reference].record;
    if (!r->value) {
        return 1;
    }
    double same = fmax(1, b->alternating[1] / fmax(b->alternating[0], DBL_MIN)),
           grows = r->alternating[1] / fmax(r->alternating[0], DBL_MIN) / same, limit = 0.1 * d->tolerance;
    double left = spari_coupling_scheme_of(d->tried[i].plan.scheme)->iterates
                      ? 16 * d->tried[i].plan.rtol * d->tried[i].plan.rtol
                      : 1e-14;
    return grows > 1.7 && r->alternating[1] > left &&
           r->alternating[1] * pow(grows, fmin(2 * (d->longer - 1), 100)) > limit * limit;
}

/* The steps of the next candidate of a kind; 0: none is better. */
static int64_t propose(const spari_advisor *d, const spari_plan *kind) {
    int low = -1, high = -1; /* the coarsest that is good, and the finest that is not */
    for (int k = 0; k < d->count; k++) {
        const spari_tried *t = &d->tried[k];
        if (!of_one_kind(&t->plan, kind) && !t->tight) {
            continue;
        }
        if (is_good(d, k)) {
            low = low < 0 || t->plan.steps < d->tried[low].plan.steps ? k : low;
        } else {
            high = high < 0 || t->plan.steps > d->tried[high].plan.steps ? k : high;
        }
    }
    if (low < 0) {
        return 0;
    }
    double steps = (double)d->tried[low].plan.steps * sqrt(d->tried[low].error / (aim * d->tolerance));
    if (high >= 0) {
        double n = (double)d->tried[high].plan.steps, e = d->tried[high].error,
               wants = isfinite(e) ? n * pow(e / (aim * d->tolerance), 1 / fmax(d->order, 1)) : 2 * n;
        steps = fmax(steps, fmin(fmax(wants, 1.04 * n), 2 * n));
    }
    steps = fmax(steps, (double)most_steps_of_dt(d));
    return (int64_t)ceil(steps);
}

/* Finds the largest dt of a kind, in few trials. */
static int try_kind(spari_advisor *d, spari_plan kind, int trials, int *best) {
    for (int k = 0; k < trials; k++) {
        int64_t steps = d->search->keep_dt ? d->present.steps : propose(d, &kind);
        int i, known = 0;
        for (int j = 0; j < d->count; j++) {
            const spari_tried *t = &d->tried[j];
            double by = (double)t->plan.steps / (double)steps;
            known = known || (of_one_kind(&t->plan, &kind) && by > 0.93 && by < 1.1);
        }
        if (steps <= 0 || known || (*best >= 0 && (double)steps > 0.92 * (double)d->tried[*best].plan.steps && k > 0)) {
            break;
        }
        if (!plan_is_explicit(&kind) && !keeps_coupling(d)) {
            kind.rtol = tight_rtol(d, steps);
        }
        kind.steps = steps;
        SPARI_TRY(spari_plan_try(d, &kind, &i));
        if (i < 0) {
            break;
        }
        SPARI_TRY(judge_trial(d, i));
        d->tried[i].error = plan_is_explicit(&kind) && is_unstable(d, i) ? INFINITY : d->tried[i].error;
        spari_plan_tell(d, &d->tried[i]);
        if (plan_is_explicit(&kind) && d->tried[i].error > 1.5 * d->tolerance) {
            break; /* its lag counts, or it is unstable */
        }
        if (is_good(d, i) && (*best < 0 || d->tried[i].cost < 0.95 * d->tried[*best].cost)) {
            int better = *best < 0 || d->tried[i].plan.scheme == d->tried[*best].plan.scheme;
            *best = i;
            if (better && d->tried[i].error > 0.4 * d->tolerance) {
                break;
            }
        }
    }
    return SPAR_OK;
}

static int choose_time(spari_advisor *d, int *best) {
    if (plan_is_explicit(&d->present)) {
        SPARI_TRY(try_kind(d, d->present, 3, best));
    }
    spari_plan p = tight(d, d->present.steps);
    p.more = d->search->keep_nodes ? 0 : p.more - 2;
    return try_kind(d, p, 4, best);
}

/* Fewer nodes, as far as the error stays. */
static int choose_nodes(spari_advisor *d, int *best) {
    int more = d->node_error > 0.02 * d->tolerance ? -1 : d->node_error > 1e-3 * d->tolerance ? -2 : -3;
    for (int k = 0; k < 2; k++) {
        spari_plan p = d->tried[*best].plan;
        int i;
        p.more += more;
        if (!spari_plan_has_nodes(d, p.more)) {
            break;
        }
        SPARI_TRY(spari_plan_try(d, &p, &i));
        if (i < 0) {
            break;
        }
        SPARI_TRY(judge_trial(d, i));
        spari_plan_tell(d, &d->tried[i]);
        int works = is_good(d, i) && d->tried[i].cost < d->tried[*best].cost;
        *best = works ? i : *best;
        if (!works && more == -1) {
            break;
        }
        more = works ? more : more / 2;
    }
    return SPAR_OK;
}

static int find_settings(spari_advisor *d, int *best) {
    SPARI_TRY(try_session_as_it_is(d));
    SPARI_TRY(find_reference(d));
    SPARI_REQUIRE(d->session, d->links > 1, d->count < d->most ? SPAR_ERR_NUMERIC : SPAR_ERR_LIMIT,
                  "%s: no trial with a smaller dt completes: %.400s", SPARI_ADVISE, d->session->message);
    SPARI_TRY(judge_chain(d));
    const int now = d->chain[0];
    *best = is_good(d, now) ? now : -1;
    SPARI_TRY(choose_time(d, best));
    for (int k = d->links - 1; k > 0; k--) { /* the tight ones keep it as well */
        int i = d->chain[k];
        if (is_good(d, i) && (*best < 0 || d->tried[i].cost < d->tried[*best].cost)) {
            *best = i;
        }
    }
    double least = INFINITY;
    for (int k = 0; k < d->count; k++) {
        least = d->tried[k].record.value ? fmin(least, d->tried[k].error) : least;
    }
    SPARI_REQUIRE(
        d->session, *best >= 0, SPAR_ERR_NUMERIC,
        "%s: the least error of %d trials is %.3g; with its margin it must be below %.3g for the tolerance %g; "
        "give a larger tolerance or limit, a smaller dt, or longer trials",
        SPARI_ADVISE, d->count, least, good * d->tolerance, d->tolerance);
    SPARI_TRY(choose_nodes(d, best));
    if (is_good(d, now) && d->tried[*best].cost > 0.9 * d->tried[now].cost) {
        *best = now;
    }
    return SPAR_OK;
}

static void hand_over(const spari_advisor *d, int best, spari_rebuild *beam, spari_advised *advised) {
    const spari_tried *t = &d->tried[best], *now = &d->tried[0];
    int64_t k = 0;
    for (const spar_member *m = d->session->members; m; m = m->next) {
        beam[k++] = spari_plan_rebuild(m, &t->plan);
    }
    double work = 0;
    for (int i = 0; i < d->count; i++) {
        work += isfinite(d->tried[i].cost) ? d->tried[i].cost : 0;
    }
    const int fails = !now->record.value;
    free(advised->beam);
    *advised = (spari_advised){.given = 1,
                               .of = spari_advised_of(d->session),
                               .dt = d->run.dt * (double)d->run.steps / (double)t->plan.steps,
                               .substeps = d->session->integrator.substeps,
                               .scheme = t->plan.scheme,
                               .coupling_rtol = t->plan.rtol,
                               .predictor = t->plan.predictor,
                               .newton_rtol = t->plan.newton,
                               .members = k,
                               .beam = beam,
                               .error = t->error,
                               .cost = fails ? 0 : t->cost / now->cost,
                               .present_fails = fails,
                               .present_error = fails ? 0 : now->error,
                               .runs = d->count,
                               .work = fails ? 0 : work / now->cost};
    (void)spari_settings_varied(d->session, advised->setting);
    spari_plan_settings(&t->plan, advised->setting);
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
                       .search = &t->search,
                       .tolerance = tolerance,
                       .longer = fmax(1, length / (t->dt * (double)t->steps)),
                       .most = t->search.limit,
                       .present = spari_plan_present(s, t->steps),
                       .progress = spari_trial_progress(t, SPARI_ADVISE)};
    int best = -1;
    d.run = spari_trial_run_of(t, &d.progress);
    d.run.goals = t->search.goals;
    spari_rebuild *beam = spari_zalloc(s->member_count, sizeof *beam);
    d.tried = spari_zalloc(d.most, sizeof *d.tried);
    int status = beam && d.tried ? SPAR_OK : spari_fail(s, SPAR_ERR_MEMORY, "%s: no memory", SPARI_ADVISE);
    status = spari_agree(s, status);
    status = status == SPAR_OK ? spari_progress_ends(&d.progress, find_settings(&d, &best)) : status;
    if (status == SPAR_OK) {
        hand_over(&d, best, beam, &t->advised);
    } else {
        free(beam);
    }
    for (int k = 0; k < d.count; k++) {
        spari_record_free(&d.tried[k].record);
    }
    free(d.tried);
    return status;
}

int spar_trial_advise(spar_trial *trial, double tolerance, double length) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, trial, SPAR_ERR_ARGUMENT, "%s: the trial is NULL; create it first", SPARI_ADVISE);
    const spari_agreed arguments[] = {spari_real("tolerance", tolerance), spari_real("length", length)};
    SPARI_TRY(spari_trial_enter(trial, SPARI_ADVISE, arguments, 2, check_request(trial, tolerance, length)));
    return spari_trial_leave(trial, SPARI_ADVISE, find_advice(trial, tolerance, length));
}
