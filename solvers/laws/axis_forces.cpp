#include "solvers/laws/axis_forces.h"

#include <algorithm>
#include <cmath>

namespace taut {
namespace {

/// An axis that starts beyond its limit comes back at no more than this rate [m/s or rad/s].
constexpr double kReturnRate = 1;
/// An axis slower than this is at rest at the start [m/s or rad/s].
constexpr double kRest = 1e-12;
/// Slower impacts do not move others [m/s or rad/s].
constexpr double kJolt = 1e-6;
/// Times of impact looked for in one step; more impacts end with their sub-step.
constexpr int kMostAxisImpacts = 16;

}  // namespace

AxisForces::AxisForces(const World& world, const Rows& rows)
    : world_(world), rows_(rows.axis_rows().begin(), rows.axis_rows().end()) {
  released_.assign(rows_.size(), 0);
  growing_ = from_own_ = released_;
  for (const Rows::AxisRow& row : rows_) angular_.push_back(rows.row(row.row).angular);
  if (std::any_of(rows_.begin(), rows_.end(), [](const auto& row) { return row.axis.axis < 0; }))
    own_.resize(rows_.size());
  read_properties();
  axes_.resize(rows_.size());
  before_ = axes_;
  impacts_.resize(rows_.size());
  reports_.resize(rows_.size());
  first_kick_.resize(rows_.size());
  reports_before_ = reports_;
}

void AxisForces::start(std::span<const double> theta, std::span<const double> rates) {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    axes_[i] = {};
    axes_[i].stuck = std::abs(rates[rows_[i].row]) <= kRest;
    axes_[i].anchor = theta[rows_[i].row];
  }
  before_ = axes_;
}

void AxisForces::begin(double time, double h, std::span<const double> theta, std::span<const double> rates,
                       std::span<const double> inertia) {
  h_ = h;
  end_time_ = time + h;
  not_finite_ = -1;
  weight_ = 0;
  second_kick_ = false;
  read_properties();
  std::copy(axes_.begin(), axes_.end(), before_.begin());
  reports_before_ = reports_;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    axes_[i].theta0 = theta[rows_[i].row];
    axes_[i].rate0 = rates[rows_[i].row];
  }
  begin_bends();
  begin_swings();
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Axis& axis = axes_[i];
    const AxisProperties& p = properties(i);
    axis.broken = false;
    axis.load_change = 0;
    const double damping = (p.friction ? p.friction->viscous : 0) + (p.spring ? p.spring->damping : 0) +
                           (p.limits ? p.limits->damping : 0);
    axis.inertia = inertia[rows_[i].row];
    axis.implicit_damping = 0.5 * h * damping > axis.inertia;
    if (is_bent(p)) begin_tangents(axis, axis.rate0);
  }
}

/// What is asked for often, and that a softened row is an axis with a spring at rest where its gap is closed,
/// one of a spring between bodies an axis with that spring.
void AxisForces::read_properties() {
  if (axis_version_ == world_.axis_version()) return;
  axis_version_ = world_.axis_version();
  has_limits_ = has_loads_ = has_bends_ = has_springs_ = false;
  find_swings();
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (rows_[i].axis.axis < 0) read_own(i);
    const AxisProperties& p = properties(i);
    has_limits_ = has_limits_ || (p.limits && p.limits->compliance == 0);
    has_loads_ = has_loads_ || (p.friction && p.friction->per_load != 0);
    has_bends_ = has_bends_ || is_bent(p);
    has_springs_ = has_springs_ || p.spring || has_soft_limit(p);
  }
}

void AxisForces::inherit(const AxisForces& old) {
  resting_ = old.resting_;
  for (std::size_t i = 0; i < old.rows_.size(); ++i)
    if (old.rows_[i].axis.axis >= 0) resting_.insert_or_assign(old.rows_[i].axis, old.axes_[i]);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const auto same = resting_.find(rows_[i].axis);
    if (same == resting_.end()) continue;
    const Axis& memory = same->second;
    if (memory.known) {
      axes_[i].anchor = memory.anchor;
      axes_[i].stuck = memory.stuck;
      axes_[i].load = memory.load;
    }
    resting_.erase(same);
  }
  before_ = axes_;
}

void AxisForces::forget(std::span<const char> moved) {
  const auto is_moved = [&](JointId joint) {
    const std::span<const BodyId> bodies = world_.joint(joint).bodies();
    return std::any_of(bodies.begin(), bodies.end(), [&](BodyId body) { return moved[body.index]; });
  };
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (rows_[i].axis.joint.index >= 0 && is_moved(rows_[i].axis.joint)) axes_[i].known = false;
  std::erase_if(resting_, [&](const auto& entry) { return is_moved(entry.first.joint); });
}

