#include "scenes/builders/hanging_chain.h"

#include <cmath>
#include <numbers>

#include "core/base/check.h"

namespace taut {
namespace {

/// A chain that is longer than the distance of its ends by less than this part is straight.
constexpr double kStraight = 1e-9;
/// Halvings of an interval, until it is as short as a double can tell.
constexpr int kHalvings = 80;

/// Where `falls` becomes negative between low, where it is not, and high.
template <typename Function>
double crossing_point(double low, double high, Function falls) {
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2;
    (falls(middle) >= 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// Links of length 1 with slopes a (i − c): the vector from end to end, in the plane of the chain.
struct Slopes {
  int n;
  double a, c;
  Eigen::Vector2d link(int i) const { return Eigen::Vector2d(1, a * (i - c)).normalized(); }
  Eigen::Vector2d sum() const {
    Eigen::Vector2d total = Eigen::Vector2d::Zero();
    for (int i = 0; i < n; ++i) total += link(i);
    return total;
  }
};

/// The slopes whose chain goes from the origin to `end`, in lengths of a link; further from it than allowed
/// if there are none.
Slopes slopes_to(const Eigen::Vector2d& end, int n) {
  const auto balanced = [&](double log_a) {  // c such that the height is right
    Slopes slopes{n, std::exp(log_a), 0};
    double reach = n;
    const auto excess = [&](double c) {
      slopes.c = c;
      return slopes.sum().y() - end.y();
    };
    while (excess(-reach) < 0 || excess(n + reach) >= 0) {
      if (reach > 1e18) break;
      reach *= 4;
    }
    slopes.c = crossing_point(-reach, n + reach, excess);
    return slopes;
  };
  // From nearly straight to nearly vertical links.
  return balanced(crossing_point(-25, 25, [&](double log_a) { return balanced(log_a).sum().x() - end.x(); }));
}

/// Chords of a circle with the ends on u, sagging towards v (both unit vectors).
std::vector<Vec3> chords_of_arc(const Vec3& from, const Vec3& to, int n, double length, const Vec3& u,
                                const Vec3& v) {
  const double link = length / n, distance = (to - from).norm();
  const double turn = crossing_point(0, 2 * std::numbers::pi / n, [&](double angle) {
    return (angle == 0 ? n : std::sin(n * angle / 2) / std::sin(angle / 2)) - distance / link;
  });
  const double radius = link / (2 * std::sin(turn / 2)), half = n * turn / 2;
  std::vector<Vec3> nodes;
  for (int k = 0; k <= n; ++k) {
    const double angle = k * turn - half;
    nodes.push_back(from + radius * (std::sin(angle) + std::sin(half)) * u +
                    radius * (std::cos(angle) - std::cos(half)) * v);
  }
  return nodes;
}

}  // namespace

std::vector<Vec3> hanging_chain(const Vec3& from, const Vec3& to, int n, double length, const Vec3& down) {
  const Vec3 d = to - from;
  const double distance = d.norm();
  if (n < 1) fail("links", "must be at least 1", n);
  require_positive("length", length);
  if (length < distance * (1 - kStraight))
    fail("length", "must not be less than the distance of the ends", length);
  std::vector<Vec3> nodes;
  if (length <= distance * (1 + kStraight)) {
    for (int k = 0; k <= n; ++k) nodes.push_back(from + d * (static_cast<double>(k) / n));
    return nodes;
  }
  if (n == 1) fail("length", "must be the distance of the ends, since one link cannot sag", length);

  const Vec3 vertical = down.norm() > 0 ? Vec3(-down.normalized()) : Vec3(Vec3::UnitZ());
  const Vec3 level = d - d.dot(vertical) * vertical;
  const double link = length / n;
  const Eigen::Vector2d end(level.norm() / link, d.dot(vertical) / link);
  if (end.x() > 0) {
    const Slopes slopes = slopes_to(end, n);
    if ((slopes.sum() - end).norm() <= kStraight * n) {
      const Vec3 along = level.normalized();
      Vec3 p = from;
      for (int i = 0; i <= n; ++i) {
        nodes.push_back(p);
        p += link * (slopes.link(i).x() * along + slopes.link(i).y() * vertical);
      }
      nodes.back() = to;
      return nodes;
    }
  }
  Vec3 u = distance > 0 ? Vec3(d / distance) : Vec3(Vec3::UnitX());
  Vec3 v = -vertical - u.dot(-vertical) * u;
  if (v.norm() < kStraight) v = u.unitOrthogonal();
  return chords_of_arc(from, to, n, length, u, v.normalized());
}

}  // namespace taut
