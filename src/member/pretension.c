/* Pretension of a beam: section forces of its reference configuration, given by the host. They are added to the
   section forces at quadrature points (stiffness_damping_lanes.h). So forces, energy, tangent (geometric stiffness),
   modes and linear members include them. */
#include "../base/environment.h"
#include "beam.h"
#include "check_arguments.h"

int spar_beam_set_pretension(spar_member *beam, int64_t n, const double *eta, const double *force) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_beam(beam, __func__));
    SPARI_TRY(spari_need_stations(beam, __func__, n, SPARI_MOST_STATIONS, eta, SPARI_INCREASING, "force", 6, force));
    return spari_line_table_set(beam, __func__, "pretension", n, 6, eta, force, &beam->beam->pretension);
}

int spar_beam_get_pretension(const spar_member *beam, int64_t *n, int64_t capacity, double *eta, double *force) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_TRY(spari_need_any_beam(beam, __func__));
    return spari_line_table_get(beam, __func__, 6, &beam->beam->pretension, capacity, n, eta, force);
}
