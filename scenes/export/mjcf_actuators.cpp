#include "scenes/export/mjcf_actuators.h"

#include <set>

namespace taut {
namespace {

/// An exact motor as a servo: its velocity follows in this part of a step, its position in so many steps.  A
/// stiffer position is unstable there, where springs are explicit.
constexpr double kFollowing = 0.1, kArriving = 4;

}  // namespace

void MjcfActuators::add(const TreeAxis& axis, BodyId body, const std::string& joint) {
  const auto& motor = scene_.world.axis_properties(axis.id).motor;
  if (!motor || motor->max_force == 0) return;  // without force it does nothing
  const std::string label = scene_.world.axis_label(axis.id);
  if (motor->mode == AxisMotor::Mode::kTrajectory)
    return notices_.push_back(label + ": a motor along a trajectory has no counterpart");
  if (motor->max_speed < kUnlimited)
    notices_.push_back(label + ": the highest speed of a motor has no counterpart");
  if (motor->force_of_speed)
    notices_.push_back(label + ": a force of a motor that depends on its speed has no counterpart");
  const bool to_position = motor->mode == AxisMotor::Mode::kPosition;
  Servo servo{joint, to_position, motor->target, motor->stiffness, motor->damping, motor->max_force};
  if (!motor->has_gains()) {
    servo = exact(axis, body, servo);
    notices_.push_back(label + ": a motor that keeps its target exactly is a servo (value: stiffness " +
                       words(servo.stiffness) + ", damping " + words(servo.damping) + ")");
  } else if (to_position && servo.stiffness == 0) {  // a damper alone
    servo.to_position = false, servo.target = 0;
  }
  servos_.push_back(std::move(servo));
}

MjcfActuators::Servo MjcfActuators::exact(const TreeAxis& axis, BodyId body, Servo servo) {
  const double m = inertia_behind(axis, body);
  servo.damping = m / (kFollowing * scene_.dt);
  if (servo.to_position) servo.stiffness = servo.damping / (kArriving * scene_.dt);
  return servo;
}

/// Of all that hangs on the axis [kg m² or kg].
double MjcfActuators::inertia_behind(const TreeAxis& axis, BodyId body) const {
  const World& world = scene_.world;
  std::set<BodyId> behind{body};
  Vec3 anchor = Vec3::Zero();
  double sum = 0;
  for (const TreeBody& each : tree_.bodies) {
    if (each.body == body) anchor = each.anchor;
    if (each.body != body && (each.free || !behind.contains(each.parent))) continue;
    behind.insert(each.body);
    const MassProperties& mass = world.mass_properties(each.body);
    const Pose& X = world.pose(each.body);
    const Vec3 about = X.q.conjugate() * axis.direction;
    sum += axis.angular ? about.dot(mass.inertia_B() * about) +
                              mass.mass() * axis.direction.cross(X.p - anchor).squaredNorm()
                        : mass.mass();
  }
  return sum;
}

std::string MjcfActuators::write(pugi::xml_node mujoco) const {
  if (servos_.empty()) return "";
  mujoco.child("option").append_attribute("integrator") = "implicitfast";
  pugi::xml_node section = mujoco.append_child("actuator");
  std::string controls;
  for (const Servo& servo : servos_) {
    pugi::xml_node node = section.append_child(servo.to_position ? "position" : "velocity");
    const auto set = [&](const char* key, const std::string& value) {
      node.append_attribute(key) = value.c_str();
    };
    set("name", servo.joint);
    set("joint", servo.joint);
    if (servo.to_position) set("kp", words(servo.stiffness));
    set("kv", words(servo.damping));
    if (servo.max_force < kUnlimited) {
      set("forcelimited", "true");
      set("forcerange", words(-servo.max_force) + ' ' + words(servo.max_force));
    }
    controls += (controls.empty() ? "" : " ") + words(servo.target);
  }
  return controls;
}

}  // namespace taut
