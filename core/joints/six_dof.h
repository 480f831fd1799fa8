#pragma once

#include <array>

#include "core/base/check.h"
#include "core/constraints/parallel_part.h"
#include "core/world/world.h"

namespace taut {

/// Generic joint: frame G of B moves against frame F of A, with any of the three translations along and three
/// rotations about the axes of F locked.                                              (core/joints, Eq. 12)
///   φ = e_i·d for each locked translation [m], d = p_WG − p_WF;
///   rotations [rad]: all locked 2 vec q_FG; two locked, free about e_k: e_i·g_k, e_j·g_k; only k locked:
///   e_i·g_j with (i, j, k) cyclic, free about e_i of F and g_j of G, as a universal joint.
/// λ of a translation is the force on B at G along e_i; rotations as Orientation and Perpendicular.
/// Free axes: `x`, `y`, `z` [m] for each free translation; `angle_x`, … [rad] for one or two free rotations.
/// Three free rotations are no scalar coordinates.  All are 0 in the pose where at() made the joint.
class SixDof final : public Joint {
 public:
  struct Locks {                        ///< Which of the six motions are locked.
    std::array<bool, 3> translation{};  ///< along x, y, z of F
    std::array<bool, 3> rotation{};     ///< about them
  };
  /// Points from the centres of mass and orientations of the frames, in body axes.
  /// @throws std::invalid_argument if a point is not finite or an orientation not of unit length.
  SixDof(BodyId a, BodyId b, const Vec3& p_AF, const Quat& q_AF, const Vec3& p_BG, const Quat& q_BG,
         const Locks& locks)
      : Joint(a, b), p_AF_(p_AF), p_BG_(p_BG), q_AF_(q_AF), q_BG_(q_BG), locks_(locks) {
    require_all_finite("six-DOF anchor on A", p_AF);
    require_all_finite("six-DOF anchor on B", p_BG);
    require_unit("six-DOF orientation on A", q_AF.coeffs());
    require_unit("six-DOF orientation on B", q_BG.coeffs());
  }
  /// The joint with both frames at (p_W, q_WF) in the bodies' present poses.
  static SixDof at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Quat& q_WF,
                   const Locks& locks) {
    require_unit("six-DOF orientation", q_WF.coeffs());
    const Pose &A = world.pose(a), &B = world.pose(b);
    return {a, b, A.local(p_W), relative(A.q, q_WF), B.local(p_W), relative(B.q, q_WF), locks};
  }

  std::string_view type() const override { return "six_dof"; }
  void append_rows(RowSink& rows) const override {
    for (int i = 0; i < 3; ++i)
      if (locks_.translation[i]) rows.add(row_parts::PointInPlane{p_AF_, F(i), p_BG_});
    const int locked = locked_rotations();
    if (locked == 3) rows.add(row_parts::Orientation{q_AF_, q_BG_});
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      if (locked == 2 && !locks_.rotation[k]) rows.add(row_parts::Parallel{F(i), F(j), G(k)});
      if (locked == 1 && locks_.rotation[k]) rows.add(row_parts::Perpendicular{F(i), G(j)});
    }
  }
  void append_axes(AxisSink& axes) const override {
    static constexpr const char* kAlong[] = {"x", "y", "z"};
    static constexpr const char* kAbout[] = {"angle_x", "angle_y", "angle_z"};
    for (int i = 0; i < 3; ++i)
      if (!locks_.translation[i]) axes.add(kAlong[i], row_parts::Displacement{{p_AF_, F(i), p_BG_}});
    const int locked = locked_rotations();
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      if (locked == 2 && !locks_.rotation[k]) axes.add(kAbout[k], row_parts::Angle{F(k), F(i), G(i)});
      if (locked == 1 && locks_.rotation[k]) {
        axes.add(kAbout[i], row_parts::Angle{F(i), F(j), G(j)});
        axes.add(kAbout[j], row_parts::Angle{-G(j), G(i), F(i)}, {1, 0});
      }
    }
  }
  Vec3 reaction_point_B() const override { return p_BG_; }

 private:
  int locked_rotations() const {
    return int{locks_.rotation[0]} + int{locks_.rotation[1]} + int{locks_.rotation[2]};
  }
  Vec3 F(int i) const { return q_AF_ * Vec3::Unit(i); }
  Vec3 G(int i) const { return q_BG_ * Vec3::Unit(i); }

  Vec3 p_AF_, p_BG_;
  Quat q_AF_, q_BG_;
  Locks locks_;
};

}  // namespace taut