void AxisForces::release(JointId joint) {
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (rows_[i].axis.joint == joint) released_[i] = 1;
}

void AxisForces::roll_back() {
  std::copy(before_.begin(), before_.end(), axes_.begin());
  reports_ = reports_before_;
}

double AxisForces::motor_force(const AxisMotor& motor, double rate) const {
  const double available =
      motor.force_of_speed ? motor.force_of_speed->held(std::abs(rate)) : motor.max_force;
  return std::min(available, motor.max_force);
}

void AxisForces::position_laws(std::span<const double> mean_rates, std::span<RowLaw> laws) {
  const double half = 0.5 * h_;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Axis& axis = axes_[i];
    const AxisProperties& p = properties(i);
    axis.spring_level = axis.spring_slope = axis.linear_damping = 0;
    axis.limit_level = axis.limit_slope = 0;
    if (released_[i]) {
      laws[rows_[i].row] = RowLaw::none();
      continue;
    }
    if (p.spring) {
      const Tangent spring = spring_tangent(axis, *p.spring, axis.tangent_at);
      axis.spring_level = spring.level, axis.spring_slope = spring.slope;
      axis.linear_damping = half * p.spring->damping;
    }
    axis.friction_force = axis.motor_force = 0;
    if (p.friction) {
      const bool held = axis.stuck && !axis.broken;
      axis.linear_damping += half * p.friction->viscous;
      axis.friction_force = half * (held ? p.friction->static_friction : p.friction->dynamic_friction) +
                            p.friction->per_load * axis.load;
      const double off = axis.anchor - axis.theta0;
      axis.friction_at = held ? (off - std::clamp(off, -slack_, slack_)) / h_ : 0;
    }
    axis.lower_at = -kNever, axis.upper_at = kNever;
    axis.lower_back = axis.upper_back = 0;
    if (is_rigid_limit(i)) set_limits(axis, *p.limits, impacts_[i]);
    if (has_soft_limit(p)) {
      const Tangent limit = limit_tangent(axis, *p.limits, axis.tangent_at);
      axis.limit_level = limit.level, axis.limit_slope = limit.slope;
    }
    set_damping(axis, p);
    if (p.motor) {
      const AxisMotor& m = *p.motor;
      axis.motor_force = half * motor_force(m, mean_rates[rows_[i].row]);
      const double aim = m.mode == AxisMotor::Mode::kTrajectory ? m.trajectory(end_time_).value : m.target;
      axis.motor_at = m.mode == AxisMotor::Mode::kVelocity
                          ? m.target
                          : std::clamp((aim - axis.theta0) / h_, -m.max_speed, m.max_speed);
      require_finite_target(axis);
    }
    laws[rows_[i].row] = law_of(axis, p);
  }
}

/// A law cannot have a breakpoint that is not a number.
void AxisForces::require_finite_target(Axis& axis) {
  if (std::isfinite(axis.motor_at)) return;
  not_finite_ = static_cast<int>(&axis - axes_.data());
  axis.motor_at = axis.motor_force = 0;
}

/// Bounds of the position stage on the mean rate.
void AxisForces::set_limits(Axis& axis, const AxisLimits& limits, const Impact& impact) const {
  const double fastest = std::max(kReturnRate, kTouch / h_);
  const bool sought = impact.stage == Impact::Stage::kSought;
  if (!sought || !impact.at_lower)
    axis.lower_at = std::clamp((limits.lower - axis.theta0) / h_, -kNever, fastest);
  if (!sought || impact.at_lower)
    axis.upper_at = std::clamp((limits.upper - axis.theta0) / h_, -fastest, kNever);
}

void AxisForces::rigid_limits(std::vector<Bound>& bounds) const {
  bounds.clear();
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (is_rigid_limit(i))
      bounds.push_back(
          {rows_[i].row, properties(i).limits->lower, properties(i).limits->upper, rows_[i].axis});
}

Gap AxisForces::beyond_limits(std::span<const double> theta) const {
  Gap gap;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (!is_rigid_limit(i)) continue;
    const AxisLimits& limits = *properties(i).limits;
    double& worst = angular_[i] ? gap.radians : gap.metres;
    worst = std::max(
        worst, std::abs(Bound{0, limits.lower, limits.upper, rows_[i].axis}.excess(theta[rows_[i].row])));
  }
  return gap;
}

