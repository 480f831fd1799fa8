#pragma once

#include <span>
#include <vector>

#include "core/constraints/rows.h"
#include "core/world/world.h"
#include "solvers/common/axis_report.h"
#include "solvers/laws/axes/axis_table.h"

namespace taut {

/// Forces along free axes that follow from the state: springs and dampers, viscous friction, limits with
/// compliance and motors with stiffness or damping, τ(θ, θ̇, t).
class AxisFlow {
 public:
  AxisFlow(const World& world, const Rows& rows);

  bool empty() const { return table_.size() == 0; }
  /// Reads properties that were changed, and forgets what has been added.
  void begin();
  /// A sub-step begins, which roll_back() takes back.
  void begin_substep();
  void roll_back();
  /// τ of each axis into its row of `tau`, at a state with these coordinates and rates by row.
  void find(double time, std::span<const double> theta, std::span<const double> rates, std::span<double> tau);
  /// Those that were found last, by what gives them, to which others may add; in the order of
  /// Rows::axis_rows().
  std::span<AxisImpulse> forces() { return forces_; }
  /// Adds the forces that were found last to the reports, for a time [s].
  void add(double time);
  /// Sums since begin(), with impulses in place of mean forces; in the order of Rows::axis_rows().
  const std::vector<AxisReport>& reports() const { return reports_; }
  std::vector<AxisReport>& reports() { return reports_; }
  /// Work of all since begin() [J].
  double work() const;

 private:
  AxisTable table_;
  std::vector<AxisReport> reports_, before_;
  std::vector<AxisImpulse> forces_;
  std::vector<double> rates_;  // of axes
};

}  // namespace taut
