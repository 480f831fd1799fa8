#include "collision/narrow/convex.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "collision/narrow/gjk.h"

namespace taut::detail {
namespace {

constexpr double kRidgeTolerance = 1e-4;
constexpr int kRimPoints = 8;
/// A disc that leans by less stands on points that are fixed in it, and does not roll on its rim [rad].
constexpr double kUprightRim = 0.02;

/// Where the rim of radius r is farthest in the direction d; on the axis if d is along it.
Vec3 rim_point(double r, double z, const Vec3& d) {
  const double across = std::hypot(d.x(), d.y());
  if (across == 0) return {0, 0, z};
  return {r * d.x() / across, r * d.y() / across, z};
}

/// Eight points fixed in the body; the one next to the deepest point gives way to it.  An exactly upright
/// disc (tilt below 1e-6 rad) has no deepest point.  Ids: first … first + 7, and first + 8.
void rim_points(double r, double z, const Vec3& d, int first, std::vector<FeaturePoint>& out) {
  const bool tilted = std::hypot(d.x(), d.y()) > 1e-6;
  const double step = 2 * std::numbers::pi / kRimPoints;
  int nearest = -1;
  if (tilted) {
    nearest = static_cast<int>(std::lround(std::atan2(d.y(), d.x()) / step));
    nearest = (nearest + kRimPoints) % kRimPoints;
  }
  for (int k = 0; k < kRimPoints; ++k) {
    if (k == nearest)
      out.push_back({rim_point(r, z, d), first + kRimPoints});
    else
      out.push_back({{r * std::cos(k * step), r * std::sin(k * step), z}, first + k});
  }
}

// Ids of corners of a cylinder or cone: rims, then the points of a generator.
constexpr int kTopRim = 0, kBottomRim = 10, kTopEnd = 20, kBottomEnd = 21;

/// The slant of a cone: its outward normal has the elevation asin(sine) above the base plane.
struct Slant {
  double sine, cosine;
  explicit Slant(const Vec3& half) {
    const double length = std::hypot(half.x(), half.z());
    sine = half.x() / length, cosine = half.z() / length;
  }
};
Vec3 apex(const Vec3& half) { return {0, 0, 0.75 * half.z()}; }

void box_face(const Vec3& half, const Vec3& d, Feature& out) {
  Eigen::Index axis;
  d.cwiseAbs().maxCoeff(&axis);
  const double sign = d[axis] >= 0 ? 1 : -1;
  const int u = static_cast<int>(axis + 1) % 3, v = static_cast<int>(axis + 2) % 3;
  out.normal = sign * Vec3::Unit(axis);
  const int loop[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  for (int k = 0; k < 4; ++k) {
    const int* at = loop[sign > 0 ? k : 3 - k];
    Vec3 p;
    p[axis] = sign * half[axis], p[u] = at[0] * half[u], p[v] = at[1] * half[v];
    const int id = (p.x() > 0) | (p.y() > 0) << 1 | (p.z() > 0) << 2;
    out.points.push_back({p, id});
  }
}

/// Of the faces at the farthest corner the one that faces d best; if that is seen nearly edge-on, its edge
/// farthest along d.
void hull_face(const Polyhedron& hull, const Vec3& corner, double extent, const Vec3& d, Feature& out) {
  std::size_t best = 0;
  double alignment = -2;
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    if (hull.offsets[f] - hull.normals[f].dot(corner) > 1e-8 * extent) continue;
    if (const double a = hull.normals[f].dot(d); a > alignment) best = f, alignment = a;
  }
  const std::vector<int>& face = hull.faces[best];
  out.normal = hull.normals[best];
  if (out.normal.dot(d) > 0.2) {
    for (int v : face) out.points.push_back({hull.vertices[v], v});
    return;
  }
  std::size_t top = 0;
  double height = -1e300;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const std::size_t j = (i + 1) % face.size();
    const double h = d.dot(hull.vertices[face[i]] + hull.vertices[face[j]]);
    if (h > height) height = h, top = i;
  }
  for (int v : {face[top], face[(top + 1) % face.size()]}) out.points.push_back({hull.vertices[v], v});
}

/// Cap as a polygon, side as a generator.
void cylinder_feature(const Vec3& half, const Vec3& d, Feature& out) {
  if (std::abs(d.z()) > std::numbers::sqrt2 / 2) {
    const bool top = d.z() > 0;
    rim_points(half.x(), top ? half.z() : -half.z(), d, top ? kTopRim : kBottomRim, out.points);
    if (!top) std::reverse(out.points.begin(), out.points.end());
    out.normal = {0, 0, top ? 1.0 : -1.0};
    out.disc = half.x(), out.centre = {0, 0, top ? half.z() : -half.z()};
  } else {
    out.points.push_back({rim_point(half.x(), half.z(), d), kTopEnd});
    out.points.push_back({rim_point(half.x(), -half.z(), d), kBottomEnd});
    out.rounding = half.x();
  }
}

/// Base as a polygon, apex as a point, side as a generator.
void cone_feature(const Vec3& half, const Vec3& d, Feature& out) {
  const Slant slant(half);
  // Halfway between the normals of base and side; beyond the side by as much as makes the apex the contact.
  const double base_limit = -std::cos(0.5 * (std::numbers::pi / 2 + std::asin(slant.sine)));
  const double apex_limit = std::sin(std::min(std::asin(slant.sine) + 0.2, std::numbers::pi / 2 - 1e-3));
  if (d.z() < base_limit) {
    rim_points(half.x(), -0.25 * half.z(), d, kBottomRim, out.points);
    std::reverse(out.points.begin(), out.points.end());
    out.normal = {0, 0, -1};
    out.disc = half.x(), out.centre = {0, 0, -0.25 * half.z()};
    return;
  }
  out.points.push_back({apex(half), kTopEnd});
  if (d.z() > apex_limit) return;
  out.points.push_back({rim_point(half.x(), -0.25 * half.z(), d), kBottomEnd});
  out.rounding = 0.5 * half.x() / slant.cosine;
}

/// The first of those that are farthest in the direction d.
const Vec3& farthest_vertex(const std::vector<Vec3>& vertices, const Vec3& d) {
  std::size_t best = 0;
  double height = -1e300;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (const double h = d.dot(vertices[i]); h > height) height = h, best = i;
  return vertices[best];
}

}  // namespace

