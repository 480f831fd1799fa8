#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

namespace taut {

/// Sets of 0 … n − 1 that grow together, each named by its least member.
class UnionFind {
 public:
  /// Each of them by itself; no allocation at a size that was there before.
  void reset(int size) {
    up_.resize(size);
    std::iota(up_.begin(), up_.end(), 0);
  }
  /// The least member of i's set.  Ways up are halved as they are gone.
  int find(int i) {
    while (up_[i] != i) i = up_[i] = up_[up_[i]];
    return i;
  }
  void join(int a, int b) {
    a = find(a), b = find(b);
    up_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> up_;  // a lesser member of the same set, or itself
};

}  // namespace taut
