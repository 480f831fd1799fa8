#pragma once

#include <span>
#include <vector>

#include "core/world.h"

namespace taut {

/// M = diag(I_W, m 1₃) per body, kept in principal axes; fixed bodies have M⁻¹ = 0.
class MassMatrix {
 public:
  struct Body {
    double mass = 1, inverse_mass = 0;
    Vec3 moments = Vec3::Ones();          ///< I_P [kg m²]
    Vec3 inverse_moments = Vec3::Zero();  ///< 1 / I_P
    double root_inverse_mass = 0;         ///< √(1/m)
    Vec3 root_inverse_moments = Vec3::Zero();
    Quat q_BP = Quat::Identity();
    bool principal = true;  ///< q_BP is the identity
    bool fixed = true;
    int symmetry_axis = -1;  ///< axis i with the other two moments equal; −1: none
  };

  explicit MassMatrix(const World& world);

  int size() const { return static_cast<int>(bodies_.size()); }
  const Body& operator[](int body) const { return bodies_[body]; }

  /// R_WP of a body.
  Mat3 principal_axes(int body, const Pose& pose) const {
    const Body& b = bodies_[body];
    return b.principal ? pose.q.toRotationMatrix() : (pose.q * b.q_BP).toRotationMatrix();
  }
  /// ω = I_W⁻¹ L.
  Vec3 angular_velocity(int body, const Pose& pose, const Vec3& L) const {
    const Mat3 R = principal_axes(body, pose);
    return R * bodies_[body].inverse_moments.cwiseProduct(R.transpose() * L);
  }
  /// L = I_W ω.
  Vec3 angular_momentum(int body, const Pose& pose, const Vec3& w) const {
    const Mat3 R = principal_axes(body, pose);
    return R * bodies_[body].moments.cwiseProduct(R.transpose() * w);
  }
  /// (I_W ω, m v); zero for fixed bodies.
  Wrench momentum(int body, const Pose& pose, const Twist& V) const {
    const Body& b = bodies_[body];
    return b.fixed ? Wrench{} : Wrench{angular_momentum(body, pose, V.w), b.mass * V.v};
  }

 private:
  std::vector<Body> bodies_;
};

/// A square root of M⁻¹ per body: M⁻¹ = A Aᵀ in two 3×3 blocks.
struct InverseMassRoot {
  Mat3 rotation = Mat3::Zero();
  Mat3 translation = Mat3::Zero();
  bool isotropic = true;  ///< `translation` is a multiple of 1
};

/// M⁻¹ of all bodies at one set of poses, for repeated use there.
class InverseMass {
 public:
  /// `roots` are those of M⁻¹ itself, at the poses in question.
  void set(std::span<const InverseMassRoot> roots) {
    bodies_.resize(roots.size());
    for (std::size_t b = 0; b < roots.size(); ++b) {
      const double t = roots[b].translation(0, 0);
      bodies_[b] = {roots[b].rotation, t * t};
    }
  }
  bool moves(int body) const { return bodies_[body].mass > 0; }
  /// V = M⁻¹ p of a body; zero for fixed ones.  The root is not multiplied out: of a thin rod, round-off then
  /// is a rotation about its axis only, which moves no point on it, be it held by a joint or a stiff damper.
  Twist twist(int body, const Wrench& p) const {
    const Mat3& A = bodies_[body].root;
    return {A * Vec3(A.transpose() * p.torque), bodies_[body].mass * p.force};
  }

 private:
  struct Body {
    Mat3 root;    // of I_W⁻¹
    double mass;  // 1/m
  };
  std::vector<Body> bodies_;
};

}  // namespace taut
