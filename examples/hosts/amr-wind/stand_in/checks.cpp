// What the turbine of spar must do in AMR-Wind's hands. Usage: amr_wind_checks NAME
#include "flow.H"

#include <cstring>
#include <map>
#include <utility>
#include <sys/stat.h>

using namespace stand_in;

namespace {

constexpr double pi = 3.14159265358979323846;

Stream uniform(double speed, double from_degrees)
{
    const double to = (270 - from_degrees) * pi / 180;
    const Place u{speed * std::cos(to), speed * std::sin(to), 0};
    return [u](const Place& /*x*/, double /*t*/) { return u; };
}

Place force_on_turbine(const Flow& flow)
{
    Place sum{};
    for (const auto& f : flow.model->grid().force) {
        for (std::size_t k = 0; k < 3; ++k) {
            sum[k] -= 1.225 * f[k];
        }
    }
    return sum;
}

// Rows of the figures' file by the column's name; "time" 0 is the first row.
std::map<std::string, std::vector<double>> read_figures()
{
    std::map<std::string, std::vector<double>> table;
    std::ifstream file("spar_amr_wind/T1.csv");
    std::string line, word;
    std::vector<std::string> names;
    std::getline(file, line);
    for (std::istringstream words(line); std::getline(words, word, ',');) {
        names.push_back(word);
    }
    while (std::getline(file, line)) {
        std::istringstream words(line);
        for (const auto& name : names) {
            std::getline(words, word, ',');
            table[name].push_back(std::stod(word));
        }
    }
    return table;
}

// ---- the order of the sampled velocities ----

// The correction of blade b, point i is made on the sampled velocity that begins at b n, with forces and relative velocities
// from 1 + b n on. Each must be of the same point. Oracle: where the points are.
void check_order()
{
    const int n = 12;
    input(false, n);
    set_turbine("fllc", "1");
    Flow flow(uniform(6, 270), 0.02, 4);
    flow.step();
    const std::vector<Place> speed_of = [&] { // of the points at the end of the first step, hub first
        std::vector<Place> v(1 + 3 * n);
        for (std::size_t i = 0; i < v.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                v[i][k] = static_cast<double>(flow.model->turbine().solid_velocity(static_cast<int>(k))[i]);
            }
        }
        return v;
    }();
    flow.step(); // samples at the positions before it, which are in flow.old
    const auto& grid = flow.model->grid();
    double apart = 0, relative = 0;
    for (std::size_t b = 0; b < 3; ++b) {
        for (std::size_t i = 0; i < n; ++i) {
            const std::size_t of_force = 1 + b * n + i, of_velocity = b * n + i;
            const double given = 6 + actuator::ops::correction(static_cast<int>(b), static_cast<int>(i));
            relative = std::max(relative, std::fabs(flow.model->meta().vel_rel[of_force][0] + speed_of[of_force][0] - given));
            for (std::size_t k = 0; k < 3; ++k) {
                apart = std::max(apart, std::fabs(grid.vel_pos[of_velocity][k] - flow.old[of_force][k]));
            }
        }
    }
    expect(apart < 1e-9, "velocities of blade b are sampled at its own points: m apart", apart);
    expect(relative < 1e-5, "relative velocities are those of their points: m/s apart", relative);
    expect(std::fabs(flow.model->meta().nacelle_velocity - 6) < 1e-6, "the nacelle's drag is found with the hub's velocity, m/s",
           flow.model->meta().nacelle_velocity);
}

// ---- checkpoints ----

bool is_there(const std::string& path)
{
    struct stat about;
    return stat(path.c_str(), &about) == 0;
}

void forget_files()
{
    for (int i = 0; i < 100; ++i) {
        char name[64];
        for (const char* form : {"spar_amr_wind/T1.%05d", "spar_amr_wind/T1.%05d.host", "spar_amr_wind/chk%05d"}) {
            std::snprintf(name, sizeof name, form, i);
            std::remove(name);
        }
    }
}

