/* The cheapest settings for a tolerance, by trials. First a run that is converged; then, one after the other with a
   share of the tolerance for each, what of the structure can be left out; then the coupling and dt together; then
   single and double moves that still pay; at last a longer run, whether what is cheapest stays stable. Errors are those
   of whole runs, costs the processor time of their steps. */
#include "trial.h"

#include "../math/basis.h"
#include "../member/beam.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const CALL = "spar_session_advise";

enum {
    GROUPS = 8,        /* of beams described alike; what is beyond stays as it is */
    FINEST = 6,        /* the reference halves dt so often at most */
    LEAST_NODES = 3,   /* of an element; 2 lock */
    TRIED = 100,       /* settings measured before moves end */
    KNOWN = 400,       /* and remembered at most */
    LONGER = 4,        /* times the trials: the run that stability is looked at in, */
    LEAST_STEPS = 256, /* and so many steps at least */
    DOUBTED = 12       /* settings looked at so */
};

/* A change has to make a run cheaper by more than the clock's noise. */
static const double worth = 0.95;

/* Parts of the tolerance that leaving out may take. */
static const double share_of_rung = 0.35, share_of_nodes = 0.25, share_of_points = 0.15, share_of_newton = 0.02,
                    share_of_reference = 0.25;

/* What of a beam is chosen. */
typedef struct shape {
    int nodes, fidelity, points;
    int64_t modes;
} shape;

/* What a run is made with. Compared byte by byte: made by copies of one that began with zeros. */
typedef struct plan {
    int64_t steps;
    int substeps, scheme, predictor, unused;
    double rtol, newton;
    shape group[GROUPS];
} plan;

typedef struct outcome {
    plan plan;
    double error, seconds; /* INFINITY: it fails */
} outcome;

typedef struct advisor {
    spar_session *session;
    spari_run run; /* as the host asked */
    double tolerance;
    int groups, *group; /* [members] of which group; -1: as it is */
    spari_record reference;
    double reference_error;
    outcome *known; /* [KNOWN] settings measured against the reference */
    int known_count, trials;
} advisor;

/* ---- plans ---- */

static int is_varied(const spar_member *m) {
    return m->kind == SPARI_BEAM && !m->external;
}

/* Whether two beams may be taken for copies of each other. */
static int alike(const spar_member *a, const spar_member *b) {
    return a->elements == b->elements && a->per_element == b->per_element && a->fidelity == b->fidelity &&
           a->modes == b->modes && a->root == b->root && a->effects == b->effects &&
           a->beam->section_count == b->beam->section_count && a->beam->axis_count == b->beam->axis_count &&
           a->beam->rule == b->beam->rule && a->beam->points == b->beam->points;
}

static const spar_member *member_of_group(const advisor *d, int group) {
    const spar_member *m = d->session->members;
    for (int k = 0; d->group[k] != group; k++) {
        m = m->next;
    }
    return m;
}

static int find_groups(advisor *d) {
    const spar_session *s = d->session;
    d->group = spari_zalloc(s->member_count, sizeof *d->group);
    d->known = spari_zalloc(KNOWN, sizeof *d->known);
    SPARI_REQUIRE(d->session, d->group && d->known, SPAR_ERR_MEMORY, "%s: no memory", CALL);
    int k = 0;
    for (const spar_member *m = s->members; m; m = m->next, k++) {
        d->group[k] = -1;
        for (int g = 0; g < d->groups && is_varied(m) && d->group[k] < 0; g++) {
            d->group[k] = alike(member_of_group(d, g), m) ? g : -1;
        }
        if (d->group[k] < 0 && is_varied(m) && d->groups < GROUPS) {
            d->group[k] = d->groups++;
        }
    }
    return SPAR_OK;
}

static plan present_plan(const advisor *d) {
    const spar_session *s = d->session;
    plan p;
    memset(&p, 0, sizeof p);
    p.steps = d->run.steps;
    p.substeps = s->substeps, p.scheme = s->scheme, p.predictor = s->predictor;
    p.rtol = s->coupling_rtol, p.newton = s->newton_rtol;
    for (int g = 0; g < d->groups; g++) {
        const spar_member *m = member_of_group(d, g);
        p.group[g].nodes = m->per_element;
        p.group[g].fidelity = m->fidelity;
        p.group[g].modes = m->modes;
    }
    return p;
}

