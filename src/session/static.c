/* Static equilibrium of one member, in its session. */
#include "../base/quiet.h"
#include "../member/body.h"
#include "../member/edge.h"
#include "../solve/fidelity.h"
#include "../solve/life.h"
#include "exchange.h"

#include <string.h>

/* The motion after of a member that spar solves for, on the rank that does. */
static int solve_member_static(spar_member *m, const double *fluid, int load_steps, int onward) {
    return spari_fidelity_is_here(m) ? m->row->rest(m, fluid, load_steps, onward) : SPAR_OK;
}

int spar_member_solve_static(spar_member *member, int load_steps) {
    SPARI_QUIET;
    SPARI_REQUIRE(NULL, member, SPAR_ERR_ARGUMENT, "%s: the member is NULL; create it first", __func__);
    spar_session *s = member->session;
    int status = SPAR_OK;
    if (!member->committed) {
        status = spari_fail(s, SPAR_ERR_STATE, "%s: member '%s' is not committed; call spar_member_commit first",
                            __func__, member->name);
    } else if (s->phase != SPARI_IDLE) {
        status = spari_fail(s, SPAR_ERR_STATE, "%s: '%s': a step is under way; accept or reject it first", __func__,
                            member->name);
    } else if (load_steps < 1) {
        status = spari_fail(s, SPAR_ERR_ARGUMENT, "%s: '%s': %d load steps; give at least 1", __func__, member->name,
                            load_steps);
    } else if (!member->row->rest) {
        status = spari_fail(s, SPAR_ERR_UNSUPPORTED, "%s: spar does not solve for '%s' (a point, or external)",
                            __func__, member->name);
    } else if (member->root == SPAR_ROOT_FREE ||
               (member->root == SPAR_ROOT_PINNED && member->body && !member->body->C)) {
        status =
            spari_fail(s, SPAR_ERR_STATE, "%s: nothing holds '%s'; fix, pin or drive its root", __func__, member->name);
    }
    if (status == SPAR_OK && !s->started) {
        status = spari_session_pushes(s, __func__);
    }
    const spari_alike alike[] = {spari_whole("load_steps", load_steps)};
    SPARI_TRY(spari_member_enter(member, __func__, alike, 1, status));
    SPARI_TRY(spari_session_seal(s, SPAR_OK));
    memcpy(member->load_before, member->load_pushed, (size_t)(6 * member->nodes) * sizeof(double));
    if (!s->started) {
        SPARI_TRY(spari_session_exchange_loads(s));
        spari_session_take_loads(s, member, member->load_pushed);
    }
    status = solve_member_static(member, member->load_pushed, load_steps, 0);
    status = spari_session_share_motion(s, status);
    if (status != SPAR_OK) {
        spari_member_reject(member);
        memcpy(member->load_pushed, member->load_before, (size_t)(6 * member->nodes) * sizeof(double));
        return spari_named(s, __func__, status);
    }
    member->dissipated_step = 0;
    spari_member_solved(member, member->load_pushed);
    spari_member_settle(member);
    return SPAR_OK;
}
