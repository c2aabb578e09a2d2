// A stand-in for Nalu-Wind's class of the same name: its functions, and the lines that the script `apply` looks for, as
// they are at a40e39cc. The bodies are ours, and shorter.
#ifndef AEROCONTAINER_H_
#define AEROCONTAINER_H_

// clang-format off
#include "stk_mesh/base/BulkData.hpp"
#include "yaml-cpp/yaml.h"

namespace sierra::nalu {
class OpenfastFSI;
class KynemaSixDof;

class AeroContainer
{
public:
  AeroContainer(const YAML::Node& node);
  ~AeroContainer();

  void setup(double timeStep, std::shared_ptr<stk::mesh::BulkData> stkBulk);
  void init(double currentTime, double restartFrequency);
  void update_displacements(
    const double currentTime,
    const bool updateCurCoords = true,
    const bool predict = true);
  void predict_model_time_step(const double);
  void advance_model_time_step(const double, const double);
  void compute_div_mesh_velocity();
  void clean_up();

  bool is_active() { return has_fsi() || has_six_dof(); }
  bool has_fsi() { return fsiContainer_ != nullptr; }
  bool has_six_dof() { return sixDof_ != nullptr; }

  const stk::mesh::PartVector fsi_parts();
  const stk::mesh::PartVector fsi_bndry_parts();
  const std::vector<std::string> fsi_bndry_part_names();
  double openfast_accumulated_time();
  double nalu_fsi_accumulated_time();

private:
  OpenfastFSI* fsiContainer_;
  std::shared_ptr<KynemaSixDof> sixDof_;
};

} // namespace sierra::nalu
// clang-format on
#endif
