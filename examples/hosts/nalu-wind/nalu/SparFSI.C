#include "aero/fsi/SparFSI.h"

#include "FieldTypeDef.h"
#include "master_element/MasterElement.h"
#include "master_element/MasterElementRepo.h"
#include "stk_mesh/base/Field.hpp"
#include "utils/ComputeVectorDivergence.h"

#include <cmath>
#include <mpi.h>
#include <stdexcept>

namespace sierra {
namespace nalu {

namespace {
template <typename T>
T
value_or(const YAML::Node& node, const std::string& key, const T& otherwise)
{
  return node[key] ? node[key].as<T>() : otherwise;
}
} // namespace

SparFSI::SparFSI(const YAML::Node& node)
  : data_(node["data"].as<std::string>()),
    restartFile_(value_or<std::string>(node, "restart_file", "")),
    partNames_(node["blade_parts"].as<std::vector<std::string>>()),
    bndryPartNames_(
      node["blade_boundary_parts"].as<std::vector<std::string>>())
{
  const auto hub = node["hub"].as<std::vector<double>>();
  if (
    partNames_.size() != FSI_BLADES || bndryPartNames_.size() != FSI_BLADES ||
    hub.size() != 3)
    throw std::runtime_error(
      "spar_fsi: three blade_parts, three blade_boundary_parts and a hub of "
      "three numbers are wanted");
  options_.rpm = node["rotor_speed_rpm"].as<double>();
  options_.pitch = value_or(node, "pitch_deg", 0.0) * std::acos(-1.0) / 180.0;
  options_.ramp = value_or(node, "ramp_length", 0.0);
  options_.gravity = value_or(node, "gravity", 9.81);
  options_.nodes = value_or(node, "nodes_blade", 10);
  for (int i = 0; i < 3; ++i)
    options_.hub[i] = hub[i];
}

SparFSI::~SparFSI() { end_spar(); }

void
SparFSI::end_spar()
{
  fsi_rotor_destroy(&rotor_);
}

// Collective calls fail on every rank, so that all of them leave.
void
SparFSI::check(int status, const std::string& what) const
{
  if (status != SPAR_OK)
    throw std::runtime_error(
      "SparFSI: " + what + ": " + spar_status_text(status) + ": " +
      fsi_rotor_message(rotor_));
}

void
SparFSI::setup(double dtNalu, std::shared_ptr<stk::mesh::BulkData> bulk)
{
  bulk_ = bulk;
  dt_ = dtNalu;
  auto& meta = bulk_->mesh_meta_data();
  for (int b = 0; b < FSI_BLADES; ++b) {
    auto* part = meta.get_part(partNames_[b]);
    auto* wall = meta.get_part(bndryPartNames_[b]);
    if (part == nullptr || wall == nullptr)
      throw std::runtime_error(
        "spar_fsi: the mesh has no part " +
        (part == nullptr ? partNames_[b] : bndryPartNames_[b]));
    parts_.push_back(part);
    bndryParts_.push_back(wall);
  }
  calcLoads_ = std::make_unique<CalcLoads>(bndryParts_);
  calcLoads_->setup(bulk_);

  options_.data = data_.c_str();
  options_.ranks = bulk_->parallel_size();
  options_.fcomm = static_cast<int>(MPI_Comm_c2f(bulk_->parallel()));
  check(fsi_rotor_create(&options_, &rotor_), "setup");
}

// Nodes that this rank owns or shares: each rank moves its own copies, to the same places.
std::vector<stk::mesh::Entity>
SparFSI::nodes_of(int blade) const
{
  auto& meta = bulk_->mesh_meta_data();
  const stk::mesh::Selector sel =
    (meta.locally_owned_part() | meta.globally_shared_part()) &
    stk::mesh::Selector(*parts_[blade]);
  std::vector<stk::mesh::Entity> nodes;
  for (const auto* b : bulk_->get_buckets(stk::topology::NODE_RANK, sel))
    for (size_t in = 0; in < b->size(); ++in)
      nodes.push_back((*b)[in]);
  return nodes;
}

// Integration points of the walls' faces in the reference configuration, in the order in which their forces stand: of the faces
// that this rank owns, so that each force is there once.
std::vector<double>
SparFSI::wall_points(int blade) const
{
  auto& meta = bulk_->mesh_meta_data();
  const auto* modelCoords =
    meta.get_field<double>(stk::topology::NODE_RANK, "coordinates");
  const stk::mesh::Selector sel =
    meta.locally_owned_part() & stk::mesh::Selector(*bndryParts_[blade]);
  std::vector<double> points;
  std::vector<double> shape;
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

void
SparFSI::set_meshes()
{
  auto& meta = bulk_->mesh_meta_data();
  auto* modelCoords =
    meta.get_field<double>(stk::topology::NODE_RANK, "coordinates");
  modelCoords->sync_to_host();
  nodes_.clear();
  int status = SPAR_OK;
  for (int b = 0; b < FSI_BLADES; ++b) {
    nodes_.push_back(nodes_of(b));
    std::vector<double> x;
    for (const auto node : nodes_[b]) {
      const double* at = stk::mesh::field_data(*modelCoords, node);
      x.insert(x.end(), at, at + 3);
    }
    const auto y = wall_points(b);
    const int one = fsi_rotor_set_mesh(
      rotor_, b, static_cast<int64_t>(nodes_[b].size()), x.data(),
      static_cast<int64_t>(y.size() / 3), y.data());
    status = status != SPAR_OK ? status : one;
  }
  // the calls above are this rank's alone: the ranks agree before the next one that is not
  int worst = SPAR_OK;
  MPI_Allreduce(&status, &worst, 1, MPI_INT, MPI_MAX, bulk_->parallel());
  check(status != SPAR_OK ? status : worst, "mapping the meshes");
}

void
SparFSI::initialize(int restartFreqNalu, double curTime)
{
  restartFreq_ = restartFreqNalu;
  calcLoads_->initialize();
  set_meshes();
  if (!restartFile_.empty()) {
    check(fsi_rotor_load(rotor_, restartFile_.c_str()), restartFile_);
    tStep_ = static_cast<int>(std::lround(curTime / dt_));
  } else if (curTime < 1e-10) {
    push_loads(); // at t = 0, for the predictor to start from
  } else {
    throw std::runtime_error("spar_fsi: a run that goes on wants a restart_file");
  }
  map_displacements(curTime, false);
  if (curTime < 1e-10)
    set_old_displacements();
}

// Before the first step the mesh has come with the velocity that it has now, as OpenfastFSI has it.
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
  for (const auto& blade : nodes_)
    for (const auto node : blade) {
      const double* d = stk::mesh::field_data(*disp, node);
      const double* v = stk::mesh::field_data(*vel, node);
      double* dn = stk::mesh::field_data(dispN, node);
      double* dnm1 = stk::mesh::field_data(dispNm1, node);
      for (int i = 0; i < 3; ++i) {
        dn[i] = d[i] - dt_ * v[i];
        dnm1[i] = d[i] - 2.0 * dt_ * v[i];
      }
    }
  dispN.modify_on_host();
  dispNm1.modify_on_host();
}

void
SparFSI::map_displacements(double /*curTime*/, bool updateCurCoor)
{
  auto& meta = bulk_->mesh_meta_data();
  auto* model =
    meta.get_field<double>(stk::topology::NODE_RANK, "coordinates");
  auto* cur =
    meta.get_field<double>(stk::topology::NODE_RANK, "current_coordinates");
  auto* disp =
    meta.get_field<double>(stk::topology::NODE_RANK, "mesh_displacement");
  auto* vel = meta.get_field<double>(stk::topology::NODE_RANK, "mesh_velocity");
  for (auto* field : {model, cur, disp, vel})
    field->sync_to_host();
  for (int b = 0; b < FSI_BLADES; ++b) {
    const auto& nodes = nodes_[b];
    std::vector<double> x(3 * nodes.size() + 1);
    std::vector<double> v(3 * nodes.size() + 1);
    check(
      fsi_rotor_get_motion(rotor_, b, x.data(), v.data()), "moving the mesh");
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

// The mesh goes where the structure goes under extrapolated loads: once a step.
void
SparFSI::predict_struct_states()
{
  check(fsi_rotor_begin(rotor_, dt_), "predicting");
}

void
SparFSI::push_loads()
{
  auto& meta = bulk_->mesh_meta_data();
  calcLoads_->execute();
  auto* tforce = meta.get_field<double>(meta.side_rank(), "tforce_scs");
  tforce->sync_to_host();
  for (int b = 0; b < FSI_BLADES; ++b) {
    const stk::mesh::Selector sel =
      meta.locally_owned_part() & stk::mesh::Selector(*bndryParts_[b]);
    std::vector<double> force;
    for (const auto* bucket : bulk_->get_buckets(meta.side_rank(), sel)) {
      const int numIp =
        MasterElementRepo::get_surface_master_element_on_host(
          bucket->topology())
          ->num_integration_points();
      for (size_t in = 0; in < bucket->size(); ++in) {
        const double* f = stk::mesh::field_data(*tforce, (*bucket)[in]);
        force.insert(force.end(), f, f + 3 * numIp);
      }
    }
    // of a push that is refused (not a number) the next collective call tells every rank
    fsi_rotor_push(rotor_, b, force.data());
  }
}

void
SparFSI::predict_struct_timestep(const double /*curTime*/)
{
  push_loads();
  check(fsi_rotor_iterate(rotor_), "the structure's step");
}

void
SparFSI::advance_struct_timestep(const double /*curTime*/)
{
  check(fsi_rotor_accept(rotor_), "the end of the step");
  ++tStep_;
  if (restartFreq_ > 0 && tStep_ % restartFreq_ == 0) {
    const std::string file = "spar_fsi." + std::to_string(tStep_);
    check(fsi_rotor_save(rotor_, file.c_str()), file);
  }
}

void
SparFSI::compute_div_mesh_velocity()
{
  auto& meta = bulk_->mesh_meta_data();
  auto* div =
    meta.get_field<double>(stk::topology::NODE_RANK, "div_mesh_velocity");
  auto* face =
    meta.get_field<double>(stk::topology::EDGE_RANK, "edge_face_velocity_mag");
  compute_edge_scalar_divergence(*bulk_, parts_, bndryParts_, face, div);
}

} // namespace nalu
} // namespace sierra
