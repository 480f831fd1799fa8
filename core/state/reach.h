#pragma once

#include <string_view>

#include "core/base/check.h"
#include "core/state/state.h"

namespace taut {

/// The largest coordinate, size and distance [m], speed [m/s] and spin [rad/s] that a World takes.  Beyond
/// 1e77 fourth powers of lengths overflow, which are in what moves of inertias come to; beyond 1e154 squares,
/// and with them FCL's tree of boxes.  The universe that can be seen has 1e27 m.
inline constexpr double kFarthest = 1e30;
/// The smallest size of a shape [m], whose square is a number as well.
inline constexpr double kSmallest = 1e-30;
/// What a step makes of these, such as the box of a shape on its way, must remain below this.
inline constexpr double kFarthestBox = 1e70;

/// False for what is not a number, too.
template <typename Vector>
bool within(const Vector& v, double bound = kFarthest) {
  return (v.array().abs() <= bound).all();
}

template <typename Vector>
void require_within_reach(std::string_view name, const Vector& v) {
  require_all_finite(name, v);
  if (!within(v)) fail_with(name, "must not be beyond 1e30", v);
}

/// Of a state that a World takes.
inline bool within_reach(const Pose& pose, const Twist& twist) {
  return within(pose.p) && within(twist.w) && within(twist.v);
}

inline void require_size(std::string_view name, double size) {
  require_positive(name, size);
  if (size > kFarthest) fail(name, "must not be beyond 1e30", size);
  if (size < kSmallest) fail(name, "must not be below 1e-30", size);
}

}  // namespace taut
