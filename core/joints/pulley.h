#pragma once

#include "core/joints/wire.h"

namespace taut {

/// Pulley: a wire from A over points of a third body to B keeps its length.            (core/joints, Eq. 20)
///   φ = |p_C1 − p_A| + ratio |p_B − p_C2| − L [m]
/// With a ratio n the side of B counts n times, as in a tackle with n strands: its force is n times that of
/// A. −λ [N] is the tension on the side of A.  The wire can push; a rope over points cannot.
class Pulley final : public Joint {
 public:
  /// Points from the centres of mass, in body axes; C1 and C2 are where the wire leaves the sheaves.
  /// @throws std::invalid_argument if a point is not finite, or length or ratio are not positive.
  Pulley(WirePoint a, WirePoint c1, WirePoint c2, WirePoint b, double length, double ratio = 1);
  /// The wire through four world points in the bodies' present poses, with the length that it has there.
  static Pulley at(const World& world, BodyId a, const Vec3& p_a_W, BodyId c, const Vec3& p_c1_W,
                   const Vec3& p_c2_W, BodyId b, const Vec3& p_b_W, double ratio = 1);

  std::string_view type() const override { return "pulley"; }
  void append_rows(RowSink& rows) const override;
  Vec3 reaction_point_B() const override;
  std::vector<WirePoint> course() const override { return points_; }

 private:
  std::vector<WirePoint> points_;
  row_parts::Coupling way_;
};

}  // namespace taut
