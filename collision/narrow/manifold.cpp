#include "collision/narrow/manifold.h"

#include <algorithm>
#include <cmath>

namespace taut::detail {
namespace {

using Corner = ManifoldScratch::Corner;

/// The common frame: contact plane (u, v), height along n, all in the frame of A.
struct Frame {
  Vec3 u, v, n;
  double x(const Vec3& p) const { return u.dot(p); }
  double y(const Vec3& p) const { return v.dot(p); }
  Vec3 lift(double x, double y, double height) const { return x * u + y * v + height * n; }
};

/// Radii of curvature below this part of both bodies together are none.
constexpr double kSharp = 1e-3;

/// Sine of the angle from which on edges that cross say all of how two bodies touch.
constexpr double kCrossing = 0.2;

/// Alignment from which on a polygon is what a direction sees, and not one of its edges or corners.
constexpr double kFaceOn = 1 - 1e-8;

/// What a body shows in the unit direction d, in its own frame, turned to another by R.
class Surroundings {
 public:
  Surroundings(const Convex& body, const Feature& feature, const Vec3& d, const Mat3& R)
      : body_(body), d_(d), R_(R), face_(feature.points.size() > 2 && feature.normal.dot(d) > kFaceOn) {
    Vec3 on_ridge, ridge;
    if (face_)
      whole_ = LocalSurface::flat(d);
    else if (feature.points.size() == 2)
      along_edge(feature.points[1].p - feature.points[0].p, feature.rounding - body.radius);
    else if (feature.points.size() > 2 && feature.disc == 0 && body.ridge(d, on_ridge, ridge))
      along_edge(ridge, 0);
    else
      whole_ = body.around(d);
    whole_.ball = body.radius;
  }

  bool is_face() const { return face_; }
  /// Unit direction of the edge that it shows, else 0.
  Vec3 edge() const { return R_ * edge_; }
  LocalSurface whole() const { return whole_.turned(R_); }
  LocalSurface corner(std::uint64_t id) const { return body_.around(d_, static_cast<int>(id)).turned(R_); }
  /// Where the body has no corner, edge or face.
  LocalSurface smooth() const { return body_.around(d_).turned(R_); }

 private:
  void along_edge(const Vec3& direction, double rounding) {
    edge_ = (direction - d_.dot(direction) * d_).normalized();
    const Vec3 f = d_.cross(edge_);
    whole_.radii =
        LocalSurface::kFlat * edge_ * edge_.transpose() + std::max(0.0, rounding) * f * f.transpose();
  }

  const Convex& body_;
  Vec3 d_, edge_ = Vec3::Zero();
  Mat3 R_;
  bool face_;
  LocalSurface whole_;
};

/// Height along n of the plane through `point` with the normal m, over (x, y).
double plane_height(const Frame& frame, const Vec3& point, const Vec3& m, double x, double y) {
  const Vec3 foot = frame.lift(x, y, 0);
  return m.dot(point - foot) / m.dot(frame.n);
}

/// Collects contact points.  Cores are rounded off here.
class Collector {
 public:
  Collector(const Convex& A, const Convex& B, const Surroundings& on_A, const Surroundings& on_B,
            const Frame& frame, double s, double cutoff, std::vector<ManifoldPoint>& out)
      : r_A_(A.radius),
        r_B_(B.radius),
        on_A_(on_A),
        on_B_(on_B),
        frame_(frame),
        s_(s),
        cutoff_(cutoff),
        size_(A.extent + B.extent),
        out_(out) {}

  /// Points p and q of the cores at one place of the contact plane; `extra` is added to the gap.
  void add(const Vec3& p, const Vec3& q, std::uint64_t id, double extra = 0) {
    // No two points are nearer along n than s: what seems so lies in the slack of a polygon.
    const double gap = std::max(s_, frame_.n.dot(q - p) - r_A_ - r_B_ + extra);
    if (gap > cutoff_) return;
    deepest_ = std::min(deepest_, gap);
    const Vec3 P = p + r_A_ * frame_.n;
    push({P, P + gap * frame_.n, frame_.n, gap, id, surface_A(id), surface_B(id)});
  }
  /// Points with a normal of their own: two rounded cores beside each other.
  void add_free(const Vec3& p, const Vec3& q, std::uint64_t id) {
    const Vec3 d = q - p;
    const double length = d.norm();
    if (!(length > 1e-9 * size_) || d.dot(frame_.n) < 0.5 * length) return add(p, q, id);
    const double gap = length - r_A_ - r_B_;
    if (gap > cutoff_) return;
    deepest_ = std::min(deepest_, gap);
    const Vec3 n = d / length;
    push({p + r_A_ * n, q - r_B_ * n, n, gap, id, surface_A(id), surface_B(id)});
  }

