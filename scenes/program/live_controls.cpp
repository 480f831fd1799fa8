#include "scenes/program/live_controls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <tuple>

#include "core/base/check.h"
#include "core/math/dense.h"
#include "scenes/recording/recorder.h"
#include "solvers/laws/axes/axis_motor_law.h"

namespace taut {
namespace {

using Json = nlohmann::json;

constexpr double kPullFrequency = 4 * std::numbers::pi;  // ω of a pull [rad/s]: two swings a second
constexpr double kPullDamping = 0.7;                     // ζ
constexpr double kMostPull = 1000;                       // factor of the stiffness that may be asked for
constexpr double kPullSteps = 0.25;  // ω h at most: the pull is explicit, and must stay stable
constexpr double kFarAway = 1e9;     // [m] that a cursor may be from the origin
constexpr double kMostTarget = 1e9;  // [rad/s, m/s, rad or m]
constexpr double kSliderTime =
    1;  // [s] in which a motor without any bound goes from end to end of its slider
constexpr double kArrived = 1e-6;      // [rad or m] from its trajectory, such a motor is on it again
constexpr int kMostAskedSteps = 1000;  // single steps that may wait

/// A finite number, or what is wrong with it.
double number_of(const Json& message, const char* key, double most) {
  const double value = message.at(key).get<double>();
  if (!std::isfinite(value) || std::abs(value) > most) fail(key, "is out of range", value);
  return value;
}

Vec3 point_of(const Json& message, const char* key) {
  const auto values = message.at(key).get<std::array<double, 3>>();
  const Vec3 point(values[0], values[1], values[2]);
  if (!point.allFinite() || point.norm() > kFarAway) fail(key, "is out of range", point.norm());
  return point;
}

int index_of(const Json& message, const char* key, int count) {
  const auto& value = message.at(key);
  if (!value.is_number_integer()) fail(key, "must be a whole number", value.dump());
  const auto index = value.get<std::int64_t>();
  if (index < 0 || index >= count) fail(key, "is not there", index);
  return static_cast<int>(index);
}

/// The largest inverse mass of a point at r from the centre of mass: of 1/m + [r]ᵀ I⁻¹ [r].
double most_inverse_mass(const World& world, BodyId body, const Vec3& p_BP) {
  const MassProperties& mass = world.mass_properties(body);
  const Mat3 R = skew(p_BP);
  const Mat3 inverse = Mat3::Identity() / mass.mass() + R.transpose() * mass.inertia_B().inverse() * R;
  return dense::symmetric_eigenvalues3(inverse).maxCoeff();
}

LivePull pull_of(const Json& message, const World& world) {
  const BodyId body{index_of(message, "body", world.body_count())};
  if (world.is_fixed(body)) fail("body", "is fixed", world.name(body));
  const double strength = number_of(message, "strength", kMostPull);
  if (!(strength > 0)) fail("strength", "must be positive", strength);
  return {body, point_of(message, "point"), point_of(message, "to"), strength};
}

/// Between which targets a slider of a motor goes.
std::pair<double, double> slider_range(const AxisMotor& motor, const AxisProperties& properties,
                                       const AxisInfo& info, double start) {
  const double width = properties.limits ? properties.limits->upper - properties.limits->lower : 0;
  if (motor.mode != AxisMotor::Mode::kVelocity && width > 0 && std::isfinite(width))
    return {properties.limits->lower, properties.limits->upper};
  const double reach = std::max(2 * std::abs(start), info.angular ? std::numbers::pi : 1.0);
  return {-reach, reach};
}

bool follows(const AxisMotor& motor) { return motor.mode == AxisMotor::Mode::kTrajectory; }

}  // namespace

Vec3 pull_force(const World& world, const LivePull& pull, double h) {
  const Pose& X_WB = world.pose(pull.body);
  const Twist& V_WB = world.twist(pull.body);
  const double m = 1 / most_inverse_mass(world, pull.body, pull.p_BP);
  const double w = std::min(kPullFrequency * std::sqrt(pull.strength), kPullSteps / h);
  const Vec3 p_WP = X_WB.point(pull.p_BP);
  return m * w * w * (pull.p_WC - p_WP) - 2 * kPullDamping * m * w * V_WB.at(p_WP - X_WB.p);
}

LiveControls::LiveControls(World& world, Simulator& simulator, bool may_reset)
    : world_(world), simulator_(simulator), may_reset_(may_reset), start_(simulator.checkpoint()) {
  for (int j = 0; j < world.joint_count(); ++j)
    for (int k = 0; k < world.axis_count({j}); ++k) {
      const AxisId axis{{j}, k};
      const AxisProperties& properties = world.axis_properties(axis);
      if (!properties.motor) continue;
      motors_.push_back({axis, *properties.motor, 0, 0});
      Motor& it = motors_.back();
      std::tie(it.low, it.high) = slider_range(it.start, properties, world.axis_info(axis), target(it));
    }
}

/// Of a motor that follows its trajectory: where that is.
double LiveControls::target(const Motor& it) const {
  const AxisMotor& now = motor(it);
  return follows(now) ? now.trajectory(world_.time()).value : now.target;
}

Json LiveControls::motors() const {
  Json all = Json::array();
  for (const Motor& it : motors_)
    all.push_back(
        {{"name", world_.axis_label(it.axis)},
         {"unit", axis_unit(world_.axis_info(it.axis), it.start.mode == AxisMotor::Mode::kVelocity)},
         {"low", it.low},
         {"high", it.high},
         {"has_trajectory", follows(it.start)}});
  return all;
}

Json LiveControls::state() const {
  Json targets = Json::array(), following = Json::array();
  for (const Motor& it : motors_) {
    targets.push_back(target(it));
    following.push_back(follows(motor(it)));
  }
  return {{"paused", paused_}, {"steps", steps_},    {"resets", resets_},
          {"speed", speed_},   {"targets", targets}, {"follows", following}};
}

void LiveControls::begin_step(double h) {
  if (paused_) --asked_steps_;
  arrive();
  for (const auto& [browser, pull] : pulls_)
    simulator_.apply_force(pull.body, pull.p_BP, pull_force(world_, pull, h));
}

void LiveControls::obey(int browser, const std::string& text) {
  const Json message = Json::parse(text);
  const std::string what = message.at("do").get<std::string>();
  const auto motor_of = [&]() -> Motor& {
    return motors_[index_of(message, "motor", static_cast<int>(motors_.size()))];
  };
  if (what == "pause" || what == "play") {
    set_paused(what == "pause");
  } else if (what == "step") {
    if (!paused_) set_paused(true);
    asked_steps_ = std::min(asked_steps_ + 1, kMostAskedSteps);
  } else if (what == "reset") {
    reset();
  } else if (what == "speed") {
    set_speed(number_of(message, "value", 1000));
  } else if (what == "motor") {
    Motor& it = motor_of();
    set_target(it, number_of(message, "target", kMostTarget));
  } else if (what == "follow") {
    follow(motor_of());
  } else if (what == "pull") {
    pulls_[browser] = pull_of(message, world_);
  } else if (what == "release") {
    pulls_.erase(browser);
  } else {
    fail("do", "is not known", what);
  }
}

void LiveControls::set_paused(bool paused) {
  paused_ = paused, asked_steps_ = 0;
  news_ = {true, true};
}

void LiveControls::set_speed(double speed) {
  if (!(speed >= 1e-3)) fail("value", "must be from 0.001 to 1000", speed);
  speed_ = speed;
  news_ = {true, true};
}

/// A motor that follows a trajectory leaves it.
void LiveControls::set_target(Motor& it, double target) {
  AxisMotor now = motor(it);
  if (follows(now)) now.mode = AxisMotor::Mode::kPosition;
  if (now.mode == AxisMotor::Mode::kPosition && is_unbounded(it.start) && std::isinf(it.start.max_speed))
    now.max_speed = (it.high - it.low) / kSliderTime;
  now.target = target;
  world_.set_motor(it.axis, std::move(now));
  it.returning = false;
  news_.state = true;
}

void LiveControls::follow(Motor& it) {
  if (!follows(it.start)) fail("follow", "the motor has no trajectory", world_.axis_label(it.axis));
  if (follows(motor(it))) return;
  AxisMotor now = it.start;
  now.max_speed = motor(it).max_speed;
  world_.set_motor(it.axis, std::move(now));
  it.returning = true;
  news_.state = true;
}

/// Motors that are on their trajectories again are what they were.
void LiveControls::arrive() {
  for (Motor& it : motors_) {
    if (!it.returning || std::abs(world_.axis_value(it.axis) - target(it)) > kArrived) continue;
    world_.set_motor(it.axis, it.start);
    it.returning = false;
  }
}

void LiveControls::reset() {
  if (!may_reset_) fail("reset", "is not possible while the run writes files", "reset");
  for (Motor& it : motors_) {
    world_.set_motor(it.axis, it.start);
    it.returning = false;
  }
  simulator_.restore(start_);
  pulls_.clear();
  steps_ = 0, ++resets_;
  news_ = {true, true};
}

}  // namespace taut
