#include <algorithm>

#include "solvers/laws/axis_forces.h"

// How the impulses of axes are made up, what is kept of them for the next kick and step, and their reports.
namespace taut {

/// Springs, dampers and levels are known from w; on a step of the law the rest goes to friction as far as it
/// reaches, then to the motor, then to the limit.
AxisImpulse AxisForces::share(int i, double lambda, double w) const {
  const Axis& axis = axes_[i];
  AxisImpulse impulse;
  if (released_[i]) return impulse;
  impulse.elastic_limit = axis.limit_level - axis.limit_slope * w;
  impulse.spring = axis.spring_level - axis.spring_slope * w;
  impulse.damping = axis.damping_level - axis.damping_slope * w;
  double rest = lambda - impulse.spring - impulse.damping - impulse.elastic_limit;
  const auto take = [&](double at, double force) {
    const double given = on_step(w, at) ? std::clamp(rest, -force, force) : w < at ? force : -force;
    return force > 0 ? given : 0;
  };
  // What is known for certain first.
  const bool on_limit = on_step(w, axis.lower_at) || on_step(w, axis.upper_at);
  if (!on_limit) rest -= impulse.limit = axis.upper_back - axis.lower_back;
  if (!on_step(w, axis.motor_at)) rest -= impulse.motor = take(axis.motor_at, axis.motor_force);
  rest -= impulse.friction = take(axis.friction_at, axis.friction_force);
  if (on_step(w, axis.motor_at)) rest -= impulse.motor = take(axis.motor_at, axis.motor_force);
  if (on_limit) impulse.limit = rest;
  return impulse;
}

void AxisForces::finish_positions(std::span<const double> w) {
  second_kick_ = true;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Axis& axis = axes_[i];
    const double rate = w[rows_[i].row];
    axis.spring = axis.spring_level - axis.spring_slope * rate;
    axis.damping = axis.damping_level - axis.damping_slope * rate;
    if (is_bent(properties(i))) {
      axis.implicit_damping = axis.implicit_damping || axis.damping_slope > axis.inertia;
      begin_tangents(axis, rate);
    }
    axis.soft_limit = axis.limit_level - axis.limit_slope * rate;
  }
}

void AxisForces::finish_velocities(std::span<const double> theta, std::span<const double> w, double time) {
  struck_ = false;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const double rate = w[rows_[i].row];
    const bool due = impacts_[i].stage == Impact::Stage::kDue;
    const bool hit = is_rigid_limit(i) && ((on_step(rate, axes_[i].lower_at) && in_flight(i, true)) ||
                                           (on_step(rate, axes_[i].upper_at) && in_flight(i, false)));
    if (due || hit) {
      reports_[i].impact_time = time;
      struck_ = true;
    }
    if (due) impacts_[i].spent = true;
    impacts_[i].stage = Impact::Stage::kNone;
    Axis& axis = axes_[i];
    const bool held = axis.friction_force > 0 && on_step(w[rows_[i].row], 0);
    if (held && (!axis.stuck || axis.broken)) axis.anchor = theta[rows_[i].row];
    axis.stuck = held;
    axis.broken = false;
    reports_[i].stuck = held;
  }
}

void AxisForces::add(AxisReport& report, int i, double lambda, double w, double rate) const {
  const AxisImpulse impulse = share(i, lambda, w);
  for (auto part : {&AxisImpulse::motor, &AxisImpulse::friction, &AxisImpulse::limit, &AxisImpulse::spring,
                    &AxisImpulse::damping, &AxisImpulse::elastic_limit}) {
    report.force.*part += impulse.*part;
    report.work.*part += impulse.*part * rate;
  }
}

void AxisForces::record_first_kick(std::span<const double> lambda, std::span<const double> w,
                                   std::span<const double> rates) {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const int row = rows_[i].row;
    first_kick_[i] = {};
    add(first_kick_[i], static_cast<int>(i), lambda[row], w[row], rates[row]);
  }
}

void AxisForces::accumulate_work(std::span<const double> lambda, std::span<const double> w,
                                 std::span<const double> rates) {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const int row = rows_[i].row;
    const Axis& axis = axes_[i];
    AxisReport& report = reports_[i];
    report.force += first_kick_[i].force;
    report.work += first_kick_[i].work;
    add(report, static_cast<int>(i), lambda[row], w[row], rates[row]);
    report.saturated = properties(i).motor && !released_[i] && !on_step(w[row], axis.motor_at);
    report.at_limit =
        on_step(w[row], axis.lower_at) || on_step(w[row], axis.upper_at) || axis.soft_limit != 0;
  }
}

void AxisForces::clear_reports() {
  std::fill(reports_.begin(), reports_.end(), AxisReport{});
  std::fill(impacts_.begin(), impacts_.end(), Impact{});
  impact_count_ = 0;
}

}  // namespace taut
