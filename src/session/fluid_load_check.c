/* Total loads of a fluid over all ranks, and their comparison with the host's values. */
#include "../base/environment.h"
#include "../comm/enter.h"
#include "../fluid/fluid.h"
#include "../math/rotation.h"
#include "callbacks.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Sums over the ranks of a fluid's pushed loads: force, moment about a point, and sums of the sizes of nodal forces
   and moments. */
enum { TOTAL_MOMENT = 3, TOTAL_FORCE_PARTS = 6, TOTAL_MOMENT_PARTS, TOTALS };

/* This rank's pushed loads at the present configuration. */
static int add_loads(const spar_fluid *fluid, const double point[3], const char *call, double total[TOTALS]) {
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
            total[TOTAL_MOMENT + k] += moment[k] + load[3 + k];
        }
        total[TOTAL_FORCE_PARTS] += spari_norm(load);
        total[TOTAL_MOMENT_PARTS] += spari_norm(moment) + spari_norm(load + 3);
    }
    SPARI_REQUIRE(m->session, spari_first_nonfinite(total, TOTALS) < 0, SPAR_ERR_NUMERIC,
                  "%s: fluid '%s': the sum is too large for a double; check the unit of the loads", call,
                  spar_fluid_get_name(fluid));
    return SPAR_OK;
}

/* Collective. point NULL: the origin. claim[count]: further arguments that must agree. */
static int sum_over_ranks(const spar_fluid *fluid, const char *call, const double *point, const spari_agreed *claim,
                          int count, int status, double total[TOTALS + 1]) {
    static const double origin[3] = {0, 0, 0};
    const spar_member *m = spari_fluid_member(fluid);
    spar_session *s = m->session;
    const double *about = point ? point : origin;
    spari_agreed must_agree[16] = {spari_real("point (x)", about[0]), spari_real("point (y)", about[1]),
                                   spari_real("point (z)", about[2])};
    for (int i = 0; i < count; i++) {
        must_agree[3 + i] = claim[i];
    }
    memset(total, 0, (TOTALS + 1) * sizeof *total);
    char what[SPARI_MESSAGE_SIZE / 2];
    (void)snprintf(what, sizeof what, "%s: fluid '%s' of member '%s'", call, spar_fluid_get_name(fluid), m->name);
    if (status == SPAR_OK && spari_first_nonfinite(about, 3) >= 0) {
        status = spari_fail(s, SPAR_ERR_ARGUMENT, "%s: the point is (%g, %g, %g); give finite numbers", what, about[0],
                            about[1], about[2]);
    }
    status = status == SPAR_OK ? add_loads(fluid, about, call, total) : status;
    SPARI_TRY(spari_enter_agreed(s, what, must_agree, 3 + count, status));
    return spari_named(s, call, spari_sum(s, total, TOTALS));
}

int spar_fluid_sum_loads(const spar_fluid *fluid, const double point[3], double force[3], double moment[3]) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, fluid, SPAR_ERR_ARGUMENT, "%s: the fluid is NULL; create it with spar_fluid_create", __func__);
    SPARI_TRY(spari_callback_refuse(spari_fluid_member(fluid)->session, __func__));
    double total[TOTALS + 1];
    SPARI_TRY(sum_over_ranks(fluid, __func__, point, NULL, 0, SPAR_OK, total));
    spari_give(force, total, 3);
    spari_give(moment, total + TOTAL_MOMENT, 3);
    return SPAR_OK;
}

/* ---- comparison with the host's values ---- */

static int check_claim(const spar_fluid *fluid, const char *call, const double *force, const double *moment,
                       double rtol) {
    spar_session *s = spari_fluid_member(fluid)->session;
    const char *name = spar_fluid_get_name(fluid);
    SPARI_REQUIRE(s, force, SPAR_ERR_ARGUMENT, "%s: fluid '%s': the force is NULL", call, name);
    SPARI_REQUIRE(s, spari_first_nonfinite(force, 3) < 0, SPAR_ERR_ARGUMENT,
                  "%s: fluid '%s': the force is (%g, %g, %g); give finite numbers", call, name, force[0], force[1],
                  force[2]);
    SPARI_REQUIRE(s, !moment || spari_first_nonfinite(moment, 3) < 0, SPAR_ERR_ARGUMENT,
                  "%s: fluid '%s': the moment has an entry that is not finite; give finite numbers", call, name);
    SPARI_REQUIRE(s, isfinite(rtol) && rtol > 0, SPAR_ERR_ARGUMENT,
                  "%s: fluid '%s': rtol is %g; give a number above 0, such as 1e-9", call, name, rtol);
    return SPAR_OK;
}

static int compare(const spar_fluid *fluid, const char *call, const char *what, const double *pushed, double parts,
                   const double *claim, double rtol) {
    const spar_member *m = spari_fluid_member(fluid);
    double off[3], size = parts > spari_norm(claim) ? parts : spari_norm(claim);
    for (int k = 0; k < 3; k++) {
        off[k] = pushed[k] - claim[k];
    }
    SPARI_REQUIRE(m->session, spari_norm(off) <= rtol * size, SPAR_ERR_ARGUMENT,
                  "%s: fluid '%s' of member '%s': the %s pushed on all ranks sum to (%.9g, %.9g, %.9g), the host's "
                  "total is (%.9g, %.9g, %.9g); relative difference %.3g (rtol %.3g); push each force node on a rank "
                  "boundary from exactly one rank",
                  call, spar_fluid_get_name(fluid), m->name, what, pushed[0], pushed[1], pushed[2], claim[0], claim[1],
                  claim[2], spari_norm(off) / size, rtol);
    return SPAR_OK;
}

int spar_fluid_check_loads(const spar_fluid *fluid, const double point[3], const double force[3],
                           const double moment[3], double rtol) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, fluid, SPAR_ERR_ARGUMENT, "%s: the fluid is NULL; create it with spar_fluid_create", __func__);
    SPARI_TRY(spari_callback_refuse(spari_fluid_member(fluid)->session, __func__));
    static const double none[3] = {0, 0, 0};
    const double *f = force ? force : none, *t = moment ? moment : none;
    const spari_agreed claim[] = {spari_real("force (x)", f[0]),  spari_real("force (y)", f[1]),
                                  spari_real("force (z)", f[2]),  spari_real("moment (x)", t[0]),
                                  spari_real("moment (y)", t[1]), spari_real("moment (z)", t[2]),
                                  spari_real("rtol", rtol),       spari_given("moment", moment != NULL)};
    double total[TOTALS + 1];
    SPARI_TRY(sum_over_ranks(fluid, __func__, point, claim, sizeof claim / sizeof *claim,
                             check_claim(fluid, __func__, force, moment, rtol), total));
    SPARI_TRY(compare(fluid, __func__, "forces", total, total[TOTAL_FORCE_PARTS], f, rtol));
    return moment ? compare(fluid, __func__, "moments", total + TOTAL_MOMENT, total[TOTAL_MOMENT_PARTS], t, rtol)
                  : SPAR_OK;
}
