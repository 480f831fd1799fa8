#include "solvers/laws/axes/axis_loads.h"

#include <algorithm>
#include <cmath>

namespace taut {
namespace {

/// Chosen, where nothing else is said.
struct AxisLoadsTuning {
  /// Bounds of friction that grow with the load are right to this part of themselves, which is less than laws
  /// are met to.
  static constexpr double kTolerance = 1e-10;
  /// Loads whose changes do not shrink to less than this part in a solve, or alternate, are extrapolated
  /// unless they grow.  Chosen.
  static constexpr double kSlow = 0.3;
};

/// Impulse of the translation rows of a joint [N·s].
double load_of(const Rows& rows, const Rows::JointRows& joint, std::span<const double> jacobian,
               std::span<const double> lambda) {
  const double* J = jacobian.data() + rows.sides()[joint.first_side + 1].offset;
  Vec3 force = Vec3::Zero();
  for (int k = 0; k < joint.equality_count; ++k)
    if (!rows.row(joint.first_row + k).angular)
      force += lambda[joint.first_row + k] * Eigen::Map<const Vec3>(J + 6 * k + 3);
  return force.norm();
}

}  // namespace

bool AxisLoads::update(const AxisTable& table, std::span<AxisLaw> axes, const Rows& rows,
                       std::span<const double> jacobian, std::span<const double> lambda) {
  bool changed = false;
  for (const int i : table.loaded()) {
    const AxisProperties& p = table.properties(i);
    if (!p.friction || p.friction->per_load == 0 || table.released(i)) continue;
    const double load = load_of(rows, rows.joints()[table.axis(i)->joint.index], jacobian, lambda);
    AxisFrictionLaw& friction = axes[i].friction;
    const double change = load - friction.load, last = friction.load_change;
    const bool moved = p.friction->per_load * std::abs(change) >
                       AxisLoadsTuning::kTolerance * (friction.bound + p.friction->per_load * load);
    const double left = last != 0 ? change / last : 0;
    growing_[i] = moved && left >= 1;
    changed = changed || moved;
    friction.load = load;
    friction.load_change = change;
    if (left >= 1 || std::abs(left) < AxisLoadsTuning::kSlow) continue;
    friction.load = std::max(0.0, load + change * left / (1 - left));  // where this geometric series ends
    friction.load_change = 0;
  }
  return changed;
}

}  // namespace taut
