#include <algorithm>
#include <cmath>

#include "core/world/swing_properties.h"
#include "solvers/laws/axis_forces.h"

// Friction and springs of the swing of ball and universal joints, which has no direction at 0.
// (solvers/laws, "Axes")
//
// Where θ₀ ≤ 1e-6 + 2 h |θ̇₀|, friction of the swing acts on the turns about two axes across it: all of it
// on each of them, until that is more than the disc |(λ_x, λ_y)| ≤ h/2 τ allows; then each has its component
// of the direction of slip, which moves halfway towards the new one in each solve of the stage.  A spring
// −k θ j whose rest is 0 is −k s for the swing as a rotation vector s, which is smooth at 0: it acts along
// both components of s, with the damper −c ṡ, which also resists a bend that goes round, as
// inside a bent shaft that turns.  At π the components change their sign, so near it the spring acts along
// the swing itself.  A rest other than 0 is a cone, where passing straight is a kink of the potential itself.
namespace taut {
namespace {

/// Swings that have no direction [rad].
constexpr double kStraight = 1e-6;
/// Swings that may come to π, where they have no components [rad].
constexpr double kFolded = 2.5;
/// Steps in which a swing may pass 0 or π.
constexpr double kSwingStepsAhead = 2;
/// Directions of friction are right to this part, after as many solves.
constexpr double kTurned = 1e-9;
constexpr int kMostTurns = 25;
/// Friction that holds is within its disc to this part.
constexpr double kDisc = 1e-9;

}  // namespace

/// The rows of a joint are neighbours.
void AxisForces::find_swings() {
  swings_.clear();
  bends_.clear();
  for (std::size_t i = 0; i < rows_.size(); ++i) from_own_[i] = rows_[i].axis.axis < 0;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const AxisId axis = rows_[i].axis;
    if (axis.axis < 0 || axis.joint.index < 0) continue;
    const std::optional<SwingProperties> properties = swing_properties(world_, axis.joint);
    if (!properties || properties->swing != axis.axis) continue;
    own_.resize(rows_.size());
    Swing swing{.axis = static_cast<int>(i)};
    SwingSpring relinearize_tables{.axis = static_cast<int>(i)};
    std::size_t first = i;
    while (first > 0 && rows_[first - 1].axis.joint == axis.joint) --first;
    for (std::size_t k = first; k < rows_.size() && rows_[k].axis.joint == axis.joint; ++k)
      for (int t : {0, 1}) {
        if (rows_[k].axis.axis == properties->across.turns[t]) swing.turn[t] = static_cast<int>(k);
        if (rows_[k].axis.axis == properties->across.components[t])
          relinearize_tables.component[t] = static_cast<int>(k);
      }
    if (properties->rubs) swings_.push_back(swing);
    if (!properties->bends) continue;
    bends_.push_back(relinearize_tables);
    for (int r :
         {relinearize_tables.axis, relinearize_tables.component[0], relinearize_tables.component[1]}) {
      own_[r] = world_.axis_properties(rows_[r].axis);
      from_own_[r] = 1;
    }
  }
}

/// The spring of a swing acts along its components; where the joint is nearly folded, since these jump at π,
/// along itself.
void AxisForces::begin_bends() {
  for (const SwingSpring& relinearize_tables : bends_) {
    const auto given = [&](int row) -> const auto& { return world_.axis_properties(rows_[row].axis).spring; };
    const Axis& swing = axes_[relinearize_tables.axis];
    const bool folded = swing.theta0 + kSwingStepsAhead * std::abs(h_ * swing.rate0) > kFolded;
    own_[relinearize_tables.axis].spring = folded ? given(relinearize_tables.axis) : std::nullopt;
    for (int c : relinearize_tables.component)
      own_[c].spring = folded ? given(c) : with_spring_of_swing(given(c), *given(relinearize_tables.axis));
  }
}

/// Two rows share the friction: all of it for each of them until it is known to be too much together.
void AxisForces::begin_swings() {
  for (Swing& swing : swings_) {
    Axis &axis = axes_[swing.axis], &x = axes_[swing.turn[0]], &y = axes_[swing.turn[1]];
    swing.straight = axis.theta0 <= kStraight + kSwingStepsAhead * std::abs(h_ * axis.rate0);
    swing.solves = 0;
    const double rate = std::hypot(x.rate0, y.rate0);
    const bool held = x.stuck && y.stuck;
    for (int t : {0, 1}) swing.share[t] = held || rate == 0 ? 1 : std::abs(axes_[swing.turn[t]].rate0) / rate;
    if (swing.straight) {
      axis.stuck = false;
      x.stuck = y.stuck = held;
    } else {
      for (int t : {0, 1})
        if (!world_.axis_properties(rows_[swing.turn[t]].axis).friction) axes_[swing.turn[t]].stuck = false;
    }
    share_friction(swing);
  }
}

/// Properties of the three rows at these shares.
void AxisForces::share_friction(const Swing& swing) {
  const AxisFriction friction = *world_.axis_properties(rows_[swing.axis].axis).friction;
  const std::optional<AxisSpring> spring = properties(swing.axis).spring;  // if it acts there
  for (int i : {swing.axis, swing.turn[0], swing.turn[1]}) {
    own_[i] = world_.axis_properties(rows_[i].axis);
    from_own_[i] = 1;
  }
  own_[swing.axis].spring = spring;
  if (!swing.straight) return;
  own_[swing.axis].friction.reset();
  for (int t : {0, 1}) {
    std::optional<AxisFriction>& own = own_[swing.turn[t]].friction;
    if (!own) own.emplace();
    own->static_friction += swing.share[t] * friction.static_friction;
    own->dynamic_friction += swing.share[t] * friction.dynamic_friction;
    own->per_load += swing.share[t] * friction.per_load;
    own->viscous += friction.viscous;
  }
}

/// Together they are a disc: what slips is against the rate, by as much as one of them alone.
bool AxisForces::turn_swings(std::span<const double> lambda, std::span<const double> w) {
  bool any = false;
  for (Swing& swing : swings_) {
    if (!swing.straight || released_[swing.axis] || swing.solves >= kMostTurns) continue;
    double force[2], rate[2], slip[2], most = 0;
    for (int t : {0, 1}) {
      const int i = swing.turn[t], row = rows_[i].row;
      rate[t] = w[row];
      force[t] = share(i, lambda[row], rate[t]).friction;
      slip[t] = on_step(rate[t], axes_[i].friction_at) ? 0 : std::abs(rate[t] - axes_[i].friction_at);
      if (swing.share[t] > 0) most = std::max(most, axes_[i].friction_force / swing.share[t]);
    }
    double u[2] = {std::abs(force[0]), std::abs(force[1])};
    const bool whole = swing.share[0] == 1 && swing.share[1] == 1;
    const double size = std::hypot(u[0], u[1]), speed = std::hypot(slip[0], slip[1]);
    if (whole && size <= (1 + kDisc) * most) continue;  // it holds, or slips along x or y
    if (!whole && speed == 0) continue;                 // it holds by what it has
    if (!whole)
      for (int t : {0, 1}) u[t] = swing.share[t] + slip[t] / speed;
    const double length = std::hypot(u[0], u[1]);
    double moved = 0;
    for (int t : {0, 1}) {
      moved = std::max(moved, std::abs(u[t] / length - swing.share[t]));
      swing.share[t] = u[t] / length;
      axes_[swing.turn[t]].broken = axes_[swing.turn[t]].stuck;
    }
    if (moved <= kTurned) continue;
    ++swing.solves;
    share_friction(swing);
    any = true;
  }
  return any;
}

}  // namespace taut
