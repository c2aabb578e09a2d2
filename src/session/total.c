/* What the loads of a fluid come to over all ranks. */
#include "../base/quiet.h"
#include "../comm/enter.h"
#include "../fluid/fluid.h"
#include "../math/rotation.h"
#include "lend.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Force and moment about the point, of what this rank has pushed, on the structure where it is now. */
static int sum_total(const spar_fluid *fluid, const double point[3], const char *call, double total[6]) {
    const spar_member *m = spari_fluid_member(fluid);
    for (int64_t i = 0; i < (m->committed ? m->nodes : 0); i++) {
        double load[6], arm[3], moment[3];
        if (!spari_fluid_node_load(fluid, i, load)) {
            break;
        }
        for (int k = 0; k < 3; k++) {
            arm[k] = m->xr[3 * i + k] + m->after.q[7 * i + k] - point[k];
        }
        spari_cross(arm, load, moment);
        for (int k = 0; k < 3; k++) {
            total[k] += load[k];
            total[3 + k] += moment[k] + load[3 + k];
        }
    }
    SPARI_REQUIRE(m->session, spari_first_nonfinite(total, 6) < 0, SPAR_ERR_NUMERIC,
                  "%s: fluid '%s': the sum is too large for a double; check the unit of the loads", call,
                  spar_fluid_get_name(fluid));
    return SPAR_OK;
}

int spar_fluid_get_total(const spar_fluid *fluid, const double point[3], double force[3], double moment[3]) {
    SPARI_QUIET;
    static const double origin[3] = {0, 0, 0};
    SPARI_REQUIRE(NULL, fluid, SPAR_ERR_ARGUMENT, "%s: the fluid is NULL; create it with spar_fluid_create", __func__);
    const spar_member *m = spari_fluid_member(fluid);
    spar_session *s = m->session;
    SPARI_TRY(spari_lend_refuse(s, __func__));
    const double *about = point ? point : origin;
    const spari_alike alike[] = {spari_real("point (x)", about[0]), spari_real("point (y)", about[1]),
                                 spari_real("point (z)", about[2])};
    double total[7] = {0}; /* and the ranks' status */
    char what[SPARI_MESSAGE_SIZE / 2];
    (void)snprintf(what, sizeof what, "%s: fluid '%s' of member '%s'", __func__, spar_fluid_get_name(fluid), m->name);
    int status = isfinite(about[0]) && isfinite(about[1]) && isfinite(about[2])
                     ? sum_total(fluid, about, __func__, total)
                     : spari_fail(s, SPAR_ERR_ARGUMENT, "%s: the point is (%g, %g, %g); give finite numbers", what,
                                  about[0], about[1], about[2]);
    SPARI_TRY(spari_enter_alike(s, what, alike, 3, status));
    SPARI_TRY(spari_named(s, __func__, spari_comm_sum(s->comm, total, 6, SPAR_OK, s->message, sizeof s->message)));
    if (force) {
        memcpy(force, total, 3 * sizeof *force);
    }
    if (moment) {
        memcpy(moment, total + 3, 3 * sizeof *moment);
    }
    return SPAR_OK;
}
