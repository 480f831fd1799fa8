#include "scenes/files/pair_keys.h"

namespace taut {
namespace {

/// Force types: a new one adds its entry here.  The World does not check what acts on a missing body, so the
/// reader's problems are asked first.
using ForceReader = std::shared_ptr<const Force> (*)(const SceneReader& reader, JsonObject& force);

/// "factor": a function of time; none if it is not given.
Motion read_factor(JsonObject& keys) {
  const auto factor = keys.find("factor");
  return factor ? read_motion(*factor, false) : Motion();
}

std::shared_ptr<const Force> read_point_force(const SceneReader& reader, JsonObject& force) {
  const BodyReference body = reader.required_body(force, "body");
  const Vec3 p_BP = force.get("point", &JsonNode::vector, body.centre) - body.centre;
  const Vec3 f = force.get_required("force", &JsonNode::vector, Vec3(Vec3::Zero()));
  const bool follows = force.get("follows_body", &JsonNode::boolean, false);
  return std::make_shared<PointForce>(body.id, p_BP, f, follows, read_factor(force));
}

std::shared_ptr<const Force> read_torque(const SceneReader& reader, JsonObject& force) {
  const BodyId body = reader.required_body(force, "body").id;
  const Vec3 torque = force.get_required("torque", &JsonNode::vector, Vec3(Vec3::Zero()));
  const bool follows = force.get("follows_body", &JsonNode::boolean, false);
  return std::make_shared<BodyTorque>(body, torque, follows, read_factor(force));
}

/// On the bodies of the list, or on all that move.
std::shared_ptr<const Force> read_acceleration(const SceneReader& reader, JsonObject& force) {
  const World& world = reader.world();
  const Vec3 acceleration = force.get_required("acceleration", &JsonNode::vector, Vec3(Vec3::Zero()));
  std::vector<FieldMass> masses;
  const auto list = force.find("bodies");
  const auto add = [&](BodyId body) {
    if (!world.is_fixed(body)) masses.push_back({body, world.mass_properties(body).mass()});
  };
  for (int b = 0; b < world.body_count() && !list; ++b) add({b});
  for (const JsonNode& item : list ? list->items("an array of names") : std::vector<JsonNode>())
    if (const BodyReference body = reader.find_body(item); body.found) add(body.id);
  return std::make_shared<AccelerationField>(std::move(masses), acceleration, read_factor(force));
}

std::shared_ptr<const Force> read_spring_damper(const SceneReader& reader, JsonObject& force) {
  PairKeys keys(reader, force);
  const auto p = keys.two_points();
  AxisSpring law;
  law.table = read_curve(force, "table");
  law.damping_table = read_curve(force, "damping_table");
  if (!force.find("table") || force.find("stiffness"))
    law.stiffness = force.get_required("stiffness", &JsonNode::not_negative, 0.0);
  law.rest = keys.length("rest_length", p, &JsonNode::not_negative);
  law.damping = force.get("damping", &JsonNode::not_negative, 0.0);
  return std::make_shared<SpringDamper>(keys.a.id, keys.b.id, p.a, p.b, std::move(law));
}

constexpr std::pair<const char*, ForceReader> kForceTypes[] = {
    {"point-force", read_point_force},
    {"torque", read_torque},
    {"acceleration", read_acceleration},
    {"spring-damper", read_spring_damper},
};

}  // namespace

void SceneReader::read_force(const JsonNode& node) {
  const std::size_t before = problems_.size();
  JsonObject force(node);
  const auto type = force.required("type");
  if (!type) return;
  const auto known_type = type->choice_or_meant(kForceTypes);
  if (!known_type) return;
  const ForceReader read_type = *known_type;
  std::shared_ptr<const Force> made;
  knows_all_ = true;
  guard_item(node, before, [&] { made = read_type(*this, force); });
  force.reject_unknown_keys();
  if (made && problems_.size() == before) node.guard([&] { scene_.world.add_force(made); });
}

}  // namespace taut
