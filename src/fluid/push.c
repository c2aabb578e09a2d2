/* Pushes loads from the fluid's nodes to the members. */
#include "../base/environment.h"
#include "../math/predictor.h"
#include "../math/rotation.h"
#include "state.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- push ---- */

/* Whether node forces can be pushed; *n: number of nodes. */
static int check_forces(const spar_fluid *fluid, int has_place, int64_t *n, const char *caller) {
    const spari_nodes *s;
    SPARI_TRY(spari_fluid_mapped(fluid, SPAR_NODES_FORCE, caller, &s));
    *n = s ? s->n : 0;
    SPARI_FLUID_REQUIRE_OF(fluid, caller, *n == 0 || has_place, SPAR_ERR_ARGUMENT, "the pointer to the forces is NULL");
    if (!fluid->history && s) {
        return spari_fluid_refuse(fluid, SPAR_ERR_STATE, caller,
                                  "node forces are not stored; request SPAR_EFFECT_FLUID_HISTORY with "
                                  "spar_member_set_effects before the member is committed");
    }
    SPARI_FLUID_REQUIRE_OF(fluid, caller, *n == 0 || spari_history_is_known(fluid->history), SPAR_ERR_STATE,
                           "the nodes are new, and the fluid has loads: their forces are not known before they are "
                           "pushed. As many stations as before keep their forces");
    return SPAR_OK;
}

static int pull_forces(spar_fluid *fluid, double theta, double *d, float *f, const char *caller) {
    int64_t n;
    const spari_history *h = fluid->history;
    SPARI_TRY(spari_fluid_check_theta(fluid, theta, caller));
    theta = spari_fluid_time(fluid, theta);
    SPARI_TRY(check_forces(fluid, d || f, &n, caller));
    fluid->asked |= SPARI_MUTE_HISTORY;
    const spari_layout *layout = spari_fluid_layout(fluid, SPAR_NODES_FORCE);
    int64_t node = layout ? layout->node : 3, component = layout ? layout->component : 1;
    int muted = (fluid->mute & SPARI_MUTE_HISTORY) != 0;
    theta = h && h->known == 0 ? 1 : theta; /* at t^n they are unknown: those pushed in this step stand for them */
    for (int64_t i = 0; h && i < 3 * n; i++) {
        double x = muted ? 0 : (1 - theta) * h->past[0][i] + theta * h->after[i];
        int64_t at = i / 3 * node + i % 3 * component;
        if (d) {
            d[at] = x;
        } else {
            f[at] = (float)x;
            SPARI_FLUID_REQUIRE_OF(fluid, caller, isfinite(f[at]), SPAR_ERR_NUMERIC,
                                   "the force of node %lld, %g, is too large for single precision", (long long)(i / 3),
                                   x);
        }
    }
    return SPAR_OK;
}

int spar_fluid_pull_forces(spar_fluid *fluid, double theta, double *force) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    return pull_forces(fluid, theta, force, NULL, __func__);
}

int spar_fluid_pull_forces_f32(spar_fluid *fluid, double theta, float *force) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    return pull_forces(fluid, theta, NULL, force, __func__);
}

int spar_fluid_get_forces(const spar_fluid *fluid, double *force) {
    SPARI_FLUID_HANDLE(fluid);
    int64_t n;
    SPARI_TRY(check_forces(fluid, force != NULL, &n, __func__));
    if (n > 0) {
        memcpy(force, fluid->history->after, 3 * (size_t)n * sizeof *force);
    }
    return SPAR_OK;
}

/* The forces at t^{n+1} become those of t^n. */
static void keep_past(spari_history *h) {
    memcpy(h->past[0], h->after, sizeof *h->after * 3 * (size_t)h->n);
    h->known = h->known > 0 ? h->known : 1;
}

static void keep_forces(spar_fluid *fluid, spari_source force) {
    spari_history *h = fluid->history;
    if (!h || h->n == 0 || (!force.d && !force.f)) {
        return;
    }
    for (int64_t i = 0; i < 3 * h->n; i++) {
        h->after[i] = spari_source_at(force, i / 3, (int)(i % 3));
    }
    if (fluid->member->session->state.phase == SPARI_IDLE) {
        keep_past(h);
    }
    h->pushed = 1;
}

