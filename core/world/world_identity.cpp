#include "core/world/world_identity.h"

#include <atomic>
#include <stdexcept>

namespace taut::detail {

std::uint64_t WorldIdentity::next() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

void WorldIdentity::refuse() {
  throw std::logic_error("world: cannot be changed by a force law while a step or a sum of forces asks it");
}

}  // namespace taut::detail
