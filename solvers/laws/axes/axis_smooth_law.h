#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/axes/axis.h"
#include "solvers/laws/axes/axis_part_law.h"
#include "solvers/laws/impulse_line.h"

namespace taut {

struct AxisSmoothTuning {
  /// A rate is known to this part of what the impulse has changed it by: some 45 units of round-off.
  static constexpr double kRoundOff = 1e-14;
  /// A tangent that is off by more than this part of the rate is far from the solution.  Chosen.
  static constexpr double kFar = 0.1;
  /// An axis by itself is solved to this part of its rate, in at most so many steps.  Chosen: it is a guess
  /// for the axis among others.
  static constexpr double kAlone = 1e-6;
  static constexpr int kMostAlone = 100;
  /// Moves of a tangent after which it goes half of the way.  Chosen.
  static constexpr int kNewtonMoves = 20;
};

/// What of a smooth property at θ is the force of a potential [N·m or N].
template <SmoothAxisProperty Property>
double stored_force(const Property& property, double theta) {
  if constexpr (StoringAxisProperty<Property>) return property.force(theta, 0);
  return 0;
}
/// Where the rest of its force is reported.
template <SmoothAxisProperty Property, typename Place = AxisPlace<Property>>
constexpr double AxisImpulse::*loss_part() {
  return StoringAxisProperty<Property> ? &AxisImpulse::damping : Place::kPart;
}

/// Impulse over a way, of a property with a law in its header, and what it falls by per rate, of that part
/// which a potential stores and of the rest.
struct SmoothImpulse {
  double stored = 0, rest = 0;              ///< [N·m·s or N·s]
  double stored_slope = 0, rest_slope = 0;  ///< ≥ 0 [kg·m² or kg]
};

namespace detail {
/// Gauss's points and weights from 0 to 1, exact to order 9.
struct GaussPoint {
  double at, weight;
};
inline constexpr std::array<GaussPoint, 5> kGaussPoints{{
    {0.046910077030668004, 0.11846344252809454},
    {0.23076534494715845, 0.23931433524968324},
    {0.5, 0.28444444444444444},
    {0.7692346550528415, 0.23931433524968324},
    {0.953089922969332, 0.11846344252809454},
}};
}  // namespace detail

/// For a `time` along the way with this rate, of which the slopes are taken by w, ∂rate/∂w = `rate_weight`.
/// The mean of its force over the way times that way is what its potential changes by; where forces act
/// beyond its middle a part of it is the force at the end, which takes energy.
template <SmoothAxisProperty Property>
SmoothImpulse smooth_impulse(const Property& property, const AxisStroke& way, double rate,
                             double rate_weight) {
  SmoothImpulse sum;
  const auto add = [&](double at, double weight) {
    const double theta = way.from + at * (way.to - way.from), time = weight * way.time;
    const double stored = stored_force(property, theta), all = property.force(theta, rate);
    sum.stored += time * stored;
    sum.rest += time * (all - stored);
    sum.rest_slope -= time * rate_weight * property.rate_slope(theta, rate);
    if constexpr (requires { property.place_slope(theta, rate); }) {
      const double moves = time * at * way.per_rate, slope = property.place_slope(theta, rate);
      const double of_stored = StoringAxisProperty<Property> ? property.place_slope(theta, 0) : 0;
      sum.stored_slope -= moves * of_stored;
      sum.rest_slope -= moves * (slope - of_stored);
    }
  };
  const double last = 2 * way.part - 1;
  for (const auto& [at, weight] : detail::kGaussPoints) add(at, (1 - last) * weight);
  if (last > 0) add(1, last);
  sum.stored_slope = std::max(0.0, sum.stored_slope);
  sum.rest_slope = std::max(0.0, sum.rest_slope);
  return sum;
}

/// The law of a property that is a smooth force of θ and θ̇, which its header has: lines λ = l − c w, tangents
/// to the impulse over the way of a step, as those of tables (AxisSpringLaw).  RATTLE gives in the second
/// kick what it gave in the first, the implicit midpoint rule, but for damping that would reverse the rate
/// there, which acts on θ̇(q₁); Moreau–Jean takes such damping later than ϑ.  It remembers nothing from step
/// to step.
template <SmoothAxisProperty Property, typename Place = AxisPlace<Property>>
struct AxisSmoothLaw : AxisPartLaw {
  ImpulseLine stored, rest;                 ///< of this stage
  double stored_given = 0, rest_given = 0;  ///< in the first kick
  double theta = 0;                         ///< θ(q₁), in the second kick
  double later = 0;       ///< of Moreau–Jean: part of the rate after the step, against which damping acts
  bool implicit = false;  ///< damping acts on θ̇(q₁) in the second kick
  double tangent = 0;     ///< rate at which the lines touch the curves [rad/s or m/s]
  int moves = 0;          ///< of the tangent in this stage
  bool is_fresh = false;  ///< a stage has begun, and has no tangent yet

