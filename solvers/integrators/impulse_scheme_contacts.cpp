#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "solvers/common/move_rows.h"
#include "solvers/integrators/impulse_scheme.h"

// Contacts come and go: found at the end of a drift, they join the rows of the system for the velocity stage
// of that step and the position stage of the next.  (solvers/integrators, "RATTLE")
namespace taut {
namespace {

/// Forces that change by more than this part between steps ask for a new start.
constexpr double kJump = 0.25;

}  // namespace

void ImpulseScheme::inherit_contacts(ImpulseScheme& old) {
  if (contacts_.empty() || old.contacts_.empty()) return;
  contacts_.inherit(old.contacts_, world_);
  std::vector<int> from(system_.row_count());
  std::iota(from.begin(), from.end(), 0);
  set_places();
  from.resize(system_.row_count(), -1);
  move_rows(from);
}

void ImpulseScheme::inherit(const ImpulseScheme& old) {
  axes_.inherit(old.axes_);
  if (bounded()) take(old.guess());
}

void ImpulseScheme::restart(const State& state, StepReport& report) {
  if (!bounded()) return start(state, report);
  const AxisForces axes = axes_;
  const Guess before = guess();
  contacts_.keep_memory();
  start(state, report);
  axes_.inherit(axes);
  take(before);
}

void ImpulseScheme::forget(std::span<const char> moved) {
  axes_.forget(moved);
  contacts_.forget(moved);
}

void ImpulseScheme::forget_contact_impulses() {
  const auto first = system_.rows().first_contact_row();
  for (auto* values : {&lambda_, &mu_, &force_multipliers_})
    std::fill(values->begin() + first, values->end(), 0.0);
  prediction_.clear_from(first);
}

ImpulseScheme::Guess ImpulseScheme::guess() const {
  const Rows& rows = system_.rows();
  return {{rows.joints().begin(), rows.joints().end()}, rows.contact_count(), force_multipliers_, lambda_};
}

/// Multipliers of the steps before as a guess.  Those of start() know of no contacts, but of loads that are
/// new: the step limit is that of both.
void ImpulseScheme::take(const Guess& guess) {
  const Rows& rows = system_.rows();
  const auto take_rows = [&](const Rows::JointRows& joint, const Rows::JointRows& before) {
    if (joint.row_count != before.row_count) return;
    std::copy_n(guess.forces.begin() + before.first_row, before.row_count,
                force_multipliers_.begin() + joint.first_row);
    std::copy_n(guess.lambda.begin() + before.first_row, before.row_count, lambda_.begin() + joint.first_row);
  };
  const std::size_t joints_before = guess.joints.size() - guess.contacts;
  const std::size_t joints = std::min(rows.joints().size() - rows.contact_count(), joints_before);
  for (std::size_t j = 0; j < joints; ++j) take_rows(rows.joints()[j], guess.joints[j]);
  for (int k = 0; k < rows.contact_count(); ++k)
    if (const int before = contacts_.inherited(k); before >= 0)
      take_rows(rows.joints()[rows.contact_joint(k)], guess.joints[joints_before + before]);
  contacts_.end_inheritance();
  const double limit = limit_.step(), omega = limit_.omega();
  update_step_limit();
  limit_.tighten(limit, omega);
}

bool ImpulseScheme::renew_forces() {
  last_forces_ = forces_;
  find_forces();
  double change = 0, size = 0;
  for (int b = 0; b < world_.body_count(); ++b) {
    if (!system_.inverse_mass(b).moves()) continue;
    change = std::max({change, (forces_[b].force - last_forces_[b].force).norm(),
                       (forces_[b].torque - last_forces_[b].torque).norm()});
    size = std::max({size, last_forces_[b].force.norm(), last_forces_[b].torque.norm()});
  }
  return change <= kJump * size;
}

void ImpulseScheme::start_contacts() {
  if (contacts_.start(world_, state_, horizon_))
    take_over_places();
  else
    contacts_.give_points(system_);
}

/// Contacts at q₁, with the velocities of the drift.
void ImpulseScheme::find_contacts() {
  std::swap(momenta_, kicked_);
  twists_from_momenta();
  std::swap(momenta_, kicked_);
  if (contacts_.move_on(world_, state_, horizon_))
    take_over_places();
  else
    contacts_.give_points(system_);
}

/// New places: a new pattern.  What belongs to rows of joints stays, also that of contacts which go on.
void ImpulseScheme::take_over_places() {
  const int joint_rows = system_.rows().first_contact_row();
  const std::vector<int> old_first(contacts_.first_rows().begin(), contacts_.first_rows().end());
  set_places();
  const int rows = system_.row_count();
  std::vector<int> from(rows, -1);
  for (int r = 0; r < joint_rows; ++r) from[r] = r;
  const std::span<const int> origin = contacts_.set().origin();
  for (std::size_t k = 0; k < origin.size(); ++k) {
    if (origin[k] < 0) continue;
    const int count = contacts_.set().places()[k].at.row_count();
    for (int i = 0; i < count; ++i)
      from[contacts_.first_row(static_cast<int>(k)) + i] = old_first[origin[k]] + i;
  }
  move_rows(from);
  contacts_.give_points(system_);
}

void ImpulseScheme::set_places() {
  system_.set_contact_places(world_, contacts_.set().rows());
  contacts_.set_rows(system_.rows());
}

/// All that has rows, to those of the new places: `from` says for each row which one it was, −1 for none.
void ImpulseScheme::move_rows(std::span<const int> from) {
  for (auto* values : {&lambda_, &mu_, &delta_, &phi_, &velocity_rows_, &impulses_, &force_multipliers_,
                       &start_theta_, &rates_, &kick_rates_})
    taut::move_rows(from, 0.0, *values);
  prediction_.move_rows(from);
  stages_.move_rows(from);
  system_.release_bounded_rows();
}

}  // namespace taut
