/* A cylinder of D = 1 m and 1 m of span on a spring across the stream of U = 1 m/s: mass M, reduced velocity
   U / (f D) = 4 in vacuo. It starts across the stream at 0.05 m/s, so that its vortices are shed soon. */
#include "spar_saturne.h"
#include <math.h>

static int describe(spar_session *session, spar_member **wet) {
    const double m = saturne_number("MASS", 2), omega = 2 * acos(-1.) / saturne_number("REDUCED_VELOCITY", 4);
    const double at[3] = {0, 0, 0.5}, across[3] = {0, 0.05, 0}, stiffness[36] = {[7] = m * omega * omega};
    const double mass[36] = {[0] = m, [7] = m, [14] = m, [21] = m, [28] = m, [35] = m};
    int status = spar_rigid_create(session, "cylinder", at, NULL, mass, wet);
    status = status == SPAR_OK ? spar_member_set_initial_velocity(*wet, at, across, NULL) : status;
    status = status == SPAR_OK ? spar_member_commit(*wet) : status;
    return status == SPAR_OK ? spar_member_set_spring(*wet, 0, SPAR_FREE_Y, stiffness, NULL, NULL, NULL) : status;
}

const saturne_case saturne_this_case = {"4", "4", 1, describe};
