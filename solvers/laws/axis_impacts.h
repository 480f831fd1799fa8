#pragma once

#include <span>
#include <vector>

#include "solvers/laws/axis_law.h"
#include "solvers/laws/axis_table.h"

namespace taut {

class Archive;

/// Impacts of axes in free flight at limits with restitution, or at all that are rigid: such a limit is let
/// through once, which shows when the axis gets there, and the sub-step is taken again with its end at the
/// first impact.
/// (solvers/laws, "Impacts")
class AxisImpacts {
 public:
  /// `plastic`: those without restitution are sought, too.
  AxisImpacts(std::size_t axes, bool plastic) : impacts_(axes), plastic_(plastic) {}

  const AxisImpact& operator[](std::size_t i) const { return impacts_[i]; }
  /// None in this step so far.
  void clear();
  /// True if these mean rates of the position stage stop an axis in free flight at such a limit.  From then
  /// on its impact is sought.
  bool seek(const AxisTable& table, std::span<const AxisLaw> axes, std::span<const double> w);
  /// The time from the start of the step, in (0, h], at which the first of these axes reaches its limit, on
  /// the parabola through θ₀ with θ̇₀ to the free end; h if none does.
  double first(const AxisTable& table, std::span<const AxisLaw> axes, std::span<const double> w,
               double h) const;
  /// Of those sought, the ones up to this time are due at the end of the next sub-step, which is to end
  /// then; the others come later.
  void take(double until, const AxisTable& table, std::span<const AxisLaw> axes, std::span<const double> w,
            double h);
  /// Those that were found are not wanted any more.  `for_good`: nor looked for again in this step.
  void forget(bool for_good);
  /// Some axis runs into a limit in this sub-step, at the end of which it is at θ₁.
  bool any(const AxisTable& table, std::span<const AxisLaw> axes, std::span<const double> theta1) const;

  /// The end of a sub-step with these rates: impacts that were due, and axes that a rate stops at a limit
  /// away from which they began, are reported with this time.
  void finish(const AxisTable& table, std::span<const AxisLaw> axes, std::span<const double> w, double time,
              std::span<AxisReport> reports);
  /// An impact ended the last sub-step.
  bool struck() const { return struck_; }

  /// What is remembered from step to step, to or from bytes: each axis, and what is said of all of them
  /// (checkpoint_memory.cpp).  @{
  void transfer(Archive& archive);
  void transfer_count(Archive& archive);  /// @}

 private:
  std::vector<AxisImpact> impacts_;
  bool plastic_ = false;
  int count_ = 0;  // looked for in this step
  bool struck_ = false;
};

}  // namespace taut
