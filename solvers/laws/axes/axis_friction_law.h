#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/axes/axis.h"
#include "solvers/laws/axes/axis_part_law.h"

namespace taut {

struct AxisFrictionTuning {
  /// An axis slower than this is at rest at the start [m/s or rad/s]: the round-off of velocities that joints
  /// are closed to.
  static constexpr double kRest = 1e-12;
};

/// Coulomb's friction of one axis, and its memory: what sticks is held where it began to, within the static
/// bound.  Viscous friction is a damper (axis_spring_law.h). (solvers/laws, "Axes")
struct AxisFrictionLaw : AxisBoxLaw<&AxisImpulse::friction> {
  double anchor = 0;       ///< θ where it is held [rad or m]
  bool stuck = false;      ///< held at the end of the last step
  bool slipping = false;   ///< let go in this step
  double load = 0;         ///< impulse of the joint's force in this stage [N·s]
  double load_change = 0;  ///< by the last solve, 0: not yet known

  bool held() const { return stuck && !slipping; }
  /// In this step, or because there is no friction any more.
  bool slides(const std::optional<AxisFriction>& friction) const { return slipping || (stuck && !friction); }
  /// A new start: an axis at rest is held at θ.
  void restart(double theta, double rate) {
    stuck = std::abs(rate) <= AxisFrictionTuning::kRest;
    anchor = theta;
  }
  void begin(const AxisProperties&, const AxisStep&, const AxisStart&) {
    slipping = false;
    load_change = 0;
  }
  /// What another system knew of the same axis.
  void inherit(const AxisFrictionLaw& old) {
    anchor = old.anchor;
    stuck = old.stuck;
    load = old.load;
  }
  bool set(const AxisStage& stage) {
    bound = at = 0;
    if (!stage.p.friction) return true;
    set_bound(*stage.p.friction, stage.step.kick_time());
    if (stage.step.in(Kick::kFirst)) hold_anchor(stage.start.theta, stage.step.h, stage.slack);
    return true;
  }
  /// What was held slips in this solution of a stage: it does not hold any more in this step, and its bound
  /// is that of dynamic friction now.
  bool move(const AxisProperties& p, const AxisStep&, const AxisStart&, double w, double rate_tolerance) {
    if (!p.friction || !held() || on_step(w, at) || std::abs(w - at) <= rate_tolerance) return false;
    slipping = true;
    return p.friction->dynamic_friction < p.friction->static_friction;
  }
  /// What is held slips in this step.
  void mark_slipping() { slipping = stuck; }
  void finish(AxisReport& report, const AxisEnd& end) {
    const bool holds = bound > 0 && on_step(end.rate, 0);
    if (holds && (!stuck || slipping)) anchor = end.theta;
    report.stuck = stuck = holds;
    slipping = false;
  }
  template <typename AnyArchive>
  void transfer(AnyArchive& archive) {
    archive(anchor, stuck, slipping, load, load_change, at, bound);
  }

 private:
  /// For a kick of length `time`.
  void set_bound(const AxisFriction& friction, double time) {
    bound = time * (held() ? friction.static_friction : friction.dynamic_friction) + friction.per_load * load;
  }
  /// The mean rate that leads from θ₀ to the anchor, if this is further away than `slack`.
  void hold_anchor(double theta0, double h, double slack) {
    const double off = anchor - theta0;
    at = held() ? (off - std::clamp(off, -slack, slack)) / h : 0;
  }
};

}  // namespace taut
