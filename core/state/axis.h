#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/state/motion_point.h"

/// What can act along a free axis of a joint.  An axis is a scalar coordinate θ(q) [rad or m] with rate θ̇;
/// forces along it are torques [N·m] about an angle and forces [N] along a displacement.  A positive one acts
/// on body B towards larger θ, and the opposite on A.
///
/// A property says by `kJumps` at how many rates its force jumps, and by members whose names are those below
/// what else concerns others than its law; AxisProperties asks those that have them.  (core/state, "A new
/// axis property")
namespace taut {

inline constexpr double kUnlimited = std::numeric_limits<double>::infinity();  ///< no limit

/// A function given by points, linear between them.
class Curve {
 public:
  struct Point {          ///< One point of the function.
    double x = 0, y = 0;  ///< argument, or value
  };
  /// @throws std::invalid_argument if there is no point, one is not finite, or x does not increase strictly.
  explicit Curve(std::vector<Point> points);

  /// Value at x, held constant beyond the ends.
  double held(double x) const;
  /// Value at x, where the first and last piece go on beyond the ends; a single point is a constant.
  double extended(double x) const;
  /// dy/dx of the piece that extended() uses at x; the right one at a point.
  double slope(double x) const;
  /// ∫ extended(x) dx.
  double integral(double from, double to) const;
  /// Mean of extended() over an interval, and its derivative by the upper end.
  struct Mean {
    double value = 0, slope = 0;  ///< mean, or ∂mean/∂to
  };
  Mean mean(double from, double to) const;                      ///< of extended() between both
  const std::vector<Point>& points() const { return points_; }  ///< as given

 private:
  std::size_t piece(double x) const;
  std::vector<Point> points_;
};

/// lower ≤ θ ≤ upper, angles with their turns: an upper limit of 10π is five turns.  An impact at a limit
/// reverses the rate by the factor of restitution, θ̇⁺ = −e θ̇⁻.
/// With a compliance the limit is a spring of stiffness 1/compliance and a damper that act beyond it.
struct AxisLimits {
  double lower = -kUnlimited, upper = kUnlimited;  ///< [rad or m]
  double restitution = 0;                          ///< e, from 0 to 1
  double compliance = 0;                           ///< [rad/(N·m) or m/N]; then the restitution must be 0
  double damping = 0;                              ///< [N·m·s/rad or N·s/m], with a compliance

  static constexpr int kJumps = 2;  ///< at both limits
  /// What needs an axis that has positions, for messages; null: nothing.
  const char* needs_position() const { return "limits"; }
  bool stores_energy() const { return compliance > 0; }  ///< it is a spring
  double energy(double theta) const;                     ///< limit_energy()
  /// How a start at θ violates it by more than the tolerance, for messages; empty if it does not.
  std::string start_problem(double theta, double tolerance) const;
};

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

  static constexpr int kJumps = 1;  ///< at its rate
  /// What needs an axis that has positions, for messages; null: nothing.
  const char* needs_position() const { return mode == Mode::kVelocity ? nullptr : "position motor"; }
  /// It would move an axis that rests if it could, so that its bodies do not sleep.
  bool keeps_going() const { return mode == Mode::kTrajectory || (mode == Mode::kVelocity && target != 0); }
};

/// Coulomb and viscous friction: sticks up to `static_friction`, then slides with `dynamic_friction`;
/// −`viscous` θ̇ besides.
struct AxisFriction {
  double static_friction = 0;   ///< [N·m or N]
  double dynamic_friction = 0;  ///< [N·m or N], at most static_friction
  double viscous = 0;           ///< [N·m·s/rad or N·s/m]
  /// Static and dynamic friction also grow by this times the force [N] that the joint's translation rows
  /// carry: μ r [m] for a pin of radius r, μ for a slider.
  double per_load = 0;

  static constexpr int kJumps = 1;  ///< at rest
};

/// Spring and damper: force −k (θ − rest) − c θ̇, each of them by a table if it has one:
/// −table(θ − rest) − damping_table(θ̇).
struct AxisSpring {
  double stiffness = 0;  ///< k [N·m/rad or N/m]; 0 with a table
  double damping = 0;    ///< c [N·m·s/rad or N·s/m]; 0 with a damping table
  double rest = 0;       ///< [rad or m]
  /// θ − rest → restoring force, extended beyond its ends.
  std::optional<Curve> table{};
  /// θ̇ → force against it, extended beyond its ends.
  std::optional<Curve> damping_table{};

