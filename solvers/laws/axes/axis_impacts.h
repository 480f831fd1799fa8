#pragma once

#include <span>
#include <vector>

#include "solvers/laws/axes/axis_law.h"
#include "solvers/laws/axes/axis_table.h"
#include "solvers/laws/time_of_meeting.h"

namespace taut {

class Archive;

/// Impacts of axes in free flight at limits with restitution, or at all that are rigid, as one of the two
/// kinds that are located within a step (integrators/impact_search.h).
class AxisImpacts {
 public:
  /// Of these axes, which must outlive it; `plastic`: those without restitution are sought, too.
  AxisImpacts(const AxisTable& table, const std::vector<AxisLaw>& axes, bool plastic)
      : table_(table), axes_(axes), impacts_(table.size()), plastic_(plastic) {}

  const AxisImpact& operator[](std::size_t i) const { return impacts_[i]; }
  /// None in this step so far.
  void clear();

  // For the location of the first one.
  std::size_t size() const { return impacts_.size(); }
  ImpactState& state(std::size_t i) { return impacts_[i]; }
  /// Some may be let through; beyond MeetingTuning::kMostImpacts they stop at their limits.
  bool wanted() const { return count_ < MeetingTuning::kMostImpacts; }
  /// The mean rates w of the position stage stop axis i in free flight at a limit that it is now let through.
  bool let_through(std::size_t i, std::span<const double> lambda, std::span<const double> w);
  /// So it was with some.
  void count() { ++count_; }
  /// The impacts of those let through are to be located.
  bool located() const { return true; }
  /// The time from the start of a step of h, in (0, h], at which axis i reaches its limit, on the parabola
  /// through θ₀ with θ̇₀ to the free end; h if it does not.
  double meeting(std::size_t i, std::span<const double> w, double h) const;
  /// That is when it strikes.
  void set_meeting(std::size_t i, double time, std::span<const double> w, double h);

  /// Some axis runs into a limit in this sub-step, at the end of which it is at θ₁, and was not located.
  bool any_unlocated(std::span<const double> theta1) const;
  /// One is due.
  bool any_due() const;
  /// At θ₁ some axis moves on into its limit at these rates.
  bool come_together(std::span<const double> theta1, std::span<const double> w) const;

  /// The end of a sub-step with these rates: impacts that were due, and axes that a rate stops at a limit
  /// away from which they began, are reported with this time.
  void finish(std::span<const double> w, double time, std::span<AxisReport> reports);
  /// An impact ended the last sub-step.
  bool struck() const { return struck_; }

  /// What is remembered from step to step, to or from bytes: each axis, and what is said of all of them
  /// (checkpoint_memory.cpp).  @{
  void transfer(Archive& archive);
  void transfer_count(Archive& archive);  /// @}

 private:
  bool stops(std::size_t i, bool at_lower, std::span<const double> w) const;
  bool runs_into_limit(int i, double theta, double rate) const;

  const AxisTable& table_;
  const std::vector<AxisLaw>& axes_;
  std::vector<AxisImpact> impacts_;
  bool plastic_ = false;
  int count_ = 0;  // looked for in this step
  bool struck_ = false;
};

}  // namespace taut
