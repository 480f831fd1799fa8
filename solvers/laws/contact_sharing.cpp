#include <algorithm>
#include <cmath>

#include "solvers/laws/contact_laws.h"

// Contacts that stick hold as long as any division of the load among them does.
// (solvers/laws, "Static friction")
//
// "Assume it locked, solve, keep it within the static limit" is a question to the system, not to each
// contact: one point that passes its disc and goes on with dynamic friction would take the others along.
// The normality law of the cone of static friction is a convex minimum with one w.  Impulses within the
// cones with which nothing slips meet it, whatever they are; so if there are any it has w = t, which is
// Coulomb's law, too, and if it slips there are none.  Then those are released that slip in both solutions.
namespace taut {
namespace {

/// Slip that is less than this part of the largest may end once others have been let go.
constexpr double kSlips = 1e-2;
/// Contacts that slip by more than this part of what all friction on one of their bodies could change are far
/// from holding.
constexpr double kFarSlip = 0.05;

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

bool ContactLaws::all_stick(std::span<const double> lambda) const {
  for (int k = 0; k < count(); ++k)
    if (presses(k, lambda) && friction_bound(k, 1) > 0 && !sticks(k)) return false;
  return true;
}

void ContactLaws::held_laws(std::span<const double> lambda, std::span<RowLaw> laws) const {
  for (int k = 0; k < count(); ++k) {
    const int row = first_row_[k];
    if (!works(k)) continue;
    const Point& point = contact(k);
    const bool bears = presses(k, lambda), holds = bears && friction_bound(k, 1) > 0;
    laws[row] = bears ? RowLaw::equality(normal_law(k).target) : RowLaw::constant(-point.back);
    for (int i : {0, 1})
      laws[row + 1 + i] =
          holds ? RowLaw::equality(point.sliding.target[i]) : RowLaw::constant(-point.sliding.given[i]);
  }
}

/// It sticks, and its disc was passed.
bool ContactLaws::slips_in_vain(int k) const {
  return sticks(k) && contact(k).sliding.slips && contact(k).sliding.weight > 0;
}

bool ContactLaws::slips_where_it_held() const {
  for (int k = 0; k < count(); ++k)
    if (slips_in_vain(k)) return true;
  return false;
}

/// Those that a contact meets faster than the resting speed, in ascending order.
std::vector<int> ContactLaws::struck_bodies() const {
  std::vector<int> struck;
  for (int k = 0; k < count(); ++k) {
    if (!works(k) || contact(k).approach >= -table_.resting_speed) continue;
    for (int b : {place_of(k).at.a, place_of(k).at.b})
      if (table_.moves[b]) struck.push_back(b);
  }
  std::sort(struck.begin(), struck.end());
  return struck;
}

bool ContactLaws::begin_stick_search(std::span<const double> lambda, std::span<const double> w) {
  const std::vector<int> struck = struck_bodies();
  const auto is_struck = [&](int body) { return std::binary_search(struck.begin(), struck.end(), body); };
  std::vector<double> friction(table_.moves.size(), 0.0);
  for (int k = 0; k < count(); ++k)
    for (int body : {place_of(k).at.a, place_of(k).at.b})
      if (works(k)) friction[body] += friction_bound(k, pressure(k, lambda));
  const auto is_far = [&](int k) {
    const int a = place_of(k).at.a, b = place_of(k).at.b;
    const double most = std::max(table_.moves[a] ? friction[a] : 0, table_.moves[b] ? friction[b] : 0);
    const double root = std::max(root_[first_row_[k] + 1], root_[first_row_[k] + 2]);
    return slip_of(k, w) > kFarSlip * most * root * root;
  };
  bool any = false;
  weakened_ = false;
  for (int k = 0; k < count(); ++k) {
    const Rows::ContactPlace& at = place_of(k).at;
    const bool slips = slips_in_vain(k);
    contact(k).stick_candidate = slips && !is_struck(at.a) && !is_struck(at.b) && !is_far(k);
    any = any || contact(k).stick_candidate;
    if (slips && !contact(k).stick_candidate) release(k);
  }
  sharing_ = any;
  if (!any) return false;
  unshared_.clear();
  for (int k = 0; k < count(); ++k) unshared_.push_back(contact(k));
  unshared_residual_ = residual_;
  return true;
}

void ContactLaws::end_stick_search(bool hold) {
  sharing_ = false;
  if (hold) return;
  for (int k = 0; k < count(); ++k) {
    if (unshared_[k].stick_candidate) unshared_[k].broken = contact(k).broken;
    contact(k) = unshared_[k];
  }
  residual_ = unshared_residual_;
  turns_.clear();
}

double ContactLaws::slip_of(int k, std::span<const double> w) const {
  const Vec2& target = contact(k).sliding.target;
  return std::hypot(w[first_row_[k] + 1] - target[0], w[first_row_[k] + 2] - target[1]);
}

double ContactLaws::shared_slip(std::span<const double> w) const {
  double largest = 0;
  for (int k = 0; k < count(); ++k)
    if (sticks(k)) largest = std::max(largest, slip_of(k, w));
  return largest;
}

void ContactLaws::release(int k) {
  const Material& material = place_of(k).material;
  contact(k).broken = true;
  contact(k).stick_candidate = false;
  weakened_ = weakened_ || material.dynamic_friction < material.static_friction;
}

bool ContactLaws::mark_sliding(std::span<const double> w, bool judged) {
  const double much = judged ? kSlips * shared_slip(w) : 0;
  bool any = false, left = false;
  for (int k = 0; k < count(); ++k) {
    if (!contact(k).stick_candidate) continue;
    const bool holds = slip_of(k, w) < much;
    left = left || holds;
    any = any || !holds;
    if (!holds) release(k);
  }
  if (any || !left) return left;
  for (int k = 0; k < count(); ++k)
    if (sticks(k) && slip_of(k, w) >= much) release(k);
  return true;
}

/// Distance of the three impulses from the normality law of the cone, [√J].
double ContactLaws::cone_error(int k, std::span<const double> lambda, std::span<const double> w) const {
  const Point& point = contact(k);
  const int row = first_row_[k];
  const Vec2& given = point.sliding.given;
  const Vec2& target = point.sliding.target;
  const double root = *std::max_element(root_.begin() + row, root_.begin() + row + 3);
  const Vec3 impulse(point.back + lambda[row], given[0] + lambda[row + 1], given[1] + lambda[row + 2]);
  const Vec3 off(w[row] - normal_law(k).target, w[row + 1] - target[0], w[row + 2] - target[1]);
  return root * (impulse - into_cone(impulse - off / (root * root), friction_bound(k, 1))).norm();
}

}  // namespace taut
