#include "solvers/integrators/reduced/axis_modes.h"

#include <algorithm>
#include <cmath>

#include "solvers/laws/axes/axis_limit_law.h"
#include "solvers/laws/axes/axis_motor_law.h"
#include "solvers/laws/law_constants.h"

namespace taut {
namespace {

bool has_dry_friction(const AxisProperties& p) {
  return p.friction && (p.friction->static_friction > 0 || p.friction->dynamic_friction > 0);
}
bool has_stiff_motor(const AxisProperties& p) { return p.motor && AxisMotorLaw::keeps_target(*p.motor); }
bool jumps(const AxisProperties& p) {
  return has_rigid_limit(p) || has_dry_friction(p) || has_stiff_motor(p);
}

/// On which side of a step a rate is; 0: on it.
signed char side_of(double w, double at) {
  if (on_step(w, at)) return 0;
  return w > at ? 1 : -1;
}

/// The limit that is touched, −1 or 1; 0: none.
signed char touched_limit(const AxisProperties& p, double theta) {
  if (!has_rigid_limit(p)) return 0;
  if (!in_flight(*p.limits, theta, true)) return -1;
  return in_flight(*p.limits, theta, false) ? 0 : 1;
}

/// How far a rate is from a step, beyond which its side is another, over the tolerance.
double way_to_step(double w, double at, signed char side) {
  return side * (w - at) / (LawTuning::kOnStep * (1 + std::abs(w)));
}

/// How far a force is from its bound, over the tolerance.
double way_to_bound(double distance, double lambda, double bound) {
  if (std::isinf(bound)) return INFINITY;
  return distance / (LawTuning::kOnStep * (1 + std::abs(lambda) + std::abs(bound)));
}

}  // namespace

AxisModes::AxisModes(const World& world, const Rows& rows) : table_(world, rows) {
  table_.refresh();
  refresh();
}

void AxisModes::refresh() {
  table_.refresh();
  std::vector<Axis> before = std::move(axes_);
  axes_.clear();
  for (std::size_t i = 0, k = 0; i < table_.size(); ++i) {
    if (!jumps(table_.properties(i))) continue;
    while (k < before.size() && before[k].index < static_cast<int>(i)) ++k;
    const bool known = k < before.size() && before[k].index == static_cast<int>(i);
    axes_.push_back(known ? before[k] : Axis{.index = static_cast<int>(i), .row = table_.row(i)});
    axes_.back().since_impact = -1;
  }
}

void AxisModes::forget() {
  for (Axis& axis : axes_) axis.held = false;
  held_.clear();
}

double AxisModes::friction_beside(const Axis& axis) const {
  const AxisProperties& p = properties(axis);
  return has_dry_friction(p) ? -axis.friction * p.friction->dynamic_friction : 0;
}

double AxisModes::motor_beside(const Axis& axis, double rate) const {
  const AxisProperties& p = properties(axis);
  return has_stiff_motor(p) && axis.motor != 0 ? -axis.motor * available_force(*p.motor, std::abs(rate)) : 0;
}

void AxisModes::add_forces(std::span<const double> rates, std::span<double> tau) const {
  for (const Axis& axis : axes_) tau[axis.row] += friction_beside(axis) + motor_beside(axis, rates[axis.row]);
}

void AxisModes::give_forces(std::span<const double> rates, std::span<const double> lambda,
                            std::span<const double> tau, std::span<AxisImpulse> forces) const {
  for (const Axis& axis : axes_) {
    const AxisProperties& p = properties(axis);
    AxisImpulse& force = forces[axis.index];
    force.friction += friction_beside(axis);
    force.motor += motor_beside(axis, rates[axis.row]);
    if (!axis.held) continue;
    // Friction first, then the motor as far as it reaches, and the limit all that is left.
    double rest = lambda[axis.row] - tau[axis.row];
    const auto take = [&](double& part, double bound) {
      const double taken = std::clamp(rest, -bound, bound);
      part += taken;
      rest -= taken;
    };
    if (has_dry_friction(p) && axis.friction == 0)
      take(force.friction, axis.limit == 0 && !has_stiff_motor(p) ? INFINITY : p.friction->static_friction);
    if (has_stiff_motor(p) && axis.motor == 0)
      take(force.motor, axis.limit == 0 ? INFINITY : available_force(*p.motor, std::abs(rates[axis.row])));
    force.limit += rest;
  }
}

/// λ of what is on its step.
AxisModes::Box AxisModes::box(const Axis& axis) const {
  const AxisProperties& p = properties(axis);
  Box box;
  if (has_dry_friction(p) && axis.friction == 0)
    box = {-p.friction->static_friction, p.friction->static_friction};
  if (has_stiff_motor(p) && axis.motor == 0) {
    const double force = available_force(*p.motor, std::abs(p.motor->target));
    box = {box.lo - force, box.hi + force};
  }
  if (axis.limit < 0) box.hi = INFINITY;
  if (axis.limit > 0) box.lo = -INFINITY;
  return box;
}

ClosedTree::Held AxisModes::held_row(const Axis& axis) const {
  const AxisProperties& p = properties(axis);
  const bool moved = axis.limit == 0 && has_stiff_motor(p) && axis.motor == 0 && p.motor->target != 0;
  ClosedTree::Held held{.row = axis.row};
  if (moved)
    held.rate = p.motor->target;
  else
    held.position = axis.anchor;
  return held;
}

double AxisModes::margin(std::span<const double> theta, std::span<const double> rates,
                         std::span<const double> lambda, std::span<const double> tau) const {
  double least = INFINITY;
  const auto see = [&](double way) { least = way < least ? way : least; };
  for (const Axis& axis : axes_) {
    const AxisProperties& p = properties(axis);
    const double w = rates[axis.row], at = theta[axis.row];
    if (has_dry_friction(p) && axis.friction != 0) see(way_to_step(w, 0, axis.friction));
    if (has_stiff_motor(p) && axis.motor != 0) see(way_to_step(w, p.motor->target, axis.motor));
    if (has_rigid_limit(p) && axis.limit == 0) {
      if (w < 0) see((at - p.limits->lower) / LawTuning::kTouch);
      if (w > 0) see((p.limits->upper - at) / LawTuning::kTouch);
    }
    if (!axis.held) continue;
    const Box its = box(axis);
    const double force = lambda[axis.row] - tau[axis.row];
    see(way_to_bound(force - its.lo, force, its.lo));
    see(way_to_bound(its.hi - force, force, its.hi));
  }
  return least;
}

bool AxisModes::begin_impact(std::span<const double> theta, std::span<const double> rates, double time,
                             double step) {
  candidates_.clear();
  members_.clear();
  bool strikes = false;
  for (std::size_t k = 0; k < axes_.size(); ++k) {
    Axis& axis = axes_[k];
    const double w = rates[axis.row];
    approach_limit(axis, theta[axis.row], w, time, step);
    const std::optional<AxisMotor>& motor = properties(axis).motor;
    const bool driven = axis.limit == 0 && has_stiff_motor(properties(axis)) && is_unbounded(*motor);
    strikes = strikes || axis.approach != 0 || (driven && !on_step(w, motor->target));
    if (axis.limit == 0 && !driven) continue;
    candidates_.push_back({.row = axis.row, .rate = driven ? motor->target : 0});
    members_.push_back(static_cast<int>(k));
  }
  set_impact_laws();
  return strikes;
}

/// Impacts that follow each other too fast are one, which has no restitution any more.
void AxisModes::approach_limit(Axis& axis, double theta, double w, double time, double step) const {
  const AxisProperties& p = properties(axis);
  axis.limit = touched_limit(p, theta);
  axis.approach = axis.restitution = 0;
  if (axis.limit == 0 || side_of(w, 0) != axis.limit) return;
  axis.approach = w;
  const bool again = axis.since_impact >= 0 && time - axis.since_impact < LawTuning::kTogether * step;
  if (!again) axis.restitution = p.limits->restitution;
  axis.since_impact = time;
}

/// Newton's law of impact: w⁺ ≥ −e w⁻ from a lower limit.
void AxisModes::set_impact_laws() {
  laws_.clear();
  for (const int k : members_) {
    const Axis& axis = axes_[k];
    const double back = -axis.restitution * axis.approach;
    laws_.push_back(axis.limit < 0   ? RowLaw::lower_limit(back)
                    : axis.limit > 0 ? RowLaw::upper_limit(back)
                                     : RowLaw::equality());
  }
}

void AxisModes::use_least_restitution() {
  double least = 1;
  for (const int k : members_)
    if (axes_[k].approach != 0) least = std::min(least, axes_[k].restitution);
  for (const int k : members_) axes_[k].restitution = least;
  set_impact_laws();
}

void AxisModes::end_impact(const double* impulses, const double* means, std::span<AxisReport> reports) {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    const Axis& axis = axes_[members_[i]];
    AxisReport& report = reports[axis.index];
    (axis.limit != 0 ? report.force.limit : report.force.motor) += impulses[i];
    (axis.limit != 0 ? report.work.limit : report.work.motor) += impulses[i] * means[i];
    if (axis.approach != 0) report.impact_time = axis.since_impact;
  }
}

