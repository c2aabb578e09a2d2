// Blades of spar in Nalu-Wind's aero container, beside OpenfastFSI and with its calls: spar moves the mesh blocks
// around the blades, and takes the forces of their walls.
#ifndef SPARFSI_H
#define SPARFSI_H

#include "aero/fsi/CalcLoads.h"
#include "aero/fsi/fsi_rotor.h"
#include "stk_mesh/base/BulkData.hpp"
#include "stk_mesh/base/MetaData.hpp"
#include "yaml-cpp/yaml.h"

#include <memory>
#include <string>
#include <vector>

namespace sierra {
namespace nalu {

class SparFSI {
  public:
    explicit SparFSI(const YAML::Node &node);
    ~SparFSI();
    SparFSI(const SparFSI &) = delete;
    SparFSI &operator=(const SparFSI &) = delete;

    void setup(double dtNalu, std::shared_ptr<stk::mesh::BulkData> bulk);
    void initialize(int restartFreqNalu, double curTime);
    void map_displacements(double curTime, bool updateCurCoor);
    void predict_struct_states();
    void predict_struct_timestep(const double curTime);
    void advance_struct_timestep(const double curTime);
    void compute_div_mesh_velocity();
    void end_spar();

    //! The blocks that spar moves, and their walls
    const stk::mesh::PartVector &parts() const {
        return parts_;
    }
    const stk::mesh::PartVector &bndry_parts() const {
        return bndryParts_;
    }

    fsi_rotor *rotor() {
        return rotor_;
    }

  private:
    void check(int status, const std::string &what) const;
    std::vector<stk::mesh::Entity> nodes_of(int blade) const;
    std::vector<double> wall_points(int blade) const;
    void set_meshes();
    void push_loads();
    void set_old_displacements();

    std::shared_ptr<stk::mesh::BulkData> bulk_;
    std::string data_, restartFile_;
    std::vector<std::string> partNames_, bndryPartNames_;
    stk::mesh::PartVector parts_, bndryParts_;
    std::unique_ptr<CalcLoads> calcLoads_;
    fsi_rotor_options options_{};
    fsi_rotor *rotor_{nullptr};
    std::vector<std::vector<stk::mesh::Entity>> nodes_; // of each blade, on this rank
    double dt_{-1.0};
    int restartFreq_{0};
    int tStep_{0};
};

} // namespace nalu
} // namespace sierra

#endif
