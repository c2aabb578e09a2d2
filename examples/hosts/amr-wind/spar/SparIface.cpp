// AMR-Wind's calls on a turbine, answered by spar. A turbine is one session of one process: that of its root rank.
#include "amr-wind/wind_energy/actuator/turbine/external/ExtTurbIface.H"
#include "amr-wind/wind_energy/actuator/turbine/spar/spar_types.H"
#include "amr-wind/CFDSim.H"
#include "amr-wind/core/SimTime.H"

#include "AMReX.H"
#include "AMReX_FileSystem.H"
#include "AMReX_ParmParse.H"
#include "AMReX_Utility.H"

#include <cstdio>

namespace ext_turb {
namespace {

void check(const SparTurbine& fi, int status)
{
    if (status != SPAR_OK) {
        amrex::Abort(
            "SparIface: turbine " + fi.tlabel + ": " +
            std::string(spar_status_text(status)) + ": " +
            std::string(actuator_message(fi.machine.get())));
    }
}

// The turbine at t = 0, as the input file has it.
void make_machine(SparTurbine& fi)
{
    if (fi.num_blades != 3 || fi.num_pts_tower != 0) {
        amrex::Abort(
            "SparIface: turbine " + fi.tlabel +
            ": num_blades is 3 and num_points_tower is 0");
    }
    actuator_options options;
    actuator_default(&options);
    options.data = fi.data_folder.c_str();
    options.points = fi.num_pts_blade;
    options.whole = fi.whole ? 1 : 0;
    options.nodes = fi.num_nodes_blade;
    options.rpm = static_cast<double>(fi.rotor_speed_rpm);
    options.pitch = static_cast<double>(fi.pitch_deg) * 3.14159265358979323846 / 180.0;
    options.wind = static_cast<double>(fi.wind_speed);
    options.density = static_cast<double>(fi.fluid_density);
    options.gravity = static_cast<double>(fi.gravity);
    actuator_machine* made = nullptr;
    const int status = actuator_create(&options, &made);
    fi.machine.reset(made);
    check(fi, status);
    // one step of spar for one of the flow, with its own substeps inside
    fi.num_substeps = 1;
    fi.num_blade_elem = fi.num_pts_blade;
    fi.dt_ext = fi.dt_cfd;
    fi.allocate_buffers();
}

std::string checkpoint_name(const SparTurbine& fi)
{
    char step[32];
    std::snprintf(step, sizeof step, "%08d", fi.time_index);
    return fi.output_folder + "/" + fi.tlabel + "." + step;
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
    if (!fi.is_loaded) {
        check(fi, actuator_start(fi.machine.get(), fi.fluid_velocity(0)));
    }
    check(fi, fi.populate_buffers());
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
    check(fi, actuator_get_hub(fi.machine.get(), x, omega, axes));
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
    check(
        fi, actuator_step(
                fi.machine.get(), static_cast<double>(fi.dt_ext),
                fi.fluid_velocity(0)));
    check(fi, fi.populate_buffers());
}

template <>
void ExtTurbIface<SparTurbine, SparSolverData>::write_turbine_checkpoint(
    int& tid)
{
    auto& fi = *m_turbine_data[tid];
    if (!amrex::UtilCreateDirectory(fi.output_folder, 0755)) {
        amrex::CreateDirectoryFailed(fi.output_folder);
    }
    check(fi, actuator_save(fi.machine.get(), checkpoint_name(fi).c_str()));
}

template <>
void ExtTurbIface<SparTurbine, SparSolverData>::ext_init_turbine(
    SparTurbine& fi)
{
    make_machine(fi);
    check(fi, fi.populate_buffers());
}

// The name ends in the step: the count of steps goes on from there.
template <>
void ExtTurbIface<SparTurbine, SparSolverData>::ext_restart_turbine(
    SparTurbine& fi)
{
    make_machine(fi);
    check(fi, actuator_load(fi.machine.get(), fi.checkpoint_file.c_str()));
    const auto dot = fi.checkpoint_file.rfind('.');
    if (dot == std::string::npos ||
        std::sscanf(
            fi.checkpoint_file.c_str() + dot + 1, "%d", &fi.time_index) != 1) {
        amrex::Abort(
            "SparIface: " + fi.checkpoint_file +
            " does not end in the number of its step");
    }
    fi.is_loaded = true;
    check(fi, fi.populate_buffers());
}

// Nothing is replayed: a turbine goes on from its file.
template <>
void ExtTurbIface<SparTurbine, SparSolverData>::ext_replay_turbine(
    SparTurbine& fi)
{
    amrex::Abort(
        "SparIface: turbine " + fi.tlabel + ": spar_sim_mode is init or restart");
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
