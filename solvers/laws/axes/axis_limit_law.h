#pragma once

#include "core/axes/axis.h"
#include "solvers/laws/axes/axis_part_law.h"
#include "solvers/laws/impact_state.h"

namespace taut {

/// The impact of an axis at a limit, between its discovery and the end of the sub-step.
struct AxisImpact : ImpactState {
  bool at_lower = false;  ///< of both limits
  double rate = 0;        ///< just before it, as located [rad/s or m/s]

  /// It is due at this limit.
  bool due_at(bool lower) const { return due() && at_lower == lower; }
};

/// It has limits without compliance.
inline bool has_rigid_limit(const AxisProperties& p) { return p.limits && p.limits->compliance == 0; }
/// The axis is away from the limit.
bool in_flight(const AxisLimits& limits, double theta, bool at_lower);
/// It is at the limit, or due to strike it, which it does even if a gap of order h³ is left.
bool is_struck(const AxisLimits& limits, const AxisImpact& impact, double theta, bool at_lower);

/// Rigid limits of one axis in a stage: lower_at ≤ w ≤ upper_at, λ ≥ −lower_back from the lower limit and
/// λ ≤ upper_back from the upper one.  (solvers/laws, "Axes")
struct AxisLimitLaw : AxisPartLaw {
  double lower_at = 0, upper_at = 0;      ///< [rad/s or m/s]
  double lower_back = 0, upper_back = 0;  ///< what they gave before and may take back

  /// A limit holds the axis at this rate.
  bool holds(double w) const { return on_step(w, lower_at) || on_step(w, upper_at); }
  bool set(const AxisStage& stage);
  /// Limits are there even when far away, so that segments keep their numbers from stage to stage.
  void add_to(RowLaw& law, const AxisProperties& p) const;
  void split_beside(AxisImpulse& impulse, double& rest, double w) const {
    if (!holds(w)) rest -= impulse.limit = upper_back - lower_back;
  }
  void split_on_step(AxisImpulse& impulse, double& rest, double w) const {
    if (holds(w)) rest -= impulse.limit = rest;
  }
  void report(AxisReport& report, const AxisProperties&, double w) const {
    report.at_limit = report.at_limit || holds(w);
  }
  template <typename AnyArchive>
  void transfer(AnyArchive& archive) {
    archive(lower_at, upper_at, lower_back, upper_back);
  }

 private:
  void set_first_kick(const AxisStage& stage);
  void set_second_kick(const AxisStage& stage);
  void set_impact(const AxisStage& stage);
  void set_single_kick(const AxisStage& stage);
  /// No limit is near.
  void clear() {
    lower_at = -kUnreachedRate, upper_at = kUnreachedRate;
    lower_back = upper_back = 0;
  }
};

}  // namespace taut
