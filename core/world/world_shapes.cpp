#include <utility>

#include "core/base/check.h"
#include "core/state/reach.h"
#include "core/world/world.h"
#include "core/world/world_parts.h"

// Shapes, materials, and who may touch whom.
namespace taut {

ShapeId World::add_shape(BodyId body, Shape shape, const Pose& pose, const Material& material,
                         CollisionFilter filter) {
  return add_shape(body, std::make_shared<const Shape>(std::move(shape)), pose, material, filter);
}

ShapeId World::add_shape(BodyId body, std::shared_ptr<const Shape> shape, const Pose& pose,
                         const Material& material, CollisionFilter filter) {
  parts_->identity.require_free();
  const std::string owner = "shape of " + name(body);
  if (!shape) fail(owner, "must not be null", "null");
  check_shape(*shape);
  check_material(material);
  require_within_reach("position of " + owner, pose.p);
  require_unit("orientation of " + owner, pose.q.coeffs());
  Pose X_BS = pose;
  X_BS.q.normalize();
  parts_->shapes.add({body, std::move(shape), X_BS, material, filter, {}, body});
  is_fixed(body) ? wake_all() : wake(body);
  ++parts_->versions.geometry;
  return {shape_count() - 1};
}

void World::set_material(ShapeId id, const Material& material) {
  parts_->identity.require_free();
  check_material(material);
  parts_->shapes.set_material(parts_->shapes.checked(id), material, {});
  wake_all();
  ++parts_->versions.properties;
}

void World::set_material(ShapeId id, MaterialId material) {
  parts_->identity.require_free();
  const Material& values = this->material(material);
  parts_->shapes.set_material(parts_->shapes.checked(id), values, material);
  wake_all();
  ++parts_->versions.properties;
}

MaterialId World::add_material(std::string name, const Material& material) {
  parts_->identity.require_free();
  const MaterialId id = parts_->materials.add(std::move(name), material);
  ++parts_->versions.properties;
  return id;
}

void World::set_contact_material(MaterialId a, MaterialId b, const Material& material) {
  parts_->identity.require_free();
  parts_->materials.checked(a), parts_->materials.checked(b);
  check_material(material);
  parts_->materials.set_pair(a, b, material);
  wake_all();
  ++parts_->versions.properties;
}

void World::set_contact_material(ShapeId a, ShapeId b, const Material& material) {
  parts_->identity.require_free();
  parts_->shapes.checked(a), parts_->shapes.checked(b);
  check_material(material);
  parts_->shapes.set_pair(a, b, material);
  wake_all();
  ++parts_->versions.properties;
}

Material World::contact_material(ShapeId a, ShapeId b) const {
  if (const Material* set = parts_->shapes.pairs().find(a, b)) return *set;
  const ShapeRecord &A = shape(a), &B = shape(b);
  if (const Material* set = parts_->materials.pairs().find(A.named, B.named)) return *set;
  return combined(A.material, B.material);
}

void World::set_collision(BodyId a, BodyId b, bool may_collide) {
  parts_->identity.require_free();
  parts_->bodies.checked(a), parts_->bodies.checked(b);
  if (a == b) fail("collision of " + name(a), "a body cannot collide with itself", name(b));
  parts_->collisions.set(a, b, may_collide);
  wake(a), wake(b);
  ++parts_->versions.properties;
}

bool World::may_collide(BodyId a, BodyId b) const {
  parts_->bodies.checked(a), parts_->bodies.checked(b);
  return a != b && !(is_fixed(a) && is_fixed(b)) && parts_->collisions.allow(a, b);
}

bool World::may_collide(ShapeId a, ShapeId b) const {
  const ShapeRecord &A = shape(a), &B = shape(b);
  return (A.filter.groups & B.filter.mask) && (B.filter.groups & A.filter.mask) && A.body != B.body &&
         !(is_fixed(A.body) && is_fixed(B.body)) && parts_->collisions.allow(A.owner, B.owner);
}

int World::shape_count() const { return parts_->shapes.count(); }
const ShapeRecord& World::shape(ShapeId id) const { return parts_->shapes[parts_->shapes.checked(id)]; }
int World::material_count() const { return parts_->materials.count(); }
const Material& World::material(MaterialId id) const {
  return parts_->materials[parts_->materials.checked(id)];
}
const std::string& World::name(MaterialId id) const {
  return parts_->materials.name(parts_->materials.checked(id));
}
MaterialId World::material(std::string_view name) const { return parts_->materials.named(name); }

}  // namespace taut
