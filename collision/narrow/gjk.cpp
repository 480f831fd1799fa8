#include "collision/narrow/gjk.h"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/geometry/shape/triangle_p.h>
#include <fcl/narrowphase/detail/convexity_based_algorithm/gjk.h>

#include <cmath>
#include <exception>

// FCL's version of libccd, compiled here without its assertions: those in the library end the process where
// round-off, or lengths of very different sizes, break what they state.  The certificate judges the answer.
#ifdef NDEBUG
#include <fcl/narrowphase/detail/convexity_based_algorithm/gjk_libccd-inl.h>
#else
#define NDEBUG
#include <assert.h>  // anew, now that they are to be left out
#include <fcl/narrowphase/detail/convexity_based_algorithm/gjk_libccd-inl.h>
#undef NDEBUG
#include <cassert>
#endif

namespace taut::detail {

/// FCL's geometry of a core.  FCL centres a cone at half its height, taut at its centre of mass.
struct GjkCore {
  std::shared_ptr<fcl::ShapeBased> geometry;
  Vec3 offset = Vec3::Zero();
  fcl::TriangleP<double>* triangle = nullptr;
};

namespace {

/// Enough for any pair seen; a solver that needs more has lost its way and the certificate tells.
constexpr unsigned kIterations = 128;

/// From A to B.
struct Answer {
  Vec3 n = Vec3::UnitZ();
  double distance = 0;
};

std::shared_ptr<fcl::ShapeBased> fcl_polyhedron(const Polyhedron& hull) {
  auto vertices = std::make_shared<std::vector<fcl::Vector3d>>(hull.vertices.begin(), hull.vertices.end());
  auto faces = std::make_shared<std::vector<int>>();
  for (const auto& face : hull.faces) {
    faces->push_back(static_cast<int>(face.size()));
    faces->insert(faces->end(), face.begin(), face.end());
  }
  return std::make_shared<fcl::Convexd>(vertices, static_cast<int>(hull.faces.size()), faces);
}

fcl::Transform3d transform(const Mat3& R, const Vec3& p) {
  fcl::Transform3d X = fcl::Transform3d::Identity();
  X.linear() = R;
  X.translation() = p;
  return X;
}

double separation(const Convex& A, const Convex& B, const Relative& X, const Vec3& shift, const Vec3& n) {
  return n.dot(X.p + shift + X.R * B.support(-(X.R.transpose() * n)) - A.support(n));
}

/// FCL's own GJK.  Its tolerances are absolute [m, m²], hence the size of the pair.
bool ask_fcl(const Convex& A, const Convex& B, const Relative& X, const Vec3& shift, const Vec3& guess,
             double size, Answer& answer) {
  fcl::detail::MinkowskiDiff<double> difference;
  difference.shapes[0] = A.gjk->geometry.get();
  difference.shapes[1] = B.gjk->geometry.get();
  difference.toshape1 = X.R.transpose();
  difference.toshape0 = transform(X.R, X.p + shift + X.R * B.gjk->offset - A.gjk->offset);
  fcl::detail::GJK<double> gjk(kIterations, 1e-12 * std::min(1.0, size * size));
  const auto status = gjk.evaluate(difference, -guess);
  // After `Failed`, out of iterations, the ray is still the best one so far: the certificate judges it.
  if (status == fcl::detail::GJK<double>::Inside) return false;
  const double distance = gjk.ray.norm();
  if (!(distance > 0)) return false;
  answer = {-gjk.ray / distance, distance};
  return true;
}

/// A shape as libccd sees it: its support function, in the frame of A.  (FCL's own objects are allocated anew
/// for each question.)
struct CcdShape {
  const Convex& body;
  Mat3 R;
  Vec3 p;

