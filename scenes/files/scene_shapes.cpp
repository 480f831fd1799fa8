#include "scenes/files/scene_reader.h"
#include "scenes/files/shape_reader.h"

// Collision shapes, materials and pairs of bodies in a scene file.
namespace taut {
namespace {

constexpr int kGroups = 32;

/// A list of numbers of collision groups as bits.
std::uint32_t read_groups(JsonObject& keys, const char* key, std::uint32_t fallback) {
  const auto node = keys.find(key);
  if (!node) return fallback;
  std::uint32_t bits = 0;
  for (const JsonNode& item : node->items("an array of groups")) {
    const double group = item.json().is_number() ? item.json().get<double>() : -1;
    if (group >= 0 && group < kGroups && group == std::floor(group))
      bits |= std::uint32_t{1} << static_cast<int>(group);
    else
      item.problem("must be a whole number from 0 to 31");
  }
  return bits;
}

}  // namespace

void SceneReader::read_materials(const JsonNode& node) {
  for (const auto& [name, material] : node.members()) {
    const Material read = read_material(material);
    material.guard([&, &name = name] { scene_.world.add_material(name, read); });
  }
}

Material SceneReader::material_of(const JsonNode& node) const {
  if (node.json().is_object()) return read_material(node);
  if (!node.json().is_string()) {
    node.problem("must be the name of a material, or a material");
    return {};
  }
  const MaterialId named = named_material(node);
  return named.index < 0 ? Material{} : scene_.world.material(named);
}

MaterialId SceneReader::named_material(const JsonNode& node) const {
  const std::string name = node.string();
  if (!node.json().is_string()) return {};
  std::vector<std::string> names;
  for (int m = 0; m < scene_.world.material_count(); ++m) {
    names.push_back(scene_.world.name(MaterialId{m}));
    if (names.back() == name) return {m};
  }
  if (may_be_generated(name)) return {};
  node.problem("there is no material of this name" + did_you_mean(name, names));
  return {};
}

/// What holds between two named materials in place of combined().
void SceneReader::read_material_pair(const JsonNode& node) {
  const std::size_t before = problems_.size();
  JsonObject pair(node);
  const auto a = pair.required("a"), b = pair.required("b"), between = pair.required("material");
  const MaterialId first = a ? named_material(*a) : MaterialId{},
                   second = b ? named_material(*b) : MaterialId{};
  const Material material = between ? material_of(*between) : Material{};
  pair.reject_unknown_keys();
  if (problems_.size() != before || first.index < 0 || second.index < 0) return;
  if (!material_pairs_.insert(std::minmax(first, second)).second)
    return node.problem("these two materials are there already");
  scene_.world.set_contact_material(first, second, material);
}

std::vector<FileShape> SceneReader::read_shapes(const JsonNode& list) const {
  std::vector<FileShape> shapes;
  for (const JsonNode& item : list.items("an array of shapes"))
    if (auto shape = read_shape_of_body(item)) shapes.push_back(std::move(*shape));
  return shapes;
}

std::optional<FileShape> SceneReader::read_shape_of_body(const JsonNode& node) const {
  const std::size_t before = problems_.size();
  JsonObject keys(node);
  const std::optional<PlacedShape> shape = read_shape(keys, &folder_);
  FileShape result{node, shape.value_or(PlacedShape{}), keys.find("density"), {}, {}, {}};
  Pose pose;
  pose.p = keys.get("position", &JsonNode::vector, pose.p);
  if (const auto orientation = keys.find("orientation")) pose.q = read_orientation(*orientation);
  result.placed.pose = {(pose.q * result.placed.pose.q).normalized(), pose.point(result.placed.pose.p)};
  if (result.density) result.placed.density = result.density->positive();
  read_surface(keys, result);
  keys.reject_unknown_keys();
  if (problems_.size() != before) return {};
  return result;
}

void SceneReader::read_surface(JsonObject& keys, FileShape& shape) const {
  const std::size_t before = problems_.size();
  if (const auto material = keys.find("material")) {
    shape.material = material_of(*material);
    if (material->json().is_string() && problems_.size() == before) shape.named = named_material(*material);
  }
  shape.filter.groups = read_groups(keys, "groups", shape.filter.groups);
  shape.filter.mask = read_groups(keys, "collides_with", shape.filter.mask);
}

void SceneReader::add_shapes(BodyId body, const std::vector<FileShape>& shapes, const Vec3& centre) {
  for (const FileShape& shape : shapes)
    shape.node.guard([&] {
      const Pose X_BS{shape.placed.pose.q, shape.placed.pose.p - centre};
      const ShapeId id = scene_.world.add_shape(body, shape.placed.shape, X_BS, shape.material, shape.filter);
      if (shape.named.index >= 0) scene_.world.set_material(id, shape.named);
    });
}

void SceneReader::read_ground(const JsonNode& node) {
  JsonObject ground(node);
  if (const auto list = ground.find("shapes")) {
    const std::vector<FileShape> shapes = read_shapes(*list);
    for (const FileShape& shape : shapes)
      if (shape.density) shape.density->problem("has no effect on the ground");
    add_shapes(kGround, shapes, Vec3::Zero());
  }
  ground.reject_unknown_keys();
}

std::vector<ShapeId> SceneReader::shapes_of_pair(JsonObject& pair, const char* body_key,
                                                 const char* shape_key) const {
  const BodyReference body = required_body(pair, body_key);
  const auto index = pair.find(shape_key);
  const auto material = pair.find("material");
  if (index && !material) index->problem("needs a \"material\"");
  if (!body.shaped || !material) return {};
  std::vector<ShapeId> all;
  for (int s = 0; s < scene_.world.shape_count(); ++s)
    if (scene_.world.shape(ShapeId{s}).body == body.id) all.push_back({s});
  if (all.empty()) pair.find(body_key)->problem("has no shapes");
  if (!index || all.empty()) return all;
  const double number = index->json().is_number() ? index->json().get<double>() : -1;
  if (number >= 0 && number < static_cast<double>(all.size()) && number == std::floor(number))
    return {all[static_cast<std::size_t>(number)]};
  index->problem("must be the index of one of the " + std::to_string(all.size()) + " shapes, from 0");
  return {};
}

void SceneReader::read_pair(const JsonNode& node) {
  const std::size_t before = problems_.size();
  JsonObject pair(node);
  const std::vector<ShapeId> on_a = shapes_of_pair(pair, "a", "shape_a");
  const std::vector<ShapeId> on_b = shapes_of_pair(pair, "b", "shape_b");
  const auto collide = pair.find("collide"), material_node = pair.find("material");
  const bool may_collide = !collide || collide->boolean();
  const Material material = material_node ? material_of(*material_node) : Material{};
  if (!collide && !material_node) pair.one_of({"collide", "material"});
  pair.reject_unknown_keys();
  if (problems_.size() != before) return;
  const BodyReference a = required_body(pair, "a"), b = required_body(pair, "b");
  if (!a.found || !b.found) return;
  if (a.id == b.id) return pair.find("b")->problem("is the same body as \"a\"");
  if (collide) scene_.world.set_collision(a.id, b.id, may_collide);
  for (ShapeId first : on_a)
    for (ShapeId second : on_b) scene_.world.set_contact_material(first, second, material);
}

}  // namespace taut
