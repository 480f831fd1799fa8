#pragma once

#include <span>
#include <vector>

namespace taut {

/// Values of rows to where the rows are now: row r was `from[r]`, −1: it is new, and has `fresh`.
template <typename Value>
void move_rows(std::span<const int> from, const Value& fresh, std::vector<Value>& values) {
  std::vector<Value> moved(from.size(), fresh);
  for (std::size_t r = 0; r < from.size(); ++r)
    if (from[r] >= 0) moved[r] = values[from[r]];
  values.swap(moved);
}

}  // namespace taut
