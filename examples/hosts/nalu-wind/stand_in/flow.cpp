// A stand-in for a flow in Nalu-Wind: tubes of quadrilaterals around the parts of a turbine, whose walls feel a stream of wind
// along x by their speed against it. It drives SparFSI through the patched AeroContainer and the stand-in of Realm, and checks
// what comes out. On ranks each has every other ring of faces. Usage: nalu_wind_stand_in
#include "Realm.h"
#include "aero/fsi/CalcLoads.h"
#include "aero/spar/SparFSI.h"
#include "nrel5mw.h"
#include "turbine_control.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

using namespace sierra::nalu;

namespace {

constexpr int around = 8, iterations = 3;
constexpr double wind = 8.0, rpm = 9.16, dt0 = 0.02;
const double pi = std::acos(-1.0);
using Vector = std::array<double, 3>;
int failures = 0, world = 0;

void expect(bool good, const char* what, double value)
{
  int all = good ? 1 : 0;
  double worst = value;
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  if (world == 0) {
    std::printf("  %-88s %12.4e %s\n", what, worst, all != 0 ? "" : "WRONG");
  }
  failures += all != 0 ? 0 : 1;
}

// The call is refused on every rank, with these words in the message.
template <typename Call> void expect_refusal(const char* what, const char* words, Call&& call)
{
  std::string message = "not refused";
  try {
    call();
  } catch (const std::exception& e) {
    message = e.what();
  }
  const bool good = message.find(words) != std::string::npos;
  expect(good, what, good ? 0 : 1);
  if (!good) {
    std::printf("    rank %d: %s\n", world, message.c_str());
  }
}

// ---- the mesh ----

struct Tube
{
  std::string name;
  Vector origin, ex, ey; // from the origin along ex
  double begin, end, radius;
  int rings;
};

void add_tube(stk::mesh::BulkData& bulk, const Tube& t)
{
  auto& meta = bulk.meta;
  auto& coordinates = meta.declare_field<double>(stk::topology::NODE_RANK, "coordinates");
  coordinates.length = 3;
  auto& block = meta.parts[t.name];
  auto& wall = meta.parts[t.name + "_wall"];
  const Vector ez{t.ex[1] * t.ey[2] - t.ex[2] * t.ey[1], t.ex[2] * t.ey[0] - t.ex[0] * t.ey[2], t.ex[0] * t.ey[1] - t.ex[1] * t.ey[0]};
  const double length = t.end - t.begin;
  for (int i = 0; i < t.rings; ++i) {
    const double along = t.begin + length * i / (t.rings - 1);
    for (size_t k = 0; k < around; ++k) {
      const double angle = 2 * pi * static_cast<double>(k) / around;
      const size_t node = bulk.count[0]++;
      for (size_t c = 0; c < 3; ++c) {
        coordinates.values.push_back(
          t.origin[c] + along * t.ex[c] + t.radius * (std::cos(angle) * t.ey[c] + std::sin(angle) * ez[c]));
      }
      block.members[0].insert(node);
      meta.owned.members[0].insert(node); // all ranks know all nodes here, and move them alike
      if (i + 1 < t.rings) {
        const size_t first = node - k, next = first + (k + 1) % around;
        const size_t face = bulk.count[2]++;
        bulk.faces.push_back({stk::mesh::Entity{node}, {next}, {next + around}, {node + around}});
        bulk.areas.push_back(length / (t.rings - 1) * 2 * pi * t.radius / around);
        wall.members[2].insert(face);
        if (i % bulk.parallel_size() == bulk.parallel_rank()) {
          meta.owned.members[2].insert(face);
        }
      }
    }
  }
}

// Blades from 0.5 m before the root to 0.5 m short of the tip; of the whole turbine hub, nacelle and tower too.
void add_turbine(stk::mesh::BulkData& bulk, const std::string& prefix, const Vector& base, bool whole)
{
  nrel5mw data;
  nrel5mw_rotor rotor;
  if (nrel5mw_load(&data, SPAR_DATA_DIR "/nrel5mw") != SPAR_OK) {
    throw std::runtime_error(data.message);
  }
  nrel5mw_rotor_default(&data, &rotor);
  const double up = 87.6 + 1.96256, over = 5.0191; // the shaft above the foot, the hub before it: turbine_model.c
  const Vector n{std::cos(data.tilt), 0, -std::sin(data.tilt)}, across{0, 1, 0};
  Vector hub{-over * n[0], 0, up - over * n[2]}, top{0, 0, up};
  for (size_t k = 0; k < 3; ++k) {
    rotor.hub[k] = hub[k];
    hub[k] += base[k];
    top[k] += base[k];
  }
  for (int b = 0; b < FSI_BLADES; ++b) {
    Vector x;
    double q[4];
    nrel5mw_root(&data, &rotor, b, 0, x.data(), q);
    for (size_t k = 0; k < 3; ++k) {
      x[k] += base[k];
    }
    const Vector ex{1 - 2 * (q[2] * q[2] + q[3] * q[3]), 2 * (q[1] * q[2] + q[0] * q[3]), 2 * (q[1] * q[3] - q[0] * q[2])};
    const Vector ey{2 * (q[1] * q[2] - q[0] * q[3]), 1 - 2 * (q[1] * q[1] + q[3] * q[3]), 2 * (q[2] * q[3] + q[0] * q[1])};
    add_tube(bulk, {prefix + "blade" + std::to_string(b + 1), x, ex, ey, -0.5, data.length - 0.5, 1, 33});
  }
  if (whole) {
    add_tube(bulk, {prefix + "hub", hub, n, across, -1, 1, 1.5, 3});
    add_tube(bulk, {prefix + "nacelle", top, n, across, -2, 8, 2, 4});
    add_tube(bulk, {prefix + "tower", base, {0, 0, 1}, {1, 0, 0}, 0, 85, 3, 12});
  }
  nrel5mw_free(&data);
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
      double* force = stk::mesh::field_data(meta.fields["tforce_scs"], stk::mesh::Entity{f});
      for (int ip = 0; ip < 4; ++ip) {
        force[3 * ip] = bulk.areas[f] / 4 * 0.5 * 1.225 * std::fabs(wind - v) * (wind - v);
        force[3 * ip + 1] = force[3 * ip + 2] = 0;
      }
    }
  }
}

