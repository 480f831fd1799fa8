#pragma once

#include <cmath>

// What all laws share.
namespace taut {

/// A limit or contact is touched within this distance [m or rad]; positions are closed to less.
inline constexpr double kTouch = 1e-9;
/// A step of a law that no rate comes to [m/s or rad/s].
inline constexpr double kUnreachedRate = 1e12;
/// Rates this near to a step of the law are on it, relative to 1 + |w|.
inline constexpr double kOnStep = 1e-9;
inline bool on_step(double w, double at) { return std::abs(w - at) <= kOnStep * (1 + std::abs(w)); }

}  // namespace taut
