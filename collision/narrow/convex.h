#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "collision/narrow/contact.h"
#include "core/math/convex_hull.h"
#include "core/world/shape.h"

namespace taut::detail {

struct GjkCore;  // FCL's geometry of a core, see gjk.h

/// A corner of a feature, in the frame of its shape.  The id names it in any feature of that shape.
struct FeaturePoint {
  Vec3 p;
  int id;
};

/// What a convex body shows in a direction: a point, a segment, or a convex polygon, counter-clockwise seen
/// from outside.
struct Feature {
  std::vector<FeaturePoint> points;
  Vec3 normal;      ///< of a polygon
  double rounding;  ///< radius of curvature across a segment [m]
  /// Of a disc, whose rim the points are on: its radius [m], else 0, and its centre.
  double disc = 0;
  Vec3 centre = Vec3::Zero();
};

/// A convex body, the sum of a core and a ball: sphere = point ⊕ ball, capsule = segment ⊕ ball, all others
/// have radius zero.  Distances of cores are what GJK does exactly, and a rounded core touches before its
/// core does.
struct Convex {
  enum class Kind { kPoint, kSegment, kBox, kCylinder, kCone, kEllipsoid, kPolyhedron };

  Kind kind = Kind::kPoint;
  Vec3 half = Vec3::Zero();  ///< box: half sizes; segment: (0, 0, L/2); cylinder: (r, r, L/2); ellipsoid:
                             ///< radii; cone: (r, r, height)
  double radius = 0;         ///< of the ball
  Polyhedron hull;           ///< kPolyhedron; a triangle has two faces
  std::vector<Vec3> face_normals, edge_directions;  ///< unit; where separating directions come from
  double extent = 0;                                ///< radius of a ball about the origin that holds it
  Vec3 centre = Vec3::Zero();                       ///< somewhere inside
  bool symmetric = true;                            ///< centrally, about the origin
  std::shared_ptr<GjkCore> gjk;

  bool curved() const { return kind == Kind::kCylinder || kind == Kind::kCone || kind == Kind::kEllipsoid; }

  /// The point of the core farthest along d, which need not be of unit length.
  Vec3 support(const Vec3& d) const;
  /// ∂support/∂d for a unit d; zero at corners.
  Mat3 support_derivative(const Vec3& d) const;
  /// What is around the corner of a feature that faces the unit d.
  LocalSurface around(const Vec3& d, int corner) const;
  /// What is around the point farthest along d that has no corner, as on an ellipsoid or a rim.
  LocalSurface around(const Vec3& d) const;
  /// The feature of the core that faces the unit vector d.
  void feature(const Vec3& d, Feature& out) const;
  /// All points of the core that can touch a plane with the outward normal −d.
  void plane_points(const Vec3& d, std::vector<FeaturePoint>& out) const;
  /// If d is within 1e-4 rad of a direction in which a whole edge or generator is farthest: the nearest such
  /// direction and the unit direction of the edge.  Of several, the nearest.
  bool ridge(const Vec3& d, Vec3& on_ridge, Vec3& edge) const;
};

/// @pre a primitive or a convex hull, checked.
Convex make_convex(const Shape& shape);

/// A triangle to be moved by set_triangle(), so that a mesh needs no allocation per triangle.
Convex make_triangle();
void set_triangle(Convex& triangle, const Vec3& a, const Vec3& b, const Vec3& c);

/// x_A = R x_B + p: where shape B is, seen from shape A.
struct Relative {
  Mat3 R;
  Vec3 p;
};

}  // namespace taut::detail
