#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/world/shape.h"

namespace taut {

/// The surface of a body around a contact point: a ball rolled over a core.  World axes.  The point of the
/// core that faces a unit d moves with d as that of an ellipsoid, Q d/√(dᵀQ d), or if Q is 0 by H across the
/// normal.
struct LocalSurface {
  /// In place of the infinite radius of flat directions [m].
  static constexpr double kFlat = 1e9;
  double ball = 0;              ///< radius [m]
  Mat3 radii = Mat3::Zero();    ///< H, radii of curvature [m], symmetric, across the normal; 0: a corner
  Mat3 squares = Mat3::Zero();  ///< Q [m²], of an ellipsoid or the circle of a rim: squares of its half axes

  /// Around a point of a face with the unit normal n.
  static LocalSurface flat(const Vec3& n);
  bool is_flat() const;  ///< around a point of a face
  /// In axes that R turns to.
  LocalSurface turned(const Mat3& R) const;
};

/// Point P of body A faces point Q of body B:  p_WQ − p_WP = gap · normal.
/// The normal points from A to B, so a contact impulse λ ≥ 0 puts +λ·normal on B at Q and −λ·normal on A at
/// P.
struct Contact {
  ShapeId a, b;                                   ///< a.index < b.index
  BodyId A, B;                                    ///< their bodies
  Vec3 p_AP = Vec3::Zero(), p_BQ = Vec3::Zero();  ///< [m] in the body frames, from the centres of mass
  Vec3 normal = Vec3::UnitZ();                    ///< unit, world axes
  double gap = 0;                                 ///< [m]; negative: penetration
  std::uint64_t feature = 0;  ///< unique within the pair; the same for the same contact in the next call
  LocalSurface surface_A{}, surface_B{};  ///< around P and Q: how the gap changes as bodies turn
};

/// So many pairs of shapes near each other, or contacts, that what they would cost has no bound: they lie in
/// one place, or move past many others in one step.
struct Crowd {
  std::int64_t most = 0;        ///< so many are taken on; there are more
  std::vector<ShapeId> shapes;  ///< those with most of them, at most four, most first; none: no crowd
  bool empty() const { return shapes.empty(); }  ///< no crowd
};

}  // namespace taut
