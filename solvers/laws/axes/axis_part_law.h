#pragma once

#include <algorithm>
#include <cmath>

#include "core/axes/axis.h"
#include "solvers/common/axis_report.h"
#include "solvers/laws/axes/axis_step.h"
#include "solvers/laws/row_law.h"

namespace taut {

struct AxisImpact;  // axis_limit_law.h

/// An axis at the start of a round of impacts.  (solvers/integrators/impact_stage.h)
struct AxisRound {
  double rate = 0;   ///< w⁻ [rad/s or m/s]
  double limit = 0;  ///< impulse of its limits in the second kick so far
};

/// An axis in a stage of a step, by which the parts of its law are set.
struct AxisStage {
  const AxisProperties& p;
  const AxisStep& step;
  const AxisStart& start;
  const AxisImpact& impact;       ///< at a limit
  const AxisImpulse& first_kick;  ///< second kick: what acted in the first
  double slack = 0;   ///< first kick: friction pulls back no axis that is this near to where it was held
  double rate = 0;    ///< for the first kick: the best estimate of its mean
  double theta = 0;   ///< for the second kick: θ(q₁); single one: in the middle of the step
  bool jolt = false;  ///< second kick: some axis runs into a limit in this sub-step unlocated
  const AxisRound* round = nullptr;  ///< second kick: of impacts at its end, if there are any
};

/// An axis at the end of a step.
struct AxisEnd {
  double theta = 0, rate = 0;  ///< θ [rad or m] and θ̇
  double rate_change = 0;      ///< θ̇ − θ̇₀
  AxisImpulse impulse;         ///< of both kicks
};

/// A part of the law of an axis: springs, friction, a motor, limits.  AxisLaw asks the same of all of them; a
/// part is a struct with its memory that hides what concerns it; the rest is nothing.  A smooth force needs a
/// line λ = l − c w by set(), add_to() and split_lines(); one that is bounded derives from
/// AxisBoxLaw.  It is named in AxisLaw::with_parts(), unless its property has its law in its header:
/// AxisSmoothLaw and AxisBoundLaw.  (core/axes, "A new axis property")
struct AxisPartLaw {
  /// A new start, with θ and its rate.
  void restart(double, double) {}
  /// A step begins.
  void begin(const AxisProperties&, const AxisStep&, const AxisStart&) {}
  /// What another system knew of the same axis.
  template <typename Part>
  void inherit(const Part&) {}

  /// Its law in the kick of the stage.  False if what the part follows is not finite; it is left out then.
  bool set(const AxisStage&) { return true; }
  /// In its place, where the axis gives no force any more.
  void release() {}
  /// Adds its steps and slope.
  void add_to(RowLaw&, const AxisProperties&) const {}
  /// It follows a solution w of the stage, which must be solved again then.
  bool move(const AxisProperties&, const AxisStep&, const AxisStart&, double, double) { return false; }

  /// Its parts of an impulse of which `rest` is left, at the rate w, in this order: by its lines; where w is
  /// beside its steps; of the rest where w is on one.  @{
  void split_lines(AxisImpulse&, double&, double) const {}
  void split_beside(AxisImpulse&, double&, double) const {}
  void split_on_step(AxisImpulse&, double&, double) const {}  /// @}

  /// The end of the position stage, with the mean rate, and of the step.  @{
  void finish_first_kick(const AxisProperties&, const AxisStart&, double) {}
  void finish(AxisReport&, const AxisEnd&) {}  /// @}
  /// What it says of a stage that ended with the rate w.
  void report(AxisReport&, const AxisProperties&, double) const {}
  /// What is remembered from step to step, to or from bytes.
  template <typename AnyArchive>
  void transfer(AnyArchive&) {}
};

/// Where the law of a property finds it, and reports what it gives.
template <typename Property>
struct AxisPlace {
  static const std::optional<Property>& get(const AxisProperties& p) { return p.get<Property>(); }
  static constexpr double AxisImpulse::*kPart = kAxisPartOf<Property>;
};

/// One that is bounded, |λ| ≤ `bound` against w − `at`.
template <double AxisImpulse::*kPart>
struct AxisBoxLaw : AxisPartLaw {
  double at = 0;     ///< rate that it holds or keeps in this stage [rad/s or m/s]
  double bound = 0;  ///< impulse in this stage; 0: none [N·m·s or N·s]

  void add_to(RowLaw& law, const AxisProperties&) const {
    if (bound > 0) law.add_step(at, bound, -bound);
  }
  void split_beside(AxisImpulse& impulse, double& rest, double w) const {
    if (bound > 0 && !holds(w)) rest -= impulse.*kPart = w < at ? bound : -bound;
  }
  void split_on_step(AxisImpulse& impulse, double& rest, double w) const {
    if (bound > 0 && holds(w)) rest -= impulse.*kPart = std::clamp(rest, -bound, bound);
  }
  /// One without bound does whatever the rate is that an inexact solver has left.
  bool holds(double w) const { return std::isinf(bound) || on_step(w, at); }
};

}  // namespace taut
