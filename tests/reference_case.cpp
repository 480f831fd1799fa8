#include "tests/reference_case.h"

#include <algorithm>
#include <fstream>

#include "core/joints.h"

namespace taut::reference {
namespace {

using Json = nlohmann::json;

Quat quaternion_of(const Json& object, const char* key) {
  const Json& q = object.at(key);
  return Quat(q.at(0).get<double>(), q.at(1).get<double>(), q.at(2).get<double>(), q.at(3).get<double>())
      .normalized();
}

MassProperties mass_of(const Json& body) {
  const double mass = body.at("mass");
  const Json& inertia = body.at("inertia");
  if (inertia.at(0).is_number()) return {mass, vector_of(body, "inertia")};
  Mat3 I;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) I(i, j) = inertia.at(i).at(j);
  return {mass, I};
}

void add_body(Case& out, const Json& body) {
  BodySpec spec{.name = body.at("name"), .mass = mass_of(body)};
  spec.pose = {quaternion_of(body, "orientation"), vector_of(body, "position")};
  spec.twist = {vector_of(body, "angular_velocity"), vector_of(body, "velocity")};
  out.world.add_body(spec);
}

/// The hinge of B against A about an axis, which may point either way.
FreeAxis hinge_about(const Case& c, BodyId a, BodyId b, const Vec3& axis_W) {
  const Vec3 axis_A = c.world.pose(a).q.conjugate() * axis_W;
  for (const auto& [name, axis] : c.axes)
    if (axis.a == a && axis.b == b && c.world.joint(axis.id.joint).type() == "hinge" &&
        axis.axis_A.cross(axis_A).norm() < 1e-9)
      return {axis.id, a, b, axis_A, 0};
  fail("axis of " + c.world.name(b), "there is no hinge about it", axis_W.transpose());
}

/// +1 if the axis points along that of its joint, −1 if against it.
double sense(const Case& c, const FreeAxis& axis) {
  for (const auto& [name, other] : c.axes)
    if (other.id == axis.id) return other.axis_A.dot(axis.axis_A) > 0 ? 1 : -1;
  return 0;
}

/// Σ coef θ = const over two or three wheels as a Gear or a Differential.
void add_gear(Case& out, const std::string& name, const Json& joint) {
  Coupling coupling;
  std::vector<double> factors;
  for (const Json& term : joint.at("terms")) {
    const BodyId body = find_body(out.world, term.at("body"));
    coupling.terms.push_back({hinge_about(out, kGround, body, vector_of(term, "axis")), term.at("coef")});
    factors.push_back(coupling.terms.back().coef * sense(out, coupling.terms.back().hinge));
  }
  const auto axis = [&](int i) { return coupling.terms.at(i).hinge.id; };
  if (joint.at("type") == "gear" && factors.size() == 2)
    out.world.add(name, Gear(out.world, axis(0), axis(1), -factors[0] / factors[1]));
  else if (factors.size() == 3 && factors[0] == -2 * factors[1] && factors[1] == factors[2])
    out.world.add(name, Differential(out.world, axis(0), axis(1), axis(2)));
  else
    fail("joint " + name, "has terms that are not supported", joint.at("terms").dump());
  out.couplings[name] = std::move(coupling);
}

void add_driver(Case& out, const std::string& name, const Json& joint) {
  const FreeAxis hinge = hinge_about(out, find_body(out.world, joint.at("a")),
                                     find_body(out.world, joint.at("b")), vector_of(joint, "axis"));
  const double rate = joint.at("rate").get<double>() * sense(out, hinge);
  out.world.add(name, Driver(out.world, hinge.id, linear_motion(out.world.axis_value(hinge.id), rate)));
  out.couplings[name] = {{{hinge, 1}}};
}

/// Angles of limits count from t = 0, displacements from the anchor of the joint.
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

/// Notes the free axis of a hinge or slider that has just been added.
void note_axis(Case& out, const Json& joint) {
  const std::string name = joint.at("name");
  const JointId id = out.world.joint(name);
  const BodyId a = out.world.joint(id).a(), b = out.world.joint(id).b();
  const Vec3 direction = vector_of(joint, "axis");
  FreeAxis axis{out.world.axis(id, joint.at("type") == "hinge" ? "angle" : "displacement"), a, b,
                out.world.pose(a).q.conjugate() * direction, 0};
  if (joint.at("type") == "slider")
    axis.start = direction.dot(out.world.pose(b).p - vector_of(joint, "anchor"));
  out.axes[name] = axis;
  if (joint.contains("limits")) add_limits(out, axis, joint.at("limits"));
}

void add_joint(Case& out, const Json& joint) {
  World& world = out.world;
  const std::string name = joint.at("name"), type = joint.at("type");
  if (type == "gear" || type == "differential") return add_gear(out, name, joint);
  if (type == "driven_hinge_rate") return add_driver(out, name, joint);
  const bool has_axis = type == "hinge" || type == "slider";
  if (joint.contains("limits") && !has_axis) fail("joint " + name, "limits are not supported", type);
  const BodyId a = find_body(world, joint.at("a")), b = find_body(world, joint.at("b"));
  const bool two_points = type == "distance";
  const Vec3 p_a = vector_of(joint, two_points ? "anchor_a" : "anchor");
  const Vec3 p_b = vector_of(joint, two_points ? "anchor_b" : "anchor");
  const Anchors& at =
      out.anchors.emplace(name, Anchors{a, b, world.pose(a).local(p_a), world.pose(b).local(p_b)})
          .first->second;
  if (type == "ball")
    world.add(name, Ball::at(world, a, b, p_a));
  else if (type == "hinge")
    world.add(name, Hinge::at(world, a, b, p_a, vector_of(joint, "axis")));
  else if (type == "slider")
    world.add(name, Slider::at(world, a, b, p_a, vector_of(joint, "axis")));
  else if (type == "universal")
    world.add(name, Universal::at(world, a, b, p_a, vector_of(joint, "axis_a"), vector_of(joint, "axis_b")));
  else if (type == "fixed")
    world.add(name, Fixed::at(world, a, b, p_a));
  else if (type == "distance")
    world.add(name, Distance(a, b, at.p_AP, at.p_BQ, joint.at("length").get<double>()));
  else
    fail("joint " + name, "of unknown type", type);
  if (has_axis) note_axis(out, joint);
}

/// p(t) = p(0) with `harmonic` along a direction, as the world's end of a joint: a body of 1 kg that is
/// driven along it takes the place of the world.  Energies and momenta of such a case include that body.
Json with_driven_anchor(Case& out, Json joint, const Json& driver) {
  const Json& h = driver.at("harmonic");
  const char* anchor = joint.contains("anchor_a") ? "anchor_a" : "anchor";
  if (driver.at("side") != "a" || joint.at("a") != "world")
    fail("driver of " + driver.at("joint").get<std::string>(), "must move the world's end", driver.dump());
  const Vec3 from = vector_of(joint, anchor), along = vector_of(h, "direction");
  const Motion motion = harmonic_motion(h.at("offset"), h.at("amplitude"), h.at("omega"), h.at("phase"));
  const auto pose = [=](double t) {
    const MotionPoint m = motion(t);
    PosePoint point;
    point.pose.p = from + m.value * along;
    point.velocity.v = m.rate * along;
    point.acceleration.v = m.acceleration * along;
    return point;
  };
  BodySpec spec{.name = joint.at("name").get<std::string>() + ".anchor"};
  spec.pose = pose(0).pose;
  spec.twist = pose(0).velocity;
  const BodyId carrier = out.world.add_body(spec);
  out.world.add(spec.name, PoseDriver(kGround, carrier, pose));
  joint["a"] = spec.name;
  for (int i = 0; i < 3; ++i) joint[anchor][i] = spec.pose.p[i];
  return joint;
}

/// Friction, motor or spring of a free axis.  @returns false for another kind of force.
bool add_axis_force(Case& out, const Json& force) {
  if (!force.contains("joint")) return false;
  const std::string type = force.at("type");
  const FreeAxis& axis = out.axes.at(force.at("joint"));
  if (type == "hinge_coulomb" || type == "slider_coulomb") {
    const double most = force.at(type == "hinge_coulomb" ? "torque" : "force");
    out.world.set_friction(axis.id, AxisFriction{most, most, 0});
  } else if (type == "hinge_motor") {
    out.world.set_motor(axis.id,
                        AxisMotor{.target = force.at("target_speed"), .max_force = force.at("max_torque")});
  } else if (type == "joint_spring") {
    out.world.set_spring(
        axis.id, AxisSpring{.stiffness = force.at("k"), .rest = force.at("rest").get<double>() - axis.start});
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
                                 force.at("rest_length"), force.at("c")));
  } else if (type == "hinge_viscous") {
    const BodyId a = body("a"), b = body("b");
    world.add_force(
        viscous_hinge(a, b, world.pose(a).q.conjugate() * vector_of(force, "axis"), force.at("c")));
  } else {
    fail("force", "of unknown type", type);
  }
}

