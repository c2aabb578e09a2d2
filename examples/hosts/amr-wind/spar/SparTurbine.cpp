// A turbine's inputs, its figures and its files.
#include "amr-wind/wind_energy/actuator/turbine/spar/spar_types.H"

#include "AMReX.H"
#include "AMReX_ParmParse.H"
#include "AMReX_Utility.H"

#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string_view>

namespace ext_turb {
namespace {

using Parser = amr_wind::actuator::utils::ActParser;

// Keys that are read here.
constexpr std::array own_keys = {
    "spar_data",       "spar_output",         "spar_whole",
    "spar_nodes_blade", "spar_scheme",        "spar_rtol",
    "spar_max_iterations", "spar_accepted_residual", "spar_substeps",
    "spar_rho_inf",    "spar_wind_direction", "spar_yaw",
    "spar_csv_interval", "spar_sim_mode",     "spar_restart_file",
    "rot_speed_rpm",   "pitch_deg",           "wind_speed_init"};

// How many letters have to be changed, added or taken away.
std::size_t distance(std::string_view a, std::string_view b)
{
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) {
        row[j] = j;
    }
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t before = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t same = before + (a[i - 1] == b[j - 1] ? 0 : 1);
            before = row[j];
            row[j] = std::min({same, row[j] + 1, row[j - 1] + 1});
        }
    }
    return row[b.size()];
}

[[noreturn]] void refuse(const std::string& prefix, const std::string& key)
{
    const auto* nearest = *std::min_element(
        own_keys.begin(), own_keys.end(), [&](const char* a, const char* b) {
            return distance(key, a) < distance(key, b);
        });
    amrex::Abort(
        "SparIface: nobody reads " + prefix + "." + key +
        "; of the turbine's keys the nearest is " + nearest);
}

// Whether there is such a file.
bool is_file(const std::string& path) { return std::ifstream(path).good(); }

// AMR-Wind wants both; the tables know them. What the input has besides is compared.
void settle_size(const Parser& pp, const std::string& prefix, const char* key, double value, const std::string& folder)
{
    amrex::Real given{0.0_rt};
    pp.query(key, given);
    if (!pp.contains(key)) {
        amrex::ParmParse(prefix).add(key, static_cast<amrex::Real>(value));
    } else if (std::abs(static_cast<double>(given) - value) > 0.01 * value) {
        amrex::Abort(
            "SparIface: " + prefix + "." + key + " is " +
            std::to_string(given) + " m, and the turbine of " + folder +
            " has " + std::to_string(value) + " m: leave the line out");
    }
}

// A step's file has AMR-Wind's digits: chk00016 goes with T1.00016.
std::string file_of_step(const SparTurbine& fi, int step)
{
    char number[32];
    std::snprintf(number, sizeof number, "%05d", step);
    return fi.output_folder + "/" + fi.tlabel + "." + number;
}

} // namespace

void SparTurbine::check(int status) const
{
    if (status != SPAR_OK) {
        amrex::Abort(
            "SparIface: turbine " + tlabel + ": " +
            std::string(spar_status_text(status)) + ": " +
            std::string(actuator_message(machine.get())));
    }
}

void SparTurbine::read_inputs(
    const Parser& pp, const std::string& label, const std::string& model)
{
    const std::string prefix = "Actuator." + label;
    type = model;
    pp.get("spar_data", data_folder);
    pp.query("spar_output", output_folder);
    pp.query("spar_whole", whole);
    pp.query("spar_nodes_blade", num_nodes_blade);
    pp.query("spar_scheme", scheme);
    pp.query("spar_rtol", rtol);
    pp.query("spar_max_iterations", max_iterations);
    pp.query("spar_accepted_residual", accepted);
    pp.query("spar_substeps", structure_substeps);
    pp.query("spar_rho_inf", rho_inf);
    pp.query("spar_wind_direction", wind_direction);
    pp.query("spar_yaw", yaw_deg);
    pp.query("spar_csv_interval", csv_interval);
    pp.query("spar_sim_mode", mode);
    pp.query("spar_restart_file", checkpoint_file);
    pp.query("rot_speed_rpm", rotor_speed_rpm);
    pp.query("pitch_deg", pitch_deg);
    pp.query("wind_speed_init", wind_speed);
    pp.query("fllc", fllc);
    if (fllc && type == "TurbineSparDisk") {
        amrex::Abort(
            "SparIface: " + prefix +
            ".fllc corrects the velocities at lines, not on a disk: leave the line out, or take TurbineSparLine");
    }
    amrex::Vector<std::string> sources;
    amrex::ParmParse("ICNS").queryarr("source_terms", sources);
    if (std::find(sources.begin(), sources.end(), "ActuatorForcing") ==
        sources.end()) {
        amrex::Abort(
            "SparIface: the flow does not take the turbine's forces: add ActuatorForcing to ICNS.source_terms");
    }
    if (mode != "auto" && mode != "init" && mode != "restart") {
        amrex::Abort(
            "SparIface: " + prefix + ".spar_sim_mode is auto, init or restart, not " + mode);
    }

    double diameter{0.0};
    double height{0.0};
    char message[512];
    if (actuator_get_size(
            data_folder.c_str(), &diameter, &height, message) != SPAR_OK) {
        amrex::Abort("SparIface: " + prefix + ".spar_data: " + message);
    }
    settle_size(pp, prefix, "rotor_diameter", diameter, data_folder);
    settle_size(pp, prefix, "hub_height", height, data_folder);

    amrex::Vector<amrex::Real> g{0.0_rt, 0.0_rt, -9.81_rt};
    amrex::ParmParse("incflo").queryarr("gravity", g);
    gravity = -g[2];
    std::string flow_file;
    amrex::ParmParse("io").query("restart_file", flow_file);
    flow_restarts = !flow_file.empty();
}

