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

}  // namespace taut::detail
