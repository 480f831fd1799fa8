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

void add_joint(Case& out, const Json& joint) {
  World& world = out.world;
  const std::string name = joint.at("name"), type = joint.at("type");
  if (joint.contains("limits")) fail("joint " + name, "limits are not supported", type);
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
  for (const char* key : {"drivers", "contacts", "static_bodies"})
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
  for (const Json& joint : list_of(setup, "joints")) add_joint(out, joint);
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
