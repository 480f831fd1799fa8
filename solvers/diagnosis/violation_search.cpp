#include "solvers/diagnosis/violation_search.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "solvers/common/max_abs.h"
#include "solvers/integrators/body_moves.h"

namespace taut {
namespace {

/// Without a unit: parts and counts.  Chosen, where nothing else is said.  (solvers/diagnosis,
/// "Contradiction")
struct SearchTuning {
  /// Demands are met within this [m or rad]: a hundred times what a step closes them to.
  static constexpr double kMet = 1e-8;
  /// Steps at most.
  static constexpr int kMostSteps = 80;
  /// |Wᵀ D c| / √2f at which demands balance, and at which they do if the search comes no further.
  static constexpr double kBalance = 1e-6, kNearBalance = 1e-3;

  // Levenberg–Marquardt.
  /// δ, relative to rows of unit length: at first, at least, and where it is given up.
  static constexpr double kFirstDamping = 1e-6, kLeastDamping = 1e-9, kMostDamping = 1e6;
  /// What f falls by over what its model says: a step is taken from kLeastGain on; δ grows kPoorTimes below
  /// kPoorGain, falls kDampingTimes above kGoodGain, and grows as much where no step is taken.
  static constexpr double kLeastGain = 1e-4, kPoorGain = 0.25, kGoodGain = 0.75;
  static constexpr double kPoorTimes = 4, kDampingTimes = 8;
};

}  // namespace

ViolationSearch::ViolationSearch(const World& world, std::span<const ContactCache::Slot> contacts)
    : system_(world, FactorChoice::kAuto) {
  if (!contacts.empty()) {
    std::vector<Rows::ContactSlot> slots;
    for (const ContactCache::Slot& slot : contacts) slots.push_back(slot.at);
    system_.set_contact_slots(world, slots);
    for (std::size_t k = 0; k < contacts.size(); ++k)
      system_.set_contact(static_cast<int>(k), contacts[k].point);
  }
  for (auto* values : {&effective_mass_, &x_, &stiffness_, &scaled_, &force_})
    values->assign(system_.row_count(), 0.0);
  for (auto* values : {&gradient_, &v_}) values->assign(6 * system_.rows().body_count(), 0.0);
}

void ViolationSearch::begin(std::vector<Demand> demands, int members, const State& from, double time) {
  demands_ = std::move(demands);
  start_ = from;
  time_ = time;
  for (auto* values : {&excess_, &trial_excess_}) values->assign(demands_.size(), 0.0);
  blame_.assign(members, 0.0);
  system_.set_mass(from.poses);
  system_.linearize(configuration(start_.poses));
  system_.effective_masses(effective_mass_);
  for (double& effective_mass : effective_mass_)
    if (effective_mass == 0) effective_mass = 1;  // nothing moves it
}

ViolationSearch::Verdict ViolationSearch::search(std::span<const char> wanted) {
  wanted_ = wanted;
  poses_ = start_.poses;
  damping_ = SearchTuning::kFirstDamping;
  f_ = evaluate(poses_, wanted);
  excess_.swap(trial_excess_);
  largest_ = trial_largest_;
  for (int k = 0; k < SearchTuning::kMostSteps; ++k) {
    if (!std::isfinite(f_)) return Verdict::kUnknown;
    if (largest_ <= SearchTuning::kMet) return Verdict::kHolds;
    gather();
    if (steepness_ <= SearchTuning::kBalance) return Verdict::kExcluded;
    if (!step()) break;
  }
  if (largest_ <= SearchTuning::kMet) return Verdict::kHolds;
  return steepness_ <= SearchTuning::kNearBalance ? Verdict::kExcluded : Verdict::kUnknown;
}

/// f, trial_excess_ and trial_largest_ at these poses.
double ViolationSearch::evaluate(std::span<const Pose> poses, std::span<const char> wanted) {
  rows().residual(configuration(poses), x_);
  double f = 0;
  trial_largest_ = 0;
  for (std::size_t i = 0; i < demands_.size(); ++i) {
    const Demand& demand = demands_[i];
    const double c = wanted[demand.member] ? demand.excess(x_[demand.row]) : 0;
    trial_excess_[i] = c;
    trial_largest_ = std::max(trial_largest_, std::abs(c));
    f += 0.5 * effective_mass_[demand.row] * c * c;
  }
  return f;
}

/// D, Wᵀ D c and how steep f is, at poses_.
void ViolationSearch::gather() {
  system_.linearize(configuration(poses_));
  std::fill(stiffness_.begin(), stiffness_.end(), 0.0);
  std::fill(force_.begin(), force_.end(), 0.0);
  for (std::size_t i = 0; i < demands_.size(); ++i) {
    if (excess_[i] == 0 && !(wanted_[demands_[i].member] && demands_[i].lower == demands_[i].upper)) continue;
    const int r = demands_[i].row;
    stiffness_[r] += effective_mass_[r];
    force_[r] += effective_mass_[r] * excess_[i];
  }
  system_.apply_Wt(force_, gradient_);
  const double slope = std::inner_product(gradient_.begin(), gradient_.end(), gradient_.begin(), 0.0);
  steepness_ = std::sqrt(slope / (2 * f_));
}

/// False if no damping makes f smaller.
bool ViolationSearch::step() {
  for (; damping_ <= SearchTuning::kMostDamping; damping_ *= SearchTuning::kDampingTimes)
    if (try_step()) return true;
  return false;
}

bool ViolationSearch::try_step() {
  StageTimes times;
  for (std::size_t r = 0; r < scaled_.size(); ++r) scaled_[r] = stiffness_[r] / damping_;
  if (!system_.factorize_bodies(system_.weighted(), scaled_, times)) return false;
  for (std::size_t i = 0; i < v_.size(); ++i) v_[i] = -gradient_[i] / damping_;
  system_.solve_bodies(v_);
  trial_ = poses_;
  double turn = 0, descent = 0, length = 0;
  for (int b = 0; b < system_.mass().size(); ++b) {
    if (system_.mass()[b].fixed) continue;
    const InverseMassRoot& root = system_.mass_roots()[b];
    const Eigen::Map<const Vec3> spin(v_.data() + 6 * b), shift(v_.data() + 6 * b + 3);
    const Vec3 angle = root.rotation * spin;
    turn = std::max(turn, angle.norm());
    trial_[b].p += root.translation * shift;
    trial_[b].q = (exp_so3(angle) * trial_[b].q).normalized();
    descent -=
        Vec3::Map(gradient_.data() + 6 * b).dot(spin) + Vec3::Map(gradient_.data() + 6 * b + 3).dot(shift);
    length += spin.squaredNorm() + shift.squaredNorm();
  }
  if (!(turn <= BodyMovesTuning::kLongestTurn)) return false;
  const double f = evaluate(trial_, wanted_), gain = (f_ - f) / (0.5 * (descent + damping_ * length));
  if (!(gain > SearchTuning::kLeastGain)) return false;
  f_ = f;
  largest_ = trial_largest_;
  poses_.swap(trial_);
  excess_.swap(trial_excess_);
  if (gain > SearchTuning::kGoodGain)
    damping_ = std::max(SearchTuning::kLeastDamping, damping_ / SearchTuning::kDampingTimes);
  if (gain < SearchTuning::kPoorGain) damping_ *= SearchTuning::kPoorTimes;
  return true;
}

std::span<const double> ViolationSearch::blame() {
  std::fill(blame_.begin(), blame_.end(), 0.0);
  for (std::size_t i = 0; i < demands_.size(); ++i)
    blame_[demands_[i].member] += effective_mass_[demands_[i].row] * excess_[i] * excess_[i];
  for (double& blame : blame_) blame = std::sqrt(blame);
  return blame_;
}

}  // namespace taut