Vec3 Convex::support(const Vec3& d) const {
  switch (kind) {
    case Kind::kPoint:
      return Vec3::Zero();
    case Kind::kSegment:
      return {0, 0, d.z() >= 0 ? half.z() : -half.z()};
    case Kind::kBox:
      return {d.x() >= 0 ? half.x() : -half.x(), d.y() >= 0 ? half.y() : -half.y(),
              d.z() >= 0 ? half.z() : -half.z()};
    case Kind::kCylinder:
      return rim_point(half.x(), d.z() >= 0 ? half.z() : -half.z(), d);
    case Kind::kCone: {
      const Vec3 rim = rim_point(half.x(), -0.25 * half.z(), d);
      return d.dot(rim) > d.dot(apex(half)) ? rim : apex(half);
    }
    case Kind::kEllipsoid: {
      const Vec3 scaled = half.cwiseAbs2().cwiseProduct(d);
      return scaled / std::sqrt(scaled.dot(d));
    }
    case Kind::kPolyhedron:
      break;
  }
  return farthest_vertex(hull.vertices, d);
}

Mat3 Convex::support_derivative(const Vec3& d) const {
  if (kind == Kind::kEllipsoid) {
    const Vec3 squares = half.cwiseAbs2(), scaled = squares.cwiseProduct(d);
    const double h = std::sqrt(scaled.dot(d));
    return Mat3(squares.asDiagonal()) / h - scaled * scaled.transpose() / (h * h * h);
  }
  const bool on_rim = kind == Kind::kCylinder || (kind == Kind::kCone && support(d).z() < 0);
  const double across = std::hypot(d.x(), d.y());
  if (!on_rim || across == 0) return Mat3::Zero();
  const Vec3 tangent = Vec3(-d.y(), d.x(), 0) / across;
  return half.x() / across * tangent * tangent.transpose();
}

LocalSurface Convex::around(const Vec3& d) const {
  const bool rim = kind == Kind::kCylinder || (kind == Kind::kCone && support(d).z() < 0);
  LocalSurface at{radius};
  if (kind == Kind::kEllipsoid)
    at.squares = half.cwiseAbs2().asDiagonal();
  else if (rim && std::hypot(d.x(), d.y()) > kUprightRim)
    at.squares = (half.x() * half.x() * Vec3(1, 1, 0)).asDiagonal();
  return at;
}