/* Audit: loads after the map compared with the pushed ones (spar.h describes the numbers). */
static void write_audit(spar_fluid *fluid, const spari_audit *in, int64_t n) {
    const spar_member *m = fluid->member;
    double force[3] = {0}, moment[3] = {0}, power = 0, t[3], d[3];
    for (int64_t l = 0; l < m->nodes; l++) {
        const double *load = fluid->load + 6 * l, *q = m->after.q + 7 * l, *v = m->after.v + 6 * l;
        double x[3] = {m->xr[3 * l] + q[0], m->xr[3 * l + 1] + q[1], m->xr[3 * l + 2] + q[2]};
        spari_cross(x, load, t);
        for (int i = 0; i < 3; i++) {
            force[i] += load[i];
            moment[i] += t[i] + load[3 + i];
            power += load[i] * v[i] + load[3 + i] * v[3 + i];
        }
    }
    double force_scale = in->force_sum, moment_scale = in->force_sum * in->x_max + in->moment_sum;
    double power_scale = in->force_sum * in->v_max + in->moment_sum * in->omega_max;
    double *a = fluid->audit;
    a[0] = spari_norm(in->force), a[1] = spari_norm(in->moment), a[2] = in->power;
    for (int i = 0; i < 3; i++) {
        d[i] = force[i] - in->force[i], t[i] = moment[i] - in->moment[i];
    }
    a[3] = force_scale > 0 ? spari_norm(d) / force_scale : 0;
    a[4] = moment_scale > 0 ? spari_norm(t) / moment_scale : 0;
    a[5] = power_scale > 0 ? fabs(power - in->power) / power_scale : 0;
    a[6] = in->x_max, a[7] = (double)n;
}

/* Reports the first number of the host that is not finite. */
static int check_source(const spar_fluid *fluid, const char *caller, const char *what, spari_source x, int64_t n) {
    for (int64_t i = 0; i < 3 * n && (x.d || x.f); i++) {
        double value = spari_source_at(x, i / 3, (int)(i % 3));
        SPARI_FLUID_REQUIRE_OF(fluid, caller, isfinite(value), SPAR_ERR_ARGUMENT,
                               "%s %lld, component %d, is %g; give finite numbers", what, (long long)(i / 3),
                               (int)(i % 3), value);
    }
    return SPAR_OK;
}

static void swap_bins(spar_fluid *fluid, int a, int b) {
    spari_bins *was = fluid->bins[a];
    fluid->bins[a] = fluid->bins[b], fluid->bins[b] = was;
}

/* Nodal load in load_new from reproducible sums. Returns the smallest |Q|^2. */
static double bin_loads(spar_fluid *fluid, const spari_nodes *s, spari_source force, spari_source moment) {
    int finite;
    double least = spari_bin_loads(s, fluid->modal, fluid->consistent, fluid->member->after.q, force, moment,
                                   spari_fluid_work(fluid, 0), fluid->bins[SPARI_OF_NEXT], &finite);
    for (int64_t i = 0; i < 6 * fluid->member->nodes; i++) {
        spari_bins_double(fluid->bins[SPARI_OF_NEXT] + i);
        fluid->load_new[i] = finite ? 0.5 * spari_bins_value(fluid->bins[SPARI_OF_NEXT] + i) : NAN;
    }
    return least;
}