// Steps of a run in which one has a file and the other has not.
int unmatched(const Flow& flow)
{
    int wrong = 0;
    for (int i = 0; i < 100; ++i) {
        char number[32];
        std::snprintf(number, sizeof number, "%05d", i);
        const bool flows = std::find(flow.checkpoints.begin(), flow.checkpoints.end(), number) != flow.checkpoints.end();
        wrong += flows != is_there(std::string("spar_amr_wind/T1.") + number) ? 1 : 0;
    }
    return wrong;
}

void check_checkpoints()
{
    const struct
    {
        const char *what, *key, *value, *key_2, *value_2;
        double dt_0;
        std::size_t number; // of checkpoints in 10 steps of 0.1 s, counted by hand
        const char* restart;
        std::size_t number_after; // in 6 steps from there
    } rules[] = {
        {"every 4 steps, and the last: 0 4 8 10; from 8: 12 14", "checkpoint_interval", "4", "", "", 0.1, 4, "00008", 2},
        {"every 4 steps; from 10: 14 16", "checkpoint_interval", "4", "", "", 0.1, 4, "00010", 2},
        {"every 4 steps from 2 on: 2 6 10", "checkpoint_interval", "4", "checkpoint_start", "2", 0.1, 3, "00006", 2},
        {"every 3 steps after 5: 6 9 10", "checkpoint_interval", "3", "checkpoint_delay", "5", 0.1, 3, "00006", 2},
        {"every 0.3 s: 0 3 6 9 10; from 6: 9 12", "checkpoint_time_interval", "0.3", "", "", 0.1, 5, "00006", 2},
        {"every 0.3 s, the first step unknown", "checkpoint_time_interval", "0.3", "", "", -1.0, 5, "00009", 2},
        {"every 0.5 s after 0.6 s: 10", "checkpoint_time_interval", "0.5", "checkpoint_time_delay", "0.6", 0.1, 1, "00010", 2},
        {"never", "checkpoint_interval", "-1", "", "", 0.1, 0, "", 0}};
    for (const auto& rule : rules) {
        forget_files();
        input(false, 4);
        set_turbine("spar_nodes_blade", "4");
        set(std::string("time.") + rule.key, rule.value);
        if (rule.key_2[0] != '\0') {
            set(std::string("time.") + rule.key_2, rule.value_2);
        }
        Flow flow(uniform(6, 270), 0.1, rule.dt_0, 10);
        flow.run();
        flow.end();
        expect(flow.checkpoints.size() == rule.number, rule.what, static_cast<double>(flow.checkpoints.size()));
        expect(unmatched(flow) == 0, "  files of the turbine without one of the flow's, or the other way round", unmatched(flow));
        if (rule.number == 0) {
            continue;
        }
        set("io.restart_file", std::string("spar_amr_wind/chk") + rule.restart);
        Flow again(uniform(6, 270), 0.1, rule.dt_0, 6);
        forget_files(); // those of the first run
        again.run();
        again.end();
        expect(again.checkpoints.size() == rule.number_after && unmatched(again) == 0, "  the same after a restart",
               static_cast<double>(again.checkpoints.size()));
    }
    forget_files();
}

// A run that a limit of wall time ends, which the ranks find together: its last checkpoint has a state too, and goes on.
void check_wall()
{
    forget_files();
    input(false, 4);
    set_turbine("spar_nodes_blade", "4");
    set("time.checkpoint_interval", "4");
    set("time.max_wall_time", std::to_string(5.5 / 3600));
    Flow flow(uniform(6, 270), 0.1, 100);
    flow.run();
    flow.end();
    expect(flow.checkpoints == std::vector<std::string>{"00000", "00004", "00006"}, "checkpoints 0 4, and 6 where the time is over",
           static_cast<double>(flow.checkpoints.size()));
    expect(unmatched(flow) == 0, "  files of the turbine without one of the flow's, or the other way round", unmatched(flow));
    set("io.restart_file", "spar_amr_wind/chk00006");
    Flow again(uniform(6, 270), 0.1, 2);
    again.run();
    expect(again.sim.time().index == 8, "  from which a restart goes on: step", again.sim.time().index);
    again.end();
    forget_files();
}

// ---- refusals ----

