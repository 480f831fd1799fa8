#pragma once

#include <span>

#include "core/state/state.h"

namespace taut {

/// The fixed point for forces that depend on the velocities that they lead to: whether they are the same as
/// in the pass before to 1e-12 of the largest, still come closer, or do not.       (solvers/integrators,
/// "RATTLE")
class ForceIteration {
 public:
  enum class Fixed { kYes, kNotYet, kStalled };

  /// Of a step.
  void begin() { pass_ = unsettled_ = 0; }
  Fixed look(std::span<const Wrench> forces, std::span<const Wrench> last);
  /// The body on which forces changed most when they stalled in this step; else the ground.
  BodyId unsettled() const { return {unsettled_}; }

 private:
  int pass_ = 0;
  double last_change_ = 0;
  int unsettled_ = 0;
};

}  // namespace taut
