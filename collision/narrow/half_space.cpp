#include <algorithm>

#include "collision/narrow/narrow_phase.h"

namespace taut::detail {
namespace {

/// The half-space z ≤ 0 of frame b, seen from frame a: outward normal h and a point of the plane.
struct Plane {
  Vec3 h, p;
  explicit Plane(const Relative& X_ab) : h(X_ab.R.col(2)), p(X_ab.p) {}

  /// Adds x of a core if the surface around it is within the cutoff.
  void add(const Vec3& x, const LocalSurface& around, int id, double cutoff,
           std::vector<ManifoldPoint>& out) const {
    const double r = around.ball;
    const double gap = h.dot(x - p) - r;
    if (gap > cutoff) return;
    const Vec3 P = x - r * h;
    out.push_back({P, P - gap * h, -h, gap, contact_id(Meeting::kVertexA, static_cast<std::uint64_t>(id), 0),
                   around, LocalSurface::flat(h)});
  }
};

}  // namespace

void half_space_contacts(const Convex& a, const Relative& X_ab, double cutoff, NarrowScratch& scratch,
                         std::vector<ManifoldPoint>& out) {
  const Plane plane(X_ab);
  if (plane.h.dot(a.support(-plane.h) - plane.p) - a.radius > cutoff) return;
  a.plane_points(-plane.h, scratch.points);
  for (const FeaturePoint& x : scratch.points) plane.add(x.p, a.around(-plane.h, x.id), x.id, cutoff, out);
}

void surface_half_space_contacts(const Surface& a, const Relative& X_ab, double cutoff,
                                 std::vector<ManifoldPoint>& out) {
  const Plane plane(X_ab);
  for (std::size_t i = 0; i < a.vertices.size(); ++i)
    plane.add(a.vertices[i], {}, static_cast<int>(i), cutoff, out);
}

}  // namespace taut::detail
