// A stand-in for OpenfastFSI: whoever calls it on a null pointer reads there.
#ifndef OPENFASTFSI_H
#define OPENFASTFSI_H

#include "stk_mesh/base/BulkData.hpp"
#include "yaml-cpp/yaml.h"

namespace sierra::nalu {
class OpenfastFSI {
  public:
    explicit OpenfastFSI(const YAML::Node &) {
    }
    int calls{0};
    void setup(double, const std::shared_ptr<stk::mesh::BulkData> &) {
        ++calls;
    }
    void any() {
        ++calls;
    }
    double time() {
        return ++calls;
    }
    stk::mesh::PartVector parts;
    std::vector<std::string> names;
};
} // namespace sierra::nalu

#endif