/* Nodal load in load_new; SPAR_OK if it is usable. */
static int gather_loads(spar_fluid *fluid, const spari_nodes *s, spari_source force, spari_source moment,
                        spari_audit *audit, const char *caller) {
    const spar_member *m = fluid->member;
    int reproducible = m->session->ranks.reproducible;
    double least = HUGE_VAL;
    SPARI_FLUID_REQUIRE_OF(fluid, caller, !reproducible || spari_fluid_make_bins(fluid) == SPAR_OK, SPAR_ERR_MEMORY,
                           "no memory for reproducible sums of its loads");
    if (s->n == 0) { /* the nodes are on other ranks */
        int64_t n = 6 * m->nodes;
        memset(fluid->load_new, 0, (size_t)n * sizeof *fluid->load_new);
        if (reproducible) {
            memset(fluid->bins[SPARI_OF_NEXT], 0, (size_t)n * sizeof(spari_bins));
        }
        return SPAR_OK;
    }
    if (audit || !reproducible) {
        spari_field_fill(m->mesh.elements, m->mesh.per_element, fluid->modal, fluid->consistent,
                         audit ? SPARI_UPTO_RATE : SPARI_UPTO_POSITION, m->xr, m->after.q, m->after.v, m->after.a,
                         fluid->field[0]);
        least = spari_gather_loads(s, fluid->modal, fluid->field[0], fluid->consistent, m->after.q, force, moment,
                                   spari_fluid_work(fluid, 0), fluid->load_new, audit);
    }
    if (reproducible) {
        least = bin_loads(fluid, s, force, moment);
    }
    if (spari_first_nonfinite(fluid->load_new, 6 * m->nodes) >= 0) { /* the cause is searched only after a failure */
        SPARI_TRY(check_source(fluid, caller, "force of node", force, s->n));
        SPARI_TRY(check_source(fluid, caller, "moment of node", moment, s->n));
        SPARI_TRY(spari_fluid_check_rotation(fluid, least, caller));
        return spari_fluid_refuse(fluid, SPAR_ERR_ARGUMENT, caller,
                                  "the loads are too large for a double; check their unit");
    }
    return spari_fluid_check_rotation(fluid, least, caller);
}

static int push(spar_fluid *fluid, const spari_nodes *s, spari_source force, spari_source moment, const char *caller) {
    spari_audit audit = {0};
    int audited = !fluid->options.audit_off;
    SPARI_FLUID_REQUIRE_OF(fluid, caller, s->n == 0 || force.d || force.f, SPAR_ERR_ARGUMENT,
                           "the force array is NULL though there are %lld force nodes", (long long)s->n);
    fluid->asked |= SPARI_ASKED_LOADS | (moment.d || moment.f ? SPARI_ASKED_MOMENT : 0);
    if (!(fluid->member->effects & SPAR_EFFECT_FLUID_MOMENT)) {
        moment = (spari_source){0};
    }
    SPARI_TRY(gather_loads(fluid, s, force, moment, audited ? &audit : NULL, caller));
    double *old = fluid->load;
    fluid->load = fluid->load_new, fluid->load_new = old;
    if (fluid->member->session->ranks.reproducible) {
        swap_bins(fluid, SPARI_OF_PUSHED, SPARI_OF_NEXT);
    } else if (fluid->bins[SPARI_OF_PUSHED]) {
        spari_fluid_drop_bins(fluid);
    }
    if (audited) {
        write_audit(fluid, &audit, s->n);
    } else {
        memset(fluid->audit, 0, sizeof fluid->audit);
    }
    return SPAR_OK;
}

/* Records that there are no loads, and why. Between steps no call depends on them. */
static void note_refusal(spar_fluid *fluid, int status, const char *why) {
    const spar_session *session = fluid->member->session;
    size_t size = strlen(why) + 1;
    char *copy = session->state.phase == SPARI_IDLE && session->clock.started ? NULL : malloc(size);
    if (copy) {
        memcpy(copy, why, size);
    }
    spari_fluid_forget_refusal(fluid);
    fluid->why = copy;
    fluid->refused = session->state.phase == SPARI_IDLE && session->clock.started ? SPAR_OK : status;
}

int spar_fluid_fail(spar_fluid *fluid, int status, const char *message) {
    SPARI_FLUID_HANDLE(fluid);
    SPARI_FLUID_REQUIRE(fluid, status != SPAR_OK && spari_is_status(status), SPAR_ERR_ARGUMENT,
                        "the status is %d; give a SPAR_ERR_*", status);
    SPARI_FLUID_REQUIRE(fluid, message && message[0], SPAR_ERR_ARGUMENT,
                        "the message is missing; give a text that describes the failure");
    note_refusal(fluid, status, message);
    return SPAR_OK;
}

int spari_fluid_refused(const spar_fluid *fluid, const char **why) {
    *why = fluid->why ? fluid->why : "no memory for the message";
    return fluid->refused;
}

