// Turbines of spar in Nalu-Wind's AeroContainer, beside OpenfastFSI and with its calls: spar moves the mesh blocks of
// blades, hub, nacelle and tower, and takes the forces of their walls.
#ifndef SPARFSI_H
#define SPARFSI_H

#include "aero/fsi/CalcLoads.h"
#include "aero/spar/fsi_turbine.h"
#include "stk_mesh/base/BulkData.hpp"
#include "stk_mesh/base/MetaData.hpp"
#include "yaml-cpp/yaml.h"

#include <array>
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
    //! Nalu-Wind calls this before it reads a restart: curTime is the time at which the input begins
    void initialize(double curTime);
    //! Moves the mesh to where the structure is; outside a step only when a restart has been read
    void map_displacements(double curTime, bool updateCurCoor);
    //! The structure goes to curTime under predicted loads, once a step: the driver of several codes asks in each of
    //! its nonlinear iterations
    void predict_struct_states(double curTime);
    void predict_struct_timestep(double curTime);
    void advance_struct_timestep(double curTime, double dT);
    void compute_div_mesh_velocity();
    //! Beside each restart that Nalu-Wind writes
    void write_restart(int stepCount);
    void end_spar();

    //! The blocks that spar moves, and their walls
    const stk::mesh::PartVector &parts() const {
        return parts_;
    }
    const stk::mesh::PartVector &bndry_parts() const {
        return bndryParts_;
    }
    const std::vector<std::string> &bndry_part_names() const {
        return bndryPartNames_;
    }
    //! Seconds so far
    double structure_time() const {
        return structureTime_;
    }
    double mesh_time() const {
        return meshTime_;
    }

  private:
    struct Face {
        stk::mesh::Entity entity;
        int points; // integration points
    };
    struct Part {
        std::vector<std::string> names, wallNames;
        stk::mesh::PartVector blocks, walls;
        std::vector<stk::mesh::Entity> nodes; // on this rank
        std::vector<Face> faces;              // that this rank owns, in the order in which their points were registered
    };
    struct Turbine {
        std::string name, data;
        fsi_options options;
        std::array<Part, FSI_PARTS> parts;
        fsi_turbine *fsi{nullptr};
        std::array<double, 3> meshTip{}; // tip of blade 1 where the mesh was moved to
    };

    Turbine read_turbine(const YAML::Node &node, size_t number) const;
    void check(const Turbine &turbine, int status, const std::string &what) const;
    int agree(int status) const;
    void find_parts(Turbine &turbine);
    void declare_fields();
    int set_mesh(Turbine &turbine, int part);
    std::vector<double> node_positions(Part &part) const;
    std::vector<double> wall_points(Part &part) const;
    void start(double curTime);
    void load();
    double clock() const;
    void move_mesh(bool updateCurCoor);
    void set_old_displacements();
    void push_loads(Turbine &turbine, int part);
    std::vector<std::string> old_lines(const std::string &path) const;
    void begin_output(const Turbine &turbine) const;
    void write_output(const Turbine &turbine) const;

    std::shared_ptr<stk::mesh::BulkData> bulk_;
    std::string restartFile_;
    std::vector<Turbine> turbines_;
    stk::mesh::PartVector parts_, bndryParts_;
    std::vector<std::string> bndryPartNames_;
    std::unique_ptr<CalcLoads> calcLoads_;
    double dt_{-1.0};     // of Nalu-Wind's input
    double stepDt_{-1.0}; // of the last step
    bool inStep_{false}, restarted_{false};
    int accepted_{0};       // steps of this run
    double beginTime_{0.0}; // of the structure in this run
    double structureTime_{0.0}, meshTime_{0.0};
};

} // namespace nalu
} // namespace sierra

#endif
