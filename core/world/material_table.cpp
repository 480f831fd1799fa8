#include "core/world/material_table.h"

#include <algorithm>

#include "core/base/check.h"
#include "core/world/id_check.h"

namespace taut::detail {

int MaterialTable::checked(MaterialId id) const { return index_of(id, materials_.size(), "material"); }

int MaterialTable::find(std::string_view name) const {
  const auto found = std::find_if(materials_.begin(), materials_.end(),
                                  [&](const auto& material) { return material.first == name; });
  return static_cast<int>(found - materials_.begin());
}

MaterialId MaterialTable::named(std::string_view name) const {
  if (!contains(name)) fail("material", "there is none of this name", std::string(name));
  return {find(name)};
}

MaterialId MaterialTable::add(std::string name, const Material& material) {
  if (name.empty()) fail("material", "must have a name", "\"\"");
  if (contains(name)) fail("material", "name is already taken", name);
  check_material(material);
  materials_.emplace_back(std::move(name), material);
  return {count() - 1};
}

void MaterialTable::set_pair(MaterialId a, MaterialId b, const Material& material) {
  pairs_.set(a, b, material);
}

}  // namespace taut::detail