/// The straight hanging chain that its file describes by numbers only: rods along z on ball joints, a sphere
/// at the lower end.
void add_hanging_chain(Case& out, const Json& p) {
  const int n = p.at("N");
  const double length = p.at("rod_length"), section = p.at("section"), mass = p.at("rod_mass");
  BodyId last = kGround;
  for (int i = 1; i <= n + 1; ++i) {
    const bool end = i == n + 1;
    BodySpec spec;
    spec.name = end ? "sphere" : std::string("rod").append(std::to_string(i));
    spec.mass = end ? MassProperties::sphere(0.1, p.at("end_mass"))
                    : MassProperties::box(Vec3(section, section, length), mass);
    spec.pose.p = Vec3(0, 0, end ? -n * length : -(i - 0.5) * length);
    const BodyId body = out.world.add_body(spec);
    const Vec3 joint(0, 0, -(i - 1) * length);
    out.world.add(end ? "jend" : std::string("j").append(std::to_string(i)),
                  Ball::at(out.world, last, body, joint));
    last = body;
  }
}

Quantity quantity_of(const Json& json) {
  Quantity quantity;
  quantity.name = json.at("name");
  if (!json.at("time").is_null()) quantity.time = json.at("time").get<double>();
  const Json& value = json.at("value");
  if (value.is_array())
    quantity.value = value.get<std::vector<double>>();
  else
    quantity.value.push_back(value.get<double>());
  quantity.uncertainty = json.at("ref_uncertainty");
  quantity.tolerance = json.at("abs_tol");
  quantity.tolerance_limit = json.at("abs_tol_limit");
  if (json.contains("probe")) quantity.probe = json.at("probe");
  return quantity;
}

