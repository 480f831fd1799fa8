#include "scenes/program/live_run.h"

#include <charconv>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "core/base/check.h"
#include "core/math/dense.h"
#include "scenes/export/page_data.h"
#include "scenes/program/interrupt.h"
#include "scenes/support/format.h"
#include "scenes/support/printable.h"

namespace taut {
namespace {

using Json = nlohmann::json;

constexpr double kShownPerSecond = 60;  // frames that browsers get
constexpr double kLookAround = 0.05;    // [s] between two looks for signals while nothing happens
constexpr double kLate = 0.1;           // [s] behind the clock; then the run no longer tries to catch up
constexpr int kMostNotes = 20;          // of ignored messages on the standard error
constexpr double kPullFrequency = 4 * std::numbers::pi;  // ω of a pull [rad/s]: two swings a second
constexpr double kPullDamping = 0.7;                     // ζ
constexpr double kMostPull = 1000;                       // factor of the stiffness that may be asked for
constexpr double kPullSteps = 0.25;  // ω h at most: the pull is explicit, and must stay stable
constexpr double kFarAway = 1e9;     // [m] that a cursor may be from the origin

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

/// Between which targets a slider of a motor goes.
std::pair<double, double> motor_range(const AxisProperties& properties, const AxisInfo& info, double start) {
  const AxisMotor& motor = *properties.motor;
  if (motor.mode == AxisMotor::Mode::kPosition && properties.limits &&
      std::isfinite(properties.limits->lower) && std::isfinite(properties.limits->upper))
    return {properties.limits->lower, properties.limits->upper};
  const double reach = std::max(2 * std::abs(start), info.angular ? std::numbers::pi : 1.0);
  return {-reach, reach};
}

const char* unit_of(const AxisMotor& motor, const AxisInfo& info) {
  const bool is_rate = motor.mode == AxisMotor::Mode::kVelocity;
  return info.angular ? (is_rate ? "rad/s" : "rad") : (is_rate ? "m/s" : "m");
}

}  // namespace

LiveServer::Options live_server_options(const LiveOptions& options) {
  LiveServer::Options server;
  if (options.address && *options.address != "localhost") server.address = *options.address;
  (void)is_loopback(server.address);  // throws for what is none, and in builds without the server
  const std::string port = options.port.value_or("0");
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), server.port);
  if (error != std::errc() || end != port.data() + port.size() || server.port < 0 || server.port > 65535)
    fail("--live", "takes a port from 0 to 65535; other addresses than 127.0.0.1 are for --live-address",
         port);
  return server;
}

Vec3 pull_force(const World& world, const LivePull& pull, double h) {
  const Pose& X_WB = world.pose(pull.body);
  const Twist& V_WB = world.twist(pull.body);
  const double m = 1 / most_inverse_mass(world, pull.body, pull.p_BP);
  const double w = std::min(kPullFrequency * std::sqrt(pull.strength), kPullSteps / h);
  const Vec3 p_WP = X_WB.point(pull.p_BP);
  return m * w * w * (pull.p_WC - p_WP) - 2 * kPullDamping * m * w * V_WB.at(p_WP - X_WB.p);
}

LiveRun::LiveRun(const LiveOptions& options, Scene& scene, Simulator& simulator, bool may_reset)
    : scene_(scene),
      simulator_(simulator),
      sampler_(scene),
      header_(sampler_.header(kShownPerSecond)),
      may_reset_(may_reset),
      start_(simulator.checkpoint()) {
  const World& world = scene.world;
  for (int j = 0; j < world.joint_count(); ++j)
    for (int k = 0; k < world.axis_count({j}); ++k) {
      const AxisId axis{{j}, k};
      const auto& motor = world.axis_properties(axis).motor;
      if (motor && motor->mode != AxisMotor::Mode::kTrajectory) motors_.push_back({axis, motor->target});
    }
  PageData page = page_frame(header_, sampler_.sample(simulator), true);
  page.description["live"] = state();
  page.description["live"]["may_reset"] = may_reset;
  page.description["live"]["motors"] = motors();
  server_ = std::make_unique<LiveServer>(live_server_options(options), page_text(page, header_.scene));
  time_ = world.time();
}

Json LiveRun::motors() const {
  const World& world = scene_.world;
  Json all = Json::array();
  for (const Motor& motor : motors_) {
    const AxisProperties& properties = world.axis_properties(motor.axis);
    const AxisInfo& info = world.axis_info(motor.axis);
    const auto [low, high] = motor_range(properties, info, motor.start);
    all.push_back({{"name", world.axis_label(motor.axis)},
                   {"unit", unit_of(*properties.motor, info)},
                   {"low", low},
                   {"high", high}});
  }
  return all;
}

