#include <algorithm>
#include <cmath>

#include "solvers/axis_forces.h"

// Springs of axes, soft rows and between bodies; tables as tangents of their impulses over the rate of a
// stage. (solvers/README, "Axes")
namespace taut {
namespace {

/// Impulses of tables are right to this part of themselves.
constexpr double kTableTolerance = 1e-11;

}  // namespace

/// Both kicks give the mean of the force between θ₀ and θ₀ + h w: what they do then is what the potential
/// changes by, whatever the table.  For a linear spring this is the force in the middle of the step, the
/// implicit midpoint rule; what is not resolved gives more against the way, as if taken later on it.
/// Moreau–Jean has its own place there.
AxisForces::Tangent AxisForces::spring_tangent(const Axis& axis, const AxisSpring& spring, double w) const {
  if (weight_ > 0) {
    const double reach = weight_ * h_;
    const double stretch = axis.theta0 + weight_ * (1 - weight_) * h_ * axis.rate0 - spring.rest;
    if (!spring.table) return {-h_ * spring.stiffness * stretch, reach * reach * spring.stiffness};
    const double there = stretch + weight_ * reach * w;
    return tangent(h_ * spring.table->extended(there), reach * reach * spring.table->slope(there), w);
  }
  const double half = 0.5 * h_, stretch = axis.theta0 - spring.rest;
  if (!spring.table)
    return {-half * spring.stiffness * stretch, half * half * spring.stiffness + axis.excess};
  const Curve::Mean mean = spring.table->mean(stretch, stretch + h_ * w);
  return tangent(half * mean.value + axis.excess * w, half * h_ * mean.slope + axis.excess, w);
}

/// Dampers act against the mean rate of the step in its first kick, and against that after the second if they
/// are implicit there.
AxisForces::Tangent AxisForces::damper_tangent(const Axis& axis, const AxisSpring& spring, double w) const {
  const Curve& table = *spring.damping_table;
  if (weight_ > 0) {
    const double rate = (1 - weight_) * axis.rate0 + weight_ * w;
    return tangent(h_ * table.extended(rate), h_ * weight_ * table.slope(rate), w);
  }
  return tangent(0.5 * h_ * table.extended(w), 0.5 * h_ * table.slope(w), w);
}

void AxisForces::spring_forces(std::span<const double> theta, std::span<const double> rates,
                               std::span<double> lambda) const {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const int row = rows_[i].row;
    if (rows_[i].spring.index < 0) continue;
    const AxisSpring& spring = *properties(i).spring;
    lambda[row] = spring_force(spring, theta[row]) + damping_force(spring, rates[row]);
  }
}

/// Of a spring between bodies that has rows of displacements, its length bears the damper alone.
void AxisForces::read_own(std::size_t i) {
  AxisSpring& own = own_[i].spring.emplace();
  if (rows_[i].spring.index >= 0) {
    const LineSpring& spring = *world_.force(rows_[i].spring).spring();
    if (rows_[i].centred)
      own.stiffness = spring.law.stiffness;
    else
      own = spring.law;
    if (!rows_[i].centred && spring.is_centred()) own.stiffness = 0;
    return;
  }
  const JointCompliance c = world_.compliance(rows_[i].axis.joint).value_or(JointCompliance{});
  own.stiffness = 1 / (angular_[i] ? c.rotation : c.translation);
  own.damping = angular_[i] ? c.rotation_damping : c.translation_damping;
}

/// Beyond a limit with compliance a spring acts, as those of axes do, wherever the middle of the step is.
void AxisForces::soften_limit(Axis& axis, const AxisLimits& limits, double mean_rate) const {
  const double half = 0.5 * h_, middle = axis.theta0 + half * mean_rate;
  if (middle >= limits.lower && middle <= limits.upper) return;
  const double at = middle < limits.lower ? limits.lower : limits.upper;
  axis.limit_level = -half * (axis.theta0 - at) / limits.compliance;
  axis.limit_slope = half * half / limits.compliance;
  axis.linear_damping += half * limits.damping;
}

void AxisForces::begin_tangents(Axis& axis, double w) const {
  axis.tangent_at = w;
  axis.root_above = -kNever, axis.root_below = kNever;
}

/// Dampers of a kick of RATTLE, those without a table in linear_damping.
void AxisForces::set_damping(Axis& axis, const AxisProperties& p) const {
  axis.damping_level = 0;
  axis.damping_slope = axis.linear_damping;
  if (!p.spring || !p.spring->damping_table) return;
  const Tangent damper = damper_tangent(axis, *p.spring, axis.tangent_at);
  axis.damping_level += damper.level;
  axis.damping_slope += damper.slope;
}

/// Newton's method for the impulses of tables, which fall with the rate: if a solution with tangents lies to
/// the right of where they touch, the one sought does, too, as far as the row by itself goes.  Digressive
/// dampers would have it jump to and fro for ever, so what lies outside of the bounds known is halved.
bool AxisForces::bend(std::span<const double> w, double rate_tolerance) {
  bool any = false;
  if (!has_tables_) return false;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const AxisProperties& p = properties(i);
    if (!has_table(p) || released_[i]) continue;
    Axis& axis = axes_[i];
    const double rate = w[rows_[i].row];
    double off = 0, size = 0;
    const auto compare = [&](const Tangent& there, double given) {
      off = std::max(off, std::abs(there.at(rate) - given));
      size = std::max(size, std::abs(given));
    };
    if (p.spring->table && !second_kick_)
      compare(spring_tangent(axis, *p.spring, rate), axis.spring_level - axis.spring_slope * rate);
    if (p.spring->damping_table && (!second_kick_ || axis.implicit_damping)) {
      const Tangent now = damper_tangent(axis, *p.spring, axis.tangent_at);
      compare(damper_tangent(axis, *p.spring, rate), now.at(rate));
    }
    if (off <= std::max(kTableTolerance * size, 0.1 * rate_tolerance * axis.inertia)) continue;
    any = true;
    (rate > axis.tangent_at ? axis.root_above : axis.root_below) = axis.tangent_at;
    if (rate > axis.root_above && rate < axis.root_below)
      axis.tangent_at = rate;
    else if (axis.root_below - axis.root_above > rate_tolerance)
      axis.tangent_at = 0.5 * (axis.root_above + axis.root_below);
    else
      begin_tangents(axis, rate);  // others have moved it
  }
  return any;
}

}  // namespace taut
