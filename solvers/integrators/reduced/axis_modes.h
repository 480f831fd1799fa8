#pragma once

#include <span>
#include <vector>

#include "core/constraints/rows.h"
#include "solvers/common/axis_report.h"
#include "solvers/integrators/reduced/closed_tree.h"
#include "solvers/laws/axes/axis_table.h"
#include "solvers/laws/row_law.h"

namespace taut {

class Archive;

/// Rigid limits, dry friction and motors without gains of free axes: what jumps with the rate w of an axis.
/// Each is a step in λ of w: friction at 0, a motor at its target, a limit at 0 while it is touched.  Beside
/// its step it is a force, on it the axis is held by a multiplier within the step's height:
///
///     beside   λ = −side · F, side · (w − w_k) ≥ 0;   held   ẇ = ẇ_k, lo ≤ λ ≤ hi
///
/// Which it is stays over a step; where an inequality ends to be true, or a limit is reached, an event ends
/// the step, an impact follows, if there is one, and from there modes are chosen that accelerations allow:
/// with ẇ − ẇ_k = A λ + b each candidate has the law of a box.  (solvers/integrators/reduced, "What jumps")
///
/// `theta`, `rates` and `lambda` have one entry a row.
class AxisModes {
 public:
  AxisModes(const World& world, const Rows& rows);

  /// Nothing jumps.
  bool empty() const { return axes_.empty(); }
  /// Reads properties that were changed.
  void refresh();
  /// Axes may have been moved: nothing is held anywhere.
  void forget();
  /// What is held.
  std::span<const ClosedTree::Held> held() const { return held_; }
  /// Adds the forces of what is beside its step to `tau`.
  void add_forces(std::span<const double> rates, std::span<double> tau) const;
  /// Adds to `forces`, one an axis row in their order, what each part gives: where an axis is held what λ has
  /// beyond τ.
  void give_forces(std::span<const double> rates, std::span<const double> lambda, std::span<const double> tau,
                   std::span<AxisImpulse> forces) const;
  /// How far the first inequality is from its end, over its tolerance: below 0 it has ended, below −1 beyond
  /// the tolerance.
  double margin(std::span<const double> theta, std::span<const double> rates, std::span<const double> lambda,
                std::span<const double> tau) const;

  /// An impact, at this time from the start of the step [s]: an axis moves into a limit that it touches, or a
  /// motor of any force is not at its target.  False if there is none.  What takes part is candidates(), with
  /// laws() of rates after it less those of the candidates.
  bool begin_impact(std::span<const double> theta, std::span<const double> rates, double time, double step);
  /// From now on all that strike have the least restitution of any.
  void use_least_restitution();
  /// Impulses of the candidates, and the means of their rates before and after.
  void end_impact(const double* impulses, const double* means, std::span<AxisReport> reports);

  /// What is on its step is a candidate to be held, with laws() of the change of its rate.
  void begin_choice(std::span<const double> theta, std::span<const double> rates);
  /// Rows have ended on these segments of their laws.  True if friction that lets go gives less than it was
  /// asked for, so that all is to be done once more.
  bool choose(std::span<const int> segments);
  std::span<const ClosedTree::Held> candidates() const { return candidates_; }
  std::span<const RowLaw> laws() const { return laws_; }

  /// Flags of what holds, or gives all it has.
  void report(std::span<AxisReport> reports) const;
  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  struct Axis {
    int index = 0, row = 0;               // in the table
    signed char friction = 0, motor = 0;  // side of their steps; 0: on it
    signed char limit = 0;                // −1, 1: the lower or upper one is touched, at rest
    bool held = false;
    double anchor = 0;                     // where it is held
    double since_impact = 0;               // time of the last impact in this step [s]; < 0: none
    double approach = 0, restitution = 0;  // in the impact that there is

    template <typename AnyArchive>
    void transfer(AnyArchive& archive) {
      archive(friction, motor, limit, held, anchor);
    }
  };
  struct Box {
    double lo = 0, hi = 0;
  };

  const AxisProperties& properties(const Axis& axis) const { return table_.properties(axis.index); }
  double friction_beside(const Axis& axis) const;
  double motor_beside(const Axis& axis, double rate) const;
  Box box(const Axis& axis) const;
  ClosedTree::Held held_row(const Axis& axis) const;
  void list_candidates();
  void list_held();
  void approach_limit(Axis& axis, double theta, double w, double time, double step) const;
  void set_impact_laws();

  AxisTable table_;
  std::vector<Axis> axes_;
  std::vector<ClosedTree::Held> held_, candidates_;
  std::vector<RowLaw> laws_;
  std::vector<int> members_;  // of axes_, by candidate
};

}  // namespace taut