LocalSurface Convex::around(const Vec3& d, int corner) const {
  const bool deepest = corner == kTopRim + kRimPoints || corner == kBottomRim + kRimPoints ||
                       corner == kBottomEnd || (corner == kTopEnd && kind == Kind::kCylinder);
  const bool round =
      kind == Kind::kEllipsoid || ((kind == Kind::kCylinder || kind == Kind::kCone) && deepest);
  return round ? around(d) : LocalSurface{radius};
}

void Convex::feature(const Vec3& d, Feature& out) const {
  out.points.clear();
  out.rounding = out.disc = 0;
  switch (kind) {
    case Kind::kPoint:
      out.points.push_back({Vec3::Zero(), 0});
      break;
    case Kind::kSegment:
      out.points.push_back({half, 0});
      out.points.push_back({-half, 1});
      out.rounding = radius;
      break;
    case Kind::kBox:
      box_face(half, d, out);
      break;
    case Kind::kCylinder:
      cylinder_feature(half, d, out);
      break;
    case Kind::kCone:
      cone_feature(half, d, out);
      break;
    case Kind::kEllipsoid:
      out.points.push_back({support(d), 0});
      break;
    case Kind::kPolyhedron:
      hull_face(hull, support(d), extent, d, out);
      break;
  }
}

void Convex::plane_points(const Vec3& d, std::vector<FeaturePoint>& out) const {
  out.clear();
  if (kind == Kind::kBox) {
    for (int id = 0; id < 8; ++id) {
      const Vec3 sign(id & 1 ? 1 : -1, id & 2 ? 1 : -1, id & 4 ? 1 : -1);
      out.push_back({half.cwiseProduct(sign), id});
    }
  } else if (kind == Kind::kPolyhedron) {
    for (std::size_t i = 0; i < hull.vertices.size(); ++i)
      out.push_back({hull.vertices[i], static_cast<int>(i)});
  } else if (kind == Kind::kSegment) {
    out.push_back({half, 0});
    out.push_back({-half, 1});
  } else if (kind == Kind::kCylinder || kind == Kind::kCone) {
    // A rim that faces the plane touches all around, one seen from the side at its deepest point.
    const bool cone = kind == Kind::kCone;
    const double bottom = cone ? -0.25 * half.z() : -half.z();
    if (cone)
      out.push_back({apex(half), kTopEnd});
    else if (d.z() > 0.5)
      rim_points(half.x(), half.z(), d, kTopRim, out);
    else
      out.push_back({rim_point(half.x(), half.z(), d), kTopEnd});
    if (d.z() < -0.5)
      rim_points(half.x(), bottom, d, kBottomRim, out);
    else
      out.push_back({rim_point(half.x(), bottom, d), kBottomEnd});
  } else {
    out.push_back({support(d), 0});
  }
}

bool Convex::ridge(const Vec3& d, Vec3& on_ridge, Vec3& edge) const {
  if (kind == Kind::kPoint || kind == Kind::kEllipsoid) return false;
  if (kind == Kind::kCone) {
    const Slant slant(half);
    const double across = std::hypot(d.x(), d.y());
    if (across == 0 || std::abs(d.z() - slant.sine) > kRidgeTolerance) return false;
    const Vec3 out = Vec3(d.x(), d.y(), 0) / across;
    on_ridge = slant.cosine * out + slant.sine * Vec3::UnitZ();
    edge = slant.cosine * Vec3::UnitZ() - slant.sine * out;
    return true;
  }
  if (kind == Kind::kPolyhedron) {
    const Vec3 top = support(d);
    double nearest = kRidgeTolerance;
    for (const Vec3& v : hull.vertices) {
      const double length = (top - v).norm();
      if (length == 0 || d.dot(top - v) > nearest * length) continue;
      nearest = d.dot(top - v) / length;
      edge = (top - v) / length;
    }
    if (nearest == kRidgeTolerance) return false;
  } else {
    Eigen::Index axis = 2;
    if (kind == Kind::kBox) d.cwiseAbs().minCoeff(&axis);
    if (std::abs(d[axis]) > kRidgeTolerance) return false;
    edge = Vec3::Unit(axis);
  }
  on_ridge = (d - d.dot(edge) * edge).normalized();
  return true;
}

namespace {

void add_unless_parallel(std::vector<Vec3>& directions, const Vec3& d) {
  for (const Vec3& known : directions)
    if (known.cross(d).norm() < 1e-9) return;
  directions.push_back(d);
}

struct Maker {
  Convex body{};

