#include "solvers/integrators/contact_pattern.h"

#include <algorithm>
#include <numeric>

namespace taut {

ContactPattern::ContactPattern(const World& world, ConstraintSystem& system, ContactForces& contacts,
                               StageSolver& stages, RowValues& values, MultiplierPrediction& prediction)
    : world_(world),
      system_(system),
      contacts_(contacts),
      stages_(stages),
      values_(values),
      prediction_(prediction) {}

void ContactPattern::start(const State& state) {
  if (contacts_.start(world_, state, horizon_)) take_over_slots();
  contacts_.give_points(system_);
}

void ContactPattern::move_on(const State& state) {
  if (contacts_.move_on(world_, state, horizon_)) take_over_slots();
  contacts_.give_points(system_);
}

void ContactPattern::inherit(ContactPattern& old) {
  if (contacts_.empty() || old.contacts_.empty()) return;
  contacts_.inherit(old.contacts_, world_);
  std::vector<int> from(system_.row_count());
  std::iota(from.begin(), from.end(), 0);
  set_slots();
  from.resize(system_.row_count(), -1);
  move_rows(from);
}

void ContactPattern::forget_impulses() {
  const auto first = system_.rows().first_contact_row();
  for (auto* values : {&values_.lambda, &values_.mu, &values_.force_multipliers})
    std::fill(values->begin() + first, values->end(), 0.0);
  prediction_.clear_from(first);
}

void ContactPattern::renew() {
  set_slots();
  move_rows(std::vector<int>(static_cast<std::size_t>(system_.row_count()), -1));
}

/// New slots: a new pattern.  What belongs to rows of joints stays, also that of contacts which go on.
void ContactPattern::take_over_slots() {
  const int joint_rows = system_.rows().first_contact_row();
  const std::vector<int> old_first(contacts_.first_rows().begin(), contacts_.first_rows().end());
  set_slots();
  const int rows = system_.row_count();
  std::vector<int> from(rows, -1);
  for (int r = 0; r < joint_rows; ++r) from[r] = r;
  const std::span<const int> origin = contacts_.cache().origin();
  for (std::size_t k = 0; k < origin.size(); ++k) {
    if (origin[k] < 0) continue;
    const int count = contacts_.cache().slots()[k].at.row_count();
    for (int i = 0; i < count; ++i)
      from[contacts_.first_row(static_cast<int>(k)) + i] = old_first[origin[k]] + i;
  }
  move_rows(from);
}

void ContactPattern::set_slots() {
  system_.set_contact_slots(world_, contacts_.cache().rows());
  contacts_.set_rows(system_.rows());
}

/// All that has rows, to those of the new slots: `from` says for each row which one it was, −1 for none.
void ContactPattern::move_rows(std::span<const int> from) {
  values_.move_rows(from);
  prediction_.move_rows(from);
  stages_.move_rows(from);
  system_.release_bounded_rows();
}

}  // namespace taut