/// The list under a key, or none.
Json list_of(const Json& object, const char* key) { return object.value(key, Json::array()); }

}  // namespace

BodyId find_body(const World& world, const std::string& name) {
  return name == "world" ? kGround : world.body(name);
}

Vec3 vector_of(const Json& object, const char* key) {
  const Json& v = object.at(key);
  return {v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>()};
}

Case load_case(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) fail("reference case", "cannot be read", file.string());
  const Json json = Json::parse(stream);
  const Json& setup = json.at("setup");
  for (const char* key : {"contacts", "static_bodies"})
    if (setup.contains(key) && !setup.at(key).empty())
      fail("reference case " + file.string(), "unknown", key);

  Case out;
  out.id = json.at("id");
  out.level = json.at("level");
  out.dt = json.at("tol_dt");
  if (setup.contains("duration") && setup.at("duration").is_number()) out.duration = setup.at("duration");
  out.world.set_gravity(vector_of(setup, "gravity"));
  if (setup.contains("generator")) add_hanging_chain(out, setup.at("parameters"));
  for (const Json& body : list_of(setup, "bodies")) add_body(out, body);
  std::map<std::string, Json> drivers;
  for (const Json& driver : list_of(setup, "drivers")) drivers[driver.at("joint")] = driver;
  for (const Json& joint : list_of(setup, "joints")) {
    const auto driver = drivers.find(joint.at("name"));
    add_joint(out, driver == drivers.end() ? joint : with_driven_anchor(out, joint, driver->second));
  }
  for (const Json& force : list_of(setup, "forces")) add_force(out, force);
  for (const Json& impulse : list_of(setup, "impulses")) {
    const BodyId body = find_body(out.world, impulse.at("body"));
    out.impulses.push_back(
        {body, out.world.pose(body).local(vector_of(impulse, "point")), vector_of(impulse, "impulse")});
  }
  for (const Json& quantity : json.at("quantities")) out.quantities.push_back(quantity_of(quantity));
  return out;
}

std::vector<std::filesystem::path> case_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace taut::reference
