#include "scenes/accuracy/reference_builder.h"

/// Forces of a reference case.
namespace taut::reference {
namespace {

using Json = nlohmann::json;

/// Friction, motor or spring of a free axis.  @returns false for another kind of force.
bool add_axis_force(Case& out, const Json& force) {
  if (!force.contains("joint")) return false;
  const std::string type = force.at("type");
  const FreeAxis& axis = out.axes.at(force.at("joint"));
  if (type == "hinge_coulomb" || type == "slider_coulomb") {
    const double most = force.at(type == "hinge_coulomb" ? "torque" : "force");
    out.world.set_friction(axis.id, AxisFriction{most, most, 0});
  } else if (type == "hinge_motor" || type == "slider_motor") {
    out.world.set_motor(
        axis.id, AxisMotor{.target = force.at("target_speed"),
                           .max_force = force.at(force.contains("max_force") ? "max_force" : "max_torque")});
  } else if (type == "joint_spring") {
    out.world.set_spring(axis.id, AxisSpring{.stiffness = force.at("k"),
                                             .damping = force.value("c", 0.0),
                                             .rest = force.value("rest", 0.0) - axis.start});
  } else {
    return false;
  }
  return true;
}

/// Torque −c ω_rel about an axis fixed in A, on B, and the opposite on A.
ForceCallback viscous_hinge(BodyId a, BodyId b, const Vec3& axis_A, double c) {
  return ForceCallback([=](const State& state, std::span<Wrench> wrenches) {
    const Vec3 axis = state.poses[a.index].q * axis_A;
    const Vec3 torque = -c * axis.dot(state.twists[b.index].w - state.twists[a.index].w) * axis;
    wrenches[b.index].torque += torque;
    wrenches[a.index].torque -= torque;
  });
}

}  // namespace

void add_force(Case& out, const Json& force) {
  World& world = out.world;
  const std::string type = force.at("type");
  if (add_axis_force(out, force)) return;
  const auto body = [&](const char* key) { return find_body(world, force.at(key)); };
  if (type == "constant_force") {
    const BodyId b = body("body");
    world.add_force(PointForce(b, world.pose(b).local(vector_of(force, "point")), vector_of(force, "force")));
  } else if (type == "constant_torque") {
    world.add_force(BodyTorque(body("body"), vector_of(force, "torque")));
  } else if (type == "spring_damper") {
    const BodyId a = body("a"), b = body("b");
    world.add_force(SpringDamper(a, b, world.pose(a).local(vector_of(force, "anchor_a")),
                                 world.pose(b).local(vector_of(force, "anchor_b")), force.at("k"),
                                 force.at("rest_length"), force.value("c", 0.0)));
  } else if (type == "hinge_viscous") {
    const BodyId a = body("a"), b = body("b");
    world.add_force(
        viscous_hinge(a, b, world.pose(a).q.conjugate() * vector_of(force, "axis"), force.at("c")));
  } else {
    fail("force", "of unknown type", type);
  }
}

}  // namespace taut::reference
