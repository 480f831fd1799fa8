#pragma once

#include "core/math/so3.h"

namespace taut {

/// A twist or wrench in pairs, for products with rows of a Jacobian block.
class SixVector {
 public:
  SixVector(const Vec3& a, const Vec3& b) : first_(a[0], a[1]), second_(a[2], b[0]), third_(b[1], b[2]) {}
  double dot(const double* row) const {  ///< with the six numbers of a row
    using Pair = Eigen::Map<const Eigen::Vector2d>;
    return (first_.cwiseProduct(Pair(row)) + second_.cwiseProduct(Pair(row + 2)) +
            third_.cwiseProduct(Pair(row + 4)))
        .sum();
  }

 private:
  Eigen::Vector2d first_, second_, third_;
};

}  // namespace taut
