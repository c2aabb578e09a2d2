// The beam of peer_physics.h in an installed Kynema-FMB: processor time of a step in microseconds, and where the tip is
// at the end. peers_kynema nodes steps atol rtol
#include "peer_physics.h"

#include <Kokkos_Core.hpp>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "interfaces/blade/blade_interface.hpp"
#include "interfaces/blade/blade_interface_builder.hpp"
#include "interfaces/components/beam_builder.hpp"

using kynema_fmb::interfaces::BladeInterface;
using kynema_fmb::interfaces::BladeInterfaceBuilder;
using kynema_fmb::interfaces::components::BeamInput;
using kynema_fmb::interfaces::components::ReferenceAxisOrientation;

static BladeInterface make_beam(std::size_t nodes, int steps, double atol, double rtol) {
    auto stiffness = std::array<std::array<double, 6>, 6>{};
    auto mass = std::array<std::array<double, 6>, 6>{};
    for (std::size_t i = 0; i < 6; i++) {
        for (std::size_t j = 0; j < 6; j++) {
            stiffness[i][j] = peer_stiffness[i][j];
        }
        mass[i][i] = peer_mass[i];
    }
    auto builder = BladeInterfaceBuilder{};
    builder.Solution()
        .EnableDynamicSolve()
        .SetTimeStep(peer_end / steps)
        .SetDampingFactor(0.)
        .SetMaximumNonlinearIterations(30)
        .SetAbsoluteErrorTolerance(atol)
        .SetRelativeErrorTolerance(rtol);
    builder.Blade()
        .SetElementOrder(nodes - 1)
        .SetSectionRefinement(nodes - 1)
        .SetQuadratureRule(BeamInput::QuadratureRule::GaussLegendre)
        .SetQuadratureStyle(BeamInput::QuadratureStyle::WholeBeam)
        .PrescribedRootMotion(true);
    for (const double s : {0., 1.}) {
        builder.Blade()
            .AddRefAxisTwist(s, 0.)
            .AddRefAxisPoint(s, {s * peer_length, 0., 0.}, ReferenceAxisOrientation::X)
            .AddSection(s, mass, stiffness, ReferenceAxisOrientation::X);
    }
    return builder.Build();
}

int main(int argc, char **argv) {
    if (argc != 5) {
        std::fprintf(stderr, "usage: peers_kynema nodes steps atol rtol\n");
        return 2;
    }
    const int steps = std::atoi(argv[2]);
    const Kokkos::ScopeGuard kokkos{};
    auto beam = make_beam(static_cast<std::size_t>(std::atoi(argv[1])), steps, std::atof(argv[3]), std::atof(argv[4]));
    auto &tip = beam.Blade().nodes.back();
    tip.loads[2] = peer_force;
    const std::clock_t begin = std::clock();
    for (int i = 0; i < steps; i++) {
        if (!beam.Step()) {
            std::fprintf(stderr, "peers_kynema: no convergence in step %d\n", i + 1);
            return 1;
        }
    }
    const double took = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    std::printf("%.6g %.17g %.17g %.17g\n", 1e6 * took / steps, tip.displacement[0], tip.displacement[1],
                tip.displacement[2]);
    return 0;
}