void refused(const char* expected)
{
    std::string text = "accepted";
    try {
        Flow flow(uniform(6, 270), 0.1, 2);
        flow.run();
    } catch (const std::exception& e) {
        text = e.what();
    }
    expect(text.find(expected) != std::string::npos, expected, static_cast<double>(text.size()));
    if (text.find(expected) == std::string::npos) {
        std::printf("    it says: %s\n", text.c_str());
    }
}

void fresh()
{
    input(false, 4);
    set_turbine("spar_nodes_blade", "4");
}

void check_refusals()
{
    const char* inputs[][3] = {
        {"spar_node_blade", "8", "nobody reads Actuator.T1.spar_node_blade; of the turbine's keys the nearest is spar_nodes_blade"},
        {"spar_winddirection", "225", "the nearest is spar_wind_direction"},
        {"rot_speed_rmp", "9", "the nearest is rot_speed_rpm"},
        {"pitch", "5", "nobody reads Actuator.T1.pitch; of the turbine's keys the nearest is pitch_deg"},
        {"wind_speed", "8", "the nearest is wind_speed_init"},
        {"openfast_input_file", "x.fst", "nobody reads Actuator.T1.openfast_input_file"},
        {"rotor_diameter", "120", "rotor_diameter is 120.0"},
        {"hub_height", "87.6", "leave the line out"},
        {"spar_data", "/nowhere", "cannot be opened"},
        {"spar_scheme", "explicit", "spar_scheme is iqn_ils, aitken or fixed_point, not explicit"},
        {"spar_accepted_residual", "1e-9", "an accepted residual of no less than the tolerance"},
        {"spar_sim_mode", "replay", "spar_sim_mode is auto, init or restart, not replay"},
        {"spar_sim_mode", "restart", "the flow begins anew"},
        {"spar_restart_file", "spar_amr_wind/T1.00002", "the turbine begins anew"},
        {"num_points_tower", "8", "num_points_tower is 0"}};
    for (const auto& one : inputs) {
        fresh();
        set_turbine(one[0], one[1]);
        refused(one[2]);
    }
    fresh();
    set("Actuator.TurbineSparLine.spar_rtoll", "1e-6");
    refused("nobody reads Actuator.TurbineSparLine.spar_rtoll; of the turbine's keys the nearest is spar_rtol");
    fresh();
    set("Actuator.spar_wind_direction", "225");
    refused("nobody reads Actuator.spar_wind_direction; of the turbine's keys the nearest is spar_wind_direction");
    fresh();
    set("Actuator.T2.pitch", "5"); // another turbine's
    set_turbine("fllc_type", "variable_chord"); // of a correction that is off
    set("Actuator.TurbineSparLine.density", "1.2"); // which this turbine has itself
    refused("accepted");
    fresh();
    set("ICNS.source_terms", "GravityForcing");
    refused("add ActuatorForcing to ICNS.source_terms");
    amrex::ParmParse::table().erase("ICNS.source_terms");
    refused("add ActuatorForcing to ICNS.source_terms");
    fresh();
    set("Actuator.type", "TurbineSparDisk");
    refused("accepted");
    set_turbine("fllc", "1");
    refused("Actuator.T1.fllc corrects the velocities at lines, not on a disk");
}

// The input that is shipped, but for the folder of the tables.
void check_input()
{
    input(false, 4);
    amrex::ParmParse::table().clear();
    std::ifstream file(SPAR_HOST_DIR "/turbine.inp");
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line.substr(0, line.find('#')));
        std::string key, equals, word, value;
        words >> key >> equals;
        while (words >> word) {
            value += (value.empty() ? "" : " ") + word;
        }
        if (!key.empty()) {
            set(key, value);
        }
    }
    set_turbine("spar_data", SPAR_DATA_DIR "/nrel5mw");
    set_turbine("spar_output", "spar_amr_wind");
    double dt = 0;
    amrex::ParmParse("time").query("fixed_dt", dt);
    Flow flow(uniform(8, 270), dt, 5);
    flow.run();
    const double thrust = force_on_turbine(flow)[0];
    // without induction: rotor disk theory has 4/9 of the dynamic pressure's 8/9 at 2/3 of the wind, and here the wind is whole
    expect(thrust > 400e3 && thrust < 900e3 && said().empty(), "the input that is shipped runs: thrust without induction, N", thrust);
    flow.end();
    forget_files();
}