Json LiveRun::state() const {
  Json targets = Json::array();
  for (const Motor& motor : motors_)
    targets.push_back(scene_.world.axis_properties(motor.axis).motor->target);
  return {{"paused", paused_},  {"steps", steps_},   {"resets", resets_},  {"speed", speed_},
          {"targets", targets}, {"status", status_}, {"message", message_}};
}

bool LiveRun::is_waiting() const {
  if (server_->browsers_seen() == 0) return true;  // nothing is to be missed
  return paused_ && asked_steps_ == 0;
}

bool LiveRun::before_step(double h) {
  while (true) {
    for (const LiveServer::Message& message : server_->take()) answer(message);
    if (InterruptGuard::signal() != 0) return false;
    if (std::exchange(changed_, false)) show();
    if (is_waiting()) {
      server_->wait(kLookAround);
      clock_ = Clock::now(), time_ = scene_.world.time();
      continue;
    }
    if (paused_) break;  // a single step
    const double ahead = (scene_.world.time() - time_) / speed_ - seconds_since(clock_);
    if (ahead < -kLate) clock_ = Clock::now(), time_ = scene_.world.time();
    if (ahead <= 0) break;
    server_->wait(std::min(ahead, kLookAround));
  }
  if (paused_) --asked_steps_;
  for (const auto& [browser, pull] : pulls_)
    simulator_.apply_force(pull.body, pull.p_BP, pull_force(scene_.world, pull, h));
  return true;
}

void LiveRun::after_step() {
  ++steps_;
  if (paused_ || seconds_since(shown_) >= 1 / kShownPerSecond) show();
}

void LiveRun::show() {
  shown_ = Clock::now();
  PageData frame = page_frame(header_, sampler_.sample(simulator_), false);
  frame.description["live"] = state();
  server_->send_frame(frame.packed());
}

void LiveRun::finish(const std::string& status, const std::string& message) {
  status_ = status, message_ = message;
  try {
    show();
  } catch (const std::exception&) {
    // What ended the run may also keep its last state from being looked at.
  }
}

void LiveRun::answer(const LiveServer::Message& message) {
  if (message.gone) {
    pulls_.erase(message.browser);
    return;
  }
  try {
    obey(message.browser, message.text);
  } catch (const std::exception& error) {
    note(message.browser, error.what());
  }
}

void LiveRun::note(int browser, const std::string& problem) {
  const std::string text = "a message is ignored: " + printable(problem);
  if (++notes_ <= kMostNotes)
    std::cerr << "taut: " << text << (notes_ == kMostNotes ? "; further ones are not shown" : "") << '\n';
  server_->send_text(browser, Json{{"notice", text}}.dump(-1, ' ', false, Json::error_handler_t::replace));
}

void LiveRun::obey(int browser, const std::string& text) {
  const Json message = Json::parse(text);
  const std::string what = message.at("do").get<std::string>();
  if (what == "pause" || what == "play") {
    set_paused(what == "pause");
  } else if (what == "step") {
    if (!paused_) set_paused(true);
    ++asked_steps_;
  } else if (what == "reset") {
    reset();
  } else if (what == "speed") {
    const double speed = number_of(message, "value", 1000);
    if (!(speed >= 1e-3)) fail("value", "must be from 0.001 to 1000", speed);
    speed_ = speed, clock_ = Clock::now(), time_ = scene_.world.time();
    changed_ = true;
  } else if (what == "motor") {
    set_motor(index_of(message, "motor", static_cast<int>(motors_.size())),
              number_of(message, "target", 1e9));
  } else if (what == "pull") {
    const BodyId body{index_of(message, "body", scene_.world.body_count())};
    if (scene_.world.is_fixed(body)) fail("body", "is fixed", scene_.world.name(body));
    const double strength = number_of(message, "strength", kMostPull);
    if (!(strength > 0)) fail("strength", "must be positive", strength);
    pulls_[browser] = {body, point_of(message, "point"), point_of(message, "to"), strength};
  } else if (what == "release") {
    pulls_.erase(browser);
  } else {
    fail("do", "is not known", what);
  }
}

void LiveRun::set_paused(bool paused) {
  paused_ = paused, changed_ = true, asked_steps_ = 0;
  clock_ = Clock::now(), time_ = scene_.world.time();
}

void LiveRun::set_motor(int index, double target) {
  scene_.world.set_motor_target(motors_[index].axis, target);
  changed_ = true;
}

void LiveRun::reset() {
  if (!may_reset_) fail("reset", "is not possible while the run writes files", "reset");
  simulator_.restore(start_);
  for (const Motor& motor : motors_) scene_.world.set_motor_target(motor.axis, motor.start);
  pulls_.clear();
  steps_ = 0, ++resets_, changed_ = true;
  clock_ = Clock::now(), time_ = scene_.world.time();
}

}  // namespace taut
