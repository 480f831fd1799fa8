#pragma once

#include "core/state/axis.h"
#include "solvers/laws/axis_step.h"
#include "solvers/laws/row_law.h"

namespace taut {

/// The impact of an axis at a limit, between its discovery and the end of the sub-step.
struct AxisImpact {
  enum class Stage { kNone, kSought, kDue } stage = Stage::kNone;
  bool at_lower = false;  ///< of both limits
  double rate = 0;        ///< just before it [rad/s or m/s]
  bool spent = false;     ///< no more in this step

  bool sought() const { return stage == Stage::kSought; }
  bool due() const { return stage == Stage::kDue; }
};

/// The step began away from the limit.
bool in_flight(const AxisLimits& limits, double theta0, bool at_lower);

/// Rigid limits of one axis in a stage: lower_at ≤ w ≤ upper_at, λ ≥ −lower_back from the lower limit and
/// λ ≤ upper_back from the upper one.  (solvers/laws, "Axes")
struct AxisLimitLaw {
  double lower_at = 0, upper_at = 0;      ///< [rad/s or m/s]
  double lower_back = 0, upper_back = 0;  ///< what they gave in the first kick and may take back

  /// No limit is near.
  void clear() {
    lower_at = -kUnreachedRate, upper_at = kUnreachedRate;
    lower_back = upper_back = 0;
  }
  /// A limit holds the axis at this rate.
  bool holds(double w) const { return on_step(w, lower_at) || on_step(w, upper_at); }
  // After clear():
  /// Bounds of the mean rate; a limit whose impact is sought is left out.
  void bound_position(const AxisLimits& limits, const AxisImpact& impact, double theta0, double h);
  /// Bounds of the rate at θ₁ by Newton's law of impact.  `jolt`: some axis runs into a limit in this
  /// sub-step; `first_kick`: the limits' impulse there.
  void bound_velocity(const AxisLimits& limits, const AxisImpact& impact, double theta1, double rate0,
                      bool jolt, double first_kick);
  /// Moreau–Jean: Newton's law of impact for a limit that is passed at θ.
  void bound_single_kick(const AxisLimits& limits, double theta, double rate0);
  /// The law and these limits.  Limits are there even when far away, so that segments keep their numbers from
  /// stage to stage.
  RowLaw add_to(RowLaw law, const AxisLimits& limits) const;
};

}  // namespace taut
