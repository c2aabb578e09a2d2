/* A step with prescribed motion of all members: see prescribed_step.h. */
#include "prescribed_step.h"

#include "../comm/enter.h"
#include "../exchange/rank_loads_and_motion.h"
#include "../fluid/fluid.h"
#include "../member/structure.h"
#include "callbacks.h"

#include <string.h>

static void end_forced(spar_session *s, double dt) {
    for (spar_member *m = s->members; m; m = m->next) {
        memcpy(m->now.q, m->after.q, (size_t)m->nodes * 7 * sizeof(double));
        memcpy(m->now.v, m->after.v, (size_t)m->nodes * 6 * sizeof(double));
        memcpy(m->now.a, m->after.a, (size_t)m->nodes * 6 * sizeof(double));
        m->state.motion_given = m->state.drive_given = 0;
    }
    spari_fluids_each(s, spari_fluid_accept);
    spari_clock_tick(&s->clock, dt);
    s->clock.step++;
    s->clock.dt_last[1] = s->clock.dt_last[0];
    s->clock.dt_last[0] = dt;
    s->state.phase = SPARI_IDLE;
}

int spari_forced_step(spar_session *s, const char *call, double dt, spar_fluid_solver solve, void *context) {
    for (spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        spari_fluid_begin(f, 0, dt, s->clock.dt_last);
    }
    s->clock.dt = dt;
    s->state.order = s->state.iteration = s->state.iterating = s->state.failed = 0;
    s->clock.started = 1;
    s->state.phase = SPARI_SOLVED;
    int status = spari_callback_run(s, call, solve, dt, context);
    if (status == SPAR_ERR_COMM) {
        return status;
    }
    status = status == SPAR_OK ? spari_session_pushes(s, call) : status;
    SPARI_TRY(spari_enter(s, call, status));
    SPARI_TRY(spari_session_exchange_loads(s, NULL));
    for (spar_member *m = s->members; m; m = m->next) {
        spari_session_take_loads(s, m, m->load.pushed);
    }
    end_forced(s, dt);
    return SPAR_OK;
}
