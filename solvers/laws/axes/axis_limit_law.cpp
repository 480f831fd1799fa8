#include "solvers/laws/axes/axis_limit_law.h"

#include <algorithm>
#include <cmath>

namespace taut {

bool in_flight(const AxisLimits& limits, double theta, bool at_lower) {
  return at_lower ? theta > limits.lower + LawTuning::kTouch : theta < limits.upper - LawTuning::kTouch;
}

bool is_struck(const AxisLimits& limits, const AxisImpact& impact, double theta, bool at_lower) {
  return !in_flight(limits, theta, at_lower) || impact.due_at(at_lower);
}

bool AxisLimitLaw::set(const AxisStage& stage) {
  clear();
  if (!has_rigid_limit(stage.p)) return true;
  switch (stage.step.kick) {
    case Kick::kFirst:
      set_first_kick(stage);
      break;
    case Kick::kSecond:
      stage.round ? set_impact(stage) : set_second_kick(stage);
      break;
    case Kick::kSingle:
      set_single_kick(stage);
  }
  if (std::isnan(lower_at) || std::isnan(upper_at)) return clear(), false;
  // Rates beyond come of steps that fail; limits must not exclude each other there.
  lower_at = std::clamp(lower_at, -kUnreachedRate, kUnreachedRate);
  upper_at = std::clamp(upper_at, -kUnreachedRate, kUnreachedRate);
  return true;
}

/// Bounds of the mean rate; a limit whose impact is sought is left out.
void AxisLimitLaw::set_first_kick(const AxisStage& stage) {
  const AxisLimits& limits = *stage.p.limits;
  const AxisImpact& impact = stage.impact;
  const double theta0 = stage.start.theta, h = stage.step.h;
  const double fastest = std::max(LawTuning::kReturnRate, LawTuning::kTouch / h);
  if (!impact.sought() || !impact.at_lower)
    lower_at = std::clamp((limits.lower - theta0) / h, -kUnreachedRate, fastest);
  if (!impact.sought() || impact.at_lower)
    upper_at = std::clamp((limits.upper - theta0) / h, -fastest, kUnreachedRate);
}

/// Bounds of the rate at θ₁, by Newton's law of impact with the rate before the step for what was not
/// located; an impact that is due is left out: it strikes after this stage.
void AxisLimitLaw::set_second_kick(const AxisStage& stage) {
  const AxisLimits& limits = *stage.p.limits;
  const AxisImpact& impact = stage.impact;
  const double theta1 = stage.theta, first_kick = stage.first_kick.limit;
  const double bounce = -limits.restitution * stage.start.rate;
  const bool at_lower = theta1 <= limits.lower + LawTuning::kTouch && !impact.due_at(true);
  const bool at_upper = theta1 >= limits.upper - LawTuning::kTouch && !impact.due_at(false);
  if (at_lower) lower_at = stage.jolt ? bounce : std::max(0.0, bounce);
  if (at_upper) upper_at = stage.jolt ? bounce : std::min(0.0, bounce);
  // Both kicks together are the impulse that must not pull.  With Λ ≥ 0 ⊥ θ̇⁺ + e θ̇⁻ ≥ 0 and one e for all
  // the energy changes by −½ (1 − e)/(1 + e) ‖ΔV‖²_M; without an impact, bounds ≥ 0 let bouncing die out.
  lower_back = at_lower ? std::max(0.0, first_kick) : 0;
  upper_back = at_upper ? std::max(0.0, -first_kick) : 0;
  if (at_lower && at_upper && lower_at > upper_at) lower_at = upper_at = 0;  // locked between both
}

/// Newton's law of impact for all limits that are touched, against the rate at the start of the round; what
/// it adds does not pull.
void AxisLimitLaw::set_impact(const AxisStage& stage) {
  const AxisLimits& limits = *stage.p.limits;
  const double before = stage.round->rate, given = stage.round->limit;
  const double e = stage.step.restitution * limits.restitution;
  const auto bounce = [&](bool comes) { return -(comes ? e : 1) * before; };
  const bool at_lower = is_struck(limits, stage.impact, stage.theta, true),
             at_upper = is_struck(limits, stage.impact, stage.theta, false);
  if (at_lower) {
    lower_at = bounce(before < 0);
    lower_back = at_upper ? -std::max(0.0, given) : -given;
  }
  if (at_upper) {
    upper_at = bounce(before > 0);
    upper_back = at_lower ? std::min(0.0, given) : given;
  }
}

/// Newton's law of impact for a limit that is passed.
void AxisLimitLaw::set_single_kick(const AxisStage& stage) {
  const AxisLimits& limits = *stage.p.limits;
  const double theta = stage.theta, bounce = -limits.restitution * stage.start.rate;
  const bool at_lower = theta <= limits.lower + LawTuning::kTouch,
             at_upper = theta >= limits.upper - LawTuning::kTouch;
  if (at_lower) lower_at = bounce;
  if (at_upper) upper_at = bounce;
  if (at_lower && at_upper) lower_at = upper_at = 0;  // locked between both
}

void AxisLimitLaw::add_to(RowLaw& law, const AxisProperties& p) const {
  if (!has_rigid_limit(p)) return;
  if (std::isfinite(p.limits->lower)) law.add_step(lower_at, RowLaw::kInfinity, -lower_back);
  if (std::isfinite(p.limits->upper)) law.add_step(upper_at, upper_back, -RowLaw::kInfinity);
}

}  // namespace taut
