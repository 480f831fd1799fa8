#pragma once

#include "core/state/state.h"

/// Equality to the last bit (but that −0 is 0): whether something was moved at all.
namespace taut {

inline bool same(const Pose& a, const Pose& b) { return a.p == b.p && a.q.coeffs() == b.q.coeffs(); }
inline bool same(const Twist& a, const Twist& b) { return a.w == b.w && a.v == b.v; }
inline bool same(const State& a, const State& b) {
  if (a.time != b.time || a.axes != b.axes || a.poses.size() != b.poses.size() ||
      a.twists.size() != b.twists.size())
    return false;
  for (std::size_t i = 0; i < a.poses.size(); ++i)
    if (!same(a.poses[i], b.poses[i]) || !same(a.twists[i], b.twists[i])) return false;
  return true;
}

}  // namespace taut
