// A stand-in for Nalu-Wind's time loop: a tube of quadrilaterals around each blade, whose walls feel a stream of wind by their
// speed against it, and nonlinear iterations of a given number. It drives SparFSI by the calls of Nalu-Wind's aero container,
// in their order, and checks what comes out. On ranks each has every other ring of faces. Usage: nalu_wind_stand_in [--steps N]
#include "aero/fsi/SparFSI.h"
#include "nrel5mw.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

using namespace sierra::nalu;

std::function<void(stk::mesh::BulkData&, const stk::mesh::PartVector&)> CalcLoads::flow;

namespace {

constexpr int rings = 33, around = 8;
constexpr double ramp = 6.0, wind = 8.0, rpm = 9.16;
const std::array<double, 3> hub{0.0, 0.0, 90.0};
int failures = 0, rank = 0;

void expect(bool good, const char* what, double value)
{
  int all = good ? 1 : 0;
  double worst = value;
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  if (rank == 0) {
    std::printf("  %-72s %12.4e %s\n", what, worst, all != 0 ? "" : "WRONG");
  }
  failures += all != 0 ? 0 : 1;
}

// Tubes of 1 m radius along the blades' pitch axes, from 0.5 m before the root to 0.5 m short of the tip.
std::shared_ptr<stk::mesh::BulkData> make_mesh()
{
  auto bulk = std::make_shared<stk::mesh::BulkData>();
  auto& meta = bulk->meta;
  nrel5mw data;
  nrel5mw_rotor rotor;
  if (nrel5mw_load(&data, SPAR_DATA_DIR "/nrel5mw") != SPAR_OK) {
    throw std::runtime_error(data.message);
  }
  nrel5mw_rotor_default(&data, &rotor);
  std::copy(hub.begin(), hub.end(), rotor.hub);
  std::vector<double> places;
  for (int b = 0; b < FSI_BLADES; ++b) {
    double x[3], q[4];
    nrel5mw_root(&data, &rotor, b, 0, x, q);
    auto& block = meta.parts["blade" + std::to_string(b + 1)];
    auto& wall = meta.parts["wall" + std::to_string(b + 1)];
    const double ex[3] = {1 - 2 * (q[2] * q[2] + q[3] * q[3]), 2 * (q[1] * q[2] + q[0] * q[3]), 2 * (q[1] * q[3] - q[0] * q[2])};
    const double ey[3] = {2 * (q[1] * q[2] - q[0] * q[3]), 1 - 2 * (q[1] * q[1] + q[3] * q[3]), 2 * (q[2] * q[3] + q[0] * q[1])};
    for (int i = 0; i < rings; ++i) {
      const double span = -0.5 + data.length * i / (rings - 1);
      for (int k = 0; k < around; ++k) {
        const double angle = 2 * std::acos(-1.0) * k / around;
        const size_t node = bulk->count[0]++;
        for (int c = 0; c < 3; ++c) {
          const double ez = ex[(c + 1) % 3] * ey[(c + 2) % 3] - ex[(c + 2) % 3] * ey[(c + 1) % 3];
          places.push_back(x[c] + span * ex[c] + std::cos(angle) * ey[c] + std::sin(angle) * ez);
        }
        block.members[0].insert(node);
        meta.owned.members[0].insert(node); // all ranks know all nodes here, and move them alike
        if (i + 1 < rings) {
          const size_t first = node - static_cast<size_t>(k), next = first + static_cast<size_t>((k + 1) % around);
          const size_t face = bulk->count[2]++;
          bulk->faces.push_back({stk::mesh::Entity{node}, {next}, {next + around}, {node + around}});
          wall.members[2].insert(face);
          if (i % bulk->parallel_size() == bulk->parallel_rank()) {
            meta.owned.members[2].insert(face);
          }
        }
      }
    }
  }
  nrel5mw_free(&data);
  for (const char* name : {"coordinates", "current_coordinates", "mesh_displacement", "mesh_velocity", "n", "nm1"}) {
    auto& field = meta.fields[name];
    field.length = 3;
    field.values.assign(3 * bulk->count[0], 0.0);
  }
  meta.fields["mesh_displacement"].older[0] = &meta.fields["n"];
  meta.fields["mesh_displacement"].older[1] = &meta.fields["nm1"];
  meta.fields["coordinates"].values = meta.fields["current_coordinates"].values = places;
  meta.fields["tforce_scs"].length = 12;
  meta.fields["tforce_scs"].values.assign(12 * bulk->count[2], 0.0);
  meta.fields["div_mesh_velocity"].length = meta.fields["edge_face_velocity_mag"].length = 1;
  return bulk;
}

// A quarter of each face's area times the dynamic pressure of the wind along x against the wall's own speed, all on x.
void stream(stk::mesh::BulkData& bulk, const stk::mesh::PartVector& walls)
{
  auto& meta = bulk.meta;
  const auto& velocity = meta.fields["mesh_velocity"];
  for (const auto* wall : walls) {
    for (const size_t f : wall->members[2]) {
      double v = 0;
      for (const auto node : bulk.faces[f]) {
        v += stk::mesh::field_data(velocity, node)[0] / 4;
      }
      const double area = 61.5 / (rings - 1) * 2 * std::acos(-1.0) / around, w = wind - v;
      double* force = stk::mesh::field_data(meta.fields["tforce_scs"], stk::mesh::Entity{f});
      for (int ip = 0; ip < 4; ++ip) {
        force[3 * ip] = area / 4 * 0.5 * 1.225 * std::fabs(w) * w;
        force[3 * ip + 1] = force[3 * ip + 2] = 0;
      }
    }
  }
}

struct Run
{
  std::shared_ptr<stk::mesh::BulkData> bulk = make_mesh();
  SparFSI fsi;
  double dt, t;
  double error_velocity = 0, error_force = 0, gap = 0; // largest