void AxisModes::begin_choice(std::span<const double> theta, std::span<const double> rates) {
  for (Axis& axis : axes_) {
    const AxisProperties& p = properties(axis);
    const double w = rates[axis.row], at = theta[axis.row];
    axis.friction = has_dry_friction(p) ? side_of(w, 0) : 0;
    axis.motor = has_stiff_motor(p) ? side_of(w, p.motor->target) : 0;
    axis.limit = on_step(w, 0) ? touched_limit(p, at) : 0;
    if (axis.limit != 0)
      axis.anchor = axis.limit < 0 ? p.limits->lower : p.limits->upper;
    else if (!axis.held)
      axis.anchor = at;
  }
  list_candidates();
}

void AxisModes::list_candidates() {
  candidates_.clear();
  members_.clear();
  laws_.clear();
  for (std::size_t k = 0; k < axes_.size(); ++k) {
    const Box its = box(axes_[k]);
    if (!(its.lo < its.hi)) {
      axes_[k].held = false;
      continue;
    }
    candidates_.push_back(held_row(axes_[k]));
    laws_.push_back(RowLaw::box(its.lo, its.hi));
    members_.push_back(static_cast<int>(k));
  }
}

bool AxisModes::choose(std::span<const int> segments) {
  bool gives_less = false;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    Axis& axis = axes_[members_[i]];
    const AxisProperties& p = properties(axis);
    axis.held = RowLaw::is_vertical(segments[i]);
    if (axis.held) continue;
    const signed char side = segments[i] == 0 ? -1 : 1;
    if (has_dry_friction(p) && axis.friction == 0) {
      axis.friction = side;
      gives_less = gives_less || p.friction->dynamic_friction < p.friction->static_friction;
    }
    if (has_stiff_motor(p) && axis.motor == 0) axis.motor = side;
    axis.limit = 0;
  }
  if (gives_less) {
    list_candidates();
    return true;
  }
  list_held();
  return false;
}

void AxisModes::list_held() {
  held_.clear();
  for (const Axis& axis : axes_)
    if (axis.held) held_.push_back(held_row(axis));
}

void AxisModes::report(std::span<AxisReport> reports) const {
  for (const Axis& axis : axes_) {
    const AxisProperties& p = properties(axis);
    AxisReport& report = reports[axis.index];
    report.stuck = has_dry_friction(p) && axis.held && axis.friction == 0;
    report.at_limit = report.at_limit || (axis.held && axis.limit != 0);
    if (has_stiff_motor(p)) report.saturated = axis.motor != 0;
  }
}

}  // namespace taut
