#include <algorithm>
#include <cmath>

#include "solvers/laws/axis_forces.h"

// Springs of axes, soft rows and between bodies; tables as tangents of their impulses over the rate of a
// stage. (solvers/laws, "Axes")
//
// The mean force on the way of a step times that way is the change of its potential, so that tables and soft
// limits conserve energy however stiff they are and wherever they bend; for a linear force it
// is the force at mid-step.  A spring between bodies has its length L as coordinate and, like a joint, one
// block in the Delassus matrix; its stiffness across the line, T/L, is geometric stiffness.  A linear one of
// natural length 0 has the three displacements of its points in axes of A instead, which are smooth where L
// is not, and L for its damper only.  Elsewhere ends may pass each other within a step: L then counts as
// negative, and that one step is not exact, since the force jumps.
namespace taut {
namespace {

/// Impulses of tables are right to this part of themselves.
constexpr double kTableTolerance = 1e-11;

/// Mean of `beyond` on a way that begins with a and ends with b, and its derivative with respect to the end.
Curve::Mean mean_beyond(double a, double b, double way) {
  if (a == 0 && b == 0) return {};
  if (a * b > 0) return {0.5 * (a + b), 0.5};
  const double mean = 0.5 * (b - a) * (b + a) / way;
  return {mean, (b - mean) / way};
}

}  // namespace

/// RATTLE goes h w, with the middle of it as the place of a force in both kicks; Moreau–Jean h V_ϑ.
AxisForces::Stroke AxisForces::way(const Axis& axis, double w) const {
  if (weight_ == 0) return {0.5 * h_, axis.theta0, axis.theta0 + h_ * w, h_, 0.5};
  return {h_, axis.theta0, axis.theta0 + h_ * ((1 - weight_) * axis.rate0 + weight_ * w), weight_ * h_,
          weight_};
}

/// For ϑ = ½ the mean of the force on the way: what it does then is what the potential changes by, whatever
/// the table, and for a linear spring this is the implicit midpoint rule.  For more a part of it is the force
/// at the end, which takes energy; what is not resolved gives more against the way, too.
AxisForces::Tangent AxisForces::spring_tangent(const Axis& axis, const AxisSpring& spring, double w) const {
  const Stroke there = way(axis, spring.table ? w : 0);
  const double from = there.from - spring.rest, to = there.to - spring.rest;
  if (!spring.table) {
    const double impulse = there.time * spring.stiffness;
    return {-impulse * (from + there.weight * (to - from)),
            impulse * there.weight * there.per_rate + axis.excess};
  }
  const Curve::Mean mean = spring.table->mean(from, to);
  const double last = 2 * there.weight - 1;
  const double force = (1 - last) * mean.value + last * spring.table->extended(to);
  const double slope = ((1 - last) * mean.slope + last * spring.table->slope(to)) * there.per_rate;
  return tangent(there.time * force + axis.excess * w, there.time * slope + axis.excess, w);
}

/// Beyond a limit with compliance there is a spring, as those of axes.  What is more than that against the
/// way counts the part of the way that is beyond the limit.
AxisForces::Tangent AxisForces::limit_tangent(const Axis& axis, const AxisLimits& limits, double w) const {
  const Stroke there = way(axis, w);
  const double from = beyond(limits, there.from), to = beyond(limits, there.to);
  const Curve::Mean mean = mean_beyond(from, to, there.to - there.from);
  const double last = 2 * there.weight - 1, impulse = there.time / limits.compliance;
  const double stretch = (1 - last) * mean.value + last * to;
  const double slope = (1 - last) * mean.slope + (to != 0 ? last : 0);
  const double excess = axis.limit_excess / h_;
  return tangent(impulse * stretch + excess * (to - from),
                 (impulse * slope + (to != 0 ? excess : 0)) * there.per_rate, w);
}

/// Its damper acts on the way that is beyond.
AxisForces::Tangent AxisForces::limit_damper_tangent(const Axis& axis, const AxisLimits& limits,
                                                     double w) const {
  const Stroke there = way(axis, w);
  const double to = beyond(limits, there.to), damping = there.time / h_ * limits.damping;
  return tangent(damping * (to - beyond(limits, there.from)), to != 0 ? damping * there.per_rate : 0, w);
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

void AxisForces::begin_tangents(Axis& axis, double w) const {
  axis.tangent_at = w;
  axis.root_above = -kNever, axis.root_below = kNever;
}

/// Dampers of a kick of RATTLE, those without a table in linear_damping.
void AxisForces::set_damping(Axis& axis, const AxisProperties& p) const {
  axis.damping_level = 0;
  axis.damping_slope = axis.linear_damping;
  const auto add = [&](const Tangent& damper) {
    axis.damping_level += damper.level;
    axis.damping_slope += damper.slope;
  };
  if (p.spring && p.spring->damping_table) add(damper_tangent(axis, *p.spring, axis.tangent_at));
  if (!has_soft_limit(p)) return;
  if (!second_kick_) add(limit_damper_tangent(axis, *p.limits, axis.tangent_at));
  if (second_kick_ && axis.beyond) axis.damping_slope += 0.5 * h_ * p.limits->damping;
}

/// Newton's method for the impulses of tables and soft limits, which fall with the rate: if a solution with
/// tangents lies to the right of where they touch, the one sought does, too, as far as the row by itself
/// goes.  Digressive dampers would have it jump to and fro for ever, so what lies outside of the bounds known
/// is halved.
bool AxisForces::relinearize_tables(std::span<const double> w, double rate_tolerance) {
  bool any = false;
  if (!has_bends_) return false;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const AxisProperties& p = properties(i);
    if (!is_bent(p) || released_[i]) continue;
    Axis& axis = axes_[i];
    const double rate = w[rows_[i].row];
    double off = 0, size = 0;
    const auto compare = [&](const Tangent& there, double given) {
      off = std::max(off, std::abs(there.at(rate) - given));
      size = std::max(size, std::abs(given));
    };
    if (p.spring && p.spring->table && !second_kick_)
      compare(spring_tangent(axis, *p.spring, rate), axis.spring_level - axis.spring_slope * rate);
    if (has_soft_limit(p) && !second_kick_) {
      compare(limit_tangent(axis, *p.limits, rate), axis.limit_level - axis.limit_slope * rate);
      compare(limit_damper_tangent(axis, *p.limits, rate),
              limit_damper_tangent(axis, *p.limits, axis.tangent_at).at(rate));
    }
    if (p.spring && p.spring->damping_table && (!second_kick_ || axis.implicit_damping)) {
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
