#pragma once

#include <array>

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
         const Locks& locks);
  /// The joint with both frames at (p_W, q_WF) in the bodies' present poses.
  static SixDof at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Quat& q_WF,
                   const Locks& locks);

  std::string_view type() const override { return "six_dof"; }
  void append_rows(RowSink& rows) const override;
  void append_axes(AxisSink& axes) const override;
  Vec3 reaction_point_B() const override { return p_BG_; }

 private:
  int locked_rotations() const;
  Vec3 F(int i) const;
  Vec3 G(int i) const;

  Vec3 p_AF_, p_BG_;
  Quat q_AF_, q_BG_;
  Locks locks_;
};

}  // namespace taut
