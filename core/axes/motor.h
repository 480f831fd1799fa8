#pragma once

#include <optional>

#include "core/axes/axis_field.h"
#include "core/axes/curve.h"
#include "core/math/motion_point.h"

namespace taut {

/// Drives the axis with at most the available force.
///
/// Without gains it keeps what it is told exactly, as far as its force reaches.  To a position or trajectory
/// it goes no faster than it can stop from with that force: it brakes in time and stays.
/// With gains it is a servo, force = stiffness (target − θ) + damping (its rate − θ̇), taken implicitly, so
/// that it is stable with any gains at any step; a position has the rate 0, a velocity no stiffness.
/// A motor that only pulls is the winch of a rope: θ is no longer than the rope that has been let out, which
/// is as long as the rope at first and changes by the motor; a slack rope stays slack.
struct AxisMotor {
  enum class Mode {  ///< What the motor keeps.
    kVelocity,       ///< θ̇ = target
    kPosition,       ///< θ = target
    kTrajectory,     ///< θ = trajectory(t)
  };
  Mode mode = Mode::kVelocity;    ///< what it keeps
  double target = 0;              ///< θ̇ [rad/s or m/s], or θ [rad or m] with its turns
  double max_force = kUnlimited;  ///< [N·m or N]
  double max_speed = kUnlimited;  ///< position and trajectory: how fast it goes to its target [rad/s or m/s]
  /// |θ̇| → available force, held beyond its ends; the smaller of it and max_force counts.
  std::optional<Curve> force_of_speed{};
  Motion trajectory{};      ///< θ over time, in that mode
  double stiffness = 0;     ///< k [N·m/rad or N/m], of a position or trajectory
  double damping = 0;       ///< [N·m·s/rad or N·s/m]; without either the target is kept exactly
  bool pulls_only = false;  ///< a winch, of the length of a rope

  bool has_gains() const { return stiffness > 0 || damping > 0; }  ///< it is a servo
  /// A winch that winds a rope with this rate [m/s], < 0 shortens it, and at most this force [N].
  static AxisMotor winch(double rate, double max_force = kUnlimited) {
    return {.target = rate, .max_force = max_force, .pulls_only = true};
  }

  /// What the property says of itself.
  static constexpr AxisFacts kFacts{
      .key = "motor",
      .phrase = "a motor",
      .text =
          "Drives an axis with at most the available force [N·m or N]: a velocity keeps θ̇ = target, a "
          "position θ "
          "= target, a trajectory θ = trajectory(t).  `max_speed` is how fast the latter two go to their "
          "target; `force_of_speed` is |θ̇| → available force.  With `stiffness` or `damping` it is a servo, "
          "taken implicitly; with `pulls_only` a winch on the length of a rope.  To a position or along a "
          "trajectory it brakes in time.",
      .jumps = 1};  // at its rate
  /// use(field, …) with its members, but mode and trajectory; target is there in scene files by the name of
  /// the mode.
  template <typename Use>
  static constexpr auto fields(Use use) {
    return use(
        axis_field(nullptr, &AxisMotor::target, AxisRange::kFinite,
                   {.text = "θ̇ [rad/s or m/s], or θ [rad or m] with its turns",
                    .label = "motor target",
                    .name = "target"}),
        axis_field("max_force", &AxisMotor::max_force, AxisRange::kBound, {.text = "[N·m or N]"}),
        axis_field("max_speed", &AxisMotor::max_speed, AxisRange::kSpeed,
                   {.text = "of a position or trajectory [rad/s or m/s]", .angular = true}),
        axis_field("force_of_speed", &AxisMotor::force_of_speed,
                   {.text = "|θ̇| → available force, held beyond its ends", .angular = true}),
        axis_field("stiffness", &AxisMotor::stiffness, AxisRange::kNotNegative,
                   {.text = "of a servo to a position or along a trajectory [N·m/rad or N/m]"}),
        axis_field("damping", &AxisMotor::damping, AxisRange::kNotNegative,
                   {.text = "of a servo [N·m·s/rad or N·s/m]"}),
        axis_field("pulls_only", &AxisMotor::pulls_only, {.text = "a winch, of the length of a rope"}));
  }
  /// Refuses a trajectory that is missing, a largest speed beside a velocity or gains, a stiffness beside a
  /// velocity, gains where it only pulls, and a force curve with negative force or speed.
  void check(std::string_view axis) const;

  /// What needs an axis that has positions, for messages; null: nothing.
  const char* needs_position() const { return mode == Mode::kVelocity ? nullptr : "position motor"; }
  /// It would move an axis that rests if it could, so that its bodies do not sleep.
  bool keeps_going() const { return mode == Mode::kTrajectory || (mode == Mode::kVelocity && target != 0); }
};

/// Where what is said of a part of an axis, such as its force, has that of the motor.
template <typename Value>
struct AxisMember<AxisMotor, Value> {
  Value motor{};                                       ///< of the motor
  static constexpr auto kMember = &AxisMember::motor;  ///< the place
};

}  // namespace taut
