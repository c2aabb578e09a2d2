/* Trials of the advice: see plan.h. */
#include "plan.h"

#include "../coupling/schemes.h"
#include "../math/basis.h"
#include "../time/fidelity.h"
#include "../trial/move_joints.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LEAST_NODES = 3 };

static int has_nodes(const spar_member *m) {
    return m->kind == SPARI_BEAM && !m->external && m->row->solved && m->fidelity >= SPAR_FIDELITY_LINEAR &&
           !spari_joints_hold_within(m, m->mesh.elements);
}

static int nodes_of(const spar_member *m, int more) {
    int nodes = m->mesh.per_element + more, least = LEAST_NODES < m->mesh.per_element ? LEAST_NODES : 2;
    return !has_nodes(m)             ? m->mesh.per_element
           : nodes < least           ? least
           : nodes > SPARI_MAX_NODES ? SPARI_MAX_NODES
                                     : nodes;
}

spari_plan spari_plan_present(const spar_session *s, int64_t steps) {
    return (spari_plan){.steps = steps,
                        .scheme = s->coupling.scheme,
                        .predictor = s->coupling.predictor,
                        .rtol = s->coupling.rtol,
                        .newton = s->newton.rtol};
}

void spari_plan_settings(const spari_plan *p, double *values) {
    SPARI_VARY(values, coupling.scheme, p->scheme);
    SPARI_VARY(values, coupling.predictor, p->predictor);
    SPARI_VARY(values, coupling.rtol, p->rtol);
    SPARI_VARY(values, newton.rtol, p->newton);
}

spari_rebuild spari_plan_rebuild(const spar_member *m, const spari_plan *p) {
    spari_rebuild r = spari_rebuild_of(m);
    r.per_element = nodes_of(m, p->more);
    return r;
}

int spari_plan_has_nodes(const spari_advisor *d, int more) {
    int any = 0;
    for (const spar_member *m = d->session->members; m; m = m->next) {
        any = any || nodes_of(m, more) != m->mesh.per_element;
    }
    return any && !d->search->keep_nodes;
}

/* Nodes of a plan relative to those of the session: what a solution costs beside it. */
static double weight(const spari_advisor *d, const spari_plan *p) {
    double now = 1, then = 1;
    for (const spar_member *m = d->session->members; m; m = m->next) {
        now += m->mesh.per_element;
        then += nodes_of(m, p->more);
    }
    return then / now;
}

void spari_plan_tell(const spari_advisor *d, const spari_tried *t) {
    const spari_coupling_scheme *scheme = spari_coupling_scheme_of(t->plan.scheme);
    spar_session *s = d->session;
    char text[SPARI_MESSAGE_SIZE], result[SPARI_MESSAGE_SIZE / 2];
    if (!s->callbacks.log || d->progress.stopped != SPAR_OK) {
        return;
    }
    if (t->record.value) {
        (void)snprintf(result, sizeof result, "error %.3g, cost %.4g", t->error, t->cost);
    } else {
        (void)snprintf(result, sizeof result, "fails: %.300s", s->message);
    }
    (void)snprintf(text, sizeof text, "%s: trial %d: dt %.4g, %s %.0e, predictor %d, Newton %.0e, %+d nodes: %s",
                   SPARI_ADVISE, (int)(t - d->tried) + 1, d->run.dt * (double)d->run.steps / (double)t->plan.steps,
                   scheme->name, t->plan.rtol, t->plan.predictor, t->plan.newton, t->plan.more, result);
    spari_log(s, SPAR_LOG_INFO, text);
}

/* Statuses that say that the settings are unsuitable, and nothing worse. */
static int is_unsuitable(int status) {
    return status == SPAR_ERR_NUMERIC || status == SPAR_ERR_LIMIT || status == SPAR_ERR_USER ||
           status == SPAR_ERR_STATE || status == SPAR_ERR_UNSUPPORTED || status == SPAR_ERR_ARGUMENT ||
           status == SPAR_ERR_MAPPING;
}

int spari_plan_try(spari_advisor *d, const spari_plan *p, int *index) {
    spar_session *s = d->session;
    spari_trial_settings settings;
    spari_run run = d->run;
    *index = -1;
    if (d->count >= d->most) {
        return SPAR_OK;
    }
    SPARI_TRY(spari_progress_tell(s, &d->progress, d->count, fmax(d->count, d->most)));
    SPARI_TRY(spari_trial_settings_create(s, &settings));
    spari_tried *t = &d->tried[d->count];
    *t = (spari_tried){.plan = *p, .error = INFINITY, .cost = INFINITY};
    spari_plan_settings(p, settings.setting);
    int64_t k = 0;
    for (const spar_member *m = s->members; m; m = m->next) {
        settings.member[k++] = spari_plan_rebuild(m, p);
    }
    run.steps = p->steps;
    run.dt = d->run.dt * (double)d->run.steps / (double)p->steps;
    int status = spari_trial_run(s, &run, &settings, &t->record);
    spari_trial_settings_free(&settings);
    if (status != SPAR_OK) {
        spari_record_free(&t->record);
        spari_plan_tell(d, t);
    } else {
        t->cost = (double)t->record.solutions * weight(d, p);
        t->error = 0;
    }
    *index = d->count++;
    return is_unsuitable(status) ? SPAR_OK : status;
}

int spari_plan_distance(spari_advisor *d, int a, int b, double *error) {
    spar_session *s = d->session;
    const spari_record *x = &d->tried[a].record, *y = &d->tried[b].record;
    double found[2] = {0, 0};
    *error = INFINITY;
    if (!x->value || !y->value) {
        return SPAR_OK;
    }
    found[0] = spari_comm_rank(s->ranks.comm) == 0 ? spari_record_error(x, y, d->search->goals, d->longer) : 0;
    SPARI_TRY(spari_sum(s, found, 1));
    *error = found[0];
    return SPAR_OK;
}
