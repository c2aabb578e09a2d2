/* Points and external members: the host gives their motion. A point may also be driven like a root. */
#include "../time/fidelity.h"

#include <string.h>

static int host_advance(spar_member *m, double dt) {
    const spari_pose *to = &m->drive[1];
    (void)dt; /* where it goes is given */
    if (m->kind == SPARI_POINT && !m->state.motion_given && !m->external && m->state.drive_given) {
        memcpy(m->after.q, to->q, sizeof to->q);
        memcpy(m->after.v, to->v, sizeof to->v);
        memcpy(m->after.a, to->a, sizeof to->a);
    }
    return SPAR_OK;
}

const spari_fidelity spari_fidelity_given = {
    .frame = SPARI_FRAME_INERTIAL,
    .advance = host_advance,
};