// What a run leaves of the table of an earlier one.
std::string bytes(const std::string& path)
{
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

std::string first_free()
{
    int n = 1;
    while (is_there("spar_amr_wind/T1.csv." + std::to_string(n))) {
        ++n;
    }
    return "spar_amr_wind/T1.csv." + std::to_string(n);
}

// Of the wrong step, of another turbine, or not there.
void check_restarts()
{
    forget_files();
    fresh();
    set("time.checkpoint_interval", "2");
    Flow flow(uniform(6, 270), 0.1, 4);
    flow.run();
    const std::string lines = bytes("spar_amr_wind/T1.csv");
    expect(!lines.empty(), "a run leaves a table: letters", static_cast<double>(lines.size()));
    set("io.restart_file", "spar_amr_wind/chk00002");
    set_turbine("spar_sim_mode", "init"); // left there after a flow without turbines
    refused("spar_sim_mode = init would begin it anew, and spar_amr_wind/T1.00002 is its state of this step");
    set_turbine("spar_sim_mode", "auto");
    set_turbine("spar_restart_file", "spar_amr_wind/T1.00004");
    refused("is of step 4, t = 0.4 s, and the flow restarts at step 2, t = 0.2 s");
    amrex::ParmParse::table().erase("Actuator.T1.spar_restart_file");
    set_turbine("spar_wind_direction", "225");
    refused("faces another way by -45 degrees");
    set_turbine("spar_wind_direction", "270");
    set_turbine("num_points_blade", "5");
    refused("use the nodes of the saved run; spar_restart_file names another");
    set_turbine("num_points_blade", "4");
    std::remove("spar_amr_wind/T1.00002.host");
    refused("T1.00002.host is not there");
    std::remove("spar_amr_wind/T1.00002");
    refused("there is no spar_amr_wind/T1.00002: step 2 of the flow has no state of the turbine");
    expect(bytes("spar_amr_wind/T1.csv") == lines, "none of them has changed the table: letters", static_cast<double>(lines.size()));
    set_turbine("spar_sim_mode", "init"); // a turbine that begins in a flow that had none
    const std::string aside = first_free();
    Flow begun(uniform(6, 270), 0.1, 2);
    expect(bytes("spar_amr_wind/T1.csv") == lines, "nor has a run before its first step", 0);
    begun.run();
    expect(bytes(aside) == lines, "a new run keeps an older table aside", 0);
    const double begins = read_figures().at("time_s").at(0);
    expect(std::fabs(begins - 0.2) < 1e-12, "spar_sim_mode = init begins a turbine in the flow as it is: first time, s",
           begins);
    set("time.checkpoint_interval", "-1");
    fresh();
    Flow changed(uniform(6, 270), 0.1, 2);
    changed.sim.time().now = 0.05;
    std::string text;
    try {
        changed.step();
    } catch (const std::exception& e) {
        text = e.what();
    }
    expect(text.find("the flow's step changed after the turbine had made its own") != std::string::npos,
           "a step of the flow that is not the turbine's", static_cast<double>(text.size()));
    forget_files();
}

// A restart on another kind of processor: the two are run with different OPENBLAS_CORETYPE, whose kernels round the turbine's
// static start differently. The figures go on, to what rounding becomes in 5 steps.
void check_one_processor()
{
    forget_files();
    input(true, 12);
    set("time.checkpoint_interval", "5");
    Flow flow(uniform(8, 270), 0.2, 10);
    flow.run();
    flow.end();
}

void check_another_processor()
{
    const auto before = read_figures();
    input(true, 12);
    set("io.restart_file", "spar_amr_wind/chk00005");
    Flow flow(uniform(8, 270), 0.2, 5);
    flow.run();
    const auto after = read_figures();
    double worst = after.at("step").size() == 11 && before.at("step").size() == 11 ? 0 : 1;
    for (std::size_t i = 6; i < 11 && worst < 1; ++i) {
        worst = std::max(worst, std::fabs(after.at("thrust_N")[i] / before.at("thrust_N")[i] - 1));
        worst = std::max(worst, std::fabs(after.at("rotor_speed_rpm")[i] / before.at("rotor_speed_rpm")[i] - 1));
    }
    expect(worst < 1e-6, "a restart on another kind of processor: change of thrust and speed, relative", worst);
    flow.end();
    forget_files();
}

// ---- coarse steps ----

// A stream with gusts of 1 m/s that differ from point to point.
Place gusty(const Place& x, double t) { return {8 + std::sin(0.1 * x[1] + 0.07 * x[2] + 1.3 * t), 0, 0}; }

// dt 0.2 s, 11 to 14 degrees of the rotor: as the README's input has it.
void check_coarse()
{
    input(true, 24);
    Flow flow(gusty, 0.2, 40);
    flow.run();
    const double thrust = force_on_turbine(flow)[0];
    expect(said().empty(), "40 steps of 0.2 s of the whole turbine end without a warning: letters",
           static_cast<double>(said().size()));

    // Too few iterations for the tolerance: what is left is small, and accepted with a warning.
    input(true, 24);
    set_turbine("spar_max_iterations", "4");
    Flow fewer(gusty, 0.2, 40);
    fewer.run();
    const double change = std::fabs(force_on_turbine(fewer)[0] - thrust) / thrust;
    expect(said().find("warning 2: after t = 0.2 s the loads still changed by") != std::string::npos && change < 2e-3,
           "4 iterations are accepted with a warning: change of the thrust", change);
    expect(said().find("warning 3:") == std::string::npos, "  of which the 1st, 2nd, 4th, ... are printed: letters",
           static_cast<double>(said().size()));

    // What is left is not small enough: parts of the step converge better.
    input(true, 24);
    set_turbine("spar_max_iterations", "4");
    set_turbine("spar_rtol", "1e-5");
    set_turbine("spar_accepted_residual", "1e-5");
    Flow parts(gusty, 0.2, 40);
    parts.run();
    const double of_parts = std::fabs(force_on_turbine(parts)[0] - thrust) / thrust;
    const auto figures = read_figures();
    const double most = *std::max_element(figures.at("parts").begin(), figures.at("parts").end());
    expect(most > 1 && said().find("a step of 0.2 s was taken in") != std::string::npos,
           "a step that does not converge is taken in parts: at most", most);
    expect(of_parts < 0.02, "  which changes the thrust by the error of the long step: change", of_parts);

    // Where nothing is accepted, the shortest parts fail too.
    input(false, 24);
    set_turbine("spar_max_iterations", "2");
    set_turbine("spar_rtol", "1e-14");
    set_turbine("spar_accepted_residual", "1e-14");
    refused("after 2 iterations the loads change by");
}

// ---- where the wind comes from ----

void check_direction()
{
    input(true, 12);
    Flow west(uniform(6, 270), 0.1, 10);
    west.run();
    const Place there = force_on_turbine(west), hub = west.model->grid().pos[0];
    expect(said().empty(), "a turbine that faces the wind says nothing: letters", static_cast<double>(said().size()));

    input(true, 12);
    set_turbine("spar_wind_direction", "225");
    Flow southwest(uniform(6, 225), 0.1, 10);
    southwest.run();
    const Place here = force_on_turbine(southwest), moved = southwest.model->grid().pos[0];
    const double c = std::sqrt(0.5);
    // numbers in single precision are turned: 1e-6
    const double error = std::hypot(here[0] - c * (there[0] - there[1]), here[1] - c * (there[0] + there[1])) / there[0];
    expect(error < 2e-6, "wind from 225 degrees: the forces are those of 270 degrees, turned: error", error);
    const double off = std::hypot(moved[0] - 500 - c * ((hub[0] - 500) - (hub[1] - 100)),
                                  moved[1] - 100 - c * ((hub[0] - 500) + (hub[1] - 100)));
    expect(off < 1e-4, "  and so is the hub: m", off);
    const auto& t = southwest.model->turbine();
    expect(std::fabs(t.hub_orient[0] - c * std::cos(5 * pi / 180)) < 2e-3 && std::fabs(t.hub_orient[3] - t.hub_orient[0]) < 2e-3,
           "  and the shaft, downwind: x", t.hub_orient[0]);
    expect(said().empty(), "  and nobody is warned: letters", static_cast<double>(said().size()));

    // turned from the wind by yaw, to either side alike but for the rotor's turn
    double lateral[2];
    for (int i = 0; i < 2; ++i) {
        input(false, 12);
        set_turbine("spar_yaw", i == 0 ? "20" : "-20");
        Flow yawed(uniform(6, 270), 0.1, 10);
        yawed.run();
        lateral[i] = force_on_turbine(yawed)[1] / force_on_turbine(yawed)[0];
    }
    expect(lateral[0] > 0.3 && lateral[1] < -0.3 && std::fabs(lateral[0] + lateral[1]) < 0.1,
           "yaw of 20 degrees: the force goes with the shaft, to the left: of its size", lateral[0]);

    input(false, 12);
    Flow wrong(uniform(6, 225), 0.1, 1);
    expect(said().find("faces 270 degrees, the wind at its hub comes from 225 degrees") != std::string::npos,
           "a turbine that does not face the wind is told: letters", static_cast<double>(said().size()));
}

// ---- figures ----

void check_figures()
{
    input(true, 24);
    set("time.checkpoint_interval", "30");
    const double speed = 8.0 * 2 / 3;
    Flow flow(uniform(speed, 270), 0.2, 60);
    flow.run();
    const auto all = read_figures();
    const auto& time = all.at("time_s");
    expect(time.size() == 61 && time[0] <= 0 && std::fabs(time[60] - 12) < 1e-9, "a line a step, from t = 0: lines",
           static_cast<double>(time.size()));
    const double thrust = all.at("thrust_N")[60], along = force_on_turbine(flow)[0];
    expect(std::fabs(thrust - along) < 0.02 * thrust, "thrust is the force that is spread, along the shaft: N", thrust);
    const double rpm = all.at("rotor_speed_rpm")[60], turned = all.at("azimuth_deg")[60] - all.at("azimuth_deg")[59];
    expect(std::fabs(std::fmod(turned + 720, 360) - rpm * 6 * 0.2) < 0.05, "azimuth is the rotor's turn: deg in a step",
           std::fmod(turned + 720, 360));
    // Equilibrium by hand: thrust at 90 m, weights of nacelle (1.9 m downwind), hub and blades (5 m upwind); what swings is 3 %.
    double flap = 0, fore = 0, mean = 0;
    for (std::size_t i = 31; i < 61; ++i) {
        fore += all.at("tower_base_fore_Nm")[i] / 30;
        mean += all.at("thrust_N")[i] / 30;
        for (const char* one : {"root1_flap_Nm", "root2_flap_Nm", "root3_flap_Nm"}) {
            flap += all.at(one)[i] / 90;
        }
    }
    const double arm = 90, by_hand = mean * std::cos(5 * pi / 180) * arm + 9.81 * (240e3 * 1.9 - 5.0 * (56780 + 3 * 17740));
    expect(std::fabs(fore - by_hand) < 0.06 * by_hand, "the moment at the tower's base, mean: N m; by hand within 6 %", fore);
    // A blade's share of the thrust, at two thirds of its length, less what cone and turning give back: 20 %
    const double of_thrust = mean / 3 * 41;
    expect(std::fabs(flap - of_thrust) < 0.2 * of_thrust, "flapwise moment of a root, mean: N m", flap);
    expect(all.at("tip1_flap_m")[60] > 2 && all.at("tip1_flap_m")[60] < 6, "tips bend downwind: m", all.at("tip1_flap_m")[60]);
    const double power = all.at("aero_power_W")[60];
    expect(std::fabs(power - 1.9e6) < 0.25 * 1.9e6 && all.at("pitch_deg")[60] < 1e-6, "power: W", power);

    // A restart goes on in the same file: lines after its time are those of the new run.
    set("io.restart_file", "spar_amr_wind/chk00030");
    Flow again(uniform(speed, 270), 0.2, 60);
    again.run();
    const auto both = read_figures();
    bool even = both.at("time_s").size() == 91;
    for (std::size_t i = 0; even && i < 91; ++i) {
        even = std::fabs(both.at("step")[i] - static_cast<double>(i)) < 0.5;
    }
    expect(even, "a restart at step 30 of 60 goes on in the file, without a gap or a line twice: lines",
           static_cast<double>(both.at("time_s").size()));
    double worst = 0;
    for (std::size_t i = 0; i < 61; ++i) {
        worst = std::max(worst, std::fabs(both.at("thrust_N")[i] - all.at("thrust_N")[i]));
    }
    expect(worst <= 0, "  and its lines are those of the run through: N", worst);
    forget_files();
}

// ---- the balance of power ----

// What the air gives to the rotor, less what the generator takes and what the rotor's speed stores, of the air's; and the mean of
// the column unbalanced_power_W, of the same. The last 25 s of 40 s in a held stream, in which the controller settles.
std::pair<double, double> missing_power(double dt, double uneven)
{
    input(true, 12);
    Flow flow(uniform(6, 270), dt, static_cast<int>(40 / dt));
    for (int i = 0; flow.sim.time().continue_simulation(); ++i) {
        flow.sim.time().dt = dt * (1 + (i % 2 == 0 ? uneven : -uneven));
        flow.step();
    }
    flow.end();
    const auto all = read_figures();
    const std::size_t last = all.at("time_s").size() - 1, first = last * 3 / 8;
    double air = 0, generator = 0, column = 0;
    for (std::size_t i = first + 1; i <= last; ++i) { // mean of the two ends of each step
        const double step = all.at("time_s")[i] - all.at("time_s")[i - 1];
        air += 0.5 * step * (all.at("aero_power_W")[i] + all.at("aero_power_W")[i - 1]);
        generator += 0.5 * step * (all.at("generator_power_W")[i] + all.at("generator_power_W")[i - 1]) / 0.944;
        column += step * all.at("unbalanced_power_W")[i];
    }
    const auto energy = [&](std::size_t i) { // of rotor and generator: 3.87e7 and 5.03e6 kg m^2
        return 0.5 * 4.37e7 * std::pow(all.at("rotor_speed_rpm")[i] * pi / 30, 2);
    };
    return {(air - generator - energy(last) + energy(first)) / air, column / air};
}

// Oracle: conservation. What is missing is the error of long steps: of nothing in even steps of 0.1 s (7 degrees of the rotor). The
// column also counts the power of the velocities at the ends, which are larger than the way in a step, by (turn in a step)^2 / 12.
void check_balance()
{
    const struct
    {
        const char* what;
        double dt, uneven, most;
    } runs[] = {{"of the air's power, even steps of 0.1 s do not find again", 0.1, 0, 1e-3},
                {"steps of 0.1 s, uneven by 1 %", 0.1, 0.01, 1e-3},
                {"even steps of 0.2 s", 0.2, 0, 4e-3}};
    for (const auto& run : runs) {
        const auto [missing, column] = missing_power(run.dt, run.uneven);
        expect(std::fabs(missing) < run.most, run.what, missing);
        expect(std::fabs(column - missing) < 5e-3, "  and the mean of the column says so", column);
    }
}

} // namespace

int main(int argc, char** argv)
{
    const std::map<std::string, void (*)()> checks{
        {"order", check_order},       {"checkpoints", check_checkpoints}, {"refusals", check_refusals},
        {"restarts", check_restarts}, {"coarse", check_coarse},           {"direction", check_direction},
        {"figures", check_figures},   {"input", check_input},             {"wall", check_wall},
        {"one_processor", check_one_processor},                           {"another_processor", check_another_processor},
        {"balance", check_balance}};
    const auto it = argc == 2 ? checks.find(argv[1]) : checks.end();
    if (it == checks.end()) {
        std::printf("usage: amr_wind_checks order|checkpoints|refusals|restarts|coarse|direction|figures|input|wall|one_processor|another_processor|balance\n");
        return 2;
    }
    try {
        it->second();
    } catch (const std::exception& e) {
        std::printf("%s\n", e.what());
        return 1;
    }
    return failures() == 0 ? 0 : 1;
}
