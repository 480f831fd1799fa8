#include "solvers/laws/axis_forces.h"

#include <algorithm>
#include <cmath>

#include "solvers/laws/axis_unresolved.h"
#include "solvers/system/constraint_system.h"

namespace taut {

AxisForces::AxisForces(const World& world, const Rows& rows)
    : table_(world, rows),
      axes_(table_.size()),
      before_(axes_),
      loads_(table_.size()),
      impacts_(table_.size()),
      work_(table_.size()) {
  if (table_.refresh()) swings_.find(table_);
}

void AxisForces::spring_forces(std::span<const double> theta, std::span<const double> rates,
                               std::span<double> lambda) const {
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const int row = table_.row(i);
    if (table_.rows()[i].spring.index < 0) continue;
    const AxisSpring& spring = *table_.properties(i).spring;
    lambda[row] = spring_force(spring, theta[row]) + damping_force(spring, rates[row]);
  }
}

void AxisForces::start(std::span<const double> theta, std::span<const double> rates) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    axes_[i] = {};
    axes_[i].friction.start(theta[table_.row(i)], rates[table_.row(i)]);
  }
  before_ = axes_;
}

void AxisForces::begin(double time, double h, std::span<const double> theta, std::span<const double> rates,
                       std::span<const double> inertia) {
  step_ = {.h = h, .end_time = time + h};
  not_finite_ = -1;
  if (table_.refresh()) swings_.find(table_);
  std::copy(axes_.begin(), axes_.end(), before_.begin());
  work_.begin();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const int row = table_.row(i);
    axes_[i].start = {theta[row], rates[row], inertia[row]};
  }
  swings_.begin(table_, axes_, h);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    axes_[i].friction.begin();
    axes_[i].springs.begin(table_.properties(i), step_, axes_[i].start);
  }
}

bool AxisForces::find_unresolved(ConstraintSystem& system, bool single_kick) {
  return taut::find_unresolved(table_, axes_, step_.h, system, single_kick);
}

void AxisForces::inherit(const AxisForces& old) {
  resting_ = old.resting_;
  for (std::size_t i = 0; i < old.axes_.size(); ++i)
    if (old.table_.id(i).axis >= 0) resting_.insert_or_assign(old.table_.id(i), old.axes_[i]);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto same = resting_.find(table_.id(i));
    if (same == resting_.end()) continue;
    if (same->second.known) axes_[i].friction.inherit(same->second.friction);
    resting_.erase(same);
  }
  before_ = axes_;
}

void AxisForces::forget(std::span<const char> moved) {
  const auto is_moved = [&](JointId joint) {
    const std::span<const BodyId> bodies = table_.world().joint(joint).bodies();
    return std::any_of(bodies.begin(), bodies.end(), [&](BodyId body) { return moved[body.index]; });
  };
  for (std::size_t i = 0; i < axes_.size(); ++i)
    if (table_.id(i).joint.index >= 0 && is_moved(table_.id(i).joint)) axes_[i].known = false;
  std::erase_if(resting_, [&](const auto& entry) { return is_moved(entry.first.joint); });
}

void AxisForces::roll_back() {
  std::copy(before_.begin(), before_.end(), axes_.begin());
  work_.roll_back();
}

/// Those of axes that are released are none; `set(i)` sets the parts of others, and is false if a motor's aim
/// is not finite.
template <typename Set>
void AxisForces::set_laws(std::span<RowLaw> laws, Set set) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    RowLaw& law = laws[table_.row(i)];
    if (table_.released(i)) {
      law = RowLaw::none();
      continue;
    }
    const AxisProperties& p = table_.properties(i);
    if (!set(axes_[i], p, i)) not_finite_ = static_cast<int>(i);
    law = axes_[i].sum(p);
  }
}

void AxisForces::position_laws(std::span<const double> mean_rates, std::span<RowLaw> laws) {
  const double kick = 0.5 * step_.h;
  for (AxisLaw& axis : axes_) axis.springs.clear();
  set_laws(laws, [&](AxisLaw& axis, const AxisProperties& p, std::size_t i) {
    axis.springs.set_first_kick(p, step_, axis.start);
    axis.friction.bound = axis.motor.bound = 0;
    if (p.friction) {
      axis.friction.set_bound(*p.friction, kick);
      axis.friction.hold_anchor(axis.start.theta, step_.h, slack_);
    }
    axis.limits.clear();
    if (table_.has_rigid_limit(i))
      axis.limits.bound_position(*p.limits, impacts_[i], axis.start.theta, step_.h);
    if (!p.motor) return true;
    axis.motor.set_bound(*p.motor, kick, mean_rates[table_.row(i)]);
    return axis.motor.aim_position(*p.motor, step_, axis.start.theta);
  });
}