  void begin(const AxisProperties&, const AxisStep&, const AxisStart& start) { start_stage(start.rate); }
  void release() { stored = rest = {}; }
  bool set(const AxisStage& stage) {
    release();
    const std::optional<Property>& property = Place::get(stage.p);
    const AxisStep& step = stage.step;
    const AxisStart& start = stage.start;
    if (step.in(Kick::kSecond)) return set_second_kick(property, stage);
    if (!property) return true;
    if (step.in(Kick::kSingle)) {
      const double damping = -step.h * property->rate_slope(start.theta, start.rate);
      later = std::max(step.vartheta, damping > 0 ? 1 - start.effective_mass / damping : 0.0);
    }
    find_tangent(*property, stage);
    return take(impulse_at(*property, step, start, tangent));
  }
  void finish_first_kick(const AxisProperties& p, const AxisStart& start, double w) {
    stored_given = stored.at(w);
    rest_given = rest.at(w);
    if (!Place::get(p)) return;
    implicit = rest.slope > start.effective_mass;
    start_stage(w);
  }
  void add_to(RowLaw& law, const AxisProperties&) const {
    for (int k = 0; k <= law.steps; ++k) law.level[k] += stored.level + rest.level;
    law.slope += stored.slope + rest.slope;
  }
  /// Newton's method; far from the solution by way of the axis by itself, pushed as it was, which is nearer
  /// than a tangent that is off by much.  No bounds of the solution are kept, as AxisSpringLaw does: others
  /// that move, too, take it out of them.
  bool move(const AxisProperties& p, const AxisStep& step, const AxisStart& start, double w,
            double rate_tolerance) {
    const std::optional<Property>& property = Place::get(p);
    if (!property || (step.in(Kick::kSecond) && !implicit)) return false;
    const double given = stored.at(w) + rest.at(w);
    const ImpulseLine there = line(*property, step, start, w);
    const double off = std::abs(there.level - given),
                 known = AxisSmoothTuning::kRoundOff * std::abs(given) / start.effective_mass;
    if (off <= std::max(tangent_tolerance(std::abs(given), rate_tolerance, start.effective_mass),
                        known * (start.effective_mass + there.slope)))
      return false;
    const bool is_far = std::abs(w - tangent) > AxisSmoothTuning::kFar * std::abs(w);
    const double next = is_far ? rate_alone(*property, step, start, w - given / start.effective_mass, w) : w;
    tangent = ++moves > AxisSmoothTuning::kNewtonMoves ? 0.5 * (tangent + next) : next;
    return true;
  }
  void split_lines(AxisImpulse& impulse, double& left, double w) const {
    const double by_store = stored.at(w), by_rest = rest.at(w);
    impulse.*Place::kPart += by_store;
    impulse.*loss_part<Property, Place>() += by_rest;
    left -= by_store + by_rest;
  }

 private:
  /// The impulse at w, as level, and what it falls by.
  ImpulseLine line(const Property& property, const AxisStep& step, const AxisStart& start, double w) const {
    const SmoothImpulse at = impulse_at(property, step, start, w);
    if (step.in(Kick::kSecond)) return {stored.level + at.rest, at.rest_slope};
    return {at.stored + at.rest, at.stored_slope + at.rest_slope};
  }
  /// A stage begins, which had the rate `w` without impulses.
  void start_stage(double w) {
    tangent = w;
    moves = 0;
    is_fresh = true;
  }
  /// The first tangent of a stage is that of the axis by itself.
  void find_tangent(const Property& property, const AxisStage& stage) {
    if (is_fresh) tangent = rate_alone(property, stage.step, stage.start, tangent, tangent);
    is_fresh = false;
  }
  /// The rate of an axis that had `free` without the property, by its own effective mass: Newton's method
  /// from w, between rates that are known to be below and above.
  double rate_alone(const Property& property, const AxisStep& step, const AxisStart& start, double free,
                    double w) const {
    double low = -kUnreachedRate, high = kUnreachedRate;
    if (!(start.effective_mass > 0) || std::isinf(start.effective_mass)) return w;
    for (int i = 0; i < AxisSmoothTuning::kMostAlone; ++i) {
      const ImpulseLine at = line(property, step, start, w);
      const double excess = start.effective_mass * (w - free) - at.level;
      const double next = w - excess / (start.effective_mass + at.slope);
      if (!std::isfinite(next)) break;
      (excess > 0 ? high : low) = w;
      const bool found = std::abs(next - w) <= AxisSmoothTuning::kAlone * std::abs(next);
      w = found || (next > low && next < high) ? next : 0.5 * (low + high);
      if (found) break;
    }
    return w;
  }

  SmoothImpulse impulse_at(const Property& property, const AxisStep& step, const AxisStart& start,
                           double w) const {
    switch (step.kick) {
      case Kick::kFirst:
        return smooth_impulse(property, stroke(step, start, w), w, 1);
      case Kick::kSecond:
        return smooth_impulse(property, {.time = 0.5 * step.h, .from = theta, .to = theta}, w, 1);
      default:
        return smooth_impulse(property, stroke(step, start, w), (1 - later) * start.rate + later * w, later);
    }
  }
  /// What was given in the first, but for damping that is implicit.
  bool set_second_kick(const std::optional<Property>& property, const AxisStage& stage) {
    theta = stage.theta;
    stored = {stored_given, 0};
    rest = {rest_given, 0};
    if (!property || !implicit) return true;
    find_tangent(*property, stage);
    return take_rest(impulse_at(*property, stage.step, stage.start, tangent));
  }
  bool take_rest(const SmoothImpulse& at) {
    if (!std::isfinite(at.rest) || !std::isfinite(at.rest_slope)) return release(), false;
    rest = {at.rest + at.rest_slope * tangent, at.rest_slope};
    return true;
  }
  bool take(const SmoothImpulse& at) {
    if (!take_rest(at) || !std::isfinite(at.stored) || !std::isfinite(at.stored_slope))
      return release(), false;
    stored = {at.stored + at.stored_slope * tangent, at.stored_slope};
    return true;
  }
};

}  // namespace taut
