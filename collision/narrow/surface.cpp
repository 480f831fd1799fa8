#include "collision/narrow/surface.h"

#include <fcl/geometry/bvh/BVH_model.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace taut::detail {

struct Bvh {
  fcl::BVHModel<fcl::AABBd> model;
};

namespace {

/// Edges bent by less than this [rad] are flat.
constexpr double kFlat = 1e-6;

}  // namespace

Surface::Surface(const TriangleMesh& mesh) : vertices(mesh.vertices), triangles(mesh.triangles) {
  connect();
  bvh_ = std::make_unique<Bvh>();
  std::vector<fcl::Vector3d> points(vertices.begin(), vertices.end());
  std::vector<fcl::Triangle> corners;
  corners.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles)
    corners.emplace_back(static_cast<std::size_t>(a), static_cast<std::size_t>(b),
                         static_cast<std::size_t>(c));
  bvh_->model.beginModel(static_cast<int>(corners.size()), static_cast<int>(points.size()));
  bvh_->model.addSubModel(points, corners);
  bvh_->model.endModel();
}

Surface::Surface(const HeightField& field) : nx_(field.nx), ny_(field.ny), dx_(field.dx), dy_(field.dy) {
  solid_below = true;
  for (int j = 0; j < ny_; ++j)
    for (int i = 0; i < nx_; ++i)
      vertices.emplace_back((i - 0.5 * (nx_ - 1)) * dx_, (j - 0.5 * (ny_ - 1)) * dy_,
                            field.heights[static_cast<std::size_t>(i) + static_cast<std::size_t>(nx_) * j]);
  // Two triangles per cell, below and above the diagonal from (i, j) to (i+1, j+1).
  for (int j = 0; j + 1 < ny_; ++j)
    for (int i = 0; i + 1 < nx_; ++i) {
      const int at = i + nx_ * j;
      triangles.push_back({at, at + 1, at + nx_ + 1});
      triangles.push_back({at, at + nx_ + 1, at + nx_});
    }
  connect();
}

Surface::~Surface() = default;

void Surface::connect() {
  low = high = vertices[triangles[0][0]];
  const int count = static_cast<int>(triangles.size());
  normals.resize(triangles.size());
  neighbours.assign(triangles.size(), {-1, -1, -1});
  edges.assign(triangles.size(), {EdgeKind::kBoundary, EdgeKind::kBoundary, EdgeKind::kBoundary});
  // Triangle and edge that walk from one vertex to another; −2 if there are several.
  std::unordered_map<std::uint64_t, int> walker;
  const auto key = [](int from, int to) {
    return static_cast<std::uint64_t>(from) << 32 | static_cast<std::uint32_t>(to);
  };
  for (int t = 0; t < count; ++t) {
    const auto& c = triangles[t];
    normals[t] = (vertices[c[1]] - vertices[c[0]]).cross(vertices[c[2]] - vertices[c[0]]).normalized();
    for (int i = 0; i < 3; ++i) {
      low = low.cwiseMin(vertices[c[i]]), high = high.cwiseMax(vertices[c[i]]);
      const auto [entry, fresh] = walker.emplace(key(c[i], c[(i + 1) % 3]), t);
      if (!fresh) entry->second = -2;
    }
  }
  for (int t = 0; t < count; ++t)
    for (int i = 0; i < 3; ++i) {
      const int from = triangles[t][i], to = triangles[t][(i + 1) % 3];
      const auto other = walker.find(key(to, from));
      if (walker.at(key(from, to)) != t || other == walker.end() || other->second < 0) continue;
      const int n = other->second;
      neighbours[t][i] = n;
      // The neighbour's normal leans outwards over a convex edge: (f × g)·e > 0.
      const Vec3 edge = (vertices[to] - vertices[from]).normalized();
      const double bend = std::atan2(normals[t].cross(normals[n]).dot(edge), normals[t].dot(normals[n]));
      edges[t][i] = std::abs(bend) < kFlat ? EdgeKind::kFlat
                    : bend > 0             ? EdgeKind::kConvex
                                           : EdgeKind::kConcave;
    }
}

int Surface::triangle_above(const Vec3& point) const {
  if (!solid_below) return -1;
  const double x = point.x() / dx_ + 0.5 * (nx_ - 1), y = point.y() / dy_ + 0.5 * (ny_ - 1);
  if (!(x >= 0 && x < nx_ - 1 && y >= 0 && y < ny_ - 1)) return -1;
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const int t = 2 * (i + (nx_ - 1) * j) + (y - j > x - i);
  return normals[t].dot(point - vertices[triangles[t][0]]) < 0 ? t : -1;
}

void Surface::overlapping(const Vec3& from, const Vec3& to, std::vector<int>& out) const {
  out.clear();
  const auto meets = [&](int t) {
    const Vec3 &a = vertices[triangles[t][0]], &b = vertices[triangles[t][1]], &c = vertices[triangles[t][2]];
    return (a.cwiseMin(b).cwiseMin(c).array() <= to.array()).all() &&
           (a.cwiseMax(b).cwiseMax(c).array() >= from.array()).all();
  };
  if (bvh_) {
    // FCL's tree, walked here: its own walks copy the mesh at each call.
    const fcl::AABBd box(from, to);
    int stack[128];
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const auto& node = bvh_->model.getBV(stack[--depth]);
      if (!node.bv.overlap(box)) continue;
      if (node.isLeaf()) {
        if (meets(node.primitiveId())) out.push_back(node.primitiveId());
      } else if (depth + 2 <= 128) {
        stack[depth++] = node.leftChild();
        stack[depth++] = node.rightChild();
      }
    }
    std::sort(out.begin(), out.end());
    return;
  }
  const auto cell = [](double x, double d, int n) {
    return static_cast<int>(std::clamp(std::floor(x / d + 0.5 * (n - 1)), -1.0, static_cast<double>(n - 1)));
  };
  const int i0 = std::max(0, cell(from.x(), dx_, nx_)), i1 = std::min(nx_ - 2, cell(to.x(), dx_, nx_));
  const int j0 = std::max(0, cell(from.y(), dy_, ny_)), j1 = std::min(ny_ - 2, cell(to.y(), dy_, ny_));
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i)
      for (int half = 0; half < 2; ++half) {
        const int t = 2 * (i + (nx_ - 1) * j) + half;
        out.push_back(t);  // whatever is below is inside
      }
}

}  // namespace taut::detail