// ---- a run ----

struct Setup
{
  bool whole{false};
  std::vector<Vector> bases{{0, 0, 0}};
  std::vector<double> speeds{rpm};
  std::string more, file; // keys of every turbine; restart_file
  OutputInfo output;
  MPI_Comm comm{MPI_COMM_WORLD};
};

std::string input(const Setup& s)
{
  std::string text = "{spar_fsi: {";
  text += s.file.empty() ? "" : "restart_file: " + s.file + ", ";
  text += "turbines: [";
  for (size_t i = 0; i < s.bases.size(); ++i) {
    const std::string p = "t" + std::to_string(i + 1);
    const auto names = [&p](const std::string& tail) {
      return "[" + p + "blade1" + tail + ", [" + p + "blade2" + tail + "], " + p + "blade3" + tail + "]";
    };
    text += "{name: " + p + ", data: " SPAR_DATA_DIR "/nrel5mw, rotor_speed_rpm: " + std::to_string(s.speeds[i]) + ", base: [" +
            std::to_string(s.bases[i][0]) + ", " + std::to_string(s.bases[i][1]) + ", " + std::to_string(s.bases[i][2]) +
            "], ramp_length: 6, blade_parts: " + names("") + ", blade_boundary_parts: " + names("_wall") + s.more;
    if (s.whole) {
      text += ", whole: true";
      for (const char* part : {"hub", "nacelle", "tower"}) {
        text += std::string(", ") + part + "_parts: " + p + part + ", " + part + "_boundary_parts: [" + p + part + "_wall]";
      }
    }
    text += "}, ";
  }
  return text + "]}}";
}

std::shared_ptr<stk::mesh::BulkData> make_mesh(const Setup& s)
{
  auto bulk = std::make_shared<stk::mesh::BulkData>(s.comm);
  for (size_t i = 0; i < s.bases.size(); ++i) {
    add_turbine(*bulk, "t" + std::to_string(i + 1), s.bases[i], s.whole);
  }
  return bulk;
}

