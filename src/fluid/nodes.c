/* Fluids and their nodes: create, describe, destroy. */
#include "../base/environment.h"
#include "fluid.h"

#include "../math/predictor.h"
#include "state.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int spari_fluid_refuse(const spar_fluid *fluid, int status, const char *caller, const char *format, ...) {
    char text[SPARI_MESSAGE_SIZE];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    return spari_fail(fluid->member->session, status, "%s: fluid '%s' of member '%s': %s", caller, fluid->name,
                      fluid->member->name, text);
}
/* ---- create and destroy ---- */

int spar_fluid_create(spar_member *member, const char *name, spar_fluid **fluid) {
    SPARI_REQUIRE(NULL, member, SPAR_ERR_ARGUMENT, "%s: the member is NULL; create it first", __func__);
    spar_session *session = member->session;
    SPARI_REQUIRE(session, fluid, SPAR_ERR_ARGUMENT, "%s: member '%s': the pointer to the handle is NULL", __func__,
                  member->name);
    SPARI_REQUIRE(session, !session->state.trial, SPAR_ERR_STATE,
                  "%s: member '%s': a trial run is in progress; create fluids before or after it", __func__,
                  member->name);
    SPARI_REQUIRE(session, name && name[0], SPAR_ERR_ARGUMENT,
                  "%s: member '%s': the fluid needs a name; messages use it", __func__, member->name);
    spar_fluid *made = spari_zalloc(1, sizeof *made);
    char *copy = spari_zalloc((int64_t)strlen(name) + 1, 1);
    if (!made || !copy) {
        SPARI_FREE(made, copy);
        return spari_fail(session, SPAR_ERR_MEMORY, "%s: member '%s': no memory for a fluid", __func__, member->name);
    }
    strcpy(copy, name);
    made->member = member, made->name = copy;
    made->before = session->last_fluid; /* appended: loads are added in order of creation */
    *(made->before ? &made->before->next : &session->fluids) = made;
    session->last_fluid = made;
    *fluid = made;
    return SPAR_OK;
}

void spari_node_set_clear(spari_node_set *set) {
    SPARI_FREE(set->x, set->eta, set->frame, set->weight, set->home);
    spari_fade_free(set->fade);
    spari_nodes_free(set->nodes);
    *set = (spari_node_set){0};
}

void spari_history_free(spari_history *h) {
    if (!h) {
        return;
    }
    free(h->after);
    for (int i = 0; i < 3; i++) {
        free(h->past[i]);
    }
    free(h);
}

void spari_taking_free(spari_taking *t) {
    if (!t) {
        return;
    }
    spari_history_free(t->history);
    spari_states_free(t->states);
    SPARI_FREE(t->load[0], t->load[1], t->bins[0], t->bins[1], t->positions, t->sorted, t->found, t);
}

spari_history *spari_history_create(int64_t n, int order) {
    spari_history *h = spari_zalloc(1, sizeof *h);
    if (!h) {
        return NULL;
    }
    h->n = n;
    h->known = SPARI_MOST_PAST;
    h->after = spari_zalloc(3 * n, sizeof *h->after);
    if (!h->after || spari_history_keep(h->past, 3 * n, order) != SPAR_OK) {
        spari_history_free(h);
        return NULL;
    }
    return h;
}

void spari_states_free(spari_states *t) {
    if (t) {
        SPARI_FREE(t->now, t->next);
    }
    free(t);
}

spari_states *spari_states_create(int64_t n, int64_t width) {
    spari_states *t = spari_zalloc(1, sizeof *t);
    if (!t) {
        return NULL;
    }
    t->n = n;
    t->width = width;
    t->now = spari_zalloc(n * width, sizeof *t->now);
    t->next = spari_zalloc(n * width, sizeof *t->next);
    if (!t->now || !t->next) {
        spari_states_free(t);
        return NULL;
    }
    return t;
}

spari_states *spari_states_copy(const spari_states *from) {
    spari_states *t = spari_states_create(from->n, from->width);
    if (t) {
        t->pushed = from->pushed;
        size_t size = (size_t)(t->n * t->width) * sizeof *t->now;
        if (size > 0) {
            memcpy(t->now, from->now, size);
            memcpy(t->next, from->next, size);
        }
    }
    return t;
}

void spari_states_begin(spari_states *t) {
    if (t) {
        t->pushed = 0;
    }
}

void spari_states_accept(spari_states *t) {
    if (t && t->pushed) {
        double *was = t->now;
        t->now = t->next, t->next = was;
        t->pushed = 0;
    }
}

void spari_fluid_free(spar_fluid *fluid) {
    if (!fluid) {
        return;
    }
    spari_node_set_clear(&fluid->set[0]);
    spari_node_set_clear(&fluid->set[1]);
    spari_history_free(fluid->history);
    spari_states_free(fluid->states);
    spari_taking_free(fluid->taking);
    spari_parts_free(fluid->parts);
    spari_fluid_drop_bins(fluid);
    SPARI_FREE(fluid->modal, fluid->field[0], fluid->field[1], fluid->reference, fluid->load, fluid->load_new,
               fluid->load_accepted, fluid->why, fluid->name, fluid);
}

