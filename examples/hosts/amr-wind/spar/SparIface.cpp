// AMR-Wind's calls on a turbine, answered by spar. A turbine is one session of one process: that of its root rank.
#include "amr-wind/wind_energy/actuator/turbine/external/ExtTurbIface.H"
#include "amr-wind/wind_energy/actuator/turbine/spar/spar_types.H"
#include "amr-wind/CFDSim.H"
#include "amr-wind/core/SimTime.H"

#include "AMReX.H"

#include <cmath>

namespace ext_turb {
namespace {

constexpr double degree = 3.14159265358979323846 / 180.0;

// The turbine at t = 0, as the input file has it.
void make_machine(SparTurbine& fi)
{
    if (fi.num_blades != 3 || fi.num_pts_tower != 0) {
        amrex::Abort(
            "SparIface: turbine " + fi.tlabel +
            ": num_blades is 3 and num_points_tower is 0");
    }
    if (actuator_scheme(fi.scheme.c_str()) < 0) {
        amrex::Abort(
            "SparIface: turbine " + fi.tlabel +
            ": spar_scheme is iqn_ils, aitken or fixed_point, not " + fi.scheme);
    }
    actuator_options options;
    actuator_default(&options);
    options.data = fi.data_folder.c_str();
    options.points = fi.num_pts_blade;
    options.whole = fi.whole ? 1 : 0;
    options.nodes = fi.num_nodes_blade;
    options.rpm = static_cast<double>(fi.rotor_speed_rpm);
    options.pitch = static_cast<double>(fi.pitch_deg) * degree;
    options.wind = static_cast<double>(fi.wind_speed);
    options.downwind = (270.0 - static_cast<double>(fi.wind_direction)) * degree;
    options.yaw = static_cast<double>(fi.yaw_deg) * degree;
    options.scheme = actuator_scheme(fi.scheme.c_str());
    options.rtol = static_cast<double>(fi.rtol);
    options.iterations = fi.max_iterations;
    options.accepted = static_cast<double>(fi.accepted);
    options.substeps = fi.structure_substeps;
    options.rho_inf = static_cast<double>(fi.rho_inf);
    options.density = static_cast<double>(fi.fluid_density);
    options.gravity = static_cast<double>(fi.gravity);
    actuator_machine* made = nullptr;
    const int status = actuator_create(&options, &made);
    fi.machine.reset(made);
    fi.check(status);
    // one step of spar for one of the flow, with its own substeps inside
    fi.num_substeps = 1;
    fi.chkpt_interval = -1; // by AMR-Wind's interval alone; see ProcessOutputsOp
    fi.num_blade_elem = fi.num_pts_blade;
    fi.dt_ext = fi.dt_cfd;
    fi.allocate_buffers();
}

// The 1st, 2nd, 4th, 8th ... warning of a turbine.
void warn(SparTurbine& fi)
{
    const char* text = actuator_warning(fi.machine.get());
    if (text[0] == '\0') {
        return;
    }
    const long n = ++fi.num_warnings;
    if ((n & (n - 1)) == 0) {
        amrex::OutStream() << "WARNING: SparIface: turbine " << fi.tlabel
                           << ", warning " << n << ": " << text << std::endl;
    }
}

// Says so where the turbine does not face the wind at its hub, whose velocity is the last.
void compare_directions(const SparTurbine& fi)
{
    const int hub = fi.length_fluid_velocity(0) - 1;
    const auto u = static_cast<double>(fi.fluid_velocity(0)[hub]);
    const auto v = static_cast<double>(fi.fluid_velocity(1)[hub]);
    const double from = 270.0 - std::atan2(v, u) / degree;
    const double faced = static_cast<double>(fi.wind_direction - fi.yaw_deg);
    if (std::hypot(u, v) > 1.0 &&
        std::cos((from - faced) * degree) < std::cos(30.0 * degree)) {
        amrex::OutStream() << "WARNING: SparIface: turbine " << fi.tlabel
                           << " faces " << faced
                           << " degrees, the wind at its hub comes from "
                           << std::fmod(from, 360.0)
                           << " degrees: see spar_wind_direction" << std::endl;
    }
}

} // namespace

template <>
ExtTurbIface<SparTurbine, SparSolverData>::~ExtTurbIface() = default;

// Unit tests alone come here; adaptive steps are fine, see ComputeForceOp.
template <>
void ExtTurbIface<SparTurbine, SparSolverData>::parse_inputs(
    const amr_wind::CFDSim& sim, const std::string& /*inp_name*/)
{
    m_dt_cfd = sim.time().delta_t();
}

template <>
void ExtTurbIface<SparTurbine, SparSolverData>::allocate_ext_turbines()
{
    m_is_initialized = true;
}

// The turbine stands at t^n, the flow there has been sampled. A turbine from a file has its forces already.
template <>
void ExtTurbIface<SparTurbine, SparSolverData>::init_solution(
    const int local_id)
{
    auto& fi = *m_turbine_data[local_id];
    compare_directions(fi);
    if (!fi.is_loaded) {
        fi.check(actuator_start(fi.machine.get(), fi.fluid_velocity(0)));
    }
    fi.check(fi.populate_buffers());
    fi.put_hub_first();
    fi.is_solution0 = false;
}

template <>
void ExtTurbIface<SparTurbine, SparSolverData>::get_hub_stats(
    const int local_id)
{
    auto& fi = *m_turbine_data[local_id];
    double x[3];
    double omega[3];
    double axes[9];
    fi.check(actuator_get_hub(fi.machine.get(), x, omega, axes));
    for (int i = 0; i < 3; ++i) {
        fi.hub_abs_pos[i] = static_cast<float>(x[i]) + fi.base_pos[i];
        fi.hub_rot_vel[i] = static_cast<float>(omega[i]);
    }
    for (int i = 0; i < 9; ++i) {
        fi.hub_orient[i] = static_cast<amrex::Real>(axes[i]);
    }
}

template <>
void ExtTurbIface<SparTurbine, SparSolverData>::do_turbine_step(SparTurbine& fi)
{
    fi.check(actuator_step(
        fi.machine.get(), static_cast<double>(fi.dt_ext),
        fi.fluid_velocity(0)));
    warn(fi);
    fi.check(fi.populate_buffers());
    fi.put_hub_first();
}

template <>
void ExtTurbIface<SparTurbine, SparSolverData>::write_turbine_checkpoint(
    int& tid)
{
    m_turbine_data[tid]->save();
}

template <>
void ExtTurbIface<SparTurbine, SparSolverData>::ext_init_turbine(
    SparTurbine& fi)
{
    fi.check_beginning();
    make_machine(fi);
    fi.check(fi.populate_buffers());
}

// The file's step and time must be the flow's.
template <>
void ExtTurbIface<SparTurbine, SparSolverData>::ext_restart_turbine(
    SparTurbine& fi)
{
    make_machine(fi);
    const int status = actuator_load(
        fi.machine.get(), fi.checkpoint_file.c_str(), fi.time_index,
        static_cast<double>(fi.start_time));
    if (status != SPAR_OK) {
        amrex::Abort(
            "SparIface: turbine " + fi.tlabel + ": " +
            actuator_message(fi.machine.get()) +
            "; spar_restart_file names another file, and spar_sim_mode = init begins a turbine in a flow that had none");
    }
    fi.is_loaded = true;
    fi.check(fi.populate_buffers());
}

// Nothing is replayed: a turbine goes on from its file.
template <>
void ExtTurbIface<SparTurbine, SparSolverData>::ext_replay_turbine(
    SparTurbine& fi)
{
    amrex::Abort(
        "SparIface: turbine " + fi.tlabel + ": spar_sim_mode is auto, init or restart");
}

template <>
void ExtTurbIface<SparTurbine, SparSolverData>::prepare_netcdf_file(
    SparTurbine& /*unused*/)
{}

template <>
void ExtTurbIface<SparTurbine, SparSolverData>::write_velocity_data(
    const SparTurbine& /*unused*/)
{}

template <>
void ExtTurbIface<SparTurbine, SparSolverData>::read_velocity_data(
    SparTurbine& /*unused*/,
    const ncutils::NCFile& /*unused*/,
    const size_t /*unused*/)
{}

template class ExtTurbIface<SparTurbine, SparSolverData>;

} // namespace ext_turb
