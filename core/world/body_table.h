#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/state/state.h"
#include "core/world/id_check.h"
#include "core/world/name_table.h"
#include "core/world/rigid_body.h"

namespace taut::detail {

/// What does not change with time about the bodies of a World: names, mass properties, and which of them
/// never move.
class BodyTable {
 public:
  int count() const { return static_cast<int>(masses_.size()); }
  int moving_count() const { return moving_count_; }  ///< not fixed
  /// Index of a body.  @throws std::invalid_argument if there is no such one.
  int checked(BodyId id) const { return index_of(id, masses_.size(), "body"); }

  const NameTable& names() const { return names_; }
  const std::vector<MassProperties>& masses() const { return masses_; }  ///< of all bodies
  std::span<const char> fixed() const { return fixed_; }                 ///< which never move
  const MassProperties& mass(int body) const { return masses_[body]; }
  bool is_fixed(int body) const { return fixed_[body]; }

  /// @throws std::invalid_argument if the name is taken.
  void add(std::string name, const MassProperties& mass, bool fixed);
  void set_mass(int body, const MassProperties& mass) { masses_[body] = mass; }
  void set_fixed(int body, bool fixed);

 private:
  NameTable names_{"body"};
  std::vector<MassProperties> masses_;
  std::vector<char> fixed_;
  int moving_count_ = 0;
};

}  // namespace taut::detail
