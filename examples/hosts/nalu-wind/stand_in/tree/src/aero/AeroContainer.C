// A stand-in for Nalu-Wind's file of the same name: its functions, and the lines that the script `apply` looks for, as they
// are at a40e39cc. The bodies are ours, and shorter.
#include <aero/AeroContainer.h>
#ifdef NALU_USES_OPENFAST
#include "aero/fsi/OpenfastFSI.h"
#endif
#include <FieldTypeDef.h>

namespace sierra {
namespace nalu {
void
AeroContainer::clean_up()
{
  if (has_fsi())
    fsiContainer_->any();
}

AeroContainer::~AeroContainer()
{
  if (has_fsi()) {
    delete fsiContainer_;
  }
}

AeroContainer::AeroContainer(const YAML::Node& node) : fsiContainer_(nullptr)
{
  if (node["openfast_fsi"])
    fsiContainer_ = new OpenfastFSI(node["openfast_fsi"]);
}

void
AeroContainer::setup(double timeStep, std::shared_ptr<stk::mesh::BulkData> bulk)
{
  if (has_fsi())
    fsiContainer_->setup(timeStep, bulk);
}

void
AeroContainer::init(double currentTime, double restartFrequency)
{
  if (has_fsi())
    fsiContainer_->any();
  (void)currentTime;
  (void)restartFrequency;
}

void
AeroContainer::update_displacements(
  const double currentTime, bool updateCC, bool predict)
{
  if (has_fsi())
    fsiContainer_->any();
  (void)currentTime;
  (void)updateCC;
  (void)predict;
}

void
AeroContainer::predict_model_time_step(const double currentTime)
{
  if (has_fsi())
    fsiContainer_->any();
  (void)currentTime;
}

void
AeroContainer::advance_model_time_step(
  const double currentTime,
  const double
#ifdef NALU_USES_KYNEMA
    dT
#endif
)
{
  if (has_fsi())
    fsiContainer_->any();
  (void)currentTime;
}

void
AeroContainer::compute_div_mesh_velocity()
{
  if (has_fsi())
    fsiContainer_->any();
}

const stk::mesh::PartVector
AeroContainer::fsi_parts()
{
  return has_fsi() ? fsiContainer_->parts : stk::mesh::PartVector();
}

const stk::mesh::PartVector
AeroContainer::fsi_bndry_parts()
{
  return has_fsi() ? fsiContainer_->parts : stk::mesh::PartVector();
}

const std::vector<std::string>
AeroContainer::fsi_bndry_part_names()
{
  return has_fsi() ? fsiContainer_->names : std::vector<std::string>();
}

double
AeroContainer::openfast_accumulated_time()
{
  return has_fsi() ? fsiContainer_->time() : -1.0;
}

double
AeroContainer::nalu_fsi_accumulated_time()
{
  return has_fsi() ? fsiContainer_->time() : -1.0;
}

} // namespace nalu
} // namespace sierra
