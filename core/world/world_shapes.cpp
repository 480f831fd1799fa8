#include <utility>

#include "core/base/check.h"
#include "core/state/reach.h"
#include "core/world/world.h"

// Shapes, materials, and who may touch whom.
namespace taut {

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
  shapes_.add({body, std::move(shape), X_BS, material, filter, {}, body});
  is_fixed(body) ? wake_all() : wake(body);
  ++versions_.geometry;
  return {shape_count() - 1};
}

void World::set_material(ShapeId id, const Material& material) {
  identity_.require_free();
  check_material(material);
  shapes_.set_material(shapes_.checked(id), material, {});
  wake_all();
  ++versions_.properties;
}

void World::set_material(ShapeId id, MaterialId material) {
  identity_.require_free();
  const Material& values = this->material(material);
  shapes_.set_material(shapes_.checked(id), values, material);
  wake_all();
  ++versions_.properties;
}

MaterialId World::add_material(std::string name, const Material& material) {
  identity_.require_free();
  const MaterialId id = materials_.add(std::move(name), material);
  ++versions_.properties;
  return id;
}

void World::set_contact_material(MaterialId a, MaterialId b, const Material& material) {
  identity_.require_free();
  materials_.checked(a), materials_.checked(b);
  check_material(material);
  materials_.set_pair(a, b, material);
  wake_all();
  ++versions_.properties;
}

void World::set_contact_material(ShapeId a, ShapeId b, const Material& material) {
  identity_.require_free();
  shapes_.checked(a), shapes_.checked(b);
  check_material(material);
  shapes_.set_pair(a, b, material);
  wake_all();
  ++versions_.properties;
}

Material World::contact_material(ShapeId a, ShapeId b) const {
  if (const Material* set = shapes_.pairs().find(a, b)) return *set;
  const ShapeRecord &A = shape(a), &B = shape(b);
  if (const Material* set = materials_.pairs().find(A.named, B.named)) return *set;
  return combined(A.material, B.material);
}

void World::set_collision(BodyId a, BodyId b, bool may_collide) {
  identity_.require_free();
  bodies_.checked(a), bodies_.checked(b);
  if (a == b) fail("collision of " + name(a), "a body cannot collide with itself", name(b));
  collisions_.set(a, b, may_collide);
  wake(a), wake(b);
  ++versions_.properties;
}

bool World::may_collide(BodyId a, BodyId b) const {
  bodies_.checked(a), bodies_.checked(b);
  return a != b && !(is_fixed(a) && is_fixed(b)) && collisions_.allow(a, b);
}

bool World::may_collide(ShapeId a, ShapeId b) const {
  const ShapeRecord &A = shape(a), &B = shape(b);
  return (A.filter.groups & B.filter.mask) && (B.filter.groups & A.filter.mask) && A.body != B.body &&
         !(is_fixed(A.body) && is_fixed(B.body)) && collisions_.allow(A.owner, B.owner);
}

}  // namespace taut