  static constexpr int kJumps = 0;  ///< none
  /// What needs an axis that has positions, for messages; null: nothing.
  const char* needs_position() const { return "spring"; }
  bool stores_energy() const { return true; }  ///< also where its stiffness is 0
  double energy(double theta) const;           ///< spring_energy()
};

/// All that acts along one axis.
struct AxisProperties {
  std::optional<AxisSpring> spring;      ///< none if not set
  std::optional<AxisFriction> friction;  ///< none if not set
  std::optional<AxisMotor> motor;        ///< none if not set
  std::optional<AxisLimits> limits;      ///< none if not set

  /// use(property, …) with all of them, set or not, in the order in which their laws are added.
  template <typename Self, typename Use>
  static auto with_all(Self& self, Use use) {
    return use(self.spring, self.friction, self.motor, self.limits);
  }
  /// visit(property) for each that is set.
  template <typename Visit>
  void each(Visit visit) const {
    with_all(*this, [&](const auto&... all) { ((all ? visit(*all) : void()), ...); });
  }
  /// Sets the property of this type, or takes it away.
  template <typename Property>
  void set(std::optional<Property> value) {
    const auto assign = [&](auto& mine) {
      if constexpr (std::is_same_v<decltype(mine), std::optional<Property>&>) mine = std::move(value);
    };
    with_all(*this, [&](auto&... all) {
      static_assert((std::is_same_v<decltype(all), std::optional<Property>&> || ...), "no axis property");
      (assign(all), ...);
    });
  }

  bool any() const;                                     ///< something is set
  bool stores_energy() const;                           ///< something stores it
  void add_energy(double theta, double& energy) const;  ///< adds what is stored at θ [J], one by one
  bool keeps_going() const;  ///< something would move an axis that rests if it could
};

namespace detail {
struct CountJumps {  // at how many rates the forces of properties jump
  template <typename... Properties>
  std::integral_constant<int, (Properties::kJumps + ...)> operator()(
      const std::optional<Properties>&...) const {
    return {};
  }
};
}  // namespace detail
/// At how many rates the force along an axis with all properties jumps.
inline constexpr int kMostAxisJumps =
    decltype(AxisProperties::with_all(std::declval<const AxisProperties&>(), detail::CountJumps{}))::value;

/// Force of the spring along the axis at θ [N·m or N]: −k (θ − rest), or −table(θ − rest).
double spring_force(const AxisSpring& spring, double theta);
double damping_force(const AxisSpring& spring, double rate);  ///< the damper's at θ̇ [N·m or N]
/// Potential energy of the spring at θ [J]: ½ k (θ − rest)², or the integral of its table from rest.
double spring_energy(const AxisSpring& spring, double theta);
/// How far θ is beyond limits [rad or m]: positive above the upper, negative below the lower one.
double beyond(const AxisLimits& limits, double theta);
/// Potential energy of a limit with compliance [J]: ½ beyond()²/compliance; 0 for a rigid one.
double limit_energy(const AxisLimits& limits, double theta);

/// @throws std::invalid_argument naming `axis`, what is wrong and the value: limits that are crossed or not
/// numbers, a restitution outside [0, 1] or beside a compliance, damping without compliance, a target that is
/// not finite, a trajectory that is missing, a largest speed beside a velocity, a force, speed, stiffness or
/// friction that is negative, a largest speed beside gains, a stiffness beside a velocity, gains of a motor
/// that only pulls, dynamic above static friction, a force curve with negative force or speed, a
/// spring with both stiffness and table, a damper with both damping and table, or with a table that falls
/// somewhere or does not go through 0.  @{
void check_axis(std::string_view axis, const AxisLimits& limits);
void check_axis(std::string_view axis, const AxisMotor& motor);
void check_axis(std::string_view axis, const AxisFriction& friction);
void check_axis(std::string_view axis, const AxisSpring& spring);  /// @}

}  // namespace taut
