#include "core/world/shape_table.h"

#include "core/world/id_check.h"

namespace taut::detail {

int ShapeTable::checked(ShapeId id) const { return index_of(id, shapes_.size(), "shape"); }

void ShapeTable::set_material(int shape, const Material& material, MaterialId named) {
  shapes_[shape].material = material;
  shapes_[shape].named = named;
}

void ShapeTable::copy_materials(const ShapeTable& from) {
  pairs_ = from.pairs_;
  for (int s = 0; s < count(); ++s) set_material(s, from[s].material, from[s].named);
}

void ShapeTable::move(int shape, BodyId body, const Pose& pose) {
  shapes_[shape].body = body;
  shapes_[shape].pose = pose;
  shapes_[shape].pose.q.normalize();
}

void ShapeTable::add(ShapeRecord shape) { shapes_.push_back(std::move(shape)); }

void ShapeTable::set_pair(ShapeId a, ShapeId b, const Material& material) { pairs_.set(a, b, material); }

}  // namespace taut::detail
