#include "solvers/integrators/velocity_projection.h"

#include <algorithm>
#include <cmath>

#include "solvers/common/max_abs.h"

namespace taut {
namespace {

constexpr int kMaxVelocityPasses = 6;
/// A part of the rates that each pass leaves is summed up if it is no more than this, and has been the same
/// to that part of itself in so many sub-steps in a row.
constexpr double kMostLeftOver = 0.2, kAlike = 0.05;
constexpr int kSteady = 20;

}  // namespace

VelocityProjection::VelocityProjection(ConstraintSystem& system, const Settings& settings,
                                       const Breaking& breaking, Phase& phase, RowValues& values)
    : system_(system),
      settings_(settings),
      breaking_(breaking),
      phase_(phase),
      values_(values),
      last_rates_(values.joint_rates.size(), 0.0) {}

void VelocityProjection::clear_loose_rows(std::span<double> rows) const {
  breaking_.clear_rows(rows);
  system_.clear_bounded_rows(rows);
}

bool VelocityProjection::project(double h, SubstepReport& report) {
  const std::vector<double>& rates = values_.joint_rates;
  std::vector<double>&mu = values_.mu, &delta = values_.delta;
  std::fill(mu.begin(), mu.end(), 0.0);
  twists_and_rates([this, h](int b) {
    if (h != 0) phase_.second_kick(b, h);
  });
  for (int pass = 0; pass < kMaxVelocityPasses; ++pass) {
    const double sum = pass > 0 && steady_count_ >= kSteady ? 1 / (1 - contraction_) : 1;
    for (int r = 0; r < system_.row_count(); ++r) delta[r] = -sum * rates[r];
    if (pass == 1) last_rates_ = rates;
    system_.solve_shifted(delta);
    twists_and_rates([this, &delta](int b) {
      phase_.momenta[b] = phase_.momenta[b] + system_.rows().wrench_on(b, system_.jacobian(), delta);
    });
    for (int r = 0; r < system_.row_count(); ++r) mu[r] += delta[r];
    if (pass == 1) watch_contraction(sum);
    report.velocity_residual = max_abs(rates);
    if (report.velocity_residual <= settings_.velocity_tolerance) return true;
  }
  return false;
}

/// Momenta as `change` makes them of each body that moves, then twists and J V + φ_t: each joint as soon as
/// the twists of its bodies are there, while its Jacobian is still near.
template <typename Change>
void VelocityProjection::twists_and_rates(Change change) {
  const Rows& rows = system_.rows();
  State& state = phase_.state;
  for (int b = 0; b < std::ssize(state.poses); ++b) {
    if (system_.inverse_mass(b).moves()) {
      change(b);
      state.twists[b] = system_.inverse_mass(b).twist(phase_.momenta[b]);
    }
    for (int j : rows.joints_due(b))
      rows.apply(rows.joints()[j], system_.jacobian(), state.twists, values_.joint_rates);
  }
  rows.add_rate(state, values_.joint_rates);
  clear_loose_rows(values_.joint_rates);
}

/// What the second pass leaves of its rates, or would have left without `sum`, as a part of them.
void VelocityProjection::watch_contraction(double sum) {
  double before = 0, after = 0;
  for (int r = 0; r < system_.row_count(); ++r) {
    before += last_rates_[r] * last_rates_[r];
    after += last_rates_[r] * values_.joint_rates[r];
  }
  const double left = before > 0 ? 1 - (1 - after / before) / sum : 0;
  const bool alike = left > 0 && left <= kMostLeftOver && std::abs(left - contraction_) <= kAlike * left;
  steady_count_ = alike ? steady_count_ + 1 : 0;
  contraction_ = left;
}

}  // namespace taut
