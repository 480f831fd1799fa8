#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/state/axis.h"
#include "solvers/laws/axis_step.h"

namespace taut {

/// Coulomb's friction of one axis, |λ| ≤ `bound` against w − `at`, and its memory: what sticks is held where
/// it began to, within the static bound.  Viscous friction is a damper (axis_spring_law.h).
/// (solvers/laws, "Axes")
struct AxisFrictionLaw {
  double anchor = 0;       ///< θ where it is held [rad or m]
  bool stuck = false;      ///< held at the end of the last step
  bool broken = false;     ///< … but not in this one
  double load = 0;         ///< impulse of the joint's force in this stage [N·s]
  double load_change = 0;  ///< by the last solve, 0: not yet known
  double at = 0;           ///< rate that it holds in this stage [rad/s or m/s]
  double bound = 0;        ///< impulse in this stage; 0: none [N·m·s or N·s]

  bool held() const { return stuck && !broken; }
  /// In this step, or because there is no friction any more.
  bool has_let_go(const std::optional<AxisFriction>& friction) const {
    return broken || (stuck && !friction);
  }
  /// A new start: an axis at rest is held at θ.
  void start(double theta, double rate) {
    stuck = std::abs(rate) <= kRest;
    anchor = theta;
  }
  void begin() {
    broken = false;
    load_change = 0;
  }
  /// What another system knew of the same axis.
  void inherit(const AxisFrictionLaw& old) {
    anchor = old.anchor;
    stuck = old.stuck;
    load = old.load;
  }
  /// For a kick of length `time`.
  void set_bound(const AxisFriction& friction, double time) {
    bound = time * (held() ? friction.static_friction : friction.dynamic_friction) + friction.per_load * load;
  }
  /// The mean rate that leads from θ₀ to the anchor, if this is further away than `slack`.
  void hold_anchor(double theta0, double h, double slack) {
    const double off = anchor - theta0;
    at = held() ? (off - std::clamp(off, -slack, slack)) / h : 0;
  }
  /// True if what was held slips in this solution of a stage: it does not hold any more in this step.
  bool break_away(double w, double rate_tolerance) {
    if (!held() || on_step(w, at) || std::abs(w - at) <= rate_tolerance) return false;
    broken = true;
    return true;
  }
  /// What is held slips in this step.
  void let_go() { broken = stuck; }
  /// With θ and its rate at the end of the step; true if it is held from here on.
  bool finish(double theta, double rate) {
    const bool holds = bound > 0 && on_step(rate, 0);
    if (holds && (!stuck || broken)) anchor = theta;
    stuck = holds;
    broken = false;
    return holds;
  }

 private:
  /// An axis slower than this is at rest at the start [m/s or rad/s].
  static constexpr double kRest = 1e-12;
};

}  // namespace taut