void spari_fluid_forget_refusal(spar_fluid *fluid) {
    free(fluid->why);
    fluid->why = NULL;
    fluid->refused = SPAR_OK;
}

static void take_out(spar_fluid *fluid) {
    spar_session *session = fluid->member->session;
    *(fluid->before ? &fluid->before->next : &session->fluids) = fluid->next;
    *(fluid->next ? &fluid->next->before : &session->last_fluid) = fluid->before;
    spari_fluid_free(fluid);
}

/* A fluid destroyed during a trial: it has no loads from now on, and is freed when the trial has ended. */
static void fall_silent(spar_fluid *fluid) {
    double *load[] = {fluid->load, fluid->load_new, fluid->load_accepted};
    for (int k = 0; k < 3 && fluid->load; k++) {
        memset(load[k], 0, (size_t)(6 * fluid->member->nodes) * sizeof **load);
    }
    spari_fluid_drop_bins(fluid);
    spari_fluid_forget_refusal(fluid);
    fluid->gone = 1;
}

void spar_fluid_destroy(spar_fluid **fluid) {
    if (!fluid || !*fluid) {
        return;
    }
    if ((*fluid)->member->session->state.trial) {
        fall_silent(*fluid);
    } else {
        take_out(*fluid);
    }
    *fluid = NULL;
}

void spari_fluid_release_gone(spar_session *session) {
    for (spar_fluid *f = session->fluids, *next; f; f = next) {
        next = f->next;
        if (f->gone) {
            take_out(f);
        }
    }
}

spar_fluid *spari_fluid_next(const spar_fluid *fluid) {
    return fluid->next;
}

spar_member *spari_fluid_member(const spar_fluid *fluid) {
    return fluid->member;
}

int spar_fluid_get_member(const spar_fluid *fluid, spar_member **member) {
    SPARI_FLUID_HANDLE(fluid);
    SPARI_FLUID_REQUIRE(fluid, member, SPAR_ERR_ARGUMENT, "the pointer to the member is NULL");
    *member = fluid->member;
    return SPAR_OK;
}

const char *spar_fluid_get_name(const spar_fluid *fluid) {
    return fluid ? fluid->name : "";
}

/* ---- nodes from the host ---- */

int spari_fluid_check_idle(const spar_fluid *fluid, const char *caller) {
    SPARI_FLUID_REQUIRE_OF(fluid, caller, fluid->member->session->state.phase == SPARI_IDLE, SPAR_ERR_STATE,
                           "a step is in progress; change nodes and maps after spar_step_accept or spar_step_reject");
    if (fluid->member->session->state.trial) {
        return spari_fluid_refuse(fluid, SPAR_ERR_STATE, caller,
                                  "a trial run is in progress; change fluids before or after it");
    }
    return SPAR_OK;
}

int spari_fluid_check_values(const spar_fluid *fluid, const char *caller, const char *what, const double *x, int64_t n,
                             int width) {
    int64_t bad = spari_first_nonfinite(x, n * width);
    SPARI_FLUID_REQUIRE_OF(fluid, caller, bad < 0, SPAR_ERR_ARGUMENT,
                           "%s %lld, component %d, is %g; give finite numbers", what, (long long)(bad / width),
                           (int)(bad % width), x[bad]);
    return SPAR_OK;
}

/* Clears one set before it is replaced. Sections that served as both sets stay with the other. */
static void empty_set(spar_fluid *fluid, int which) {
    if (fluid->shared) {
        fluid->shared = 0;
        if (which == SPAR_NODES_MOTION) {
            fluid->set[SPAR_NODES_FORCE] = fluid->set[SPAR_NODES_MOTION];
            fluid->set[SPAR_NODES_MOTION] = (spari_node_set){0};
        }
    }
    spari_node_set_clear(&fluid->set[which]);
    fluid->layout[which] = (spari_layout){0, 0}; /* it was made for their number */
}

/* A copy of x [n], or zeros if NULL. */
static int set_places(spar_fluid *fluid, int which, int64_t n, const double *x, const char *caller) {
    SPARI_TRY(spari_fluid_check_idle(fluid, caller));
    SPARI_FLUID_REQUIRE_OF(fluid, caller, n >= 0 && n <= SPARI_MOST && (n == 0 || x), SPAR_ERR_ARGUMENT,
                           "%lld nodes%s; give 0 to 2^40, and n x 3 coordinates", (long long)n,
                           x ? "" : " without positions");
    SPARI_TRY(
        spari_fluid_check_values(fluid, caller, which == SPAR_NODES_MOTION ? "motion node" : "force node", x, n, 3));
    double *copy = spari_copy(x, 3 * n);
    SPARI_FLUID_REQUIRE_OF(fluid, caller, copy, SPAR_ERR_MEMORY, "no memory for %lld nodes", (long long)n);
    empty_set(fluid, which);
    fluid->set[which] = (spari_node_set){.pending = 1, .n = n, .x = copy};
    return SPAR_OK;
}