  void operator()(const Sphere& s) { body.radius = s.radius; }
  void operator()(const Capsule& s) {
    body.kind = s.length > 0 ? Convex::Kind::kSegment : Convex::Kind::kPoint;
    body.half = {0, 0, s.length / 2};
    body.radius = s.radius;
    if (s.length > 0) body.edge_directions = {Vec3::UnitZ()};
  }
  void operator()(const Box& s) {
    body.kind = Convex::Kind::kBox;
    body.half = s.size / 2;
    for (int i = 0; i < 3; ++i) {
      body.face_normals.insert(body.face_normals.end(), {Vec3::Unit(i), -Vec3::Unit(i)});
      body.edge_directions.push_back(Vec3::Unit(i));
    }
  }
  void operator()(const Cylinder& s) {
    body.kind = Convex::Kind::kCylinder;
    body.half = {s.radius, s.radius, s.length / 2};
    body.face_normals = {Vec3::UnitZ(), -Vec3::UnitZ()};
    body.edge_directions = {Vec3::UnitZ()};
  }
  void operator()(const Ellipsoid& s) {
    body.kind = Convex::Kind::kEllipsoid;
    body.half = s.radii;
  }
  void operator()(const Cone& s) {
    body.kind = Convex::Kind::kCone;
    body.half = {s.radius, s.radius, s.height};
    body.face_normals = {-Vec3::UnitZ()};
    body.symmetric = false;
  }
  void operator()(const ConvexHull& s) {
    body.kind = Convex::Kind::kPolyhedron;
    body.hull = convex_hull(s.points);
    body.face_normals = body.hull.normals;
    for (const auto& face : body.hull.faces)
      for (std::size_t i = 0; i < face.size(); ++i) {
        const Vec3 edge = body.hull.vertices[face[(i + 1) % face.size()]] - body.hull.vertices[face[i]];
        add_unless_parallel(body.edge_directions, edge.normalized());
      }
    body.symmetric = false;
    for (const Vec3& v : body.hull.vertices)
      body.centre += v / static_cast<double>(body.hull.vertices.size());
  }
  void operator()(const TriangleMesh&) {}
  void operator()(const HalfSpace&) {}
  void operator()(const HeightField&) {}
};

double extent_of(const Convex& body) {
  double core = body.half.norm();  // box and segment
  if (body.kind == Convex::Kind::kCylinder) core = std::hypot(body.half.x(), body.half.z());
  if (body.kind == Convex::Kind::kEllipsoid) core = body.half.maxCoeff();
  if (body.kind == Convex::Kind::kCone)
    core = std::max(0.75 * body.half.z(), std::hypot(body.half.x(), 0.25 * body.half.z()));
  for (const Vec3& v : body.hull.vertices) core = std::max(core, v.norm());
  return core + body.radius;
}

}  // namespace

Convex make_convex(const Shape& shape) {
  Maker maker;
  std::visit(maker, shape);
  maker.body.extent = extent_of(maker.body);
  attach_gjk(maker.body);
  return std::move(maker.body);
}

Convex make_triangle() {
  Convex body;
  body.kind = Convex::Kind::kPolyhedron;
  body.symmetric = false;
  body.hull.vertices.resize(3);
  body.hull.faces = {{0, 1, 2}, {0, 2, 1}};
  body.hull.normals.resize(2);
  body.hull.offsets.resize(2);
  body.face_normals.resize(2);
  body.edge_directions.resize(3);
  set_triangle(body, Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY());
  attach_gjk(body);
  return body;
}

void set_triangle(Convex& triangle, const Vec3& a, const Vec3& b, const Vec3& c) {
  triangle.hull.vertices = {a, b, c};
  const Vec3 normal = (b - a).cross(c - a).normalized();
  triangle.hull.normals = {normal, -normal};
  triangle.hull.offsets = {normal.dot(a), -normal.dot(a)};
  triangle.face_normals = triangle.hull.normals;
  triangle.edge_directions = {(b - a).normalized(), (c - b).normalized(), (a - c).normalized()};
  triangle.centre = (a + b + c) / 3;
  triangle.extent = std::sqrt(std::max({a.squaredNorm(), b.squaredNorm(), c.squaredNorm()}));
  if (triangle.gjk) update_gjk_triangle(triangle);
}

}  // namespace taut::detail