void AxisForces::velocity_laws(std::span<const double> theta, std::span<RowLaw> laws) {
  const bool jolt = impacts_.any(table_, axes_, theta);
  set_laws(laws, [&](AxisLaw& axis, const AxisProperties& p, std::size_t i) {
    const double theta1 = theta[table_.row(i)];
    axis.springs.set_second_kick(p, step_, axis.start, theta1);
    if (p.friction) axis.friction.set_bound(*p.friction, 0.5 * step_.h);
    axis.friction.at = 0;
    axis.limits.clear();
    if (table_.has_rigid_limit(i))
      axis.limits.bound_velocity(*p.limits, impacts_[i], theta1, axis.start.rate, jolt,
                                 work_.first_kick(i).limit);
    return !p.motor || axis.motor.aim_velocity(*p.motor, step_, theta1);
  });
}

void AxisForces::impulse_laws(double weight, std::span<const double> theta, std::span<RowLaw> laws) {
  step_.weight = weight;
  work_.clear_first_kick();
  set_laws(laws, [&](AxisLaw& axis, const AxisProperties& p, std::size_t i) {
    axis.springs.set_single_kick(p, step_, axis.start);
    axis.friction.bound = axis.motor.bound = axis.friction.at = 0;
    if (p.friction) axis.friction.set_bound(*p.friction, step_.h);
    axis.limits.clear();
    if (table_.has_rigid_limit(i))
      axis.limits.bound_single_kick(*p.limits, theta[table_.row(i)], axis.start.rate);
    if (!p.motor) return true;
    axis.motor.set_bound(*p.motor, step_.h, axis.start.rate);
    return axis.motor.aim_single_kick(*p.motor, step_, axis.start.theta);
  });
}

bool AxisForces::laws_move(const ConstraintSystem& system, std::span<const double> lambda,
                           std::span<const double> w, double rate_tolerance) {
  const bool broke = break_away(w, rate_tolerance), bent = relinearize(w, rate_tolerance);
  const bool turned = swings_.turn(table_, axes_, lambda, w);
  return loads_.update(table_, axes_, system.rows(), system.jacobian(), lambda) || broke || bent || turned;
}

/// Axes that static friction held and that have broken away: their bound is that of dynamic friction now.
bool AxisForces::break_away(std::span<const double> w, double rate_tolerance) {
  bool any = false;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const std::optional<AxisFriction>& friction = table_.properties(i).friction;
    if (!friction || table_.released(i) || !axes_[i].friction.break_away(w[table_.row(i)], rate_tolerance))
      continue;
    any = any || friction->dynamic_friction < friction->static_friction;
  }
  return any;
}

bool AxisForces::relinearize(std::span<const double> w, double rate_tolerance) {
  bool any = false;
  if (!table_.any_curved()) return false;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const AxisProperties& p = table_.properties(i);
    if (!is_curved(p) || table_.released(i)) continue;
    AxisLaw& axis = axes_[i];
    any = axis.springs.relinearize(p, step_, axis.start, w[table_.row(i)], rate_tolerance) || any;
  }
  return any;
}

bool AxisForces::any_broken() const {
  for (std::size_t i = 0; i < axes_.size(); ++i)
    if (axes_[i].friction.has_let_go(table_.properties(i).friction)) return true;
  return false;
}

void AxisForces::clear_loose(std::span<char> rows) const {
  for (std::size_t i = 0; i < axes_.size(); ++i)
    if (!axes_[i].friction.held() || !table_.properties(i).friction || table_.released(i) ||
        table_.id(i).axis < 0)
      rows[table_.row(i)] = 0;
}

void AxisForces::rigid_limits(std::vector<Bound>& bounds) const {
  bounds.clear();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (!table_.has_rigid_limit(i)) continue;
    const AxisLimits& limits = *table_.properties(i).limits;
    bounds.push_back({table_.row(i), limits.lower, limits.upper, table_.id(i)});
  }
}

Gap AxisForces::beyond_limits(std::span<const double> theta) const {
  Gap gap;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (!table_.has_rigid_limit(i)) continue;
    double& worst = table_.angular(i) ? gap.radians : gap.metres;
    worst = std::max(worst, std::abs(beyond(*table_.properties(i).limits, theta[table_.row(i)])));
  }
  return gap;
}

void AxisForces::finish_positions(std::span<const double> w) {
  step_.second_kick = true;
  for (std::size_t i = 0; i < axes_.size(); ++i)
    axes_[i].springs.finish_first_kick(table_.properties(i), axes_[i].start, w[table_.row(i)]);
}

void AxisForces::finish_velocities(std::span<const double> theta, std::span<const double> w, double time) {
  const std::span<AxisReport> reports = work_.reports();
  impacts_.finish(table_, axes_, w, time, reports);
  for (std::size_t i = 0; i < axes_.size(); ++i)
    reports[i].stuck = axes_[i].friction.finish(theta[table_.row(i)], w[table_.row(i)]);
}

void AxisForces::clear_reports() {
  work_.clear();
  impacts_.clear();
}

bool AxisForces::only_springs() const {
  return std::all_of(table_.rows().begin(), table_.rows().end(),
                     [](const auto& row) { return row.spring.index >= 0; });
}

}  // namespace taut