  /// The deepest place, where only B, or only A, has a point of its own.
  void add_beside(const Vec3& p, const Vec3& q, std::uint64_t id, bool of_B) {
    const std::size_t first = out_.size();
    add(p, q, id);
    if (out_.size() > first)
      (of_B ? out_[first].surface_B : out_[first].surface_A) = (of_B ? on_B_ : on_A_).smooth();
  }

  /// What the deepest point may lack of the depth s.
  double depth_slack() const { return 2e-7 * size_; }
  /// True if the deepest place is among the points from `first` on.  Its gap is then s itself, free of the
  /// round-off of steep faces.
  bool settle_depth(std::size_t first) {
    if (!(deepest_ <= s_ + depth_slack())) return false;
    for (std::size_t i = first; i < out_.size(); ++i) {
      ManifoldPoint& point = out_[i];
      if (point.gap != deepest_) continue;
      point.gap = s_;
      point.q = point.p + s_ * point.n;
      break;
    }
    return true;
  }

 private:
  /// Corners and edges alone leave the normal free: it turns with the body whose face it is across then.
  void push(ManifoldPoint point) {
    const Mat3 H = point.surface_A.radii + point.surface_A.squares / size_ + point.surface_B.radii +
                   point.surface_B.squares / size_;
    const double xx = frame_.u.dot(H * frame_.u), yy = frame_.v.dot(H * frame_.v),
                 xy = frame_.u.dot(H * frame_.v);
    const double least = 0.5 * (xx + yy) - std::hypot(0.5 * (xx - yy), xy);
    if (least + r_A_ + r_B_ < kSharp * size_) {
      point.surface_A = point.surface_B = {};
      (on_A_.is_face() ? point.surface_A : point.surface_B) = LocalSurface::flat(point.n);
    }
    out_.push_back(point);
  }

  /// Of edges that cross on a face, or hardly cross, one has a corner on the other.
  LocalSurface surface_A(std::uint64_t id) const {
    const Meeting meeting = meeting_of(id);
    if (meeting == Meeting::kVertexA) return on_A_.corner(side_A(id));
    return meeting == Meeting::kEdges && on_B_.is_face() ? LocalSurface{r_A_} : on_A_.whole();
  }
  LocalSurface surface_B(std::uint64_t id) const {
    const Meeting meeting = meeting_of(id);
    if (meeting == Meeting::kVertexB) return on_B_.corner(side_B(id));
    const bool crossing = on_B_.is_face() || on_A_.edge().cross(on_B_.edge()).norm() > kCrossing;
    return meeting == Meeting::kEdges && !crossing ? LocalSurface{r_B_} : on_B_.whole();
  }

  double r_A_, r_B_;
  const Surroundings &on_A_, &on_B_;
  const Frame& frame_;
  double s_, cutoff_, size_;
  std::vector<ManifoldPoint>& out_;
  double deepest_ = 1e300;
};

/// Two segments in the contact plane, a0 + t (ax, ay) and a0 + (cx, cy) + w (bx, by) with t and w from 0
/// to 1.
struct PlaneSegments {
  double ax, ay, bx, by, cx, cy;
  double aa = ax * ax + ay * ay, bb = bx * bx + by * by, ab = ax * bx + ay * by, cross = ax * by - ay * bx;

