#include <algorithm>

#include "scenes/accuracy/reference_builder.h"

/// Shapes and contacts of a reference case.
namespace taut::reference {
namespace {

using Json = nlohmann::json;

/// Rotation that takes the z axis, which shapes of revolution have, to a direction.
Quat from_z_to(const Vec3& direction) { return rotation_between(Vec3::UnitZ(), direction).normalized(); }

Quat axis_rotation(const Json& shape) {
  const std::string axis = shape.value("axis", "z");
  if (axis == "x") return from_z_to(Vec3::UnitX());
  if (axis == "y") return from_z_to(Vec3::UnitY());
  if (axis == "z") return Quat::Identity();
  fail("shape", "its axis must be x, y or z", axis);
}

/// Where the middle of the shape is on the body, in body axes.
Vec3 centre_of(const Json& shape, const Pose& body) {
  for (const char* key : {"centre_world_at_t0", "centre"})
    if (shape.contains(key)) return body.local(vector_of(shape, key));
  return Vec3::Zero();
}

ConvexHull hull_of(const Json& shape, const Pose& body) {
  ConvexHull hull;
  const bool world = shape.contains("vertices_world");
  for (const Json& v : shape.at(world ? "vertices_world" : "vertices")) {
    const Vec3 p(v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>());
    hull.points.push_back(world ? body.local(p) : p);
  }
  return hull;
}

/// Adds the shapes of one body, which is in its pose at t = 0.
void add_shapes(World& world, BodyId id, const Json& shape, std::vector<ShapeId>& added) {
  const std::string type = shape.at("type");
  const Pose& body = world.pose(id);
  const auto add = [&](Shape what, const Quat& q, const Vec3& p) {
    added.push_back(world.add_shape(id, std::move(what), Pose{q, p}));
  };
  if (type == "sphere") {
    add(Sphere{shape.at("radius")}, Quat::Identity(), centre_of(shape, body));
  } else if (type == "box") {
    add(Box{vector_of(shape, "size")}, Quat::Identity(), centre_of(shape, body));
  } else if (type == "cylinder") {
    add(Cylinder{shape.at("radius"), shape.at("length")}, axis_rotation(shape), centre_of(shape, body));
  } else if (type == "capsule") {
    add(Capsule{shape.at("radius"), shape.at("segment_length")}, axis_rotation(shape),
        centre_of(shape, body));
  } else if (type == "convex") {
    add(hull_of(shape, body), Quat::Identity(), Vec3::Zero());
  } else if (type == "plane") {
    const Vec3 n = vector_of(shape, "normal").normalized();
    const Quat q = body.q.conjugate() * from_z_to(n);
    add(HalfSpace{}, q.normalized(), body.local(shape.at("offset").get<double>() * n));
  } else if (type == "compound") {
    for (const Json& child : shape.at("children")) add_shapes(world, id, child, added);
  } else {
    fail("shape of " + world.name(id), "of unknown type", type);
  }
}

/// A part of the world: fixed, or carried along at a constant velocity and angular velocity about its
/// position.
BodyId add_static_body(Case& out, const Json& body) {
  const auto vector = [&](const char* key) {
    return body.contains(key) && !body.at(key).is_null() ? vector_of(body, key) : Vec3(Vec3::Zero());
  };
  Pose start{Quat::Identity(), vector("position")};
  if (body.contains("orientation")) {
    const Json& q = body.at("orientation");
    start.q = Quat(q.at(0).get<double>(), q.at(1), q.at(2), q.at(3)).normalized();
  }
  const Vec3 v = vector("velocity") + vector("surface_velocity"), w = vector("angular_velocity");
  const std::string name = body_name(body.at("name"));
  if (v.isZero(0) && w.isZero(0)) {
    BodySpec spec{.name = name};
    spec.fixed = true;
    spec.pose = start;
    return out.world.add_body(spec);
  }
  return add_carrier(out, name, [=](double t) {
    PosePoint point;
    point.pose = {(exp_so3(w * t) * start.q).normalized(), start.p + t * v};
    point.velocity = {w, v};
    return point;
  });
}

Material material_of(Case& out, const Json& contact) {
  Material material;
  material.restitution = contact.value("restitution", 0.0);
  material.dynamic_friction = contact.at("mu_kinetic");
  material.static_friction = std::max(material.dynamic_friction, contact.at("mu_static").get<double>());
  const auto turning = [&](const char* key, const char* law, double& coulomb, double& linear) {
    const std::string is = contact.value(law, "coulomb");
    if (is == "coulomb" || is == "linear")
      (is == "linear" ? linear : coulomb) = contact.value(key, 0.0);
    else
      out.missing.push_back(std::string(law) + " \"" + is + '"');
  };
  turning("mu_roll", "rolling_law", material.rolling_friction, material.rolling_friction_linear);
  turning("mu_spin", "spinning_law", material.spinning_friction, material.spinning_friction_linear);
  return material;
}

}  // namespace

void add_contacts(Case& out, const Json& setup) {
  World& world = out.world;
  std::map<std::string, Json> shape_of;
  for (const Json& body : list_of(setup, "bodies"))
    if (body.contains("shape")) shape_of[body.at("name")] = body.at("shape");
  for (const Json& body : list_of(setup, "static_bodies")) {
    add_static_body(out, body);
    shape_of[body.at("name")] = body.at("shape");
  }
  const Json contacts = list_of(setup, "contacts");
  for (int a = 0; a < world.body_count() && !contacts.empty(); ++a)
    for (int b = 0; b < a; ++b) world.set_collision(BodyId{a}, BodyId{b}, false);

  std::map<std::string, std::vector<ShapeId>> shapes;
  const auto shapes_on = [&](const std::string& name) -> const std::vector<ShapeId>& {
    const auto [found, fresh] = shapes.try_emplace(name);
    if (fresh) add_shapes(world, find_body(world, name), shape_of.at(name), found->second);
    return found->second;
  };
  for (const Json& contact : contacts) {
    const std::string a = contact.at("a"), b = contact.at("b");
    out.pairs.push_back({a, b, find_body(world, a), find_body(world, b)});
    world.set_collision(out.pairs.back().body_a, out.pairs.back().body_b, true);
    const Material material = material_of(out, contact);
    for (ShapeId on_a : shapes_on(a))
      for (ShapeId on_b : shapes_on(b)) world.set_contact_material(on_a, on_b, material);
  }
}

}  // namespace taut::reference
