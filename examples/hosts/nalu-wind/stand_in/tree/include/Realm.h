// A stand-in for Nalu-Wind's Realm and TimeIntegrator: the aero container is called in the order of a40e39cc. In a
// restart it is initialised at the time at which the input begins, before the restart is read; afterwards the mesh is
// asked for at the time that the input names, and the run goes on from the time in the file.
#ifndef REALM_STAND_IN_H
#define REALM_STAND_IN_H

// clang-format off
#include "aero/AeroContainer.h"

#include <functional>

namespace sierra::nalu {

struct Saved { // one time of the restart file
  double time;
  int timeStepCount;
  std::map<std::string, std::vector<double>> fields;
};

struct OutputInfo {
  bool hasRestartBlock_{false};
  int restartFreq_{500}, restartStart_{0};
  double restartTime_{-1.0}; // negative: no restart
  double startTime_{0.0};
};

class Realm {
public:
  Realm(std::shared_ptr<stk::mesh::BulkData> bulk, const YAML::Node& node, OutputInfo output, double timeStep,
    std::vector<Saved>& restartFile);
  ~Realm();
  //! Initialisation, initial condition, restart
  void initialize();
  //! A step of dt with so many nonlinear iterations
  void step(double dt, int iterations);

  std::shared_ptr<stk::mesh::BulkData> bulkData_;
  std::unique_ptr<AeroContainer> aeroModels_;
  double currentTime_;
  int timeStepCount_{0};
  //! What drives the walls once the flow has its initial condition
  std::function<void(stk::mesh::BulkData&, const stk::mesh::PartVector&)> flow;
  //! Steps as the driver of several codes makes them: the mesh is asked for in each nonlinear iteration
  bool driven{false};
  //! What happens between two nonlinear iterations
  std::function<void(int)> between;

private:
  void populate_field_data();
  void init_current_coordinates();
  void update_geometry_due_to_mesh_motion();
  void populate_restart();
  void provide_restart_output();

  OutputInfo outputInfo_;
  double timeStepFromFile_;
  std::vector<Saved>& restartFile_;
};

} // namespace sierra::nalu
// clang-format on
#endif
