#pragma once

#include "core/state/axis.h"
#include "solvers/common/axis_report.h"
#include "solvers/laws/axis_friction_law.h"
#include "solvers/laws/axis_limit_law.h"
#include "solvers/laws/axis_motor_law.h"
#include "solvers/laws/axis_spring_law.h"
#include "solvers/laws/axis_step.h"
#include "solvers/laws/row_law.h"

namespace taut {

/// All that acts along one axis in a stage, as the sum of the laws of its parts, and what they remember.
/// (solvers/laws, "Axes")
struct AxisLaw {
  bool known = true;  ///< no body was moved
  AxisStart start;
  AxisFrictionLaw friction;
  AxisSpringLaw springs;
  AxisMotorLaw motor;
  AxisLimitLaw limits;

  /// The sum of the steps and slopes.
  RowLaw sum(const AxisProperties& p);
  /// How an impulse λ at the rate w is made up.
  AxisImpulse share(double lambda, double w) const;
};

}  // namespace taut
