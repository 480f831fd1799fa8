#pragma once

#include <span>
#include <vector>

#include "solvers/laws/axes/axis_law.h"
#include "solvers/laws/axes/axis_table.h"

namespace taut {

/// Friction that grows with the load of its joint: μ |F|, with the force F [N] of its translation rows.
/// (solvers/laws, "Axes")
///
/// The stage is solved again until no bound changes, at most 40 times.  The iteration has a limit as long as
/// friction grows by less than the load that it makes grow.  Beyond that (a wedge at α to the way of its
/// follower with μ ≥ cot α) nothing moves the joint: a motor of bounded force stalls there, which is a
/// success; if a driver or a motor without bound asks for motion all the same, no impulses exist, whatever
/// the step, and it ends as Status::kContradiction.  Near the limit changes shrink slowly or alternate: then
/// it continues from the end of their geometric series.
class AxisLoads {
 public:
  explicit AxisLoads(std::size_t axes) : growing_(axes, 0) {}

  /// Loads from the impulses of a stage; true if a bound has changed by more than the tolerance of impulses,
  /// so that the stage must be solved again.
  bool update(const AxisTable& table, std::span<AxisLaw> axes, const Rows& rows,
              std::span<const double> jacobian, std::span<const double> lambda);
  /// Axes whose bounds the last update() has changed so, and by no less than the one before.
  std::span<const char> growing() const { return growing_; }

 private:
  std::vector<char> growing_;
};

}  // namespace taut