/// The step began away from the limit.
bool AxisForces::in_flight(std::size_t i, bool at_lower) const {
  const AxisLimits& limits = *properties(i).limits;
  return at_lower ? axes_[i].theta0 > limits.lower + kTouch : axes_[i].theta0 < limits.upper - kTouch;
}

bool AxisForces::seek_impacts(std::span<const double> w) {
  if (!has_limits_ || impact_count_ >= kMostAxisImpacts) return false;
  bool any = false;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const AxisProperties& p = properties(i);
    Impact& impact = impacts_[i];
    if (!is_rigid_limit(i) || p.limits->restitution == 0 || impact.spent ||
        impact.stage != Impact::Stage::kNone)
      continue;
    for (bool at_lower : {true, false}) {
      if (!in_flight(i, at_lower)) continue;
      if (!on_step(w[rows_[i].row], at_lower ? axes_[i].lower_at : axes_[i].upper_at)) continue;
      impact.stage = Impact::Stage::kSought;
      impact.at_lower = at_lower;
      any = true;
    }
  }
  if (any) ++impact_count_;
  return any;
}

/// Root of  θ₀ + θ̇₀ s + (w − θ̇₀) s²/h = θ_lim  in (0, h]; h if the axis does not get there.
double AxisForces::crossing(std::size_t i, double w) const {
  const Axis& axis = axes_[i];
  const AxisLimits& limits = *properties(i).limits;
  const double sign = impacts_[i].at_lower ? 1 : -1;
  const double gap = sign * (axis.theta0 - (impacts_[i].at_lower ? limits.lower : limits.upper));
  const auto gap_at = [&](double s) { return gap + sign * (axis.rate0 * s + (w - axis.rate0) * s * s / h_); };
  double low = 0, high = h_;
  if (gap_at(high) >= 0) return h_;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (gap_at(middle) > 0 ? low : high) = middle;
  }
  return high;
}

double AxisForces::first_impact(std::span<const double> w) const {
  double first = h_;
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (impacts_[i].stage == Impact::Stage::kSought) first = std::min(first, crossing(i, w[rows_[i].row]));
  return first;
}

void AxisForces::take_impacts(double until, std::span<const double> w) {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Impact& impact = impacts_[i];
    if (impact.stage != Impact::Stage::kSought) {
      impact.stage = Impact::Stage::kNone;
      continue;
    }
    const double mean = w[rows_[i].row], s = crossing(i, mean), rate0 = axes_[i].rate0;
    impact.stage = s <= until ? Impact::Stage::kDue : Impact::Stage::kNone;
    impact.rate = rate0 + 2 * (mean - rate0) * s / h_;
  }
}

void AxisForces::forget_impacts(bool for_good) {
  for (Impact& impact : impacts_) {
    if (for_good && impact.stage != Impact::Stage::kNone) impact.spent = true;
    impact.stage = Impact::Stage::kNone;
  }
}

/// Some axis runs into a limit in this sub-step.
bool AxisForces::has_impact(std::span<const double> theta) const {
  if (!has_limits_) return false;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const AxisProperties& p = properties(i);
    if (!is_rigid_limit(i)) continue;
    const double theta1 = theta[rows_[i].row], rate0 = axes_[i].rate0;
    if (impacts_[i].stage == Impact::Stage::kDue || (theta1 <= p.limits->lower + kTouch && rate0 < -kJolt) ||
        (theta1 >= p.limits->upper - kTouch && rate0 > kJolt))
      return true;
  }
  return false;
}

