#pragma once

#include <array>

namespace taut {

/// Axes of a joint, by their place in it, along which friction and springs of its swing act where that has no
/// direction; −1: none.
struct SwingAxes {
  std::array<int, 2> turns{-1, -1};       ///< about two directions across it, for friction next to 0
  std::array<int, 2> components{-1, -1};  ///< of the swing as a vector, for a spring whose rest is 0
};

}  // namespace taut
