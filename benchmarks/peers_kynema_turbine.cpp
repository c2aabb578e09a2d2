// The turbine of benchmarks/peers_turbine_scene.h in an installed Kynema-FMB by its own model, as peers_kynema.cpp does
// with blades. Prints milliseconds of the first step, microseconds of each further one, and the displacement of the
// first blade's tip at the end. peers_kynema_turbine seconds steps atol rtol
#include <Kokkos_Core.hpp>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "model/model.hpp"
#include "peers_turbine_scene.h"
#include "step/step.hpp"

using Matrix = std::array<std::array<double, 6>, 6>;

static Matrix diagonal(const double *d) {
    Matrix m{};
    for (std::size_t i = 0; i < 6; i++) {
        m[i][i] = d[i];
    }
    return m;
}

// Gauss-Lobatto nodes and Gauss points on [-1, 1], as many of each, by Newton's iteration on Legendre polynomials.
static void legendre(int n, double x, double &p, double &slope) {
    double before = 1.;
    p = x;
    for (int k = 2; k <= n; k++) {
        const double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p, p = next;
    }
    slope = n * (before - x * p) / (1. - x * x);
}

static std::vector<double> lobatto(int n) {
    std::vector<double> x(static_cast<std::size_t>(n));
    for (int i = 0; i < n; i++) {
        double y = -std::cos(3.14159265358979323846 * i / (n - 1)), p = 0., slope = 0.;
        for (int k = 0; k < 50 && i > 0 && i < n - 1; k++) {
            legendre(n - 1, y, p, slope);
            y -= slope * (1. - y * y) / (2. * y * slope - n * (n - 1) * p);
        }
        x[static_cast<std::size_t>(i)] = y;
    }
    return x;
}

static std::vector<std::array<double, 2>> gauss(int n) {
    std::vector<std::array<double, 2>> points;
    for (int i = 0; i < n; i++) {
        double y = -std::cos(3.14159265358979323846 * (i + 0.75) / (n + 0.5)), p = 0., slope = 0.;
        for (int k = 0; k < 50; k++) {
            legendre(n, y, p, slope);
            y -= p / slope;
        }
        legendre(n, y, p, slope);
        points.push_back({y, 2. / ((1. - y * y) * slope * slope)});
    }
    return points;
}

// Nodes of a beam that begins at x, points along a line and has section axes q.
static std::vector<std::size_t> add_beam(kynema_fmb::Model &model, int n, double length, const double *x,
                                         const double *q, const double *along, const double *stiffness,
                                         const double *mass) {
    std::vector<std::size_t> ids;
    for (const double xi : lobatto(n)) {
        const double s = 0.5 * (1. + xi), far = s * length;
        ids.push_back(model.AddNode()
                          .SetElemLocation(s)
                          .SetPosition(x[0] + far * along[0], x[1] + far * along[1], x[2] + far * along[2], q[0], q[1],
                                       q[2], q[3])
                          .Build());
    }
    const std::vector<kynema_fmb::BeamSection> sections{{0., diagonal(mass), diagonal(stiffness)},
                                                        {1., diagonal(mass), diagonal(stiffness)}};
    model.AddBeamElement(ids, sections, gauss(n));
    return ids;
}

struct Run {
    double first{}, us{};
    std::array<double, 3> moved{};
};

struct Turbine {
    kynema_fmb::Model model;
    std::size_t tip{};
    double shaft{}, pitch{};
};

static void make_turbine(Turbine &t) {
    const double origin[3] = {0., 0., 0.}, up[3] = {0., 0., 1.}, q[4] = {std::sqrt(0.5), 0., -std::sqrt(0.5), 0.};
    const std::array<double, 3> shaft{1., 0., 0.};
    const auto tower = add_beam(t.model, TOWER_NODES, tower_height, origin, q, up, tower_stiffness, tower_mass);
    t.model.AddMassElement(tower.back(), diagonal(nacelle_mass));
    const auto hub = t.model.AddNode().SetPosition(hub_at[0], hub_at[1], hub_at[2], 1., 0., 0., 0.).Build();
    t.model.AddMassElement(hub, diagonal(hub_mass));
    t.model.AddFixedBC(tower.front());
    t.model.AddRotationControl(std::array{tower.back(), hub}, shaft, &t.shaft);
    for (int k = 0; k < BLADE_COUNT; k++) {
        double x[3], p[4], along[3];
        blade_at(k, x, p, along);
        const auto ids = add_beam(t.model, BLADE_NODES, blade_length, x, p, along, blade_stiffness, blade_mass);
        const std::array<double, 3> axis{along[0], along[1], along[2]};
        t.model.AddRotationControl(std::array{hub, ids.front()}, axis, &t.pitch);
        t.tip = k == 0 ? ids.back() : t.tip;
    }
}

static double now() {
    struct timespec t {};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e6 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_nsec);
}

// Whether every step converged.
static bool run(double end, int steps, double atol, double rtol, Run &out) {
    Turbine t;
    const double dt = end / steps;
    make_turbine(t);
    auto parameters = kynema_fmb::StepParameters(true, 30, dt, radius_at_inf, atol, rtol);
    auto [state, elements, constraints, solver] = t.model.CreateSystemWithSolver<>();
    double since = now();
    for (int i = 1; i <= steps; i++) {
        t.shaft = full_speed * integral_at(dt * i);
        t.pitch = full_pitch * part_at(dt * i);
        elements.beams.gravity(2) = elements.masses.gravity(2) = -full_gravity * part_at(dt * i);
        if (!kynema_fmb::Step(parameters, solver, elements, state, constraints)) {
            std::fprintf(stderr, "peers_kynema_turbine: no convergence in step %d\n", i);
            return false;
        }
        if (i == 1) {
            const double then = now();
            out.first = 1e-3 * (then - since);
            since = then;
        }
    }
    out.us = (now() - since) / (steps - 1);
    for (std::size_t i = 0; i < 3; i++) {
        out.moved[i] = state.q(t.tip, i);
    }
    return true;
}

int main(int argc, char **argv) {
    Run out;
    if (argc != 5 || std::atoi(argv[2]) < 2) {
        std::fprintf(stderr, "usage: peers_kynema_turbine seconds steps atol rtol\n");
        return 2;
    }
    const Kokkos::ScopeGuard kokkos{};
    for (int turn = 0; turn < 2; turn++) { // the first finds the caches cold
        if (!run(std::atof(argv[1]), std::atoi(argv[2]), std::atof(argv[3]), std::atof(argv[4]), out)) {
            return 1;
        }
    }
    std::printf("%.6g %.6g %.17g %.17g %.17g\n", out.first, out.us, out.moved[0], out.moved[1], out.moved[2]);
    return 0;
}
