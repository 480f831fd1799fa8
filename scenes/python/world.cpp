#include "core/world/world.h"

#include <nanobind/stl/variant.h>

#include "core/world/applied_force.h"
#include "scenes/python/access.h"
#include "scenes/python/parts.h"
#include "scenes/python/world_state.h"

namespace taut::python {
namespace {

const auto kBody = nb::arg("body"), kJoint = nb::arg("joint"), kAxis = nb::arg("axis");

void bind_making(nb::class_<World>& c) {
  c.def(
       "add_body",
       [](World& world, const std::string& name, const MassProperties& mass, const Pose& pose,
          const Twist& twist, bool fixed) {
         begin_change(world);
         return world.add_body({.name = name, .mass = mass, .pose = pose, .twist = twist, .fixed = fixed});
       },
       nb::arg("name") = "", nb::arg("mass") = MassProperties(1.0, Vec3(1, 1, 1)), nb::arg("pose") = Pose(),
       nb::arg("twist") = Twist(), nb::arg("fixed") = false,
       "Adds a body; its frame sits at the centre of mass.  An empty name is replaced by a free one.")
      .def(
          "add",
          [](World& world, std::string name, std::shared_ptr<Joint> joint) {
            begin_change(world);
            return world.add_joint(std::move(name), std::move(joint));
          },
          nb::arg("name"), nb::arg("joint"),
          "Adds a joint: world.add(\"elbow\", Ball.at(world, upper, lower, p)).")
      .def(
          "add_force",
          [](World& world, std::shared_ptr<Force> force) {
            begin_change(world);
            return world.add_force(std::shared_ptr<const Force>(std::move(force)));
          },
          nb::arg("force"), "Adds a force law.")
      .def(
          "apply_force",
          [](World& world, BodyId body, const Wrench& wrench) {
            begin_change(world);
            apply_force(world, body, wrench);
          },
          nb::arg("body"), nb::arg("wrench"),
          "A wrench about the centre of mass [N·m, N], world axes, during the next step alone, constant over "
          "its sub-steps.  Several calls add up.  It wakes the body and is in checkpoints.  It is gone with "
          "a "
          "step that is ok(); one that fails keeps it.")
      .def(
          "apply_force",
          [](World& world, BodyId body, const Vec3& p_BP, const Vec3& force) {
            begin_change(world);
            apply_force(world, body, p_BP, force);
          },
          nb::arg("body"), nb::arg("p_BP"), nb::arg("force"),
          "The same of a force [N], world axes, at a point of the body [m], by how the body is turned now.")
      .def(
          "set_force",
          [](World& world, ForceId id, std::shared_ptr<Force> force) {
            begin_change(world);
            world.set_force(id, std::move(force));
          },
          nb::arg("id"), nb::arg("force"),
          "Replaces a force law, for instance to change its value between steps.")
      .def(
          "append",
          [](World& world, const World& other, const std::string& prefix, const Pose& placement) {
            if (&world == &other)
              throw std::invalid_argument("append: a world cannot be appended to itself; append a copy");
            require_askable(other);
            begin_change(world);
            world.append(other, prefix, placement);
          },
          nb::arg("other"), nb::arg("prefix") = "", nb::arg("placement") = Pose(),
          "Adds all that another world has, every name with the prefix, moved as a whole by the placement "
          "X_WF.")
      .def(
          "copy",
          [](const World& world) {
            require_askable(world);
            return World(world);
          },
          "An independent world that shares joints and force laws, which never change.")
      .def("__copy__",
           [](const World& world) {
             require_askable(world);
             return World(world);
           })
      .def(
          "__deepcopy__",
          [](const World& world, nb::handle) {
            require_askable(world);
            return World(world);
          },
          nb::arg("memo"));
}

void bind_joints_of_world(nb::class_<World>& c) {
  c.def("set_break", changing(&World::set_break), kJoint, nb::arg("limits").none(),
        "Strength of a joint; None: it never breaks.")
      .def("set_compliance", changing(&World::set_compliance), kJoint, nb::arg("compliance").none(),
           "Elasticity of a joint; None: rigid.")
      .def("compliance", asking(&World::compliance), kJoint, "None: rigid.")
      .def("detach", changing(&World::detach), kJoint,
           "Takes a joint out; it keeps id, name, axes and properties.")
      .def("attach", changing(&World::attach), kJoint, "Puts a joint back, closed where it was made to be.")
      .def("set_joint_frame", changing(&World::set_joint_frame), kJoint, nb::arg("X_BF"),
           "Has a joint of two bodies take a frame at X_BF on its body B for B; the identity takes it back.  "
           "closing_frame() gives the one with which it is closed.")
      .def("is_attached", asking(&World::is_attached), kJoint)
      .def(
          "joint_type", [](const World& world, JointId id) { return std::string(world.joint(id).type()); },
          kJoint, "As \"hinge\".")
      .def(
          "joint_bodies",
          [](const World& world, JointId id) {
            const auto bodies = world.joint(id).bodies();
            return std::vector<BodyId>(bodies.begin(), bodies.end());
          },
          kJoint, "A, B and further ones.")
      .def(
          "anchor",
          [](const World& world, JointId id) {
            require_askable(world);
            const Joint& joint = world.joint(id);
            return Vec3(world.pose(joint.b()).point(joint.reaction_point_B()));
          },
          kJoint, "The world point [m] about which the torque of its reaction is.");
}

void bind_axes_of_world(nb::class_<World>& c) {
  c.def("axis", &World::axis, kJoint, nb::arg("name"), "A free axis by name.")
      .def(
          "axes",
          [](const World& world, JointId joint) {
            std::vector<std::string> names;
            for (int k = 0; k < world.axis_count(joint); ++k)
              names.push_back(world.axis_info({joint, k}).name);
            return names;
          },
          kJoint, "Names of the free axes of a joint.")
      .def("axis_index", &World::axis_index, kAxis, "Index of an axis in the arrays of a state.")
      .def(
          "axis_properties",
          [](const World& world, AxisId axis) {
            require_askable(world);
            return AxisProperties(world.axis_properties(axis));
          },
          kAxis, "What acts along it; a copy.")
      .def("let_out", &let_out, kAxis, "Length of rope that a winch has let out [m].")
      .def("set_motor_target", changing(&World::set_motor_target), kAxis, nb::arg("target"),
           "A new target for a motor that is there.")
      .def("axis_value", asking(&World::axis_value), kAxis,
           "θ [rad or m] in the present state, with its turns.")
      .def("axis_rate", asking(&World::axis_rate), kAxis, "θ̇ [rad/s or m/s].")
      .def("set_axis_turns", changing(&World::set_axis_turns), kAxis, nb::arg("value"),
           "Says how many turns an angle has made: the value next to this one that fits the poses is kept.");
  for_axis_types_backward([&]<typename Property>() {
    const char* key = Property::kFacts.key;
    c.def((std::string("set_") + key).c_str(), changing(&World::set_property<std::optional<Property>>), kAxis,
          nb::arg(key).none(), "Sets it, or takes it away (None).");
  });
}

void bind_shapes_of_world(nb::class_<World>& c) {
  using SetShape = void (World::*)(ShapeId, const Material&);
  using SetNamed = void (World::*)(ShapeId, MaterialId);
  using OfShapes = void (World::*)(ShapeId, ShapeId, const Material&);
  using OfMaterials = void (World::*)(MaterialId, MaterialId, const Material&);
  c.def(
       "add_shape",
       [](World& world, BodyId body, const Shape& shape, const Pose& pose, const Material& material,
          CollisionFilter filter) {
         begin_change(world);
         return world.add_shape(body, shape, pose, material, filter);
       },
       kBody, nb::arg("shape"), nb::arg("pose") = Pose(), nb::arg("material") = Material(),
       nb::arg("filter") = CollisionFilter(),
       "Gives a body a shape at the pose X_BS in its frame; several shapes on one body are a compound.")
      .def(
          "shape", [](const World& world, ShapeId id) { return ShapeRecord(world.shape(id)); }, nb::arg("id"),
          "As added; a copy.")
      .def("set_material", changing(static_cast<SetShape>(&World::set_material)), nb::arg("shape"),
           nb::arg("material"))
      .def("set_material", changing(static_cast<SetNamed>(&World::set_material)), nb::arg("shape"),
           nb::arg("material"))
      .def("add_material", changing(&World::add_material), nb::arg("name"), nb::arg("material"),
           "A material with a name, which shapes can share and pairs can refer to.")
      .def(
          "material", [](const World& world, std::string_view name) { return world.material(name); },
          nb::arg("name"), "The id of a material by name.")
      .def("set_contact_material", changing(static_cast<OfShapes>(&World::set_contact_material)),
           nb::arg("a"), nb::arg("b"), nb::arg("material"))
      .def("set_contact_material", changing(static_cast<OfMaterials>(&World::set_contact_material)),
           nb::arg("a"), nb::arg("b"), nb::arg("material"))
      .def("contact_material", &World::contact_material, nb::arg("a"), nb::arg("b"),
           "As set for a pair, or combined().")
      .def("set_collision", changing(&World::set_collision), nb::arg("a"), nb::arg("b"),
           nb::arg("may_collide"),
           "Whether two bodies may touch, in place of the rule that bodies with a common joint do not.")
      .def(
          "may_collide", [](const World& world, BodyId a, BodyId b) { return world.may_collide(a, b); },
          nb::arg("a"), nb::arg("b"));
}

void bind_rest(nb::class_<World>& c) {
  c.def_prop_ro(
       "breakable",
       [](const World& world) {
         std::vector<std::pair<JointId, BreakLimits>> found(world.breakable().begin(),
                                                            world.breakable().end());
         return found;
       },
       "The joints that can break, with their strengths.")
      .def(
          "detach_all_but",
          [](World& world, const std::vector<JointId>& joints) {
            begin_change(world);
            world.detach_all_but(joints);
          },
          nb::arg("joints"), "Takes out all joints but these and those whose axes they couple.")
      .def_prop_ro("detached_count", asking(&World::detached_count))
      .def("has_axis_properties", asking(&World::has_axis_properties), kJoint)
      .def("set_axis_properties", changing(&World::set_axis_properties), kAxis, nb::arg("properties"),
           "Sets all that acts along an axis at once.")
      .def("axis_label", &World::axis_label, kAxis, "As \"elbow angle\", for messages.")
      .def(
          "spring_energy_of",
          [](World& world, JointId joint) {
            const StepScope scope(world);
            return world.spring_energy_of(joint, world.state());
          },
          kJoint, "In the springs, soft limits and compliance of one joint [J].")
      .def(
          "may_collide", [](const World& world, ShapeId a, ShapeId b) { return world.may_collide(a, b); },
          nb::arg("a"), nb::arg("b"),
          "Whether two shapes may touch: their bodies may, and their filters agree.")
      .def(
          "material", [](const World& world, MaterialId id) { return Material(world.material(id)); },
          nb::arg("id"), "Its values; a copy.")
      .def_prop_ro("material_count", &World::material_count, "With a name.")
      .def("moves", asking(&World::moves), kBody, "Neither fixed nor asleep.")
      .def("wake_count", asking(&World::wake_count), kBody, "How often a body was woken.")
      .def_prop_ro("asleep_count", asking(&World::asleep_count))
      .def(
          "springs",
          [](const World& world) {
            return std::vector<ForceId>(world.springs().begin(), world.springs().end());
          },
          "The force laws that are springs between two bodies.");
}

void bind_names(nb::class_<World>& c) {
  c.def("body", &World::body, nb::arg("name"), "A body by name.")
      .def(
          "joint", [](const World& world, std::string_view name) { return world.joint(name); },
          nb::arg("name"), "A joint by name.")
      .def("has_body", &World::has_body, nb::arg("name"))
      .def("has_joint", &World::has_joint, nb::arg("name"))
      .def(
          "name", [](const World& world, BodyId id) { return world.name(id); }, nb::arg("id"))
      .def(
          "name", [](const World& world, JointId id) { return world.name(id); }, nb::arg("id"))
      .def(
          "name", [](const World& world, MaterialId id) { return world.name(id); }, nb::arg("id"))
      .def(
          "mass_properties",
          [](const World& world, BodyId id) { return MassProperties(world.mass_properties(id)); }, kBody)
      .def("is_fixed", &World::is_fixed, kBody)
      .def_prop_ro("body_count", &World::body_count, "With the ground.")
      .def_prop_ro("moving_body_count", &World::moving_body_count)
      .def_prop_ro("joint_count", &World::joint_count, "Detached ones too.")
      .def_prop_ro("force_count", &World::force_count, "Without gravity.")
      .def_prop_ro("shape_count", &World::shape_count)
      .def(
          "bodies",
          [](const World& world) {
            std::vector<BodyId> ids;
            for (int b = 0; b < world.body_count(); ++b) ids.push_back({b});
            return ids;
          },
          "All of them, the ground first.")
      .def(
          "joints",
          [](const World& world) {
            std::vector<JointId> ids;
            for (int j = 0; j < world.joint_count(); ++j) ids.push_back({j});
            return ids;
          },
          "All of them.");
}

}  // namespace

void bind_world(nb::module_& m) {
  nb::class_<Joint>(m, "Joint",
                    "A joint between body A and body B, and for some types further bodies; immutable.  "
                    "World.add() adds it.");
  nb::class_<Force>(m, "Force", "A force law f(q, V, t).  World.add_force() adds it.");
  nb::class_<World> world(
      m, "World",
      "What exists: bodies, joints, forces, gravity, and their present state.  It owns everything and never "
      "steps; "
      "ids stay good, since nothing is ever removed.  What raises leaves the world as it was.  SI units.");
  world.def(nb::init<>());
  bind_making(world);
  bind_joints_of_world(world);
  bind_axes_of_world(world);
  bind_shapes_of_world(world);
  bind_rest(world);
  bind_names(world);
  bind_world_state(world);
  world.def("__repr__", [](const World& w) {
    return "<World: " + std::to_string(w.body_count()) + " bodies, " + std::to_string(w.joint_count()) +
           " joints>";
  });
}

}  // namespace taut::python