  /// The place on B that is nearest to a place on A.
  double beside(double t) const {
    return std::clamp(((t * ax - cx) * bx + (t * ay - cy) * by) / bb, 0.0, 1.0);
  }
  double squared_distance(double t, double w) const {
    const double dx = cx + w * bx - t * ax, dy = cy + w * by - t * ay;
    return dx * dx + dy * dy;
  }
  /// Nearest points: the crossing, or an end of one of them.
  std::pair<double, double> nearest() const {
    const double t = cross != 0 ? std::clamp((cx * by - cy * bx) / cross, 0.0, 1.0) : 0.5;
    const double w = beside(t);
    return {std::clamp(((cx + w * bx) * ax + (cy + w * by) * ay) / aa, 0.0, 1.0), w};
  }
};

/// An end of the stretch of a segment A that a segment B lies beside.
struct StretchEnd {
  double t = 0, w = 0;    // places on A and B
  double excess = 1e300;  // how much shallower than the crossing it is
  std::uint64_t id = 0;
};

/// Both ends; those of nothing have the first behind the second.
std::pair<StretchEnd, StretchEnd> shared_stretch(const Feature& a, const Feature& b, const PlaneSegments& s,
                                                 const std::uint64_t (&edges)[2]) {
  StretchEnd lo, hi;
  lo.t = (s.cx * s.ax + s.cy * s.ay) / s.aa, hi.t = lo.t + s.ab / s.aa;
  int id_lo = 0, id_hi = 1;
  if (lo.t > hi.t) std::swap(lo, hi), std::swap(id_lo, id_hi);
  lo.id = contact_id(Meeting::kVertexB, edges[0], b.points[id_lo].id);
  hi.id = contact_id(Meeting::kVertexB, edges[0], b.points[id_hi].id);
  if (lo.t < 0) lo.t = 0, lo.id = contact_id(Meeting::kVertexA, a.points[0].id, edges[1]);
  if (hi.t > 1) hi.t = 1, hi.id = contact_id(Meeting::kVertexA, a.points[1].id, edges[1]);
  return {lo, hi};
}

/// How far off B's line is at the ends, and what the curvature makes of it: d²/2ρ.
void measure_ends(const PlaneSegments& s, double rounding, StretchEnd& lo, StretchEnd& hi) {
  const bool sharp_parallel =
      rounding == 0 && lo.t < hi.t && std::abs(s.cross) < 1e-6 * std::sqrt(s.aa * s.bb);
  const bool round = rounding > 0 && lo.t < hi.t;
  for (StretchEnd* end : {&lo, &hi}) {
    if (!round && !sharp_parallel) continue;
    end->w = s.beside(end->t);
    end->excess = round ? s.squared_distance(end->t, end->w) / (2 * rounding) : 0;
  }
  // Of lines that cross at more than 0.2 rad the crossing says it all.
  if (std::abs(s.cross) > kCrossing * std::sqrt(s.aa * s.bb)) lo.excess = hi.excess = 1e300;
}

/// Two segments: where they cross, and the ends of what they share unless those are too far apart, or where
/// they cross.
void meet_segments(const Feature& a, const Feature& b, const Frame& f, bool rounded, double cutoff_excess,
                   double near, Collector& out) {
  const Vec3 &a0 = a.points[0].p, &b0 = b.points[0].p;
  const Vec3 da = a.points[1].p - a0, db = b.points[1].p - b0;
  const PlaneSegments s{f.x(da), f.y(da), f.x(db), f.y(db), f.x(b0 - a0), f.y(b0 - a0)};
  if (s.aa == 0 || s.bb == 0) return;
  const auto contact = [&](double t, double w, std::uint64_t id, double extra) {
    const Vec3 p = a0 + t * da, q = b0 + w * db;
    if (rounded)
      out.add_free(p, q, id);
    else
      out.add(p, q, id, extra);
  };
  const std::uint64_t edges[2] = {edge_id(a.points[0].id, a.points[1].id),
                                  edge_id(b.points[0].id, b.points[1].id)};
  auto [lo, hi] = shared_stretch(a, b, s, edges);
  measure_ends(s, a.rounding + b.rounding, lo, hi);
  // Where the ends are as deep as the crossing, that is not needed.
  const bool beside = std::max(lo.excess, hi.excess) <= out.depth_slack();
  const auto [t, w] = s.nearest();
  const auto apart = [&](double end, double other) {
    return std::abs(end - other) * std::sqrt(s.aa) >= near;
  };
  if (lo.excess <= cutoff_excess && (beside || apart(lo.t, t))) contact(lo.t, lo.w, lo.id, lo.excess);
  if (hi.excess <= cutoff_excess && apart(hi.t, beside ? lo.t : t)) contact(hi.t, hi.w, hi.id, hi.excess);
  if (!beside) contact(t, w, contact_id(Meeting::kEdges, edges[0], edges[1]), 0);
}

/// Narrows [lo, hi], places on the segment s0 + t d, to what lies over a disc; false if nothing does.
bool within_disc(const Vec3& s0, const Vec3& d, const Feature& disc, const Frame& f, double slack, double& lo,
                 double& hi) {
  const auto on_plane = [&](const Vec3& p) {
    const double x = f.x(p), y = f.y(p);
    return f.lift(x, y, plane_height(f, disc.centre, disc.normal, x, y));
  };
  const Vec3 from = on_plane(s0) - disc.centre, way = on_plane(s0 + d) - disc.centre - from;
  const double a = way.squaredNorm(), b = from.dot(way), r = disc.disc + slack;
  const double root2 = b * b - a * (from.squaredNorm() - r * r);
  if (!(a > 0 && root2 >= 0)) return false;
  lo = std::max(lo, (-b - std::sqrt(root2)) / a);
  hi = std::min(hi, (-b + std::sqrt(root2)) / a);
  return true;
}

/// The part of a segment that lies over a polygon or a disc.
class SegmentOverFace {
 public:
  SegmentOverFace(const Feature& segment, const Feature& face, bool segment_is_A, const Frame& f)
      : segment_(segment), face_(face), segment_is_A_(segment_is_A), f_(f) {}

