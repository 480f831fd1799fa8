#include "solvers/laws/contact_drift.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/math/so3.h"

namespace taut {
namespace {

/// Chosen, where nothing else is said.  (solvers/laws, "Contacts")
struct DriftTuning {
  /// Steps of Newton's method for the normal, at most; of corners, edges and faces it takes two.
  static constexpr int kNormalSteps = 4;
  /// It is done when the normal turns by less [rad]; it has found none if it turns by more than the second at
  /// the end, or if the gap along it is less than that along the one it began with.
  static constexpr double kNormalFound = 1e-12, kNormalLost = 1e-6;
  /// The expansion of curved surfaces ends where the normal turns by more in one step [rad]; a contact whose
  /// normal turns by more in the drift, or is lost, as that of edges that hardly cross, is that of planes.
  static constexpr double kFarTurn = 0.5;
  /// Newton's method closes gaps that surfaces open as they turn to this part of what they open in the second
  /// order, times the turn: a part of the third-order error of a drift.
  static constexpr double kCurvedPart = 0.05;
  /// What moves less against each other than this part of its arms has rates that stay as they are.
  static constexpr double kHardlyMoves = 1e-9;
};

/// The solution δ ⟂ m of (H + s 1) δ = g.
Vec3 solve_across(const Mat3& H, double s, const Vec3& m, const Vec3& g) {
  const Vec3 u = m.unitOrthogonal(), v = m.cross(u);
  const double a = u.dot(H * u) + s, b = u.dot(H * v), c = v.dot(H * v) + s;
  const double x = u.dot(g), y = v.dot(g), determinant = a * c - b * b;
  if (!(determinant > 0)) return Vec3::Zero();
  return (c * x - b * y) / determinant * u + (a * y - b * x) / determinant * v;
}

/// The core of a surface on a body that has turned: how its point farthest along a unit d goes on as d turns
/// from the outward normal n.
struct Core {
  double ball;
  Vec3 n;
  Mat3 H, Q;

  Core(const LocalSurface& surface, const Mat3& turn, const Vec3& normal)
      : ball(surface.ball),
        n(turn * normal),
        H(turn * surface.radii * turn.transpose()),
        Q(turn * surface.squares * turn.transpose()) {}

