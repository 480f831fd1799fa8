#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/world/world.h"

namespace taut::detail {

struct Bounds {
  Vec3 low, high;
  bool overlaps(const Bounds& other) const {
    return (low.array() <= other.high.array()).all() && (high.array() >= other.low.array()).all();
  }
};

/// Pairs of shapes whose boxes overlap, by FCL's dynamic tree of boxes: one tree for what moves, one for what
/// does not.  A box in the tree is larger than its shape's and is put anew only when the shape leaves it.
class BroadPhase {
 public:
  BroadPhase();
  ~BroadPhase();
  BroadPhase(const BroadPhase&) = delete;
  BroadPhase& operator=(const BroadPhase&) = delete;

  /// Starts afresh with these shapes; those that are not in a tree (half-spaces) have role kNone.
  enum class Role : char { kNone, kMoving, kFixed };
  void reset(std::span<const Role> roles, std::span<const Bounds> bounds);
  void update(std::span<const Bounds> bounds);

  /// All pairs (smaller index first) with overlapping bounds of which at least one moves and
  /// world.may_collide(), in no particular order.  Appended to `pairs`.  Among shapes that all lie in one
  /// place their number is quadratic: the search ends, with false, as soon as there are more than `most`.
  bool find_pairs(const World& world, std::span<const Bounds> bounds, std::size_t most,
                  std::vector<std::pair<int, int>>& pairs);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taut::detail
