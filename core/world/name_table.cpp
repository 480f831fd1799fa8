#include "core/world/name_table.h"

#include "core/base/check.h"

namespace taut::detail {

int NameTable::index_of(std::string_view name) const {
  const auto found = index_of_name_.find(std::string(name));
  if (found == index_of_name_.end()) fail(kind_, "there is none of this name", name);
  return found->second;
}

std::string NameTable::shown(const std::string& name) const {
  return name.empty() ? std::string(kind_) + "_" + std::to_string(names_.size()) : name;
}

void NameTable::add(std::string name) {
  if (name.empty()) {
    name = shown(name);
    while (index_of_name_.contains(name)) name += "_";
  }
  if (!index_of_name_.emplace(name, static_cast<int>(names_.size())).second)
    fail(kind_, "name is already taken", name);
  names_.push_back(std::move(name));
}

bool NameTable::contains(std::string_view name) const { return index_of_name_.contains(std::string(name)); }

}  // namespace taut::detail
