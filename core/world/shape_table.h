#pragma once

#include <vector>

#include "core/world/pair_table.h"
#include "core/world/shape.h"

namespace taut::detail {

/// The shapes of a World, and what contacts between two of them are like instead of what their materials say.
class ShapeTable {
 public:
  int count() const { return static_cast<int>(shapes_.size()); }
  /// Index of a shape.  @throws std::invalid_argument if there is no such one.
  int checked(ShapeId id) const;
  const ShapeRecord& operator[](int shape) const { return shapes_[shape]; }
  const std::vector<ShapeRecord>& all() const { return shapes_; }
  const PairTable<ShapeId, Material>& pairs() const { return pairs_; }  ///< as set

  void add(ShapeRecord shape);
  void set_material(int shape, const Material& material, MaterialId named);
  void set_pair(ShapeId a, ShapeId b, const Material& material);
  /// All materials as in a table of the same shapes.
  void copy_materials(const ShapeTable& from);
  /// A shape moves with another body now, at X_BS.
  void move(int shape, BodyId body, const Pose& pose);

 private:
  std::vector<ShapeRecord> shapes_;
  PairTable<ShapeId, Material> pairs_;
};

}  // namespace taut::detail
