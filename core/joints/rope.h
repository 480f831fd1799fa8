#pragma once

#include <optional>

#include "core/joints/wire.h"

namespace taut {

/// Rope: the way from point to point is never longer than the rope; it slides without friction through the
/// points between its ends.  No equality row; its free axis `length` [m] = Σ |p_{i+1} − p_i| has the upper
/// limit from the start (World::set_limits changes it, as a winch does).              (core/joints, Eq. 21)
/// λ ≤ 0 along that axis: −λ [N] is the tension.  A motor that only pulls (AxisMotor::winch) winds it.
///
/// Over guide points it has an axis for each section between two bodies, `span_1` from the first point on
/// [m], with a lower limit, the stop: as a hook block that has come up to its sheave, an end stays there and
/// the rope can be pulled no further.
class Rope final : public Joint {
 public:
  /// `stop`: the shortest that a section over guide points becomes [m], if not given 1 cm or a hundredth of
  /// the length, whichever is less; 0: there is no stop, and a step in which an end arrives fails.
  /// @throws std::invalid_argument if there are fewer than two points or bodies, a point is not finite, or
  /// the length not positive, the restitution not from 0 to 1 or the stop negative.
  Rope(const std::vector<WirePoint>& points, double length, double restitution = 0,
       std::optional<double> stop = std::nullopt);
  /// A rope between a point of A and one of B.
  Rope(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& p_BQ, double length, double restitution = 0);
  /// A rope that is just taut between two world points of A and B in their present poses.
  static Rope between(const World& world, BodyId a, BodyId b, const Vec3& p_a_W, const Vec3& p_b_W);

  std::string_view type() const override { return "rope"; }
  void append_rows(RowSink&) const override {}
  void append_axes(AxisSink& axes) const override;
  Vec3 reaction_point_B() const override { return point_B_; }
  std::vector<WirePoint> course() const override { return points_; }

 private:
  std::vector<WirePoint> points_;
  row_parts::Coupling way_;
  AxisLimits limits_;
  double stop_ = 0;
  Vec3 point_B_ = Vec3::Zero();
};

}  // namespace taut
