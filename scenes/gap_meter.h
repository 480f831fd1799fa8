#pragma once

#include <vector>

#include "core/diagnostics.h"

namespace taut {

/// How far joints are open, from the poses alone and independent of what the solver reports.  Joints that are
/// detached, broken ones too, are not open.
class GapMeter {
 public:
  explicit GapMeter(const World& world) { follow(world); }

  /// Of the present state of a world: the one of the constructor or a copy that lived on.
  Gap largest(const World& world) {
    evaluate(world);
    return max_gap(rows_, phi_);
  }
  std::vector<Gap> all(const World& world) {
    evaluate(world);
    return joint_gaps(rows_, phi_);
  }
  int row_count() const { return rows_.row_count(); }

 private:
  void evaluate(const World& world) {
    if (world.topology_version() != version_) follow(world);
    rows_.residual(world.state(), phi_);
  }
  void follow(const World& world) {
    rows_ = Rows(world);
    phi_.resize(rows_.row_count());
    version_ = world.topology_version();
  }

  Rows rows_;
  std::vector<double> phi_;
  int version_ = -1;
};

}  // namespace taut
