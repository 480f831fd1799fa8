#include "collision/narrow/separation.h"

#include <algorithm>
#include <cmath>

#include "collision/narrow/gjk.h"

namespace taut::detail {
namespace {

/// More pairs of edges than this are not tried one by one.
constexpr std::size_t kEdgePairs = 1024;

/// The pair, and s(n) of the cores.
struct Pair {
  const Convex& A;
  const Convex& B;
  const Relative& X;

  /// From the support point of A to that of B.
  Vec3 witness(const Vec3& n) const { return X.p + X.R * B.support(-(X.R.transpose() * n)) - A.support(n); }
  double s(const Vec3& n) const { return n.dot(witness(n)); }
  double size() const { return A.extent + B.extent; }
};

/// The best direction so far, and whether it already proves that the pair is far apart.
struct Best {
  const Pair& pair;
  double cutoff;  ///< of the cores
  Vec3 n = Vec3::UnitZ();
  double s = -1e300;

  /// A later direction must be better by more than round-off, so that ties do not flicker.
  bool try_direction(const Vec3& direction) {
    const double value = pair.s(direction);
    if (value > s + 1e-14 * pair.size()) s = value, n = direction;
    return s > cutoff;
  }
};

/// A core without volume, a point or a segment about the origin along z.
bool is_thin(const Convex& body) {
  return body.kind == Convex::Kind::kPoint || body.kind == Convex::Kind::kSegment;
}

/// From core to core along the shortest line, of two that are thin: no face and no cross product of edges
/// separates segments in one plane.
Vec3 between_thin(const Pair& pair) {
  const double a = pair.A.half.z(), b = pair.B.half.z();
  const Vec3 e = Vec3::UnitZ(), f = pair.X.R.col(2), D = pair.X.p;
  // Nearest places t e and D + w f of the lines, held on the segments in turn.
  const double ef = e.dot(f), sine2 = e.cross(f).squaredNorm();
  double t = sine2 > 1e-14 ? std::clamp((D.dot(e) - D.dot(f) * ef) / sine2, -a, a) : 0;
  double w = std::clamp((t * e - D).dot(f), -b, b);
  t = std::clamp((D + w * f).dot(e), -a, a);
  w = std::clamp((t * e - D).dot(f), -b, b);
  return D + w * f - t * e;
}

/// Directions that separate polytopes if any do: normals of faces, cross products of edges; and for round
/// bodies the lines between centres, across the axes.  True if the pair is found to be far apart.
bool try_candidates(Best& best) {
  const auto& [A, B, X] = best.pair;
  Vec3 between = X.p + X.R * B.centre - A.centre;
  if (!(between.norm() > 1e-9 * best.pair.size())) between = Vec3::UnitZ();
  const bool symmetric = A.symmetric && B.symmetric;
  const auto try_it = [&](const Vec3& n) {
    return symmetric && n.dot(between) < 0 ? false : best.try_direction(n);
  };
  for (const Vec3& f : A.face_normals)
    if (try_it(f)) return true;
  for (const Vec3& f : B.face_normals)
    if (try_it(-(X.R * f))) return true;
  if (best.try_direction(between.normalized())) return true;
  if (is_thin(A) && is_thin(B)) {
    const Vec3 line = between_thin(best.pair);
    if (line.norm() > 1e-12 * best.pair.size() && best.try_direction(line.normalized())) return true;
  }
  for (int side = 0; side < 2; ++side) {
    if (!(side == 0 ? A : B).curved()) continue;
    const Vec3 axis = side == 0 ? Vec3(Vec3::UnitZ()) : Vec3(X.R.col(2));
    const Vec3 across = between - between.dot(axis) * axis;
    if (across.norm() > 1e-9 * best.pair.size() && best.try_direction(across.normalized())) return true;
  }
  if (A.edge_directions.size() * B.edge_directions.size() > kEdgePairs) return false;
  for (const Vec3& e : A.edge_directions)
    for (const Vec3& g : B.edge_directions) {
      Vec3 n = e.cross(X.R * g);
      const double sine = n.norm();
      if (sine < 1e-7) continue;  // parallel edges have no direction of their own
      n /= sine;
      if (symmetric && n.dot(between) < 0) n = -n;
      if (best.try_direction(n) || (!symmetric && best.try_direction(-n))) return true;
    }
  return false;
}

/// True if try_candidates() has seen every local maximum of s < 0.
bool candidates_are_complete(const Convex& A, const Convex& B) {
  return !A.curved() && !B.curved() && A.edge_directions.size() * B.edge_directions.size() <= kEdgePairs;
}

/// Newton's method for w(n) ∥ n without a ridge: w is the gradient of s, and in a tangent basis U
///     (Uᵀ (H_A + H_B) U + s 1) y = Uᵀ w,   n ← n + U y
/// (collision/narrow, Eq. 4)
Vec3 polish_smooth(const Pair& pair, Vec3 n) {
  const Convex &A = pair.A, &B = pair.B;
  const Relative& X = pair.X;
  for (int i = 0; i < 8; ++i) {
    Eigen::Matrix<double, 3, 2> U;
    Vec3 u, v;
    complete_frame(n, u, v);
    U << u, v;
    const Vec3 w = pair.witness(n);
    const Mat3 H =
        A.support_derivative(n) + X.R * B.support_derivative(-(X.R.transpose() * n)) * X.R.transpose();
    const Eigen::Matrix2d K = U.transpose() * H * U + n.dot(w) * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d g = U.transpose() * w;
    const double determinant = K.determinant();
    if (!(determinant > 0) || !(K.trace() > 0)) break;  // not a maximum
    const Eigen::Vector2d y = K.inverse() * g;
    if (!(y.norm() < 0.1)) break;
    n = (n + U * y).normalized();
    if (y.norm() < 1e-15) break;
  }
  return n;
}

/// The same along a ridge, where a whole edge of one body is farthest: n moves on the curve of directions
/// across that edge; secant method for its angle.
Vec3 polish_ridge(const Pair& pair, Vec3 n, bool of_A) {
  const Convex &A = pair.A, &B = pair.B;
  const Relative& X = pair.X;
  const auto on_ridge = [&](const Vec3& d, Vec3& edge) {
    Vec3 r = d;
    if (of_A) return A.ridge(d, r, edge) ? r : d;
    const bool found = B.ridge(-(X.R.transpose() * d), r, edge);
    edge = X.R * edge;
    return found ? Vec3(-(X.R * r)) : d;
  };
  // dw/dθ across the edge; the edge itself does not show in it.
  const auto slope = [&](const Vec3& d, const Vec3& edge) {
    return pair.witness(d).dot(d.cross(edge).normalized());
  };
  Vec3 edge = Vec3::UnitZ();
  n = on_ridge(n, edge);
  double g = slope(n, edge), step = 1e-6;
  for (int i = 0; i < 10 && g != 0; ++i) {
    Vec3 next_edge = edge;
    const Vec3 next = on_ridge((n + step * n.cross(edge)).normalized(), next_edge);
    if (next_edge.dot(edge) < 0) next_edge = -next_edge;
    const double next_g = slope(next, next_edge);
    const double change = next_g - g;
    if (change == 0) break;
    const bool nearer = std::abs(next_g) < std::abs(g);
    if (nearer) n = next, edge = next_edge, g = next_g;
    step = -g * step / change;
    if (!(std::abs(step) < 0.1) || std::abs(step) < 1e-16) break;
  }
  return n;
}

/// GJK finds the direction between curved bodies to about 1e-6 rad; this makes it exact.
void polish(Best& best) {
  const Convex &A = best.pair.A, &B = best.pair.B;
  const Relative& X = best.pair.X;
  const double slack = 1e-13 * best.pair.size();
  const auto accept = [&](const Vec3& n) {
    const double value = best.pair.s(n);
    if (!(value >= best.s - slack)) return false;
    best.n = n, best.s = value;
    return true;
  };
  Vec3 ridge_A, ridge_B, edge_A, edge_B;
  const auto edges = [&](const Vec3& n) {
    const bool of_A = A.ridge(n, ridge_A, edge_A);
    return std::pair(of_A, B.ridge(-(X.R.transpose() * n), ridge_B, edge_B));
  };
  // Two edges that cross; those of a cone turn with n, hence the repetition.
  Vec3 crossing = best.n;
  const auto [on_A, on_B] = edges(best.n);
  bool both = on_A && on_B;
  for (int i = 0; i < 8 && both; ++i) {
    const Vec3 n = edge_A.cross(X.R * edge_B);
    if (n.norm() < 1e-7) break;
    const Vec3 last = crossing;
    crossing = (n.dot(best.n) > 0 ? n : Vec3(-n)).normalized();
    if ((crossing - last).norm() < 1e-15) break;
    const auto [still_A, still_B] = edges(crossing);
    both = still_A && still_B;
  }
  if (on_A && on_B && crossing != best.n && accept(crossing)) return;
  if (on_A && accept(polish_ridge(best.pair, best.n, true))) return;
  if (on_B && accept(polish_ridge(best.pair, best.n, false))) return;
  accept(polish_smooth(best.pair, best.n));
}

/// Proximal point iteration with GJK: B moved by t n is separated from A, and the direction of its distance
///     argmax s(m) + t m·n
/// has s no smaller than s(n).  Ends at once on a facet of s, else gains a factor t/(t + curvature) a step.
/// (collision/narrow, Eq. 3)
void climb(Best& best) {
  const double size = best.pair.size(), smaller = std::min(best.pair.A.extent, best.pair.B.extent);
  const double clearance = 1e-2 * (smaller > 0 ? smaller : size);
  for (int i = 0; i < 20; ++i) {
    const double before = best.s;
    Vec3 n;
    const Vec3 shift = (clearance - best.s) * best.n;
    if (!shortest_direction(best.pair.A, best.pair.B, best.pair.X, shift, best.n, n)) return;
    if (best.try_direction(n)) return;
    if (best.s <= before + 1e-10 * size) return;
  }
}

}  // namespace

bool find_separation(const Convex& A, const Convex& B, const Relative& X, double cutoff, Separation& out) {
  const Pair pair{A, B, X};
  const double radii = A.radius + B.radius, apart = 1e-7 * pair.size();
  Best best{pair, cutoff + radii};
  if (try_candidates(best)) return false;
  if (best.s <= apart && !candidates_are_complete(A, B)) climb(best);
  if (best.s > best.cutoff) return false;
  // Curved bodies may be apart although the climb, with GJK's 1e-6 rad, has not seen it yet.
  const bool doubtful = (A.curved() || B.curved()) && best.s > -1e-4 * pair.size();
  const bool thin = is_thin(A) && is_thin(B);  // the shortest line is among the candidates
  if (!thin && (best.s > apart || doubtful || (radii > 0 && best.s > -1e-12 * pair.size()))) {
    Vec3 n;
    if (shortest_direction(A, B, X, Vec3::Zero(), best.n, n, best.s > apart) && best.try_direction(n))
      return false;
  }
  if (A.curved() || B.curved()) polish(best);
  out = {best.n, best.s - radii};
  return out.s <= cutoff;
}

}  // namespace taut::detail