  /// To what is over the face, `slack` larger all around; false if nothing is.
  bool narrow(double slack) {
    return (face_.disc > 0 ? narrow_to_disc(slack) : narrow_to_polygon(slack)) && !(lo_ > hi_);
  }

  /// Contacts at its ends, one if they are less than `near` apart.
  void add_ends(double near, Collector& out) const {
    for (const bool last : {false, true}) {
      const Vec3 p = s0_ + (last ? hi_ : lo_) * d_;
      const double x = f_.x(p), y = f_.y(p);
      const Vec3 q = f_.lift(x, y, plane_height(f_, face_.points[0].p, face_.normal, x, y));
      const std::uint64_t name = last ? hi_id_ : lo_id_;
      segment_is_A_ ? out.add(p, q, name) : out.add(q, p, name);
      if ((hi_ - lo_) * d_.norm() < near) break;
    }
  }

 private:
  std::uint64_t id(Meeting meeting, std::uint64_t of_segment, std::uint64_t of_face) const {
    if (segment_is_A_) return contact_id(meeting, of_segment, of_face);
    if (meeting == Meeting::kVertexA) meeting = Meeting::kVertexB;
    return contact_id(meeting, of_face, of_segment);
  }

  bool narrow_to_disc(double slack) {  // its polygon would turn with the least tilt
    if (!within_disc(s0_, d_, face_, f_, slack, lo_, hi_)) return false;
    if (lo_ > 0) lo_id_ = id(Meeting::kEdges, edge_, 0);
    if (hi_ < 1) hi_id_ = id(Meeting::kEdges, edge_, 1);
    return true;
  }

  bool narrow_to_polygon(double slack) {
    const double sense = face_.normal.dot(f_.n) > 0 ? 1 : -1;
    const std::size_t count = face_.points.size();
    for (std::size_t i = 0; i < count; ++i)
      if (!narrow_to_edge(face_.points[i], face_.points[(i + 1) % count], sense, slack)) return false;
    return true;
  }

