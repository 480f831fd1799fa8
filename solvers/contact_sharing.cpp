#include <algorithm>
#include <cmath>

#include "solvers/contact_forces.h"

// Contacts that stick hold as long as any division of the load among them does.  (solvers/README, "Static
// friction")
namespace taut {
namespace {

/// Slip that is less than this part of the largest may end once others have been let go.
constexpr double kSlips = 1e-2;

/// The point of the cone |x_t| ≤ μ x_n that is nearest to x = (x_n, x_t).
Vec3 into_cone(const Vec3& x, double mu) {
  const Vec2 tangent = x.tail<2>();
  const double size = tangent.norm();
  const auto [region, on] = nearest_on_cone(x[0], size, mu);
  if (region == NearestOnCone::Region::kWithin) return x;
  if (region == NearestOnCone::Region::kApex) return Vec3::Zero();
  Vec3 nearest;
  nearest << on, mu * on / size * tangent;
  return nearest;
}

}  // namespace

bool ContactForces::all_stick(std::span<const double> lambda) const {
  for (int k = 0; k < std::ssize(points_); ++k)
    if (presses(k, lambda) && friction_bound(k, 1) > 0 && !sticks(k)) return false;
  return true;
}

void ContactForces::held_laws(std::span<const double> lambda, std::span<RowLaw> laws) const {
  for (int k = 0; k < std::ssize(points_); ++k) {
    const int row = first_row_[k];
    if (!works(k)) continue;
    const Point& point = points_[k];
    const bool bears = presses(k, lambda), holds = bears && friction_bound(k, 1) > 0;
    laws[row] = bears ? RowLaw::equality(normal_law(k).target) : RowLaw::constant(-point.back);
    for (int i : {0, 1})
      laws[row + 1 + i] =
          holds ? RowLaw::equality(point.sliding.target[i]) : RowLaw::constant(-point.sliding.given[i]);
  }
}

/// It sticks, and its disc was passed.
bool ContactForces::slips_in_vain(int k) const {
  return sticks(k) && points_[k].sliding.slips && points_[k].sliding.weight > 0;
}

bool ContactForces::slips_where_it_held() const {
  for (std::size_t k = 0; k < points_.size(); ++k)
    if (slips_in_vain(static_cast<int>(k))) return true;
  return false;
}

/// Those that a contact meets faster than the resting speed.
std::vector<char> ContactForces::struck_bodies() const {
  std::vector<char> struck(moves_.size(), 0);
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const Rows::ContactPlace& at = set_.places()[k].at;
    if (!works(static_cast<int>(k)) || points_[k].approach >= -resting_speed_) continue;
    for (int b : {at.a, at.b}) struck[b] = moves_[b];
  }
  return struck;
}

bool ContactForces::begin_sharing() {
  const std::vector<char> struck = struck_bodies();
  bool any = false;
  weakened_ = false;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const Rows::ContactPlace& at = set_.places()[k].at;
    const bool slips = slips_in_vain(static_cast<int>(k));
    points_[k].wavers = slips && !struck[at.a] && !struck[at.b];
    any = any || points_[k].wavers;
    if (slips && !points_[k].wavers) release(static_cast<int>(k));
  }
  sharing_ = any;
  if (!any) return false;
  unshared_ = points_;
  unshared_residual_ = residual_;
  return true;
}

void ContactForces::end_sharing(bool hold) {
  sharing_ = false;
  if (hold) return;
  for (std::size_t k = 0; k < points_.size(); ++k)
    if (unshared_[k].wavers) unshared_[k].broken = points_[k].broken;
  points_ = unshared_;
  residual_ = unshared_residual_;
  turns_.clear();
}

double ContactForces::slip_of(int k, std::span<const double> w) const {
  const Vec2& target = points_[k].sliding.target;
  return std::hypot(w[first_row_[k] + 1] - target[0], w[first_row_[k] + 2] - target[1]);
}

double ContactForces::shared_slip(std::span<const double> w) const {
  double largest = 0;
  for (std::size_t k = 0; k < points_.size(); ++k)
    if (sticks(static_cast<int>(k))) largest = std::max(largest, slip_of(static_cast<int>(k), w));
  return largest;
}

void ContactForces::release(int k) {
  const Material& material = set_.places()[k].material;
  points_[k].broken = true;
  points_[k].wavers = false;
  weakened_ = weakened_ || material.dynamic_friction < material.static_friction;
}

bool ContactForces::let_go(std::span<const double> w, bool judged) {
  const double much = judged ? kSlips * shared_slip(w) : 0;
  bool any = false, left = false;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    if (!points_[k].wavers) continue;
    const bool holds = slip_of(static_cast<int>(k), w) < much;
    left = left || holds;
    any = any || !holds;
    if (!holds) release(static_cast<int>(k));
  }
  if (any || !left) return left;
  for (std::size_t k = 0; k < points_.size(); ++k)
    if (sticks(static_cast<int>(k)) && slip_of(static_cast<int>(k), w) >= much) release(static_cast<int>(k));
  return true;
}

/// Distance of the three impulses from the normality law of the cone, [√J].
double ContactForces::cone_error(int k, std::span<const double> lambda, std::span<const double> w) const {
  const Point& point = points_[k];
  const int row = first_row_[k];
  const Vec2& given = point.sliding.given;
  const Vec2& target = point.sliding.target;
  const double root = *std::max_element(root_.begin() + row, root_.begin() + row + 3);
  const Vec3 impulse(point.back + lambda[row], given[0] + lambda[row + 1], given[1] + lambda[row + 2]);
  const Vec3 off(w[row] - normal_law(k).target, w[row + 1] - target[0], w[row + 2] - target[1]);
  return root * (impulse - into_cone(impulse - off / (root * root), friction_bound(k, 1))).norm();
}

}  // namespace taut
