#include <nanobind/stl/filesystem.h>

#include "scenes/builders/drawing.h"
#include "scenes/builders/scene.h"
#include "scenes/files/scene_file.h"
#include "scenes/files/scene_source.h"
#include "scenes/files/state_file.h"
#include "scenes/python/parts.h"
#include "scenes/python/session.h"

namespace taut::python {
namespace {

void bind_probe(nb::module_& m) {
  using Quantity = Probe::Quantity;
  nb::class_<Probe> probe(m, "Probe", "A quantity recorded over time, from a body, a joint or an axis.");
  nb::enum_<Quantity>(probe, "Quantity", "What is recorded.")
      .value("POSITION", Quantity::kPosition, "Of a body point [m].")
      .value("VELOCITY", Quantity::kVelocity, "Of a body point [m/s].")
      .value("ORIENTATION", Quantity::kOrientation, "Quaternion w, x, y, z.")
      .value("ANGULAR_VELOCITY", Quantity::kAngularVelocity, "World axes [rad/s].")
      .value("REACTION_FORCE", Quantity::kReactionForce, "Of a joint on B, world axes [N].")
      .value("REACTION_TORQUE", Quantity::kReactionTorque, "Of a joint on B about its anchor [N·m].")
      .value("GAP", Quantity::kGap, "Of a joint [m], [rad].")
      .value("ENERGY", Quantity::kEnergy, "Kinetic, potential [J].")
      .value("MOMENTUM", Quantity::kMomentum, "Linear [N·s].")
      .value("ANGULAR_MOMENTUM", Quantity::kAngularMomentum, "About the world origin [N·m·s].")
      .value("AXIS", Quantity::kAxis, "Value [rad or m] and rate of a free axis.")
      .value("AXIS_FORCE", Quantity::kAxisForce, "Mean over the last step, by what gave it [N·m or N].")
      .value("AXIS_POWER", Quantity::kAxisPower, "[W].")
      .value("AXIS_STATE", Quantity::kAxisState, "Stuck, saturated, at a limit; 0 or 1.");
  probe
      .def(
          "__init__",
          [](Probe* it, std::string name, Quantity quantity, BodyId body, JointId joint, AxisId axis,
             const Vec3& point_B) { new (it) Probe{std::move(name), quantity, body, joint, axis, point_B}; },
          nb::arg("name"), nb::arg("quantity"), nb::arg("body") = BodyId(), nb::arg("joint") = JointId(),
          nb::arg("axis") = AxisId(), nb::arg("point_B") = Vec3(0, 0, 0))
      .def_ro("name", &Probe::name)
      .def_ro("quantity", &Probe::quantity)
      .def_ro("body", &Probe::body)
      .def_ro("joint", &Probe::joint)
      .def_ro("axis", &Probe::axis)
      .def_ro("point_B", &Probe::point_B, "From the centre of mass, body axes [m].");
}

void bind_scene(nb::module_& m) {
  nb::class_<Scene>(m, "Scene", "A world with what is needed to run it.")
      .def(
          "__init__",
          [](Scene* it, const World& world, std::string name) {
            require_askable(world);
            new (it) Scene();
            it->name = std::move(name);
            it->world = world;
          },
          nb::arg("world"), nb::arg("name") = "scene", "Of a copy of a world.")
      .def_rw("name", &Scene::name)
      .def_ro("parameters", &Scene::parameters, "As built; booleans are 0 or 1.")
      .def_ro("parameter_units", &Scene::parameter_units, "Of those that have one; \"bool\": true or false.")
      .def_prop_ro(
          "world", [](Scene& scene) -> World& { return scene.world; }, nb::rv_policy::reference_internal)
      .def_ro("warnings", &Scene::warnings, "What is strange in the file that it was read from, a line each.")
      .def_rw("settings", &Scene::settings)
      .def_rw("dt", &Scene::dt, "[s].")
      .def_rw("duration", &Scene::duration, "[s].")
      .def_ro("assemble", &Scene::assemble,
              "Joints may be open at the start: Simulator.assemble() comes before the first step.")
      .def_prop_ro(
          "probes", [](const Scene& scene) { return scene.probes; }, "A copy.")
      .def(
          "add_probe", [](Scene& scene, Probe probe) { scene.probes.push_back(std::move(probe)); },
          nb::arg("probe"))
      .def_prop_rw(
          "events", [](const Scene& scene) { return scene.events; },
          [](Scene& scene, std::vector<Event> events) { scene.events = std::move(events); },
          "For Simulator.set_events(), which simulate() calls; a copy.")
      .def("draw", &draw, nb::arg("body"), nb::arg("shape"),
           "Has a body drawn as a PlacedShape on pages; nothing collides and no mass changes.")
      .def("__repr__", [](const Scene& scene) {
        return "<Scene " + scene.name + ": " + std::to_string(scene.world.body_count()) + " bodies, " +
               std::to_string(scene.world.joint_count()) + " joints>";
      });
}

void bind_sources(nb::module_& m) {
  nb::class_<ParameterInfo>(m, "ParameterInfo", "One parameter of a scene of the catalogue.")
      .def_ro("name", &ParameterInfo::name)
      .def_ro("default_value", &ParameterInfo::default_value)
      .def_ro("unit", &ParameterInfo::unit)
      .def_ro("description", &ParameterInfo::description)
      .def_ro("minimum", &ParameterInfo::minimum)
      .def_ro("maximum", &ParameterInfo::maximum)
      .def_ro("integer", &ParameterInfo::integer);
  nb::class_<SceneInfo>(m, "SceneInfo", "A scene of the catalogue.")
      .def_ro("name", &SceneInfo::name)
      .def_ro("description", &SceneInfo::description)
      .def_ro("parameters", &SceneInfo::parameters)
      .def("__repr__", [](const SceneInfo& info) { return "<" + info.name + ": " + info.description + ">"; });
  m.def(
      "catalogue", [] { return scene_catalogue(); }, "All scenes that build_scene() knows.");
  m.def(
      "build_scene",
      [](const std::string& name, const nb::kwargs& parameters) {
        return build_scene(name, nb::cast<std::map<std::string, double>>(parameters));
      },
      nb::arg("name"), nb::arg("parameters"), "A scene of the catalogue: build_scene(\"bridge\", n=50).",
      nb::sig("def build_scene(name: str, **parameters: float) -> Scene"));
  m.def("load_scene", &load_scene_file, nb::arg("path"),
        "A scene file (JSON); mesh files are looked for in its folder.");
  m.def(
      "parse_scene", &parse_scene, nb::arg("text"), nb::arg("file_name") = "scene.json",
      nb::arg("by_hand") = true,
      "The same for a text; its name is for messages, and mesh files are looked for in its folder.  by_hand "
      "False: a program has made it, and there are no warnings of slips of the hand.");
}

void bind_state_files(nb::module_& m) {
  m.def(
      "save_state",
      [](Session& session, const std::filesystem::path& path) {
        const std::string error =
            session.ask([&](Simulator& simulator) { return save_state_file(simulator, path); });
        if (!error.empty()) throw std::runtime_error(error);
      },
      nb::arg("simulator"), nb::arg("path"),
      "Writes the state with all that the simulator remembers, as `taut run --save`; a file that is there is "
      "replaced as a "
      "whole.");
  m.def(
      "load_state",
      [](Session& session, const std::filesystem::path& path) {
        return session.ask([&](Simulator& simulator) {
          const SavedMemory memory = load_state_file(session.world(), path);
          return go_on_from(simulator, session.world(), memory);
        });
      },
      nb::arg("simulator"), nb::arg("path"),
      "Sets the world to the state of a file and goes on from there.  Returns \"\" if that is to the last "
      "bit, or why it goes on "
      "from the state alone.");
}

}  // namespace

void bind_scenes(nb::module_& m) {
  bind_probe(m);
  bind_scene(m);
  bind_sources(m);
  bind_state_files(m);
}

}  // namespace taut::python