  bool narrow_to_edge(const FeaturePoint& c, const FeaturePoint& e, double sense, double slack) {
    const double ex = sense * f_.x(e.p - c.p), ey = sense * f_.y(e.p - c.p);
    // Inside is left of the edge.
    const double h0 = ex * f_.y(s0_ - c.p) - ey * f_.x(s0_ - c.p) + slack * std::hypot(ex, ey);
    const double dh = ex * f_.y(d_) - ey * f_.x(d_);
    const double h1 = h0 + dh;
    if (h0 < 0 && h1 < 0) return false;
    if (h0 >= 0 && h1 >= 0) return true;
    const double t = h0 / (h0 - h1);
    const std::uint64_t cut = id(Meeting::kEdges, edge_, edge_id(c.id, e.id));
    if (h0 < 0 && t > lo_) lo_ = t, lo_id_ = cut;
    if (h1 < 0 && t < hi_) hi_ = t, hi_id_ = cut;
    return true;
  }

  const Feature& segment_;
  const Feature& face_;
  const bool segment_is_A_;
  const Frame& f_;
  const Vec3 s0_ = segment_.points[0].p, d_ = segment_.points[1].p - s0_;
  const std::uint64_t edge_ = edge_id(segment_.points[0].id, segment_.points[1].id);
  double lo_ = 0, hi_ = 1;  // places s0 + t d
  std::uint64_t lo_id_ = id(Meeting::kVertexA, segment_.points[0].id, 0);
  std::uint64_t hi_id_ = id(Meeting::kVertexA, segment_.points[1].id, 0);
};

void meet_segment_face(const Feature& segment, const Feature& face, bool segment_is_A, const Frame& f,
                       double slack, double near, Collector& out) {
  SegmentOverFace over(segment, face, segment_is_A, f);
  if (over.narrow(slack)) over.add_ends(near, out);
}

/// [SutherlandHodgman1974]: cuts polygon A, in the contact plane, by the edges of B.  Each corner remembers
/// the edge of A that starts at it and the edge of B it lies on, which name it. Polygon B is `slack` larger
/// all around, so that a corner on its boundary is in.
void clip(const Feature& A, const Feature& B, const Frame& f, double slack, ManifoldScratch& work) {
  std::vector<Corner>&poly = work.polygon, &next = work.clipped;
  poly.clear();
  const int count_A = static_cast<int>(A.points.size()), count_B = static_cast<int>(B.points.size());
  for (int i = 0; i < count_A; ++i)
    poly.push_back(
        {f.x(A.points[i].p), f.y(A.points[i].p), contact_id(Meeting::kVertexA, A.points[i].id, 0), i, -1});
  const double sense = B.normal.dot(f.n) > 0 ? 1 : -1;
  for (int k = 0; k < count_B; ++k) {
    const int k1 = (k + 1) % count_B;
    const Vec3 &c = B.points[k].p, &e = B.points[k1].p;
    const double cx = f.x(c), cy = f.y(c), ex = sense * (f.x(e) - cx), ey = sense * (f.y(e) - cy);
    const double allowance = slack * std::hypot(ex, ey);
    const auto inside = [&](const Corner& p) { return ex * (p.y - cy) - ey * (p.x - cx) + allowance; };
    next.clear();
    for (std::size_t i = 0; i < poly.size(); ++i) {
      const Corner &from = poly[i], &to = poly[(i + 1) % poly.size()];
      const double h0 = inside(from), h1 = inside(to);
      if (h0 >= 0) next.push_back(from);
      if ((h0 >= 0) == (h1 >= 0)) continue;
      const double t = h0 / (h0 - h1);
      Corner cut{from.x + t * (to.x - from.x), from.y + t * (to.y - from.y), 0, from.edge_A, from.edge_B};
      if (from.edge_A >= 0) {  // an edge of A crosses the edge k of B
        const int i1 = (from.edge_A + 1) % count_A;
        cut.id = contact_id(Meeting::kEdges, edge_id(A.points[from.edge_A].id, A.points[i1].id),
                            edge_id(B.points[k].id, B.points[k1].id));
      } else {  // two edges of B meet: a corner of B inside A
        const int shared = (from.edge_B + 1) % count_B == k ? k : k1;
        cut.id = contact_id(Meeting::kVertexB, 0, B.points[shared].id);
      }
      if (h0 >= 0)
        cut.edge_A = -1, cut.edge_B = k;  // leaving: from here on the boundary runs along the edge k
      next.push_back(cut);
    }
    poly.swap(next);
  }
}

/// Takes out corners that coincide with the one before or lie on the line between their neighbours.
void simplify(std::vector<Corner>& polygon, double near) {
  for (std::size_t i = 0; i < polygon.size() && polygon.size() > 1;) {
    const Corner &a = polygon[(i + polygon.size() - 1) % polygon.size()], &b = polygon[i],
                 &c = polygon[(i + 1) % polygon.size()];
    const double ux = c.x - a.x, uy = c.y - a.y, chord = std::hypot(ux, uy);
    const bool twin = std::hypot(b.x - a.x, b.y - a.y) < near;
    const bool flat = polygon.size() > 2 && chord > near &&
                      std::abs(ux * (b.y - a.y) - uy * (b.x - a.x)) < near * chord &&
                      (b.x - a.x) * ux + (b.y - a.y) * uy > 0 && (c.x - b.x) * ux + (c.y - b.y) * uy > 0;
    if (twin || flat) {
      // Of twins the one with the smaller id stays: corners of A before corners of B before crossings.
      if (twin) polygon[(i + polygon.size() - 1) % polygon.size()].id = std::min(a.id, b.id);
      polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      ++i;
    }
  }
}

bool over_polygon(const Feature& polygon, const Vec3& point, const Frame& f, double slack) {
  const std::size_t count = polygon.points.size();
  if (count < 3) return false;
  const double sense = polygon.normal.dot(f.n) > 0 ? 1 : -1;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 &c = polygon.points[i].p, &e = polygon.points[(i + 1) % count].p;
    const double ex = sense * f.x(e - c), ey = sense * f.y(e - c);
    if (ex * f.y(point - c) - ey * f.x(point - c) < -slack * std::hypot(ex, ey)) return false;
  }
  return true;
}

void to_frame_of_A(Feature& feature, const Relative& X) {
  for (FeaturePoint& point : feature.points) point.p = X.p + X.R * point.p;
  feature.centre = X.p + X.R * feature.centre;
  feature.normal = X.R * feature.normal;
}

std::uint64_t deepest_id() { return contact_id(Meeting::kDeepest, 0, 0); }

/// A corner of one body, and the place of the other across the contact plane.
void meet_point(const Feature& a, const Feature& b, const Frame& f, double core_s, Overhang overhang,
                double slack, Collector& out) {
  const bool of_A = a.points.size() == 1;
  const Vec3& at = of_A ? a.points[0].p : b.points[0].p;
  if (overhang == Overhang::kNone && !over_polygon(of_A ? b : a, at, f, slack)) return;
  const Vec3 p = of_A ? at : Vec3(at - core_s * f.n);
  out.add(p, p + core_s * f.n, deepest_id());
}

/// What two polygons share.
void meet_polygons(const Feature& a, const Feature& b, const Frame& f, Overhang overhang, double slack,
                   double near, ManifoldScratch& work, Collector& out) {
  clip(a, b, f, slack, work);
  simplify(work.polygon, near);
  // Two polygons that share a corner only: the deepest place is exact, and added behind.
  if (work.polygon.size() == 1 && overhang == Overhang::kDeepest) work.polygon.clear();
  for (const Corner& c : work.polygon) {
    const Vec3 p = f.lift(c.x, c.y, plane_height(f, a.points[0].p, a.normal, c.x, c.y));
    const Vec3 q = f.lift(c.x, c.y, plane_height(f, b.points[0].p, b.normal, c.x, c.y));
    out.add(p, q, c.id);
  }
}

}  // namespace

