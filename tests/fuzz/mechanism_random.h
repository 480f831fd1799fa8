#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/math/so3.h"

namespace taut::fuzz {

/// splitmix64: the same numbers with every standard library.
class Random {
 public:
  /// Seeds side by side must not give the same numbers one place on.
  explicit Random(std::uint64_t seed) : state_(mix(seed + 1) ^ mix(~seed)) {}

  std::uint64_t next() { return mix(state_ += 0x9e3779b97f4a7c15u); }
  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  double uniform(double from, double to) {
    return from + (to - from) * (static_cast<double>(next() >> 11) * 0x1p-53);
  }
  /// 10 to a power between both.
  double decades(double from, double to) { return std::pow(10.0, uniform(from, to)); }
  int below(int count) { return static_cast<int>(next() % static_cast<std::uint64_t>(count)); }
  bool chance(double p) { return uniform(0, 1) < p; }
  template <typename T>
  const T& of(const std::vector<T>& list) {
    return list[below(static_cast<int>(list.size()))];
  }
  Vec3 in_cube(double half) {
    const double x = uniform(-half, half), y = uniform(-half, half), z = uniform(-half, half);
    return {x, y, z};
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 v = in_cube(1);
      if (v.norm() > 0.1 && v.norm() <= 1) return v.normalized();
    }
  }
  Quat rotation() {
    const Vec3 axis = direction();
    const double half = uniform(-std::numbers::pi, std::numbers::pi) / 2;
    const Vec3 v = std::sin(half) * axis;
    return Quat(std::cos(half), v.x(), v.y(), v.z()).normalized();
  }

 private:
  std::uint64_t state_;
};

}  // namespace taut::fuzz