struct Run
{
  std::shared_ptr<stk::mesh::BulkData> bulk;
  Realm realm;
  double error_velocity = 0, error_force = 0; // largest

  Run(const Setup& s, std::vector<Saved>& restart_file)
    : bulk(make_mesh(s)), realm(bulk, YAML::Load(input(s)), s.output, dt0, restart_file)
  {
    realm.flow = stream;
    realm.initialize();
  }
  // The container keeps its SparFSI to itself; tests see it by the parts that it moves.
  const std::vector<double>& position() { return bulk->meta.fields["current_coordinates"].values; }
  const std::vector<double>& reference() { return bulk->meta.fields["coordinates"].values; }
  void steps(int n, double dt = dt0)
  {
    for (int i = 0; i < n; ++i) {
      const auto old = position(), old_v = bulk->meta.fields["mesh_velocity"].values;
      realm.step(dt, iterations);
      const auto& v = bulk->meta.fields["mesh_velocity"].values;
      for (size_t k = 0; k < v.size(); ++k) {
        error_velocity = std::max(error_velocity, std::fabs((position()[k] - old[k]) / dt - 0.5 * (v[k] + old_v[k])));
      }
    }
  }
  // Mean position of a ring of a part; negative: from the end.
  Vector ring(const std::string& part, int number)
  {
    const auto& nodes = bulk->meta.parts[part].members[0];
    const int rings = static_cast<int>(nodes.size()) / around;
    auto node = nodes.begin();
    std::advance(node, around * (number < 0 ? rings + number : number));
    Vector mean{0, 0, 0};
    for (int k = 0; k < around; ++k, ++node) {
      for (size_t c = 0; c < 3; ++c) {
        mean[c] += position()[3 * *node + c] / around;
      }
    }
    return mean;
  }
  // Of the walls, as the flow has it.
  double force()
  {
    double sum = 0;
    for (const double f : bulk->meta.fields["tforce_scs"].values) {
      sum += f;
    }
    return sum;
  }
};

double difference(const std::vector<double>& a, const std::vector<double>& b)
{
  double worst = a.size() == b.size() ? 0 : 1e300;
  for (size_t i = 0; i < a.size() && i < b.size(); ++i) {
    worst = std::max(worst, std::fabs(a[i] - b[i]));
  }
  return worst;
}

double distance(const Vector& a, const Vector& b)
{
  return std::sqrt(std::pow(a[0] - b[0], 2) + std::pow(a[1] - b[1], 2) + std::pow(a[2] - b[2], 2));
}

