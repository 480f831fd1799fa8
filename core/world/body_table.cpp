#include "core/world/body_table.h"

#include <utility>

namespace taut::detail {

void BodyTable::add(std::string name, const MassProperties& mass, bool fixed) {
  names_.add(std::move(name));
  masses_.push_back(mass);
  fixed_.push_back(fixed);
  moving_count_ += !fixed;
}

void BodyTable::set_fixed(int body, bool fixed) {
  moving_count_ += static_cast<int>(is_fixed(body)) - static_cast<int>(fixed);
  fixed_[body] = fixed;
}

}  // namespace taut::detail