// Of the turbine, of its type, and of all actuators together. Nobody reads keys of a correction that is off, nor those of the
// type that the turbine has itself.
void SparTurbine::refuse_unread() const
{
    const amrex::ParmParse own("Actuator." + tlabel);
    for (const auto& prefix :
         {"Actuator." + tlabel, "Actuator." + type, std::string("Actuator")}) {
        for (const auto& entry : amrex::ParmParse::getUnusedInputs(prefix)) {
            const std::string key =
                entry.substr(prefix.size() + 1, entry.find(' ') - prefix.size() - 1);
            const bool is_of_another = key.find('.') != std::string::npos;
            const bool is_off = !fllc && key.rfind("fllc_", 0) == 0;
            const bool is_replaced =
                prefix == "Actuator." + type && own.contains(key.c_str());
            if (!is_of_another && !is_off && !is_replaced) {
                refuse(prefix, key);
            }
        }
    }
}

// A flow that goes on has a turbine that goes on, unless the input says that it begins, after a flow without turbines.
void SparTurbine::choose_mode(int step, amrex::Real flow_time)
{
    time_index = step;
    start_time = time = flow_time;
    if (mode == "init" || (mode == "auto" && !flow_restarts)) {
        if (!checkpoint_file.empty()) {
            amrex::Abort(
                "SparIface: turbine " + tlabel +
                ": spar_restart_file is given, and the turbine begins anew: take the line out, or restart the flow too "
                "(io.restart_file)");
        }
        sim_mode = SimMode::init;
        return;
    }
    if (!flow_restarts) {
        amrex::Abort(
            "SparIface: turbine " + tlabel +
            ": spar_sim_mode is restart, and the flow begins anew: give io.restart_file");
    }
    sim_mode = SimMode::restart;
    if (checkpoint_file.empty()) {
        checkpoint_file = file_of_step(*this, step);
    }
}

void SparTurbine::check_beginning() const
{
    const std::string state = file_of_step(*this, time_index);
    if (flow_restarts && is_file(state)) {
        amrex::Abort(
            "SparIface: turbine " + tlabel +
            ": spar_sim_mode = init would begin it anew, and " + state +
            " is its state of this step: take the line out to go on from there, or move the file away");
    }
}

// A run that ends by an error is not over.
SparTurbine::~SparTurbine()
{
    if (is_state_due && std::uncaught_exceptions() == 0) {
        save();
    }
}

void SparTurbine::begin_figures()
{
    if (!amrex::UtilCreateDirectory(output_folder, 0755)) {
        amrex::CreateDirectoryFailed(output_folder);
    }
    if (csv_interval < 1) {
        return;
    }
    const std::string path = output_folder + "/" + tlabel + ".csv";
    check(actuator_begin_figures(
        machine.get(), path.c_str(), is_loaded ? 1 : 0, time_index,
        static_cast<double>(time)));
}

void SparTurbine::end_step(
    int step, amrex::Real flow_time, bool checkpoint, bool last)
{
    const amrex::Real passed = flow_time - time;
    if (std::abs(passed - dt_cfd) > 1.0e-6_rt * dt_cfd + 1.0e-12_rt * std::abs(time)) {
        amrex::Abort(
            "SparIface: turbine " + tlabel + " has made a step of " + std::to_string(dt_cfd) + " s, the flow one of " +
            std::to_string(passed) + " s: the flow's step changed after the turbine had made its own");
    }
    time = flow_time;
    time_index = step;
    if (csv_interval > 0 && step % csv_interval == 0) {
        check(actuator_write_figures(machine.get(), step, static_cast<double>(time)));
    }
    if (checkpoint) {
        save();
    }
    is_state_due = last && !checkpoint;
}

void SparTurbine::save()
{
    const std::string path = file_of_step(*this, time_index);
    check(actuator_save(machine.get(), path.c_str(), time_index, static_cast<double>(time)));
}

} // namespace ext_turb
