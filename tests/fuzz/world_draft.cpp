#include "tests/fuzz/world_draft.h"

#include <cmath>
#include <numbers>

namespace taut::fuzz {
namespace {

Json quaternion_of(const Quat& q) { return json_of(q); }

/// Of a shape without one of its own, of a body like it.
MassProperties mass_of(const Json& shape, double density) {
  const std::string type = shape["type"];
  const auto number = [&](const char* key) { return shape[key].get<double>(); };
  const auto vector = [&](const char* key) {
    return Vec3(shape[key][0].get<double>(), shape[key][1].get<double>(), shape[key][2].get<double>());
  };
  if (type == "box") return MassProperties::box(vector("size"), Density{density});
  if (type == "sphere") return MassProperties::sphere(number("radius"), Density{density});
  if (type == "ellipsoid") return MassProperties::ellipsoid(vector("radii"), Density{density});
  if (type == "capsule") return MassProperties::capsule(number("radius"), number("length"), Density{density});
  if (type == "cylinder")
    return MassProperties::cylinder(number("radius"), number("length"), Density{density});
  if (type == "cone") return MassProperties::cone(number("radius"), number("height"), Density{density});
  return MassProperties::sphere(0.8 * shape["reach"].get<double>(), Density{density});  // hulls and meshes
}

}  // namespace

WorldDraft::WorldDraft(std::uint64_t seed) : random(seed) {
  scene = {{"format", "taut-scene/1"}, {"name", "world " + std::to_string(seed)}, {"gravity", {0, 0, -9.81}},
           {"duration", 1.0},          {"ground", {{"shapes", Json::array()}}},   {"bodies", Json::array()},
           {"joints", Json::array()}};
  scene["dt"] = random.of<double>({1.0 / 60, 1.0 / 120, 1.0 / 240, 1.0 / 240, 1.0 / 480, 1e-3});
  scene["settings"] = settings();
  size = random.chance(0.7) ? 1 : random.decades(-1, 1);
  density = random.of<double>({100, 1000, 1000, 7800});
  friction_ = random.chance(0.15) ? 0 : random.uniform(0.05, 1.2);
  restitution_ = random.chance(0.25) ? random.uniform(0, 1) : 0;
  compliance_ = !moreau && random.chance(0.15) ? random.decades(-9, -6) : 0;
  ground_material_ = material();
}

/// Mostly as they come.
Json WorldDraft::settings() {
  Json its = Json::object();
  const double kind = random.uniform(0, 1);
  if (kind < 0.12)
    its["integrator"] = "moreau-jean", moreau = true;
  else if (kind < 0.2)
    its["tension"] = "implicit";
  else if (kind < 0.27)
    its["sleep"] = true;
  return its;
}

Json WorldDraft::material() {
  Json its = {{"static_friction", friction_}};
  if (random.chance(0.2)) its["dynamic_friction"] = friction_ * random.uniform(0.3, 1);
  if (restitution_ > 0) its["restitution"] = restitution_;
  if (compliance_ > 0) its["compliance"] = compliance_;
  if (random.chance(0.1)) its["rolling_friction"] = size * random.decades(-4, -2);
  if (random.chance(0.05)) its["spinning_friction"] = size * random.decades(-4, -2);
  return its;
}

Json WorldDraft::solid(double radius) {
  const auto about = [&] { return radius * random.uniform(0.6, 1.2); };
  switch (random.below(9)) {
    case 0:
    case 1:
      return box(Vec3(about(), about(), about()) * 1.6);
    case 2:
      return capsule(0.5 * about(), about());
    case 3:
      return {{"type", "cylinder"},
              {"radius", about()},
              {"length", random.chance(0.3) ? 0.3 * about() : about()}};
    case 4:
      return {{"type", "ellipsoid"}, {"radii", {about(), about(), about()}}};
    case 5:
      return {{"type", "cone"}, {"radius", about()}, {"height", 1.5 * about()}};
    case 6: {
      Json points = Json::array();
      for (int i = 0; i < 8; ++i) points.push_back(json_of(Vec3(radius * random.direction())));
      return {{"type", "convex_hull"}, {"points", points}, {"reach", radius}};
    }
    case 7: {
      const double r = radius;
      const Json corners = {json_of(Vec3(0, 0, r)), json_of(Vec3(r, 0, -r / 2)),
                            json_of(Vec3(-r / 2, 0.8 * r, -r / 2)), json_of(Vec3(-r / 2, -0.8 * r, -r / 2))};
      return {{"type", "triangle_mesh"},
              {"vertices", corners},
              {"triangles", {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}},
              {"reach", r}};
    }
    default:
      return ball(about());
  }
}

std::string WorldDraft::add_body(Json shape, const Pose& pose, double its_density) {
  const std::string name = "b" + std::to_string(scene["bodies"].size());
  const MassProperties mass = mass_of(shape, its_density);
  shape.erase("reach");
  shape["material"] = material();
  scene["bodies"].push_back({{"name", name},
                             {"mass", mass.mass()},
                             {"inertia", json_of(Vec3(mass.inertia_B().diagonal()))},
                             {"position", json_of(pose.p)},
                             {"orientation", quaternion_of(pose.q)},
                             {"shapes", {shape}}});
  return name;
}

void WorldDraft::set_velocity(const Vec3& v, const Vec3& w) {
  Json& body = scene["bodies"].back();
  body["velocity"] = json_of(v), body["angular_velocity"] = json_of(w);
}

void WorldDraft::set_groups(const Json& groups, const Json& collides_with) {
  Json& shape = scene["bodies"].back()["shapes"][0];
  shape["groups"] = groups, shape["collides_with"] = collides_with;
}

Json& WorldDraft::add_joint(const std::string& type, const std::string& a, const std::string& b,
                            const Vec3& anchor) {
  Json& joints = scene["joints"];
  joints.push_back({{"name", "j" + std::to_string(joints.size())},
                    {"type", type},
                    {"a", a},
                    {"b", b},
                    {"anchor", json_of(anchor)}});
  return joints.back();
}

void WorldDraft::add_ground(const Json& shape, const Pose& pose) {
  Json its = shape;
  its["material"] = ground_material_;
  its["position"] = json_of(pose.p), its["orientation"] = quaternion_of(pose.q);
  scene["ground"]["shapes"].push_back(its);
}

void WorldDraft::add_floor(double half) {
  const double kind = random.uniform(0, 1);
  if (kind < 0.2) {  // uneven
    constexpr int kPoints = 8;
    Json heights = Json::array();
    for (int i = 0; i < kPoints * kPoints; ++i) heights.push_back(-0.2 * size * random.uniform(0, 1));
    const double d = 12 * half / (kPoints - 1);  // nobody comes to its edge
    add_ground({{"type", "height_field"},
                {"nx", kPoints},
                {"ny", kPoints},
                {"dx", d},
                {"dy", d},
                {"heights", heights}});
    return;
  }
  add_ground({{"type", "half_space"}});
  if (kind < 0.5) return;
  if (kind < 0.7) return add_pegs(half);
  if (kind < 0.85) {  // walls, some of them leaning
    for (int side = 0; side < 4; ++side) {
      const double angle = side * std::numbers::pi / 2;
      const Quat turn = exp_so3(Vec3(0, 0, angle)) * exp_so3(Vec3(0, random.uniform(0, 0.8), 0));
      add_ground(box(Vec3(0.2, 4 * half, 4 * half)),
                 {turn, exp_so3(Vec3(0, 0, angle)) * Vec3(half + 0.1, 0, 0)});
    }
    return;
  }
  // Steps down, or a wedge.
  for (int k = 0; k < 3; ++k)
    add_ground(box(Vec3(half, 4 * half, 0.2 * size * (k + 1))), {Quat::Identity(), Vec3(-half * k, 0, 0)});
}

void WorldDraft::add_pegs(double half) {
  const int count = 1 + random.below(5);
  for (int k = 0; k < count; ++k) {
    const Vec3 at(random.uniform(-half, half), random.uniform(-half, half), size * random.uniform(0.05, 0.4));
    const double r = size * random.uniform(0.05, 0.25);
    const int type = random.below(3);
    const Json shape = type == 0 ? ball(r) : type == 1 ? capsule(0.4 * r, 3 * half) : box(Vec3(r, r, 2 * r));
    const Quat lying = exp_so3(Vec3(0, std::numbers::pi / 2, 0));
    add_ground(shape,
               {type == 1 ? Quat(exp_so3(Vec3(0, 0, random.uniform(0, 3))) * lying) : random.rotation(), at});
  }
}

}  // namespace taut::fuzz
