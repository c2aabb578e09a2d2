/* The host's own numbers at a fluid's force nodes: state of its model, saved and restored with the fluid's loads. */
#include "../base/environment.h"
#include "state.h"

#include <string.h>

static void copy_states(double *to, const double *from, int64_t count) {
    if (count > 0) {
        memcpy(to, from, (size_t)count * sizeof *to);
    }
}

int spar_fluid_set_states(spar_fluid *fluid, int64_t width) {
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(spari_fluid_check_idle(fluid, __func__));
    SPARI_FLUID_REQUIRE(fluid, width >= 0 && width <= SPARI_MOST_STATES, SPAR_ERR_ARGUMENT,
                        "%lld states per node; give 0 to %d", (long long)width, SPARI_MOST_STATES);
    if (width == (fluid->states ? fluid->states->width : 0)) {
        return SPAR_OK;
    }
    const spari_nodes *s = spari_fluid_set(fluid, SPAR_NODES_FORCE)->nodes;
    spari_states *made = width > 0 ? spari_states_create(s ? s->n : 0, width) : NULL;
    SPARI_FLUID_REQUIRE(fluid, made || width == 0, SPAR_ERR_MEMORY, "no memory for %lld states per node",
                        (long long)width);
    spari_states_free(fluid->states);
    fluid->states = made;
    return SPAR_OK;
}

int spar_fluid_get_states(const spar_fluid *fluid, int64_t *width, double *dt) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    const spar_session *s = fluid->member->session;
    SPARI_GIVE(width, fluid->states ? fluid->states->width : 0);
    SPARI_GIVE(dt, s->state.phase == SPARI_IDLE || s->state.static_solution ? 0 : s->clock.dt);
    return SPAR_OK;
}

/* Whether numbers of this width can be pushed and pulled now. *states NULL: none. */
static int check_states(const spar_fluid *fluid, int64_t width, int has_place, spari_states **states,
                        const char *caller) {
    const spari_nodes *s;
    SPARI_TRY(spari_fluid_mapped(fluid, SPAR_NODES_FORCE, caller, &s));
    int64_t kept = fluid->states ? fluid->states->width : 0;
    SPARI_FLUID_REQUIRE_OF(fluid, caller, width == kept, SPAR_ERR_ARGUMENT,
                           "%lld states per node, but %lld are set; see spar_fluid_set_states", (long long)width,
                           (long long)kept);
    *states = s && kept > 0 && s->n > 0 ? fluid->states : NULL;
    SPARI_FLUID_REQUIRE_OF(fluid, caller, !*states || has_place, SPAR_ERR_ARGUMENT, "the array is NULL");
    return SPAR_OK;
}

int spar_fluid_pull_states(const spar_fluid *fluid, int64_t width, double *states) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    spari_states *t = NULL;
    SPARI_TRY(check_states(fluid, width, states != NULL, &t, __func__));
    if (t) {
        copy_states(states, t->now, t->n * t->width);
    }
    return SPAR_OK;
}

int spar_fluid_push_states(spar_fluid *fluid, int64_t width, const double *states) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    const spar_session *session = fluid->member->session;
    int idle = session->state.phase == SPARI_IDLE;
    SPARI_FLUID_REQUIRE(fluid, !idle || !session->clock.started, SPAR_ERR_STATE,
                        "no step is in progress; states are pushed between spar_step_begin and spar_step_accept, or "
                        "before the first step");
    spari_states *t = NULL;
    SPARI_TRY(check_states(fluid, width, states != NULL, &t, __func__));
    if (!t) {
        return SPAR_OK;
    }
    SPARI_TRY(spari_fluid_check_values(fluid, __func__, "state of node", states, t->n, (int)width));
    copy_states(idle ? t->now : t->next, states, t->n * t->width);
    t->pushed = !idle;
    return SPAR_OK;
}
