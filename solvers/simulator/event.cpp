#include "solvers/simulator/event.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/base/check.h"
#include "core/world/joint_frame.h"
#include "solvers/simulator/simulator.h"

namespace taut {
namespace {

/// A vector as the number that is watched.
auto measured(const Watch::Along& along) {
  if (along) require_unit("watched direction", *along);
  return [along](const Vec3& v) { return along ? along->dot(v) : v.norm(); };
}

std::string component(const char* what, const Watch::Along& along) {
  if (!along) return std::string("magnitude of the ") + what;
  for (int k = 0; k < 3; ++k)
    if (*along == Vec3::Unit(k)) return std::string(what) + " along " + "xyz"[k];
  return std::string(what) + " along a direction";
}

std::string shown(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

std::string shown(const Vec3& v) {
  std::ostringstream text;
  text << '[' << v.x() << ", " << v.y() << ", " << v.z() << ']';
  return text.str();
}

/// Checks one action, whose event is called so.
struct CheckAction {
  const World& world;
  const std::string& event;

  void operator()(const AttachJoint& a) const {
    const Joint& joint = world.joint(a.joint);
    require_not_negative(event + ": tolerance", a.tolerance);
    if (a.where == AttachJoint::Where::kAsIs &&
        (joint.bodies().size() != 2 || joint.axes_needed() > 0 || !joint.couples().empty()))
      fail(event + ": joint " + world.name(a.joint), "has no end on one of two bodies that could be moved",
           joint.type());
  }
  void operator()(const DetachJoint& a) const { (void)world.joint(a.joint); }
  void operator()(const SetMotor& a) const {
    const std::string motor = event + ": motor of " + world.axis_label(a.axis);
    const std::optional<AxisMotor>& present = world.axis_properties(a.axis).motor;
    if (!present) fail(motor, "is not there", "none");
    if (a.remove == (a.target || a.max_force))
      fail(motor, "needs a target, a largest force, or to be removed", a.remove ? "both" : "nothing");
    if (a.target && present->mode == AxisMotor::Mode::kTrajectory)
      fail(motor, "follows a trajectory and has no target", *a.target);
    AxisMotor changed = *present;
    changed.target = a.target.value_or(changed.target);
    changed.max_force = a.max_force.value_or(changed.max_force);
    check_axis(motor, changed);
  }
  void operator()(const ApplyLoad& a) const {
    const std::string load = event + ": load on " + world.name(a.body);
    require_all_finite(load + ": point", a.p_BP);
    require_all_finite(load + ": force", a.force);
    require_all_finite(load + ": torque", a.torque);
    if (!(a.duration > 0)) fail(load + ": duration", "must be positive", a.duration);
  }
  void operator()(const SetGravity& a) const { require_all_finite(event + ": gravity", a.gravity); }
  void operator()(const EndRun&) const {}
};

struct ActionText {
  const World& world;

  std::string operator()(const AttachJoint& a) const {
    return "attach " + world.name(a.joint) + (a.where == AttachJoint::Where::kAsIs ? " as it is" : "");
  }
  std::string operator()(const DetachJoint& a) const { return "detach " + world.name(a.joint); }
  std::string operator()(const SetMotor& a) const {
    std::string text = "motor of " + world.axis_label(a.axis) + ":";
    if (a.remove) text += " removed";
    if (a.target) text += " target " + shown(*a.target);
    if (a.max_force) text += std::string(a.target ? "," : "") + " at most " + shown(*a.max_force);
    return text;
  }
  std::string operator()(const ApplyLoad& a) const {
    std::string text = "load on " + world.name(a.body);
    if (a.duration < kUnlimited) text += " for " + shown(a.duration) + " s";
    return text;
  }
  std::string operator()(const SetGravity& a) const { return "gravity " + shown(a.gravity); }
  std::string operator()(const EndRun&) const { return "end of the run"; }
};

}  // namespace

Watch Watch::position(const World& world, BodyId body, const Vec3& p_BP, const Along& along) {
  require_all_finite("watched point of " + world.name(body), p_BP);
  return {component("position", along) + " of " + world.name(body),
          [=, measure = measured(along)](Simulator& simulator) {
            return measure(simulator.world().pose(body).point(p_BP));
          }};
}

Watch Watch::velocity(const World& world, BodyId body, const Vec3& p_BP, const Along& along) {
  require_all_finite("watched point of " + world.name(body), p_BP);
  return {component("velocity", along) + " of " + world.name(body),
          [=, measure = measured(along)](Simulator& simulator) {
            const World& now = simulator.world();
            return measure(now.twist(body).at(now.pose(body).q * p_BP));
          }};
}

Watch Watch::angular_velocity(const World& world, BodyId body, const Along& along) {
  return {component("angular velocity", along) + " of " + world.name(body),
          [=, measure = measured(along)](Simulator& simulator) {
            return measure(simulator.world().twist(body).w);
          }};
}

Watch Watch::distance(const World& world, BodyId a, const Vec3& p_AP, BodyId b, const Vec3& p_BQ) {
  require_all_finite("watched point of " + world.name(a), p_AP);
  require_all_finite("watched point of " + world.name(b), p_BQ);
  return {"distance of " + world.name(a) + " and " + world.name(b), [=](Simulator& simulator) {
            const World& now = simulator.world();
            return (now.pose(b).point(p_BQ) - now.pose(a).point(p_AP)).norm();
          }};
}

Watch Watch::axis(const World& world, AxisId axis) {
  return {world.axis_label(axis), [=](Simulator& simulator) { return simulator.world().axis_value(axis); }};
}

Watch Watch::axis_rate(const World& world, AxisId axis) {
  return {"rate of " + world.axis_label(axis),
          [=](Simulator& simulator) { return simulator.world().axis_rate(axis); }};
}

Watch Watch::reaction_force(const World& world, JointId joint, const Along& along) {
  return {component("reaction force", along) + " of " + world.name(joint),
          [=, measure = measured(along)](Simulator& simulator) {
            return simulator.world().is_attached(joint) ? measure(simulator.mean_reaction(joint).force) : 0;
          },
          false};
}

Watch Watch::reaction_torque(const World& world, JointId joint, const Along& along) {
  return {component("reaction torque", along) + " of " + world.name(joint),
          [=, measure = measured(along)](Simulator& simulator) {
            return simulator.world().is_attached(joint) ? measure(simulator.mean_reaction(joint).torque) : 0;
          },
          false};
}

Watch Watch::joint_gap(const World& world, JointId joint) {
  return {"gap of " + world.name(joint), [=](Simulator& simulator) {
            const Gap gap = gap_of(simulator.world(), joint);
            return std::max(gap.metres, gap.radians);
          }};
}

Watch Watch::contact_gap(const World& world, BodyId a, BodyId b) {
  return {"contact gap of " + world.name(a) + " and " + world.name(b),
          [=](Simulator& simulator) {
            // Before the first step no contact is known.
            if (simulator.report().dt == 0) return std::numeric_limits<double>::quiet_NaN();
            double least = std::numeric_limits<double>::infinity();
            for (const ContactReport& report : simulator.contacts()) {
              const Contact& c = report.contact;
              if ((c.A == a && c.B == b) || (c.A == b && c.B == a)) least = std::min(least, c.gap);
            }
            return least;
          },
          false};
}

void check_event(const World& world, const Event& event) {
  const std::string name = "event " + event.name;
  if (event.name.empty()) fail("event", "must have a name", "");
  if (const AtTime* at = std::get_if<AtTime>(&event.when)) {
    require_finite(name + ": time", at->time);
  } else {
    const WhenPasses& passes = std::get<WhenPasses>(event.when);
    require_finite(name + ": threshold", passes.threshold);
    if (!passes.watch.value) fail(name + ": watch", "must be callable", "empty function");
  }
  if (event.actions.empty() && std::holds_alternative<AtTime>(event.when))
    fail(name, "must do something", "no action");
  for (const EventAction& action : event.actions) std::visit(CheckAction{world, name}, action);
}

std::string text_of(const Event& event, const World& world) {
  std::string text;
  for (const EventAction& action : event.actions)
    text += (text.empty() ? "" : "; ") + std::visit(ActionText{world}, action);
  return text;
}

}  // namespace taut
