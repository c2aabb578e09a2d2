#include "aero/spar/SparFSI.h"

#include "FieldTypeDef.h"
#include "master_element/MasterElement.h"
#include "master_element/MasterElementRepo.h"
#include "stk_mesh/base/Field.hpp"
#include "utils/ComputeVectorDivergence.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <mpi.h>
#include <sstream>
#include <stdexcept>

namespace sierra {
namespace nalu {

namespace {

// Where parts meet, the later ones have the nodes.
constexpr int order[] = {FSI_TOWER, FSI_NACELLE, FSI_HUB, 0, 1, 2};

// Points of a face: four of a quadrilateral, as Nalu-Wind's own FSI assumes.
constexpr int maxFacePoints = 4;

template <typename T>
T
value_or(const YAML::Node& node, const std::string& key, const T& otherwise)
{
  return node[key] ? node[key].as<T>() : otherwise;
}

// One name, or a list of names.
std::vector<std::string>
names_of(const YAML::Node& node)
{
  if (!node)
    return {};
  if (node.IsSequence())
    return node.as<std::vector<std::string>>();
  return {node.as<std::string>()};
}

void
refuse_other_keys(
  const YAML::Node& node,
  const std::vector<std::string>& keys,
  const std::string& where)
{
  if (!node.IsMap())
    throw std::runtime_error(where + ": a map of keys is wanted");
  for (const auto& pair : node) {
    const auto key = pair.first.as<std::string>();
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) {
      std::string known;
      for (const auto& k : keys)
        known += " " + k;
      throw std::runtime_error(
        where + ": unknown key '" + key + "'; known keys are" + known);
    }
  }
}

std::string
text_of(double x)
{
  std::ostringstream out;
  out.precision(12);
  out << x;
  return out.str();
}

class Timer
{
public:
  explicit Timer(double& sum) : sum_(sum), begin_(MPI_Wtime()) {}
  ~Timer() { sum_ += MPI_Wtime() - begin_; }
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

private:
  double& sum_;
  double begin_;
};

} // namespace

SparFSI::SparFSI(const YAML::Node& node)
{
  refuse_other_keys(node, {"turbines", "restart_file"}, "spar_fsi");
  restartFile_ = value_or<std::string>(node, "restart_file", "");
  const YAML::Node list = node["turbines"];
  if (!list || !list.IsSequence() || list.size() == 0)
    throw std::runtime_error("spar_fsi: a list of turbines is wanted");
  for (size_t i = 0; i < list.size(); ++i) {
    turbines_.push_back(read_turbine(list[i], i + 1));
    for (size_t k = 0; k < i; ++k)
      if (turbines_[k].name == turbines_[i].name)
        throw std::runtime_error(
          "spar_fsi: two turbines have the name '" + turbines_[i].name +
          "', which names their files; give each its own");
  }
}

SparFSI::Turbine
SparFSI::read_turbine(const YAML::Node& node, size_t number) const
{
  Turbine t;
  const std::string what = "spar_fsi: turbine " + std::to_string(number);
  refuse_other_keys(
    node,
    {"name", "data", "base", "whole", "rotor_speed_rpm", "pitch_deg",
     "start_wind", "load_ramp", "ramp_length", "gravity", "nodes_blade",
     "blade_parts", "blade_boundary_parts", "hub_parts", "hub_boundary_parts",
     "nacelle_parts", "nacelle_boundary_parts", "tower_parts",
     "tower_boundary_parts"},
    what);
  t.name = value_or<std::string>(node, "name", "T" + std::to_string(number));
  if (t.name.empty() || t.name.find('/') != std::string::npos)
    throw std::runtime_error(
      what + ": name '" + t.name + "' cannot be part of a file's name");
  for (const char* key :
       {"data", "base", "rotor_speed_rpm", "blade_parts",
        "blade_boundary_parts"})
    if (!node[key])
      throw std::runtime_error(what + ": the key " + key + " is wanted");
  t.data = node["data"].as<std::string>();
  const auto base = node["base"].as<std::vector<double>>();
  const YAML::Node blades = node["blade_parts"];
  const YAML::Node bladeWalls = node["blade_boundary_parts"];
  if (
    base.size() != 3 || blades.size() != FSI_BLADES ||
    bladeWalls.size() != FSI_BLADES)
    throw std::runtime_error(
      what + ": three numbers of base, three blade_parts and three "
             "blade_boundary_parts are wanted");
  fsi_default(&t.options);
  std::copy(base.begin(), base.end(), t.options.base);
  t.options.whole = value_or(node, "whole", false) ? 1 : 0;
  t.options.rpm = node["rotor_speed_rpm"].as<double>();
  t.options.pitch = value_or(node, "pitch_deg", 0.0) * std::acos(-1.0) / 180.0;
  t.options.wind = value_or(node, "start_wind", 0.0);
  t.options.load_ramp = value_or(node, "load_ramp", 0.0);
  t.options.root_ramp = value_or(node, "ramp_length", 0.0);
  t.options.gravity = value_or(node, "gravity", t.options.gravity);
  t.options.nodes = value_or(node, "nodes_blade", t.options.nodes);
  for (size_t b = 0; b < FSI_BLADES; ++b) {
    t.parts[b].names = names_of(blades[b]);
    t.parts[b].wallNames = names_of(bladeWalls[b]);
  }
  const struct
  {
    int part;
    const char* name;
  } others[] = {
    {FSI_HUB, "hub"}, {FSI_NACELLE, "nacelle"}, {FSI_TOWER, "tower"}};
  for (const auto& other : others) {
    t.parts[other.part].names =
      names_of(node[std::string(other.name) + "_parts"]);
    t.parts[other.part].wallNames =
      names_of(node[std::string(other.name) + "_boundary_parts"]);
  }
  return t;
}

SparFSI::~SparFSI() { end_spar(); }

void
SparFSI::end_spar()
{
  for (auto& t : turbines_)
    fsi_turbine_destroy(&t.fsi);
}

// Collective calls fail on every rank, so that all of them leave.
void
SparFSI::check(
  const Turbine& turbine, int status, const std::string& what) const
{
  if (status != SPAR_OK)
    throw std::runtime_error(
      "spar_fsi: turbine '" + turbine.name + "': " + what + ": " +
      spar_status_text(status) + ": " + fsi_turbine_message(turbine.fsi));
}

// After calls that are this rank's alone: a failure on one rank is one on all.
int
SparFSI::agree(int status) const
{
  int worst = SPAR_OK;
  MPI_Allreduce(&status, &worst, 1, MPI_INT, MPI_MAX, bulk_->parallel());
  return status != SPAR_OK ? status : worst;
}

// ---- before the mesh is read ----

void
SparFSI::find_parts(Turbine& turbine)
{
  auto& meta = bulk_->mesh_meta_data();
  const auto find = [&](const std::string& name) {
    auto* part = meta.get_part(name);
    if (part == nullptr)
      throw std::runtime_error(
        "spar_fsi: turbine '" + turbine.name + "': the mesh has no part '" +
        name + "'");
    return part;
  };
  for (auto& part : turbine.parts) {
    for (const auto& name : part.names) {
      part.blocks.push_back(find(name));
      parts_.push_back(part.blocks.back());
    }
    for (const auto& name : part.wallNames) {
      part.walls.push_back(find(name));
      bndryParts_.push_back(part.walls.back());
      bndryPartNames_.push_back(name);
    }
  }
}

// What Nalu-Wind declares for OpenFAST's turbines alone.
void
SparFSI::declare_fields()
{
  auto& meta = bulk_->mesh_meta_data();
  auto* tforce = meta.get_field<double>(meta.side_rank(), "tforce_scs");
  if (tforce == nullptr)
    tforce = &meta.declare_field<double>(meta.side_rank(), "tforce_scs");
  for (auto* wall : bndryParts_)
    stk::mesh::put_field_on_mesh(*tforce, *wall, 3 * maxFacePoints, nullptr);
  auto* div =
    meta.get_field<double>(stk::topology::NODE_RANK, "div_mesh_velocity");
  if (div == nullptr)
    div = &meta.declare_field<double>(
      stk::topology::NODE_RANK, "div_mesh_velocity");
  stk::mesh::put_field_on_mesh(*div, meta.universal_part(), nullptr);
}

void
SparFSI::setup(double dtNalu, std::shared_ptr<stk::mesh::BulkData> bulk)
{
  bulk_ = bulk;
  dt_ = dtNalu;
  for (auto& t : turbines_) {
    find_parts(t);
    t.options.data = t.data.c_str();
    t.options.rank = bulk_->parallel_rank();
    t.options.ranks = bulk_->parallel_size();
    t.options.fcomm = static_cast<int>(MPI_Comm_c2f(bulk_->parallel()));
    check(t, fsi_turbine_create(&t.options, &t.fsi), "setup");
  }
  declare_fields();
  calcLoads_ = std::make_unique<CalcLoads>(bndryParts_);
  calcLoads_->setup(bulk_);
}

// ---- the meshes ----

// Nodes that this rank owns or shares: each rank moves its own copies, to the
// same positions.
std::vector<double>
SparFSI::node_positions(Part& part) const
{
  auto& meta = bulk_->mesh_meta_data();
  const auto* modelCoords =
    meta.get_field<double>(stk::topology::NODE_RANK, "coordinates");
  const stk::mesh::Selector sel =
    (meta.locally_owned_part() | meta.globally_shared_part()) &
    stk::mesh::selectUnion(part.blocks);
  std::vector<double> x;
  part.nodes.clear();
  for (const auto* b : bulk_->get_buckets(stk::topology::NODE_RANK, sel))
    for (size_t in = 0; in < b->size(); ++in) {
      part.nodes.push_back((*b)[in]);
      const double* at = stk::mesh::field_data(*modelCoords, (*b)[in]);
      x.insert(x.end(), at, at + 3);
    }
  return x;
}

// Integration points of the walls' faces in the reference configuration, of
// the faces that this rank owns, so that each force is there once. The faces
// are kept: buckets come in another order after any change of the mesh.
std::vector<double>
SparFSI::wall_points(Part& part) const
{
  auto& meta = bulk_->mesh_meta_data();
  const auto* modelCoords =
    meta.get_field<double>(stk::topology::NODE_RANK, "coordinates");
  const stk::mesh::Selector sel =
    meta.locally_owned_part() & stk::mesh::selectUnion(part.walls);
  std::vector<double> points;
  std::vector<double> shape;
  part.faces.clear();
  for (const auto* b : bulk_->get_buckets(meta.side_rank(), sel)) {
    MasterElement* meFC =
      MasterElementRepo::get_surface_master_element_on_host(b->topology());
    const int nodesPerFace = meFC->nodesPerElement_;
    const int numIp = meFC->num_integration_points();
    shape.resize(static_cast<size_t>(numIp) * nodesPerFace);
    SharedMemView<double**, HostShmem> shapeView(
      shape.data(), numIp, nodesPerFace);
    meFC->shape_fcn<>(shapeView);
    for (size_t in = 0; in < b->size(); ++in) {
      part.faces.push_back({(*b)[in], numIp});
      const stk::mesh::Entity* faceNodes = bulk_->begin_nodes((*b)[in]);
      for (int ip = 0; ip < numIp; ++ip)
        for (int i = 0; i < 3; ++i) {
          double x = 0.0;
          for (int ni = 0; ni < nodesPerFace; ++ni)
            x += shapeView(ip, ni) *
                 stk::mesh::field_data(*modelCoords, faceNodes[ni])[i];
          points.push_back(x);
        }
    }
  }
  return points;
}

int
SparFSI::set_mesh(Turbine& turbine, int number)
{
  Part& part = turbine.parts[number];
  if (part.names.empty() && part.wallNames.empty())
    return SPAR_OK;
  const auto x = node_positions(part);
  const auto y = wall_points(part);
  for (const auto& face : part.faces)
    if (face.points > maxFacePoints)
      throw std::runtime_error(
        "spar_fsi: turbine '" + turbine.name + "': a wall has faces of " +
        std::to_string(face.points) +
        " integration points; give it quadrilaterals or triangles");
  return fsi_turbine_set_mesh(
    turbine.fsi, number, static_cast<int64_t>(part.nodes.size()), x.data(),
    static_cast<int64_t>(y.size() / 3), y.data());
}

// ---- the beginning ----

void
SparFSI::start(double curTime)
{
  if (curTime != 0.0)
    throw std::runtime_error(
      "spar_fsi: Nalu-Wind starts at " + text_of(curTime) +
      " s, the structure at 0 s; give start_time 0, or a restart_file");
  for (auto& t : turbines_)
    check(t, fsi_turbine_start(t.fsi), "the initial state");
}

void
SparFSI::load()
{
  for (auto& t : turbines_) {
    const std::string file = restartFile_ + "." + t.name;
    check(t, agree(fsi_turbine_load(t.fsi, file.c_str())), file);
    double time = 0.0;
    fsi_turbine_get_time(t.fsi, &time);
    if (std::fabs(time - clock()) > 1e-6 * dt_)
      throw std::runtime_error(
        "spar_fsi: " + file + " is of " + text_of(time) + " s, " +
        restartFile_ + "." + turbines_[0].name + " of " + text_of(clock()) +
        " s; give the files of one step");
  }
}

void
SparFSI::initialize(double curTime)
{
  auto& meta = bulk_->mesh_meta_data();
  calcLoads_->initialize();
  meta.get_field<double>(stk::topology::NODE_RANK, "coordinates")
    ->sync_to_host();
  for (auto& t : turbines_)
    for (const int part : order)
      check(t, agree(set_mesh(t, part)), "mapping the mesh");
  if (restartFile_.empty())
    start(curTime);
  else
    load();
  stepDt_ = dt_;
  beginTime_ = clock();
  move_mesh(false);
  if (restartFile_.empty())
    set_old_displacements();
}

double
SparFSI::clock() const
{
  double time = 0.0;
  fsi_turbine_get_time(turbines_[0].fsi, &time);
  return time;
}

// Before the first step the mesh has come with the velocity that it has now, as
// OpenfastFSI has it.
void
SparFSI::set_old_displacements()
{
  auto& meta = bulk_->mesh_meta_data();
  auto* disp =
    meta.get_field<double>(stk::topology::NODE_RANK, "mesh_displacement");
  auto* vel = meta.get_field<double>(stk::topology::NODE_RANK, "mesh_velocity");
  auto& dispN = disp->field_of_state(stk::mesh::StateN);
  auto& dispNm1 = disp->field_of_state(stk::mesh::StateNM1);
  dispN.sync_to_host();
  dispNm1.sync_to_host();
  for (const auto& t : turbines_)
    for (const auto& part : t.parts)
      for (const auto node : part.nodes) {
        const double* d = stk::mesh::field_data(*disp, node);
        const double* v = stk::mesh::field_data(*vel, node);
        double* dn = stk::mesh::field_data(dispN, node);
        double* dnm1 = stk::mesh::field_data(dispNm1, node);
        for (int i = 0; i < 3; ++i) {
          dn[i] = d[i] - dt_ * v[i];
          dnm1[i] = d[i] - 2.0 * dt_ * v[i];
        }
      }
  for (auto* field : {&dispN, &dispNm1}) {
    field->modify_on_host();
    field->sync_to_device();
  }
}

// ---- a step ----

// Outside a step Nalu-Wind asks for the mesh only after it has read a restart,
// at the time that its input names.
void
SparFSI::map_displacements(double curTime, bool updateCurCoor)
{
  const double now = inStep_ ? clock() + stepDt_ : clock();
  if (std::fabs(curTime - now) > (inStep_ ? 1e-6 : 1e-2) * stepDt_) {
    const std::string times = "spar_fsi: Nalu-Wind is at " + text_of(curTime) +
                              " s, the structure at " + text_of(now) + " s";
    throw std::runtime_error(
      restartFile_.empty()
        ? times + "; a run that goes on wants restart_file: spar_fsi.STEP, "
                  "the files written with the restart of that time"
        : times + "; give restart_time the time of " + restartFile_ +
            ", or the restart_file of that time");
  }
  restarted_ = restarted_ || !inStep_;
  move_mesh(updateCurCoor);
}

void
SparFSI::move_mesh(bool updateCurCoor)
{
  const Timer timer(meshTime_);
  auto& meta = bulk_->mesh_meta_data();
  auto* model = meta.get_field<double>(stk::topology::NODE_RANK, "coordinates");
  auto* cur =
    meta.get_field<double>(stk::topology::NODE_RANK, "current_coordinates");
  auto* disp =
    meta.get_field<double>(stk::topology::NODE_RANK, "mesh_displacement");
  auto* vel = meta.get_field<double>(stk::topology::NODE_RANK, "mesh_velocity");
  for (auto* field : {model, cur, disp, vel})
    field->sync_to_host();
  for (auto& t : turbines_)
    for (const int number : order) {
      const auto& nodes = t.parts[number].nodes;
      if (nodes.empty())
        continue;
      std::vector<double> x(3 * nodes.size());
      std::vector<double> v(3 * nodes.size());
      check(
        t, fsi_turbine_get_motion(t.fsi, number, x.data(), v.data()),
        "moving the mesh");
      for (size_t n = 0; n < nodes.size(); ++n) {
        const double* at = stk::mesh::field_data(*model, nodes[n]);
        double* d = stk::mesh::field_data(*disp, nodes[n]);
        double* w = stk::mesh::field_data(*vel, nodes[n]);
        double* c = stk::mesh::field_data(*cur, nodes[n]);
        for (size_t i = 0; i < 3; ++i) {
          d[i] = x[3 * n + i] - at[i];
          w[i] = v[3 * n + i];
          if (updateCurCoor)
            c[i] = x[3 * n + i];
        }
      }
    }
  for (auto* field : {cur, disp, vel}) {
    field->modify_on_host();
    field->sync_to_device();
  }
}

// The mesh goes where the structure goes under extrapolated loads; asked again
// within the step, where the last loads have put it. The step is what is left to Nalu-Wind's clock, so that it may change; one
// that differs by rounding alone stays as it was.
void
SparFSI::predict_struct_states(double curTime)
{
  const double now = clock();
  const double dt = curTime - now;
  if (!restartFile_.empty() && !restarted_)
    throw std::runtime_error(
      "spar_fsi: restart_file is given, but Nalu-Wind does not restart; give "
      "restart_time " +
      text_of(now) + ", or leave restart_file out");
  if (!(dt > 0.0))
    throw std::runtime_error(
      "spar_fsi: Nalu-Wind steps to " + text_of(curTime) +
      " s, but the structure is at " + text_of(now) +
      " s; restart_file and restart_time are of one time");
  if (std::fabs(dt - stepDt_) > 1e-9 * stepDt_)
    stepDt_ = dt;
  const Timer timer(structureTime_);
  for (auto& t : turbines_) {
    check(t, fsi_turbine_begin(t.fsi, now + stepDt_), "predicting");
    fsi_turbine_get_tip(t.fsi, 0, t.meshTip.data());
  }
  inStep_ = true;
}

void
SparFSI::push_loads(Turbine& turbine, int number)
{
  auto& meta = bulk_->mesh_meta_data();
  const auto* tforce = meta.get_field<double>(meta.side_rank(), "tforce_scs");
  const Part& part = turbine.parts[number];
  if (part.names.empty() && part.wallNames.empty())
    return;
  std::vector<double> force;
  for (const auto& face : part.faces) {
    if (!bulk_->is_valid(face.entity)) {
      fsi_turbine_fail(
        turbine.fsi, number,
        "a face of a wall has left this rank; do not change the mesh after "
        "the start");
      return;
    }
    const double* f = stk::mesh::field_data(*tforce, face.entity);
    force.insert(force.end(), f, f + 3 * face.points);
  }
  // of a push that is refused (not a number) the next collective call tells
  // every rank
  fsi_turbine_push(turbine.fsi, number, force.data());
}

void
SparFSI::predict_struct_timestep(double /*curTime*/)
{
  {
    const Timer timer(meshTime_);
    auto& meta = bulk_->mesh_meta_data();
    calcLoads_->execute();
    meta.get_field<double>(meta.side_rank(), "tforce_scs")->sync_to_host();
    for (auto& t : turbines_)
      for (const int part : order)
        push_loads(t, part);
  }
  const Timer timer(structureTime_);
  for (auto& t : turbines_)
    check(t, fsi_turbine_iterate(t.fsi), "the structure's step");
}

void
SparFSI::advance_struct_timestep(double curTime, double dT)
{
  if (std::fabs(dT - stepDt_) > 1e-6 * dT)
    throw std::runtime_error(
      "spar_fsi: Nalu-Wind made a step of " + text_of(dT) + " s to " +
      text_of(curTime) + " s, the structure one of " + text_of(stepDt_) +
      " s; a run begins at 0 s, or with restart_file and restart_time of one "
      "time");
  const Timer timer(structureTime_);
  for (auto& t : turbines_) {
    check(t, fsi_turbine_accept(t.fsi), "the end of the step");
    if (accepted_ == 0)
      begin_output(t);
    write_output(t);
  }
  inStep_ = false;
  ++accepted_;
}

// Nalu-Wind writes the state that it has just read once more: that file stays.
void
SparFSI::write_restart(int stepCount)
{
  if (accepted_ == 0)
    return;
  for (auto& t : turbines_) {
    const std::string file =
      "spar_fsi." + std::to_string(stepCount) + "." + t.name;
    check(t, agree(fsi_turbine_save(t.fsi, file.c_str())), file);
  }
}

// ---- output: a table for each turbine, which a restart continues ----

// Of the table of the run that this one continues: the heading, and the lines
// up to where this run begins.
std::vector<std::string>
SparFSI::old_lines(const std::string& path) const
{
  std::vector<std::string> lines;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);)
    if (
      lines.empty() ||
      std::strtod(line.c_str(), nullptr) <= beginTime_ + 1e-6 * dt_)
      lines.push_back(line);
  return lines;
}