/* Steps of the run on the grid of ratios sqrt(2), j = 0: as the host asked. */
static int64_t steps_at(const advisor *d, int j) {
    double n = (double)d->run.steps / SPARI_SAMPLES * pow(2, 0.5 * j);
    return SPARI_SAMPLES * (int64_t)fmax(1, floor(n + 0.5));
}

static int grid_of(const advisor *d, int64_t steps) {
    return (int)lround(2 * log2((double)steps / (double)d->run.steps));
}

/* ---- runs ---- */

/* Of a trial, not of the machine: the settings will not do. */
static int is_of_the_plan(int status) {
    return status == SPAR_ERR_NUMERIC || status == SPAR_ERR_USER || status == SPAR_ERR_STATE ||
           status == SPAR_ERR_UNSUPPORTED || status == SPAR_ERR_ARGUMENT || status == SPAR_ERR_MAPPING;
}

/* longer: times the host's steps */
static int run_plan(advisor *d, const plan *p, int longer, spari_record *record) {
    spar_session *s = d->session;
    spari_wish wish;
    spari_run run = d->run;
    SPARI_TRY(spari_wish_create(s, &wish));
    wish.substeps = p->substeps, wish.scheme = p->scheme, wish.predictor = p->predictor;
    wish.coupling_rtol = p->rtol;
    wish.newton_rtol = p->newton;
    for (int k = 0; k < s->member_count; k++) {
        if (d->group[k] >= 0) {
            const shape *g = &p->group[d->group[k]];
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

static const char *describe(const advisor *d, const plan *p, char *text, size_t size) {
    static const char *const scheme[] = {"explicit", "fixed point", "Aitken", "IQN-ILS"}, *const rung[] = {
                                                                                              "prescribed", "rigid",
                                                                                              "linear", "modal",
                                                                                              "exact"};
    double dt = d->run.dt * (double)d->run.steps / (double)p->steps;
    int at = snprintf(text, size, "dt %.4g", dt);
    if (p->substeps > 1) {
        at += snprintf(text + at, size - (size_t)at, " in %d substeps", p->substeps);
    }
    at += snprintf(text + at, size - (size_t)at, ", %s", scheme[p->scheme]);
    if (p->scheme != SPAR_COUPLING_EXPLICIT) {
        at += snprintf(text + at, size - (size_t)at, " %.0e", p->rtol);
    }
    at += snprintf(text + at, size - (size_t)at, ", predictor %d, Newton %.0e", p->predictor, p->newton);
    for (int g = 0; g < d->groups && (size_t)at + 80 < size; g++) {
        const shape *b = &p->group[g];
        at += snprintf(text + at, size - (size_t)at, ", %s", rung[b->fidelity]);
        if (b->fidelity == SPAR_FIDELITY_MODAL) {
            at += snprintf(text + at, size - (size_t)at, " %lld", (long long)b->modes);
        }
        at += snprintf(text + at, size - (size_t)at, " of %d nodes", b->nodes);
        if (b->points > 0) {
            at += snprintf(text + at, size - (size_t)at, " and %d points", b->points);
        }
    }
    return text;
}

static void tell(const advisor *d, const plan *p, double error, double seconds) {
    spar_session *s = d->session;
    char what[SPARI_MESSAGE_SIZE / 2], text[SPARI_MESSAGE_SIZE];
    if (!s->log) {
        return;
    }
    (void)describe(d, p, what, sizeof what);
    if (isfinite(error)) {
        (void)snprintf(text, sizeof text, "%s: trial %d: %s: error %.3g, %.4g s", CALL, d->trials, what, error,
                       seconds);
    } else {
        (void)snprintf(text, sizeof text, "%s: trial %d: %s: fails: %.300s", CALL, d->trials, what, s->message);
    }
    s->log(s, SPAR_LOG_INFO, text, s->log_context);
}

/* How much larger an error is over the time that the host will run: errors of phase grow with time. */
static double later(const advisor *d, const spari_record *r, const spari_record *base) {
    const double doubt = 2; /* of what was not seen, as against what was */
    double longer = d->session->horizon / (d->run.dt * (double)d->run.steps);
    return longer > 1 ? 1 + doubt * (spari_record_growth(r, base, longer) - 1) : 1;
}

/* Error against the reference and cost; INFINITY if the settings fail. What is known is not run again. */
static int measure(advisor *d, const plan *p, outcome *out) {
    for (int k = 0; k < d->known_count; k++) {
        if (memcmp(&d->known[k].plan, p, sizeof *p) == 0) {
            *out = d->known[k];
            return SPAR_OK;
        }
    }
    enum { REPEATS = 3 };
    const double enough = 0.05; /* seconds that a short run is timed for in all */
    double spent = 0;
    *out = (outcome){*p, INFINITY, INFINITY};
    for (int k = 0; k < REPEATS && spent < enough; k++) {
        spari_record r;
        int status = run_plan(d, p, 1, &r);
        if (status != SPAR_OK) {
            spari_record_free(&r);
            if (!is_of_the_plan(status)) {
                return status;
            }
            break;
        }
        out->error = spari_record_motion(&r, &d->reference) * later(d, &r, &d->reference) + d->reference_error;
        out->seconds = fmin(out->seconds, r.seconds);
        spent += r.seconds;
        spari_record_free(&r);
    }
    tell(d, p, out->error, out->seconds);
    if (d->known_count < KNOWN) {
        d->known[d->known_count++] = *out;
    }
    return SPAR_OK;
}

/* A tenth of the tolerance stays for what an estimate does not see. */
static int is_good(const advisor *d, const outcome *o) {
    return o->error <= 0.9 * d->tolerance;
}

/* Change of the motion that the plan makes against a run of `base`, relative to the tolerance; INFINITY: it fails. */
static int distance(advisor *d, const plan *p, const spari_record *base, double *part, double *seconds) {
    spari_record r;
    int status = run_plan(d, p, 1, &r);
    *part = status == SPAR_OK ? spari_record_motion(&r, base) * later(d, &r, base) / d->tolerance : INFINITY;
    *seconds = r.seconds;
    tell(d, p, *part * d->tolerance, r.seconds);
    spari_record_free(&r);
    return is_of_the_plan(status) ? SPAR_OK : status;
}

/* ---- the reference ---- */

static plan reference_plan(const advisor *d, const plan *present, int level) {
    const spar_session *s = d->session;
    plan p = *present;
    p.newton = fmin(p.newton, 1e-10);
    p.substeps = 1;
    p.predictor = 1;
    if (!s->keep_coupling) {
        p.scheme = SPAR_COUPLING_IQN_ILS;
        p.rtol = 1e-8;
    }
    p.steps = s->keep_dt ? present->steps : steps_at(d, 2 * level);
    for (int g = 0; g < d->groups; g++) {
        shape *b = &p.group[g];
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

/* Halves dt until the error that is left, judged by how the changes fall, is a small part of the tolerance. */
static int find_reference(advisor *d, const plan *present, plan *finest) {
    spar_session *s = d->session;
    double change = 0, before = 0;
    d->reference_error = INFINITY;
    int ends = s->keep_dt && s->keep_nodes ? 0 : s->keep_dt ? 2 : FINEST;
    for (int level = 0; level <= ends && d->reference_error > share_of_reference * d->tolerance; level++) {
        spari_record finer;
        plan p = reference_plan(d, present, level);
        int status = run_plan(d, &p, 1, &finer);
        if (status != SPAR_OK) {
            spari_record_free(&finer);
            if (!is_of_the_plan(status)) {
                return status;
            }
            tell(d, &p, INFINITY, 0);
            continue; /* too coarse, perhaps */
        }
        before = change;
        change = d->reference.motion ? spari_record_motion(&d->reference, &finer) : 0;
        if (d->reference.motion) { /* what is left: the changes to come, a geometric series */
            double rate = before > 0 && change > 0 ? fmin(fmax(before / change, 1.25), 4) : 2;
            d->reference_error = change / (rate - 1) * later(d, &d->reference, &finer);
        } else if (ends == 0) {
            d->reference_error = 0;
        }
        tell(d, &p, change, finer.seconds);
        spari_record_free(&d->reference);
        d->reference = finer;
        *finest = p;
    }
    SPARI_REQUIRE(s, d->reference.motion, SPAR_ERR_NUMERIC, "%s: no reference run comes to its end: %.400s", CALL,
                  s->message);
    SPARI_REQUIRE(s, d->reference_error <= 0.5 * d->tolerance, SPAR_ERR_NUMERIC,
                  "%s: no reference: with dt/%lld and finer nodes the run still changes by %.3g, the tolerance is %g; "
                  "ask for less, begin with a smaller dt, or look whether the fluid solver is repeatable",
                  CALL, (long long)(finest->steps / d->run.steps), change, d->tolerance);
    return SPAR_OK;
}

/* ---- the structure ---- */

/* The fewest nodes whose error stays in its share; the error falls with the nodes. */
static int choose_nodes(advisor *d, plan *p, int g, const spari_record *base) {
    int few = LEAST_NODES - 1, enough = p->group[g].nodes;
    while (enough - few > 1) {
        int middle = (few + enough) / 2;
        double part, seconds;
        plan q = *p;
        q.group[g].nodes = middle;
        SPARI_TRY(distance(d, &q, base, &part, &seconds));
        if (part <= share_of_nodes) {
            enough = middle;
        } else {
            few = middle;
        }
    }
    p->group[g].nodes = enough;
    return SPAR_OK;
}

/* Takes the plan if it is within the share and cheaper than the best so far. */
static int consider(advisor *d, const plan *p, const spari_record *base, double share, plan *best, double *seconds,
                    int *taken) {
    double part, took;
    SPARI_TRY(distance(d, p, base, &part, &took));
    *taken = part <= share && took < worth * *seconds;
    if (*taken) {
        *best = *p;
        *seconds = took;
    }
    return SPAR_OK;
}

static int choose_rung(advisor *d, plan *p, int g, const spari_record *base) {
    static const int64_t modes[] = {16, 8, 4, 2};
    double seconds = base->seconds;
    plan best = *p, q = *p;
    int held = 0, taken, small;
    const spar_member *m = member_of_group(d, g);
    held = m->root == SPAR_ROOT_FIXED || m->root == SPAR_ROOT_DRIVEN;
    shape *b = &q.group[g];
    b->fidelity = SPAR_FIDELITY_LINEAR;
    SPARI_TRY(consider(d, &q, base, share_of_rung, &best, &seconds, &small));
    for (size_t k = 0; k < sizeof modes / sizeof *modes && small; k++) {
        b->fidelity = SPAR_FIDELITY_MODAL;
        b->modes = modes[k];
        SPARI_TRY(consider(d, &q, base, share_of_rung, &best, &seconds, &taken));
    }
    b->modes = 0;
    b->fidelity = SPAR_FIDELITY_RIGID;
    SPARI_TRY(consider(d, &q, base, share_of_rung, &best, &seconds, &taken));
    if (taken && held) {
        b->fidelity = SPAR_FIDELITY_PRESCRIBED;
        SPARI_TRY(consider(d, &q, base, share_of_rung, &best, &seconds, &taken));
    }
    *p = best;
    return SPAR_OK;
}

static int choose_points(advisor *d, plan *p, int g, const spari_record *base) {
    const spari_beam *beam = member_of_group(d, g)->beam;
    double part, seconds;
    if (spari_beam_rule(beam) != SPAR_QUADRATURE_SECTIONS || beam->points == 1) {
        return SPAR_OK;
    }
    plan q = *p;
    q.group[g].points = 1;
    SPARI_TRY(distance(d, &q, base, &part, &seconds));
    if (part <= share_of_points) {
        *p = q;
    }
    return SPAR_OK;
}

static int choose_newton(advisor *d, plan *p, const spari_record *base) {
    static const double tolerance[] = {1e-3, 1e-6, 1e-9};
    for (size_t k = 0; k < sizeof tolerance / sizeof *tolerance; k++) {
        double part, seconds;
        plan q = *p;
        q.newton = tolerance[k];
        SPARI_TRY(distance(d, &q, base, &part, &seconds));
        if (part <= share_of_newton) {
            *p = q;
            return SPAR_OK;
        }
    }
    return SPAR_OK;
}

static int is_elastic(const plan *p, int g) {
    return p->group[g].fidelity >= SPAR_FIDELITY_LINEAR;
}

/* Each choice is measured against the run before it, all with the host's dt and the reference's coupling. */
static int choose_structure(advisor *d, const plan *finest, plan *chosen) {
    const spar_session *s = d->session;
    plan p = *finest;
    spari_record base;
    p.steps = d->run.steps;
    p.rtol = fmax(p.rtol, 1e-2 * d->tolerance);
    int status = run_plan(d, &p, 1, &base);
    while (is_of_the_plan(status) && p.steps < finest->steps) {
        spari_record_free(&base);
        p.steps *= 2;
        status = run_plan(d, &p, 1, &base);
    }
    for (int g = 0; g < d->groups && status == SPAR_OK; g++) {
        status = s->keep_fidelity ? SPAR_OK : choose_rung(d, &p, g, &base);
        if (status == SPAR_OK && is_elastic(&p, g)) {
            status = choose_points(d, &p, g, &base);
            status = status == SPAR_OK && !s->keep_nodes ? choose_nodes(d, &p, g, &base) : status;
        } else if (status == SPAR_OK) {
            p.group[g].nodes = member_of_group(d, g)->per_element;
        }
    }
    if (status == SPAR_OK) { /* Newton's tolerance by itself, against the same shapes */
        spari_record_free(&base);
        status = run_plan(d, &p, 1, &base);
        status = status == SPAR_OK ? choose_newton(d, &p, &base) : status;
    }
    spari_record_free(&base);
    *chosen = p;
    return is_of_the_plan(status) ? SPAR_OK : status;
}

/* ---- dt and coupling ---- */

/* The coarsest steps that keep the tolerance, from grid place j on; *best improves if that is cheaper. */
static int coarsest_steps(advisor *d, plan p, int *j, outcome *best) {
    const int finest = 2 * FINEST, coarsest = (int)floor(2 * log2((double)SPARI_SAMPLES / (double)d->run.steps));
    int good = finest + 1, bad = coarsest - 1, at = *j;
    while (good - bad > 1 && d->known_count < TRIED) {
        outcome o;
        p.steps = steps_at(d, at);
        SPARI_TRY(measure(d, &p, &o));
        double ratio = isfinite(o.error) ? o.error / d->tolerance : 100;
        if (is_good(d, &o)) {
            good = at;
            if (o.seconds < worth * best->seconds) {
                *best = o;
                *j = at;
            }
        } else {
            bad = at;
            if (o.seconds > best->seconds && isfinite(o.seconds)) {
                return SPAR_OK; /* finer steps cost more still */
            }
        }
        /* with an error of order 2 in dt the next place is near; then halve the gap */
        int leap = (int)lround(log2(fmax(ratio, 1e-3)));
        leap = leap > 0 ? leap : leap < 0 ? leap : is_good(d, &o) ? -1 : 1;
        at += leap;
        if (at >= good || at <= bad) {
            at = (good + bad) / 2;
            at = at >= good ? good - 1 : at <= bad ? bad + 1 : at;
        }
    }
    return SPAR_OK;
}

static int choose_time(advisor *d, const plan *structure, outcome *best) {
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
        plan p = *structure;
        p.scheme = kept ? s->scheme : coupling[k].scheme;
        p.rtol = kept || coupling[k].rtol <= 0 ? s->coupling_rtol : coupling[k].rtol;
        p.predictor = coupling[k].predictor;
        if (s->keep_dt) {
            outcome o;
            p.steps = d->run.steps;
            SPARI_TRY(measure(d, &p, &o));
            *best = is_good(d, &o) && o.seconds < best->seconds ? o : *best;
        } else {
            SPARI_TRY(coarsest_steps(d, p, &j, best));
        }
    }
    return SPAR_OK;
}

/* ---- moves ---- */

/* Changes one thing of the plan; 0: there is no such change. */
typedef int (*move)(const advisor *d, plan *p, int g);

static int coarser(const advisor *d, plan *p, int g) {
    (void)g;
    int64_t steps = steps_at(d, grid_of(d, p->steps) - 1);
    int moved = !d->session->keep_dt && steps < p->steps;
    p->steps = moved ? steps : p->steps;
    return moved;
}

static int finer(const advisor *d, plan *p, int g) {
    (void)g;
    p->steps = steps_at(d, grid_of(d, p->steps) + 1);
    return !d->session->keep_dt;
}

static int fewer_nodes(const advisor *d, plan *p, int g) {
    return !d->session->keep_nodes && is_elastic(p, g) && p->group[g].nodes-- > LEAST_NODES;
}

static int more_nodes(const advisor *d, plan *p, int g) {
    return !d->session->keep_nodes && is_elastic(p, g) && p->group[g].nodes++ < SPARI_MAX_NODES;
}

static int fewer_points(const advisor *d, plan *p, int g) {
    int moved = is_elastic(p, g) && p->group[g].points == 0 &&
                spari_beam_rule(member_of_group(d, g)->beam) == SPAR_QUADRATURE_SECTIONS;
    p->group[g].points = moved ? 1 : p->group[g].points;
    return moved;
}

static int lower_rung(const advisor *d, plan *p, int g) {
    shape *b = &p->group[g];
    if (d->session->keep_fidelity) {
        return 0;
    }
    if (b->fidelity == SPAR_FIDELITY_MODAL && b->modes > 1) {
        b->modes /= 2;
        return 1;
    }
    if (b->fidelity == SPAR_FIDELITY_EXACT || b->fidelity == SPAR_FIDELITY_LINEAR) {
        b->fidelity = SPAR_FIDELITY_MODAL;
        b->modes = 8;
        return 1;
    }
    return 0;
}

static int looser_newton(const advisor *d, plan *p, int g) {
    (void)d, (void)g;
    p->newton *= 1e3;
    return p->newton <= 1e-3;
}

static int other_predictor(const advisor *d, plan *p, int g) {
    (void)d, (void)g;
    p->predictor = 3 - p->predictor;
    return p->predictor == 1 || p->predictor == 2;
}

static int more_substeps(const advisor *d, plan *p, int g) {
    p->substeps *= 2;
    return p->substeps <= 8 && coarser(d, p, g) && coarser(d, p, g);
}

static const struct {
    move first, second;
} moves[] = {{coarser, NULL},           {fewer_nodes, NULL},        {fewer_points, NULL},  {lower_rung, NULL},
             {looser_newton, NULL},     {other_predictor, coarser}, {more_substeps, NULL}, {finer, fewer_nodes},
             {coarser, more_nodes},     {finer, lower_rung},        {finer, fewer_points}, {coarser, coarser},
             {fewer_nodes, fewer_nodes}};

/* Moves as long as one pays and keeps the tolerance. */
static int improve(advisor *d, outcome *best) {
    int rounds = d->groups > 0 ? d->groups : 1, moved = 1;
    while (moved && d->known_count < TRIED) {
        moved = 0;
        for (size_t k = 0; k < sizeof moves / sizeof *moves && d->known_count < TRIED; k++) {
            for (int g = 0; g < rounds; g++) {
                plan p = best->plan;
                outcome o;
                if (!moves[k].first(d, &p, g) || (moves[k].second && !moves[k].second(d, &p, g))) {
                    continue;
                }
                SPARI_TRY(measure(d, &p, &o));
                if (is_good(d, &o) && o.seconds < worth * best->seconds) {
                    *best = o;
                    moved = 1;
                }
            }
        }
    }
    return SPAR_OK;
}

/* ---- stability ---- */

/* Whether a part of the loads that turns round with every step is there and grows, and not with the motion itself, as
   the finer run shows it. */
static int seesaws(const spari_record *r, const spari_record *finer) {
    const double there = 1e-8, grows = 2; /* squares */
    double same = fmax(1, finer->alternating[1] / fmax(finer->alternating[0], DBL_MIN));
    return r->alternating[1] > there && r->alternating[1] > grows * same * r->alternating[0];
}

/* Whether the settings stay near a run with half the dt and a tight coupling for longer than the trials were: what
   grows slowly enough to pass a trial is found here. Errors of phase may have grown as the time has. */
static int look_longer(advisor *d, const plan *p, int *stays) {
    int longer = p->steps * LONGER < LEAST_STEPS ? (int)(LEAST_STEPS / p->steps) + 1 : LONGER;
    plan q = *p;
    spari_record run, finer = {0};
    int status = run_plan(d, p, longer, &run);
    if (status == SPAR_OK) {
        q.steps = 2 * p->steps;
        q.predictor = 1;
        q.newton = fmin(q.newton, 1e-9);
        if (!d->session->keep_coupling) {
            q.scheme = SPAR_COUPLING_IQN_ILS;
            q.rtol = 1e-4;
        }
        status = run_plan(d, &q, longer, &finer);
    }
    double error = status == SPAR_OK ? spari_record_motion(&run, &finer) : INFINITY;
    *stays = error <= longer * d->tolerance && !seesaws(&run, &finer);
    tell(d, p, error, run.seconds);
    spari_record_free(&run);
    spari_record_free(&finer);
    return is_of_the_plan(status) ? SPAR_OK : status;
}

/* The cheapest of all settings that keep the tolerance and stay stable. */
static int find_stable(advisor *d, outcome *best) {
    int stays = 0;
    for (int k = 0; k < DOUBTED && isfinite(best->seconds); k++) {
        SPARI_TRY(look_longer(d, &best->plan, &stays));
        if (stays) {
            return SPAR_OK;
        }
        outcome next = {.error = INFINITY, .seconds = INFINITY};
        for (int i = 0; i < d->known_count; i++) {
            outcome *o = &d->known[i];
            if (memcmp(&o->plan, &best->plan, sizeof o->plan) == 0) {
                o->error = INFINITY;
            } else if (is_good(d, o) && o->seconds < next.seconds) {
                next = *o;
            }
        }
        *best = next;
    }
    return spari_fail(
        d->session, SPAR_ERR_NUMERIC,
        "%s: settings that keep the tolerance over the trials drift away after them; ask with more steps, "
        "or for less",
        CALL);
}

/* ---- the answer ---- */

/* The finest settings known not to fail, where the shares left nothing: they are tried as they are. */
static int search(advisor *d, const plan *present, outcome *now, outcome *best) {
    plan finest, structure;
    SPARI_TRY(find_reference(d, present, &finest));
    SPARI_TRY(measure(d, present, now));
    SPARI_TRY(choose_structure(d, &finest, &structure));
    SPARI_TRY(choose_time(d, &structure, best));
    if (!isfinite(best->seconds)) {
        SPARI_TRY(choose_time(d, &finest, best));
    }
    if (is_good(d, now) && now->seconds < best->seconds) {
        *best = *now;
    }
    if (isfinite(best->seconds)) {
        SPARI_TRY(improve(d, best));
        return find_stable(d, best);
    }
    double least = INFINITY;
    for (int k = 0; k < d->known_count; k++) {
        least = fmin(least, d->known[k].error);
    }
    return spari_fail(d->session, SPAR_ERR_NUMERIC,
                      "%s: of %d trials none keeps the tolerance %g; the least error is %.3g; ask for less, or begin "
                      "with a smaller dt",
                      CALL, d->trials, d->tolerance, least);
}

static int hand_over(advisor *d, const outcome *now, const outcome *best, double *advice) {
    const plan *p = &best->plan;
    int k = 0;
    for (spar_member *m = d->session->members; m; m = m->next) {
        if (!m->advice && !(m->advice = spari_zalloc(1, sizeof *m->advice))) {
            return spari_fail(d->session, SPAR_ERR_MEMORY, "%s: no memory", CALL);
        }
    }
    for (spar_member *m = d->session->members; m; m = m->next, k++) {
        *m->advice = spari_remake_of(m);
        if (d->group[k] >= 0) {
            const shape *b = &p->group[d->group[k]];
            *m->advice = (spari_remake){b->nodes, b->fidelity, b->modes, b->points, 0};
        }
    }
    advice[SPAR_ADVICE_DT] = d->run.dt * (double)d->run.steps / (double)p->steps;
    advice[SPAR_ADVICE_SUBSTEPS] = p->substeps;
    advice[SPAR_ADVICE_SCHEME] = p->scheme;
    advice[SPAR_ADVICE_COUPLING_RTOL] = p->rtol;
    advice[SPAR_ADVICE_PREDICTOR] = p->predictor;
    advice[SPAR_ADVICE_NEWTON_RTOL] = p->newton;
    advice[SPAR_ADVICE_ERROR] = best->error;
    advice[SPAR_ADVICE_COST] = isfinite(now->seconds) && now->seconds > 0 ? best->seconds / now->seconds : -1;
    advice[SPAR_ADVICE_PRESENT_ERROR] = isfinite(now->error) ? now->error : -1;
    advice[SPAR_ADVICE_TRIALS] = d->trials;
    return SPAR_OK;
}

static int check(spar_session *s, double tolerance, const spari_run *run, const double *advice) {
    SPARI_TRY(spari_trial_check(s, CALL, run));
    SPARI_REQUIRE(s, tolerance > 0 && tolerance < 1, SPAR_ERR_ARGUMENT, "%s: the tolerance is %g; give one in (0, 1)",
                  CALL, tolerance);
    SPARI_REQUIRE(s, advice, SPAR_ERR_ARGUMENT, "%s: advice is NULL", CALL);
    SPARI_REQUIRE(s, run->solve, SPAR_ERR_UNSUPPORTED,
                  "%s: without a fluid solver there are no trials; give the one that spar_step is given", CALL);
    return SPAR_OK;
}

int spar_session_advise(spar_session *session, double tolerance, double dt, int64_t steps, spar_before_step before,
                        spar_fluid_solver solve, void *context, double advice[SPAR_ADVICE_COUNT]) {
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", CALL);
    spar_session *s = session;
    advisor d = {.session = s, .run = {dt, steps, before, solve, context}, .tolerance = tolerance};
    outcome now = {0}, best = {.seconds = INFINITY, .error = INFINITY};
    SPARI_TRY(spari_comm_enter(s->comm, CALL, check(s, tolerance, &d.run, advice), s->message, sizeof s->message));
    char message[SPARI_MESSAGE_SIZE];
    memcpy(message, s->message, sizeof message);
    int status = spari_comm_agree(s->comm, find_groups(&d), s->message, sizeof s->message);
    if (status == SPAR_OK) {
        plan present = present_plan(&d);
        status = search(&d, &present, &now, &best);
    }
    if (status == SPAR_OK) {
        memcpy(s->message, message, sizeof message); /* what failed in a trial is no failure of the session's */
        status = spari_comm_agree(s->comm, hand_over(&d, &now, &best, advice), s->message, sizeof s->message);
    }
    free(d.group);
    free(d.known);
    spari_record_free(&d.reference);
    return status;
}

int spar_member_get_advice(const spar_member *member, int *fidelity, int64_t *modes, int *nodes_per_element,
                           int *points) {
    const char *call = "spar_member_get_advice";
    SPARI_REQUIRE(NULL, member, SPAR_ERR_ARGUMENT, "%s: the member is NULL; create it first", call);
    SPARI_REQUIRE(member->session, member->advice, SPAR_ERR_STATE,
                  "%s: '%s' has no advice yet; call spar_session_advise first", call, member->name);
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