namespace {

constexpr int kSideBits = 30;
constexpr std::uint64_t kSide = (std::uint64_t{1} << kSideBits) - 1;

}  // namespace

Meeting meeting_of(std::uint64_t id) { return static_cast<Meeting>(id >> 2 * kSideBits); }
std::uint64_t side_A(std::uint64_t id) { return id >> kSideBits & kSide; }
std::uint64_t side_B(std::uint64_t id) { return id & kSide; }

std::uint64_t contact_id(Meeting meeting, std::uint64_t of_A, std::uint64_t of_B) {
  return static_cast<std::uint64_t>(meeting) << 2 * kSideBits | (of_A & kSide) << kSideBits | (of_B & kSide);
}

std::uint64_t edge_id(int corner, int other) {
  const auto [low, high] = std::minmax(corner, other);
  return static_cast<std::uint64_t>(low) << 15 | static_cast<std::uint64_t>(high);
}

void make_manifold(const Convex& A, const Convex& B, const Relative& X, const Separation& separation,
                   double cutoff, Overhang overhang, ManifoldScratch& work, std::vector<ManifoldPoint>& out) {
  Frame frame;
  frame.n = separation.n;
  complete_frame(frame.n, frame.u, frame.v);
  Feature &a = work.feature_A, &b = work.feature_B;
  const Vec3 n_B = -(X.R.transpose() * frame.n);
  A.feature(frame.n, a);
  B.feature(n_B, b);
  const Surroundings on_A(A, a, frame.n, Mat3::Identity()), on_B(B, b, n_B, X.R);
  to_frame_of_A(b, X);
  const double core_s = separation.s + A.radius + B.radius;
  const double smaller = std::min(A.extent, B.extent), slack = 1e-9 * smaller, near = 1e-5 * smaller;
  Collector collect(A, B, on_A, on_B, frame, separation.s, cutoff, out);
  if (a.points.size() == 1 || b.points.size() == 1)
    return meet_point(a, b, frame, core_s, overhang, slack, collect);
  const std::size_t first = out.size();
  if (a.points.size() == 2 && b.points.size() == 2) {
    meet_segments(a, b, frame, A.radius > 0 && B.radius > 0, std::max(0.0, cutoff - separation.s), near,
                  collect);
  } else if (a.points.size() == 2) {
    meet_segment_face(a, b, true, frame, slack, near, collect);
  } else if (b.points.size() == 2) {
    meet_segment_face(b, a, false, frame, slack, near, collect);
  } else {
    meet_polygons(a, b, frame, overhang, slack, near, work, collect);
  }
  if (collect.settle_depth(first) || overhang == Overhang::kNone) return;
  // The features miss the deepest place, as when a round side overhangs an edge: it is the support point of
  // the body that has only one there.
  Vec3 on_ridge, edge;
  Vec3 p = A.support(frame.n);
  const bool of_B = A.ridge(frame.n, on_ridge, edge);
  if (of_B) p = X.p + X.R * B.support(n_B) - core_s * frame.n;
  const auto beside = [&](const ManifoldPoint& other) {
    return (other.p - p - A.radius * frame.n).norm() < 10 * near;
  };
  out.erase(std::remove_if(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(), beside), out.end());
  collect.add_beside(p, p + core_s * frame.n, deepest_id(), of_B);
}

