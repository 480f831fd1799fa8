#include "core/joints/joints.h"
#include "scenes/accuracy/reference_builder.h"

/// Joints of a reference case.
namespace taut::reference {
namespace {

using Json = nlohmann::json;

/// An angle with the sense in which it counts a given direction.
struct Sensed {
  FreeAxis axis;
  double sense = 1;
};

/// The angle of B against A about an axis, whichever way the joint was given.
Sensed hinge_about(const Case& c, BodyId a, BodyId b, const Vec3& axis_W) {
  for (const auto& [name, axis] : c.axes) {
    if (!c.world.axis_info(axis.id).angular) continue;
    const bool forward = axis.a == a && axis.b == b, backward = axis.a == b && axis.b == a;
    const Vec3 own = c.world.pose(axis.a).q * axis.axis_A;
    if ((!forward && !backward) || own.cross(axis_W).norm() > 1e-9) continue;
    const double along = own.dot(axis_W) > 0 ? 1 : -1;
    FreeAxis found = axis;
    found.axis_A = along * axis.axis_A;
    found.start = 0;
    if (forward) return {found, along};
    // Torque on b about the axis is torque on the joint's A: the coupling sees the pair the other way round.
    found.a = a, found.b = b;
    found.axis_A = c.world.pose(a).q.conjugate() * axis_W;
    return {found, -along};
  }
  fail_with("axis of " + c.world.name(b), "there is no hinge about it", axis_W);
}

/// Σ coef θ = const over any number of wheels.
class LinearCoupling final : public AxisCoupling {
 public:
  LinearCoupling(const World& world, const Terms& terms) : AxisCoupling(world, "coupling", terms) {}
  std::string_view type() const override { return "coupling"; }
};

void add_gear(Case& out, const std::string& name, const Json& joint) {
  Coupling coupling;
  AxisCoupling::Terms terms;
  for (const Json& term : joint.at("terms")) {
    const BodyId body = find_body(out.world, term.at("body"));
    const Sensed hinge = hinge_about(out, kGround, body, vector_of(term, "axis"));
    coupling.terms.push_back({hinge.axis, term.at("coef")});
    terms.emplace_back(hinge.axis.id, coupling.terms.back().coef * hinge.sense);
  }
  out.world.add(name, LinearCoupling(out.world, terms));
  out.couplings[name] = std::move(coupling);
}

void add_driver(Case& out, const std::string& name, const Json& joint) {
  const Sensed hinge = hinge_about(out, find_body(out.world, joint.at("a")),
                                   find_body(out.world, joint.at("b")), vector_of(joint, "axis"));
  const AxisId axis = hinge.axis.id;
  const double rate = joint.at("rate").get<double>() * hinge.sense;
  out.world.add(name, Driver(out.world, axis, linear_motion(out.world.axis_value(axis), rate)));
  out.couplings[name] = {{{hinge.axis, 1}}};
}

/// Angles of limits count from t = 0, displacements from the anchor of the joint unless they are relative.
void add_limits(Case& out, const FreeAxis& axis, const Json& limits) {
  AxisLimits bounds{.restitution = limits.value("restitution", 0.0)};
  for (const auto& [key, value] : limits.items()) {
    if (key == "lower") bounds.lower = value.get<double>() - axis.start;
    if (key == "upper") bounds.upper = value.get<double>() - axis.start;
    if (key == "lower_relative_to_start") bounds.lower = value;
    if (key == "upper_relative_to_start") bounds.upper = value;
  }
  if (bounds.lower == -kUnlimited && bounds.upper == kUnlimited)
    fail("limits of " + out.world.axis_label(axis.id), "are in no known form", limits.dump());
  out.world.set_limits(axis.id, bounds);
}

/// Notes the free axis of a joint that has just been added.
void note_axis(Case& out, const Json& joint) {
  const std::string name = joint.at("name");
  const JointId id = out.world.joint(name);
  const BodyId a = out.world.joint(id).a(), b = out.world.joint(id).b();
  const Vec3 direction = vector_of(joint, "axis").normalized();
  FreeAxis axis{out.world.axis(id, joint.at("type") == "slider" ? "displacement" : "angle"), a, b,
                out.world.pose(a).q.conjugate() * direction, 0};
  if (joint.at("type") == "slider")
    axis.start = direction.dot(out.world.pose(b).p - vector_of(joint, "anchor"));
  out.axes[name] = axis;
  if (joint.contains("limits") && !joint.at("limits").is_null()) add_limits(out, axis, joint.at("limits"));
}

bool has_axis(const std::string& type) {
  return type == "hinge" || type == "slider" || type == "cylindrical";
}

/// A joint of two bodies by its type.
void add_typed(Case& out, const Json& joint, BodyId a, BodyId b) {
  World& world = out.world;
  const std::string name = joint.at("name"), type = joint.at("type");
  if (type == "distance") {
    const Anchors& at = out.anchors.at(name);
    world.add(name, Distance(a, b, at.p_AP, at.p_BQ, joint.at("length").get<double>()));
    return;
  }
  const Vec3 p = vector_of(joint, "anchor");
  const auto direction = [&](const char* key) { return Vec3(vector_of(joint, key).normalized()); };
  if (type == "ball")
    world.add(name, Ball::at(world, a, b, p));
  else if (type == "hinge")
    world.add(name, Hinge::at(world, a, b, p, direction("axis")));
  else if (type == "slider")
    world.add(name, Slider::at(world, a, b, p, direction("axis")));
  else if (type == "cylindrical")
    world.add(name, Cylindrical::at(world, a, b, p, direction("axis")));
  else if (type == "universal")
    world.add(name, Universal::at(world, a, b, p, direction("axis_a"), direction("axis_b")));
  else if (type == "fixed")
    world.add(name, Fixed::at(world, a, b, p));
  else
    fail("joint " + name, "of unknown type", type);
}

}  // namespace

void add_joint(Case& out, const Json& joint) {
  const std::string name = joint.at("name"), type = joint.at("type");
  if (type == "gear" || type == "differential") return add_gear(out, name, joint);
  if (type == "driven_hinge_rate") return add_driver(out, name, joint);
  if (joint.contains("limits") && !joint.at("limits").is_null() && !has_axis(type))
    fail("joint " + name, "limits need a free axis", type);
  const World& world = out.world;
  const BodyId a = find_body(world, joint.at("a")), b = find_body(world, joint.at("b"));
  const bool two_points = type == "distance";
  out.anchors[name] = {a, b, world.pose(a).local(vector_of(joint, two_points ? "anchor_a" : "anchor")),
                       world.pose(b).local(vector_of(joint, two_points ? "anchor_b" : "anchor"))};
  add_typed(out, joint, a, b);
  if (has_axis(type)) note_axis(out, joint);
}

/// p(t) = p(0) with `harmonic` along a direction, as the world's end of a joint.
Json with_driven_anchor(Case& out, Json joint, const Json& driver) {
  const Json& h = driver.at("harmonic");
  const char* anchor = joint.contains("anchor_a") ? "anchor_a" : "anchor";
  if (driver.at("side") != "a" || joint.at("a") != "world")
    fail("driver of " + driver.at("joint").get<std::string>(), "must move the world's end", driver.dump());
  const Vec3 from = vector_of(joint, anchor), along = vector_of(h, "direction");
  const Motion motion =
      harmonic_motion(h.value("offset", 0.0), h.at("amplitude"), h.at("omega"), h.value("phase", 0.0));
  const std::string name = joint.at("name").get<std::string>() + ".anchor";
  const BodyId carrier = add_carrier(out, name, [=](double t) {
    const MotionPoint m = motion(t);
    PosePoint point;
    point.pose.p = from + m.value * along;
    point.velocity.v = m.rate * along;
    point.acceleration.v = m.acceleration * along;
    return point;
  });
  joint["a"] = name;
  for (int i = 0; i < 3; ++i) joint[anchor][i] = out.world.pose(carrier).p[i];
  return joint;
}

}  // namespace taut::reference
