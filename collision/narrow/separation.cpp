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
/// bodies the lines between centres, across the axes.  Each function is true if one of its directions shows
/// that the pair is far apart.
class Candidates {
 public:
  explicit Candidates(Best& best)
      : best_(best),
        A_(best.pair.A),
        B_(best.pair.B),
        X_(best.pair.X),
        between_(X_.p + X_.R * B_.centre - A_.centre) {
    if (!(between_.norm() > 1e-9 * best.pair.size())) between_ = Vec3::UnitZ();
  }

  bool try_all() { return try_faces() || try_centres() || try_across_axes() || try_edges(); }

 private:
  bool is_backward(const Vec3& n) const { return symmetric_ && n.dot(between_) < 0; }
  bool try_face(const Vec3& n) { return !is_backward(n) && best_.try_direction(n); }

  bool try_faces() {
    const auto of_A = [this](const Vec3& f) { return try_face(f); };
    const auto of_B = [this](const Vec3& f) { return try_face(-(X_.R * f)); };
    return std::any_of(A_.face_normals.begin(), A_.face_normals.end(), of_A) ||
           std::any_of(B_.face_normals.begin(), B_.face_normals.end(), of_B);
  }

  bool try_centres() {
    if (best_.try_direction(between_.normalized())) return true;
    if (!is_thin(A_) || !is_thin(B_)) return false;
    const Vec3 line = between_thin(best_.pair);
    return line.norm() > 1e-12 * best_.pair.size() && best_.try_direction(line.normalized());
  }

  bool try_across_axes() {
    return (A_.curved() && try_across(Vec3::UnitZ())) || (B_.curved() && try_across(X_.R.col(2)));
  }
  bool try_across(const Vec3& axis) {
    const Vec3 across = between_ - between_.dot(axis) * axis;
    return across.norm() > 1e-9 * best_.pair.size() && best_.try_direction(across.normalized());
  }

  bool try_edges() {
    if (A_.edge_directions.size() * B_.edge_directions.size() > kEdgePairs) return false;
    for (const Vec3& e : A_.edge_directions)
      for (const Vec3& g : B_.edge_directions)
        if (try_across_edges(e, X_.R * g)) return true;
    return false;
  }
  bool try_across_edges(const Vec3& e, const Vec3& g) {
    Vec3 n = e.cross(g);
    const double sine = n.norm();
    if (sine < 1e-7) return false;  // parallel edges have no direction of their own
    n /= sine;
    if (is_backward(n)) n = -n;
    return best_.try_direction(n) || (!symmetric_ && best_.try_direction(-n));
  }

  Best& best_;
  const Convex& A_;
  const Convex& B_;
  const Relative& X_;
  Vec3 between_;                                         // from centre to centre
  const bool symmetric_ = A_.symmetric && B_.symmetric;  // of n and −n the one towards B is enough
};

/// True if Candidates has seen every local maximum of s < 0.
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

/// Whole edges that are farthest in a direction, on both bodies; each in axes of its own.
struct FarEdges {
  bool on_A = false, on_B = false;  ///< whether there is one
  Vec3 of_A = Vec3::Zero(), of_B = Vec3::Zero();
  bool both() const { return on_A && on_B; }
};

FarEdges far_edges(const Pair& pair, const Vec3& n) {
  FarEdges found;
  Vec3 ridge_A, ridge_B;
  found.on_A = pair.A.ridge(n, ridge_A, found.of_A);
  found.on_B = pair.B.ridge(-(pair.X.R.transpose() * n), ridge_B, found.of_B);
  return found;
}

/// The direction near n across two edges that cross; those of a cone turn with it, hence the repetition.
Vec3 across_far_edges(const Pair& pair, const Vec3& n, FarEdges edges) {
  Vec3 crossing = n;
  for (int i = 0; i < 8 && edges.both(); ++i) {
    const Vec3 across = edges.of_A.cross(pair.X.R * edges.of_B);
    if (across.norm() < 1e-7) break;
    const Vec3 last = crossing;
    crossing = (across.dot(n) > 0 ? across : Vec3(-across)).normalized();
    if ((crossing - last).norm() < 1e-15) break;
    edges = far_edges(pair, crossing);
  }
  return crossing;
}

/// GJK finds the direction between curved bodies to about 1e-6 rad; this makes it exact.
void polish(Best& best) {
  const double slack = 1e-13 * best.pair.size();
  const auto accept = [&](const Vec3& n) {
    const double value = best.pair.s(n);
    if (!(value >= best.s - slack)) return false;
    best.n = n, best.s = value;
    return true;
  };
  const FarEdges edges = far_edges(best.pair, best.n);
  const Vec3 crossing = across_far_edges(best.pair, best.n, edges);
  if (edges.both() && crossing != best.n && accept(crossing)) return;
  if (edges.on_A && accept(polish_ridge(best.pair, best.n, true))) return;
  if (edges.on_B && accept(polish_ridge(best.pair, best.n, false))) return;
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

/// Whether the shortest line from core to core has to be looked for: of two that are apart, and of curved or
/// rounded ones that may be although the climb, with GJK's 1e-6 rad, has not seen it yet.
bool needs_shortest_line(const Best& best, double radii, double apart) {
  const auto& [A, B, X] = best.pair;
  if (is_thin(A) && is_thin(B)) return false;  // it is among the candidates
  const bool doubtful = (A.curved() || B.curved()) && best.s > -1e-4 * best.pair.size();
  return best.s > apart || doubtful || (radii > 0 && best.s > -1e-12 * best.pair.size());
}

}  // namespace

bool find_separation(const Convex& A, const Convex& B, const Relative& X, double cutoff, Separation& out) {
  const Pair pair{A, B, X};
  const double radii = A.radius + B.radius, apart = 1e-7 * pair.size();
  Best best{pair, cutoff + radii};
  if (Candidates(best).try_all()) return false;
  if (best.s <= apart && !candidates_are_complete(A, B)) climb(best);
  if (best.s > best.cutoff) return false;
  if (needs_shortest_line(best, radii, apart)) {
    Vec3 n;
    if (shortest_direction(A, B, X, Vec3::Zero(), best.n, n, best.s > apart) && best.try_direction(n))
      return false;
  }
  if (A.curved() || B.curved()) polish(best);
  out = {best.n, best.s - radii};
  return out.s <= cutoff;
}

}  // namespace taut::detail