static int push_loads(spar_fluid *fluid, spari_source force, spari_source moment, const char *caller) {
    spar_session *session = fluid->member->session;
    const spari_nodes *s = NULL;
    SPARI_FLUID_REQUIRE_OF(fluid, caller, session->state.phase != SPARI_IDLE || !session->clock.started, SPAR_ERR_STATE,
                           "no step is in progress; loads are pushed between spar_step_begin and spar_step_accept, or "
                           "before the first step");
    int status = spari_fluid_mapped(fluid, SPAR_NODES_FORCE, caller, &s);
    if (status != SPAR_OK) {
        note_refusal(fluid, status, session->message);
        return status;
    }
    if (!s) {
        if (force.d || force.f) {
            spari_fluid_warn_no_force_nodes(fluid);
        }
        return SPAR_OK;
    }
    status = push(fluid, s, force, moment, caller);
    if (status != SPAR_OK) {
        note_refusal(fluid, status, session->message);
        return status;
    }
    spari_fluid_forget_refusal(fluid);
    fluid->pushes++;
    if (session->state.phase == SPARI_IDLE) {
        spari_fluid_keep_loads(fluid);
    }
    keep_forces(fluid, force);
    return SPAR_OK;
}

/* Factor of a ramp at t^n + theta dt */
static double ramp_at(const spar_fluid *fluid, double theta) {
    const spar_session *s = fluid->member->session;
    double ahead = s->state.phase == SPARI_IDLE || s->state.static_solution ? 0 : theta * s->clock.dt;
    double part = (s->clock.time + ahead - fluid->options.ramp_start) / fabs(fluid->options.ramp);
    part = fmax(0, fmin(1, part));
    return fluid->options.ramp > 0 ? part : 1 - part;
}

/* Multiplies force and moment by the factor of the option ramp: in a copy, which the caller frees. Nodes that are not
   mapped are refused later. */
static int ramp_loads(spar_fluid *fluid, double theta, spari_source load[2], double **copy, const char *caller) {
    const spari_node_set *set = spari_fluid_set(fluid, SPAR_NODES_FORCE);
    double factor = fluid->options.ramp == 0 ? 1 : ramp_at(fluid, theta);
    *copy = NULL;
    if (factor == 1 || set->pending || !set->nodes || set->nodes->n == 0) {
        return SPAR_OK;
    }
    int64_t n = set->nodes->n;
    *copy = spari_zalloc(6 * n, sizeof **copy);
    if (!*copy) {
        int status = spari_fluid_refuse(fluid, SPAR_ERR_MEMORY, caller, "no memory for the ramp of its loads");
        note_refusal(fluid, status, fluid->member->session->message);
        return status;
    }
    for (int k = 0; k < 2; k++) {
        double *to = *copy + 3 * n * k;
        if (load[k].d || load[k].f) {
            for (int64_t i = 0; i < 3 * n; i++) {
                to[i] = factor * spari_source_at(load[k], i / 3, (int)(i % 3));
            }
            load[k] = (spari_source){.d = to};
        }
    }
    return SPAR_OK;
}

static int push_forces(spar_fluid *fluid, spari_source force, spari_source moment, const char *caller) {
    spari_source load[2] = {force, moment};
    double *copy;
    SPARI_TRY(ramp_loads(fluid, 1, load, &copy, caller));
    int status = push_loads(fluid, load[0], load[1], caller);
    free(copy);
    SPARI_TRY(status);
    if (fluid->parts) {
        spari_parts_begin(fluid);
        fluid->parts->plain = 1;
    }
    return SPAR_OK;
}

int spar_fluid_push_forces(spar_fluid *fluid, const double *force, const double *moment) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    const spari_layout *layout = spari_fluid_layout(fluid, SPAR_NODES_FORCE);
    const spari_source f = {.d = force, .layout = layout}, m = {.d = moment, .layout = layout};
    return push_forces(fluid, f, m, __func__);
}

int spar_fluid_push_forces_f32(spar_fluid *fluid, const float *force, const float *moment) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    const spari_layout *layout = spari_fluid_layout(fluid, SPAR_NODES_FORCE);
    const spari_source f = {.f = force, .layout = layout}, m = {.f = moment, .layout = layout};
    return push_forces(fluid, f, m, __func__);
}

