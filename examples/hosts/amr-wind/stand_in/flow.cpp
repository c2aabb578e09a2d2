// The turbine of spar in a uniform stream, driven as AMR-Wind drives it, and what comes out.
// Usage: amr_wind_stand_in [--whole] [--steps N] [--dt S] [--wind M/S]
#include "actuator.h"
#include "flow.H"

#include <cstdlib>
#include <cstring>

using namespace stand_in;

namespace {

double dot(const Place& a, const Place& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Place operator-(const Place& a, const Place& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

// Force on the turbine, N: the source turned round, times the density.
Place total(const ActGrid& grid, double density)
{
    Place sum{};
    for (const auto& f : grid.force) {
        for (std::size_t k = 0; k < 3; ++k) {
            sum[k] -= density * f[k];
        }
    }
    return sum;
}

// Work on the blades in the last step: forces half-way times the way.
double work(const ActGrid& grid, const std::vector<Place>& old, double density)
{
    double sum = 0;
    for (std::size_t i = 1; i < grid.pos.size(); ++i) {
        sum -= density * dot(grid.force[i], grid.pos[i] - old[i]);
    }
    return sum;
}

// Moment about the hub along the axis, at the places half-way.
double torque(const ActGrid& grid, const std::vector<Place>& old, const Place& axis, double density)
{
    double sum = 0;
    for (std::size_t i = 1; i < grid.pos.size(); ++i) {
        Place arm{};
        for (std::size_t k = 0; k < 3; ++k) {
            arm[k] = 0.5 * (grid.pos[i][k] + old[i][k]) - 0.5 * (grid.pos[0][k] + old[0][k]);
        }
        const auto& f = grid.force[i];
        const Place m{arm[1] * f[2] - arm[2] * f[1], arm[2] * f[0] - arm[0] * f[2], arm[0] * f[1] - arm[1] * f[0]};
        sum -= density * dot(m, axis);
    }
    return sum;
}

// The machine by itself in a stream: the forces that are spread are the mean of those at the step's two ends.
double spread_error(bool whole, double wind, double dt)
{
    actuator_options options;
    actuator_default(&options);
    options.data = SPAR_DATA_DIR "/nrel5mw";
    options.points = 24;
    options.whole = whole ? 1 : 0;
    options.rpm = 9.16;
    options.wind = 8;
    actuator_machine* machine = nullptr;
    double worst = actuator_create(&options, &machine) == SPAR_OK ? 0 : 1;
    if (worst <= 0) {
        const auto n = static_cast<std::size_t>(actuator_get_count(machine));
        std::vector<float> velocity(3 * n, 0.0F), force(3 * n);
        std::fill_n(velocity.begin(), n, static_cast<float>(wind));
        Place before, after;
        worst = actuator_start(machine, velocity.data()) == SPAR_OK ? 0 : 1;
        actuator_get_rotor(machine, nullptr, nullptr, nullptr, before.data());
        for (int i = 0; i < 10; ++i) {
            velocity[0] = velocity[n / 2] += 0.1F; // a gust on one point
            const bool good = actuator_step(machine, dt, velocity.data()) == SPAR_OK &&
                              actuator_get_points(machine, nullptr, nullptr, nullptr, force.data(), nullptr, nullptr) == SPAR_OK &&
                              actuator_get_rotor(machine, nullptr, nullptr, nullptr, after.data()) == SPAR_OK;
            for (std::size_t k = 0; k < 3; ++k) {
                double sum = 0;
                for (std::size_t p = 0; p < n; ++p) {
                    sum += static_cast<double>(force[k * n + p]);
                }
                worst = std::max(worst, good ? std::fabs(sum - 0.5 * (before[k] + after[k])) / std::fabs(after[0]) : 1.0);
            }
            before = after;
        }
    }
    actuator_destroy(&machine);
    return worst;
}

// How far the first local axis is from the line of the points, over all blades: the largest sine.
double misalignment(const ActGrid& grid, std::size_t n)
{
    double worst = 0;
    for (std::size_t b = 0; b < 3; ++b) {
        for (std::size_t i = n / 2; i + 1 < n; ++i) {
            const std::size_t p = 1 + b * n + i;
            const Place way = grid.pos[p + 1] - grid.pos[p];
            const Place x{grid.orientation[p][0], grid.orientation[p][1], grid.orientation[p][2]};
            const double along = dot(way, x) / std::sqrt(dot(way, way));
            worst = std::max(worst, along > 0 ? std::sqrt(std::max(0.0, 1 - along * along)) : 1.0);
        }
    }
    return worst;
}

struct Sums
{
    double work = 0, turn = 0, thrust = 0, power = 0;
};

// Steps, with the figures of the last part of them.
Sums run(Flow& c, int steps, double density)
{
    Sums sums;
    std::printf("%8s %12s %14s %10s %12s\n", "time", "thrust, kN", "power, kW", "rev/min", "tip off hub");
    for (int i = 0; i < steps; ++i) {
        c.step();
        const auto& t = c.model->turbine();
        const Place axis{t.hub_orient[0], t.hub_orient[3], t.hub_orient[6]};
        const Place omega{static_cast<double>(t.hub_rot_vel[0]), static_cast<double>(t.hub_rot_vel[1]),
                          static_cast<double>(t.hub_rot_vel[2])};
        const double speed = dot(omega, axis), moment = torque(c.model->grid(), c.old, axis, density);
        sums.work += work(c.model->grid(), c.old, density);
        sums.turn += moment * speed * c.sim.time().dt;
        sums.thrust = dot(total(c.model->grid(), density), axis);
        sums.power = moment * speed;
        if ((i + 1) % std::max(1, steps / 10) == 0) {
            std::printf("%8.3f %12.3f %14.3f %10.4f %12.4f\n", c.sim.time().now, sums.thrust * 1e-3, sums.power * 1e-3,
                        speed * 30 / 3.14159265358979323846, c.model->grid().pos[24][0] - c.model->grid().pos[0][0]);
        }
    }
    return sums;
}

} // namespace

int main(int argc, char** argv)
{
    bool whole = false;
    int steps = 100;
    double wind = 8.0 * 2 / 3, dt = 0.02;
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], "--whole") == 0) {
            whole = true;
        } else if (std::strcmp(argv[i], "--steps") == 0 && i + 1 < argc) {
            steps = std::max(10, std::atoi(argv[++i]));
        } else if (std::strcmp(argv[i], "--dt") == 0 && i + 1 < argc) {
            dt = std::atof(argv[++i]);
        } else if (std::strcmp(argv[i], "--wind") == 0 && i + 1 < argc) {
            wind = std::atof(argv[++i]);
        } else {
            std::printf("usage: amr_wind_stand_in [--whole] [--steps N] [--dt S] [--wind M/S, at the rotor]\n");
            return 2;
        }
    }
    const double density = 1.225;
    const Stream stream = [wind](const Place& /*x*/, double /*t*/) { return Place{wind, 0.0, 0.0}; };
    const int half = steps / 2;
    try {
        input(whole, 24);
        set("time.checkpoint_interval", std::to_string(half));
        Flow c(stream, dt, 2 * half);
        const Sums sums = run(c, 2 * half, density);

        std::printf("\n");
        const Place hub = c.model->grid().pos[0];
        expect(std::fabs(hub[0] - 500 + 5.0) < 1 && std::fabs(hub[1] - 100) < 0.5 && std::fabs(hub[2] - 90) < 0.5,
               "the hub stands over the base, 5 m upwind, at 90 m: height", hub[2]);
        expect(misalignment(c.model->grid(), 24) < 0.05, "first local axes lie along the blades: largest sine",
               misalignment(c.model->grid(), 24));
        const double spread = spread_error(whole, wind, dt);
        expect(spread < 1e-6, "spread forces are the mean of the lines' at both ends of a step: error", spread);
        // A rotor at a given speed does no other work than by its torque, but for what the blades store. The whole turbine also
        // moves its tower.
        const double defect = std::fabs(sums.work - sums.turn) / std::fabs(sums.turn);
        expect(dt > 0.2 || defect < 0.02, "work of forces half-way on the way of the points, against torque times turn", defect);
        // 8 m/s upstream and one third of it taken away: AeroDyn has 385 kN and 1.9 MW
        const bool far_from_8 = std::fabs(wind - 8.0 * 2 / 3) > 1e-9;
        expect(far_from_8 || std::fabs(sums.thrust - 385e3) < 0.15 * 385e3, "thrust, N", sums.thrust);
        expect(far_from_8 || std::fabs(sums.power - 1.9e6) < 0.25 * 1.9e6, "power, W", sums.power);

        set("io.restart_file", "spar_amr_wind/chk" + c.checkpoints.at(1));
        Flow again(stream, dt, half);
        again.run();
        expect(difference(c.model->grid(), again.model->grid()) <= 0, "a restart half-way ends with the same bits: difference",
               difference(c.model->grid(), again.model->grid()));
        expect(said().empty(), "no warning: letters", static_cast<double>(said().size()));
        std::printf("%s", said().c_str());
    } catch (const std::exception& e) {
        std::printf("%s\n", e.what());
        return 1;
    }
    return failures() == 0 ? 0 : 1;
}
