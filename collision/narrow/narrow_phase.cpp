#include "collision/narrow/narrow_phase.h"

#include <limits>

namespace taut::detail {
namespace {

Relative inverse(const Relative& X) { return {X.R.transpose(), -(X.R.transpose() * X.p)}; }

/// Points found with A and B exchanged, brought back; X maps coordinates of the frame they were found in to
/// the one wanted.
void exchange(std::vector<ManifoldPoint>& points, std::size_t first, const Relative& X) {
  for (std::size_t i = first; i < points.size(); ++i) {
    ManifoldPoint& point = points[i];
    const Vec3 p = X.p + X.R * point.q, q = X.p + X.R * point.p;
    point.p = p, point.q = q, point.n = -(X.R * point.n);
    std::swap(point.surface_A, point.surface_B);
    point.surface_A = point.surface_A.turned(X.R), point.surface_B = point.surface_B.turned(X.R);
  }
}

/// reduce() for each group of neighbouring points with one normal (to about 3°).
void reduce_by_normal(std::vector<ManifoldPoint>& points, std::size_t first, std::size_t most,
                      ManifoldScratch& scratch) {
  for (std::size_t begin = first; begin < points.size();) {
    const Vec3 n = points[begin].n;
    const auto from = points.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto rest = std::stable_partition(from, points.end(),
                                            [&](const ManifoldPoint& p) { return p.n.dot(n) > 0.9986; });
    const std::size_t group = static_cast<std::size_t>(rest - from);
    if (group > most) {
      const std::vector<ManifoldPoint> others(rest, points.end());
      points.erase(rest, points.end());
      reduce(points, begin, most, scratch);
      begin = points.size();
      points.insert(points.end(), others.begin(), others.end());
    } else {
      begin += group;
    }
  }
}

/// Points in the frame of the convex body, which is A.  One whose centre is below a height field is pushed
/// out through the plane of the triangle above it, as from a half-space.
void convex_on_surface(const Convex& body, const Surface& surface, const Relative& X, double cutoff,
                       NarrowScratch& scratch, std::vector<ManifoldPoint>& out) {
  const Relative X_SB = inverse(X);
  const Vec3 centre = X_SB.p + X_SB.R * body.centre;
  if (const int t = surface.triangle_above(centre); t >= 0) {
    Relative plane;
    Vec3 u, v;
    complete_frame(surface.normals[t], u, v);
    plane.R << X.R * u, X.R * v, X.R * surface.normals[t];
    plane.p = X.p + X.R * surface.vertices[surface.triangles[t][0]];
    return half_space_contacts(body, plane, cutoff, scratch, out);
  }
  const std::size_t first = out.size();
  surface_contacts(surface, body, X_SB, cutoff, scratch, out);
  exchange(out, first, X);
}

}  // namespace

void Geometry::bounds(const Pose& X_WS, Vec3& low, Vec3& high) const {
  const Mat3 R = X_WS.q.toRotationMatrix();
  if (kind == Kind::kConvex) {
    // h(±e) of the world's axes: the core's support and the ball.
    for (int i = 0; i < 3; ++i) {
      const Vec3 d = R.row(i);
      high[i] = X_WS.p[i] + d.dot(convex.support(d)) + convex.radius;
      low[i] = X_WS.p[i] + d.dot(convex.support(-d)) - convex.radius;
    }
    return;
  }
  const Vec3 centre = X_WS.point(box_centre), half = R.cwiseAbs() * box_half;
  low = centre - half, high = centre + half;
}

std::unique_ptr<const Geometry> make_geometry(const Shape& shape) {
  auto geometry = std::make_unique<Geometry>();
  if (std::holds_alternative<HalfSpace>(shape)) {
    geometry->kind = Geometry::Kind::kHalfSpace;
    geometry->extent = std::numeric_limits<double>::infinity();
    return geometry;
  }
  if (const auto* mesh = std::get_if<TriangleMesh>(&shape))
    geometry->surface = std::make_unique<Surface>(*mesh);
  else if (const auto* field = std::get_if<HeightField>(&shape))
    geometry->surface = std::make_unique<Surface>(*field);
  if (geometry->surface) {
    geometry->kind = Geometry::Kind::kSurface;
    Vec3 low = geometry->surface->low;
    const Vec3& high = geometry->surface->high;
    // All below a height field is inside: as deep as it is wide.
    if (geometry->surface->solid_below) low.z() -= (high - low).norm();
    geometry->box_centre = (low + high) / 2;
    geometry->box_half = (high - low) / 2;
    geometry->extent = geometry->box_centre.norm() + geometry->box_half.norm();
  } else {
    geometry->kind = Geometry::Kind::kConvex;
    geometry->convex = make_convex(shape);
    geometry->extent = geometry->convex.extent;
  }
  return geometry;
}

void find_contacts(const Geometry& a, const Geometry& b, const Relative& X_ab, double cutoff,
                   std::size_t most, NarrowScratch& scratch, std::vector<ManifoldPoint>& out) {
  using Kind = Geometry::Kind;
  const std::size_t first = out.size();
  if (a.kind == Kind::kHalfSpace || (a.kind == Kind::kSurface && b.kind == Kind::kConvex)) {
    const Relative X_ba = inverse(X_ab);
    if (a.kind == Kind::kSurface)
      convex_on_surface(b.convex, *a.surface, X_ba, cutoff, scratch, out);
    else if (b.kind == Kind::kConvex)
      half_space_contacts(b.convex, X_ba, cutoff, scratch, out);
    else
      surface_half_space_contacts(*b.surface, X_ba, cutoff, out);
    exchange(out, first, X_ab);
  } else if (a.kind == Kind::kSurface) {
    surface_half_space_contacts(*a.surface, X_ab, cutoff, out);
  } else if (b.kind == Kind::kSurface) {
    convex_on_surface(a.convex, *b.surface, X_ab, cutoff, scratch, out);
  } else if (b.kind == Kind::kHalfSpace) {
    half_space_contacts(a.convex, X_ab, cutoff, scratch, out);
  } else {
    Separation separation;
    if (find_separation(a.convex, b.convex, X_ab, cutoff, separation))
      make_manifold(a.convex, b.convex, X_ab, separation, cutoff, Overhang::kDeepest, scratch.manifold, out);
  }
  if (out.size() - first > most) reduce_by_normal(out, first, most, scratch.manifold);
}

}  // namespace taut::detail