/* The loads in use, from the mean of the parts and the end of the line. slope: 1/2, or 0. */
static void combine_parts(spar_fluid *fluid, double slope) { /* (T13) */
    const spari_parts *p = fluid->parts;
    const double *begin = p->ended ? p->end[0] : fluid->load_accepted;
    for (int64_t i = 0; i < 6 * fluid->member->nodes; i++) {
        fluid->load[i] = p->mean[i] + slope * (p->end[1][i] - begin[i]);
    }
}

/* The same for reproducible sums. Accepted loads that are not of parts have even sums, because the host pushed them. */
static void combine_bins(spar_fluid *fluid, int with_slope) {
    int begin = fluid->parts->ended ? SPARI_OF_BEGIN : SPARI_OF_ACCEPTED;
    for (int64_t i = 0; i < 6 * fluid->member->nodes; i++) {
        spari_bins *sum = fluid->bins[SPARI_OF_PUSHED] + i;
        *sum = fluid->bins[SPARI_OF_MEAN][i];
        if (with_slope) {
            spari_bins_merge_half(sum, fluid->bins[SPARI_OF_END] + i, 1);
            spari_bins_merge_half(sum, fluid->bins[begin] + i, -1);
        }
        fluid->load[i] = 0.5 * spari_bins_value(sum);
    }
}

/* Stores the end of the parts at theta in end[1], and the load in use in the fluid. After a refusal nothing has
   changed. */
static int push_parts(spar_fluid *fluid, const spari_nodes *s, double theta, const char *caller) {
    spari_parts *p = fluid->parts;
    const spari_source force = {.d = p->value[0]}, moment = {.d = p->moment_next ? p->value[1] : NULL};
    int64_t n = 6 * fluid->member->nodes;
    spari_parts_see(p, theta, 0);
    int status = gather_loads(fluid, s, force, moment, NULL, caller);
    if (status != SPAR_OK) {
        note_refusal(fluid, status, fluid->member->session->message);
        return status;
    }
    memcpy(p->mean, fluid->load_new, (size_t)n * sizeof *p->mean);
    spari_parts_see(p, theta, 1);
    swap_bins(fluid, SPARI_OF_MEAN, SPARI_OF_NEXT);
    SPARI_TRY(push_loads(fluid, force, moment, caller));
    memcpy(p->end[1], fluid->load, (size_t)n * sizeof *p->end[1]);
    int moves = !fluid->member->session->state.static_solution; /* a static solution has no end of a step */
    if (fluid->bins[SPARI_OF_PUSHED]) {
        memcpy(fluid->bins[SPARI_OF_END], fluid->bins[SPARI_OF_PUSHED], (size_t)n * sizeof(spari_bins));
        combine_bins(fluid, moves);
    } else {
        combine_parts(fluid, moves ? 0.5 : 0);
    }
    spari_parts_keep(p, theta);
    return SPAR_OK;
}

int spar_fluid_push_forces_at(spar_fluid *fluid, double theta, const double *force, const double *moment) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_FLUID_REQUIRE(fluid, theta > 0 && theta <= 1, SPAR_ERR_ARGUMENT, "theta is %g; give a number in (0, 1]",
                        theta);
    SPARI_FLUID_REQUIRE(fluid, fluid->member->session->state.phase != SPARI_IDLE, SPAR_ERR_STATE,
                        "no step is in progress; these loads are pushed between spar_step_begin and spar_step_accept");
    const spari_nodes *s;
    SPARI_TRY(spari_fluid_mapped(fluid, SPAR_NODES_FORCE, __func__, &s));
    if (!s) {
        if (force) {
            spari_fluid_warn_no_force_nodes(fluid);
        }
        return SPAR_OK;
    }
    SPARI_FLUID_REQUIRE(fluid, s->n == 0 || force, SPAR_ERR_ARGUMENT,
                        "the force array is NULL though there are force nodes");
    int moments = (fluid->member->effects & SPAR_EFFECT_FLUID_MOMENT) != 0;
    const spari_layout *layout = spari_fluid_layout(fluid, SPAR_NODES_FORCE);
    spari_source load[2] = {{.d = force, .layout = layout}, {.d = moments ? moment : NULL, .layout = layout}};
    double *copy, before = fluid->parts && theta > fluid->parts->theta ? fluid->parts->theta : 0;
    SPARI_TRY(ramp_loads(fluid, 0.5 * (before + theta), load, &copy, __func__));
    int failed = spari_parts_add(fluid, s->n, theta, load[0], load[1]);
    free(copy);
    SPARI_FLUID_REQUIRE(fluid, failed == SPAR_OK, failed, "no memory for loads over parts of a step");
    return push_parts(fluid, s, theta, __func__);
}

