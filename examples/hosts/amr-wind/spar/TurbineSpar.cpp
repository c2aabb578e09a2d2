// The actuator models TurbineSparLine and TurbineSparDisk.
#include "amr-wind/wind_energy/actuator/turbine/spar/TurbineSpar.H"
#include "amr-wind/wind_energy/actuator/turbine/spar/turbine_spar_ops.H"
#include "amr-wind/wind_energy/actuator/ActuatorModel.H"

namespace amr_wind::actuator {

template class ActModel<TurbineSpar, ActSrcLine>;
template class ActModel<TurbineSpar, ActSrcDisk>;

} // namespace amr_wind::actuator

namespace ext_turb {
template <>
std::string ext_id<SparTurbine>()
{
    return "TurbineSpar";
}
template <>
std::string ext_id<SparSolverData>()
{
    return "Spar";
}
} // namespace ext_turb
