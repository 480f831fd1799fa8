#include "solvers/complementarity/stage_culprits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

namespace taut {

void StageCulprits::clear() {
  jammed_.clear();
  culprits_.clear();
}

void StageCulprits::find(const StageResidual& residual, const StageSolution& solution) {
  culprits_.clear();
  const double scale = residual.scale(solution);
  add_rows(residual, solution, scale);
  add_contacts(solution, scale);
  while (!culprits_.empty() && culprits_.back().share < Tuning::kCulpritShare * culprits_.front().share)
    culprits_.pop_back();
}

void StageCulprits::add_rows(const StageResidual& residual, const StageSolution& solution, double scale) {
  const Rows& rows = model_.system.rows();
  auto axis = rows.axis_rows().begin();
  for (int r = 0; r < rows.first_contact_row(); ++r) {
    while (axis != rows.axis_rows().end() && axis->row < r) ++axis;
    const double off = residual.of_row(r, solution, scale, {});
    if (!counts(off)) continue;
    const bool has_axis = axis != rows.axis_rows().end() && axis->row == r;
    Culprit culprit = owner_of(r, has_axis ? &*axis : nullptr);
    culprit.share = off;
    add(culprit);
  }
}

void StageCulprits::add_contacts(const StageSolution& solution, double scale) {
  const std::span<const ContactCache::Slot> slots = model_.contacts.cache().slots();
  for (std::size_t k = 0; k < slots.size(); ++k) {
    if (!slots[k].active) continue;
    const double off = relative_contact_residual(model_.contacts, static_cast<int>(k), solution.lambda,
                                                 solution.w, scale, {});
    if (!counts(off)) continue;
    const auto [a, b] =
        std::minmax(named_->shape(slots[k].contact.a).body, named_->shape(slots[k].contact.b).body);
    add({.kind = Culprit::Kind::kContact, .a = a, .b = b, .share = off});
  }
}

/// The spring, axis or joint whose row it is.
Culprit StageCulprits::owner_of(int row, const Rows::AxisRow* axis) const {
  const auto& owner = model_.system.rows().owner(row);
  if (const auto* spring = std::get_if<ForceId>(&owner))
    return {.kind = Culprit::Kind::kSpring, .force = *spring};
  if (axis && axis->axis()) return {.kind = Culprit::Kind::kAxis, .axis = *axis->axis()};
  return {.kind = Culprit::Kind::kJoint, .axis = AxisId{std::get<JointId>(owner), -1}};
}

/// What is so far off is among the first few.
bool StageCulprits::counts(double off) const {
  return !(off <= (culprits_.size() < Tuning::kMostCulprits ? 0 : culprits_.back().share));
}

/// One entry for all rows of one owner.
void StageCulprits::add(Culprit culprit) {
  if (!(culprit.share <= std::numeric_limits<double>::max()))
    culprit.share = std::numeric_limits<double>::infinity();
  const auto same = std::find_if(culprits_.begin(), culprits_.end(), [&](const Culprit& other) {
    return other.kind == culprit.kind && other.axis == culprit.axis && other.force == culprit.force &&
           other.a == culprit.a && other.b == culprit.b;
  });
  if (same == culprits_.end())
    culprits_.push_back(culprit);
  else
    same->share = std::max(same->share, culprit.share);
  std::stable_sort(culprits_.begin(), culprits_.end(),
                   [](const Culprit& a, const Culprit& b) { return a.share > b.share; });
  if (culprits_.size() > Tuning::kMostCulprits) culprits_.pop_back();
}

void StageCulprits::find_jam(std::span<const double> lambda, std::span<const double> effective_mass) {
  const Rows& rows = model_.system.rows();
  const auto size = [&](int r) {
    return effective_mass[r] > 0 ? std::abs(lambda[r]) / std::sqrt(effective_mass[r]) : 0;
  };
  double largest = 0;
  for (int r = 0; r < rows.first_contact_row(); ++r) largest = std::max(largest, size(r));
  jammed_.clear();
  const std::span<const char> growing = model_.axes.growing();
  if (std::find(growing.begin(), growing.end(), 1) == growing.end()) return;  // they only settle slowly
  const auto is_large = [&](int r) { return size(r) >= Tuning::kJamShare * largest; };
  for (std::size_t i = 0; i < rows.axis_rows().size(); ++i) {
    const int r = rows.axis_rows()[i].row;
    if (is_large(r) && (growing[i] || model_.axes.has_unbounded_motor(i))) jammed_.push_back(r);
  }
  for (int r = 0; r < rows.first_contact_row(); ++r)
    if (rows.is_equality(r) && rows.row(r).store->depends_on_time() && is_large(r)) jammed_.push_back(r);
}

void StageCulprits::report(SubstepReport& report) const { report.culprits = culprits_; }

}  // namespace taut
