#include <algorithm>
#include <cmath>

#include "solvers/laws/axis_forces.h"

// Friction that grows with the load of its joint.  (solvers/laws, "Axes")
//
// The stage is solved again until no bound changes, at most 40 times.  The iteration has a limit as long as
// friction grows by less than the load that it makes grow.  Beyond that (a wedge at α to the way of its
// follower with μ ≥ cot α) nothing moves the joint: a motor of bounded force stalls there, which is a
// success; if a driver or a motor without bound asks for motion all the same, no impulses exist, whatever
// the step, and it ends as Status::kContradiction.  Near the limit changes shrink slowly or alternate: then
// it continues from the end of their geometric series.
namespace taut {
namespace {

/// Bounds of friction that grow with the load are right to this part.
constexpr double kLoadTolerance = 1e-10;
/// Loads whose changes do not shrink to less than this part, or alternate, are extrapolated unless they grow.
constexpr double kSlowLoad = 0.3;

}  // namespace

bool AxisForces::update_loads(const Rows& rows, std::span<const double> jacobian,
                              std::span<const double> lambda) {
  bool changed = false;
  if (!has_loads_) return false;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const AxisProperties& p = properties(i);
    if (!p.friction || p.friction->per_load == 0 || released_[i]) continue;
    const Rows::JointRows& joint = rows.joints()[rows_[i].axis.joint.index];
    const double* J = jacobian.data() + rows.sides()[joint.first_side + 1].offset;
    Vec3 force = Vec3::Zero();
    for (int k = 0; k < joint.equality_count; ++k)
      if (!rows.row(joint.first_row + k).angular)
        force += lambda[joint.first_row + k] * Eigen::Map<const Vec3>(J + 6 * k + 3);
    Axis& axis = axes_[i];
    const double load = force.norm(), change = load - axis.load, last = axis.load_change;
    const bool moved = p.friction->per_load * std::abs(change) >
                       kLoadTolerance * (axis.friction_force + p.friction->per_load * load);
    const double left = last != 0 ? change / last : 0;
    growing_[i] = moved && left >= 1;
    changed = changed || moved;
    axis.load = load;
    axis.load_change = change;
    if (left >= 1 || std::abs(left) < kSlowLoad) continue;
    axis.load = std::max(0.0, load + change * left / (1 - left));  // where this geometric series ends
    axis.load_change = 0;
  }
  return changed;
}

bool AxisForces::has_unbounded_motor(std::size_t i) const {
  const AxisProperties& p = properties(i);
  return !released_[i] && p.motor && std::isinf(p.motor->max_force) && !p.motor->force_of_speed;
}

}  // namespace taut
