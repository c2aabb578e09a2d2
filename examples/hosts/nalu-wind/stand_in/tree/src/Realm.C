#include "Realm.h"

#include "aero/fsi/CalcLoads.h"

#include <cmath>

namespace sierra {
namespace nalu {

std::function<void(stk::mesh::BulkData&, const stk::mesh::PartVector&)> CalcLoads::flow;

namespace {
// The broker of Nalu-Wind's files.
struct Broker
{
  std::vector<Saved>& file;
  const stk::mesh::MetaData& meta;
  void begin_output_step(int, double time, int count)
  {
    file.push_back({time, count, {}});
  }
  void write_defined_output_fields(int)
  {
    for (const auto& field : meta.fields)
      file.back().fields[field.first] = field.second.values;
  }
  void end_output_step(int) {}
};
} // namespace

Realm::Realm(
  std::shared_ptr<stk::mesh::BulkData> bulk,
  const YAML::Node& node,
  OutputInfo output,
  double timeStep,
  std::vector<Saved>& restartFile)
  : bulkData_(bulk),
    aeroModels_(std::make_unique<AeroContainer>(node)),
    currentTime_(output.startTime_),
    outputInfo_(output),
    timeStepFromFile_(timeStep),
    restartFile_(restartFile)
{
}

Realm::~Realm()
{
  if (aeroModels_->is_active())
    aeroModels_->clean_up();
}

// Fields that were declared get their values: zeros, and the coordinates.
void
Realm::populate_field_data()
{
  auto& meta = bulkData_->mesh_meta_data();
  for (auto& entry : meta.fields) {
    auto& field = entry.second;
    if (field.values.empty())
      field.values.assign(field.length * bulkData_->count[meta.rank[entry.first]], 0.0);
  }
}

void
Realm::init_current_coordinates()
{
  auto& fields = bulkData_->mesh_meta_data().fields;
  for (size_t i = 0; i < fields["coordinates"].values.size(); ++i)
    fields["current_coordinates"].values[i] =
      fields["coordinates"].values[i] + fields["mesh_displacement"].values[i];
}

void
Realm::initialize()
{
  CalcLoads::flow = nullptr;
  auto& meta = bulkData_->mesh_meta_data();
  for (const char* name : {"current_coordinates", "mesh_displacement", "mesh_velocity", "mesh_displacement_n", "mesh_displacement_nm1"})
    meta.declare_field<double>(stk::topology::NODE_RANK, name).length = 3;
  meta.fields["mesh_displacement"].older[0] = &meta.fields["mesh_displacement_n"];
  meta.fields["mesh_displacement"].older[1] = &meta.fields["mesh_displacement_nm1"];
  meta.declare_field<double>(stk::topology::EDGE_RANK, "edge_face_velocity_mag").length = 1;
  if (aeroModels_->is_active())
    aeroModels_->setup(timeStepFromFile_, bulkData_);
  populate_field_data();
  init_current_coordinates();
  if (aeroModels_->is_active())
    aeroModels_->init(currentTime_, outputInfo_.restartFreq_);
  CalcLoads::flow = flow; // the initial condition
  populate_restart();
  provide_restart_output();
}

void
Realm::populate_restart()
{
  if (outputInfo_.restartTime_ < 0.0)
    return;
  const Saved* found = nullptr; // the closest
  for (const auto& saved : restartFile_)
    if (
      found == nullptr || std::fabs(saved.time - outputInfo_.restartTime_) <
                            std::fabs(found->time - outputInfo_.restartTime_))
      found = &saved;
  auto& meta = bulkData_->mesh_meta_data();
  for (const auto& field : found->fields)
    meta.fields[field.first].values = field.second;
  timeStepCount_ = found->timeStepCount;
  init_current_coordinates();
  if (aeroModels_->has_fsi())
    aeroModels_->update_displacements(outputInfo_.restartTime_, true, false);
  currentTime_ = std::max(currentTime_, found->time);
}

void
Realm::update_geometry_due_to_mesh_motion()
{
  if (aeroModels_->is_active())
    aeroModels_->update_displacements(currentTime_);
  if (aeroModels_->has_fsi())
    aeroModels_->compute_div_mesh_velocity();
}

void
Realm::step(double dt, int iterations)
{
  auto& fields = bulkData_->mesh_meta_data().fields;
  currentTime_ += dt;
  timeStepCount_ += 1;
  fields["mesh_displacement_nm1"].values = fields["mesh_displacement_n"].values;
  fields["mesh_displacement_n"].values = fields["mesh_displacement"].values;
  for (int k = 0; k < iterations; ++k) {
    if (k == 0 || driven)
      update_geometry_due_to_mesh_motion();
    if (between)
      between(k);
    if (aeroModels_->is_active())
      aeroModels_->predict_model_time_step(currentTime_);
  }
  if (aeroModels_->is_active())
    aeroModels_->advance_model_time_step(currentTime_, dt);
  provide_restart_output();
}

void
Realm::provide_restart_output()
{
  const int timeStepCount = timeStepCount_;
  const int restartFileIndex_ = 0;
  const int past = timeStepCount - outputInfo_.restartStart_;
  if (outputInfo_.hasRestartBlock_ && outputInfo_.restartFreq_ > 0) {
    if (past >= 0 && past % outputInfo_.restartFreq_ == 0) {
      Broker broker{restartFile_, bulkData_->mesh_meta_data()};
      auto* ioBroker_ = &broker;
      ioBroker_->begin_output_step(restartFileIndex_, currentTime_, timeStepCount);
      ioBroker_->write_defined_output_fields(restartFileIndex_);
      ioBroker_->end_output_step(restartFileIndex_);
    }
  }
}

} // namespace nalu
} // namespace sierra
