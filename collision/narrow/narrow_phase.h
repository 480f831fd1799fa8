#pragma once

#include <memory>
#include <vector>

#include "collision/narrow/manifold.h"
#include "collision/narrow/surface.h"

namespace taut::detail {

/// A shape made ready for detection; shared by all records of one shape.
struct Geometry {
  enum class Kind { kConvex, kSurface, kHalfSpace };
  Kind kind;
  Convex convex;
  std::unique_ptr<Surface> surface;
  Vec3 box_centre = Vec3::Zero();  ///< box of a surface in its own frame
  Vec3 box_half = Vec3::Zero();
  double extent = 0;  ///< radius of a ball about the origin that holds it; infinite for a half-space

  /// The smallest box of the world's axes around it at the pose X_WS.
  void bounds(const Pose& X_WS, Vec3& low, Vec3& high) const;
};

/// @pre checked by check_shape().
std::unique_ptr<const Geometry> make_geometry(const Shape& shape);

/// Work space of one thread.
struct NarrowScratch {
  ManifoldScratch manifold;
  Convex triangle = make_triangle();
  std::vector<int> triangles;
  std::vector<FeaturePoint> points;
};

/// Contact points of two shapes with gaps up to `cutoff`, in the frame of a; at most `most` for each
/// direction of the normal.  Appended to `out`.  @pre have_contacts().
void find_contacts(const Geometry& a, const Geometry& b, const Relative& X_ab, double cutoff,
                   std::size_t most, NarrowScratch& scratch, std::vector<ManifoldPoint>& out);

/// The parts of find_contacts() that are not convex against convex.
void half_space_contacts(const Convex& a, const Relative& X_ab, double cutoff, NarrowScratch& scratch,
                         std::vector<ManifoldPoint>& out);
void surface_half_space_contacts(const Surface& a, const Relative& X_ab, double cutoff,
                                 std::vector<ManifoldPoint>& out);
/// Points in the frame of the surface, which is A.
void surface_contacts(const Surface& surface, const Convex& b, const Relative& X_ab, double cutoff,
                      NarrowScratch& scratch, std::vector<ManifoldPoint>& out);

}  // namespace taut::detail
