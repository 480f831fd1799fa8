#include <algorithm>
#include <utility>

#include "core/base/check.h"
#include "core/state/reach.h"
#include "core/world/world.h"

namespace taut {
namespace {

template <typename Id>
std::pair<Id, Id> ordered(Id a, Id b) {
  return a < b ? std::pair(a, b) : std::pair(b, a);
}

}  // namespace

int World::checked(ShapeId id) const {
  if (id.index < 0 || id.index >= shape_count()) fail("shape id", "no such shape", id.index);
  return id.index;
}

int World::checked(MaterialId id) const {
  if (id.index < 0 || id.index >= material_count()) fail("material id", "no such material", id.index);
  return id.index;
}

ShapeId World::add_shape(BodyId body, Shape shape, const Pose& pose, const Material& material,
                         CollisionFilter filter) {
  return add_shape(body, std::make_shared<const Shape>(std::move(shape)), pose, material, filter);
}

ShapeId World::add_shape(BodyId body, std::shared_ptr<const Shape> shape, const Pose& pose,
                         const Material& material, CollisionFilter filter) {
  identity_.require_free();
  const std::string owner = "shape of " + name(body);
  if (!shape) fail(owner, "must not be null", "null");
  check_shape(*shape);
  check_material(material);
  require_within_reach("position of " + owner, pose.p);
  require_unit("orientation of " + owner, pose.q.coeffs());
  Pose X_BS = pose;
  X_BS.q.normalize();
  shapes_.push_back({body, std::move(shape), X_BS, material, filter, {}, body});
  is_fixed(body) ? wake_all() : wake(body);
  ++geometry_version_;
  return {shape_count() - 1};
}

void World::set_material(ShapeId id, const Material& material) {
  identity_.require_free();
  check_material(material);
  shapes_[checked(id)].material = material;
  shapes_[checked(id)].named = {};
  wake_all();
  ++property_version_;
}

void World::set_material(ShapeId id, MaterialId material) {
  identity_.require_free();
  shapes_[checked(id)].material = this->material(material);
  shapes_[checked(id)].named = material;
  wake_all();
  ++property_version_;
}

MaterialId World::add_material(std::string name, const Material& material) {
  identity_.require_free();
  if (name.empty()) fail("material", "must have a name", "\"\"");
  for (const auto& [taken, other] : materials_)
    if (taken == name) fail("material", "name is already taken", name);
  check_material(material);
  materials_.emplace_back(std::move(name), material);
  ++property_version_;
  return {material_count() - 1};
}

MaterialId World::material(std::string_view name) const {
  const auto found = std::find_if(materials_.begin(), materials_.end(),
                                  [&](const auto& material) { return material.first == name; });
  if (found == materials_.end()) fail("material", "there is none of this name", std::string(name));
  return {static_cast<int>(found - materials_.begin())};
}

void World::set_contact_material(MaterialId a, MaterialId b, const Material& material) {
  identity_.require_free();
  checked(a), checked(b);
  check_material(material);
  material_pairs_[ordered(a, b)] = material;
  wake_all();
  ++property_version_;
}

void World::set_contact_material(ShapeId a, ShapeId b, const Material& material) {
  identity_.require_free();
  checked(a), checked(b);
  check_material(material);
  contact_materials_[ordered(a, b)] = material;
  wake_all();
  ++property_version_;
}

Material World::contact_material(ShapeId a, ShapeId b) const {
  if (!contact_materials_.empty())
    if (const auto found = contact_materials_.find(ordered(a, b)); found != contact_materials_.end())
      return found->second;
  const ShapeRecord &A = shape(a), &B = shape(b);
  if (const auto found = material_pairs_.find(ordered(A.named, B.named)); found != material_pairs_.end())
    return found->second;
  return combined(A.material, B.material);
}

void World::set_collision(BodyId a, BodyId b, bool may_collide) {
  identity_.require_free();
  checked(a), checked(b);
  if (a == b) fail("collision of " + name(a), "a body cannot collide with itself", name(b));
  collisions_[ordered(a, b)] = may_collide;
  wake(a), wake(b);
  ++property_version_;
}

bool World::may_collide(BodyId a, BodyId b) const {
  checked(a), checked(b);
  return a != b && !(is_fixed(a) && is_fixed(b)) && no_rule_forbids(a, b);
}

/// By set_collision(), or else by the joints.
bool World::no_rule_forbids(BodyId a, BodyId b) const {
  if (const auto found = collisions_.find(ordered(a, b)); found != collisions_.end()) return found->second;
  return !jointed_.contains(ordered(a, b));
}

bool World::may_collide(ShapeId a, ShapeId b) const {
  const ShapeRecord &A = shape(a), &B = shape(b);
  return (A.filter.groups & B.filter.mask) && (B.filter.groups & A.filter.mask) && A.body != B.body &&
         !(is_fixed(A.body) && is_fixed(B.body)) && no_rule_forbids(A.owner, B.owner);
}

}  // namespace taut
