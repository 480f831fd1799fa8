#include <nanobind/stl/variant.h>

#include "core/world/joint_frame.h"
#include "scenes/python/access.h"
#include "scenes/python/callbacks.h"
#include "scenes/python/parts.h"
#include "solvers/simulator/event.h"
#include "solvers/simulator/simulator.h"

namespace taut::python {
namespace {

/// Calls a Python function with a copy of the state.
struct WatchFunction {
  HeldObject function;

  double operator()(Simulator& simulator) const {
    const nb::gil_scoped_acquire gil;
    const nb::object result = function.get()(nb::cast(State(simulator.world().state())));
    double value = 0;
    if (!nb::try_cast(result, value)) throw nb::type_error("a watch must return a number");
    return value;
  }
};

void bind_watches(nb::module_& m) {
  nb::class_<Watch>(m, "Watch",
                    "A number that an event watches.  `along` is a direction of unit length in world axes, "
                    "whose component of "
                    "a vector is meant; without it, its magnitude.")
      .def(
          "__init__",
          [](Watch* it, nb::callable function, std::string label, bool of_state) {
            new (it) Watch{std::move(label), WatchFunction{HeldObject(std::move(function))}, of_state};
          },
          nb::arg("function"), nb::arg("label") = "a function", nb::arg("of_state") = true,
          "Any function(state) of a State.  of_state: it depends on the state alone and is continuous, so "
          "that "
          "events can be located within a step.")
      .def_static("position", &Watch::position, nb::arg("world"), nb::arg("body"),
                  nb::arg("p_BP") = Vec3(0, 0, 0), nb::arg("along") = nb::none(), "Of a body's point [m].")
      .def_static("velocity", &Watch::velocity, nb::arg("world"), nb::arg("body"),
                  nb::arg("p_BP") = Vec3(0, 0, 0), nb::arg("along") = nb::none(), "Of a body's point [m/s].")
      .def_static("angular_velocity", &Watch::angular_velocity, nb::arg("world"), nb::arg("body"),
                  nb::arg("along") = nb::none(), "Of a body [rad/s].")
      .def_static("distance", &Watch::distance, nb::arg("world"), nb::arg("a"), nb::arg("p_AP"), nb::arg("b"),
                  nb::arg("p_BQ"), "Of point P of A and point Q of B [m].")
      .def_static("axis", &Watch::axis, nb::arg("world"), nb::arg("axis"),
                  "Coordinate of a free axis [rad or m].")
      .def_static("axis_rate", &Watch::axis_rate, nb::arg("world"), nb::arg("axis"), "[rad/s or m/s].")
      .def_static("reaction_force", &Watch::reaction_force, nb::arg("world"), nb::arg("joint"),
                  nb::arg("along") = nb::none(), "Mean over the last step, on B [N]; not located.")
      .def_static("reaction_torque", &Watch::reaction_torque, nb::arg("world"), nb::arg("joint"),
                  nb::arg("along") = nb::none(),
                  "Mean over the last step, on B about the anchor [N·m]; not located.")
      .def_static("joint_gap", &Watch::joint_gap, nb::arg("world"), nb::arg("joint"),
                  "How far a joint is open, detached or not: the larger of [m] and [rad].")
      .def_static("contact_gap", &Watch::contact_gap, nb::arg("world"), nb::arg("a"), nb::arg("b"),
                  "Smallest gap of the contacts of two bodies [m]; infinite without any; not located.")
      .def_ro("label", &Watch::label);
}

void bind_causes_of_events(nb::module_& m) {
  nb::class_<AtTime>(m, "AtTime", "At a time [s], which a step ends at, to the last bit.")
      .def(nb::init<double>(), nb::arg("time"))
      .def_ro("time", &AtTime::time);
  nb::class_<WhenPasses> passes(
      m, "WhenPasses",
      "When a number passes a threshold: it was on one side and is at it or beyond; once or each time.  "
      "Located "
      "to a millionth of a step, which costs a checkpoint a step, or at the end of the step.");
  nb::enum_<WhenPasses::Way>(passes, "Way", "Which passages count.")
      .value("RISING", WhenPasses::Way::kRising)
      .value("FALLING", WhenPasses::Way::kFalling)
      .value("EITHER", WhenPasses::Way::kEither);
  passes
      .def(
          "__init__",
          [](WhenPasses* it, Watch watch, double threshold, WhenPasses::Way way, bool each_time,
             bool located) {
            new (it) WhenPasses{std::move(watch), threshold, way, each_time, located};
          },
          nb::arg("watch"), nb::arg("threshold"), nb::arg("way") = WhenPasses::Way::kEither,
          nb::arg("each_time") = false, nb::arg("located") = true)
      .def_ro("watch", &WhenPasses::watch)
      .def_ro("threshold", &WhenPasses::threshold)
      .def_ro("way", &WhenPasses::way)
      .def_ro("each_time", &WhenPasses::each_time)
      .def_ro("located", &WhenPasses::located);
}

void bind_actions(nb::module_& m) {
  nb::class_<AttachJoint> attach(m, "AttachJoint",
                                 "Attaches a joint.  With its ends apart by more than `tolerance` [m or rad] "
                                 "the step fails (CLOSED), or "
                                 "its end on B moves to where it is closed (AS_IS).");
  nb::enum_<AttachJoint::Where>(attach, "Where", "What becomes of a joint whose ends are apart.")
      .value("CLOSED", AttachJoint::Where::kClosed)
      .value("AS_IS", AttachJoint::Where::kAsIs);
  attach.def(
      "__init__",
      [](AttachJoint* it, JointId joint, AttachJoint::Where where, double tolerance) {
        new (it) AttachJoint{joint, where, tolerance};
      },
      nb::arg("joint"), nb::arg("where") = AttachJoint::Where::kClosed, nb::arg("tolerance") = 1e-6);
  nb::class_<DetachJoint>(m, "DetachJoint", "Detaches a joint and those that couple its axes.")
      .def(
          "__init__", [](DetachJoint* it, JointId joint) { new (it) DetachJoint{joint}; }, nb::arg("joint"));
  nb::class_<SetMotor>(m, "SetMotor",
                       "Gives the motor of a free axis a target or a largest force, or takes it away.")
      .def(
          "__init__",
          [](SetMotor* it, AxisId axis, std::optional<double> target, std::optional<double> max_force,
             bool remove) {
            new (it) SetMotor{axis, target, max_force, remove};
          },
          nb::arg("axis"), nb::arg("target") = nb::none(), nb::arg("max_force") = nb::none(),
          nb::arg("remove") = false);
  nb::class_<ApplyLoad>(
      m, "ApplyLoad",
      "A force [N] at point P of a body and a torque [N·m] for a duration [s] from the event on, "
      "times a function of the time since then.")
      .def(
          "__init__",
          [](ApplyLoad* it, BodyId body, const Vec3& force, const Vec3& torque, const Vec3& p_BP,
             bool follows_body, double duration, std::optional<BoundMotion> factor) {
            new (it) ApplyLoad{
                body, p_BP, force, torque, follows_body, duration, factor ? factor->function : Motion()};
          },
          nb::arg("body"), nb::arg("force") = Vec3(0, 0, 0), nb::arg("torque") = Vec3(0, 0, 0),
          nb::arg("p_BP") = Vec3(0, 0, 0), nb::arg("follows_body") = false, nb::arg("duration") = kUnlimited,
          nb::arg("factor") = nb::none());
  nb::class_<SetGravity>(m, "SetGravity", "Sets gravity [m/s²].")
      .def(
          "__init__", [](SetGravity* it, const Vec3& gravity) { new (it) SetGravity{gravity}; },
          nb::arg("gravity"));
  nb::class_<EndRun>(m, "EndRun", "Ends the run with the event's name: run_until() and simulate() return.")
      .def(nb::init<>());
}

}  // namespace

void bind_events(nb::module_& m) {
  m.def(
      "gap_of",
      [](const World& world, JointId joint) {
        require_askable(world);
        return gap_of(world, joint);
      },
      nb::arg("world"), nb::arg("joint"), "How far a joint is open, detached or not, soft or rigid.");
  m.def(
      "closing_frame",
      [](const World& world, JointId joint) {
        require_askable(world);
        return closing_frame(world, joint);
      },
      nb::arg("world"), nb::arg("joint"),
      "For World.set_joint_frame(): closes a joint of two bodies where they are, by the smallest turn of B's "
      "end "
      "about the anchor and the smallest shift.");
  bind_watches(m);
  bind_causes_of_events(m);
  bind_actions(m);
  nb::class_<Event>(m, "Event",
                    "Something that happens once, or each time when a number passes a threshold: "
                    "Simulator.set_events().")
      .def(
          "__init__",
          [](Event* it, std::string name, std::variant<AtTime, WhenPasses> when,
             std::vector<EventAction> actions) {
            new (it) Event{std::move(name), std::move(when), std::move(actions)};
          },
          nb::arg("name"), nb::arg("when"), nb::arg("actions") = std::vector<EventAction>())
      .def_ro("name", &Event::name)
      .def(
          "text", [](const Event& it, const World& world) { return text_of(it, world); }, nb::arg("world"),
          "What it does: \"detach hook\".");
}

}  // namespace taut::python
