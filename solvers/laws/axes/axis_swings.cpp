#include "solvers/laws/axes/axis_swings.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/world/swing_properties.h"

namespace taut {
namespace {

/// Chosen, where nothing else is said.  (solvers/laws, "Axes")
struct SwingTuning {
  /// Swings below have no direction [rad].
  static constexpr double kStraight = 1e-6;
  /// Swings above may come to π, where they have no components [rad].
  static constexpr double kFolded = 2.5;
  /// Steps, at the rate of now, in which a swing may pass 0 or π.  Half: twice the sub-steps of swings
  /// with friction.
  static constexpr double kSwingStepsAhead = 2;
  /// Directions of friction are right when a solve turns them by no more than this [rad], or after so many.
  static constexpr double kTurned = 1e-9;
  static constexpr int kMostTurns = 25;
  /// Part of its bound by which friction that holds may be outside its disc: what laws are met to.
  static constexpr double kDisc = 1e-9;
};

/// Two axes of the joint of axis i in the table, by their places in the joint; −1 for one that has no row.
/// The rows of a joint are neighbours.
std::array<int, 2> find_beside(const AxisTable& table, std::size_t i, const std::array<int, 2>& places) {
  const std::optional<JointId> joint = table.rows()[i].joint();
  std::array<int, 2> found{-1, -1};
  while (i > 0 && table.rows()[i - 1].joint() == joint) --i;
  for (; i < table.size() && table.rows()[i].joint() == joint; ++i)
    for (int k : {0, 1})
      if (table.axis(i) && table.axis(i)->axis == places[k]) found[k] = static_cast<int>(i);
  return found;
}

}  // namespace

void AxisSwings::find(AxisTable& table) {
  frictions_.clear();
  springs_.clear();
  for (std::size_t i = 0; i < table.size(); ++i) {
    const AxisId* id = table.axis(i);
    if (!id) continue;
    const std::optional<SwingProperties> properties = swing_properties(table.world(), id->joint);
    if (!properties || properties->swing != id->axis) continue;
    const int axis = static_cast<int>(i);
    if (properties->has_friction)
      frictions_.push_back({.axis = axis, .turn = find_beside(table, i, properties->across.turns)});
    if (!properties->has_spring) continue;
    springs_.push_back({axis, find_beside(table, i, properties->across.components)});
    for (int k : {axis, springs_.back().component[0], springs_.back().component[1]}) table.make_own(k);
  }
}

void AxisSwings::begin(AxisTable& table, std::span<AxisLaw> axes, double h) {
  for (const Spring& swing : springs_) begin(swing, table, axes, h);
  for (Friction& swing : frictions_) begin(swing, table, axes, h);
}

/// The spring of a swing acts along its components; where the joint is nearly folded, since these jump at π,
/// along itself.
void AxisSwings::begin(const Spring& swing, AxisTable& table, std::span<const AxisLaw> axes, double h) {
  const auto given = [&](int k) -> const auto& { return table.given(k).spring; };
  const AxisStart& start = axes[swing.axis].start;
  const bool folded =
      start.theta + SwingTuning::kSwingStepsAhead * std::abs(h * start.rate) > SwingTuning::kFolded;
  table.own(swing.axis).spring = folded ? given(swing.axis) : std::nullopt;
  for (int k : swing.component)
    table.own(k).spring = folded ? given(k) : with_spring_of_swing(given(k), *given(swing.axis));
}

/// Two rows bear the friction: all of it for each of them until it is known to be too much together.
void AxisSwings::begin(Friction& swing, AxisTable& table, std::span<AxisLaw> axes, double h) {
  AxisLaw &axis = axes[swing.axis], &x = axes[swing.turn[0]], &y = axes[swing.turn[1]];
  swing.straight = axis.start.theta <=
                   SwingTuning::kStraight + SwingTuning::kSwingStepsAhead * std::abs(h * axis.start.rate);
  swing.solves = 0;
  const double rate = std::hypot(x.start.rate, y.start.rate);
  const bool held = x.friction.stuck && y.friction.stuck;
  for (int t : {0, 1})
    swing.part[t] = held || rate == 0 ? 1 : std::abs(axes[swing.turn[t]].start.rate) / rate;
  if (swing.straight) {
    axis.friction.stuck = false;
    x.friction.stuck = y.friction.stuck = held;
  } else {
    for (int t : swing.turn)
      if (!table.given(t).friction) axes[t].friction.stuck = false;
  }
  split_friction(swing, table);
}

/// Properties of the three axes at these parts.
void AxisSwings::split_friction(const Friction& swing, AxisTable& table) {
  const AxisFriction friction = *table.given(swing.axis).friction;
  const std::optional<AxisSpring> spring = table.properties(swing.axis).spring;  // if it acts there
  for (int k : {swing.axis, swing.turn[0], swing.turn[1]}) table.make_own(k);
  table.own(swing.axis).spring = spring;
  if (!swing.straight) return;
  table.own(swing.axis).friction.reset();
  for (int t : {0, 1}) {
    std::optional<AxisFriction>& own = table.own(swing.turn[t]).friction;
    if (!own) own.emplace();
    own->static_friction += swing.part[t] * friction.static_friction;
    own->dynamic_friction += swing.part[t] * friction.dynamic_friction;
    own->per_load += swing.part[t] * friction.per_load;
    own->viscous += friction.viscous;
  }
}

bool AxisSwings::turn(AxisTable& table, std::span<AxisLaw> axes, std::span<const double> lambda,
                      std::span<const double> w) {
  bool any = false;
  for (Friction& swing : frictions_) {
    if (!swing.straight || table.released(swing.axis) || swing.solves >= SwingTuning::kMostTurns) continue;
    std::array<double, 2> force, rate;
    for (int t : {0, 1}) {
      const int axis = swing.turn[t], row = table.row(axis);
      rate[t] = w[row];
      const double on_law = axes[axis].rate_of(table.properties(axis), lambda[row], rate[t]);
      force[t] = axes[axis].split(lambda[row], on_law).friction;
    }
    if (!turn(swing, axes, force, rate)) continue;
    split_friction(swing, table);
    any = true;
  }
  return any;
}

/// Together both turns are a disc: what slips is against the rate, by as much as one of them alone.
bool AxisSwings::turn(Friction& swing, std::span<AxisLaw> axes, const std::array<double, 2>& force,
                      const std::array<double, 2>& rate) {
  std::array<double, 2> slip;
  double most = 0;
  for (int t : {0, 1}) {
    const AxisFrictionLaw& friction = axes[swing.turn[t]].friction;
    slip[t] = on_step(rate[t], friction.at) ? 0 : std::abs(rate[t] - friction.at);
    if (swing.part[t] > 0) most = std::max(most, friction.bound / swing.part[t]);
  }
  std::array<double, 2> direction{std::abs(force[0]), std::abs(force[1])};
  const double size = std::hypot(direction[0], direction[1]), speed = std::hypot(slip[0], slip[1]);
  if (swing.part[0] == 1 && swing.part[1] == 1) {
    if (size <= (1 + SwingTuning::kDisc) * most) return false;  // it holds, or slips along x or y
  } else {
    if (speed == 0) return false;  // it holds by what it has
    for (int t : {0, 1}) direction[t] = swing.part[t] + slip[t] / speed;
  }
  const double length = std::hypot(direction[0], direction[1]);
  double moved = 0;
  for (int t : {0, 1}) {
    moved = std::max(moved, std::abs(direction[t] / length - swing.part[t]));
    swing.part[t] = direction[t] / length;
    axes[swing.turn[t]].friction.mark_slipping();
  }
  if (moved <= SwingTuning::kTurned) return false;
  ++swing.solves;
  return true;
}

}  // namespace taut
