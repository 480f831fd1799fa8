#include "core/math/convex_hull.h"

#include <algorithm>
#include <array>
#include <map>

#include "core/base/check.h"

namespace taut {
namespace {

struct Facet {
  std::array<int, 3> corner;
  Vec3 normal;
  double offset;
  std::vector<int> outside;  // points above it that no other facet owns
  bool alive = true;
};

class QuickHull {
 public:
  explicit QuickHull(std::span<const Vec3> points) : points_(points) {
    Vec3 low = points[0], high = points[0];
    for (const Vec3& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
    extent_ = (high - low).norm();
    tolerance_ = 1e-10 * extent_;
  }

  void run() {
    start();
    for (std::size_t f = 0; f < facets_.size(); ++f)
      while (facets_[f].alive && !facets_[f].outside.empty()) add_farthest(f);
  }

  std::vector<Facet> facets_;
  double extent_, tolerance_;

 private:
  double height(const Facet& facet, int point) const {
    return facet.normal.dot(points_[point]) - facet.offset;
  }

  std::size_t add_facet(int a, int b, int c) {
    const Vec3 normal = (points_[b] - points_[a]).cross(points_[c] - points_[a]).normalized();
    const double offset = normal.dot(points_[a] + points_[b] + points_[c]) / 3;
    const std::size_t index = facets_.size();
    facets_.push_back({{a, b, c}, normal, offset, {}});
    facet_of_edge_[{a, b}] = facet_of_edge_[{b, c}] = facet_of_edge_[{c, a}] = index;
    return index;
  }

  /// The index with the largest value; the first one of equals.
  template <typename Value>
  int farthest(Value value) const {
    int best = 0;
    for (int i = 1; i < static_cast<int>(points_.size()); ++i)
      if (value(points_[i]) > value(points_[best])) best = i;
    return best;
  }

  /// A tetrahedron of points that are far from each other.
  void start() {
    const int a = farthest([&](const Vec3& p) { return (p - points_[0]).squaredNorm(); });
    const int b = farthest([&](const Vec3& p) { return (p - points_[a]).squaredNorm(); });
    const Vec3 ab = points_[b] - points_[a];
    int c = farthest([&](const Vec3& p) { return ab.cross(p - points_[a]).squaredNorm(); });
    const Vec3 normal = ab.cross(points_[c] - points_[a]);
    const int d = farthest([&](const Vec3& p) { return std::abs(normal.dot(p - points_[a])); });
    const double volume = normal.dot(points_[d] - points_[a]);
    // Written so that a volume that is not a number counts as none.
    if (!(normal.norm() > 1e-8 * extent_ * extent_) || !(std::abs(volume) > 1e-8 * extent_ * normal.norm()))
      fail("convex hull",
           "hull without volume: all points in one plane, on a line or in one place; extent [m]", extent_);
    int first = b;
    if (volume > 0) std::swap(first, c);  // d is to be below the facet a, first, c
    add_facet(a, first, c);
    add_facet(a, c, d);
    add_facet(c, first, d);
    add_facet(first, a, d);
    std::vector<int> all(points_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
    distribute(all, 0);
  }

  /// Each point goes to the facet, of those from `first` on, that it lies highest above.
  void distribute(const std::vector<int>& points, std::size_t first) {
    for (int p : points) {
      double best = tolerance_;
      std::size_t owner = facets_.size();
      for (std::size_t f = first; f < facets_.size(); ++f)
        if (const double h = height(facets_[f], p); h > best) best = h, owner = f;
      if (owner < facets_.size()) facets_[owner].outside.push_back(p);
    }
  }

  /// Replaces what the farthest point of facet f sees by a cone from that point to the horizon.
  void add_farthest(std::size_t f) {
    const std::vector<int>& candidates = facets_[f].outside;
    int eye = candidates[0];
    for (int p : candidates)
      if (height(facets_[f], p) > height(facets_[f], eye)) eye = p;
    std::vector<std::size_t> visible{f};
    std::vector<std::pair<int, int>> horizon;
    std::vector<int> orphans;
    facets_[f].alive = false;
    for (std::size_t k = 0; k < visible.size(); ++k) {
      const std::array<int, 3> corner = facets_[visible[k]].corner;
      for (int i = 0; i < 3; ++i) {
        const int from = corner[i], to = corner[(i + 1) % 3];
        const std::size_t next = facet_of_edge_.at({to, from});
        if (!facets_[next].alive) continue;
        if (height(facets_[next], eye) > tolerance_) {
          facets_[next].alive = false;
          visible.push_back(next);
        }
      }
    }
    for (std::size_t v : visible) {
      for (int i = 0; i < 3; ++i) {
        const int from = facets_[v].corner[i], to = facets_[v].corner[(i + 1) % 3];
        if (facets_[facet_of_edge_.at({to, from})].alive) horizon.push_back({from, to});
      }
      orphans.insert(orphans.end(), facets_[v].outside.begin(), facets_[v].outside.end());
      facets_[v].outside = {};
    }
    std::erase(orphans, eye);
    const std::size_t first = facets_.size();
    for (const auto& [from, to] : horizon) add_facet(from, to, eye);
    distribute(orphans, first);
  }

  std::span<const Vec3> points_;
  std::map<std::pair<int, int>, std::size_t> facet_of_edge_;
};

/// Groups of facets in one plane: flood from the largest facets, so that a sliver never defines a plane.
std::vector<int> plane_of_facet(const QuickHull& hull, const std::vector<std::size_t>& alive,
                                const std::map<std::pair<int, int>, std::size_t>& facet_of_edge,
                                std::span<const Vec3> points, std::vector<std::size_t>& seeds) {
  const auto area = [&](std::size_t f) {
    const auto& c = hull.facets_[f].corner;
    return (points[c[1]] - points[c[0]]).cross(points[c[2]] - points[c[0]]).norm();
  };
  std::vector<std::size_t> order = alive;
  std::stable_sort(order.begin(), order.end(), [&](auto f, auto g) { return area(f) > area(g); });
  std::vector<int> plane(hull.facets_.size(), -1);
  for (std::size_t seed : order) {
    if (plane[seed] >= 0) continue;
    const int id = static_cast<int>(seeds.size());
    seeds.push_back(seed);
    plane[seed] = id;
    std::vector<std::size_t> front{seed};
    while (!front.empty()) {
      const auto corner = hull.facets_[front.back()].corner;
      front.pop_back();
      for (int i = 0; i < 3; ++i) {
        const std::size_t next = facet_of_edge.at({corner[(i + 1) % 3], corner[i]});
        if (plane[next] >= 0) continue;
        const Facet& reference = hull.facets_[seed];
        bool on_plane = true;
        for (int c : hull.facets_[next].corner)
          on_plane &= std::abs(reference.normal.dot(points[c]) - reference.offset) <= 20 * hull.tolerance_;
        if (!on_plane) continue;
        plane[next] = id;
        front.push_back(next);
      }
    }
  }
  return plane;
}

/// The boundary of each plane as a loop of points: edges between facets of one plane vanish, and so do points
/// of only two planes, which lie on an edge.
std::vector<std::map<int, int>> boundary_loops(
    const std::map<std::pair<int, int>, std::size_t>& facet_of_edge, const std::vector<int>& plane,
    std::size_t plane_count) {
  std::vector<std::map<int, int>> next(plane_count);
  for (const auto& [edge, f] : facet_of_edge)
    if (plane[facet_of_edge.at({edge.second, edge.first})] != plane[f])
      next[plane[f]][edge.first] = edge.second;
  std::map<int, int> planes_of_point;
  for (const auto& loop : next)
    for (const auto& [from, to] : loop) ++planes_of_point[from];
  for (auto& loop : next) {
    for (auto& [from, to] : loop)
      while (planes_of_point.at(to) < 3 && to != from) to = loop.at(to);
    std::erase_if(loop, [&](const auto& edge) { return planes_of_point.at(edge.first) < 3; });
  }
  return next;
}

/// Newell's normal over the whole polygon is exacter than that of any of its triangles.
void add_face(Polyhedron& hull, std::vector<int> face) {
  Vec3 normal = Vec3::Zero(), centre = Vec3::Zero();
  const Vec3& origin = hull.vertices[face[0]];
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Vec3 p = hull.vertices[face[i]] - origin;
    normal += p.cross(hull.vertices[face[(i + 1) % face.size()]] - origin);
    centre += hull.vertices[face[i]];
  }
  normal.normalize();
  hull.normals.push_back(normal);
  hull.offsets.push_back(normal.dot(centre) / static_cast<double>(face.size()));
  hull.faces.push_back(std::move(face));
}

}  // namespace

Polyhedron convex_hull(std::span<const Vec3> points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    require_all_finite("convex hull point " + std::to_string(i), points[i]);
  if (points.size() < 4) fail("convex hull", "needs at least four points", points.size());
  QuickHull hull(points);
  hull.run();

  std::vector<std::size_t> alive;
  std::map<std::pair<int, int>, std::size_t> facet_of_edge;
  for (std::size_t f = 0; f < hull.facets_.size(); ++f) {
    if (!hull.facets_[f].alive) continue;
    alive.push_back(f);
    const auto& c = hull.facets_[f].corner;
    for (int i = 0; i < 3; ++i) facet_of_edge[{c[i], c[(i + 1) % 3]}] = f;
  }
  std::vector<std::size_t> seeds;
  const std::vector<int> plane = plane_of_facet(hull, alive, facet_of_edge, points, seeds);
  const auto next = boundary_loops(facet_of_edge, plane, seeds.size());

  Polyhedron result;
  std::map<int, int> corner_of_point;
  for (const auto& loop : next)
    for (const auto& [from, to] : loop) corner_of_point[from] = 0;
  for (auto& [point, corner] : corner_of_point) {
    corner = static_cast<int>(result.vertices.size());
    result.vertices.push_back(points[point]);
  }
  for (const auto& loop : next) {
    if (loop.size() < 3) continue;  // a sliver along an edge
    std::vector<int> face;
    int at = loop.begin()->first;
    for (std::size_t i = 0; i < loop.size(); ++i, at = loop.at(at)) face.push_back(corner_of_point.at(at));
    add_face(result, std::move(face));
  }
  return result;
}

}  // namespace taut