  bool is_quadric() const { return Q.trace() > 0; }
  Vec3 farthest(const Vec3& d) const {
    const Vec3 q = Q * d;
    const double height = std::sqrt(std::max(0.0, d.dot(q)));
    return height > 0 ? Vec3(q / height) : Vec3::Zero();
  }
  Vec3 shift(const Vec3& d) const {
    return is_quadric() ? Vec3(farthest(d) - farthest(n)) : Vec3(H * tangential(d, n));
  }
  /// d · shift(d), of H with the fall of the second order.
  double height(const Vec3& d) const {
    const Vec3 u = tangential(d, n);
    return is_quadric() ? d.dot(shift(d)) : 0.5 * u.dot(H * u);
  }
  Mat3 radii(const Vec3& d) const {
    if (!is_quadric()) return H;
    const Vec3 q = Q * d;
    const double height = std::sqrt(std::max(0.0, d.dot(q)));
    return height > 0 ? Mat3(Q / height - q * q.transpose() / (height * height * height)) : Mat3::Zero();
  }
};

struct BodyEnds {
  Pose start, end;
  Mat3 turn;
  Twist V;  ///< at the end
};

BodyEnds ends_of(const ContactDrift& drift, int b) {
  BodyEnds ends{drift.start[b], drift.start[b], Mat3::Identity(), {Vec3::Zero(), Vec3::Zero()}};
  if (drift.mass[b].fixed) return ends;
  ends.end = drift.end[b];
  ends.turn = (ends.end.q * ends.start.q.conjugate()).toRotationMatrix();
  ends.V = {drift.mass.angular_velocity(b, ends.end, drift.momenta[b].torque),
            drift.mass[b].inverse_mass * drift.momenta[b].force};
  return ends;
}

/// J(q₀) gives the rates to round-off: bodies do not turn, and slip on a plane or not at all.
bool is_still(const Contact& contact, const BodyEnds& A, const BodyEnds& B) {
  const double turned = (A.turn - Mat3::Identity()).norm() + (B.turn - Mat3::Identity()).norm();
  if (turned > DriftTuning::kHardlyMoves) return false;
  if (contact.surface_A.is_flat() || contact.surface_B.is_flat()) return true;
  const Vec3 a = rotate(A.end.q, contact.p_AP), b = rotate(B.end.q, contact.p_BQ);
  const Vec3 way = (B.end.p - A.end.p) - (B.start.p - A.start.p) + (b - rotate(B.start.q, contact.p_BQ)) -
                   (a - rotate(A.start.q, contact.p_AP));
  return way.norm() <= DriftTuning::kHardlyMoves * (a.norm() + b.norm());
}

}  // namespace

/// The gap is the largest over unit vectors u of  u·D(u) − r_A − r_B,  D from the point of A's core farthest
/// along u to that of B's farthest against it.
MovedContact moved_contact(const Contact& contact, const Pose& A, const Pose& B, const Mat3& turn_A,
                           const Mat3& turn_B) {
  const Core on_A(contact.surface_A, turn_A, contact.normal),
      on_B(contact.surface_B, turn_B, -contact.normal);
  const Vec3 a = rotate(A.q, contact.p_AP) - on_A.ball * on_A.n,
             b = rotate(B.q, contact.p_BQ) - on_B.ball * on_B.n;
  const Vec3 between = B.p - A.p + b - a;
  const auto gap_along = [&](const Vec3& m) {
    return m.dot(between) - on_A.height(m) - on_B.height(-m) - on_A.ball - on_B.ball;
  };
  Vec3 m = (on_A.n - on_B.n).normalized();
  const double first = gap_along(m);
  double far = 0;
  for (int k = 0; k < DriftTuning::kNormalSteps; ++k) {
    const Vec3 D = between + on_B.shift(-m) - on_A.shift(m);
    const Vec3 turn = solve_across(on_A.radii(m) + on_B.radii(-m), std::max(0.0, m.dot(between)), m, D);
    far = turn.norm();
    m = (m + std::min(1.0, DriftTuning::kFarTurn / far) * turn).normalized();
    if (!(far > DriftTuning::kNormalFound)) break;
  }
  MovedContact moved;
  moved.normal = m;
  moved.gap = gap_along(m);
  moved.found = far <= DriftTuning::kNormalLost &&
                moved.gap >= first - DriftTuning::kNormalFound * (a.norm() + b.norm());
  // From the side that is less flat, where the place is known better.
  if (on_A.H.trace() <= on_B.H.trace()) {
    moved.P = a + on_A.shift(m) + on_A.ball * m;
    moved.Q = moved.P + moved.gap * m - (B.p - A.p);
  } else {
    moved.Q = b + on_B.shift(-m) - on_B.ball * m;
    moved.P = moved.Q - moved.gap * m + (B.p - A.p);
  }
  return moved;
}

void drift_rates(ContactRows& contacts, const ContactDrift& drift, std::span<double> rates) {
  for (int k = 0; k < contacts.count(); ++k) {
    ContactConstraints::Point& point = contacts.point(k);
    point.curved = 0;
    if (!point.active) continue;
    const Contact& contact = contacts.slot(k).contact;
    const row_parts::ContactFrame& frame = contacts.slot(k).point.frame;
    const BodyEnds A = ends_of(drift, contact.A.index), B = ends_of(drift, contact.B.index);
    if (is_still(contact, A, B)) continue;
    const Mat3 still = Mat3::Identity();
    const MovedContact now = moved_contact(contact, A.end, B.end, A.turn, B.turn);
    const MovedContact then = moved_contact(contact, A.start, B.start, still, still);
    const Vec3 n = frame.n, m = now.normal;
    if (!now.found || (m - n).norm() > DriftTuning::kFarTurn) continue;
    const auto at_end = [&](const Vec3& rate) { return carried(tangential(rate, m), m, n); };
    const Vec3 half = 0.5 * now.gap * m;
    const Vec3 slip = at_end(B.V.at(now.Q - half) - A.V.at(now.P + half)), turning = B.V.w - A.V.w;
    const int row = contacts.first_row(k);
    const double linear = std::exchange(rates[row], (now.gap - then.gap) / drift.h);
    point.curved = DriftTuning::kCurvedPart * (m - n).norm() * std::abs(rates[row] - linear);
    const Vec3 rolling = at_end(turning);
    for (int i : {1, 2}) {
      double& sliding = rates[row + i];
      sliding = 0.5 * (sliding + frame.direction(i).dot(slip));
      if (!contacts.has_twist(k)) continue;
      double& roll = rates[row + ContactRows::kSpinRow + i];
      roll = 0.5 * (roll + frame.direction(i).dot(rolling));
    }
    if (contacts.has_twist(k)) {
      double& spin = rates[row + ContactRows::kSpinRow];
      spin = 0.5 * (spin + m.dot(turning));
    }
  }
}

}  // namespace taut