  static void support(const void* shape, const ccd_vec3_t* direction, ccd_vec3_t* point) {
    const auto& [body, R, p] = *static_cast<const CcdShape*>(shape);
    const double* d = direction->v;
    const Vec3 farthest = p + R * body.support(R.transpose() * Vec3(d[0], d[1], d[2]));
    ccdVec3Set(point, farthest.x(), farthest.y(), farthest.z());
  }
};

bool ask_libccd(const Convex& A, const Convex& B, const Relative& X, const Vec3& shift, Answer& answer) {
  CcdShape a{A, Mat3::Identity(), Vec3::Zero()}, b{B, X.R, X.p + shift};
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = &CcdShape::support;
  ccd.max_iterations = kIterations;
  ccd.dist_tolerance = ccd.epa_tolerance = 1e-12;
  ccd_vec3_t p, q;
  ccdVec3Set(&p, 0, 0, 0);
  ccdVec3Set(&q, 0, 0, 0);
  try {
    if (fcl::detail::libccd_extension::ccdGJKDist2(&a, &b, &ccd, &p, &q) < 0) return false;
  } catch (const std::exception&) {  // FailedAtThisConfiguration
    return false;
  }
  const Vec3 way = Vec3(q.v[0], q.v[1], q.v[2]) - Vec3(p.v[0], p.v[1], p.v[2]);
  const double length = way.norm();
  if (!(length > 0)) return false;
  answer = {way / length, length};
  return true;
}

}  // namespace

void attach_gjk(Convex& body) {
  body.gjk = std::make_shared<GjkCore>();
  GjkCore& core = *body.gjk;
  const Vec3& h = body.half;
  switch (body.kind) {
    case Convex::Kind::kPoint:
      core.geometry = std::make_shared<fcl::Sphered>(0.0);
      break;
    case Convex::Kind::kSegment:
      core.geometry = std::make_shared<fcl::Capsuled>(0.0, 2 * h.z());
      break;
    case Convex::Kind::kBox:
      core.geometry = std::make_shared<fcl::Boxd>(2 * h.x(), 2 * h.y(), 2 * h.z());
      break;
    case Convex::Kind::kCylinder:
      core.geometry = std::make_shared<fcl::Cylinderd>(h.x(), 2 * h.z());
      break;
    case Convex::Kind::kCone:
      core.geometry = std::make_shared<fcl::Coned>(h.x(), h.z());
      core.offset = {0, 0, h.z() / 4};
      break;
    case Convex::Kind::kEllipsoid:
      core.geometry = std::make_shared<fcl::Ellipsoidd>(h.x(), h.y(), h.z());
      break;
    case Convex::Kind::kPolyhedron:
      if (body.hull.vertices.size() > 3) {
        core.geometry = fcl_polyhedron(body.hull);
      } else {
        const auto triangle = std::make_shared<fcl::TriangleP<double>>(
            body.hull.vertices[0], body.hull.vertices[1], body.hull.vertices[2]);
        core.triangle = triangle.get();
        core.geometry = triangle;
      }
      break;
  }
}

void update_gjk_triangle(Convex& body) {
  fcl::TriangleP<double>& t = *body.gjk->triangle;
  t.a = body.hull.vertices[0], t.b = body.hull.vertices[1], t.c = body.hull.vertices[2];
}

bool shortest_direction(const Convex& A, const Convex& B, const Relative& X, const Vec3& shift,
                        const Vec3& guess, Vec3& n, bool second_opinion) {
  const double size = A.extent + B.extent;
  double smaller = size;
  for (const double extent : {A.extent, B.extent})
    if (extent > 0) smaller = std::min(smaller, extent);
  // What is polished afterwards need not be exact here.
  const double certificate = (A.curved() || B.curved() ? 1e-5 : 1e-8) * size;
  Answer first, second;
  const bool found = ask_fcl(A, B, X, shift, guess, smaller, first);
  double s_first = -1;
  if (found) {
    n = first.n;
    s_first = separation(A, B, X, shift, n);
    if (std::abs(s_first - first.distance) <= certificate) return true;
  } else {
    n = guess;
  }
  if (second_opinion && ask_libccd(A, B, X, shift, second) && separation(A, B, X, shift, second.n) > s_first)
    n = second.n;
  return separation(A, B, X, shift, n) > 0;
}

}  // namespace taut::detail
