#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/state/state.h"
#include "core/world/joint_properties.h"

namespace taut::detail {

/// The joints of a World that can break, in ascending order, with what they bear.
class BreakableJoints {
 public:
  const std::vector<std::pair<JointId, BreakLimits>>& all() const { return joints_; }
  void set(JointId id, std::optional<BreakLimits> limits);  ///< nullopt: it never breaks

 private:
  std::vector<std::pair<JointId, BreakLimits>> joints_;
};

}  // namespace taut::detail
