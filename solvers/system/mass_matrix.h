#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/world/world.h"

namespace taut {

/// M = diag(I_W, m 1₃) per body, kept in principal axes; fixed bodies have M⁻¹ = 0.
class MassMatrix {
 public:
  /// What each step reads of a body, in one line of the cache.
  struct alignas(64) Body {
    Vec3 inverse_moments = Vec3::Zero();       ///< 1 / I_P
    double inverse_mass = 0;                   ///< 1 / m
    Vec3 root_inverse_moments = Vec3::Zero();  ///< 1 / √I_P
    bool principal = true;                     ///< q_BP is the identity
    bool fixed = true;                         ///< it never moves
    std::int8_t symmetry_axis = -1;            ///< axis i with the other two moments equal; −1: none
  };
  /// What else is known of a body.
  struct Inertia {
    double mass = 1;               ///< m [kg]
    Vec3 moments = Vec3::Ones();   ///< I_P [kg m²]
    Quat q_BP = Quat::Identity();  ///< principal axes P in body axes
  };

  explicit MassMatrix(const World& world);
  /// The blocks of some bodies of another mass matrix, numbered anew.
  MassMatrix(const MassMatrix& whole, std::span<const int> bodies);

  int size() const { return static_cast<int>(bodies_.size()); }       ///< number of bodies
  const Body& operator[](int body) const { return bodies_[body]; }    ///< by its index
  const Inertia& inertia(int body) const { return inertias_[body]; }  ///< by its index

  /// R_WP of a body.
  Mat3 principal_axes(int body, const Pose& pose) const;
  /// ω = I_W⁻¹ L.
  Vec3 angular_velocity(int body, const Pose& pose, const Vec3& L) const;
  /// L = I_W ω.
  Vec3 angular_momentum(int body, const Pose& pose, const Vec3& w) const;
  /// (I_W ω, m v); zero for fixed bodies.
  Wrench momentum(int body, const Pose& pose, const Twist& V) const;

 private:
  std::vector<Body> bodies_;
  std::vector<Inertia> inertias_;
};

}  // namespace taut
