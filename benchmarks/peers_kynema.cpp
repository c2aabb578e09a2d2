// The blades of a file that benchmarks/peer_codes.c writes, in an installed Kynema-FMB by its own model, without what
// its interfaces copy each step. Prints processor time of a step in microseconds, the reference place of the first
// blade's tip and its displacement at the end. peers_kynema file steps atol rtol
#include <Kokkos_Core.hpp>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <vector>

#include "model/model.hpp"
#include "step/step.hpp"

using Matrix = std::array<std::array<double, 6>, 6>;

struct Scene {
    std::size_t blades{};
    double hub{}, turning{}, gravity{}, force{}, end{}, rho_inf{};
    bool smoothly{};
    std::array<double, 6> damping{};
    std::vector<double> s;                         // of the nodes, 0 to 1
    std::vector<std::array<double, 7>> nodes;      // of the first blade
    std::vector<std::array<double, 2>> quadrature; // on [-1, 1]
    std::vector<kynema_fmb::BeamSection> sections;
};

static bool read_scene(const char *path, Scene &scene) {
    std::ifstream file(path);
    std::size_t n = 0;
    file >> scene.blades >> scene.hub >> scene.turning >> scene.gravity >> scene.force >> scene.end >> scene.rho_inf >>
        scene.smoothly;
    for (auto &x : scene.damping) {
        file >> x;
    }
    file >> n;
    scene.s.resize(n), scene.nodes.resize(n);
    for (std::size_t i = 0; i < n; i++) {
        file >> scene.s[i];
        for (auto &x : scene.nodes[i]) {
            file >> x;
        }
    }
    file >> n;
    scene.quadrature.resize(n);
    for (auto &point : scene.quadrature) {
        file >> point[0] >> point[1];
    }
    file >> n;
    for (std::size_t i = 0; i < n; i++) {
        double at = 0;
        std::array<Matrix, 2> table{}; // mass, stiffness
        file >> at;
        for (auto &matrix : table) {
            for (auto &row : matrix) {
                for (auto &x : row) {
                    file >> x;
                }
            }
        }
        scene.sections.emplace_back(at, table[0], table[1]);
    }
    return static_cast<bool>(file);
}

static const std::array<double, 3> origin{0., 0., 0.};

static const double pi = 3.14159265358979323846;

// As peer_codes.c has them.
static double part_at(const Scene &scene, double t) {
    return scene.smoothly ? std::pow(std::sin(0.5 * pi * t / scene.end), 2) : 1.;
}
static double angle_at(const Scene &scene, double t) {
    return scene.smoothly ? 0.5 * t - 0.5 * scene.end / pi * std::sin(pi * t / scene.end) : t;
}

static std::array<double, 4> turned(double angle) {
    return {std::cos(0.5 * angle), 0., std::sin(0.5 * angle), 0.};
}

// Blades around the hub, turning from the start; the constraints of their roots.
static std::vector<std::size_t> make_blades(const Scene &scene, kynema_fmb::Model &model) {
    const double speed = scene.turning * part_at(scene, 0.);
    const std::array<double, 6> velocity{0., 0., 0., 0., speed, 0.}, none{};
    const std::array<double, 3> omega{0., speed, 0.};
    std::vector<std::size_t> roots;
    model.SetGravity(0., 0., -scene.gravity);
    for (std::size_t blade = 0; blade < scene.blades; blade++) {
        std::vector<std::size_t> ids;
        for (std::size_t i = 0; i < scene.nodes.size(); i++) {
            ids.push_back(model.AddNode().SetElemLocation(scene.s[i]).SetPosition(scene.nodes[i]).Build());
        }
        const auto element = model.AddBeamElement(ids, scene.sections, scene.quadrature, scene.damping);
        const auto angle = 2. * pi * static_cast<double>(blade) / static_cast<double>(scene.blades);
        model.RotateBeamAboutPoint(element, turned(angle), origin);
        model.SetBeamVelocityAboutPoint(element, velocity, origin);
        model.SetBeamAccelerationAboutPoint(element, none, omega, origin);
        roots.push_back(scene.turning > 0. ? model.AddPrescribedBC(ids.front()) : model.AddFixedBC(ids.front()));
    }
    return roots;
}

// Displacement of a root that stood at an angle and has turned by another.
static std::array<double, 7> root_at(const Scene &scene, double from, double turn) {
    const auto q = turned(turn);
    return {scene.hub * (std::cos(from + turn) - std::cos(from)),
            0.,
            -scene.hub * (std::sin(from + turn) - std::sin(from)),
            q[0],
            q[1],
            q[2],
            q[3]};
}

struct Run {
    double us{};
    std::array<double, 3> place{}, moved{};
};

// Whether every step converged.
static bool run(const Scene &scene, int steps, double atol, double rtol, Run &out) {
    auto model = kynema_fmb::Model();
    const double dt = scene.end / steps;
    const auto roots = make_blades(scene, model);
    const auto last = scene.nodes.size() - 1;
    auto parameters = kynema_fmb::StepParameters(true, 30, dt, scene.rho_inf, atol, rtol);
    auto [state, elements, constraints, solver] = model.CreateSystemWithSolver<>();
    auto force = Kokkos::create_mirror_view(state.f);
    Kokkos::deep_copy(force, state.f);
    Kokkos::deep_copy(state.a, state.vd); // its scheme carries these accelerations on
    const std::clock_t begin = std::clock();
    for (int i = 0; i < steps; i++) {
        const double turn = scene.turning * angle_at(scene, dt * (i + 1));
        for (std::size_t blade = 0; blade < scene.blades; blade++) {
            const double from = 2. * pi * static_cast<double>(blade) / static_cast<double>(scene.blades);
            if (scene.turning > 0.) {
                constraints.UpdateDisplacement(roots[blade], root_at(scene, from, turn));
            }
            force((blade + 1) * scene.nodes.size() - 1, 2) = part_at(scene, dt * (i + 1)) * scene.force;
        }
        if (i == 0 || (scene.smoothly && scene.force != 0.)) {
            Kokkos::deep_copy(state.f, force);
        }
        if (!kynema_fmb::Step(parameters, solver, elements, state, constraints)) {
            std::fprintf(stderr, "peers_kynema: no convergence in step %d\n", i + 1);
            return false;
        }
    }
    out.us = 1e6 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC / steps;
    const auto q = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), state.q);
    for (std::size_t i = 0; i < 3; i++) {
        out.place[i] = scene.nodes[last][i];
        out.moved[i] = q(last, i);
    }
    return true;
}

int main(int argc, char **argv) {
    Scene scene;
    Run out;
    if (argc != 5 || !read_scene(argv[1], scene)) {
        std::fprintf(stderr, "usage: peers_kynema file steps atol rtol\n");
        return 2;
    }
    const Kokkos::ScopeGuard kokkos{};
    for (int turn = 0; turn < 2; turn++) { // the first finds the caches cold
        if (!run(scene, std::atoi(argv[2]), std::atof(argv[3]), std::atof(argv[4]), out)) {
            return 1;
        }
    }
    std::printf("%.6g %.17g %.17g %.17g %.17g %.17g %.17g\n", out.us, out.place[0], out.place[1], out.place[2],
                out.moved[0], out.moved[1], out.moved[2]);
    return 0;
}