void reduce(std::vector<ManifoldPoint>& points, std::size_t first, std::size_t most, ManifoldScratch& work) {
  const std::size_t count = points.size() - first;
  if (count <= most) return;
  const auto begin = points.begin() + static_cast<std::ptrdiff_t>(first);
  std::vector<ManifoldPoint>& kept = work.kept;
  kept.clear();
  // A bit mask would do for few points; meshes can bring hundreds, so each point carries its distance.
  std::vector<double>& distance = work.plane_A;
  distance.assign(count, 1e300);
  std::size_t chosen = 0;
  for (std::size_t i = 1; i < count; ++i)
    if (begin[static_cast<std::ptrdiff_t>(i)].gap < begin[static_cast<std::ptrdiff_t>(chosen)].gap)
      chosen = i;
  std::vector<double>& order = work.plane_B;
  order.clear();
  while (order.size() < most) {
    order.push_back(static_cast<double>(chosen));
    const Vec3 at = begin[static_cast<std::ptrdiff_t>(chosen)].p;
    std::size_t next = 0;
    for (std::size_t i = 0; i < count; ++i) {
      distance[i] = std::min(distance[i], (begin[static_cast<std::ptrdiff_t>(i)].p - at).squaredNorm());
      if (distance[i] > distance[next]) next = i;
    }
    chosen = next;
  }
  std::sort(order.begin(), order.end());
  for (double i : order) kept.push_back(begin[static_cast<std::ptrdiff_t>(i)]);
  points.resize(first);
  points.insert(points.end(), kept.begin(), kept.end());
}

}  // namespace taut::detail
