#include "solvers/laws/stick_search.h"

#include <algorithm>

namespace taut {
namespace {

struct StickSearchTuning {
  /// Slip that is less than this part of the largest slip may end once others have been let go.  Chosen.
  static constexpr double kSlips = 1e-2;
  /// Contacts that slip by more than this part of what all friction on one of their bodies could change are
  /// far from holding.  Chosen.
  static constexpr double kFarSlip = 0.05;
};

}  // namespace

bool StickSearch::begin(std::span<const double> lambda, std::span<const double> w) {
  weakened_ = false;
  const bool any = choose_candidates(lambda, w);
  contacts_.set_normality(any);
  if (!any) return false;
  before_.clear();
  for (int k = 0; k < contacts_.count(); ++k) before_.push_back(contacts_.point(k));
  residual_before_ = friction_.residual();
  return true;
}

/// Those that may hold after all; what slips and may not is let go.
bool StickSearch::choose_candidates(std::span<const double> lambda, std::span<const double> w) {
  const std::vector<int> struck = struck_bodies();
  const std::vector<double> friction = friction_of_bodies(lambda);
  const auto is_struck = [&](int body) { return std::binary_search(struck.begin(), struck.end(), body); };
  bool any = false;
  for (int k = 0; k < contacts_.count(); ++k) {
    const Rows::ContactSlot& at = contacts_.slot(k).at;
    const bool slips = contacts_.slips_in_vain(k);
    const bool candidate = slips && !is_struck(at.a) && !is_struck(at.b) && !is_far(k, w, friction);
    contacts_.point(k).stick_candidate = candidate;
    any = any || candidate;
    if (slips && !candidate) release(k);
  }
  return any;
}

/// Those that a contact meets faster than the resting speed, in ascending order.
std::vector<int> StickSearch::struck_bodies() const {
  const ContactConstraints& table = contacts_.table();
  std::vector<int> struck;
  for (int k = 0; k < contacts_.count(); ++k) {
    if (!contacts_.works(k) || contacts_.point(k).approach >= -table.resting_speed) continue;
    for (int b : {contacts_.slot(k).at.a, contacts_.slot(k).at.b})
      if (table.moves[b]) struck.push_back(b);
  }
  std::sort(struck.begin(), struck.end());
  return struck;
}

/// The most that friction of all contacts of a body gives it [N·s].
std::vector<double> StickSearch::friction_of_bodies(std::span<const double> lambda) const {
  std::vector<double> friction(contacts_.table().moves.size(), 0.0);
  for (int k = 0; k < contacts_.count(); ++k)
    for (int body : {contacts_.slot(k).at.a, contacts_.slot(k).at.b})
      if (contacts_.works(k)) friction[body] += contacts_.friction_bound(k, contacts_.pressure(k, lambda));
  return friction;
}

bool StickSearch::is_far(int k, std::span<const double> w, std::span<const double> friction) const {
  const std::vector<char>& moves = contacts_.table().moves;
  const auto [a, b, twist] = contacts_.slot(k).at;
  const double most = std::max(moves[a] ? friction[a] : 0, moves[b] ? friction[b] : 0);
  const int row = contacts_.first_row(k);
  const double root = std::max(contacts_.root_diagonal(row + 1), contacts_.root_diagonal(row + 2));
  return contacts_.slip_of(k, w) > StickSearchTuning::kFarSlip * most * root * root;
}

void StickSearch::end(bool hold) {
  contacts_.set_normality(false);
  if (hold) return;
  for (int k = 0; k < contacts_.count(); ++k) {
    if (before_[k].stick_candidate) before_[k].slipping = contacts_.point(k).slipping;
    contacts_.point(k) = before_[k];
  }
  friction_.restore(residual_before_);
}

void StickSearch::release(int k) {
  const Material& material = contacts_.slot(k).material;
  contacts_.point(k).slipping = true;
  contacts_.point(k).stick_candidate = false;
  if (material.dynamic_friction < material.static_friction) weakened_ = true;
}

bool StickSearch::mark_sliding(std::span<const double> w, bool judged) {
  const double much = judged ? StickSearchTuning::kSlips * contacts_.sticking_slip(w) : 0;
  bool any = false, left = false;
  for (int k = 0; k < contacts_.count(); ++k) {
    if (!contacts_.point(k).stick_candidate) continue;
    const bool holds = contacts_.slip_of(k, w) < much;
    left = left || holds;
    any = any || !holds;
    if (!holds) release(k);
  }
  if (any || !left) return left;
  for (int k = 0; k < contacts_.count(); ++k)
    if (contacts_.sticks(k) && contacts_.slip_of(k, w) >= much) release(k);
  return true;
}

}  // namespace taut
