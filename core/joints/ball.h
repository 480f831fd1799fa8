#pragma once

#include "core/check.h"
#include "core/world.h"

namespace taut {

/// Ball joint: point P of A stays on point Q of B.  φ = p_WQ − p_WP ∈ ℝ³ [m]. (core/README, Eq. 5) λ is the
/// force on B at Q in world axes; A receives −λ at P.
class Ball final : public Joint {
 public:
  /// Points from the centres of mass, in body axes; for the ground, in world axes.
  /// @throws std::invalid_argument if a point is not finite.
  Ball(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& p_BQ) : Joint(a, b), p_AP_(p_AP), p_BQ_(p_BQ) {
    require_all_finite("ball anchor on A", p_AP);
    require_all_finite("ball anchor on B", p_BQ);
  }
  /// The joint that holds A and B together at world point p_W in their present poses.
  static Ball at(const World& world, BodyId a, BodyId b, const Vec3& p_W) {
    return {a, b, world.pose(a).local(p_W), world.pose(b).local(p_W)};
  }

  std::string_view type() const override { return "ball"; }
  void append_rows(RowSink& rows) const override { rows.add(row_parts::Point{p_AP_, p_BQ_}); }
  Vec3 reaction_point_B() const override { return p_BQ_; }

 private:
  Vec3 p_AP_, p_BQ_;
};

}  // namespace taut
