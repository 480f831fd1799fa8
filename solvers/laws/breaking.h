#pragma once

#include <span>
#include <vector>

#include "core/world/world.h"
#include "solvers/common/step_report.h"
#include "solvers/system/constraint_system.h"

namespace taut {

class Archive;

/// Joints that leave within a step because their load exceeds what they bear: which, when, and the rows that
/// are out of the system from then on.                                         (solvers/laws, "Breaking")
class Breaking {
 public:
  Breaking(const World& world, const Rows& rows);

  bool possible() const { return !world_.breakable().empty(); }
  /// A sub-step of h [s] at its end, where the system is linearised, with the impulses of both kicks.
  struct Substep {
    const ConstraintSystem& system;
    const State& end;
    std::span<const double> lambda, mu;
    double h;
  };
  /// Whether a joint bears less than its mean load over the sub-step, which is then to be taken back, and
  /// again: of length time_to_break() if that is positive, or at once without the joints in overloaded().
  bool check(const Substep& step);
  double time_to_break() const { return time_to_break_; }
  const std::vector<JointId>& overloaded() const { return overloaded_; }
  /// Joints whose time has come with the end of an accepted sub-step; moves them to overloaded().
  bool due(double time);
  bool any_due() const { return !due_.empty(); }
  /// The overloaded joints, and those that couple their axes, are out from the state on.
  void release(const State& state);

  /// Rows of all joints that are out, and whether one is.
  std::span<const int> rows() const { return rows_; }
  /// Zero in these rows.
  void clear_rows(std::span<double> values) const {
    for (int r : rows_) values[r] = 0;
  }
  bool any() const { return !rows_.empty() || !events_.empty(); }
  const std::vector<BreakEvent>& events() const { return events_; }

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  struct Load {
    double force = 0, torque = 0, ratio = 0;
  };
  Load load_of(const Substep& step, const std::pair<JointId, BreakLimits>& joint) const;
  bool is_out(JointId joint) const;
  double find_loads(const Substep& step);
  double first_break(double h) const;
  void shorten(double first, double time, double h);
  void overload(double worst, double h);
  void append_limited(double until, double h, std::vector<JointId>& joints) const;
  double time_to_limit(std::size_t i, double h) const;

  const World& world_;
  const Rows& all_rows_;
  std::vector<Load> loads_, last_loads_;  // in the order of World::breakable()
  bool has_loads_ = false;                // last_loads_ are those of the sub-step just before
  double last_h_ = 0, time_to_break_ = 0, due_time_ = 0;
  int shortened_ = 0;  // sub-steps that were shortened to a break since the last release
  std::vector<JointId> overloaded_, due_;
  std::vector<int> rows_;
  std::vector<BreakEvent> events_;
};

}  // namespace taut