// At the end of the first step: a run that is refused before leaves the table
// of another as it is. A new run keeps an older table aside.
void
SparFSI::begin_output(const Turbine& t) const
{
  if (bulk_->parallel_rank() != 0)
    return;
  const std::string path = "spar_fsi." + t.name + ".csv";
  std::vector<std::string> lines;
  if (!restartFile_.empty())
    lines = old_lines(path);
  else
    for (int n = 1; std::ifstream(path).good(); ++n) {
      const std::string aside = path + "." + std::to_string(n);
      if (
        !std::ifstream(aside).good() &&
        std::rename(path.c_str(), aside.c_str()) != 0)
        throw std::runtime_error("spar_fsi: " + path + " cannot be renamed");
    }
  if (lines.empty())
    lines.emplace_back(
      "time_s,rotor_speed_rpm,pitch_deg,force_x_N,force_y_N,force_z_N,"
      "moment_x_Nm,moment_y_Nm,moment_z_Nm,tip1_x_m,tip1_y_m,tip1_z_m,"
      "tip1_from_mesh_m");
  std::ofstream out(path);
  for (const auto& line : lines)
    out << line << '\n';
}

// Loads of the flow, moments about the foot of the tower; how far the structure
// has ended from where the mesh is.
void
SparFSI::write_output(const Turbine& t) const
{
  const double degree = std::acos(-1.0) / 180.0;
  double time = 0.0, speed = 0.0, pitch = 0.0, load[6], tip[3], gap = 0.0;
  check(t, fsi_turbine_get_load(t.fsi, load, load + 3), "the loads");
  fsi_turbine_get_time(t.fsi, &time);
  fsi_turbine_get_rotor(t.fsi, &speed, &pitch);
  fsi_turbine_get_tip(t.fsi, 0, tip);
  for (int i = 0; i < 3; ++i)
    gap = std::hypot(gap, tip[i] - t.meshTip[i]);
  if (bulk_->parallel_rank() != 0)
    return;
  std::ofstream out("spar_fsi." + t.name + ".csv", std::ios::app);
  out.precision(15);
  out << time << ',' << speed / degree / 6.0 << ',' << pitch / degree;
  for (const double x : load)
    out << ',' << x;
  for (const double x : tip)
    out << ',' << x;
  out << ',' << gap << '\n';
}

void
SparFSI::compute_div_mesh_velocity()
{
  const Timer timer(meshTime_);
  auto& meta = bulk_->mesh_meta_data();
  auto* div =
    meta.get_field<double>(stk::topology::NODE_RANK, "div_mesh_velocity");
  auto* face =
    meta.get_field<double>(stk::topology::EDGE_RANK, "edge_face_velocity_mag");
  compute_edge_scalar_divergence(*bulk_, parts_, bndryParts_, face, div);
}

} // namespace nalu
} // namespace sierra
