#pragma once

#include <tuple>

#include "core/axes/axis.h"
#include "solvers/common/axis_report.h"
#include "solvers/laws/axes/axis_bound_law.h"
#include "solvers/laws/axes/axis_friction_law.h"
#include "solvers/laws/axes/axis_limit_law.h"
#include "solvers/laws/axes/axis_motor_law.h"
#include "solvers/laws/axes/axis_part_law.h"
#include "solvers/laws/axes/axis_servo_law.h"
#include "solvers/laws/axes/axis_smooth_law.h"
#include "solvers/laws/axes/axis_spring_law.h"
#include "solvers/laws/axes/axis_step.h"
#include "solvers/laws/axes/axis_winch_law.h"
#include "solvers/laws/row_law.h"

namespace taut {

namespace detail {
template <typename Property>
auto plain_axis_law() {
  if constexpr (SmoothAxisProperty<Property>)
    return std::tuple<AxisSmoothLaw<Property>>();
  else if constexpr (BoundedAxisProperty<Property>)
    return std::tuple<AxisBoundLaw<Property>>();
  else
    return std::tuple<>();
}
template <typename... Properties>
auto plain_axis_laws(AxisTypes<Properties...>) {
  return std::tuple_cat(plain_axis_law<Properties>()...);
}
using PlainAxisLaws = decltype(plain_axis_laws(AllAxisProperties{}));
}  // namespace detail

/// All that acts along one axis in a stage, as the sum of the laws of its parts, and what they remember.
/// What each function asks of the parts: AxisPartLaw.  (solvers/laws, "Axes")
struct AxisLaw {
  bool known = true;  ///< no body was moved
  AxisStart start;
  AxisSpringLaw springs;
  AxisFrictionLaw friction;
  AxisMotorLaw motor;
  AxisServoLaw servo;
  AxisWinchLaw winch;
  AxisLimitLaw limits;

  /// Of the properties whose laws are in their headers.
  detail::PlainAxisLaws plain;

  /// use(part, …) with all parts, in the order of their sum.
  template <typename Self, typename Use>
  static auto with_parts(Self& self, Use use) {
    return std::apply(
        [&](auto&... of_plain) {
          return use(self.springs, of_plain..., self.friction, self.motor, self.servo, self.winch,
                     self.limits);
        },
        self.plain);
  }

  /// A new start: nothing is known but θ and its rate.
  void restart(double theta, double rate);
  void begin(const AxisProperties& p, const AxisStep& step);
  void inherit(const AxisLaw& old);
  bool set(const AxisStage& stage);
  void release();
  /// Some part has followed a solution w of a stage, which must be solved again.
  bool move(const AxisProperties& p, const AxisStep& step, double w, double rate_tolerance);
  void finish_first_kick(const AxisProperties& p, double w);
  void finish(AxisReport& report, const AxisEnd& end);
  void report(AxisReport& report, const AxisProperties& p, double w) const;

  /// The sum of the steps and slopes.
  RowLaw sum(const AxisProperties& p);
  /// The rate at which the law has the impulse λ, the nearest to w: a solution is off by a tolerance, and at
  /// w itself a motor that holds its target might give all that it can.
  double rate_of(const AxisProperties& p, double lambda, double w) const;
  /// How an impulse λ at the rate w, which is on the law (rate_of()), is made up.
  AxisImpulse split(double lambda, double w) const;

  template <typename AnyArchive>
  void transfer(AnyArchive& archive) {
    archive(known, start.theta, start.rate, start.effective_mass);
    with_parts(*this, [&](auto&... part) { (part.transfer(archive), ...); });
  }

 private:
  RowLaw graph(const AxisProperties& p) const;
};

}  // namespace taut
