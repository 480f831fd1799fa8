#pragma once

#include <cstddef>

namespace taut::detail {

/// @throws std::invalid_argument: "body id: no such body".
[[noreturn]] void fail_for_id(const char* kind, int index);

/// The index of an id.  @throws std::invalid_argument unless it is one of `count` things of this kind.
template <typename Id>
int index_of(Id id, std::size_t count, const char* kind) {
  if (id.index < 0 || static_cast<std::size_t>(id.index) >= count) fail_for_id(kind, id.index);
  return id.index;
}

}  // namespace taut::detail
