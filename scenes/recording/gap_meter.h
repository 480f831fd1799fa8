#pragma once

#include <vector>

#include "core/constraints/rows.h"
#include "core/world/diagnostics.h"

namespace taut {

/// How far joints are open, from the poses alone and independent of what the solver reports.  Joints that are
/// detached, broken ones too, are not open.
class GapMeter {
 public:
  explicit GapMeter(const World& world)
      : rows_(world), phi_(rows_.row_count()), version_(world.topology_version()) {}

  /// Of the present state of a world: the one of the constructor or a copy that lived on.
  Gap largest(const World& world) {
    evaluate(world);
    return max_gap(rows_, phi_);
  }
  /// Of all joints, in the order of their ids.
  std::vector<Gap> all(const World& world) {
    evaluate(world);
    return joint_gaps(rows_, phi_);
  }
  int row_count() const { return rows_.row_count(); }  ///< of all joints

 private:
  void evaluate(const World& world) {
    if (world.topology_version() != version_) *this = GapMeter(world);
    rows_.residual(world.state(), phi_);
  }

  Rows rows_;
  std::vector<double> phi_;
  int version_;
};

}  // namespace taut