  Run(double dt_in, int restart_every, const std::string& restart, double t0)
    : fsi(YAML::Node({{"data", SPAR_DATA_DIR "/nrel5mw"},
                      {"rotor_speed_rpm", std::to_string(rpm)},
                      {"hub", "[0,0,90]"},
                      {"ramp_length", std::to_string(ramp)},
                      {"blade_parts", "[blade1,blade2,blade3]"},
                      {"blade_boundary_parts", "[wall1,wall2,wall3]"},
                      {"restart_file", restart}})),
      dt(dt_in), t(t0)
  {
    CalcLoads::flow = stream;
    fsi.setup(dt, bulk);
    fsi.initialize(restart_every, t0);
  }
  double tip_of_mesh(int axis)
  {
    double mean = 0;
    for (int k = 0; k < around; ++k) {
      mean += bulk->meta.fields["current_coordinates"].values[3 * ((rings - 1) * around + k) + axis] / around;
    }
    return mean;
  }
  // As Nalu-Wind's loop: the mesh once, then the nonlinear iterations, then on.
  void step(int iterations)
  {
    const auto old = bulk->meta.fields["current_coordinates"].values;
    const auto old_v = bulk->meta.fields["mesh_velocity"].values;
    double before[3], after[3];
    fsi.predict_struct_states();
    fsi.map_displacements(t + dt, true);
    fsi.compute_div_mesh_velocity();
    fsi_rotor_get_tip(fsi.rotor(), 0, before);
    for (int k = 0; k < iterations; ++k) {
      fsi.predict_struct_timestep(t + dt);
    }
    fsi_rotor_get_tip(fsi.rotor(), 0, after);
    fsi.advance_struct_timestep(t + dt);
    t += dt;
    gap = std::max(gap, std::sqrt(std::pow(after[0] - before[0], 2) + std::pow(after[1] - before[1], 2) +
                                  std::pow(after[2] - before[2], 2)));
    const auto& now = bulk->meta.fields["current_coordinates"].values;
    const auto& v = bulk->meta.fields["mesh_velocity"].values;
    for (size_t i = 0; i < now.size(); ++i) {
      error_velocity = std::max(error_velocity, std::fabs((now[i] - old[i]) / dt - 0.5 * (v[i] + old_v[i])));
    }
    double force[3], sum = 0;
    fsi_rotor_get_force(fsi.rotor(), force);
    const auto& f = bulk->meta.fields["tforce_scs"].values;
    for (size_t i = 0; i < f.size(); i += 3) {
      sum += f[i];
    }
    error_force = std::max(error_force, std::fabs(force[0] - sum) / std::fabs(sum));
  }
};

// Nodes before the root have none of the blade's weight: turned with the hub, exactly.
double hub_error(Run& run)
{
  const double tilt = 5 * std::acos(-1.0) / 180, angle = rpm * std::acos(-1.0) / 30 * run.t;
  const double n[3] = {std::cos(tilt), 0, -std::sin(tilt)};
  double worst = 0;
  for (int k = 0; k < around; ++k) {
    const double* x = &run.bulk->meta.fields["coordinates"].values[static_cast<size_t>(3 * k)];
    double arm[3], along = 0;
    for (int i = 0; i < 3; ++i) {
      arm[i] = x[i] - hub[static_cast<size_t>(i)];
      along += arm[i] * n[i];
    }
    for (int i = 0; i < 3; ++i) {
      const double cross = n[(i + 1) % 3] * arm[(i + 2) % 3] - n[(i + 2) % 3] * arm[(i + 1) % 3];
      const double to = hub[static_cast<size_t>(i)] + std::cos(angle) * arm[i] + std::sin(angle) * cross +
                        (1 - std::cos(angle)) * along * n[i];
      worst = std::max(worst, std::fabs(run.bulk->meta.fields["current_coordinates"].values[static_cast<size_t>(3 * k + i)] - to));
    }
  }
  return worst;
}

void run_all(int steps)
{
  Run run(0.02, steps / 2, "", 0.0);
  if (rank == 0) {
    std::printf("%8s %14s %22s\n", "time", "tip of mesh, x", "mesh to structure, m");
  }
  for (int i = 0; i < steps; ++i) {
    run.gap = 0;
    run.step(3);
    if (rank == 0 && (i + 1) % std::max(1, steps / 10) == 0) {
      std::printf("%8.3f %12.4f m %22.3e\n", run.t, run.tip_of_mesh(0), run.gap);
    }
  }
  if (rank == 0) {
    std::printf("\n");
  }
  expect(hub_error(run) < 1e-9, "mesh before the root turns with the hub: error, m", hub_error(run));
  // 60 m/s at the tip; the blades spring from straight, which the differences see one step late
  expect(run.error_velocity < 0.2, "mesh velocities against differences of places: largest, m/s", run.error_velocity);
  expect(run.error_force < 1e-12, "force pushed against the sum over the walls, relative", run.error_force);

  Run again(0.02, 0, "spar_fsi." + std::to_string(steps / 2), 0.02 * (steps / 2));
  for (int i = steps / 2; i < steps; ++i) {
    again.step(3);
  }
  double worst = 0;
  const auto &a = run.bulk->meta.fields["current_coordinates"].values, &b = again.bulk->meta.fields["current_coordinates"].values;
  for (size_t i = 0; i < a.size(); ++i) {
    worst = std::max(worst, std::fabs(a[i] - b[i]));
  }
  expect(worst <= 0, "a restart half-way ends with the same bits: difference, m", worst);

  // The mesh goes where extrapolated loads lead. Their error falls with dt^2, and what a load error moves within a step with dt^2:
  // 16 for half the step in the limit. Loads that were not extrapolated would have 8, loads that were not taken in 4.
  double gap[2];
  for (int k = 0; k < 2; ++k) {
    const double dt = k == 0 ? 0.02 : 0.01;
    Run one(dt, 0, "", 0.0);
    for (int i = 0; i < (k == 0 ? 10 : 20); ++i) {
      one.gap = i < (k == 0 ? 5 : 10) ? 0 : one.gap;
      one.step(3);
    }
    gap[k] = one.gap;
  }
  expect(gap[0] / gap[1] > 8, "mesh to structure at the end of a step, dt 0.02 over dt 0.01", gap[0] / gap[1]);
}

} // namespace

int main(int argc, char** argv)
{
  MPI_Init(&argc, &argv);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  const int steps = argc > 2 && std::strcmp(argv[1], "--steps") == 0 ? std::max(4, std::atoi(argv[2])) / 2 * 2 : 20;
  try {
    run_all(steps);
  } catch (const std::exception& e) {
    std::printf("rank %d: %s\n", rank, e.what());
    MPI_Abort(MPI_COMM_WORLD, 1);
  }
  MPI_Finalize();
  return failures == 0 ? 0 : 1;
}
