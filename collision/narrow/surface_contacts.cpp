#include <algorithm>
#include <cmath>

#include "collision/narrow/narrow_phase.h"

namespace taut::detail {
namespace {

/// Sides of triangles that meet in the surface are not there for whoever touches it (internal edges): a
/// contact on an edge or corner of triangle t keeps its normal n only within the cone between the normals of
/// the faces that meet there.  What a contact with that normal comes to:
enum class Verdict { kKeep, kUseFace, kLeaveToNeighbour };

Verdict judge(const Surface& surface, int t, const Vec3& n) {
  const auto& corner = surface.triangles[t];
  const Vec3& f = surface.normals[t];
  Verdict verdict = Verdict::kKeep;
  for (int i = 0; i < 3; ++i) {
    const Vec3 edge = (surface.vertices[corner[(i + 1) % 3]] - surface.vertices[corner[i]]).normalized();
    const Vec3 outward = edge.cross(f);  // in the plane of t, away from it
    const double lean = n.dot(outward);
    if (lean <= 1e-9) continue;  // n does not lean over this edge
    const EdgeKind kind = surface.edges[t][i];
    if (kind == EdgeKind::kFlat || kind == EdgeKind::kConcave) return Verdict::kUseFace;
    if (kind == EdgeKind::kBoundary) continue;
    const Vec3& g = surface.normals[surface.neighbours[t][i]];
    const double beyond = std::atan2(lean, n.dot(f)) - std::atan2(g.dot(outward), g.dot(f));
    if (beyond > 1e-9) verdict = Verdict::kLeaveToNeighbour;
  }
  return verdict;
}

/// Whether n leans over a convex edge of triangle t.
bool leans_over_convex_edge(const Surface& surface, int t, const Vec3& n) {
  const auto& corner = surface.triangles[t];
  for (int i = 0; i < 3; ++i) {
    const Vec3 edge = surface.vertices[corner[(i + 1) % 3]] - surface.vertices[corner[i]];
    if (surface.edges[t][i] == EdgeKind::kConvex && n.dot(edge.normalized().cross(surface.normals[t])) > 1e-9)
      return true;
  }
  return false;
}

/// Puts the triangle's number into the ids of its contacts: eight codes per triangle, corners 0–2, edges 3–5.
void name_triangle(std::vector<ManifoldPoint>& points, std::size_t first, int t) {
  for (std::size_t i = first; i < points.size(); ++i) {
    const Meeting meeting = meeting_of(points[i].id);
    const std::uint64_t of_A = side_A(points[i].id), of_B = side_B(points[i].id);
    std::uint64_t code = meeting == Meeting::kVertexA ? of_A : 7;
    if (meeting == Meeting::kEdges) code = of_A == edge_id(0, 1) ? 3 : of_A == edge_id(1, 2) ? 4 : 5;
    points[i].id = contact_id(meeting, 8 * static_cast<std::uint64_t>(t) + code, of_B);
  }
}

/// Points on edges that are not edges of the surface bound nothing: a box across the diagonal of a flat
/// square has its corners only.
void drop_inner_points(const Surface& surface, int t, std::vector<ManifoldPoint>& points, std::size_t first) {
  const auto flat = [&](std::uint64_t edge) { return surface.edges[t][edge] == EdgeKind::kFlat; };
  const auto inner = [&](const ManifoldPoint& point) {
    const Meeting meeting = meeting_of(point.id);
    const std::uint64_t code = side_A(point.id) & 7;
    if (meeting == Meeting::kEdges) return flat(code - 3);
    return meeting == Meeting::kVertexA && flat(code) && flat((code + 2) % 3);
  };
  points.erase(std::remove_if(points.begin() + static_cast<std::ptrdiff_t>(first), points.end(), inner),
               points.end());
}

/// One of several points in one place with one normal, the deepest: triangles share edges and corners.
void drop_twins(std::vector<ManifoldPoint>& points, std::size_t first, double near) {
  std::size_t kept = first;
  for (std::size_t i = first; i < points.size(); ++i) {
    bool twin = false;
    for (std::size_t k = first; k < kept && !twin; ++k) {
      twin = (points[k].q - points[i].q).norm() < near && points[k].n.dot(points[i].n) > 1 - 1e-6;
      if (twin && points[i].gap < points[k].gap - 1e-12) points[k] = points[i];
    }
    if (!twin) points[kept++] = points[i];
  }
  points.erase(points.begin() + static_cast<std::ptrdiff_t>(kept), points.end());
}

}  // namespace

void surface_contacts(const Surface& surface, const Convex& b, const Relative& X, double cutoff,
                      NarrowScratch& work, std::vector<ManifoldPoint>& out) {
  const std::size_t first = out.size();
  Vec3 low, high;
  for (int i = 0; i < 3; ++i) {
    const Vec3 d = X.R.row(i);
    high[i] = X.p[i] + d.dot(b.support(d)) + b.radius + cutoff;
    low[i] = X.p[i] + d.dot(b.support(-d)) - b.radius - cutoff;
  }
  const Vec3 centre = X.p + X.R * b.centre;
  surface.overlapping(low, high, work.triangles);
  for (int t : work.triangles) {
    const auto& corner = surface.triangles[t];
    const Vec3 &a0 = surface.vertices[corner[0]], &f = surface.normals[t];
    const Vec3 deepest = X.p + X.R * b.support(-(X.R.transpose() * f));
    const double s_face = f.dot(deepest - a0) - b.radius;
    if (s_face > cutoff) continue;  // far above the plane
    // In a frame at the triangle, so that round-off does not grow with the mesh.
    set_triangle(work.triangle, Vec3::Zero(), surface.vertices[corner[1]] - a0,
                 surface.vertices[corner[2]] - a0);
    const Relative X_t{X.R, X.p - a0};
    Separation separation;
    if (!find_separation(work.triangle, b, X_t, cutoff, separation)) continue;
    bool face = separation.n.dot(f) > 1 - 1e-12;
    if (!face) {
      const Verdict verdict = judge(surface, t, separation.n);
      if (verdict == Verdict::kLeaveToNeighbour) continue;
      // Nearest is the way through the back, and a body that has sunk in is pushed out through the face; but
      // the normals of sharp edges and corners, as those of a small mesh on a floor, look behind some faces.
      const bool sunk = separation.n.dot(f) < 0 && !leans_over_convex_edge(surface, t, separation.n);
      face = verdict == Verdict::kUseFace || sunk;
      if (face) separation = {f, s_face};
    }
    if (face && f.dot(centre - a0) < 0) continue;  // it has come through from behind
    const std::size_t own = out.size();
    make_manifold(work.triangle, b, X_t, separation, cutoff, face ? Overhang::kNone : Overhang::kDeepest,
                  work.manifold, out);
    for (std::size_t i = own; i < out.size(); ++i) out[i].p += a0, out[i].q += a0;
    name_triangle(out, own, t);
    if (face) drop_inner_points(surface, t, out, own);
  }
  drop_twins(out, first, 1e-5 * b.extent);
}

}  // namespace taut::detail
