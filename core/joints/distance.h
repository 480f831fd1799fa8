#pragma once

#include "core/world/world.h"

namespace taut {

/// Distance joint (massless rod on two ball joints): P of A and Q of B keep the distance L.
/// (core/joints, Eq. 6)
///   φ = |p_WQ − p_WP| − L [m].
/// λ > 0 pushes the points apart (compression of the rod), λ < 0 pulls them together (tension).
class Distance final : public Joint {
 public:
  /// Points from the centres of mass, in body axes.
  /// @throws std::invalid_argument if a point is not finite or the length not positive (use a ball joint for
  /// 0).
  Distance(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& p_BQ, double length);
  /// The rod between two world points of A and B in their present poses.
  static Distance between(const World& world, BodyId a, BodyId b, const Vec3& p_a_W, const Vec3& p_b_W);

  std::string_view type() const override { return "distance"; }
  void append_rows(RowSink& rows) const override;
  Vec3 reaction_point_B() const override { return p_BQ_; }
  std::vector<WirePoint> course() const override;

 private:
  Vec3 p_AP_, p_BQ_;
  double length_;
};

}  // namespace taut