int spar_fluid_get_audit(const spar_fluid *fluid, int64_t capacity, double *audit) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_FLUID_REQUIRE(fluid, capacity >= 0 && capacity <= SPARI_MOST, SPAR_ERR_ARGUMENT,
                        "capacity is %lld; give the length of the array, 0 to 2^40", (long long)capacity);
    spari_fill(capacity, audit, SPAR_AUDIT_COUNT, fluid->audit);
    return SPAR_OK;
}

/* ---- for the session ---- */

int spari_fluid_node_load(const spar_fluid *fluid, int64_t i, double load[6]) {
    if (fluid->load) {
        memcpy(load, fluid->load + 6 * i, 6 * sizeof *load);
    }
    return fluid->load != NULL;
}

int spari_fluid_keep(spar_fluid *fluid, int order) {
    spari_history *h = fluid->history;
    return h ? spari_history_keep(h->past, 3 * h->n, order) : SPAR_OK;
}

void spari_fluid_begin(spar_fluid *fluid, int order, double dt, const double dt_last[2]) {
    spari_history *h = fluid->history;
    double w[3];
    spari_fluid_forget_refusal(fluid);
    spari_parts_begin(fluid);
    spari_states_begin(fluid->states);
    fluid->asked |= fluid->asked & SPARI_ASKED_LOADS ? SPARI_HAD_LOADS : 0;
    if (!h) {
        return;
    }
    h->pushed = 0;
    order = order < h->known ? order : h->known > 0 ? h->known - 1 : 0;
    spari_predictor(order, dt, dt_last, w);
    for (int64_t i = 0; i < 3 * h->n; i++) {
        h->after[i] = w[0] * h->past[0][i];
        for (int k = 1; k <= order; k++) {
            h->after[i] += w[k] * h->past[k][i];
        }
    }
}

void spari_fluid_commit_state(spar_fluid *fluid) {
    spari_history *h = fluid->history;
    spari_fluid_forget_refusal(fluid);
    spari_parts_begin(fluid);
    if (fluid->parts) {
        fluid->parts->ended = 0;
    }
    spari_fluid_keep_loads(fluid);
    spari_states_accept(fluid->states);
    if (h && h->n > 0 && spari_history_is_known(h)) {
        keep_past(h);
    }
}

void spari_fluid_accept(spar_fluid *fluid) {
    spari_history *h = fluid->history;
    spari_fluid_forget_refusal(fluid);
    spari_parts_accept(fluid);
    spari_fluid_keep_loads(fluid);
    spari_states_accept(fluid->states);
    spari_fluid_warn_step(fluid);
    if (!h || h->n == 0) {
        return;
    }
    size_t size = sizeof *h->after * 3 * (size_t)h->n;
    h->known += spari_history_is_known(h) && h->known < SPARI_MOST_PAST;
    if (!h->pushed) { /* loads that were not pushed stay unchanged */
        memcpy(h->after, h->past[0], size);
    }
    spari_history_shift(h->past, 3 * h->n, fluid->member->session->coupling.predictor, h->after);
}

void spari_fluid_reject(spar_fluid *fluid) {
    spari_history *h = fluid->history;
    spari_fluid_forget_refusal(fluid);
    spari_parts_begin(fluid);
    fluid->asked &= fluid->asked & SPARI_HAD_LOADS ? ~0 : ~SPARI_ASKED_LOADS;
    spari_fluid_revert_loads(fluid);
    spari_states_begin(fluid->states);
    if (h) {
        h->pushed = 0;
    }
    if (h && h->n > 0) {
        memcpy(h->after, h->past[0], sizeof *h->after * 3 * (size_t)h->n);
    }
}