void AxisForces::velocity_laws(std::span<const double> theta, std::span<RowLaw> laws) {
  const bool jolt = has_impact(theta);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Axis& axis = axes_[i];
    const AxisProperties& p = properties(i);
    const double theta1 = theta[rows_[i].row];
    if (released_[i]) {
      laws[rows_[i].row] = RowLaw::none();
      continue;
    }
    axis.limit_level = axis.soft_limit;
    axis.beyond = has_soft_limit(p) && beyond(*p.limits, theta1) != 0;
    axis.limit_slope = axis.beyond ? axis.limit_excess : 0;
    axis.spring_level = axis.spring;
    axis.spring_slope = axis.excess;
    set_damping(axis, p);
    if (!axis.implicit_damping) axis.damping_level = axis.damping, axis.damping_slope = 0;
    if (p.friction) {
      const bool held = axis.stuck && !axis.broken;
      axis.friction_force = 0.5 * h_ * (held ? p.friction->static_friction : p.friction->dynamic_friction) +
                            p.friction->per_load * axis.load;
    }
    axis.friction_at = 0;
    axis.lower_at = -kNever, axis.upper_at = kNever;
    axis.lower_back = axis.upper_back = 0;
    if (is_rigid_limit(i)) {
      // Newton's law of impact with the rate just before, or else that before the step.  An impact that is
      // due happens even if a gap of order h³ is left.
      const bool due = impacts_[i].stage == Impact::Stage::kDue;
      const double bounce = -p.limits->restitution * (due ? impacts_[i].rate : axis.rate0);
      const bool at_lower = theta1 <= p.limits->lower + kTouch || (due && impacts_[i].at_lower);
      const bool at_upper = theta1 >= p.limits->upper - kTouch || (due && !impacts_[i].at_lower);
      if (at_lower) axis.lower_at = jolt ? bounce : std::max(0.0, bounce);
      if (at_upper) axis.upper_at = jolt ? bounce : std::min(0.0, bounce);
      // Both kicks together are the impulse that must not pull.  With Λ ≥ 0 ⊥ θ̇⁺ + e θ̇⁻ ≥ 0 and one e for
      // all the energy changes by −½ (1 − e)/(1 + e) ‖ΔV‖²_M; without an impact, bounds ≥ 0 let bouncing die
      // out.
      axis.lower_back = at_lower ? std::max(0.0, first_kick_[i].force.limit) : 0;
      axis.upper_back = at_upper ? std::max(0.0, -first_kick_[i].force.limit) : 0;
      if (axis.lower_at > axis.upper_at) axis.lower_at = axis.upper_at = 0;  // locked between both
    }
    if (p.motor) {
      const bool follows = p.motor->mode == AxisMotor::Mode::kTrajectory;
      const MotionPoint aim = follows ? p.motor->trajectory(end_time_) : MotionPoint{p.motor->target};
      const double left = aim.value - theta1, back = std::abs(left) <= kTouch ? 0 : left / h_;
      axis.motor_at = p.motor->mode == AxisMotor::Mode::kVelocity
                          ? p.motor->target
                          : std::clamp(aim.rate + back, -p.motor->max_speed, p.motor->max_speed);
      require_finite_target(axis);
    }
    laws[rows_[i].row] = law_of(axis, p);
  }
}

/// The sum of the steps and slopes of one axis.  The steps of limits are there even when far away, so that
/// the segments keep their numbers from stage to stage.
RowLaw AxisForces::law_of(Axis& axis, const AxisProperties& p) const {
  RowLaw law = RowLaw::viscous(axis.spring_slope + axis.damping_slope + axis.limit_slope);
  law.level[0] = axis.spring_level + axis.damping_level + axis.limit_level;
  if (axis.friction_force > 0)
    law = law + RowLaw::box(-axis.friction_force, axis.friction_force, axis.friction_at);
  if (axis.motor_force > 0) {
    // A motor of any force stops at a limit.
    if (std::isinf(axis.motor_force)) axis.motor_at = std::clamp(axis.motor_at, axis.lower_at, axis.upper_at);
    law = law + RowLaw::box(-axis.motor_force, axis.motor_force, axis.motor_at);
  }
  if (has_soft_limit(p)) return law;
  if (p.limits && std::isfinite(p.limits->lower)) {
    law = law + RowLaw::lower_limit(axis.lower_at);
    for (int k = 1; k <= law.steps; ++k) law.level[k] -= axis.lower_back;
  }
  if (p.limits && std::isfinite(p.limits->upper)) {
    law = law + RowLaw::upper_limit(axis.upper_at);
    for (int k = 0; k < law.steps; ++k) law.level[k] += axis.upper_back;
  }
  return law;
}

bool AxisForces::break_away(std::span<const double> w, double rate_tolerance) {
  bool any = false;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Axis& axis = axes_[i];
    const AxisProperties& p = properties(i);
    if (!p.friction || !axis.stuck || axis.broken || released_[i] ||
        on_step(w[rows_[i].row], axis.friction_at) ||
        std::abs(w[rows_[i].row] - axis.friction_at) <= rate_tolerance)
      continue;
    axis.broken = true;
    any = any || p.friction->dynamic_friction < p.friction->static_friction;
  }
  return any;
}

bool AxisForces::any_broken() const {
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (axes_[i].broken || (axes_[i].stuck && !properties(i).friction)) return true;
  return false;
}

void AxisForces::clear_loose(std::span<char> rows) const {
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (!axes_[i].stuck || axes_[i].broken || !properties(i).friction || released_[i] ||
        rows_[i].axis.axis < 0)
      rows[rows_[i].row] = 0;
}

}  // namespace taut
