#pragma once

#include <random>
#include <vector>

#include "core/state/state.h"

namespace taut::testing {

/// Seeded source of poses, twists and vectors of order one.  The same numbers on every platform: only the
/// bits of mt19937_64 are used, not the library's distributions.
class Random {
 public:
  explicit Random(unsigned seed) : bits_(seed) {}

  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53;
  }
  Vec3 vector(double scale = 1) {
    const double x = uniform(-scale, scale), y = uniform(-scale, scale), z = uniform(-scale, scale);
    return {x, y, z};
  }
  Vec3 unit() {
    for (;;) {
      const Vec3 v = vector();
      if (v.norm() > 0.1 && v.norm() < 1) return v.normalized();
    }
  }
  /// Any rotation; the angle is uniform in [0, π).
  Quat rotation() {
    const Vec3 axis = unit();
    return exp_so3(uniform(0, 3.14159) * axis);
  }
  Pose pose() {
    const Quat q = rotation();
    return {q, vector(2)};
  }
  Twist twist() {
    const Vec3 w = vector();
    return {w, vector()};
  }
  std::vector<double> multipliers(int count) {
    std::vector<double> lambda(count);
    for (double& l : lambda) l = uniform(-1, 1);
    return lambda;
  }

 private:
  std::mt19937_64 bits_;
};

/// The pose after turning by δ about the body's centre (world axes, from the left) and shifting by d.
inline Pose moved(const Pose& pose, const Vec3& delta, const Vec3& d) {
  return {(exp_so3(delta) * pose.q).normalized(), pose.p + d};
}

/// The pose after the rigid motion x ↦ R x + t of the whole world.
inline Pose transformed(const Quat& R, const Vec3& t, const Pose& pose) {
  return {R * pose.q, R * pose.p + t};
}

}  // namespace taut::testing
