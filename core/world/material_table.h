#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/world/material.h"
#include "core/world/pair_table.h"

namespace taut::detail {

/// The materials of a World that have names, and what contacts between two of them are like instead of
/// combined().
class MaterialTable {
 public:
  int count() const { return static_cast<int>(materials_.size()); }
  /// Index of a material.  @throws std::invalid_argument if there is no such one.
  int checked(MaterialId id) const;
  const std::string& name(int material) const { return materials_[material].first; }
  const Material& operator[](int material) const { return materials_[material].second; }
  const PairTable<MaterialId, Material>& pairs() const { return pairs_; }  ///< as set
  bool contains(std::string_view name) const { return find(name) < count(); }
  /// @throws std::invalid_argument if there is none of this name.
  MaterialId named(std::string_view name) const;

  /// @throws std::invalid_argument for an empty name or one that is taken, and for what check_material()
  /// refuses.
  MaterialId add(std::string name, const Material& material);
  void set_pair(MaterialId a, MaterialId b, const Material& material);

 private:
  int find(std::string_view name) const;  // count() if there is none

  std::vector<std::pair<std::string, Material>> materials_;
  PairTable<MaterialId, Material> pairs_;
};

}  // namespace taut::detail