std::string bytes(const std::string& file)
{
  MPI_Barrier(MPI_COMM_WORLD);
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// A part as a rigid one: largest change of a distance between its nodes.
double strain(Run& run, const std::string& part)
{
  const auto& nodes = run.bulk->meta.parts[part].members[0];
  const auto& x = run.position();
  const auto& X = run.reference();
  const auto at = [](const std::vector<double>& all, size_t node) { return Vector{all[3 * node], all[3 * node + 1], all[3 * node + 2]}; };
  double worst = 0;
  for (const size_t i : nodes) {
    for (const size_t k : nodes) {
      worst = std::max(worst, std::fabs(distance(at(x, i), at(x, k)) - distance(at(X, i), at(X, k))));
    }
  }
  return worst;
}

// ---- what a turbine has written ----

// The last rows of its table, [n][13].
std::vector<std::array<double, 13>> table(const std::string& name)
{
  MPI_Barrier(MPI_COMM_WORLD); // rank 0 has written
  std::ifstream in("spar_fsi." + name + ".csv");
  std::string line;
  std::getline(in, line);
  std::vector<std::array<double, 13>> rows;
  while (std::getline(in, line)) {
    std::array<double, 13> row{};
    std::istringstream cells(line);
    std::string cell;
    for (size_t i = 0; std::getline(cells, cell, ',') && i < row.size(); ++i) {
      row[i] = std::atof(cell.c_str());
    }
    rows.push_back(row);
  }
  return rows;
}
enum Column { TIME, SPEED, PITCH, FORCE_X, MOMENT_X = 6, MOMENT_Y, MOMENT_Z, TIP_X, TIP_Y, TIP_Z, GAP };

// The hub's rotation by an angle about the shaft of a turbine at the origin.
Vector turned(const Vector& X, double angle)
{
  const double tilt = 5 * pi / 180, up = 87.6 + 1.96256;
  const Vector n{std::cos(tilt), 0, -std::sin(tilt)};
  Vector arm{X[0], X[1], X[2] - up}, x;
  const double along = arm[0] * n[0] + arm[1] * n[1] + arm[2] * n[2];
  for (size_t i = 0; i < 3; ++i) {
    const double cross = n[(i + 1) % 3] * arm[(i + 2) % 3] - n[(i + 2) % 3] * arm[(i + 1) % 3];
    x[i] = (i == 2 ? up : 0) + std::cos(angle) * arm[i] + std::sin(angle) * cross + (1 - std::cos(angle)) * along * n[i];
  }
  return x;
}

// Nodes before the root have none of the blade's weight: they turn with the hub, exactly.
double hub_error(Run& run)
{
  double worst = 0;
  for (size_t k = 0; k < around; ++k) {
    const double *X = &run.reference()[3 * k], *x = &run.position()[3 * k];
    worst = std::max(worst, distance(turned({X[0], X[1], X[2]}, rpm * pi / 30 * run.realm.currentTime_), {x[0], x[1], x[2]}));
  }
  return worst;
}

// ---- the tests ----

OutputInfo every(int frequency, double restart_time = -1.0)
{
  OutputInfo o;
  o.hasRestartBlock_ = frequency > 0;
  o.restartFreq_ = frequency;
  o.restartTime_ = restart_time;
  return o;
}

void test_container()
{
  std::vector<Saved> none;
  const auto bulk = std::make_shared<stk::mesh::BulkData>(MPI_COMM_WORLD);
  Realm still(bulk, YAML::Load("{}"), OutputInfo(), dt0, none);
  const auto& aero = still.aeroModels_;
  expect(!aero->has_fsi() && !aero->is_active() && aero->fsi_parts().empty(), "a realm without spar_fsi has none", 0);
  Realm spar(bulk, YAML::Load(input(Setup())), OutputInfo(), dt0, none);
  expect(spar.aeroModels_->has_fsi() && spar.aeroModels_->is_active() && !spar.aeroModels_->has_openfast(),
    "spar_fsi makes has_fsi() and is_active() true, without OpenFAST", 0);
  const auto make = [&](const std::string& text) { Realm(bulk, YAML::Load(text), OutputInfo(), dt0, none); };
  expect_refusal("spar_fsi beside openfast_fsi is refused", "does not go together", [&]() {
    make(input(Setup()).substr(0, input(Setup()).size() - 1) + ", openfast_fsi: {}}");
  });
  Setup s;
  s.more = ", towerparts: a";
  expect_refusal("a misspelt key is refused", "unknown key 'towerparts'", [&]() { make(input(s)); });
  s.more = ", tower_parts: nothing";
  expect_refusal("a part that the mesh has not is refused", "no part 'nothing'", [&]() { Run(s, none); });
  s.more = ", tower_parts: t1blade1";
  expect_refusal("a tower of a rotor alone is refused", "no such part", [&]() { Run(s, none); });
  s.more = ", whole: true";
  expect_refusal("the whole turbine without the wind of its start is refused", "give the wind", [&]() { Run(s, none); });
  s.more = "";
  s.output.startTime_ = 3;
  expect_refusal("a start at another time than 0 is refused", "give start_time 0", [&]() { Run(s, none); });
}

void test_rotor()
{
  std::vector<Saved> none;
  Run run(Setup(), none);
  double error_force = 0;
  for (int i = 0; i < 20; ++i) {
    run.steps(1);
    const auto rows = table("t1");
    if (world == 0) {
      error_force = std::max(error_force, rows.size() == size_t(i + 1) ? std::fabs(rows.back()[FORCE_X] / run.force() - 1) : 1);
    }
  }
  expect(hub_error(run) < 1e-9, "mesh before the root turns with the hub: error, m", hub_error(run));
  // 60 m/s at the tip; the blades spring from straight, which the differences see one step late
  expect(run.error_velocity < 0.2, "mesh velocities against differences of positions: largest, m/s", run.error_velocity);
  expect(error_force < 1e-12, "force in the table against the sum over the walls, relative", error_force);

  // The mesh goes where extrapolated loads lead. Their error falls with dt^2, and what a load error moves within a step with dt^2:
  // 16 for half the step in the limit. Loads that were not extrapolated would have 8, loads that were not taken in 4.
  double gap[2] = {0, 0};
  for (int k = 0; k < 2; ++k) {
    Run one(Setup(), none);
    one.steps(k == 0 ? 10 : 20, k == 0 ? dt0 : dt0 / 2);
    const auto rows = table("t1");
    for (size_t i = rows.size() / 2; i < rows.size(); ++i) {
      gap[k] = std::max(gap[k], rows[i][GAP]);
    }
  }
  expect(gap[0] / gap[1] > 8, "mesh to structure at the end of a step, dt 0.02 over dt 0.01", gap[0] / gap[1]);
}

// One session for each rank's own copy of the mesh gives the same motion as one over all ranks, to what the order of sums leaves.
void test_ranks()
{
  std::vector<Saved> none;
  Setup s;
  Run all(s, none);
  all.steps(10);
  s.comm = MPI_COMM_SELF;
  MPI_Barrier(MPI_COMM_WORLD);
  Run own(s, none);
  own.steps(10);
  MPI_Barrier(MPI_COMM_WORLD);
  const double error = difference(all.position(), own.position());
  expect(error < 1e-10, "all ranks as one rank alone: difference, m", error);
}

// Buckets in another order, and half-way in a third, change no bit. Forces in a wrong order would change the moments.
void test_faces()
{
  std::vector<Saved> none;
  Run run(Setup(), none), other(Setup(), none);
  other.realm.between = [&](int k) { other.bulk->reversed = k % 2 == 0; };
  run.steps(10);
  other.steps(10);
  const double error = difference(run.position(), other.position());
  expect(error <= 0, "buckets that come in another order change no bit: difference, m", error);
  // the moment about the foot, of the faces where the mesh has them: of its ramp the structure knows less, 1e-3
  double moment = 0;
  auto& meta = run.bulk->meta;
  for (size_t f = 0; f < run.bulk->faces.size(); ++f) {
    for (const auto node : run.bulk->faces[f]) {
      moment += 0.25 * stk::mesh::field_data(meta.fields["current_coordinates"], node)[2] * 4 *
                stk::mesh::field_data(meta.fields["tforce_scs"], stk::mesh::Entity{f})[0];
    }
  }
  const auto rows = table("t1");
  const double off = world == 0 ? std::fabs(rows.back()[MOMENT_Y] / moment - 1) : 0;
  expect(off < 1e-3, "moment of the loads against that of the faces where they are, relative", off);
  other.bulk->lost = *meta.parts["t1blade2_wall"].members[2].rbegin();
  expect_refusal("a face that has left its rank fails on every rank", "spar_fsi", [&]() { other.steps(1); });
}

void test_restart(bool whole)
{
  std::vector<Saved> file;
  Setup s;
  s.whole = whole;
  s.more = whole ? ", start_wind: 8" : "";
  s.output = every(10);
  Run run(s, file);
  run.steps(20);
  const std::string ten = bytes("spar_fsi.10.t1"), twenty = bytes("spar_fsi.20.t1");
  expect(!ten.empty() && !twenty.empty() && bytes("spar_fsi.0.t1").empty(), "state files stand beside the restarts at steps 10 and 20", 0);
  MPI_Barrier(MPI_COMM_WORLD);
  Setup r = s;
  r.file = "spar_fsi.10";
  r.output = every(5, 10 * dt0);
  {
    std::vector<Saved> copy = file;
    Run again(r, copy);
    expect(table("t1").size() == 20, "the table goes on", 0);
    MPI_Barrier(MPI_COMM_WORLD);
    again.steps(10);
    const auto rows = table("t1");
    bool in_turn = world != 0 || rows.size() == 20;
    for (size_t i = 1; i < rows.size(); ++i) {
      in_turn = in_turn && std::fabs(rows[i][TIME] - rows[i - 1][TIME] - dt0) < 1e-9;
    }
    expect(in_turn, "whose lines after the restart's time are those of the new run", static_cast<double>(rows.size()));
    const double error = difference(run.position(), again.position());
    expect(error <= 0, "a restart half-way ends with the same bits: difference, m", error);
    expect(!bytes("spar_fsi.15.t1").empty() && bytes("spar_fsi.10.t1") == ten, "its files have Nalu-Wind's numbers; the one it came from stands", 0);
  }
  {
    // each rank alone, from the files of all: to what the order of sums leaves in 10 steps
    std::vector<Saved> copy = file;
    Setup own = r;
    own.comm = MPI_COMM_SELF;
    own.output = every(0, 10 * dt0);
    Run again(own, copy);
    again.steps(10);
    MPI_Barrier(MPI_COMM_WORLD);
    const double error = difference(run.position(), again.position());
    expect(error < 1e-9, "a restart on another number of ranks: difference, m", error);
  }
  if (whole) {
    return;
  }
  const auto go = [&](const std::string& name, double time, std::vector<Saved> db, int steps) {
    Setup q = s;
    q.file = name;
    q.output = every(10, time);
    Run again(q, db);
    again.steps(steps);
  };
  const std::string lines = bytes("spar_fsi.t1.csv");
  expect_refusal("a restart that forgot restart_file is refused", "wants restart_file", [&]() { go("", 10 * dt0, file, 10); });
  expect(bytes("spar_fsi.10.t1") == ten && bytes("spar_fsi.t1.csv") == lines, "and has overwritten nothing", 0);
  expect_refusal("restart_file without a restart is refused", "does not restart", [&]() { go("spar_fsi.10", -1, file, 1); });
  expect_refusal("restart_file of another time is refused", "give restart_time", [&]() { go("spar_fsi.20", 10 * dt0, file, 1); });
  expect_refusal("restart_file that is missing is refused", "spar_fsi.11.t1", [&]() { go("spar_fsi.11", 10 * dt0, file, 1); });
  expect_refusal("a restart from another time than asked for is refused in its first step", "made a step of",
    [&]() { go("spar_fsi.10", 10 * dt0, {file[2]}, 1); });
  expect(bytes("spar_fsi.t1.csv") == lines, "none of them has changed the table", 0);
  int free = 1;
  while (!bytes("spar_fsi.t1.csv." + std::to_string(free)).empty()) {
    ++free;
  }
  go("", -1, {}, 1);
  expect(
    bytes("spar_fsi.t1.csv." + std::to_string(free)) == lines && table("t1").size() == 1, "a new run keeps the old table aside: number", free);
}

// The driver of several codes asks for the mesh in each nonlinear iteration. The structure predicts once: the controller
// makes one step, and the mesh follows the structure, which ends the step the nearer to it. The rest of the run is the same, to
// what the mesh's motion within a step does to the loads.
void test_driver()
{
  std::vector<Saved> none;
  Setup s;
  s.whole = true;
  s.more = ", start_wind: 8";
  Vector tip[2];
  double gap[2], speed[2];
  for (int k = 0; k < 2; ++k) {
    Run run(s, none);
    run.realm.driven = k == 1;
    run.steps(20);
    const auto rows = table("t1");
    for (size_t i = 0; i < 3 && !rows.empty(); ++i) {
      tip[k][i] = rows.back()[TIP_X + i];
    }
    gap[k] = rows.empty() ? 1.0 - k : rows.back()[GAP];
    speed[k] = rows.empty() ? 0 : rows.back()[SPEED];
    MPI_Barrier(MPI_COMM_WORLD);
  }
  expect(gap[1] < 0.2 * gap[0], "asked in each iteration: structure to mesh at the end of a step, over that of once a step", gap[1] / gap[0]);
  const double apart = world == 0 ? distance(tip[0], tip[1]) : 0;
  expect(apart < 1e-3, "the tip of blade 1 after 20 steps: m apart", apart);
  expect(std::fabs(speed[1] - speed[0]) < 1e-4, "the rotor's speed, rev/min apart", std::fabs(speed[1] - speed[0]));
}

// The times of the table and the angle of the hub follow Nalu-Wind's clock, whatever its steps.
void test_adaptive()
{
  std::vector<Saved> none;
  Run run(Setup(), none);
  for (int i = 0; i < 20; ++i) {
    run.steps(1, dt0 * (1 + 0.4 * std::sin(i)));
  }
  const auto rows = table("t1");
  const double late = world == 0 ? std::fabs(rows.back()[TIME] - run.realm.currentTime_) : 0;
  expect(late < 1e-12, "changing steps: the structure's clock against Nalu-Wind's, s", late);
  expect(hub_error(run) < 1e-9, "changing steps: mesh before the root, m", hub_error(run));
}

// Each of two turbines moves as one alone does, to the rounding of its base.
void test_farm()
{
  std::vector<Saved> none;
  Setup s;
  s.bases = {{0, 0, 0}, {500, 300, 7}};
  s.speeds = {rpm, 8.0};
  Run both(s, none);
  both.steps(10);
  const size_t n = both.position().size() / 2;
  double worst = 0;
  for (size_t i = 0; i < 2; ++i) {
    Setup one;
    one.speeds = {s.speeds[i]};
    Run alone(one, none);
    alone.steps(10);
    for (size_t k = 0; k < n; ++k) {
      worst = std::max(worst, std::fabs(both.position()[i * n + k] - s.bases[i][k % 3] - alone.position()[k]));
    }
  }
  expect(worst < 1e-9, "two turbines move as each does alone: difference, m", worst);
  expect(table("t2").size() == 10, "each has its table", 0);
}

// Deflection of blade 1's tip out of the rotor's plane, against the hub's rotation.
double bend(const std::array<double, 13>& row, const Vector& straight)
{
  const Vector rigid = turned(straight, rpm * pi / 30 * row[TIME]);
  const double tilt = 5 * pi / 180;
  return (row[TIP_X] - rigid[0]) * std::cos(tilt) - (row[TIP_Z] - rigid[2]) * std::sin(tilt);
}

void test_start()
{
  nrel5mw data;
  nrel5mw_rotor rotor;
  Vector straight;
  double q[4];
  nrel5mw_load(&data, SPAR_DATA_DIR "/nrel5mw");
  nrel5mw_rotor_default(&data, &rotor);
  nrel5mw_root(&data, &rotor, 0, 0, straight.data(), q);
  const double tilt = data.tilt, up = 87.6 + 1.96256, over = 5.0191;
  straight[0] += -over * std::cos(tilt) + data.length * (1 - 2 * (q[2] * q[2] + q[3] * q[3]));
  straight[1] += data.length * 2 * (q[1] * q[2] + q[0] * q[3]);
  straight[2] += up + over * std::sin(tilt) + data.length * 2 * (q[1] * q[3] - q[0] * q[2]);
  nrel5mw_free(&data);

  // Under the loads of the start alone (the ramp of the flow's takes for ever) the blade keeps its shape but for what gravity
  // does around the circle; from straight it springs to twice as far.
  std::vector<Saved> none;
  double least[2] = {1e9, 1e9}, most[2] = {-1e9, -1e9};
  for (int k = 0; k < 2; ++k) {
    Setup s;
    s.more = k == 0 ? ", start_wind: 8, load_ramp: 1e9" : "";
    Run run(s, none);
    run.steps(80);
    for (const auto& row : table("t1")) {
      least[k] = std::min(least[k], bend(row, straight));
      most[k] = std::max(most[k], bend(row, straight));
    }
  }
  const double change = (most[0] - least[0]) / most[0], spring = (most[1] - least[1]) / most[1];
  expect(most[0] > 2 && change < 0.1, "static start: change of the tip's deflection in 1.6 s, relative", change);
  expect(spring > 0.8, "without it: the same", spring);

  // On the ramp the flow has the share 3 s^2 - 2 s^3 of the loads.
  Setup s;
  s.more = ", start_wind: 8, load_ramp: 0.2";
  Run run(s, none);
  double worst = 0;
  for (int i = 1; i <= 12; ++i) {
    run.steps(1);
    const double way = std::min(i * dt0 / 0.2, 1.0), share = way * way * (3 - 2 * way);
    const auto rows = table("t1");
    worst = world == 0 ? std::max(worst, std::fabs(rows.back()[FORCE_X] / run.force() - share)) : 0;
  }
  expect(worst < 1e-12, "on the ramp the flow's share of the loads: error", worst);

  // After it blade elements push nothing more: in no wind at all the bent blade swings back beyond the shape it would be held in.
  Run calm(s, none);
  CalcLoads::flow = nullptr;
  calm.steps(80);
  double back = 1e9;
  for (const auto& row : table("t1")) {
    back = std::min(back, bend(row, straight));
  }
  expect(back < 0.3 * most[0], "after the ramp no load of the start is left: least deflection over that of the start", back / most[0]);
}

void test_whole()
{
  std::vector<Saved> none;
  Setup s;
  s.whole = true;
  s.more = ", start_wind: 8";
  Run run(s, none);
  run.steps(20);
  const auto rows = table("t1");
  expect(strain(run, "t1nacelle") < 1e-9, "the nacelle's mesh stays rigid: change of a distance, m", strain(run, "t1nacelle"));
  expect(strain(run, "t1hub") < 1e-9, "the hub's mesh stays rigid: change of a distance, m", strain(run, "t1hub"));
  const Vector foot = run.ring("t1tower", 0), top = run.ring("t1tower", -1);
  expect(distance(foot, {0, 0, 0}) < 1e-12, "the tower's foot stays: moved by, m", distance(foot, {0, 0, 0}));
  expect(top[0] > 0.05 && top[0] < 0.5, "its top leans with the wind: by, m", top[0]);
  // all walls together, tower and nacelle too
  const double off = world == 0 ? std::fabs(rows.back()[FORCE_X] / run.force() - 1) : 0;
  expect(off < 1e-12, "force in the table against the sum over all walls, relative", off);

  // The controller, fed with the speeds of the table, gives the generator's torque; it and the torque of the stream about the
  // leaning shaft, 1/20 of it, slow the rotor's 3.87e7 kg m^2 and the generator's 5.03e6. Half a second is left to the drivetrain,
  // which was wound up by the loads of the start; the blades' edgewise motion remains, 1/20.
  run.steps(130);
  const auto more = table("t1");
  turbine_control control;
  turbine_control_begin(&control, turbine_gear * rpm * pi / 30, 0);
  double push = 0, before = rpm * pi / 30, first = 0;
  for (size_t i = 0; i < more.size(); ++i) {
    turbine_control_step(&control, turbine_gear * before, dt0);
    before = more[i][SPEED] * pi / 30;
    first = i < 25 ? before : first;
    push += i < 25 ? 0 : dt0 * (turbine_gear * control.torque + std::sin(5 * pi / 180) * more[i][MOMENT_Z]);
  }
  const double ratio = (3.87e7 + 5.03e6) * (first - before) / push;
  expect(ratio > 0.9 && ratio < 1.1, "the generator slows the rotor: change of angular momentum over its torque's", ratio);
}

} // namespace

int main(int argc, char** argv)
{
  MPI_Init(&argc, &argv);
  MPI_Comm_rank(MPI_COMM_WORLD, &world);
  for (int n = 0; n < 100 && world == 0; ++n) { // of an earlier run of the tests
    std::remove(("spar_fsi.t1.csv" + (n > 0 ? "." + std::to_string(n) : "")).c_str());
    std::remove(("spar_fsi.t2.csv" + (n > 0 ? "." + std::to_string(n) : "")).c_str());
  }
  MPI_Barrier(MPI_COMM_WORLD);
  try {
    test_container();
    test_rotor();
    test_ranks();
    test_faces();
    test_restart(false);
    test_adaptive();
    test_farm();
    test_start();
    test_whole();
    test_driver();
    test_restart(true);
  } catch (const std::exception& e) {
    std::printf("rank %d: %s\n", world, e.what());
    MPI_Abort(MPI_COMM_WORLD, 1);
  }
  MPI_Finalize();
  return failures == 0 ? 0 : 1;
}