int spar_fluid_set_motion_nodes(spar_fluid *fluid, int64_t n, const double *x) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    return set_places(fluid, SPAR_NODES_MOTION, n, x, __func__);
}

int spar_fluid_set_force_nodes(spar_fluid *fluid, int64_t n, const double *x) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    return set_places(fluid, SPAR_NODES_FORCE, n, x, __func__);
}

/* Copies the host's sections, to be mapped later; the fluid is not changed. */
static int copy_sections(const spar_fluid *fluid, int64_t n, const double *eta, const double *offset,
                         spari_node_set *set, const char *caller) {
    SPARI_TRY(spari_fluid_check_idle(fluid, caller));
    SPARI_FLUID_REQUIRE_OF(fluid, caller, n >= 0 && n <= SPARI_MOST && (n == 0 || eta), SPAR_ERR_ARGUMENT,
                           "%lld sections%s; give 0 to 2^40, and n coordinates", (long long)n,
                           eta ? "" : " without coordinates");
    for (int64_t j = 0; j < n; j++) {
        SPARI_FLUID_REQUIRE_OF(fluid, caller, eta[j] >= 0 && eta[j] <= 1, SPAR_ERR_ARGUMENT,
                               "section %lld: eta = %g lies outside [0,1]; give eta, which is 0 at the root "
                               "and 1 at the tip",
                               (long long)j, eta[j]);
    }
    if (offset) {
        SPARI_TRY(spari_fluid_check_values(fluid, caller, "offset of section", offset, n, 3));
    }
    double *copy = spari_copy(offset, 3 * n), *at = spari_copy(eta, n);
    if (!copy || !at) {
        SPARI_FREE(copy, at);
        return spari_fluid_refuse(fluid, SPAR_ERR_MEMORY, caller, "no memory for %lld sections", (long long)n);
    }
    *set = (spari_node_set){.pending = 1, .sections = 1, .n = n, .x = copy, .eta = at};
    return SPAR_OK;
}

int spar_fluid_set_stations(spar_fluid *fluid, int64_t n, const double *eta, const double *offset) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    spari_node_set made;
    SPARI_TRY(copy_sections(fluid, n, eta, offset, &made, __func__));
    for (int which = 0; which < 2; which++) {
        spari_node_set_clear(&fluid->set[which]);
        fluid->layout[which] = (spari_layout){0, 0};
    }
    fluid->shared = 1;
    fluid->set[SPAR_NODES_MOTION] = made;
    return SPAR_OK;
}

int spar_fluid_set_motion_stations(spar_fluid *fluid, int64_t n, const double *eta, const double *offset) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    spari_node_set made;
    SPARI_TRY(copy_sections(fluid, n, eta, offset, &made, __func__));
    empty_set(fluid, SPAR_NODES_MOTION);
    fluid->set[SPAR_NODES_MOTION] = made;
    return SPAR_OK;
}

int spar_fluid_set_projection(spar_fluid *fluid, int method, double max_distance) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(spari_fluid_check_idle(fluid, __func__));
    SPARI_FLUID_REQUIRE(fluid, method == SPAR_PROJECT_BOUNDED || method == SPAR_PROJECT_RPOLY, SPAR_ERR_ARGUMENT,
                        "projection method %d is not known; give SPAR_PROJECT_BOUNDED or SPAR_PROJECT_RPOLY", method);
    SPARI_FLUID_REQUIRE(fluid, !isnan(max_distance), SPAR_ERR_ARGUMENT,
                        "max_distance is not a number; <= 0 means no limit");
    fluid->method = method;
    fluid->max_distance = max_distance;
    return SPAR_OK;
}

int spar_fluid_set_interpolation(spar_fluid *fluid, int kind) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(spari_fluid_check_idle(fluid, __func__));
    SPARI_FLUID_REQUIRE(fluid, kind == SPAR_INTERPOLATE_NODAL || kind == SPAR_INTERPOLATE_CONSISTENT, SPAR_ERR_ARGUMENT,
                        "interpolation %d is not known; give SPAR_INTERPOLATE_NODAL or SPAR_INTERPOLATE_CONSISTENT",
                        kind);
    fluid->consistent = kind == SPAR_INTERPOLATE_CONSISTENT;
    return SPAR_OK;
}

int spar_fluid_get_projection(const spar_fluid *fluid, int *method, double *max_distance) {
    SPARI_FLUID_HANDLE(fluid);
    SPARI_GIVE(method, fluid->method);
    SPARI_GIVE(max_distance, fluid->max_distance);
    return SPAR_OK;
}

int spar_fluid_get_interpolation(const spar_fluid *fluid, int *kind) {
    SPARI_FLUID_HANDLE(fluid);
    SPARI_GIVE(kind, fluid->consistent ? SPAR_INTERPOLATE_CONSISTENT : SPAR_INTERPOLATE_NODAL);
    return SPAR_OK;
}
